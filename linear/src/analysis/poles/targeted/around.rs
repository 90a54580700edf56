//! All poles in an ellipse about a range of frequencies, with their residues and a bound of H on the ellipse. In: a system whose
//! damping is light beside the gaps of its undamped frequencies, the range. Out: each pole and the vector of its residues, and what
//! is needed to bound the rest of H, which has no pole in the ellipse. See docs/method/transfer.md#a-range-of-many-poles.
//!
//! With 0 <= C <= x (M + K / r), g = max |s| x (1 + l / r) / |s^2 + l| over the undamped l = omega^2 and B = max 1 / |s^2 + l| +
//! max |s| x (1 + l / r) / |s^2 + l|^2 / (1 - g): where g < 1, |M^1/2 Q(s)^-1 M^1/2| <= B. That holds with any part of C as well, so a
//! curve on which g < 1 surrounds as many poles as without damping: a certified count of the l counts them.
//!
//! With r = Q(z) x, for a circle about z on which that bound holds and within which there is one pole s_j, of residue V:
//! x / (s - z) = Q^-1 r / (s - z) + Q^-1 ((s + z) M + C) x, integrated over the circle, gives x - e = V ((s_j + z) M + C) x with
//! |e| <= B |r| in the norms of M and of its inverse. V has rank one, so V = (x - e)(x - e)^T / k with
//! k = (x - e)^T ((s_j + z) M + C) x, and (z - s_j) k = (x - e)^T r.

use crate::analysis::answer::ModeKind;
use crate::analysis::modes::mesh::elimination::Rounding;
use crate::analysis::modes::mesh::least_inertia;
use crate::analysis::modes::modes_as;
use crate::analysis::modes::parts::Part;
use crate::analysis::modes::request::{Request, Which};
use crate::analysis::poles::pencil::{Application, Pencil, Vector};
use crate::analysis::poles::refinement::Pair;
use crate::analysis::poles::targeted::Large;
use crate::analysis::poles::targeted::iteration::{Start, follow};
use crate::base::{Ball, Dd, Number, Power, larger, up};
use crate::kernel::complex::Complex;
use crate::kernel::squares::Squares;
use crate::kernel::triple::Precise;
use crate::system::{CoordinateId, LinearSystem};

/// C <= weight (M + K / reference) in the sense of quadratic forms, and C >= 0.
#[derive(Clone, Copy, Debug)]
pub struct Drag {
    pub weight: f64,
    /// 1/s^2
    pub reference: f64,
}

/// The poles in an ellipse with the foci i reach and -i reach: those of `poles` and their conjugates, and no others.
pub struct Around {
    /// rad/s
    pub reach: f64,
    /// The sum of the semi-axes over `reach`.
    pub rho: f64,
    /// The longer semi-axis: no point of the ellipse is farther from zero. rad/s
    pub size: f64,
    pub poles: Vec<SimplePole>,
    /// |M^1/2 Q^-1 M^1/2| on the ellipse.
    bound: f64,
    /// M >= diag(scale)
    scale: Vec<f64>,
}

/// A pole in the upper half plane, and the vector of its residues.
pub struct SimplePole {
    /// On the imaginary axis exactly where nothing damps.
    pub s: Complex<Ball>,
    /// A lower bound of its distance from the ellipse.
    pub clearance: f64,
    x: Vector,
    /// |e| in the norm of M.
    slip: f64,
    /// k
    square: Complex<Ball>,
}

/// Coefficients of 1, s and s^2.
type Polynomial = [Vec<(CoordinateId, Number)>; 3];

/// More poles in the ellipse than this are left to the methods for all poles.
const MOST_POLES: usize = 200;
/// The longer semi-axis beside the reach: where the widest gap is found between these.
const SEMI_AXES: [f64; 2] = [1.25, 1.6];
/// The largest g.
const MOST_DRAG: f64 = 0.9;
/// A circle about a pole reaches so far to the next undamped frequency.
const PART_OF_GAP: f64 = 0.4;
/// Where the count is taken between the ellipse and the next omega^2: next to it, it would be open whether that is counted.
const PART_BEYOND: f64 = 0.9;
/// Factors that cover the roundings of a few dozen operations in binary64.
const UP: f64 = up::THOUSANDS;
const DOWN: f64 = 1.0 - 1e-12;

impl Around {
    /// For frequencies up to `reach`, rad/s. `None` if there are too many poles, or the conditions above do not hold.
    pub fn of(system: &LinearSystem, reach: f64, drag: Drag) -> Option<Around> {
        let large = Large::of(system, &Part::whole(system))?;
        let networks = &large.networks;
        let count = |mu: f64| networks.pattern.count(&networks.k, &networks.m, mu, Rounding::Down);
        let wanted = count((reach * SEMI_AXES[1]).power(2))? + 1;
        if wanted > MOST_POLES || 4 * wanted >= system.n() {
            return None;
        }
        let scale = least_inertia(&networks.m)?;
        let modes =
            modes_as(system, &Request { which: Which::Lowest(wanted), ..Request::default().without_shares() }).ok()?;
        let certain = modes.list.len() == wanted
            && modes.list.iter().all(|mode| {
                mode.kind == ModeKind::Oscillation && mode.cluster.is_none() && mode.omega_squared.is_finite()
            });
        if !certain {
            return None;
        }
        let squares: Vec<Ball> = modes.list.iter().map(|mode| mode.omega_squared).collect();
        let (inside, square) = gap(&squares, reach)?;
        let others = square + PART_BEYOND * (squares[inside].to_f64() - square);
        let apart = squares.windows(2).all(|pair| (pair[1] - pair[0]).is_positive()) && squares[0].is_positive();
        // Each of the disjoint enclosures below `others` holds one, and no more are there.
        if !apart || others <= square || count(others)? != inside {
            return None;
        }
        let spectrum = Spectrum { known: squares[..inside].to_vec(), others, drag };
        let longer = square.sqrt() / reach;
        let rho = (longer + (longer * longer - 1.0).sqrt()) * DOWN;
        let size = 0.5 * reach * (rho + 1.0 / rho) * UP;
        let bound = spectrum.on_ellipse(reach, rho, size)?;
        let pencil = large.exact.to_dd();
        let mut poles = Vec::with_capacity(inside);
        let mut circles: Vec<(Complex<f64>, f64)> = Vec::with_capacity(inside);
        for (mode, found) in modes.list[..inside].iter().enumerate() {
            let x = found.shape.iter().map(|&x| Complex::real(x)).collect();
            let start = Start { s: Complex::new(0.0, found.omega.mid.hi), x, mode };
            let pair = correct_once(&large, &pencil, follow(networks, &pencil, &start)?)?;
            let s = pair.s.to_f64();
            let radius = spectrum.radius(mode, square.sqrt());
            // The sum of the distances from the foci is at most twice the longer semi-axis in the ellipse.
            let foci = 0.5 * ((s - Complex::new(0.0, reach)).abs() + (s + Complex::new(0.0, reach)).abs()) * UP;
            let clearance = 0.5 * reach * (rho + 1.0 / rho) * DOWN - foci;
            let alone = circles.iter().all(|(other, reached)| (s - *other).abs() * DOWN > radius + reached);
            if !(clearance > radius && alone) {
                return None;
            }
            circles.push((s, radius));
            poles.push(SimplePole::of(
                &large.exact,
                &pair,
                radius,
                spectrum.on_circle(mode, s, radius)?,
                clearance,
                &scale,
            )?);
        }
        Some(Around { reach, rho, size, poles, bound, scale })
    }

    /// The residue of p(s)^T Q(s)^-1 b(s) at a pole.
    pub fn residue(&self, pole: &SimplePole, p: &Polynomial, b: &Polynomial) -> Complex<Ball> {
        pole.along(p, &self.scale) * pole.along(b, &self.scale) / pole.square
    }

    /// A bound of |p(s)^T Q(s)^-1 b(s)| on the ellipse.
    pub fn most(&self, p: &Polynomial, b: &Polynomial) -> f64 {
        let [p, b] = [p, b].map(|a| a.iter().rev().fold(0.0, |sum, a| sum * self.size + dual(a, &self.scale)));
        self.bound * p * b * UP
    }
}

/// The widest place for the ellipse to cross the axis: the number of squares below, and the square of the crossing.
fn gap(squares: &[Ball], reach: f64) -> Option<(usize, f64)> {
    let [least, most] = SEMI_AXES.map(|part| (part * reach).power(2));
    let mut best: Option<(f64, usize, f64)> = None;
    for (inside, above) in squares.iter().map(Ball::to_f64).enumerate() {
        let below = if inside == 0 { -above } else { squares[inside - 1].to_f64() };
        let square = (0.5 * (below + above)).clamp(least, most);
        let room = (above - square).min(square - below);
        if room > 0.0 && best.is_none_or(|best| room > best.0) {
            best = Some((room, inside, square));
        }
    }
    best.map(|(_, inside, square)| (inside, square))
}

/// One more correction: the pair's error is its square after those of [`follow`].
fn correct_once(large: &Large, pencil: &Pencil<Dd>, mut pair: Pair) -> Option<Pair> {
    /// Next to the pole itself, the correction would be along x alone.
    const ASIDE: f64 = 1e-8;
    let applied = pencil.apply(pair.s, &pair.x);
    let slope = pencil.slope(pair.s.to_f64(), &applied);
    pair.s = pair.s + (-(applied.energy.to_f64() * slope.recip())).into();
    let force: Vec<Complex<f64>> = pencil.apply(pair.s, &pair.x).force.iter().map(|f| f.to_f64()).collect();
    let step = large.networks.factor(pair.s.to_f64().scale(1.0 + ASIDE))?.solve(&force);
    step.iter().enumerate().for_each(|(i, &step)| pair.x.add(i, -step));
    let applied = pencil.apply(pair.s, &pair.x);
    pair.s = pair.s + (-(applied.energy.to_f64() * slope.recip())).into();
    Some(pair)
}

/// The undamped omega^2, and the damping.
struct Spectrum {
    known: Vec<Ball>,
    /// All others are at least this.
    others: f64,
    drag: Drag,
}

impl Spectrum {
    /// B, given lower bounds of |s^2 + l| for the known l and for all others, and an upper bound of |s|.
    fn bound(&self, size: f64, known: impl Iterator<Item = f64>, others: f64) -> Option<f64> {
        let weight = |square: f64| self.drag.weight * (1.0 + square / self.drag.reference) * UP;
        let (mut nearest, mut g, mut both) = (f64::INFINITY, 0.0f64, 0.0f64);
        let of_known = known.zip(&self.known).map(|(least, square)| (least, weight(square.magnitude())));
        // Beyond `others` the bound of |s^2 + l| grows with l, faster than its weight.
        for (least, weight) in of_known.chain([(others, weight(self.others))]) {
            if least.is_nan() || least <= 0.0 {
                return None;
            }
            nearest = nearest.min(least);
            g = larger(g, size * weight / least * UP);
            both = larger(both, size * weight / (least * least) * UP);
        }
        (g < MOST_DRAG).then(|| (1.0 / nearest + both / (1.0 - g)) * UP)
    }

    /// On the ellipse: -s^2 is on one with the foci 0 and reach^2, so its distance from a point between its ends is at least what is
    /// left of the longer semi-axis when half of the point's distances from the foci are taken away.
    fn on_ellipse(&self, reach: f64, rho: f64, size: f64) -> Option<f64> {
        let (centre, square) = (0.5 * reach * reach, rho * rho);
        let longer = 0.5 * centre * (square + 1.0 / square);
        let slack = 1e-12 * (longer + centre);
        let known = self.known.iter().map(|l| longer - larger(centre, (*l - Ball::from(centre)).magnitude()) - slack);
        self.bound(size, known, self.others - size * size * UP)
    }

    /// On a circle about s within which there is i omega of one known mode alone.
    fn on_circle(&self, own: usize, s: Complex<f64>, radius: f64) -> Option<f64> {
        let slack = 1e-13 * (s.abs() + radius);
        let known = self.known.iter().enumerate().map(|(k, square)| {
            let omega = square.sqrt();
            let distance = |sign: f64| (s - Complex::new(0.0, sign * omega.to_f64())).abs();
            let (near, far) = (distance(1.0), distance(-1.0) - radius - omega.rad - slack);
            let near = if k == own { radius - near } else { near - radius } - omega.rad - slack;
            if near > 0.0 && far > 0.0 { near * far * DOWN } else { 0.0 }
        });
        let size = (s.abs() + radius) * UP;
        self.bound(size, known, self.others - size * size * UP)
    }

    fn radius(&self, own: usize, end: f64) -> f64 {
        let omega = |k: usize| self.known[k].to_f64().sqrt();
        let below = if own == 0 { omega(0) } else { omega(own) - omega(own - 1) };
        let above = if own + 1 == self.known.len() { end - omega(own) } else { omega(own + 1) - omega(own) };
        PART_OF_GAP * below.min(above).min(0.25 * omega(own))
    }
}

impl SimplePole {
    /// `bound` is B on the circle with this radius.
    fn of(
        pencil: &Pencil<Precise>,
        pair: &Pair,
        radius: f64,
        bound: f64,
        clearance: f64,
        scale: &[f64],
    ) -> Option<SimplePole> {
        let applied = pencil.apply(pair.s, &pair.x);
        let size = |z: &Complex<Precise>| ball(*z).magnitude();
        let residual =
            (applied.force.iter().zip(scale).map(|(f, m)| size(f).power(2) / m).sum::<f64>() * UP).sqrt() * UP;
        let slip = bound * residual * UP;
        let s = pair.s.to_ball();
        let (inertia, drag) = (energy(&pencil.m, &applied.m_stretch), energy(&pencil.c, &applied.c_stretch));
        // |((s_j + z) M + C) x| in the norm of the inverse of M, term by term; |s_j| <= |z| + radius.
        let twice = (2.0 * s.magnitude() + radius) * UP;
        let steep = steepness(pencil, &applied, twice, scale);
        let along = (s + s) * inertia + drag;
        let product = ball(applied.energy);
        // With d = s_j - z, k = along + d inertia - e^T (..), and |d k| <= |x^T r| + |e| |r|.
        let doubt = slip * residual * UP;
        let k = |distance: f64| {
            let by = (distance * inertia.magnitude() + slip * steep) * UP;
            Complex::new(along.re.widen(by), along.im.widen(by))
        };
        let least = |k: Complex<Ball>| k.mid().to_f64().abs() * DOWN - k.radius();
        let distance = (product.magnitude() + doubt) / least(k(radius)) * UP;
        if !(least(k(radius)) > 0.0 && distance < radius) {
            return None;
        }
        let square = k(distance);
        let step = Complex::new(product.re.widen(doubt), product.im.widen(doubt)) / square;
        let pole = s - step;
        let is_undamped = pencil.c.is_empty();
        let pole = if is_undamped { Complex::new(Ball::ZERO, pole.im) } else { pole };
        Some(SimplePole { s: pole, clearance, x: pair.x.clone(), slip, square })
    }

    /// a(s_j) . (x - e)
    fn along(&self, a: &Polynomial, scale: &[f64]) -> Complex<Ball> {
        a.iter().rev().fold(Complex::ZERO, |sum, a| {
            let product = a.iter().fold(Complex::<Ball>::ZERO, |sum, (i, value)| {
                sum + self.x.entry(i.index()).to_ball().scale(value.to_ball())
            });
            let lost = dual(a, scale) * self.slip * UP;
            let product = Complex::new(product.re.widen(lost), product.im.widen(lost));
            sum * self.s + product
        })
    }
}

/// |a| in the norm of the inverse of M.
fn dual(a: &[(CoordinateId, Number)], scale: &[f64]) -> f64 {
    // An entry may consist of several numbers.
    let sum = |list: &[(CoordinateId, Number)]| {
        list.iter().map(|(i, value)| value.to_ball().magnitude() / scale[i.index()].sqrt()).sum::<f64>()
    };
    sum(a) * UP
}

/// sum w t^2
fn energy(squares: &Squares<Precise>, stretches: &[Complex<Precise>]) -> Complex<Ball> {
    ball(squares.weights.iter().zip(stretches).fold(Complex::ZERO, |sum, (w, &t)| sum + (t * t).scale(*w)))
}

fn ball(z: Complex<Precise>) -> Complex<Ball> {
    let part = |x: Precise| {
        let (mid, rest) = x.value.split();
        Ball::new(mid, (x.radius + rest.abs()) * UP)
    };
    Complex::new(part(z.re), part(z.im))
}

/// |(z M + C) x| in the norm of the inverse of M, at most, for |z| <= `twice`.
fn steepness(pencil: &Pencil<Precise>, applied: &Application<Precise>, twice: f64, scale: &[f64]) -> f64 {
    let mut sizes = vec![0.0; pencil.n];
    for (squares, stretches, by) in [(&pencil.m, &applied.m_stretch, twice), (&pencil.c, &applied.c_stretch, 1.0)] {
        for (t, &stretch) in stretches.iter().enumerate() {
            let size = |x: Precise| x.value.hi().abs() * up::FEW + x.radius;
            let force = by * size(squares.weights[t]) * ball(stretch).magnitude();
            let (indices, values) = squares.row(t);
            indices.iter().zip(values).for_each(|(&i, &a)| sizes[i as usize] += size(a) * force);
        }
    }
    // Sums of this many products.
    let roundings = 1.0 + (pencil.m.len() + pencil.c.len() + 16) as f64 * f64::EPSILON;
    (sizes.iter().zip(scale).map(|(f, m)| (f * roundings).power(2) / m).sum::<f64>() * UP * roundings).sqrt() * UP
}
