//! Random scenes: chains, trees and nets along x and y and of wheels, with and without coordinates, pendulums.

use std::fmt::Write;

/// A small generator (Knuth's MMIX constants), of which the upper bits are used.
struct Chance(u64);

impl Chance {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }
}

/// Names of various lengths.
fn name(chance: &mut Chance, letter: char, number: u64) -> String {
    let tail = ["", "_left", "_of_the_engine", "θ", "_2"][chance.below(5) as usize];
    format!("{letter}{number}{tail}")
}

pub fn scene(seed: u64) -> String {
    let mut chance = Chance(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) + 1);
    chance.below(2);
    match chance.below(4) {
        0 => tied(&mut chance, "moves x"),
        1 => tied(&mut chance, "moves y"),
        2 => tied(&mut chance, "turns"),
        _ => pendulums(&mut chance),
    }
}

/// Bodies with one kind of motion, each connected to the ground, a base or some earlier bodies.
fn tied(chance: &mut Chance, moves: &str) -> String {
    let turns = moves == "turns";
    let count = 1 + chance.below(9);
    let to_scale = chance.below(3) == 0 && !turns;
    let (k, c) = if turns { ("N*m/rad", "N*m*s/rad") } else { ("N/m", "N*s/m") };
    let mut text = String::from("model generated\n");
    let mut names: Vec<String> = Vec::new();
    if chance.below(3) == 0 {
        let at = if to_scale { ", at = (-1 m, -1 m)" } else { "" };
        let _ = writeln!(text, "base road {{ {moves}{at} }}");
        names.push("road".into());
    }
    for number in 0..count {
        let name = name(chance, 'b', number);
        let property = if turns { "inertia = 2 kg*m^2" } else { "mass = 2 kg" };
        let at =
            if to_scale { format!(", at = ({} m, {} m)", chance.below(7), chance.below(5)) } else { String::new() };
        let _ = writeln!(text, "body {name} {{ {property}, {moves}{at} }}");
        let ties = 1 + chance.below(3);
        for tie in 0..ties {
            let other = match chance.below(names.len() as u64 + 1) {
                0 => "ground".to_string(),
                which => names[which as usize - 1].clone(),
            };
            let along = if turns { String::new() } else { format!(", along = {}", &moves[6..]) };
            let letter = format!("{number}_{tie}");
            let _ = match chance.below(2) {
                0 => writeln!(text, "spring k{letter}: {other} -- {name} {{ k = 10 {k}{along} }}"),
                _ => writeln!(text, "damper c{letter}: {other} -- {name} {{ c = 1 {c}{along} }}"),
            };
        }
        if chance.below(3) == 0 {
            let motion = if turns { "angle" } else { &moves[6..] };
            let _ = writeln!(text, "output o{number} = {name}.{motion}");
        }
        if chance.below(4) == 0 {
            let _ = match turns {
                true => writeln!(text, "torque T{number}: {name}"),
                false => writeln!(text, "force F{number}: {name} along {}", &moves[6..]),
            };
        }
        names.push(name);
    }
    text
}

/// Rods that hang on each other, with springs to the ground.
fn pendulums(chance: &mut Chance) -> String {
    let mut text = String::from("model generated\ngravity 9.81 m/s^2\npoint P0 = (0, 0)\n");
    let mut carrier = "ground@P0".to_string();
    for number in 1..=1 + chance.below(4) {
        let (x, y) = (chance.below(7) as i64 - 3, -1 - chance.below(3) as i64);
        let before = number - 1;
        let _ = writeln!(text, "point P{number} = P{before} + ({x} m, {y} m)");
        let name = name(chance, 'r', number);
        let _ = writeln!(text, "body {name} {{ mass = 1 kg, shape = rod(P{before}, P{number}) }}");
        let _ = writeln!(text, "pivot p{number}: {carrier} -- {name}");
        if chance.below(2) == 0 {
            let _ =
                writeln!(text, "spring s{number}: ground@(P{number} + (2 m, 0)) -- {name}@P{number} {{ k = 5 N/m }}");
        }
        if chance.below(2) == 0 {
            let _ = writeln!(text, "output q{number} = {name}.angle");
        }
        carrier = format!("{name}@P{number}");
    }
    text
}
