//! Orders of a rate of rotation: the frequencies n times the rate, and the places where the curves have them, as in a
//! Campbell diagram. In: the frequencies at all places. Out: the critical rates. See docs/method/studies.md#orders.

use super::Member;
use super::meetings::{Two, enclose, passages};
use super::places::{Field, Place};
use crate::analysis::derived::hertz;
use crate::base::{Angle, Ball, Dimension, Number, Quantity};
use crate::questions::followed::{Critical, Orders};

/// The cycles per second of a rate of rotation in SI units; `None` for other quantities.
fn cycles(rate: &Quantity) -> Option<fn(Ball) -> Ball> {
    match rate.angle {
        _ if rate.dimension != Dimension::FREQUENCY => None,
        Angle::Radians => Some(hertz),
        Angle::Cycles => Some(|rate| rate),
        _ => None,
    }
}

pub fn is_rate(quantity: &Quantity) -> bool {
    cycles(quantity).is_some()
}

/// The places where the curves have the frequencies of these orders of the parameter.
pub fn orders(field: &Field, places: &[&Place], curves: &[Member], rate: &Quantity, list: &[u32]) -> Orders {
    let Some(cycles) = cycles(rate) else { return Orders::default() };
    let mut critical = Vec::new();
    for &order in list {
        let frequency = |at: &Number| cycles(at.to_ball()) * Ball::from(f64::from(order));
        for (curve, own) in curves.iter().enumerate() {
            let side = |place: &Place| {
                let (own, ordered) = (place.frequency(own.class, own.index)?, frequency(&place.at));
                let apart = own - ordered;
                match (apart.is_positive(), apart.is_negative()) {
                    _ if own.is_zero() && ordered.is_zero() => None,
                    (false, false) => Some(None),
                    (above, _) => Some(Some(above)),
                }
            };
            let two = Two { side: &side, value: &|ends| enclose(&field.bounds(ends), *own) };
            let passed = passages(field, places, &two).into_iter();
            critical.extend(passed.map(|found| Critical { curve, order, place: found.place, frequency: found.value }));
        }
    }
    Orders { list: list.to_vec(), critical, per_unit: cycles(Ball::ONE).to_f64() }
}
