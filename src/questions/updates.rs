//! Frequencies of many cases in which one parameter weighs a few squares w a a^T of M and K, in coordinates of the
//! modes of one of the cases: each square adds a single square to a diagonal matrix, whose eigenvalues are the roots of
//! an equation in one unknown. In: the system of that case, the squares, the changes of the parameter. Out: enclosures
//! of the lowest eigenvalues. See docs/method/studies.md#one-weight.

use crate::analysis::modes::request::DEFAULT_TOLERANCE;
use crate::analysis::projection::{ABOVE, off_diagonal_norm, project};
use crate::analysis::{self, ModeKind, Request, Which};
use crate::base::{Ball, Dd, OrderBy};
use crate::kernel::bounded::Bounded;
use crate::kernel::secular::{Factor, Secular};
use crate::system::{Form, LinearSystem};

/// The unit roundoff.
const U: f64 = f64::EPSILON / 2.0;
/// The relative error that a change of the parameter may have.
pub const ROUNDING_OF_CHANGE: f64 = 4.0 * U;
/// Eigenvalues that differ by less than this share of the largest one count as equal, and a mode with less than this
/// share of a row is not affected by it.
const NEGLIGIBLE: f64 = 1e-24;
/// Limit on the coordinates, because the modes are computed in double-double.
pub const MOST: usize = 200;

/// The matrix that a square belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Stiffness,
    Damping,
    Mass,
}

impl Part {
    pub fn form(self, of: &LinearSystem) -> &Form {
        match self {
            Part::Stiffness => &of.k,
            Part::Damping => &of.c,
            Part::Mass => &of.m,
        }
    }
}

/// A square whose weight is linear in the parameter.
#[derive(Clone, Debug)]
pub struct Changing {
    pub part: Part,
    /// Coordinates and entries.
    pub row: Vec<(usize, Ball)>,
    /// Rows that are equal, but for their signs, have one number.
    pub number: usize,
    /// The derivative of the weight.
    pub slope: Ball,
}

/// A square and the modes that it affects; no other square affects these.
#[derive(Clone, Debug)]
struct Update {
    part: Part,
    slope: f64,
    /// A bound of its relative error.
    error: f64,
    /// The sum of the squares of the row in modal coordinates.
    size: Ball,
    secular: Secular,
}

/// A system near one of its cases.
#[derive(Clone, Debug)]
pub struct Updates {
    list: Vec<Update>,
    /// The eigenvalues of unaffected modes, ascending.
    constant: Vec<Dd>,
    /// The number of eigenvalues that are exactly zero in all cases.
    rigid: usize,
    /// Bounds of the errors of all eigenvalues: an absolute one, and one relative to each eigenvalue.
    off: [f64; 2],
    /// The number of eigenvalues that are requested.
    pub count: usize,
}

impl Updates {
    /// In coordinates of the modes of `base`; `reach` is the change of the parameter with the largest magnitude, and
    /// all changes have its sign. `None` if several squares affect one mode, a change would lower an eigenvalue, or a
    /// number is not known accurately enough.
    pub fn of(base: &LinearSystem, changing: &[Changing], reach: f64, count: usize) -> Option<Updates> {
        let n = base.n();
        let raises = |of: &Changing| {
            let upward = of.slope * Ball::from(reach.signum());
            match of.part {
                Part::Stiffness => upward.is_positive(),
                Part::Mass => upward.is_negative(),
                Part::Damping => false,
            }
        };
        if changing.is_empty() || n > MOST || base.is_chained() || !changing.iter().all(raises) {
            return None;
        }
        let modal = Modal::of(base)?;
        let largest = modal.d.iter().fold(0.0f64, |most, d| most.max(d.hi.abs()));
        let mut d = modal.d.clone();
        // Squared distances of both matrices from the diagonal ones, in the Frobenius norm; then bounds of norms.
        let (mut of_k, mut within_k, mut within_m) = (0.0, modal.off[0], modal.off[1]);
        for x in d.iter_mut().filter(|x| x.hi.abs() <= NEGLIGIBLE * largest) {
            of_k += x.hi * x.hi;
            *x = Dd::ZERO;
        }
        let (mut is_felt, mut is_constant, mut list, mut least) = (vec![false; n], vec![true; n], Vec::new(), 1.0f64);
        let mut holds_rigid = false;
        for of in changing {
            let g: Vec<Ball> = (0..n)
                .map(|i| of.row.iter().fold(Ball::ZERO, |sum, (at, a)| sum + *a * Ball::exact(modal.vectors[i][*at])))
                .collect();
            let longest = g.iter().fold(0.0f64, |most, g| most.max(g.magnitude()));
            let counts = |g: &Ball| g.mid.hi.abs() > (NEGLIGIBLE * longest).max(4.0 * g.rad);
            let (mut left_out, mut size) = (0.0, Ball::ZERO);
            let (mut poles, mut squares): (Vec<Dd>, Vec<Ball>) = (Vec::new(), Vec::new());
            for (i, g) in g.iter().enumerate() {
                if !counts(g) {
                    left_out += g.magnitude() * g.magnitude();
                    continue;
                }
                if std::mem::replace(&mut is_felt[i], true) {
                    return None;
                }
                is_constant[i] = false;
                holds_rigid |= of.part == Part::Stiffness && d[i].is_zero();
                left_out += g.rad * g.rad;
                let square = Ball::exact(g.mid).square();
                size = size + square;
                match poles.last() {
                    Some(last) if (d[i] - *last).hi <= NEGLIGIBLE * largest => {
                        // A double eigenvalue: its modes are rotated so that one of them takes all of the row, and the
                        // other none.
                        let apart = (d[i] - *last).to_f64();
                        of_k += apart * apart;
                        d[i] = *last;
                        is_constant[i] = true;
                        let sum = squares.last_mut()?;
                        *sum = *sum + square;
                    }
                    _ => {
                        poles.push(d[i]);
                        squares.push(square);
                    }
                }
            }
            let most = of.slope.magnitude() * reach.abs() * ABOVE;
            let left_out = left_out.sqrt() * ABOVE;
            let of_square = most * left_out * (2.0 * size.magnitude().sqrt() + left_out) * ABOVE;
            match of.part {
                Part::Stiffness => within_k += of_square,
                Part::Damping => return None,
                Part::Mass => {
                    within_m += of_square;
                    least = least.min((1.0 - most * size.magnitude()) * (1.0 - 1e-12));
                    // The squares in this equation are those of the row times the poles, so a pole at zero stays where
                    // it is.
                    let felt: Vec<(Dd, Ball)> =
                        poles.iter().zip(&squares).map(|(d, g)| (*d, *g * Ball::exact(*d))).collect();
                    let moving = felt.iter().filter(|(d, _)| !d.is_zero());
                    (poles, squares) = moving.copied().unzip();
                    is_constant.iter_mut().zip(&d).for_each(|(constant, d)| *constant |= d.is_zero());
                }
            }
            // Each is within the radius and one rounding of the true root, and the errors of the products left out are
            // far smaller.
            let numbers = squares.iter().map(|square| square.to_f64()).collect();
            let is_known = squares.iter().all(|square| square.relative_error() < U);
            if poles.is_empty() {
                continue;
            }
            list.push(Update {
                part: of.part,
                slope: of.slope.to_f64(),
                error: if of.slope.is_zero() { 0.0 } else { of.slope.relative_error() + 2.0 * U },
                size,
                secular: Secular::new(poles, numbers).filter(|_| is_known)?,
            });
        }
        within_k += of_k.sqrt() * ABOVE;
        let room = (least - within_m) * (1.0 - 1e-12);
        if room.is_nan() || room < 1e-6 || within_m > 0.01 * room {
            return None;
        }
        let constant = (0..n).filter(|&i| is_constant[i]).map(|i| d[i]).collect();
        let off = [within_k / room * ABOVE, within_m / room * ABOVE];
        off.iter().all(|x| x.is_finite()).then_some(())?;
        // A row with no weight at the base is none of its rows, and may hold what is rigid there.
        let rigid = if holds_rigid { 0 } else { rigid(base, &modal) };
        Some(Updates { list, constant, rigid, off, count: count.min(n) })
    }

    /// The lowest eigenvalues for each change of the parameter, ascending, with their error bounds; NaN where they are not known. A change
    /// may have an error of [`ROUNDING_OF_CHANGE`].
    pub fn lowest(&self, changes: &[f64]) -> Bounded {
        let of_update = |update: &Update| {
            let factors: Vec<Factor> = changes.iter().map(|change| update.factor(*change)).collect();
            update.secular.lowest(self.count, &factors)
        };
        let mut of_lists: Vec<Bounded> = self.list.iter().map(of_update).collect();
        let mut found = match of_lists.pop() {
            Some(alone) if self.constant.is_empty() && of_lists.is_empty() => alone,
            last => {
                of_lists.extend(last);
                self.in_order(&of_lists, changes.len())
            }
        };
        for i in 0..found.count() {
            let (numbers, bounds) = found.whole_lanes(i);
            if i < self.rigid {
                numbers.fill(0.0);
                bounds.fill(0.0);
                continue;
            }
            for (x, bound) in numbers.iter().zip(bounds) {
                *bound = (*bound + self.off[0] + self.off[1] * (x.abs() + *bound)) * (1.0 + 16.0 * U);
            }
        }
        found
    }

    /// The lowest of several lists and of what is constant: the i-th eigenvalue lies between the i-th smallest lower end and the i-th
    /// smallest upper end.
    fn in_order(&self, lists: &[Bounded], cases: usize) -> Bounded {
        let mut found = Bounded::unknown(self.count, cases);
        let (mut lows, mut highs) = (Vec::new(), Vec::new());
        for case in 0..cases {
            lows.clear();
            highs.clear();
            for list in lists {
                for [x, bound] in (0..list.count()).map(|i| list.pair(i, case)) {
                    lows.push(x - bound);
                    highs.push(x + bound);
                }
            }
            lows.extend(self.constant.iter().map(|d| d.hi));
            highs.extend(self.constant.iter().map(|d| d.hi));
            // A root that is not known may lie anywhere, which leaves the order of all others unknown.
            if lows.iter().any(|low| low.is_nan()) {
                continue;
            }
            lows.sort_by(f64::total_cmp);
            highs.sort_by(f64::total_cmp);
            for (i, (low, high)) in lows.iter().zip(&highs).take(self.count).enumerate() {
                let middle = 0.5 * (low + high);
                found.set(i, case, [middle, 0.5 * (high - low) + 4.0 * U * (low.abs() + high.abs())]);
            }
        }
        found
    }
}

impl Update {
    /// The factor of the square in the equation of eigenvalues. See docs/method/studies.md#one-weight.
    #[inline]
    fn factor(&self, change: f64) -> Factor {
        let weight = change * self.slope;
        let error = self.error + ROUNDING_OF_CHANGE + 2.0 * U;
        let (rho, error) = match self.part {
            Part::Stiffness => (weight, error),
            Part::Mass => of_mass(-weight, error, self.size),
            Part::Damping => (f64::NAN, error),
        };
        Factor::new(rho, error)
    }
}

/// c / (1 - c g) for a mass that falls by c along a row, with g = a^T M^-1 a of the row a, and a bound of its relative error; `error` is
/// that of c.
pub(super) fn of_mass(c: f64, error: f64, g: Ball) -> (f64, f64) {
    let part = c * g.to_f64();
    let left = 1.0 - part;
    let of_g = if g.is_zero() { 0.0 } else { g.relative_error() + 2.0 * U };
    let off = part.abs() * (error + of_g + 4.0 * U) + 2.0 * U;
    (c / left, (error + 2.0 * off / left + 2.0 * U) * ABOVE)
}

/// The number of eigenvalues that are exactly zero for every change: if no weight of K is negative, the null space of K
/// is that of all its rows.
fn rigid(base: &LinearSystem, modal: &Modal) -> usize {
    let is_semidefinite = base.k.terms().all(|term| term.weight.is_positive());
    if is_semidefinite { modal.rigid } else { 0 }
}

/// The modes of a system as coordinates: V^T M V is nearly the unit matrix, V^T K V nearly diagonal.
struct Modal {
    /// By mode.
    vectors: Vec<Vec<Dd>>,
    /// The diagonal of V^T K V, ascending.
    d: Vec<Dd>,
    /// Bounds of the norms of V^T K V less its diagonal, and of V^T M V less the unit matrix.
    off: [f64; 2],
    /// The number of modes that are exactly rigid.
    rigid: usize,
}

/// Entries beside a diagonal below this share of the largest one are small enough.
const BESIDE: f64 = 1e-20;
/// Steps that reduce the entries beside a diagonal: each of them squares these.
const MOST_STEPS: usize = 2;

impl Modal {
    fn of(base: &LinearSystem) -> Option<Modal> {
        let n = base.n();
        let request = Request { which: Which::All, tolerance: DEFAULT_TOLERANCE, ..Request::default() };
        let modes = analysis::modes_as(base, &request).ok()?;
        if modes.list.len() != n || !modes.is_complete() || modes.infinite > 0 {
            return None;
        }
        let rigid = modes.list.iter().filter(|mode| mode.kind == ModeKind::Rigid).count();
        let vectors = modes.list.into_iter().map(|mode| match mode.precise {
            Some(precise) => precise,
            None => mode.shape.into_iter().map(Dd::from).collect(),
        });
        let mut vectors: Vec<Vec<Dd>> = vectors.collect();
        for step in 0..=MOST_STEPS {
            let [k, m] = [&base.k, &base.m].map(|form| project(form, &vectors));
            let d: Vec<Dd> = (0..n).map(|i| k[i * n + i].mid).collect();
            let off = [off_diagonal_norm(&k, &d), off_diagonal_norm(&m, &vec![Dd::from(1.0); n])];
            let largest = d.iter().fold(0.0f64, |most, d| most.max(d.hi.abs()));
            if off[0] <= BESIDE * largest && off[1] <= BESIDE {
                let mut order: Vec<usize> = (0..n).collect();
                order.order_by(|&i, &j| (d[i] - d[j]).hi.total_cmp(&0.0));
                let sorted = order.iter().map(|&i| std::mem::take(&mut vectors[i])).collect();
                return Some(Modal { vectors: sorted, d: order.iter().map(|&i| d[i]).collect(), off, rigid });
            }
            if step < MOST_STEPS {
                refine(&mut vectors, &k, &m);
            }
        }
        None
    }
}

/// Vectors that are orthogonal to first order (Ogita and Aishima, Japan J. Indust. Appl. Math. 35, 2018, 1007-1035).
fn refine(vectors: &mut [Vec<Dd>], k: &[Ball], m: &[Ball]) {
    let n = vectors.len();
    let at = |matrix: &[Ball], i: usize, j: usize| matrix[i * n + j].to_f64();
    let ratio = |i: usize| k[i * n + i].to_f64() / m[i * n + i].to_f64();
    let part = |i: usize, j: usize| {
        if i == j {
            return (Ball::ONE - m[i * n + i]).to_f64() / 2.0;
        }
        let turned = (at(k, i, j) - ratio(j) * at(m, i, j)) / (ratio(j) - ratio(i));
        if turned.abs() < 1e-3 { turned } else { -at(m, i, j) / 2.0 }
    };
    let old = vectors.to_vec();
    for (j, vector) in vectors.iter_mut().enumerate() {
        for (i, other) in old.iter().enumerate() {
            let part = Dd::from(part(i, j));
            vector.iter_mut().zip(other).for_each(|(x, y)| *x += *y * part);
        }
    }
}
