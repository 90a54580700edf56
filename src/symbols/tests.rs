//! Identities of the algebra, checked against their known results.

use super::*;
use crate::base::{Number, Rational};

fn name(place: usize) -> Sum {
    Sum::name(Symbol::new(0, place))
}

#[test]
fn sums_and_products_are_canonical() {
    let (a, b) = (name(0), name(1));
    assert_eq!(&(&a + &b).square(), &(&(&a.square() + &b.square()) + &(&a * &b).scale(&Rational::from(2))));
    assert!((&(&a * &b) - &(&b * &a)).is_zero());
    assert_eq!(a.over(&a), Some(Sum::one()));
}

#[test]
fn sines_and_cosines_add_up() {
    let (a, b) = (name(0), name(1));
    assert_eq!(&a.sine().square() + &a.cosine().square(), Sum::one());
    let addition = &(&a.sine() * &b.cosine()) + &(&a.cosine() * &b.sine());
    assert_eq!(addition, (&a + &b).sine());
    assert_eq!((-&a).sine(), -&a.sine());
    assert_eq!((&a + &Sum::pi()).cosine(), -&a.cosine());
    assert_eq!((&Sum::pi().halve() - &a).sine(), a.cosine());
}

#[test]
fn angles_of_whole_degrees_have_values() {
    let degrees = |d: i64| Sum::pi().scale(&Rational::new(d, 180));
    assert_eq!(degrees(30).sine().evaluate(), Sum::fraction(1, 2));
    assert_eq!(degrees(60).sine().square().evaluate(), Sum::fraction(3, 4));
    assert_eq!(degrees(-45).sine().square(), Sum::fraction(1, 2));
    assert_eq!(degrees(120).cosine().evaluate(), Sum::fraction(-1, 2));
    assert_eq!(&degrees(40).sine() * &degrees(40).sine(), &Sum::fraction(1, 2) - &degrees(80).cosine().halve());
    // 30 degrees before the axis is 60 behind the other one.
    let (a, arm) = (name(0), [degrees(60).sine(), -&degrees(60).cosine()]);
    let turned = &(&arm[0] * &a.cosine()) - &(&arm[1] * &a.sine());
    assert_eq!(turned, (&a + &degrees(60)).sine());
    for d in -720..720 {
        let (sine, cosine) = (degrees(d).sine(), degrees(d).cosine());
        let value = |sum: &Sum| sum.value(&|_| None).expect("no names").to_f64();
        assert!((value(&sine) - f64::from(d as i32).to_radians().sin()).abs() < 1e-12, "{d}");
        assert!((value(&cosine) - f64::from(d as i32).to_radians().cos()).abs() < 1e-12, "{d}");
    }
}

#[test]
fn quotients_of_sums_cancel() {
    let (a, b) = (name(0), name(1));
    let sum = &a + &b;
    let whole = &(&a * &sum.inverse().unwrap()) + &(&b * &sum.inverse().unwrap());
    assert!((&whole - &Sum::one()).vanishes());
    assert!(!(&whole + &Sum::one()).vanishes());
    let twice = sum.scale(&Rational::from(2));
    assert_eq!(twice.inverse().unwrap(), sum.inverse().unwrap().halve());
}

#[test]
fn roots_square_back() {
    let (a, b) = (name(0), name(1));
    let root = (&a.square() + &b).root();
    assert_eq!(root.square(), &a.square() + &b);
    assert_eq!(Sum::number(Rational::from(12)).root(), Sum::number(Rational::from(3)).root().scale(&Rational::from(2)));
    let square = (&(&a + &b) - &Sum::fraction(1, 2)).square();
    let found = square.exact_root().expect("a square");
    assert_eq!(found.square(), square);
    assert_eq!((&square + &Sum::one()).exact_root(), None);
    assert!((&(&root * &root.inverse().unwrap()) - &Sum::one()).vanishes());
}

#[test]
fn derivatives_are_those_of_calculus() {
    let lengths = Lengths::default();
    let (a, b) = (name(0), name(1));
    let by = Symbol::new(0, 0);
    let function = &(&a.square() * &(&a * &b).sine()) + &(&a + &b).root();
    let derivative = function.derivative(by, &lengths);
    let at = |sum: &Sum, x: f64| {
        let value = |symbol: Symbol| Number::from(Rational::from_f64(if symbol == by { x } else { 0.7 }).unwrap());
        sum.value(&|symbol| Some(value(symbol))).unwrap().to_f64()
    };
    // Central difference with a step of 1e-5: error about 1e-10.
    let (x, h) = (0.3, 1e-5);
    assert!((at(&derivative, x) - (at(&function, x + h) - at(&function, x - h)) / (2.0 * h)).abs() < 1e-8);
    let length = Symbol::new(9, 0);
    let lengths = Lengths(vec![(length, Dependence::Root(&a.square() + &b))]);
    let by_name = Sum::name(length).derivative(by, &lengths);
    assert_eq!(by_name, &a * &Sum::name(length).inverse().unwrap());
}

#[test]
fn common_factors_are_factored_out() {
    let (a, b, c) = (name(0), name(1), name(2));
    let sum = &(&(&a * &c) + &(&b * &c)).scale(&Rational::from(-2)) + &Sum::ZERO;
    let factored = common_factors(&sum);
    assert_eq!(factored.number, Rational::from(-2));
    assert_eq!(factored.rest, &a + &b);
    let square = &(&a + &b).square() * &c;
    let factored = common_factors(&square);
    assert!(factored.squared && factored.rest == &a + &b);
}

#[test]
fn quotients_without_remainder_are_sums() {
    let (a, b) = (name(0), name(1));
    let sum = &a + &b;
    let quotient = (&(&sum.square() * &a) * &sum.inverse().unwrap()).simplify();
    assert_eq!(quotient, &sum * &a);
    let left = (&(&a + &Sum::one()) * &sum.inverse().unwrap()).simplify();
    assert!((&(&left * &sum) - &(&a + &Sum::one())).vanishes());
}

/// a^2 - 2 a b + b^2 begins with the negative product in the order of terms.
#[test]
fn squares_of_differences_are_factored() {
    let [a, b, k] = [0, 1, 2].map(|place| Sum::name(Symbol::new(0, place)));
    let factored = common_factors(&(&k * &(&a - &b).square()));
    assert!(factored.squared && factored.number.is_one(), "{factored:?}");
    assert!(factored.rest == &a - &b || factored.rest == &b - &a, "{factored:?}");
}
