//! Reports as values: text that fits its width, Markdown that a parser reads back, and the same numbers in every
//! layout.

use pulldown_cmark::{Event, Options as Extensions, Parser, Tag, TagEnd};
use vibc::analysis::{self, Extrema, Methods, Sweep};
use vibc::answers::ModalAnswer;
use vibc::answers::report::{self, Block, Figure, Line, Part, Report, Table, Value};
use vibc::backend::{ReportOptions, json, markdown, report as text};
use vibc::base::{SourceFile, Sources};
use vibc::model::Overrides;

/// Carts in a row, damped at one end, with names of some length.
fn row_of_carts(count: usize) -> String {
    format!(
        "body car[1] {{ mass = 1 kg, moves x }}\nspring s[1]: ground -- car[1] {{ k = 1 kN/m }}\n\
         damper d[1]: ground -- car[1] {{ c = 3 N*s/m }}\nrepeat i in 2..{count} {{\nbody car[i] {{ mass = 1.5 kg, moves x }}\n\
         spring s[i]: car[i-1] -- car[i] {{ k = 170 MN/m }}\n}}\nforce F: car[1] along x\noutput last = car[{count}].x\n\
         require frequency(1) > 0.1 Hz\nrequire damping(1) > 0.0001\n"
    )
}

fn examples() -> Vec<(String, String)> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut files: Vec<_> =
        std::fs::read_dir(folder).expect("examples").map(|entry| entry.expect("a file").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "vib"));
    files.sort();
    let read =
        |path: &std::path::PathBuf| (path.display().to_string(), std::fs::read_to_string(path).expect("a model"));
    files.iter().map(read).collect()
}

fn answer(name: &str, model: &str) -> ModalAnswer {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model(name, model));
    crate::examples::add_used_files(&mut sources, file);
    let outcome = vibc::analyze(&sources, file, &Overrides::default());
    outcome.answer.unwrap_or_else(|| panic!("{name}: {:?}", outcome.diagnostics))
}

fn widest(text: &str) -> usize {
    text.lines().map(|line| line.chars().count()).max().unwrap_or(0)
}

#[test]
fn reports_of_up_to_ten_degrees_of_freedom_fit_their_columns() {
    let rows = (1..=10).map(|count| (format!("row_{count}.vib"), row_of_carts(count.max(2))));
    let hanging = "gravity 9.81 m/s^2\nbody rod[1] { mass = 1 kg, shape = rod((0, 0), (0, -1 m)) }\npivot p[1]: ground@(0, 0) -- rod[1]\n\
                   repeat i in 2..6 {\nbody rod[i] { mass = 1 kg, shape = rod((0, (1 - i) * 1 m), (0, -i * 1 m)) }\n\
                   pivot p[i]: rod[i-1]@(0, (1 - i) * 1 m) -- rod[i]\n}\ndamper d: rod[1] -- rod[2] { c = 1 N*m*s/rad }\n";
    for (name, model) in rows.chain(examples()).chain([("hanging.vib".to_string(), hanging.to_string())]) {
        let answer = answer(&name, &model);
        if answer.system.n() > 10 {
            continue;
        }
        for digits in [None, Some(12), Some(30)] {
            for matrices in [false, true] {
                let options = ReportOptions { digits, matrices, ..ReportOptions::default() };
                let report = report::modal(&answer, &options);
                for width in [80, 100, 132] {
                    let text = text::laid_out(&report, width);
                    assert!(widest(&text) <= width, "{name}: {} columns of {width}:\n{text}", widest(&text));
                }
            }
        }
    }
}

/// What the program prints for each example of that size, by every command that prints a report.
#[test]
fn other_reports_of_up_to_ten_degrees_of_freedom_fit_their_columns() {
    let mut commands: Vec<Vec<&str>> =
        ["transfer", "check", "equations"].map(|command| command.split(' ').collect()).to_vec();
    commands.push("simulate --format text --until 100ms --step 10ms".split(' ').collect());
    let mut small = 0;
    for (path, model) in examples() {
        let mut sources = Sources::new();
        let file = sources.add(SourceFile::model(&path, &model));
        crate::examples::add_used_files(&mut sources, file);
        // A model with loss factors has harmonic motions only.
        let Some((name, system)) = vibc::linear(&sources, file, &Overrides::default()).answer else {
            fits(&["transfer"], &path, 80);
            continue;
        };
        if system.n() > 10 {
            continue;
        }
        small += 1;
        for command in &commands {
            fits(command, &path, 80);
        }
        match &name[..] {
            "cart" => {
                fits(&["bench"], &path, 80);
                fits(&["sweep", "--over", "b=1N*s/m..9N*s/m:3", "--modes", "2"], &path, 80);
            }
            "drop_test" => fits(
                &"shock --from table --damping 5% --range 5Hz..100Hz --format text".split(' ').collect::<Vec<_>>(),
                &path,
                80,
            ),
            _ => {}
        }
    }
    assert!(small > 25, "{small} examples");
}

/// The command's report about a model has this width at most.
fn fits(command: &[&str], model: &str, width: usize) {
    let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_vibc"));
    let printed = program.args(command).args([model, "--quiet", "--width", &width.to_string()]).output();
    let printed = printed.expect("the program starts");
    // A model without inputs or outputs has no such report.
    if printed.status.code() == Some(2) {
        let reason = String::from_utf8_lossy(&printed.stderr);
        assert!(reason.contains("the model declares no"), "{command:?} {model}: {reason}");
        return;
    }
    let text = String::from_utf8(printed.stdout).expect("text");
    assert!(widest(&text) <= width, "{command:?} {model}: {} columns of {width}:\n{text}", widest(&text));
}

/// Every number of a wide report is in a narrow one.
#[test]
fn a_narrow_report_loses_no_number() {
    let answer = answer("row_10.vib", &row_of_carts(10));
    let report = report::modal(&answer, &ReportOptions::default());
    let narrow = text::laid_out(&report, 60);
    let poles = tables(&report).find(|table| plain(&table.columns[0].title) == "pole").expect("a table of poles");
    for cell in poles.rows.iter().flatten() {
        let shown = plain(&cell.longest());
        assert!(narrow.contains(&shown), "{shown} is missing:\n{narrow}");
    }
}

fn transfer_of(name: &str, model: &str, spoil: impl Fn(&mut Extrema)) -> Vec<Report> {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model(name, model));
    crate::examples::add_used_files(&mut sources, file);
    let dynamics = vibc::dynamics(&sources, file, &Overrides::default()).answer.expect("a model");
    let modes = dynamics.modes.clone().expect("modes");
    let sweep = Sweep { inputs: vec![0], outputs: vec![0], ..Sweep::default() };
    let poles = dynamics.poles_for(&sweep).expect("no error").expect("poles");
    let mut table = analysis::table(&Methods::of(&dynamics.system, &modes), &poles, &sweep).expect("a small table");
    table.extrema.iter_mut().flatten().flatten().for_each(spoil);
    report::transfer(&dynamics.model, &dynamics.system, &table)
}

#[test]
fn transfer_reports_fit_with_several_parts_unproved() {
    let spoil = |extrema: &mut Extrema| {
        extrema.complete = None;
        extrema.open =
            vec![(1.234567891, 1.234567892), (12.34567891, 12.34567892), (123.4567, 123.4568), (200.0, 201.0)];
    };
    let reports = transfer_of("row_of_carts_with_a_long_name.vib", &row_of_carts(10), spoil);
    for width in [60, 80] {
        let text = text::all_laid_out(&reports, width);
        assert!(widest(&text) <= width, "{text}");
        for part in ["not proved", "1.23457 Hz", "12.3457 Hz", "123.457 Hz", "1 more intervals"] {
            let unbroken = text.replace("\n       ", " ");
            assert!(unbroken.contains(part), "{part} is missing:\n{text}");
        }
    }
}

/// A chain of 2000 masses: no share is reported as `0 %`, and no list of ten bodies as all that move.
#[test]
fn modes_of_large_scenes_say_how_thinly_their_energy_is_spread() {
    let model = "body m[1] { mass = 1 kg, moves x }\nspring k[1]: ground -- m[1] { k = 1 kN/m }\nrepeat i in 2..2000 {\n\
                 body m[i] { mass = 1 kg, moves x }\nspring k[i]: m[i-1] -- m[i] { k = 1 kN/m }\n}\n";
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("chain.vib", model));
    let request = analysis::Request { which: analysis::Which::Lowest(3), ..analysis::Request::default() };
    let answer = vibc::analyze_as(&sources, file, &Overrides::default(), &request).answer.expect("a chain");
    let text = text::text(&answer, &ReportOptions::default());
    // The lowest mode of a uniform chain is a quarter of a sine: its largest share is 2 / 2000 of the whole.
    assert!(text.contains("spread over many, at most 0.1 % (m[2000])"), "{text}");
    assert!(!text.contains(" 0 %") && !text.contains("over 10"), "{text}");
}

#[test]
fn one_more_is_named_and_not_counted() {
    let model = "repeat i in 1..3 {\nbody car[i] { mass = 1 kg, moves x }\n}\nspring a: car[1] -- car[2] { k = 1 N/m }\n\
                 spring b: car[2] -- car[3] { k = 1 N/m }\n";
    for width in [60, 80, 100] {
        let report = report::modal(&answer("three.vib", model), &ReportOptions::default());
        let text = text::laid_out(&report, width);
        assert!(text.contains("car[1] 33 %, car[2] 33 %, car[3] 33 %") || width == 60, "{text}");
        assert!(!text.contains("1 more"), "{text}");
    }
}

fn tables(report: &Report) -> impl Iterator<Item = &Table> {
    let blocks = report.sections.iter().flat_map(|section| &section.blocks);
    blocks.filter_map(|block| match block {
        Block::Table(table) => Some(table),
        _ => None,
    })
}

/// A line as plain text.
fn plain(line: &Line) -> String {
    let title = Report { title: line.clone(), sections: Vec::new() };
    text::laid_out(&title, usize::MAX).trim_end().to_string()
}

/// The tables of a Markdown text as read by a parser, with the text of each cell; and everything else that it found.
#[derive(Default)]
struct Read {
    tables: Vec<Vec<Vec<String>>>,
    headings: Vec<String>,
    /// Links, images and HTML, of which there must be none.
    active: Vec<String>,
}

fn read(markdown: &str) -> Read {
    let mut read = Read::default();
    let mut text = String::new();
    for event in Parser::new_ext(markdown, Extensions::ENABLE_TABLES | Extensions::ENABLE_STRIKETHROUGH) {
        match event {
            Event::Start(Tag::Table(_)) => read.tables.push(Vec::new()),
            Event::Start(Tag::TableHead | Tag::TableRow) => read.tables.last_mut().expect("a table").push(Vec::new()),
            Event::Start(Tag::TableCell | Tag::Heading { .. }) => text.clear(),
            Event::End(TagEnd::TableCell) => {
                let row = read.tables.last_mut().and_then(|table| table.last_mut()).expect("a row");
                row.push(text.trim().to_string());
            }
            Event::End(TagEnd::Heading(_)) => read.headings.push(text.clone()),
            Event::Text(words) => text += &words,
            Event::Start(Tag::Link { .. } | Tag::Image { .. } | Tag::Emphasis | Tag::Strong | Tag::Strikethrough)
            | Event::Html(_)
            | Event::InlineHtml(_)
            | Event::Code(_)
            | Event::Rule => read.active.push(format!("{event:?}")),
            _ => {}
        }
    }
    read
}

/// Asserts that a parser finds the report's headings and tables, cell by cell, and nothing else.
fn assert_read_back(name: &str, report: &Report) {
    let markdown = markdown::markdown(report);
    let read = read(&markdown);
    assert_eq!(read.active, Vec::<String>::new(), "{name}:\n{markdown}");
    let headings: Vec<String> = report.sections.iter().map(|section| section.heading.to_string()).collect();
    assert_eq!(read.headings[0], plain(&report.title), "{name}");
    assert_eq!(read.headings[1..], headings, "{name}");
    let expected: Vec<Vec<Vec<String>>> = tables(report)
        .map(|table| {
            let titles = table.columns.iter().map(|column| format!("{} {}", plain(&column.title), column.unit));
            let rows = table.rows.iter().map(|row| row.iter().map(|cell| plain(&cell.longest())).collect());
            [titles.map(|title| title.trim().to_string()).collect()].into_iter().chain(rows).collect()
        })
        .collect();
    assert_eq!(read.tables, expected, "{name}:\n{markdown}");
}

#[test]
fn markdown_reads_back_as_the_report() {
    for (name, model) in examples().into_iter().chain([("row.vib".to_string(), row_of_carts(4))]) {
        assert_read_back(&name, &report::modal(&answer(&name, &model), &ReportOptions::default()));
    }
    for report in transfer_of("row.vib", &row_of_carts(3), |_| {}) {
        assert_read_back("transfer", &report);
    }
}

#[test]
fn hostile_names_are_harmless_in_markdown() {
    let names = [
        "<script>alert(1)</script>",
        "[x](javascript:alert(1))",
        "![x](http://example.org/a.png)",
        "a | b | c",
        "`code` *b* **c** __d__ ~~e~~",
        "www.example.org",
        "&lt;b&gt; &#60;",
        "# heading",
        "- item",
        "1. item",
        "\u{1b}[31mred\u{202e}",
        "two\n\nlines\n***",
        "back\\slash\\",
    ];
    for name in names {
        let mut answer = answer("row.vib", &row_of_carts(2));
        answer.model = name.to_string();
        answer.requirements[0].text = name.to_string();
        let report = report::modal(&answer, &ReportOptions::default());
        assert_read_back(name, &report);
        let text = markdown::markdown(&report);
        assert!(!text.contains(['\u{1b}', '\u{202e}']), "{text:?}");
    }
}

fn figures(line: &Line) -> impl Iterator<Item = &Figure> {
    line.parts.iter().filter_map(|part| match part {
        Part::Figure(figure) => Some(figure),
        _ => None,
    })
}

/// The frequencies of the report, as binary64, are those of the JSON, and so are their bounds.
#[test]
fn report_and_json_have_the_same_numbers() {
    let answer = answer("row.vib", &row_of_carts(6));
    let report = report::modal(&answer, &ReportOptions::default());
    let object: serde_json::Value =
        serde_json::from_str(&json::json(&answer, &ReportOptions::default())).expect("JSON");
    let modes = tables(&report).find(|table| plain(&table.columns[0].title) == "mode").expect("a table of modes");
    assert_eq!(modes.rows.len(), 6);
    for (row, mode) in modes.rows.iter().zip(object["modes"].as_array().expect("modes")) {
        let number = |at: usize| row[at].longest();
        let rounded = |at: usize| figures(&number(at)).next().and_then(Figure::to_rounded).expect("a number");
        assert_eq!(rounded(1).value(), mode["frequency_hz"].as_f64().expect("a frequency"));
        assert_eq!(rounded(2).value(), mode["omega"].as_f64().expect("an angular frequency"));
        let bound = match figures(&number(4)).next().map(|figure| figure.value.clone()) {
            Some(Value::Bound(bound)) => bound,
            other => panic!("{other:?}"),
        };
        assert_eq!(bound.value(), mode["omega_error_bound"].as_f64().expect("a bound"));
    }
}

/// Names of the report link to their declarations.
#[test]
fn names_keep_their_places() {
    let model = row_of_carts(2);
    let report = report::modal(&answer("row.vib", &model), &ReportOptions::default());
    let lines = report.sections.iter().flat_map(|section| &section.blocks).filter_map(|block| match block {
        Block::Line(line) => Some(line.clone()),
        _ => None,
    });
    let cells = tables(&report).flat_map(|table| table.rows.iter().flatten().map(|cell| cell.longest()));
    let mut seen = Vec::new();
    for part in lines.chain(cells).flat_map(|line| line.parts) {
        let Part::Named(named) = part else { continue };
        let Some(place) = named.place else { continue };
        seen.push((named.text, place.range()));
    }
    let place =
        |name: &str| seen.iter().find(|(text, _)| text == name).map(|(_, place)| place.clone()).expect("a place");
    let body = place("car[1].x");
    assert!(model[..body.start].ends_with("body ") && model[body.start..].starts_with("car[1]"), "{seen:?}");
    let requirement = "frequency(1) > 0.1 Hz";
    assert_eq!(model[place(requirement)], *requirement);
}
