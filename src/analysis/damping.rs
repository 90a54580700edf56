//! Damping that is declared for the whole system: Rayleigh's C = alpha M + beta K, and one ratio for all modes,
//! C = sum 2 zeta omega_i (M x_i)(M x_i)^T over the oscillations. In: a system; out: its C with these terms added.
//! See docs/method/response.md.

use crate::analysis::answer::{ModeKind, Modes, PRECISE};
use crate::analysis::modes::form;
use crate::analysis::modes::squares::Squares;
use crate::base::{Ball, Dd, Name, Number};
use crate::system::{CoordinateId, Form, Label, LinearSystem, Nature, Origin, Source};

/// Adds alpha M + beta K, term by term: exact where these are.
pub fn rayleigh(system: &mut LinearSystem, alpha: &Number, beta: &Number) {
    let (m, k) = (system.m.clone(), system.k.clone());
    let source = source(system);
    for (form, factor) in [(&m, alpha), (&k, beta)] {
        add_scaled(&mut system.c, source, form, factor);
    }
}

fn source(system: &mut LinearSystem) -> u32 {
    let name = Label { name: Name::plain(system.words.intern("damping")), motion: "" };
    system.c.source(Source { name, origin: Origin::Damping })
}

fn add_scaled(c: &mut Form, source: u32, form: &Form, factor: &Number) {
    for term in form.terms() {
        c.push(source, term.nature, factor * &term.weight, form.row(term).iter().cloned());
    }
}

/// Adds the damping ratio to every oscillation. The rows M x_i are the double-double numbers that were computed: they give
/// each mode its ratio to about 28 digits, and are data from then on.
///
/// The modes keep the shapes that were refined for it: they are those of the damped system too.
pub fn modal(system: &mut LinearSystem, ratio: &Number, modes: &mut Modes) {
    let n = system.n();
    let m = Squares::of(&system.m);
    let shapes = form::shapes(system, modes);
    if n <= PRECISE {
        modes.list.iter_mut().enumerate().for_each(|(i, mode)| mode.precise = Some(shapes.column(i).to_vec()));
    }
    let source = source(system);
    for (i, mode) in modes.list.iter().enumerate().filter(|(_, mode)| mode.kind == ModeKind::Oscillation) {
        let row = momentum(&m, shapes.column(i), n);
        let entries = (0u32..).zip(row).map(|(j, x)| (CoordinateId(j), Number::Ball(Ball::exact(x))));
        let weight = &(ratio * &Number::from(2)) * &Number::Ball(mode.omega);
        system.c.push(source, Nature::Property, weight, entries);
    }
}

/// M x
fn momentum(m: &Squares, x: &[Dd], n: usize) -> Vec<Dd> {
    let mut momentum = vec![Dd::ZERO; n];
    for t in 0..m.len() {
        let weighted = (m.weights[t] * m.stretch(t, x)).mid;
        let (indices, values) = m.row(t);
        for (&i, a) in indices.iter().zip(values) {
            momentum[i as usize] += weighted * a.mid;
        }
    }
    momentum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::analysis::{modes, poles};

    fn chain() -> LinearSystem {
        let mut system = blank(3);
        for i in 0..3 {
            push(&mut system.m, "2", i, None);
            push(&mut system.k, "50", i, i.checked_sub(1));
        }
        system
    }

    #[test]
    fn every_mode_gets_its_ratio() {
        let mut system = chain();
        let mut undamped = modes(&system).expect("modes");
        modal(&mut system, &Number::from("0.02"), &mut undamped);
        let poles = poles(&system, &undamped).expect("poles");
        assert_eq!(poles.list.len(), 6);
        for pole in &poles.list {
            let zeta = pole.damping_ratio.expect("no pole at zero");
            assert!((zeta.to_f64() - 0.02).abs() < 1e-16, "{zeta:?}");
        }
    }

    /// zeta_i = (alpha / omega_i + beta omega_i) / 2.
    #[test]
    fn rayleigh_damping_has_its_ratios() {
        let mut system = chain();
        let undamped = modes(&system).expect("modes");
        rayleigh(&mut system, &Number::from("0.1"), &Number::from("0.001"));
        let poles = poles(&system, &undamped).expect("poles");
        for (mode, pair) in undamped.list.iter().zip(poles.list.chunks(2)) {
            let omega = mode.omega.to_f64();
            let zeta = pair[0].damping_ratio.expect("no pole at zero").to_f64();
            assert!((zeta - 0.5 * (0.1 / omega + 0.001 * omega)).abs() < 1e-15);
        }
    }
}
