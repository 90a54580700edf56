//! Enclosures beside counts of negative pivots (Sylvester), of random pencils whose axes are poor approximations of their modes: of
//! masses and frequencies of all sizes, some of them close, with uncertainties of both forms that are used up in full.

use super::*;
use crate::analysis::modes::terms::Terms;
use crate::analysis::test_systems::blank;
use crate::base::{Number, Rational};
use crate::system::{CoordinateId, Form, LinearSystem, Nature};

/// SplitMix64, between 0 and 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn sign(&mut self) -> f64 {
        if self.next() < 0.5 { -1.0 } else { 1.0 }
    }
}

type Symmetric = [[f64; 3]; 3];

/// Sums of w_ij (x_i + x_j)^2 and of what is left on the diagonal.
fn form(system: &mut LinearSystem, a: &Symmetric, which: fn(&mut LinearSystem) -> &mut Form) {
    let source = {
        let name = system.coordinates[0].name;
        which(system).source(name)
    };
    let mut add = |w: f64, at: &[usize]| {
        let row = at.iter().map(|&i| (CoordinateId(i as u32), Number::ONE));
        let weight = Number::from(Rational::from_f64(w).expect("finite"));
        which(system).push(source, Nature::Property, weight, row.collect::<Vec<_>>());
    };
    for (i, row) in a.iter().enumerate() {
        let others: f64 = (0..3).filter(|&j| j != i).map(|j| row[j]).sum();
        add(row[i], &[i]);
        add(-others, &[i]);
        (0..i).for_each(|j| add(row[j], &[i, j]));
    }
}

/// The number of negative pivots of K - s M in double-double; `None` where a pivot is nearly zero.
fn count(k: &Symmetric, m: &Symmetric, s: Dd) -> Option<usize> {
    let mut a = [[Dd::ZERO; 3]; 3];
    (0..9).for_each(|e| a[e / 3][e % 3] = Dd::from(k[e / 3][e % 3]) - s * Dd::from(m[e / 3][e % 3]));
    let mut negative = 0;
    for p in 0..3 {
        let size = (0..3).map(|i| (s.hi * m[p][i]).abs() + k[p][i].abs()).fold(0.0, f64::max);
        if a[p][p].hi.abs() < 1e-20 * size {
            return None;
        }
        negative += usize::from(a[p][p].hi < 0.0);
        for i in p + 1..3 {
            let factor = a[i][p] / a[p][p];
            (p + 1..3).for_each(|j| a[i][j] -= factor * a[p][j]);
        }
    }
    Some(negative)
}

#[test]
fn enclosures_agree_with_counts_of_negative_pivots() {
    let mut random = Random(7);
    let (mut finite, mut tight) = (0, 0);
    for sample in 0..1500 {
        // Frequencies, some of them close, and masses over three decades.
        let unit = 10f64.powf(4.0 * random.next() - 2.0);
        let masses = [0, 1, 2].map(|_| 10f64.powf(3.0 * random.next() - 1.5));
        let close = [1.0, 1e-1, 1e-3, 1e-6][sample % 4];
        let lambda = [unit, unit * (1.0 + close * random.next()), unit * (1.0 + 3.0 * random.next())];
        let (mut k, mut m) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        // Couplings from what is hardly a bound to nothing, of K or of M or of both.
        let size = 10f64.powf(-4.0 * random.next()) * if sample % 8 < 4 { close } else { 1.0 };
        let (in_k, in_m) = [(1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.0, 0.0)][(sample / 4) % 4];
        for i in 0..3 {
            (m[i][i], k[i][i]) = (masses[i], masses[i] * lambda[i]);
            for j in 0..i {
                let both = (masses[i] * masses[j]).sqrt() * size;
                let (of_k, of_m) = (in_k * random.sign() * unit * both, in_m * random.sign() * both * random.next());
                (k[i][j], k[j][i], m[i][j], m[j][i]) = (of_k, of_k, of_m, of_m);
            }
        }
        let mut system = blank(3);
        form(&mut system, &k, |system| &mut system.k);
        form(&mut system, &m, |system| &mut system.m);
        // The forms themselves may be off by the squares of these rows.
        let of = |random: &mut Random, unit: f64, none: bool| -> Vec<f64> {
            let size = if none { 0.0 } else { 10f64.powf(-3.0 * random.next()) * close.sqrt() };
            masses.iter().map(|mass| (mass * unit).sqrt() * size * (0.1 + 0.2 * random.next())).collect()
        };
        let (slips_k, slips_m) = (of(&mut random, unit, sample % 3 == 0), of(&mut random, 1.0, sample % 5 < 2));
        let x = Matrix::from_fn(3, 3, |i, j| Triple::from(if i == j { 1.0 } else { 0.0 }));
        let (terms_k, terms_m) = (Terms::of(&system.k), Terms::of(&system.m));
        let found = enclose(
            &Gram::of(&terms_k, &x).with_slips(slips_k.clone()),
            &Gram::of(&terms_m, &x).with_slips(slips_m.clone()),
        );
        for signs in 0..4 {
            let (side_k, side_m) = ([1.0, -1.0][signs % 2], [1.0, -1.0][signs / 2]);
            let turns = [random.sign(), random.sign(), random.sign()];
            let moved = |a: &Symmetric, slips: &[f64], side: f64| -> Symmetric {
                std::array::from_fn(|i| {
                    std::array::from_fn(|j| a[i][j] + 0.999_999 * side * slips[i] * slips[j] * turns[i] * turns[j])
                })
            };
            let (k, m) = (moved(&k, &slips_k, side_k), moved(&m, &slips_m, side_m));
            for (i, found) in found.iter().enumerate().filter(|(_, found)| found.radius.is_finite()) {
                let middle = found.lambda.dd();
                let reach = Dd::from(found.radius + 1e-12 * middle.hi.abs());
                let (below, above) = (count(&k, &m, middle - reach), count(&k, &m, middle + reach));
                assert!(below.is_none_or(|n| n <= i), "{sample} {signs} {i}: {found:?} {below:?}");
                assert!(above.is_none_or(|n| n > i), "{sample} {signs} {i}: {found:?} {above:?}");
                // Half of the radius, in one of the cases, is not enough.
                let part = Dd::from(0.5 * found.radius);
                let inside = (count(&k, &m, middle - part), count(&k, &m, middle + part));
                tight += usize::from(matches!(inside, (Some(a), Some(b)) if a > i || b <= i));
                finite += 1;
            }
        }
    }
    assert!(finite > 9000 && tight > 900, "{finite} {tight}");
}

fn identity() -> Matrix<Triple> {
    Matrix::from_fn(3, 3, |i, j| Triple::from(if i == j { 1.0 } else { 0.0 }))
}

fn system(k: &Symmetric, m: &Symmetric) -> LinearSystem {
    let mut system = blank(3);
    form(&mut system, k, |system| &mut system.k);
    form(&mut system, m, |system| &mut system.m);
    system
}

/// Two modes of 10 and one of 11 in one group. K - s M couples the first two by 0.45 at 10, by nothing at 11, and by more below: the
/// lowest eigenvalue is less than 9.2.
#[test]
fn a_coupling_grows_over_the_width_of_its_group() {
    let (k, m) = (
        [[10.0, 4.95, 0.12625], [4.95, 10.0, 0.0], [0.12625, 0.0, 11.0]],
        [[1.0, 0.45, 0.0], [0.45, 1.0, 0.0], [0.0, 0.0, 1.0]],
    );
    let (system, x) = (system(&k, &m), identity());
    let (of_k, of_m) = (Terms::of(&system.k), Terms::of(&system.m));
    let found = enclose(&Gram::of(&of_k, &x), &Gram::of(&of_m, &x));
    assert!(found.iter().all(|one| one.radius == found[0].radius && one.radius < 10.0), "{found:?}");
    for (i, found) in found.iter().enumerate() {
        let end =
            |side: f64| count(&k, &m, found.lambda.dd() + Dd::from(side * found.radius)).expect("no pivot is zero");
        assert!(end(-1.0) <= i && end(1.0) > i, "{i}: {found:?}");
    }
}

/// A mode of 1 between whose neighbours of 11 masses of 0.6 act: what they take from K - s M at s = 1.5, 0.01 times 2 / (9.5 - 0.9), is
/// within what is said of all s as far away as 0.5.
#[test]
fn what_is_assumed_is_in_the_coupling_of_the_others() {
    let (k, m) =
        ([[1.0, 0.1, 0.1], [0.1, 11.0, 0.0], [0.1, 0.0, 11.0]], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.6], [0.0, 0.6, 1.0]]);
    let (system, x) = (system(&k, &m), identity());
    let (of_k, of_m) = (Terms::of(&system.k), Terms::of(&system.m));
    let (of_k, of_m) = (Gram::of(&of_k, &x), Gram::of(&of_m, &x));
    let radius = Pencil::new(&of_k, &of_m).radius_assuming(0, 1, (0.0, 0.0), 0.5);
    let truth = 0.01 * 2.0 / (9.5 - 0.9);
    assert!((truth..1.1 * truth).contains(&radius), "{radius} {truth}");
}

/// Two equal modes of forms that may be off by (0.01, 0.01) times itself: with one sign in K and the other one in M, the eigenvalue is
/// (1 - 2e-4) / (1 + 2e-4), or one over that.
#[test]
fn uncertainties_of_both_forms_add_up_within_a_group() {
    let (k, m) =
        ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 9.0]], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let system = system(&k, &m);
    let (of_k, of_m) = (Terms::of(&system.k), Terms::of(&system.m));
    let (x, slips) = (identity(), vec![0.01, 0.01, 0.0]);
    let found = enclose(&Gram::of(&of_k, &x).with_slips(slips.clone()), &Gram::of(&of_m, &x).with_slips(slips));
    let truth = (1.0 - 2e-4) / (1.0 + 2e-4);
    for (found, truth) in found.iter().zip([truth, 1.0 / truth, 9.0]) {
        assert!((found.lambda.hi() - truth).abs() <= found.radius && found.radius < 1e-3, "{truth}: {found:?}");
    }
}

/// K and M that may be off by 0.01 beside the diagonals 1 and 2: by 0.03 at 2, within one of 1.
#[test]
fn uncertainty_of_a_coupling_grows_with_the_distance() {
    let (k, m) =
        ([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 9.0]], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let system = system(&k, &m);
    let (of_k, of_m) = (Terms::of(&system.k), Terms::of(&system.m));
    let (x, slips) = (identity(), vec![0.1, 0.1, 0.0]);
    let (of_k, of_m) = (Gram::of(&of_k, &x).with_slips(slips.clone()), Gram::of(&of_m, &x).with_slips(slips));
    let pencil = Pencil::new(&of_k, &of_m);
    for span in [0.0, 1.0, 3.0] {
        let truth = 0.01 + 0.01 * (1.0 + span);
        for found in [pencil.coupling(0, 1, span), pencil.close_coupling(0, 1, span)] {
            assert!((truth..1.001 * truth).contains(&found), "{span}: {found} {truth}");
        }
    }
}
