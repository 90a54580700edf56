//! The modes that a moving base excites: participation factors and effective masses of the undamped modes. In: a system
//! with its modes, and inputs that are motions of bases. Out: for each of them enclosures, mode by mode, and their
//! total. See docs/method/measures.md#effective-masses.

use crate::analysis::answer::{Mode, ModeKind, Modes};
use crate::analysis::modes::parts::independent_undamped;
use crate::base::{Ball, Number};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::solve;
use crate::system::{CoordinateId, LinearSystem};

/// The modes that the motion of a base excites while all other bases are held.
#[derive(Clone, Debug)]
pub struct Excitation {
    /// Index of the input.
    pub input: usize,
    /// The excitation of each mode.
    pub modes: Vec<Excited>,
    /// The sum of all effective masses: kg, or kg m^2 of a base that turns.
    pub total: Ball,
    /// The displacement of each coordinate that follows a unit displacement of the base statically.
    pub(in crate::analysis) carried: Vec<Ball>,
}

/// The part of a mode in the motion relative to the static response to the base.
#[derive(Clone, Copy, Debug)]
pub struct Excited {
    /// The participation factor of the mass-normalised shape; its square is the effective mass. `None` if the shape is
    /// not determined, as for one of several modes of equal frequency.
    pub participation: Option<Ball>,
    pub mass: Option<Ball>,
    /// The sum of the effective masses up to this mode.
    pub running: Option<Ball>,
}

/// Coordinates up to which the matrices are inverted in balls.
const MOST: usize = 128;

/// A system whose modes are prepared for the excitation by bases.
pub struct Excitations<'a> {
    system: &'a LinearSystem,
    modes: &'a Modes,
    m: Matrix<Ball>,
    k: Matrix<Ball>,
    /// For each mode its shape, x^T M x, and a bound of the components of other modes in it; `None` if nothing is
    /// known.
    shapes: Vec<Option<Shape>>,
}

struct Shape {
    x: Vec<Ball>,
    /// x^T M x
    square: Ball,
    /// A bound of the M-norm of the components of other modes in x.
    foreign: f64,
}

impl<'a> Excitations<'a> {
    /// The excitations of a system, or the reason why there are none.
    pub fn of(system: &'a LinearSystem, modes: &'a Modes) -> Result<Excitations<'a>, &'static str> {
        if system.is_chained() || system.n() > MOST {
            return Err("effective masses are computed for up to 128 coordinates");
        }
        if modes.infinite > 0 {
            return Err("a motion without inertia has no mode: give every body that moves a mass");
        }
        if !modes.is_complete() || modes.list.len() != system.n() {
            return Err("effective masses need all modes");
        }
        if modes.list.iter().any(|mode| mode.kind != ModeKind::Oscillation) {
            return Err("a base carries along only what springs hold: every mode has to oscillate");
        }
        let [m, k] = [&system.m, &system.k].map(|form| {
            let entries = form.assemble(system.n());
            Matrix::from_fn(system.n(), system.n(), |i, j| entries[i][j])
        });
        let shapes =
            shapes(&homes(system, modes), modes, &m, &k).ok_or("the mass matrix is too close to a singular one")?;
        Ok(Excitations { system, modes, m, k, shapes })
    }

    /// The modes that an input excites.
    pub fn by(&self, input: usize) -> Result<Excitation, &'static str> {
        let n = self.system.n();
        let [b0, _, b2] = self.system.inputs[input].b.each_ref().map(|column| {
            let mut dense = vec![Ball::ZERO; n];
            column.iter().for_each(|(i, value): &(CoordinateId, _)| dense[i.index()] = value.to_ball());
            dense
        });
        // The static response to a unit displacement of the base, and the inertia of that motion.
        let carried = solve(&self.k, &Matrix::from_fn(n, 1, |i, _| b0[i]))
            .ok_or("a base carries along only what springs hold: the stiffness matrix may be singular")?;
        let inertia: Vec<Ball> = (0..n).map(|i| dot(n, |j| self.m[(i, j)] * carried[(j, 0)]) - b2[i]).collect();
        let moved = solve(&self.m, &Matrix::from_fn(n, 1, |i, _| inertia[i]))
            .ok_or("the mass matrix is too close to a singular one")?;
        let total = dot(n, |i| inertia[i] * moved[(i, 0)]);
        let root = total.magnitude().sqrt().next_up();
        let factors: Vec<Option<(Ball, Ball)>> = (self.shapes.iter())
            .map(|shape| {
                let Shape { x, square, foreign } = shape.as_ref()?;
                let product = dot(n, |i| x[i] * inertia[i]).widen((foreign * root).next_up());
                let own = square.widen((foreign * foreign).next_up());
                own.is_positive().then(|| (product / own.sqrt(), product.square() / own))
            })
            .collect();
        let modes = (0..self.modes.list.len()).map(|i| Excited {
            participation: factors[i].map(|(participation, _)| participation),
            mass: factors[i].map(|(_, mass)| mass),
            running: running(&factors, i, total),
        });
        let carried = (0..n).map(|i| carried[(i, 0)]).collect();
        Ok(Excitation { input, modes: modes.collect(), total, carried })
    }
}

impl Excitations<'_> {
    /// The product of a row of displacements with each mass-normalised shape; `None` if the shape is not determined.
    pub(in crate::analysis) fn along(&self, row: &[(CoordinateId, Number)]) -> Vec<Option<Ball>> {
        let n = self.system.n();
        let mut dense = vec![Ball::ZERO; n];
        row.iter().for_each(|(i, value)| dense[i.index()] = dense[i.index()] + value.to_ball());
        let Some(moved) = solve(&self.m, &Matrix::from_fn(n, 1, |i, _| dense[i])) else {
            return vec![None; self.shapes.len()];
        };
        let root = dot(n, |i| dense[i] * moved[(i, 0)]).magnitude().sqrt().next_up();
        let along = |shape: &Option<Shape>| {
            let Shape { x, square, foreign } = shape.as_ref()?;
            let product = dot(n, |i| x[i] * dense[i]).widen((foreign * root).next_up());
            let own = square.widen((foreign * foreign).next_up());
            own.is_positive().then(|| product / own.sqrt())
        };
        self.shapes.iter().map(along).collect()
    }

    /// The angular frequency of a mode, rad/s.
    pub(in crate::analysis) fn omega(&self, mode: usize) -> Ball {
        self.modes.list[mode].omega
    }
}

/// The sum of the effective masses up to a mode: computed directly, or as the total minus the masses after it,
/// whichever is more accurate.
fn running(factors: &[Option<(Ball, Ball)>], last: usize, total: Ball) -> Option<Ball> {
    let sum =
        |some: &[Option<(Ball, Ball)>]| some.iter().try_fold(Ball::ZERO, |sum, factor| Some(sum + factor.as_ref()?.1));
    let (up_to, after) = (sum(&factors[..=last]), sum(&factors[last + 1..]).map(|after| total - after));
    match (up_to, after) {
        (Some(one), Some(other)) => Some(if one.rad <= other.rad { one } else { other }),
        (one, other) => one.or(other),
    }
}

fn dot(n: usize, product: impl Fn(usize) -> Ball) -> Ball {
    (0..n).fold(Ball::ZERO, |sum, i| sum + product(i))
}

/// The shapes as enclosures of only their own digits, each with a bound of the components of other modes in it: with r
/// = K x - s M x, and all other omega^2 at least g away from s, the M-norm of these components is at most |r| / g,
/// where
/// r|^2 = r^T M^-1 r. `None` if M may be singular.
///
/// A shape of one independent part has no components of modes of other parts. `homes`: the part of each mode, if it is
/// known.
fn shapes(homes: &[Option<u32>], modes: &Modes, m: &Matrix<Ball>, k: &Matrix<Ball>) -> Option<Vec<Option<Shape>>> {
    let (n, list) = (m.rows(), &modes.list);
    let xs: Vec<Vec<Ball>> = list.iter().map(displacements).collect();
    let times = |matrix: &Matrix<Ball>, x: &[Ball], i: usize| dot(n, |j| matrix[(i, j)] * x[j]);
    let residuals = Matrix::from_fn(n, list.len(), |i, mode| {
        let s = Ball::exact(list[mode].omega_squared.mid);
        times(k, &xs[mode], i) - s * times(m, &xs[mode], i)
    });
    let solved = solve(m, &residuals)?;
    let shape = |(mode, x): (usize, Vec<Ball>)| {
        let s = Ball::exact(list[mode].omega_squared.mid);
        let apart = |other: usize| homes[mode].is_some() && homes[other].is_some() && homes[mode] != homes[other];
        let others = list.iter().enumerate().filter(|(other, _)| *other != mode && !apart(*other));
        let gap = others.map(|(_, other)| (other.omega_squared - s).mignitude()).fold(f64::INFINITY, f64::min);
        let square = dot(n, |i| residuals[(i, mode)] * solved[(i, mode)]);
        let foreign = (square.magnitude().sqrt().next_up() / gap).next_up();
        let foreign = if gap == f64::INFINITY { 0.0 } else { foreign };
        let square = dot(n, |i| x[i] * times(m, &x, i));
        foreign.is_finite().then_some(Shape { x, square, foreign })
    };
    Some(xs.into_iter().enumerate().map(shape).collect())
}

/// The independent part that each mode moves; `None` for all, unless every part has as many modes as coordinates.
fn homes(system: &LinearSystem, modes: &Modes) -> Vec<Option<u32>> {
    let parts = independent_undamped(system);
    let mut part_of = vec![0_u32; system.n()];
    let mut missing: Vec<usize> = Vec::new();
    for (number, part) in (0..).zip(&parts) {
        part.coordinates.iter().for_each(|coordinate| part_of[*coordinate as usize] = number);
        missing.push(part.coordinates.len());
    }
    let mut homes = Vec::new();
    for mode in &modes.list {
        let mut moved = displacements(mode).into_iter().zip(&part_of).filter(|(x, _)| !x.is_zero());
        let home = moved.next().map(|(_, part)| *part);
        match home.filter(|home| moved.all(|(_, part)| part == home)) {
            Some(home) if missing[home as usize] > 0 => missing[home as usize] -= 1,
            _ => return vec![None; modes.list.len()],
        }
        homes.push(home);
    }
    homes
}

fn displacements(mode: &Mode) -> Vec<Ball> {
    match &mode.precise {
        Some(x) => x.iter().copied().map(Ball::exact).collect(),
        None => mode.shape.iter().copied().map(Ball::from).collect(),
    }
}
