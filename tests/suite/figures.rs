//! `vibc draw`: figures compared with the models, in numbers that are independent of the figure's own code; and no
//! label covers anything, on all examples, drawings, hard cases and generated scenes. See docs/draw.md.

mod generated;
mod room;

use room::crowded;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use vibc::FigureOptions;
use vibc::backend::draw::svg;
use vibc::base::{FileId, SourceFile, Sources};
use vibc::model::Overrides;
use vibc::picture::geometry::Point;
use vibc::picture::{Figure, Glyph, Kind, Stroke};

/// A figure and its text.
pub struct Figured {
    pub sources: Sources,
    pub model: FileId,
    pub figure: Figure,
}

impl Figured {
    pub fn of(name: &str, text: &str, drawn: FigureOptions) -> Result<Figured, String> {
        let mut sources = Sources::new();
        let model = sources.add(SourceFile::model(name, text));
        crate::examples::add_used_files(&mut sources, model);
        let outcome = vibc::draw(&sources, model, &Overrides::default(), &drawn);
        let Some(found) = outcome.answer else {
            let errors = outcome.diagnostics.iter().filter(|finding| finding.is_error());
            return Err(errors.map(|finding| format!("{}: {}", finding.code.0, finding.message)).collect());
        };
        Ok(Figured { figure: found?, sources, model })
    }

    pub fn svg(&self) -> String {
        svg(&self.figure, &self.sources, self.model)
    }

    fn named(&self, kind: Kind, start: &str) -> &Glyph {
        let found = self.figure.glyphs.iter().find(|g| !g.ghost && g.kind == kind && g.title.starts_with(start));
        found.unwrap_or_else(|| panic!("no {kind:?} whose title starts with {start:?}"))
    }

    fn of_kind(&self, kind: Kind) -> impl Iterator<Item = &Glyph> {
        self.figure.glyphs.iter().filter(move |glyph| !glyph.ghost && glyph.kind == kind)
    }
}

fn folder(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The models of a folder: name and text.
fn models(path: &str) -> Vec<(String, String)> {
    let entries = fs::read_dir(folder(path)).expect("a folder of models");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "vib"));
    files.sort();
    let read = |file: &PathBuf| {
        let name = file.file_name().expect("a file").to_string_lossy().into_owned();
        (name, String::from_utf8_lossy(&fs::read(file).expect("a model")).into_owned())
    };
    files.iter().map(read).collect()
}

fn example(name: &str) -> String {
    fs::read_to_string(folder("examples").join(name)).expect("an example")
}

fn drawing(name: &str) -> String {
    fs::read_to_string(folder("tests/drawings").join(name)).expect("a drawing")
}

const AS_DRAWN: FigureOptions = FigureOptions { rest: false, mode: None, values: false };

#[test]
fn figures_are_as_reviewed() {
    for (name, text) in models("examples").into_iter().chain(models("tests/drawings")) {
        let stem = name.trim_end_matches(".vib").to_string();
        let figured = Figured::of(&name, &text, AS_DRAWN).unwrap_or_else(|error| panic!("{name}: {error}"));
        insta::with_settings!({ snapshot_path => "../drawings/snapshots", prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_binary_snapshot!(&format!("{stem}.svg"), figured.svg().into_bytes());
        });
    }
}

#[test]
fn modes_and_rest_are_as_reviewed() {
    let cases = [
        ("cart_mode_2", example("cart.vib"), FigureOptions { mode: Some(2), ..AS_DRAWN }),
        ("double_pendulum_rest", example("double_pendulum.vib"), FigureOptions { rest: true, ..AS_DRAWN }),
        ("half_car_mode_2", example("half_car.vib"), FigureOptions { mode: Some(2), ..AS_DRAWN }),
        ("drive_line_values", example("drive_line.vib"), FigureOptions { values: true, ..AS_DRAWN }),
        ("engine_mode_1", drawing("engine.vib"), FigureOptions { mode: Some(1), ..AS_DRAWN }),
    ];
    for (name, text, drawn) in cases {
        let figured = Figured::of("m.vib", &text, drawn).unwrap_or_else(|error| panic!("{name}: {error}"));
        insta::with_settings!({ snapshot_path => "../drawings/snapshots", prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_binary_snapshot!(&format!("{name}.svg"), figured.svg().into_bytes());
        });
    }
}

#[test]
fn no_name_lies_over_anything() {
    for (name, text) in models("examples").into_iter().chain(models("tests/drawings")) {
        for values in [false, true] {
            let mut modes = vec![AS_DRAWN, FigureOptions { rest: true, ..AS_DRAWN }];
            modes.extend((1..=4).map(|mode| FigureOptions { mode: Some(mode), ..AS_DRAWN }));
            for drawn in modes {
                // Not every scene has this many modes.
                let Ok(figured) = Figured::of(&name, &text, FigureOptions { values, ..drawn }) else { continue };
                let over = crowded(&figured.figure);
                assert!(over.is_empty(), "{name}, {drawn:?}, values {values}: {}", over.join("\n"));
                let left_out = figured.figure.notes.iter().any(|note| note.text.contains("left out"));
                assert!(!left_out, "{name}, {drawn:?}: every name has a place");
            }
        }
    }
}

/// The models of `tests/diagnostics` exist for their findings; those that have a scene nevertheless are drawn.
#[test]
fn scenes_of_diagnostics_are_drawn_where_there_is_one() {
    let mut drawn = 0;
    for (name, text) in models("tests/diagnostics") {
        let Ok(figured) = Figured::of(&name, &text, AS_DRAWN) else { continue };
        let over = crowded(&figured.figure);
        assert!(over.is_empty(), "{name}: {}", over.join("\n"));
        drawn += 1;
    }
    assert!(drawn > 30, "{drawn}");
}

#[test]
fn generated_scenes_have_room_for_names() {
    let (mut names, mut left_out) = (0, 0);
    for seed in 0..500 {
        let text = generated::scene(seed);
        let figured =
            Figured::of("generated.vib", &text, AS_DRAWN).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}"));
        let over = crowded(&figured.figure);
        assert!(over.is_empty(), "seed {seed}: {}\n{text}", over.join("\n"));
        names += figured.figure.labels.len();
        let note = figured.figure.notes.iter().find_map(|note| note.text.split("left out: ").nth(1));
        left_out += note.map_or(0, |count| count.parse::<usize>().expect("a number"));
    }
    assert!(names > 5_000, "{names}");
    assert!(left_out * 200 < names, "{left_out} of {names} names found no room");
}

#[test]
fn every_kind_has_its_glyph() {
    let mut seen = BTreeSet::new();
    for (name, text) in models("examples").into_iter().chain(models("tests/drawings")) {
        let figured = Figured::of(&name, &text, AS_DRAWN).unwrap_or_else(|error| panic!("{name}: {error}"));
        seen.extend(figured.figure.glyphs.iter().map(|glyph| glyph.kind));
    }
    let all = [
        Kind::Rod,
        Kind::Disk,
        Kind::Ring,
        Kind::Box,
        Kind::Block,
        Kind::Point,
        Kind::Base,
        Kind::Ground,
        Kind::Spring,
        Kind::Damper,
        Kind::TorsionSpring,
        Kind::TorsionDamper,
        Kind::Belt,
        Kind::Pivot,
        Kind::Slide,
        Kind::Weld,
        Kind::Couple,
        Kind::Gear,
        Kind::Force,
        Kind::Torque,
        Kind::Unbalance,
        Kind::Output,
        Kind::Initial,
        Kind::Gravity,
        Kind::ScaleBar,
    ];
    let missing: Vec<Kind> = all.into_iter().filter(|kind| !seen.contains(kind)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// Centre of the first circle of a glyph.
fn circle(glyph: &Glyph) -> Point {
    let found = glyph.strokes.iter().find_map(|stroke| match stroke {
        Stroke::Circle { centre, .. } => Some(*centre),
        Stroke::Line { .. } => None,
    });
    found.expect("a circle")
}

#[test]
fn coordinates_are_to_scale() {
    let figured = Figured::of("m.vib", &example("double_pendulum.vib"), AS_DRAWN).expect("a figure");
    let bar = figured.named(Kind::ScaleBar, "scale: 200 mm").bounds().width();
    let [p, q] = ["pivot p", "pivot q"].map(|name| circle(figured.named(Kind::Pivot, name)));
    // O to A is one metre, 60 degrees from the vertical.
    assert!((p.distance(q) / bar - 5.0).abs() < 1e-9);
    assert!(((q.x - p.x) / bar - 5.0 * 0.75f64.sqrt()).abs() < 1e-9 && ((q.y - p.y) / bar - 2.5).abs() < 1e-9);
}

#[test]
fn a_pendulum_at_rest_hangs_down() {
    let figured = Figured::of("m.vib", &example("double_pendulum.vib"), FigureOptions { rest: true, ..AS_DRAWN })
        .expect("a figure");
    let [p, q] = ["pivot p", "pivot q"].map(|name| circle(figured.named(Kind::Pivot, name)));
    let bobs: Vec<Point> = figured.of_kind(Kind::Point).map(circle).collect();
    assert!((p.x - q.x).abs() < 1e-6 && bobs.iter().all(|bob| (bob.x - p.x).abs() < 1e-6), "all below each other");
    assert!(q.y > p.y && bobs.iter().all(|bob| bob.y > p.y), "below the ceiling");
}

/// The end of a rod that is further from a point.
fn far_end(rod: &Glyph, from: Point) -> Point {
    let Stroke::Line { points, .. } = &rod.strokes[0] else { panic!("a bar") };
    let far = points.iter().max_by(|a, b| a.distance(from).total_cmp(&b.distance(from)));
    *far.expect("points")
}

#[test]
fn a_mode_is_drawn_in_its_proportions() {
    let text = example("cart.vib");
    let figured = Figured::of("m.vib", &text, FigureOptions { mode: Some(2), ..AS_DRAWN }).expect("a figure");
    let still = Figured::of("m.vib", &text, FigureOptions { rest: true, ..AS_DRAWN }).expect("a figure");
    // Both frames are positioned by their content: measure from the spring's wall.
    let place = |figured: &Figured| {
        let wall = figured.of_kind(Kind::Ground).next().expect("a wall").bounds().high.x;
        let pivot = circle(figured.named(Kind::Pivot, "pivot p"));
        let rod = far_end(figured.named(Kind::Rod, "body rod"), pivot);
        let bar = figured.of_kind(Kind::ScaleBar).next().expect("a scale").bounds().width() * 2.0;
        ((pivot.x - wall) / bar, (rod.x - pivot.x) / bar, (rod.y - pivot.y) / bar)
    };
    let (moved, rest) = (place(&figured), place(&still));
    let x = moved.0 - rest.0;
    // Counter-clockwise rotation moves the end of a hanging rod to the right. The cap of the bar is round: its farthest
    // point turns with it.
    let angle = (moved.1 / moved.2).atan() - (rest.1 / rest.2).atan();
    // theta / x of the second mode, worked out by hand in examples/cart.vib.
    assert!((angle / x - -1.5756).abs() < 0.02, "{} for -1.5756", angle / x);
    let note = figured.figure.notes.iter().find(|note| note.text.contains("magnified")).expect("a magnification");
    let times: f64 = note.text.split_whitespace().find_map(|word| word.parse().ok()).expect("a number");
    assert!((x / times - 1.0).abs() < 0.01, "the largest translation is 1 in the shape, {x} in the figure, {times}");
}

#[test]
fn rows_run_along_the_motion_from_the_ground() {
    let figured = Figured::of("m.vib", &example("shear_building.vib"), AS_DRAWN).expect("a figure");
    let floors: Vec<Point> = figured.of_kind(Kind::Block).map(|glyph| glyph.bounds().centre()).collect();
    assert!(floors.windows(2).all(|pair| pair[0].x < pair[1].x && (pair[0].y - pair[1].y).abs() < 1e-9));
    let figured = Figured::of("m.vib", &example("quarter_car.vib"), AS_DRAWN).expect("a figure");
    let [chassis, wheel] =
        ["body chassis", "body wheel"].map(|name| figured.named(Kind::Block, name).bounds().centre());
    let method = figured.of_kind(Kind::Base).next().expect("a base").bounds().centre();
    assert!(chassis.y < wheel.y && wheel.y < method.y, "the road is below the wheel, the wheel below the chassis");
    // Spring and damper in parallel.
    let [spring, damper] = [
        figured.named(Kind::Spring, "spring suspension").bounds(),
        figured.named(Kind::Damper, "damper shock").bounds(),
    ];
    assert!(!spring.overlaps(&damper) && (spring.low.y - damper.low.y).abs() < 1.0);
}

#[test]
fn a_spring_and_dashpot_in_series_is_drawn_beside_the_spring() {
    let figured = Figured::of("m.vib", &drawing("maxwell_mount.vib"), AS_DRAWN).expect("a figure");
    let [k, k1] = ["spring k:", "spring k1:"].map(|name| figured.named(Kind::Spring, name).bounds());
    let c1 = figured.named(Kind::Damper, "damper c1").bounds();
    let joint = figured.of_kind(Kind::Point).next().expect("the massless point").bounds().centre();
    assert!((k.height() - k1.height() - c1.height()).abs() < 1.0, "as long together as the spring alone");
    assert!((joint.y - k1.low.y).abs() < 1.0 && (joint.y - c1.high.y).abs() < 1.0, "the point is between the two");
}

#[test]
fn long_rows_turn() {
    let figured = Figured::of("m.vib", &example("long_chain.vib"), AS_DRAWN).expect("a figure");
    let (width, height) = (figured.figure.width, figured.figure.height);
    assert!(width < 4.0 * height && height < 4.0 * width, "{width} by {height}");
}

#[test]
fn glyphs_name_the_line_that_made_them() {
    for (name, text) in models("examples") {
        let figured = Figured::of(&name, &text, AS_DRAWN).expect("a figure");
        let svg = figured.svg();
        let lines: Vec<&str> = text.lines().collect();
        let mut seen = 0;
        for glyph in svg.split("<g class=\"glyph ").skip(1) {
            let Some((head, rest)) = glyph.split_once("><title>") else {
                panic!("{name}: a glyph without a title: {glyph}")
            };
            let title = rest.split("</title>").next().expect("a title");
            let Some(line) = head.split("data-line=\"").nth(1) else { continue };
            let line: usize = line.trim_end_matches('"').parse().expect("a line");
            // `spring s: ...` was declared on the given line. A leader has only the name.
            let Some((word, of)) = title.split_once([' ', ',']) else { continue };
            let of: String = of.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            if ["spring", "damper", "body", "pivot", "base", "force", "torque", "coupling"].contains(&word) {
                assert!(lines[line - 1].contains(&of), "{name}: {title} is not on line {line}: {}", lines[line - 1]);
                seen += 1;
            }
        }
        assert!(seen >= 2, "{name}");
    }
}

/// What joints and rails exert has an arrow in its positive direction or turn; what a coupling exerts has no place.
#[test]
fn reactions_have_arrows() {
    let figured = Figured::of("slider_crank.vib", &example("slider_crank.vib"), AS_DRAWN).expect("a figure");
    let titles =
        |figured: &Figured| figured.of_kind(Kind::Output).map(|glyph| glyph.title.clone()).collect::<BTreeSet<_>>();
    let wanted = ["angle", "bearing_x", "bearing_y", "side", "wrist_x"].map(|name| format!("output {name}"));
    assert_eq!(titles(&figured), BTreeSet::from(wanted));
    let model = "body block { mass = 1 kg, moves x, at = (0, 0) }\nspring s: ground@(-1 m, 0) -- block { k = 10 N/m }\n\
                 body a { mass = 1 kg, inertia = 1 kg*m^2, turns, at = (0, 3 m) }\nbody b { mass = 1 kg, inertia = 1 kg*m^2, turns, at = (2 m, 3 m) }\n\
                 couple g: 2 * a.angle = b.angle\noutput rails = block.support_y\noutput guide = block.support_moment\noutput teeth = g.force\n";
    let figured = Figured::of("rails.vib", model, AS_DRAWN).expect("a figure");
    assert_eq!(titles(&figured), BTreeSet::from(["guide", "rails"].map(|name| format!("output {name}"))));
}

/// Checks that elements are closed in their order, and that text contains no markup.
fn well_formed(svg: &str) -> Result<(), String> {
    let mut open: Vec<&str> = Vec::new();
    for piece in svg.split('<').skip(1) {
        let (tag, text) = piece.split_once('>').ok_or("a tag without an end")?;
        let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap_or("");
        match (tag.starts_with('/'), tag.ends_with('/')) {
            (true, _) if open.pop() == Some(name) => {}
            (true, _) => return Err(format!("</{name}> closes nothing")),
            (false, true) => {}
            (false, false) => open.push(name),
        }
        if tag.matches('"').count() % 2 == 1 || text.contains(|c: char| c.is_control() && c != '\n') {
            return Err(format!("<{tag}>{text}"));
        }
    }
    if open.is_empty() { Ok(()) } else { Err(format!("{open:?} are open")) }
}

#[test]
fn files_are_well_formed_and_the_same_every_time() {
    for (name, text) in models("examples").into_iter().chain(models("tests/drawings")) {
        let draw = || Figured::of(&name, &text, FigureOptions { values: true, ..AS_DRAWN }).expect("a figure").svg();
        let svg = draw();
        well_formed(&svg).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(svg, draw(), "{name}");
    }
}

#[test]
fn hostile_names_are_text() {
    let name = "</title><script>alert('1')<\u{1b}[31m\u{202e}&.vib";
    let figured = Figured::of(name, "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 1 N/m }", AS_DRAWN);
    let svg = figured.expect("a figure").svg();
    well_formed(&svg).expect("no markup of a name");
    assert!(!svg.contains("<script") && svg.contains("&lt;script&gt;"), "{svg}");
    assert!(!svg.contains('\u{1b}') && !svg.contains('\u{202e}'));
}

#[test]
fn large_scenes_thin_out() {
    let chain = |n: usize| {
        format!(
            "body m[1] {{ mass = 1 kg, moves x }}\nspring k[1]: ground -- m[1] {{ k = 1 N/m }}\nrepeat i in 2..{n} {{\n\
             body m[i] {{ mass = 1 kg, moves x }}\nspring k[i]: m[i-1] -- m[i] {{ k = 1 N/m }}\n}}\n"
        )
    };
    let figured = |n: usize| Figured::of("chain.vib", &chain(n), AS_DRAWN).expect("a figure");
    assert_eq!(figured(500).figure.labels.len(), 1000, "all have names");
    let unnamed = figured(2_000);
    assert!(unnamed.figure.labels.is_empty() && unnamed.figure.notes[0].text.contains("names are left out"));
    assert_eq!(unnamed.of_kind(Kind::Spring).count(), 2_000);
    let bare = figured(50_000);
    assert_eq!(bare.figure.notes[0].text, "100000 parts: bodies are squares, springs and dampers lines, without names");
    let bytes = bare.svg().len();
    assert!(bytes < 4_000_000, "{bytes} bytes");
    let strokes = |kind| bare.of_kind(kind).map(|glyph| glyph.strokes.len()).sum::<usize>();
    assert_eq!((strokes(Kind::Block), strokes(Kind::Spring)), (50_000, 50_000), "nothing is left out but names");
}

#[test]
fn what_cannot_be_drawn_is_reported() {
    let refusal = |text: &str, drawn| Figured::of("m.vib", text, drawn).err().expect("no figure");
    let cart = example("cart.vib");
    assert_eq!(refusal(&cart, FigureOptions { mode: Some(3), ..AS_DRAWN }), "the model has no mode 3; it has 2");
    let far = "body b { mass = 1 kg, at = (1e200 m, 0), moves x }\nspring s: ground@(0, 0) -- b { k = 1 N/m }";
    assert_eq!(refusal(far, AS_DRAWN), "a coordinate of `b` is too large to be drawn");
}

/// The figures of the documents are what the program draws now: runs the commands of `docs/figures/make`, one after the
/// other.
#[test]
fn figures_of_the_documents_are_fresh() {
    let script = fs::read_to_string(folder("docs/figures/make")).expect("the script");
    let folder_of_new = tempfile::tempdir().expect("a temporary folder");
    let mut compared = 0;
    for line in script.lines().filter_map(|line| line.strip_prefix("\"$vibc\" ")) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let (old, options) = words.split_last().expect("a command");
        let new = folder_of_new.path().join("new.svg");
        let run = std::process::Command::new(env!("CARGO_BIN_EXE_vibc"))
            .args(options)
            .arg(&new)
            .current_dir(folder("."))
            .output()
            .expect("the program starts");
        assert!(run.status.success(), "{line}");
        let [old_text, new_text] = [folder(old), new].map(|file| fs::read_to_string(file).expect("a figure"));
        assert_eq!(old_text, new_text, "{old} is stale: run docs/figures/make");
        compared += 1;
    }
    assert!(compared >= 4);
    let readme = fs::read_to_string(folder("README.md")).expect("README.md");
    assert!(readme.contains("docs/figures/cart.svg"));
}

/// Parts without coordinates form a separate figure if other parts have coordinates: those that move along y are in a
/// column, its elements run along y, and nothing covers a body.
#[test]
fn parts_without_coordinates_beside_others_are_laid_out() {
    for (name, column, elements) in [
        ("raft.vib", &["deck", "raft", "pump"][..], &["mounts", "lining", "feet", "pads"][..]),
        ("crane.vib", &["deck", "raft", "pump"], &["mounts", "feet", "pads"]),
    ] {
        let figured = Figured::of(name, &drawing(name), AS_DRAWN).expect("a figure");
        let body = |part: &str| {
            let glyphs = || figured.figure.glyphs.iter().filter(|g| matches!(g.kind, Kind::Block | Kind::Base));
            let found = glyphs().find(|glyph| glyph.title.contains(&format!(" {part}")));
            found.unwrap_or_else(|| panic!("{name}: {part}")).bounds()
        };
        for pair in column.windows(2) {
            let (lower, upper) = (body(pair[0]), body(pair[1]));
            assert!(lower.low.y > upper.high.y + 30.0, "{name}: {} stands below {}", pair[0], pair[1]);
            assert!((lower.centre().x - upper.centre().x).abs() < 1.0, "{name}: {pair:?} stand in a column");
        }
        for element in elements {
            let glyphs = figured.figure.glyphs.iter();
            let mut ties = glyphs.filter(|glyph| matches!(glyph.kind, Kind::Spring | Kind::Damper));
            let found = ties.find(|glyph| glyph.title.contains(&format!(" {element}"))).expect("an element");
            let bounds = found.bounds();
            assert!(bounds.height() > 2.0 * bounds.width(), "{name}: {element} runs along y: {bounds:?}");
            for part in column {
                assert!(!body(part).grow(-4.0).overlaps(&bounds), "{name}: {element} lies over {part}");
            }
        }
        // The column covers nothing that has coordinates.
        let lever = figured.of_kind(Kind::Rod).next().expect("a rod").bounds();
        assert!(!lever.overlaps(&body("raft")) && !lever.overlaps(&body("deck")), "{name}");
    }
}

/// A slider-crank: the piston is at x = r cos a + sqrt(l^2 - r^2 sin^2 a) and the rod turns by -asin(r/l sin a) for the crank's angle a.
/// What the figure moves agrees with the first and second derivatives, whichever coordinate is the independent one.
#[test]
fn loops_stay_together_to_second_order() {
    use vibc::model::scene::{BodyId, Part};
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::model("m.vib", drawing("engine.vib")));
    let tree = vibc::syntax::parse(&sources, model).tree;
    let checked = vibc::model::check(&sources, &tree, &Overrides::default()).scene.expect("a sound model");
    let lowered = vibc::lower::lower(&checked).lowered.expect("a sound scene");
    let at_rest = lowered.mechanism.poses();
    let poses = at_rest.displace(&lowered.mechanism.displacements(&at_rest, &[1.0]));
    let piece = |body: u32| &poses.pieces[poses.piece(Part::Body(BodyId(body)))];
    let (crank, rod, piston) = (&piece(0).angle, &piece(1).angle, &piece(2).slides[0].1);
    let (r, l) = (0.5f64, 0.65f64.sqrt());
    // From the drawing, in which the crank points to (0.3, 0.4), to the rest.
    let a = 0.4f64.atan2(0.3) + crank.rest;
    let (s, c, root) = (a.sin(), a.cos(), (l * l - r * r * a.sin() * a.sin()).sqrt());
    let x1 = -r * s - r * r * s * c / root;
    let x2 = -r * c - r * r * (c * c - s * s) / root - (r * r * s * c).powi(2) / root.powi(3);
    let rod1 = -r * c / root;
    let rod2 = r * s / root - r * c * r * r * s * c / root.powi(3);
    for (of, first, second) in [(piston, x1, x2), (rod, rod1, rod2)] {
        assert!((of.shape - first * crank.shape).abs() < 1e-12, "{of:?}: {first}");
        let bend = first * crank.bend + second * crank.shape * crank.shape / 2.0;
        assert!((of.bend - bend).abs() < 1e-12, "{of:?}: {bend}");
    }
    assert!(piston.bend.abs() + rod.bend.abs() + crank.bend.abs() > 0.1, "something bends");
}

/// The force in an element is an arrow next to it.
#[test]
fn the_force_in_an_element_is_drawn_beside_it() {
    let figured = Figured::of("m.vib", &example("inerter_table.vib"), AS_DRAWN).expect("a figure");
    let inerter = figured.named(Kind::Inerter, "inerter b").bounds();
    let push = figured.named(Kind::Output, "output push").bounds();
    let apart = (push.low.x - inerter.high.x).max(inerter.low.x - push.high.x);
    assert!(0.0 < apart && apart < 12.0, "{push:?} beside {inerter:?}");
    assert!(inerter.low.y < push.low.y && push.high.y < inerter.high.y, "{push:?} beside {inerter:?}");
}
