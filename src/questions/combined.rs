//! Arithmetic of measured numbers: `2 * frequency(1)`, `peak(a) - peak(b)`. In: an expression of measurements. Out: one
//! measurement, enclosed as its parts are. See docs/method/measures.md.

use crate::analysis::Measurement;
use crate::model::scene::{Arithmetic, Combined};

/// The value of an expression, or the reason why a part of it has none.
pub fn value_of(combined: &Combined<Measurement>) -> Measurement {
    match combined {
        Combined::Measure(measured) => measured.clone(),
        Combined::Number(number) => Measurement::Value(number.to_ball()),
        Combined::Negated(part) => match value_of(part) {
            Measurement::Value(value) => Measurement::Value(-value),
            Measurement::Infinite => INFINITE,
            other => other,
        },
        Combined::Binary { operator, left, right } => binary(*operator, value_of(left), value_of(right)),
    }
}

/// The result if an operand is infinite: a difference of two infinite numbers could be anything.
const INFINITE: Measurement = Measurement::None("one of its parts is infinite");

fn binary(operator: Arithmetic, left: Measurement, right: Measurement) -> Measurement {
    let (a, b) = match (left, right) {
        (Measurement::Value(a), Measurement::Value(b)) => (a, b),
        (Measurement::Infinite, Measurement::Value(_) | Measurement::Infinite)
        | (Measurement::Value(_), Measurement::Infinite) => return INFINITE,
        (Measurement::Value(_) | Measurement::Infinite, other) | (other, _) => return other,
    };
    Measurement::Value(match operator {
        Arithmetic::Add => a + b,
        Arithmetic::Subtract => a - b,
        Arithmetic::Multiply => a * b,
        Arithmetic::Divide if b.contains_zero() => {
            return Measurement::None("it divides by a number that may be zero");
        }
        Arithmetic::Divide => a / b,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Ball, Number};

    fn measure(value: f64) -> Combined<Measurement> {
        Combined::Measure(Measurement::Value(Ball::from(value).widen(0.25)))
    }

    fn combine_both(operator: Arithmetic, left: Combined<Measurement>, right: Combined<Measurement>) -> Measurement {
        value_of(&Combined::Binary { operator, left: Box::new(left), right: Box::new(right) })
    }

    /// The operands are only known to a quarter; the extreme values of the result lie in its enclosure.
    #[test]
    fn the_result_encloses_all_values_of_the_parts() {
        for (operator, ends) in [
            (Arithmetic::Add, [7.5, 8.5]),
            (Arithmetic::Subtract, [3.5, 4.5]),
            (Arithmetic::Multiply, [5.75 * 1.75, 6.25 * 2.25]),
            (Arithmetic::Divide, [5.75 / 2.25, 6.25 / 1.75]),
        ] {
            let Measurement::Value(found) = combine_both(operator, measure(6.0), measure(2.0)) else {
                panic!("a value")
            };
            assert!(ends.iter().all(|end| (found - Ball::from(*end)).mignitude() < 1e-15), "{operator:?} {found:?}");
        }
    }

    #[test]
    fn an_operand_without_a_value_gives_none() {
        let infinite = || Combined::Measure(Measurement::Infinite);
        let two = || Combined::Number(Number::from(2));
        assert_eq!(combine_both(Arithmetic::Subtract, infinite(), infinite()), INFINITE);
        assert_eq!(combine_both(Arithmetic::Add, two(), infinite()), INFINITE);
        assert!(matches!(combine_both(Arithmetic::Divide, two(), measure(0.1)), Measurement::None(_)));
        let none = || Combined::Measure(Measurement::None("no such mode"));
        assert_eq!(combine_both(Arithmetic::Add, infinite(), none()), Measurement::None("no such mode"));
        assert_eq!(combine_both(Arithmetic::Add, none(), two()), Measurement::None("no such mode"));
    }
}
