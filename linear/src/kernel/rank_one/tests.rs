//! Courses that lead elsewhere than their eigenvalues.

use super::*;

fn pole(re: f64, im: f64, b: f64) -> Pole {
    let complex = |re: f64, im: f64| Complex { re: Dd::from(re), im: Dd::from(im) };
    Pole { s: complex(re, im), b: complex(b, 0.1 * b), v: complex(1.0, 0.0) }
}

/// Two pairs; what is proved of them at a factor, after the courses were changed.
fn with_courses(change: impl Fn(&mut Vec<Root>)) -> Option<Vec<Eigenvalue>> {
    let mut matrix = RankOne::new(&[pole(-0.1, 1.0, 0.2), pole(-0.2, 3.0, 0.3)], [0.0; 2], 1.0).expect("usual sizes");
    matrix.stretches.iter_mut().for_each(|stretch| change(&mut stretch.roots));
    matrix.eigenvalues(&[Factor::new(0.3, 0.0)]).remove(0)
}

/// Courses prove nothing: two that lead to one eigenvalue, or to the conjugate of one, are none of two.
#[test]
fn an_eigenvalue_that_is_found_twice_is_not_counted_twice() {
    assert!(with_courses(|_| {}).is_some());
    assert_eq!(with_courses(|roots| roots[1] = roots[0].clone()), None);
    let mirrored = |roots: &mut Vec<Root>| roots[1] = roots[0].conj();
    assert_eq!(with_courses(mirrored), None);
    // Only of one below the axis: its conjugate would be the same as itself above.
    assert_eq!(with_courses(|roots| roots[0] = roots[0].conj()), None);
}
