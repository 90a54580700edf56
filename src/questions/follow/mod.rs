//! Modes followed along a parameter: each is a curve that keeps its identity, instead of a number in an order. In: a
//! study over one parameter. Out: the curves, what is proved about the steps between their points, and where they veer
//! or cross. See docs/method/studies.md#curves.

mod by_class;
mod loci;
mod meetings;
mod onsets;
mod orders;
mod places;
mod steps;

use super::answer::{Case, Column, Entry, Holds, Proved};
use super::cases::{Study, Varied};
use super::followed::{Curve, Followed, Grows, Meeting, MeetingKind};
use crate::base::{Ball, Number, OrderBy};
use crate::kernel::cores;
use crate::questions::rows::Rows;
use places::{Field, Place};
use steps::{Limits, Step};

/// Limit on the points of a followed study.
pub const MOST_POINTS: u64 = 10_000;
/// Limit on the coordinates.
pub const MOST_COORDINATES: usize = 60;
/// Limit on the curves.
pub const MOST_CURVES: usize = 60;

/// A mode, given by the index of its class and its index in the class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Member {
    pub class: usize,
    pub index: usize,
}

/// The reason why modes cannot be followed.
pub enum Unfollowed {
    NotInOrder,
    TooManyPoints(u64),
    TooManyCoordinates(usize),
    /// The model determines parameters for each case.
    Determined,
    NoModes,
    /// Orders are requested, but the parameter is not a rate of rotation.
    NoRate,
}

/// The modes whose distance to the next one of their class is needed: those of the curves, and the ones below them.
fn pairs_of(curves: &[Member], classes: &[Vec<u32>]) -> Vec<Member> {
    let own = curves.iter().filter(|own| own.index + 1 < classes[own.class].len()).copied();
    let below = curves.iter().filter_map(|own| Some(Member { index: own.index.checked_sub(1)?, ..*own }));
    let mut pairs: Vec<Member> = own.chain(below).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Follows the modes of a study over one parameter.
pub fn follow(study: &Study, orders: &[u32]) -> Result<Followed, Unfollowed> {
    let Varied::Over(swept) = &study.varied else { return Err(Unfollowed::NotInOrder) };
    let [swept] = &swept[..] else { return Err(Unfollowed::NotInOrder) };
    let values: Vec<Number> = (0..study.count().min(MOST_POINTS + 1)).map(|i| swept.points.value(i)).collect();
    let n = fitting(study, &values)?;
    let rate = &swept.parameter.value;
    if !orders.is_empty() && !orders::is_rate(rate) {
        return Err(Unfollowed::NoRate);
    }
    let (Some(first), Some(last)) = (values.first(), values.last()) else { return Err(Unfollowed::NoModes) };
    let (classes, course) = places::classes(study, [first, last], n);
    let wanted = study.frequencies_asked().min(MOST_CURVES);
    // Of the last curve, the distance to the next one is needed.
    let count = (wanted + 1).min(n);
    let line = |class: &Vec<u32>| study.line_of_class(class, classes.len() == 1, count);
    let lines: Vec<_> = classes.iter().map(line).collect();
    let class = classes.first().filter(|_| classes.len() > 1).map(Vec::as_slice);
    let has_polynomials = course.is_none() && study.has_polynomials([first, last], class);
    let field = Field { study, classes: &classes, course, lines: &lines, has_polynomials };
    let points = field.places(&values, count);
    let curves = choose(&points, wanted)?;
    let limits = Limits { stretches: stretches(values.len(), n) };
    let look = steps::Look { curves: &curves, pairs: pairs_of(&curves, &classes) };
    let cases: Vec<u64> = (1..points.len() as u64).map(|next| next - 1).collect();
    let steps = cores::in_pieces(&cases, 1, 1, |some| {
        let over = field.over_steps(some, count);
        let ends = |case: u64| [&points[case as usize], &points[case as usize + 1]];
        some.iter()
            .zip(&over)
            .map(|(case, over)| steps::step(&field, &look, limits, ends(*case), over.as_ref()))
            .collect()
    });
    let places = all_places(&points, &steps);
    let mut meetings = meetings_of(&field, &curves, &points, &steps, &places);
    let orders = orders::orders(&field, &places, &curves, rate, orders);
    let grows = if study.asked.poles { Grows::Poles } else { Grows::Modes };
    let rises = values.len() < 2 || first.to_f64() <= last.to_f64();
    let key = |meeting: &Meeting| if rises { meeting.place[0] } else { -meeting.place[0] };
    meetings.order_by(|a, b| key(a).total_cmp(&key(b)));
    Ok(Followed {
        curves: curves.iter().map(|own| curve(*own, &classes, &points, &steps)).collect(),
        meetings,
        loci: if study.asked.poles { loci::loci(&field, &values) } else { Vec::new() },
        onsets: onsets::onsets(&field, &points, grows),
        orders,
        parameter: (swept.parameter.name.clone(), swept.parameter.unit.clone()),
        places: points.iter().map(|place| place.x).collect(),
        classes: classes.len(),
    })
}

/// The number of coordinates, if the study is one that can be followed.
fn fitting(study: &Study, points: &[Number]) -> Result<usize, Unfollowed> {
    let count = study.count();
    if count > MOST_POINTS {
        return Err(Unfollowed::TooManyPoints(count));
    }
    if study.columns.iter().any(|column| column.holds == Holds::Determined) {
        return Err(Unfollowed::Determined);
    }
    let values: Vec<f64> = points.iter().map(Number::to_f64).collect();
    let is_in_order = values.windows(2).all(|two| two[0] < two[1]) || values.windows(2).all(|two| two[0] > two[1]);
    if !is_in_order {
        return Err(Unfollowed::NotInOrder);
    }
    let n = (0..)
        .zip(points)
        .find_map(|(i, value)| Some(study.undamped_system(i, value.clone())?.n()))
        .ok_or(Unfollowed::NoModes)?;
    if n > MOST_COORDINATES { Err(Unfollowed::TooManyCoordinates(n)) } else { Ok(n) }
}

/// Limit on the pieces of a step, chosen for about ten seconds in total: computing the modes of n coordinates takes
/// about n^2 times as long as computing one.
fn stretches(points: usize, n: usize) -> usize {
    let in_all = 40_000 / (1 + n * n / 50);
    (in_all / points.max(1)).clamp(8, 128)
}

/// The lowest modes at the first place whose modes are known; those that do not oscillate there are the lowest.
fn choose(points: &[Place], count: usize) -> Result<Vec<Member>, Unfollowed> {
    let first = points.iter().find(|place| place.classes().all(|class| !class.is_empty()));
    let mut list: Vec<(f64, Member)> = Vec::new();
    for (class, frequencies) in first.ok_or(Unfollowed::NoModes)?.classes().enumerate() {
        let key = |frequency: &Option<Ball>| frequency.map_or(f64::NEG_INFINITY, |frequency| frequency.to_f64());
        let own = frequencies.iter().enumerate().map(|(index, frequency)| (key(frequency), Member { class, index }));
        list.extend(own);
    }
    list.order_by(|a, b| a.0.total_cmp(&b.0));
    Ok(list.into_iter().take(count).map(|(_, member)| member).collect())
}

fn curve(own: Member, classes: &[Vec<u32>], points: &[Place], steps: &[Option<Box<Step>>]) -> Curve {
    let neighbours = pairs_of(&[own], classes);
    let is_proved =
        |step: &Step| !step.unknown.contains(&own.class) && neighbours.iter().all(|pair| !step.doubtful.contains(pair));
    let link = |step: &Option<Box<Step>>| step.as_ref().is_none_or(|step| is_proved(step)).then_some(Proved(()));
    Curve {
        class: own.class + 1,
        points: points.iter().map(|place| place.frequency(own.class, own.index)).collect(),
        links: std::iter::once(None).chain(steps.iter().map(link)).collect(),
    }
}

/// All evaluated places, in order.
fn all_places<'a>(points: &'a [Place], steps: &'a [Option<Box<Step>>]) -> Vec<&'a Place> {
    let mut places: Vec<&Place> = Vec::with_capacity(points.len());
    for (i, point) in points.iter().enumerate() {
        places.push(point);
        places.extend(steps.get(i).into_iter().flatten().flat_map(|step| &step.inner));
    }
    places
}

/// The results about pairs of curves.
fn meetings_of(
    field: &Field,
    curves: &[Member],
    points: &[Place],
    steps: &[Option<Box<Step>>],
    places: &[&Place],
) -> Vec<Meeting> {
    let pairs: Vec<[usize; 2]> = (0..curves.len()).flat_map(|i| (i + 1..curves.len()).map(move |j| [i, j])).collect();
    let of_pair = |pair: &[usize; 2]| {
        let [a, b] = pair.map(|i| curves[i]);
        let doubtful = |step: &Step| match a.class == b.class {
            true => step.doubtful.contains(&a.min(b)),
            false => step.near.contains(pair),
        };
        let mut list = match (a.class == b.class, a.index.abs_diff(b.index)) {
            (false, _) => meetings::crossings(field, places, [a, b], *pair),
            (true, 1) => meetings::veerings(field, places, a.min(b), *pair),
            _ => return Vec::new(),
        };
        let open: Vec<usize> =
            (0..steps.len()).filter(|&i| steps[i].as_ref().is_some_and(|step| doubtful(step))).collect();
        for run in open.chunk_by(|a, b| a + 1 == *b) {
            let ends = [&points[run[0]], &points[run[run.len() - 1] + 1]];
            if !list.iter().any(|known| lies_in(known, ends)) {
                list.push(meetings::undecided_meeting(*pair, ends));
            }
        }
        list
    };
    cores::in_pieces(&pairs, 1, 1, |some| some.iter().map(of_pair).collect()).concat()
}

fn lies_in(meeting: &Meeting, ends: [&Place; 2]) -> bool {
    let [low, high] = ends.map(|place| place.x);
    meeting.place.iter().all(|x| (low.min(high)..=low.max(high)).contains(x))
}

/// Halvings of one interval: the number of digits of a binary64 number, twice, because the interval may lie near zero.
const MOST_HALVINGS: usize = 200;

/// Shortens an interval as far as the answers are certain: at its first end the answer is certainly `Some(true)`, at
/// its last end it is not.
fn narrow([mut first, mut last]: [f64; 2], is_alike: impl Fn(f64) -> Option<bool>) -> [f64; 2] {
    for _ in 0..MOST_HALVINGS {
        let old = [first, last];
        // No answer may be certain in the middle, because the place searched for lies there.
        for part in [0.5, 0.25, 0.75] {
            let x = old[0] + part * (old[1] - old[0]);
            match is_alike(x) {
                _ if old.contains(&x) => {}
                Some(true) => first = x,
                Some(false) => last = x,
                None => continue,
            }
            break;
        }
        if [first, last] == old {
            break;
        }
    }
    [first, last]
}

impl Followed {
    /// Replaces the `modes` numbered frequencies, and the poles after them, by curves, each with a column that says
    /// whether its links are proved.
    pub(super) fn columns(&self, columns: &[Column], modes: usize) -> Vec<Column> {
        let link = |name: String| Column { name: format!("{name}_linked"), unit: String::new(), holds: Holds::Link };
        let curve = |i: usize| {
            let name = format!("curve_{i}");
            [Column { name: name.clone(), unit: "Hz".into(), holds: Holds::Curve }, link(name)]
        };
        let mut list = columns[..1].to_vec();
        list.extend((1..=self.curves.len()).flat_map(curve));
        let poles = &columns[1 + modes..];
        let parts = poles.chunks(2).take(self.loci.len()).enumerate();
        list.extend(parts.flat_map(|(i, parts)| [parts, &[link(format!("pole_{}", i + 1))]].concat()));
        list.extend_from_slice(&poles[2 * self.loci.len()..]);
        list
    }

    /// The rows of cases with their curves in place of numbered frequencies.
    pub(super) fn rows(&self, numbered: &Rows, modes: usize, rows: &mut Rows) {
        let places = 0..numbered.len();
        if numbered.columns().len() != 1 + modes {
            rows.clear(0);
            return places.for_each(|at| rows.push(self.row(&numbered.case_at(at), modes)));
        }
        // Columns of numbers, as those of the cases are, but for a case that lacks one.
        rows.clear(1 + 2 * self.curves.len());
        let numbers: Vec<u64> = places.clone().map(|at| numbered.number(at)).collect();
        rows.extend(&numbers);
        let mut is_whole = vec![true; numbers.len()];
        numbered.places_of_others().for_each(|at| is_whole[at] = false);
        let (parameter, columns) = rows.columns_mut().split_at_mut(1);
        parameter[0].clone_from(&numbered.columns()[0]);
        for (curve, columns) in self.curves.iter().zip(columns.chunks_mut(2)) {
            columns[1].are_verdicts = true;
            for (at, number) in numbers.iter().map(|number| *number as usize).enumerate() {
                match curve.points[number] {
                    Some(value) if curve.has_link(number) => {
                        columns[0].set(at, value);
                        columns[1].high[at] = if curve.links[number].is_some() { 1.0 } else { 0.0 };
                    }
                    _ => is_whole[at] = false,
                }
            }
        }
        for at in places.filter(|at| !is_whole[*at]) {
            rows.replace(at, self.row(&numbered.case_at(at), modes));
        }
    }

    /// The row of a case with its curves in place of numbered frequencies.
    fn row(&self, case: &Case, modes: usize) -> Case {
        let number = case.number as usize;
        let link = |is_one: bool, proof: &Option<Proved>| match is_one {
            true => Entry::Verdict(proof.is_some()),
            false => Entry::None(None),
        };
        let (first, rest) = case.entries.split_at(1);
        let rest = &rest[modes + 2 * self.loci.len()..];
        let mut entries = Vec::with_capacity(1 + 2 * self.curves.len() + 3 * self.loci.len() + rest.len());
        entries.extend_from_slice(first);
        for curve in &self.curves {
            entries.push(curve.points[number].map_or(Entry::None(None), Entry::Enclosed));
            entries.push(link(curve.has_link(number), &curve.links[number]));
        }
        for locus in &self.loci {
            entries.extend(locus.points[number].map(Entry::Enclosed));
            entries.push(link(number > 0, &locus.links[number]));
        }
        entries.extend_from_slice(rest);
        Case { entries, ..*case }
    }
}

impl MeetingKind {
    pub fn is_decided(&self) -> bool {
        !matches!(self, MeetingKind::Undecided { .. })
    }
}
