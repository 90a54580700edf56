//! Complex shapes of damped motions, beside closed forms, and shapes at outputs. See docs/method/poles.md#shapes.

use crate::program::{json, text};
use serde_json::Value;

type Complex = (f64, f64);

fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn over(a: Complex, b: Complex) -> Complex {
    let square = b.0 * b.0 + b.1 * b.1;
    let product = times(a, (b.0, -b.1));
    (product.0 / square, product.1 / square)
}

fn entry(of: &Value) -> Complex {
    (of["re"].as_f64().expect("re"), of["im"].as_f64().expect("im"))
}

/// Poles with im s >= 0, and the shapes.
fn found(model: &str) -> (Vec<Complex>, Vec<Value>) {
    let whole = json(model, &["analyze", "--shapes", "damped"]);
    let poles = whole["poles"].as_array().expect("poles").iter().map(entry).filter(|pole| pole.1 >= 0.0).collect();
    (poles, whole["damped_shapes"].as_array().cloned().unwrap_or_default())
}

const TWO: &str = "body a { mass = 2 kg, moves x }\nbody b { mass = 1 kg, moves x }\n\
                   spring s: ground -- a { k = 300 N/m }\nspring t: a -- b { k = 200 N/m }\n";

/// The equation of b alone: (s^2 + c s + k) b = (c s + k) a, at light damping and where two poles are real.
#[test]
fn the_entries_satisfy_the_equation_of_a_body() {
    for c in [4.0, 90.0] {
        let model = format!("{TWO}damper d: a -- b {{ c = {c} N*s/m }}\noutput gap = b.x - a.x\noutput v = b.vx\n");
        let (poles, shapes) = found(&model);
        assert_eq!((poles.len(), shapes.len()), if c < 10.0 { (2, 2) } else { (3, 3) });
        for (s, row) in poles.into_iter().zip(shapes) {
            let link = (c * s.0 + 200.0, c * s.1);
            let square = times(s, s);
            let ratio = over(link, (square.0 + link.0, square.1 + link.1));
            let (a, b) = (entry(&row["shape"]["a.x"]), entry(&row["shape"]["b.x"]));
            assert!(a == (1.0, 0.0) || b == (1.0, 0.0), "{row}");
            assert!(a.0.hypot(a.1).max(b.0.hypot(b.1)) <= 1.0 + 1e-9);
            let truth = times(ratio, a);
            assert!((b.0 - truth.0).hypot(b.1 - truth.1) < 1e-12, "{b:?} {truth:?}");
            let (gap, v) = (entry(&row["outputs"]["gap"]), entry(&row["outputs"]["v"]));
            assert!((gap.0 - b.0 + a.0).hypot(gap.1 - b.1 + a.1) < 1e-15);
            let rate = times(s, b);
            assert!((v.0 - rate.0).hypot(v.1 - rate.1) < 1e-13);
            let bound = row["shape"]["a.x"]["error_bound"].as_f64().expect("a bound");
            assert!(bound < 1e-15 && row["not_computed"].is_null());
        }
    }
}

/// Damping in proportion leaves the undamped shapes: everything is in phase or opposite.
#[test]
fn classical_damping_has_real_shapes() {
    let (_, shapes) = found(&format!("{TWO}damping rayleigh(0.3 /s, 2 ms)\n"));
    let undamped = json(TWO, &["analyze"])["modes"].clone();
    for (row, mode) in shapes.iter().zip(undamped.as_array().expect("modes")) {
        for name in ["a.x", "b.x"] {
            let (found, real) = (entry(&row["shape"][name]), mode["shape"][name].as_f64().expect("a number"));
            assert!((found.0 - real).abs() < 1e-14 && found.1.abs() < 1e-25, "{found:?} {real}");
        }
    }
}

/// Two equal oscillators have only the span of their shapes; a critically damped one has a shape of its own.
#[test]
fn poles_of_several_motions_have_no_shape() {
    let one = |name: &str, c: f64| {
        format!(
            "body {name} {{ mass = 1 kg, moves x }}\nspring s{name}: ground -- {name} {{ k = 4 N/m }}\n\
             damper d{name}: ground -- {name} {{ c = {c} N*s/m }}\n"
        )
    };
    let (_, shapes) = found(&(one("a", 1.0) + &one("b", 1.0)));
    assert!(shapes.iter().all(|row| row["not_computed"].is_string()), "{shapes:?}");
    let printed = text(&(one("a", 1.0) + &one("b", 1.0)), &["analyze", "--shapes", "damped"]);
    assert!(printed.contains("pole 1: its shape is not determined"), "{printed}");
    let (_, shapes) = found(&one("a", 4.0));
    assert!(shapes.iter().all(|row| entry(&row["shape"]["a.x"]) == (1.0, 0.0)), "{shapes:?}");
}

/// The node of each mode on a body.
fn nodes_of(modes: &serde_json::Value, body: &str) -> Vec<[f64; 2]> {
    let of_mode = |mode: &serde_json::Value| {
        let nodes = mode["nodes"].as_array().expect("nodes");
        let node = nodes.iter().find(|node| node["body"] == body).expect("a node on the body");
        ["x", "y"].map(|axis| node[axis].as_f64().expect("a number"))
    };
    modes.as_array().expect("modes").iter().map(of_mode).collect()
}

/// A rigid body on two springs (Den Hartog, Mechanical Vibrations, 4th ed., section 3.4): with y + x theta = 0 at the
/// nodes, they are the roots of the quadratic equation that elimination of omega^2 leaves, and their product is -I/m.
#[test]
fn a_body_on_two_springs_turns_about_conjugate_points() {
    let model = "body car { mass = 1730 kg, inertia = 3267 kg*m^2, at = (2 m, 1 m), moves y, turns }\n\
                 point f = (3.189 m, 1 m)\npoint r = (304 mm, 1 m)\n\
                 spring kf: ground -- car@f { k = 35 kN/m, along = y }\nspring kr: ground -- car@r { k = 38 kN/m, along = y }";
    let (a, b, front, rear, square) = (1.189_f64, 1.696, 35e3, 38e3, 3267.0 / 1730.0);
    let (sum, mixed, turning) = (front + rear, front * a - rear * b, front * a * a + rear * b * b);
    // (sum - m w) y + mixed theta = 0, mixed y + (turning - I w) theta = 0, y = -x theta:
    // mixed x^2 + (sum I/m - turning) x - mixed I/m = 0.
    let half = (sum * square - turning) / (2.0 * mixed);
    let root = (half * half + square).sqrt();
    let mut expected = [-half - root, -half + root];
    let nodes = nodes_of(&json(model, &["analyze", "--shapes", "all"])["modes"], "car");
    // The lower mode bounces: its node is far away.
    expected.sort_by(|p, q| q.abs().total_cmp(&p.abs()));
    for (node, expected) in nodes.iter().zip(expected) {
        assert!((node[0] - 2.0 - expected).abs() < 1e-12 * expected.abs(), "{node:?} {expected}");
        assert_eq!(node[1], 1.0);
    }
    assert!(json(model, &["analyze"])["modes"][0]["nodes"].is_null());
    let printed = text(model, &["analyze", "--shapes", "all"]);
    assert!(printed.contains("nodes: the points about which bodies turn"), "{printed}");
    // Without a position the nodes are seen from the centre.
    let unplaced = "body car { mass = 2 kg, inertia = 3 kg*m^2, moves y, turns }\n\
                    spring k: ground -- car { k = 2 N/m }\nspring t: ground -- car { k = 5 N*m/rad }\n\
                    couple drive: 0.2 rad/m * car.y = car.angle";
    let mode = &json(unplaced, &["analyze", "--shapes", "all"])["modes"][0];
    assert_eq!((mode["nodes"][0]["x"].as_f64(), mode["nodes"][0]["from_centre"].as_bool()), (Some(-5.0), Some(true)));
}

/// Two pendulums drawn to the right, which hang at rest: the upper one turns about its pivot, the lower one about a point of
/// its own line, where the motion that the upper one hands on and its own rotation cancel.
#[test]
fn nodes_are_where_bodies_rest() {
    let model = "gravity 9.81 m/s^2\n\
                 point O = (1 m, 3 m)\npoint A = (1.6 m, 3 m)\npoint B = (2.5 m, 3 m)\n\
                 body upper { mass = 2 kg, shape = rod(O, A) }\nbody lower { mass = 1 kg, shape = rod(A, B) }\n\
                 pivot p: ground@O -- upper\npivot q: upper@A -- lower";
    let modes = json(model, &["analyze", "--shapes", "all"])["modes"].clone();
    for (mode, [x, y]) in modes.as_array().expect("modes").iter().zip(nodes_of(&modes, "upper")) {
        assert!((x - 1.0).abs() < 1e-14 && (y - 3.0).abs() < 1e-14, "{mode}");
    }
    for (mode, [x, y]) in modes.as_array().expect("modes").iter().zip(nodes_of(&modes, "lower")) {
        let [upper, lower] = ["upper.angle", "lower.angle"].map(|name| mode["shape"][name].as_f64().expect("a number"));
        // The joint at (1, 2.4) m moves by 0.6 m times the upper angle to the right.
        assert!((x - 1.0).abs() < 1e-14 && (y - 2.4 - 0.6 * upper / lower).abs() < 1e-13, "{mode}");
    }
}

/// The undamped shapes at outputs of displacements: b - a of (a, b), with the scaling of the shape; no rates.
#[test]
fn undamped_shapes_are_shown_at_outputs() {
    let model = format!("{TWO}output gap = b.x - a.x\noutput v = b.vx\noutput mean in mm = a.x / 2 + b.x / 2\n");
    let modes = json(&model, &["analyze", "--shapes", "all"])["modes"].clone();
    for mode in modes.as_array().expect("modes") {
        let [a, b] = ["a.x", "b.x"].map(|name| mode["shape"][name].as_f64().expect("a number"));
        let outputs = &mode["outputs"];
        assert!((outputs["gap"].as_f64().expect("gap") - (b - a)).abs() < 1e-14);
        assert!((outputs["mean"].as_f64().expect("mean") - 500.0 * (a + b)).abs() < 1e-11);
        assert!(outputs["v"].is_null());
    }
    assert!(json(&model, &["analyze"])["modes"][0]["outputs"].is_null());
    let printed = text(&model, &["analyze", "--shapes", "all"]);
    assert!(printed.lines().any(|line| line.trim_start().starts_with("gap") && line.contains("[m]")), "{printed}");
}
