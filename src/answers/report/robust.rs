//! The worst case of an optimum within the tolerances.

use super::tolerances::{place_text, ranges};
use super::{Line, line};
use crate::base::{Ball, Number};
use crate::questions::answer::{Optimised, Robust, Throughout, WorstCase, outer_text, shown_in, shown_text};

/// Where a bound lies this share of it beyond what is reached, both are reported.
const FAR: f64 = 0.01;

/// `minimised the worst case of static(x): at most 0.12 m`
pub fn first_line(found: &Optimised, robust: &Robust) -> Line {
    let word = if found.highest { "maximised" } else { "minimised" };
    line![word, " the worst case of ", found.measure.clone(), ": ", size(found, &robust.worst)]
}

/// `at most 0.12 m`, or what was reached if that is all that is known.
fn size(found: &Optimised, worst: &WorstCase) -> Line {
    let most = if found.highest { "at least " } else { "at most " };
    match &worst.bound {
        Some((bound, _)) => {
            let shown = shown_in(&Number::Ball(*bound), &found.unit, false);
            line![most, format!("{} {}", outer_text(shown.number, !found.highest), shown.unit).trim_end().to_string()]
        }
        None => line![few_digits_of(found, worst.reached), " reached; worse values are not excluded"],
    }
}

pub fn lines(found: &Optimised, robust: &Robust) -> Vec<Line> {
    let reached = few_digits_of(found, robust.worst.reached);
    let nominal: Vec<String> = (found.parameters.iter().zip(&robust.nominal))
        .map(|(own, si)| format!("{}\u{a0}=\u{a0}{}", own.parameter, shown_text(&shown_in(si, &own.unit, false))))
        .collect();
    let best = if found.highest { "largest" } else { "least" };
    let there = match &robust.nominal_worst {
        Some(worst) if is_far(worst) => {
            line![
                "its worst case is ",
                size(found, worst),
                ", and ",
                few_digits_of(found, worst.reached),
                " is reached"
            ]
        }
        Some(worst) => line!["its worst case is ", size(found, worst)],
        None => "there it has no value at some values within the tolerances".into(),
    };
    let mut list = vec![
        line!["for all values within ", ranges(&robust.parameters)],
        line!["the worst that is reached is ", reached, ", at ", place_text(&robust.parameters, &robust.worst.at)],
        line!["at the values of the model it is ", few_digits_of(found, found.value)],
        line![
            best,
            " for the values of the model, ",
            few_digits_of(found, robust.nominal_value),
            ", it is at ",
            nominal.join(", "),
            ": ",
            there
        ],
    ];
    for (condition, everywhere) in robust.conditions.iter().zip(&robust.worst.conditions) {
        if matches!(everywhere, Throughout::Undetermined) {
            let text = condition.clone();
            list.push(line![text, " does not fail where it was looked at; that it holds everywhere is not proved"]);
        }
    }
    if !robust.worst.decays {
        list.push("that no free motion grows is not proved for all values".into());
    }
    list
}

/// Whether the bound says less about a worst case than what is reached.
fn is_far(worst: &WorstCase) -> bool {
    let far = |(bound, _): &(Ball, _)| (*bound - worst.reached).magnitude() > FAR * worst.reached.magnitude();
    worst.bound.as_ref().is_some_and(far)
}

fn few_digits_of(found: &Optimised, ball: Ball) -> String {
    shown_text(&shown_in(&Number::Ball(ball), &found.unit, false))
}
