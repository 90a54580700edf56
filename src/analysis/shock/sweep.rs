//! The largest motions of oscillators during a signal, eight of them in parallel lanes of binary64: exact steps from event to
//! event with a running bound of their error, and for each step a bound of what the motion reaches within it. The few steps
//! that may hold the largest value are examined as polynomials afterwards. See docs/method/shock.md#maxima.

use super::base_motion::{BaseMotion, Segment};
use super::oscillator::{Factorials, LONGEST, Step, factorials_for, step, within};
use super::{MOST_STEPS, Refusal, Sides};
use crate::analysis::largest::{Curve, Largest};
use crate::base::rounding::UNIT;
use crate::base::{Ball, Number, up};
use crate::kernel::simd::{LANES, simd};

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

/// Up to this damping ratio errors are counted in q = x^2 + 2 zeta x v + v^2, which decays as exp(-2 zeta omega t) exactly.
const LIGHT: f64 = 0.5;
/// Bounds of sqrt(q) over the length of a state, and the other way, for ratios up to [`LIGHT`].
const INTO: f64 = 1.2248;
const OUT_OF: f64 = 1.4143;
/// Covers underflow in a step.
const TINY: f64 = 1e-290;
/// Candidates of a lane that are kept before those that were overtaken are dropped.
const KEPT: usize = 1024;

/// For each frequency, in ascending order.
pub fn sweep(motion: &BaseMotion, damping: Ball, omegas: &[Ball]) -> Result<Vec<Found>, Refusal> {
    let course = Course::of(motion);
    let steps: f64 = omegas.chunks(LANES).map(|group| course.steps(damping, group) * LANES as f64).sum();
    if steps > MOST_STEPS || steps.is_nan() {
        return Err(Refusal::TooLong { steps });
    }
    let factorials = Factorials::new(factorials_for(course.terms));
    let mut found = Vec::with_capacity(omegas.len());
    let most = omegas.chunks(LANES).map(|group| course.steps(damping, group)).fold(0.0, f64::max);
    let mut pieces = Pieces::with_room(&course, most as usize);
    let mut is_filled = false;
    for group in omegas.chunks(LANES) {
        let parts = course.parts(damping, group);
        if !is_filled || pieces.parts != parts {
            pieces.fill(&course, motion, parts);
            is_filled = true;
        }
        found.extend(of_group(&course, &pieces, &factorials, damping, group)?);
    }
    Ok(found)
}

/// The segments of a motion with their different lengths.
struct Course {
    lengths: Vec<Ball>,
    /// For each segment, the index of its length.
    class: Vec<u32>,
    /// The most derivatives that an acceleration has.
    terms: usize,
}

impl Course {
    fn of(motion: &BaseMotion) -> Course {
        /// Lengths that are compared with the next one.
        const RECENT: usize = 8;
        let mut known: Vec<&Number> = Vec::new();
        let mut class = Vec::with_capacity(motion.segments.len());
        for Segment { length, .. } in &motion.segments {
            let recent = known.len().saturating_sub(RECENT);
            let found = known[recent..].iter().rposition(|other| *other == length);
            let place = found.map_or_else(
                || {
                    known.push(length);
                    known.len() - 1
                },
                |place| recent + place,
            );
            class.push(place as u32);
        }
        let terms = motion.segments.iter().map(|segment| segment.derivatives.len()).max().unwrap_or(0).max(1);
        Course { lengths: known.into_iter().map(Number::to_ball).collect(), class, terms }
    }

    /// For each length the number of steps that it is divided into, a power of two.
    fn parts(&self, damping: Ball, group: &[Ball]) -> Vec<f64> {
        let fastest = group.iter().map(Ball::magnitude).fold(0.0, f64::max) * (2.0 * damping.magnitude()).max(1.0);
        let divided = |length: &Ball| {
            let least = fastest * length.magnitude() / LONGEST * up::FEW;
            let mut parts = 1.0;
            while parts < least {
                parts *= 2.0;
            }
            parts
        };
        self.lengths.iter().map(divided).collect()
    }

    fn steps(&self, damping: Ball, group: &[Ball]) -> f64 {
        let parts = self.parts(damping, group);
        self.class.iter().map(|class| parts[*class as usize]).sum()
    }
}

/// All steps of a group of frequencies, in binary64.
struct Pieces {
    /// For each length, the number of steps.
    parts: Vec<f64>,
    terms: usize,
    /// The index of the length of each step.
    class: Vec<u32>,
    /// For each step the acceleration and its derivatives at its start.
    derivatives: Vec<f64>,
    /// Bounds of |a| and |a'| within each step, and of the error of the state that its numbers cause.
    most: Vec<f64>,
    rise: Vec<f64>,
    added: Vec<f64>,
    /// By what the state jumps before a step: its index, displacement and velocity.
    jumps: Vec<(usize, Ball, Ball)>,
}

impl Pieces {
    /// Room for so many steps.
    fn with_room(course: &Course, count: usize) -> Pieces {
        let with = Vec::<f64>::with_capacity;
        Pieces {
            terms: course.terms,
            class: Vec::with_capacity(count),
            derivatives: with(count * course.terms),
            most: with(count),
            rise: with(count),
            added: with(count),
            jumps: Vec::new(),
            parts: Vec::new(),
        }
    }

    /// All steps, where each length is divided into so many parts.
    fn fill(&mut self, course: &Course, motion: &BaseMotion, parts: Vec<f64>) {
        let pieces = self;
        pieces.class.clear();
        pieces.jumps.clear();
        for list in [&mut pieces.derivatives, &mut pieces.most, &mut pieces.rise, &mut pieces.added] {
            list.clear();
        }
        pieces.parts = parts;
        let lengths: Vec<Ball> =
            course.lengths.iter().zip(&pieces.parts).map(|(length, parts)| *length * Ball::from(1.0 / parts)).collect();
        let mut jumps = motion.jumps.iter().peekable();
        for (i, (segment, class)) in motion.segments.iter().zip(&course.class).enumerate() {
            if let Some(jump) = jumps.next_if(|jump| jump.segment == i) {
                pieces.jumps.push((pieces.class.len(), jump.displacement, jump.velocity));
            }
            pieces.divide(&segment.derivatives, *class, lengths[*class as usize], motion.error);
        }
        if let Some(jump) = jumps.next() {
            pieces.jumps.push((pieces.class.len(), jump.displacement, jump.velocity));
        }
    }

    /// Adds the steps of a segment.
    fn divide(&mut self, derivatives: &[Ball], class: u32, h: Ball, error: f64) {
        let length = h.magnitude();
        for part in 0..self.parts[class as usize] as usize {
            let (mut most, mut rise, mut off) = (0.0, 0.0, error);
            let mut power = 1.0;
            for k in 0..self.terms {
                let (value, size, error) = shifted(derivatives, k, part as f64 * h.mid.hi);
                self.derivatives.push(value);
                most += size * power;
                off += error * power;
                if k > 0 {
                    rise += size * power * k as f64 / length;
                }
                power *= length / (k as f64 + 1.0);
            }
            self.class.push(class);
            self.most.push(most * up::DOZENS);
            self.rise.push(rise * up::DOZENS);
            self.added.push(((off + most * rounding(self.terms)) * length * INTO + TINY) * up::DOZENS);
        }
    }

    fn derivatives_of(&self, piece: usize) -> &[f64] {
        &self.derivatives[piece * self.terms..(piece + 1) * self.terms]
    }
}

/// The k-th derivative after a time t that is rounded twice, a bound of its size, and one of its error.
fn shifted(derivatives: &[Ball], k: usize, t: f64) -> (f64, f64, f64) {
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
fn rounding(terms: usize) -> f64 {
    (terms as f64 + 4.0) * 1.5 * UNIT
}

/// Rows of a step's entries, each of eight lanes.
mod row {
    pub const A11: usize = 0;
    pub const A12: usize = 1;
    pub const A22: usize = 2;
    /// Factor of the error.
    pub const DECAY: usize = 3;
    pub const THETA: usize = 4;
    /// Factors in the bound of how far the motion leaves a parabola: of |a'|, |a|, and the size of the state.
    pub const BENT: usize = 5;
    pub const DRIVEN: usize = 6;
    pub const OWN: usize = 7;
    /// The length in each lane.
    pub const LENGTH: usize = 8;
    /// From here on the entries for each derivative of the acceleration, first for x and then for v.
    pub const FORCING: usize = 9;
}

/// The entries of one length for eight frequencies.
fn entries(h: Ball, damping: Ball, group: &[Ball], terms: usize, factorials: &Factorials) -> Vec<f64> {
    let mut all = vec![0.0; (row::FORCING + 2 * terms) * LANES];
    let zeta = damping.magnitude();
    let curved = 1.0 + 2.0 * zeta + 4.0 * zeta * zeta;
    for lane in 0..LANES {
        // Lanes that are left over repeat the last frequency.
        let omega = group[lane.min(group.len() - 1)];
        let Step { own, forcing } = step(omega, damping, h, terms, factorials);
        let theta = omega * h;
        let decay = Number::Ball(-(damping * theta)).exp().map_or(1.0, |decay| decay.to_ball().magnitude());
        let (long, length) = (theta.magnitude(), h.magnitude());
        let bent = long / 12.0;
        let mut put = |at: usize, value: f64| all[at * LANES + lane] = value;
        put(row::A11, own[0].mid.hi);
        put(row::A12, own[1].mid.hi);
        put(row::A22, own[2].mid.hi);
        put(row::DECAY, if zeta <= LIGHT { decay.min(1.0) * up::FEW } else { 1.0 });
        put(row::THETA, theta.mid.hi);
        put(row::BENT, bent * length * length * up::DOZENS);
        put(row::DRIVEN, length * (bent * long * (2.0 * zeta + long * curved) + 32.0 * UNIT) * up::DOZENS);
        put(row::OWN, (bent * long * long * curved + 32.0 * UNIT) * up::DOZENS);
        put(row::LENGTH, length);
        for (k, (x, v)) in forcing.into_iter().enumerate() {
            put(row::FORCING + 2 * k, x.mid.hi);
            put(row::FORCING + 2 * k + 1, v.mid.hi);
        }
    }
    all
}

/// A step that may hold the largest value to one side.
#[derive(Clone, Copy)]
struct Candidate {
    /// An upper bound of the value.
    high: f64,
    piece: u32,
    state: [f64; 2],
    error: f64,
}

/// The eight oscillators of a group on their way.
struct Lanes {
    x: [f64; LANES],
    v: [f64; LANES],
    /// Bounds of the error of the state, in the norm of [`LIGHT`].
    error: [f64; LANES],
    /// Values of x that are certainly reached, on the positive and on the negative side.
    low: [[f64; LANES]; 2],
    candidates: [Vec<Candidate>; 2 * LANES],
    limits: [usize; 2 * LANES],
}

fn of_group(
    course: &Course,
    pieces: &Pieces,
    factorials: &Factorials,
    damping: Ball,
    group: &[Ball],
) -> Result<Vec<Found>, Refusal> {
    let length = |class: usize| course.lengths[class] * Ball::from(1.0 / pieces.parts[class]);
    let table: Vec<f64> = (0..course.lengths.len())
        .flat_map(|class| entries(length(class), damping, group, pieces.terms, factorials))
        .collect();
    let mut lanes = Lanes {
        x: [0.0; LANES],
        v: [0.0; LANES],
        error: [0.0; LANES],
        low: [[0.0; LANES]; 2],
        candidates: std::array::from_fn(|_| Vec::new()),
        limits: [KEPT; 2 * LANES],
    };
    let mut from = 0;
    for (at, displacement, velocity) in &pieces.jumps {
        run(pieces, &table, from, *at, &mut lanes);
        lanes.jump(*displacement, *velocity, damping, group);
        from = *at;
    }
    run(pieces, &table, from, pieces.class.len(), &mut lanes);
    let of = |lane: usize| {
        let state = [lanes.x[lane], lanes.v[lane]];
        let error = lanes.error[lane] * OUT_OF * up::MILLIONS;
        if !(state[0].is_finite() && state[1].is_finite() && error.is_finite()) {
            return Err(Refusal::OutOfRange);
        }
        let side = |side: usize| {
            let mut largest = Largest::default();
            largest.at_least(lanes.low[side][lane]);
            let take = |candidate: &Candidate, largest: &mut Largest| {
                let class = pieces.class[candidate.piece as usize] as usize;
                examine(pieces, candidate, [group[lane], damping, length(class)], side == 1, largest);
            };
            // Few others are left after the highest.
            let list = &lanes.candidates[2 * lane + side];
            let highest = list.iter().max_by(|a, b| a.high.total_cmp(&b.high));
            if let Some(highest) = highest.filter(|highest| !largest.reaches(highest.high)) {
                take(highest, &mut largest);
            }
            let mut others: Vec<&Candidate> = list.iter().filter(|other| !largest.reaches(other.high)).collect();
            others.sort_by(|a, b| b.high.total_cmp(&a.high));
            for candidate in others {
                if largest.reaches(candidate.high) {
                    break;
                }
                take(candidate, &mut largest);
            }
            largest.ball()
        };
        let ball = |value: f64| Ball::from(value).widen(error);
        Ok(Found {
            primary: Sides { positive: side(0), negative: side(1) },
            state: State { x: ball(state[0]), v: ball(state[1]) },
        })
    };
    (0..group.len()).map(of).collect()
}

/// Takes account of a step as a polynomial.
fn examine(
    pieces: &Pieces,
    candidate: &Candidate,
    [omega, damping, h]: [Ball; 3],
    negative: bool,
    largest: &mut Largest,
) {
    let theta = omega * h;
    let shape = [(damping * theta).mid.hi * 2.0, theta.square().mid.hi, theta.mid.hi];
    let (mut terms, off) = within(candidate.state, shape, h.mid.hi, pieces.derivatives_of(candidate.piece as usize));
    if negative {
        terms.iter_mut().for_each(|term| *term = -*term);
    }
    largest.bound_fine(&Curve::rough(&terms, off + candidate.error).signed());
}

impl Lanes {
    /// The base jumps by a displacement and a velocity, and the mass lags behind by them: y += d, y' += v - 2 zeta omega d.
    fn jump(&mut self, displacement: Ball, velocity: Ball, damping: Ball, group: &[Ball]) {
        for lane in 0..LANES {
            let omega = group[lane.min(group.len() - 1)];
            let (x, v) = (omega * displacement, velocity - damping * omega * displacement * Ball::from(2.0));
            let to = [self.x[lane] + x.mid.hi, self.v[lane] + v.mid.hi];
            let rounded = (x.magnitude() + v.magnitude() + to[0].abs() + to[1].abs()) * 2.0 * UNIT;
            self.error[lane] += (x.rad + v.rad + rounded + TINY) * INTO * up::DOZENS;
            [self.x[lane], self.v[lane]] = to;
            // Where no step follows, the value counts all the same.
            let off = self.error[lane] * OUT_OF * up::FEW;
            self.low[0][lane] = self.low[0][lane].max(to[0] - off);
            self.low[1][lane] = self.low[1][lane].max(-to[0] - off);
        }
    }

    fn keep(&mut self, place: usize, low: f64, candidate: Candidate) {
        let list = &mut self.candidates[place];
        if list.len() >= self.limits[place] {
            list.retain(|known| known.high > low);
            self.limits[place] = (2 * list.len()).max(KEPT);
        }
        list.push(candidate);
    }
}

simd! {
/// Steps from one piece to another.
fn run<V: Eight>(pieces: &Pieces, table: &[f64], from: usize, to: usize, lanes: &mut Lanes) {
    let stride = (row::FORCING + 2 * pieces.terms) * LANES;
    let (mut x, mut v, mut error) = (V::load(&lanes.x), V::load(&lanes.v), V::load(&lanes.error));
    let (mut above, mut below) = (V::load(&lanes.low[0]), V::load(&lanes.low[1]));
    let rounded = V::splat(rounding(pieces.terms) * INTO);
    let (zero, one, half) = (V::splat(0.0), V::splat(1.0), V::splat(0.5));
    let grown = V::splat(OUT_OF);
    let mut least = above.min(below);
    for piece in from..to {
        let start = pieces.class[piece] as usize * stride;
        let entries = &table[start..start + stride];
        let entry = |row: usize| V::load(&entries[row * LANES..]);
        let (mut x1, mut v1) = (zero, zero);
        for (k, d) in pieces.derivatives[piece * pieces.terms..(piece + 1) * pieces.terms].iter().enumerate() {
            let d = V::splat(*d);
            x1 = entry(row::FORCING + 2 * k).mul_add(d, x1);
            v1 = entry(row::FORCING + 2 * k + 1).mul_add(d, v1);
        }
        let (a11, a12, a22) = (entry(row::A11), entry(row::A12), entry(row::A22));
        x1 = a11.mul_add(x, a12.mul_add(v, x1));
        v1 = a22.mul_add(v, (-a12).mul_add(x, v1));
        let size = x.abs() + v.abs();
        let error1 = entry(row::DECAY).mul_add(error, rounded.mul_add(size, V::splat(pieces.added[piece])));
        let off = (error + error1) * grown;
        let most = V::splat(pieces.most[piece]);
        // No motion from this state is larger.
        if (entry(row::LENGTH).mul_add(most, size) + off).exceeds(least) != 0 {
            let theta = entry(row::THETA);
            // On the parabola with the same slopes at both ends.
            let q = (v / (v - v1)).max(zero).min(one);
            let top = (theta * q).mul_add((v1 - v).mul_add(q * half, v), x);
            let bent = entry(row::OWN).mul_add(size, entry(row::DRIVEN).mul_add(most, entry(row::BENT) * V::splat(pieces.rise[piece])));
            let slack = bent + bent + off;
            let (high, low) = (x.max(x1).max(top), x.min(x1).min(top));
            let (up, down) = (high + slack, slack - low);
            let bits = [up.exceeds(above), down.exceeds(below)];
            above = above.max(high - slack);
            below = below.max(-low - slack);
            least = above.min(below);
            if bits[0] | bits[1] != 0 {
                let (xs, vs, errors) = (x.to_array(), v.to_array(), off.to_array());
                for (side, (bits, bounds, low)) in [(bits[0], up, above), (bits[1], down, below)].into_iter().enumerate() {
                    let (bounds, low) = (bounds.to_array(), low.to_array());
                    for lane in 0..LANES {
                        if bits >> lane & 1 == 1 {
                            let (state, error) = ([xs[lane], vs[lane]], errors[lane]);
                            let candidate = Candidate { high: bounds[lane], piece: piece as u32, state, error };
                            lanes.keep(2 * lane + side, low[lane], candidate);
                        }
                    }
                }
            }
        }
        (x, v, error) = (x1, v1, error1);
    }
    x.store(&mut lanes.x);
    v.store(&mut lanes.v);
    error.store(&mut lanes.error);
    above.store(&mut lanes.low[0]);
    below.store(&mut lanes.low[1]);
}
}
