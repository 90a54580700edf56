//! Pictures of `--svg`: titles of axes, ticks at the places of their values, no text over another or outside of the picture, by what
//! the file says.

use crate::program::ran;
use std::fs;
use std::path::Path;

/// A text with its box, px.
#[derive(Debug)]
struct Text {
    words: String,
    class: String,
    low: (f64, f64),
    high: (f64, f64),
    is_turned: bool,
    is_centred: bool,
}

/// Titles of what has no unit.
const RATIOS: [&str; 2] = ["gain", "relative error"];

/// The width of a letter of Verdana and the like in parts of the size: digits have 0.636, and letters of a text less on average.
const LETTER: f64 = 0.64;

fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    let (_, after) = element.split_once(&format!(" {name}=\""))?;
    Some(after.split_once('"')?.0)
}

fn number(element: &str, name: &str) -> Option<f64> {
    attribute(element, name)?.parse().ok()
}

fn texts(svg: &str) -> Vec<Text> {
    let text = |part: &str| {
        let (element, after) = part.split_once('>').expect("an element");
        let words = after.split_once("</text>").expect("its end").0;
        let words = words.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
        let size = number(element, "font-size").unwrap_or(12.0);
        let width = number(element, "textLength").unwrap_or(LETTER * size * words.chars().count() as f64);
        let before = match attribute(element, "text-anchor") {
            Some("middle") => width / 2.0,
            Some("end") => width,
            _ => 0.0,
        };
        let is_centred = attribute(element, "text-anchor") == Some("middle");
        let class = attribute(element, "class").unwrap_or_default().to_string();
        let turned = attribute(element, "transform").map(|transform| {
            let places = transform.strip_prefix("translate(").and_then(|rest| rest.strip_suffix(") rotate(-90)"));
            let (x, y) = places.expect("a title that reads upwards").split_once(' ').expect("two numbers");
            (x.parse::<f64>().expect("a number"), y.parse::<f64>().expect("a number"))
        });
        let (up, down) = (0.75 * size, 0.2 * size);
        let (low, high) = match turned {
            Some((x, y)) => ((x - up, y + before - width), (x + down, y + before)),
            None => {
                let (x, y) = (number(element, "x").expect("x"), number(element, "y").expect("y"));
                ((x - before, y - up), (x - before + width, y + down))
            }
        };
        Text { words, class, low, high, is_turned: turned.is_some(), is_centred }
    };
    svg.split("<text").skip(1).map(text).collect()
}

/// What is wrong with a picture.
fn faults(svg: &str) -> Vec<String> {
    let mut faults = Vec::new();
    let all = texts(svg);
    let (width, height) = (number(svg, "width").expect("a width"), number(svg, "height").expect("a height"));
    for (place, a) in all.iter().enumerate() {
        if a.low.0 < 0.0 || a.low.1 < 0.0 || a.high.0 > width || a.high.1 > height {
            faults.push(format!("`{}` leaves the picture", a.words));
        }
        for b in &all[place + 1..] {
            let apart = a.high.0 <= b.low.0 || b.high.0 <= a.low.0 || a.high.1 <= b.low.1 || b.high.1 <= a.low.1;
            if !apart {
                faults.push(format!("`{}` lies over `{}`", a.words, b.words));
            }
        }
    }
    let panels: Vec<&str> = svg.split("<g class=\"panel\">").skip(1).collect();
    if panels.is_empty() {
        faults.push("no panel".into());
    }
    for panel in panels {
        faults.extend(faults_of_axes(panel));
    }
    faults
}

fn faults_of_axes(panel: &str) -> Vec<String> {
    let mut faults = Vec::new();
    let all = texts(panel);
    // A gain of metres by metres and a relative error are numbers.
    let has_unit = |words: &str| words.contains('[') || RATIOS.contains(&words);
    let title = |is_turned: bool| all.iter().find(|text| text.is_turned == is_turned && has_unit(&text.words));
    for is_turned in [false, true] {
        if title(is_turned).is_none() {
            faults.push(format!("an axis without a title with its unit: {panel:.200}"));
        }
    }
    let (mut across, mut up) = (Vec::new(), Vec::new());
    for tick in all.iter().filter(|text| text.class == "tick") {
        let Ok(value) = tick.words.parse::<f64>() else {
            faults.push(format!("a tick that is no number: {}", tick.words));
            continue;
        };
        let middle = ((tick.low.0 + tick.high.0) / 2.0, (tick.low.1 + tick.high.1) / 2.0);
        // Labels below the frame have their middle at the tick, labels beside it stand at its height.
        if tick.is_centred { across.push((middle.0, value)) } else { up.push((middle.1, value)) }
    }
    for (axis, ticks) in [("x", across), ("y", up)] {
        if ticks.len() < 2 {
            faults.push(format!("the {axis} axis has {} ticks", ticks.len()));
        } else if !is_scale(&ticks, |value| value) && !is_scale(&ticks, f64::log10) {
            faults.push(format!("the ticks of the {axis} axis are on no scale: {ticks:?}"));
        }
    }
    faults
}

/// Whether values grow evenly with their places, to half a pixel.
fn is_scale(ticks: &[(f64, f64)], of: impl Fn(f64) -> f64) -> bool {
    let (first, last) = (ticks[0], ticks[ticks.len() - 1]);
    let slope = (of(last.1) - of(first.1)) / (last.0 - first.0);
    slope.is_finite()
        && slope != 0.0
        && ticks.iter().all(|(place, value)| ((of(*value) - of(first.1)) / slope - (place - first.0)).abs() < 0.5)
}

/// The picture that the program writes.
fn picture(model: &str, arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("m.svg").to_string_lossy().into_owned();
    let output = ran(model, &[arguments, &["--svg", &path]].concat());
    assert!(output.status.success(), "{model}: {}", String::from_utf8_lossy(&output.stderr));
    fs::read_to_string(path).expect("a picture")
}

fn example(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name).with_extension("vib");
    fs::read_to_string(path).expect("an example")
}

/// y = constant.
const STILL: &str = "body b { mass = 2 kg, moves x }\ninitial b { x = AT }\noutput place = b.x\n";

#[test]
fn axes_have_titles_and_ticks_in_their_places() {
    let motion = ["simulate", "--until", "2 s", "--step", "0.02 s"];
    let mut wrong = Vec::new();
    for name in ["cart", "quarter_car", "half_car", "tuned_mass_damper", "shaker_test", "rotor", "drive_line"] {
        wrong.extend(
            faults(&picture(&example(name), &["transfer"])).into_iter().map(|fault| format!("{name}: {fault}")),
        );
    }
    for name in ["cart", "rotor", "stacked_blocks", "mortar", "double_pendulum"] {
        wrong.extend(
            faults(&picture(&example(name), &motion)).into_iter().map(|fault| format!("{name}, in time: {fault}")),
        );
    }
    let oscillator = "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 800 N/m }\ndamper d: ground -- b { c = 3 N*s/m }\n\
                      force F: b along x\noutput x = b.x\n";
    wrong.extend(faults(&picture(oscillator, &["bench"])).into_iter().map(|fault| format!("bench: {fault}")));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// An output that stays where it is: the axis holds it and zero, and its curve is a level line at its value.
#[test]
fn a_constant_output_has_an_axis_around_it() {
    for (at, value) in [("0 m", 0.0), ("2 mm", 0.002), ("-3 km", -3000.0), ("1e-9 m", 1e-9)] {
        let svg = picture(&STILL.replace("AT", at), &["simulate", "--until", "1 s", "--step", "0.1 s"]);
        assert_eq!(faults(&svg), Vec::<String>::new(), "{at}");
        let all = texts(&svg);
        let ticks = all.iter().filter(|text| text.class == "tick" && !text.is_centred);
        let ticks: Vec<(f64, f64)> =
            ticks.map(|tick| ((tick.low.1 + tick.high.1) / 2.0, tick.words.parse().expect("a number"))).collect();
        let (first, last) = (ticks[0], ticks[ticks.len() - 1]);
        let (least, most) = (first.1.min(last.1), first.1.max(last.1));
        let reach = if value == 0.0 { 1.0 } else { f64::abs(value) };
        assert!(
            least <= 0.0 && most >= 0.0 && most - least > 0.6 * reach && most - least < 2.2 * reach,
            "{at}: {ticks:?}"
        );
        let (_, curve) = svg.split_once("<path class=\"curve c0 k0\" d=\"M").expect("a curve");
        let path = curve.split_once('"').expect("its end").0;
        let (_, start) = path.split_once(' ').expect("a place");
        let height: f64 = start[..start.find('h').expect("a level line")].parse().expect("a number");
        // The middle of a label is within a pixel or so of its tick.
        let place = first.0 + (value - first.1) * (last.0 - first.0) / (last.1 - first.1);
        assert!((place - height).abs() < 2.0, "{at}: the curve is at {height}, its value at {place}");
        assert!(!start.contains(['l', 'v']), "{at}: {start}");
    }
}

/// The tests above see what is wrong: ticks moved, a title left out, a label on another.
#[test]
fn faults_in_a_picture_are_seen() {
    let sound = picture(&example("cart"), &["transfer"]);
    assert_eq!(faults(&sound), Vec::<String>::new());
    let moved = sound.replacen("class=\"tick\" x=\"172.1\"", "class=\"tick\" x=\"180.1\"", 1);
    assert!(moved != sound && faults(&moved).iter().any(|fault| fault.contains("no scale")));
    let untitled = sound.replacen("frequency [Hz]", "", 1);
    assert!(untitled != sound && faults(&untitled).iter().any(|fault| fault.contains("without a title")));
    let covered = sound.replacen("class=\"label\" x=\"184.4\" y=\"115.8\"", "class=\"label\" x=\"327\" y=\"124.2\"", 1);
    assert!(covered != sound && faults(&covered).iter().any(|fault| fault.contains("lies over")));
}
