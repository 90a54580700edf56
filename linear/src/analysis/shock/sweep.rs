//! The largest motions of oscillators during a signal, eight of them in parallel lanes of binary64. The first pass takes each
//! piece of the signal in one exact step, with a running bound of the error, and finds values that are certainly reached; the
//! second one returns to the few pieces in which the motion may exceed them, and takes these in short steps. The few steps
//! that may hold the largest value are examined as polynomials afterwards. See docs/method/shock.md#maxima.

use super::base_motion::BaseMotion;
use super::course::{Course, INTO, OUT_OF, Piece, TINY, rounding};
use super::entries::{Entries, row, short, state_after, whole};
use super::oscillator::{Factorials, factorials_for, within_step};
use super::{MOST_STEPS, Refusal, Sides};
use crate::analysis::largest::{Curve, Largest};
use crate::base::rounding::UNIT;
use crate::base::{Ball, OrderBy, up};
use crate::kernel::cores;
use crate::kernel::simd::{Eight, LANES, simd};

/// A number for each lane.
type Row = [f64; LANES];

/// The state of an oscillator; see [`super::oscillator`].
#[derive(Clone, Copy, Debug)]
pub struct State {
    pub x: Ball,
    pub v: Ball,
}

/// The result of the signal for one oscillator.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    pub primary: Sides,
    /// After the last event.
    pub state: State,
}

/// Candidates of a lane that are kept before those that were overtaken are dropped.
const KEPT: usize = 1024;
/// Pieces that are passed over or returned to together.
const BLOCK: usize = 16;
/// Steps of a group that take longer than starting a thread does.
const MOST_OF_ONE: usize = 40_000;

/// More than the root of a sum of squares loses to underflow.
const LOST: f64 = 1e-150;

/// For each frequency, in ascending order.
pub fn sweep(motion: &BaseMotion, damping: Ball, omegas: &[Ball]) -> Result<Vec<Found>, Refusal> {
    let rate =
        |group: &[Ball]| group.iter().map(Ball::magnitude).fold(0.0, f64::max) * (2.0 * damping.magnitude()).max(1.0);
    let course = Course::of(motion, rate(omegas));
    let steps: f64 = omegas.chunks(LANES).map(|group| course.all_steps(rate(group)) * LANES as f64).sum();
    if steps > MOST_STEPS || steps.is_nan() {
        return Err(Refusal::TooLong { steps });
    }
    let course = course.fill();
    let factorials = Factorials::new(factorials_for(course.terms));
    let least = LANES * MOST_OF_ONE.div_ceil(course.pieces.len().max(1));
    let found = cores::in_pieces(omegas, least, LANES, |omegas| {
        let mut blocks = Vec::with_capacity(course.pieces.len() / BLOCK + course.jumps.len() + 1);
        let mut found = Vec::with_capacity(omegas.len());
        for group in omegas.chunks(LANES) {
            blocks.clear();
            found.extend(Group::of(&course, &factorials, damping, group).into_found(&mut blocks));
        }
        found
    });
    found.into_iter().collect()
}

/// Eight oscillators on their way.
struct Group<'a> {
    course: &'a Course<'a>,
    damping: Ball,
    omegas: &'a [Ball],
    entries: Entries,
    now: Lanes,
    /// Values of x that are certainly reached, on the positive and on the negative side.
    low: [Row; 2],
    candidates: [Vec<Candidate>; 2 * LANES],
    limits: [usize; 2 * LANES],
}

/// States, and bounds of their errors in the norm of [`super::course::LIGHT`].
#[derive(Clone, Copy)]
struct Lanes {
    x: Row,
    v: Row,
    error: Row,
}

impl Lanes {
    #[inline(always)]
    fn of<V: Eight>(x: V, v: V, error: V) -> Lanes {
        let mut lanes = Lanes { x: [0.0; LANES], v: [0.0; LANES], error: [0.0; LANES] };
        x.store(&mut lanes.x);
        v.store(&mut lanes.v);
        error.store(&mut lanes.error);
        lanes
    }

    #[inline(always)]
    fn load<V: Eight>(&self) -> (V, V, V) {
        (V::load(&self.x), V::load(&self.v), V::load(&self.error))
    }
}

/// Some pieces in a row.
struct Block {
    from: usize,
    to: usize,
    start: Lanes,
    /// Bounds of |x| in them.
    most: Row,
}

/// A step that may hold the largest value to one side.
#[derive(Clone, Copy)]
struct Candidate {
    /// An upper bound of the value.
    high: f64,
    class: u32,
    segment: u32,
    /// The number of the step in its segment.
    part: u32,
    state: [f64; 2],
    error: f64,
}

impl<'a> Group<'a> {
    fn of(course: &'a Course<'a>, factorials: &Factorials, damping: Ball, omegas: &'a [Ball]) -> Group<'a> {
        let rest = [0.0; LANES];
        Group {
            course,
            damping,
            omegas,
            entries: Entries::of(course, damping, omegas, factorials),
            now: Lanes { x: rest, v: rest, error: rest },
            low: [rest; 2],
            candidates: std::array::from_fn(|_| Vec::new()),
            limits: [KEPT; 2 * LANES],
        }
    }

    /// `blocks`: room for those of the course.
    fn into_found(mut self, blocks: &mut Vec<Block>) -> Vec<Result<Found, Refusal>> {
        let course = self.course;
        let mut from = 0;
        for jump in &course.jumps {
            advance(&mut self, from, jump.piece, blocks);
            self.jump(jump.displacement, jump.velocity);
            from = jump.piece;
        }
        advance(&mut self, from, course.pieces.len(), blocks);
        let mut bends = vec![0.0; course.terms - 2];
        for block in blocks.iter() {
            repeat_block(&mut self, block, &mut bends);
        }
        (0..self.omegas.len()).map(|lane| self.of_lane(lane, &mut bends)).collect()
    }

    fn of_lane(&self, lane: usize, bends: &mut [f64]) -> Result<Found, Refusal> {
        let state = [self.now.x[lane], self.now.v[lane]];
        let error = self.now.error[lane] * OUT_OF * up::MILLIONS;
        if !(state[0].is_finite() && state[1].is_finite() && error.is_finite()) {
            return Err(Refusal::OutOfRange);
        }
        let mut side = |side: usize| {
            let mut largest = Largest::default();
            largest.at_least(self.low[side][lane]);
            // Few others are left after the highest.
            let list = &self.candidates[2 * lane + side];
            let highest = list.iter().max_by(|a, b| a.high.total_cmp(&b.high));
            if let Some(highest) = highest.filter(|highest| !largest.reaches(highest.high)) {
                self.examine(lane, highest, side == 1, &mut largest, bends);
            }
            let mut others: Vec<&Candidate> = list.iter().filter(|other| !largest.reaches(other.high)).collect();
            others.order_by(|a, b| b.high.total_cmp(&a.high));
            for candidate in others {
                if largest.reaches(candidate.high) {
                    break;
                }
                self.examine(lane, candidate, side == 1, &mut largest, bends);
            }
            largest.ball()
        };
        let ball = |value: f64| Ball::from(value).widen(error);
        Ok(Found {
            primary: Sides { positive: side(0), negative: side(1) },
            state: State { x: ball(state[0]), v: ball(state[1]) },
        })
    }

    /// Takes account of a step as a polynomial.
    fn examine(&self, lane: usize, candidate: &Candidate, negative: bool, largest: &mut Largest, bends: &mut [f64]) {
        let class = candidate.class;
        let h = self.course.length(class as usize, self.entries.steps[class as usize]);
        let Piece { line, .. } = self.course.step(class, candidate.segment, candidate.part, h, bends);
        let theta = self.omegas[lane] * h;
        let shape = [(self.damping * theta).mid.hi * 2.0, theta.square().mid.hi, theta.mid.hi];
        let derivatives: Vec<f64> = line.iter().chain(&*bends).copied().collect();
        let (mut terms, off) = within_step(candidate.state, shape, h.mid.hi, &derivatives);
        if negative {
            terms.iter_mut().for_each(|term| *term = -*term);
        }
        largest.bound_fine(&Curve::rough(&terms, off + candidate.error).signed_curve());
    }

    /// The base jumps by a displacement and a velocity, and the mass lags behind by them: y += d, y' += v - 2 zeta omega d.
    fn jump(&mut self, displacement: Ball, velocity: Ball) {
        let Lanes { x: xs, v: vs, error } = &mut self.now;
        for lane in 0..LANES {
            let omega = self.omegas[lane.min(self.omegas.len() - 1)];
            let (x, v) = (omega * displacement, velocity - self.damping * omega * displacement * Ball::from(2.0));
            let to = [xs[lane] + x.mid.hi, vs[lane] + v.mid.hi];
            let rounded = (x.magnitude() + v.magnitude() + to[0].abs() + to[1].abs()) * 2.0 * UNIT;
            error[lane] += (x.rad + v.rad + rounded + TINY) * INTO * up::DOZENS;
            [xs[lane], vs[lane]] = to;
            // Where no step follows, the value counts all the same.
            let off = error[lane] * OUT_OF * up::FEW;
            self.low[0][lane] = self.low[0][lane].max(to[0] - off);
            self.low[1][lane] = self.low[1][lane].max(-to[0] - off);
        }
    }

    /// Keeps a step for each lane of a side in which it may exceed the value that is certainly reached.
    fn keep(&mut self, side: usize, bits: u32, step: &Piece, [highs, xs, vs, errors]: [Row; 4]) {
        for lane in (0..LANES).filter(|lane| bits >> lane & 1 == 1) {
            let Piece { class, segment, part, .. } = *step;
            let (state, error) = ([xs[lane], vs[lane]], errors[lane]);
            let candidate = Candidate { high: highs[lane], class, segment, part, state, error };
            let (place, low) = (2 * lane + side, self.low[side][lane]);
            let list = &mut self.candidates[place];
            if list.len() >= self.limits[place] {
                list.retain(|known| known.high > low);
                self.limits[place] = (2 * list.len()).max(KEPT);
            }
            list.push(candidate);
        }
    }
}

simd! {
/// Goes over some pieces in whole steps.
fn advance<V: Eight>(group: &mut Group, from: usize, to: usize, blocks: &mut Vec<Block>) {
    let (course, entries) = (group.course, &group.entries);
    let bent = course.terms - 2;
    let rounded = V::splat(rounding(course.terms) * INTO);
    let (grown, lost) = (V::splat(OUT_OF * up::FEW), V::splat(LOST));
    let (mut x, mut v, mut error) = group.now.load::<V>();
    let (mut above, mut below) = (V::load(&group.low[0]), V::load(&group.low[1]));
    for start in (from..to).step_by(BLOCK) {
        let end = (start + BLOCK).min(to);
        let mut block = Block { from: start, to: end, start: Lanes::of(x, v, error), most: [0.0; LANES] };
        let (mut highest, mut lowest, mut largest, mut worst, mut reach) = (x, -x, V::splat(0.0), error, 0.0);
        for (i, piece) in course.pieces[start..end].iter().enumerate() {
            let (rows, _) = entries.whole.of(piece.class);
            let bends = &course.bends[(start + i) * bent..][..bent];
            let size = x.abs() + v.abs();
            largest = largest.max(x.mul_add(x, v * v));
            error = V::load(&rows[row::DECAY].0).mul_add(error, rounded.mul_add(size, V::splat(piece.added)));
            [x, v] = state_after::<V>(rows, piece.line, bends, [x, v]);
            highest = highest.max(x);
            lowest = lowest.max(-x);
            worst = worst.max(error);
            reach = if piece.reach > reach { piece.reach } else { reach };
        }
        let off = worst * grown;
        above = above.max(highest - off);
        below = below.max(lowest - off);
        let most = (largest.sqrt() + lost + V::splat(reach) + off + off) * V::splat(up::FEW);
        most.store(&mut block.most);
        blocks.push(block);
    }
    group.now = Lanes::of(x, v, error);
    above.store(&mut group.low[0]);
    below.store(&mut group.low[1]);
}
}

simd! {
/// Goes over the pieces of a block once more if the motion may exceed in them what is certainly reached, and takes those in which
/// it may in short steps.
fn repeat_block<V: Eight>(group: &mut Group, block: &Block, bends: &mut [f64]) {
    let least = V::load(&group.low[0]).min(V::load(&group.low[1]));
    if V::load(&block.most).exceeds(least) == 0 {
        return;
    }
    let course = group.course;
    let bent = course.terms - 2;
    let rounded = V::splat(rounding(course.terms) * INTO);
    let (grown, lost) = (V::splat(OUT_OF), V::splat(LOST));
    let (mut x, mut v, mut error) = block.start.load::<V>();
    for at in block.from..block.to {
        let piece = &course.pieces[at];
        let (rows, more) = group.entries.whole.of(piece.class);
        let size = x.abs() + v.abs();
        let error1 = V::load(&rows[row::DECAY].0).mul_add(error, rounded.mul_add(size, V::splat(piece.added)));
        let off = (error + error1) * grown;
        let (above, below) = (V::load(&group.low[0]), V::load(&group.low[1]));
        // No motion from this state is larger.
        let whole_size = x.mul_add(x, v * v).sqrt() + lost;
        let mut may = (whole_size + V::splat(piece.reach) + off).exceeds(above.min(below));
        if may != 0 && bent == 0 {
            // Nor does it leave the motion that goes with the base by more than it does now.
            let (d0, d1) = (V::splat(piece.line[0]), V::splat(piece.line[1]));
            let entry = |row: usize| V::load(&more[row].0);
            let rest = entry(whole::RATE).mul_add(d0, entry(whole::LAG) * d1);
            let later = entry(whole::RISE).mul_add(d1, rest);
            let (dx, dv) = (x - rest, v - entry(whole::SWAY) * d1);
            let swing = entry(whole::SLACK).mul_add(V::splat(piece.most), dx.mul_add(dx, dv * dv).sqrt() + lost + off);
            may = (rest.max(later) + swing).exceeds(above) | (swing - rest.min(later)).exceeds(below);
        }
        let next = state_after::<V>(rows, piece.line, &course.bends[at * bent..][..bent], [x, v]);
        if may != 0 {
            in_short_steps::<V>(group, piece, Lanes::of(x, v, error), bends);
        }
        ([x, v], error) = (next, error1);
    }
}
}

/// Takes a piece in short steps from a state at its start, and keeps those that may hold the largest value to one side.
#[inline(always)]
fn in_short_steps<V: Eight>(group: &mut Group, piece: &Piece, now: Lanes, bends: &mut [f64]) {
    let course = group.course;
    let steps = group.entries.steps[piece.class as usize];
    let h = course.length(piece.class as usize, steps);
    let rounded = V::splat(rounding(course.terms) * INTO);
    let (zero, one, half, grown) = (V::splat(0.0), V::splat(1.0), V::splat(0.5), V::splat(OUT_OF));
    let (mut x, mut v, mut error) = now.load::<V>();
    let (mut above, mut below) = (V::load(&group.low[0]), V::load(&group.low[1]));
    for step in 0..steps as u32 {
        let step = course.step(piece.class, piece.segment, piece.part * steps as u32 + step, h, bends);
        let (rows, more) = group.entries.short.of(piece.class);
        let entry = |row: usize| V::load(&more[row].0);
        let size = x.abs() + v.abs();
        let [x1, v1] = state_after::<V>(rows, step.line, bends, [x, v]);
        let error1 = V::load(&rows[row::DECAY].0).mul_add(error, rounded.mul_add(size, V::splat(step.added)));
        let off = (error + error1) * grown;
        let most = V::splat(step.most);
        if (entry(short::LENGTH).mul_add(most, size) + off).exceeds(above.min(below)) != 0 {
            let theta = entry(short::THETA);
            // On the parabola with the same slopes at both ends.
            let q = (v / (v - v1)).max(zero).min(one);
            let top = (theta * q).mul_add((v1 - v).mul_add(q * half, v), x);
            let bent = entry(short::OWN)
                .mul_add(size, entry(short::DRIVEN).mul_add(most, entry(short::BENT) * V::splat(step.rise)));
            let slack = bent + bent + off;
            let (high, low) = (x.max(x1).max(top), x.min(x1).min(top));
            let (up, down) = (high + slack, slack - low);
            let bits = [up.exceeds(above), down.exceeds(below)];
            above = above.max(high - slack);
            below = below.max(-low - slack);
            if bits[0] | bits[1] != 0 {
                above.store(&mut group.low[0]);
                below.store(&mut group.low[1]);
                for (side, bounds) in [up, down].into_iter().enumerate() {
                    let mut rows = [[0.0; LANES]; 4];
                    rows.iter_mut().zip([bounds, x, v, off]).for_each(|(row, of)| of.store(row));
                    group.keep(side, bits[side], &step, rows);
                }
            }
        }
        ([x, v], error) = ([x1, v1], error1);
    }
    above.store(&mut group.low[0]);
    below.store(&mut group.low[1]);
}
