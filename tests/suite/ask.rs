//! Takes a model's text through every stage, for the modules of this suite that test physics.

use vibc::analysis::{Modes, Poles};
use vibc::base::Diagnostic;
use vibc::base::source::{SourceFile, Sources};
use vibc::lower::Lowered;
use vibc::model::{CheckedScene, Overrides};

/// The results of all stages for a text.
pub struct Answer {
    pub scene: CheckedScene,
    pub lowered: Lowered,
    pub modes: Modes,
    pub poles: Poles,
    /// Warnings and notes.
    pub remarks: Vec<Diagnostic>,
}

/// The answer, or all diagnostics of a text that was refused.
pub fn try_ask(text: &str) -> Result<Answer, Vec<Diagnostic>> {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("model.vib", text));
    let parsed = vibc::syntax::parse(&sources, file);
    let checked = vibc::model::check(&sources, &parsed.tree, &Overrides::default());
    let mut diagnostics = parsed.errors;
    diagnostics.extend(checked.diagnostics);
    let (Some(scene), false) = (checked.scene, diagnostics.has_errors()) else {
        return Err(diagnostics.into_sorted());
    };
    let outcome = vibc::lower::lower(&scene);
    diagnostics.extend(outcome.diagnostics);
    let (Some(lowered), false) = (outcome.lowered, diagnostics.has_errors()) else {
        return Err(diagnostics.into_sorted());
    };
    let modes = vibc::analysis::modes(&lowered.system).expect("modes of a small system");
    let poles = vibc::analysis::poles(&lowered.system, &modes).expect("poles of a small system");
    Ok(Answer { scene, lowered, modes, poles, remarks: diagnostics.into_sorted() })
}

/// The answer to a text that must be accepted.
pub fn ask(text: &str) -> Answer {
    try_ask(text).unwrap_or_else(|diagnostics| {
        let messages: Vec<String> = diagnostics.iter().map(|d| format!("{}: {}", d.code, d.message)).collect();
        panic!("refused:\n{}\n{text}", messages.join("\n"))
    })
}

/// The codes of the errors of a text that must be refused.
pub fn refusal(text: &str) -> Vec<String> {
    match try_ask(text) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(diagnostics) => diagnostics.iter().filter(|d| d.is_error()).map(|d| d.code.to_string()).collect(),
    }
}

impl Answer {
    /// Natural frequencies in rad/s, ascending; a divergence as minus its growth rate.
    pub fn omegas(&self) -> Vec<f64> {
        use vibc::analysis::ModeKind;
        let signed = |kind, omega: f64| if kind == ModeKind::Divergence { -omega } else { omega };
        self.modes.list.iter().map(|mode| signed(mode.kind, mode.omega.to_f64())).collect()
    }

    /// Natural frequencies in Hz.
    pub fn frequencies(&self) -> Vec<f64> {
        self.omegas().into_iter().map(|omega| omega / std::f64::consts::TAU).collect()
    }

    /// Real and imaginary parts of the poles.
    pub fn pole_values(&self) -> Vec<(f64, f64)> {
        self.poles.list.iter().map(|pole| (pole.re.to_f64(), pole.im.to_f64())).collect()
    }

    /// Component of a mode (counted from 1) for a coordinate by its name.
    pub fn shape(&self, mode: usize, coordinate: &str) -> f64 {
        let names = self.lowered.system.coordinate_names();
        let at = names.iter().position(|name| name == coordinate);
        self.modes.list[mode - 1].shape[at.unwrap_or_else(|| panic!("{coordinate} among {names:?}"))]
    }
}
