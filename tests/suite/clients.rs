//! An independent client of the language server: Neovim, driven by `tests/clients/neovim.lua`.
//!
//! Needs Neovim 0.11 or later as `nvim`, or at the path in `NVIM`: `cargo test` shows it as ignored, `.ci/run` installs
//! Neovim and runs it.

use std::fs;
use std::path::Path;
use std::process::Command;

/// A field that does not exist, and a stiffness without its unit.
const MODEL: &str = "model two_errors

param m  = 2 kg

body block { mas = m, moves x}

spring s: ground -- block { k = 10 }
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
fn neovim_sees_mends_renames_lays_out() {
    let neovim = neovim().expect("Neovim 0.11 or later, as `nvim` or as NVIM says");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = folder.path().join("two_errors.vib");
    fs::write(&model, MODEL).expect("a model");
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
    assert_eq!(said.lines().filter(|line| line.starts_with("ok: ")).count(), 9, "{said}{failed}");
}

/// Figures and plots of every example and drawing, in Chromium and in librsvg: `tests/clients/figures.mjs`.
#[test]
#[ignore = "needs node with playwright-core below PLAYWRIGHT, Chromium and rsvg-convert"]
fn browsers_draw_figures_alike_and_names_lie_over_nothing() {
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
    let (said, failed) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{said}{failed}");
}
