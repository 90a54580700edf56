//! What holds for all values within the tolerances. See docs/method/studies.md#tolerances.

use super::answer::few_digits;
use crate::base::{Ball, Number};
use crate::model::scene::Written;

/// What is known for all values within the tolerances. A place is a value for each parameter, SI, in their order.
#[derive(Clone, Debug)]
pub struct Tolerated {
    /// The parameters that have a range, and that nothing determines.
    pub parameters: Vec<ToleratedParameter>,
    /// Where every frequency is least, and largest. `None` if that is not proved of any.
    pub corners: Option<[Vec<Number>; 2]>,
    /// Of the frequency of each undamped mode, Hz, in ascending order.
    pub frequencies: Vec<Range>,
    /// Of the damping ratio of each damped motion, as `damping(i)` counts them; empty if nothing damps.
    pub ratios: Vec<Range>,
    /// Of the real part, 1/s, and the imaginary part, rad/s, of each pole with im s >= 0, ascending in |s|; empty if nothing damps.
    pub poles: Vec<[Range; 2]>,
    /// Of the measure of each requirement, SI; `None` where it is a verdict, or has no value somewhere.
    pub measures: Vec<Option<Range>>,
    /// For each requirement.
    pub requirements: Vec<Throughout>,
    /// For each requirement why the values of its measure are not enclosed, where they never are.
    pub never: Vec<Option<&'static str>>,
    /// The number of places that were looked at.
    pub places: usize,
    /// Terms move with the rest, which is the one that the declared rest becomes as the values move; a search may end in another one.
    pub follows_rest: bool,
    /// Why ranges are not proved, where one thing is to blame.
    pub not_proved: Option<&'static str>,
}

/// A parameter with a range.
#[derive(Clone, Debug)]
pub struct ToleratedParameter {
    pub name: String,
    pub unit: Written,
    /// SI, the lower one first.
    pub ends: [Number; 2],
}

/// The values of a quantity.
#[derive(Clone, Debug)]
pub struct Range {
    /// Bounds of all values within the tolerances if that is proved, otherwise what was reached. `None` if there is no value at one of
    /// the places, as where a mode does not oscillate.
    pub ends: Option<[Ball; 2]>,
    /// The least and the largest that was reached.
    pub reached: Option<[Ball; 2]>,
    /// Where these are.
    pub at: Option<[Vec<Number>; 2]>,
    pub proof: Option<RangeProof>,
}

/// Why no value lies beyond the ends.
#[derive(Clone, Copy, Debug)]
pub enum RangeProof {
    /// The ends are reached, at corners.
    Corners(Proved),
    /// Bounds of so many boxes, which together are the whole.
    Boxes(usize, Proved),
}

/// Only `questions::tolerated` and `questions::follow` make it, or another proof.
#[derive(Clone, Copy, Debug)]
pub struct Proved(pub(in crate::questions) ());

impl From<super::answer::Everywhere> for Proved {
    fn from(_: super::answer::Everywhere) -> Proved {
        Proved(())
    }
}

/// Whether a requirement holds for all values within the tolerances.
#[derive(Clone, Debug)]
pub enum Throughout {
    Holds(Proved),
    /// It certainly fails at this place.
    FailsAt(Vec<Number>),
    Undetermined,
}

/// The worst case of an optimum over all values within the tolerances.
#[derive(Clone, Debug)]
pub struct Robust {
    /// The ranges with the values that were found: those of varied parameters move with them.
    pub parameters: Vec<ToleratedParameter>,
    pub worst: WorstCase,
    /// The best values for the declared ones of all others, in the order of the varied parameters, SI.
    pub nominal: Vec<Number>,
    /// The measure there for the declared values.
    pub nominal_value: Ball,
    /// The worst case there; `None` if the measure has no value at one of the places.
    pub nominal_worst: Option<WorstCase>,
    /// The conditions as written.
    pub conditions: Vec<String>,
    /// No values in the ranges have a better worst case.
    pub best_possible: Option<(Ball, Proved)>,
}

/// The largest value of a measure that is minimised, or the least of one that is maximised, over all values within the tolerances.
#[derive(Clone, Debug)]
pub struct WorstCase {
    /// The worst value that was reached, and the place.
    pub reached: Ball,
    pub at: Vec<Number>,
    /// No value is worse.
    pub bound: Option<(Ball, Proved)>,
    /// Whether each condition of the line holds.
    pub conditions: Vec<Throughout>,
    /// Whether it is proved that no free motion grows, if the measure is one of a response.
    pub decays: bool,
}

/// A binary64 number that no number of a ball exceeds, or goes below.
pub fn outer(ball: Ball, upper: bool) -> Ball {
    let sign = if upper { 1.0 } else { -1.0 };
    let end = sign * ball.mid.hi + ball.mid.lo.abs() + ball.rad;
    Ball::from(sign * end.next_up().next_up())
}

/// Such a number with six digits.
pub fn outer_text(ball: Ball, upper: bool) -> String {
    let end = outer(ball, upper).to_f64();
    let is_beyond = |text: &f64| if upper { *text >= end } else { *text <= end };
    let text = |x: f64| format!("{x:.5e}").parse::<f64>().ok();
    // Half a unit of the last digit, and a little, takes it to the next number of six digits.
    let step = text(end).map_or(0.0, |x| {
        format!("{x:e}").split_once('e').map_or(0.0, |(_, power)| format!("5.0001e{power}").parse().unwrap_or(0.0))
    }) * 1e-6;
    let further = if upper { end + step } else { end - step };
    [end, further].into_iter().filter_map(text).find(is_beyond).map_or_else(|| format!("{end:e}"), few_digits)
}
