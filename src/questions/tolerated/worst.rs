//! The worst case of the measure of a line `minimise` or `maximise` over all values within the tolerances, and how good the worst case
//! can be at best. See docs/method/measures.md#worst-cases.

use super::boxes::{Boxes, Part, Point, Sought, WHOLE};
use super::extremes::{Seen, Until};
use super::{Asked, Corners, Subject, others};
use crate::base::{Ball, Diagnostics, Number};
use crate::dynamics;
use crate::model::Setting;
use crate::model::scene::{Measure, Optimum, Tolerance};
use crate::questions::answer::{Proved, WorstCase};
use crate::questions::trial::Text;

/// Parts of the ranges of varied parameters that are looked at.
const MOST_PARTS: usize = 800;
/// Each design may take this part of all work: some tenths of a second.
const SHARE: u64 = 40;
/// The share of the worst case that is left between it and the best that is possible.
const LITTLE: f64 = 1e-9;

/// The worst case at values that are held; `None` if the measure has no value at one of them.
pub fn worst(
    text: &Text,
    (optimum, index): (&Optimum, usize),
    held: &[Setting],
    free: &[Tolerance],
) -> Option<WorstCase> {
    let held = &others(held, free);
    let corners = Corners::new(text, held, free, Subject::Optimum(index));
    let places = corners.places();
    let boxes = Boxes::new(&corners);
    let points: Vec<Point> = places.iter().map(|place| boxes.point_at(place)).collect();
    let scene = text.scene(held).ok()?;
    let asked = Asked::new(&scene, &boxes, &places, &points);
    let mut seen = asked.seen_values(Sought::Measure(0))?;
    let sign = if optimum.highest { -1.0 } else { 1.0 };
    boxes.begin();
    let bound = match asked.can_cut() && !corners.follows_rest() {
        true => boxes.extreme(Sought::Measure(0), sign, &mut seen, Until::Close).0,
        false => None,
    };
    let (reached, at) = seen.ends[usize::from(!optimum.highest)].clone();
    let limits = optimum.limits.iter().enumerate();
    let conditions = limits.map(|(i, limit)| asked.requirement(1 + i, limit, None, &[]).1).collect();
    let measures = std::iter::once(&optimum.question).chain(optimum.limits.iter().map(|limit| &limit.question));
    let needs_decay = measures.map(|question| &question.measure).any(Measure::is_of_transfer);
    let decays = !needs_decay || asked.can_cut() && (boxes.is_passive() || asked.all_decay());
    let bound = bound.map(|(bound, _)| (bound, Proved(())));
    Some(WorstCase { reached, at, bound, conditions, decays })
}

/// The values at the middle and at corners that are looked at first.
pub fn places(text: &Text, held: &[Setting], free: &[Tolerance]) -> Vec<Vec<Number>> {
    Corners::new(text, &others(held, free), free, Subject::Requirements).places()
}

impl Corners<'_> {
    fn places(&self) -> Vec<Vec<Number>> {
        let centre: Vec<Number> = self.free.iter().map(|tolerance| tolerance.parameter.value.si.clone()).collect();
        let scene = self.text.scene(&self.settings(&centre)).ok();
        let lowered = scene.and_then(|scene| dynamics::lower_written_out(&scene, &mut Diagnostics::new()));
        let n = lowered.map_or(1, |written| written.lowered.system.n());
        let others = self.others(&centre, n);
        std::iter::once(centre).chain(others).collect()
    }
}

/// What is varied while everything else has one value within its tolerance: values that are held, and the ranges of the varied parameters.
pub struct Design {
    pub held: Vec<Setting>,
    pub ranges: Vec<Tolerance>,
}

/// What the worst case is at least, at any values in the ranges (at most, if it is maximised): at each, the measure in one of the designs
/// is as bad as that. Stops when it is as bad as `known`.
pub fn best_possible(
    text: &Text,
    (optimum, index): (&Optimum, usize),
    designs: &[Design],
    known: Ball,
) -> Option<(Ball, Proved)> {
    let sign = if optimum.highest { 1.0 } else { -1.0 };
    let corners =
        designs.iter().map(|Design { held, ranges }| Corners::new(text, held, ranges, Subject::Optimum(index)));
    let corners: Vec<Corners> = corners.collect();
    if corners.iter().any(Corners::follows_rest) {
        return None;
    }
    let boxes: Vec<Boxes> = corners.iter().map(Boxes::new).collect();
    boxes.iter().for_each(|boxes| boxes.begin_with_share(SHARE));
    let goal = sign * known.to_f64() + LITTLE * known.magnitude();
    let mut seen = Seen::of([(known, Vec::new())])?;
    // In the direction in which the measure is better, as bounds of parts are.
    let mut bound_of = |part: &Part, above: f64| {
        let mut bound = above;
        for boxes in &boxes {
            bound = bound.min(boxes.bound_over(part.clone(), Sought::Measure(0), sign, &mut seen).bound);
            if bound <= goal {
                break;
            }
        }
        bound
    };
    let whole: Part = vec![[0, WHOLE]; optimum.varied.len()];
    let mut parts = vec![(bound_of(&whole, f64::INFINITY), whole)];
    loop {
        let worst = (0..parts.len()).max_by(|&a, &b| parts[a].0.total_cmp(&parts[b].0).then(b.cmp(&a)))?;
        let (bound, part) = parts[worst].clone();
        let done = bound <= goal || parts.len() >= MOST_PARTS || !boxes.iter().all(Boxes::may_go_on);
        let Some([first, second]) = (if done { None } else { halves(&part) }) else {
            let is_proved = bound.is_finite() && !boxes.iter().any(Boxes::strays);
            return is_proved.then(|| (Ball::from(sign * bound), Proved(())));
        };
        parts[worst] = (bound_of(&first, bound), first);
        parts.push((bound_of(&second, bound), second));
    }
}

/// A part cut across its widest range; `None` if it is too narrow to be cut.
fn halves(part: &Part) -> Option<[Part; 2]> {
    let width = |i: usize| part[i][1] - part[i][0];
    let widest = (0..part.len()).max_by_key(|&i| (width(i), std::cmp::Reverse(i)))?;
    let [low, high] = part[widest];
    let with = |ends: [u32; 2]| {
        let mut half = part.clone();
        half[widest] = ends;
        half
    };
    let middle = low + (high - low) / 2;
    (high - low >= 4).then(|| [with([low, middle]), with([middle, high])])
}
