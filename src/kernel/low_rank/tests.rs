//! Determinants of matrices of integers, and permanents of their sizes.

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
