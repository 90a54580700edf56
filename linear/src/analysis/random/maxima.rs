//! Maxima of a density that is a sum over noises, each with its own spectrum and with inputs that it drives at
//! different times. Where the density is smooth, intervals of frequency are cut until the slope or the second
//! derivative has one sign in each. In: zeros and poles of each path, noises. Out: the maxima between two frequencies.
//! See docs/method/random.md#peaks.

use super::effort::Effort;
use super::harmonic::Response;
use super::several::{band_between, edges};
use crate::analysis::transfer::Transfer;
use crate::analysis::transfer::extrema::{Exactly, Over, product};
use crate::base::density::{Band, Course, Density};
use crate::base::{Ball, Dd, Number};
use crate::kernel::complex::Complex;
use crate::system::Noise;

const UNPROVED: &str = "it is not proved that no peak is missing";
const LONG: &str = "the search for them takes too long";
const ENDLESS: &str = "white noise that comes again later, or at several inputs, makes peaks without end";
const EDGES: &str = "peaks under several noises are found where the ends of their bands are fractions";

/// Limit on the zeros and poles evaluated, over all intervals: some seconds.
pub const MOST_TERMS: usize = 3_000_000;
/// Number of multiplications of an elimination that take as long as evaluating one zero or pole.
const WORK_OF_ROOT: usize = 10;
/// The place at which an interval is cut: not the middle, because maxima often lie at round numbers.
const CUT: f64 = 0.4871;
/// Least width of an interval, relative to the frequency.
const FINEST: f64 = 1e-13;
/// Above this multiple of the largest zero or pole, a sum that decays has no peak.
const BEYOND: f64 = 1000.0;

/// A noise with its path to the output.
pub struct Share<'a> {
    noise: &'a Noise,
    way: Way<'a>,
}

enum Way<'a> {
    /// Paths by their zeros and poles, each with the delay at its input, s.
    Roots(Vec<(&'a Exactly, Ball)>),
    /// By elimination in modal coordinates, with the number of times that the noise is to be integrated.
    Modes(Response<'a>, i32),
}

/// A function of the angular frequency with its first two derivatives, over an interval.
type Jet = [Ball; 3];

/// A noise with the inputs that it drives, each with its delay, s.
pub type Reaching<'a> = (&'a Noise, Vec<(usize, Number)>);

impl<'a> Share<'a> {
    pub fn by_modes(noise: &'a Noise, response: Response<'a>, left: i32) -> Share<'a> {
        Share { noise, way: Way::Modes(response, left) }
    }

    /// `None` if exact arithmetic does not find zeros and poles.
    pub fn all_by_roots(transfer: &'a Transfer, reaching: &[Reaching<'a>], output: usize) -> Option<Vec<Share<'a>>> {
        let of = |(noise, inputs): &Reaching<'a>| {
            let path =
                |(input, delay): &(usize, Number)| Some((transfer.zero_pole_form(*input, output)?, delay.to_ball()));
            Some(Share { noise, way: Way::Roots(inputs.iter().map(path).collect::<Option<_>>()?) })
        };
        reaching.iter().map(of).collect()
    }

    /// The effort of one evaluation, counted in zeros and poles.
    fn terms(&self) -> usize {
        match &self.way {
            Way::Roots(paths) => paths.iter().map(|(path, _)| path.roots()).sum(),
            Way::Modes(response, _) => 1 + response.work() / WORK_OF_ROOT,
        }
    }
}

/// The frequencies in Hz of the maxima, ascending, except those at the ends of bands. `effort`: that of all ranges
/// together; without it each range has its own.
pub fn maxima(shares: &[Share], effort: Option<&Effort>) -> Result<Vec<Ball>, &'static str> {
    let edges = edges(shares.iter().map(|share| share.noise)).ok_or(EDGES)?;
    let mut left = effort.map(Effort::limit);
    let mut list = Vec::new();
    for (i, from) in edges.iter().enumerate() {
        let to = edges.get(i + 1);
        let mut sum = Sum { parts: Vec::new(), terms: 0, left: left.unwrap_or(MOST_TERMS) };
        for share in shares {
            let band = match (&share.noise.density, to) {
                (Density::White(_), _) => None,
                (Density::Bands(bands), Some(to)) => match band_between(bands, from, to) {
                    Some(band) => Some(band),
                    None => continue,
                },
                (Density::Bands(_), None) => continue,
            };
            sum.terms += share.terms();
            sum.parts.push((share, band));
        }
        if !sum.parts.is_empty() {
            let low = radians(from);
            let found = to.map_or_else(|| sum.top(low), |to| Ok(radians(to))).and_then(|high| sum.maxima(low, high));
            left = left.map(|_| sum.left);
            if let (Err(LONG), Some(effort)) = (&found, effort) {
                effort.record_failure(effort.limit());
            }
            list.extend(found?);
        }
    }
    let hertz = Ball::PI * Ball::from(2.0);
    Ok(list.into_iter().map(|omega| omega / hertz).collect())
}

fn radians(frequency: &Number) -> Ball {
    frequency.to_ball() * Ball::PI * Ball::from(2.0)
}

/// The density between two edges: the noises present there, each with its band, or with none if it is white.
struct Sum<'a> {
    parts: Vec<(&'a Share<'a>, Option<&'a Band>)>,
    /// Number of zeros and poles of all parts.
    terms: usize,
    /// Number of these that may still be evaluated.
    left: usize,
}

impl Sum<'_> {
    /// A frequency above which the density decreases because each part does: w t / (t^2 + a^2) = 1 +- 2 / K for w >= K
    /// |z|.
    fn top(&self, low: Ball) -> Result<Ball, &'static str> {
        let mut largest = 0.0f64;
        for (share, _) in &self.parts {
            let path = match &share.way {
                Way::Roots(paths) => {
                    let [(path, _)] = paths[..] else { return Err(ENDLESS) };
                    path
                }
                Way::Modes(response, _) if response.drives.len() > 1 => return Err(ENDLESS),
                Way::Modes(response, left) => {
                    largest = largest.max(response.falls_above(*left).ok_or(UNPROVED)? / BEYOND);
                    continue;
                }
            };
            let excess = path.excess().ok_or(UNPROVED)? as f64 - f64::from(share.noise.derivative);
            if !(excess < 0.0 && 4.0 * path.roots() as f64 <= BEYOND * -excess) {
                return Err(UNPROVED);
            }
            largest = largest.max(path.largest());
        }
        Ok(Ball::from((BEYOND * largest).max(2.0 * low.magnitude())))
    }

    /// Whether the density is an even function of the frequency, so that its slope at zero is zero.
    fn is_even(&self) -> bool {
        let is_flat = |band: &Option<&Band>| band.is_none_or(|band| matches!(band.course, Course::Flat(_)));
        self.parts.iter().all(|(share, band)| {
            is_flat(band)
                && match &share.way {
                    Way::Roots(_) => true,
                    Way::Modes(response, _) => response.is_even(),
                }
        })
    }

    fn maxima(&mut self, low: Ball, high: Ball) -> Result<Vec<Ball>, &'static str> {
        let (low_end, high_end) = ((low.to_f64() - low.rad).next_down().max(0.0), (high.to_f64() + high.rad).next_up());
        let mut list = Vec::new();
        // The lower half of an interval is put on top, so that the maxima are found in order.
        let mut left = vec![[low_end, high_end]];
        while let Some([a, b]) = left.pop() {
            let half = (0.5 * (b - a)).next_up();
            let middle = Ball::from(0.5 * a + 0.5 * b);
            let [_, slope, bend] = self.over(middle.widen(half))?;
            let from_middle = self.over(middle)?[1] + bend * Ball::new(Dd::ZERO, half);
            let has_sign = |x: &Ball| x.is_finite() && !x.contains_zero();
            if has_sign(&slope) || has_sign(&from_middle) || (bend.is_finite() && bend.is_positive()) {
                continue;
            }
            if bend.is_finite() && bend.is_negative() {
                // Decreasing from a slope of zero at 0 Hz.
                if a == 0.0 && self.is_even() {
                    continue;
                }
                let at_ends = [self.over(Ball::from(a))?[1], self.over(Ball::from(b))?[1]];
                if at_ends.iter().all(has_sign) {
                    if at_ends[0].is_positive() && at_ends[1].is_negative() {
                        list.push(self.sharpen(middle.widen(half))?);
                    }
                    continue;
                }
            }
            let rises = || self.parts.iter().all(|(share, band)| share.rises(*band, middle.widen(half)) == Some(true));
            if a == 0.0 && rises() {
                continue;
            }
            let cut = a + CUT * (b - a);
            if b - a <= FINEST * b || !(a < cut && cut < b) {
                return Err(UNPROVED);
            }
            left.extend([[cut, b], [a, cut]]);
        }
        let mut inside = Vec::with_capacity(list.len());
        for omega in list {
            match ((omega - low), (high - omega)) {
                (above, below) if above.is_positive() && below.is_positive() => inside.push(omega),
                (above, below) if above.is_negative() || below.is_negative() => {}
                // It may be at the end.
                _ => return Err(UNPROVED),
            }
        }
        Ok(inside)
    }

    /// The only zero of the slope in an interval over which the slope decreases, by Newton's method with the interval's
    /// second derivative: each of the resulting intervals contains the zero. An interval that is too wide for that is
    /// halved.
    fn sharpen(&mut self, mut omega: Ball) -> Result<Ball, &'static str> {
        loop {
            let centre = Ball::exact(omega.mid);
            let (at, over) = (self.over(centre)?, self.over(omega)?);
            let next = centre - at[1] / over[2];
            let quarter = Dd::from(0.5 * omega.rad);
            let half = |mid: Dd| Ball::new(mid, (0.5 * omega.rad).next_up() + mid.hi.abs() * Dd::EPSILON);
            let next = match () {
                () if next.is_finite() && next.rad < 0.5 * omega.rad => next,
                () if at[1].is_positive() => half(omega.mid + quarter),
                () if at[1].is_negative() => half(omega.mid - quarter),
                () => return Ok(omega),
            };
            if next.rad > 0.75 * omega.rad {
                return Ok(omega);
            }
            omega = next;
        }
    }

    /// The density over an interval.
    fn over(&mut self, omega: Ball) -> Result<Jet, &'static str> {
        self.left = self.left.checked_sub(self.terms).ok_or(LONG)?;
        let unknown = [Ball::new(Dd::ZERO, f64::INFINITY); 3];
        let zero = [Ball::ZERO; 3];
        let sum = self.parts.iter().try_fold(zero, |sum, (share, band)| {
            let part = share.over(*band, omega)?;
            Some(std::array::from_fn(|i| sum[i] + part[i]))
        });
        Ok(sum.unwrap_or(unknown))
    }
}

impl Share<'_> {
    /// The density times |sum H e^(-i w t)|^2 / w^(2 derivative); `None` if an interval is too wide for any statement.
    fn over(&self, band: Option<&Band>, omega: Ball) -> Option<Jet> {
        let by_course = course(&self.noise.density, band, omega)?;
        let (square, exponent) = self.square(omega)?;
        Some(product(product(square, power(omega, exponent)), by_course))
    }

    /// The product without the density, as a function times a power of the frequency.
    fn square(&self, omega: Ball) -> Option<(Jet, i32)> {
        let rate = i32::from(self.noise.derivative);
        Some(match &self.way {
            Way::Modes(response, left) => (square_of(response.over(omega)?), -2 * left),
            Way::Roots(paths) if paths.len() == 1 => {
                let over = paths[0].0.over(omega)?;
                let size = Ball::ONE / (over.below.re.square() + over.below.im.square());
                let [g, rise] = over.slopes.map(|z| z.re * Ball::from(-2.0));
                let poles = [size, size * g, size * (g.square() + rise)];
                (product(over.square_above, poles), 2 * (over.at_zero - rate))
            }
            Way::Roots(paths) => {
                let mut sum = [Complex::<Ball>::ZERO; 3];
                for (path, delay) in paths {
                    let part = delay_path(path, *delay, rate, omega)?;
                    sum = std::array::from_fn(|i| sum[i] + part[i]);
                }
                (square_of(sum), 0)
            }
        })
    }

    /// Whether it rises from zero at 0 Hz over an interval that begins there: like w^p f with w |f'| < p f.
    fn rises(&self, band: Option<&Band>, omega: Ball) -> Option<bool> {
        let (square, exponent) = self.square(omega)?;
        let exponent = Ball::from(f64::from(exponent));
        let (regular, exponent) = match band.map(|band| &band.course) {
            None | Some(Course::Flat(_)) => (square, exponent),
            Some(Course::Power { .. }) => (square, exponent + band?.slope()?.to_ball()),
            Some(Course::Line { .. }) => (product(square, course(&self.noise.density, band, omega)?), exponent),
        };
        let margin = exponent * regular[0] - omega * Ball::from(regular[1].magnitude());
        Some(exponent.is_positive() && regular[0].is_positive() && margin.is_positive())
    }
}

/// |g|^2 with its derivatives.
fn square_of([g, g1, g2]: [Complex<Ball>; 3]) -> Jet {
    let two = Ball::from(2.0);
    let inner = |a: Complex<Ball>, b: Complex<Ball>| a.re * b.re + a.im * b.im;
    let size = |a: Complex<Ball>| a.re.square() + a.im.square();
    [size(g), two * inner(g, g1), two * (size(g1) + inner(g, g2))]
}

/// H e^(-i w t) / (i w)^rate with its derivatives.
fn delay_path(path: &Exactly, delay: Ball, rate: i32, omega: Ball) -> Option<[Complex<Ball>; 3]> {
    let Over { at_zero, above, below, slopes: [first, second], .. } = path.over(omega)?;
    let (sine, cosine) = Number::Ball(omega * delay).sin_cos()?;
    // The factor i of each root at zero, and -i t of each derivative of the delay.
    let value = quarters(Complex::new(cosine.to_ball(), -sine.to_ball()) / below, at_zero - rate);
    let slope = -first + Complex::new(Ball::ZERO, -delay);
    let two = Ball::from(2.0);
    let [z, z1, z2] = above;
    let [v, v1, v2] = [value, value * slope, value * (slope * slope - second)];
    let [v, v1, v2] = [v * z, v1 * z + v * z1, v2 * z + (v1 * z1).scale(two) + v * z2];
    let [p, p1, p2] = power(omega, at_zero - rate);
    Some([v.scale(p), v1.scale(p) + v.scale(p1), v2.scale(p) + v1.scale(two * p1) + v.scale(p2)])
}

/// The density of a noise by the angular frequency.
fn course(density: &Density, band: Option<&Band>, omega: Ball) -> Option<Jet> {
    let flat = |value: &Number| [value.to_ball(), Ball::ZERO, Ball::ZERO];
    let band = match (density, band) {
        (Density::White(value), _) => return Some(flat(value)),
        (Density::Bands(_), band) => band?,
    };
    let turn = Ball::PI * Ball::from(2.0);
    Some(match &band.course {
        Course::Flat(value) => flat(value),
        Course::Power { .. } => {
            let value = band.at(&Number::Ball(omega / turn))?.to_ball();
            let slope = band.slope()?.to_ball();
            let by_omega = value / omega;
            [value, slope * by_omega, slope * (slope - Ball::ONE) * by_omega / omega]
        }
        Course::Line { low, high } => {
            let value = band.at(&Number::Ball(omega / turn))?.to_ball();
            let slope = (high - low).checked_div(&(&band.to - &band.from))?.to_ball();
            [value, slope / turn, Ball::ZERO]
        }
    })
}

/// z i^times
pub fn quarters(z: Complex<Ball>, times: i32) -> Complex<Ball> {
    match times.rem_euclid(4) {
        0 => z,
        1 => Complex::new(-z.im, z.re),
        2 => -z,
        _ => Complex::new(z.im, -z.re),
    }
}

/// omega^exponent
pub fn power(omega: Ball, exponent: i32) -> Jet {
    let of = |exponent: i32| {
        let size = (0..exponent.unsigned_abs()).fold(Ball::ONE, |product, _| product * omega);
        if exponent < 0 { Ball::ONE / size } else { size }
    };
    let times = |factor: i32, exponent: i32| match factor {
        0 => Ball::ZERO,
        _ => Ball::from(f64::from(factor)) * of(exponent),
    };
    [of(exponent), times(exponent, exponent - 1), times(exponent * (exponent - 1), exponent - 2)]
}
