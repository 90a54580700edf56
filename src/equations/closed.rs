//! Natural frequencies in closed form, part by part: coordinates that no entry connects are separate parts. In: the
//! linearised equations. Out: for parts of one and two coordinates the characteristic polynomial in symbols and its
//! roots, for larger ones its numbers.

use super::polynomial::{self, Polynomial};
use super::{Entry, Equations};
use crate::base::Number;
use crate::symbols::{Factor, Product, Sum, Symbol};

/// Coordinates that are coupled.
#[derive(Clone, Debug)]
pub struct Part {
    /// Their places among the independent coordinates.
    pub places: Vec<usize>,
    /// det(M s^2 + C s + K) by powers of s, the constant first; empty if it is too long or has no symbols.
    pub characteristic: Vec<Sum>,
    /// The polynomials with numbers, for parts of more coordinates.
    pub numbers: Polynomial,
    /// det(K - omega^2 M) by powers of -omega^2, the constant first.
    pub undamped: Vec<Sum>,
    /// The solutions, ascending.
    pub squares: Vec<Square>,
    /// c/(2 sqrt(k m)) of a single coordinate with damping.
    pub damping_ratio: Option<(Sum, Number)>,
}

/// The square of a natural frequency.
#[derive(Clone, Debug)]
pub struct Square {
    /// The root in symbols, unless it is the root of a quadratic.
    pub form: Option<Sum>,
    /// `None` if its enclosure is infinite.
    pub value: Option<Number>,
}

/// Maximum number of terms of a coefficient; a longer closed form says less than its numbers.
pub const MOST_TERMS: usize = 16;
/// Maximum number of coordinates of a part whose polynomials are written with numbers.
const MOST_NUMBERS: usize = 8;

/// The parts with a short closed form, and those of a few more coordinates.
pub fn parts(equations: &Equations) -> Vec<Part> {
    let linear = &equations.linear;
    let groups = groups(linear.coordinates.len(), &[&linear.mass, &linear.damping, &linear.stiffness]);
    groups.into_iter().filter_map(|places| part(equations, places)).collect()
}

/// An entry of M s^2 + C s + K by powers of s.
pub fn entry(equations: &Equations, i: usize, j: usize) -> Vec<Sum> {
    let linear = &equations.linear;
    [&linear.stiffness, &linear.damping, &linear.mass].map(|matrix| matrix[i][j].sum.clone()).to_vec()
}

fn part(equations: &Equations, places: Vec<usize>) -> Option<Part> {
    let has_symbols = equations.modal_damping.is_none();
    let empty = Part {
        places: places.clone(),
        characteristic: Vec::new(),
        numbers: Vec::new(),
        undamped: Vec::new(),
        squares: Vec::new(),
        damping_ratio: None,
    };
    let is_short = |sums: &[Sum]| sums.iter().all(|sum| sum.terms().len() <= MOST_TERMS);
    let undamped = if places.len() <= 2 { undamped_determinant(equations, &places) } else { Vec::new() };
    if undamped.is_empty() || !is_short(&undamped) {
        let numbers = (has_symbols && places.len() <= MOST_NUMBERS).then(|| numbers(equations, &places)).flatten();
        return numbers.map(|numbers| Part { numbers, ..empty });
    }
    let whole = determinant(&|i, j| entry(equations, i, j), &places);
    let characteristic = if has_symbols && is_short(&whole) { whole } else { Vec::new() };
    let squares = squares(equations, &undamped);
    let damping_ratio = if has_symbols { damping_ratio(equations, &places) } else { None };
    Some(Part { characteristic, undamped, squares, damping_ratio, ..empty })
}

/// det(K - omega^2 M): stiffness and mass by powers of -omega^2.
fn undamped_determinant(equations: &Equations, places: &[usize]) -> Vec<Sum> {
    let linear = &equations.linear;
    determinant(&|i, j| vec![linear.stiffness[i][j].sum.clone(), linear.mass[i][j].sum.clone()], places)
}

fn determinant(entry: &impl Fn(usize, usize) -> Vec<Sum>, places: &[usize]) -> Vec<Sum> {
    match *places {
        [one] => entry(one, one),
        [one, other] => {
            let straight = product(&entry(one, one), &entry(other, other));
            let across = product(&entry(one, other), &entry(other, one));
            straight.iter().zip(&across).map(|(a, b)| &a.evaluate() - &b.evaluate()).collect()
        }
        _ => Vec::new(),
    }
}

/// The solutions of a_0 - a_2 omega^2 + a_4 omega^4 = 0.
fn squares(equations: &Equations, undamped: &[Sum]) -> Vec<Square> {
    let names = &equations.names;
    let quotient = |over: &Sum, under: &Sum| {
        let form = over.over(under).map(|form| form.simplify());
        let value = form.as_ref().and_then(|form| names.value_of(form));
        Square { form, value }
    };
    match undamped {
        [stiffness, mass] => vec![quotient(stiffness, mass)],
        // A motion without inertia follows the other.
        [zeroth, second, fourth] if fourth.vanishes() => vec![quotient(zeroth, second)],
        [zeroth, second, fourth] if zeroth.vanishes() => {
            vec![Square { form: Some(Sum::ZERO), value: Some(Number::ZERO) }, quotient(second, fourth)]
        }
        [zeroth, second, fourth] => {
            let root = |negative: bool| {
                let (r, p, q) = (names.value_of(zeroth)?, names.value_of(second)?, names.value_of(fourth)?);
                let root = (&p.square() - &(&(&q * &r) * &Number::from(4))).sqrt()?;
                let top = if negative { &p - &root } else { &p + &root };
                top.checked_div(&(&q + &q))
            };
            [true, false].map(|negative| Square { form: None, value: root(negative) }).to_vec()
        }
        _ => Vec::new(),
    }
}

fn damping_ratio(equations: &Equations, places: &[usize]) -> Option<(Sum, Number)> {
    let &[one] = places else { return None };
    let [stiffness, damping, mass] = &entry(equations, one, one)[..] else { return None };
    if damping.is_zero() {
        return None;
    }
    let names = &equations.names;
    // Two sums are not multiplied out.
    let root = match stiffness.terms().len() > 1 && mass.terms().len() > 1 {
        true => &names.length(stiffness) * &names.length(mass),
        false => names.length(&(stiffness * mass)),
    };
    let critical = root.scale(&crate::base::Rational::from(2));
    let ratio = damping.over(&critical)?.simplify();
    let value = names.value_of(&ratio)?;
    Some((ratio, value))
}

/// The characteristic polynomial of a larger part.
fn numbers(equations: &Equations, places: &[usize]) -> Option<Polynomial> {
    let mut polynomial = polynomial::determinant(&matrix_of_numbers(equations, places)?)?;
    // An equal motion of all coordinates that no spring resists gives a factor s, or s^2 if no damper resists it
    // either: these are exact zeros.
    let resists = |matrix: &Vec<Vec<Entry>>| {
        let row = |i: &usize| places.iter().fold(Sum::ZERO, |sum, j| &sum + &matrix[*i][*j].sum);
        !places.iter().all(|i| row(i).vanishes())
    };
    let linear = &equations.linear;
    if !resists(&linear.stiffness) {
        let zeros = if resists(&linear.damping) { 1 } else { 2 };
        polynomial.iter_mut().take(zeros).for_each(|coefficient| *coefficient = Number::ZERO);
    }
    Some(polynomial)
}

/// M s^2 + C s + K of a part with numbers.
pub fn matrix_of_numbers(equations: &Equations, places: &[usize]) -> Option<Vec<Vec<Polynomial>>> {
    let worth = |sum: &Sum| equations.names.value_of(sum);
    let cell = |i: usize, j: usize| entry(equations, i, j).iter().map(worth).collect::<Option<Polynomial>>();
    places.iter().map(|i| places.iter().map(|j| cell(*i, *j)).collect()).collect()
}

/// The product of two polynomials in s.
pub fn product(a: &[Sum], b: &[Sum]) -> Vec<Sum> {
    let mut product = vec![Sum::ZERO; (a.len() + b.len()).saturating_sub(1)];
    for (i, first) in a.iter().enumerate() {
        for (j, second) in b.iter().enumerate() {
            product[i + j] = &product[i + j] + &(first * second);
        }
    }
    product
}

/// Places that entries join, each group ascending.
pub fn groups(n: usize, matrices: &[&Vec<Vec<Entry>>]) -> Vec<Vec<usize>> {
    let mut group: Vec<usize> = (0..n).collect();
    for matrix in matrices {
        for i in 0..n {
            for j in 0..n {
                if group[i] != group[j] && !matrix[i][j].sum.is_zero() {
                    let (keeps, joins) = (group[i].min(group[j]), group[i].max(group[j]));
                    group.iter_mut().filter(|own| **own == joins).for_each(|own| *own = keeps);
                }
            }
        }
    }
    let groups = (0..n).map(|first| (0..n).filter(|place| group[*place] == first).collect::<Vec<usize>>());
    groups.filter(|places| !places.is_empty()).collect()
}

/// A polynomial in a variable as a sum.
pub fn in_variable(coefficients: &[Sum], variable: Symbol) -> Sum {
    let term = |(power, coefficient): (usize, &Sum)| match power {
        0 => coefficient.clone(),
        power => {
            let power = Product::of(Factor::Name(variable), power as i32);
            &Sum::term(power, crate::base::Rational::ONE) * coefficient
        }
    };
    coefficients.iter().enumerate().map(term).fold(Sum::ZERO, |sum, term| &sum + &term)
}
