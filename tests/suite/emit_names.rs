//! Names with a meaning in the target language, numbers outside its range, files that must not be overwritten, and
//! sizes that exceed memory: emitted code compiles, or the model is refused. See docs/method/emit.md.

use super::emit::{emission, options, silently, write};
use super::systems::number;
use std::fs;
use std::path::Path;
use std::process::Command;
use vibc::analysis::discrete::equations::{NoEquations, equations};
use vibc::analysis::discrete::{Options, Port, Precision};
use vibc::backend::emit::{self, Language, Program};
use vibc::base::{SourceFile, SourceKind, Sources};
use vibc::model::Overrides;

const CART: &str =
    "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 1 N/m }\nforce F: b along x\noutput x = b.x\n";

/// Keywords of ISO C99 to C23, of C++98 to C++23, and of Rust (editions 2015 to 2024, including reserved ones and names
/// of types).
const KEYWORDS: &str = "alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class compl \
    concept const consteval constexpr constinit const_cast continue co_await co_return co_yield decltype default delete do \
    double dynamic_cast else enum explicit export extern false float for friend goto if inline int long mutable namespace new \
    noexcept not not_eq nullptr operator or or_eq private protected public register reinterpret_cast requires restrict return \
    short signed sizeof static static_assert static_cast struct switch template this thread_local throw true try typedef \
    typeid typename typeof typeof_unqual union unsigned using virtual void volatile wchar_t while xor xor_eq final override \
    as crate dyn fn impl in let loop match mod move mut pub ref self Self super trait type unsafe use where async await abstract \
    become box macro priv unsized yield gen raw safe i8 i16 i32 i64 i128 isize u8 u16 u32 u64 u128 usize f32 f64 str String \
    main linux unix state inputs outputs motion derivative event value std core Some None Ok Err _ __func__ y x1 w0 n1";

/// All headers of ISO C99.
const HEADERS: &str = "assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdarg stdbool stddef \
    stdint stdio stdlib string tgmath time wchar wctype";

/// The macros without parameters that are defined after including all headers of C.
fn macros(folder: &tempfile::TempDir, standard: &str) -> Vec<String> {
    let output = Command::new("gcc")
        .args([standard, "-dM", "-E", "all.c"])
        .current_dir(folder.path())
        .output()
        .expect("a list of macros");
    let text = String::from_utf8(output.stdout).expect("text");
    let names = text.lines().filter_map(|line| line.strip_prefix("#define ")?.split(' ').next());
    names.filter(|name| !name.contains('(') && !name.starts_with('_')).map(str::to_string).collect()
}

/// Outputs and inputs with every name that a language or a header reserves, after all headers, in C, C++ and every
/// edition of Rust.
#[test]
fn names_of_the_target_are_no_names_of_the_code() {
    let folder = tempfile::tempdir().expect("a folder");
    let all: String = HEADERS.split_whitespace().map(|name| format!("#include <{name}.h>\n")).collect();
    fs::write(folder.path().join("all.c"), &all).expect("a file");
    let mut names: Vec<String> = KEYWORDS.split_whitespace().map(str::to_string).collect();
    names.extend(macros(&folder, "-std=c99"));
    names.extend(macros(&folder, "-std=c17"));
    assert!(names.len() > 500, "{}", names.len());
    let mut system = emission("names", CART, &options("0.01")).system;
    let port = |name: &String| Port { name: name.clone(), unit: "m".into() };
    // The first input and output are those of the model.
    system.inputs.extend(names.iter().map(port));
    system.outputs.extend(names.iter().map(port));
    system.direct.resize(system.outputs.len(), Vec::new());
    let program = Program { step: number("0.01"), samples: 3 };
    write(&folder, &emit::files("names", &system, Language::C, Some(&program)));
    for standard in ["-std=c99", "-std=c17"] {
        for file in ["names.c", "main.c"] {
            let flags = [standard, "-include", "all.c", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", file];
            silently(&folder, "gcc", &flags);
        }
    }
    silently(&folder, "gcc", &["-std=gnu17", "-Wall", "-Werror", "-fsyntax-only", "names.c", "main.c"]);
    let headers = all.replace("#include <tgmath.h>\n", "").replace("#include <complex.h>\n", "");
    fs::write(folder.path().join("all.h"), headers).expect("a file");
    let flags = ["-x", "c++", "-include", "all.h", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "names.c"];
    for standard in ["-std=c++11", "-std=c++20"] {
        silently(&folder, "g++", &[&flags[..], &[standard]].concat());
    }
    write(&folder, &emit::files("names", &system, Language::Rust, Some(&program)));
    for edition in ["2015", "2018", "2021", "2024"] {
        silently(&folder, "rustc", &["--edition", edition, "-D", "warnings", "--emit", "metadata", "main.rs"]);
    }
}

/// A model with the name of a header does not replace it, and one with the name of a Rust module does not hide it.
#[test]
fn a_model_takes_the_place_of_no_header() {
    let system = emission("names", CART, &options("0.01")).system;
    let program = Program { step: number("0.01"), samples: 3 };
    let folder = tempfile::tempdir().expect("a folder");
    let more = ["features", "alloca", "endian", "strings", "unistd", "Stdio", "NULL", "pthread"];
    let all: String = HEADERS.split_whitespace().map(|name| format!("#include <{name}.h>\n")).collect();
    fs::write(folder.path().join("all.c"), &all).expect("a file");
    for name in HEADERS.split_whitespace().chain(more) {
        let files = emit::files(name, &system, Language::C, None);
        for file in &files {
            let there = Path::new("/usr/include").join(file.name.to_lowercase());
            assert!(!there.exists(), "{} hides a header", file.name);
        }
        write(&folder, &files);
    }
    silently(&folder, "gcc", &["-std=gnu17", "-I.", "-Wall", "-Werror", "-fsyntax-only", "all.c", "stdio_.c"]);
    for name in
        ["std", "core", "alloc", "io", "String", "Write", "u64", "usize", "bool", "main", "Option", "print", "out"]
    {
        let folder = tempfile::tempdir().expect("a folder");
        write(&folder, &emit::files(name, &system, Language::Rust, Some(&program)));
        silently(
            &folder,
            "rustc",
            &["--edition", "2021", "-A", "non_camel_case_types", "--emit", "metadata", "main.rs"],
        );
        write(&folder, &emit::files(name, &system, Language::C, Some(&program)));
        let c: Vec<String> =
            emit::files(name, &system, Language::C, Some(&program)).into_iter().map(|f| f.name).collect();
        let c: Vec<&str> = c.iter().map(String::as_str).filter(|name| name.ends_with(".c")).collect();
        silently(&folder, "gcc", &[&["-std=c99", "-I.", "-Wall", "-Werror", "-fsyntax-only"][..], &c].concat());
    }
}

/// Characters that change the direction of text, or control a terminal, do not reach comments.
#[test]
fn comments_hold_no_controls() {
    let system = emission("names", CART, &options("0.01")).system;
    let name = "a\u{202e}b\u{2066}c\u{1b}d\u{2028}e*/f";
    for language in [Language::C, Language::Rust] {
        let text = emit::whole(name, &system, language);
        let steers = |c: char| c.is_control() && c != '\n' || "\u{202e}\u{2066}\u{2028}".contains(c);
        assert!(!text.contains(steers), "{language:?}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    write(&folder, &emit::files(name, &system, Language::Rust, None));
    silently(&folder, "rustc", &["--crate-type", "lib", "-D", "warnings", "--emit", "metadata", "a_b_c_d_e_f.rs"]);
}

/// The codes of the diagnostics of a model from which no code is made.
fn refused(text: &str, wanted: &Options) -> Vec<String> {
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::decode(SourceKind::Model, "model", text.as_bytes().to_vec()));
    let outcome = vibc::discrete(&sources, model, &Overrides::default(), wanted);
    assert!(outcome.answer.is_none(), "{text}");
    outcome.diagnostics.iter().map(|d| d.code.0.to_string()).collect()
}

/// Numbers outside the precision are refused, and steps in which a motion or a signal turns so far that its phase is
/// lost.
#[test]
fn numbers_outside_the_precision_are_refused() {
    let single = Options { precision: Precision::Single, ..options("0.001") };
    let heavy = CART.replace("1 kg", "1e150 kg").replace("1 N/m", "1e6 N/m");
    assert_eq!(refused(&heavy, &single), ["vib::limit::range"]);
    let system = emission("heavy", &heavy, &options("0.001")).system;
    assert!(system.cells.iter().all(|cell| cell.is_finite()));
    // The output's coefficient is too small for single precision, and would print as zero.
    let seen = CART.replace("output x = b.x", "output x = 1e-44 * b.x");
    if let Some(text) = seen.contains("1e-44").then_some(&seen) {
        assert_eq!(refused(text, &single), ["vib::limit::range"]);
        emission("seen", text, &options("0.001"));
    }
    let fast = CART.replace("1 N/m", "1e20 N/m");
    assert_eq!(refused(&fast, &options("1")), ["vib::limit::range"]);
    let signal = CART.replace("along x\n", "along x = harmonic(1 N, 1e9 Hz)\n");
    assert_eq!(refused(&signal, &Options { built_in: true, ..options("1") }), ["vib::limit::range"]);
    emission("slow", &signal, &Options { built_in: true, ..options("0.01") });
}

/// The equations of a long chain and of a hub with many spokes take time and text in proportion to their size, without
/// deep recursion.
#[test]
fn equations_of_large_models_are_in_proportion() {
    let chain = |n: usize| {
        let bodies: String = (0..n).map(|i| format!("body b{i} {{ mass = 1 kg, moves x }}\n")).collect();
        let springs: String = (1..n).map(|i| format!("spring s{i}: b{} -- b{i} {{ k = 1 N/m }}\n", i - 1)).collect();
        format!("{bodies}{springs}spring s0: ground -- b0 {{ k = 1 N/m }}\noutput x = b0.x\n")
    };
    let hub = |n: usize| {
        let spokes: String = (1..n)
            .map(|i| format!("body b{i} {{ mass = 1 kg, moves x }}\nspring s{i}: b0 -- b{i} {{ k = 1 N/m }}\n"))
            .collect();
        format!("body b0 {{ mass = 1 kg, moves x }}\n{spokes}output x = b0.x\n")
    };
    let emitted = |text: String| {
        let mut sources = Sources::new();
        let model = sources.add(SourceFile::decode(SourceKind::Model, "large", text.into_bytes()));
        let (_, system) = vibc::linear(&sources, model, &Overrides::default()).answer.expect("a system");
        let equations = equations(&system, Precision::Double).expect("equations");
        emit::equation_text("large", &equations, Language::Rust).len()
    };
    for text in [&chain as &dyn Fn(usize) -> String, &hub] {
        let (some, more) = (emitted(text(2000)), emitted(text(8000)));
        assert!(more < 5 * some, "{some} {more}");
    }
}

/// A coordinate without mass has no equation, and neither has a number outside single precision.
#[test]
fn equations_that_cannot_be_are_refused() {
    let found = |text: &str, precision| {
        let mut sources = Sources::new();
        let model = sources.add(SourceFile::decode(SourceKind::Model, "model", text.as_bytes().to_vec()));
        let (_, system) = vibc::linear(&sources, model, &Overrides::default()).answer.expect("a system");
        equations(&system, precision).err()
    };
    let heavy = CART.replace("1 kg", "1e150 kg").replace("1 N/m", "1e6 N/m");
    assert_eq!(found(&heavy, Precision::Double), None);
    assert_eq!(found(&heavy, Precision::Single), Some(NoEquations::OutOfRange { precision: "single" }));
}

/// Emitted files do not overwrite the model, whatever its name is.
#[test]
fn a_model_is_not_replaced_by_its_code() {
    for (file, target) in [("m.rs", "rust"), ("m.c", "c"), ("m.h", "c")] {
        let folder = tempfile::tempdir().expect("a folder");
        let text = format!("model m\n{CART}");
        fs::write(folder.path().join(file), &text).expect("a file");
        let output = Command::new(env!("CARGO_BIN_EXE_vibc"))
            .args(["emit", "--target", target, "-o", ".", file])
            .current_dir(folder.path())
            .output()
            .expect("the program starts");
        assert_eq!(output.status.code(), Some(2), "{file}");
        assert_eq!(fs::read_to_string(folder.path().join(file)).expect("the model"), text);
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1, "{file}");
    }
}
