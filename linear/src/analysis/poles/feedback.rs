//! Forces along rows that are proportional to the displacement, the velocity or the acceleration along them, as squares whose weights
//! change are, in coordinates of the poles. In: a system and the rows. Out: a matrix diag(D) - t B (1 + t G)^-1 W^T for all factors t of
//! the forces, whose eigenvalues are the poles, with bounds of what the true one has besides.
//! docs/method/studies.md#one-weight-and-all-poles derives it for one row, and #a-few-weights-and-all-poles for several.

use crate::analysis::poles::coordinates::power_of_two_below;
use crate::analysis::poles::disc_columns::UP;
use crate::analysis::poles::{all_modes, pole_coordinates};
use crate::base::{Ball, Dd, Number, Power};
use crate::kernel::complex::Complex;
use crate::kernel::low_rank::{Columns, Off};
use crate::system::{CoordinateId, Input, LinearSystem};

/// A row, and what the weights of its squares in K, C and M grow by for a factor of 1.
#[derive(Clone, Debug)]
pub struct WeighedRow {
    pub entries: Vec<(usize, Ball)>,
    pub slopes: [Ball; 3],
}

/// The matrix for some rows.
#[derive(Clone, Debug)]
pub struct Feedback {
    pub columns: Columns,
    /// G, what accelerations feed back at once.
    pub direct: Vec<Vec<Ball>>,
}

/// One row in coordinates of the poles.
struct Column {
    b: Vec<Complex<Ball>>,
    w: Vec<Complex<Ball>>,
    /// A bound of the length of what the true w has besides.
    beside: f64,
    /// The row after one power of D, and that of the true row besides.
    velocity: Vec<Complex<Ball>>,
    beside_velocity: f64,
    of_mass: Ball,
}

impl Feedback {
    /// For factors of the sign of `direction`. `None` where the poles are no coordinates of the motion.
    pub fn of(system: &LinearSystem, rows: &[WeighedRow], direction: f64) -> Option<Feedback> {
        let first = system.coordinates.first()?;
        let input = |row: &WeighedRow| {
            let force = row.entries.iter().map(|(at, a)| (CoordinateId(*at as u32), Number::Ball(*a))).collect();
            Input { name: first.name, span: first.span, unit: "N", b: [force, Vec::new(), Vec::new()], undamped: None }
        };
        let inputs = rows.iter().map(input).collect();
        let driven = LinearSystem { inputs, outputs: Vec::new(), initial: Vec::new(), ..system.clone() };
        let of = pole_coordinates(&driven, &all_modes(&driven).ok()?)?;
        let tau = of.coupling;
        let is_real = |j: usize| of.pairs[j].is_real();
        let length = |list: &[Complex<Ball>], part: fn(Complex<Ball>) -> f64| {
            let square = |(j, z): (usize, &Complex<Ball>)| part(*z).power(2) * if is_real(j) { 1.0 } else { 2.0 };
            list.iter().enumerate().map(square).sum::<f64>().sqrt() * UP
        };
        let fastest = of.pairs.iter().map(|pair| pair.s.to_ball().magnitude()).fold(0.0, f64::max);
        let weighs_masses = rows.iter().any(|row| !row.slopes[2].is_zero());
        // What is known of the inverse for several rows takes M to be positive.
        let is_sum = system.m.terms().all(|term| term.weight.is_positive() || term.weight.is_zero());
        if weighs_masses && rows.len() > 1 && !is_sum {
            return None;
        }
        let column = |(row, input): (&WeighedRow, &[Option<Vec<Complex<Ball>>>; 3])| {
            let b = input[0].clone()?;
            // v (D - T)^power instead of v, from the left, and what T adds to it.
            let seen = of.sees(&row.entries);
            let mut v: Vec<Complex<Ball>> = seen.iter().zip(&of.scale).map(|(z, g)| z.scale(Ball::from(*g))).collect();
            let (mut w, mut beside, mut beside_v): (Option<Vec<Complex<Ball>>>, f64, f64) = (None, 0.0, 0.0);
            let (mut velocity, mut beside_velocity) = (Vec::new(), 0.0);
            let power = row.slopes.iter().rposition(|slope| !slope.is_zero())?;
            for at in 0..=power.max(usize::from(weighs_masses)) {
                if at > 0 {
                    let before = length(&v, Complex::<Ball>::magnitude);
                    v.iter_mut().zip(&of.pairs).for_each(|(v, pair)| *v = *v * pair.s.to_ball());
                    // What T does to the exact vector of the power before, and to what that one has besides.
                    beside_v = (beside_v * (fastest + tau) + before * tau) * UP;
                }
                if at == 1 {
                    (velocity, beside_velocity) = (v.clone(), beside_v);
                }
                let slope = row.slopes[at];
                // Without the rounding of a product with one.
                let is_one = slope == Ball::ONE;
                if !slope.is_zero() {
                    let scaled = v.iter().map(|z| if is_one { *z } else { z.scale(slope) });
                    w = Some(match w {
                        None => scaled.collect(),
                        Some(sum) => sum.iter().zip(scaled).map(|(a, b)| *a + b).collect(),
                    });
                    beside += if is_one { beside_v } else { beside_v * slope.magnitude() * UP };
                }
            }
            Some(Column { b, w: w?, beside, velocity, beside_velocity, of_mass: row.slopes[2] })
        };
        let mut list = rows.iter().zip(&of.inputs).map(column).collect::<Option<Vec<Column>>>()?;
        // An acceleration follows a force at once, a velocity and a displacement do not: v . b = 0 exactly.
        let at_once = |of_row: &Column, to: &Column| {
            let both = |(j, (v, b)): (usize, (&Complex<Ball>, &Complex<Ball>))| {
                let product = (*v * *b).re;
                if is_real(j) { product } else { product * Ball::from(2.0) }
            };
            let sum = of_row.velocity.iter().zip(&to.b).enumerate().map(both).fold(Ball::ZERO, |sum, x| sum + x);
            sum.widen(of_row.beside_velocity * length(&to.b, Complex::<Ball>::magnitude) * UP)
        };
        let mut direct = vec![vec![Ball::ZERO; rows.len()]; rows.len()];
        let mut felt = vec![0.0; rows.len()];
        for (i, row) in list.iter().enumerate().filter(|_| weighs_masses) {
            for (k, other) in list.iter().enumerate() {
                let own = at_once(row, other);
                if i == k {
                    felt[i] = own.magnitude();
                }
                let slope = row.of_mass;
                direct[i][k] = if slope == Ball::ONE { own } else { own * slope };
            }
        }
        // b and w of a row alike in size: what one is multiplied by the other is divided by, which changes no eigenvalue.
        let mut scale = vec![1.0; rows.len()];
        for (column, scale) in list.iter_mut().zip(&mut scale).filter(|_| rows.len() > 1) {
            let size = |list: &[Complex<Ball>]| length(list, Complex::<Ball>::magnitude);
            *scale = power_of_two_below((size(&column.b) / size(&column.w)).sqrt());
            let exactly = |list: &mut Vec<Complex<Ball>>, by: f64| {
                let scaled = |x: Ball| Ball::new(x.mid.scale(by), x.rad * by);
                list.iter_mut().for_each(|z| *z = Complex::new(scaled(z.re), scaled(z.im)));
            };
            exactly(&mut column.b, 1.0 / *scale);
            exactly(&mut column.w, *scale);
            column.beside *= *scale;
        }
        for (row, own) in direct.iter_mut().zip(&scale) {
            row.iter_mut().zip(&scale).for_each(|(g, other)| {
                *g = Ball::new(g.mid.scale(own / other), g.rad * (own / other));
            });
        }
        let all = |part: &dyn Fn(&Column) -> f64| list.iter().map(|column| part(column).power(2)).sum::<f64>();
        let whole =
            |part: &dyn Fn(&Column) -> f64| if list.len() == 1 { part(&list[0]) } else { all(part).sqrt() * UP };
        let sizes = [
            whole(&|column| length(&column.b, Complex::<Ball>::magnitude)),
            whole(&|column| length(&column.w, Complex::<Ball>::magnitude)),
        ];
        let doubts = [
            whole(&|column| length(&column.b, Complex::<Ball>::radius)),
            whole(&|column| length(&column.w, Complex::<Ball>::radius) + column.beside),
        ];
        let once = (doubts[0] * sizes[1] + sizes[0] * doubts[1]) * UP;
        let radii = direct.iter().flatten().map(|g| g.rad * g.rad).sum::<f64>().sqrt() * UP;
        // See docs/method/studies.md#a-few-weights-and-all-poles.
        let masses = || list.iter().map(|column| column.of_mass).zip(felt.iter().zip(&scale));
        let [by_masses, by_rows] = [
            masses().map(|(slope, (g, scale))| (slope.magnitude() * scale).power(2) * g).sum::<f64>(),
            masses().map(|(_, (g, scale))| g / (scale * scale)).sum::<f64>(),
        ];
        let growth = (by_masses * by_rows).sqrt() * UP * UP;
        let grows = |slope: Ball| slope.is_zero() || (slope * Ball::from(direction)).is_positive();
        let falling = masses().filter(|(slope, _)| !grows(*slope));
        let fall = falling.map(|(slope, (g, _))| slope.magnitude() * g).sum::<f64>() * UP;
        let off = Off {
            always: tau,
            once,
            twice: radii * sizes[0] * sizes[1] * UP,
            growth: if fall > 0.0 { 2.0 * growth } else { growth },
            reach: if fall > 0.0 { 0.499 / fall } else { f64::INFINITY },
            direct: radii,
        };
        let mids = |list: &[Complex<Ball>]| list.iter().map(|z| z.mid()).collect::<Vec<Complex<Dd>>>();
        let columns = Columns {
            poles: of.pairs.iter().map(|pair| pair.s).collect(),
            b: list.iter().map(|column| mids(&column.b)).collect(),
            w: list.iter().map(|column| mids(&column.w)).collect(),
            direct: direct.iter().map(|row| row.iter().map(|g| g.mid).collect()).collect(),
            off,
        };
        Some(Feedback { columns, direct })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::system::Nature;

    fn chain() -> LinearSystem {
        let mut system = blank(4);
        for (i, k) in ["3.1", "1.7", "2.3", "0.9"].into_iter().enumerate() {
            push(&mut system.m, "1.25", i, None);
            push(&mut system.k, k, i, i.checked_sub(1));
        }
        push(&mut system.c, "0.37", 1, None);
        system
    }

    fn row(entries: &[(usize, f64)], slopes: [f64; 3]) -> WeighedRow {
        let entries = entries.iter().map(|(i, a)| (*i, Ball::from(*a))).collect();
        WeighedRow { entries, slopes: slopes.map(Ball::from) }
    }

    /// What an acceleration feeds back is a . M^-1 a times the slope, and the bound of (1 + t G)^-1 holds with masses that grow, one by far,
    /// and with masses that fall, up to half of what would use one up.
    #[test]
    fn what_is_fed_back_at_once_and_its_inverse_are_bounded() {
        let mut largest = 0.0f64;
        for (direction, slopes) in [(1.0, [2.0, 0.5]), (1.0, [400.0, 0.5]), (-1.0, [2.0, 0.5]), (1.0, [-0.125, 0.5])] {
            let rows = [row(&[(0, 1.0)], [1.0, 0.0, slopes[0]]), row(&[(0, -1.0), (1, 8.0)], [0.0, 0.25, slopes[1]])];
            let Feedback { columns, direct } = Feedback::of(&chain(), &rows, direction).expect("coordinates");
            let g = [[0.8, -0.8], [-0.8, 52.0]];
            let known = |i: usize, k: usize| direct[i][k].to_f64();
            for i in 0..2 {
                assert!((known(i, i) - slopes[i] * g[i][i]).abs() < 1e-13 * known(i, i).abs());
            }
            let product = slopes[0] * slopes[1] * g[0][1] * g[1][0];
            assert!((known(0, 1) * known(1, 0) - product).abs() < 1e-13 * product.abs());
            // Masses that fall: those of both rows, or the first.
            let fall = [0, 1].map(|i| (-direction * slopes[i] * g[i][i]).max(0.0)).iter().sum::<f64>();
            assert_eq!(fall > 0.0, columns.off.reach.is_finite());
            assert!(fall == 0.0 || (columns.off.reach * fall - 0.499).abs() < 1e-9);
            for share in [1e-3, 0.1, 1.0] {
                let t = direction * share * columns.off.reach.min(10.0);
                let a = [[1.0 + t * known(0, 0), t * known(0, 1)], [t * known(1, 0), 1.0 + t * known(1, 1)]];
                let determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
                let [p, q, r, s] = [a[1][1], -a[0][1], -a[1][0], a[0][0]].map(|x| x / determinant);
                // The largest singular value.
                let (sum, difference) = (p * p + q * q + r * r + s * s, 2.0 * (p * s - q * r));
                let norm = 0.5 * ((sum + difference).sqrt() + (sum - difference).max(0.0).sqrt());
                let bound = 1.0 + columns.off.growth * t.abs();
                assert!(norm <= bound, "{slopes:?} {t}: {norm} {bound}");
                largest = largest.max(norm);
            }
        }
        // Otherwise 1 would be a bound.
        assert!(largest > 1.5, "{largest}");
        // One row in K, C and M together is one column; without a mass nothing is fed back.
        let of = |slopes| Feedback::of(&chain(), &[row(&[(0, 1.0)], slopes)], 1.0).expect("coordinates").columns;
        let [all, k, c, m] = [[2.0, 3.0, 5.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 5.0]].map(of);
        for j in 0..k.poles.len() {
            let off = all.w[0][j] - (k.w[0][j] + c.w[0][j] + m.w[0][j]);
            assert!(off.to_f64().abs() < 1e-25 * all.w[0][j].to_f64().abs());
        }
        assert!(k.direct[0][0].is_zero() && (m.direct[0][0].to_f64() - 4.0).abs() < 1e-13);
        // Columns of very different rows are alike in size.
        let long =
            Feedback::of(&chain(), &[row(&[(0, 1e3)], [1e4, 0.0, 0.0]), row(&[(2, 1e-3)], [1.0, 0.0, 0.0])], 1.0);
        let long = long.expect("coordinates").columns;
        let size = |list: &[Complex<Dd>]| list.iter().map(|z| z.to_f64().abs().powi(2)).sum::<f64>().sqrt();
        assert!((0..2).all(|i| (0.2..5.0).contains(&(size(&long.b[i]) / size(&long.w[i])))));
    }

    /// A mass with a negative weight is in no sum of squares.
    #[test]
    fn the_inverse_is_not_bounded_where_masses_may_be_negative() {
        let mut system = chain();
        let source = system.m.source(system.coordinates[0].name);
        let weight = -&Number::from("0.25");
        system.m.push(source, Nature::Property, weight, [(CoordinateId(3), Number::ONE)]);
        let rows = |mass: f64| [row(&[(0, 1.0)], [1.0, 0.0, mass]), row(&[(1, 1.0)], [1.0, 0.0, 0.0])];
        assert!(Feedback::of(&system, &rows(1.0), 1.0).is_none());
        assert!(Feedback::of(&system, &rows(0.0), 1.0).is_some());
    }
}
