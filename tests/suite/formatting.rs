//! `vibc fmt`: the layout does not depend on the old one, formatting twice changes nothing, and the scene stays the
//! same. See spec.md#layout.

use crate::fuzzing::scene_text;
use crate::independent::random_scenes::Random;
use std::fs;
use std::path::{Path, PathBuf};
use vibc::base::{FileId, SourceFile, Sources};
use vibc::editor::tokens::{TokenKind, tokens};
use vibc::model::Overrides;

fn source(text: &str) -> (Sources, FileId) {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("model.vib", text));
    crate::examples::add_used_files(&mut sources, file);
    (sources, file)
}

/// The formatted text; `None` if the text does not conform to the grammar.
fn formatted(text: &str) -> Option<String> {
    let (sources, file) = source(text);
    vibc::format(&sources, file).answer
}

/// The scene, or the findings, without places.
fn meaning(text: &str) -> String {
    let (sources, file) = source(text);
    let parsed = vibc::syntax::parse(&sources, file);
    assert!(parsed.errors.is_empty(), "{text}");
    let checked = vibc::model::check(&sources, &parsed.tree, &Overrides::default());
    let messages: Vec<(&str, String)> =
        checked.diagnostics.iter().map(|finding| (finding.code.0, finding.message.clone())).collect();
    without_places(&format!("{:?} {messages:?}", checked.scene))
}

/// A `Debug` text without its spans.
fn without_places(debug: &str) -> String {
    let mut parts = debug.split("Span {");
    let mut text = parts.next().unwrap_or_default().to_string();
    parts.for_each(|part| text += part.split_once('}').map_or("", |(_, rest)| rest));
    text
}

fn comments(text: &str) -> Vec<&str> {
    let tokens = tokens(text);
    tokens.iter().filter(|token| token.kind == TokenKind::Comment).map(|token| token.text(text)).collect()
}

/// Number of paragraphs, separated by empty lines.
fn paragraphs(text: &str) -> usize {
    text.split("\n\n").filter(|paragraph| !paragraph.trim().is_empty()).count()
}

/// Formats a text and checks what holds for every layout; `None` if it has none.
fn lay_out(text: &str) -> Option<String> {
    let laid_out = formatted(text)?;
    assert_eq!(formatted(&laid_out).as_deref(), Some(laid_out.as_str()), "twice is once\n{text}");
    assert!(meaning(&laid_out) == meaning(text), "the scene stays\n{text}\n{laid_out}");
    assert_eq!(comments(&laid_out), comments(text), "comments stay\n{text}");
    let blanks = [' ', '\t', '\r'];
    assert!(laid_out.split('\n').all(|line| !line.ends_with(blanks)), "no blanks at the end of a line\n{laid_out}");
    assert!(!laid_out.starts_with('\n') && !laid_out.ends_with("\n\n") && !laid_out.contains("\n\n\n"), "{laid_out}");
    Some(laid_out)
}

/// The models below a folder, sorted by name.
fn models(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = fs::read_dir(folder).expect("a folder of models").map(|entry| entry.expect("an entry").path());
    let mut models: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == "vib")).collect();
    models.sort();
    models
}

#[test]
fn examples_are_in_the_one_layout() {
    for path in ["examples", "examples/parts"].into_iter().flat_map(models) {
        let text = fs::read_to_string(&path).unwrap();
        let laid_out = lay_out(&text).unwrap_or_else(|| panic!("{} has errors", path.display()));
        assert!(laid_out == text, "`vibc fmt {}` is due", path.display());
        assert_eq!(paragraphs(&laid_out), paragraphs(&text));
    }
}

#[test]
fn an_example_is_the_same_however_it_was_laid_out() {
    for path in models("examples") {
        let text = fs::read_to_string(&path).unwrap();
        let spread = spread(&text);
        assert_ne!(spread, text);
        assert_eq!(lay_out(&spread).as_deref(), Some(text.as_str()), "{spread}");
    }
}

/// The text with fewer blanks in some places and more in others, with fields on lines of their own.
fn spread(text: &str) -> String {
    let lines = text.lines().map(|line| match line.split_once("//") {
        Some((code, comment)) => format!("   {}//{comment}", code.trim_end()),
        None => line
            .replace(" { ", "{\n\n")
            .replace(" }", "\n  }")
            .replace(" = ", "=")
            .replace(": ", ":\t")
            .replace(" -- ", "--")
            .replace(" + ", "  +")
            .replace(" * ", "   *  ")
            .replace(", ", " ,"),
    });
    format!("\n\n{}\n\n", lines.collect::<Vec<_>>().join("\r\n").replace('\r', "").replace("\n\n", "\n\n\n"))
}

#[test]
fn models_with_findings_keep_them() {
    let mut laid_out = 0;
    for path in models("tests/diagnostics") {
        let Ok(text) = fs::read_to_string(&path) else { continue };
        laid_out += usize::from(lay_out(&text).is_some());
    }
    assert!(laid_out > 60, "most models of findings are in the grammar: {laid_out}");
}

#[test]
fn random_models_keep_their_meaning() {
    let mut random = Random::new(20_261_122);
    let mut laid_out = 0;
    for _ in 0..400 {
        let bytes: Vec<u8> = (0..10 + random.below(300)).map(|_| random.below(40) as u8).collect();
        laid_out += usize::from(lay_out(&scene_text::text_of(&bytes)).is_some());
    }
    assert!(laid_out > 200, "most random models are in the grammar: {laid_out}");
}

#[test]
fn every_form_has_its_layout() {
    let written = "

model   cart   // the model
/// How stiff
param k=10N/m //first


let rate   =  sqrt(k/ m)*2- -1    // second
gravity(0,-9.81 m/s^2)
repeat i in 1 .. n-1 { body m[i+1]{mass=1 kg,moves x,}  // inside

  repeat j in (1)..2 {spring s[i,j]:m[i]--m[i+1]{k=10 N/m * 2
   along=x}}

}
body b { // the block
  mass = 1 kg // heavy

  // on its own
  moves x y, at = (1 m,  // first
     2 m)
  turns }
spring s: ground@(0, // zero
   1 m) -- b { k = 1 N/m }
param q = (1 N/m // one
 + 2 N/m)
body long { mass = 1000000000000000 kg, inertia = 333333333333333333333333333333333 kg*m^2 about (0, 1 m), free, at = (0, 0) }
output y = b@(0,1 m).x-2*b.y
force F : b -- c along --x = harmonic( 1 N , 2 Hz )+table( \"a  b.csv\" )
couple c: -b.x/0.3 m = 2^-1 * a.angle
damping rayleigh( 0.1 /s , 1e-4s )
rest   as  drawn
solve fn in 5 Hz..29 Hz : gain( floor->table.y ,30 Hz)=-12dB
require frequency(1)>=2Hz
initial b{}
";
    let laid_out = lay_out(written).expect("it is in the grammar");
    insta::assert_snapshot!(laid_out);
}

/// Blanks of other scripts are part of a comment: nothing is moved elsewhere.
#[test]
fn a_comment_keeps_the_blanks_of_other_scripts() {
    for blank in "\u{a0}\u{1680}\u{2000}\u{2005}\u{200a}\u{2028}\u{2029}\u{202f}\u{205f}\u{3000}".chars() {
        let text = format!("// note{blank}\n/// of it{blank}\nbody b {{ mass = 1 kg, moves x }} // beside{blank} \t\n");
        let laid_out = lay_out(&text).expect("it is in the grammar");
        assert_eq!(laid_out, text.replace(" \t", "").replace("} //", "}  //"), "{blank:?}");
    }
}

/// `in`, `along`, `about` and `modal` are names in the position of a value or a part.
#[test]
fn words_between_values_are_names_where_values_stand() {
    for text in [
        "body bar { mass = 2 kg, shape = rod(in(0, 0), (0, 1 m)) }\n",
        "param k = about(1, 2) + along(3) * modal(4)\n",
        "spring s: in@(0, 1 m) -- along@(0, 2 m) { k = modal(1) N/m }\n",
        "output y = in.x - along.y + about@(0, 1 m).x\n",
        "require in(1) < about(2)\n",
    ] {
        let Some(laid_out) = formatted(text) else { continue };
        assert_eq!(laid_out, text);
        lay_out(text);
    }
    assert!(formatted("body bar { mass = 2 kg, shape = rod(in(0, 0), (0, 1 m)) }\n").is_some());
    for (text, laid_out) in [
        ("repeat i in(2)..3 {\nparam p[i] = 1\n}\n", "repeat i in (2)..3 {\n  param p[i] = 1\n}\n"),
        ("slide s: a -- b along(1, 0)\n", "slide s: a -- b along (1, 0)\n"),
        ("body b { mass = 1 kg, moves along(1, 0) }\n", "body b { mass = 1 kg, moves along (1, 0) }\n"),
        ("body b { inertia = 1 kg*m^2 about(0, 1 m) }\n", "body b { inertia = 1 kg*m^2 about (0, 1 m) }\n"),
        ("damping modal(2 %)\n", "damping modal (2 %)\n"),
        ("solve k in(1)..2: frequency(1) = 1 Hz\n", "solve k in (1) .. 2: frequency(1) = 1 Hz\n"),
    ] {
        assert_eq!(formatted(text).as_deref(), Some(laid_out), "{text}");
    }
}

#[test]
fn line_ends_stay_as_the_first_one_is() {
    assert_eq!(formatted("param a=1\r\nparam b=2\n").as_deref(), Some("param a = 1\r\nparam b = 2\r\n"));
    assert_eq!(formatted("param a=1\nparam b=2\r\n").as_deref(), Some("param a = 1\nparam b = 2\n"));
    assert_eq!(formatted("").as_deref(), Some(""));
    assert_eq!(formatted("\n \n// alone").as_deref(), Some("// alone\n"));
}

#[test]
fn a_text_that_is_not_in_the_grammar_has_no_layout() {
    for text in ["param k = \n", "body b { moves x\n", "spring: a -- b\n", "}\n"] {
        assert_eq!(formatted(text), None, "{text}");
    }
}
