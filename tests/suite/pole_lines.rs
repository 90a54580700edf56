//! Poles of systems in which one weight changes, or a few: each enclosure holds a root of the determinant, which is computed in exact arithmetic, and
//! there are as many enclosures that do not meet as poles. See docs/method/studies.md#one-weight-and-all-poles.

use super::exact::Quadratic;
use super::sweeps::damped_net;
use super::systems::{Builder, Random, number};
use vibc::base::{Ball, Dd, Number, Rational};
use vibc::kernel::complex::Complex;
use vibc::kernel::low_rank::{Columns, LowRank, Off};
use vibc::kernel::rank_one::{Eigenvalue, Factor, Pole, RankOne};
use vibc::questions::pole_updates::PoleUpdates;
use vibc::questions::updates::{Changing, Part};
use vibc::system::{CoordinateId, Form, LinearSystem, Nature};

type Row = Vec<(usize, Number)>;

/// A system in which a weight is `change` more, exactly.
fn changed(system: &LinearSystem, part: Part, row: &Row, change: f64) -> LinearSystem {
    with_more(system, part, row, Number::from(Rational::from_f64(change).expect("finite")))
}

fn with_more(system: &LinearSystem, part: Part, row: &Row, weight: Number) -> LinearSystem {
    let mut system = system.clone();
    let name = system.coordinates[0].name;
    let form = match part {
        Part::Stiffness => &mut system.k,
        Part::Damping => &mut system.c,
        Part::Mass => &mut system.m,
    };
    let source = form.source(name);
    let entries = row.iter().map(|(i, a)| (CoordinateId(*i as u32), a.clone()));
    form.push(source, Nature::Property, weight, entries);
    system
}

fn changing(part: Part, row: &Row) -> Changing {
    Changing { part, row: row.iter().map(|(i, a)| (*i, a.to_ball())).collect(), number: 0, slope: Ball::ONE }
}

fn row_of(form: &Form, at: usize) -> (Row, f64) {
    let term = form.term(at);
    (form.row(term).iter().map(|(i, a)| (i.index(), a.clone())).collect(), term.weight.to_f64())
}

/// A weight that changes by a slope times the change of a parameter.
type Weighed = (Part, Row, f64);

fn several(list: &[Weighed]) -> Vec<Changing> {
    let number = |row: &Row| list.iter().position(|(_, other, _)| other == row).expect("one of them");
    let of = |(part, row, slope): &Weighed| Changing {
        slope: Ball::from(*slope),
        number: number(row),
        ..changing(*part, row)
    };
    list.iter().map(of).collect()
}

fn all_changed(system: &LinearSystem, list: &[Weighed], change: f64) -> LinearSystem {
    let exact = |x: f64| Number::from(Rational::from_f64(x).expect("finite"));
    let by = |system, (part, row, slope): &Weighed| with_more(&system, *part, row, &exact(change) * &exact(*slope));
    list.iter().fold(system.clone(), by)
}

/// The largest bound relative to the size of its pole. Each rectangle is as wide as the error of its middle, and no two meet.
fn check(truth: &LinearSystem, found: &[Eigenvalue], what: &str) -> f64 {
    assert_eq!(found.len(), 2 * truth.n(), "{what}: {found:?}");
    let exact = Quadratic::of(truth);
    let mut widest = 0.0f64;
    for (i, one) in found.iter().enumerate() {
        let error = exact.error(Dd::from(one.s.re), Dd::from(one.s.im));
        let bound = one.bounds[0].hypot(one.bounds[1]);
        assert!(error <= bound * 1.001, "{what}: {one:?} is {error:e} off");
        let size = one.s.re.hypot(one.s.im);
        widest = widest.max(bound / size);
        for other in &found[..i] {
            let apart = (one.s.re - other.s.re).hypot(one.s.im - other.s.im);
            assert!(apart > one.bounds[0] + other.bounds[0], "{what}: {one:?} {other:?}");
            let sizes = (size, other.s.re.hypot(other.s.im));
            assert!(sizes.0 >= sizes.1 * (1.0 - 1e-15), "{what}: in ascending order");
        }
    }
    widest
}

/// Nets over decades, damped lightly and heavily: springs and dampers that become up to a thousand times as stiff, masses that nearly
/// vanish or become fifty times as large.
#[test]
fn every_enclosure_of_a_changed_system_holds() {
    let mut random = Random::new(5);
    let (mut proved, mut all, mut widest) = ([0; 3], [0; 3], 0.0f64);
    for n in [1, 2, 3, 5, 8] {
        for (decades, level) in [(0.5, 0.0), (0.5, -1.0), (2.0, 0.0), (1.0, 1.0)] {
            let system = damped_net(&mut random, n, decades, level, false);
            for (at, part) in [Part::Stiffness, Part::Damping, Part::Mass].into_iter().enumerate() {
                let form = part.form(&system);
                if form.is_empty() {
                    continue;
                }
                let (row, weight) = row_of(form, random.below(form.terms().len()));
                let reaches = if part == Part::Mass { [-0.95, 50.0] } else { [1000.0, 1.0] };
                for reach in reaches.map(|share| share * weight) {
                    let Some(updates) = PoleUpdates::of(&system, &[changing(part, &row)], reach) else { continue };
                    let changes = [1.0, 1e-6, 0.02, 0.3].map(|share| share * reach);
                    for (change, found) in changes.iter().zip(updates.poles(&changes)) {
                        all[at] += 1;
                        let Some(found) = found else { continue };
                        let what = format!("{n} {decades} {level} {part:?} {change}");
                        widest = widest.max(check(&changed(&system, part, &row, *change), &found, &what));
                        proved[at] += 1;
                        // Alone in its lanes, a case has the same bits.
                        assert_eq!(updates.poles(&[*change])[0].as_ref(), Some(&found), "{what}");
                    }
                }
            }
        }
    }
    // What is not proved is beyond a place where poles meet, as most do while a damper becomes a thousand times as strong.
    assert!((0..3).all(|at| all[at] > 60 && 2 * proved[at] > all[at]), "{proved:?} of {all:?}");
    assert!(widest < 1e-10, "{widest:e}");
}

/// Two to four squares that one parameter weighs, of one matrix or of all, on rows of their own or on one: as far as poles do not meet,
/// each pole is enclosed.
#[test]
fn every_enclosure_of_several_changed_squares_holds() {
    let mut random = Random::new(11);
    let kinds: [&[Part]; 9] = [
        &[Part::Stiffness; 2],
        &[Part::Mass; 2],
        &[Part::Damping; 2],
        &[Part::Stiffness, Part::Mass],
        &[Part::Stiffness; 3],
        &[Part::Mass; 3],
        &[Part::Damping, Part::Mass, Part::Stiffness],
        &[Part::Mass, Part::Mass, Part::Stiffness, Part::Damping],
        &[Part::Stiffness; 4],
    ];
    let (mut proved, mut all, mut widest) = ([0; 9], [0; 9], 0.0f64);
    for n in [2, 3, 5, 8] {
        for (decades, level) in [(0.5, 0.0), (0.5, -1.0), (2.0, 0.0), (1.0, 1.0)] {
            for (at, parts) in kinds.into_iter().enumerate() {
                let system = damped_net(&mut random, n, decades, level, false);
                let mut list: Vec<Weighed> = Vec::new();
                for part in parts {
                    let form = part.form(&system);
                    if !form.is_empty() {
                        let (row, weight) = row_of(form, random.below(form.terms().len()));
                        list.push((*part, row, weight));
                    }
                }
                let falls = parts.iter().all(|part| *part == Part::Mass);
                for reach in [if falls { -0.2 } else { 0.4 }, 30.0] {
                    let Some(updates) = PoleUpdates::of(&system, &several(&list), reach) else { continue };
                    let changes = [1.0, 1e-6, 0.02, 0.3].map(|share| share * reach);
                    for (change, found) in changes.iter().zip(updates.poles(&changes)) {
                        all[at] += 1;
                        let Some(found) = found else { continue };
                        let what = format!("{n} {decades} {level} {parts:?} {change}");
                        widest = widest.max(check(&all_changed(&system, &list, *change), &found, &what));
                        proved[at] += 1;
                        assert_eq!(updates.poles(&[*change])[0].as_ref(), Some(&found), "{what}");
                    }
                }
            }
        }
    }
    assert!((0..9).all(|at| all[at] > 90 && 4 * proved[at] > 3 * all[at]), "{proved:?} of {all:?}");
    // A study takes none that is wider than 1e-10: near where poles meet they are.
    assert!(widest < 1e-7, "{widest:e}");
}

/// Oscillators in a row, coupled by springs so soft that each feels a change of the first by 1e-9 of what its neighbour feels: poles that
/// move by a few digits, by a part of the last one, and by next to nothing. All are enclosed, to the last digits.
#[test]
fn poles_that_hardly_move_are_enclosed_where_they_are() {
    let n = 6;
    let mut builder = Builder::numbered(n);
    for i in 0..n {
        builder.mass(i, &Number::ONE);
        builder.spring(None, i, &Number::from(100 + 37 * i as i64));
        builder.damper(None, i, &Number::from(1 + i as i64 % 3));
        if i > 0 {
            builder.spring(Some(i - 1), i, &number("3e-7"));
        }
    }
    let system = builder.finish();
    let row = vec![(0, Number::ONE)];
    for (part, reach) in [(Part::Stiffness, 25.0), (Part::Damping, 0.5), (Part::Mass, 0.3)] {
        let updates = PoleUpdates::of(&system, &[changing(part, &row)], reach).expect("one square");
        let changes = [1.0, 0.01].map(|share| share * reach);
        for (change, found) in changes.iter().zip(updates.poles(&changes)) {
            let found = found.unwrap_or_else(|| panic!("{part:?} {change}"));
            let widest = check(&changed(&system, part, &row, *change), &found, &format!("{part:?} {change}"));
            assert!(widest < 1e-13, "{part:?} {change}: {widest:e}");
        }
    }
    // On two rows, a spring and a mass.
    let both = [(Part::Stiffness, row, 1.0), (Part::Mass, vec![(1, Number::ONE)], 0.015625)];
    let updates = PoleUpdates::of(&system, &several(&both), 16.0).expect("two rows");
    for change in [16.0, 0.25] {
        let found = updates.poles(&[change]).remove(0).unwrap_or_else(|| panic!("{change}"));
        let widest = check(&all_changed(&system, &both, change), &found, &format!("two rows {change}"));
        assert!(widest < 1e-12, "{change}: {widest:e}");
    }
    // Two poles may be much closer to each other than the last digit: then they are not told apart.
    let twins = |apart: f64| {
        let complex = |re: f64, im: f64| Complex { re: Dd::from(re), im: Dd::from(im) };
        let pole = |s: Complex<Dd>, b: f64| Pole { s, b: complex(b, 0.0), v: complex(1.0, 0.0) };
        let close = Complex { re: Dd::from(-1.0), im: Dd::new(3.0, apart) };
        RankOne::new(&[pole(complex(-1.0, 3.0), 0.5), pole(close, 1e-60)], [1e-28, 0.0], 1e-18).expect("usual sizes")
    };
    let is_known = |apart: f64| twins(apart).eigenvalues(&[Factor::new(1e-19, 0.0)])[0].is_some();
    assert!(is_known(1e-2) && !is_known(1e-18));
}

/// Two pendulums alike, coupled: the damper between them does not act on the motion that both share, whose poles stay: then nothing is
/// claimed. Nor is it for five rows, a row over two parts, which couples them, rigid motions, or a mass that a change uses up.
#[test]
fn what_is_not_covered_is_refused() {
    let twins = |grounded: bool| {
        let mut builder = Builder::numbered(2);
        for i in 0..2 {
            builder.mass(i, &number("2"));
            if grounded {
                builder.spring(None, i, &number("5"));
            }
        }
        builder.spring(Some(0), 1, &number("0.1"));
        builder.damper(None, 0, &number("0.3"));
        builder.damper(Some(0), 1, &number("0.3"));
        builder.finish()
    };
    let system = twins(true);
    let mut builder = Builder::numbered(2);
    for (i, c) in ["0.3", "0.7"].into_iter().enumerate() {
        builder.mass(i, &number("2"));
        builder.spring(None, i, &number("5"));
        builder.damper(None, i, &number(c));
    }
    let apart = builder.finish();
    let one = vec![(0, Number::ONE)];
    let of = |system: &LinearSystem, list: &[Changing], reach: f64| PoleUpdates::of(system, list, reach);
    let (spring, mass) = (changing(Part::Stiffness, &one), changing(Part::Mass, &one));
    assert!(of(&system, std::slice::from_ref(&spring), 3.0).is_some());
    let row = |i: i64| (Part::Stiffness, vec![(0, Number::ONE), (1, Number::from(i + 1))], 1.0);
    let rows: Vec<Weighed> = (0..5).map(row).collect();
    assert!(of(&system, &several(&rows[..4]), 3.0).is_some());
    assert!(of(&system, &several(&rows), 3.0).is_none(), "five rows");
    let over_both = (Part::Stiffness, vec![(0, Number::ONE), (1, -&Number::ONE)], 1.0);
    let both = several(&[(Part::Stiffness, one.clone(), 1.0), over_both]);
    assert!(of(&apart, &both[..1], 3.0).is_some());
    assert!(of(&apart, &both, 3.0).is_none(), "a row over two parts");
    assert!(of(&twins(false), std::slice::from_ref(&spring), 3.0).is_none(), "a rigid motion");
    let used_up = of(&system, std::slice::from_ref(&mass), -2.5);
    assert!(used_up.is_none_or(|updates| updates.poles(&[-2.0, -2.2])[..] == [None, None]));
    // Without a change, or in the other direction, there is no stretch.
    let updates = of(&system, &[spring], 3.0).expect("one square");
    assert_eq!(updates.poles(&[0.0, -1.0, f64::NAN, 3.5]), [None, None, None, None]);
}

/// Numbers of one pair of poles: D, and c with b = c and v = 1.
fn pair(d: (f64, f64), c: (f64, f64)) -> Vec<Pole> {
    let complex = |(re, im): (f64, f64)| Complex { re: Dd::from(re), im: Dd::from(im) };
    vec![Pole { s: complex(d), b: complex(c), v: complex((1.0, 0.0)) }]
}

/// s^2 - 2 Re(D - rho c) s + |D|^2 - 2 rho Re(c D') = 0, of which all coefficients are exact: a pair that becomes real at rho = 8, where
/// nothing is proved.
#[test]
fn eigenvalues_of_one_pair_are_those_of_a_quadratic() {
    let matrix = RankOne::new(&pair((-1.0, 3.0), (0.5, -0.25)), [0.0; 2], 40.0).expect("usual sizes");
    let truth = |rho: f64| {
        let (half, product) = (-1.0 - rho * 0.5, 10.0 - 2.0 * rho * (-0.5 - 0.75));
        (half, half * half - product)
    };
    let factors = [0.25, 1.0, 2.0, 3.5, 5.0];
    let list: Vec<Factor> = factors.iter().map(|rho| Factor::new(*rho, 0.0)).collect();
    for (rho, found) in factors.iter().zip(matrix.eigenvalues(&list)) {
        let ((half, square), found) = (truth(*rho), found.expect("apart"));
        assert!(square < 0.0 && found.len() == 2);
        for (one, sign) in found.iter().zip([-1.0, 1.0]) {
            let off = [one.s.re - half, one.s.im - sign * (-square).sqrt()];
            assert!((0..2).all(|i| off[i].abs() <= one.bounds[i] + 1e-15), "{rho}: {one:?}");
            assert!(one.bounds[0] < 1e-12);
        }
    }
}

/// What the true matrix has besides may be any matrix of that norm: D that lies somewhere else by as much, or another b.
#[test]
fn what_the_matrix_has_besides_is_in_the_bounds() {
    let off = 1e-6;
    let near = RankOne::new(&pair((-1.0, 3.0), (0.5, -0.25)), [off, 0.0], 4.0).expect("usual sizes");
    let of_factor = RankOne::new(&pair((-1.0, 3.0), (0.5, -0.25)), [0.0, off], 4.0).expect("usual sizes");
    let mut largest = [0.0f64; 2];
    for rho in [0.5, 1.5, 3.9] {
        let factor = [Factor::new(rho, 0.0)];
        let of = |matrix: &RankOne| matrix.eigenvalues(&factor)[0].clone().expect("apart");
        for (dx, dy) in [(1.0, 0.0), (0.0, 1.0), (-0.6, 0.8), (0.6, 0.8)] {
            // The matrix beside is diagonal in the first case; in the second it is d b v^T with |v| = sqrt 2, |d b| = sqrt 2 |d|.
            let shift = (0.999 * off * dx, 0.999 * off * dy);
            let moved = pair((-1.0 + shift.0, 3.0 + shift.1), (0.5, -0.25));
            let other = pair((-1.0, 3.0), (0.5 + shift.0 / 2.0, -0.25 + shift.1 / 2.0));
            for (which, (poles, bounded)) in [(moved, &near), (other, &of_factor)].into_iter().enumerate() {
                let exact = of(&RankOne::new(&poles, [0.0; 2], 4.0).expect("usual sizes"));
                for (one, truth) in of(bounded).iter().zip(&exact) {
                    let error = (one.s.re - truth.s.re).hypot(one.s.im - truth.s.im);
                    assert!(error <= one.bounds[0], "{which} {rho}: {error:e} {one:?}");
                    largest[which] = largest[which].max(error / one.bounds[0]);
                }
            }
        }
    }
    // Otherwise the test would compare nothing.
    assert!(largest.iter().all(|x| *x > 0.1), "{largest:?}");
    // An error of the factor: rho (1 + e) instead of rho.
    let matrix = RankOne::new(&pair((-1.0, 3.0), (0.5, -0.25)), [0.0; 2], 4.0).expect("usual sizes");
    let found = matrix.eigenvalues(&[Factor::new(2.0, 1e-7), Factor::new(2.0 * (1.0 + 0.99e-7), 0.0)]);
    let [one, truth] = [&found[0], &found[1]].map(|list| list.as_ref().expect("apart")[0]);
    let error = (one.s.re - truth.s.re).hypot(one.s.im - truth.s.im);
    assert!(error <= one.bounds[0] && 20.0 * error > one.bounds[0], "{error:e} {one:?}");
}

/// Two pairs of poles, two columns, and what accelerations feed back.
fn columns() -> Columns {
    let complex = |(re, im): (f64, f64)| Complex { re: Dd::from(re), im: Dd::from(im) };
    let list = |of: [(f64, f64); 2]| of.map(complex).to_vec();
    Columns {
        poles: list([(-1.0, 3.0), (-0.5, 7.0)]),
        b: vec![list([(0.5, -0.25), (0.125, 0.5)]), list([(-0.25, 0.75), (0.5, 0.25)])],
        w: vec![list([(1.0, 0.25), (0.5, -0.5)]), list([(-0.5, -0.5), (1.0, -0.125)])],
        direct: [[0.5, 0.125], [0.125, 0.25]].map(|row| row.map(Dd::from).to_vec()).to_vec(),
        off: Off { reach: f64::INFINITY, ..Off::default() },
    }
}

/// F at s, in binary64.
fn determinant_of(of: &Columns, t: f64, s: Complex<f64>) -> Complex<f64> {
    let entry = |i: usize, k: usize| {
        let mut sum: Complex<f64> = Complex::real(of.direct[i][k].to_f64());
        for (j, pole) in of.poles.iter().enumerate() {
            let (pole, product) = (pole.to_f64(), of.w[i][j].to_f64() * of.b[k][j].to_f64());
            sum = sum + product * (s - pole).recip() + product.conj() * (s - pole.conj()).recip();
        }
        sum.scale(t) + Complex::real(if i == k { 1.0 } else { 0.0 })
    };
    entry(0, 0) * entry(1, 1) - entry(0, 1) * entry(1, 0)
}

/// With two columns, too, what the true matrix has besides may be any of that norm: other D, other b, other w, another G.
#[test]
fn what_the_matrix_of_two_columns_has_besides_is_in_the_bounds() {
    let off = 1e-9;
    let (end, factors) = (1.0, [0.125, 0.5, 0.9375]);
    let of = |columns: &Columns, t: f64| {
        let matrix = LowRank::<2>::new(columns, end).expect("usual sizes");
        matrix.eigenvalues(&[Factor::new(t, 0.0)]).remove(0).expect("apart")
    };
    for t in factors {
        for one in of(&columns(), t) {
            // A zero of F: a step of a millionth changes it far more.
            let at = |s: Complex<f64>| determinant_of(&columns(), t, s).abs();
            assert!(at(one.s) < 1e-9 * at(one.s + Complex::real(1e-3)), "{t}: {one:?}");
            assert!(one.bounds[0] < 1e-12, "{t}: {one:?}");
        }
    }
    // The lengths of all columns of B, and of W: both of each pair count.
    let length = |list: &[Vec<Complex<Dd>>]| {
        let squares = list.iter().flatten().map(|z| 2.0 * z.to_f64().abs().powi(2));
        squares.sum::<f64>().sqrt()
    };
    let (of_b, of_w) = (length(&columns().b), length(&columns().w));
    let shifted = |z: Complex<Dd>, (re, im): (f64, f64)| Complex { re: z.re + Dd::from(re), im: z.im + Dd::from(im) };
    let mut largest = [0.0f64; 4];
    for t in factors {
        for (dx, dy) in [(1.0, 0.0), (0.0, 1.0), (-0.6, 0.8), (0.6, 0.8)] {
            let by = (0.999 * off * dx, 0.999 * off * dy);
            let (mut poles, mut b, mut w, mut direct) = (columns(), columns(), columns(), columns());
            poles.poles[0] = shifted(poles.poles[0], by);
            b.b[1][0] = shifted(b.b[1][0], by);
            w.w[0][1] = shifted(w.w[0][1], by);
            direct.direct[0][1] += Dd::from(0.999 * off * dx);
            direct.direct[1][0] += Dd::from(0.999 * off * dy);
            let both = off * 2f64.sqrt();
            let bounds = [
                Off { always: off, ..columns().off },
                Off { once: both * of_w, ..columns().off },
                Off { once: both * of_b, ..columns().off },
                Off { twice: off * of_b * of_w, direct: off, ..columns().off },
            ];
            for (at, (changed, off)) in [poles, b, w, direct].iter().zip(bounds).enumerate() {
                let (found, truth) = (of(&Columns { off, ..columns() }, t), of(changed, t));
                for (one, truth) in found.iter().zip(&truth) {
                    let error = (one.s.re - truth.s.re).hypot(one.s.im - truth.s.im);
                    assert!(error <= one.bounds[0], "{at} {t}: {error:e} {one:?}");
                    largest[at] = largest[at].max(error / one.bounds[0]);
                }
            }
        }
    }
    // Otherwise the test would compare nothing.
    assert!(largest.iter().all(|x| *x > 0.01), "{largest:?}");
    // A bound of the inverse that grows with the factor counts, a factor beyond what is proved has none, and so has a G that is hardly known.
    let with = |off: Off| LowRank::<2>::new(&Columns { off, ..columns() }, end);
    let bound = |growth: f64| {
        let matrix = with(Off { once: 1e-9, twice: 1e-9, growth, ..columns().off }).expect("usual sizes");
        matrix.eigenvalues(&[Factor::new(0.5, 0.0)])[0].as_ref().expect("apart")[0].bounds[0]
    };
    assert!(bound(6.0) > 3.9 * bound(0.0) && bound(6.0) < 16.1 * bound(0.0));
    let short = with(Off { reach: 0.25, ..columns().off }).expect("usual sizes");
    let known = short.eigenvalues(&[Factor::new(0.2, 0.0), Factor::new(0.3, 0.0)]);
    assert!(known[0].is_some() && known[1].is_none());
    assert!(with(Off { direct: 0.01, ..columns().off }).is_none());
    // An error of the factor.
    let matrix = with(columns().off).expect("usual sizes");
    let found = matrix.eigenvalues(&[Factor::new(0.5, 1e-7), Factor::new(0.5 * (1.0 + 0.99e-7), 0.0)]);
    let [one, truth] = [&found[0], &found[1]].map(|list| list.as_ref().expect("apart")[0]);
    let error = (one.s.re - truth.s.re).hypot(one.s.im - truth.s.im);
    assert!(error <= one.bounds[0] && 100.0 * error > one.bounds[0], "{error:e} {one:?}");
}

/// A matrix beside that moves a pole that the change does not: it lies within four times its norm.
#[test]
fn a_pole_that_stays_may_be_where_the_matrix_beside_moves_it() {
    let complex = |re: f64, im: f64| Complex { re: Dd::from(re), im: Dd::from(im) };
    let (b, none) = (complex(0.5, -0.25), complex(1e-40, 0.0));
    let poles = |shift: f64| {
        let moving = Pole { s: complex(-1.0, 3.0), b, v: complex(1.0, 0.0) };
        [moving, Pole { s: complex(-2.0 + shift, 5.0), b: none, v: none }]
    };
    let factor = [Factor::new(1.5, 0.0)];
    let of = |shift: f64, off: f64| {
        let matrix = RankOne::new(&poles(shift), [off, 0.0], 2.0).expect("usual sizes");
        matrix.eigenvalues(&factor)[0].clone().expect("apart")
    };
    let (found, truth) = (of(0.0, 1e-9), of(0.999e-9, 0.0));
    for (one, truth) in found.iter().zip(&truth).skip(2) {
        let error = (one.s.re - truth.s.re).abs();
        assert!(error <= one.bounds[0] && one.bounds[0] < 6.0 * error, "{error:e} {one:?}");
    }
}

/// The same of two columns: a third pair that feels neither stays within four times the norm, also beside a pole that it can hardly be
/// told from, of which nothing is claimed; and the cofactors count in what the matrix beside does.
#[test]
fn a_pole_that_neither_of_two_columns_moves_stays() {
    let complex = |re: f64, im: Dd| Complex { re: Dd::from(re), im };
    let with_third = |s: Complex<Dd>, off: f64| {
        let mut columns = columns();
        columns.poles.push(s);
        let small = complex(1e-40, Dd::ZERO);
        columns.b.iter_mut().chain(&mut columns.w).for_each(|list| list.push(small));
        columns.off.always = off;
        let matrix = LowRank::<2>::new(&columns, 1.0).expect("usual sizes");
        matrix.eigenvalues(&[Factor::new(0.5, 0.0)]).remove(0)
    };
    let of = |shift: f64, off: f64| with_third(complex(-2.0 + shift, Dd::from(5.0)), off).expect("apart");
    let (found, truth) = (of(0.0, 1e-12), of(0.999e-12, 0.0));
    let third = |list: &[Eigenvalue]| *list.iter().find(|one| (one.s.im - 5.0).abs() < 1e-9).expect("a third pair");
    let (one, truth) = (third(&found), third(&truth));
    let error = (one.s.re - truth.s.re).abs();
    assert!(error <= one.bounds[0] && one.bounds[0] < 6.0 * error, "{error:e} {one:?}");
    // Next to one of the others, which begins there.
    let beside = |apart: f64| with_third(complex(-1.0, Dd::new(3.0, apart)), 1e-28);
    assert!(beside(1e-2).is_some() && beside(1e-18).is_none());
    // A term as large as the distance of the pole that has it is small: the columns are long, and H is far from 1.
    let off = 1e-12;
    let long = |shift: f64, off: f64| {
        let mut columns = columns();
        columns.b.iter_mut().flatten().for_each(|z| *z = z.scale(Dd::from(64.0)));
        columns.poles[1].im += Dd::from(shift);
        columns.off.always = off;
        let matrix = LowRank::<2>::new(&columns, 1.0).expect("usual sizes");
        matrix.eigenvalues(&[Factor::new(0.015625, 0.0)]).remove(0).expect("apart")
    };
    for (one, truth) in long(0.0, off).iter().zip(&long(0.999 * off, 0.0)) {
        let error = (one.s.re - truth.s.re).hypot(one.s.im - truth.s.im);
        assert!(error <= one.bounds[0], "{error:e} {one:?}");
    }
}

/// Near the place where a pair becomes real a small matrix beside moves both by the root of its size: what is claimed holds there too.
#[test]
fn bounds_hold_where_two_eigenvalues_nearly_meet() {
    let (mut claimed, mut refused) = (0, 0);
    // 3 + sqrt(45), where (1 + rho / 2)^2 = 10 + 2.5 rho.
    let meeting = 3.0 + 45f64.sqrt();
    for step in 4..40 {
        let rho = meeting * (1.0 - 2f64.powf(-0.5 * f64::from(step)));
        for off in [1e-8, 1e-6, 1e-4, 1e-3] {
            let matrix = RankOne::new(&pair((-1.0, 3.0), (0.5, -0.25)), [off, 0.0], meeting).expect("usual sizes");
            let Some(found) = &matrix.eigenvalues(&[Factor::new(rho, 0.0)])[0] else {
                refused += 1;
                continue;
            };
            claimed += 1;
            for (dx, dy) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
                let (x, y) = (-1.0 + off * dx, 3.0 + off * dy);
                // s^2 - 2 (x - rho / 2) s + x^2 + y^2 - 2 rho (x / 2 - y / 4) = 0.
                let half = x - 0.5 * rho;
                let square = x * x + y * y - 2.0 * rho * (0.5 * x - 0.25 * y) - half * half;
                assert!(square > 0.0, "{rho} {off}: both are real, {found:?}");
                let error = (found[1].s.re - half).hypot(found[1].s.im - square.sqrt());
                assert!(error <= found[1].bounds[0].hypot(found[1].bounds[1]), "{rho} {off}: {error:e} {found:?}");
            }
        }
    }
    assert!(claimed > 20 && refused > 20, "{claimed} {refused}");
}
