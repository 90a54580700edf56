//! A small system as a function of one parameter, for code in which it stays adjustable. In: the system at several
//! exact values of the parameter. Out: every entry of M, C, K and of the rows of inputs and outputs as a polynomial of
//! degree at most two, found from three of the values and confirmed at the others; or why that is not possible. See
//! docs/method/emit.md.

use crate::analysis::discrete::Port;
use crate::base::{Ball, Number};
use crate::system::LinearSystem;

/// c0 + c1 p + c2 p^2
pub type Polynomial = [f64; 3];

/// The system over the parameter.
#[derive(Clone, Debug)]
pub struct Parameterised {
    pub name: String,
    /// The current value and the range that was examined, in SI units.
    pub value: f64,
    pub range: (f64, f64),
    pub coordinates: Vec<Port>,
    pub inputs: Vec<Port>,
    pub outputs: Vec<Port>,
    /// n x n, row by row.
    pub m: Vec<Polynomial>,
    pub c: Vec<Polynomial>,
    pub k: Vec<Polynomial>,
    /// n x inputs.
    pub b: Vec<Polynomial>,
    /// For displacements, velocities and accelerations: outputs x n.
    pub p: [Vec<Polynomial>; 3],
    /// outputs x inputs.
    pub d: Vec<Polynomial>,
    pub start: Vec<(f64, f64)>,
}

/// With more coordinates, the recomputation would take longer than most steps can wait.
pub const MOST_COORDINATES: usize = 8;
/// The parameter is evaluated at these multiples of its value: three determine a polynomial, the others confirm it.
pub const MULTIPLES: [(i64, i64); 8] = [(1, 1), (2, 1), (5, 1), (1, 16), (1, 3), (7, 1), (11, 1), (16, 1)];

/// The polynomials; `Err` says why they do not exist.
pub fn fit(name: &str, value: &Number, systems: &[LinearSystem]) -> Result<Parameterised, String> {
    let Some(first) = systems.first() else { return Err("there is no system".into()) };
    let n = first.n();
    if n > MOST_COORDINATES {
        return Err(format!("the model has {n} coordinates; the limit is {MOST_COORDINATES}"));
    }
    let names = first.coordinate_names();
    let alike = |s: &LinearSystem| {
        s.coordinate_names() == names && s.inputs.len() == first.inputs.len() && s.outputs.len() == first.outputs.len()
    };
    if !systems.iter().all(alike) {
        return Err(format!("`{name}` changes the set of coordinates"));
    }
    let powers = |s: &LinearSystem| {
        s.inputs.iter().all(|i| i.b[1].is_empty() && i.b[2].is_empty())
            && s.outputs.iter().all(|o| o.d[1].is_empty() && o.d[2].is_empty())
    };
    if !systems.iter().all(powers) {
        return Err("an input acts through its rate (a damper on a moving base)".into());
    }
    let values: Vec<Number> = MULTIPLES.iter().map(|&(a, b)| &(value * &Number::from(a)) / &Number::from(b)).collect();
    let fit = |what: &str, of: &dyn Fn(&LinearSystem) -> Vec<Number>| -> Result<Vec<Polynomial>, String> {
        let columns: Vec<Vec<Number>> = systems.iter().map(of).collect();
        (0..columns[0].len())
            .map(|i| {
                let entry: Vec<Number> = columns.iter().map(|column| column[i].clone()).collect();
                polynomial(&values, &entry)
                    .ok_or_else(|| format!("{what} is not a polynomial of degree two or less in `{name}`"))
            })
            .collect()
    };
    let matrix = |form: fn(&LinearSystem) -> &crate::system::Form| {
        move |s: &LinearSystem| form(s).entries(n).into_iter().flatten().collect::<Vec<Number>>()
    };
    let row = |entries: &[(crate::system::CoordinateId, Number)]| {
        let mut row = vec![Number::ZERO; n];
        entries.iter().for_each(|(i, x)| row[i.index()] = &row[i.index()] + x);
        row
    };
    let inputs = first.inputs.len();
    let seen =
        |power: usize| move |s: &LinearSystem| s.outputs.iter().flat_map(|o| row(&o.p[power])).collect::<Vec<Number>>();
    let b = |s: &LinearSystem| {
        let columns: Vec<Vec<Number>> = s.inputs.iter().map(|input| row(&input.b[0])).collect();
        (0..n).flat_map(|i| columns.iter().map(move |c| c[i].clone()).collect::<Vec<_>>()).collect::<Vec<Number>>()
    };
    let d = |s: &LinearSystem| {
        let of = |output: &crate::system::Output| {
            let mut row = vec![Number::ZERO; inputs];
            output.d[0].iter().for_each(|(j, x)| row[*j as usize] = &row[*j as usize] + x);
            row
        };
        s.outputs.iter().flat_map(of).collect::<Vec<Number>>()
    };
    let start = |s: &LinearSystem| {
        let mut start = vec![Number::ZERO; 2 * n];
        for (i, q, v) in &s.initial {
            start[i.index()] = q.clone();
            start[n + i.index()] = v.clone();
        }
        start
    };
    let start = fit("the initial state", &start)?;
    if start.iter().any(|p| p[1] != 0.0 || p[2] != 0.0) {
        return Err(format!("the initial state depends on `{name}`"));
    }
    let port = |name, unit: &str| Port { name: first.display(name), unit: unit.to_string() };
    Ok(Parameterised {
        name: name.to_string(),
        value: value.to_f64(),
        range: (value.to_f64() / 16.0, value.to_f64() * 16.0),
        coordinates: super::coordinates(first),
        inputs: first.inputs.iter().map(|input| port(input.name, input.unit)).collect(),
        outputs: first.outputs.iter().map(|output| port(output.name, &output.unit)).collect(),
        m: fit("the mass matrix", &matrix(|s| &s.m))?,
        c: fit("the damping matrix", &matrix(|s| &s.c))?,
        k: fit("the stiffness matrix", &matrix(|s| &s.k))?,
        b: fit("the effect of an input", &b)?,
        p: [fit("an output", &seen(0))?, fit("an output", &seen(1))?, fit("an output", &seen(2))?],
        d: fit("an output", &d)?,
        start: (0..n).map(|i| (start[i][0], start[n + i][0])).collect(),
    })
}

/// Newton's divided differences from the first three values; the others must lie on the polynomial.
fn polynomial(x: &[Number], y: &[Number]) -> Option<Polynomial> {
    let slope = |a: usize, b: usize| &(&y[b] - &y[a]) / &(&x[b] - &x[a]);
    let (first, second) = (slope(0, 1), slope(1, 2));
    let bend = &(&second - &first) / &(&x[2] - &x[0]);
    let c2 = cleaned_coefficient(bend, &y[0], &x[0].square());
    let c1 = cleaned_coefficient(&first - &(&c2 * &(&x[0] + &x[1])), &y[0], &x[0]);
    let c0 = cleaned_coefficient(&(&y[0] - &(&c1 * &x[0])) - &(&c2 * &x[0].square()), &y[0], &Number::ONE);
    let at = |x: &Number| &(&(&(&c2 * x) + &c1) * x) + &c0;
    let fits = x.iter().zip(y).all(|(x, y)| {
        let difference = (&at(x) - y).to_ball();
        difference.contains_zero() || difference.magnitude() <= 1e-24 * y.to_ball().magnitude()
    });
    fits.then(|| [c0.to_f64(), c1.to_f64(), c2.to_f64()])
}

/// A coefficient whose contribution is below the rounding error of the values is zero.
fn cleaned_coefficient(c: Number, y: &Number, x: &Number) -> Number {
    let term: Ball = (&c * x).to_ball();
    let small = !y.is_zero() && term.mid.hi.abs() <= 1e-24 * y.to_ball().magnitude();
    if small || c.to_ball().contains_zero() { Number::ZERO } else { c }
}
