//! The settings that a scene has at most once: its name, gravity, damping, and whether it rests as drawn. See spec.md.

use super::Check;
use super::error::{NameError, PartError, ValueError};
use super::evaluate::Evaluated;
use super::expect::Expected;
use super::scene::Damping;
use super::scope::{Environment, Instance};
use super::value::{Value, Vector};
use crate::base::{Dimension, Number, Span, Vec3};
use crate::syntax::tree::{DeclKind, ExprId, ExprList, Rare};

const FREE_FALL: Expected = Expected::new("an acceleration", Dimension::ACCELERATION, "gravity 9.81 m/s^2");
const DAMPING_RATIO: Expected = Expected::new("a damping ratio", Dimension::NONE, "damping modal 2 %");
const ALPHA: Expected = Expected::new("a rate", Dimension::FREQUENCY, "0.1 /s");
const BETA: Expected = Expected::new("a time", Dimension::TIME, "1e-4 s");

/// The place of the first declaration of each setting.
#[derive(Debug, Default)]
struct Declared {
    model: Option<Span>,
    gravity: Option<Span>,
    damping: Option<Span>,
    rest: Option<Span>,
}

impl<'a> Check<'a> {
    pub fn settings(&mut self) {
        let mut declared = Declared::default();
        for index in 0..self.instances.settings.len() {
            let Instance { decl, environment } = self.instances.settings[index];
            let (place, what) = match self.kind_of_setting(decl.kind) {
                Setting::Model => (&mut declared.model, "the model's name"),
                Setting::Gravity => (&mut declared.gravity, "gravity"),
                Setting::Damping => (&mut declared.damping, "damping"),
                Setting::Rest => (&mut declared.rest, "the rest"),
            };
            if let Some(first) = *place {
                self.report(environment, NameError::SettingTwice { span: decl.span, first, what });
                continue;
            }
            *place = Some(decl.span);
            // An error has been reported; nothing else depends on a setting.
            let _ = self.setting(decl.kind, decl.span, environment);
        }
    }

    fn kind_of_setting(&self, decl: DeclKind) -> Setting {
        match decl {
            DeclKind::Model { .. } => Setting::Model,
            DeclKind::Rare { index } => match self.tree.rare[index as usize] {
                Rare::RestAsDrawn => Setting::Rest,
                _ => Setting::Damping,
            },
            _ => Setting::Gravity,
        }
    }

    fn setting(&mut self, decl: DeclKind, span: Span, environment: Environment) -> Evaluated<()> {
        match decl {
            DeclKind::Model { name } => self.scene.name = self.sources.slice(name).to_string(),
            DeclKind::Gravity { value } => {
                self.scene.gravity = self.gravity(value, environment)?;
                self.scene.gravity_span = Some(span);
            }
            DeclKind::Rare { index } => match self.tree.rare[index as usize] {
                Rare::RestAsDrawn => self.scene.rest_as_drawn = Some(span),
                Rare::DampingModal { ratio } => {
                    let at = self.tree.expr(ratio).span;
                    let ratio = self.number(ratio, environment, &DAMPING_RATIO)?;
                    self.unusual_ratio(&ratio, at, environment);
                    self.scene.damping = Some(Damping::Modal { ratio, span });
                }
                Rare::DampingRayleigh { arguments } => {
                    self.scene.damping = Some(self.rayleigh(arguments, span, environment)?);
                }
                _ => {}
            },
            _ => {}
        }
        Ok(())
    }

    /// A number points along -y; a vector gives the direction itself.
    fn gravity(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Vec3> {
        let value = self.evaluate(expr, environment)?;
        let Value::Vector(Vector { si, dimension }) = value else {
            let number = self.as_number(&value, expr, environment, &FREE_FALL)?;
            return Ok(Vec3::Y.scale(&-&number));
        };
        match dimension {
            Some(found) if found != Dimension::ACCELERATION => Err(self.mismatch(found, expr, environment, &FREE_FALL)),
            _ => {
                self.check_range(&si.x, expr, environment)?;
                self.check_range(&si.y, expr, environment)?;
                Ok((*si).clone())
            }
        }
    }

    fn rayleigh(&mut self, arguments: ExprList, span: Span, environment: Environment) -> Evaluated<Damping> {
        let tree = self.tree;
        let &[alpha, beta] = tree.list(arguments) else {
            let found = tree.list(arguments).len();
            return self
                .fail(environment, ValueError::ArgumentCount { span, function: "rayleigh", expected: 2, found });
        };
        let places = [alpha, beta].map(|expr| tree.expr(expr).span);
        let alpha = self.of_radians(alpha, environment, &ALPHA);
        let beta = self.of_radians(beta, environment, &BETA)?;
        let alpha = alpha?;
        for (number, span) in [&alpha, &beta].into_iter().zip(places) {
            if number.is_negative() {
                self.report(environment, PartError::DampingFeeds { span });
            }
        }
        Ok(Damping::Rayleigh { alpha, beta, span })
    }

    /// A rate, or a time, that belongs to angular frequencies, with a warning if a frequency in cycles went into it.
    fn of_radians(&mut self, expr: ExprId, environment: Environment, expected: &Expected) -> Evaluated<Number> {
        let value = self.evaluate(expr, environment)?;
        let number = self.as_number(&value, expr, environment, expected)?;
        let cycles = self.as_scalar(&value, expr, environment, expected)?.cycles;
        if cycles != 0.0 {
            self.report_cycles(number.to_f64(), expr, environment, expected);
        }
        Ok(number)
    }

    /// Reports the reading of a ratio that was probably not intended: `2` for 2 %, or a negative sign.
    fn unusual_ratio(&mut self, ratio: &Number, span: Span, environment: Environment) {
        if ratio.is_negative() {
            self.report(environment, PartError::DampingFeeds { span });
        } else if !(&Number::ONE - ratio).is_positive() {
            self.report(environment, PartError::DampingOverCritical { span, ratio: ratio.to_f64() });
        }
    }
}

enum Setting {
    Model,
    Gravity,
    Damping,
    Rest,
}
