//! A system under noise, all of whose motions matter: mean squares by Lyapunov's equation and by residues at poles. In:
//! a linear system with all its modes, the noises of its inputs. Out: for each output a number, a proof that it is
//! infinite, or the reason why neither was found. See docs/method/random.md.

use super::bands::{self, Bands};
use super::coherent;
use super::gramian::{Covariance, Drive, Obstacle, Space};
use super::quotient;
use super::resolvent::{Line, Parts, Resolvent};
use super::source::{Arm, OPEN_BASE, Rigid, Source, Springs, direct, drift, intensity};
use super::undamped::{Excited, Undamped};
use super::{OPEN_RATE, Reach, Spread, finite, why};
use crate::analysis::answer::{Mode, ModeKind, Modes};
use crate::analysis::forms::{apply, is_certain};
use crate::analysis::poles::companion::StateForm;
use crate::analysis::transfer::{Frequency, Transfer};
use crate::base::{Ball, Density, Number, OrderBy, Rational, Unproven};
use crate::kernel::dense::echelon;
use crate::system::{LinearSystem, Noise, Output};
use std::borrow::Cow;
use std::cell::OnceCell;

const RIGID: &str = "infinite: nothing brings back a motion that noise drives on";
const UNDAMPED: &str = "infinite: nothing damps what noise excites";

const OPEN_POLES: &str = "the poles are too close to each other for a bound";
pub const OPEN_TURNS: &str = "the delay is too long for this band: the phase turns too often";
const OPEN_DIGITS: &str = "the bound leaves no digit";
const OPEN_UNDAMPED: &str = "whether the noise has power where it excites an undamped motion is not decided";
const OPEN_LATER: &str = "a motion is not damped, which is not computed under noises with delays";

const OPEN_INPUTS: &str = "the noise drives more than 64 inputs: that many are not integrated in bands";
const OPEN_LONG: &str =
    "the density has too many bands (the limit is 200,000 over the number of coordinates): give fewer rows or points";

/// Limit on the inputs that one noise in bands drives: each pair of them at different times adds a term; some seconds
/// in all.
const MOST_INPUTS: usize = 64;
/// Limit on bands times coordinates: some ten seconds.
const MOST_BANDS: usize = 200_000;

/// A system under noise.
pub struct Driven<'a> {
    system: Cow<'a, LinearSystem>,
    modes: Cow<'a, Modes>,
    /// The numbers of these modes in the scene, from 1; empty if they are the modes of the scene.
    numbers: Vec<usize>,
    noises: &'a [Noise],
    sources: Vec<Source<'a>>,
    reach: Reach,
    springs: OnceCell<Springs>,
    space: Result<Space, Obstacle>,
    /// For all white noises, where every motion decays.
    covariance: Option<Covariance>,
    /// Needed only for noise in bands.
    resolvent: OnceCell<Option<Resolvent>>,
    /// Needed if some motions do not decay.
    undamped: OnceCell<Option<Undamped<'a>>>,
}

impl<'a> Driven<'a> {
    pub fn of(
        system: Cow<'a, LinearSystem>,
        modes: Cow<'a, Modes>,
        noises: &'a [Noise],
        numbers: Vec<usize>,
        known: Option<&StateForm>,
    ) -> Driven<'a> {
        let space = Space::of(&system, &modes, known);
        let sources: Vec<Source> = noises.iter().map(|noise| Source::of(&system, noise)).collect();
        let covariance = space.as_ref().ok().and_then(|space| {
            let white =
                sources.iter().filter_map(|source| Some((source.arms.as_ref().ok()?, intensity(source.noise)?)));
            let drives: Vec<Drive> = white
                .flat_map(|(arms, intensity)| arms.iter().map(move |arm| space.drive(&arm.channel, intensity)))
                .collect();
            space.covariance(&drives)
        });
        let reach = Reach::of(&system);
        let (springs, resolvent, undamped) = Default::default();
        Driven { system, modes, numbers, noises, sources, reach, springs, space, covariance, resolvent, undamped }
    }

    /// Whether every motion is proved to decay.
    fn decays(&self) -> bool {
        self.space.as_ref().is_ok_and(Space::decays)
    }

    /// The undamped motions, if some motions are not proved to decay and none grows.
    fn undamped_motions(&self) -> Option<&Undamped<'a>> {
        if self.decays() || !self.space.as_ref().is_ok_and(|space| space.is_passive) {
            return None;
        }
        self.undamped.get_or_init(|| Undamped::of(&self.system, &self.modes, self.noises)).as_ref()
    }

    /// The system without its undamped motions, and the output there, if these motions have no part in the output under
    /// any noise.
    pub fn without_undamped(&self, output: &Output) -> Option<(&Driven<'a>, Output)> {
        let undamped = self.undamped_motions()?;
        let (basis, rest) = undamped.rest.as_ref()?;
        let is_apart = self.reaching(output).all(|source| undamped.is_apart(source.noise, output));
        is_apart.then(|| (&**rest, basis.output(output)))
    }

    /// A proof that a noise excites an undamped motion that an output shows, with power at its frequency.
    fn resonant(&self, source: &Source, output: &Output, within: Option<[&Number; 2]>) -> Result<Excited, Spread> {
        let Some(undamped) = self.undamped_motions() else { return Ok(Excited::Open) };
        match undamped.under(source.noise, output, within) {
            Excited::At(omega) => {
                let is_it = |i: &usize| (self.modes.list[*i].omega - omega).contains_zero();
                let found = (0..self.modes.list.len()).find(is_it).and_then(|i| self.numbers.get(i));
                Err(Spread::Infinite(match found {
                    Some(number) => {
                        format!("infinite: nothing damps mode {number}, and the noise has power at its frequency")
                            .into()
                    }
                    None => UNDAMPED.into(),
                }))
            }
            other => Ok(other),
        }
    }

    /// The noises that reach an output.
    fn reaching(&self, output: &Output) -> impl Iterator<Item = &Source<'a>> {
        self.sources.iter().filter(move |source| self.reach.from_noise(&self.system, source.noise, output))
    }

    /// The arms through which a noise reaches an output.
    fn arms<'s>(&self, source: &'s Source, output: &Output) -> Result<Vec<&'s Arm>, &'static str> {
        let reaches = |input: &usize| self.reach.from_input(&self.system, *input, output);
        let all = source.arms.as_ref().map_err(|why| *why)?;
        Ok(all.iter().filter(|arm| arm.channel.inputs.iter().any(reaches)).collect())
    }

    /// The mean square of an output, in the square of its SI unit.
    pub fn mean_square(&self, output: &Output) -> Spread {
        let all = self.reaching(output);
        let (white, banded): (Vec<&Source>, Vec<&Source>) = all.partition(|source| source.is_white());
        let of_white = self.or_exactly(self.under_white(&white, output), &white, output, Part::Whole);
        let of_bands = banded.iter().map(|source| self.under_bands(source, output, Part::Whole));
        of_bands.fold(of_white, Spread::plus)
    }

    /// The noises for which no result is known otherwise, by exact quotients of polynomials.
    fn or_exactly(&self, found: Spread, sources: &[&Source], output: &Output, part: Part) -> Spread {
        let Spread::Unknown(_) = &found else { return found };
        let within = if let Part::Within(within) = part { Some(within) } else { None };
        let is_rate = matches!(part, Part::Rate);
        let of =
            |source: &&Source| quotient::mean_square(&self.system, &self.reach, source.noise, output, is_rate, within);
        let all: Option<Vec<Spread>> = sources.iter().map(of).collect();
        all.map_or(found, |all| all.into_iter().fold(Spread::Finite(Ball::ZERO), Spread::plus))
    }

    /// The mean square of the part of an output between two frequencies, Hz.
    pub fn mean_square_within(&self, output: &Output, within: [&Number; 2]) -> Spread {
        let each = self.reaching(output).map(|source| self.under_bands(source, output, Part::Within(within)));
        each.fold(Spread::Finite(Ball::ZERO), Spread::plus)
    }

    fn under_white(&self, sources: &[&Source], output: &Output) -> Spread {
        let mut open = None;
        let mut together = Ball::ZERO;
        for source in sources {
            let arms = match self.arms(source, output) {
                Ok(arms) => arms,
                Err(why) => {
                    open.get_or_insert(why);
                    continue;
                }
            };
            match direct(&arms, output, self.springs()) {
                Ok(()) => {}
                Err(Spread::Unknown(why)) => {
                    open.get_or_insert(why);
                }
                Err(infinite) => return infinite,
            }
            if let Some(infinite) = self.endless(source, &arms, output) {
                return infinite;
            }
            if arms.len() > 1 && open.is_none() {
                match self.covariances(source, &arms, output) {
                    Ok(sum) => together = together + sum,
                    Err(why) => open = Some(why),
                }
            }
        }
        match (open, &self.space, &self.covariance) {
            (Some(why), ..) => Spread::Unknown(why),
            _ if sources.is_empty() => Spread::Finite(Ball::ZERO),
            (None, Ok(space), Some(covariance)) => {
                let apart = space.variance(covariance, &space.row(output));
                // A variance is not negative.
                let sum = apart + together;
                finite(Some(if sum.mid.hi < 0.0 { Ball::ZERO.widen(sum.magnitude()) } else { sum }))
            }
            (None, Err(obstacle), _) => Spread::Unknown(why(*obstacle)),
            (None, Ok(_), None) => Spread::Unknown(why(Obstacle::NotStable)),
        }
    }

    /// Twice the sum of the covariances of the contributions of a white noise through its arms.
    fn covariances(&self, source: &Source, arms: &[&Arm], output: &Output) -> Result<Ball, &'static str> {
        let space = self.space.as_ref().map_err(|obstacle| why(*obstacle))?;
        let resolvent = self.resolvent(space)?;
        let intensity = intensity(source.noise).unwrap_or(Ball::ZERO);
        let row = space.row(output);
        let near = resolvent.on_axis().ok_or(OPEN_POLES)?;
        let parts =
            |arm: &&Arm| resolvent.parts(space, &space.drive(&arm.channel, Ball::ONE), &row, [Ball::ZERO; 5], &near);
        let parts: Vec<Parts> = arms.iter().map(parts).collect::<Option<_>>().ok_or(OPEN_DIGITS)?;
        let mut sum = Ball::ZERO;
        for (second, later) in arms.iter().enumerate() {
            for (first, earlier) in arms.iter().enumerate().take(second) {
                let apart = &later.delay - &earlier.delay;
                let (early, late) = if apart.is_positive() { (first, second) } else { (second, first) };
                sum = sum + coherent::covariance(resolvent, &parts[early], &parts[late], apart.to_ball().abs());
            }
        }
        Ok(sum * intensity * Ball::from(2.0))
    }

    fn resolvent(&self, space: &Space) -> Result<&Resolvent, &'static str> {
        self.resolvent.get_or_init(|| Resolvent::of(space)).as_ref().ok_or(OPEN_POLES)
    }

    /// The mean square under a noise in bands, or within a band.
    fn under_bands(&self, source: &Source, output: &Output, part: Part) -> Spread {
        if source.noise.inputs.len() > MOST_INPUTS {
            return Spread::Unknown(OPEN_INPUTS);
        }
        if source.noise.density.bands() * self.system.n() > MOST_BANDS {
            return Spread::Unknown(OPEN_LONG);
        }
        self.or_exactly(self.by_poles(source, output, part), &[source], output, part)
    }

    fn by_poles(&self, source: &Source, output: &Output, part: Part) -> Spread {
        let within = match part {
            Part::Within(within) => Some(within),
            _ => None,
        };
        let arms = match self.arms(source, output) {
            Ok(arms) => arms,
            Err(why) => return Spread::Unknown(why),
        };
        let Some(starts_at_zero) = bands::starts_at_zero(&source.noise.density, within) else {
            return Spread::Unknown(OPEN_DIGITS);
        };
        if starts_at_zero {
            // The density of an output that drifts cannot be integrated over a band that begins at 0 Hz.
            if source.left > 0 {
                return Spread::Unknown(OPEN_BASE);
            }
            if let Err(drifts) = drift(&arms, output, self.springs()) {
                return drifts;
            }
        }
        let space = match &self.space {
            Ok(space) => space,
            Err(obstacle) => return Spread::Unknown(why(*obstacle)),
        };
        // If some motion may not decay, a proved number requires that none grows and that no pole lies in a band.
        let mut open = OPEN_DIGITS;
        if !self.decays() {
            open = match self.resonant(source, output, within) {
                Err(infinite) => return infinite,
                Ok(Excited::Open) => OPEN_UNDAMPED,
                Ok(_) => OPEN_DIGITS,
            };
            if !space.is_passive || self.undamped_motions().is_none() {
                open = why(Obstacle::NotStable);
            }
            if !space.is_passive {
                return Spread::Unknown(open);
            }
            // Pairs of poles on the axis are not separated there.
            if arms.len() > 1 {
                return Spread::Unknown(OPEN_LATER);
            }
        }
        let resolvent = match self.resolvent(space) {
            Ok(resolvent) => resolvent,
            Err(why) => return Spread::Unknown(why),
        };
        let more = |part: Part| if matches!(part, Part::Rate) { 2 } else { 0 } - 2 * source.left;
        let of = |part: Part| Bands::of(&source.noise.density, within, more(part), resolvent);
        let own;
        let bands = match part {
            Part::Whole => source.bands[0].get_or_init(|| of(part)),
            Part::Rate => source.bands[1].get_or_init(|| of(part)),
            Part::Within(_) => {
                own = of(part);
                &own
            }
        };
        let row = space.row(output);
        let Some(bands) = bands else { return Spread::Unknown(open) };
        let parts = |arm: &&Arm| {
            let direct = arm.channel.feed(output).map(|part| part.to_ball());
            resolvent.parts(space, &space.drive(&arm.channel, Ball::ONE), &row, direct, bands.nearness())
        };
        let Some(parts) = arms.iter().map(parts).collect::<Option<Vec<Parts>>>() else {
            return Spread::Unknown(OPEN_DIGITS);
        };
        let delays: Vec<&Number> = arms.iter().map(|arm| &arm.delay).collect();
        let Some(pairs) = coherent::pairs(&source.noise.density, within, more(part), &delays, resolvent) else {
            return Spread::Unknown(OPEN_TURNS);
        };
        match finite(coherent::mean_square(bands, &pairs, resolvent, &parts)) {
            Spread::Unknown(_) => Spread::Unknown(open),
            found => found,
        }
    }

    /// A proof that the variance under white noise is infinite, if no motion decays.
    fn endless(&self, source: &Source, arms: &[&Arm], output: &Output) -> Option<Spread> {
        if self.decays() {
            return None;
        }
        if let Err(infinite) = self.resonant(source, output, None) {
            return Some(infinite);
        }
        // A drift of the base may cancel it.
        let drifts = |arm: &&Arm| arm.channel.feed(output)[..2].iter().any(|part| !part.is_zero());
        if let Springs::One(rigid) = self.springs()
            && !arms.iter().any(drifts)
        {
            let is_simple = rigid.drag.iter().all(Number::is_zero) || is_certain(&rigid.resistance);
            if is_simple && is_certain(&rigid.excitation_shown(arms, output)) {
                return Some(Spread::Infinite(RIGID.into()));
            }
        }
        // Without dampers every pole lies on the axis, and a nonzero transfer function has one.
        if self.system.c.is_empty() && self.modes.list.iter().all(|mode| mode.kind != ModeKind::Divergence) {
            let index = self.system.outputs.iter().position(|known| known.p == output.p && known.d == output.d)?;
            let [arm] = arms else { return None };
            let [input] = arm.channel.inputs[..] else { return None };
            let transfer = Transfer::of(&self.system);
            let excites = ["0.8164", "3.1622", "31.415"].map(Number::from).iter().any(|frequency| {
                let gain = transfer.between(&Frequency::hertz(frequency), &[input], &[index])[0][0];
                gain.disc().is_some_and(|disc| disc.gain().is_positive())
            });
            return excites.then(|| Spread::Infinite(UNDAMPED.into()));
        }
        None
    }

    /// The motions that springs do not hold.
    fn springs(&self) -> &Springs {
        self.springs.get_or_init(|| {
            let n = self.system.n();
            let is_held = |mode: &Mode| matches!(mode.kind, ModeKind::Oscillation | ModeKind::Divergence);
            let free = self.modes.list.iter().filter(|mode| !is_held(mode)).count();
            let is_complete = self.modes.list.len() == n;
            if is_complete && free == 0 || has_regular_stiffness(&self.system) {
                return Springs::Hold;
            }
            match self.only_rigid_motion().filter(|_| is_complete && free == 1) {
                Some(motion) => {
                    let drag = apply(&self.system.c, &motion);
                    let resistance = motion.iter().zip(&drag).fold(Number::ZERO, |sum, (r, c)| &sum + &(r * c));
                    Springs::One(Rigid { motion, drag, resistance })
                }
                None => Springs::Open,
            }
        })
    }

    /// The only motion without stiffness, as a vector of simple fractions, with proof.
    fn only_rigid_motion(&self) -> Option<Vec<Number>> {
        const LARGEST_DENOMINATOR: i64 = 64;
        let mut rigid = self.modes.list.iter().filter(|mode| mode.kind == ModeKind::Rigid);
        let (Some(mode), None) = (rigid.next(), rigid.next()) else { return None };
        let largest = mode.shape.iter().copied().reduce(|a, b| if b.abs() > a.abs() { b } else { a })?;
        let simple = |x: &f64| {
            (1..=LARGEST_DENOMINATOR).find_map(|denominator| {
                let numerator = x / largest * denominator as f64;
                let whole = numerator.round();
                ((numerator - whole).abs() < 1e-6).then(|| Number::from(Rational::new(whole as i64, denominator)))
            })
        };
        let motion: Vec<Number> = mode.shape.iter().map(simple).collect::<Option<_>>()?;
        apply(&self.system.k, &motion).iter().all(Number::is_zero).then_some(motion)
    }

    /// The mean square of the rate of an output.
    fn rate(&self, output: &Output) -> Spread {
        if let Some(rate) = rate_of(output) {
            return self.mean_square(&rate);
        }
        let of = |source: &Source| match source.noise.density {
            Density::White(_) => self.or_exactly(Spread::Unknown(OPEN_RATE), &[source], output, Part::Rate),
            Density::Bands(_) => self.under_bands(source, output, Part::Rate),
        };
        self.reaching(output).map(of).fold(Spread::Finite(Ball::ZERO), Spread::plus)
    }

    /// The expected number of upward zero crossings per second: the rms of the rate over 2 pi times the rms (Rice 1945).
    pub fn crossings(&self, output: &Output, mean_square: Spread) -> Spread {
        self.rate(output).crossings(mean_square)
    }

    /// The contribution of each mode to the mean square, in binary64.
    fn contributions(&self, output: &Output) -> Option<Vec<f64>> {
        let (Ok(space), Some(covariance)) = (&self.space, &self.covariance) else { return None };
        let row = space.row(output);
        let all = self.reaching(output);
        let (white, banded): (Vec<&Source>, Vec<&Source>) = all.partition(|source| source.is_white());
        let mut sum = vec![0.0; self.system.n()];
        if !white.is_empty() {
            sum = space.contributions(covariance, &row);
        }
        for source in white {
            let arms = self.arms(source, output).ok()?;
            if arms.len() > 1 {
                let intensity = intensity(source.noise)?.to_f64();
                let list = self.contributions_of_pairs(space, &arms, &row)?;
                sum.iter_mut().zip(list).for_each(|(sum, part)| *sum += intensity * part);
            }
        }
        for source in banded {
            let resolvent = self.resolvent.get()?.as_ref()?;
            let arms = self.arms(source, output).ok()?;
            let bands = source.bands[0].get()?.as_ref()?;
            let of = |arm: &&Arm| {
                let direct = arm.channel.feed(output).map(|part| part.to_ball());
                let drive = space.drive(&arm.channel, Ball::ONE);
                let parts = resolvent.parts(space, &drive, &row, direct, bands.nearness())?;
                Some((resolvent.lines(space, &parts, &row)?, direct))
            };
            let lines: Vec<(Vec<Line>, [Ball; 5])> = arms.iter().map(of).collect::<Option<_>>()?;
            let mut lists = Vec::with_capacity(lines.len() + 1);
            for (lines, direct) in &lines {
                lists.push(bands.contributions(resolvent, lines, direct)?);
            }
            if arms.len() > 1 {
                let delays: Vec<&Number> = arms.iter().map(|arm| &arm.delay).collect();
                let pairs = coherent::pairs(&source.noise.density, None, -2 * source.left, &delays, resolvent)?;
                let short: Vec<_> = lines.into_iter().map(|(lines, feed)| (lines, feed.map(|x| x.to_f64()))).collect();
                lists.push(coherent::shared_in_bands(&pairs, resolvent, &short)?);
            }
            lists.into_iter().for_each(|list| sum.iter_mut().zip(list).for_each(|(sum, part)| *sum += part));
        }
        Some(sum)
    }

    /// The contributions of the modes through inputs that one white noise of unit intensity drives at different times,
    /// in addition to the contribution of each input alone.
    fn contributions_of_pairs(&self, space: &Space, arms: &[&Arm], row: &[Ball]) -> Option<Vec<f64>> {
        let resolvent = self.resolvent(space).ok()?;
        let near = resolvent.on_axis()?;
        let lines = |arm: &&Arm| {
            let parts = resolvent.parts(space, &space.drive(&arm.channel, Ball::ONE), row, [Ball::ZERO; 5], &near)?;
            resolvent.lines(space, &parts, row)
        };
        let lines: Vec<Vec<Line>> = arms.iter().map(lines).collect::<Option<_>>()?;
        let mut sum = vec![0.0; self.system.n()];
        for (a, one) in arms.iter().zip(&lines) {
            for (b, other) in arms.iter().zip(&lines).filter(|(b, _)| !std::ptr::eq(**b, *a)) {
                let part = coherent::shared_covariance(one, other, (&b.delay - &a.delay).to_f64());
                sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
            }
        }
        Some(sum)
    }

    /// The contribution of each mode to a known mean square: the numbers of the modes from 1, and shares that add up to
    /// one if no noise reaches the output directly.
    pub fn shares(&self, output: &Output, whole: Ball) -> Vec<(usize, Unproven)> {
        let Some(parts) = self.contributions(output) else { return Vec::new() };
        shares(self.numbers.iter().copied().zip(parts), whole)
    }
}

/// The modes that contribute to a mean square, in descending order of their shares.
pub fn shares(parts: impl Iterator<Item = (usize, f64)>, whole: Ball) -> Vec<(usize, Unproven)> {
    let share = |(mode, part)| (mode, Unproven(if whole.is_zero() { 0.0 } else { part / whole.to_f64() }));
    let mut list: Vec<(usize, Unproven)> = parts.map(share).collect();
    list.order_by(|(i, a), (j, b)| b.0.abs().total_cmp(&a.0.abs()).then(i.cmp(j)));
    list
}

/// Whether K is regular, if exact arithmetic decides it.
fn has_regular_stiffness(system: &LinearSystem) -> bool {
    const MOST: usize = 24;
    let n = system.n();
    let entries = if n <= MOST { system.k.rational_entries(n) } else { None };
    let solution = entries.and_then(|k| echelon::solution(&k, &vec![Rational::ZERO; n]));
    solution.is_some_and(|(_, is_only)| is_only)
}

/// The part of a noise that is used.
#[derive(Clone, Copy)]
enum Part<'n> {
    Whole,
    /// Its rate.
    Rate,
    /// The part between two frequencies, Hz.
    Within([&'n Number; 2]),
}

/// The rate of an output as an output; `None` if that requires the third derivative.
pub fn rate_of(output: &Output) -> Option<Output> {
    let [p0, p1, p2] = &output.p;
    let [d0, d1, d2] = &output.d;
    let is_low = p2.is_empty() && d2.is_empty();
    is_low.then(|| Output {
        p: [Vec::new(), p0.clone(), p1.clone()],
        d: [Vec::new(), d0.clone(), d1.clone()],
        ..output.clone()
    })
}
