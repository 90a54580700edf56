//! Transfer functions: the hard cases with their bounds, and closed forms.

use super::ask::ask;
use super::systems::{Builder, HardCase, Random, chain, number};
use vibc::analysis::{self, Extrema, FeatureKind, Frequency, Gain, Methods, Sweep, Table, Transfer};
use vibc::answers;
use vibc::backend::report;
use vibc::base::{Number, Rational, Span};
use vibc::system::{Coordinate, CoordinateId, Input, Label, LinearSystem, Output};

/// The system with a force on each coordinate, and its displacement as output.
pub fn with_every_pair(mut system: LinearSystem) -> LinearSystem {
    let names: Vec<(Label, Span)> = system.coordinates.iter().map(|of| (of.name, of.span)).collect();
    for (i, &(name, span)) in names.iter().enumerate() {
        let at = vec![(CoordinateId(i as u32), Number::ONE)];
        system.inputs.push(Input { name, span, unit: "N", b: [at.clone(), Vec::new(), Vec::new()], undamped: None });
        let d = [Vec::new(), Vec::new(), Vec::new()];
        system.outputs.push(Output { name, unit: "m".into(), p: [at, Vec::new(), Vec::new()], d });
    }
    system
}

/// Checks every reference `frf[out/in]@w=omega` of a case to 15 digits, and that its bound holds.
fn check_case(name: &str) {
    let case = HardCase::load(name);
    let names = case.system.coordinate_names();
    let index = |coordinate: &str| names.iter().position(|n| n == coordinate).expect("a coordinate of the case");
    let mut checked = 0;
    for reference in case.json["reference"].as_array().expect("a list") {
        let id = reference["id"].as_str().expect("an id");
        let Some(pair) = id.strip_prefix("frf[").and_then(|rest| rest.strip_suffix(":re")) else { continue };
        let (pair, omega) = pair.split_once("]@w=").expect("frf[out/in]@w=omega");
        let (output, input) = pair.split_once('/').expect("out/in");
        let omega: f64 = omega.parse().expect("a number");
        let frequency = Frequency::radians(&Number::from(Rational::from_f64(omega).expect("finite")));
        let im = case.reference(&format!("frf[{pair}]@w={}:im", id_omega(id))).expect("both parts");
        let truth = (number(reference["value"].as_str().expect("a decimal")), im);
        let mut system = with_every_pair(case.system.clone());
        system.inputs.push(load(&case, input, index));
        let loaded = system.inputs.len() - 1;
        let gain = Transfer::of(&system).between(&frequency, &[loaded], &[index(output)])[0][0];
        check(&format!("{name} {id}"), gain, &truth);
        checked += 1;
    }
    assert!(checked >= 8, "{name} has {checked} values");
}

/// A load in the notation of the cases: `x1`, `x1+x3`, or the parameter F, a force in newtons on the first coordinate.
fn load(case: &HardCase, text: &str, index: impl Fn(&str) -> usize) -> Input {
    let column = match case.json["parameters"][text].as_str() {
        Some(force) => vec![(CoordinateId(0), number(force))],
        None => text.split('+').map(|name| (CoordinateId(index(name) as u32), Number::ONE)).collect(),
    };
    let Coordinate { name, span, .. } = case.system.coordinates[0];
    Input { name, span, unit: "N", b: [column, Vec::new(), Vec::new()], undamped: None }
}

fn id_omega(id: &str) -> &str {
    id.split_once("@w=").and_then(|(_, rest)| rest.strip_suffix(":re")).expect("an frf id")
}

fn check(what: &str, gain: Gain, truth: &(Number, Number)) {
    let disc = gain.disc().unwrap_or_else(|| panic!("{what}: {gain:?}"));
    let (re, im) = (truth.0.to_ball().mid, truth.1.to_ball().mid);
    let error = (disc.value - vibc::kernel::complex::Complex::new(re, im)).to_f64().abs();
    let size = (re * re + im * im).sqrt().to_f64();
    // The references have 36 digits, of which double-double keeps 31.
    assert!(error <= disc.radius + 4e-32 * size, "{what}: error {error:e}, bound {:e}", disc.radius);
    assert!(error <= 1e-15 * size, "{what}: {} digits", -(error / size).log10());
    // Ten units in the last place of double-double numbers times a condition number of 1e17, half a unit in the last
    // place away from a pole (o26); the bound of an exact zero is absolute.
    let allowed = if size == 0.0 { 1e-30 } else { 1e-14 * size };
    assert!(disc.radius <= allowed, "{what}: bound {:e}", disc.radius / size);
}

#[test]
fn damping_that_is_not_proportional() {
    check_case("o15_nonproportional_2dof");
}

#[test]
fn resonance_at_a_damping_ratio_of_a_billionth() {
    check_case("o16_light_damping_frf");
}

#[test]
fn a_massless_coordinate_behind_a_damper() {
    check_case("o18_zener_maxwell");
}

#[test]
fn an_antiresonance_nine_decades_deep() {
    check_case("o25_absorber_antiresonance");
}

#[test]
fn a_pole_that_a_zero_cancels_exactly() {
    check_case("o26_pole_zero_cancel");
}

#[test]
fn the_cart_with_a_pendulum() {
    check_case("o29_seed_cart");
}

/// If the pole is not cancelled, H is infinite at that frequency.
#[test]
fn an_undamped_system_at_its_own_frequency_is_infinite() {
    let system = with_every_pair(HardCase::load("o26_pole_zero_cancel").system);
    let gains = Transfer::of(&system).at(&Frequency::radians(&Number::from(2)));
    assert_eq!(gains[0][0], Gain::Infinite);
    assert_eq!(gains[0][2], Gain::Infinite);
    assert!(matches!(gains[1][1], Gain::Finite(_)));
}

/// A free body under a steady force diverges; two forces in balance stretch the spring between them.
#[test]
fn at_rest_a_free_pair_answers_forces_in_balance() {
    let mut b = Builder::numbered(2);
    b.mass(0, &number("1"));
    b.mass(1, &number("3"));
    b.spring(Some(0), 1, &number("8"));
    let mut system = with_every_pair(b.finish());
    let mut pulled = system.inputs[0].clone();
    pulled.b[0] = vec![(CoordinateId(0), Number::from(-1)), (CoordinateId(1), Number::ONE)];
    system.inputs.push(pulled);
    let gains = Transfer::of(&system).at(&Frequency::hertz(&Number::ZERO));
    assert_eq!(gains[0][0], Gain::Infinite);
    // Stretched by 1/8 about the centre of mass: -3/32 and 1/32.
    for (i, expected) in [(0, -3.0 / 32.0), (1, 1.0 / 32.0)] {
        assert_eq!(gains[2][i].disc().expect("finite").value.re.to_f64(), expected);
    }
}

/// A base moves a mass through a spring and a damper: |H| at fn/f = 1/sqrt(5) is 1/4 without damping.
#[test]
fn the_isolation_table_passes_a_quarter() {
    let mut b = Builder::numbered(1);
    b.mass(0, &number("200"));
    b.spring(None, 0, &number("1000"));
    let mut system = b.finish();
    let at = |value: &str| vec![(CoordinateId(0), number(value))];
    let name = system.coordinates[0].name;
    system.inputs.push(Input {
        name,
        span: system.coordinates[0].span,
        unit: "m",
        b: [at("1000"), at("0"), Vec::new()],
        undamped: None,
    });
    system = with_output(system, name);
    let gain = Transfer::of(&system).at(&Frequency::radians(&Number::from(5)))[0][0];
    let disc = gain.disc().expect("finite");
    assert_eq!((disc.value.re.to_f64(), disc.value.im.to_f64()), (-0.25, 0.0));
}

fn with_output(mut system: LinearSystem, name: Label) -> LinearSystem {
    let p = [vec![(CoordinateId(0), Number::ONE)], Vec::new(), Vec::new()];
    system.outputs.push(Output { name, unit: "m".into(), p, d: [Vec::new(), Vec::new(), Vec::new()] });
    system
}

/// C09 of the published cases (SDLD21): eight masses of 10 kg between nine springs of 1e5 N/m with 50 N*s/m each, the
/// receptance of the fourth mass; printed there with 14 digits, reproduced to 9e-8 by its own statement.
#[test]
fn a_chain_of_eight_masses_has_its_published_receptance() {
    let system = with_every_pair(super::systems::chain(8, "10", "100000", "50"));
    let transfer = Transfer::of(&system);
    let published = [
        ("5", 1.0236955849989e-4, -8.5187439983774e-6),
        ("5.5", 4.5066156116617e-4, -7.7914353360801e-4),
        ("6", -9.4100964378279e-5, -1.0585181923058e-5),
        ("10", 8.4142788923597e-7, -1.0334675916655e-6),
        ("13", 2.6423957265351e-6, -9.344789296341e-7),
        ("40", -2.569581759e-6, -2.75536673097e-7),
    ];
    for (f, re, im) in published {
        let gain = transfer.between(&Frequency::hertz(&number(f)), &[3], &[3])[0][0];
        let disc = gain.disc().expect("finite");
        let error = (disc.value.re.to_f64() - re).hypot(disc.value.im.to_f64() - im);
        assert!(error <= 2e-7 * re.hypot(im), "{f} Hz: {disc:?}");
        assert!(disc.relative_error() < 1e-17, "{f} Hz: {:e}", disc.relative_error());
    }
}

/// The default table of one pair.
fn table_of(system: &LinearSystem, input: usize, output: usize) -> Table {
    let modes = analysis::modes(system).expect("a regular system");
    let poles = analysis::poles(system, &modes).expect("poles");
    let sweep = Sweep { inputs: vec![input], outputs: vec![output], ..Sweep::default() };
    analysis::table(&Methods::of(system, &modes), &poles, &sweep).expect("a small table")
}

/// The extrema of a table of one pair.
fn extrema(table: &Table) -> &Extrema {
    &table.extrema.as_ref().expect("the default grid")[0][0]
}

/// An antiresonance nine decades deep between two peaks of damping ratio 2e-10, none of them on a grid point.
#[test]
fn the_default_table_misses_nothing() {
    let system = with_every_pair(HardCase::load("o25_absorber_antiresonance").system);
    let table = table_of(&system, 0, 0);
    let found = extrema(&table);
    assert!(found.complete.is_some());
    let kinds: Vec<FeatureKind> = found.list.iter().map(|extremum| extremum.kind).collect();
    assert_eq!(kinds, [FeatureKind::Peak, FeatureKind::Antiresonance, FeatureKind::Peak]);
    let omega = |i: usize| found.list[i].frequency.to_f64() * 2.0 * std::f64::consts::PI;
    assert!((omega(1) - 10.0).abs() < 1e-12, "{:?}", omega(1));
    assert!((omega(0) - 8.543089535574104).abs() < 1e-12);
    let deep = found.list[1].gain.disc().expect("finite").value.to_f64().abs();
    // At 10 rad/s: H = 1 / (k_eff), with the absorber's dynamic stiffness 1e9 at resonance: 1e-9 or below.
    assert!(deep < 1.1e-9, "{deep:e}");
    let width = found.list[0].width.expect("a width").to_f64() * std::f64::consts::PI;
    assert!((width / 1.539653345e-9 - 1.0).abs() < 1e-6, "{width:e}");
    assert!(table.rows.windows(2).all(|w| w[0].frequency.to_f64() < w[1].frequency.to_f64()));
}

/// The peak of an oscillator is at omega sqrt(1 - 2 zeta^2) with the gain 1 / (2 k zeta sqrt(1 - zeta^2)).
#[test]
fn a_peak_is_at_its_maximum() {
    let mut b = Builder::numbered(1);
    b.mass(0, &number("1"));
    b.spring(None, 0, &number("100"));
    let label = b.label("c");
    let source = b.c.source(label);
    b.c.push(source, vibc::system::Nature::Property, number("4"), [(CoordinateId(0), Number::ONE)]);
    let table = table_of(&with_every_pair(b.finish()), 0, 0);
    let zeta = 0.2f64;
    let peak = &extrema(&table).list[0];
    let omega = peak.frequency.to_f64() * 2.0 * std::f64::consts::PI;
    assert!((omega - 10.0 * (1.0 - 2.0 * zeta * zeta).sqrt()).abs() < 1e-14, "{omega}");
    let gain = peak.gain.disc().expect("finite").gain().to_f64();
    assert!((gain * 200.0 * zeta * (1.0 - zeta * zeta).sqrt() - 1.0).abs() < 1e-14);
    assert_eq!(extrema(&table).list.len(), 1);
}

/// Without damping the peaks are infinite, at the poles.
#[test]
fn undamped_peaks_are_infinite() {
    let system = with_every_pair(HardCase::load("o26_pole_zero_cancel").system);
    let peaks = |input, output| {
        let table = table_of(&system, input, output);
        let peaks = extrema(&table).list.iter().filter(|extremum| extremum.kind == FeatureKind::Peak);
        peaks.map(|extremum| extremum.gain).collect::<Vec<_>>()
    };
    assert_eq!(peaks(0, 0), [Gain::Infinite; 3]);
    // The second mode does not move the middle mass.
    assert_eq!(peaks(1, 1), [Gain::Infinite; 2]);
}

/// Enough work for all cores is divided into a piece for each; a few frequencies are not. The results are identical.
#[test]
fn pieces_for_several_cores_give_the_same_bytes() {
    let system = with_every_pair(chain(60, "2", "1000", "0.3"));
    let transfer = Transfer::of(&system);
    let frequencies: Vec<Frequency> =
        (1..=6000).map(|i| Frequency::hertz(&Number::Exact(Rational::new(i, 400)))).collect();
    let at_once = transfer.at_frequencies(&frequencies, &[0, 59], &[0, 30], 1e-13);
    let few = frequencies.chunks(48).flat_map(|some| transfer.at_frequencies(some, &[0, 59], &[0, 30], 1e-13));
    assert!(at_once.len() == 4 * 6000 && few.eq(at_once));
}

/// Two dozen masses, each with springs and dampers to three others: too many for exact arithmetic, and no path leads from the
/// force to the output, so the zeros are unknown. Elimination in binary64 on a fine grid finds the same peaks and valleys.
#[test]
fn every_extremum_of_a_damped_net_is_proved() {
    const N: usize = 24;
    let mut chance = Random::new(41);
    let mut model = String::from("model net\n");
    let (mut masses, mut springs, mut dampers) = (vec![0.0; N], vec![vec![0.0; N]; N], vec![vec![0.0; N]; N]);
    let join = |matrix: &mut Vec<Vec<f64>>, value: f64, a: Option<usize>, b: usize| {
        matrix[b][b] += value;
        if let Some(a) = a {
            matrix[a][a] += value;
            matrix[a][b] -= value;
            matrix[b][a] -= value;
        }
    };
    for (i, mass) in masses.iter_mut().enumerate() {
        *mass = 1.0 + chance.below(100) as f64 / 128.0;
        model += &format!("body m{i} {{ mass = {mass} kg, moves x }}\n");
        let mut others: Vec<Option<usize>> =
            if i == 0 { vec![None] } else { vec![Some(i - 1), Some(i.saturating_sub(2)), Some(chance.below(i))] };
        others.sort();
        others.dedup();
        for (number, other) in others.into_iter().enumerate() {
            let end = other.map_or("ground".to_string(), |other| format!("m{other}"));
            let (k, c) = (1.0 + chance.below(200) as f64 / 128.0, (1 + chance.below(9)) as f64 / 128.0);
            model += &format!("spring s{i}_{number}: {end} -- m{i} {{ k = {k} N/m }}\n");
            model += &format!("damper d{i}_{number}: {end} -- m{i} {{ c = {c} N*s/m }}\n");
            join(&mut springs, k, other, i);
            join(&mut dampers, c, other, i);
        }
    }
    model += &format!("force F: m0 along x\noutput y = m{}.x\n", N - 1);
    let (answer, status, told) = told(&model, "transfer", &["--range", "0.01Hz..0.5Hz"]);
    let pair = &answer["pairs"][0];
    assert!(status == Some(0) && pair["complete"] == true, "{told}");
    let size = |hertz: f64| {
        let omega = 2.0 * std::f64::consts::PI * hertz;
        let entry = |i: usize, j: usize| {
            let inertia = if i == j { omega * omega * masses[i] } else { 0.0 };
            [springs[i][j] - inertia, omega * dampers[i][j]]
        };
        last_of_solution((0..N).map(|i| (0..N).map(|j| entry(i, j)).collect()).collect())
    };
    let grid: Vec<f64> = (0..=1500).map(|i| 0.01 * 50f64.powf(f64::from(i) / 1500.0)).collect();
    let sizes: Vec<f64> = grid.iter().map(|&f| size(f)).collect();
    let turns = sizes.windows(3).enumerate().filter_map(|(i, size)| {
        let peak = size[1] > size[0] && size[1] > size[2];
        let valley = size[1] < size[0] && size[1] < size[2];
        (peak || valley).then_some((if peak { "peak" } else { "antiresonance" }, i))
    });
    let turns: Vec<(&str, usize)> = turns.collect();
    let extrema = pair["extrema"].as_array().expect("a list");
    assert_eq!(extrema.len(), turns.len(), "{told}");
    for (extremum, (kind, i)) in extrema.iter().zip(turns) {
        let hertz = extremum["frequency_hz"].as_f64().expect("a number");
        assert!(extremum["kind"] == kind && (grid[i]..=grid[i + 2]).contains(&hertz), "{extremum} {}", grid[i + 1]);
        let gain = extremum["gain"].as_f64().expect("a number");
        assert!((size(hertz) / gain - 1.0).abs() < 1e-9, "{extremum}");
        assert!(extremum["gain_error_bound"].as_f64().expect("a bound") < 1e-12, "{extremum}");
        // |H| is its peak over the root of 2 at two points that are so far apart; at least one of them within this distance.
        if let Some(width) = extremum["width_hz"].as_f64() {
            let least = size(hertz - width).min(size(hertz + width));
            assert!(least <= gain / 2f64.sqrt() * (1.0 + 1e-9), "{extremum}");
        }
    }
}

/// The modulus of the last entry of Q^-1 e_1: elimination of complex numbers with pivots.
fn last_of_solution(mut q: Vec<Vec<[f64; 2]>>) -> f64 {
    let n = q.len();
    for (i, row) in q.iter_mut().enumerate() {
        row.push([if i == 0 { 1.0 } else { 0.0 }, 0.0]);
    }
    let square = |z: [f64; 2]| z[0] * z[0] + z[1] * z[1];
    let over = |a: [f64; 2], b: [f64; 2]| {
        let d = square(b);
        [(a[0] * b[0] + a[1] * b[1]) / d, (a[1] * b[0] - a[0] * b[1]) / d]
    };
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| square(q[a][k]).total_cmp(&square(q[b][k]))).expect("a row");
        q.swap(k, pivot);
        for i in k + 1..n {
            let f = over(q[i][k], q[k][k]);
            let pivot = q[k].clone();
            for (entry, x) in q[i].iter_mut().zip(&pivot).skip(k) {
                entry[0] -= f[0] * x[0] - f[1] * x[1];
                entry[1] -= f[0] * x[1] + f[1] * x[0];
            }
        }
    }
    square(over(q[n - 1][n], q[n - 1][n - 1])).sqrt()
}

/// Three springs at angles of 120 degrees: by symmetry a force along x moves nothing along y, although the enclosed
/// sines of the drawing leave 1e-24 open. The rest is rounding error, which must have no peaks.
#[test]
fn responses_that_may_be_zero_have_no_extrema() {
    let answer = ask("body drum { mass = 40 kg, shape = disk(0.25 m), at = (0, 0), free }
        repeat i in 0..2 {
            point A[i] = (0.25 m * cos(i * 120 deg + 10 deg), 0.25 m * sin(i * 120 deg + 10 deg))
            spring s[i]: ground@(2 * A[i]) -- drum@A[i] { k = 5 kN/m, preload = 200 N }
            damper d[i]: ground@(2 * A[i]) -- drum@A[i] { c = 150 N*s/m }
        }
        force F: drum along x
        output x = drum.x
        output y = drum.y");
    let system = &answer.lowered.system;
    let (along, across) = (table_of(system, 0, 0), table_of(system, 0, 1));
    assert!(across.rows.iter().all(|row| row.gains[0][0].disc().is_some_and(|disc| disc.relative_error() >= 0.1)));
    assert!(extrema(&across).list.is_empty(), "{:?}", extrema(&across).list);
    assert!(extrema(&along).list.iter().any(|extremum| extremum.kind == FeatureKind::Peak));
}

/// The output for the absorber: text, and the format of the CSV and the JSON.
#[test]
fn tables_are_printed() {
    let system = with_every_pair(HardCase::load("o25_absorber_antiresonance").system);
    let table = table_of(&system, 0, 0);
    insta::assert_snapshot!(report::all_laid_out(
        &answers::report::transfer("absorber", &system, &table),
        report::WIDTH
    ));
    let modes = analysis::modes(&system).expect("a regular system");
    let poles = analysis::poles(&system, &modes).expect("poles");
    let at = ["0", "1.5", "1.6"].map(|f| Frequency::hertz(&number(f))).to_vec();
    let sweep = Sweep { inputs: vec![0], outputs: vec![0, 1], at, ..Sweep::default() };
    let table = analysis::table(&Methods::of(&system, &modes), &poles, &sweep).expect("a small table");
    insta::assert_snapshot!(vibc::backend::transfer::csv(&system, &table));
    insta::assert_snapshot!(vibc::backend::transfer::json("absorber", &system, &table));
    insta::assert_snapshot!(report::all_laid_out(
        &answers::report::transfer("absorber", &system, &table),
        report::WIDTH
    ));
    // An undamped system at rest with a rigid motion.
    let mut b = Builder::numbered(1);
    b.mass(0, &number("2"));
    let free = with_every_pair(b.finish());
    let sweep = Sweep {
        inputs: vec![0],
        outputs: vec![0],
        at: [0, 1].map(|f| Frequency::hertz(&Number::from(f))).to_vec(),
        ..Sweep::default()
    };
    let modes = analysis::modes(&free).expect("a regular system");
    let poles = analysis::poles(&free, &modes).expect("poles");
    insta::assert_snapshot!(vibc::backend::transfer::csv(
        &free,
        &analysis::table(&Methods::of(&free, &modes), &poles, &sweep).expect("a small table")
    ));
}

/// Three methods for the receptances of a proportionally damped chain agree within their bounds.
#[test]
fn sums_over_modes_agree_with_solutions() {
    let system = with_every_pair(super::systems::chain(8, "10", "100000", "50"));
    let modes = analysis::modes(&system).expect("a regular system");
    let poles = analysis::poles(&system, &modes).expect("poles");
    let methods = Methods::of(&system, &modes);
    let at: Vec<Frequency> = (1..40).map(|i| Frequency::hertz(&(&Number::from(i) / &Number::from(2)))).collect();
    let table = |tolerance| {
        let sweep = Sweep { inputs: vec![0, 3], outputs: vec![3, 7], at: at.clone(), tolerance, ..Sweep::default() };
        analysis::table(&methods, &poles, &sweep).expect("a small table")
    };
    let direct = Transfer::of(&system);
    for (tolerance, table) in [(1e-12, table(Some(1e-12))), (1e-17, table(None))] {
        for row in &table.rows {
            let truth = direct.between(&Frequency::hertz(&row.frequency), &[0, 3], &[3, 7]);
            for (gain, truth) in row.gains.iter().flatten().zip(truth.iter().flatten()) {
                let (gain, truth) = (gain.disc().expect("finite"), truth.disc().expect("finite"));
                assert!((gain.value - truth.value).to_f64().abs() <= gain.radius + truth.radius);
                assert!(gain.relative_error() <= tolerance);
            }
        }
    }
}

/// From one end to the other and back, H has the same value, in a band full of resonances; at rest it is that of the
/// springs.
#[test]
fn a_chain_of_two_thousand_answers_both_ways_alike() {
    let n = 2000;
    let system = with_every_pair(super::systems::chain(n, "1", "1000", "0.001"));
    let transfer = Transfer::of(&system);
    let frequency = Frequency::hertz(&number("3.3"));
    let there = transfer.between(&frequency, &[100], &[1700])[0][0].disc().expect("finite");
    let back = transfer.between(&frequency, &[1700], &[100])[0][0].disc().expect("finite");
    assert!((there.value - back.value).to_f64().abs() <= there.radius + back.radius);
    assert!(there.relative_error() < 1e-15, "{:e}", there.relative_error());
    // At rest: n - i + 1 springs on one side, i on the other.
    let rest = transfer.between(&Frequency::hertz(&Number::ZERO), &[499], &[499])[0][0].disc().expect("finite");
    let expected = 500.0 * 1501.0 / 2001.0 / 1000.0;
    assert!((rest.value.re.to_f64() / expected - 1.0).abs() < 1e-15);
}

/// A value too small for binary64 is not reported as zero, nor is one whose square is too small.
#[test]
fn a_value_below_the_range_is_no_zero() {
    let table = |text: &str, hertz: &str| {
        let mut sources = vibc::base::Sources::new();
        let model = sources.add(vibc::base::SourceFile::model("tiny.vib", text));
        let dynamics = vibc::dynamics(&sources, model, &Default::default()).answer.expect("a system");
        let gain = analysis::Transfer::of(&dynamics.system).at(&Frequency::hertz(&number(hertz)))[0][0];
        gain.disc().map(|disc| (disc.gain(), disc.relative_error()))
    };
    // Two masses on a soft spring, far above resonance: k / (m1 m2 omega^4) * omega^2 is 3e-884 m/s^2 for 1 N.
    let soft = "body a { mass = 2e292 kg, moves x }\nbody b { mass = 4e291 kg, moves x }\nspring k: a -- b { k = 6e-295 N/m }\n\
                force F: a along x\noutput y = b.ax\n";
    assert!(table(soft, "75.6").is_none_or(|(_, error)| error > 0.0));
    // k alone: 1 / 3e290 m/N, exact at 0 Hz.
    let stiff = "body a { mass = 1 kg, moves x }\nspring k: ground -- a { k = 3e290 N/m }\nforce F: a along x\noutput y = a.x\n";
    let (gain, error) = table(stiff, "1e-3").expect("a value");
    assert!(error < 1e-20 && (gain.to_f64() * 3e290 - 1.0).abs() < 1e-15, "{gain:?}");
}

/// The receptance of a model at a frequency, with its bound; references have 40 digits.
fn receptance(text: &str, hertz: &str, truth: (&str, &str)) {
    let mut sources = vibc::base::Sources::new();
    let model = sources.add(vibc::base::SourceFile::model("modal.vib", text));
    let dynamics = vibc::dynamics(&sources, model, &Default::default()).answer.expect("a system");
    let gain = Transfer::of(&dynamics.system).at(&Frequency::hertz(&number(hertz)))[0][0];
    check(hertz, gain, &(number(truth.0), number(truth.1)));
}

/// 1e13 of an acceleration reaches the far mass: what the computed mode shapes are off by is in the bound. References:
/// sums over the modes in mpmath with 120 digits.
#[test]
fn damping_by_modes_is_within_the_bound_between_weakly_joined_masses() {
    let text = "body b0 { mass = 0.5 kg, moves x }\nbody b1 { mass = 0.003 kg, moves x }\n\
        body b2 { mass = 40 kg, moves x }\nbody b3 { mass = 300 kg, moves x }\n\
        spring k0: b0 -- b1 { k = 1000 N/m }\nspring k1: b1 -- b2 { k = 0.04 N/m }\n\
        spring k2: b2 -- b3 { k = 0.0014 N/m }\nspring k3: ground -- b0 { k = 690 N/m }\n\
        spring k4: ground -- b3 { k = 0.4 N/m }\nforce F: b1 along x\noutput y = b3.ax\ndamping modal 1\n";
    let near =
        ("2.79105839299219143395795052848672904987264442e-17", "-5.73509240032692042890836360053761187714585846e-13");
    receptance(text, "92.1663583350", near);
    let far =
        ("9.0911842387486996974927679588019877936245283e-14", "-1.76378252360261424875718972787631449424252876e-11");
    receptance(text, "3", far);
}

/// The answer of the program to a model, as JSON, and its exit status with what it says.
fn told(model: &str, command: &str, options: &[&str]) -> (serde_json::Value, Option<i32>, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("model.vib");
    std::fs::write(&path, model).expect("a model");
    let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_vibc"));
    program.arg(command).arg(&path).args(["--format", "json", "--message-format", "json"]).args(options);
    let output = program.output().expect("the program runs");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (serde_json::from_slice(&output.stdout).unwrap_or_default(), output.status.code(), said)
}

/// An oscillator of 1e297 kg on 1e-297 N/m, whose omega^2 no binary64 number holds, has the values of the textbook:
/// H = 1 / (k - m w^2 + i w c), where m, c and k are powers of ten with w a multiple of 1e-297 rad/s.
#[test]
fn frequencies_whose_squares_leave_the_range_have_values() {
    let model = "model far\nbody m { mass = 1e297 kg, moves x }\nspring k: ground -- m { k = 1e-297 N/m }\n\
                 damper c: ground -- m { c = 0.5 N*s/m }\nforce F: m along x\noutput y = m.x\noutput v = m.vx\n";
    let at = ["--at", "1e-297 rad/s", "--at", "2e-297 rad/s", "--at", "1e-300 rad/s"];
    let (table, status, said) = told(model, "transfer", &at);
    assert_eq!(status, Some(0), "{said}");
    let rows = |output: usize| table["pairs"][output]["values"].as_array().expect("rows").clone();
    // In units of 1e297: 1 / (1 - n^2 + i n / 2) at n times 1e-297 rad/s.
    let truth = |n: f64| {
        let (a, b) = (1.0 - n * n, n / 2.0);
        (a / (a * a + b * b), -b / (a * a + b * b))
    };
    for (row, n) in rows(0).iter().zip([1.0, 2.0, 1e-3]) {
        let (re, im) = truth(n);
        let number = |field: &str| row[field].as_f64().unwrap_or_else(|| panic!("{n}: no {field}"));
        let off = (number("re") / 1e297 - re).hypot(number("im") / 1e297 - im) / re.hypot(im);
        assert!(off < 1e-15 && number("error_bound") < 1e-15, "{n}: off by {off:e}, {row}");
    }
    for (row, n) in rows(1).iter().zip([1.0, 2.0, 1e-3]) {
        let (re, im) = truth(n);
        let number = |field: &str| row[field].as_f64().unwrap_or_else(|| panic!("{n}: no {field}"));
        // i w H, w = n 1e-297
        let off = (number("re") / n + im).hypot(number("im") / n - re) / re.hypot(im);
        assert!(off < 1e-15 && number("error_bound") < 1e-15, "{n}: off by {off:e}, {row}");
    }
}

/// A frequency that no binary64 number holds is said to be out of range; its end is not read as a unit.
#[test]
fn a_frequency_out_of_range_is_no_unit() {
    let model = "model far\nbody m { mass = 1 kg, moves x }\nspring k: ground -- m { k = 1 N/m }\n\
                 force F: m along x\noutput y = m.x\n";
    let (_, status, said) = told(model, "transfer", &["--at", "1.7973852322294102e-398Hz"]);
    assert_eq!(status, Some(2));
    assert!(said.contains("outside the range of binary64") && !said.contains("unit"), "{said}");
}

/// Springs of 1e300 N/m across springs of 1 N/m: even with 640 bits products of the stiff ones have nothing left of the soft ones. No
/// frequency is printed, and the warning says so.
#[test]
fn a_mesh_graded_beyond_all_digits_has_no_frequencies() {
    let mesh = |decades: i32| {
        format!(
            "model mesh\nrepeat i in 1..4 {{ repeat j in 1..6 {{ body b[i,j] {{ mass = 1 kg, moves x }} }} }}\n\
             repeat i in 2..4 {{ repeat j in 1..6 {{ spring h[i,j]: b[i-1,j] -- b[i,j] {{ k = 10^({decades}*(2*i-5)) * 1 N/m }} }} }}\n\
             repeat i in 1..4 {{ repeat j in 2..6 {{ spring v[i,j]: b[i,j-1] -- b[i,j] {{ k = 1 N/m }} }} }}\n\
             repeat i in 1..4 {{ spring g[i]: ground -- b[i,1] {{ k = 1 N/m }} }}\n"
        )
    };
    let (beyond, _, said) = told(&mesh(100), "analyze", &["--modes", "3"]);
    assert!(said.contains("vib::limit::tolerance"), "{said}");
    for mode in beyond["modes"].as_array().expect("modes") {
        assert!(mode["frequency_hz"].is_null() && mode["omega_error_bound"].is_null(), "{mode}");
    }
    let report = super::program::text(&mesh(100), &["analyze", "--modes", "3"]);
    assert!(report.contains("modes 1 to 3: no bound of their frequencies is known"), "{report}");
    assert!(!report.contains("cluster"), "{report}");
    // Within the digits the frequencies of all rows of a mesh are those of one row: 2 sin((2 n - 1) pi / 26).
    let least = 2.0 * (std::f64::consts::PI / 26.0).sin() / (2.0 * std::f64::consts::PI);
    for (decades, route) in [(3, "star-mesh"), (20, "counted"), (40, "counted")] {
        let (within, _, said) = told(&mesh(decades), "analyze", &["--modes", "1"]);
        assert_eq!(said, "", "{decades}");
        let found = within["modes"][0]["frequency_hz"].as_f64().expect("a frequency");
        assert!((found / least - 1.0).abs() < 1e-14, "{found} {least}");
        assert_eq!(within["modes"][0]["route"], route);
    }
}

/// Limits of transfer functions at frequencies where Q is singular: real parts, imaginary parts, or infinite.
#[track_caller]
fn has_limits(model: &str, at: &str, truth: &[Option<(f64, f64)>]) {
    let (table, status, said) = told(model, "transfer", &["--at", at]);
    assert_eq!(status, Some(0), "{said}");
    let pairs = table["pairs"].as_array().expect("pairs");
    assert_eq!(pairs.len(), truth.len());
    for (pair, truth) in pairs.iter().zip(truth) {
        let row = &pair["values"][0];
        match truth {
            None => assert_eq!(row["infinite"], true, "{pair}"),
            Some((re, im)) => {
                let number = |field: &str| row[field].as_f64().unwrap_or_else(|| panic!("no {field}: {pair}"));
                let (off, size) = ((number("re") - re).hypot(number("im") - im), re.hypot(*im));
                // A bound of what is printed, and two roundings of the closed form.
                assert!(number("error_bound") < 1e-16 && off <= 3e-16 * size, "off by {off:e}: {pair}");
            }
        }
    }
}

/// Nothing holds these scenes at rest. A free mass m has x/F = 1/(m s^2): a/F = 1/m. With a damper to the ground
/// v/F = 1/c; a base that moves a mass through a damper alone carries it along.
#[test]
fn motions_that_nothing_holds_have_their_limits_at_rest() {
    let outputs = "output x = b.x\noutput v = b.vx\noutput a = b.ax\n";
    let mass = "body b { mass = 4 kg, moves x }\n";
    has_limits(&format!("{mass}force F: b along x\n{outputs}"), "0Hz", &[None, None, Some((0.25, 0.0))]);
    let damped = format!("{mass}damper d: ground -- b {{ c = 3 N*s/m }}\nforce F: b along x\n{outputs}");
    has_limits(&damped, "0Hz", &[None, Some((1.0 / 3.0, 0.0)), Some((0.0, 0.0))]);
    let carried = format!("base g {{ moves x }}\n{mass}damper d: g -- b {{ c = 3 N*s/m }}\n{outputs}");
    has_limits(&carried, "0Hz", &[Some((1.0, 0.0)), Some((0.0, 0.0)), Some((0.0, 0.0))]);
    // An inerter b from the base: x/u = b / (m + b) at every frequency.
    let inert = format!("base g {{ moves x }}\n{mass}inerter i: g -- b {{ b = 12 kg }}\n{outputs}");
    has_limits(&inert, "0Hz", &[Some((0.75, 0.0)), Some((0.0, 0.0)), Some((0.0, 0.0))]);
}

/// A torque T on the motor of a hoist turns it and the drum with one angular velocity of the belt. The damper c of the drum
/// takes c w = T R / r. Nothing accelerates, so the belt's spans, of stiffness 2 k, carry all of T: slip = T / (2 k r).
#[test]
fn a_hoist_that_a_damper_holds_slips_as_its_belt_is_stretched() {
    let model = "body drum { mass = 40 kg, shape = disk(0.3 m), at = (0, 0), turns }\n\
                 body motor { mass = 8 kg, shape = disk(0.08 m), at = (0.9 m, 0), turns }\n\
                 belt b: motor -- drum { k = 150 kN/m, preload = 200 N }\n\
                 damper d: ground -- drum { c = 2 N*m*s/rad }\ntorque T: motor = step(5 N*m, 0 s)\n\
                 output slip = motor.angle * 0.08 m - drum.angle * 0.3 m\noutput w = drum.omega\n\
                 require static(slip) < 1 mm\n";
    has_limits(model, "0Hz", &[Some((1.0 / (2.0 * 150e3 * 0.08), 0.0)), Some((0.3 / 0.08 / 2.0, 0.0))]);
    let (report, _, said) = told(model, "analyze", &[]);
    let slip = report["requirements"][0]["value"].as_f64().unwrap_or_else(|| panic!("no value: {said}"));
    assert!((slip * 24000.0 / 5.0 - 1.0).abs() < 1e-15, "{slip}");
}

/// A base moves a mass through k = 4 and an inerter of 1 kg: x/u = (4 + s^2) / (16 + 4 s^2) is 1/4 everywhere, at the
/// natural frequency of 2 rad/s too, and the velocity has 2 i / 4.
#[test]
fn a_resonance_that_an_inerter_cancels_has_its_limit() {
    let model = "base g { moves x }\nbody b { mass = 3 kg, moves x }\nspring s: g -- b { k = 4 N/m }\n\
                 inerter i: g -- b { b = 1 kg }\nspring t: ground -- b { k = 12 N/m }\noutput x = b.x\noutput v = b.vx\n";
    has_limits(model, "2 rad/s", &[Some((0.25, 0.0)), Some((0.0, 0.5))]);
    let held = model.replace("k = 4 ", "k = 5 ").replace("3 kg", "3.25 kg");
    has_limits(&held, "2 rad/s", &[None, None]);
}

/// A stiffness of (2 pi f)^2 m puts the resonance at f. The same masses and springs as in rational numbers, in a unit of time
/// that is pi times as long: lengths per force are 1/pi^2 times theirs.
#[test]
fn a_resonance_written_with_pi_is_exact() {
    let pi = std::f64::consts::PI;
    let tuned = "let k = (2*pi*1 Hz)^2 * 1 kg\nbody a { mass = 1 kg, moves x }\nspring s: ground -- a { k = k }\n\
                 force F: a along x\noutput x = a.x\n";
    has_limits(tuned, "1 Hz", &[None]);
    has_limits(&tuned.replace("1 kg\n", "2 kg\n"), "1 Hz", &[Some((1.0 / (4.0 * pi * pi), 0.0))]);
    // As with the inerter above, omega = 2 pi/s: the limit has no unit of time.
    let model = "let w2 = (pi / 1 s)^2\nbase g { moves x }\nbody b { mass = 3 kg, moves x }\nspring s: g -- b { k = 4 kg * w2 }\n\
                 inerter i: g -- b { b = 1 kg }\nspring t: ground -- b { k = 12 kg * w2 }\noutput x = b.x\noutput v = b.vx\n";
    has_limits(model, "1 Hz", &[Some((0.25, 0.0)), Some((0.0, 0.5 * pi))]);
    // Two free masses: nothing holds them, and a steady force on one accelerates both.
    let free = "let w2 = (pi / 1 s)^2\nbody a { mass = 1 kg, moves x }\nbody b { mass = 3 kg, moves x }\n\
                spring s: a -- b { k = 2 kg * w2 }\nforce F: a along x\noutput d = a.x - b.x\noutput acc = b.ax\noutput x = b.x\n";
    has_limits(free, "0 Hz", &[Some((0.375 / (pi * pi), 0.0)), Some((0.25, 0.0)), None]);
    // A root: omega^2 = 10 1/s^2.
    let root = tuned.replace("(2*pi*1 Hz)^2 * 1 kg", "10 N/m");
    let (report, ..) = told(&format!("{root}require gain(F -> x, sqrt(k / 1 kg) * 1 rad) < 1 m/N\n"), "analyze", &[]);
    assert_eq!(report["requirements"][0]["value_text"], "infinite", "{report}");
}

/// Loads in balance: +1 N and -1 N stretch the spring between two free bodies by F/k about their centre of mass. Dampers to
/// the ground and between the bodies leave nothing of it but the stretch of one body: the other ends where it began.
#[test]
fn loads_in_balance_have_a_final_value() {
    let value = |model: &str| {
        let (report, _, said) = told(model, "analyze", &[]);
        report["requirements"][0]["value"].as_f64().unwrap_or_else(|| panic!("no value: {said}"))
    };
    let free = "body a { mass = 1 kg, moves x }\nbody b { mass = 3 kg, moves x }\nspring w: a -- b { k = 2 N/m }\n\
                force F: a along x = step(1 N, 0 s)\nforce G: b along x = step(-1 N, 0 s)\n";
    assert_eq!(value(&format!("{free}output y = a.x\nrequire static(y) < 1 m\n")), 0.375);
    assert_eq!(value(&format!("{free}output y = a.x + 3*b.x\nrequire static(y) < 1 m\n")), 0.0);
    // m a'' + c a' + ... summed over both bodies: the momentum is zero, so a ends at 0 and b at -F/k.
    let damped = format!("{free}damper d: ground -- a {{ c = 1 N*s/m }}\ndamper e: a -- b {{ c = 1 N*s/m }}\n");
    assert_eq!(value(&format!("{damped}output y = a.x\nrequire static(y) < 1 m\n")), 0.0);
    assert_eq!(value(&format!("{damped}output y = b.x\nrequire static(y) < 1 m\n")), -0.5);
}

/// Values of which nothing is known are told once for each pair: springs of 1e36 N/m across springs of 1 N/m, none of them rational.
#[test]
fn values_that_are_not_known_are_told() {
    let mesh = |decades: i32| {
        format!(
            "repeat i in 1..4 {{ repeat j in 1..6 {{ body b[i,j] {{ mass = 1 kg, moves x }} }} }}\n\
             repeat i in 2..4 {{ repeat j in 1..6 {{ spring h[i,j]: b[i-1,j] -- b[i,j] {{ k = 10^({decades}*(2*i-5)) * sqrt(2) * 1 N/m }} }} }}\n\
             repeat i in 1..4 {{ repeat j in 2..6 {{ spring v[i,j]: b[i,j-1] -- b[i,j] {{ k = sqrt(3) * 1 N/m }} }} }}\n\
             repeat i in 1..4 {{ spring g[i]: ground -- b[i,1] {{ k = sqrt(5) * 1 N/m }} }}\n\
             force F: b[1,1] along x\noutput x = b[4,6].x\noutput y = b[1,1].x\n"
        )
    };
    let (table, status, said) = told(&mesh(12), "transfer", &["--at", "0.1Hz", "--at", "3Hz"]);
    assert_eq!(status, Some(0));
    for (pair, output) in table["pairs"].as_array().expect("pairs").iter().zip(["x", "y"]) {
        assert!(
            pair["values"].as_array().is_some_and(|values| values.iter().all(|value| value["re"].is_null())),
            "{pair}"
        );
        let told = format!("nothing is known of 2 of the 2 values of `{output}` from `F`, the first at 0.1 Hz");
        assert!(said.contains(&told), "{said}");
    }
    assert_eq!(said.matches("vib::limit::transfer").count(), 2, "{said}");
    // Known to seven digits in one value, to all in the others.
    let (table, _, said) = told(&mesh(8), "transfer", &["--at", "0.1Hz", "--at", "3Hz"]);
    assert!(said.is_empty() && table["pairs"][0]["values"][0]["re"].is_number(), "{said}");
}
