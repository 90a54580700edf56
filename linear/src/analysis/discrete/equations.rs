//! The right-hand side of M q'' + C q' + K q = forces, for use with an external integrator: stretches that springs and
//! dampers share, tensions, forces, accelerations. In: a linear system. Out: sparse rows of numbers that a back end
//! only prints, or the coordinate without mass that makes this impossible. See docs/method/emit.md.

use crate::analysis::discrete::Port;
use crate::analysis::discrete::precision::Precision;
use crate::base::{Dd, Number};
use crate::system::{CoordinateId, Form, LinearSystem};
use std::collections::BTreeMap;
use std::fmt;

/// The equations of motion, term by term.
#[derive(Clone, Debug)]
pub struct Equations {
    pub coordinates: Vec<Port>,
    pub inputs: Vec<Port>,
    pub outputs: Vec<Port>,
    pub precision: Precision,
    /// Stretches; springs and dampers along the same row share one.
    pub stretches: Vec<Stretch>,
    /// Stiffness and damping of each coordinate to the ground.
    pub own: Vec<(f64, f64)>,
    /// Factors of u, u' and u'' in each coordinate's force.
    pub forces: Vec<[Vec<(usize, f64)>; 3]>,
    /// M = L D L^T: rows of L left of the diagonal, and 1 / D.
    pub lower: Vec<Vec<(usize, f64)>>,
    pub inverse: Vec<f64>,
    /// Each output over displacements, velocities and accelerations, and over u, u' and u''.
    pub seen: Vec<[Vec<(usize, f64)>; 3]>,
    pub direct: Vec<[Vec<(usize, f64)>; 3]>,
    /// Displacements and velocities at t = 0.
    pub start: Vec<(f64, f64)>,
}

/// stretch = row q; tension = k stretch + c (row q'); force = -row^T tension.
#[derive(Clone, Debug)]
pub struct Stretch {
    pub row: Vec<(usize, f64)>,
    pub k: f64,
    pub c: f64,
}

/// Why there are no equations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoEquations {
    /// A coordinate without mass.
    Massless { coordinate: String },
    /// Inertia couples too many coordinates: L has too many numbers for emitted code.
    TooMany,
    /// A number outside the range of the precision.
    OutOfRange { precision: &'static str },
}

impl fmt::Display for NoEquations {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NoEquations::Massless { coordinate } => write!(
                f,
                "`{coordinate}` has no mass of its own, so its equation is not of second order: use `--style steps`"
            ),
            NoEquations::TooMany => write!(
                f,
                "so many masses are coupled that the accelerations alone would need more than {MOST_NUMBERS} numbers"
            ),
            NoEquations::OutOfRange { precision } => {
                write!(f, "a number of the equations leaves the range of {precision} precision; check the units")
            }
        }
    }
}

/// Limit on the entries of L that are written out.
const MOST_NUMBERS: usize = 1_000_000;

type Row = Vec<(CoordinateId, Number)>;

/// The equations of a system.
pub fn equations(system: &LinearSystem, precision: Precision) -> Result<Equations, NoEquations> {
    let round = |x: &Number| precision.round(x.to_ball().mid);
    let (own, stretches) = stretches(system, precision);
    let (lower, inverse) = factors(system, precision)?;
    let rows = |all: &[Row; 3]| [0, 1, 2].map(|p: usize| all[p].iter().map(|(i, x)| (i.index(), round(x))).collect());
    let mut forces: Vec<[Vec<(usize, f64)>; 3]> = vec![Default::default(); system.n()];
    for (j, input) in system.inputs.iter().enumerate() {
        for (p, column) in input.b.iter().enumerate() {
            column.iter().for_each(|(i, b)| forces[i.index()][p].push((j, round(b))));
        }
    }
    let direct = |d: &[Vec<(u32, Number)>; 3]| {
        [0, 1, 2].map(|p: usize| d[p].iter().map(|(j, x)| (*j as usize, round(x))).collect())
    };
    let mut start = vec![(0.0, 0.0); system.n()];
    for (i, q, v) in &system.initial {
        start[i.index()] = (round(q), round(v));
    }
    let port = |name, unit: &str| Port { name: system.display(name), unit: unit.to_string() };
    let equations = Equations {
        coordinates: super::coordinates(system),
        inputs: system.inputs.iter().map(|input| port(input.name, input.unit)).collect(),
        outputs: system.outputs.iter().map(|output| port(output.name, &output.unit)).collect(),
        precision,
        stretches,
        own,
        forces,
        lower,
        inverse,
        seen: system.outputs.iter().map(|output| rows(&output.p)).collect(),
        direct: system.outputs.iter().map(|output| direct(&output.d)).collect(),
        start,
    };
    if equations.fits() { Ok(equations) } else { Err(NoEquations::OutOfRange { precision: precision.name() }) }
}

impl Equations {
    /// Whether all numbers are finite, and no factor was lost by underflow.
    fn fits(&self) -> bool {
        let of = |row: &Vec<(usize, f64)>| row.iter().map(|(_, value)| *value).collect::<Vec<f64>>();
        let rows = self.forces.iter().chain(&self.seen).chain(&self.direct).flatten().chain(&self.lower);
        let stretches =
            self.stretches.iter().flat_map(|stretch| of(&stretch.row).into_iter().chain([stretch.k, stretch.c]));
        let pairs = self.own.iter().chain(&self.start).flat_map(|&(a, b)| [a, b]);
        let kept = |x: f64| x == 0.0 || x.abs() >= self.precision.least();
        rows.flat_map(of).chain(stretches).chain(pairs).chain(self.inverse.iter().copied()).all(|x| x.is_finite())
            && self.inverse.iter().all(|&x| x != 0.0 && kept(x))
            && self.stretches.iter().all(|stretch| kept(stretch.k) && kept(stretch.c))
            && self.own.iter().all(|&(k, c)| kept(k) && kept(c))
    }
}

/// Terms of K and C by their rows; those on a single coordinate are summed.
fn stretches(system: &LinearSystem, precision: Precision) -> (Vec<(f64, f64)>, Vec<Stretch>) {
    let mut own = vec![[Dd::ZERO; 2]; system.n()];
    let mut shared: Vec<(Row, [Dd; 2])> = Vec::new();
    // There are few different rows for any pair of coordinates.
    let mut places: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    let mut add = |form: &Form, which: usize| {
        for term in form.terms() {
            let (row, weight) = (form.row(term), term.weight.to_ball().mid);
            if let (Some((i, a)), 1) = (row.first(), row.len()) {
                own[i.index()][which] += weight * a.to_ball().mid.square();
                continue;
            }
            let alike = places.entry(row.iter().map(|(i, _)| i.index()).collect()).or_default();
            let known = alike.iter().copied().find(|&at| row == shared[at].0);
            let at = known.unwrap_or_else(|| {
                alike.push(shared.len());
                shared.push((row.to_vec(), [Dd::ZERO; 2]));
                shared.len() - 1
            });
            shared[at].1[which] += weight;
        }
    };
    add(&system.k, 0);
    add(&system.c, 1);
    let round = |x: Dd| precision.round(x);
    let stretch = |(row, [k, c]): (Row, [Dd; 2])| Stretch {
        row: row.iter().map(|(i, a)| (i.index(), round(a.to_ball().mid))).collect(),
        k: round(k),
        c: round(c),
    };
    (own.iter().map(|&[k, c]| (round(k), round(c))).collect(), shared.into_iter().map(stretch).collect())
}

type Factors = (Vec<Vec<(usize, f64)>>, Vec<f64>);

/// M = L D L^T without the zeros of L, row by row: each row solves L z = m with the columns computed so far.
fn factors(system: &LinearSystem, precision: Precision) -> Result<Factors, NoEquations> {
    let n = system.n();
    let m = sparse(&system.m, n);
    let mut columns: Vec<Vec<(usize, Dd)>> = vec![Vec::new(); n];
    let mut rows: Vec<Vec<(usize, Dd)>> = vec![Vec::new(); n];
    let mut d = vec![Dd::ZERO; n];
    let size: Vec<f64> = (0..n).map(|i| m[i].get(&i).map_or(0.0, |x| x.hi)).collect();
    let mut numbers = 0;
    for i in 0..n {
        let mut rest = m[i].clone();
        let mut diagonal = rest.remove(&i).unwrap_or(Dd::ZERO);
        while let Some((j, z)) = rest.pop_first() {
            if z.hi.abs() <= 1e-28 * (size[i] * size[j]).sqrt() {
                continue;
            }
            let l = z / d[j];
            for &(k, other) in &columns[j] {
                *rest.entry(k).or_insert(Dd::ZERO) -= other * z;
            }
            diagonal -= l * z;
            rows[i].push((j, l));
        }
        if diagonal.hi.is_nan() || diagonal.hi <= 1e-20 * size[i] {
            return Err(NoEquations::Massless { coordinate: system.display(system.coordinates[i].name) });
        }
        d[i] = diagonal;
        numbers += rows[i].len();
        if numbers > MOST_NUMBERS {
            return Err(NoEquations::TooMany);
        }
        rows[i].iter().for_each(|&(j, l)| columns[j].push((i, l)));
    }
    let rounded = |row: Vec<(usize, Dd)>| row.into_iter().map(|(j, l)| (j, precision.round(l))).collect();
    Ok((rows.into_iter().map(rounded).collect(), d.iter().map(|&d| precision.round(Dd::ONE / d)).collect()))
}

/// The rows of a matrix, up to the diagonal.
fn sparse(form: &Form, n: usize) -> Vec<BTreeMap<usize, Dd>> {
    let mut rows: Vec<BTreeMap<usize, Dd>> = vec![BTreeMap::new(); n];
    for term in form.terms() {
        let (row, weight) = (form.row(term), term.weight.to_ball().mid);
        for (i, a) in row {
            let scaled = weight * a.to_ball().mid;
            for (j, b) in row.iter().filter(|(j, _)| *j <= i) {
                *rows[i.index()].entry(j.index()).or_insert(Dd::ZERO) += scaled * b.to_ball().mid;
            }
        }
    }
    rows
}
