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
