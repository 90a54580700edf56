//! Other programs at what this one writes: a published client at the language server, browsers at figures and equations, LaTeX and Typst at
//! equations.
//!
//! `cargo test` shows these tests as ignored; `.ci/run` installs what they need and runs them.

use std::fs;
use std::path::Path;
use std::process::Command;

/// A field that does not exist, and a stiffness without its unit.
const MODEL: &str = "model two_errors

param m  = 2 kg

body block { mas = m, moves x}

spring s: ground -- block { k = 10 }
";

/// A component, and a model that places it.
const AXLES: &str = "/// An axle on its tyre.
component axle(m: kg, k = 150 kN/m) {
  /// The unsprung mass.
  body   wheel { mass = m, moves y }
  spring tyre: ground -- wheel { k = k }
  output lift = wheel.y
}
";

const CAR: &str = "use \"axles.vib\"
place front = axle(m = 40 kg)
force F: front.wheel along y
require gain(F -> front.lift, 1 Hz) < 1 mm/N
";

/// The program, if it is new enough to include a client.
fn neovim() -> Option<String> {
    let name = std::env::var("NVIM").unwrap_or_else(|_| "nvim".into());
    let output = Command::new(&name).arg("--version").output().ok()?;
    let version = String::from_utf8_lossy(&output.stdout).lines().next()?.trim_start_matches("NVIM v").to_string();
    let mut numbers = version.split(['.', '-']).map(|number| number.parse::<u32>().unwrap_or(0));
    let version = (numbers.next()?, numbers.next()?);
    (version >= (0, 11)).then_some(name)
}

#[test]
#[ignore = "needs Neovim 0.11 or later, as `nvim` or as NVIM says"]
fn neovim_fixes_renames_and_formats() {
    let neovim = neovim().expect("Neovim 0.11 or later, as `nvim` or as NVIM says");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = folder.path().join("two_errors.vib");
    fs::write(&model, MODEL).expect("a model");
    fs::write(folder.path().join("axles.vib"), AXLES).expect("a file of components");
    fs::write(folder.path().join("car.vib"), CAR).expect("a model");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/clients/neovim.lua");
    let run = Command::new(neovim)
        .args(["--headless", "--clean", "-l"])
        .args([&script, &model])
        .env("VIBC", env!("CARGO_BIN_EXE_vibc"))
        .env("XDG_STATE_HOME", folder.path())
        .output()
        .expect("Neovim starts");
    let (said, failed) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{said}{failed}");
    assert_eq!(said.lines().filter(|line| line.starts_with("ok: ")).count(), 15, "{said}{failed}");
}

/// Figures and plots of every example and drawing, in Chromium and in librsvg: `tests/clients/figures.mjs`.
#[test]
#[ignore = "needs node with playwright-core below PLAYWRIGHT, Chromium and rsvg-convert"]
fn browsers_draw_figures_alike_and_names_overlap_nothing() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let vibc = |arguments: &[&str]| {
        let run = Command::new(env!("CARGO_BIN_EXE_vibc")).args(arguments).output().expect("the program starts");
        run.status.success()
    };
    let mut drawn = 0;
    for models in ["examples", "tests/drawings"] {
        for entry in fs::read_dir(root.join(models)).expect("a folder of models") {
            let model = entry.expect("an entry").path();
            if model.extension().is_none_or(|extension| extension != "vib") {
                continue;
            }
            let stem = model.file_stem().expect("a name").to_string_lossy().into_owned();
            let to = |what: &str| folder.path().join(format!("{stem}{what}.svg")).to_string_lossy().into_owned();
            let model = model.to_string_lossy().into_owned();
            assert!(vibc(&["draw", &model, "-o", &to("")]), "{stem}");
            assert!(vibc(&["draw", &model, "--values", "-o", &to("_values")]), "{stem}");
            assert!(vibc(&["draw", &model, "--mode", "1", "-o", &to("_mode")]), "{stem}");
            // Not every model has inputs or outputs.
            vibc(&["transfer", &model, "--svg", &to("_transfer")]);
            drawn += 1;
        }
    }
    assert!(drawn > 15, "{drawn}");
    let script = root.join("tests/clients/figures.mjs");
    let run = Command::new("node").arg(script).arg(folder.path()).output().expect("node starts");
    let (messages, failed) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{messages}{failed}");
}

/// The equations of every example and drawing in a form, one file each. A model with a loss factor has none, in symbols or in
/// numbers: it is a law of harmonic motion alone.
fn write_equations(format: &str, ending: &str, folder: &Path) -> usize {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut written = 0;
    for models in ["examples", "tests/drawings"] {
        for entry in fs::read_dir(root.join(models)).expect("a folder of models") {
            let model = entry.expect("an entry").path();
            if model.extension().is_none_or(|extension| extension != "vib") {
                continue;
            }
            if fs::read_to_string(&model).expect("a model").contains("loss = ") {
                continue;
            }
            let to = folder.join(model.file_stem().expect("a name")).with_extension(ending);
            let run = Command::new(env!("CARGO_BIN_EXE_vibc"))
                .args(["equations", "--format", format, "-o"])
                .args([&to, &model])
                .output()
                .expect("the program starts");
            let finding = String::from_utf8_lossy(&run.stderr);
            assert!(run.status.success(), "{}: {finding}", model.display());
            written += 1;
        }
    }
    assert!(written > 20, "{written}");
    written
}

/// Fractions, dots, indices and matrices where they belong, at two widths: `tests/clients/equations.mjs`.
#[test]
#[ignore = "needs node with playwright-core below PLAYWRIGHT, and Chromium"]
fn a_browser_lays_out_the_equations() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write_equations("mathml", "html", folder.path());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/clients/equations.mjs");
    let run = Command::new("node").arg(script).arg(folder.path()).output().expect("node starts");
    let (messages, failed) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{messages}{failed}");
}

#[test]
#[ignore = "needs pdflatex with amsmath"]
fn latex_sets_the_equations() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write_equations("latex", "tex", folder.path());
    for entry in fs::read_dir(folder.path()).expect("the folder").collect::<Vec<_>>() {
        let file = entry.expect("an entry").path();
        let run = Command::new("pdflatex")
            .args(["-interaction=nonstopmode", "-halt-on-error"])
            .arg(&file)
            .current_dir(folder.path())
            .output()
            .expect("pdflatex starts");
        let messages = String::from_utf8_lossy(&run.stdout);
        assert!(run.status.success() && file.with_extension("pdf").exists(), "{}\n{messages}", file.display());
    }
}

/// `TYPST` names a Python that has the package `typst`.
#[test]
#[ignore = "needs Python with the package typst, as `python3` or as TYPST says"]
fn typst_sets_the_equations() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let written = write_equations("typst", "typ", folder.path());
    let python = std::env::var("TYPST").unwrap_or_else(|_| "python3".into());
    let script = "import sys, glob, typst\nfiles = glob.glob(sys.argv[1] + '/*.typ')\nfor file in files:\n    assert typst.compile(file, format='pdf')[:5] == b'%PDF-', file\nprint(len(files))";
    let run = Command::new(python).args(["-c", script]).arg(folder.path()).output().expect("Python starts");
    let (messages, failed) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success() && messages.trim() == written.to_string(), "{messages}{failed}");
}

/// The report page of the examples, of a hostile model and of a chain in closed form, in Chromium: `tests/clients/page.mjs`.
#[test]
#[ignore = "needs node with playwright-core and axe-core below PLAYWRIGHT, and Chromium"]
fn a_browser_shows_and_moves_the_page() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let vibc = |arguments: &[&str]| {
        let run = Command::new(env!("CARGO_BIN_EXE_vibc")).args(arguments).output().expect("the program starts");
        assert!(run.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&run.stderr));
    };
    for models in ["examples", "tests/clients/models"] {
        for entry in fs::read_dir(root.join(models)).expect("a folder of models") {
            let model = entry.expect("an entry").path();
            if model.extension().is_none_or(|extension| extension != "vib") {
                continue;
            }
            let stem = model.file_stem().expect("a name").to_string_lossy().into_owned();
            let to = |ending: &str| folder.path().join(format!("{stem}.{ending}")).to_string_lossy().into_owned();
            let model = model.to_string_lossy().into_owned();
            vibc(&["report", &model, "-o", &to("html")]);
            if ["cart", "half_car"].contains(&stem.as_str()) {
                vibc(&["analyze", &model, "--format", "json", "-o", &to("json")]);
            }
        }
    }
    let script = root.join("tests/clients/page.mjs");
    let run = Command::new("node").arg(script).arg(folder.path()).output().expect("node starts");
    let (messages, failed) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{messages}{failed}");
    assert_eq!(messages.lines().filter(|line| line.starts_with("ok: ")).count(), 7, "{messages}{failed}");
}

/// The picture of the page in the README: `docs/figures/make` makes it, by `docs/figures/page.mjs`.
#[test]
#[ignore = "needs node with playwright-core below PLAYWRIGHT, and Chromium"]
fn the_picture_of_the_page_is_fresh() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = folder.path().join("cart.html");
    let mut report = Command::new(env!("CARGO_BIN_EXE_vibc"));
    report.arg("report").arg(root.join("examples/cart.vib")).arg("-o").arg(&page);
    assert!(report.status().expect("the program starts").success());
    let run = Command::new("node")
        .arg(root.join("docs/figures/page.mjs"))
        .args([&page, &root.join("docs/figures/cart_report.png")])
        .arg("--compare")
        .output()
        .expect("node starts");
    let (said, failed) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{said}{failed}");
}
