//! Eigenvalues of many small pencils side by side: the i-th enclosure holds the i-th eigenvalue, counted by the signs of leading minors
//! in exact arithmetic. See docs/method/studies.md#many-small-pencils.

use super::exact::{ExactPencil, binary};
use super::systems::Random;
use num_rational::BigRational;
use vibc::base::{Ball, Number};
use vibc::kernel::pencils::{Line, MOST, Plane};

type Exact = Vec<Vec<BigRational>>;

/// Sums of squares w a a^T with rows of two to four entries, over so many decades.
fn squares(random: &mut Random, n: usize, count: usize, decades: f64, signed: bool) -> Vec<Vec<Number>> {
    let mut sum = vec![vec![Number::ZERO; n]; n];
    for at in 0..count {
        let weight = random.decimal(decades);
        let weight = if signed && random.below(3) == 0 { &Number::ZERO - &weight } else { weight };
        let row: Vec<(usize, Number)> = (0..2 + random.below(3)).map(|i| ((at + i) % n, random.signed())).collect();
        for (i, a) in &row {
            for (j, b) in &row {
                sum[*i][*j] = &sum[*i][*j] + &(&weight * &(a * b));
            }
        }
    }
    sum
}

fn diagonal(random: &mut Random, n: usize, decades: f64) -> Vec<Vec<Number>> {
    let mut matrix = vec![vec![Number::ZERO; n]; n];
    (0..n).for_each(|i| matrix[i][i] = random.decimal(decades));
    matrix
}

fn plus(a: &[Vec<Number>], b: &[Vec<Number>]) -> Vec<Vec<Number>> {
    a.iter().zip(b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a + b).collect()).collect()
}

fn balls(matrix: &[Vec<Number>]) -> Vec<Vec<Ball>> {
    matrix.iter().map(|row| row.iter().map(Number::to_ball).collect()).collect()
}

/// A + d B + d^2 C + ...
fn at(parts: &[&[Vec<Number>]], d: &BigRational) -> Exact {
    let exact = |x: &Number| x.exact().expect("rational").to_big();
    let n = parts[0].len();
    let sum = |i: usize, j: usize| parts.iter().rev().fold(binary(0.0), |sum, part| sum * d + exact(&part[i][j]));
    (0..n).map(|i| (0..n).map(|j| sum(i, j)).collect()).collect()
}

/// Checks every enclosure; returns the number of pencils that have them, and the largest bound relative to the largest eigenvalue.
fn check(k: [&[Vec<Number>]; 2], m: [&[Vec<Number>]; 2], places: &[f64]) -> (usize, f64) {
    check_polynomials(&k, &m, places, 0.0)
}

/// The same for matrices of any degree, at places within `half` of the given ones.
fn check_polynomials(k: &[&[Vec<Number>]], m: &[&[Vec<Number>]], places: &[f64], half: f64) -> (usize, f64) {
    let n = k[0].len();
    let most = places.iter().fold(0.0f64, |most, d| most.max(d.abs() + half));
    let [of_k, of_m] = [k, m].map(|parts| parts.iter().map(|part| balls(part)).collect::<Vec<_>>());
    let line = Line::new(n, &of_k, &of_m, most).expect("numbers of usual size");
    let (mut found, mut widest) = (0, 0.0f64);
    let shares: &[f64] = if half == 0.0 { &[0.0] } else { &[-1.0, 0.25, 1.0] };
    for (d, eigenvalues) in places.iter().zip(line.eigenvalues(places, &vec![half; places.len()])) {
        let Some(eigenvalues) = eigenvalues else { continue };
        found += 1;
        let largest = eigenvalues.list.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        for share in shares {
            let x = binary(*d) + binary(share * half);
            let pencil = ExactPencil::new(&at(k, &x), &at(m, &x));
            for (i, (value, bound)) in eigenvalues.list.iter().zip(&eigenvalues.bounds).enumerate() {
                widest = widest.max(bound / largest);
                assert!(holds(&pencil, i, [*value, *bound]), "{i} of {n} at {d} + {share} {half}: {value} ± {bound}");
            }
        }
    }
    (found, widest)
}

/// Whether the i-th eigenvalue is within the bound of the value, by what can be counted.
fn holds(pencil: &ExactPencil, i: usize, [value, bound]: [f64; 2]) -> bool {
    let [below, above] = [-bound, bound].map(|change| pencil.below(&(binary(value) + binary(change))));
    below.is_none_or(|count| count <= i) && above.is_none_or(|count| count > i)
}

/// Matrices that are linear in three numbers of very different sizes, one of which weighs masses as well; one case has no number.
#[test]
fn matrices_linear_in_several_numbers_are_enclosed() {
    let mut random = Random::new(33);
    for n in [1, 2, 3, 5, 9, MOST] {
        let k: Vec<_> =
            (0..4).map(|at| squares(&mut random, n, if at == 0 { 2 * n } else { n }, 1.0, at != 0)).collect();
        let none = vec![vec![Number::ZERO; n]; n];
        let m = [
            plus(&diagonal(&mut random, n, 0.0), &squares(&mut random, n, n / 2, 0.0, false)),
            none,
            diagonal(&mut random, n, 0.0),
        ];
        let numbers = [
            vec![0.0, 0.1, -0.1, 0.037, 0.1, f64::NAN, 0.01, -0.09, 1e-9],
            vec![0.0, 1e-3, 2e-3, -3e-4, 1e-3, 1e-3, 0.0, 2e-3, 7e-4],
            vec![0.0, 900.0, -35.0, 1000.0, 1e-3, 5.0, 7.0, 8.0, 0.1],
        ];
        let scaled = |part: &Vec<Vec<Number>>, by: &str| -> Vec<Vec<Number>> {
            part.iter().map(|row| row.iter().map(|x| x * &Number::from(by)).collect()).collect()
        };
        let k = [k[0].clone(), k[1].clone(), scaled(&k[2], "100"), scaled(&k[3], "1e-4")];
        let m = [m[0].clone(), m[1].clone(), scaled(&m[2], "10")];
        let [of_k, of_m] = [&k[..], &m[..]].map(|parts| parts.iter().map(|part| balls(part)).collect::<Vec<_>>());
        let plane = Plane::new(n, &of_k, &of_m, &[0.1, 2e-3, 1000.0]).expect("numbers of usual size");
        let found = plane.side_by_side(&numbers);
        for case in 0..numbers[0].len() {
            if numbers[0][case].is_nan() {
                assert!((0..n).all(|i| found.pair(i, case)[0].is_nan()));
                continue;
            }
            let sum = |parts: &[Vec<Vec<Number>>]| -> Exact {
                let of = |i: usize, j: usize| {
                    let exact = |part: &Vec<Vec<Number>>| part[i][j].exact().expect("rational").to_big();
                    let first = exact(&parts[0]);
                    parts[1..].iter().zip(&numbers).fold(first, |sum, (part, of)| sum + exact(part) * binary(of[case]))
                };
                (0..n).map(|i| (0..n).map(|j| of(i, j)).collect()).collect()
            };
            let pencil = ExactPencil::new(&sum(&k), &sum(&m));
            let largest = (0..n).map(|i| found.pair(i, case)[0].abs()).fold(0.0, f64::max);
            for i in 0..n {
                let pair = found.pair(i, case);
                assert!(holds(&pencil, i, pair), "{i} of {n}, case {case}: {pair:?}");
                // As for polynomials.
                assert!(pair[1] < 1e-12 * largest, "{i} of {n}, case {case}: {pair:?}");
            }
        }
    }
}

/// Matrices of the fourth and the second degree, at single numbers and over ranges, whose bounds are then as wide as eigenvalues move.
#[test]
fn polynomials_of_matrices_are_enclosed_over_ranges() {
    let mut random = Random::new(71);
    for n in [1, 2, 3, 6, 11] {
        let k: Vec<_> = (0..5).map(|_| squares(&mut random, n, 2 * n, 1.0, true)).collect();
        let m =
            [diagonal(&mut random, n, 1.0), squares(&mut random, n, n / 3, 0.0, false), diagonal(&mut random, n, 0.0)];
        let k: Vec<&[Vec<Number>]> = k.iter().map(|part| &part[..]).collect();
        let m: Vec<&[Vec<Number>]> = m.iter().map(|part| &part[..]).collect();
        let places = [0.0, 0.01, 0.25, 0.5, 0.93];
        for (half, most) in [(0.0, 1e-12), (1e-9, 1e-5), (1e-4, 1.0)] {
            let (found, widest) = check_polynomials(&k, &m, &places, half);
            assert!(found == places.len(), "{found} of {n} coordinates");
            assert!(widest < most && widest > 0.01 * half, "{n} coordinates, {half:e}: {widest:e}");
        }
        // Ranges in which second and third derivatives count.
        for half in [0.03, 0.2] {
            check_polynomials(&k, &m, &places, half);
        }
    }
}

/// Two eigenvalues 1000 d and d of M = 1 about d = 1: what the larger one changes by does not count for the smaller one, whose enclosure is
/// the range of d.
#[test]
fn an_eigenvalue_is_as_wide_as_its_own_change() {
    let diagonal = |x: [f64; 2]| vec![vec![Ball::from(x[0]), Ball::ZERO], vec![Ball::ZERO, Ball::from(x[1])]];
    let line =
        Line::new(2, &[diagonal([0.0, 0.0]), diagonal([1.0, 1000.0])], &[diagonal([1.0, 1.0])], 1.5).expect("usual");
    let found = line.eigenvalues(&[1.0], &[0.1]).remove(0).expect("two eigenvalues");
    for (i, truth) in [1.0, 1000.0].into_iter().enumerate() {
        let (off, bound) = ((found.list[i] - truth).abs(), found.bounds[i]);
        assert!(bound >= 0.1 * truth + off && bound < 0.101 * truth, "{i}: {off:e} {bound:e}");
    }
}

/// K = d^2, K = d^3 and K = -d^4 at 1: each term of Taylor's formula counts.
#[test]
fn ranges_of_powers_are_enclosed() {
    let one = |x: f64| vec![vec![Ball::from(x)]];
    for power in 1..=4 {
        let k: Vec<_> = (0..=power).map(|at| one(if at == power { 1.0 } else { 0.0 })).collect();
        for (d, half) in [(1.0, 0.5), (0.0, 1.0), (-0.5, 0.25)] {
            let line = Line::new(1, &k, &[one(1.0)], 1.5).expect("usual");
            let found = line.eigenvalues(&[d], &[half]).remove(0).expect("an eigenvalue");
            for end in [d - half, d, d + half] {
                let truth: f64 = (0..power).map(|_| end).product();
                let off = (found.list[0] - truth).abs();
                assert!(off <= found.bounds[0], "{end}^{power}: {off} {}", found.bounds[0]);
            }
        }
    }
}

/// K = 2 + c d with c known to 0.01 alone, over all d up to 1: what c may be counts where d is largest, not in the middle.
#[test]
fn coefficients_that_are_not_known_count_over_the_whole_range() {
    let one = |x: Ball| vec![vec![x]];
    let k = [one(Ball::from(2.0)), one(Ball::from(0.0).widen(0.01))];
    let line = Line::new(1, &k, &[one(Ball::ONE)], 1.0).expect("numbers of usual size");
    for (d, half) in [(0.0, 1.0), (0.5, 0.5), (-0.25, 0.75), (1.0, 0.0)] {
        let found = line.eigenvalues(&[d], &[half]).remove(0).expect("one eigenvalue");
        let reached = (found.list[0] - 2.0).abs() + found.bounds[0];
        // A few bounds are a thousandth too large each.
        assert!((0.01..0.0103).contains(&reached), "{d} {half}: {reached:e}");
    }
}

/// K = 2 + a x + b y with a known to 0.01 and b to 0.02 alone.
#[test]
fn coefficients_of_several_numbers_that_are_not_known_count() {
    let one = |x: Ball| vec![vec![x]];
    let k = [one(Ball::from(2.0)), one(Ball::ZERO.widen(0.01)), one(Ball::ZERO.widen(0.02))];
    let plane = Plane::new(1, &k, &[one(Ball::ONE)], &[1.0, 1.0]).expect("numbers of usual size");
    let found = plane.side_by_side(&[vec![1.0, -0.5, 0.0], vec![-0.5, 1.0, 0.0]]);
    for (case, truth) in [0.02, 0.025, 0.0].into_iter().enumerate() {
        let [value, bound] = found.pair(0, case);
        let reached = (value - 2.0).abs() + bound;
        // As above.
        assert!((truth..=1.03 * truth + 1e-14).contains(&reached), "{case}: {reached:e}");
    }
}

#[test]
fn every_enclosure_holds_its_eigenvalue() {
    let mut random = Random::new(20);
    for n in 1..=MOST {
        for (decades, signed) in [(0.0, false), (3.0, true), (8.0, false)] {
            let k = squares(&mut random, n, 2 * n, decades, signed);
            let k1 = squares(&mut random, n, 1 + n / 3, decades, false);
            let m = plus(&diagonal(&mut random, n, decades.min(3.0)), &squares(&mut random, n, n / 2, 0.0, false));
            let m1 = diagonal(&mut random, n, 0.0);
            let places = [0.0, 0.01, 0.37, 1.0, 2.5, 7.0, 19.0, 100.0, 1e-9];
            let (found, widest) = check([&k, &k1], [&m, &m1], &places);
            assert!(found == places.len(), "{found} of {n} coordinates");
            // Some 10 n units of rounding, times the condition of M, whose weights are spread over 5 decades with the places.
            assert!(widest < 1e-10, "{n} coordinates, {decades} decades: {widest:e}");
        }
    }
}

/// Equal and nearly equal eigenvalues, rigid motions, and a K that is zero.
#[test]
fn repeated_eigenvalues_are_enclosed_together() {
    let n = 6;
    let unit = |value: &str| {
        let mut matrix = vec![vec![Number::ZERO; n]; n];
        (0..n).for_each(|i| matrix[i][i] = Number::from(value));
        matrix
    };
    // A ring of equal springs: eigenvalues 0, 1, 1, 3, 3, 4.
    let mut ring = vec![vec![Number::ZERO; n]; n];
    for i in 0..n {
        let j = (i + 1) % n;
        for (a, b, x) in [(i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)] {
            ring[a][b] = &ring[a][b] + &Number::from(x);
        }
    }
    let mut nearly = unit("0");
    nearly[2][2] = Number::from("1e-13");
    let zero = unit("0");
    for k in [[&ring, &nearly], [&ring, &zero], [&unit("3"), &nearly], [&zero, &zero]] {
        let (found, widest) = check(k.map(|m| &m[..]), [&unit("1"), &zero], &[0.0, 0.5, 1.0, 3.0]);
        assert_eq!(found, 4);
        assert!(widest < 1e-13 || k[0] == &zero, "{widest:e}");
    }
}

/// Where M is not positive definite, or nearly is not, there are no eigenvalues.
#[test]
fn a_mass_that_may_be_singular_has_none() {
    let matrix = |entries: [&str; 4]| {
        let [a, b, c, d] = entries.map(|text| match text.strip_prefix('-') {
            Some(size) => &Number::ZERO - &Number::from(size),
            None => Number::from(text),
        });
        vec![vec![a, b], vec![c, d]]
    };
    let k = matrix(["2", "-1", "-1", "2"]);
    let zero = matrix(["0", "0", "0", "0"]);
    for m in [["1", "1", "1", "1"], ["1", "2", "2", "1"], ["1", "1", "1", "1.0000000000000001"], ["1", "0", "0", "-1"]]
    {
        assert_eq!(check([&k, &zero], [&matrix(m), &zero], &[1.0]).0, 0, "{m:?}");
    }
    // M = diag(1, d) up to and beyond zero.
    let (m, slope) = (matrix(["1", "0", "0", "0"]), matrix(["0", "0", "0", "1"]));
    assert_eq!(check([&k, &zero], [&m, &slope], &[-1.0, 0.0, 1e-3, 1.0]).0, 2);
}
