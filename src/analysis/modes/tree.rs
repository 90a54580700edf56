//! The lowest modes of a tree of bodies and springs, each certified by itself, in time proportional to its size.
//!
//! 1. Brackets: counts of frequencies below eight omegas at once, in binary64, until each frequency wanted is alone and
//!    narrowly enclosed. By the theory of [`forest`] a count at omega is right for some omega (1 +- eta).
//! 2. Vectors: the null vector of the elimination at omega, its Rayleigh quotient the next omega.
//! 3. Bounds: Kato and Temple's for the inverse problem M x = mu K x. With rho = x^T M x / x^T K x between its neighbours'
//!    brackets mu_above > mu_below (in mu),
//!
//!      rho - e^2 / (mu_above - rho) <= mu <= rho + e^2 / (rho - mu_below),   e = |K^-1 M x - rho x|_K / |x|_K,
//!
//!    and e is bounded by the energy of any forces g that balance the inertia forces M x (Prager and Synge's hypercircle;
//!    Thomson's principle): |K^-1 M x - rho x|_K^2 <= sum (g - rho k b)^2 / k, b = A x. In a tree such forces are found from
//!    the leaves; what rounding leaves unbalanced, r, adds |r|_(M^-1) / sqrt(lambda_1). In this norm errors of soft and stiff
//!    directions weigh alike, so vectors of working precision suffice.
//! 4. The same in double-double where more digits are asked for.
//!
//! A tree without ground is held by springs tau m to the ground, which add tau to every eigenvalue.
//! Clause: spec.md 10.10.

use crate::analysis::modes::eigen::Displacements;
use crate::analysis::modes::forest::{Forest, Node, counts, root, shapes, taken, twisted};
use crate::analysis::modes::request::Band;
use crate::analysis::numeric::dense::Real;
use crate::analysis::numeric::pairwise::PairwiseSum;
use crate::analysis::numeric::triple::Triple;
use crate::base::Dd;
use std::ops::Range;

/// A mode of a tree.
#[derive(Clone, Debug)]
pub struct TreeMode {
    pub lambda: Triple,
    pub radius: f64,
    /// M-normalised to working precision.
    pub x: Displacements,
}

/// An approximate mode: its nodes' displacements.
struct Vector {
    omega: f64,
    x: Vec<f64>,
}

/// An interval of omega with one frequency.
#[derive(Clone, Copy, Debug)]
struct Bracket {
    low: f64,
    high: f64,
}

/// Lanes computed at once while brackets are narrowed.
const BUDGET: usize = 24;
const MAX_PASSES: usize = 400;
/// How narrow a bracket has to be beside the distance of its neighbours; tried in turn.
const NARROW: [f64; 4] = [0.25, 0.01, 1e-4, 1e-8];

/// The `wanted` lowest modes that are not rigid, ascending; `None` if the tree is not for this method: frequencies too close
/// to be told apart in binary64, or vectors out of range.
pub fn lowest(forest: &Forest, wanted: usize, tolerance: f64) -> Option<Vec<TreeMode>> {
    Search::new(forest).modes(0..wanted, tolerance)
}

/// The modes that may lie in the band, rigid ones left out, ascending, and how many that are not rigid come before them.
pub fn within(forest: &Forest, band: Band, tolerance: f64) -> Option<(usize, Vec<TreeMode>)> {
    let mut search = Search::new(forest);
    let wanted = search.numbers(band);
    let before = wanted.start;
    Some((before, search.modes(wanted, tolerance)?))
}

/// The rigid motion of a tree without ground: down from the root, each spring unstretched.
pub fn rigid_motion(forest: &Forest) -> Vec<Dd> {
    let mut x = vec![Dd::ONE; forest.n()];
    for (i, node) in forest.nodes.iter().enumerate().rev().skip(1) {
        x[i] = -(node.parents * x[node.parent as usize]) / node.own;
    }
    let inertia = forest.nodes.iter().zip(&x).fold(Dd::ZERO, |sum, (node, x)| sum + node.mass * x.square());
    let scale = inertia.sqrt().recip();
    let mut by_coordinate = vec![Dd::ZERO; forest.n()];
    for (&coordinate, &x) in forest.coordinates.iter().zip(&x) {
        by_coordinate[coordinate as usize] = x * scale;
    }
    by_coordinate
}

struct Search<'a> {
    forest: &'a Forest,
    nodes: Vec<Node<f64>>,
    tree: Tree,
    /// Relative error of the omega for which a count in binary64 is right.
    eta: f64,
    /// Omegas and how many frequencies are below, ascending.
    points: Vec<(f64, i64)>,
    /// Of the frequencies wanted and one more.
    brackets: Vec<Bracket>,
}

impl<'a> Search<'a> {
    fn new(forest: &'a Forest) -> Search<'a> {
        let tree = Tree::of(forest);
        // Each number of an elimination takes part in at most breadth + 12 roundings, conversion to binary64 included.
        let eta = tree.factor_change * ((tree.breadth + 12.0) * f64::ERROR + forest.uncertainty);
        Search { forest, nodes: forest.nodes_in(), tree, eta, points: Vec::new(), brackets: Vec::new() }
    }

    /// The modes with these numbers, counted from the first that is not rigid.
    fn modes(&mut self, wanted: Range<usize>, tolerance: f64) -> Option<Vec<TreeMode>> {
        let elastic = self.forest.n() - self.rigid() as usize;
        let wanted = wanted.start.min(elastic)..wanted.end.min(elastic);
        if wanted.is_empty() {
            return Some(Vec::new());
        }
        // The neighbours on either side are bracketed too.
        let bracketed = wanted.start.saturating_sub(1)..(wanted.end + 1).min(elastic);
        let first = wanted.start - bracketed.start;
        for narrow in NARROW {
            self.narrow(&bracketed, narrow)?;
            if let Some(vectors) = self.vectors(first..first + wanted.len()) {
                let certified = (first..).zip(vectors).map(|(k, v)| self.certified(k, v, tolerance));
                return certified.collect();
            }
        }
        None
    }

    /// 1 if there is a rigid motion.
    fn rigid(&self) -> i64 {
        i64::from(self.forest.floats)
    }

    /// The numbers of the modes that may lie in the band.
    fn numbers(&mut self, band: Band) -> Range<usize> {
        let slack = 8.0 * self.eta;
        let least = self.least();
        let (low, high) = ((band.from * (1.0 - slack)).max(least), (band.to * (1.0 + slack)).max(least));
        self.count(&[low, high]);
        let below = |omega: f64| self.points.iter().find(|point| point.0 == omega).map_or(0, |point| point.1);
        let number = |omega: f64| (below(omega) - self.rigid()).max(0) as usize;
        number(low)..number(high).max(number(low))
    }

    /// No frequency of a model in the range of binary64 is below.
    fn least(&self) -> f64 {
        self.highest() * 1e-140
    }

    /// Narrows the brackets of the frequencies with these numbers, and encloses the first of all within a factor.
    fn narrow(&mut self, wanted: &Range<usize>, narrow: f64) -> Option<()> {
        let (from, to) = (self.rigid() + wanted.start as i64, self.rigid() + wanted.end as i64);
        self.count(&[self.least(), self.highest()]);
        if self.points[0].1 != self.rigid() {
            return None;
        }
        for _ in 0..MAX_PASSES {
            let open = self.open_intervals(from, to, narrow)?;
            if open.is_empty() {
                break;
            }
            let places = self.places(&open);
            self.count(&places);
        }
        let single =
            self.points.windows(2).filter(|pair| pair[1].1 == pair[0].1 + 1 && (from..to).contains(&pair[0].1));
        self.brackets = single.map(|pair| Bracket { low: pair[0].0, high: pair[1].0 }).collect();
        (self.brackets.len() == wanted.len()).then_some(())
    }

    /// A frequency below which there is none, and next to the first one.
    fn below_all(&self) -> f64 {
        let without = self.points.iter().take_while(|point| point.1 <= self.rigid());
        without.last().map_or(0.0, |point| point.0)
    }

    /// Above all frequencies: omega^2 <= max (v + sum k |a| (|a| + |b|)) / m by Gershgorin's theorem on M^-1 K.
    fn highest(&self) -> f64 {
        let mut row: Vec<f64> = self.nodes.iter().map(|node| node.ground).collect();
        for (i, node) in self.nodes.iter().enumerate() {
            let (a, b) = (node.own.abs(), node.parents.abs());
            row[i] += a * (a + b) / node.flexibility;
            row[node.parent as usize] += b * (a + b) / node.flexibility;
        }
        let square = row.iter().zip(&self.nodes).map(|(row, node)| row / node.mass).fold(0.0, f64::max);
        square.sqrt() * 1.01
    }

    fn count(&mut self, places: &[f64]) {
        for chunk in places.chunks(8) {
            let mut lanes = [chunk[0]; 8];
            lanes[..chunk.len()].copy_from_slice(chunk);
            let counted = counts(&self.nodes, lanes);
            self.points.extend(chunk.iter().copied().zip(counted));
        }
        self.points.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.points.dedup();
    }

    /// Intervals between points that hold wanted frequencies and are not narrow; `None` if some cannot be separated.
    fn open_intervals(&self, from: i64, to: i64, narrow: f64) -> Option<Vec<usize>> {
        let mut open = Vec::new();
        for i in 0..self.points.len() - 1 {
            let ((low, below), (high, above)) = (self.points[i], self.points[i + 1]);
            let first = below <= self.rigid() && above > self.rigid();
            if first && high > 1.1 * low {
                open.push(i);
                continue;
            }
            if above <= from || below >= to || above <= below {
                continue;
            }
            if above > below + 1 && high - low <= 8.0 * self.eta * high {
                return None;
            }
            // Half of a bracket as wide as that, and neither end may be wrong by eta.
            let least = 4.0 * self.eta * high;
            if above > below + 1 || high - low > (narrow * self.room(i).min(low)).max(least) {
                open.push(i);
            }
        }
        Some(open)
    }

    /// The distance from interval i to the frequencies next to it: at least one interval without any lies between.
    fn room(&self, i: usize) -> f64 {
        let points = &self.points;
        let below = (0..i).rev().find(|&j| points[j].1 < points[i].1).map(|j| points[i].0 - points[j + 1].0);
        let above =
            (i + 2..points.len()).find(|&j| points[j].1 > points[i + 1].1).map(|j| points[j - 1].0 - points[i + 1].0);
        below.unwrap_or(f64::INFINITY).min(above.unwrap_or(f64::INFINITY))
    }

    /// Places within the intervals, as many as the budget allows.
    fn places(&self, open: &[usize]) -> Vec<f64> {
        let levels = (BUDGET / open.len() + 1).max(2).ilog2();
        let mut places = Vec::new();
        for &i in open {
            split(self.points[i].0, self.points[i + 1].0, levels, &mut places);
        }
        places
    }

    /// Vectors of the brackets: Rayleigh quotient iteration on the elimination. `None` if one leaves its bracket.
    fn vectors(&self, wanted: Range<usize>) -> Option<Vec<Vector>> {
        let mut all = Vec::with_capacity(wanted.len());
        let mut room = Vec::new();
        for chunk in self.brackets[wanted].chunks(8) {
            let (omega, settled) = self.iterate(chunk, &mut room);
            for (lane, bracket) in chunk.iter().enumerate() {
                all.push(match settled[lane] {
                    true => Vector { omega: omega[lane], x: room.iter().map(|x| x[lane]).collect() },
                    false => self.twisted(bracket)?,
                });
            }
        }
        Some(all)
    }

    /// Leaves vectors of up to eight brackets in `room`. Returns their omegas and whether each settled inside its
    /// bracket.
    fn iterate(&self, brackets: &[Bracket], room: &mut Vec<[f64; 8]>) -> ([f64; 8], [bool; 8]) {
        let mut omega = [brackets[0].middle(); 8];
        omega.iter_mut().zip(brackets).for_each(|(omega, bracket)| *omega = bracket.middle());
        let mut settled = [false; 8];
        for _ in 0..MAX_ITERATIONS {
            // Newton's step for D of the root is Rayleigh's quotient of the null vector.
            let (d, slope) = root(&self.nodes, omega);
            for (lane, bracket) in brackets.iter().enumerate() {
                let next = omega[lane] - d[lane] / slope[lane];
                settled[lane] = bracket.contains(next) && is_settled(omega[lane], next);
                if bracket.contains(next) {
                    omega[lane] = next;
                }
            }
            if settled[..brackets.len()].iter().all(|&settled| settled) {
                break;
            }
        }
        // The vectors at the frequencies found.
        shapes(&self.nodes, omega, room);
        (omega, settled)
    }

    /// The vector of one bracket, for modes in which the root hardly moves.
    fn twisted(&self, bracket: &Bracket) -> Option<Vector> {
        let mut omega = bracket.middle();
        for _ in 0..MAX_ITERATIONS {
            let found = twisted(&self.nodes, omega, None);
            let square = |(node, x): (&Node<f64>, &f64)| node.mass * x * x;
            let inertia: f64 = self.nodes.iter().zip(&found.x).map(square).sum();
            let next = quotient(omega, found.residual, inertia);
            if !bracket.contains(next) {
                return None;
            }
            if is_settled(omega, next) {
                return Some(Vector { omega: next, x: twisted(&self.nodes, next, None).x });
            }
            omega = next;
        }
        None
    }

    /// The mode of bracket k from its vector, in binary64 or, if that is not enough, in double-double.
    fn certified(&self, k: usize, vector: Vector, tolerance: f64) -> Option<TreeMode> {
        let frame = self.frame(k);
        let found = enclosed(&self.nodes, &vector.x, self.tree, &frame);
        if found.relative() <= tolerance {
            let x = self.by_coordinate(&vector.x, |x| x * found.scale.hi, 0.0);
            return Some(TreeMode { lambda: found.lambda, radius: found.radius, x: Displacements::Plain(x) });
        }
        let nodes = self.forest.nodes_in::<Dd>();
        let mut omega = Dd::from(vector.omega);
        let mut at = None;
        for _ in 0..2 {
            let next = twisted(&nodes, omega, at);
            let square = |(node, x): (&Node<Dd>, &Dd)| node.mass * x.square();
            let inertia = nodes.iter().zip(&next.x).map(square).fold(Dd::ZERO, |sum, x| sum + x);
            omega = (omega * (omega - next.residual / inertia)).sqrt();
            at = Some(next.at);
        }
        let x = twisted(&nodes, omega, at).x;
        let found = enclosed(&nodes, &x, self.tree, &frame);
        let x = self.by_coordinate(&x, |x| Triple::from(x * found.scale), Triple::ZERO);
        let x = Displacements::Precise(x);
        found.radius.is_finite().then_some(TreeMode { lambda: found.lambda, radius: found.radius, x })
    }

    fn by_coordinate<T: Real, U: Copy>(&self, x: &[T], scaled: impl Fn(T) -> U, zero: U) -> Vec<U> {
        let mut result = vec![zero; x.len()];
        for (&coordinate, &x) in self.forest.coordinates.iter().zip(x) {
            result[coordinate as usize] = scaled(x);
        }
        result
    }

    /// What Kato and Temple's bounds need to know of the other eigenvalues.
    fn frame(&self, k: usize) -> Frame {
        let square = |omega: f64| omega * omega;
        let above = |b: &Bracket| square(b.low * (1.0 - self.eta)) * (1.0 - 4.0 * f64::EPSILON);
        let below = |b: &Bracket| square(b.high * (1.0 + self.eta)) * (1.0 + 4.0 * f64::EPSILON);
        let first = square(self.below_all() * (1.0 - self.eta)) * (1.0 - 4.0 * f64::EPSILON);
        let previous = if k > 0 { Some(below(&self.brackets[k - 1])) } else { self.forest.floats.then_some(0.0) };
        let holding = if self.forest.floats { first } else { 0.0 };
        let least = if self.forest.floats { holding } else { first };
        Frame { previous, next: self.brackets.get(k + 1).map(above), holding, least }
    }
}

/// What bounds need to know of a tree.
#[derive(Clone, Copy)]
struct Tree {
    plain: bool,
    uncertainty: f64,
    breadth: f64,
    /// omega's relative change is at most this times the relative change of each number of the matrix: each spring has an
    /// entry on either side of it, changes along the way from the root multiply up, and do so for bodies and for springs.
    factor_change: f64,
}

impl Tree {
    fn of(forest: &Forest) -> Tree {
        let (depth, breadth) = forest.depth_and_breadth();
        let factor_change = 4.0 * (depth as f64 + 1.0) * 1.01;
        Tree { plain: forest.plain, uncertainty: forest.uncertainty, breadth: breadth as f64, factor_change }
    }
}

/// Points between low and high that halve the interval so many times: by their ratio where they are far apart.
fn split(low: f64, high: f64, levels: u32, places: &mut Vec<f64>) {
    if levels == 0 {
        return;
    }
    let middle = if high > 2.0 * low { low.sqrt() * high.sqrt() } else { 0.5 * (low + high) };
    split(low, middle, levels - 1, places);
    places.push(middle);
    split(middle, high, levels - 1, places);
}

/// The quotient of a vector that is nearly right is right to the square of that.
fn is_settled(omega: f64, next: f64) -> bool {
    (next - omega).abs() <= 1e-9 * omega
}

impl Bracket {
    fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }

    fn contains(&self, omega: f64) -> bool {
        (self.low..=self.high).contains(&omega)
    }
}

/// The root of the Rayleigh quotient of a vector that is 1 where its residual is: x^T (omega^2 M - K) x = omega r, so
/// x^T K x / x^T M x = omega^2 - omega r / x^T M x, without the rounding errors of stretches.
fn quotient(omega: f64, residual: f64, inertia: f64) -> f64 {
    (omega * (omega - residual / inertia)).sqrt()
}

/// Bounds of the eigenvalues next to one, without tau; tau; and a bound below of the least eigenvalue, with tau.
struct Frame {
    previous: Option<f64>,
    next: Option<f64>,
    holding: f64,
    least: f64,
}

/// An eigenvalue with its radius, and 1 / sqrt(x^T M x).
struct Enclosed {
    lambda: Triple,
    radius: f64,
    scale: Dd,
}

impl Enclosed {
    fn relative(&self) -> f64 {
        let relative = self.radius / self.lambda.hi().abs();
        if relative.is_nan() { f64::INFINITY } else { relative }
    }
}

/// Covers the few roundings of a radius computed in binary64, sums in pairs.
const UP: f64 = 1.0 + 1e-12;

/// The eigenvalue near the Rayleigh quotient of x; see the module.
fn enclosed<T: Real>(nodes: &[Node<T>], x: &[T], tree: Tree, frame: &Frame) -> Enclosed {
    let holding = T::of(Dd::from(frame.holding));
    let energies = Energies::of(nodes, x, holding, tree.plain);
    let (strain, inertia) = (energies.strain.total(), energies.inertia.total());
    let shifted = strain / inertia;
    let slip = energies.slip / strain.hi();
    let rounding = energies.strain.relative_error() + energies.inertia.relative_error() + 12.0 * T::ERROR + slip;
    // e^2 / mu^2, all in the norm of K; the least distance of 1 / mu to its neighbours' on either side.
    let residual = residual(nodes, x, inertia / strain, holding, tree);
    let error = residual.elastic + residual.unbalanced / frame.least.sqrt();
    let square = (error * shifted.hi()).powi(2) / strain.hi() * UP;
    let value = shifted.hi() * (1.0 - 2.0 * rounding);
    let top = shifted.hi() * (1.0 + 2.0 * rounding);
    let below = frame.next.map_or(0.0, |next| square / (1.0 - top / (next + frame.holding)));
    let above = frame.previous.map_or(0.0, |previous| square / (value / (previous + frame.holding) - 1.0));
    let temple = if below >= 0.0 && above >= 0.0 { below.max(above) } else { f64::INFINITY };
    let data = 2.0 * (tree.uncertainty + 4.0 * T::ERROR) * if tree.plain { 1.0 } else { tree.factor_change };
    let lambda = shifted - holding;
    let relative = if temple < 0.5 { temple / (1.0 - temple) + 2.0 * rounding } else { f64::INFINITY };
    let radius = (shifted.hi() * (relative + T::ERROR) + lambda.hi().abs() * data) * UP;
    Enclosed { lambda: Triple::from(lambda.to_dd()), radius, scale: inertia.to_dd().sqrt().recip() }
}

/// x^T K x and x^T M x, and a bound of what the errors of the stretches change in the former.
struct Energies<T> {
    strain: PairwiseSum<T>,
    inertia: PairwiseSum<T>,
    slip: f64,
}

impl<T: Real> Energies<T> {
    fn of(nodes: &[Node<T>], x: &[T], holding: T, plain: bool) -> Energies<T> {
        let mut energies = Energies { strain: PairwiseSum::new(), inertia: PairwiseSum::new(), slip: 0.0 };
        let mut slip = PairwiseSum::new();
        for (i, node) in nodes.iter().enumerate() {
            let inertia = node.mass * (x[i] * x[i]);
            energies.inertia.add(inertia);
            energies.strain.add(holding * inertia + node.ground * (x[i] * x[i]));
            if !node.is_root() {
                let (b, error) = stretch(node, x[i], x[node.parent as usize], plain);
                energies.strain.add(b * b / node.flexibility);
                slip.add((2.0 * b.hi().abs() * UP + error) * error / node.flexibility.hi());
            }
        }
        energies.slip = slip.total() * UP;
        energies
    }
}

/// a x + b y and a bound of its error.
#[inline]
fn stretch<T: Real>(node: &Node<T>, x: T, y: T, plain: bool) -> (T, f64) {
    let (p, q) = (node.own * x, node.parents * y);
    let sum = p + q;
    let products = if plain { 0.0 } else { p.hi().abs() + q.hi().abs() };
    (sum, T::ERROR * UP * (sum.hi().abs() + products))
}

/// Bounds of |K^-1 (M x - r) - mu x|_K and of |r|_(M^-1).
struct Residual {
    elastic: f64,
    unbalanced: f64,
}

/// The forces that balance M x - mu V x from the leaves to the root, and what rounding leaves unbalanced.
fn residual<T: Real>(nodes: &[Node<T>], x: &[T], mu: T, holding: T, tree: Tree) -> Residual {
    let mut stack: Vec<(T, f64)> = Vec::new();
    let (mut unbalanced, mut complementary) = (PairwiseSum::new(), PairwiseSum::new());
    // A balance has a product and a sum a child, and five roundings of its own.
    let rounding = (tree.breadth + 8.0) * T::ERROR;
    for (i, node) in nodes.iter().enumerate() {
        let (load, size) = taken(&mut stack, node.children, (T::ZERO, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
        let inertia = node.mass * x[i];
        let ground = mu * ((node.ground + holding * node.mass) * x[i]);
        let rest = inertia - ground - load;
        let magnitude = size + inertia.hi().abs() + ground.hi().abs();
        if node.is_root() {
            let left = rest.hi().abs() + rounding * magnitude;
            unbalanced.add(left * left / node.mass.hi());
            continue;
        }
        let force = rest / node.own;
        let (b, error) = stretch(node, x[i], x[node.parent as usize], tree.plain);
        let elastic = mu * b / node.flexibility;
        // What the roundings of this balance leave, and of the elastic force's own.
        let left = rounding * magnitude;
        unbalanced.add(left * left / node.mass.hi());
        let slip = mu.hi() * error / node.flexibility.hi() + 4.0 * T::ERROR * (force.hi().abs() + elastic.hi().abs());
        let difference = (force - elastic).hi().abs() + slip;
        complementary.add(node.flexibility.hi() * difference * difference);
        let carried = node.parents * force;
        stack.push((carried, carried.hi().abs()));
    }
    let root = |sum: PairwiseSum<f64>| (sum.total() * UP).sqrt() * UP;
    Residual { elastic: root(complementary), unbalanced: root(unbalanced) }
}

/// Quadratic convergence from a narrow bracket takes two or three steps.
const MAX_ITERATIONS: usize = 6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes::eigen::{Eigenvalue, eigenpairs};
    use crate::analysis::modes::terms::Terms;
    use crate::analysis::test_systems::{blank, push};
    use crate::system::{Form, LinearSystem};

    /// A tree of n bodies: body i hangs on body (i x 7 + 3) mod i, with numbers spread over so many decades.
    fn tree(n: usize, decades: i32, grounded: bool) -> LinearSystem {
        let mut system = blank(n);
        let number = |i: usize, salt: usize| {
            let e = (i * 5 + salt) as i32 % (decades + 1) - decades / 2;
            format!("{}e{e}", 1000 + (i * 7919 + salt * 104_729) % 9000)
        };
        for i in 0..n {
            push(&mut system.m, &number(i, 1), i, None);
            if i > 0 {
                push(&mut system.k, &number(i, 2), (i * 7 + 3) % i, Some(i));
            }
        }
        if grounded {
            push(&mut system.k, &number(n, 3), 0, None);
            push(&mut system.k, &number(n, 4), n / 2, None);
        }
        system
    }

    fn forest(system: &LinearSystem) -> Forest {
        Forest::of(&Terms::of(&system.m), &Terms::of(&system.k), system.n()).expect("a tree")
    }

    /// The lowest modes agree with those of the dense method within both bounds, and the bounds are as asked.
    fn check(system: &LinearSystem, tolerance: f64) {
        let forest = forest(system);
        let found = lowest(&forest, 6, tolerance).expect("modes apart");
        let known = eigenpairs(&system.k, &system.m, system.n(), 1e-12).expect("a regular system");
        let known = known.iter().filter_map(|pair| match pair.value {
            Eigenvalue::Near { value, radius, .. } => Some((value, radius)),
            Eigenvalue::Zero => None,
        });
        for (mode, (value, radius)) in found.iter().zip(known) {
            let error = (mode.lambda - value).hi().abs();
            assert!(error <= mode.radius + radius, "{error:e} {:e} {radius:e}", mode.radius);
            assert!(mode.radius <= tolerance * value.hi(), "{:e}", mode.radius / value.hi());
        }
    }

    #[test]
    fn trees_agree_with_dense_matrices() {
        for decades in [0, 6, 20] {
            check(&tree(14, decades, true), 1e-12);
            check(&tree(14, decades, true), 1e-28);
            check(&tree(13, decades, false), 1e-12);
            check(&tree(13, decades, false), 1e-28);
        }
    }

    #[test]
    fn gears_are_trees_too() {
        let mut system = tree(9, 4, true);
        let mut form = Form::new();
        for term in system.k.terms() {
            let source = form.source(system.k.source_name(term.source));
            let row = system.k.row(term).iter().enumerate();
            let row = row.map(|(i, (c, a))| (*c, a * &crate::base::Number::from(["1", "2.3"][i])));
            form.push(source, term.nature, term.weight.clone(), row.collect::<Vec<_>>());
        }
        system.k = form;
        check(&system, 1e-12);
        check(&system, 1e-27);
    }

    #[test]
    fn the_rigid_motion_stretches_nothing() {
        let system = tree(9, 3, false);
        let x = rigid_motion(&forest(&system));
        assert!(x.iter().all(|&entry| entry == x[0]));
    }
}
