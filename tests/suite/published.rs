//! Published cases: models from verification manuals, textbooks and other tools' tests, with the answers recomputed from
//! the stated parameters to the digits shown.
//!
//! Sources: VM = Ansys Mechanical APDL verification manual; SDL.. = guide VPCS (as in Code_Aster's V2.01);
//! Friswell = Friswell, Penny, Garvey and Lees, *Dynamics of Rotating Machines*, as in openTorsion's tests;
//! Inman = *Engineering Vibration*; Thomson = *Theory of Vibration with Applications*; EoM = Minaker's EoM samples.
//!
//! A value counts as right within 1e-12 of itself or half a unit of the last digit shown, whichever is larger.

use crate::ask::{Answer, ask};

/// Asserts a relative difference of at most 1e-12, or half a unit of the last digit.
fn assert_digits(found: f64, digits: &str, what: &str) {
    let truth: f64 = digits.parse().expect("a number");
    let decimals = digits.split(['e', 'E']).next().and_then(|m| m.split('.').nth(1)).map_or(0, str::len);
    let exponent: i32 = digits.split(['e', 'E']).nth(1).map_or(0, |e| e.parse().expect("an exponent"));
    let last_digit = if digits.contains('.') { 0.5 * 10f64.powi(exponent - decimals as i32) } else { 0.0 };
    // The program's number and this one differ by a quotient of two binary64 numbers and a conversion: 4e-16.
    let allowed = (1e-12 * truth.abs()).max(last_digit) + 4e-16 * truth.abs();
    assert!((found - truth).abs() <= allowed, "{what}: {found:e}, published {digits}");
}

fn assert_all(found: &[f64], digits: &[&str], what: &str) {
    assert_eq!(found.len(), digits.len(), "{what}: {found:?}");
    for (i, (found, digits)) in found.iter().zip(digits).enumerate() {
        assert_digits(*found, digits, &format!("{what}, number {}", i + 1));
    }
}

fn assert_hz(model: &str, digits: &[&str]) -> Answer {
    let answer = ask(model);
    assert_all(&answer.frequencies(), digits, "Hz");
    answer
}

fn assert_rad(model: &str, digits: &[&str]) -> Answer {
    let answer = ask(model);
    assert_all(&answer.omegas(), digits, "rad/s");
    answer
}

/// The oscillating poles with positive imaginary part, ascending in |s|: real and imaginary parts.
fn upper(answer: &Answer) -> Vec<(f64, f64)> {
    answer.pole_values().into_iter().filter(|(_, im)| *im > 0.0).collect()
}

fn assert_poles(model: &str, digits: &[(&str, &str)]) {
    let found = upper(&ask(model));
    assert_eq!(found.len(), digits.len(), "{found:?}");
    for ((re, im), (re_digits, im_digits)) in found.into_iter().zip(digits) {
        assert_digits(re, re_digits, "real part");
        assert_digits(im, im_digits, "imaginary part");
    }
}

/// Damping ratios, one for each pair, ascending in |s|.
fn zetas(answer: &Answer) -> Vec<f64> {
    let pairs = answer.poles.list.iter().filter(|pole| pole.im.to_f64() > 0.0);
    pairs.map(|pole| pole.damping_ratio.expect("not at zero").to_f64()).collect()
}

/// `count` equal masses in a row on equal springs, held at the first end and, if `both`, at the last.
fn chain(count: usize, mass: &str, k: &str, c: Option<&str>, both: bool) -> String {
    let damper = |name: &str, ends: &str| c.map_or(String::new(), |c| format!("damper {name}: {ends} {{ c = {c} }}\n"));
    let mut text = format!(
        "body m[1] {{ mass = {mass}, moves x }}\nspring k[1]: ground -- m[1] {{ k = {k} }}\n{}",
        damper("c[1]", "ground -- m[1]")
    );
    text += &format!(
        "repeat i in 2..{count} {{\n body m[i] {{ mass = {mass}, moves x }}\n spring k[i]: m[i-1] -- m[i] {{ k = {k} }}\n {}}}\n",
        damper("c[i]", "m[i-1] -- m[i]")
    );
    if both {
        let ends = format!("m[{count}] -- ground");
        text += &format!("spring last: {ends} {{ k = {k} }}\n{}", damper("last_c", &ends));
    }
    text
}

// One degree of freedom.

#[test]
fn vm45_spring_and_mass() {
    assert_hz(
        "body w { mass = 0.006477 lbf*s^2/inch, moves y }\nspring k: ground -- w { k = 48 lbf/inch }",
        &["13.7010484408522"],
    );
}

#[test]
fn vm47_torsion_pendulum() {
    assert_hz(
        "body disc { inertia = 0.30312 lbf*inch*s^2, turns }\nspring k: ground -- disc { k = 4.8 lbf*inch/rad }",
        &["0.633334949082213"],
    );
}

#[test]
fn vm48_shaft_with_a_disc() {
    assert_hz(
        "param L = 8 inch\nparam d = 0.375 inch\nparam E = 31.2e6 psi\nparam nu = 0.3
let G = E / (2*(1 + nu))
body disc { inertia = 0.031 lbf*inch*s^2, turns }
spring shaft: ground -- disc { k = G * pi*d^4/32 / L }",
        &["48.7806290996670"],
    );
}

#[test]
fn vm69_spring_and_mass() {
    assert_hz("body m { mass = 1 kg, moves x }\nspring k: ground -- m { k = 9.8696 N/m }", &["0.499999888518909"]);
}

#[test]
fn vm72_logarithmic_decrement() {
    let answer = ask("body m { mass = 0.02590673 lbf*s^2/inch, moves x }
spring k: ground -- m { k = 30 lbf/inch }
damper c: ground -- m { c = 0.12 lbf*s/inch }");
    let (re, im) = upper(&answer)[0];
    assert_digits((std::f64::consts::TAU * -re / im).exp(), "1.53513745449", "ratio of amplitudes");
    assert_digits(std::f64::consts::TAU / im, "0.185069010698", "damped period");
}

/// resonance (Moore): a rod with a disc at its end.
#[test]
fn clock_pendulum() {
    assert_rad(
        "gravity 9.81 m/s^2\nparam L = 0.2799 m
body rod { mass = 0.1 kg, shape = rod((0, 0), (0, -L)) }
body bob { mass = 0.1 kg, at = (0, -L), shape = disk(0.03 m) }
pivot hinge: ground@(0, 0) -- rod
weld end: rod -- bob",
        &["6.26579051763710"],
    );
}

/// resonance (Moore): `quarter car`, one mass.
#[test]
fn single_mass_car() {
    let answer = ask("body car { mass = 1007 kg, moves y }
spring k: ground -- car { k = 40000 N/m }\ndamper c: ground -- car { c = 2000 N*s/m }");
    assert_all(&answer.omegas(), &["6.30253491663254"], "undamped");
    assert_all(&zetas(&answer), &["0.157563372915814"], "damping ratio");
    assert_digits(upper(&answer)[0].1, "6.22380918212210", "damped");
}

/// MBDyn's test of its eigenvalue analysis.
#[test]
fn two_separate_oscillators() {
    assert_poles(
        "body a { mass = 2.5 kg, moves x }\nspring ka: ground -- a { k = 5000 N/m }\ndamper ca: ground -- a { c = 10 N*s/m }
body b { mass = 3 kg, moves x }\nspring kb: ground -- b { k = 1000 N/m }\ndamper cb: ground -- b { c = 20 N*s/m }",
        &[("-3.3333333333333333", "17.950549357115"), ("-2", "44.676615807377")],
    );
}

/// V2.01.400: six motions of a bushing, with two equal pairs.
#[test]
fn bushing_with_repeated_frequencies() {
    let stiffness = [16, 18, 18, 128, 128, 196];
    let model: String = stiffness
        .iter()
        .enumerate()
        .map(|(i, k)| format!("body m{i} {{ mass = 1 kg, moves x }}\nspring k{i}: ground -- m{i} {{ k = {k} N/m }}\n"))
        .collect();
    assert_hz(
        &model,
        &["0.636619772368", "0.675237237118", "0.675237237118", "1.80063263231", "1.80063263231", "2.22816920329"],
    );
}

/// Exudyn's test of one mass.
#[test]
fn five_percent_damping() {
    let model = "body m { mass = 1.6 kg, moves x }\nspring k: ground -- m { k = 4000 N/m }\ndamper c: ground -- m { c = 8 N*s/m }";
    let answer = assert_rad(model, &["50"]);
    assert_all(&zetas(&answer), &["0.05"], "damping ratio");
    assert_poles(model, &[("-2.5", "49.9374609")]);
}

// Chains and small lumped systems.

#[test]
fn vm68_two_masses() {
    assert_hz(
        "body m1 { mass = 0.5 lbf*s^2/inch, moves x }\nbody m2 { mass = 1 lbf*s^2/inch, moves x }
spring k1: ground -- m1 { k = 42832 lbf/inch }\nspring k2: m1 -- m2 { k = 32416 lbf/inch }",
        &["20.5720620764708", "64.8845539979944"],
    );
}

#[test]
fn vm89_two_masses_between_walls() {
    let answer = assert_hz(
        "body m1 { mass = 0.5 lbf*s^2/inch, moves x }\nbody m2 { mass = 1 lbf*s^2/inch, moves x }
spring k1: ground -- m1 { k = 200 lbf/inch }\nspring kc: m1 -- m2 { k = 800 lbf/inch }\nspring k2: m2 -- ground { k = 200 lbf/inch }",
        &["2.58139462222060", "8.32630107167186"],
    );
    let ratio = |mode| answer.shape(mode, "m1.x") / answer.shape(mode, "m2.x");
    assert_all(&[ratio(1), ratio(2)], &["0.921164609606623", "-2.17116460960662"], "u1/u2");
}

#[test]
fn sdld02_eight_masses_between_walls() {
    let answer = assert_hz(
        &chain(8, "10 kg", "1e5 N/m", Some("50 N*s/m"), true),
        &[
            "5.52739316691833",
            "10.8868392894557",
            "15.9154943091895",
            "20.4605650879673",
            "24.3839519500927",
            "27.5664447710896",
            "29.9113451170111",
            "31.3474043774231",
        ],
    );
    // SDLD25: the damping ratios of that chain. The guide's .04331841 for the sixth is a misprint.
    assert_all(
        &zetas(&answer),
        &[
            "0.00868240888335",
            "0.0171010071663",
            "0.025",
            "0.0321393804843",
            "0.0383022221559",
            "0.0433012701892",
            "0.0469846310393",
            "0.0492403876506",
        ],
        "damping ratio",
    );
}

#[test]
fn sdld04_three_masses_on_a_wall() {
    assert_hz(
        &chain(3, "1 kg", "1000 N/m", None, false),
        &["2.23986065655518", "6.27595009654656", "9.06901065044008"],
    );
}

#[test]
fn sdld30_two_masses_between_walls() {
    assert_hz(
        "body a { mass = 10 kg, moves x }\nbody b { mass = 10 kg, moves x }
spring k1: ground -- a { k = 1000 N/m }\nspring k2: a -- b { k = 1000 N/m }\nspring k3: b -- ground { k = 10000 N/m }",
        &["2.18815056124550", "5.30484512545661"],
    );
}

#[test]
fn sdld102_three_masses_between_walls() {
    assert_rad(&chain(3, "1 kg", "1 N/m", None, true), &["0.765366864730", "1.414213562373", "1.847759065023"]);
}

#[test]
fn sdld103_three_masses_between_walls() {
    assert_hz(&chain(3, "10 kg", "1e4 N/m", None, true), &["3.85203112728", "7.11762543417", "9.29962579015"]);
}

/// Vibration toolbox (Slater): K = [[8, -4, 0], [-4, 8, -4], [0, -4, 4]], M = 4.
#[test]
fn three_masses_of_four_kilograms() {
    assert_rad(&chain(3, "4 kg", "4 N/m", None, false), &["0.445041867912629", "1.24697960371747", "1.80193773580484"]);
}

/// Vibration toolbox (Slater): K = [[2, -1], [-1, 6]], C = [[.3, -.02], [-.02, .1]], M = 1.
#[test]
fn two_masses_with_unproportional_damping() {
    let answer = ask("body a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }
spring ka: ground -- a { k = 1 N/m }\nspring kab: a -- b { k = 1 N/m }\nspring kb: b -- ground { k = 5 N/m }
damper ca: ground -- a { c = 0.28 N*s/m }\ndamper cab: a -- b { c = 0.02 N*s/m }\ndamper cb: b -- ground { c = 0.08 N*s/m }");
    let magnitudes: Vec<f64> = upper(&answer).into_iter().map(|(re, im)| re.hypot(im)).collect();
    assert_all(&magnitudes, &["1.32870652984243", "2.49613042147743"], "|s|");
    let damped: Vec<f64> = upper(&answer).into_iter().map(|(_, im)| im).collect();
    assert_all(&damped, &["1.32126807696953", "2.49541874853034"], "damped");
    assert_all(&zetas(&answer), &["0.105665471376623", "0.0238775977770125"], "damping ratio");
}

/// resonance: two masses, three springs, three dampers.
#[test]
fn two_masses_with_proportional_damping() {
    let answer =
        assert_rad(&chain(2, "1 kg", "1000 N/m", Some("5 N*s/m"), true), &["31.6227766016838", "54.7722557505166"]);
    let damped: Vec<f64> = upper(&answer).into_iter().map(|(_, im)| im).collect();
    assert_all(&damped, &["31.5238005322962", "54.2563360355268"], "damped");
}

/// Inman, example 4.1.5: M = diag(9, 1), K = [[27, -3], [-3, 3]], C = K / 10.
#[test]
fn inman_two_masses() {
    let answer = ask("body a { mass = 9 kg, moves x }\nbody b { mass = 1 kg, moves x }
spring ka: ground -- a { k = 24 N/m }\nspring kab: a -- b { k = 3 N/m }
damper ca: ground -- a { c = 2.4 N*s/m }\ndamper cab: a -- b { c = 0.3 N*s/m }");
    assert_all(&answer.omegas(), &["1.4142135623730951", "2"], "rad/s");
    assert_all(&zetas(&answer), &["0.0707106781187", "0.1"], "damping ratio");
}

/// resonance: a shear building of four storeys.
#[test]
fn four_storeys() {
    assert_rad(
        &chain(4, "4000 kg", "5000 N/m", None, false),
        &["0.388289129432217", "1.118033988749895", "1.7129274486", "2.10121657803"],
    );
}

/// A lecture on earthquake engineering: five storeys, the upper two lighter.
#[test]
fn five_storeys() {
    let mut model = String::from("body s0 { mass = 2 kg, moves x }\nspring k0: ground -- s0 { k = 1 N/m }\n");
    for (i, mass) in [2, 2, 1, 1].into_iter().enumerate() {
        let (below, here) = (i, i + 1);
        model += &format!(
            "body s{here} {{ mass = {mass} kg, moves x }}\nspring k{here}: s{below} -- s{here} {{ k = 1 N/m }}\n"
        );
    }
    assert_rad(&model, &["0.243915558347", "0.668905697692", "1", "1.286042263352", "1.684982393043"]);
}

/// Greenwood, *Principles of Dynamics*, example 9-1: 1 kg and 4 kg in a row on a wall.
#[test]
fn greenwood_two_masses() {
    let answer = ask("body a { mass = 1 kg, moves x }\nbody b { mass = 4 kg, moves x }
spring k1: ground -- a { k = 1000 N/m }\nspring k2: a -- b { k = 1000 N/m }");
    // lambda = (9000 -+ sqrt 65e6) / 8; x_a / x_b = 1000 / (2000 - lambda).
    let root = 65e6f64.sqrt();
    for (mode, lambda) in [(9000.0 - root) / 8.0, (9000.0 + root) / 8.0].into_iter().enumerate() {
        let omega = answer.omegas()[mode];
        assert!((omega - lambda.sqrt()).abs() < 1e-12 * omega, "{omega}");
        let ratio = answer.shape(mode + 1, "a.x") / answer.shape(mode + 1, "b.x");
        // The rounding of 9000 - sqrt 65e6 is 2e-15 of lambda; 2000 - lambda keeps it.
        assert!((ratio - 1000.0 / (2000.0 - lambda)).abs() < 1e-12 * ratio.abs(), "{ratio}");
    }
}

/// Friswell 9.6: a chain of nine with springs to the ground at the first and the sixth.
#[test]
fn friswell_nine_masses() {
    let mut model = String::new();
    for (i, mass) in [90, 140, 140, 140, 140, 90, 350, 500, 22000].into_iter().enumerate() {
        model += &format!("body d{i} {{ inertia = {mass} kg*m^2, turns }}\n");
    }
    for (i, k) in ["2.5e6", "2.5e6", "2.5e6", "2.5e6", "2.5e6", "4e7", "4e7", "3e6"].into_iter().enumerate() {
        model += &format!("spring k{i}: d{i} -- d{} {{ k = {k} N*m/rad }}\n", i + 1);
    }
    for i in [0, 5] {
        model += &format!("spring g{i}: ground -- d{i} {{ k = 1e7 N*m/rad }}\n");
    }
    assert_hz(
        &model,
        &[
            "1.54792928605",
            "11.9263818237",
            "17.9238724671",
            "24.4488013848",
            "33.7147338201",
            "40.1849897837",
            "60.3151299157",
            "69.2409641123",
            "132.804259553",
        ],
    );
}

/// Chains of n equal masses: 2 sqrt(k/m) times a sine (Thomson, section 10).
#[test]
fn chains_of_any_length() {
    let pi = std::f64::consts::PI;
    for n in [2usize, 3, 7, 20] {
        let held_at_both = ask(&chain(n, "1 kg", "1 N/m", None, true));
        for (i, omega) in held_at_both.omegas().into_iter().enumerate() {
            let truth = 2.0 * ((i + 1) as f64 * pi / (2 * (n + 1)) as f64).sin();
            assert!((omega - truth).abs() < 1e-14 * truth, "fixed-fixed {n}: {omega} {truth}");
        }
        let held_at_one = ask(&chain(n, "1 kg", "1 N/m", None, false));
        for (i, omega) in held_at_one.omegas().into_iter().enumerate() {
            let truth = 2.0 * ((2 * i + 1) as f64 * pi / (2 * (2 * n + 1)) as f64).sin();
            assert!((omega - truth).abs() < 1e-14 * truth, "fixed-free {n}: {omega} {truth}");
        }
        let free =
            ask(&chain(n, "1 kg", "1 N/m", None, false).replace("spring k[1]: ground -- m[1] { k = 1 N/m }\n", ""));
        assert_eq!(free.omegas()[0], 0.0, "a rigid motion is exactly zero");
        for (i, omega) in free.omegas().into_iter().enumerate().skip(1) {
            let truth = 2.0 * (i as f64 * pi / (2 * n) as f64).sin();
            assert!((omega - truth).abs() < 1e-14 * truth, "free-free {n}: {omega} {truth}");
        }
    }
}

// Torsion.

fn shaft(inertias: &[&str], stiffness: &[&str]) -> String {
    let mut model = String::new();
    for (i, inertia) in inertias.iter().enumerate() {
        model += &format!("body d{i} {{ inertia = {inertia} kg*m^2, turns }}\n");
    }
    for (i, k) in stiffness.iter().enumerate() {
        model += &format!("spring k{i}: d{i} -- d{} {{ k = {k} N*m/rad }}\n", i + 1);
    }
    model
}

#[test]
fn friswell_two_discs() {
    assert_hz(&shaft(&["211.4", "8.3"], &["9.775e6"]), &["0", "176.076746752421"]);
}

#[test]
fn friswell_five_discs() {
    assert_hz(
        &shaft(&["3.5e-3", "3.5e-3", "3.5e-3", "0.15", "0.05"], &["12e3", "12e3", "14e3", "10e3"]),
        &["0", "81.2076290243598", "141.214071391523", "378.952953903407", "536.363282927215"],
    );
}

/// Friswell 9.9: a drill string of 800 m with end discs, its inertia lumped at the ends of 5 and of 8 elements.
#[test]
fn friswell_drill_string() {
    let string = |elements: usize| {
        let last = elements - 1;
        format!(
            "let I = pi/32 * ((0.78 m)^4 - (0.65 m)^4)
let element = 800 m / {elements}
let half = 8000 kg/m^3 * I * element / 2
body d[0] {{ inertia = 200 kg*m^2 + half, turns }}
repeat i in 1..{last} {{ body d[i] {{ inertia = 2*half, turns }} }}
body d[{elements}] {{ inertia = 10 kg*m^2 + half, turns }}
repeat i in 1..{elements} {{ spring s[i]: d[i-1] -- d[i] {{ k = 75 GPa * I / element / 1 rad }} }}"
        )
    };
    let lowest = |elements| ask(&string(elements)).frequencies()[..5].to_vec();
    assert_all(&lowest(5), &["0", "1.87906359493", "3.57419386124", "4.9194669106", "5.78325029486"], "5 elements");
    assert_all(&lowest(8), &["0", "1.89808116266", "3.72322106509", "5.40528201397", "6.87962626865"], "8 elements");
}

#[test]
fn opentorsion_wind_turbine() {
    assert_hz(
        &shaft(&["1e7", "5770", "97030"], &["3.67e8", "5.496e9"]),
        &["0", "9.28512514709220", "164.584469252564"],
    );
}

#[test]
fn opentorsion_crankshaft() {
    assert_hz(
        &shaft(
            &["0.0170", "0.0090", "0.0467", "0.0327", "0.0467", "0.0467", "0.0327", "0.0487", "2.0750"],
            &["1.106e6", "1.631e6", "1.253e6", "1.253e6", "1.678e6", "1.253e6", "1.253e6", "1.976e6"],
        ),
        &[
            "0",
            "216.583605235076",
            "592.740480248023",
            "984.922963985232",
            "1171.01740818997",
            "1415.99501720666",
            "1660.04391168019",
            "1794.38757974682",
            "2993.47356256953",
        ],
    );
}

// Rigid bodies on springs.

/// VM52; Thomson, section 6.3: bounce and pitch of a car.
#[test]
fn vm52_bounce_and_pitch() {
    assert_hz(
        "body car { mass = 100 slug, inertia = 1600 slug*ft^2, at = (0, 0), moves y, turns }
spring front: ground -- car@(-4.5 ft, 0) { k = 2400 lbf/ft, along = y }
spring rear: ground -- car@(5.5 ft, 0) { k = 2600 lbf/ft, along = y }",
        &["1.09807813046802", "1.44058644709568"],
    );
}

/// Edwards and Penney: 100 x'' = -4000 x + 4000 th, 1000 th'' = 4000 x - 104000 th; springs of 2000 at 6 and 4 from the centre.
#[test]
fn edwards_penney_car() {
    assert_rad(
        "body car { mass = 100 slug, inertia = 1000 slug*ft^2, at = (0, 0), moves y, turns }
spring front: ground -- car@(-6 ft, 0) { k = 2000 lbf/ft, along = y }
spring rear: ground -- car@(4 ft, 0) { k = 2000 lbf/ft, along = y }",
        &["6.13112542130966", "10.3154884066713"],
    );
}

/// EoM: bounce and pitch with dampers; the mass is a weight over 9.81 m/s^2.
#[test]
fn eom_bounce_and_pitch() {
    let model = "body car { mass = 16975 N / 9.81 m/s^2, inertia = 3267 kg*m^2, at = (0, 0), moves y, turns }
spring front: ground -- car@(-1.189 m, 0) { k = 35000 N/m, along = y }
spring rear: ground -- car@(1.696 m, 0) { k = 38000 N/m, along = y }
";
    assert_hz(model, &["0.945199703646", "1.18588716712"]);
    let damped = format!(
        "{model}damper cf: ground -- car@(-1.189 m, 0) {{ c = 1000 N*s/m, along = y }}
damper cr: ground -- car@(1.696 m, 0) {{ c = 1200 N*s/m, along = y }}"
    );
    assert_poles(&damped, &[("-0.504125738251", "5.91744257709"), ("-0.876205010618", "7.39943527465")]);
}

/// EoM: a quarter car with a damped tyre.
#[test]
fn eom_quarter_car() {
    let model = "body wheel { mass = 50 kg, moves y }\nbody car { mass = 500 kg, moves y }
spring tyre: ground -- wheel { k = 180000 N/m }\nspring ks: wheel -- car { k = 18000 N/m }
";
    assert_hz(model, &["0.910110573651", "10.0195589325"]);
    let damped =
        format!("{model}damper ct: ground -- wheel {{ c = 500 N*s/m }}\ndamper cs: wheel -- car {{ c = 1500 N*s/m }}");
    assert_poles(&damped, &[("-1.26093830163", "5.63214186443"), ("-20.2390616984", "58.9999030664")]);
    assert_all(&zetas(&ask(&damped)), &["0.218474162837", "0.324475287974"], "damping ratio");
}

// Pivots, gravity, preload.

/// The cart of MIT 2.003 with other numbers, which a formulation without the rod's weight gets wrong.
#[test]
fn cart_with_a_rod() {
    let answer = assert_rad(
        "gravity 9.81 m/s^2
body cart { mass = 2 kg, moves x }
body rod { mass = 1 kg, shape = rod((0, 0), (0, -1 m)) }
pivot p: cart@(0, 0) -- rod
spring k: ground -- cart { k = 40 N/m, along = x }",
        &["3.0521263999316", "5.2992737442614"],
    );
    let system = &answer.lowered.system;
    let entries = |form: &vibc::system::Form| {
        form.assemble(2).into_iter().flatten().map(|entry| entry.to_f64()).collect::<Vec<f64>>()
    };
    assert_eq!(entries(&system.m), [3.0, 0.5, 0.5, 1.0 / 3.0]);
    assert_eq!(entries(&system.k), [40.0, 0.0, 0.0, 4.905]);
}

/// MIT 2.003, problem set 10, problem 1: to the last digit of binary64.
#[test]
fn cart_of_the_problem_set() {
    let answer = ask(CART);
    let omegas = answer.omegas();
    for (found, truth) in omegas.iter().zip([2.15817927443011, 3.74715239993107]) {
        assert!((found - truth).abs() <= 1e-14 * truth, "{found:e}");
    }
    let ratio = |mode| answer.shape(mode, "rod.angle") / answer.shape(mode, "block.x");
    assert_all(&[ratio(1), ratio(2)], &["1.29393000254", "-1.57561535762"], "theta/x");
    assert_poles(CART, &[("-0.309953841", "2.636171869"), ("-1.912268381", "2.371873795")]);
    // M = [1.5 0.5; 0.5 2/3], C = diag(5, 0), K = diag(10, 4.905), exactly.
    let system = &answer.lowered.system;
    let entries = |form: &vibc::system::Form| {
        form.assemble(2).into_iter().flatten().map(|entry| entry.to_f64()).collect::<Vec<f64>>()
    };
    assert_eq!(entries(&system.m), [1.5, 0.5, 0.5, 2.0 / 3.0]);
    assert_eq!(entries(&system.c), [5.0, 0.0, 0.0, 0.0]);
    assert_eq!(entries(&system.k), [10.0, 0.0, 0.0, 4.905]);
}

const CART: &str = "model cart
param m1 = 1 kg\nparam m2 = 0.5 kg\nparam L = 2 m\nparam k = 10 N/m\nparam b = 5 N*s/m
gravity 9.81 m/s^2
point W = (-0.5 m, 0)\npoint A = (0, 0)
body block { mass = m1, moves x }
body rod { mass = m2, shape = rod(A, A + (0, -L)) }
pivot p: block@A -- rod
spring s: ground@W -- block@A { k = k, free_length = 0.5 m }
damper d: ground@W -- block@A { c = b }
force F: block along x
output x = block.x\noutput theta = rod.angle";

fn rod(extra: &str, end: &str) -> String {
    format!(
        "gravity 9.81 m/s^2\nbody rod {{ mass = 1 kg, shape = rod((0, 0), (0, {end})) }}\npivot p: ground@(0, 0) -- rod\n{extra}"
    )
}

/// A uniform rod of 1 kg and 1 m: hanging, hanging on a hinge spring, upright on one (what Exudyn got wrong).
#[test]
fn rod_on_a_hinge() {
    let squares = |model: &str| ask(model).modes.list[0].omega_squared.to_f64();
    assert_digits(squares(&rod("", "-1 m")), "14.715", "hanging");
    assert_digits(squares(&rod("spring k: ground -- rod { k = 5 N*m/rad }", "-1 m")), "29.715", "with a spring");
    let upright = ask(&rod("spring k: ground -- rod { k = 2 N*m/rad }", "1 m"));
    assert_digits(upright.modes.list[0].omega_squared.to_f64(), "-8.715", "upright");
    assert_eq!(
        vibc::analysis::stability(&upright.lowered.system, &upright.modes, &upright.poles),
        vibc::analysis::Stability::Unstable
    );
}

/// A string of point masses 1 m apart, hanging.
fn hanging_chain(n: usize) -> String {
    let mut model = String::from("gravity 9.81 m/s^2\n");
    for i in 1..=n {
        let above = if i == 1 { "ground".to_string() } else { format!("b{}", i - 1) };
        model += &format!("body b{i} {{ mass = 1 kg, at = (0, -{i} m), inertia = 0 kg*m^2 }}\n");
        model += &format!("pivot p{i}: {above}@(0, -{} m) -- b{i}\n", i - 1);
    }
    model
}

/// omega^2 = (2 -+ sqrt 2) g / l.
#[test]
fn double_pendulum() {
    assert_rad(&hanging_chain(2), &["2.3971993978641", "5.7873512980361"]);
}

/// EoM: two uniform rods, one under the other.
#[test]
fn two_rods_in_a_row() {
    assert_rad(
        "gravity 9.81 m/s^2
body upper { mass = 1 kg, shape = rod((0, 0), (0, -1 m)) }
body lower { mass = 1 kg, shape = rod((0, -1 m), (0, -2 m)) }
pivot a: ground@(0, 0) -- upper\npivot b: upper@(0, -1 m) -- lower",
        &["2.6801140122534", "7.1886708702877"],
    );
}

/// omega^2 = x g / l with the roots x of the Laguerre polynomial of degree n.
#[test]
fn hanging_chains() {
    assert_rad(&hanging_chain(3), &["2.0195911472489", "4.7441427396672", "7.8552123627319"]);
    assert_rad(
        &hanging_chain(5),
        &["1.6079573179767", "3.7236385444663", "5.9397758218564", "8.3373734567593", "11.135809637487"],
    );
    assert_rad(
        &hanging_chain(10),
        &[
            "1.1626495370499",
            "2.6750605844777",
            "4.2118694027798",
            "5.7765097226575",
            "7.3803785224083",
            "9.0398450454507",
            "10.779032380961",
            "12.637227517372",
            "14.689673475457",
            "17.132484866195",
        ],
    );
}

/// A demonstration of Project Chrono: a point of 15 kg drawn at 30 degrees, whose rest must be found.
#[test]
fn pendulum_drawn_away_from_its_rest() {
    let answer = assert_rad(
        "gravity 9.81 m/s^2\nparam L = 4 m
body bob { mass = 15 kg, at = (L*sin(30 deg), -L*cos(30 deg)), inertia = 0 kg*m^2 }
pivot hinge: ground@(0, 0) -- bob",
        &["1.5660459763366"],
    );
    let turned = answer.lowered.rest.displacement[0].to_f64();
    assert!((turned + std::f64::consts::FRAC_PI_6).abs() < 1e-15, "{turned}");
}

/// VM9: a point between two springs of 1 and 8 lbf/inch, pulled by (5, 5) lbf: a rest far from the drawing.
#[test]
fn vm9_rest_under_a_large_load() {
    let answer = ask("body p { mass = 1 lbf*s^2/inch, at = (0, 0), moves x y }
spring lower: ground@(0, -10 inch) -- p { k = 1 lbf/inch }
spring upper: ground@(0, 10 inch) -- p { k = 8 lbf/inch }
force fx: p along x = constant(5 lbf)\nforce fy: p along y = constant(5 lbf)");
    let inches: Vec<f64> = answer.lowered.rest.displacement.iter().map(|d| d.to_f64() / 0.0254).collect();
    assert_all(&inches, &["8.632066133347", "4.531906698982"], "displacement");
}
