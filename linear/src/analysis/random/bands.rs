//! Mean squares under noise in bands: the integral of |H|^2 S over frequencies. In: a density, the transfer function from its noise to
//! an output as residues at poles. Out: an enclosure. See docs/method/random.md#bands.

use super::argument::{Argument, Point, Two};
use super::resolvent::{Line, Nearness, Parts, Resolvent, Value};
use super::weight::{Panels, Piece, Slope};
use crate::base::density::{Band, Course, Density};
use crate::base::{Ball, Dd, Number, up};
use crate::kernel::complex::Complex;

const UP: f64 = up::THOUSANDS;
/// Number of bands whose series are kept in memory at a time.
const TOGETHER: usize = 256;

/// A density times a power of the angular frequency, integrated over every pole of a system.
pub struct Bands {
    /// Integrals over i w - D of each block and of its conjugate.
    of_poles: Vec<[Value; 2]>,
    /// Integrals over w^(2 m), m from -2 to 2; `None` if the integral does not exist, or is not known.
    even: [Option<Ball>; 5],
    /// A bound of the mean square of the noise itself.
    whole: f64,
    near: Nearness,
    /// Integrals over (i w - s_b) (i w + conj s_c) of the pairs of poles that these bands cannot tell apart, and of
    /// their conjugates.
    of_close: Vec<[Point; 2]>,
}

impl Bands {
    /// The density times w^more, of white noise between two frequencies, Hz.
    pub fn of(density: &Density, within: Option<[&Number; 2]>, more: i32, resolvent: &Resolvent) -> Option<Bands> {
        let pieces = pieces(density, within)?;
        let starts_at_zero = pieces.iter().any(|piece| !piece.from.is_positive());
        let even = [-4, -2, 0, 2, 4].map(|power| {
            if power < 0 && starts_at_zero {
                return None;
            }
            pieces
                .iter()
                .try_fold(Ball::ZERO, |sum, piece| Some(sum + piece.panels(more + power, Ball::ZERO)?.integral().re))
        });
        let whole = even[2]?.magnitude() * UP;
        let ranges: Vec<[Ball; 2]> = pieces.iter().map(|piece| [piece.from, piece.to]).collect();
        let near = resolvent.within(&ranges)?;
        let close = resolvent.close_pairs(&near);
        let mut of_poles: Vec<[Value; 2]> = Vec::new();
        let mut of_close = vec![[Complex::ZERO; 2]; close.len()];
        in_parts(&pieces, more, Ball::ZERO, |panels| {
            add_values(&mut of_poles, panels, resolvent);
            for (sum, (pair, corner)) in of_close.iter_mut().zip(&close) {
                let divided = |pair: Two| over(panels, pair).0[0][1].scale(Ball::ONE / *corner);
                *sum = [sum[0] + divided(*pair), sum[1] + divided(pair.conj())];
            }
        })?;
        Some(Bands { of_poles, even, whole, near, of_close })
    }

    /// The distances of the bands from the poles.
    pub fn nearness(&self) -> &Nearness {
        &self.near
    }

    /// A bound of the mean square of the noise itself, times 2 pi.
    pub fn whole(&self) -> f64 {
        self.whole
    }

    /// The integral of |H|^2 over angular frequencies, and a bound of its error.
    pub fn integral(&self, resolvent: &Resolvent, parts: &Parts) -> Option<(Ball, f64)> {
        let square = resolvent.square(parts, &self.near);
        let two = Ball::from(2.0);
        let mut sum = Ball::ZERO;
        for (b, ((p, g), [direct, mirrored])) in square.rows.iter().zip(&square.columns).zip(&self.of_poles).enumerate()
        {
            let mut part = direct.between(p, g).re;
            if !resolvent.is_real(b) {
                let conj = |x: &[Point]| x.iter().map(|z| z.conj()).collect::<Vec<Point>>();
                part = part + mirrored.between(&conj(p), &conj(g)).re;
            }
            sum = sum + part * two;
        }
        for (factor, [direct, mirrored]) in resolvent.close_factors(parts, &self.near).into_iter().zip(&self.of_close) {
            sum = sum + (factor * *direct).re + (factor.conj() * *mirrored).re;
        }
        for (direct, integral) in square.direct.iter().zip(&self.even) {
            if !direct.is_zero() {
                sum = sum + *direct * (*integral)?;
            }
        }
        // |H|^2 is off by 2 |H| e + e^2 at most; the mean of the first is bounded by Schwarz's inequality.
        let (size, whole, slack) = (sum.magnitude(), self.whole, square.slack);
        let off = (2.0 * slack * size.sqrt() * whole.sqrt() + slack * slack * whole) * UP;
        Some((sum, off))
    }
}

/// A mean square from an integral over angular frequencies and its error bound.
pub fn to_mean_square(integral: Ball, off: f64) -> Option<Ball> {
    let value = integral.widen(off) / (Ball::PI * Ball::from(2.0));
    if !value.is_finite() {
        return None;
    }
    // A mean square is not negative.
    Some(if value.mid.hi < 0.0 { Ball::new(Dd::ZERO, value.magnitude()) } else { value })
}

impl Bands {
    /// The contribution of each mode to the mean square: the integral of re H_i conj H S, in binary64. Noise that
    /// reaches the output directly belongs to no mode.
    pub fn contributions(&self, resolvent: &Resolvent, lines: &[Line], direct: &[Ball; 5]) -> Option<Vec<f64>> {
        let integrals = of_lines(&self.of_poles, resolvent)?;
        let direct = direct.map(|factor| factor.to_f64());
        // H_i conj H by partial fractions: H(-s) at the poles of H_i, and H_i(-s) at those of H.
        let weight = |at: &Line, integral: Complex<f64>| {
            let sum = lines.iter().zip(&integrals).fold(Complex::ZERO, |sum: Complex<f64>, (line, other)| {
                sum - line.p * line.q * (integral + *other) * (at.s + line.s).recip()
            });
            (sum + laurent(&direct, at.s) * integral) * at.q
        };
        let weights: Vec<Complex<f64>> = lines.iter().zip(&integrals).map(|(line, i)| weight(line, *i)).collect();
        let even = |place: usize| self.even[place].map_or(0.0, |integral| integral.to_f64());
        let of_mode = |i: usize| {
            let each = lines.iter().zip(&weights).map(|(line, weight)| {
                let by_q = line.of_modes[i] * line.q;
                let plain = (line.of_modes[i] * *weight).re - direct[3] * by_q.re * even(2);
                plain + direct[4] * (by_q * line.s).re * even(2) + direct[0] * (by_q * line.s.recip()).re * even(1)
            });
            each.sum::<f64>() / (2.0 * std::f64::consts::PI)
        };
        Some((0..lines.first()?.of_modes.len()).map(of_mode).collect())
    }
}

/// Integrals over poles in binary64, in the order of the lines: each conjugate comes before its pole.
pub fn of_lines(of_poles: &[[Value; 2]], resolvent: &Resolvent) -> Option<Vec<Complex<f64>>> {
    let mut integrals = Vec::with_capacity(2 * of_poles.len());
    for (b, [own, mirrored]) in of_poles.iter().enumerate() {
        let (Value::One(own), Value::One(mirrored)) = (own, mirrored) else { return None };
        if !resolvent.is_real(b) {
            integrals.push(mirrored.to_f64());
        }
        integrals.push(own.to_f64());
    }
    Some(integrals)
}

/// The sum of factors of s^-2 .. s^2 at -s.
pub fn laurent(factors: &[f64; 5], s: Complex<f64>) -> Complex<f64> {
    let [a, b, c, d, e] = factors.map(Complex::real);
    let inverse = s.recip();
    (a * inverse - b) * inverse + c - (d - e * s) * s
}

/// Cuts power laws, times w^more and the phase of a delay, into panels, a few at a time to limit the memory that a long
/// table takes; `None` if numbers leave their range.
pub fn in_parts(pieces: &[Piece], more: i32, delay: Ball, mut each: impl FnMut(&[Panels])) -> Option<()> {
    pieces.chunks(TOGETHER).try_for_each(|some| {
        let panels: Vec<Panels> = some.iter().map(|piece| piece.panels(more, delay)).collect::<Option<_>>()?;
        each(&panels);
        Some(())
    })
}

/// Adds the integrals over i w - D of each block and of its conjugate.
pub fn add_values(sums: &mut Vec<[Value; 2]>, panels: &[Panels], resolvent: &Resolvent) {
    for (place, part) in resolvent.values(|s| over(panels, s), |s| over(panels, s)).enumerate() {
        match sums.get_mut(place) {
            Some(sum) => *sum = [0, 1].map(|i| sum[i].plus(part[i])),
            None => sums.push(part),
        }
    }
}

/// The integral of power laws over i w - D.
pub fn over<A: Argument>(panels: &[Panels], d: A) -> A {
    panels.iter().fold(A::of(Complex::ZERO), |sum, panels| sum.plus(panels.over(d)))
}

/// Whether a band of the density begins at 0 Hz; `None` if numbers leave their range or do not decide it.
pub fn starts_at_zero(density: &Density, within: Option<[&Number; 2]>) -> Option<bool> {
    let pieces = pieces(density, within)?;
    let is_decided = pieces.iter().all(|piece| piece.from.is_zero() || piece.from.is_positive());
    is_decided.then(|| pieces.iter().any(|piece| piece.from.is_zero()))
}

/// The power laws that a density consists of. `None` for white noise without limits, and if numbers leave their range.
pub fn pieces(density: &Density, within: Option<[&Number; 2]>) -> Option<Vec<Piece>> {
    let white;
    let bands = match (density, within) {
        (Density::Bands(bands), _) => bands,
        (Density::White(value), Some([from, to])) => {
            white = vec![Band { from: from.clone(), to: to.clone(), course: Course::Flat(value.clone()) }];
            &white
        }
        (Density::White(_), None) => return None,
    };
    let mut list = Vec::new();
    for band in bands {
        let (from, to) = match within {
            Some([low, high]) => (outer(&band.from, low, true), outer(&band.to, high, false)),
            None => (band.from.to_ball(), band.to.to_ball()),
        };
        let is_empty = !(to - from).is_positive();
        if is_empty {
            if (from - to).is_positive() || (to - from).is_zero() {
                continue;
            }
            return None;
        }
        list.extend(laws(band)?.into_iter().filter(|law| !law.0.is_zero()).map(|(size, reference, slope)| Piece {
            from: angular(from),
            to: angular(to),
            size,
            reference: angular(reference),
            slope,
        }));
    }
    Some(list)
}

/// Sizes, reference frequencies and slopes of the power laws whose sum a band is.
fn laws(band: &Band) -> Option<Vec<(Ball, Ball, Slope)>> {
    let slope = |slope: Number| match slope.exact().and_then(|slope| slope.to_i64()) {
        Some(slope) => i32::try_from(slope).map_or(Slope::Real(Ball::from(slope as f64)), Slope::Whole),
        None => Slope::Real(slope.to_ball()),
    };
    Some(match &band.course {
        Course::Flat(value) => vec![(value.to_ball(), Ball::ONE, Slope::Whole(0))],
        Course::Power { low, .. } => vec![(low.to_ball(), band.from.to_ball(), slope(band.slope()?))],
        Course::Line { low, high } => {
            let rise = (high - low).checked_div(&(&band.to - &band.from))?;
            let at_zero = low - &(&rise * &band.from);
            vec![(at_zero.to_ball(), Ball::ONE, Slope::Whole(0)), (rise.to_ball(), Ball::ONE, Slope::Whole(1))]
        }
    })
}

/// The larger or the smaller of two numbers.
fn outer(a: &Number, b: &Number, is_larger: bool) -> Ball {
    let apart = a - b;
    let (a, b) = (a.to_ball(), b.to_ball());
    match (apart.is_positive(), apart.is_negative()) {
        (true, _) => {
            if is_larger {
                a
            } else {
                b
            }
        }
        (_, true) => {
            if is_larger {
                b
            } else {
                a
            }
        }
        _ => a.widen(apart.to_ball().magnitude()),
    }
}

/// rad/s
fn angular(frequency: Ball) -> Ball {
    frequency * Ball::PI * Ball::from(2.0)
}
