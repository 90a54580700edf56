//! Checks whether the answers are as accurate as requested. In: certified modes and poles, the request. Out: the least
//! accurate number that is not, with the bound that was reached. See docs/method/modes.md#requested-accuracy.

use crate::analysis::answer::{ModeKind, Modes, PoleKind, Poles};
use crate::analysis::error::place;
use crate::analysis::modes::request::Request;
use crate::base::{Code, Diagnostic, Span};
use crate::system::{CoordinateId, LinearSystem};

const CODE: Code = Code::limit("vib::limit::tolerance");

/// The number farthest from being accurate enough, and how many others are not either.
#[derive(Clone, Debug, PartialEq)]
pub struct Shortfall {
    /// The number in words: `the frequency of mode 3`.
    what: String,
    /// Its relative bound.
    reached: f64,
    /// Frequencies and poles that are not accurate enough, this one among them.
    short: [usize; 2],
    tolerance: f64,
    /// Whether a user set the tolerance.
    asked: bool,
    /// The coordinate that leads a mode's shape, and its place; for a pole, the first coordinate.
    moving: Option<usize>,
    at: Span,
}

/// The worst relative bound above the tolerance, if there is one. The verdict already covers numbers whose sign is not
/// certain, so they count only if a tolerance was requested.
pub fn shortfall(system: &LinearSystem, modes: &Modes, poles: &Poles, request: &Request) -> Option<Shortfall> {
    let (tolerance, asked) = (request.limit(), request.asked.is_some());
    let frequencies = modes.with_numbers().filter(|(_, mode)| asked || mode.kind != ModeKind::Undetermined);
    let frequencies = frequencies.map(|(number, mode)| {
        let moving = mode.leading.map_or(0, CoordinateId::index);
        (mode.omega.relative_error(), format!("the frequency of mode {number}"), Some(moving))
    });
    // Numbered as in the report, where a pair counts once. Without damping, the poles are the frequencies again.
    let upper = poles.list.iter().filter(|pole| pole.im.mid.hi >= 0.0 && !system.c.is_empty());
    let decays = (1..).zip(upper).filter(|(_, pole)| asked || pole.kind != PoleKind::Undetermined);
    let decays = decays.map(|(number, pole)| (pole.relative_error, format!("pole {number}"), None));
    let short = |bound: f64| bound.is_nan() || bound > tolerance;
    let all: Vec<_> = frequencies.chain(decays).filter(|(bound, ..)| short(*bound)).collect();
    let of_modes = all.iter().filter(|(.., moving)| moving.is_some()).count();
    let short = [of_modes, all.len() - of_modes];
    let worst = all.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    worst.map(|(reached, what, moving)| Shortfall {
        what,
        reached,
        short,
        tolerance,
        asked,
        moving,
        at: place(system, moving.unwrap_or(0)),
    })
}

impl Shortfall {
    /// An error if the tolerance was requested, otherwise a warning; the answer is available in any case.
    pub fn to_diagnostic(&self) -> Diagnostic {
        let reached = if self.reached.is_finite() {
            format!("to {} of itself", round_up_to_two_digits(self.reached))
        } else {
            "to no digit".to_string()
        };
        let mut message = format!("{} is certain {reached}, but not to {:e}", self.what, self.tolerance);
        let others = others(self.short, self.moving.is_some());
        if !others.is_empty() {
            message += &format!("; neither {others}");
        }
        let help = "terms that nearly cancel, or roots and angles (enclosed in double-double), leave no more digits; write what \
                    cancels without them, or say with `--tolerance` what is good enough";
        let diagnostic = match self.asked {
            true => Diagnostic::error(CODE, self.at, message),
            false => Diagnostic::warning(CODE, self.at, message),
        };
        match self.moving {
            Some(_) => diagnostic.label("this has the largest displacement in it").help(help),
            None => diagnostic.help(help),
        }
    }
}

/// Of frequencies and poles that are not accurate enough those beside one of them, a frequency or a pole: `are 3 others, nor are 2 poles`.
fn others([frequencies, poles]: [usize; 2], beside_frequency: bool) -> String {
    let (frequencies, poles) = if beside_frequency { (frequencies - 1, poles) } else { (frequencies, poles - 1) };
    let verb = |count: usize| if count == 1 { "is" } else { "are" };
    let own = |count: usize| format!("{} {count} other{}", verb(count), if count == 1 { "" } else { "s" });
    let kind = |count: usize, one: &str, many: &str| {
        format!("{} {count} {}", verb(count), if count == 1 { one } else { many })
    };
    let parts = match beside_frequency {
        true => [(frequencies, own(frequencies)), (poles, kind(poles, "pole", "poles"))],
        false => [(poles, own(poles)), (frequencies, kind(frequencies, "frequency", "frequencies"))],
    };
    let parts: Vec<String> = parts.into_iter().filter(|(count, _)| *count > 0).map(|(_, words)| words).collect();
    parts.join(", nor ")
}

/// Two digits, rounded up.
fn round_up_to_two_digits(value: f64) -> String {
    format!("{:.1e}", value * 1.06)
}

#[cfg(test)]
mod tests {
    use super::{others, round_up_to_two_digits};

    #[test]
    fn others_are_counted() {
        assert_eq!(others([1, 0], true), "");
        assert_eq!(others([20, 0], true), "are 19 others");
        assert_eq!(others([2, 2], true), "is 1 other, nor are 2 poles");
        assert_eq!(others([2, 2], false), "is 1 other, nor are 2 frequencies");
    }

    #[test]
    fn an_accuracy_bound_is_rounded_upwards() {
        for value in [1e-12, 9.99e-7, 1.04e-3, 0.5, 7.77e-31] {
            let reported: f64 = round_up_to_two_digits(value).parse().expect("a number");
            assert!(reported >= value && reported <= 1.12 * value, "{value}: {reported}");
        }
    }
}
