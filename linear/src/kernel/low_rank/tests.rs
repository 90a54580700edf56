//! Determinants of matrices of integers, and permanents of their sizes; two eigenvalues in one disc.

use super::*;
use crate::kernel::real::Scalar;

/// A matrix times its adjugate is its determinant times 1, and a permanent of sizes has the same products without signs.
fn check<const R: usize>(matrix: [[[f64; 2]; R]; R]) {
    let of = cofactors(&matrix);
    let whole = row_product(&matrix[0], &of[0]);
    for (i, row) in matrix.iter().enumerate() {
        for (k, cofactors) in of.iter().enumerate() {
            let expected = if i == k { whole } else { [0.0; 2] };
            assert_eq!(row_product(row, cofactors), expected, "{R}: {i} {k}");
        }
    }
    assert_ne!(whole, [0.0; 2]);
    // All ones: as many products as permutations, of R and of R - 1.
    let ones = permanents(&[[1.0f64; R]; R]);
    let factorial = |n: usize| (1..=n).product::<usize>() as f64;
    assert_eq!((ones.whole, ones.cofactors[R - 1][0].0), (factorial(R), factorial(R - 1)));
    assert_eq!(ones.length, R as f64 * factorial(R - 1));
    // With one entry alone beside the diagonal there are two.
    let mut mixed = [[0.0f64; R]; R];
    (0..R).for_each(|i| mixed[i][i] = 2.0);
    (mixed[0][R - 1], mixed[R - 1][0]) = (3.0, 5.0);
    assert_eq!(permanents(&mixed).whole, (4.0 + 15.0) * 2f64.powi(R as i32 - 2));
}

#[test]
fn cofactors_make_the_inverse() {
    check([[[2.0, 1.0], [3.0, -1.0]], [[-1.0, 4.0], [5.0, 2.0]]]);
    check([
        [[2.0, 1.0], [3.0, -1.0], [1.0, 1.0]],
        [[-1.0, 4.0], [5.0, 2.0], [0.0, 3.0]],
        [[7.0, 0.0], [1.0, -2.0], [2.0, 2.0]],
    ]);
    check([
        [[2.0, 1.0], [3.0, -1.0], [1.0, 1.0], [0.0, -2.0]],
        [[-1.0, 4.0], [5.0, 2.0], [0.0, 3.0], [1.0, 6.0]],
        [[7.0, 0.0], [1.0, -2.0], [2.0, 2.0], [3.0, 3.0]],
        [[1.0, 1.0], [4.0, 0.0], [-2.0, 5.0], [6.0, -1.0]],
    ]);
}

/// [-2 delta; delta -2] from the poles -1 and -3, with the eigenvalues -2 - delta and -2 + delta: a disc about one of them that reaches the
/// other one proves nothing, though the slope of F is known well, and the disc is small beside the distance of the poles.
#[test]
fn a_disc_that_may_hold_two_eigenvalues_proves_nothing() {
    let delta = 1e-3;
    let real = |x: f64| Complex::real(Dd::from(x));
    let columns = Columns {
        poles: vec![real(-1.0), real(-3.0)],
        b: vec![vec![real(1.0), real(0.0)], vec![real(0.0), real(1.0)]],
        w: vec![vec![real(1.0), real(-delta)], vec![real(-delta), real(-1.0)]],
        direct: vec![vec![Dd::ZERO; 2]; 2],
        off: Off { reach: f64::INFINITY, ..Off::default() },
    };
    let of = LowRank::<2>::new(&columns, 0.5).expect("usual sizes");
    let root = &of.stretches[0].roots[0];
    let from = root.differences(of.equation.poles());
    let start = [-2.0 + delta - root.origin.re.to_f64(), 0.0];
    let found =
        |noise: f64| of.equation.moving(&from, root, start, &Cases { rho: 1.0, noise, eta: 0.0 }, &mut Vec::new());
    let [alone, both] = [1e-14, 4e-7].map(found);
    assert!(alone.is_proved == 1.0 && alone.radius < delta);
    assert!(both.is_proved == 0.0 && both.radius > 2.0 * delta && both.radius < 0.008);
}

/// Real poles with two columns, b and w by pole, nothing besides.
fn two_columns(poles: &[f64], b: &[[f64; 2]], w: &[[f64; 2]]) -> LowRank<2> {
    let real = |x: f64| Complex::real(Dd::from(x));
    let columns = |of: &[[f64; 2]]| [0, 1].map(|i| of.iter().map(|row| real(row[i])).collect()).to_vec();
    let columns = Columns {
        poles: poles.iter().map(|&x| real(x)).collect(),
        b: columns(b),
        w: columns(w),
        direct: vec![vec![Dd::ZERO; 2]; 2],
        off: Off { reach: f64::INFINITY, ..Off::default() },
    };
    LowRank::<2>::new(&columns, 1.0).expect("usual sizes")
}

/// The eigenvalue that begins at a pole, followed from it by some other columns: where it is looked for is no part of the proof.
fn root_at(poles: &[f64], pole: usize) -> Root {
    let little = [[1e-3, 0.0], [0.0, 1e-3], [1e-3, 1e-3]];
    let of = two_columns(poles, &little[..poles.len()], &little[..poles.len()]);
    of.stretches[0].roots.iter().find(|root| root.pole == pole).expect("one for each pole").clone()
}

/// An eigenvalue beside which the adjugate of H is large: without it the bound of what the matrix has besides would be a seventieth. What
/// the matrix has besides, at its worst, moves it within its disc.
#[test]
fn the_worst_of_what_is_besides_moves_an_eigenvalue_within_its_disc() {
    let poles = [-1.75, -3.25, -3.3125];
    let b = [[0.125, 1.0], [-6.0, 1.0], [0.125, 13.0]];
    let w = [[0.125, 5.5], [13.0, 1.5], [-0.0625, 0.75]];
    let of = two_columns(&poles, &b, &w);
    // A - s, row by row, with what it has besides.
    let matrix = |s: f64, besides: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
        std::array::from_fn(|j| {
            std::array::from_fn(|l| {
                let own = if j == l { poles[j] - s } else { 0.0 };
                own - (b[j][0] * w[l][0] + b[j][1] * w[l][1]) + besides[j][l]
            })
        })
    };
    let cross = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
    };
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
    // An eigenvalue near s, by Newton's method with the sum of the principal minors for a slope.
    let eigenvalue = |mut s: f64, besides: [[f64; 3]; 3]| {
        for _ in 0..30 {
            let m = matrix(s, besides);
            let minors: f64 = (0..3).map(|i| cross(m[(i + 1) % 3], m[(i + 2) % 3])[i]).sum();
            s += dot(m[0], cross(m[1], m[2])) / minors;
        }
        s
    };
    let root = root_at(&poles, 0);
    let from = root.differences(of.equation.poles());
    let s = eigenvalue(-2.27, [[0.0; 3]; 3]);
    for eta in [1e-9, 1e-7, 1e-5] {
        let start = [s - root.origin.re.to_f64(), 0.0];
        let cases = Cases { rho: 1.0, noise: of.equation.rounding(), eta };
        let found = of.equation.moving(&from, &root, start, &cases, &mut Vec::new());
        assert_eq!(found.is_proved, 1.0, "{found:?}");
        // The worst of this norm is the product of the vectors that A - s takes to nothing, from the left and from the right.
        let rows = matrix(s, [[0.0; 3]; 3]);
        let columns: [[f64; 3]; 3] = std::array::from_fn(|i| rows.map(|row| row[i]));
        let [x, y] = [rows, columns].map(|of| {
            let x = cross(of[0], of[1]);
            x.map(|part| part / dot(x, x).sqrt())
        });
        for sign in [1.0, -1.0] {
            let worst: [[f64; 3]; 3] = y.map(|y| x.map(|x| sign * eta * y * x));
            let moved = (eigenvalue(s, worst) - s).abs();
            assert!(moved > 4.0 * eta, "{eta:e} {moved:e}");
            assert!(moved <= found.radius && moved > 0.2 * found.radius, "{eta:e}: {moved:e} {found:?}");
        }
    }
}

/// A pole that the columns move by 1e-15 of its size, more than its roundings: the disc about it reaches as far.
#[test]
fn what_moves_a_pole_that_stays_is_in_its_disc() {
    for (b, w) in [(1e-8, 1e-8), (1e-3, -1e-13), (1e-13, 1e-3)] {
        let (poles, rows) = ([-1.0, -3.0], ([[b, 0.5 * b], [1.0, 0.25]], [[w, 2.0 * w], [0.5, 0.75]]));
        let of = two_columns(&poles, &rows.0, &rows.1);
        let mut root = root_at(&poles, 0);
        root.stays = true;
        let from = root.differences(of.equation.poles());
        let cases = Cases { rho: 1.0, noise: of.equation.rounding(), eta: 0.0 };
        let found = of.equation.staying(&from, &root, &cases, &mut Vec::new());
        assert_eq!(found.is_proved, 1.0, "{found:?}");
        // (-1 - s - p) (-3 - s - q) = r t, with s = -1 + moved: moved = -p + ..
        let product = |j: usize, l: usize| rows.0[j][0] * rows.1[l][0] + rows.0[j][1] * rows.1[l][1];
        let other = -2.0 - product(1, 1);
        let moved = -product(0, 0) - product(0, 1) * product(1, 0) / other;
        assert!(moved.abs() > 1e-17, "{moved:e}");
        assert!(moved.abs() <= found.radius && moved.abs() > 0.02 * found.radius, "{moved:e} {found:?}");
    }
}

/// [-1 0; -g -a]: -1 is an eigenvalue whatever g is, and what the matrix has besides moves it by as much as g is large, or a near 1.
/// Where that is more than a few times its norm, a disc about -1 is refused.
#[test]
fn a_pole_that_stays_but_may_move_far_is_refused() {
    let mut seen = [0; 2];
    for (w, exponents) in [(0.5, -2..=8), (-2.0625, -10..=0)] {
        for exponent in exponents {
            let g = 4f64.powi(exponent);
            let of = two_columns(&[-1.0, -3.0], &[[0.0, 0.0], [1.0, 0.25]], &[[g, 0.0], [w, 0.5]]);
            let mut root = root_at(&[-1.0, -3.0], 0);
            root.stays = true;
            let from = root.differences(of.equation.poles());
            let eta = 1e-10;
            let cases = Cases { rho: 1.0, noise: of.equation.rounding(), eta };
            let found = of.equation.staying(&from, &root, &cases, &mut Vec::new());
            // [-1 eta; -g -a]: (-1 - s)(-a - s) + eta g = 0, with s = -1 + moved: moved^2 - (1 - a) moved + eta g = 0
            let a = 3.0 + w + 0.125;
            let half = 0.5 * (1.0 - a);
            let moved = (eta * g / (half - (half * half - eta * g).sqrt())).abs();
            let is_proved = found.is_proved > 0.0;
            assert!(!is_proved || moved <= found.radius, "{g}: {moved:e} {found:?}");
            seen[usize::from(is_proved)] += 1;
            // Beyond the disc nothing but the resolvent says so.
            assert!(moved <= found.radius || (found.radius < 1e-8 && !is_proved), "{g}: {moved:e} {found:?}");
        }
    }
    assert!(seen[0] > 4 && seen[1] > 4, "{seen:?}");
}

/// H = [1 h; 0 1] beside the pole -1, with a large h: [-1 0; h g, -3.5], whose pole -1 moves by h g eta / 2.5.
#[test]
fn a_large_adjugate_moves_a_pole_that_stays() {
    let (h, eta) = (64.0, 1e-10);
    let real = |x: f64| Complex::real(Dd::from(x));
    for exponent in -8..=2 {
        let g = 4f64.powi(exponent);
        let columns = Columns {
            poles: vec![real(-1.0), real(-3.0)],
            b: vec![vec![real(0.0), real(1.0)], vec![real(0.0), real(0.0)]],
            w: vec![vec![real(0.0), real(0.5)], vec![real(g), real(0.0)]],
            direct: vec![vec![Dd::ZERO, Dd::from(h)], vec![Dd::ZERO; 2]],
            off: Off { reach: f64::INFINITY, ..Off::default() },
        };
        let of = LowRank::<2>::new(&columns, 1.0).expect("usual sizes");
        let mut root = root_at(&[-1.0, -3.0], 0);
        root.stays = true;
        let from = root.differences(of.equation.poles());
        let cases = Cases { rho: 1.0, noise: of.equation.rounding(), eta };
        let found = of.equation.staying(&from, &root, &cases, &mut Vec::new());
        let moved = h * g * eta / 2.5;
        assert!(
            found.is_proved.is_nan() || found.is_proved == 0.0 || moved <= found.radius,
            "{g}: {moved:e} {found:?}"
        );
        assert!(exponent > -7 || found.is_proved == 1.0, "{g}: {found:?}");
    }
}

/// Poles off the real axis and one on it, with two columns of complex numbers.
fn complex_columns(off: Off) -> Columns {
    let of = |list: [[f64; 2]; 3]| list.map(|[re, im]| Complex::new(Dd::from(re), Dd::from(im))).to_vec();
    Columns {
        poles: of([[-0.3, 2.0], [-1.0, 0.5], [-2.0, 0.0]]),
        b: vec![of([[0.5, 0.25], [-0.75, 1.0], [0.5, 0.0]]), of([[0.125, -1.0], [0.5, 0.5], [-1.5, 0.0]])],
        w: vec![of([[1.0, -0.5], [0.25, 0.75], [1.25, 0.0]]), of([[-0.5, -0.25], [1.5, -0.125], [0.5, 0.0]])],
        direct: vec![vec![Dd::from(0.25), Dd::from(-0.125)], vec![Dd::from(0.0625), Dd::from(0.5)]],
        off,
    }
}

/// H, its slope and F' by the formulas of the module in double-double, at a number off the axis; the sizes of all sums are no less
/// than these, and no more than they need to be.
#[test]
fn sums_over_complex_poles_are_those_of_the_formula() {
    let (columns, t) = (complex_columns(Off { reach: f64::INFINITY, ..Off::default() }), 0.75);
    let of = LowRank::<2>::new(&columns, 1.0).expect("usual sizes");
    let root = of.stretches[0].roots[0].clone();
    let from = root.differences(of.equation.poles());
    let tau = [0.4375, -0.28125];
    let mut room = Vec::new();
    pass(&from, of.equation.poles().len(), tau, &mut room);
    let found = value(&of.equation, &room, t);
    let sizes = super::sizes(&of.equation, &from, &room, t);
    let s = root.origin + Complex::new(Dd::from(tau[0]), Dd::from(tau[1]));
    let (mut h, mut slope) = ([[Complex::<Dd>::ZERO; 2]; 2], [[Complex::<Dd>::ZERO; 2]; 2]);
    let (mut of_h, mut of_slope, mut squares, mut nearest) = ([[0.0; 2]; 2], [[0.0; 2]; 2], [0.0; 2], 0.0f64);
    let both = (0..3).flat_map(|j| [(j, false), (j, true)]).filter(|&(j, conj)| j < 2 || !conj);
    for (j, conj) in both {
        let side = |z: Complex<Dd>| if conj { z.conj() } else { z };
        let q = (s - side(columns.poles[j])).recip();
        let size = q.to_f64().abs();
        nearest = nearest.max(size * size);
        for i in 0..2 {
            let [b, w] = [&columns.b, &columns.w].map(|list| list[i][j].to_f64().abs());
            squares = [squares[0] + (b * size).powi(2), squares[1] + (w * size).powi(2)];
            for k in 0..2 {
                let product = side(columns.w[i][j]) * side(columns.b[k][j]);
                h[i][k] = h[i][k] + product * q;
                slope[i][k] = slope[i][k] - product * q * q;
                let parts = q.to_f64().re.abs() + q.to_f64().im.abs();
                of_h[i][k] += product.to_f64().abs() * parts;
                of_slope[i][k] += product.to_f64().abs() * size * size;
            }
        }
    }
    let near = |found: [f64; 2], truth: Complex<f64>| (Complex::new(found[0], found[1]) - truth).abs() < 1e-14;
    let is_size = |found: f64, truth: f64| (truth * (1.0 - 1e-14)..truth * (1.0 + 1e-13)).contains(&found);
    let mut whole = [[Complex::<f64>::ZERO; 2]; 2];
    for i in 0..2 {
        for k in 0..2 {
            let (one, direct) = (if i == k { 1.0 } else { 0.0 }, columns.direct[i][k].to_f64());
            whole[i][k] = (h[i][k].to_f64() + Complex::real(direct)).scale(t) + Complex::real(one);
            assert!(near(found.h[i][k], whole[i][k]), "{i} {k}: {:?}", found.h);
            assert!(near(found.slope[i][k], slope[i][k].to_f64().scale(t)), "{i} {k}: {:?}", found.slope);
            assert!(is_size(sizes.of[i][k], one + t * (direct.abs() + of_h[i][k])), "{i} {k}: {:?}", sizes.of);
            assert!(is_size(sizes.slopes[i][k], t * of_slope[i][k]), "{i} {k}: {:?}", sizes.slopes);
        }
    }
    assert!(
        is_size(sizes.squares[0], squares[0])
            && is_size(sizes.squares[1], squares[1])
            && is_size(sizes.nearest, nearest)
    );
    let slope = slope.map(|row| row.map(|z| z.to_f64().scale(t)));
    let [f, of_f, _] = determinant(&found);
    assert!(near(f, whole[0][0] * whole[1][1] - whole[0][1] * whole[1][0]));
    let rule =
        slope[0][0] * whole[1][1] + whole[0][0] * slope[1][1] - slope[0][1] * whole[1][0] - whole[0][1] * slope[1][0];
    assert!(near(of_f, rule));
    // A real eigenvalue is exactly real.
    let stretch = &of.stretches[0];
    let (real, t) = (stretch.roots.iter().find(|root| root.is_real).expect("one"), 0.75 * stretch.to);
    let cases = Cases { rho: t, noise: of.equation.rounding(), eta: 0.0 };
    let from = real.differences(of.equation.poles());
    let found = of.equation.moving(&from, real, real.start(t, stretch), &cases, &mut room);
    assert_eq!((found.tau[1], found.is_proved), (0.0, 1.0));
}

/// always + t p once + t^2 p^2 twice, with p = 1 + growth t and a percent for the inverse that is known.
#[test]
fn what_the_matrix_has_besides_grows_with_the_factor() {
    for off in
        [[1.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.0, 0.5], [0.0, 0.0, 1.0, 0.5], [2.0, 3.0, 5.0, 0.0], [2.0, 3.0, 5.0, 7.0]]
    {
        let [always, once, twice, growth] = off;
        let of =
            LowRank::<2>::new(&complex_columns(Off { always, once, twice, growth, reach: 10.0, direct: 0.0 }), 5.0);
        let of = of.expect("usual sizes");
        for t in [0.25, 1.0, 5.0, -5.0] {
            let size = f64::abs(t);
            let p = size * (1.0 + growth * size) * 1.01;
            let truth = always + p * once + p * p * twice;
            assert!((truth..1.05 * truth).contains(&of.equation.eta(t)), "{off:?} {t}");
        }
    }
}

#[test]
fn a_line_ends_where_a_bound_is_proved_no_further() {
    let end = |off: Off, end: f64| {
        let of = LowRank::<2>::new(&complex_columns(Off { always: 1e-20, ..off }), end)?;
        of.stretches.last().map(|last| last.to)
    };
    for reach in [0.03125, 0.0625, 0.125] {
        let found = [1.0, -1.0].map(|to| end(Off { reach, ..Off::default() }, to).expect("usual sizes"));
        assert!(found.iter().all(|end| (0.5 * reach..=reach).contains(&end.abs())), "{reach}: {found:?}");
    }
    // The error of G times t p, at the end of the line.
    for (to, direct, is_small) in
        [(1.0, 2.2e-4, true), (1.0, 2.6e-4, false), (0.25, 2.2e-3, true), (0.25, 2.4e-3, false)]
    {
        let found = end(Off { reach: 10.0, growth: 3.0, direct, ..Off::default() }, to);
        assert_eq!(found.is_some(), is_small, "{to} {direct:e}");
    }
}

#[test]
fn columns_of_other_numbers_or_sizes_are_refused() {
    let is_taken = |change: fn(&mut Columns)| {
        let mut columns = complex_columns(Off { reach: f64::INFINITY, ..Off::default() });
        change(&mut columns);
        LowRank::<2>::new(&columns, 1.0).is_some()
    };
    assert!(is_taken(|_| {}));
    let wrong: [fn(&mut Columns); 9] = [
        |of| of.b.push(of.b[0].clone()),
        |of| of.w.push(of.w[0].clone()),
        |of| of.direct.push(vec![Dd::ZERO; 2]),
        |of| of.direct[1].push(Dd::ZERO),
        |of| of.b[0][0] = Complex::real(Dd::from(1e60)),
        |of| of.off.growth = 1e60,
        |of| of.direct[0][0] = Dd::from(1e60),
        |of| of.poles[0] = Complex::real(Dd::from(1e60)),
        |of| of.poles[0] = Complex::real(Dd::from(1e-60)),
    ];
    for (which, change) in wrong.into_iter().enumerate() {
        assert!(!is_taken(change), "{which}");
    }
}

/// H = [1 + (1 + c) u / (s + u) + c u / (s + 3 u), g; g, 1 + ..]: both diagonal entries vanish at s = -2 u, so that two eigenvalues are near
/// it. A disc about one of them that reaches the other one proves nothing, whatever the unit u is, and however much cancels in H.
#[test]
fn a_disc_that_reaches_another_eigenvalue_proves_nothing() {
    for exponent in [-10, 0, 10] {
        for much in [0.0, 1024.0] {
            for close in [1e-3, 1e-6] {
                let unit = 2f64.powi(exponent);
                // The slopes of both entries, times the unit.
                let slopes = [1.0 + 2.0 * much, (0.75 + 2.0 * much) / 0.5625];
                let g = close * (slopes[0] * slopes[1]).sqrt();
                let real = |x: f64| Complex::real(Dd::from(x));
                let weights = [1.0 + much, much, 0.75 + much, much].map(|w| real(w * unit));
                let [one, zero] = [real(1.0), real(0.0)];
                let columns = Columns {
                    poles: [-1.0, -3.0, -1.25, -2.75].map(|x| real(x * unit)).to_vec(),
                    b: vec![vec![one, one, zero, zero], vec![zero, zero, one, one]],
                    w: vec![vec![weights[0], weights[1], zero, zero], vec![zero, zero, weights[2], weights[3]]],
                    direct: vec![vec![Dd::ZERO, Dd::from(g)], vec![Dd::from(g), Dd::ZERO]],
                    off: Off { reach: f64::INFINITY, ..Off::default() },
                };
                let of = LowRank::<2>::new(&columns, 0.5).expect("usual sizes");
                let mut root = root_at(&[-1.0, -3.0], 0);
                (root.origin, root.pole) = (columns.poles[0], 0);
                let from = root.differences(of.equation.poles());
                let (mut room, mut seen) = (Vec::new(), [0; 2]);
                // From one eigenvalue to the other.
                let of_sign = |side: f64| {
                    let cases = Cases { rho: 1.0, noise: 0.0, eta: 0.0 };
                    let (mut tau, mut room) = ([(-1.0 + side * close) * unit, 0.0], Vec::new());
                    for _ in 0..20 {
                        tau = of.equation.moving(&from, &root, tau, &cases, &mut room).tau;
                    }
                    tau
                };
                let [start, other] = [1.0, -1.0].map(of_sign);
                let between = (start[0] - other[0]).abs();
                assert!((1.9..2.1).contains(&(between / (close * unit))), "{exponent} {much} {close}: {between:e}");
                for noise in -60..-2 {
                    let cases = Cases { rho: 1.0, noise: 2f64.powi(noise), eta: 0.0 };
                    let found = of.equation.moving(&from, &root, start, &cases, &mut room);
                    let is_proved = found.is_proved > 0.0;
                    assert!(!is_proved || found.radius < between, "{exponent} {much} {close}: {noise} {found:?}");
                    seen[usize::from(is_proved)] += 1;
                }
                assert!(seen[0] > 0 && seen[1] > 0, "{exponent} {much} {close}: {seen:?}");
            }
        }
    }
}

/// A pole at -2 u that stays beside an eigenvalue at -2 u + close u, where 1 - c u / (s + 3 u) - much u / (s + u) vanishes: a disc that reaches
/// that far, or about which H may be singular within its errors, is refused.
#[test]
fn a_pole_that_stays_is_alone_in_its_disc() {
    for exponent in [-10, 0, 10] {
        for (much, close) in [(0.0, 0.5), (0.0, 1e-3), (1024.0, 0.5), (1024.0, 1e-3)] {
            let unit = 2f64.powi(exponent);
            let real = |x: f64| Complex::real(Dd::from(x));
            let c = (1.0 + much / (1.0 - close)) * (1.0 + close);
            let [one, zero] = [real(1.0), real(0.0)];
            let columns = Columns {
                poles: [-2.0, -3.0, -1.0].map(|x| real(x * unit)).to_vec(),
                b: vec![vec![zero, one, one], vec![zero; 3]],
                w: vec![vec![zero, real(-c * unit), real(-much * unit)], vec![zero; 3]],
                direct: vec![vec![Dd::ZERO; 2]; 2],
                off: Off { reach: f64::INFINITY, ..Off::default() },
            };
            let mut of = LowRank::<2>::new(&columns, 0.5).expect("usual sizes");
            let mut root = root_at(&[-1.0, -3.0], 0);
            (root.origin, root.pole, root.stays) = (columns.poles[0], 0, true);
            let from = root.differences(of.equation.poles());
            // By a term of the pole in the other column, and by what is besides.
            let mut staying = |own: f64, noise: f64, eta: f64| {
                of.equation.sizes[0][1][1] = own;
                let found = of.equation.staying(&from, &root, &Cases { rho: 1.0, noise, eta }, &mut Vec::new());
                (found.is_proved > 0.0, found.radius)
            };
            let mut seen = [0; 2];
            for much in -60..0 {
                let much = 2f64.powi(much) * unit;
                for (is_proved, radius) in [staying(much, 1e-15, 0.0), staying(0.0, 1e-15, much)] {
                    // All numbers of the proof are for so much of the distance of the nearest pole.
                    let most = unit * f64::min(close, 0.0091);
                    assert!(!is_proved || radius < most, "{exponent} {much} {close}: {radius:e}");
                    seen[usize::from(is_proved)] += 1;
                }
            }
            // 1 - c + much and the sum of these sizes, at the pole.
            let (f, size) = ((1.0 - c + much).abs(), 1.0 + c + much);
            for noise in -60..2 {
                let noise = 2f64.powi(noise);
                let (is_proved, _) = staying(0.0, noise, 1e-30 * unit);
                assert!(!is_proved || 2.0 * noise * size < f, "{exponent} {much} {close}: {noise:e}");
                seen[usize::from(is_proved)] += 1;
            }
            assert!(seen[0] > 8 && seen[1] > 8, "{exponent} {much} {close}: {seen:?}");
        }
    }
}

/// Eigenvalues of three poles with two columns, in double-double: each is in its disc, which is no more than the rounding of F.
#[test]
fn roundings_are_in_the_radius() {
    let (poles, b) = ([-1.75, -3.25, -3.3125], [[0.125, 1.0], [-6.0, 1.0], [0.125, 13.0]]);
    let mut tightest = 0.0f64;
    for turn in 0..128 {
        let w = [[0.125 + f64::from(turn) / 1024.0, 5.5], [13.0, 1.5], [-0.0625, 0.75]];
        let of = two_columns(&poles, &b, &w);
        let root = root_at(&poles, 0);
        let from = root.differences(of.equation.poles());
        // The characteristic polynomial by its values, and Newton's method on it.
        let determinant = |s: Dd| {
            let entry = |j: usize, l: usize| {
                let own = if j == l { Dd::from(poles[j]) - s } else { Dd::ZERO };
                own - Dd::from(b[j][0]) * Dd::from(w[l][0]) - Dd::from(b[j][1]) * Dd::from(w[l][1])
            };
            let minor = |a: usize, b: usize| entry(1, a) * entry(2, b) - entry(1, b) * entry(2, a);
            entry(0, 0) * minor(1, 2) - entry(0, 1) * minor(0, 2) + entry(0, 2) * minor(0, 1)
        };
        let slope = |s: Dd| (determinant(s + Dd::from(1e-9)) - determinant(s - Dd::from(1e-9))) * Dd::from(0.5e9);
        let mut truth = Dd::from(-2.27);
        for _ in 0..60 {
            truth -= determinant(truth) / slope(truth);
        }
        let start = [(truth - root.origin.re).to_f64(), 0.0];
        let cases = Cases { rho: 1.0, noise: of.equation.rounding(), eta: 0.0 };
        let found = of.equation.moving(&from, &root, start, &cases, &mut Vec::new());
        let off = (root.origin.re + Dd::from(found.tau[0]) - truth).abs().to_f64();
        assert!(found.is_proved == 1.0 && off <= found.radius && found.radius < 1e-11, "{turn}: {off:e} {found:?}");
        tightest = tightest.max(off / found.radius);
    }
    assert!(tightest > 1e-4, "{tightest:e}");
}

/// An eigenvalue so near a pole that is not its origin that differences from the origin do not say how near, but for luck.
#[test]
fn an_eigenvalue_next_to_another_pole_than_its_origin_is_refused() {
    for exponent in [-10, 0, 10] {
        let unit = 2f64.powi(exponent);
        let (poles, near) = ([-unit, -3.0 * unit], unit * 2f64.powi(-40));
        let of = two_columns(&poles, &[[0.0, 0.125], [1.0, 0.0]], &[[0.0, 0.125 * unit], [near, 0.0]]);
        for (pole, is_accurate) in [(1, true), (0, false)] {
            let mut root = root_at(&[-1.0, -3.0], 0);
            (root.origin, root.pole) = (of.equation.poles()[pole], pole);
            let from = root.differences(of.equation.poles());
            let at = -near - if pole == 0 { 2.0 * unit } else { 0.0 };
            let cases = Cases { rho: 1.0, noise: of.equation.rounding(), eta: 0.0 };
            let found = of.equation.moving(&from, &root, [at, 0.0], &cases, &mut Vec::new());
            assert_eq!(found.is_proved > 0.0, is_accurate, "{exponent} {pole}: {found:?}");
        }
    }
}

/// Real poles with R columns, b and w by pole, nothing besides.
fn few_columns<const R: usize>(poles: &[f64], b: &[[f64; R]], w: &[[f64; R]]) -> LowRank<R> {
    let real = |x: f64| Complex::real(Dd::from(x));
    let columns = |of: &[[f64; R]]| (0..R).map(|i| of.iter().map(|row| real(row[i])).collect()).collect();
    let columns = Columns {
        poles: poles.iter().map(|&x| real(x)).collect(),
        b: columns(b),
        w: columns(w),
        direct: vec![vec![Dd::ZERO; R]; R],
        off: Off { reach: f64::INFINITY, ..Off::default() },
    };
    LowRank::<R>::new(&columns, 1.0).expect("usual sizes")
}

/// A root for a proof alone, whose origin is a pole of these.
fn root_of<const R: usize>(of: &LowRank<R>, pole: usize) -> Root {
    let mut root = root_at(&[-1.0, -3.0], 0);
    (root.origin, root.pole) = (of.equation.poles()[pole], pole);
    root
}

/// At -2 between the poles -1 and -3: H = diag(1 + 1 / (s + 1), 1 + 1 / (s + 3), 1 ..), so that F = 0, F' = -2, the permanent of the sizes
/// is 4 and the poles are at the distance 1. A disc is proved as far as 4.1 2^R pi epsilon / r^2 is at most 0.009 |F'|.
#[test]
fn a_disc_is_proved_as_far_as_its_curvature_allows() {
    fn check<const R: usize>() {
        let row = |which: usize| std::array::from_fn(|i| if i == which { 1.0 } else { 0.0 });
        let of = few_columns::<R>(&[-1.0, -3.0], &[row(0), row(1)], &[row(0), row(1)]);
        let root = root_of(&of, 0);
        let from = root.differences(of.equation.poles());
        let power = f64::from(1u32 << R);
        let most = 0.009 * 2.0 / (4.1 * power * 4.0);
        // epsilon = 1.1 (R + 2) nu pi / |F'|
        let noise = most * 2.0 / (1.1 * (R as f64 + 2.0) * 4.0);
        for (share, is_proved) in [(0.01, true), (0.98, true), (1.02, false), (4.0, false), (16.0, false)] {
            let cases = Cases { rho: 1.0, noise: share * noise, eta: 0.0 };
            let found = of.equation.moving(&from, &root, [-1.0, 0.0], &cases, &mut Vec::new());
            assert_eq!(found.is_proved > 0.0, is_proved, "{R} {share}: {found:?}");
            assert!((share * most..1.001 * share * most).contains(&found.radius), "{R} {share}: {found:?}");
        }
    }
    check::<2>();
    check::<3>();
    check::<4>();
}

/// About the pole -1, on which nothing acts, beside one at -3: H = diag(1 - 1.875 / (s + 3) 2, 1, 1 ..), of determinant 1/16 with a permanent
/// of 2 - 1/16 and the distance 2. The disc has four times eta for its radius, and is refused where 2.1 2^R pi epsilon / r is more than
/// half of the determinant, or the rounding (R + 2) nu pi is.
#[test]
fn a_pole_stays_as_far_as_its_determinant_is_known() {
    fn check<const R: usize>() {
        let small = 0.0625;
        let (zero, one) = ([0.0; R], std::array::from_fn(|i| if i == 0 { 1.0 } else { 0.0 }));
        let of = few_columns::<R>(&[-1.0, -3.0], &[zero, one], &[zero, one.map(|x| (2.0 - 2.0 * small) * -x)]);
        let mut root = root_of(&of, 0);
        root.stays = true;
        let from = root.differences(of.equation.poles());
        let (whole, power) = (2.0 - small, f64::from(1u32 << R));
        let radius = 0.5 * small * 2.0 / (2.1 * power * whole);
        let rounding = 0.5 * small / ((R as f64 + 2.0) * whole);
        for (share, is_proved) in [(0.01, true), (0.98, true), (1.02, false), (2.0, false)] {
            for cases in [
                Cases { rho: 1.0, noise: 1e-16, eta: 0.25 * share * radius },
                Cases { rho: 1.0, noise: share * rounding, eta: 1e-14 },
            ] {
                let found = of.equation.staying(&from, &root, &cases, &mut Vec::new());
                assert_eq!(found.is_proved > 0.0, is_proved, "{R} {share}: {cases:?} {found:?}");
            }
        }
    }
    check::<2>();
    check::<3>();
    check::<4>();
}

/// A pole with the term q = |w b| / epsilon beside the diagonal of H = 1, which does not move it: the norm of (1.01, 1.01, q) times q / 4 has to
/// be at most 1/4.
#[test]
fn the_term_of_a_pole_that_stays_is_in_its_adjugate() {
    for (q, is_proved) in [(0.1, true), (0.63, true), (0.65, false), (0.69, false), (2.0, false)] {
        let eta = 1e-10;
        let of = few_columns::<2>(&[-1.0, -3.0], &[[1.0, 0.0], [0.0; 2]], &[[0.0, 4.0 * eta * q], [0.0; 2]]);
        let mut root = root_of(&of, 0);
        root.stays = true;
        let from = root.differences(of.equation.poles());
        let found = of.equation.staying(&from, &root, &Cases { rho: 1.0, noise: 1e-15, eta }, &mut Vec::new());
        assert!((4.0 * eta..4.001 * eta).contains(&found.radius), "{q}: {found:?}");
        assert_eq!(found.is_proved > 0.0, is_proved, "{q}: {found:?}");
        let of_q = q * (2.0 * 1.01f64.powi(2) + q * q).sqrt();
        assert_eq!(of_q <= 1.0, is_proved, "{q}: {of_q}");
    }
}
