//! Wrong loads, laws, belts and optima: each is one finding at its place. The place stands between « and » in the model.

use vibc::base::{Diagnostic, Severity, SourceFile, SourceKind, Sources};

const TABLES: [(&str, &str); 2] = [("plain.csv", "time,value\n0,0\n1,1\n"), ("shock.csv", "time,acc\n0,0\n1,1\n")];

/// All findings but notes, and the text without the marks.
fn findings(marked: &str) -> (String, Vec<Diagnostic>) {
    let text: String = marked.chars().filter(|c| !"«»".contains(*c)).collect();
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::model("model.vib", text.clone()));
    for name in vibc::table_files(&sources, model) {
        let (_, rows) = TABLES.iter().find(|(known, _)| *known == name).expect("a table");
        sources.add(SourceFile::decode(SourceKind::Table, name, rows.as_bytes().to_vec()));
    }
    let outcome = vibc::check(&sources, model, &Default::default(), None);
    let finding = |found: &Diagnostic| found.severity != Severity::Note;
    (text, outcome.diagnostics.into_iter().filter(finding).collect())
}

pub fn one(marked: &str, code: &str) {
    let (text, list) = findings(marked);
    let [found] = &list[..] else { panic!("{marked}\n{list:?}") };
    assert_eq!(found.code.0, code, "{marked}");
    let start = marked.find('«').expect("a mark");
    let end = marked.find('»').expect("a mark") - '«'.len_utf8();
    assert_eq!(&text[found.primary.span.start()..found.primary.span.end()], &text[start..end], "{marked}");
    assert!(found.help.is_some(), "{marked}: no help");
}

#[test]
fn a_law_is_defined_where_the_rest_needs_it() {
    let hangs = |element: &str| format!("gravity 9.81 m/s^2\nbody b {{ mass = 2 kg, moves y }}\n{element}\n");
    for law in ["10 N * «sqrt(1 - abs(stretch) / 1 cm)»", "«1 N*m / stretch»", "3 N * «asin(stretch / 1 mm)»"] {
        one(&hangs(&format!("spring s: ground -- b {{ law = {law} }}")), "vib::law::undefined");
    }
    let damped = "spring s: ground -- b { k = 10 N/m }\ndamper d: ground -- b { law = 3 N * «sqrt(rate / 1 m/s - 1)» }";
    one(&hangs(damped), "vib::law::undefined");
}

#[test]
fn a_table_says_what_its_numbers_are() {
    let body = "body b { mass = 2 kg, moves x }\nspring s: f -- b { k = 10 N/m }\noutput o = b.x\n";
    one(&format!("base f {{ moves x }} = table(«\"plain.csv\"»)\n{body}"), "vib::table::unit");
    let forced = body.replace("f --", "ground --");
    one(&format!("force F: b along x = table(«\"plain.csv\"»)\n{forced}"), "vib::table::unit");
    // The heading speaks of an acceleration: the place is in the table itself.
    let (_, list) = findings(&format!("base f {{ moves x }} = table(\"shock.csv\")\n{body}"));
    let [found] = &list[..] else { panic!("{list:?}") };
    let span = found.primary.span;
    assert_eq!((found.code.0, &TABLES[1].1[span.start()..span.end()]), ("vib::table::heading", "acc"));
}

#[test]
fn what_redundant_joints_leave_open_has_no_value() {
    let guided = "body block { mass = 1 kg, at = (0, 0) }\nslide left: ground@(-1 m, 0) -- block along x\n\
                  slide right: ground@(1 m, 0) -- block along x\nspring s: ground@(-2 m, 0) -- block { k = 10 N/m }\n";
    one(&format!("{guided}output «bearing» = left.fy\n"), "vib::reaction::undetermined");
    one(&format!("{guided}require «rest(right.fy) < 3 N»\n"), "vib::require::no_value");
}

const ABSORBER: &str = "param k = 4.5 kN/m\nparam c = 40 N*s/m\nbody m { mass = 100 kg, moves x }\n\
                        body a { mass = 5 kg, moves x }\nspring s: ground -- m { k = 98696 N/m }\n\
                        spring l: m -- a { k = k }\ndamper o: m -- a { c = c }\nforce F: m along x\noutput x = m.x\n";

#[test]
fn an_optimum_at_an_end_on_a_plateau_or_in_a_circle_is_found() {
    for (line, code) in [
        ("minimise peak_gain(F -> x) over «c» in 60 N*s/m .. 80 N*s/m", "vib::minimise::end_of_range"),
        ("maximise damping(1) over «c» in 1 N*s/m .. 2 N*s/m", "vib::minimise::end_of_range"),
        ("minimise frequency(1) over «c» in 20 N*s/m .. 80 N*s/m", "vib::minimise::plateau"),
        (
            "solve k in 4 kN/m .. 5 kN/m: damping(1) = 7 %\nminimise peak_gain(F -> x) over «k» in 4 kN/m .. 5 kN/m",
            "vib::minimise::twice",
        ),
        (
            "«minimise gain(F -> x, 5 Hz) over k in 4 kN/m .. 5 kN/m»\n\
             maximise gain(F -> x, 4 Hz) over c in 20 N*s/m .. 80 N*s/m",
            "vib::minimise::circle",
        ),
        ("minimise peak_gain(F -> x) over c in «60 N .. 80 N»", "vib::unit::mismatch"),
        ("minimise peak_gain(F -> x) over c in «60 N» .. 80 N*s/m", "vib::unit::mismatch"),
        ("minimise peak_gain(F -> x, «1 m» .. 3 m) over c in 60 N*s/m .. 80 N*s/m", "vib::unit::mismatch"),
        ("solve c in «2 kg .. 3 kg»: damping(1) = 7 %", "vib::unit::mismatch"),
    ] {
        one(&format!("{ABSORBER}{line}\n"), code);
    }
}

#[test]
fn a_signal_is_not_delayed_from_itself() {
    let body = "body b { mass = 2 kg, moves x }\nspring s: f -- b { k = 10 N/m }\noutput o = b.x\n";
    one(&format!("base f {{ moves x }} = delayed(«f», 1 s)\n{body}"), "vib::signal::cycle");
    let two = "base f { moves x } = delayed(«g», 1 s)\nbase g { moves x } = delayed(f, 1 s)\n";
    one(&format!("{two}{body}spring t: g -- b {{ k = 10 N/m }}\n"), "vib::signal::cycle");
}

#[test]
fn a_belt_runs_round_two_disks() {
    let disk = "body a { mass = 1 kg, at = (0, 0), shape = disk(0.1 m), turns }\n";
    for (other, ends, code) in [
        ("shape = box(0.1 m, 0.1 m)", "a -- «b»", "vib::belt::no_disk"),
        ("shape = rod((1 m, 0), (2 m, 0))", "«b» -- a", "vib::belt::no_disk"),
        ("shape = disk(2 m)", "«a -- b»", "vib::belt::overlap"),
    ] {
        let at = if other.contains("rod") { "" } else { "at = (1 m, 0), " };
        one(&format!("{disk}body b {{ mass = 1 kg, {at}{other}, turns }}\nbelt r: {ends} {{ k = 2 kN/m }}\n"), code);
    }
    one(&format!("{disk}belt r: a -- «ground» {{ k = 2 kN/m }}\n"), "vib::belt::no_disk");
}

#[test]
fn a_period_fits_its_rows() {
    let force = |signal: &str| {
        format!(
            "body b {{ mass = 2 kg, moves x }}\nspring s: ground -- b {{ k = 10 N/m }}\nforce F: b along x = {signal}\n"
        )
    };
    for period in ["«0.5 s»", "«2.5 s»", "«0 s»", "«-1 s»"] {
        one(&force(&format!("periodic(table(\"plain.csv\", 1 N), {period})")), "vib::signal::period");
    }
    one(&force("periodic(«step(1 N, 0 s)», 1 s)"), "vib::signal::arguments");
    let moved = "body b { mass = 2 kg, moves x }\nspring s: f -- b { k = 10 N/m }\n\
                 base f { moves x } = periodic(table(\"plain.csv\", 1 mm), «1 s»)\n";
    one(moved, "vib::signal::period");
}
