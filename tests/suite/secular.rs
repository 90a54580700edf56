//! Frequencies of systems in which one weight changes: the i-th enclosure holds the i-th eigenvalue, counted by the signs of leading
//! minors in exact arithmetic. See docs/method/studies.md#one-weight.

use super::exact::{ExactPencil, binary, value};
use super::sweeps::network;
use super::systems::{Builder, Random, number};
use num_rational::BigRational;
use num_traits::Zero;
use vibc::base::{Ball, Dd, Number};
use vibc::kernel::secular::{Factor, Secular};
use vibc::questions::updates::{Changing, Part, Updates};
use vibc::system::LinearSystem;

type Exact = Vec<Vec<BigRational>>;

/// The largest bound relative to its value. Every enclosure that there is holds its eigenvalue.
fn check(pencil: &ExactPencil, found: &[f64], what: &str) -> f64 {
    let mut widest = 0.0f64;
    for (i, pair) in found.chunks(2).enumerate() {
        let [x, bound] = [pair[0], pair[1]];
        if bound.is_nan() {
            widest = f64::INFINITY;
            continue;
        }
        let below = pencil.below(&(binary(x) - binary(bound)));
        let above = pencil.below(&(binary(x) + binary(bound)));
        assert!(below.is_none_or(|count| count <= i), "{what}: {i}: {x} ± {bound}");
        assert!(above.is_none_or(|count| count > i), "{what}: {i}: {x} ± {bound}");
        widest = widest.max(if x == 0.0 { bound } else { bound / x.abs() });
    }
    widest
}

fn diagonal(entries: &[BigRational]) -> Exact {
    let n = entries.len();
    let mut matrix = vec![vec![BigRational::zero(); n]; n];
    (0..n).for_each(|i| matrix[i][i] = entries[i].clone());
    matrix
}

/// From poles that are 1e-20 of their size apart to poles over many decades, with squares from next to nothing to overwhelming.
#[test]
fn every_root_lies_in_its_enclosure() {
    let mut random = Random::new(7);
    for m in 1..=14 {
        for (closeness, decades) in [(0.0, 0.0), (0.0, 30.0), (16.0, 6.0), (20.0, 20.0)] {
            let mut at = Dd::from(random.signed().to_f64());
            let poles: Vec<Dd> = (0..m)
                .map(|_| {
                    let size = random.decimal(closeness).to_f64() * 10f64.powf(-closeness / 2.0);
                    at += Dd::from(size);
                    at
                })
                .collect();
            let roots: Vec<f64> = (0..m).map(|_| random.decimal(decades / 2.0).to_f64() as f32 as f64).collect();
            let squares: Vec<f64> = roots.iter().map(|g| g * g).collect();
            let secular = Secular::new(poles.clone(), squares).expect("usual sizes");
            let factors = [1.0, 1e-12, 3e-5, 0.02, 7.0, 1e4, 1e9, 2.5, 1e-3];
            let list: Vec<Factor> = factors.iter().map(|rho| Factor::new(*rho, 0.0)).collect();
            let found = secular.lowest(m, &list);
            let few = secular.lowest(m.div_ceil(2), &list);
            for (case, rho) in factors.iter().enumerate() {
                let mut k = diagonal(&poles.iter().map(|pole| value(*pole)).collect::<Vec<_>>());
                for i in 0..m {
                    for j in 0..m {
                        k[i][j] += binary(*rho) * binary(roots[i]) * binary(roots[j]);
                    }
                }
                let pencil = ExactPencil::new(&k, &diagonal(&vec![binary(1.0); m]));
                let row = &found.of_case(case)[..];
                check(&pencil, row, &format!("{m} {closeness} {decades} {rho}"));
                let count = m.div_ceil(2);
                // Rows with fewer roots are the same numbers, and so is each alone in its lane.
                let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
                assert_eq!(bits(&row[..2 * count]), bits(&few.of_case(case)));
                assert_eq!(bits(row), bits(&secular.lowest(m, &list[case..=case]).of_case(0)));
                let known = row.chunks(2).filter(|pair| pair[1].is_finite()).count();
                assert!(known == m, "{known} of {m}: {closeness} {decades} {rho}: {row:?}");
            }
        }
    }
}

/// Poles, squares and factors over sixty decades and more: a root that is proved is one.
#[test]
fn roots_of_extreme_sizes_are_right_or_not_proved() {
    let mut random = Random::new(23);
    let (mut proved, mut all) = (0, 0);
    for round in 0..60 {
        let m = 1 + round % 6;
        let mut at = Dd::ZERO;
        let poles: Vec<Dd> = (0..m)
            .map(|_| {
                at += Dd::from(random.decimal(60.0).to_f64());
                at
            })
            .collect();
        let roots: Vec<f64> = (0..m).map(|_| random.decimal(30.0).to_f64() as f32 as f64).collect();
        let Some(secular) = Secular::new(poles.clone(), roots.iter().map(|g| g * g).collect()) else { continue };
        let factors = [1e-60, 1e-20, 1.0, 1e20, 1e60].map(|rho| rho * random.decimal(3.0).to_f64());
        let list: Vec<Factor> = factors.iter().map(|rho| Factor::new(*rho, 0.0)).collect();
        let found = secular.lowest(m, &list);
        for (case, rho) in factors.iter().enumerate() {
            let row = &found.of_case(case)[..];
            let mut k = diagonal(&poles.iter().map(|pole| value(*pole)).collect::<Vec<_>>());
            for i in 0..m {
                for j in 0..m {
                    k[i][j] += binary(*rho) * binary(roots[i]) * binary(roots[j]);
                }
            }
            check(&ExactPencil::new(&k, &diagonal(&vec![binary(1.0); m])), row, &format!("{round} {m} {rho}"));
            proved += row.chunks(2).filter(|pair| pair[1].is_finite()).count();
            all += m;
        }
    }
    assert!(10 * proved > 9 * all, "{proved} of {all}");
}

/// A root next to a pole, between two poles at a distance of one whose terms cancel, all so large that the 1 of f is nothing beside them:
/// rounding makes the root uncertain by 1e-15, which is up to more than its distance x from the pole. The slope of f falls by at most (1 + b/x)^2 within b of the root, so that f rises by at least
/// 1 / (1 + b/x) of slope times b, and a bound with 1.05 to spare is one up to b = 0.05 x.
#[test]
fn a_root_is_proved_only_where_the_slope_is_known() {
    let (mut proved, mut all) = (0, 0);
    for step in 0..=64 {
        let x = 10f64.powf(-16.0 + step as f64 / 16.0) as f32 as f64;
        let poles: Vec<Dd> = [-1.0, 0.0, 1.0].map(Dd::from).to_vec();
        // 2 x - s / x = 0, about.
        let roots = [1.0, (2f64.sqrt() * x) as f32 as f64, 1.0];
        let secular = Secular::new(poles.clone(), roots.map(|g| g * g).to_vec()).expect("usual sizes");
        let rho = 1e40;
        let row = secular.lowest(3, &[Factor::new(rho, 0.0)]).of_case(0);
        let mut k = diagonal(&poles.iter().map(|pole| value(*pole)).collect::<Vec<_>>());
        for i in 0..3 {
            for j in 0..3 {
                k[i][j] += binary(rho) * binary(roots[i]) * binary(roots[j]);
            }
        }
        check(&ExactPencil::new(&k, &diagonal(&vec![binary(1.0); 3])), &row, &format!("{x}"));
        for pair in row.chunks(2).take(2) {
            let [root, bound] = [pair[0], pair[1]];
            assert!(bound.is_nan() || bound <= 0.05 * root.abs(), "{x}: {root} {bound}");
            proved += usize::from(bound.is_finite());
            all += 1;
        }
    }
    assert!(0 < proved && proved < all, "{proved} of {all}");
}

/// Factors that are not positive, or that nobody knows, prove nothing.
#[test]
fn no_root_without_a_factor() {
    let secular = Secular::new(vec![Dd::from(1.0), Dd::from(2.0)], vec![1.0, 1.0]).expect("usual sizes");
    for (rho, error) in [(0.0, 0.0), (-1.0, 0.0), (f64::NAN, 0.0), (1e90, 0.0), (1.0, f64::NAN), (1.0, 0.5)] {
        assert!(
            secular.lowest(2, &[Factor::new(rho, error)]).of_case(0).chunks(2).all(|pair| pair[1].is_nan()),
            "{rho} {error}"
        );
    }
    // An error of the factor is in the bounds: 1 + rho (1 - x)^-1 = 0 is at 1 + rho.
    let one = Secular::new(vec![Dd::from(1.0)], vec![1.0]).expect("usual sizes");
    let found = one.lowest(1, &[Factor::new(2.0, 1e-9)]).of_case(0);
    assert!((found[0] - 3.0).abs() < found[1] && (2e-9..2.2e-9).contains(&found[1]), "{found:?}");
    assert!(Secular::new(vec![Dd::from(1.0); 2], vec![1.0; 2]).is_none(), "equal poles");
    assert!(Secular::new(vec![Dd::from(1.0)], vec![0.0]).is_none(), "no square");
}

/// A system in which a weight is `change` more, exactly.
fn changed(system: &LinearSystem, part: Part, row: &[(usize, Number)], change: f64) -> ExactPencil {
    let n = system.n();
    let exact = |matrix: Vec<Vec<Number>>| -> Exact {
        matrix.iter().map(|row| row.iter().map(|x| x.exact().expect("rational").to_big()).collect()).collect()
    };
    let (mut k, mut m) = (exact(system.k.entries(n)), exact(system.m.entries(n)));
    let matrix = if part == Part::Stiffness { &mut k } else { &mut m };
    for (i, a) in row {
        for (j, b) in row {
            let [a, b] = [a, b].map(|x| x.exact().expect("rational").to_big());
            matrix[*i][*j] += binary(change) * a * b;
        }
    }
    ExactPencil::new(&k, &m)
}

fn changing(part: Part, row: &[(usize, Number)]) -> Changing {
    Changing { part, row: row.iter().map(|(i, a)| (*i, a.to_ball())).collect(), number: 0, slope: Ball::ONE }
}

fn row_of(form: &vibc::system::Form, at: usize) -> (Vec<(usize, Number)>, f64) {
    let term = form.term(at);
    (form.row(term).iter().map(|(i, a)| (i.index(), a.clone())).collect(), term.weight.to_f64())
}

/// Networks of springs over decades: a stiffness that grows up to a thousandfold, a mass that nearly vanishes.
#[test]
fn every_enclosure_of_a_changed_system_holds() {
    let mut random = Random::new(11);
    let (mut cases, mut worst) = (0, 0.0f64);
    for n in [1, 2, 3, 5, 8, 11, 18] {
        for (decades, grounded) in [(0.5, true), (3.0, true), (1.0, false)] {
            let system = network(&mut random, n, decades, n / 2, grounded);
            for part in [Part::Stiffness, Part::Mass] {
                let form = if part == Part::Stiffness { &system.k } else { &system.m };
                if form.is_empty() {
                    continue;
                }
                let (row, weight) = row_of(form, random.below(form.terms().len()));
                let reach = if part == Part::Stiffness { 1000.0 * weight } else { -0.99 * weight };
                let updates = Updates::of(&system, &[changing(part, &row)], reach, n);
                let Some(updates) = updates else { panic!("{n} {decades} {part:?}") };
                let changes = [1.0, 1e-6, 0.03].map(|share| share * reach);
                let all = updates.lowest(&changes);
                for (case, change) in changes.iter().enumerate() {
                    let found = &all.of_case(case)[..];
                    let pencil = changed(&system, part, &row, *change);
                    let widest = check(&pencil, found, &format!("{n} {decades} {part:?} {change}"));
                    assert!(widest < 1e-11, "{n} {decades} {part:?} {change}: {found:?}");
                    (cases, worst) = (cases + 1, worst.max(widest));
                }
            }
        }
    }
    // The rest of the error is that of a few roundings, times n; a mass that leaves a hundredth of itself, a hundred times.
    assert!(cases > 100, "{cases}: {worst:e}");
}

/// Equal parts: double eigenvalues, of which the change turns one away, and modes that do not feel it at all.
#[test]
fn modes_that_feel_no_change_stay() {
    // Three equal pendulums, coupled in a ring; and two pairs without any coupling.
    for (n, springs) in [(3, &[(0, 1), (1, 2), (2, 0)][..]), (4, &[(0, 1), (2, 3)][..])] {
        let mut builder = Builder::numbered(n);
        for i in 0..n {
            builder.mass(i, &number("2"));
            builder.spring(None, i, &number("5"));
        }
        for (a, b) in springs {
            builder.spring(Some(*a), *b, &number("0.1"));
        }
        let system = builder.finish();
        let row = [(0, Number::ONE)];
        for (part, reach) in [(Part::Stiffness, 3.0), (Part::Mass, -1.5)] {
            let updates = Updates::of(&system, &[changing(part, &row)], reach, n).expect("one square");
            let changes = [reach, 0.25 * reach];
            let all = updates.lowest(&changes);
            for (case, change) in changes.iter().enumerate() {
                let found = &all.of_case(case)[..];
                let widest = check(&changed(&system, part, &row, *change), found, &format!("{n} {part:?} {change}"));
                // Some 50 roundings, four times as many where a quarter of the mass is left.
                assert!(widest < 1e-13, "{widest:e}");
            }
        }
        // Without a change no root is proved, and then the place in the order of the modes that stay is not known either.
        let updates = Updates::of(&system, &[changing(Part::Stiffness, &row)], 3.0, n).expect("one square");
        assert!(updates.lowest(&[0.0]).of_case(0).iter().all(|x| x.is_nan()));
        // Two squares that the same modes feel are refused, and so is a change that lowers frequencies.
        let other = [(1, Number::ONE)];
        let both = [changing(Part::Stiffness, &row), changing(Part::Stiffness, &other)];
        assert!(Updates::of(&system, &both, 1.0, n).is_none());
        assert!(Updates::of(&system, &both[..1], -1.0, n).is_none());
        assert!(Updates::of(&system, &[changing(Part::Mass, &row)], 1.0, n).is_none());
        assert!(Updates::of(&system, &[changing(Part::Mass, &row)], -2.0, n).is_none(), "no mass is left");
    }
}

/// A slope or a row that is not known well: the enclosures hold for all that it may be.
#[test]
fn enclosures_hold_for_every_slope_and_row() {
    let mut builder = Builder::numbered(3);
    for i in 0..3 {
        builder.mass(i, &number("2"));
        builder.spring(None, i, &number(["5", "7", "11"][i]));
    }
    builder.spring(Some(0), 1, &number("3"));
    builder.spring(Some(1), 2, &number("2"));
    let system = builder.finish();
    let row = [(0, Number::ONE)];
    for (part, change) in [(Part::Stiffness, 4.0), (Part::Mass, -1.0)] {
        let mut wide = changing(part, &row);
        wide.slope = wide.slope.widen(1e-6);
        let mut blurred = changing(part, &row);
        blurred.row = vec![(0, Ball::ONE.widen(1e-6))];
        for (of, power) in [(wide, 1), (blurred, 2)] {
            let updates = Updates::of(&system, &[of], change, 3).expect("one square");
            let found = updates.lowest(&[change]).of_case(0);
            for factor in [1.0 - 0.999e-6f64, 1.0, 1.0 + 0.999e-6] {
                let widest = check(&changed(&system, part, &row, change * factor.powi(power)), &found, "uncertain");
                assert!(widest < 1e-4, "{part:?}: {found:?}");
            }
        }
    }
}

/// What is rigid at the base may be held by a row that has no weight there, or by springs that cancel there.
#[test]
fn what_is_rigid_at_the_base_need_not_stay_so() {
    for cancels in [false, true] {
        let mut builder = Builder::numbered(2);
        builder.mass(0, &number("2"));
        builder.mass(1, &number("3"));
        builder.spring(Some(0), 1, &number("5"));
        if cancels {
            builder.spring(None, 0, &number("4"));
            builder.spring(None, 0, &number("-4"));
        }
        let system = builder.finish();
        let row = [(0, Number::ONE)];
        if let Some(updates) = Updates::of(&system, &[changing(Part::Stiffness, &row)], 3.0, 2) {
            check(
                &changed(&system, Part::Stiffness, &row, 3.0),
                &updates.lowest(&[3.0]).of_case(0),
                &format!("{cancels}"),
            );
        }
    }
}

/// Blocks that nothing couples may each have a square of their own, at their corners too.
#[test]
fn squares_of_separate_blocks_are_taken_together() {
    let mut builder = Builder::numbered(4);
    for (i, k) in ["5", "7", "11", "13"].iter().enumerate() {
        builder.mass(i, &number("2"));
        builder.spring(None, i, &number(k));
    }
    builder.spring(Some(0), 1, &number("3"));
    builder.spring(Some(2), 3, &number("1.5"));
    let system = builder.finish();
    let rows = [[(0, Number::ONE)], [(3, Number::ONE)]];
    let both = rows.each_ref().map(|row| changing(Part::Stiffness, row));
    for count in [4, 2] {
        let updates = Updates::of(&system, &both, 9.0, count).expect("separate blocks");
        let all = updates.lowest(&[9.0, 0.5]);
        for (case, change) in [9.0, 0.5].iter().enumerate() {
            let found = &all.of_case(case)[..];
            let n = system.n();
            let exact = |matrix: Vec<Vec<Number>>| -> Exact {
                matrix.iter().map(|row| row.iter().map(|x| x.exact().expect("rational").to_big()).collect()).collect()
            };
            let (mut k, m) = (exact(system.k.entries(n)), exact(system.m.entries(n)));
            k[0][0] += binary(*change);
            k[3][3] += binary(*change);
            assert!(check(&ExactPencil::new(&k, &m), found, &format!("{change}")) < 1e-14);
        }
    }
}
