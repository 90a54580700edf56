//! Invariances: names, order, units, the position and orientation of the drawing, a spring divided in two.
//!
//! One scene is written in many equivalent ways; its frequencies and poles must agree within their reported error
//! bounds, because both bounds claim to contain the true value.

use crate::ask::{Answer, ask};
use vibc::base::Ball;

/// One way to write the scene.
struct Style {
    /// A part's name.
    name: fn(&str) -> String,
    /// A drawn point from its coordinates in m.
    point: fn(&str, &str) -> String,
    /// A direction, from its components.
    direction: fn(&str, &str) -> String,
    /// The clause of a body that moves along x of the drawing.
    moves_x: &'static str,
    gravity: &'static str,
    /// A value in m, kg, N/m, N, N*m/rad, N*s/m, kg*m^2, N*m*s/rad.
    quantity: fn(&str, &str) -> String,
}

fn plain() -> Style {
    Style {
        name: str::to_string,
        point: |x, y| format!("({x} m, {y} m)"),
        direction: |x, y| format!("({x}, {y})"),
        moves_x: "moves x",
        gravity: "9.81 m/s^2",
        quantity: |value, unit| format!("{value} {unit}"),
    }
}

/// A cart, an arm and a bob under gravity on springs and dampers of every kind; its rest is not the drawing.
fn declarations(style: &Style) -> Vec<String> {
    let Style { name, point, direction, moves_x, gravity, quantity } = style;
    let (cart, arm, bob) = (name("cart"), name("arm"), name("bob"));
    let (a, b, wall, post) = (point("0", "0"), point("0.6", "-1.1"), point("-2", "0.3"), point("2", "-1.5"));
    let (middle, end) = (point("0.3", "-0.55"), point("1", "-1.9"));
    let q = quantity;
    vec![
        format!("gravity {gravity}"),
        format!("body {cart} {{ mass = {}, at = {a}, {moves_x} }}", q("3", "kg")),
        format!("body {arm} {{ mass = {}, shape = rod({a}, {b}) }}", q("1.5", "kg")),
        format!("body {bob} {{ mass = {}, at = {end}, inertia = {} }}", q("0.7", "kg"), q("0.05", "kg*m^2")),
        format!("pivot {}: {cart}@{a} -- {arm}", name("first")),
        format!("pivot {}: {arm}@{b} -- {bob}", name("second")),
        format!(
            "spring {}: ground@{wall} -- {cart}@{a} {{ k = {}, free_length = {} }}",
            name("wall"),
            q("120", "N/m"),
            q("1.7", "m")
        ),
        format!(
            "spring {}: ground@{post} -- {arm}@{b} {{ k = {}, preload = {} }}",
            name("tie"),
            q("45", "N/m"),
            q("3", "N")
        ),
        format!("spring {}: {arm} -- {bob} {{ k = {} }}", name("hinge"), q("2", "N*m/rad")),
        format!(
            "spring {}: ground -- {arm} {{ k = {}, along = {} }}",
            name("rail"),
            q("15", "N/m"),
            direction("3", "4")
        ),
        format!("damper {}: ground@{wall} -- {arm}@{middle} {{ c = {} }}", name("slow"), q("4", "N*s/m")),
        format!("damper {}: {arm} -- {bob} {{ c = {} }}", name("twist"), q("0.3", "N*m*s/rad")),
    ]
}

fn scene(style: &Style) -> String {
    declarations(style).join("\n")
}

/// Whether two enclosures may contain the same number.
fn overlap(a: &Ball, b: &Ball) -> bool {
    (a.mid - b.mid).abs().to_f64() <= (a.rad + b.rad) * (1.0 + 1e-15)
}

/// An infinitely wide bound would pass every comparison.
fn assert_sharp(answer: &Answer) {
    for mode in &answer.modes.list {
        assert!(mode.omega.relative_error() < 1e-12, "{:?}", mode.omega);
    }
    for pole in &answer.poles.list {
        assert!(pole.relative_error < 1e-12, "{pole:?}");
    }
}

fn assert_same(one: &Answer, other: &Answer, what: &str) {
    assert_sharp(one);
    assert_sharp(other);
    assert_eq!(one.modes.list.len(), other.modes.list.len(), "{what}");
    for (a, b) in one.modes.list.iter().zip(&other.modes.list) {
        assert_eq!(a.kind, b.kind, "{what}");
        assert!(overlap(&a.omega, &b.omega), "{what}: {:?} and {:?}", a.omega, b.omega);
        assert!(overlap(&a.omega_squared, &b.omega_squared), "{what}: {:?} and {:?}", a.omega_squared, b.omega_squared);
    }
    assert_eq!(one.poles.list.len(), other.poles.list.len(), "{what}");
    for (a, b) in one.poles.list.iter().zip(&other.poles.list) {
        assert_eq!(a.kind, b.kind, "{what}");
        assert!(overlap(&a.re, &b.re) && overlap(&a.im, &b.im), "{what}: {a:?} and {b:?}");
    }
}

fn assert_same_as_plain(text: &str, what: &str) {
    assert_same(&ask(&scene(&plain())), &ask(text), what);
}

#[test]
fn names_do_not_matter() {
    let renamed = Style { name: |name| format!("Ω_{}", name.chars().rev().collect::<String>()), ..plain() };
    assert_same_as_plain(&scene(&renamed), "renamed");
}

#[test]
fn order_does_not_matter() {
    let all = declarations(&plain());
    let n = all.len();
    // 5 and 7 have no common factor with 12: i -> 5 i + shift is a permutation.
    for (stride, shift) in [(1, 3), (5, 0), (5, 8), (7, 1), (11, 11)] {
        let shuffled: Vec<String> = (0..n).map(|i| all[(stride * i + shift) % n].clone()).collect();
        assert_same_as_plain(&shuffled.join("\n"), "reordered");
    }
}

#[test]
fn the_order_of_ends_does_not_matter() {
    let swapped: Vec<String> = declarations(&plain())
        .into_iter()
        .map(|text| {
            let Some((head, rest)) = text.split_once(": ") else { return text };
            let (ends, fields) = rest.split_once(" {").map_or((rest, String::new()), |(e, f)| (e, format!(" {{{f}")));
            let (a, b) = ends.split_once(" -- ").expect("two ends");
            format!("{head}: {b} -- {a}{fields}")
        })
        .collect();
    assert_same_as_plain(&swapped.join("\n"), "ends swapped");
}

#[test]
fn metric_units_do_not_matter() {
    let small = Style {
        point: |x, y| format!("({x}e3 mm, {y}e2 cm)"),
        quantity: |value, unit| match unit {
            "m" => format!("{value}e2 cm"),
            "kg" => format!("{value}e-3 t"),
            "N/m" => format!("{value}e-3 N/mm"),
            "N" => format!("{value}e-3 kN"),
            "N*m/rad" => format!("{value}e3 N*mm/rad"),
            "N*s/m" => format!("{value}e-6 kN*s/mm"),
            "kg*m^2" => format!("{value}e7 g*cm^2"),
            "N*m*s/rad" => format!("{value}e3 N*mm*s/rad"),
            other => panic!("{other}"),
        },
        gravity: "9.81e-3 km/s^2",
        ..plain()
    };
    assert_same_as_plain(&scene(&small), "millimetres and tonnes");
}

#[test]
fn customary_units_do_not_matter() {
    // 1 inch = 0.0254 m, 1 lb = 0.45359237 kg, 1 lbf = 1 lb * 9.80665 m/s^2, all exact.
    let customary = Style {
        point: |x, y| format!("({x}/0.0254 * 1 inch, {y}/0.3048 * 1 ft)"),
        quantity: |value, unit| match unit {
            "m" => format!("{value}/0.0254 * 1 inch"),
            "kg" => format!("{value}/0.45359237 * 1 lb"),
            "N/m" => format!("{value}*0.0254/(0.45359237*9.80665) * 1 lbf/inch"),
            "N" => format!("{value}/(0.45359237*9.80665) * 1 lbf"),
            "N*m/rad" => format!("{value}/(0.45359237*9.80665*0.3048) * 1 lbf*ft/rad"),
            "N*s/m" => format!("{value}*0.3048/(0.45359237*9.80665) * 1 lbf*s/ft"),
            // 1 slug = 1 lbf s^2/ft
            "kg*m^2" => format!("{value}/(0.45359237*9.80665*0.3048) * 1 slug*ft^2"),
            "N*m*s/rad" => format!("{value}/(0.45359237*9.80665*0.0254) * 1 lbf*inch*s/rad"),
            other => panic!("{other}"),
        },
        gravity: "9.81/9.80665 * 1 g0",
        ..plain()
    };
    assert_same_as_plain(&scene(&customary), "inches and pounds");
}

#[test]
fn the_place_of_the_drawing_does_not_matter() {
    let moved = Style { point: |x, y| format!("({x} m + 123.456 m, {y} m - 7.89 m)"), ..plain() };
    assert_same_as_plain(&scene(&moved), "moved");
}

#[test]
fn turning_the_drawing_with_gravity_does_not_matter() {
    let by_thirty = Style {
        point: |x, y| {
            format!("({x} m * cos(30 deg) - ({y} m) * sin(30 deg), {x} m * sin(30 deg) + ({y} m) * cos(30 deg))")
        },
        direction: |x, y| format!("({x}*cos(30 deg) - {y}*sin(30 deg), {x}*sin(30 deg) + {y}*cos(30 deg))"),
        moves_x: "moves along (cos(30 deg), sin(30 deg))",
        gravity: "(9.81 m/s^2 * sin(30 deg), -9.81 m/s^2 * cos(30 deg))",
        ..plain()
    };
    assert_same_as_plain(&scene(&by_thirty), "turned by 30 degrees");
    let by_quarter = Style {
        point: |x, y| format!("(-({y} m), {x} m)"),
        direction: |x, y| format!("(-({y}), {x})"),
        moves_x: "moves y",
        gravity: "(9.81 m/s^2, 0)",
        ..plain()
    };
    assert_same_as_plain(&scene(&by_quarter), "turned by 90 degrees");
    // The Pythagorean angle of 3-4-5 keeps every number rational.
    let by_pythagoras = Style {
        point: |x, y| format!("({x} m * 0.6 - ({y} m) * 0.8, {x} m * 0.8 + ({y} m) * 0.6)"),
        direction: |x, y| format!("({x}*0.6 - {y}*0.8, {x}*0.8 + {y}*0.6)"),
        moves_x: "moves along (3, 4)",
        gravity: "(9.81 m/s^2 * 0.8, -9.81 m/s^2 * 0.6)",
        ..plain()
    };
    assert_same_as_plain(&scene(&by_pythagoras), "turned by atan 4/3");
}

#[test]
fn a_mirrored_drawing_is_the_same() {
    let mirrored =
        Style { point: |x, y| format!("(-({x} m), {y} m)"), direction: |x, y| format!("(-({x}), {y})"), ..plain() };
    assert_same_as_plain(&scene(&mirrored), "mirrored");
}

#[test]
fn two_springs_in_parallel_are_one() {
    let split: Vec<String> = declarations(&plain())
        .into_iter()
        .flat_map(|text| {
            let is_element = text.starts_with("spring") || text.starts_with("damper");
            if !is_element {
                return vec![text];
            }
            ["0.3", "0.7"].map(|share| share_of(&text, share)).to_vec()
        })
        .collect();
    assert_same_as_plain(&split.join("\n"), "springs split");
}

/// The element with a share of its stiffness (or damping) and preload, under a different name.
fn share_of(text: &str, share: &str) -> String {
    let named = text.replacen(':', &format!("_{}:", share.replace('.', "_")), 1);
    named
        .replace("k = ", &format!("k = {share} * "))
        .replace("c = ", &format!("c = {share} * "))
        .replace("preload = ", &format!("preload = {share} * "))
}

#[test]
fn twice_the_masses_stiffnesses_and_loads_are_as_fast() {
    let heavier = Style {
        quantity: |value, unit| if unit == "m" { format!("{value} m") } else { format!("2 * {value} {unit}") },
        ..plain()
    };
    assert_same_as_plain(&scene(&heavier), "all doubled");
}

#[test]
fn parameters_and_lets_are_their_values() {
    let mut text = String::from("let half = whole / 2\nparam whole = 2\nparam unit_k = 1 N/m\n");
    for declaration in declarations(&plain()) {
        text += &declaration.replace("120 N/m", "120 * unit_k * half").replace("1.7 m", "1.7 m * half^3");
        text.push('\n');
    }
    assert_same_as_plain(&text, "with parameters");
}

/// A chain written with `repeat` and by hand.
#[test]
fn repeat_is_the_same_as_writing_it_out() {
    let repeated = ask("param n = 6\nbody m[1] { mass = 1 kg, moves x }
repeat i in 2..n { body m[i] { mass = i * 1 kg, moves x }\nspring k[i]: m[i-1] -- m[i] { k = 100 N/m / i } }
spring wall: ground -- m[1] { k = 70 N/m }\ndamper d: m[3] -- m[n] { c = 2 N*s/m }");
    let mut written = String::from("body a1 { mass = 1 kg, moves x }\nspring wall: ground -- a1 { k = 70 N/m }\n");
    for i in 2..=6 {
        written += &format!("body a{i} {{ mass = {i} kg, moves x }}\n");
        written += &format!("spring k{i}: a{} -- a{i} {{ k = 100 N/m / {i} }}\n", i - 1);
    }
    written += "damper d: a3 -- a6 { c = 2 N*s/m }";
    assert_same(&repeated, &ask(&written), "written out");
}

/// The same text gives the same bits twice.
#[test]
fn the_same_text_gives_the_same_bits() {
    let text = scene(&plain());
    let (one, two) = (ask(&text), ask(&text));
    assert_eq!(format!("{:?}", one.modes), format!("{:?}", two.modes));
    assert_eq!(format!("{:?}", one.poles), format!("{:?}", two.poles));
}
