//! The motion in time: the hard cases, published cases and closed forms, each with its bound.

use super::systems::{Builder, HardCase, number};
use super::transfer::with_every_pair;
use vibc::analysis::{Signal, respond};
use vibc::answers;
use vibc::backend::report;
use vibc::base::{Ball, Number, Rational};
use vibc::system::{CoordinateId, Course, Input, LinearSystem, Nature, Table};

fn n(text: &str) -> Number {
    number(text)
}

/// Displacement and velocity of each coordinate as outputs, and a force on each as input.
fn observed(system: LinearSystem) -> LinearSystem {
    let mut system = with_every_pair(system);
    for i in 0..system.n() {
        let mut velocity = system.outputs[i].clone();
        velocity.p.swap(0, 1);
        system.outputs.push(velocity);
    }
    system
}

/// Checks the references `x[..]@t=` and `v[..]@t=` of a case with a prefix, to `digits` digits of the largest at each
/// time.
fn check_case(name: &str, prefix: &str, initial: &[&str], drive: Option<Signal>, digits: f64) {
    let case = HardCase::load(name);
    let mut system = observed(case.system.clone());
    system.initial = (initial.iter().enumerate()).map(|(i, x)| (CoordinateId(i as u32), n(x), Number::ZERO)).collect();
    let drives: Vec<Vec<Signal>> = vec![drive.into_iter().collect()];
    let names = case.system.coordinate_names();
    let texts = times(&case, prefix);
    assert!(!texts.is_empty(), "{name} {prefix}");
    let at: Vec<Number> = texts.iter().map(|text| exact(text)).collect();
    let history = respond(&system, &drives, &at).expect("a motion");
    for (text, values) in texts.iter().zip(&history.values) {
        for (offset, letter) in [(0, "x"), (names.len(), "v")] {
            let truths: Vec<Number> = (names.iter())
                .map(|c| case.reference(&format!("{prefix}{letter}[{c}]@t={text}")).expect("all coordinates"))
                .collect();
            let size = truths.iter().map(|x| x.to_f64().abs()).fold(0.0, f64::max);
            for (i, truth) in truths.iter().enumerate() {
                check(
                    &format!("{name} {prefix}{letter}[{}]@t={text}", names[i]),
                    values[offset + i],
                    truth,
                    size,
                    digits,
                );
            }
        }
    }
}

fn times(case: &HardCase, prefix: &str) -> Vec<String> {
    let mut texts: Vec<String> = Vec::new();
    for reference in case.json["reference"].as_array().expect("a list") {
        let id = reference["id"].as_str().expect("an id");
        let Some((_, time)) =
            id.strip_prefix(prefix).filter(|id| id.starts_with("x[")).and_then(|id| id.split_once("@t="))
        else {
            continue;
        };
        if texts.iter().all(|known| known != time) {
            texts.push(time.to_string());
        }
    }
    texts.sort_by(|a, b| exact(a).to_f64().total_cmp(&exact(b).to_f64()));
    texts
}

/// The literal as rounded to binary64.
fn exact(text: &str) -> Number {
    Number::from(Rational::from_f64(text.parse().expect("a number")).expect("finite"))
}

fn check(what: &str, value: Ball, truth: &Number, size: f64, digits: f64) {
    let (error, holds) = super::systems::error(value, truth, 1e-34 * size);
    assert!(holds, "{what}: error {error:e}, bound {:e}", value.rad);
    assert!(error <= 10f64.powf(-digits) * size, "{what}: {} digits", -(error / size).log10());
    assert!(value.rad <= 10f64.powf(-digits) * size, "{what}: bound {:e}", value.rad / size);
}

/// amplitude cos(omega t) as a harmonic in Hz.
fn cosine(amplitude: &str, omega: &str) -> Signal {
    Signal::Harmonic {
        value: exact(amplitude),
        frequency: &exact(omega) / &(&Number::pi() * &Number::from(2)),
        phase: &Number::pi() / &Number::from(2),
        at: Number::ZERO,
    }
}

#[test]
fn through_critical_damping() {
    check_case("o12_critical_sdof", "", &["1"], None, 15.0);
    check_case("o13_near_critical_sdof", "", &["1"], None, 15.0);
    check_case("o32_nearcritical_2dof", "", &["1", "0"], None, 15.0);
}

#[test]
fn damping_that_is_not_proportional() {
    check_case("o15_nonproportional_2dof", "", &["1", "0"], None, 15.0);
}

#[test]
fn a_million_periods_keep_their_phase() {
    check_case("o27_long_phase", "", &["1", "0"], None, 15.0);
}

#[test]
fn rates_nine_decades_apart() {
    check_case("o28_stiff_transient", "", &["1", "0"], None, 15.0);
}

#[test]
fn exact_resonance_and_a_beat_of_a_thousand_years() {
    check_case("o30_resonant_forcing", "res_", &[], Some(cosine("1", "2")), 15.0);
    check_case("o30_resonant_forcing", "beat_", &[], Some(cosine("1", "2.0000000002")), 15.0);
}

#[test]
fn a_tiny_force_next_to_a_preload() {
    check_case("o22_preload_tiny_dynamics", "dyn_", &[], Some(cosine("1e-12", "10")), 15.0);
}

#[test]
fn a_cart_with_a_pendulum_under_a_harmonic_force() {
    check_case("o29_seed_cart", "", &["0", "0.125"], Some(cosine("3", "6")), 15.0);
}

/// m x'' + c x' + k x = f, with displacement and velocity as outputs; released from x0 with v0.
fn oscillator(m: &str, c: &str, k: &str, x0: &str, v0: &str) -> LinearSystem {
    let mut b = Builder::numbered(1);
    b.mass(0, &n(m));
    b.stiffness("spring", Nature::Property, &n(k), &[(0, Number::ONE)]);
    b.damper(None, 0, &n(c));
    let mut system = observed(b.finish());
    system.initial = vec![(CoordinateId(0), n(x0), n(v0))];
    system
}

/// x and v of an oscillator at some times.
fn motion(system: &LinearSystem, drive: Vec<Signal>, times: &[&str]) -> Vec<Vec<Ball>> {
    let times: Vec<Number> = times.iter().map(|t| n(t)).collect();
    let history = respond(system, &[drive], &times).expect("a motion");
    assert!(history.values.iter().flatten().all(|value| value.rad < 1e-15), "{:?}", history.values);
    history.values
}

fn near(value: Ball, expected: f64, relative: f64) {
    assert!((value.to_f64() - expected).abs() <= relative * expected.abs(), "{value:?}, not {expected}");
}

/// S05 of the published cases (VM71), recomputed there to 12 digits.
#[test]
fn a_released_mass_with_four_dampers() {
    let expected = [
        ("3.52636", 0.474197550091),
        ("1.76318", 0.189984425663),
        ("0.352636", -0.521085224393),
        ("0", -0.996885351246),
    ];
    for (c, x) in expected {
        let system = oscillator("0.02590673", c, "30", "1", "0");
        near(motion(&system, Vec::new(), &["0.09"])[0][0], x, 1e-11);
    }
}

/// S08 (VM74): an impulse of 10 on a resting mass.
#[test]
fn an_impulse_starts_a_resting_mass() {
    let impulse = || vec![Signal::Impulse { value: n("10"), at: Number::ZERO }];
    let free = motion(&oscillator("0.5", "0", "200", "0", "0"), impulse(), &["0", "0.08", "0.1"]);
    near(free[0][1], 20.0, 1e-15);
    near(free[1][0], 0.999573603042, 1e-11);
    near(free[2][0], 0.909297426826, 1e-11);
    near(motion(&oscillator("0.5", "14", "200", "0", "0"), impulse(), &["0.1"])[0][0], 0.341804301226, 1e-11);
}

/// S09 (VM75): a ramp force, and then a pulse as the difference of two ramps.
#[test]
fn a_force_that_comes_on() {
    let step = |at: &str| Signal::Step { value: n("200"), at: n(at) };
    near(motion(&oscillator("0.5", "0", "200", "0", "0"), vec![step("0")], &["0.2"])[0][0], 1.65364362086, 1e-11);
    let damped = oscillator("0.5", "10", "200", "0", "0");
    near(motion(&damped, vec![step("0")], &["0.2"])[0][0], 1.15312276841, 1e-11);
    let pulse = Signal::Pulse { value: n("200"), from: n("0.3"), to: n("0.45") };
    let off = Signal::Step { value: n("-200"), at: n("0.45") };
    let (a, b) = (motion(&damped, vec![pulse], &["0.4", "2"]), motion(&damped, vec![step("0.3"), off], &["0.4", "2"]));
    for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
        assert!((*a - *b).contains_zero());
    }
}

/// C05 (VM182): two masses, 50 on the first for 1.8 s.
#[test]
fn a_pulse_on_two_masses() {
    let mut b = Builder::numbered(2);
    b.mass(0, &n("2"));
    b.mass(1, &n("2"));
    b.spring(None, 1, &n("16"));
    b.spring(Some(1), 0, &n("6"));
    let system = observed(b.finish());
    let pulse = vec![Signal::Pulse { value: n("50"), from: Number::ZERO, to: n("1.8") }];
    let y = motion(&system, pulse, &["1.3", "2.4"]);
    for (value, expected) in [(y[0][0], 14.4771506332843), (y[0][1], 3.98714923370)] {
        near(value, expected, 1e-11);
    }
    for (value, expected) in [(y[1][0], 18.3216436917909), (y[1][1], 6.13659864878)] {
        near(value, expected, 1e-11);
    }
}

/// C11 (SDLD22): a unit force on the fourth of eight masses for a second, recomputed to 12 digits.
#[test]
fn a_pulse_on_a_chain() {
    let system = observed(super::systems::chain(8, "10", "100000", "50"));
    let mut drives = vec![Vec::new(); 8];
    drives[3] = vec![Signal::Pulse { value: Number::ONE, from: Number::ZERO, to: Number::ONE }];
    let times = ["0.090", "0.184", "0.272", "1.452"].map(n);
    let history = respond(&system, &drives, &times).expect("a motion");
    let expected = [4.02320253820e-5, 4.01919354435e-6, 3.90032003172e-5, -2.65500629277e-5];
    for (values, expected) in history.values.iter().zip(expected) {
        near(values[3], expected, 1e-10);
        assert!(values[3].relative_error() < 1e-20);
    }
}

/// Problem 6 of the course: five periods after the shot, exp(-10 pi zeta / sqrt(1 - zeta^2)) = 0.73 of the amplitude is
/// left.
#[test]
fn the_mortar_oscillates_and_comes_to_rest() {
    let x0 = &(&n("25") * &n("9.81")) / &n("15791");
    let mut system = oscillator("10000", "251.33", "15791", "0", "0");
    system.initial = vec![(CoordinateId(0), x0.clone(), n("0.375"))];
    let (w2, a) = (1.5791f64, 251.33 / 20000.0);
    let wd = (w2 - a * a).sqrt();
    let closed =
        |t: f64| (-a * t).exp() * (x0.to_f64() * (wd * t).cos() + (0.375 + a * x0.to_f64()) / wd * (wd * t).sin());
    let rows = motion(&system, Vec::new(), &["1", "7.5", "60"]);
    for (row, t) in rows.iter().zip([1.0, 7.5, 60.0]) {
        near(row[0], closed(t), 1e-12);
    }
    let ratio = (-a * 10.0 * std::f64::consts::PI / wd).exp();
    assert!((ratio - 0.73).abs() < 1e-3);
}

/// A free mass under a steady force, one that falls off a hill, and a massless plate in oil.
#[test]
fn rigid_diverging_and_creeping_motions() {
    let step = || vec![Signal::Step { value: n("3"), at: Number::ZERO }];
    let mut b = Builder::numbered(1);
    b.mass(0, &n("2"));
    let free = observed(b.finish());
    let y = &motion(&free, step(), &["4"])[0];
    assert!((y[0] - Ball::from(12.0)).contains_zero() && (y[1] - Ball::from(6.0)).contains_zero());

    let falling = oscillator("1", "0", "-4", "1", "0");
    let y = &motion(&falling, Vec::new(), &["1.5"])[0];
    near(y[0], 3f64.cosh(), 1e-14);
    near(y[1], 2.0 * 3f64.sinh(), 1e-14);

    let mut b = Builder::numbered(1);
    b.stiffness("spring", Nature::Property, &n("6"), &[(0, Number::ONE)]);
    b.damper(None, 0, &n("2"));
    let y = &motion(&observed(b.finish()), step(), &["0.7"])[0];
    near(y[0], 0.5 * (1.0 - (-2.1f64).exp()), 1e-14);
    near(y[1], 1.5 * (-2.1f64).exp(), 1e-14);
}

/// A base that jumps gives the mass an impulse through the damper: dv = c J / m; one that rises in a ramp does not.
#[test]
fn a_base_that_jumps() {
    let mut system = oscillator("2", "3", "8", "0", "0");
    let at = |value: &str| vec![(CoordinateId(0), n(value))];
    let name = system.inputs[0].name;
    system.inputs =
        vec![Input { name, span: system.inputs[0].span, unit: "m", b: [at("8"), at("3"), Vec::new()], undamped: None }];
    let jump = Signal::Step { value: n("0.1"), at: n("0.5") };
    let y = motion(&system, vec![jump], &["0.4999", "0.5"]);
    assert!(y[0][0].is_zero() && y[0][1].is_zero());
    near(y[1][1], 0.15, 1e-15);
    let ramp = Signal::Ramp { value: n("0.1"), from: n("0.5"), to: n("0.6") };
    assert!(motion(&system, vec![ramp], &["0.5"])[0][1].is_zero());
}

/// A ramp as a signal, as a table, and (on a base) as a spline through points of a line.
#[test]
fn a_table_interpolates_its_rows() {
    let system = oscillator("1", "0.5", "9", "0", "0");
    let ramp = Signal::Ramp { value: n("6"), from: Number::ZERO, to: n("2") };
    let numbers = |list: &[&str]| list.iter().map(|text| n(text)).collect::<Vec<_>>();
    let table = |course| {
        let (times, values) = (numbers(&["0", "0.7", "2"]), numbers(&["0", "2.1", "6"]));
        Signal::Table(Table { times, values, course, period: None })
    };
    let times = ["0.3", "1.9", "5"];
    let expected = motion(&system, vec![ramp], &times);
    for course in [Course::Lines, Course::Spline] {
        let other = motion(&system, vec![table(course)], &times);
        for (a, b) in expected.iter().flatten().zip(other.iter().flatten()) {
            assert!((*a - *b).contains_zero(), "{a:?} {b:?}");
        }
    }
}

/// A chirp is divided into pieces according to the samples; two divisions agree within their bounds.
#[test]
fn a_chirp_is_followed_to_its_bound() {
    let system = oscillator("1", "0.5", "900", "0", "0");
    let chirp = || {
        vec![Signal::Chirp {
            value: n("2"),
            from: n("1"),
            to: n("10"),
            duration: n("3"),
            at: Number::ZERO,
            phase: Number::ZERO,
        }]
    };
    let fine = motion(&system, chirp(), &["0.1", "0.2", "0.3", "1.7", "4"]);
    let rough = motion(&system, chirp(), &["0.3", "1.7", "4"]);
    for (a, b) in fine[2..].iter().flatten().zip(rough.iter().flatten()) {
        assert!((*a - *b).contains_zero(), "{a:?} {b:?}");
        assert!(a.rad < 1e-15 && a.to_f64().abs() > 1e-6);
    }
}

#[test]
fn motions_are_printed() {
    let system = oscillator("0.5", "10", "200", "0.01", "0");
    let times = vibc::analysis::grid(&n("0.5"), &n("0.125"));
    let step = Signal::Step { value: n("200"), at: n("0.25") };
    let history = respond(&system, &[vec![step]], &times).expect("a motion");
    insta::assert_snapshot!(vibc::backend::simulation::csv(&system, &history, false));
    insta::assert_snapshot!(vibc::backend::simulation::json("oscillator", &system, &history, &[]));
    insta::assert_snapshot!(report::laid_out(
        &answers::report::motion("oscillator", &system, &history, &[]),
        report::WIDTH
    ));
}

/// S10 and S11 of the published cases (VM86, VM88): 10 N at 20 rad/s give 1/12 m. Also its printed form, and that of an
/// undamped oscillator at its own 2 rad/s.
#[test]
fn a_steady_state_is_reported() {
    let system = oscillator("0.5", "6", "200", "0", "0");
    let f = &n("20") / &(&Number::pi() * &n("2"));
    let force =
        |phase: &str| Signal::Harmonic { value: n("10"), frequency: f.clone(), phase: n(phase), at: Number::ZERO };
    let steady = |system: &LinearSystem, signal: Signal| {
        let transfer = vibc::analysis::Transfer::of(system);
        vibc::analysis::steady(&transfer, &[vec![signal]], &[0, 1])
    };
    let reported = steady(&system, force("0"));
    let (x, v) = (reported[0].outputs[0].disc().expect("finite"), reported[0].outputs[1].disc().expect("finite"));
    near(x.gain(), 1.0 / 12.0, 1e-15);
    near(v.gain(), 20.0 / 12.0, 1e-15);
    // Stiffness and inertia cancel: the motion is a quarter of a period late.
    assert!(x.value.re.to_f64().abs() < 1e-17 && x.value.im.to_f64() < 0.0);
    // The motion approaches it: at t = 20 s the transient is below exp(-120).
    let late = &motion(&system, vec![force("0.7")], &["20"])[0];
    let reported_late = steady(&system, force("0.7"))[0].outputs[0].disc().expect("finite");
    let (s, c) = Number::from(400).sin_cos().expect("in range");
    let value = reported_late.value.re.to_f64() * s.to_f64() + reported_late.value.im.to_f64() * c.to_f64();
    near(late[0], value, 1e-14);
    let history = respond(&system, &[vec![force("0.7")]], &[n("0"), n("20")]).expect("a motion");
    insta::assert_snapshot!(report::laid_out(
        &answers::report::motion("shaken", &system, &history, &reported),
        report::WIDTH
    ));
    insta::assert_snapshot!(vibc::backend::simulation::json("shaken", &system, &history, &reported));
    let undamped = oscillator("1", "0", "4", "0", "0");
    let own = Signal::Harmonic {
        value: n("1"),
        frequency: Number::pi().recip().expect("not zero"),
        phase: n("0"),
        at: Number::ZERO,
    };
    let reported = steady(&undamped, own);
    assert!(reported[0].outputs[0].disc().is_none());
}

/// What swings with a force is a steady state only where nothing grows: a damper that feeds energy in, or a spring that pushes
/// away, may leave no such state.
#[test]
fn a_steady_state_is_not_claimed_where_motions_may_grow() {
    let force = Signal::Harmonic { value: n("1"), frequency: n("0.3"), phase: n("0"), at: Number::ZERO };
    for (damping, stiffness, is_steady) in
        [("0.1", "4", true), ("0", "4", true), ("-0.1", "4", false), ("0.1", "-4", false)]
    {
        let system = oscillator("1", damping, stiffness, "0", "0");
        let drives = [vec![force.clone()]];
        let history = respond(&system, &drives, &[n("0"), n("1")]).expect("a motion");
        let steady = vibc::analysis::steady_alone(&system, &drives);
        let text = report::laid_out(&answers::report::motion("shaken", &system, &history, &steady), report::WIDTH);
        assert_eq!(text.contains("  steady state, without the free motion"), is_steady, "{text}");
        let json = vibc::backend::simulation::json("shaken", &system, &history, &steady);
        assert!(json.contains(&format!("\"nothing_grows\":{is_steady}")), "{json}");
        assert_eq!(text.contains("the free motion may grow"), !is_steady, "{text}");
    }
}

/// Random chains with random dampers under a step and a harmonic force: one long step and many short ones agree within
/// their bounds. The energy balance holds too: the work of the force is stored or dissipated, and no more.
#[test]
fn long_and_short_steps_agree_within_their_bounds() {
    // A linear congruential generator (Knuth, MMIX) with a fixed seed: the same scenes everywhere.
    let mut state = 2026u64;
    let mut random = |most: u64| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        1 + (state >> 33) % most
    };
    for _ in 0..12 {
        let size = 1 + random(3) as usize;
        let mut b = Builder::numbered(size);
        for i in 0..size {
            b.mass(i, &Number::from(random(9) as i64));
            b.spring(i.checked_sub(1), i, &Number::from(random(1_000_000) as i64));
            if random(3) > 1 {
                b.damper(i.checked_sub(1), i, &(&Number::from(random(5000) as i64) / &Number::from(100)));
            }
        }
        let system = observed(b.finish());
        let force = vec![
            Signal::Step { value: Number::from(random(7) as i64), at: n("0.25") },
            Signal::Harmonic {
                value: Number::ONE,
                frequency: Number::from(random(20) as i64),
                phase: n("0.3"),
                at: Number::ZERO,
            },
        ];
        let drives = [force];
        let rough = respond(&system, &drives, &[n("0.5"), n("2")]).expect("a motion");
        let fine = respond(&system, &drives, &vibc::analysis::grid(&n("2"), &n("0.125"))).expect("a motion");
        for (row, at) in rough.values.iter().zip([4, 16]) {
            for (a, b) in row.iter().zip(&fine.values[at]) {
                assert!((*a - *b).contains_zero(), "{a:?} {b:?}");
                assert!(a.rad < 1e-18);
            }
        }
    }
}

/// Random damped chains, two integrals by Simpson's rule on a fine grid. Energy: the work of a harmonic force is stored
/// or dissipated. Parseval: the integral of the squared impulse response over time is that of |H|^2 over frequency
/// (trapezoids, which are exact for a response that has decayed within the period of the grid's spacing; the tail of
/// |H|^2 is 1 / (m w^2)^2).
#[test]
fn energy_is_kept_and_parseval_holds() {
    let mut state = 77u64;
    let mut random = |most: u64| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        1 + (state >> 33) % most
    };
    let simpson = |values: &[f64], h: f64| -> f64 {
        let weight = |i: usize| if i == 0 || i + 1 == values.len() { 1.0 } else { [2.0, 4.0][i % 2] };
        values.iter().enumerate().map(|(i, y)| weight(i) * y).sum::<f64>() * h / 3.0
    };
    for _ in 0..4 {
        let size = 2 + random(2) as usize;
        let mut b = Builder::numbered(size);
        let (mut m, mut k, mut c) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..size {
            let (mass, spring, damper) = (random(3) as i64, 20 + random(60) as i64, 1 + random(2) as i64);
            b.mass(i, &Number::from(mass));
            b.spring(i.checked_sub(1), i, &Number::from(spring));
            b.damper(i.checked_sub(1), i, &Number::from(damper));
            m.push(mass as f64);
            k.push(spring as f64);
            c.push(damper as f64);
        }
        let system = observed(b.finish());
        let force = Signal::Harmonic { value: n("3"), frequency: n("0.7"), phase: Number::ZERO, at: Number::ZERO };
        let (h, times) = (1.0 / 256.0, vibc::analysis::grid(&n("4"), &n("0.00390625")));
        let rows = respond(&system, &[vec![force]], &times).expect("a motion").values;
        let value = |row: &Vec<Ball>, i: usize| row[i].to_f64();
        let between = |row: &Vec<Ball>, offset: usize, i: usize| {
            value(row, offset + i) - i.checked_sub(1).map_or(0.0, |j| value(row, offset + j))
        };
        let power =
            |(i, row): (usize, &Vec<Ball>)| 3.0 * (1.4 * std::f64::consts::PI * h * i as f64).sin() * value(row, size);
        let work = simpson(&rows.iter().enumerate().map(power).collect::<Vec<_>>(), h);
        let heat = |row: &Vec<Ball>| (0..size).map(|i| c[i] * between(row, size, i).powi(2)).sum::<f64>();
        let dissipated = simpson(&rows.iter().map(heat).collect::<Vec<_>>(), h);
        let last = rows.last().expect("samples");
        let stored: f64 =
            (0..size).map(|i| 0.5 * (m[i] * value(last, size + i).powi(2) + k[i] * between(last, 0, i).powi(2))).sum();
        assert!((work - dissipated - stored).abs() < 1e-7 * work.abs(), "{work} {dissipated} {stored}");

        let impulse = vec![Signal::Impulse { value: Number::ONE, at: Number::ZERO }];
        let times = vibc::analysis::grid(&n("128"), &n("0.0078125"));
        let rows = respond(&system, &[impulse], &times).expect("a motion").values;
        let over_time = simpson(&rows.iter().map(|row| value(row, 0).powi(2)).collect::<Vec<_>>(), 1.0 / 128.0);
        let (step, count) = (1.0 / 64.0, 20_000);
        let frequencies: Vec<vibc::analysis::Frequency> =
            (0..=count).map(|i| vibc::analysis::Frequency::radians(&(&Number::from(i) / &n("64")))).collect();
        let transfer = vibc::analysis::Transfer::of(&system);
        let gains = transfer.at_frequencies(&frequencies, &[0], &[0], 1e-12);
        let square = |i: usize| gains[i].disc().expect("damped").gain().to_f64().powi(2);
        let ends = 0.5 * (square(0) + square(count as usize));
        let sum = ends + (1..count as usize).map(square).sum::<f64>();
        let edge = f64::from(count as i32) * step;
        let over_frequency = (sum * step + 1.0 / (3.0 * m[0] * m[0] * edge.powi(3))) / std::f64::consts::PI;
        assert!((over_time / over_frequency - 1.0).abs() < 1e-6, "{over_time} {over_frequency}");
    }
}
