//! The density of an output under several independent noises as a single square |G|^2 between the frequencies at which
//! a density changes its course: a sum of squared polynomials, whose zeros are those of G. In: a small system of
//! rational numbers, noises. Out: G for each range of frequencies. See docs/method/random.md#peaks.

use super::quotient::square_on_axis;
use crate::analysis::transfer::extrema::{Exactly, Factored, Quotient};
use crate::base::density::{Band, Course};
use crate::base::{Ball, Density, Number, OrderBy, Rational};
use crate::kernel::polynomial::Polynomial;
use crate::system::{LinearSystem, Noise, Output};
use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::One;
use std::cmp::Ordering;

const LARGE: &str = "peaks under several noises are found in up to 12 coordinates whose numbers are fractions";
const SLOPES: &str = "peaks under several noises are found where all densities have one slope that is a whole number";

/// G without its power of the frequency, and that power, between two frequencies in Hz; under white noise there is no
/// upper end.
pub struct Range {
    pub from: Number,
    pub to: Option<Number>,
    pub whole: Exactly,
    pub power: Ball,
}

/// The part of a noise in the density: the noise times |N|^2 w^(-2 derivative) / |D|^2.
struct Part<'a> {
    noise: &'a Noise,
    /// |N|^2 by powers of w^2.
    square: Vec<Rational>,
}

/// In ascending frequency. `reaching`: noises with the inputs that each drives at the same time.
pub fn ranges(
    system: &LinearSystem,
    reaching: &[(&Noise, Vec<(usize, Number)>)],
    output: &Output,
) -> Result<Vec<Range>, &'static str> {
    let (mut parts, mut below) = (Vec::new(), Vec::new());
    for (noise, inputs) in reaching {
        let inputs: Vec<usize> = inputs.iter().map(|(input, _)| *input).collect();
        let quotient = Quotient::of(system, &inputs, output).ok_or(LARGE)?;
        if quotient.above.is_zero() {
            continue;
        }
        let factor = &quotient.factor * &quotient.factor;
        let square = square_on_axis(&quotient.above).iter().map(|a| a * &factor).collect();
        parts.push(Part { noise, square });
        below = square_on_axis(&quotient.below);
    }
    let below = clear_denominators(&below);
    let mut list = Vec::new();
    let edges = edges(parts.iter().map(|part| part.noise)).ok_or(SLOPES)?;
    for (i, from) in edges.iter().enumerate() {
        let to = edges.get(i + 1);
        let Some((above, power)) = sum(&parts, from, to)? else { continue };
        let whole = Factored::of_square(&above, &below).and_then(|factored| Exactly::of(&factored)).ok_or(LARGE)?;
        list.push(Range { from: from.clone(), to: to.cloned(), whole, power });
    }
    Ok(list)
}

/// 0 Hz and the ends of all bands, ascending; `None` if numbers do not decide their order.
pub fn edges<'a>(noises: impl Iterator<Item = &'a Noise>) -> Option<Vec<Number>> {
    let mut list = vec![Number::ZERO];
    for noise in noises {
        if let Density::Bands(bands) = &noise.density {
            list.extend(bands.iter().flat_map(|band| [band.from.clone(), band.to.clone()]));
        }
    }
    if list.iter().any(|edge| edge.exact().is_none()) {
        return None;
    }
    list.order_by(|a, b| a.compare(b).unwrap_or(Ordering::Equal));
    list.dedup();
    Some(list)
}

/// |G|^2 times |D|^2 and a power of w: a polynomial in w^2, and half of that power. `None` if there is no noise.
fn sum(parts: &[Part], from: &Number, to: Option<&Number>) -> Result<Option<(Polynomial, Ball)>, &'static str> {
    let most = parts.iter().map(|part| part.noise.derivative).max().unwrap_or(0);
    let mut whole: Vec<Rational> = Vec::new();
    let mut common = None;
    for Part { noise, square } in parts {
        let Some((size, slope)) = course(&noise.density, from, to)? else { continue };
        if size.is_zero() {
            continue;
        }
        if common.is_some_and(|common| common != slope) {
            return Err(SLOPES);
        }
        common = Some(slope);
        let later = usize::from(most - noise.derivative);
        whole.resize(whole.len().max(square.len() + later), Rational::ZERO);
        for (sum, a) in whole[later..].iter_mut().zip(square) {
            *sum = &*sum + &(a * &size);
        }
    }
    let Some(slope) = common else { return Ok(None) };
    Ok(Some((clear_denominators(&whole), Ball::from(0.5 * f64::from(slope) - f64::from(most)))))
}

/// The band that contains the range between two neighbouring edges.
pub fn band_between<'a>(bands: &'a [Band], from: &Number, to: &Number) -> Option<&'a Band> {
    let holds = |low: &Number, high: &Number| matches!(low.compare(high), Some(Ordering::Less | Ordering::Equal));
    bands.iter().find(|band| holds(&band.from, from) && holds(to, &band.to))
}

/// A density as size f^slope between two edges; `None` if it is zero.
fn course(density: &Density, from: &Number, to: Option<&Number>) -> Result<Option<(Rational, i32)>, &'static str> {
    let known = |size: Number, slope: i32| size.exact().cloned().map(|size| Some((size, slope))).ok_or(SLOPES);
    let bands = match density {
        Density::White(size) => return known(size.clone(), 0),
        Density::Bands(bands) => bands,
    };
    let Some(band) = to.and_then(|to| band_between(bands, from, to)) else { return Ok(None) };
    match &band.course {
        Course::Flat(size) => known(size.clone(), 0),
        Course::Power { low, slope: Some(slope), .. } => {
            let at_one = band.from.powi(*slope).and_then(|power| low.checked_div(&power)).ok_or(SLOPES)?;
            known(at_one, *slope)
        }
        Course::Power { slope: None, .. } | Course::Line { .. } => Err(SLOPES),
    }
}

/// A polynomial with integer coefficients that has the same roots.
fn clear_denominators(list: &[Rational]) -> Polynomial {
    let big: Vec<_> = list.iter().map(Rational::to_big).collect();
    let common = big.iter().fold(BigInt::one(), |common, a| common.lcm(a.denom()));
    Polynomial::new(big.iter().map(|a| a.numer() * (&common / a.denom())).collect()).primitive()
}
