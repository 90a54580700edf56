//! `vibc equations`: what it prints beside what a textbook prints.

use std::path::Path;
use vibc::backend::equations;
use vibc::base::{SourceFile, Sources};
use vibc::model::Overrides;

/// The equations of a model as text; its messages where there are none.
fn text_of(name: &str, model: &str) -> String {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model(name, model));
    let outcome = vibc::equations(&sources, file, &Overrides::default());
    match outcome.answer {
        Some(answer) => equations::text(&equations::document(&answer)),
        None => outcome.diagnostics.iter().map(|d| format!("{}: {}\n", d.code.0, d.message)).collect(),
    }
}

fn example(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name);
    text_of(name, &std::fs::read_to_string(path).expect("an example"))
}

/// Whether a line of the text is this formula, blanks at its ends aside.
fn says(text: &str, line: &str) -> bool {
    text.lines().any(|found| found.trim() == line)
}

/// The course's solution: (m1 + m2) x" + m2 L/2 (theta" cos theta - theta'^2 sin theta) + b x' + k x = F and
/// m2 L^2/3 theta" + m2 L/2 x" cos theta + m2 g L/2 sin theta = 0, and both linearised.
#[test]
fn the_cart_has_the_equations_of_the_course() {
    let text = example("cart.vib");
    for line in [
        "T = 1/2 (m1 + m2) x'^2 + 1/2 m2 L cos(theta) x' theta' + 1/6 m2 L^2 theta'^2",
        "V = 1/2 k x^2 - 1/2 m2 g L cos(theta)",
        "D = 1/2 b x'^2",
        "Q_x = F",
        "(m1 + m2) x'' + m2 L/2 cos(theta) theta'' - m2 L/2 sin(theta) theta'^2 + b x' + k x = F",
        "m2 L/2 cos(theta) x'' + m2 L^2/3 theta'' + m2 g L/2 sin(theta) = 0",
        "(m1 + m2) x'' + m2 L/2 theta'' + b x' + k x = F",
        "m2 L/2 x'' + m2 L^2/3 theta'' + m2 g L/2 theta = 0",
    ] {
        assert!(says(&text, line), "{line} is not in\n{text}");
    }
}
