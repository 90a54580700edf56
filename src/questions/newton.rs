//! Several unknowns at once: Newton's method from many starting points in their ranges. In: equations that depend on
//! each other's unknowns. Out: the set of values that satisfies all of them, proven to be the only one in its
//! neighbourhood, or an error with the evaluations that were made. See docs/method/measures.md.

use super::answer::Others;
use super::derivative::step;
use super::error::AskedError;
use super::range_enclosure::{Centre, Moved};
use super::search::{Difference, Root, to_fraction};
use super::unknowns::{Pairing, Unknowns, finite_value, interpolate};
use crate::base::{Ball, Dd, Jet, Number, two_to, up};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::lu::Lu;
use crate::kernel::real::Scalar;

/// Number of starting points along each range, for this number of unknowns.
fn starts_of(unknowns: usize) -> i64 {
    match unknowns {
        2 => 7,
        3 => 4,
        4 => 3,
        _ => 2,
    }
}

/// Limit on the number of starting points.
const MOST_STARTS: usize = 128;
const MOST_STEPS: usize = 60;
/// If the determinant, with rows and columns scaled to one, is below this, the measures do not vary independently.
const SINGULAR: f64 = 1e-9;

/// The end point of Newton's method from one starting point.
struct End {
    x: Vec<Dd>,
    /// The sum of |difference|, each relative to the target of its equation.
    size: f64,
    differences: Vec<Ball>,
    /// Whether the residual is as small as the measures can resolve.
    arrived: bool,
    singular: bool,
}

/// Finds the unknowns of a group.
pub fn solve_group(unknowns: &mut Unknowns, group: &[Pairing]) -> Result<(), Vec<AskedError>> {
    let problem = Problem::of(unknowns, group);
    let ends: Vec<End> = problem.starts().into_iter().filter_map(|start| problem.descend(start)).collect();
    let mut roots: Vec<&End> = Vec::new();
    for end in ends.iter().filter(|end| end.arrived) {
        if !roots.iter().any(|known| problem.are_same(&known.x, &end.x)) {
            roots.push(end);
        }
    }
    let list: Vec<usize> = group.iter().map(|(_, unknown)| *unknown).collect();
    if roots.iter().any(|root| root.singular) || roots.len() > MAX_REPORTED {
        return Err(vec![unknowns.singular(&list)]);
    }
    match roots[..] {
        [root] => {
            let within = problem.prove(root);
            let (x, evaluations) = (root.x.clone(), problem.evaluations.get());
            for (i, &(equation, unknown)) in group.iter().enumerate() {
                let root = match &within {
                    Some(within) => Root::enclosed_root(x[i], within[i]),
                    None => Root::seen_root(x[i], x[i].hi.abs() * two_to(-96)),
                };
                unknowns.take(equation, unknown, &root, evaluations, Others::Unknown);
            }
            Ok(())
        }
        [] => Err(vec![problem.no_solution(&ends, &list)]),
        _ => Err(vec![problem.several_solutions(&roots, &list)]),
    }
}

/// Number of times the box in which one set of values is to be proven is enlarged.
const WIDENINGS: usize = 12;

/// More sets of values than this lie on a curve.
const MAX_REPORTED: usize = 6;

struct Problem<'a, 'b> {
    unknowns: &'a Unknowns<'b>,
    group: &'a [Pairing],
    equations: Vec<usize>,
    low: Vec<Dd>,
    high: Vec<Dd>,
    evaluations: std::cell::Cell<usize>,
}

impl<'a, 'b> Problem<'a, 'b> {
    fn of(unknowns: &'a Unknowns<'b>, group: &'a [Pairing]) -> Problem<'a, 'b> {
        let ends = |of: fn(&crate::model::scene::Solve) -> &Number| {
            group.iter().map(|&(_, unknown)| of(&unknowns.solves[unknown]).to_ball().mid).collect()
        };
        let equations = group.iter().map(|(equation, _)| *equation).collect();
        let (low, high) = (ends(|solve| &solve.low), ends(|solve| &solve.high));
        Problem { unknowns, group, equations, low, high, evaluations: std::cell::Cell::new(0) }
    }

    /// The midpoints of equal parts of the ranges, in all combinations.
    fn starts(&self) -> Vec<Vec<Dd>> {
        let parts = starts_of(self.group.len());
        let mut starts: Vec<Vec<Dd>> = vec![Vec::new()];
        for &(_, unknown) in self.group {
            let solve = &self.unknowns.solves[unknown];
            let places: Vec<Dd> =
                (0..parts).map(|i| interpolate(&solve.low, &solve.high, 2 * i + 1, 2 * parts).to_ball().mid).collect();
            let longer = |start: &Vec<Dd>| {
                places.iter().map(|place| start.iter().copied().chain([*place]).collect()).collect::<Vec<Vec<Dd>>>()
            };
            starts = starts.iter().flat_map(longer).take(MOST_STARTS).collect();
        }
        starts
    }

    fn differences(&self, x: &[Dd]) -> Option<Vec<Ball>> {
        self.evaluations.set(self.evaluations.get() + 1);
        let mut values = self.unknowns.values.clone();
        for (&(_, unknown), &x) in self.group.iter().zip(x) {
            values[unknown] = to_fraction(x);
        }
        self.unknowns.differences(&self.equations, &values).into_iter().map(finite_value).collect()
    }

    /// Rows: equations; columns: unknowns.
    fn jacobian(&self, x: &[Dd], differences: &[Ball]) -> Option<Vec<Vec<f64>>> {
        let mut columns = Vec::new();
        for i in 0..x.len() {
            let scale = to_fraction((self.high[i] - self.low[i]).abs());
            let relative =
                (differences.iter().enumerate()).map(|(e, ball)| ball.rad / self.target(e)).fold(0.0, f64::max);
            let h = step(&to_fraction(x[i]), &scale, relative).to_ball().mid;
            let moved = |h: Dd| {
                let mut moved = x.to_vec();
                moved[i] += h;
                self.differences(&moved)
            };
            let (after, before) = (moved(h)?, moved(-h)?);
            let column = after.iter().zip(&before).map(|(a, b)| ((a.mid - b.mid) / (h + h)).to_f64());
            columns.push(column.collect::<Vec<f64>>());
        }
        Some((0..x.len()).map(|row| columns.iter().map(|column| column[row]).collect()).collect())
    }

    /// The magnitude of the target of an equation.
    fn target(&self, equation: usize) -> f64 {
        self.unknowns.solves[self.equations[equation]].question.value.to_f64().abs().max(f64::MIN_POSITIVE)
    }

    /// Newton steps inside the ranges, shortened until they bring the measures nearer.
    fn descend(&self, start: Vec<Dd>) -> Option<End> {
        let mut x = start;
        let mut here = self.differences(&x)?;
        let size = |differences: &[Ball]| -> f64 {
            differences.iter().enumerate().map(|(e, d)| d.to_f64().abs() / self.target(e)).sum()
        };
        let mut singular = false;
        for _ in 0..MOST_STEPS {
            if here.iter().all(Ball::contains_zero) {
                break;
            }
            let Some(jacobian) = self.jacobian(&x, &here) else { break };
            singular = self.is_singular(&jacobian);
            let rhs: Vec<Dd> = here.iter().map(|d| d.mid).collect();
            let Some(full) = factor(&jacobian).and_then(|lu| solve_step(&lu, rhs)) else {
                singular = true;
                break;
            };
            let mut part = 1.0;
            let mut better = None;
            while part > 1e-4 && better.is_none() {
                let next: Vec<Dd> = (0..x.len()).map(|i| self.clamp_to_limits(i, x[i] - full[i].scale(part))).collect();
                better = self.differences(&next).filter(|there| size(there) < size(&here)).map(|there| (next, there));
                part *= 0.5;
            }
            let Some((next, there)) = better else { break };
            (x, here) = (next, there);
        }
        let arrived =
            here.iter().enumerate().all(|(e, d)| d.contains_zero() || d.to_f64().abs() < 1e-20 * self.target(e));
        Some(End { size: size(&here), x, differences: here, arrived, singular })
    }

    fn clamp_to_limits(&self, i: usize, x: Dd) -> Dd {
        if x < self.low[i] {
            self.low[i]
        } else if x > self.high[i] {
            self.high[i]
        } else {
            x
        }
    }

    fn are_same(&self, a: &[Dd], b: &[Dd]) -> bool {
        let width = |i: usize| (self.high[i] - self.low[i]).to_f64();
        a.iter().zip(b).enumerate().all(|(i, (a, b))| (*a - *b).abs().to_f64() <= 1e-9 * width(i))
    }

    /// Judged by the determinant once every row and column is scaled to one, so that it measures how parallel they are.
    fn is_singular(&self, jacobian: &[Vec<f64>]) -> bool {
        let mut scaled: Vec<Vec<f64>> = jacobian.to_vec();
        for (i, column) in (0..scaled.len()).map(|i| (i, (self.high[i] - self.low[i]).to_f64())) {
            scaled.iter_mut().for_each(|row| row[i] *= column);
        }
        for row in &mut scaled {
            let length = row.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length == 0.0 {
                return true;
            }
            row.iter_mut().for_each(|x| *x /= length);
        }
        factor::<f64>(&scaled).is_none_or(|lu| lu.determinant().abs() < SINGULAR)
    }

    /// Distances from an end within which there is exactly one set of values, by Krawczyk's operator: with Y near the
    /// inverse of the derivatives J, |Y F| + |1 - Y J(box)| r < r. `None` if that could not be shown.
    fn prove(&self, end: &End) -> Option<Vec<f64>> {
        let n = end.x.len();
        let middle = self.jacobian(&end.x, &end.differences)?;
        let unit = |e: usize| -> Vec<Dd> { (0..n).map(|i| if i == e { Dd::ONE } else { Dd::ZERO }).collect() };
        let middle = factor(&middle)?;
        let columns: Option<Vec<Vec<Dd>>> = (0..n).map(|e| solve_step(&middle, unit(e))).collect();
        let y = columns?;
        // |Y F(m)|
        let step: Vec<f64> = (0..n)
            .map(|i| (0..n).map(|e| y[e][i].hi.abs() * end.differences[e].magnitude()).sum::<f64>() * up::THOUSANDS)
            .collect();
        let rounding = |i: usize| end.x[i].hi.abs().max(self.high[i].hi.abs() * 1e-9) * two_to(-98);
        let mut radius: Vec<f64> = (0..n).map(|i| 2.0 * step[i] + rounding(i)).collect();
        for _ in 0..WIDENINGS {
            if is_contracted(&y, &self.slopes(&end.x, &radius)?, &step, &radius) {
                return Some(radius);
            }
            radius.iter_mut().for_each(|radius| *radius *= 16.0);
        }
        None
    }

    /// The derivatives of all measures over a box around these values. Rows: equations.
    fn slopes(&self, x: &[Dd], radius: &[f64]) -> Option<Vec<Vec<Ball>>> {
        (0..self.equations.len()).map(|e| self.slopes_of(self.equations[e], x, radius)).collect()
    }

    fn slopes_of(&self, equation: usize, x: &[Dd], radius: &[f64]) -> Option<Vec<Ball>> {
        let n = x.len();
        // One unknown carries its derivative, and the others lie anywhere in the box.
        let values = |own: Option<usize>| {
            let mut values = self.unknowns.values.clone();
            for (i, &(_, unknown)) in self.group.iter().enumerate() {
                let range = Ball::exact(x[i]).widen(radius[i]);
                values[unknown] = match own {
                    None => to_fraction(x[i]),
                    Some(own) if own == i => Jet::of_parameter(range),
                    Some(_) => Number::Ball(range),
                };
            }
            values
        };
        let centre = self.unknowns.centre(equation, &values(None))?;
        let moved = |centre: &Centre| -> Option<Vec<Moved>> {
            (0..n)
                .map(|i| self.unknowns.ask(equation, &values(Some(i)), |asked| asked.derivative_in_centre(centre))?)
                .collect()
        };
        let wide = centre.over_box(radius, moved)?;
        (0..n).map(|i| self.unknowns.ask(equation, &values(Some(i)), |asked| asked.slope(&wide))?).collect()
    }

    fn no_solution(&self, ends: &[End], list: &[usize]) -> AskedError {
        let (span, others) = self.unknowns.spans(list);
        let names = self.unknowns.names(list);
        match ends.iter().min_by(|a, b| a.size.total_cmp(&b.size)) {
            Some(end) if end.singular => self.unknowns.singular(list),
            Some(end) => {
                let text = |(i, &unknown): (usize, &usize)| self.unknowns.value_text(unknown, &to_fraction(end.x[i]));
                let nearest = names.iter().cloned().zip(list.iter().enumerate().map(text)).collect();
                let reached = |(e, d): (&usize, &Ball)| self.unknowns.reached_value(*e, &Difference::Known(*d));
                let left = self.equations.iter().zip(&end.differences).map(reached).collect();
                AskedError::Apart { span, names, others, nearest, left }
            }
            None => self.unknowns.singular(list),
        }
    }

    fn several_solutions(&self, roots: &[&End], list: &[usize]) -> AskedError {
        let (span, others) = self.unknowns.spans(list);
        let names = self.unknowns.names(list);
        let text = |root: &&End| {
            let one = |(i, &unknown): (usize, &usize)| {
                format!("{} = {}", names[i], self.unknowns.value_text(unknown, &to_fraction(root.x[i])))
            };
            list.iter().enumerate().map(one).collect::<Vec<_>>().join(", ")
        };
        let mut roots: Vec<String> = roots.iter().map(text).collect();
        roots.sort();
        AskedError::SeveralTogether { span, names, others, roots }
    }
}

/// Whether Krawczyk's operator maps a box about the end into its interior: |Y F| + |1 - Y J(box)| r < r in every component.
/// `inverse` has the columns of Y, `slopes` the rows of J, and `step` bounds |Y F|.
fn is_contracted(inverse: &[Vec<Dd>], slopes: &[Vec<Ball>], step: &[f64], radius: &[f64]) -> bool {
    let n = radius.len();
    (0..n).all(|i| {
        let left = |j: usize| {
            let product = (0..n).fold(Ball::ZERO, |sum, e| sum + Ball::exact(inverse[e][i]) * slopes[e][j]);
            (product - if i == j { Ball::ONE } else { Ball::ZERO }).magnitude()
        };
        let image = (step[i] + (0..n).map(|j| left(j) * radius[j]).sum::<f64>()) * up::THOUSANDS;
        image < radius[i]
    })
}

/// The factors of a matrix given by rows.
fn factor<T: Scalar>(rows: &[Vec<f64>]) -> Option<Lu<T>> {
    Lu::of(Matrix::from_fn(rows.len(), rows.len(), |i, j| T::of_f64(rows[i][j])))
}

/// A^-1 b; `None` if it is not finite.
fn solve_step(a: &Lu<Dd>, mut b: Vec<Dd>) -> Option<Vec<Dd>> {
    a.solve(&mut b);
    b.iter().all(|x| x.is_finite()).then_some(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_contraction(slopes: [[(f64, f64); 2]; 2], step: [f64; 2], radius: [f64; 2]) -> bool {
        let ball = |(middle, radius): (f64, f64)| Ball::from(middle).widen(radius);
        let slopes: Vec<Vec<Ball>> = slopes.iter().map(|row| row.iter().copied().map(ball).collect()).collect();
        let identity = [vec![Dd::ONE, Dd::ZERO], vec![Dd::ZERO, Dd::ONE]];
        is_contracted(&identity, &slopes, &step, &radius)
    }

    /// With Y = 1 the image of a box |x| <= r has the half widths |F| + |1 - J| r.
    #[test]
    fn a_box_is_proved_only_if_its_image_lies_within_it() {
        let exact = [[(1.0, 0.0), (0.0, 0.0)], [(0.0, 0.0), (1.0, 0.0)]];
        assert!(is_contraction(exact, [0.9; 2], [1.0; 2]));
        // An image that reaches the boundary, or leaves through one side alone.
        assert!(!is_contraction(exact, [1.0, 0.0], [1.0; 2]));
        assert!(!is_contraction(exact, [0.0, 1.1], [1.0; 2]));
        // A slope that varies by a half in the box leaves half of it for the step.
        let varying = [[(1.0, 0.5), (0.0, 0.0)], [(0.0, 0.0), (1.0, 0.0)]];
        assert!(is_contraction(varying, [0.4; 2], [1.0; 2]) && !is_contraction(varying, [0.6; 2], [1.0; 2]));
        // A slope that may be zero, as at a double root, and one by the other unknown, whose range is wider.
        let double = [[(1.0, 1.0), (0.0, 0.0)], [(0.0, 0.0), (1.0, 0.0)]];
        assert!(!is_contraction(double, [0.0; 2], [1.0; 2]));
        let coupled = [[(1.0, 0.0), (0.0, 0.5)], [(0.0, 0.0), (1.0, 0.0)]];
        assert!(is_contraction(coupled, [0.1; 2], [1.0, 1.0]) && !is_contraction(coupled, [0.1; 2], [1.0, 2.0]));
    }
}
