//! What a scene does for all values within its tolerances. In: the text, its checked scene, values that are held. Out: the range of
//! each undamped frequency, damping ratio, pole and measure with the values at its ends, and whether each requirement holds everywhere,
//! as far as this is proved. See docs/method/studies.md#tolerances.
//!
//! Undamped frequencies come from two corners where each parameter moves all of them in one direction. [`extremes`] finds the others,
//! from what [`boxes`] tells about parts of the ranges.

mod boxes;
mod extremes;
mod reason;
mod rests;
mod tubes;
mod worst;

pub(super) use worst::{Design, best_possible, places, worst};

use super::answer::{Proved, Range, RangeProof, Throughout, Tolerated, ToleratedParameter};
use super::trial::Text;
use crate::analysis::range::{Course, Family, outer};
use crate::analysis::{ModeKind, Modes, Request, modes_as};
use crate::base::number::jet;
use crate::base::{Ball, Diagnostics, Jet, Number, Quantity, Rational};
use crate::dynamics;
use crate::lower::rest::Rest;
use crate::model::scene::{Comparison, Measure, Optimum, Parameter, Require, Scene, Tolerance};
use crate::model::{CheckedScene, Setting};
use crate::system::LinearSystem;
use boxes::{Boxes, Point, Sought};
use extremes::Seen;
use std::cell::OnceCell;

/// With so many parameters or fewer, every corner is looked at where nothing is proved; with more, the ends of each alone.
const MOST_CORNERS: usize = 6;
/// Ends of so many parameters, where there are more.
const MOST_ALONE: usize = 30;

/// Places times the cube of the coordinates that are looked at: the poles of each, and what is measured, take some seconds in all.
const MOST_LOOKED_AT: usize = 3_000_000;
/// Every mode of larger systems is computed at the declared values and at the two corners alone.
const MOST_COORDINATES: usize = 60;
/// Parameters times coordinates for which anything is proved: some seconds.
const MOST_WORK: usize = 1_000_000;

/// `None` if no parameter that is free has a range. `held`: values of those that the model determines; `n`: the number of coordinates.
///
/// `robust`: the tolerances of parameters that a line optimises are those about the values that were found.
pub fn within_tolerances(
    text: &Text,
    (scene, n): (&CheckedScene, usize),
    held: &[Setting],
    robust: bool,
) -> Option<Tolerated> {
    // Scenes at other values than the declared ones have no tolerances.
    let declared = if held.is_empty() { None } else { Some(text.scene(&[]).ok()?) };
    let declared = declared.as_ref().unwrap_or(scene).scene();
    let free = match robust {
        true => varied_tolerances(declared, held),
        false => ranges(declared).filter(|tolerance| value_of(held, tolerance).is_none()).cloned().collect(),
    };
    if free.is_empty() {
        return None;
    }
    let held = &others(held, &free);
    let corners = Corners::new(text, held, &free, Subject::Requirements);
    // Each parameter alone takes the scene through all stages once.
    let found = if free.len().saturating_mul(n) > MOST_WORK { None } else { corners.find(n) };
    let mut places = vec![free.iter().map(|tolerance| tolerance.parameter.value.si.clone()).collect::<Vec<_>>()];
    let ends = found.as_ref().and_then(|found| found.ends.as_ref());
    places.extend(ends.iter().copied().flatten().cloned());
    // These two decide about frequencies; where that is proved and all that is asked, others say nothing new.
    let is_frequency = |require: &Require| matches!(require.question.measure, Measure::Frequency { .. });
    if ends.is_none() || !scene.scene().requires.iter().all(is_frequency) {
        places.extend(corners.others(&places[0], n));
    }
    let boxes = Boxes::new(&corners);
    let points: Vec<Point> = places.iter().map(|place| boxes.point_at(place)).collect();
    let asked = Asked::new(scene, &boxes, &places, &points);
    let found = found.filter(|_| asked.keeps_rest);
    let mut frequencies = frequencies(&corners, &places, found.as_ref());
    let (measures, requirements) = asked.requirements(found.as_ref(), &frequencies);
    let (mut ratios, mut poles) = (Vec::new(), Vec::new());
    if asked.can_cut() {
        for (i, range) in frequencies.iter_mut().enumerate().filter(|(_, range)| is_wide(range)) {
            asked.narrow(range, Sought::Frequency(i));
        }
        (ratios, poles) = asked.damped_ranges();
    }
    let mut ranges = frequencies.iter().chain(&ratios).chain(poles.iter().flatten()).chain(measures.iter().flatten());
    let is_open = ranges.any(|range| range.ends.is_some() && range.proof.is_none());
    Some(Tolerated {
        follows_rest: corners.follows_rest(),
        never: scene.scene().requires.iter().map(|require| reason::why_never(&require.question.measure)).collect(),
        not_proved: if is_open { asked.why_unproved() } else { None },
        parameters: free.iter().filter_map(parameter).collect(),
        frequencies,
        ratios,
        poles,
        measures,
        requirements,
        places: places.len(),
        corners: found.and_then(|found| found.ends),
    })
}

pub(super) fn parameter(tolerance: &Tolerance) -> Option<ToleratedParameter> {
    let Parameter { name, unit, .. } = &tolerance.parameter;
    Some(ToleratedParameter { name: name.clone(), unit: unit.clone(), ends: tolerance.within.clone()? })
}

fn ranges(scene: &Scene) -> impl Iterator<Item = &Tolerance> {
    scene.tolerances.iter().filter(|tolerance| tolerance.within.is_some())
}

/// The value that a parameter with a tolerance is held at.
fn value_of<'a>(held: &'a [Setting], tolerance: &Tolerance) -> Option<&'a Quantity> {
    held.iter().find(|(name, _)| *name == tolerance.parameter.name).map(|(_, value)| value)
}

/// The values that are held of parameters without a tolerance.
pub(super) fn others(held: &[Setting], free: &[Tolerance]) -> Vec<Setting> {
    let is_free = |name: &str| free.iter().any(|tolerance| tolerance.parameter.name == name);
    held.iter().filter(|(name, _)| !is_free(name)).cloned().collect()
}

/// The tolerances of a scene's parameters, but for those that a `solve` determines; about the values that are held of others.
pub(super) fn varied_tolerances(scene: &Scene, held: &[Setting]) -> Vec<Tolerance> {
    let is_solved =
        |tolerance: &&Tolerance| scene.solves.iter().any(|solve| solve.parameter.name == tolerance.parameter.name);
    let about = |tolerance: &Tolerance| match value_of(held, tolerance) {
        Some(value) => tolerance.about(&value.si),
        None => tolerance.clone(),
    };
    ranges(scene).filter(|tolerance| !is_solved(tolerance)).map(about).collect()
}

/// The lines whose measures are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Subject {
    Requirements,
    /// The measure of the line `minimise` or `maximise` with this index, and its conditions.
    Optimum(usize),
}

impl Subject {
    /// As requirements; one of a measure alone has no comparison.
    fn lines(self, scene: &Scene) -> Vec<Require> {
        match self {
            Subject::Requirements => scene.requires.clone(),
            Subject::Optimum(index) => scene.optima.get(index).map_or_else(Vec::new, |optimum| {
                let Optimum { span, question, limits, .. } = optimum;
                let measure = Require { span: *span, question: question.clone(), comparison: None };
                std::iter::once(&measure).chain(limits).cloned().collect()
            }),
        }
    }
}

/// The range of each parameter, SI.
type Ranges = Vec<[Number; 2]>;

/// What is proved of the whole box.
struct Found {
    /// Where every frequency is least and largest, if each parameter alone moves all of them in one direction.
    ends: Option<[Vec<Number>; 2]>,
    /// Which limits of requirements are the same in the whole box.
    steady_limits: Vec<bool>,
    /// The number of coordinates.
    coordinates: usize,
    /// Boxes that together are the whole.
    pieces: Vec<Ranges>,
}

/// What is proved of a piece: the direction of each parameter, if it has one; steady limits, and coordinates.
struct Piece {
    courses: Vec<Option<Course>>,
    steady_limits: Vec<bool>,
    coordinates: usize,
}

struct Corners<'a> {
    text: &'a Text<'a>,
    held: &'a [Setting],
    free: &'a [Tolerance],
    subject: Subject,
    /// The rest over the whole box, where parameters move it.
    rest: OnceCell<Option<Rest>>,
}

impl<'a> Corners<'a> {
    fn new(text: &'a Text<'a>, held: &'a [Setting], free: &'a [Tolerance], subject: Subject) -> Corners<'a> {
        Corners { text, held, free, subject, rest: OnceCell::new() }
    }

    /// `None` if a parameter moves more than the weights of masses and springs. Where numbers over the whole box are too wide to
    /// decide, it is cut: what is constant, or rises, in each of two boxes with a common side, does so in both together.
    fn find(&self, n: usize) -> Option<Found> {
        let whole = self.whole()?;
        let (mut left, mut pieces, mut known) = (vec![whole.clone()], Vec::new(), Vec::new());
        while let Some(ranges) = left.pop() {
            match self.look(&ranges) {
                Some(piece) => {
                    pieces.push(ranges);
                    known.push(piece);
                }
                None if n <= MOST_COORDINATES && left.len() + pieces.len() < MOST_PIECES => {
                    left.extend(halve(&ranges)?)
                }
                None => return None,
            }
        }
        let both = |a: Piece, b: Piece| {
            let same = |(a, b): (Option<Course>, Option<Course>)| a.filter(|_| a == b);
            Some(Piece {
                courses: a.courses.into_iter().zip(b.courses).map(same).collect(),
                steady_limits: a.steady_limits.iter().zip(&b.steady_limits).map(|(a, b)| *a && *b).collect(),
                coordinates: Some(a.coordinates).filter(|n| *n == b.coordinates)?,
            })
        };
        let mut known = known.into_iter();
        let first = known.next()?;
        let Piece { courses, steady_limits, coordinates } = known.try_fold(first, both)?;
        // Along each edge from one corner to the other no frequency decreases.
        let pair = |(course, [low, high]): (Option<Course>, [Number; 2])| match course? {
            Course::Rises => Some((low, high)),
            Course::Falls => Some((high, low)),
        };
        let ends: Option<(Vec<Number>, Vec<Number>)> = courses.into_iter().zip(whole).map(pair).collect();
        Some(Found { ends: ends.map(|(low, high)| [low, high]), steady_limits, coordinates, pieces })
    }

    fn look(&self, ranges: &Ranges) -> Option<Piece> {
        let mut piece = Piece { courses: Vec::new(), steady_limits: Vec::new(), coordinates: 0 };
        for own in 0..ranges.len() {
            let (system, steady) = self.lower(ranges, own)?;
            outer(&system)?;
            piece.courses.push(Family::course(&system, false));
            piece.coordinates = system.n();
            piece.steady_limits = match own {
                0 => steady,
                _ => piece.steady_limits.iter().zip(&steady).map(|(a, b)| *a && *b).collect(),
            };
        }
        Some(piece)
    }

    /// The range of each parameter.
    fn whole(&self) -> Option<Ranges> {
        self.free.iter().map(|tolerance| tolerance.within.clone()).collect()
    }

    /// Other corners of a scene with n coordinates, as many as are looked at.
    fn others(&self, centre: &[Number], n: usize) -> Vec<Vec<Number>> {
        let ends: Vec<[Number; 2]> = self.free.iter().filter_map(|tolerance| tolerance.within.clone()).collect();
        let k = ends.len();
        let fits = |places: usize| n <= MOST_COORDINATES && places * n.pow(3) <= MOST_LOOKED_AT;
        if k <= MOST_CORNERS && fits(1 << k) {
            let corner = |bits: usize| (0..k).map(|i| ends[i][bits >> i & 1].clone()).collect();
            return (0..1 << k).map(corner).collect();
        }
        let alone = |i: usize, end: usize| {
            let mut place = centre.to_vec();
            place[i] = ends[i][end].clone();
            place
        };
        let few = (0..=k.min(MOST_ALONE)).rev().find(|few| fits(2 * few)).unwrap_or(0);
        (0..few).flat_map(|i| [alone(i, 0), alone(i, 1)]).collect()
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

    /// The system with every parameter anywhere in its range, and the derivatives by one of them; and which limits of requirements
    /// that one does not move. Every question about a sign on the way has one answer in the whole box.
    fn lower(&self, ranges: &[[Number; 2]], own: usize) -> Option<(LinearSystem, Vec<bool>)> {
        let range = |(i, [low, high]): (usize, &[Number; 2])| {
            let value = hull(low.enclosure(), high.enclosure());
            let slope = if i == own { Ball::ONE } else { Ball::ZERO };
            self.setting(i, Number::from(Jet { value, slope }))
        };
        let own_values: Vec<Setting> = ranges.iter().enumerate().map(range).collect();
        let values = [self.held, &own_values].concat();
        let prepared = jet::without_division(|| {
            let scene = self.text.scene(&values).ok()?.without_damping();
            let limits = self.subject.lines(scene.scene());
            let steady = limits.iter().map(|require| !matches!(require.question.value, Number::Jet(_))).collect();
            let lowered = dynamics::lower_written_out(&scene, &mut Diagnostics::new())?.lowered;
            let fits = lowered.rest.is_proven() && !lowered.system.is_chained();
            fits.then_some((lowered, steady))
        });
        let (lowered, steady) = prepared??;
        // Loss factors have no part in undamped modes.
        let system = LinearSystem { losses: None, ..lowered.system };
        self.keeps_rest(&lowered.rest, || self.rest_at(&middle_of(ranges))).then_some((system, steady))
    }

    /// Bounds of each frequency over a box, Hz; `None` for a mode that does not oscillate in the lower system.
    fn bounds(&self, ranges: &[[Number; 2]], count: usize) -> Option<Vec<Option<[Ball; 2]>>> {
        let (system, _) = self.lower(ranges, 0)?;
        let [low, high] = outer(&system)?.map(|system| modes_as(&system, &Request::default()).ok());
        let (low, high) = (low?, high?);
        let is_whole = |modes: &Modes| modes.is_complete() && modes.list.len() == count;
        if system.n() != count || !is_whole(&low) || !is_whole(&high) {
            return None;
        }
        Some((0..count).map(|i| Some([frequency(&low, i)?, frequency(&high, i)?])).collect())
    }

    /// Bounds over the whole box, from boxes into which it is cut where they are wide beside what is reached.
    fn enclose(&self, pieces: &[Ranges], reached: &[Option<[Ball; 2]>]) -> Option<(Vec<Option<[Ball; 2]>>, usize)> {
        let count = reached.len();
        if self.free.len() > MOST_CUT || count > MOST_COORDINATES {
            return None;
        }
        let mut boxes = pieces.to_vec();
        let mut bounds = boxes.iter().map(|own| self.bounds(own, count)).collect::<Option<Vec<_>>>()?;
        loop {
            let over_all = |i: usize| bounds.iter().map(|own| own[i]).reduce(|a, b| Some(union(a?, b?))).flatten();
            let all: Vec<Option<[Ball; 2]>> = (0..count).map(over_all).collect();
            // The side that is worst beside its width, and the box that is to blame.
            let excess = |i: usize| {
                let ([low, high], [least, largest]) = (all[i]?.map(|f| f.to_f64()), reached[i]?.map(|f| f.to_f64()));
                let allowed = EXCESS * (largest - least) + EXCESS_OF_VALUE * largest;
                let (below, above) = (least - low, high - largest);
                let side = usize::from(above > below);
                Some((below.max(above) / allowed, side, i))
            };
            let worst = (0..count).filter_map(excess).max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, side, i)) = worst.filter(|worst| worst.0 > 1.0 && boxes.len() < MOST_BOXES) else {
                return Some((all, boxes.len()));
            };
            let end = |own: &Vec<Option<[Ball; 2]>>| own[i].map_or(f64::NAN, |ends| ends[side].to_f64());
            let sign = if side == 0 { -1.0 } else { 1.0 };
            let Some(at) =
                (0..boxes.len()).max_by(|a, b| (sign * end(&bounds[*a])).total_cmp(&(sign * end(&bounds[*b]))))
            else {
                return Some((all, boxes.len()));
            };
            let Some(halves) = halve(&boxes[at]) else { return Some((all, boxes.len())) };
            let [first, second] = halves.each_ref().map(|half| self.bounds(half, count));
            let (Some(first), Some(second)) = (first, second) else { return Some((all, boxes.len())) };
            let [one, other] = halves;
            (boxes[at], bounds[at]) = (one, first);
            boxes.push(other);
            bounds.push(second);
        }
    }
}

/// How far a bound may lie beyond what is reached, as a share of the width that is reached, and of the value.
const EXCESS: f64 = 0.25;
const EXCESS_OF_VALUE: f64 = 5e-7;
/// Boxes of more parameters are not cut.
const MOST_CUT: usize = 30;
/// Into so many boxes at most is the whole one cut: to decide anything, and to narrow bounds.
const MOST_PIECES: usize = 16;
const MOST_BOXES: usize = 64;
/// Boxes for each end of any other range.
const MOST_PARTS: usize = 256;

fn frequency(modes: &Modes, i: usize) -> Option<Ball> {
    let mode = &modes.list[i];
    mode.frequency().filter(|_| mode.kind == ModeKind::Oscillation)
}

/// The least and the largest of both.
fn union([low, high]: [Ball; 2], [other_low, other_high]: [Ball; 2]) -> [Ball; 2] {
    let least = if (other_low - low).mid.hi < 0.0 { other_low } else { low };
    let largest = if (other_high - high).mid.hi > 0.0 { other_high } else { high };
    [least, largest]
}

fn middle_of(ranges: &[[Number; 2]]) -> Vec<Number> {
    ranges.iter().map(|[low, high]| &(low + high) * &Number::from(Rational::new(1, 2))).collect()
}

/// A box cut across the parameter that is widest beside its size.
fn halve(whole: &Ranges) -> Option<[Ranges; 2]> {
    let width = |[low, high]: &[Number; 2]| {
        let (low, high) = (low.to_f64(), high.to_f64());
        (high - low) / low.abs().max(high.abs())
    };
    let widest = (0..whole.len()).max_by(|a, b| width(&whole[*a]).total_cmp(&width(&whole[*b])))?;
    let [low, high] = &whole[widest];
    let middle = &(low + high) * &Number::from(Rational::new(1, 2));
    let with = |ends: [Number; 2]| {
        let mut half = whole.clone();
        half[widest] = ends;
        half
    };
    Some([with([low.clone(), middle.clone()]), with([middle, high.clone()])])
}

/// A ball that contains both.
pub(super) fn hull(low: Ball, high: Ball) -> Ball {
    let middle = (low + high) * Ball::from(0.5);
    let reach = (low - Ball::exact(middle.mid)).magnitude().max((high - Ball::exact(middle.mid)).magnitude());
    Ball::exact(middle.mid).widen(reach)
}

/// The frequencies at the places, of which the first is the declared one, and what encloses them. Those of the two corners enclose all
/// others only if M is positive definite at the upper corner (it is then so everywhere, for M is least there), which the number of
/// modes shows.
fn frequencies(corners: &Corners, places: &[Vec<Number>], found: Option<&Found>) -> Vec<Range> {
    let at = |place: &Vec<Number>| {
        corners.text.undamped_modes(&corners.settings(place), &Request::default()).ok().filter(Modes::is_complete)
    };
    let Some(all) = places.iter().map(at).collect::<Option<Vec<Modes>>>() else { return Vec::new() };
    let count = all[0].list.len();
    if all.iter().any(|modes| modes.list.len() != count) {
        return Vec::new();
    }
    let seen = |i: usize| {
        let each = all.iter().zip(places).map(|(modes, place)| Some((frequency(modes, i)?, place.clone())));
        Seen::of(each.collect::<Option<Vec<_>>>()?)
    };
    let seen: Vec<Option<Seen>> = (0..count).map(seen).collect();
    let reached: Vec<Option<[Ball; 2]>> =
        seen.iter().map(|seen| Some(seen.as_ref()?.ends.each_ref().map(|(value, _)| *value))).collect();
    let found = found.filter(|found| found.coordinates == count);
    let of = |i: usize, proved: Option<([Ball; 2], RangeProof)>| {
        let known = seen[i].as_ref().map_or(NOTHING, Seen::without_proof);
        match proved {
            Some((ends, proof)) => Range { ends: Some(ends), proof: Some(proof), ..known },
            None => known,
        }
    };
    match found {
        Some(Found { ends: Some(_), .. }) => {
            let ends = |i: usize| Some([frequency(&all[1], i)?, frequency(&all[2], i)?]);
            (0..count).map(|i| of(i, ends(i).map(|ends| (ends, RangeProof::Corners(Proved(())))))).collect()
        }
        _ => {
            let enclosed = found.and_then(|found| corners.enclose(&found.pieces, &reached));
            let (bounds, boxes) = enclosed.unwrap_or((vec![None; count], 0));
            let range = |i: usize| of(i, bounds[i].map(|ends| (ends, RangeProof::Boxes(boxes, Proved(())))));
            (0..count).map(|i| if seen[i].is_some() { range(i) } else { NOTHING }).collect()
        }
    }
}

/// No value somewhere.
const NOTHING: Range = Range { ends: None, reached: None, at: None, proof: None };

/// Whether bounds lie far beyond what was reached, or there are none although it was reached everywhere.
fn is_wide(range: &Range) -> bool {
    let (Some(ends), Some(reached)) = (range.ends, range.reached) else { return false };
    let ([low, high], [least, largest]) = (ends.map(|x| x.to_f64()), reached.map(|x| x.to_f64()));
    let allowed = EXCESS * (largest - least) + EXCESS_OF_VALUE * largest.abs();
    range.proof.is_none() || (least - low).max(high - largest) > allowed
}

/// What is asked of the whole box.
struct Asked<'a> {
    scene: &'a CheckedScene,
    boxes: &'a Boxes<'a>,
    places: &'a [Vec<Number>],
    /// The model at each place.
    points: &'a [Point],
    /// Whether the rest at each place is the one that is enclosed over the whole box.
    keeps_rest: bool,
}

impl<'a> Asked<'a> {
    fn new(scene: &'a CheckedScene, boxes: &'a Boxes<'a>, places: &'a [Vec<Number>], points: &'a [Point]) -> Asked<'a> {
        let keeps_rest = boxes.corners.keeps_rest_at(points);
        Asked { scene, boxes, places, points, keeps_rest }
    }

    /// Whether the box is cut where that narrows bounds.
    fn can_cut(&self) -> bool {
        self.keeps_rest && self.boxes.corners.free.len() <= MOST_CUT
    }

    /// What a quantity was at the places; `None` if it had no value at one of them.
    fn seen_values(&self, quantity: Sought) -> Option<Seen> {
        let values = self
            .points
            .iter()
            .zip(self.places)
            .map(|(point, place)| Some((self.boxes.at(point, quantity)?, place.clone())));
        Seen::of(values.collect::<Option<Vec<_>>>()?)
    }

    fn range(&self, quantity: Sought, limit: Option<Ball>) -> Option<Range> {
        let seen = self.seen_values(quantity)?;
        Some(if self.can_cut() { self.boxes.range(quantity, seen, limit) } else { seen.without_proof() })
    }

    /// Narrower bounds in place of wide ones, if there are some.
    fn narrow(&self, range: &mut Range, quantity: Sought) {
        let Some(found) = self.range(quantity, None).filter(|found| found.proof.is_some()) else { return };
        match (range.proof, range.ends, found.ends) {
            (Some(_), Some([low, high]), Some([least, largest])) => {
                let inner = [
                    if (least - low).mid.hi > 0.0 { least } else { low },
                    if (high - largest).mid.hi > 0.0 { largest } else { high },
                ];
                *range = Range { ends: Some(inner), proof: found.proof, ..found };
            }
            _ => *range = found,
        }
    }

    /// The damping ratios and the poles, if something damps.
    fn damped_ranges(&self) -> (Vec<Range>, Vec<[Range; 2]>) {
        let (motions, is_damped) = self.points[0].motions();
        let counts = self.points[0].counts();
        if !is_damped || counts.is_none() || self.points.iter().any(|point| point.counts().is_none()) {
            return (Vec::new(), Vec::new());
        }
        let range = |quantity: Sought| self.range(quantity, None).unwrap_or(NOTHING);
        let ratios = (1..=motions).map(|motion| range(Sought::Ratio(motion))).collect();
        let poles = (0..counts.map_or(0, |(_, poles)| poles))
            .map(|i| [range(Sought::PoleRe(i)), range(Sought::PoleIm(i))])
            .collect();
        (ratios, poles)
    }

    /// Whether the real part of every pole is proved to be negative.
    fn all_decay(&self) -> bool {
        let range = self.range(Sought::Abscissa, Some(Ball::ZERO)).filter(|range| range.proof.is_some());
        range.is_some_and(|range| range.ends.is_some_and(|[_, high]| high.is_negative()))
    }

    /// The range of each measure, and whether each requirement holds everywhere.
    fn requirements(&self, found: Option<&Found>, frequencies: &[Range]) -> (Vec<Option<Range>>, Vec<Throughout>) {
        let each = self.scene.scene().requires.iter().enumerate();
        each.map(|(i, require)| self.requirement(i, require, found, frequencies)).unzip()
    }

    /// The values of a requirement, and whether it holds for all; not known where the search may end in another rest than the one that
    /// the values are of.
    fn requirement(
        &self,
        index: usize,
        require: &Require,
        found: Option<&Found>,
        frequencies: &[Range],
    ) -> (Option<Range>, Throughout) {
        match self.about_rest(index, require, found, frequencies) {
            (range, Throughout::Holds(_)) if self.boxes.corners.follows_rest() => (range, Throughout::Undetermined),
            known => known,
        }
    }

    /// The same about the rest that the declared rest becomes.
    fn about_rest(
        &self,
        index: usize,
        require: &Require,
        found: Option<&Found>,
        frequencies: &[Range],
    ) -> (Option<Range>, Throughout) {
        let holds = |point: &Point| self.boxes.requirement(point, index).and_then(|requirement| requirement.holds);
        let failed = || self.points.iter().position(|point| holds(point) == Some(false));
        let fails = || failed().map(|place| Throughout::FailsAt(self.places[place].clone()));
        let Some(comparison) = require.comparison else {
            let is_stable = || self.can_cut() && (self.boxes.is_held() || self.all_decay());
            let verdict = fails().unwrap_or_else(|| {
                let all = self.points.iter().all(|point| holds(point) == Some(true));
                if all && is_stable() { Throughout::Holds(Proved(())) } else { Throughout::Undetermined }
            });
            return (None, verdict);
        };
        let is_lower_limit = matches!(comparison, Comparison::Greater | Comparison::GreaterEqual);
        let by_corners = found.is_some_and(|found| found.steady_limits.get(index) == Some(&true));
        // Undamped frequencies are known, and so is whether they keep limits that nothing moves.
        if let (Measure::Frequency { mode }, true) = (&require.question.measure, by_corners)
            && let Some(range) = (*mode as usize).checked_sub(1).and_then(|i| frequencies.get(i))
            && let (Some(RangeProof::Corners(_)), Some(at)) = (range.proof, &range.at)
        {
            let worst = usize::from(!is_lower_limit);
            // The first places are the declared one and the two corners.
            let verdict = match self.points.get(1 + worst).and_then(holds) {
                Some(true) => Throughout::Holds(Proved(())),
                Some(false) => Throughout::FailsAt(at[worst].clone()),
                None => fails().unwrap_or(Throughout::Undetermined),
            };
            return (Some(range.clone()), verdict);
        }
        let limit = require.question.value.to_ball();
        let is_steady = by_corners || self.boxes.keeps_limit(index);
        let range = self.range(Sought::Measure(index), is_steady.then_some(limit));
        let (margin, against) = match is_steady {
            true => (range.clone(), limit),
            false => (self.range(Sought::Margin(index), Some(Ball::ZERO)), Ball::ZERO),
        };
        let Some(margin) = margin else { return (range, fails().unwrap_or(Throughout::Undetermined)) };
        let worst = usize::from(!is_lower_limit);
        let beyond = |ends: [Ball; 2]| if is_lower_limit { ends[0] - against } else { against - ends[1] };
        if let (Some(at), Some(true)) = (&margin.at, margin.reached.map(|ends| beyond(ends).is_negative()))
            && holds(&self.boxes.point_at(&at[worst])) == Some(false)
        {
            return (range, Throughout::FailsAt(at[worst].clone()));
        }
        let keeps = margin.proof.is_some() && margin.ends.is_some_and(|ends| beyond(ends).is_positive());
        let verdict = fails().unwrap_or(if keeps { Throughout::Holds(Proved(())) } else { Throughout::Undetermined });
        (range, verdict)
    }
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
        let text = Text {
            sources: &sources,
            tree: &tree,
            overrides: &overrides,
            until: None,
            is_usual: false,
            case: &[],
            fixed: &[],
        };
        within_tolerances(&text, (&scene, 1), &[], false)
    }

    fn proved_range(found: &Tolerated, mode: usize) -> [Ball; 2] {
        let range = &found.frequencies[mode];
        assert!(range.proof.is_some());
        range.ends.expect("oscillations")
    }

    const BLOCK: &str = "param k = 100 N/m within 10 %\nparam m = 1 kg within 0.9 kg .. 1.2 kg\n\
                         body b { mass = m, moves x }\nspring s: ground -- b { k = k }\n";

    /// sqrt(90 / 1.2) and sqrt(110 / 0.9) rad/s
    #[test]
    fn a_block_has_its_extremes_at_corners() {
        let found = of(BLOCK).expect("tolerances");
        let [low, high] = proved_range(&found, 0);
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
            for (ball, square) in proved_range(&found, mode).into_iter().zip(ends) {
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

    /// A parameter that stiffens one spring and softens another has no direction, nor has one that turns round within its range: the
    /// bounds come from boxes. omega^2 of the one block is 10 + p - p^2 / 9 with its top of 12.25 at p = 4.5, between 12.222... at 4
    /// and 12 at 6; that of the two blocks 10 + 6 + p - + sqrt((p - 6)^2 + 100), p from 4 to 6, with the springs p, 10 and 12 - p.
    #[test]
    fn bounds_without_a_direction_come_from_boxes() {
        let blocks = |k: &str| {
            format!(
                "param p = 5 N/m within 4 N/m .. 6 N/m\nbody a {{ mass = 1 kg, moves x }}\nbody b {{ mass = 1 kg, moves x }}\n\
                 spring s: ground -- a {{ k = {k} }}\nspring t: a -- b {{ k = 10 N/m }}\nspring u: b -- ground {{ k = 12 N/m - p }}\n"
            )
        };
        let turning = "param p = 5 N/m within 4 N/m .. 6 N/m\nbody a { mass = 1 kg, moves x }\n\
                       spring s: ground -- a { k = 10 N/m + p - p^2 / (9 N/m) }\nrequire frequency(1) < 0.561 Hz\n\
                       require frequency(1) > 0.55 Hz\nrequire frequency(1) < 0.557 Hz\n";
        let hertz = |square: f64| f64::sqrt(square) / (2.0 * std::f64::consts::PI);
        let two = |p: f64, sign: f64| hertz(16.0 + sign * f64::hypot(p - 6.0, 10.0));
        let found = of(turning).expect("tolerances");
        assert!(found.corners.is_none());
        let one = [(&found.frequencies[0], [hertz(12.0), hertz(12.25)])];
        let coupled = of(&blocks("p")).expect("tolerances");
        let both = [
            (&coupled.frequencies[0], [two(4.0, -1.0), two(6.0, -1.0)]),
            (&coupled.frequencies[1], [two(6.0, 1.0), two(4.0, 1.0)]),
        ];
        for (range, truth) in one.into_iter().chain(both) {
            assert!(matches!(range.proof, Some(RangeProof::Boxes(..))));
            let [low, high] = range.ends.expect("oscillations").map(|f| f.to_f64());
            let width = truth[1] - truth[0];
            assert!(low <= truth[0] && truth[1] <= high, "{low} {high} {truth:?}");
            assert!(high - low <= 2.0 * width + 1e-6 * truth[1], "{low} {high} {truth:?}");
        }
        let verdicts = &found.requirements;
        assert!(
            matches!(verdicts[0], Throughout::Holds(_)) && matches!(verdicts[1], Throughout::Holds(_)),
            "{verdicts:?}"
        );
        // It fails in the middle alone.
        assert!(matches!(&verdicts[2], Throughout::FailsAt(at) if at[0].to_f64() == 4.5), "{verdicts:?}");
        // Both springs fall with it.
        assert!(of(&blocks("12 N/m - p")).expect("tolerances").corners.is_some());
        assert!(of("body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 1 N/m }\n").is_none());
    }

    /// k = 1/2 N/m + (p - 5 N/m)^2 / (1 N/m) falls up to p = 5 N/m, where it is 1/2, and rises from there on to 9 1/2 at 8; at both ends
    /// and at the declared 7 it is 4.5 or more. Over all of it the square may be negative as far as numbers know, so it is cut.
    #[test]
    fn a_valley_between_the_places_is_not_overlooked() {
        let hertz = |square: f64| f64::sqrt(square) / (2.0 * std::f64::consts::PI);
        let model = format!(
            "param p = 7 N/m within 3 N/m .. 8 N/m\nbody a {{ mass = 1 kg, moves x }}\n\
             spring s: ground -- a {{ k = 0.5 N/m + (p - 5 N/m) * (p - 5 N/m) / (1 N/m) }}\n\
             require frequency(1) > {} Hz\nrequire frequency(1) < {} Hz\n",
            hertz(2.0),
            hertz(9.4)
        );
        let found = of(&model).expect("tolerances");
        assert!(found.corners.is_none());
        let range = &found.frequencies[0];
        if range.proof.is_some() {
            let [low, high] = range.ends.expect("oscillations").map(|f| f.to_f64());
            assert!(low <= hertz(0.5) && high >= hertz(9.5), "{low} {high}");
        }
        let fails = |i: usize| matches!(found.requirements[i], Throughout::FailsAt(_));
        assert!(fails(0) && fails(1), "{:?}", found.requirements);
    }

    /// A parameter that moves the place of a spring on a body that moves and turns moves rows: omega^2 of both motions are those of
    /// M = diag(1, 1/10) and K = (20, 10 (l - 1); 10 (l - 1), 10 (l^2 + 1)). One that moves a rod with one degree of freedom changes the
    /// weight m l^2 + J alone: sqrt(10 / (0.1 + l^2)) rad/s.
    #[test]
    fn frequencies_where_rows_move_have_bounds() {
        let bar = of(
            "param l = 1 m within 5 %\nbody bar { mass = 1 kg, inertia = 0.1 kg*m^2, at = (0 m, 0 m), moves y, turns }\n\
             spring s: ground@(l, 1 m) -- bar@(l, 0 m) { k = 10 N/m, along = y }\n\
             spring t: ground@(-1 m, 1 m) -- bar@(-1 m, 0 m) { k = 10 N/m, along = y }\n",
        );
        let bar = bar.expect("tolerances");
        assert!(bar.corners.is_none());
        let square = |l: f64, sign: f64| {
            let (a, b, c) = (20.0, 100.0 * (l * l + 1.0), 10.0 * (l - 1.0) * f64::sqrt(10.0));
            0.5 * (a + b) + sign * f64::hypot(0.5 * (a - b), c)
        };
        for (mode, sign) in [(0, -1.0), (1, 1.0)] {
            let values =
                (0..=1000).map(|i| 0.95 + 1e-4 * f64::from(i)).map(|l| square(l, sign).sqrt() / std::f64::consts::TAU);
            encloses(&bar.frequencies[mode], &values.collect::<Vec<_>>());
        }
        let rod = of("param l = 1 m within 5 %\nbody rod { mass = 1 kg, inertia = 0.1 kg*m^2, at = (l, 0 m) }\n\
             pivot p: ground@(0 m, 0 m) -- rod@(0 m, 0 m)\nspring s: ground -- rod { k = 10 N*m/rad }\n");
        let [low, high] = proved_range(&rod.expect("tolerances"), 0).map(|f| f.to_f64() * 2.0 * std::f64::consts::PI);
        for (found, l) in [(low, 1.05), (high, 0.95)] {
            let truth = f64::sqrt(10.0 / (0.1 + l * l));
            assert!((found - truth).abs() < 1e-13 * truth, "{found} {truth}");
        }
    }

    /// All values lie in a proved range, which is at most 1.5 times as wide as they are.
    fn encloses(range: &Range, values: &[f64]) {
        assert!(range.proof.is_some(), "{range:?}");
        let [low, high] = range.ends.expect("values").map(|x| x.to_f64());
        let (least, largest) =
            (values.iter().copied().fold(f64::MAX, f64::min), values.iter().copied().fold(f64::MIN, f64::max));
        let rounding = 1e-12 * largest.abs().max(least.abs());
        assert!(low <= least + rounding && largest <= high + rounding, "{low} .. {high} {least} .. {largest}");
        assert!(high - low <= 1.5 * (largest - least) + 1e-6 * high.abs(), "{low} .. {high} {least} .. {largest}");
    }

    const DAMPED: &str = "param k = 100 N/m within 10 %\nparam m = 1 kg within 0.9 kg .. 1.2 kg\nparam c = 2 N*s/m within 20 %\n\
                          body b { mass = m, moves x }\nspring s: ground -- b { k = k }\ndamper d: ground -- b { c = c }\n\
                          force F: b along x = step(3 N, 0 s)\nforce G: b along x = harmonic(2 N, 1 Hz)\noutput x = b.x\n";

    /// The corners of k, m, c.
    fn corners() -> Vec<[f64; 3]> {
        let of = |i: usize| [[90.0, 110.0][i & 1], [0.9, 1.2][i >> 1 & 1], [1.6, 2.4][i >> 2]];
        (0..8).map(of).collect()
    }

    /// Damping ratio, pole, gain, amplitude, final value and largest gain of one block in closed form: all are monotone in k, m and c over
    /// these ranges (but the real part in k), so that the corners are their ends, reached and told to the last digits.
    #[test]
    fn measures_of_a_damped_block_have_their_extremes_at_corners() {
        let w = std::f64::consts::TAU;
        let gain = |[k, m, c]: [f64; 3]| 1.0 / f64::hypot(k - w * w * m, w * c);
        let zeta = |[k, m, c]: [f64; 3]| 0.5 * c / f64::sqrt(k * m);
        let largest = |p: [f64; 3]| 0.5 / (p[0] * zeta(p) * f64::sqrt(1.0 - zeta(p) * zeta(p)));
        type Truth<'a> = &'a dyn Fn([f64; 3]) -> f64;
        let rows: [(&str, Truth); 5] = [
            ("damping(1) < 20 %", &zeta),
            ("gain(F -> x, 1 Hz) < 1 m/N", &gain),
            ("amplitude(x) < 1 m", &|p| 2.0 * gain(p)),
            ("static(x) < 1 m", &|[k, ..]| 3.0 / k),
            ("peak_gain(F -> x) < 1 m/N", &largest),
        ];
        let lines: String = rows.iter().map(|(line, _)| format!("require {line}\n")).collect();
        let found = of(&format!("{DAMPED}{lines}")).expect("tolerances");
        let is_exact = |range: &Range, truth: &dyn Fn([f64; 3]) -> f64, what: &str| {
            let values: Vec<f64> = corners().into_iter().map(truth).collect();
            encloses(range, &values);
            assert!(matches!(range.proof, Some(RangeProof::Corners(_))), "{what} {range:?}");
            let (least, largest) =
                (values.iter().copied().fold(f64::MAX, f64::min), values.iter().copied().fold(f64::MIN, f64::max));
            for (end, truth) in range.ends.expect("values").into_iter().zip([least, largest]) {
                assert!((end.to_f64() - truth).abs() < 1e-12 * truth.abs(), "{what} {end:?} {truth}");
            }
            // The places of the extremes are where they are.
            for (place, end) in range.at.as_ref().expect("places").iter().zip(range.reached.expect("values")) {
                let at: [f64; 3] = std::array::from_fn(|i| place[i].to_f64());
                assert!((truth(at) - end.to_f64()).abs() < 1e-12 * end.to_f64().abs(), "{what} {place:?} {end:?}");
            }
        };
        for (place, (line, truth)) in rows.iter().enumerate() {
            let range = found.measures[place].as_ref().expect("values");
            match line.starts_with("peak") {
                true => encloses(range, &corners().into_iter().map(truth).collect::<Vec<_>>()),
                false => is_exact(range, truth, line),
            }
            assert!(matches!(found.requirements[place], Throughout::Holds(_)), "{line}");
        }
        is_exact(&found.ratios[0], &zeta, "ratio");
        is_exact(&found.poles[0][0], &|[_, m, c]| -0.5 * c / m, "re");
        is_exact(&found.poles[0][1], &|[k, m, c]| f64::sqrt(k / m - 0.25 * c * c / (m * m)), "im");
    }

    /// One block whose damping is a thirtieth of its tolerances, and more: the largest gain is 1 / (2 k zeta sqrt(1 - zeta^2)), and that of
    /// the velocity 1 / c, whatever k and m are.
    #[test]
    fn largest_gains_are_known_however_little_damps() {
        for c in [0.02, 2.0] {
            let found = of(&format!(
                "param k = 100 N/m within 2 %\nparam m = 1 kg within 3 %\nparam c = {c} N*s/m within 3 %\n\
                 body b {{ mass = m, moves x }}\nspring s: ground -- b {{ k = k }}\ndamper d: ground -- b {{ c = c }}\n\
                 force F: b along x\noutput x = b.x\noutput v = b.vx\nrequire peak_gain(F -> x) < 1e9 m/N\n\
                 require peak_gain(F -> v) < 1e9 s/kg\n"
            ));
            let found = found.expect("tolerances");
            let gain = |k: f64, m: f64, c: f64| {
                let zeta = 0.5 * c / f64::sqrt(k * m);
                0.5 / (k * zeta * f64::sqrt(1.0 - zeta * zeta))
            };
            let [displacement, velocity] = &found.measures[..] else { panic!("two measures") };
            let range = displacement.as_ref().expect("values");
            assert!(matches!(range.proof, Some(RangeProof::Corners(_))), "{c} {range:?}");
            for (end, truth) in
                range.ends.expect("values").iter().zip([gain(102.0, 0.97, 1.03 * c), gain(98.0, 1.03, 0.97 * c)])
            {
                assert!((end.to_f64() - truth).abs() < 1e-11 * truth, "{c} {end:?} {truth}");
            }
            encloses(velocity.as_ref().expect("values"), &[1.0 / (1.03 * c), 1.0 / (0.97 * c)]);
        }
    }

    /// A rod at an angle, held by a torsion spring under its weight: k q = -m g l cos q. Rest, the force of the spring there and the stiffness
    /// k - m g l sin q depend on each parameter; a block that hangs moves by m g / k, and its frequency with none of this.
    #[test]
    fn a_rest_that_moves_is_enclosed() {
        let rod = of("param k = 40 N*m/rad within 10 %\nparam m = 2 kg within 5 %\nparam l = 1.2 m within 3 %\ngravity 10 m/s^2\n\
             body rod { mass = m, inertia = 0.1 kg*m^2, at = (l, 0 m) }\npivot p: ground@(0 m, 0 m) -- rod@(0 m, 0 m)\n\
             spring s: ground -- rod { k = k }\ndamper d: ground -- rod { c = 0.5 N*m*s/rad }\n\
             require rest(rod.angle) > -1 rad\nrequire rest(rod.y) > -1.2 m\nrequire frequency(1) > 0.1 Hz\n")
        .expect("tolerances");
        assert!(rod.follows_rest);
        let at = |[k, m, l]: [f64; 3]| {
            let g = 10.0 * m * l;
            let (mut low, mut high) = (-1.5, 0.0);
            for _ in 0..100 {
                let q = 0.5 * (low + high);
                if k * q + g * q.cos() < 0.0 { low = q } else { high = q }
            }
            let omega = ((k - g * low.sin()) / (m * l * l + 0.1)).sqrt();
            [low, l * low.sin(), omega / std::f64::consts::TAU, -0.25 / (m * l * l + 0.1)]
        };
        let grid = |low: f64, high: f64, i: i32| low + (high - low) * f64::from(i) / 8.0;
        let places = (0..729).map(|i| [grid(36.0, 44.0, i / 81), grid(1.9, 2.1, i / 9 % 9), grid(1.164, 1.236, i % 9)]);
        let values: Vec<[f64; 4]> = places.map(at).collect();
        let of_one = |i: usize| values.iter().map(|own| own[i]).collect::<Vec<_>>();
        for (i, range) in rod.measures.iter().enumerate() {
            encloses(range.as_ref().expect("values"), &of_one(i));
        }
        encloses(&rod.frequencies[0], &of_one(2));
        encloses(&rod.poles[0][0], &of_one(3));
        // It hangs so far from its drawing that a search is not proved to end there for all values.
        assert!(
            rod.requirements.iter().all(|verdict| matches!(verdict, Throughout::Undetermined)),
            "{:?}",
            rod.requirements
        );

        let block = of(&format!(
            "gravity 10 m/s^2\n{}require rest(b.y) > -1 m\n",
            BLOCK.replace("moves x", "moves y").replace("ground -- b {", "ground@(0 m, 1 m) -- b { along = y,")
        ))
        .expect("tolerances");
        assert!(!block.follows_rest && block.corners.is_some());
        let moved = block.measures[0].as_ref().expect("values");
        assert!(matches!(moved.proof, Some(RangeProof::Corners(_))), "{moved:?}");
        for (end, truth) in moved.ends.expect("values").into_iter().zip([-12.0 / 90.0, -9.0 / 110.0]) {
            assert!((end.to_f64() - truth).abs() < 1e-14, "{end:?} {truth}");
        }
    }

    /// The double pendulum, drawn at 60 and 30 degrees: (2 -+ sqrt 2) g / l, largest and least at the ends of l, whatever the masses are.
    #[test]
    fn pendulums_have_their_extremes_at_the_ends_of_their_length() {
        let text = std::fs::read_to_string("examples/double_pendulum.vib").expect("an example");
        let text = text.replace("l = 1 m", "l = 1 m within 3 %").replace("m = 1 kg", "m = 1 kg within 3 %");
        let found = of(&text).expect("tolerances");
        for (range, sign) in found.frequencies.iter().zip([-1.0, 1.0]) {
            let at = |l: f64| f64::sqrt((2.0 + sign * f64::sqrt(2.0)) * 9.81 / l) / std::f64::consts::TAU;
            encloses(range, &[at(1.03), at(0.97)]);
        }
    }

    /// White noise of a force, and one that shakes a base: S / ((k - m w^2)^2 + (w c)^2), and the relative motion m^2 S / (the same) under the
    /// acceleration of the base, both together.
    #[test]
    fn densities_under_noise_are_enclosed() {
        let found = of("param k = 100 N/m within 10 %\nparam m = 1 kg within 5 %\nparam c = 2 N*s/m within 20 %\n\
             base g { moves x } = noise(white 0.5 m^2/s^4/Hz)\nbody b { mass = m, moves x }\n\
             spring s: g -- b { k = k }\ndamper d: g -- b { c = c }\nforce F: b along x = noise(white 3 N^2/Hz)\n\
             output e = b.x - g.x\nrequire psd(e, 1.3 Hz) < 1 m^2/Hz\n")
        .expect("tolerances");
        let w = std::f64::consts::TAU * 1.3;
        let grid = |low: f64, high: f64, i: usize| low + (high - low) * i as f64 / 8.0;
        let value = |i: usize| {
            let (k, m, c) = (grid(90.0, 110.0, i / 81), grid(0.95, 1.05, i / 9 % 9), grid(1.6, 2.4, i % 9));
            (3.0 + 0.5 * m * m) / ((k - w * w * m).powi(2) + (w * c).powi(2))
        };
        encloses(found.measures[0].as_ref().expect("values"), &(0..729).map(value).collect::<Vec<_>>());
        assert!(matches!(found.requirements[0], Throughout::Holds(_)));
    }

    /// A block between two slanted springs snaps through under 1 N, 2 k (L0 / L - 1) y at its most: from 0.12 kg on it rests below, with
    /// 0.09 kg above. Both rests depend continuously on the mass, and only one of them over all of the range.
    #[test]
    fn a_rest_that_another_value_does_not_find_proves_nothing() {
        let truss = |mass: &str| {
            of(&format!("{mass}\ngravity 9.81 m/s^2\nbody b {{ mass = m, at = (0 m, 0.3 m), moves y }}\n\
                 spring s: ground@(-1 m, 0 m) -- b {{ k = 100 N/m }}\nspring t: ground@(1 m, 0 m) -- b {{ k = 100 N/m }}\n\
                 require rest(b.y) < -0.3 m\n"))
            .expect("tolerances")
        };
        let within = |range: &str| truss(&format!("param m = 0.12 kg within {range}"));
        let (both, below) = (within("0.09 kg .. 0.15 kg"), within("0.11 kg .. 0.15 kg"));
        assert!(
            both.frequencies[0].proof.is_none() && both.measures[0].as_ref().is_some_and(|range| range.proof.is_none())
        );
        assert_eq!(both.not_proved, Some("for some of these values the model comes to rest elsewhere"));
        assert!(
            matches!(both.requirements[0], Throughout::FailsAt(_))
                && matches!(below.requirements[0], Throughout::Undetermined)
        );
        assert!(
            below.frequencies[0].proof.is_some()
                && below.measures[0].as_ref().is_some_and(|range| range.proof.is_some())
        );
        assert_eq!(below.not_proved, None);
        // 0.1 kg at p = 1/2, more than 0.105 kg at the declared value, the ends and the middle: a part alone has a middle that rests above.
        let inside = truss("param p = 0.9 within -1 .. 1\nlet m = 0.103 kg + 0.003 kg * cos(360 deg * p)");
        assert!(inside.follows_rest);
        assert!(inside.measures[0].as_ref().is_some_and(|range| range.proof.is_none()), "{:?}", inside.measures);
        assert_eq!(inside.not_proved, both.not_proved);
        assert!(matches!(inside.requirements[0], Throughout::FailsAt(_)), "{:?}", inside.requirements);
    }

    /// k = 1/2 N/m + (p - 5 N/m)^2 / (1 N/m) is least within the range, and so the final value largest: at no corner.
    #[test]
    fn an_extreme_inside_is_enclosed() {
        let found = of("param p = 6 N/m within 4 N/m .. 7 N/m\nbody a { mass = 1 kg, moves x }\n\
             spring s: ground -- a { k = 0.5 N/m + (p - 5 N/m)^2 / (1 N/m) }\ndamper d: ground -- a { c = 1 N*s/m }\n\
             force F: a along x = step(1 N, 0 s)\noutput x = a.x\nrequire static(x) < 2.5 m\nrequire static(x) < 1.9 m\n\
             require static(x) > 0.2 m\n");
        let found = found.expect("tolerances");
        let values = (0..=3000).map(|i| 4.0 + 1e-3 * f64::from(i)).map(|p| 1.0 / (0.5 + (p - 5.0) * (p - 5.0)));
        encloses(found.measures[0].as_ref().expect("values"), &values.collect::<Vec<_>>());
        assert!(matches!(found.requirements[0], Throughout::Holds(_)));
        assert!(matches!(&found.requirements[1], Throughout::FailsAt(at) if (at[0].to_f64() - 5.0).abs() < 0.2));
        assert!(matches!(&found.requirements[2], Throughout::Holds(_)));
    }

    /// Two blocks side by side whose frequencies cross: the first damped motion is one or the other, with 5 % or 10 %.
    #[test]
    fn motions_that_change_places_are_both_in_the_range() {
        let found =
            of("param p = 100 N/m within 20 %\nbody a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\n\
             spring s: ground -- a { k = p }\nspring t: ground -- b { k = 100 N/m }\n\
             damper d: ground -- a { c = 1 N*s/m }\ndamper e: ground -- b { c = 2 N*s/m }\nrequire damping(1) < 9 %\n");
        // The order of both is not certain at p = 100 N/m itself, so that damping(1) has no value there.
        let found = found.expect("tolerances");
        assert!(found.measures[0].is_none());
        let apart =
            of("param p = 99 N/m within 20 %\nbody a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\n\
             spring s: ground -- a { k = p }\nspring t: ground -- b { k = 100 N/m }\n\
             damper d: ground -- a { c = 1 N*s/m }\ndamper e: ground -- b { c = 2 N*s/m }\nrequire damping(1) < 9 %\n");
        let apart = apart.expect("tolerances");
        let range = apart.measures[0].as_ref().expect("values");
        if range.proof.is_some() {
            let [low, high] = range.ends.expect("values").map(|x| x.to_f64());
            assert!(low <= 0.5 / f64::sqrt(100.0) && high >= 0.1, "{low} {high}");
        }
        assert!(!matches!(apart.requirements[0], Throughout::Holds(_)));
    }

    /// c = ((p - 5)^2 - 1/100) 0.1 N*s/m feeds energy in from p = 4.9 to 5.1 alone, which is no corner and not the middle; a heavily damped
    /// block beside it does not make up for it. With 1/2 in its place nothing grows, though one damper feeds energy in.
    #[test]
    fn what_grows_for_some_values_is_not_stable_beside_what_falls() {
        let verdict = |more: &str| {
            of(&format!(
                "param p = 3.6 within 3 .. 8\nbody a {{ mass = 1 kg, moves x }}\nspring s: ground -- a {{ k = 4 N/m }}\n\
                 damper d: ground -- a {{ c = ((p - 5)^2 - {more}) * 0.1 N*s/m + 0.1 N*s/m }}\n\
                 damper f: ground -- a {{ c = -0.1 N*s/m }}\nbody b {{ mass = 1 kg, moves x }}\n\
                 spring t: ground -- b {{ k = 9 N/m }}\ndamper e: ground -- b {{ c = 3 N*s/m }}\nrequire stable\n"
            ))
            .expect("tolerances")
            .requirements[0]
                .clone()
        };
        assert!(!matches!(verdict("0.01"), Throughout::Holds(_)), "{:?}", verdict("0.01"));
        assert!(matches!(verdict("(-0.5)"), Throughout::Holds(_)), "{:?}", verdict("(-0.5)"));
    }

    /// The effective mass of a block on a base is the block's.
    #[test]
    fn effective_masses_have_ranges() {
        let found = of(&format!(
            "base q {{ moves x }}\n{}require effective_mass(q, 1) < 1.3 kg\n",
            BLOCK.replace("ground -- b", "q -- b")
        ));
        encloses(found.expect("tolerances").measures[0].as_ref().expect("values"), &[0.9, 1.2]);
    }

    /// k/2 times the damping ratio and less the frequency; a limit that moves with k; a damper that may feed energy in.
    #[test]
    fn expressions_limits_that_move_and_verdicts_are_decided() {
        let verdict =
            |line: &str| of(&format!("{DAMPED}require {line}\n")).expect("tolerances").requirements[0].clone();
        // zeta f = c / (4 pi m): 0.1061 .. 0.2122 Hz.
        assert!(matches!(verdict("damping(1) * frequency(1) < 0.22 Hz"), Throughout::Holds(_)));
        assert!(matches!(verdict("damping(1) * frequency(1) > 0.11 Hz"), Throughout::FailsAt(_)));
        assert!(matches!(verdict("static(x) < 3.1 N / k"), Throughout::Holds(_)));
        assert!(
            matches!(verdict("static(x) < 300 N^2/m / k / (95 N/m) * (k / (100 N/m))"), Throughout::FailsAt(at) if at[0].to_f64() == 90.0)
        );
        assert!(matches!(verdict("stable"), Throughout::Holds(_)));
        let fed = |low: &str| {
            of(&format!(
                "param c = 1 N*s/m within {low} N*s/m .. 2 N*s/m\nbody b {{ mass = 1 kg, moves x }}\n\
                 spring s: ground -- b {{ k = 4 N/m }}\ndamper d: ground -- b {{ c = c }}\n\
                 damper e: ground -- b {{ c = -0.5 N*s/m }}\nrequire stable\n"
            ))
            .expect("tolerances")
            .requirements[0]
                .clone()
        };
        assert!(matches!(fed("0.6"), Throughout::Holds(_)), "{:?}", fed("0.6"));
        assert!(matches!(fed("0.4"), Throughout::FailsAt(_)));
    }
}
