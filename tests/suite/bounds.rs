//! Every printed bound of a frequency or a pole holds and is sharp: random systems of every kind against exact arithmetic.
//! `cargo bench --bench bounds` does the same for ten thousand of them.

use super::sweeps::{DAMPED, Figures, UNDAMPED, check_modes, check_poles};
use super::systems::Random;

/// Systems of each kind; of the large ones, which exact arithmetic takes long for, fewer.
const FEW: usize = 16;
const LARGE: usize = 3;

fn assert_sound(figures: &Figures) {
    assert!(figures.violations.is_empty(), "{:#?}", figures.violations);
    assert!(figures.uncertified.is_empty(), "{:#?}", figures.uncertified);
}

#[test]
fn bounds_of_frequencies_hold_and_are_sharp() {
    for (at, (name, system)) in UNDAMPED.iter().enumerate() {
        let (mut random, mut figures) = (Random::new(20_261_121 + at as u64), Figures::default());
        for i in 0..FEW {
            check_modes(&system(&mut random, i), &mut figures, &format!("{name} {i}"));
        }
        assert_sound(&figures);
        assert!(figures.median() <= 10.0, "{name}: bounds are {} times the errors", figures.median());
    }
}

#[test]
fn bounds_of_poles_hold_and_are_sharp() {
    for (at, (name, system)) in DAMPED.iter().enumerate() {
        let (mut random, mut figures) = (Random::new(20_261_221 + at as u64), Figures::default());
        let count = if name.starts_with("beyond") { LARGE } else { FEW };
        for i in 0..count {
            check_poles(&system(&mut random, i), &mut figures, &format!("{name} {i}"));
        }
        assert_sound(&figures);
        let limit = 4.0 * figures.average_size();
        assert!(figures.median() <= limit, "{name}: bounds are {} times the errors", figures.median());
    }
}
