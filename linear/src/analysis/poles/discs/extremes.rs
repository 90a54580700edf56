//! Bounds of the proof by themselves, each beside the matrices that reach it: B whose parts off the diagonal are all as large as
//! they may be, T whose entries are, and discs that just meet.

use super::*;
use crate::analysis::modes;
use crate::analysis::modes::parts::Part;
use crate::analysis::poles::companion::Basis;
use crate::analysis::poles::refinement::refine;
use crate::analysis::test_systems::{blank, push};

fn near(value: f64, error: f64) -> Bounded {
    Bounded { value: Complex::real(value), error, size: (value.abs() + error) * UP }
}

fn table(rows: [[f64; 3]; 3]) -> Table {
    let mut table = Table::new(3);
    (0..9).for_each(|k| table.set(k / 3, k % 3, rows[k / 3][k % 3]));
    table
}

/// A conjugate pair and a real pole.
fn columns(centres: [Complex<f64>; 3]) -> Columns {
    Columns {
        list: Vec::new(),
        rigid: Vec::new(),
        of_pair: vec![(0, 1), (2, 2)],
        factors: vec![Complex::real(1.0); 2],
        mirror: vec![1, 0, 2],
        centres: centres.map(|s| Complex::new(Dd::from(s.re), Dd::from(s.im)).to_ball()).to_vec(),
    }
}

const APART: [Complex<f64>; 3] =
    [Complex { re: 0.0, im: 4.0 }, Complex { re: 0.0, im: -4.0 }, Complex { re: -3.0, im: 0.0 }];

fn above(bound: f64, truth: f64) -> bool {
    truth <= bound && bound <= truth * (1.0 + 1e-7)
}

/// B = Lambda (1 - G) and R = Lambda times ones, with each row of G of sum theta: T = (1 - G)^-1 of ones, which is 1 / (1 - theta)
/// everywhere, and without its first term G (1 - G)^-1 of ones. No bound may be less, and none is more.
#[test]
fn t_is_that_of_the_worst_matrices() {
    let (theta, least) = (0.3, [2.0, 2.0, 5.0]);
    let off = table([[0.0, 0.1, 0.2], [0.1, 0.0, 0.2], [0.25, 0.05, 0.0]]);
    let b = Deviation { diagonal: least.iter().map(|&least| near(least + 0.5, 0.5)).collect(), off, theta };
    let mut r = Table::new(3);
    (0..9).for_each(|k| r.set(k / 3, k % 3, [0.7, 0.7, 0.01][k % 3] * least[k / 3]));
    let found = perturbation(&columns(APART), &b, &r).expect("finite");
    for (k, size) in [0.7, 0.7, 0.01].into_iter().enumerate() {
        let truth = size / (1.0 - theta);
        assert!((0..3).all(|i| above(found.t.at(i, k), truth)), "{k}: {:?} {truth}", found.t.column(k));
        assert!(above(found.own[k], truth - size), "{k}: {} {}", found.own[k], truth - size);
        assert!(above(found.times(&[1.0, 0.0, 0.0])[k], 0.7 / (1.0 - theta)));
    }
    assert!(above(found.largest_column(), 3.0 * 0.7 / (1.0 - theta)));
    // A column that is no number proves nothing.
    r.set(0, 2, f64::INFINITY);
    assert!(perturbation(&columns(APART), &b, &r).is_none());
}

/// T with entries of the size of its bounds moves pole k, by t_ki t_ik over the distance for all the others together, and no
/// further than the shrunk disc, at distances of more and of less than 1 rad/s.
#[test]
fn a_shrunk_disc_holds_the_pole_of_the_worst_matrix() {
    for unit in [1.0, 0.01, 100.0] {
        let centres = APART.map(|s| s.scale(unit));
        let (a, b) = (0.03 * unit, 0.07 * unit);
        // Column k moves, and row k of T leads to the others.
        for k in 0..3 {
            let mut t = Table::new(3);
            (0..3).filter(|&i| i != k).for_each(|i| {
                t.set(i, k, a);
                t.set(k, i, b);
            });
            let own = vec![0.0; 3];
            let columns = columns(centres);
            let radii: Vec<f64> = (0..3).map(|k| t.column(k).iter().sum::<f64>() * UP).collect();
            let exact = Deviation { diagonal: vec![near(1.0, 0.0); 3], off: Table::new(3), theta: 0.0 };
            let known = Certificate { columns, b: exact, t: Perturbation { t, own } };
            let radius = known.shrunk_radius(&radii, k);
            // lambda - s_k = sum t_ki t_ik / (lambda - s_i) with phases that agree at each of the two others.
            let mut moved = 0.0;
            for _ in 0..20 {
                moved = (0..3).filter(|&i| i != k).map(|i| a * b / ((centres[i] - centres[k]).abs() + moved)).sum();
            }
            assert!(moved <= radius && radius < 6.0 * moved, "{unit} {k}: {moved:e} {radius:e}");
            // What else the centre is uncertain by is added.
            let known = Certificate { t: Perturbation { own: vec![0.2 * unit; 3], ..known.t }, ..known };
            let pair = Pair { s: Complex::new(Dd::from(centres[k].re), Dd::from(centres[k].im)), ..some_pair() };
            let disc = known.isolated_disc(&radii, k, &pair, near(0.1, 0.3 * unit));
            let found = disc.s.re.rad;
            assert!(above(found, radius + 0.5 * unit), "{unit} {k}: {found:e}");
            assert!((disc.s.re.to_f64() - centres[k].re - 0.1).abs() < 1e-12 * unit.max(1.0));
        }
    }
}

/// T of the same size both ways draws two poles together by a fifth of their distance.
#[test]
fn poles_that_draw_together_are_in_their_discs() {
    let (gap, size) = (7.0, 0.4 * 7.0);
    let mut t = Table::new(2);
    t.set(0, 1, size);
    t.set(1, 0, size);
    let centres = [Complex::ZERO, Complex::new(Dd::from(gap), Dd::ZERO)].map(Complex::to_ball).to_vec();
    let columns = Columns { of_pair: vec![(0, 0), (1, 1)], mirror: vec![0, 1], centres, ..columns(APART) };
    let b = Deviation { diagonal: vec![near(1.0, 0.0); 2], off: Table::new(2), theta: 0.0 };
    let known = Certificate { columns, b, t: Perturbation { t, own: vec![0.0; 2] } };
    let moved = 0.5 * (gap - (gap * gap - 4.0 * size * size).sqrt());
    assert!((0..2).all(|k| known.shrunk_radius(&[size; 2], k) >= moved));
}

/// Discs of six tenths of the distance meet, and of four tenths do not.
#[test]
fn discs_that_meet_are_one_cluster() {
    for (part, meet) in [(0.6, true), (0.4, false)] {
        let (pencil, rigid, pairs) = row(SPRINGS[1], "0.37", true);
        let applied: Vec<_> = pairs.iter().map(|pair| pencil.apply(pair.s, &pair.x)).collect();
        let columns = Columns::of(&pencil, &rigid, &pairs, &applied);
        let r = residual_products(&columns, &pairs, &applied);
        let b = deviation(&pencil, &columns, &r).expect("regular");
        let mut t = Table::new(columns.list.len());
        let of = |p: usize| (0..pairs.len()).filter(move |&q| q != p);
        let gap = |p: usize, q: usize| columns.gap(columns.of_pair[p].0, columns.of_pair[q].0);
        let (p, q) = (0, of(0).min_by(|&a, &b| gap(0, a).total_cmp(&gap(0, b))).expect("four"));
        for at in [p, q].map(|p| columns.of_pair[p].0) {
            t.set(at, at, part * gap(p, q));
        }
        let own = vec![0.0; t.n];
        let found = gershgorin(&Certificate { columns, b, t: Perturbation { t, own } }, &pairs, &applied);
        assert_eq!(found[p].clusters[0].is_some(), meet);
        assert_eq!(found[p].clusters[0], found[q].clusters[0]);
        assert!(of(p).filter(|&other| other != q).all(|other| found[other].clusters[0].is_none()));
    }
}

/// -R / B is off by most where R is as large, and B as small, as they may be.
#[test]
fn a_step_is_that_of_the_worst_quotient() {
    let b = Deviation { diagonal: vec![near(2.0, 0.1), near(0.5, 0.1)], off: Table::new(2), theta: 0.0 };
    let t = Perturbation { t: Table::new(2), own: vec![0.0; 2] };
    let known = Certificate { columns: columns(APART), b, t };
    let energy = Complex::new(
        Precise { value: Triple::from(3.0), radius: 0.2 },
        Precise { value: Triple::from(0.0), radius: 0.0 },
    );
    for (k, b, factor) in [(0, 2.0, 1.0), (1, 0.5, 1.0), (0, 2.0, 1.5), (1, 0.5, 0.25)] {
        let step = known.rayleigh_step(k, Complex::real(factor), energy);
        let [value, largest] = [3.0 / b, 3.2 / (b - 0.1)].map(|x| x * factor * factor);
        assert!((step.value.re + value).abs() < 1e-12, "{k}");
        assert!(above(step.error * (1.0 + 1e-12), largest - value), "{k}: {} {}", step.error, largest - value);
        assert!(above(step.size * (1.0 + 1e-12), largest), "{k}: {}", step.size);
    }
}

/// A circle about one centre that holds all discs of its cluster, and none of another.
#[test]
fn a_union_reaches_the_far_side_of_each_disc() {
    let centres: Vec<Complex<Ball>> =
        [(0.0, 0.0), (3.0, 4.0), (-1.0, 0.5), (90.0, 0.0)].map(|(re, im)| Complex::new(re.into(), im.into())).to_vec();
    let clusters = [Some(0), Some(0), Some(0), Some(3)];
    let radii = [0.5, 0.25, 7.0, 1.0];
    for k in 0..3 {
        let far = (0..3).map(|i| (centres[i] - centres[k]).to_f64().abs() + radii[i]).fold(0.0, f64::max);
        assert!(above(union_radius(&clusters, Some(0), &radii, &centres, k) * (1.0 + 1e-12), far), "{k}");
    }
    assert!(above(union_radius(&clusters, Some(3), &radii, &centres, 3), 1.0));
}

/// Discs that touch through others are one cluster, in whatever order that is seen; the first columns belong to none.
#[test]
fn clusters_are_what_is_joined() {
    let of = |first: usize, joined: &[(usize, usize)]| clusters(first, 6, |i, k| joined.contains(&(i, k)));
    let same = |list: &[Option<u32>], of: &[usize]| of.iter().all(|&i| list[i].is_some() && list[i] == list[of[0]]);
    let list = of(0, &[(0, 1), (2, 3), (1, 3)]);
    assert!(same(&list, &[0, 1, 2, 3]) && list[4].is_none() && list[5].is_none(), "{list:?}");
    let list = of(0, &[(1, 5), (2, 4)]);
    assert!(same(&list, &[1, 5]) && same(&list, &[2, 4]) && list[1] != list[2] && list[0].is_none(), "{list:?}");
    let list = of(2, &[(0, 3), (1, 2), (3, 5)]);
    assert!(same(&list, &[3, 5]) && list[..3].iter().all(Option::is_none), "{list:?}");
}

fn some_pair() -> Pair {
    row(SPRINGS[1], "0.37", true).2.swap_remove(0)
}

/// Poles are apart by some hundredths of 1 rad/s, by 1 or so, by 100 or so.
const SPRINGS: [[&str; 4]; 3] =
    [["0.00031", "0.00017", "0.00023", "0.00009"], ["3.1", "1.7", "2.3", "0.9"], ["31000", "17000", "23000", "9000"]];

/// Four masses in a row with one damper; held, or not.
fn row(springs: [&str; 4], c: &str, held: bool) -> (Pencil<Precise>, RigidMotions, Vec<Pair>) {
    let mut system = blank(4);
    for (i, k) in springs.into_iter().enumerate() {
        push(&mut system.m, "1.3", i, None);
        if held || i > 0 {
            push(&mut system.k, k, i, i.checked_sub(1));
        }
    }
    push(&mut system.c, c, 2, Some(1));
    let rigid = crate::analysis::poles::rigid::rigid_motions(&system);
    let pencil = Pencil::of(&system, &Part::whole(&system), &[0, 1, 2, 3]);
    let working = pencil.to_dd();
    let basis = Basis::of(&working, &modes(&system).expect("modes"), &rigid);
    let starts = basis.spectrum().values();
    let pairs = (0..).zip(&starts).map(|(seed, &start)| refine(&working, &basis, start, seed).expect("a pole"));
    (pencil, rigid, pairs.collect())
}

/// Entries of B by their definition, from the terms, beside the bounds that follow from the residuals: of vectors that are off,
/// of poles that are a hundredth of 1 rad/s apart and of some that are a hundred, and beside rigid motions.
#[test]
fn b_is_within_what_the_residuals_say() {
    let mut closest = [0.0f64; 2];
    for (springs, c) in SPRINGS.into_iter().zip(["0.0037", "0.37", "37"]) {
        for held in [true, false] {
            let (pencil, rigid, mut pairs) = row(springs, c, held);
            for (at, pair) in pairs.iter_mut().enumerate() {
                let off = |i: usize| 1e-5 * [0.2, -0.4, 0.1, 0.3][(i + at) % 4];
                (0..4).for_each(|i| pair.x.add(i, Complex::new(off(i), 0.7 * off(i + 1))));
            }
            let applied: Vec<_> = pairs.iter().map(|pair| pencil.apply(pair.s, &pair.x)).collect();
            let columns = Columns::of(&pencil, &rigid, &pairs, &applied);
            let r = residual_products(&columns, &pairs, &applied);
            for (p, applied) in applied.iter().enumerate() {
                let (own, factor) = (applied.energy.to_f64().abs(), columns.factors[p].abs());
                let bound = r.at(columns.of_pair[p].0, columns.of_pair[p].0);
                assert!(own * factor * factor <= bound * (1.0 + 1e-12), "{c} {held} {p}: {bound:e}");
            }
            let b = deviation(&pencil, &columns, &r).expect("regular");
            let n = columns.list.len();
            assert_eq!((n, columns.rigid.len()), if held { (8, 0) } else { (8, 2) });
            let mut sums = vec![0.0; n];
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|(i, j)| i != j) {
                let [entry, own] = [j, i].map(|j| columns.list[i].product(&columns.list[j], &pencil));
                let (truth, bound) = (entry.value.abs() - entry.error, b.off.at(i, j));
                assert!(truth / own.size <= bound, "{c} {held} {i} {j}: {truth:e} {bound:e}");
                let which = usize::from(i < columns.rigid.len());
                closest[which] = closest[which].max(truth / own.size / bound);
                sums[i] += truth / own.size;
            }
            assert!(b.theta >= sums.iter().copied().fold(0.0, f64::max), "{c} {held}");
        }
    }
    assert!(closest[0] > 0.3 && closest[1] > 0.3, "{closest:?}");
}
