//! Every printed bound of a frequency or a pole holds and is sharp: random systems of every kind against exact arithmetic.
//! `cargo bench --bench bounds` does the same for ten thousand of them.

use super::sweeps::{DAMPED, Figures, Kind, UNDAMPED, check_modes, check_poles, turned};
use super::systems::Random;
use vibc::system::LinearSystem;

/// The number of systems of each kind; fewer of the large ones, for which exact arithmetic takes long.
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
            let system = system(&mut random, i);
            check_modes(&system, &system, &mut figures, &format!("{name} {i}"));
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
            let system = system(&mut random, i);
            check_poles(&system, &system, &mut figures, &format!("{name} {i}"));
        }
        assert_sound(&figures);
        let limit = 4.0 * figures.average_size();
        assert!(figures.median() <= limit, "{name}: bounds are {} times the errors", figures.median());
    }
}

/// Numbers that are not rational: nearly all results are certified, as sharply as with rational ones.
#[test]
fn rotated_drawings_are_certified() {
    let small = |kinds: &'static [Kind]| kinds.iter().filter(|(name, _)| !name.starts_with("beyond"));
    // Which motions have no inertia is decided only for rational numbers.
    let modes = small(&UNDAMPED).filter(|(name, _)| !name.starts_with("massless"));
    let modes = modes.map(|kind| (kind, check_modes as Check));
    let poles = small(&DAMPED).map(|kind| (kind, check_poles as Check));
    for (at, ((name, system), check)) in modes.chain(poles).enumerate() {
        let (mut random, mut figures) = (Random::new(20_261_321 + at as u64), Figures::default());
        for i in 0..FEW {
            let truth = system(&mut random, i);
            check(&turned(&truth), &truth, &mut figures, &format!("{name} {i}"));
        }
        assert!(figures.violations.is_empty(), "{:#?}", figures.violations);
        // Whether a damper acts on a motion may depend on unknown relations between such numbers.
        assert!(8 * figures.uncertified.len() <= figures.numbers, "{name}: {:#?}", figures.uncertified);
        assert!(figures.median() <= 10.0, "{name}: bounds are {} times the errors", figures.median());
    }
}

type Check = fn(&LinearSystem, &LinearSystem, &mut Figures, &str);
