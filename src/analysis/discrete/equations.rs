//! The plain right-hand side of M q'' + C q' + K q = forces, for somebody else's integrator: stretches that springs and dampers
//! share, tensions, forces, accelerations. In: a linear system. Out: sparse rows of numbers that a back end only prints, or
//! the coordinate without mass that stands in the way. Clause: spec.md, "Simulation code".

use crate::analysis::discrete::Port;
use crate::analysis::discrete::precision::Precision;
use crate::analysis::numeric::dense::Matrix;
use crate::base::{Dd, Number};
use crate::system::{CoordinateId, Form, LinearSystem};

/// The equations of motion, term by term.
#[derive(Clone, Debug)]
pub struct Equations {
    pub coordinates: Vec<Port>,
    pub inputs: Vec<Port>,
    pub outputs: Vec<Port>,
    pub precision: Precision,
    /// What stretches: springs and dampers along the same row are one.
    pub stretches: Vec<Stretch>,
    /// Stiffness and damping of each coordinate against the ground.
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

/// A coordinate that has no mass of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Massless {
    pub coordinate: String,
}

type Row = Vec<(CoordinateId, Number)>;

/// The equations of a system.
pub fn equations(system: &LinearSystem, precision: Precision) -> Result<Equations, Massless> {
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
    Ok(Equations {
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
    })
}

/// Terms of K and C by their rows; those of one coordinate alone are summed.
fn stretches(system: &LinearSystem, precision: Precision) -> (Vec<(f64, f64)>, Vec<Stretch>) {
    let mut own = vec![[Dd::ZERO; 2]; system.n()];
    let mut shared: Vec<(Row, [Dd; 2])> = Vec::new();
    let mut add = |form: &Form, which: usize| {
        for term in form.terms() {
            let (row, weight) = (form.row(term), term.weight.to_ball().mid);
            match row {
                [(i, a)] => own[i.index()][which] += weight * a.to_ball().mid.square(),
                _ => match shared.iter_mut().find(|(known, _)| known == row) {
                    Some((_, weights)) => weights[which] += weight,
                    None => {
                        let mut weights = [Dd::ZERO; 2];
                        weights[which] = weight;
                        shared.push((row.to_vec(), weights));
                    }
                },
            }
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

/// M = L D L^T, without the zeros of L.
fn factors(system: &LinearSystem, precision: Precision) -> Result<Factors, Massless> {
    let n = system.n();
    let m = system.m.assemble(n);
    let mut l = Matrix::zeros(n, n);
    let mut d = vec![Dd::ZERO; n];
    for i in 0..n {
        for j in 0..=i {
            let known = (0..j).fold(m[i][j].mid, |rest, k| rest - l[(i, k)] * d[k] * l[(j, k)]);
            if i == j {
                if known.hi <= 1e-20 * m[i][i].mid.hi {
                    let coordinate = system.display(system.coordinates[i].name);
                    return Err(Massless { coordinate });
                }
                d[i] = known;
            } else if known.hi.abs() > 1e-28 * (m[i][i].mid.hi * m[j][j].mid.hi).sqrt() {
                l[(i, j)] = known / d[j];
            }
        }
    }
    let row = |i: usize| (0..i).filter(|&j| !l[(i, j)].is_zero()).map(|j| (j, precision.round(l[(i, j)]))).collect();
    Ok(((0..n).map(row).collect(), d.iter().map(|&d| precision.round(Dd::ONE / d)).collect()))
}
