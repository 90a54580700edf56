//! A text through every stage, with what must hold whatever the text is.

use vibc::analysis::{ModeKind, Modes, Poles};
use vibc::backend::diagnostics::{self, HumanStyle};
use vibc::backend::{ReportOptions, json, report};
use vibc::base::source::{SourceFile, Sources};
use vibc::base::{Diagnostic, Diagnostics, FileId};
use vibc::model::Overrides;

/// Coordinates beyond which a fuzzer only waits.
const LARGE: usize = 40;

/// Panics where a stage does, or where what it says cannot be.
pub fn run(text: &str) {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("model.vib", text));
    let parsed = vibc::syntax::parse(&sources, file);
    let checked = vibc::model::check(&sources, &parsed.tree, &Overrides::default());
    let mut diagnostics = parsed.errors;
    diagnostics.extend(checked.diagnostics);
    let Some(scene) = checked.scene.filter(|_| !diagnostics.has_errors()) else {
        assert!(diagnostics.has_errors(), "no scene and no error");
        // The expressions of a text are read beside its numbers.
        assert!(vibc::equations(&sources, file, &Overrides::default()).answer.is_none(), "equations of no scene");
        return assert_findings(&sources, diagnostics);
    };
    let outcome = vibc::lower::lower(&scene);
    assert!(outcome.lowered.is_some() || outcome.diagnostics.has_errors(), "no system and no error");
    diagnostics.extend(outcome.diagnostics);
    assert_findings(&sources, diagnostics);
    let Some(lowered) = outcome.lowered.filter(|lowered| lowered.system.n() <= LARGE) else { return };
    let Ok(modes) = vibc::analysis::modes(&lowered.system) else { return };
    assert_modes(&modes, lowered.system.n());
    let Ok(poles) = vibc::analysis::poles(&lowered.system, &modes) else { return };
    assert_poles(&poles);
    assert_reported(&sources, file);
}

/// Every place of every diagnostic lies in its text, on character boundaries, and all of them can be drawn without a
/// control character that would steer a terminal.
fn assert_findings(sources: &Sources, diagnostics: Diagnostics) {
    let findings = diagnostics.into_sorted();
    for diagnostic in &findings {
        let Diagnostic { primary, related, message, .. } = diagnostic;
        assert!(!message.is_empty(), "{diagnostic:?}");
        for label in std::iter::once(primary).chain(related) {
            assert!(sources.text(label.span.file()).get(label.span.range()).is_some(), "{diagnostic:?}");
        }
    }
    let style = HumanStyle { colour: false, ascii: false };
    assert_plain(&diagnostics::human(sources, &findings, style));
    assert_plain(&diagnostics::short(sources, &findings));
    assert_plain(&diagnostics::json(sources, &findings));
}

fn assert_plain(text: &str) {
    assert!(text.chars().all(|c| c == '\n' || !c.is_control()), "{text:?}");
}

/// The whole program once more, up to what it prints.
fn assert_reported(sources: &Sources, file: FileId) {
    let analysis = vibc::analyze(sources, file, &Overrides::default());
    let Some(answer) = &analysis.answer else { return };
    let options = ReportOptions { matrices: true, ..ReportOptions::default() };
    assert_plain(&report::text(answer, &options));
    assert_plain(&json::json(answer, &options));
}

/// As many modes as coordinates, those without inertia counted, in order, each of one kind and with a bound that is a number.
fn assert_modes(modes: &Modes, n: usize) {
    assert_eq!(modes.list.len() + modes.infinite, n);
    let mut last = f64::NEG_INFINITY;
    for mode in &modes.list {
        let square = mode.omega_squared.to_f64();
        assert!(square >= last, "ascending: {:?}", modes.list);
        assert!(mode.omega_squared.rad >= 0.0 && mode.omega.rad >= 0.0, "{mode:?}");
        assert!(mode.shape.len() == n && mode.shape.iter().all(|x| x.is_finite()), "{mode:?}");
        match mode.kind {
            ModeKind::Oscillation => assert!(square > 0.0, "{mode:?}"),
            ModeKind::Rigid => assert!(mode.omega_squared.is_zero() && mode.omega.is_zero(), "{mode:?}"),
            ModeKind::Undetermined => assert!(mode.omega_squared.contains_zero(), "{mode:?}"),
            ModeKind::Divergence => assert!(square < 0.0, "{mode:?}"),
        }
        for shares in
            [mode.kinetic.iter().map(|s| s.part).collect::<Vec<_>>(), mode.strain.iter().map(|s| s.part).collect()]
        {
            // Shares of strain energy may be large and of both signs.
            let (sum, size) =
                shares.iter().fold((0.0, 1.0), |(sum, size), share| (sum + share.0, size + share.0.abs()));
            assert!(shares.is_empty() || (sum - 1.0).abs() < 1e-12 * size + 1e-6, "{mode:?}");
        }
        last = square;
    }
}

/// Complex poles come in pairs; bounds are numbers.
fn assert_poles(poles: &Poles) {
    let upper = poles.list.iter().filter(|pole| pole.im.to_f64() > 0.0).count();
    let lower = poles.list.iter().filter(|pole| pole.im.to_f64() < 0.0).count();
    assert_eq!(upper, lower, "{:?}", poles.list);
    for pole in &poles.list {
        assert!(pole.relative_error >= 0.0, "{pole:?}");
        assert!(pole.re.to_f64().is_finite() && pole.im.to_f64().is_finite(), "{pole:?}");
    }
}
