//! Products with the matrices of a system and solutions of their equations, exact wherever the numbers are: verdicts such
//! as whether something is infinite depend on zeros.

use crate::analysis::modes::parts::joined_by;
use crate::base::{Ball, Number, Rational};
use crate::kernel::dense::{Matrix, echelon, enclosure};
use crate::system::{CoordinateId, Form};

/// Maximum number of coupled coordinates that are solved for in fractions.
const MOST_EXACT: usize = 12;

/// A sparse vector as a dense one.
pub fn dense<'r>(n: usize, row: impl IntoIterator<Item = &'r (CoordinateId, Number)>) -> Vec<Number> {
    let mut list = vec![Number::ZERO; n];
    for (i, value) in row {
        list[i.index()] = &list[i.index()] + value;
    }
    list
}

/// The product of a sparse vector and a dense one.
pub fn dot(row: &[(CoordinateId, Number)], x: &[Number]) -> Number {
    row.iter().filter(|(i, _)| !x[i.index()].is_zero()).fold(Number::ZERO, |sum, (i, a)| &sum + &(a * &x[i.index()]))
}

/// The form times a vector, term by term.
pub fn apply(form: &Form, x: &[Number]) -> Vec<Number> {
    let mut image = vec![Number::ZERO; x.len()];
    if x.iter().all(Number::is_zero) {
        return image;
    }
    for term in form.terms() {
        let row = form.row(term);
        let stretch = row.iter().fold(Number::ZERO, |sum, (i, a)| &sum + &(a * &x[i.index()]));
        if stretch.is_zero() {
            continue;
        }
        let pull = term.weight * &stretch;
        for (i, a) in row {
            image[i.index()] = &image[i.index()] + &(a * &pull);
        }
    }
    image
}

/// x with A x = b over some of the coordinates, exact if possible, and zero in all others; zero, too, in the coordinates
/// that A does not couple with those of b. `None` if A is singular over them.
pub fn solution_on(a: &Form, coordinates: &[usize], b: &[Number]) -> Option<Vec<Number>> {
    let mut solution = vec![Number::ZERO; b.len()];
    if coordinates.iter().all(|&i| b[i].is_zero()) {
        return Some(solution);
    }
    let mut is_meant = vec![false; b.len()];
    coordinates.iter().for_each(|&i| is_meant[i] = true);
    for part in joined_by(b.len(), &[a]) {
        let part: Vec<usize> = part.coordinates.iter().map(|&i| i as usize).filter(|&i| is_meant[i]).collect();
        if part.iter().all(|&i| b[i].is_zero()) {
            continue;
        }
        let own: Vec<Number> = part.iter().map(|&i| b[i].clone()).collect();
        for (&i, value) in part.iter().zip(part_solution(a, b.len(), &part, &own)?) {
            solution[i] = value;
        }
    }
    Some(solution)
}

fn part_solution(form: &Form, coordinates: usize, part: &[usize], b: &[Number]) -> Option<Vec<Number>> {
    let n = part.len();
    let mut place = vec![usize::MAX; coordinates];
    part.iter().enumerate().for_each(|(at, &i)| place[i] = at);
    let mut entries = vec![vec![Number::ZERO; n]; n];
    for term in form.terms() {
        let row = form.row(term);
        for (i, x) in row {
            for (j, y) in row {
                let (i, j) = (place[i.index()], place[j.index()]);
                if i < n && j < n {
                    entries[i][j] = &entries[i][j] + &(term.weight * &(x * y));
                }
            }
        }
    }
    if n == 1 {
        return Some(vec![b[0].checked_div(&entries[0][0])?]);
    }
    if n <= MOST_EXACT {
        let rational = |row: &Vec<Number>| row.iter().map(|x| x.exact().cloned()).collect::<Option<Vec<Rational>>>();
        let matrix: Option<Vec<Vec<Rational>>> = entries.iter().map(rational).collect();
        let right: Option<Vec<Rational>> = b.iter().map(|x| x.exact().cloned()).collect();
        if let (Some(matrix), Some(right)) = (matrix, right) {
            let (solution, only) = echelon::solution(&matrix, &right)?;
            return only.then(|| solution.into_iter().map(Number::from).collect());
        }
    }
    let matrix = Matrix::from_fn(n, n, |i, j| entries[i][j].to_ball());
    let right = Matrix::from_fn(n, 1, |i, _| b[i].to_ball());
    let solution = enclosure::solve(&matrix, &right)?;
    Some((0..n).map(|i| Number::Ball(solution[(i, 0)])).collect())
}

/// Whether a number is certainly not zero.
pub fn is_certain(x: &Number) -> bool {
    let ball: Ball = x.to_ball();
    !x.is_zero() && !ball.contains_zero()
}
