//! Mean squares under noise for springs with loss factors: the transfer functions have no conjugate pairs of poles, so
//! |H|^2 S is integrated by Gauss's rule over panels of frequencies, with an error bound from the largest value in a
//! complex neighbourhood of each panel. In: a system with loss factors and its modes, noises. Out: the same as without
//! loss factors. See docs/method/random.md#loss-factors.

use super::argument::Point;
use super::bands;
use super::channel::Channel;
use super::driven::{OPEN_TURNS, rate_of};
use super::effort::Effort;
use super::gauss::{self, Rule};
use super::gramian::Space;
use super::harmonic::{Drive, Response, Row};
use super::maxima::Share;
use super::source::{Arm, OPEN_BASE, Source, Springs, direct};
use super::tail::Tail;
use super::weight::Piece;
use super::{OPEN_RATE, Reach, Spread, finite, why};
use crate::analysis::answer::Modes;
use crate::base::{Ball, Density, Number, up};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::system::{LinearSystem, Losses, Noise, Output};
use std::borrow::Cow;
use std::collections::VecDeque;

const OPEN: &str =
    "with loss factors its integral takes too long: coordinates are many, or a motion has next to no damping";
const OPEN_LOSS: &str =
    "whether a loss factor passes the noise on at once, or lets the output drift with the base, is not decided";
const OPEN_LATER: &str = "white noise that comes again later is not computed with loss factors";
const GROWS: &str = "a loss factor or a damper is negative: a motion may grow";

/// Limit on the multiplications of all eliminations of one integral: some seconds.
const MOST_WORK: usize = 100_000_000;
/// A panel is narrow enough if its error is below this share of the integral.
const FINE: f64 = 1e-20;
/// Limit on the phase turned in half a panel, rad.
const TURN: f64 = 2.0;
/// White noise above this multiple of the highest natural frequency is integrated over the period.
const BEYOND: f64 = 4.0;

/// A system with loss factors under noise.
pub struct Lossy<'a> {
    system: Cow<'a, LinearSystem>,
    reach: Reach,
    sources: Vec<Source<'a>>,
    space: Result<Space, &'static str>,
    /// X^T H X
    h: Matrix<Ball>,
    numbers: Vec<usize>,
    /// Of integrals.
    effort: Effort,
}

/// An output, or its rate: the real part that every output has, and the part that the loss factors add, divided by i.
#[derive(Clone)]
pub struct Seen {
    plain: Output,
    lossy: Output,
}

impl Seen {
    /// Its rate; `None` if that requires the third derivative.
    pub fn rate(&self) -> Option<Seen> {
        Some(Seen { plain: rate_of(&self.plain)?, lossy: rate_of(&self.lossy)? })
    }

    /// The output of which this one is a derivative, and the order of that: the part of an acceleration at 0 Hz is then
    /// exactly zero.
    fn integral_seen(&self) -> (Cow<'_, Seen>, i32) {
        let Output { p, d, .. } = &self.plain;
        let is_rate = p[0].is_empty() && d[0].is_empty() && self.lossy.p[0].is_empty() && self.lossy.d[0].is_empty();
        let is_seen = p.iter().any(|p| !p.is_empty()) || d.iter().any(|d| !d.is_empty());
        if !(is_rate && is_seen) {
            return (Cow::Borrowed(self), 0);
        }
        let [_, p1, p2] = p.clone();
        let [_, d1, d2] = d.clone();
        let plain = Output { p: [p1, p2, Vec::new()], d: [d1, d2, Vec::new()], ..self.plain.clone() };
        let seen = Seen { plain, lossy: self.lossy.clone() };
        let (found, order) = seen.integral_seen();
        (Cow::Owned(found.into_owned()), order + 1)
    }

    /// The real part, and the part that the loss factors add, divided by i.
    pub fn rows(&self) -> [&Output; 2] {
        [&self.plain, &self.lossy]
    }
}

impl<'a> Lossy<'a> {
    /// `numbers`: those of the modes, from 1.
    pub fn of(system: Cow<'a, LinearSystem>, modes: &Modes, noises: &'a [Noise], numbers: Vec<usize>) -> Lossy<'a> {
        let none = Losses::default();
        let losses = system.losses.as_deref().unwrap_or(&none);
        let space = Space::of(&system, modes, None).map_err(why);
        let is_fed = losses.h.terms().any(|term| !term.weight.is_positive());
        let (space, h) = match space {
            Ok(space) if is_fed || !space.is_passive => (Err(GROWS), Matrix::none(0, 0)),
            Ok(space) => {
                let h = space.in_all_modes(&losses.h);
                (Ok(space), h)
            }
            Err(why) => (Err(why), Matrix::none(0, 0)),
        };
        let sources = noises.iter().map(|noise| Source::of(&system, noise)).collect();
        let reach = Reach::of(&system);
        Lossy { system, reach, sources, space, h, numbers, effort: Effort::of(MOST_WORK) }
    }

    pub fn has_losses(&self) -> bool {
        self.system.losses.is_some()
    }

    /// An output by its number.
    pub fn seen_output(&self, output: usize) -> Seen {
        let plain = self.system.outputs[output].clone();
        let of_losses =
            self.system.losses.as_deref().map(|losses| (losses.p[output].clone(), losses.d[output].clone()));
        let (p, d) = of_losses.unwrap_or_default();
        let lossy = Output { p: [p, Vec::new(), Vec::new()], d: [d, Vec::new(), Vec::new()], ..plain.clone() };
        Seen { plain, lossy }
    }

    /// The mean square of an output, of its rate, or of its part between two frequencies, Hz; and the contribution of
    /// each mode with its number.
    pub fn mean_square(&self, seen: &Seen, is_rate: bool, within: Option<[&Number; 2]>) -> (Spread, Vec<(usize, f64)>) {
        let rate = if is_rate { seen.rate() } else { None };
        let (seen, more) = rate.as_ref().map_or((seen, i32::from(is_rate)), |rate| (rate, 0));
        let reaches = |source: &&Source| self.reach.from_noise(&self.system, source.noise, &seen.plain);
        let mut by_modes: Vec<(usize, f64)> = self.numbers.iter().map(|number| (*number, 0.0)).collect();
        let of = |source| match self.under(source, seen, more, within) {
            Ok((square, own)) => {
                by_modes.iter_mut().zip(own).for_each(|((_, sum), own)| *sum += own);
                square
            }
            Err(open) => open,
        };
        let square = self.sources.iter().filter(reaches).map(of).fold(Spread::Finite(Ball::ZERO), Spread::plus);
        (square, by_modes)
    }

    /// The response for each noise that reaches an output with a finite mean square.
    pub fn shares<'s>(&'s self, seen: &Seen) -> Result<Vec<Share<'s>>, Spread> {
        let reaches = |source: &&Source| self.reach.from_noise(&self.system, source.noise, &seen.plain);
        let of = |source: &'s Source, (seen, rates): (&Seen, i32)| {
            let response = self.response(source, seen, None)?;
            let tail = self.tail(source, seen);
            Ok(Share::by_modes(source.noise, Response { tail, ..response }, source.left - rates))
        };
        let (integrated, rates) = seen.integral_seen();
        // An integrated quantity may drift with a base.
        let share = |source| of(source, (&*integrated, rates)).or_else(|_: Spread| of(source, (seen, 0)));
        self.sources.iter().filter(reaches).map(share).collect()
    }

    fn tail(&self, source: &Source, seen: &Seen) -> Option<Tail> {
        match (&source.noise.density, source.arms.as_deref()) {
            (Density::White(_), Ok([arm])) => Tail::of(&self.system, self.space.as_ref().ok()?, &arm.channel, seen),
            _ => None,
        }
    }

    /// H between a noise and an output, if the mean square is finite.
    fn response(&self, source: &Source, seen: &Seen, within: Option<[&Number; 2]>) -> Result<Response<'_>, Spread> {
        let space = self.space.as_ref().map_err(|why| Spread::Unknown(why))?;
        let all = source.arms.as_ref().map_err(|why| Spread::Unknown(why))?;
        let reaches = |input: &usize| self.reach.from_input(&self.system, *input, &seen.plain);
        let arms: Vec<&Arm> = all.iter().filter(|arm| arm.channel.inputs.iter().any(reaches)).collect();
        let is_white = source.is_white() && within.is_none();
        if is_white {
            direct(&arms, &seen.plain, &Springs::Hold)?;
        }
        let starts_at_zero = is_white
            || bands::starts_at_zero(&source.noise.density, within)
                .ok_or(Spread::Unknown("the bound leaves no digit"))?;
        let row = self.row(space, seen);
        let mut drives = Vec::with_capacity(arms.len());
        for arm in &arms {
            let fed = [&seen.plain, &seen.lossy].map(|output| arm.channel.feed(output));
            let is_open = |feed: &[Number]| feed.iter().any(|part| !part.is_zero());
            let drifts = starts_at_zero && (source.left > 0 || fed.iter().any(|feed| is_open(&feed[..2])));
            if drifts || (is_white && fed.iter().any(|feed| is_open(feed))) {
                return Err(Spread::Unknown(OPEN_LOSS));
            }
            let later = &arm.delay - &arms[0].delay;
            let drive =
                self.drive(space, &arm.channel, seen, fed, later.to_ball()).ok_or(Spread::Unknown(OPEN_BASE))?;
            if is_white && !drive.feed[2].im.is_zero() {
                return Err(Spread::Unknown(OPEN_LOSS));
            }
            drives.push(drive);
        }
        Ok(Response { space, h: &self.h, row, drives, tail: None })
    }

    /// `more`: a further power of w^2.
    fn under(
        &self,
        source: &Source,
        seen: &Seen,
        more: i32,
        within: Option<[&Number; 2]>,
    ) -> Result<(Spread, Vec<f64>), Spread> {
        let is_white = source.is_white() && within.is_none();
        if is_white && more > 0 {
            return Err(Spread::Unknown(OPEN_RATE));
        }
        let response = self.response(source, seen, within)?;
        let is_late = response.drives.len() > 1;
        let most = self.effort.limit();
        let by_modes = vec![0.0; response.space.n];
        let mut integral = Integral { response, left: source.left - more, spent: 0, most, sum: Ball::ZERO, by_modes };
        let pieces = bands::pieces(&source.noise.density, within);
        if integral.turns_too_often(pieces.iter().flatten()) {
            return Err(Spread::Unknown(OPEN_TURNS));
        }
        let done = match &source.noise.density {
            Density::White(_) if is_white && is_late => return Err(Spread::Unknown(OPEN_LATER)),
            Density::White(density) if is_white => integral.over_all(density.to_ball()),
            _ => pieces.and_then(|pieces| {
                pieces.iter().try_for_each(|piece| integral.over(&Range::Law(piece), [piece.from, piece.to]))
            }),
        };
        if done.is_none() {
            self.effort.record_failure(integral.spent);
            return Err(Spread::Unknown(OPEN));
        }
        let by_modes = integral.by_modes.iter().map(|part| part / (2.0 * std::f64::consts::PI)).collect();
        match finite(bands::to_mean_square(integral.sum, 0.0)) {
            Spread::Unknown(_) => Err(Spread::Unknown(OPEN)),
            found => Ok((found, by_modes)),
        }
    }

    /// An output over the displacements and rates of the modes; accelerations follow from the forces: M q'' = f w - C
    /// q' - (K + i H) q.
    fn row(&self, space: &Space, seen: &Seen) -> Row {
        let n = space.n;
        let [plain, lossy] = [&seen.plain, &seen.lossy].map(|output| {
            let row = space.row(output);
            let scaled = row[..n].iter().zip(&space.s).map(|(x, s)| *x * Ball::from(*s));
            (scaled.collect::<Vec<Ball>>(), row[n..].to_vec())
        });
        let place = |i: usize| Complex::new(plain.0[i], lossy.0[i] - space.acceleration(&seen.plain, self.h.column(i)));
        let rate = |i: usize| Complex::new(plain.1[i], lossy.1[i]);
        Row { place: (0..n).map(place).collect(), rate: (0..n).map(rate).collect() }
    }

    /// `None` if it is not proved that the loss factors do not act in the motion that a base carries along.
    fn drive(
        &self,
        space: &Space,
        channel: &Channel,
        seen: &Seen,
        [plain, lossy]: [[Number; 5]; 2],
        later: Ball,
    ) -> Option<Drive> {
        let n = space.n;
        let lost = match self.system.losses.as_deref() {
            Some(losses) => channel.loss_force(losses)?,
            None => vec![Number::ZERO; n],
        };
        let drive = space.drive(channel, Ball::ONE);
        let jump: Vec<Ball> = drive.jump.iter().zip(&space.s).map(|(x, s)| *x / Ball::from(*s)).collect();
        // X^T M X is 1 and X^T K X is diagonal, up to small entries.
        let (of_m, of_k) = (space.of_m * sum(&jump) * UP, space.of_k * sum(&drive.jump) * UP);
        let impulse = jump.iter().map(|x| x.widen(of_m)).collect();
        let held = (0..n).map(|i| (space.k[i] * jump[i]).widen(space.s[i] * of_k)).collect();
        let by_loss = space.in_modes(&lost);
        let force = drive.force.iter().zip(&by_loss).map(|(re, im)| Complex::new(*re, *im)).collect();
        let mut feed = std::array::from_fn(|i| Complex::new(plain[i].to_ball(), lossy[i].to_ball()));
        // The accelerations caused directly by the forces of the loss factors.
        feed[2].im = feed[2].im + space.acceleration(&seen.plain, &by_loss);
        Some(Drive { force, jump, impulse, held, feed, later })
    }
}

const UP: f64 = up::THOUSANDS;

/// A bound of the sum of magnitudes.
fn sum(list: &[Ball]) -> f64 {
    list.iter().map(Ball::magnitude).sum::<f64>() * UP
}

/// The integrand over a range: a power law, or a constant density over frequencies or over periods 1 / w.
enum Range<'p> {
    Law(&'p Piece),
    Flat(Ball),
    Periods(Ball),
}

/// The integral of |H|^2 S so far.
struct Integral<'a> {
    response: Response<'a>,
    /// A further power of 1 / w^2.
    left: i32,
    spent: usize,
    most: usize,
    sum: Ball,
    /// The contribution of each mode to the sum.
    by_modes: Vec<f64>,
}

impl Integral<'_> {
    /// Whether the panels that delays require are already too many.
    fn turns_too_often<'p>(&self, pieces: impl Iterator<Item = &'p Piece>) -> bool {
        let longest = self.response.drives.iter().map(|drive| drive.later.magnitude()).fold(0.0, f64::max);
        let panels = pieces.map(|piece| (piece.to - piece.from).magnitude()).sum::<f64>() * longest / (2.0 * TURN);
        panels * (gauss::NODES + 1) as f64 * self.response.work() as f64 > MOST_WORK as f64
    }

    /// White noise of a density over all frequencies.
    fn over_all(&mut self, density: Ball) -> Option<()> {
        let highest = self.response.space.s.iter().copied().fold(0.0, f64::max);
        let cut = BEYOND * highest;
        self.over(&Range::Flat(density), [Ball::ZERO, Ball::from(cut)])?;
        self.over(&Range::Periods(density), [Ball::ZERO, Ball::ONE / Ball::from(cut)])
    }

    /// Adds the integral between two ends; `None` if the limit is exceeded. A panel that has been cut waits until all
    /// others are done: where the integrand is negligible, a panel is narrow enough as soon as the integral is known
    /// roughly.
    fn over(&mut self, range: &Range, ends: [Ball; 2]) -> Option<()> {
        let rule = gauss::rule();
        let mut waiting = VecDeque::from([ends]);
        while let Some([a, b]) = waiting.pop_front() {
            let half = (b - a) * Ball::from(0.5);
            let middle = (a + b) * Ball::from(0.5);
            match self.panel(rule, range, middle, half) {
                Some(part) => self.sum = self.sum + part,
                None if self.spent > self.most => return None,
                None => {
                    let cut = Ball::from(gauss::cut(a.to_f64(), b.to_f64())?);
                    waiting.extend([[a, cut], [cut, b]]);
                }
            }
        }
        Some(())
    }

    /// The integral over a panel; `None` if the panel is too wide.
    fn panel(&mut self, rule: &Rule, range: &Range, middle: Ball, half: Ball) -> Option<Ball> {
        let turns = self.response.drives.iter().any(|drive| (drive.later * half).magnitude() > TURN);
        if turns {
            return None;
        }
        let reach = half.magnitude() * UP;
        let around = Complex::new(middle.widen(gauss::ACROSS * reach), Ball::ZERO.widen(gauss::UP_AND_DOWN * reach));
        let size = Ball::from(total(&self.parts(range, around)?).magnitude());
        let largest = (size.square() * self.density(range, modulus(around))?).magnitude();
        let (mut part, mut by_modes) = (Ball::ZERO, vec![0.0; self.by_modes.len()]);
        for (x, weight) in &rule.nodes {
            let parts = self.parts(range, Complex::real(middle + half * *x))?;
            let scale = self.density(range, middle + half * *x)? * *weight;
            let h = total(&parts);
            part = part + (h.re.square() + h.im.square()) * scale;
            let (h, scale) = (h.to_f64(), scale.to_f64() * half.to_f64());
            by_modes.iter_mut().zip(&parts).for_each(|(sum, own)| *sum += (own.to_f64() * h.conj()).re * scale);
        }
        let part = part * half;
        let error = rule.error(largest) * reach;
        let is_fine = error <= FINE * part.magnitude().max(self.sum.magnitude());
        if !(is_fine && part.is_finite()) {
            return None;
        }
        self.by_modes.iter_mut().zip(by_modes).for_each(|(sum, own)| *sum += own);
        Some(part.widen(error))
    }

    /// The contributions of the modes to H at an angular frequency or a period.
    fn parts(&mut self, range: &Range, at: Point) -> Option<Vec<Point>> {
        self.spent += self.response.work();
        match range {
            Range::Periods(_) => self.response.by_period(at),
            _ => self.response.by_frequency(at),
        }
    }

    /// The factor of |H|^2 at an angular frequency or a period, or for complex ones its magnitude.
    fn density(&self, range: &Range, size: Ball) -> Option<Ball> {
        let density = match range {
            Range::Flat(density) | Range::Periods(density) => *density,
            // |w^slope| = |w|^slope
            Range::Law(piece) => piece.at(size)?,
        };
        let rates = (0..self.left.abs()).fold(Ball::ONE, |product, _| product * size.square());
        Some(if self.left < 0 { density * rates } else { density / rates }).filter(Ball::is_finite)
    }
}

fn total(parts: &[Point]) -> Point {
    parts.iter().fold(Complex::ZERO, |sum, part| sum + *part)
}

/// |w| over a neighbourhood.
fn modulus(at: Point) -> Ball {
    let (low, high) = (at.re.mignitude(), at.magnitude());
    Ball::from(0.5 * (low + high)).widen(0.5 * (high - low) + f64::EPSILON * high)
}
