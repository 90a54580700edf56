//! Peaks and antiresonances: all of them, each at its place, with bounds that hold, and a report if that is not proved.
//!
//! Reference values: the numerator N and the denominator D of H by cofactors over the rationals, |H|^2 = A(x) / B(x)
//! with x = omega^2, the real roots of A' B - A B' enclosed at 300 bits, H there by Horner's scheme (python-flint 0.8).
//! They use no pivot, pole or mode.

use super::ask::ask;
use super::systems::chain;
use super::transfer::with_every_pair;
use vibc::analysis::{self, Extrema, FeatureKind, Frequency, Gain, Methods, Sweep, Table, Transfer};
use vibc::base::{Ball, Number, Rounded};
use vibc::system::LinearSystem;

fn table_of(system: &LinearSystem, range: Option<(&str, &str)>) -> Table {
    let modes = analysis::modes(system).expect("a regular system");
    let poles = analysis::poles(system, &modes).expect("poles");
    let range = range.map(|(low, high)| (Number::from(low), Number::from(high)));
    let last = system.outputs.len() - 1;
    let sweep = Sweep { range, inputs: vec![0], outputs: vec![last], ..Sweep::default() };
    analysis::table(&Methods::of(system, &modes), &poles, &sweep).expect("a small table")
}

fn extrema_of(text: &str, range: Option<(&str, &str)>) -> Extrema {
    let answer = ask(text);
    let table = table_of(&answer.lowered.system, range);
    table.extrema.expect("the default grid")[0][0].clone()
}

/// Compares with a reference of which 20 digits are given.
fn near(what: &str, reported: Ball, written: &str) {
    let truth = Number::from(written.trim_start_matches('-')).to_ball();
    let truth = if written.starts_with('-') { -truth } else { truth };
    let unit = 1e-19 * truth.to_f64().abs();
    assert!((reported - truth).mid.abs().to_f64() <= reported.rad + unit, "{what}: {reported:?}, not {written}");
    assert!(reported.relative_error() < 1e-18, "{what}: {:e}", reported.relative_error());
    // The printed number keeps its own bound.
    let printed = Rounded::of(reported).expect("finite");
    let error = (Ball::from(printed.value()) - truth).mid.abs().to_f64();
    assert!(
        error <= printed.bound().value() + unit && printed.bound().value() < 1.2e-16 * truth.to_f64().abs(),
        "{what}"
    );
}

fn check(text: &str, range: Option<(&str, &str)>, expected: &[(FeatureKind, &str, &str, &str)]) {
    let found = extrema_of(text, range);
    assert!(found.complete.is_some(), "open: {:?}", found.open);
    let kinds: Vec<FeatureKind> = found.list.iter().map(|extremum| extremum.kind).collect();
    assert_eq!(kinds, expected.iter().map(|expected| expected.0).collect::<Vec<_>>());
    for (extremum, (_, frequency, gain, phase)) in found.list.iter().zip(expected) {
        near("frequency", extremum.frequency, frequency);
        match (*gain, extremum.gain) {
            ("infinite", gain) => assert_eq!(gain, Gain::Infinite),
            ("0", gain) => assert!(gain.disc().is_some_and(|disc| disc.gain().is_zero())),
            (gain, reported) => {
                let disc = reported.disc().expect("finite");
                near("gain", disc.gain(), gain);
                if !phase.is_empty() {
                    near("phase", disc.phase().expect("an angle"), phase);
                }
            }
        }
    }
}

use FeatureKind::{Antiresonance, Peak};

#[test]
fn broad_extrema_of_damped_pairs_are_at_their_places() {
    let pair = |masses: [i32; 2], springs: [i32; 2], dampers: [&str; 2], rest: &str| {
        let [[a, b], [k, l]] = [masses, springs];
        let [c, d] = dampers;
        format!(
            "body b0 {{ mass = {a} kg, moves x }}
            body b1 {{ mass = {b} kg, moves x }}
            spring k0: ground -- b0 {{ k = {k} N/m }}
            spring k1: b0 -- b1 {{ k = {l} N/m }}
            damper c0: ground -- b0 {{ c = {c} N*s/m }}
            damper c1: b0 -- b1 {{ c = {d} N*s/m }}
            {rest}"
        )
    };
    let first = pair([9, 6], [7, 3], ["2", "0.5"], "force F: b1 along x\noutput y = b0.x - 2*b1.x");
    let expected = [
        (Peak, "0.08615917525091295849309760", "5.828016560375096311961", "97.50151963511572006503"),
        (Antiresonance, "0.1525572894891676120689058", "0.2646628129546630919365", "54.40775602141652037752"),
        (Peak, "0.1859898551253773834412556", "0.4595758930851612842214", "50.87628093110422135804"),
    ];
    check(&first, None, &expected);
    let second = pair([1, 8], [2, 3], ["5", "1"], "force F: b0 along x\noutput y = b1.x - 3*b0.x");
    let expected = [
        (Peak, "0.01481616964110704714139065", "1.000194641529376287558", "166.3955386030655330986"),
        (Antiresonance, "0.08058461822241646358643673", "0.1651465088441373177976", "119.8273828141680381831"),
        (Peak, "0.1397040403509600869610449", "0.3949545677649824227527", "137.2230584145757365887"),
    ];
    check(&second, Some(("0.01", "2")), &expected);
}

/// Four masses of 35 kg to 15 g; the second hangs on the first without a damper and stops it at its own frequency.
#[test]
fn a_zero_without_damping_is_exactly_zero() {
    let scene = "base z0 { moves x }
        body b0 { mass = 347e-1 kg, moves x }
        body b1 { mass = 200e-2 kg, moves x }
        body b2 { mass = 678e-3 kg, moves x }
        body b3 { mass = 150e-4 kg, moves x }
        spring k0: z0 -- b0 { k = 137e-3 N/m }
        spring k1: b0 -- b1 { k = 107e-2 N/m }
        spring k2: ground -- b2 { k = 594e-1 N/m }
        spring k3: ground -- b3 { k = 292e-2 N/m }
        spring k4: b0 -- b3 { k = 810e-4 N/m }
        damper c0: ground -- b0 { c = 714e-3 N*s/m }
        damper c1: b3 -- b2 { c = 936e-3 N*s/m }
        output y = b3.vx";
    let expected = [
        (Peak, "0.01220091817327495059337129", "0.005172531639656401363306", "-1.36555029007975662729474"),
        (Antiresonance, "0.1164118048660129525208648", "0", ""),
        (Peak, "0.1197558588920260827385513", "0.005037577632067433609743", "-13.2037717821658473651981"),
        (Antiresonance, "1.335945735149852874558388", "4.907491131616707570508e-6", "-133.845497837842415777105"),
        (Peak, "1.509630712462498464667287", "0.0001134734933887917896099", "-159.880616147313357205832"),
    ];
    check(scene, Some(("0.01", "10")), &expected);
}

/// Two zeros that a grid cannot separate, with a maximum between them.
#[test]
fn two_close_zeros_are_counted_twice() {
    let scene = "base z { moves x }
        body b0 { mass = 1 kg, moves x }
        spring s0: z -- b0 { k = 1 N/m }
        body b1 { mass = 1 kg, moves x }
        spring s1: z -- b1 { k = 9 N/m }
        body b2 { mass = 1 kg, moves x }
        spring s2: z -- b2 { k = 100 N/m }
        output y = (145/132)*b0.x - (11/156)*b1.x + (23/4290)*b2.x";
    let expected = [
        (Peak, "0.1591549430918953357688838", "infinite", ""),
        (Antiresonance, "0.3748212690550214631787657", "0.4196950286124185710704", "180.000000000000000"),
        (Peak, "0.4774648292756860073066513", "infinite", ""),
        (Antiresonance, "0.8717275246988208332290454", "0", ""),
        (Peak, "0.8788429594745308552834718", "5.673003841514970988653e-6", "180.000000000000000"),
        (Antiresonance, "0.8861372203152950333079649", "0", ""),
        (Peak, "1.591549430918953357688838", "infinite", ""),
    ];
    check(scene, None, &expected);
}

/// m = 1, k = 2, c = 2e-15: a peak of 1 / (c omega sqrt(1 - zeta^2)) at -90 degrees, of width c / m in rad/s.
#[test]
fn the_lightest_damping_has_its_peak() {
    let scene = "body a { mass = 1 kg, moves x }
        spring s: ground -- a { k = 2 N/m }
        damper d: ground -- a { c = 2e-15 N*s/m }
        force F: a along x
        output y = a.x";
    let found = extrema_of(scene, None);
    assert!(found.complete.is_some());
    let [peak] = &found.list[..] else { panic!("{found:?}") };
    // To 30 digits, zeta = 7e-16 has no effect.
    near("frequency", peak.frequency, "0.225079079039276517388799797752");
    let disc = peak.gain.disc().expect("finite");
    near("gain", disc.gain(), "353553390593273.76220042218105");
    near("phase", disc.phase().expect("an angle"), "-89.9999999999999594857657729302");
    near("width", peak.width.expect("a width"), "3.18309886183790671537767526745e-16");
}

/// The driving-point gain of a chain has a peak for each mode and a zero between each two; the gain to its last mass
/// has no zero, but a minimum between each two.
#[test]
fn a_chain_has_as_many_peaks_as_masses() {
    for (n, damping) in [(2, "0"), (6, "0"), (12, "0"), (5, "0.0001"), (9, "0.00001")] {
        let mut system = with_every_pair(chain(n, "1", "1000", damping));
        for last in [n, 1] {
            system.outputs.truncate(last);
            let table = table_of(&system, None);
            let found = &table.extrema.as_ref().expect("the default grid")[0][0];
            let count = |kind| found.list.iter().filter(|extremum| extremum.kind == kind).count();
            assert!(found.complete.is_some(), "{n} {damping}: {:?}", found.open);
            assert_eq!((count(Peak), count(Antiresonance)), (n, n - 1), "{n} {damping}");
            let stilled =
                |e: &&analysis::Extremum| e.kind == Antiresonance && e.gain.disc().is_some_and(|d| d.gain().is_zero());
            let still = found.list.iter().filter(stilled).count();
            assert_eq!(still, if damping == "0" && last == 1 { n - 1 } else { 0 }, "{n} {damping}");
        }
    }
}

/// Values next to the pole of an oscillator with a damping ratio of 5e-21, where double-double eliminations give no
/// information.
#[test]
fn values_near_very_lightly_damped_poles_are_reported() {
    let scene = "body a { mass = 1 kg, moves x }
        spring s: ground -- a { k = 1 N/m }
        damper d: ground -- a { c = 1e-20 N*s/m }
        force F: a along x
        output y = a.x";
    let answer = ask(scene);
    let at = |omega: &str| Transfer::of(&answer.lowered.system).at(&Frequency::radians(&Number::from(omega)))[0][0];
    // At its own frequency H is 1 / (i c).
    let disc = at("1").disc().expect("finite");
    near("im", -Ball::exact(disc.value.im).widen(disc.radius), "1e20");
    assert!(disc.relative_error() < 1e-18);
    // Without a damper it is infinite.
    let answer = ask(&scene.replace("damper d: ground -- a { c = 1e-20 N*s/m }", ""));
    let gain = Transfer::of(&answer.lowered.system).at(&Frequency::radians(&Number::ONE))[0][0];
    assert_eq!(gain, Gain::Infinite);
}

/// n masses of 1 kg between springs of 1000 N/m, the first of them to ground, and a damper of `c` from each to ground.
fn long_chain(n: usize, damper: &str, rest: &str) -> String {
    format!(
        "repeat i in 1..{n} {{
            body m[i] {{ mass = 1 kg, moves x }}
            {}
        }}
        spring k[1]: ground -- m[1] {{ k = 1000 N/m }}
        repeat i in 2..{n} {{
            spring k[i]: m[i-1] -- m[i] {{ k = 1000 N/m }}
        }}
        force F: m[1] along x
        {rest}",
        if damper.is_empty() { String::new() } else { format!("damper c[i]: ground -- m[i] {{ c = {damper} N*s/m }}") }
    )
}

/// |H| of that chain by a continued fraction: from the free end g = mu + k, then g = mu + 2 k - k^2 / g, H = 1 / g at
/// the first mass, times k / g for each further one at the last; mu = -omega^2 + i omega c.
fn of_long_chain(n: usize, c: f64, to_last: bool, hertz: f64) -> f64 {
    let omega = 2.0 * std::f64::consts::PI * hertz;
    let (re, im, k) = (-omega * omega, omega * c, 1000.0);
    let mut g = (re + k, im);
    let mut along = 1.0;
    for _ in 1..n {
        let norm = g.0 * g.0 + g.1 * g.1;
        along *= k / norm.sqrt();
        g = (re + 2.0 * k - k * k * g.0 / norm, im + k * k * g.1 / norm);
    }
    (if to_last { along } else { 1.0 }) / g.0.hypot(g.1)
}

/// Exactly the maxima and minima that 50,000 values show are reported, with correct values and widths.
#[test]
fn long_damped_chains_have_all_extrema_with_widths() {
    let (n, c, step) = (40, 0.1, 2.4e-4);
    for (to_last, output) in [(false, "output y = m[1].x"), (true, "output y = m[40].x")] {
        let found = extrema_of(&long_chain(n, "0.1", output), Some(("0.05", "12")));
        assert!(found.complete.is_some(), "{:?}", found.open);
        let size = |f: f64| of_long_chain(n, c, to_last, f);
        let values: Vec<f64> = (0..=49_791).map(|i| size(0.05 + step * i as f64)).collect();
        let turns = |w: &[f64]| (w[1] > w[0]) != (w[2] > w[1]);
        let expected: Vec<(f64, FeatureKind)> = (values.windows(3).enumerate())
            .filter(|(_, w)| turns(w))
            .map(|(i, w)| (0.05 + step * (i + 1) as f64, if w[1] > w[0] { Peak } else { Antiresonance }))
            .collect();
        assert_eq!(found.list.len(), expected.len(), "{output}");
        for (reported, (f, kind)) in found.list.iter().zip(expected) {
            let at = reported.frequency.to_f64();
            assert!(reported.kind == kind && (at - f).abs() < step, "{reported:?}, not {f}");
            let gain = reported.gain.disc().expect("finite").gain().to_f64();
            assert!((size(at) / gain - 1.0).abs() < 1e-10, "{reported:?}: {}", size(at));
            assert!(reported.frequency.relative_error() < 1e-20, "{reported:?}");
            let half = |sign: f64| {
                let above = |f: &f64| size(*f) > gain * 0.5f64.sqrt();
                let far = (1..2000).map(|i| at + sign * step * i as f64).find(|f| !above(f)).unwrap_or(f64::NAN);
                let (mut near, mut far) = (far - sign * step, far);
                for _ in 0..60 {
                    let middle = 0.5 * (near + far);
                    if above(&middle) { near = middle } else { far = middle }
                }
                near
            };
            if let Some(width) = reported.width {
                assert!((width.to_f64() / (half(1.0) - half(-1.0)) - 1.0).abs() < 1e-9, "{reported:?}");
            }
        }
        // At low frequencies, the peaks of the first mass are less than the root of 2 above the lowest value beside
        // them.
        let wide = found.list.iter().filter(|reported| reported.width.is_some()).count();
        assert!(wide >= 20, "{wide} of {}", found.list.len());
    }
}

/// Peaks at 2 sqrt(k/m) sin((2 j - 1) pi / (4 n + 2)), zeros of the first mass where that of n - 1 masses has its peaks.
#[test]
fn a_long_undamped_chain_has_its_textbook_poles_and_zeros() {
    let n = 64;
    let found = extrema_of(&long_chain(n, "", "output y = m[1].x"), None);
    assert!(found.complete.is_some(), "{:?}", found.open);
    let textbook = |n: usize, j: usize| {
        let angle = (2 * j + 1) as f64 * std::f64::consts::PI / (4 * n + 2) as f64;
        1000f64.sqrt() * angle.sin() / std::f64::consts::PI
    };
    assert_eq!(found.list.len(), 2 * n - 1);
    for (i, reported) in found.list.iter().enumerate() {
        let expected = textbook(n - i % 2, i / 2);
        assert!((reported.frequency.to_f64() / expected - 1.0).abs() < 1e-14, "{i}: {reported:?}, not {expected}");
        let exactly = if i % 2 == 0 {
            reported.kind == Peak && reported.gain == Gain::Infinite
        } else {
            reported.kind == Antiresonance && reported.gain.disc().is_some_and(|disc| disc.gain().is_zero())
        };
        assert!(exactly, "{i}: {reported:?}");
    }
}

/// A ring of unequal masses is not a tree. A driven mass has one zero between two poles of the undamped system; nothing
/// cancels because no two masses are equal.
#[test]
fn driving_point_extrema_are_complete_in_any_net() {
    let n = 20;
    let ring = |rest: &str| {
        format!(
            "repeat i in 1..{n} {{
                body m[i] {{ mass = (1 + i*i/50) * 1 kg, moves x }}
                spring g[i]: ground -- m[i] {{ k = 100 N/m }}
            }}
            spring k[1]: m[{n}] -- m[1] {{ k = 700 N/m }}
            repeat i in 2..{n} {{
                spring k[i]: m[i-1] -- m[i] {{ k = 1000 N/m }}
            }}
            {rest}"
        )
    };
    for rest in ["force F: m[3] along x\noutput y = m[3].vx", "force F: m[3] along x\noutput y = m[3].x"] {
        let found = extrema_of(&ring(rest), None);
        assert!(found.complete.is_some(), "{rest}: {:?}", found.open);
        assert_eq!(found.list.len(), 2 * n - 1, "{rest}");
        let alternate = |(i, reported): (usize, &analysis::Extremum)| {
            reported.kind == if i % 2 == 0 { Peak } else { Antiresonance }
        };
        assert!(found.list.iter().enumerate().all(alternate), "{rest}");
    }
    // To another mass two paths lead: the residues of the modes prove it, 20 infinite peaks with a minimum or a zero between two.
    let across = "force F: m[3] along x\noutput y = m[8].x";
    let found = extrema_of(&ring(across), None);
    assert!(found.complete.is_some(), "{:?}", found.open);
    assert_eq!(found.list.iter().filter(|reported| reported.gain == Gain::Infinite).count(), n);
    assert!(found.list.windows(2).all(|two| two[0].kind != two[1].kind));
    // With equal masses each frequency but two is there twice, and no mode has a residue of its own: nothing is proved.
    let equal = ring(across).replace("(1 + i*i/50)", "1");
    assert!(extrema_of(&equal, None).complete.is_none());
}

/// Masses that hang from one another, at a rest that no fraction gives: the poles are on the axis all the same, for no damper is there,
/// and a zero that rounding leaves at 1e14 Hz is no reason not to prove the others. With unit masses and lengths the
/// upper angle of a push at the lower end is g / (s^4 + 4 g s^2 + 2 g^2).
#[test]
fn extrema_about_a_rest_that_is_no_fraction_are_complete() {
    let text = std::fs::read_to_string("examples/double_pendulum.vib").expect("the example");
    let mut system = ask(&text).lowered.system;
    let of_last = |system: &LinearSystem| table_of(system, None).extrema.expect("the default grid")[0][0].clone();
    let lower = of_last(&system);
    system.outputs.truncate(1);
    let upper = of_last(&system);
    let g = Number::from("9.81");
    let root_two = Number::from(2).sqrt().expect("a number");
    let pole = |sign: i64| {
        let square = &g * &(&Number::from(2) + &(&Number::from(sign) * &root_two));
        hertz(square.sqrt().expect("a number").to_ball())
    };
    // Between the poles the upper angle is least; the lower one is zero where the upper mass alone would swing.
    let middle = hertz((&Number::from(2) * &g).sqrt().expect("a number").to_ball());
    for extrema in [&upper, &lower] {
        assert!(extrema.is_complete(), "{:?}", extrema.open);
        let kinds: Vec<FeatureKind> = extrema.list.iter().map(|extremum| extremum.kind).collect();
        assert_eq!(kinds, [Peak, Antiresonance, Peak]);
        for (extremum, truth) in extrema.list.iter().zip([pole(-1), middle, pole(1)]) {
            assert!((extremum.frequency - truth).contains_zero(), "{:?}, not {truth:?}", extremum.frequency);
            assert!(extremum.frequency.relative_error() < 1e-16, "{:?}", extremum.frequency);
        }
        assert_eq!([extrema.list[0].gain, extrema.list[2].gain], [Gain::Infinite; 2]);
    }
    let [gain, zero] = [upper, lower].map(|extrema| extrema.list[1].gain.disc().expect("a value").gain());
    assert!(zero.is_zero(), "{zero:?}");
    let truth = Ball::ONE / (Ball::from(2.0) * g.to_ball());
    assert!((gain - truth).contains_zero() && gain.relative_error() < 1e-16, "{gain:?}, not {truth:?}");
}

/// An inerter's force on a table on a moving floor, with k = m (2 pi 10 Hz)^2: m b w^4 / (k - (m + b) w^2), infinite at
/// w0^2 = k / (m + b) and least at sqrt(2) w0. That b k - b k is no term in s^2 is known to the last digits only.
#[test]
fn a_numerator_whose_lowest_coefficients_cancel_leaves_nothing_open() {
    let text = "model inerter\n\nlet k = 200 kg * (2 * pi * 10 Hz)^2\nbase floor { moves y }\n\
        body table { mass = 200 kg, moves y }\nspring s: floor -- table { k = k }\n\
        inerter b: floor -- table { b = k / (2 * pi * 30 Hz)^2 }\noutput push = b.force\n";
    let found = extrema_of(text, None);
    assert!(found.is_complete(), "{:?}", found.open);
    let [peak, least] = &found.list[..] else { panic!("{:?}", found.list) };
    assert_eq!([(peak.kind, peak.gain == Gain::Infinite), (least.kind, false)], [(Peak, true), (Antiresonance, false)]);
    // w0 = 2 pi 10 sqrt(0.9).
    let square = Number::from(90).to_ball();
    near("peak", peak.frequency, "9.4868329805051379960");
    assert!((least.frequency * least.frequency - square * Ball::from(2.0)).contains_zero());
    assert!(least.frequency.relative_error() < 1e-16, "{:?}", least.frequency);
    // m b w^4 / ((m + b) (w^2 - w0^2)) = 4 w0^2 m b / (m + b), m b / (m + b) = 20 kg.
    let truth = Ball::PI * Ball::PI * Ball::from(4.0) * square * Ball::from(80.0);
    let gain = least.gain.disc().expect("a value").gain();
    assert!((gain - truth).contains_zero() && gain.relative_error() < 1e-16, "{gain:?}, not {truth:?}");
}

/// A row of wagons, the last of which carries a mass on a spring of 1 t (2 pi 0.5 Hz)^2: the force in the last hook has a
/// double zero where two couplings let nothing through, zeros at rest, and no coefficient is a fraction. With 40 digits of
/// pi in place of pi they all are.
#[test]
fn double_zeros_of_numbers_that_are_no_fractions_leave_nothing_open() {
    let of = |stiffness: &str| {
        let mut text = format!("model row\n\nlet s = {stiffness}\nbody load {{ mass = 1 t, moves x }}\n");
        for i in 0..4 {
            text += &format!("body m{i} {{ mass = {} t, moves x }}\n", 4 - i);
        }
        for i in 1..4 {
            let before = i - 1;
            text += &format!("spring k{i}: m{before} -- m{i} {{ k = 300 kN/m }}\n");
            text += &format!("damper c{i}: m{before} -- m{i} {{ c = 5 kN*s/m }}\n");
        }
        text += "spring s: m3 -- load { k = s }\ndamper d: m3 -- load { c = 90 N*s/m }\n";
        text += "force F: m0 along x\noutput pull = k3.force\n";
        extrema_of(&text, Some(("0.1", "10")))
    };
    let (found, truth) = (of("1 t * (2 * pi * 0.5 Hz)^2"), of("9869.60440108935861883449099987615113531369 N/m"));
    assert!(found.is_complete() && truth.is_complete(), "{:?} {:?}", found.open, truth.open);
    assert!(truth.list.len() >= 4 && found.list.len() == truth.list.len(), "{:?} {:?}", found.list, truth.list);
    for (found, truth) in found.list.iter().zip(&truth.list) {
        assert_eq!(found.kind, truth.kind);
        let (frequency, gains) =
            (found.frequency - truth.frequency, [found, truth].map(|e| e.gain.disc().map(|d| d.gain())));
        assert!(frequency.contains_zero() && found.frequency.relative_error() < 1e-15, "{found:?}, not {truth:?}");
        if let [Some(gain), Some(truth)] = gains {
            assert!((gain - truth).contains_zero() && gain.relative_error() < 1e-13, "{gain:?}, not {truth:?}");
        }
    }
}

fn hertz(omega: Ball) -> Ball {
    omega / (Ball::from(2.0) * Ball::PI)
}
