//! Determinants of matrices of integers, and permanents of their sizes; two eigenvalues in one disc.

use super::*;

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

/// [-1 0; -g -a]: -1 is an eigenvalue whatever g is, and what the matrix has besides moves it by as much as g is large. Where that is
/// more than a few times its norm, a disc about -1 is refused.
#[test]
fn a_pole_that_stays_but_may_move_far_is_refused() {
    let mut seen = [0; 2];
    for exponent in -2..=8 {
        let g = 4f64.powi(exponent);
        let of = two_columns(&[-1.0, -3.0], &[[0.0, 0.0], [1.0, 0.25]], &[[g, 0.0], [0.5, 0.5]]);
        let mut root = root_at(&[-1.0, -3.0], 0);
        root.stays = true;
        let from = root.differences(of.equation.poles());
        let eta = 1e-10;
        let cases = Cases { rho: 1.0, noise: of.equation.rounding(), eta };
        let found = of.equation.staying(&from, &root, &cases, &mut Vec::new());
        // [-1 eta; -g -a]: (-1 - s)(-a - s) + eta g = 0, with s = -1 + moved: moved^2 - (1 - a) moved + eta g = 0
        let a = 3.0 + 0.625;
        let half = 0.5 * (1.0 - a);
        let moved = (eta * g / (half - (half * half - eta * g).sqrt())).abs();
        let is_proved = found.is_proved == 1.0;
        assert!(!is_proved || moved <= found.radius, "{g}: {moved:e} {found:?}");
        seen[usize::from(is_proved)] += 1;
        // Beyond the disc nothing but the resolvent says so.
        assert!(moved <= found.radius || (found.radius < 1e-8 && !is_proved), "{g}: {moved:e} {found:?}");
    }
    assert!(seen[0] > 2 && seen[1] > 2, "{seen:?}");
}
