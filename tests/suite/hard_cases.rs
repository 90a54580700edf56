//! The certified hard cases of tests/hardcases: each value within its tolerance, each bound holding, each fact reported.

use super::ask::ask;
use super::systems::{Builder, HardCase, error, number};
use vibc::analysis::{self, ModeKind, Modes, Request, Stability, Which};
use vibc::base::Number;

/// Checks all references omega_k of a case: the number of digits, and that the bound holds. Returns the modes for
/// further checks.
fn check_frequencies(name: &str, digits: f64) -> Modes {
    let case = HardCase::load(name);
    let modes = analysis::modes(&case.system).expect("the case has modes");
    for (i, mode) in modes.list.iter().enumerate() {
        let id = format!("omega_{}", i + 1);
        let truth = case.reference(&id).unwrap_or_else(|| panic!("{name} has {id}"));
        // The terms are given to 40 digits, which determine omega to 40 digits minus those that cancel.
        let room = 1e-40 * mode.input_condition.map_or(0.0, |factor| factor.0);
        check(name, &id, mode.omega, &truth, digits, room);
    }
    modes
}

fn check(name: &str, id: &str, computed: vibc::base::Ball, truth: &Number, digits: f64, room: f64) {
    if truth.is_zero() {
        assert!(computed.is_zero(), "{name} {id}: {computed:?}");
        return;
    }
    // The references are correct to 36 digits.
    let size = truth.abs().to_f64();
    let (error, holds) = error(computed, truth, (1e-35 + room) * size);
    assert!(holds, "{name} {id}: error {error:e}, bound {:e}", computed.rad);
    assert!(error <= 10f64.powf(-digits) * size, "{name} {id}: {} digits", -(error / size).log10());
    assert!(computed.rad <= 1e-12 * size, "{name} {id}: bound {:e}", computed.rad / size);
}

#[test]
fn graded_chains_and_nets_keep_all_digits() {
    for name in [
        "o01_chain_soft_ground",
        "o02_chain_zigzag",
        "o03_stiff_link_soft_mount",
        "o05_star_tree",
        "o06_mesh_graph",
        "o21_hanging_chain_graded",
    ] {
        check_frequencies(name, 28.0);
    }
}

#[test]
fn plain_cases_keep_all_digits() {
    for name in ["o26_pole_zero_cancel", "o27_long_phase", "o29_seed_cart", "o30_resonant_forcing"] {
        check_frequencies(name, 28.0);
    }
}

#[test]
fn rigid_motions_are_counted_exactly() {
    for (name, count) in [("o07_free_free_chain", 1), ("o08_free_planar_levers", 2)] {
        let modes = check_frequencies(name, 28.0);
        let rigid = modes.list.iter().filter(|mode| mode.kind == ModeKind::Rigid).count();
        assert_eq!(rigid, count, "{name}");
    }
}

#[test]
fn close_frequencies_keep_the_digits_of_their_differences() {
    for name in ["o04_tuned_tiny_absorber", "o10_two_pendulums_weak", "o11_wilkinson21"] {
        let modes = check_frequencies(name, 28.0);
        let case = HardCase::load(name);
        for reference in case.json["reference"].as_array().expect("a list") {
            let id = reference["id"].as_str().expect("an id");
            let Some(pair) = id.strip_prefix("split_") else { continue };
            let (b, a) = pair.split_once('_').expect("two numbers");
            let omega = |k: &str| modes.list[k.parse::<usize>().expect("a number") - 1].omega;
            let truth = number(reference["value"].as_str().expect("a decimal"));
            check(name, id, omega(b) - omega(a), &truth, 16.0, 1e-35 * omega(b).to_f64() / truth.to_f64());
        }
    }
}

#[test]
fn a_repeated_frequency_is_certified_as_a_group() {
    let modes = check_frequencies("o09_c3_ring", 28.0);
    let clusters: Vec<_> = modes.list.iter().map(|mode| mode.cluster).collect();
    assert_eq!(clusters, [None, Some(0), Some(0)]);
}

#[test]
fn near_buckling_the_digits_and_the_sign_are_certain() {
    for name in ["o19_inverted_pendulum", "o20_double_inverted", "o31_qzs_isolator"] {
        let modes = check_frequencies(name, 15.0);
        assert!(modes.list.iter().all(|mode| mode.kind == ModeKind::Oscillation), "{name}");
    }
}

#[test]
fn massless_nodes_are_eliminated_or_named() {
    let modes = check_frequencies("o17_massless_series", 28.0);
    assert_eq!(modes.infinite, 1);
    let error = analysis::modes(&HardCase::load("o33_floating_massless").system).expect_err("a and b float");
    assert_eq!(error.to_diagnostic().code.0, "vib::mass::singular");
    assert!(error.to_diagnostic().message.starts_with("a, b "), "{error:?}");
}

#[test]
fn the_load_factor_to_buckling_is_certified() {
    // (spring over load) of the one-coordinate cases; the exact quotients of the binary64 literals to 1e-25.
    for (name, margin) in [("o19_inverted_pendulum", 1.01936799226e-11), ("o31_qzs_isolator", 9.9999994e-10)] {
        let system = HardCase::load(name).system;
        let found = analysis::buckling(&system).expect("a softening load");
        let k = |nature| {
            let terms = system.k.terms().filter(|term| term.nature == nature);
            terms.fold(Number::ZERO, |sum, term| &sum + term.weight)
        };
        use vibc::system::Nature;
        let truth = -&(&k(Nature::Property) / &k(Nature::Geometric));
        let (error, holds) = error(found.load_factor, &truth, 0.0);
        assert!(holds && error < 1e-28, "{name}: {error:e}");
        assert!(((&truth - &Number::ONE).to_f64() / margin - 1.0).abs() < 1e-3, "{name}");
    }
    // Two hinges of 35 + 1e-10 and 30 N m/rad under 20 and 10 N m/rad: 200 a^2 - (30 x 20 + 65 x 10) a + 35 x 30 = 0
    // approximately, a = 1.
    let found = analysis::buckling(&HardCase::load("o20_double_inverted").system).expect("a softening load");
    let margin = (found.load_factor - vibc::base::Ball::ONE).to_f64();
    // d alpha / d k1 = k2' / -(d det / d alpha): (30 - 10) / (650 + 600 - 400) at alpha = 1.
    assert!((margin / (1.0000178e-10 * 20.0 / 850.0) - 1.0).abs() < 1e-5, "{margin:e}");
}

/// The cases that are files, by name.
fn names() -> Vec<String> {
    let folder = format!("{}/tests/hardcases", env!("CARGO_MANIFEST_DIR"));
    let files = std::fs::read_dir(folder).expect("the cases").map(|file| file.expect("a case").file_name());
    let names = files.filter_map(|file| Some(file.to_str()?.strip_suffix(".json")?.to_string()));
    let mut names: Vec<String> = names.filter(|name| name != "index").collect();
    names.sort();
    names
}

/// Each fact that a case expects is reported, and no growth or doubt if it expects none.
#[test]
fn expected_facts_are_reported() {
    let mut reported = 0;
    for name in names().iter().filter(|name| !LARGE.contains(&name.as_str())) {
        let case = HardCase::load(name);
        let expect = case.json["expect"].as_object().expect("facts").clone();
        let modes = match (analysis::modes(&case.system), expect.get("error")) {
            (Ok(modes), None) => modes,
            (Err(error), Some(_)) => {
                assert_eq!(error.to_diagnostic().code.0, "vib::mass::singular", "{name}");
                reported += 1;
                continue;
            }
            (found, expected) => panic!("{name}: {:?}, expected {expected:?}", found.err()),
        };
        let poles = analysis::poles(&case.system, &modes).expect("poles");
        let number = |fact: &str| expect.get(fact).and_then(|value| value.as_u64()).unwrap_or(0) as usize;
        let kinds = |kind: ModeKind| modes.list.iter().filter(|mode| mode.kind == kind).count();
        assert_eq!(kinds(ModeKind::Rigid), number("zero_modes"), "{name}");
        assert_eq!(kinds(ModeKind::Divergence), number("unstable_modes"), "{name}");
        assert_eq!(kinds(ModeKind::Undetermined), 0, "{name}");
        assert_eq!(modes.infinite, number("infinite_modes"), "{name}");
        let defective = expect.get("defective").is_some_and(|value| value == true);
        assert_eq!(poles.list.iter().any(|pole| pole.defective), defective, "{name}");
        let wanted = expect.get("multiplicities").map(|list| list.as_array().expect("a list").clone());
        let ones = || modes.list.iter().map(|_| 1).collect();
        let wanted: Vec<u64> =
            wanted.map_or_else(ones, |list| list.iter().map(|n| n.as_u64().expect("a count")).collect());
        assert_eq!(multiplicities(&modes), wanted, "{name}");
        let growing = number("unstable_modes") > 0;
        let kind = match (growing, number("zero_modes")) {
            (true, _) => Stability::Unstable,
            (false, 0) => Stability::Stable,
            (false, _) => Stability::Neutral,
        };
        assert_eq!(analysis::stability(&case.system, &modes, &poles), kind, "{name}");
        // `singular_dynamic_stiffness_at` is reported by an infinite gain: `transfer`.
        let known = ["zero_modes", "unstable_modes", "infinite_modes", "defective", "multiplicities"];
        let known = [known.as_slice(), &["singular_dynamic_stiffness_at"]].concat();
        for fact in expect.keys() {
            assert!(known.contains(&fact.as_str()), "{name}: nothing is known about `{fact}`");
            reported += 1;
        }
    }
    assert!(reported >= 8, "{reported} facts");
}

/// Sizes of the groups of modes that are certified together.
fn multiplicities(modes: &Modes) -> Vec<u64> {
    let mut sizes: Vec<u64> = Vec::new();
    for (i, mode) in modes.list.iter().enumerate() {
        match sizes.last_mut() {
            Some(size) if i > 0 && mode.cluster.is_some() && mode.cluster == modes.list[i - 1].cluster => *size += 1,
            _ => sizes.push(1),
        }
    }
    sizes
}

/// Cases that contain a recipe, with so many coordinates that only the methods for large systems handle them.
const LARGE: [&str; 2] = ["o23_uniform_chain_1e5", "o24_membrane_200x200"];

/// Checks the lowest modes of a case that contains a recipe against its references; `nodes` makes its springs, where
/// `None` is a wall.
fn check_lowest(
    name: &str,
    side: &str,
    n: impl Fn(usize) -> usize,
    springs: impl Fn(usize) -> Vec<(Option<usize>, usize)>,
) {
    let json = HardCase::json(name);
    let parameter = |key: &str| json["parameters"][key].as_str().expect("a parameter").to_string();
    let side: usize = parameter(side).parse().expect("a whole number");
    let (mass, stiffness) = (number(&parameter("m")), number(&parameter("k")));
    let mut b = Builder::numbered(n(side));
    (0..n(side)).for_each(|i| b.mass(i, &mass));
    springs(side).into_iter().for_each(|(from, to)| b.spring(from, to, &stiffness));
    let request = Request { which: Which::Lowest(20), ..Request::default() };
    let modes = analysis::modes_as(&b.finish(), &request).expect("modes");
    assert_eq!(modes.list.len(), 20);
    for (i, mode) in modes.list.iter().enumerate() {
        let id = format!("omega_{}", i + 1);
        // The values for literals as decimals, if the case distinguishes the two readings.
        let list = json["reference"].as_array().expect("a list");
        let entry = list.iter().find(|entry| entry["id"] == *id).unwrap_or_else(|| panic!("{name} has {id}"));
        let decimal = entry["value_decimal"].as_str().or(entry["value"].as_str()).expect("a decimal");
        check(name, &id, mode.omega, &number(decimal), 14.0, 0.0);
        assert_eq!(mode.cluster.is_some(), entry["multiplicity"] == 2, "{name} {id}");
    }
}

#[test]
fn a_chain_of_1e5_has_its_lowest_frequencies() {
    check_lowest(LARGE[0], "n", |n| n, |n| (0..n).map(|i| (i.checked_sub(1), i)).collect());
}

#[test]
fn a_membrane_of_40000_has_its_lowest_frequencies_twice_where_they_are() {
    let springs = |side: usize| {
        let at = |i: usize, j: usize| (i < side && j < side).then(|| i * side + j);
        let before = |i: usize, j: usize| [at(i.wrapping_sub(1), j), at(i, j.wrapping_sub(1))];
        let nodes = (0..side).flat_map(|i| (0..side).map(move |j| (i, j)));
        let inner = nodes.clone().flat_map(|(i, j)| before(i, j).map(|from| (from, i * side + j)));
        // The far edges are connected to walls.
        let last = side - 1;
        let far = nodes.flat_map(|(i, j)| [(i, i * side + j), (j, i * side + j)]);
        inner.chain(far.filter(|(place, _)| *place == last).map(|(_, node)| (None, node))).collect()
    };
    check_lowest(LARGE[1], "N", |side| side * side, springs);
}

/// Every reference is tested: for each kind of reference that is checked, the case is named.
#[test]
fn every_reference_of_every_case_is_checked_somewhere() {
    let source = |module: &str| {
        let path = format!("{}/tests/suite/{module}.rs", env!("CARGO_MANIFEST_DIR"));
        std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
    };
    let modules = ["hard_cases", "hard_cases_damped", "transfer", "response"].map(|module| (module, source(module)));
    let names = names();
    assert_eq!(names.len(), 33);
    for name in names.iter().filter(|name| !LARGE.contains(&name.as_str())) {
        let case = HardCase::load(name);
        for reference in case.json["reference"].as_array().expect("a list") {
            let kind = reference["kind"].as_str().expect("a kind");
            let module = match kind {
                "natural_frequency" | "frequency_difference" | "static_deflection" => "hard_cases",
                "damping_ratio" | "eigenvalue_re" | "eigenvalue_im" | "eigenvalue_real" => "hard_cases_damped",
                "frf_re" | "frf_im" => "transfer",
                "displacement" | "velocity" => "response",
                _ => panic!("{name}: no test knows references of kind {kind}"),
            };
            let (_, text) = modules.iter().find(|(at, _)| *at == module).expect("a module");
            assert!(text.contains(&format!("\"{name}\"")), "{module} does not check {kind} of {name}");
        }
    }
}

/// Beats as reported by the analysis: every pair of a case, to 16 digits.
#[test]
fn beats_are_reported_with_their_digits() {
    for name in ["o04_tuned_tiny_absorber", "o10_two_pendulums_weak", "o11_wilkinson21"] {
        let case = HardCase::load(name);
        let modes = analysis::modes(&case.system).expect("modes");
        let splits = analysis::splits(&modes);
        for reference in case.json["reference"].as_array().expect("a list") {
            let id = reference["id"].as_str().expect("an id");
            let Some((_, lower)) = id.strip_prefix("split_").and_then(|pair| pair.split_once('_')) else { continue };
            let lower: usize = lower.parse().expect("a number");
            let split = splits.iter().find(|split| split.lower == lower).unwrap_or_else(|| panic!("{name} {id}"));
            let truth = case.reference(id).expect("the reference");
            let upper = modes.list[lower].omega.to_f64();
            check(name, id, split.omega, &truth, 16.0, 1e-35 * upper / truth.to_f64());
        }
    }
}

/// o22 as a scene: both bodies hang on their springs, and the rest is exact.
#[test]
fn a_static_deflection_is_exact() {
    let name = "o22_preload_tiny_dynamics";
    let answer = ask("gravity 9.81 m/s^2
         body crate { mass = 1000 kg, moves y }
         body part { mass = 2 kg, moves y }
         spring K: ground -- crate { k = 1e5 N/m }
         spring k: crate -- part { k = 800 N/m }
         damper c: ground -- crate { c = 50 N*s/m }");
    let case = HardCase::load(name);
    let list = case.json["reference"].as_array().expect("a list");
    for (i, id) in ["static[x1]", "static[x2]"].iter().enumerate() {
        let entry = list.iter().find(|entry| entry["id"] == *id).expect("the reference");
        let truth = number(entry["value_decimal"].as_str().expect("a decimal"));
        // The references count downwards.
        let found = -&answer.lowered.rest.displacement[i];
        assert_eq!((&found - &truth).to_f64(), 0.0, "{id}: {found:?}");
    }
}
