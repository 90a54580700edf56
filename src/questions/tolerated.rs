//! What a scene does for all values within its tolerances. In: the text, its checked scene, values that are held. Out: the range of
//! each undamped frequency with the values at its ends, and whether each requirement holds everywhere, as far as this is proved
//! by monotonicity. See docs/method/studies.md.

use super::answer::{FrequencyRange, Monotone, Throughout, Tolerated, ToleratedParameter};
use super::require::judged;
use super::trial::{Facts, Text};
use crate::analysis::range::{Course, Family};
use crate::analysis::{ModeKind, Modes, Request};
use crate::base::number::jet;
use crate::base::{Ball, Diagnostics, Jet, Number, Quantity};
use crate::dynamics;
use crate::model::scene::{Comparison, Measure, Parameter, Require, Tolerance};
use crate::model::{CheckedScene, Setting};
use crate::system::LinearSystem;

/// With so many parameters or fewer, every corner is looked at where nothing is proved; with more, the ends of each alone.
const MOST_CORNERS: usize = 6;
/// Ends of so many parameters, where there are more.
const MOST_ALONE: usize = 30;

/// `None` if no parameter that is free has a range. `held`: values of those that the model determines.
pub fn tolerated(text: &Text, scene: &CheckedScene, held: &[Setting]) -> Option<Tolerated> {
    let is_free = |tolerance: &&Tolerance| held.iter().all(|(name, _)| *name != tolerance.parameter.name);
    // Scenes at other values than the declared ones have no tolerances.
    let declared = if held.is_empty() { None } else { Some(text.scene(&[]).ok()?) };
    let tolerances = &declared.as_ref().unwrap_or(scene).scene().tolerances;
    let free: Vec<&Tolerance> =
        tolerances.iter().filter(is_free).filter(|tolerance| tolerance.within.is_some()).collect();
    if free.is_empty() {
        return None;
    }
    let corners = Corners { text, held, free: &free };
    let found = corners.find();
    let mut places = vec![free.iter().map(|tolerance| tolerance.parameter.value.si.clone()).collect::<Vec<_>>()];
    if let Some(found) = &found {
        places.extend(found.ends.iter().cloned());
    }
    // These two decide about frequencies; where that is proved and all that is asked, others say nothing new.
    let is_frequency = |require: &Require| matches!(require.question.measure, Measure::Frequency { .. });
    if found.is_none() || !scene.scene().requires.iter().all(is_frequency) {
        places.extend(corners.others(&places[0]));
    }
    let settings = |place: &Vec<Number>| corners.settings(place);
    let frequencies = frequencies(text, &places.iter().map(settings).collect::<Vec<_>>(), found.as_ref());
    let requirements = requirements(text, scene, &corners, &places, found.as_ref());
    let range = |tolerance: &&Tolerance| {
        let Parameter { name, unit, .. } = &tolerance.parameter;
        Some(ToleratedParameter { name: name.clone(), unit: unit.clone(), ends: tolerance.within.clone()? })
    };
    Some(Tolerated {
        parameters: free.iter().filter_map(range).collect(),
        corners: found.map(|found| found.ends),
        frequencies,
        requirements,
        places: places.len(),
    })
}

/// The ends of the box between which every frequency lies, and which limits of requirements are the same in the whole box.
struct Found {
    ends: [Vec<Number>; 2],
    steady_limits: Vec<bool>,
    /// The number of coordinates.
    coordinates: usize,
}

struct Corners<'a> {
    text: &'a Text<'a>,
    held: &'a [Setting],
    free: &'a [&'a Tolerance],
}

impl Corners<'_> {
    /// The two corners, if in the whole box each parameter alone moves all eigenvalues in one direction: then along each
    /// edge from one corner to the other no frequency decreases.
    fn find(&self) -> Option<Found> {
        let mut ends = [Vec::new(), Vec::new()];
        let mut steady_limits: Option<Vec<bool>> = None;
        let mut coordinates = 0;
        for own in 0..self.free.len() {
            let (course, steady, n) = self.course(own)?;
            coordinates = n;
            let [low, high] = self.free[own].within.clone()?;
            let pair = if course == Course::Rises { [low, high] } else { [high, low] };
            for (end, si) in ends.iter_mut().zip(pair) {
                end.push(si);
            }
            let all = match steady_limits {
                None => steady,
                Some(before) => before.iter().zip(&steady).map(|(a, b)| *a && *b).collect(),
            };
            steady_limits = Some(all);
        }
        Some(Found { ends, steady_limits: steady_limits?, coordinates })
    }

    /// Other corners, as many as are looked at.
    fn others(&self, centre: &[Number]) -> Vec<Vec<Number>> {
        let ends: Vec<[Number; 2]> = self.free.iter().filter_map(|tolerance| tolerance.within.clone()).collect();
        let k = ends.len();
        if k <= MOST_CORNERS {
            let corner = |bits: usize| (0..k).map(|i| ends[i][bits >> i & 1].clone()).collect();
            return (0..1 << k).map(corner).collect();
        }
        let alone = |i: usize, end: usize| {
            let mut place = centre.to_vec();
            place[i] = ends[i][end].clone();
            place
        };
        (0..k.min(MOST_ALONE)).flat_map(|i| [alone(i, 0), alone(i, 1)]).collect()
    }

    /// A place as settings, with the values that are held.
    fn settings(&self, place: &[Number]) -> Vec<Setting> {
        let own = place.iter().enumerate().map(|(i, si)| self.setting(i, si.clone()));
        self.held.iter().cloned().chain(own).collect()
    }

    fn setting(&self, i: usize, si: Number) -> Setting {
        let parameter = &self.free[i].parameter;
        (parameter.name.clone(), Quantity { si, ..parameter.value.clone() })
    }

    /// The direction in which one parameter moves the eigenvalues while all others lie anywhere within their tolerances, and
    /// which limits no parameter moves. Every question about a sign on the way to the system has one answer in the whole box.
    fn course(&self, own: usize) -> Option<(Course, Vec<bool>, usize)> {
        let range = |i: usize| {
            let [low, high] = self.free[i].within.as_ref()?;
            let range = hull(low.enclosure(), high.enclosure());
            let slope = if i == own { Ball::ONE } else { Ball::ZERO };
            Some(self.setting(i, Number::Jet(Box::new(Jet { value: range, slope }))))
        };
        let ranges: Vec<Setting> = (0..self.free.len()).map(range).collect::<Option<_>>()?;
        let values = [self.held, &ranges].concat();
        let prepared = jet::undivided(|| {
            let scene = self.text.scene(&values).ok()?.without_damping();
            let limits = scene.scene().requires.iter();
            let steady = limits.map(|require| !matches!(require.question.value, Number::Jet(_))).collect();
            let lowered = dynamics::lower_written_out(&scene, &mut Diagnostics::new())?.lowered;
            let fits = lowered.rest.is_proven() && !lowered.system.is_chained();
            // Loss factors have no part in undamped modes.
            fits.then_some((LinearSystem { losses: None, ..lowered.system }, steady))
        });
        let (system, steady) = prepared??;
        let n = system.n();
        Some((Family::course(&system, false)?, steady, n))
    }
}

/// A ball that contains both.
fn hull(low: Ball, high: Ball) -> Ball {
    let middle = (low + high) * Ball::from(0.5);
    let reach = (low - Ball::exact(middle.mid)).magnitude().max((high - Ball::exact(middle.mid)).magnitude());
    Ball::exact(middle.mid).widen(reach)
}

/// The frequencies at the places, of which the first is the declared one. Those of the two corners enclose all others only if M is
/// positive definite at the upper corner (it is then so everywhere, for M is least there), which the number of modes shows.
fn frequencies(text: &Text, places: &[Vec<Setting>], found: Option<&Found>) -> Vec<FrequencyRange> {
    let at = |values: &Vec<Setting>| text.undamped(values, &Request::default()).ok().filter(Modes::is_complete);
    let Some(all) = places.iter().map(at).collect::<Option<Vec<Modes>>>() else { return Vec::new() };
    let count = all[0].list.len();
    if all.iter().any(|modes| modes.list.len() != count) {
        return Vec::new();
    }
    let frequency = |modes: &Modes, i: usize| {
        let mode = &modes.list[i];
        mode.frequency().filter(|_| mode.kind == ModeKind::Oscillation)
    };
    let proved = found.is_some_and(|found| found.coordinates == count);
    let range = |i: usize| {
        let seen: Option<Vec<Ball>> = all.iter().map(|modes| frequency(modes, i)).collect();
        let ends = seen.map(|seen| match proved {
            true => [seen[1], seen[2]],
            false => seen.iter().fold([seen[0]; 2], |[low, high], &f| {
                [if (f - low).mid.hi < 0.0 { f } else { low }, if (f - high).mid.hi > 0.0 { f } else { high }]
            }),
        });
        FrequencyRange { ends, proof: (proved && ends.is_some()).then_some(Monotone(())) }
    };
    (0..count).map(range).collect()
}

/// A requirement fails somewhere if it fails at one of the places. It holds everywhere if it is about a frequency and a limit that
/// nothing moves, and holds at the corner where the frequency is worst.
fn requirements(
    text: &Text,
    scene: &CheckedScene,
    corners: &Corners,
    places: &[Vec<Number>],
    found: Option<&Found>,
) -> Vec<Throughout> {
    let requires = &scene.scene().requires;
    if requires.is_empty() {
        return Vec::new();
    }
    let judge = |place: &Vec<Number>| {
        let found = text.scene(&corners.settings(place)).ok().map(|scene| judged(text, &scene, Facts::default()));
        found.unwrap_or_default().iter().map(|requirement| requirement.holds).collect::<Vec<_>>()
    };
    let tried: Vec<Vec<Option<bool>>> = places.iter().map(judge).collect();
    let each = requires.iter().enumerate().map(|(i, require)| {
        let verdict = |place: usize| tried.get(place).and_then(|list| list.get(i).copied().flatten());
        if let Some(place) = (0..tried.len()).find(|&place| verdict(place) == Some(false)) {
            return Throughout::FailsAt(places[place].clone());
        }
        let worst = match require.comparison {
            Some(Comparison::Greater | Comparison::GreaterEqual) => Some(1),
            Some(Comparison::Less | Comparison::LessEqual) => Some(2),
            _ => None,
        };
        let is_monotone = matches!(require.question.measure, Measure::Frequency { .. })
            && found.is_some_and(|found| found.steady_limits.get(i) == Some(&true));
        match is_monotone && verdict(1).is_some() && worst.and_then(verdict) == Some(true) {
            true => Throughout::Holds(Monotone(())),
            false => Throughout::Undetermined,
        }
    });
    each.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{SourceFile, Sources};
    use crate::model::{self, Overrides};
    use crate::syntax;

    fn of(model: &str) -> Option<Tolerated> {
        let mut sources = Sources::new();
        let file = sources.add(SourceFile::model("t.vib", model));
        let overrides = Overrides::default();
        let tree = syntax::parse(&sources, file).tree;
        let checked = model::check(&sources, &tree, &overrides);
        let scene = checked.scene.unwrap_or_else(|| panic!("{:?}", checked.diagnostics));
        let text = Text { sources: &sources, tree: &tree, overrides: &overrides, until: None, case: &[], fixed: &[] };
        tolerated(&text, &scene, &[])
    }

    fn proved(found: &Tolerated, mode: usize) -> [Ball; 2] {
        let range = found.frequencies[mode];
        assert!(range.proof.is_some());
        range.ends.expect("oscillations")
    }

    const BLOCK: &str = "param k = 100 N/m within 10 %\nparam m = 1 kg within 0.9 kg .. 1.2 kg\n\
                         body b { mass = m, moves x }\nspring s: ground -- b { k = k }\n";

    /// sqrt(90 / 1.2) and sqrt(110 / 0.9) rad/s
    #[test]
    fn a_block_has_its_extremes_at_corners() {
        let found = of(BLOCK).expect("tolerances");
        let [low, high] = proved(&found, 0);
        for (ball, square) in [(low, 90.0 / 1.2), (high, 110.0 / 0.9)] {
            let truth = f64::sqrt(square) / (2.0 * std::f64::consts::PI);
            assert!((ball.to_f64() - truth).abs() < 1e-14 * truth && ball.rad < 1e-25, "{ball:?} {truth}");
        }
        let corners = found.corners.expect("corners").map(|end| end.iter().map(Number::to_f64).collect::<Vec<_>>());
        assert_eq!(corners, [[90.0, 1.2], [110.0, 0.9]]);
    }

    /// Two blocks with springs of one parameter each: least and largest at corners, compared with omega^2 in closed form.
    #[test]
    fn coupled_blocks_move_between_two_corners() {
        let model = "param k = 10 N/m within 5 %\nparam q = 5 N/m within 20 %\nbody a { mass = 1 kg, moves x }\n\
                     body b { mass = 1 kg, moves x }\nspring s: ground -- a { k = k }\nspring t: a -- b { k = q }\n\
                     spring u: b -- ground { k = k }\n";
        let found = of(model).expect("tolerances");
        for (mode, ends) in [(0, [9.5, 10.5]), (1, [9.5 + 2.0 * 4.0, 10.5 + 2.0 * 6.0])] {
            for (ball, square) in proved(&found, mode).into_iter().zip(ends) {
                let truth = f64::sqrt(square) / (2.0 * std::f64::consts::PI);
                assert!((ball.to_f64() - truth).abs() < 1e-14 * truth, "{ball:?} {truth}");
            }
        }
    }

    #[test]
    fn requirements_over_frequencies_are_decided() {
        // Between 1.378 Hz and 1.760 Hz.
        let verdict = |line: &str| of(&format!("{BLOCK}require {line}\n")).expect("tolerances").requirements[0].clone();
        assert!(matches!(verdict("frequency(1) > 1.37 Hz"), Throughout::Holds(_)));
        assert!(matches!(verdict("frequency(1) < 1.77 Hz"), Throughout::Holds(_)));
        assert!(matches!(verdict("frequency(1) > 1.38 Hz"), Throughout::FailsAt(at) if at[1].to_f64() == 1.2));
        assert!(matches!(verdict("frequency(1) < 1.75 Hz"), Throughout::FailsAt(at) if at[1].to_f64() == 0.9));
        // A limit that moves too: kept at the corners of the frequency and at the values themselves, but not at k = 110 N/m, m = 1.2 kg, where it
        // is 1.595 Hz and the frequency 1.524 Hz.
        let moving = "frequency(1) > 1.45 Hz * (k / (100 N/m))";
        assert!(matches!(verdict(moving), Throughout::FailsAt(at) if at[0].to_f64() == 110.0 && at[1].to_f64() == 1.2));
    }

    /// A parameter that stiffens one spring and softens another has no direction; one that moves a place, and one that
    /// turns round within its range, have none either.
    #[test]
    fn nothing_is_claimed_without_a_direction() {
        let blocks = |k: &str| {
            format!(
                "param p = 5 N/m within 4 N/m .. 6 N/m\nbody a {{ mass = 1 kg, moves x }}\nbody b {{ mass = 1 kg, moves x }}\n\
                 spring s: ground -- a {{ k = {k} }}\nspring t: a -- b {{ k = 10 N/m }}\nspring u: b -- ground {{ k = 12 N/m - p }}\n"
            )
        };
        let turning = "param p = 5 N/m within 4 N/m .. 6 N/m\nbody a { mass = 1 kg, moves x }\n\
                       spring s: ground -- a { k = 10 N/m + p - p^2 / (9 N/m) }\n";
        for model in [blocks("p"), turning.to_string()] {
            let found = of(&model).expect("tolerances");
            assert!(found.corners.is_none() && found.frequencies.iter().all(|range| range.proof.is_none()), "{model}");
        }
        // Both springs fall with it.
        assert!(of(&blocks("12 N/m - p")).expect("tolerances").corners.is_some());
        assert!(of("body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 1 N/m }\n").is_none());
    }
}
