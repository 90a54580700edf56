//! The motion of a base in pieces for binary64, the same for all oscillators: segments with what bounds them, and the division
//! of one into the short steps of a frequency. In: the motion in balls. Out: values with bounds of their errors.

use super::base_motion::BaseMotion;
use super::oscillator::LONGEST;
use crate::base::rounding::UNIT;
use crate::base::{Ball, two_to, up};

/// A piece is at most 2 to this power steps of the fastest oscillator: its entries come from as many doublings.
const DOUBLINGS: u32 = 20;
/// Covers underflow in a step.
pub const TINY: f64 = 1e-290;
/// Up to this damping ratio errors are counted in q = x^2 + 2 zeta x v + v^2, which decays as exp(-2 zeta omega t) exactly.
pub const LIGHT: f64 = 0.5;
/// Bound of sqrt(q) over the length of a state, for ratios up to [`LIGHT`].
pub const INTO: f64 = 1.2248;
/// Bound of the length of a state over sqrt(q), for ratios up to [`LIGHT`].
pub const OUT_OF: f64 = 1.4143;

/// A segment, or a part of one that is very long.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The index of its length.
    pub class: u32,
    pub segment: u32,
    /// Its number in the segment.
    pub part: u32,
    /// The acceleration and its derivative at its start.
    pub line: [f64; 2],
    /// Bounds of |a| and |a'| within it.
    pub most: f64,
    pub rise: f64,
    /// A bound of the integral of |a| over it.
    pub reach: f64,
    /// A bound of the error of the state that its numbers cause.
    pub added: f64,
}

/// By what the state jumps before a piece.
pub struct JumpAt {
    pub piece: usize,
    pub displacement: Ball,
    pub velocity: Ball,
}

pub struct Course<'a> {
    motion: &'a BaseMotion,
    /// For each length of segments, how many segments have it, and into how many pieces each of these is divided, a power of two.
    counts: Vec<f64>,
    cuts: Vec<f64>,
    /// The most derivatives that an acceleration has, the acceleration among them; at least two.
    pub terms: usize,
    pub pieces: Vec<Piece>,
    /// The derivatives from the second one on, `terms` - 2 for each piece.
    pub bends: Vec<f64>,
    pub jumps: Vec<JumpAt>,
}

impl<'a> Course<'a> {
    /// The lengths alone, without pieces. `fastest`: the largest omega max(1, 2 zeta).
    pub fn of(motion: &'a BaseMotion, fastest: f64) -> Course<'a> {
        let mut counts = vec![0.0; motion.lengths.len()];
        motion.segments.iter().for_each(|segment| counts[segment.class as usize] += 1.0);
        let cuts = |length: &Ball| (parts(length.magnitude(), fastest) * two_to(-(DOUBLINGS as i32))).max(1.0);
        let cuts = motion.lengths.iter().map(cuts).collect();
        let terms = (0..motion.segments.len()).map(|segment| motion.derivatives(segment).len()).fold(2, usize::max);
        let (pieces, bends, jumps) = (Vec::new(), Vec::new(), Vec::new());
        Course { motion, counts, cuts, terms, pieces, bends, jumps }
    }

    /// With its pieces.
    pub fn fill(mut self) -> Course<'a> {
        let all: f64 = self.counts.iter().zip(&self.cuts).map(|(count, cuts)| count * cuts).sum();
        self.pieces.reserve(all as usize);
        let motion = self.motion;
        let mut jumps = motion.jumps.iter().peekable();
        let whole: Vec<Ball> = (0..self.classes()).map(|class| self.length(class, 1.0)).collect();
        for (segment, of) in motion.segments.iter().enumerate() {
            if let Some(jump) = jumps.next_if(|jump| jump.segment == segment) {
                self.jumps.push(self.jump(jump.displacement, jump.velocity));
            }
            for part in 0..self.cuts[of.class as usize] as u32 {
                let piece = Piece { class: of.class, segment: segment as u32, part, ..NONE };
                self.add(piece, whole[of.class as usize]);
            }
        }
        if let Some(jump) = jumps.next() {
            self.jumps.push(self.jump(jump.displacement, jump.velocity));
        }
        self
    }

    fn jump(&self, displacement: Ball, velocity: Ball) -> JumpAt {
        JumpAt { piece: self.pieces.len(), displacement, velocity }
    }

    /// The number of lengths of pieces.
    pub fn classes(&self) -> usize {
        self.counts.len()
    }

    /// The length of a step if a piece has this many steps, a power of two.
    pub fn length(&self, class: usize, steps: f64) -> Ball {
        self.motion.lengths[class] * Ball::from(1.0 / (steps * self.cuts[class]))
    }

    /// The number of steps in a piece, a power of two.
    pub fn steps(&self, class: usize, fastest: f64) -> f64 {
        parts(self.length(class, 1.0).magnitude(), fastest)
    }

    /// The number of steps of the whole motion.
    pub fn all_steps(&self, fastest: f64) -> f64 {
        let of = |class: usize| self.counts[class] * self.cuts[class] * self.steps(class, fastest);
        (0..self.classes()).map(of).sum()
    }

    /// Adds a piece of the length h.
    fn add(&mut self, mut piece: Piece, h: Ball) {
        let all = self.motion.derivatives(piece.segment as usize);
        let bends = &mut self.bends;
        describe(&mut piece, all, self.terms, h, self.motion.error, |_, value| bends.push(value));
        self.pieces.push(piece);
    }

    /// A step of a piece, its number counted from the start of the segment, with its derivatives from the second one on.
    pub fn step(&self, class: u32, segment: u32, part: u32, h: Ball, bends: &mut [f64]) -> Piece {
        let all = self.motion.derivatives(segment as usize);
        let mut step = Piece { class, segment, part, ..NONE };
        describe(&mut step, all, self.terms, h, self.motion.error, |k, value| bends[k - 2] = value);
        step
    }
}

const NONE: Piece =
    Piece { class: 0, segment: 0, part: 0, line: [0.0; 2], most: 0.0, rise: 0.0, reach: 0.0, added: 0.0 };

/// The least power of two of steps.
fn parts(length: f64, fastest: f64) -> f64 {
    let least = fastest * length / LONGEST * up::FEW;
    let mut parts = 1.0;
    while parts < least {
        parts *= 2.0;
    }
    parts
}

/// The values of a piece of the length h by the derivatives at the start of its segment.
fn describe(
    piece: &mut Piece,
    derivatives: &[Ball],
    terms: usize,
    h: Ball,
    error: f64,
    mut bend: impl FnMut(usize, f64),
) {
    let length = h.magnitude();
    let (mut most, mut rise, mut off, mut power) = (0.0, 0.0, error, 1.0);
    for k in 0..terms {
        let (value, size, error) = shift_derivative(derivatives, k, f64::from(piece.part) * h.mid.hi);
        match piece.line.get_mut(k) {
            Some(place) => *place = value,
            None => bend(k, value),
        }
        most += size * power;
        off += error * power;
        if k > 0 {
            rise += size * power * k as f64 / length;
        }
        power *= length / (k as f64 + 1.0);
    }
    piece.most = most * up::DOZENS;
    piece.rise = rise * up::DOZENS;
    piece.reach = most * length * up::DOZENS;
    piece.added = ((off + most * rounding(terms)) * length * INTO + TINY) * up::DOZENS;
}

/// The k-th derivative after a time t that is rounded twice, a bound of its size, and one of its error.
fn shift_derivative(derivatives: &[Ball], k: usize, t: f64) -> (f64, f64, f64) {
    let Some((last, others)) = derivatives.get(k..).and_then(<[Ball]>::split_last) else { return (0.0, 0.0, 0.0) };
    let own = |d: &Ball| (d.mid.hi, d.mid.hi.abs(), d.rad + d.mid.lo.abs());
    if t == 0.0 {
        let (value, size, error) = own(others.first().unwrap_or(last));
        return (value, (size + error) * up::FEW, error * up::FEW);
    }
    let (mut value, mut size, mut error) = own(last);
    for (i, d) in others.iter().enumerate().rev() {
        let (factor, (own, own_size, own_error)) = (t / (i as f64 + 1.0), own(d));
        value = value * factor + own;
        size = size * factor + own_size;
        error = error * factor + own_error;
    }
    // Each step of Horner's scheme rounds the factor, which is off by three units already, the product and the sum.
    let rounded = (6.0 * others.len() as f64 + 2.0) * UNIT;
    let size = (size + error) * up::MILLIONS;
    (value, size, (error * up::MILLIONS + rounded * size) * up::FEW)
}

/// Relative rounding of a step: each of its sums has `terms` + 2 products, whose factors are rounded.
pub fn rounding(terms: usize) -> f64 {
    (terms as f64 + 4.0) * 1.5 * UNIT
}
