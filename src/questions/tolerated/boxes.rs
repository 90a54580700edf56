//! Quantities of a model over boxes of its parameters. In: a box, as parts of the ranges. Out: an enclosure of a frequency, a pole, a
//! damping ratio or a measure for all values in the box, with its derivatives by the parameters; and what they are at single places.
//! See docs/method/studies.md#tolerances.
//!
//! An eigenvalue or a pole is followed from the middle of the box: it stays in an enclosure in which it is simple
//! ([`Centre::over_box`]). Each has its own, so what is the i-th in order is one of those whose sizes do not exclude it.

use super::Corners;
use crate::analysis::measures;
use crate::analysis::range::largest::{self, Largest, Way};
use crate::analysis::range::together::Together;
use crate::analysis::range::{Family, MOST};
use crate::analysis::{Measurement, ModeKind, Modes, Pole, Poles, is_passive};
use crate::base::number::jet;
use crate::base::{Ball, Dd, Diagnostics, Jet, Number, Rational};
use crate::dynamics::{self, WrittenOut};
use crate::kernel::complex::Complex;
use crate::lower::rest::Rest;
use crate::model::scene::{Arithmetic, Combined, Question, Scene};
use crate::model::{CheckedScene, Setting};
use crate::questions::answer::{Requirement, Value};
use crate::questions::probe::Probe;
use crate::questions::range_enclosure::{
    Centre, Drive, Moved, QuestionOverRange, frequency_slope, spectral_density, two_pi,
};
use crate::questions::require::judged_alone;
use crate::questions::tolerated::tubes::{Tube, Tubes, candidates, sizes};
use crate::questions::trial::{Facts, Ranged, spectrum};
use crate::system::{LinearSystem, Signal};
use std::cell::{Cell, OnceCell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;

/// What is enclosed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sought {
    /// Of the undamped mode with this index, Hz.
    Frequency(usize),
    /// The damping ratio of a damped motion, counted from 1.
    Ratio(usize),
    /// Of the pole with this index among those with im s >= 0, ascending in |s|: its real part, 1/s.
    PoleRe(usize),
    /// Its imaginary part, rad/s.
    PoleIm(usize),
    /// The largest real part of all poles, 1/s.
    Abscissa,
    /// The measure of a requirement, SI.
    Measure(usize),
    /// The measure less its limit.
    Margin(usize),
}

/// A part of the whole box: for each parameter the ends of its part, as multiples of 1 / [`WHOLE`] of its range.
pub(super) type Part = Vec<[u32; 2]>;

pub(super) const WHOLE: u32 = 1 << 30;

/// Work in units of some nanoseconds: a lowering, and the limit of all together, some seconds. One quantity takes at most a share of
/// what is left, so that others have their turn.
const LOWERING: u64 = 6_000;
const MOST_WORK: u64 = 2_000_000_000;
const SHARE: u64 = 4;

/// Arcs of a circle that may be cut to show that no pole is on it.
const MOST_ARCS: usize = 48;

/// A number over a box.
#[derive(Clone, Debug)]
pub(super) struct Enclosed {
    pub value: Ball,
    /// By each parameter that is not a single number in the box, in their order.
    pub slopes: Vec<Ball>,
}

/// The model over a box.
struct Sheet {
    /// With the derivatives by one parameter each.
    over: Vec<Ranged>,
    /// Half the width of each range, SI.
    radius: Vec<f64>,
    /// What narrows the numbers of the systems, if their coordinates are the same in the middle.
    together: Option<Together>,
    /// Every eigenvalue, ascending in the middle of the box.
    squares: OnceCell<Option<Tubes>>,
    /// Every pole with im s >= 0.
    poles: OnceCell<Option<Tubes>>,
    /// Largest gains, each over all frequencies or in a band, Hz.
    largest: RefCell<Vec<LargestOf>>,
}

/// A way, its band, and what was found.
type LargestOf = (Way, Option<[Number; 2]>, Option<Largest>);

/// The model at one place.
pub(super) struct Point {
    scene: Option<CheckedScene>,
    written: Option<WrittenOut>,
    spectrum: Option<(Modes, Poles)>,
    /// What is required, each looked at when it is asked for.
    requirements: RefCell<BTreeMap<usize, Option<Requirement>>>,
}

pub(super) struct Boxes<'a> {
    pub corners: &'a Corners<'a>,
    sheets: RefCell<BTreeMap<Part, Option<Rc<Sheet>>>>,
    points: RefCell<BTreeMap<Vec<u32>, Rc<Point>>>,
    done: Cell<u64>,
    /// Where the quantity at hand has to stop.
    until: Cell<u64>,
    /// Whether the rest in the middle of some part is not the one over the whole box.
    strays: Cell<bool>,
}

impl<'a> Boxes<'a> {
    pub fn new(corners: &'a Corners<'a>) -> Boxes<'a> {
        let (sheets, points) = (RefCell::default(), RefCell::default());
        Boxes { corners, sheets, points, done: Cell::new(0), until: Cell::new(0), strays: Cell::new(false) }
    }

    /// Begins with another quantity.
    pub fn begin(&self) {
        self.begin_with_share(SHARE);
    }

    /// Begins with a quantity that may take this part of the work that is left.
    pub fn begin_with_share(&self, share: u64) {
        let done = self.done.get();
        self.until.set(done + MOST_WORK.saturating_sub(done) / share);
    }

    /// Whether there is work left that may be done.
    pub fn may_go_on(&self) -> bool {
        self.done.get() < self.until.get()
    }

    fn work(&self, amount: u64) {
        self.done.set(self.done.get().saturating_add(amount));
    }

    /// The value of a parameter at a part of its range.
    fn value(&self, parameter: usize, at: u32) -> Number {
        let Some([low, high]) = &self.corners.free[parameter].within else { return Number::ZERO };
        match at {
            0 => low.clone(),
            WHOLE => high.clone(),
            _ => low + &(&(high - low) * &Number::from(Rational::new(i64::from(at), i64::from(WHOLE)))),
        }
    }

    pub fn place(&self, at: &[u32]) -> Vec<Number> {
        at.iter().enumerate().map(|(i, at)| self.value(i, *at)).collect()
    }

    pub fn middle(part: &Part) -> Vec<u32> {
        part.iter().map(|[low, high]| low + (high - low) / 2).collect()
    }

    /// The model at a place.
    pub fn point(&self, at: &[u32]) -> Rc<Point> {
        if let Some(known) = self.points.borrow().get(at) {
            return known.clone();
        }
        let point = Rc::new(self.point_at(&self.place(at)));
        self.points.borrow_mut().insert(at.to_vec(), point.clone());
        point
    }

    /// The model at a place that is given by its values.
    pub fn point_at(&self, place: &[Number]) -> Point {
        let scene = self.corners.text.scene(&self.corners.settings(place)).ok();
        let written = scene.as_ref().and_then(|scene| dynamics::lower_written_out(scene, &mut Diagnostics::new()));
        let n = written.as_ref().map_or(0, |written| written.lowered.system.n());
        let spectrum = written.as_ref().filter(|_| n <= MOST).and_then(spectrum);
        self.work(LOWERING + 100 * cube(n.min(MOST)));
        Point { scene, written, spectrum, requirements: RefCell::default() }
    }

    /// A requirement at a point.
    pub fn requirement(&self, point: &Point, index: usize) -> Option<Requirement> {
        if let Some(known) = point.requirements.borrow().get(&index) {
            return known.clone();
        }
        let both = point.spectrum.as_ref().map(|(modes, poles)| (modes, poles));
        let both = both.filter(|(modes, poles)| modes.is_complete() && poles.left_out == 0);
        let known = Facts { system: point.written.as_ref(), spectrum: both };
        let judge = |scene: &CheckedScene| {
            let line = self.corners.subject.lines(scene.scene()).into_iter().nth(index)?;
            judged_alone(self.corners.text, scene, known, &line)
        };
        let found = point.scene.as_ref().and_then(judge);
        let n = point.written.as_ref().map_or(0, |written| written.lowered.system.n());
        self.work(LOWERING + 500 * cube(n.min(MOST)));
        point.requirements.borrow_mut().insert(index, found.clone());
        found
    }

    /// The value of a quantity at a point.
    pub fn at(&self, point: &Point, quantity: Sought) -> Option<Ball> {
        let poles = || Some(&point.spectrum.as_ref()?.1);
        let upper = |i: usize| poles()?.list.iter().filter(|pole| !pole.is_lower_half()).nth(i);
        let found = match quantity {
            Sought::Frequency(i) => {
                let mode = point.spectrum.as_ref()?.0.list.get(i)?;
                mode.frequency().filter(|_| mode.kind == ModeKind::Oscillation)?
            }
            Sought::Ratio(motion) => match measures::damping_ratio(poles()?, motion) {
                Measurement::Value(value) => value,
                _ => return None,
            },
            Sought::PoleRe(i) => upper(i)?.re,
            Sought::PoleIm(i) => upper(i)?.im,
            Sought::Abscissa => {
                let parts = poles().filter(|poles| poles.is_complete())?.list.iter().map(|pole| pole.re);
                parts.reduce(|a, b| if (b - a).mid.hi > 0.0 { b } else { a })?
            }
            Sought::Measure(i) => match self.requirement(point, i)?.value {
                Value::Number(ball) => ball,
                _ => return None,
            },
            Sought::Margin(i) => {
                self.at(point, Sought::Measure(i))? - self.requirement(point, i)?.limit.as_ref()?.to_ball()
            }
        };
        found.is_finite().then_some(found)
    }

    fn sheet(&self, part: &Part) -> Option<Rc<Sheet>> {
        if let Some(known) = self.sheets.borrow().get(part) {
            return known.clone();
        }
        let sheet = self.lower(part).map(Rc::new);
        self.sheets.borrow_mut().insert(part.clone(), sheet.clone());
        sheet
    }

    fn lower(&self, part: &Part) -> Option<Sheet> {
        let free: Vec<usize> = (0..part.len()).filter(|&i| part[i][0] < part[i][1]).collect();
        let ends: Vec<[Number; 2]> = (0..part.len()).map(|i| part[i].map(|at| self.value(i, at))).collect();
        let middle = Boxes::middle(part);
        // With the derivatives by one parameter; or in the middle, on the same way.
        let lower = |own: Option<usize>| {
            let setting = |(i, [low, high]): (usize, &[Number; 2])| {
                let slope = if Some(i) == own { Ball::ONE } else { Ball::ZERO };
                let si = match own {
                    _ if part[i][0] == part[i][1] => low.clone(),
                    Some(_) => {
                        let value = super::hull(low.enclosure(), high.enclosure());
                        Number::from(Jet { value, slope })
                    }
                    None => {
                        let value = self.value(i, middle[i]).enclosure();
                        Number::from(Jet { value, slope })
                    }
                };
                self.corners.setting(i, si)
            };
            let settings: Vec<Setting> =
                self.corners.held.iter().cloned().chain(ends.iter().enumerate().map(setting)).collect();
            self.work(LOWERING);
            let lines = |scene: &Scene| self.corners.subject.lines(scene);
            let ask = |scene: &Scene| lines(scene).into_iter().map(|require| require.question).collect();
            self.corners.text.with_ranges(&settings, ask)
        };
        let over = free.iter().map(|&own| lower(Some(own))).collect::<Option<Vec<Ranged>>>()?;
        let n = over.first()?.lowered.system.n();
        if n == 0 || n > MOST || over.iter().any(|ranged| ranged.lowered.system.n() != n) {
            return None;
        }
        let half = |&i: &usize| (&ends[i][1] - &ends[i][0]).to_ball().magnitude() * 0.5 * (1.0 + f64::EPSILON);
        let radius: Vec<f64> = free.iter().map(half).collect();
        let middle_rest = || self.point(&middle).rest().cloned();
        let keeps_rest = self.corners.keeps_rest(&over.first()?.lowered.rest, middle_rest);
        if !keeps_rest {
            self.strays.set(true);
            return None;
        }
        let systems: Vec<&LinearSystem> = over.iter().map(|ranged| &ranged.lowered.system).collect();
        let together = lower(None).and_then(|centre| Together::of(&systems, &centre.lowered.system, &radius));
        let (squares, poles, largest) = (OnceCell::new(), OnceCell::new(), RefCell::default());
        Some(Sheet { over, radius, together, squares, poles, largest })
    }

    /// Whether no term supplies energy and every displacement takes some, whatever the values: nothing grows or stays away.
    pub fn is_held(&self) -> bool {
        let whole: Part = vec![[0, WHOLE]; self.corners.free.len()];
        let Some(sheet) = self.sheet(&whole) else { return false };
        self.is_passive() && sheet.family(0).is_some_and(|family| family.is_held())
    }

    /// Whether no term supplies energy, whatever the values: nothing grows.
    pub fn is_passive(&self) -> bool {
        let whole: Part = vec![[0, WHOLE]; self.corners.free.len()];
        let Some(sheet) = self.sheet(&whole) else { return false };
        let ranged = &sheet.over[0];
        ranged.is_damped && is_passive(&ranged.lowered.system)
    }

    /// Whether no parameter certainly moves the limit of a requirement.
    pub fn keeps_limit(&self, requirement: usize) -> bool {
        let whole: Part = vec![[0, WHOLE]; self.corners.free.len()];
        let is_fixed = |ranged: &Ranged| {
            let question = ranged.questions.get(requirement);
            question.is_some_and(|question| !matches!(question.value, Number::Jet(_)))
        };
        self.sheet(&whole).is_some_and(|sheet| sheet.over.iter().all(is_fixed))
    }

    /// Whether another rest than the one over the whole box was found in the middle of some part, so that its bounds are not about all values.
    pub fn strays(&self) -> bool {
        self.strays.get()
    }

    /// How much each parameter of a part changes the system, about relative to it; nothing if that is not known.
    pub fn changes(&self, part: &Part) -> Vec<f64> {
        let sheet = self.sheet(part);
        let of = |sheet: &Rc<Sheet>| Some(sheet.together.as_ref()?.changes());
        sheet.as_ref().and_then(of).unwrap_or_default()
    }

    /// A quantity over a part of the box that is no single place; `None` if it may be infinite, or nothing is known.
    pub fn enclose_over(&self, part: &Part, quantity: Sought) -> Option<Enclosed> {
        let sheet = self.sheet(part)?;
        let mut value: Option<Ball> = None;
        let mut slopes = Vec::with_capacity(sheet.over.len());
        for own in 0..sheet.over.len() {
            let jet = self.jet(part, &sheet, own, quantity).filter(|jet| jet.value.is_finite())?;
            value = Some(value.map_or(jet.value, |known| if jet.value.rad < known.rad { jet.value } else { known }));
            slopes.push(jet.slope);
        }
        Some(Enclosed { value: value?, slopes })
    }

    /// A quantity with its derivative by one of the parameters.
    fn jet(&self, part: &Part, sheet: &Sheet, own: usize, quantity: Sought) -> Option<Jet> {
        match quantity {
            Sought::Frequency(i) => self.frequency(part, sheet, own, i),
            Sought::Ratio(motion) => {
                let tubes = self.poles(part, sheet)?.lowest();
                let counts: Vec<usize> = tubes.iter().map(|tube| if tube.is_real { 1 } else { 2 }).collect();
                candidates(&sizes(&tubes), &counts, |count, of| (2 * motion..2 * motion + of).contains(&count))
                    .map(|i| tubes[i].ratio(own))
                    .reduce(either_value)?
            }
            Sought::PoleRe(i) | Sought::PoleIm(i) => {
                let tubes = self.poles(part, sheet)?.lowest();
                let pick = |tube: &Tube| tube.part(own, quantity == Sought::PoleIm(i));
                candidates(&sizes(&tubes), &vec![1; tubes.len()], |count, _| count == i + 1)
                    .map(|i| pick(tubes[i]))
                    .reduce(either_value)?
            }
            Sought::Abscissa => {
                let tubes = self.poles(part, sheet)?.all()?;
                let parts = tubes.iter().map(|tube| tube.part(own, false)).collect::<Option<Vec<Jet>>>()?;
                let ends = parts.iter().map(|jet| jet.value);
                let low = ends.clone().map(|ball| ball.mid.hi - ball.rad).fold(f64::NEG_INFINITY, f64::max);
                let reach = |ball: Ball| ball.mid.hi + ball.rad >= low;
                parts.into_iter().filter(|jet| reach(jet.value)).map(Some).reduce(either_value)?
            }
            Sought::Measure(i) => {
                let probe = sheet.over[own].probes.get(i)?;
                self.measure(part, sheet, own, probe, sheet.over[own].questions.get(i)?)
            }
            Sought::Margin(i) => {
                let measured = self.jet(part, sheet, own, Sought::Measure(i))?;
                let limit = Jet::of(&sheet.over[own].questions.get(i)?.value);
                Some(Jet { value: measured.value - limit.value, slope: measured.slope - limit.slope })
            }
        }
    }

    fn measure(&self, part: &Part, sheet: &Sheet, own: usize, probe: &Probe, question: &Question) -> Option<Jet> {
        let ranged = &sheet.over[own];
        let (system, scene) = (&ranged.lowered.system, ranged.scene.scene());
        let settles = || {
            let falls = |tube: &&Tube| tube.part(own, false).is_some_and(|re| re.value.is_negative());
            is_passive(system) || self.poles(part, sheet).and_then(Tubes::all).is_some_and(|all| all.iter().all(falls))
        };
        let has_harmonics = || {
            let mut signals = ranged.context.drives.iter().flatten();
            signals.any(|signal| matches!(signal, Signal::Harmonic { .. }))
        };
        match probe {
            Probe::Frequency(mode) => self.frequency(part, sheet, own, mode.checked_sub(1)?),
            Probe::Damping(motion) => self.jet(part, sheet, own, Sought::Ratio(*motion)),
            Probe::Amplitude(_) if !has_harmonics() || !settles() => None,
            Probe::Static(_)
                if ranged.context.drives.iter().any(|signals| measures::lasting_value(signals).is_none())
                    || ranged.loads.iter().all(|(_, load)| load.is_zero())
                    || !settles() =>
            {
                None
            }
            Probe::PeakGain(..) => self.largest(part, sheet, own, (probe, 0)),
            Probe::ByRate(rate, inner) if matches!(**inner, Probe::PeakGain(..)) => {
                self.largest(part, sheet, own, (inner, *rate))
            }
            Probe::Gain(..) | Probe::Phase(..) | Probe::Amplitude(_) | Probe::Static(_) | Probe::ByRate(..) => {
                if !ranged.is_damped {
                    return None;
                }
                let family = sheet.family(own)?;
                let drive = &Drive { signals: &ranged.context.drives, loads: &ranged.loads };
                self.work(solving(2 * system.n() + 2));
                QuestionOverRange { family: Some(&family), course: None, drive, probe, question }.measure()
            }
            Probe::Psd(output, at) => {
                let family = sheet.family(own).filter(|_| ranged.is_damped && settles())?;
                let inputs: usize = ranged.context.noises.iter().map(|noise| noise.inputs.len()).sum();
                self.work(inputs as u64 * solving(2 * system.n() + 2));
                let found = spectral_density(&family, &ranged.context.noises, *output, at)?;
                Some(family.jet_of(&found)).filter(|jet| jet.value.is_finite())
            }
            Probe::Rest(terms, span) => {
                let at_rest = || ranged.lowered.mechanism.at_rest(scene, &ranged.lowered.rest, terms, *span).ok();
                Some(Jet::of(&jet::without_division(at_rest)??))
            }
            Probe::EffectiveMass(input, mode) => {
                let square = self.square(part, sheet, own, mode.checked_sub(1)?)?;
                self.work(2 * solving(system.n() + 1));
                sheet.family(own)?.effective_mass(*input, &square)
            }
            Probe::Combined(combined) => {
                let parts = combined.map(&mut |probe| self.measure(part, sheet, own, probe, question));
                Some(Jet::of(&value_of(&parts)?))
            }
            _ => None,
        }
    }

    /// The largest gain over frequencies.
    fn largest(&self, part: &Part, sheet: &Sheet, own: usize, (probe, rate): (&Probe, u8)) -> Option<Jet> {
        let Probe::PeakGain(input, output, range) = probe else { return None };
        let way = Way { input: *input, output: *output, rate };
        let band = match range {
            // All derivatives come from one search, which a band that a parameter moves has not.
            Some(ends) if ends.iter().any(|end| matches!(end, Number::Jet(_))) => return None,
            Some([low, high]) => {
                let radians = |hertz: &Number| (hertz * &two_pi()).to_ball();
                (radians(low), Some(radians(high)))
            }
            None => (Ball::ZERO, None),
        };
        let search = || {
            let families = self.families(sheet).filter(|_| sheet.over.iter().all(|ranged| ranged.is_damped))?;
            let point = self.point(&Boxes::middle(part));
            let (_, poles) = point.spectrum.as_ref()?;
            let sizes = poles.list.iter().map(|pole| pole.modulus().to_f64()).filter(|size| *size > 0.0);
            let ends = sizes.fold([f64::INFINITY, 0.0f64], |[low, high], size| [low.min(size), high.max(size)]);
            let (undamped, _) = point.spectrum.as_ref()?;
            let squares =
                |tube: &Tube| (0..families.len()).map(|own| tube.part(own, false)).collect::<Option<Vec<Jet>>>();
            let all = |tubes: &Tubes| {
                let tubes = tubes.list.iter().zip(&undamped.list);
                tubes.filter_map(|(tube, mode)| Some((mode.omega_squared, squares(tube.as_ref()?)?))).collect()
            };
            let modes: Vec<(Ball, Vec<Jet>)> = self.squares(part, sheet).map(all).unwrap_or_default();
            let found = largest::largest((&families, sheet.together.as_ref()), way, band, (ends, &modes));
            let evaluations = found.as_ref().map_or(2 * largest::MOST_CELLS, |found| found.evaluations);
            self.work(2 * evaluations as u64 * solving(2 * families[0].coordinates() + 1));
            found
        };
        let mut known = sheet.largest.borrow_mut();
        let place = known.iter().position(|(other, ends, _)| *other == way && ends == range).unwrap_or_else(|| {
            known.push((way, range.clone(), search()));
            known.len() - 1
        });
        let found = known[place].2.as_ref()?;
        Some(Jet { value: found.value, slope: *found.slopes.get(own)? })
    }

    /// omega^2 of the mode with this index.
    fn square(&self, part: &Part, sheet: &Sheet, own: usize, index: usize) -> Option<Jet> {
        let tubes = self.squares(part, sheet)?.lowest();
        candidates(&sizes(&tubes), &vec![1; tubes.len()], |count, _| count == index + 1)
            .map(|i| tubes[i].part(own, false))
            .reduce(either_value)?
    }

    fn frequency(&self, part: &Part, sheet: &Sheet, own: usize, index: usize) -> Option<Jet> {
        let square = self.square(part, sheet, own, index).filter(|square| square.value.is_positive())?;
        let value = square.value.sqrt() / two_pi().to_ball();
        Some(Jet { value, slope: frequency_slope(square.value, square.slope) })
    }

    fn squares<'s>(&self, part: &Part, sheet: &'s Sheet) -> Option<&'s Tubes> {
        let found = sheet.squares.get_or_init(|| {
            let point = self.point(&Boxes::middle(part));
            let (modes, _) = point.spectrum.as_ref()?;
            let families = self.families(sheet)?;
            let n = families[0].coordinates();
            if !modes.is_complete() || modes.list.len() != n {
                return None;
            }
            let moved = |centre: &Centre| {
                let Centre::Eigenvalue(square) = *centre else { return None };
                let x = families[0].modes_at(square, 1)?;
                let slope = |family: &Family| family.eigenvalue_slope(square, &x).map(Moved::Eigenvalue);
                families.iter().map(slope).collect::<Option<Vec<_>>>()
            };
            self.work(8 * n as u64 * solving(n + 1));
            let tube = |square: Ball| sheet.tube(&Centre::Eigenvalue(square), true, moved);
            let middles: Vec<Ball> = modes.list.iter().map(|mode| mode.omega_squared).collect();
            let list = middles.iter().map(|square| tube(*square)).collect();
            Some(Tubes::of(list, &middles, |square| families[0].has_no_eigenvalue_at(square)))
        });
        found.as_ref()
    }

    fn poles<'s>(&self, part: &Part, sheet: &'s Sheet) -> Option<&'s Tubes> {
        let found = sheet.poles.get_or_init(|| {
            let point = self.point(&Boxes::middle(part));
            let (_, poles) = point.spectrum.as_ref()?;
            let families = self.families(sheet)?;
            let n = families[0].coordinates();
            if !poles.is_complete() || poles.list.len() != 2 * n || sheet.over.iter().any(|ranged| !ranged.is_damped) {
                return None;
            }
            let moved = |centre: &Centre| {
                let Centre::Pole(re, im) = *centre else { return None };
                let s = Complex::new(re, im);
                let x = families[0].motion_at(s)?;
                let slope = |family: &Family| family.pole_slope(s, &x).map(|s| Moved::Pole(s.re, s.im));
                families.iter().map(slope).collect()
            };
            let upper: Vec<&Pole> = poles.list.iter().filter(|pole| !pole.is_lower_half()).collect();
            self.work(((8 + families.len()) * upper.len()) as u64 * solving(2 * n + 2));
            let tube = |pole: &&Pole| {
                let mut tube = sheet.tube(&Centre::Pole(pole.re, pole.im), !pole.is_complex(), moved)?;
                if !tube.is_real {
                    let of = |own: usize| families[own].energies(&tube.raw(own, false)?, &tube.raw(own, true)?);
                    tube.energies = (0..families.len()).map(of).collect();
                }
                Some(tube)
            };
            let list = upper.iter().map(tube).collect();
            let middles: Vec<Ball> = upper.iter().map(|pole| jet::square(pole.re) + jet::square(pole.im)).collect();
            let is_free = |square: f64| {
                self.work(MOST_ARCS as u64 * solving(2 * n));
                families[0].has_no_pole_of_size(square.sqrt(), MOST_ARCS)
            };
            Some(Tubes::of(list, &middles, is_free))
        });
        found.as_ref()
    }

    /// The systems with their derivatives, if M is regular everywhere, so that there are as many eigenvalues and poles everywhere.
    fn families<'s>(&self, sheet: &'s Sheet) -> Option<Vec<Family<'s>>> {
        let families: Option<Vec<Family>> = (0..sheet.over.len()).map(|own| sheet.family(own)).collect();
        families.filter(|families| families.first().is_some_and(Family::has_regular_mass))
    }
}

impl Sheet {
    /// The system with the derivatives by one of the parameters.
    fn family(&self, own: usize) -> Option<Family<'_>> {
        let system = &self.over.get(own)?.lowered.system;
        match &self.together {
            Some(together) => together.family(system, own),
            None => Family::of(system, false),
        }
    }

    /// An eigenvalue or a pole over the box, from its enclosure in the middle.
    fn tube(&self, start: &Centre, is_real: bool, moved: impl Fn(&Centre) -> Option<Vec<Moved>>) -> Option<Tube> {
        let (centre, moved) = start.over_box_narrow(&self.radius, moved)?;
        Some(Tube { moved, centre, is_real, energies: Vec::new() })
    }
}

impl Point {
    pub fn scene(&self) -> Option<&CheckedScene> {
        self.scene.as_ref()
    }

    pub fn rest(&self) -> Option<&Rest> {
        self.written.as_ref().map(|written| &written.lowered.rest)
    }

    pub fn system(&self) -> Option<&WrittenOut> {
        self.written.as_ref()
    }

    /// The number of undamped modes, and of poles with im s >= 0, if all are known.
    pub fn counts(&self) -> Option<(usize, usize)> {
        let (modes, poles) = self.spectrum.as_ref()?;
        let upper = poles.list.iter().filter(|pole| !pole.is_lower_half()).count();
        (modes.is_complete() && poles.is_complete()).then_some((modes.list.len(), upper))
    }

    /// The number of damped motions that oscillate, and whether anything damps.
    pub fn motions(&self) -> (usize, bool) {
        let Some((_, poles)) = &self.spectrum else { return (0, false) };
        let is_damped = poles.list.iter().any(|pole| !pole.re.is_zero());
        let halves: usize =
            poles.list.iter().filter(|pole| !pole.is_lower_half()).map(|pole| 1 + usize::from(pole.is_complex())).sum();
        (halves / 2, is_damped)
    }
}

/// One number or the other: both values are enclosed, and nothing is said about the derivative.
fn either_value(a: Option<Jet>, b: Option<Jet>) -> Option<Jet> {
    let (a, b) = (a?.value, b?.value);
    let end = |ball: Ball, sign: f64| Ball::exact(ball.mid) + Ball::from(sign * ball.rad);
    let pick = |sign: f64| {
        let (a, b) = (end(a, sign), end(b, sign));
        if sign * (b - a).mid.hi > 0.0 { b } else { a }
    };
    Some(Jet { value: super::hull(pick(-1.0), pick(1.0)), slope: Ball::new(Dd::ZERO, f64::INFINITY) })
}

/// The value of an expression of numbers with their derivatives.
fn value_of(combined: &Combined<Option<Jet>>) -> Option<Number> {
    Some(match combined {
        Combined::Measure(jet) => number(jet.clone()?),
        Combined::Number(number) => number.clone(),
        Combined::Negated(part) => -&value_of(part)?,
        Combined::Binary { operator, left, right } => {
            let (left, right) = (value_of(left)?, value_of(right)?);
            match operator {
                Arithmetic::Add => &left + &right,
                Arithmetic::Subtract => &left - &right,
                Arithmetic::Multiply => &left * &right,
                Arithmetic::Divide => left.checked_div(&right)?,
            }
        }
    })
}

fn number(jet: Jet) -> Number {
    Number::from(jet)
}

/// The work of linear equations in balls with their derivatives.
fn solving(n: usize) -> u64 {
    10 * cube(n)
}

fn cube(n: usize) -> u64 {
    (n as u64).pow(3)
}
