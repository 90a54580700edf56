//! The modes of a study as curves: what is proved of their links, and where they veer, cross, or come too near each other to tell.

use super::table::{Align, Cell, Table};
use super::{Block, Figure, Line, Section, line};
use crate::base::Bound;
use crate::questions::answer::{Followed, Grows, Meeting, MeetingKind, few_digits};

const DIGITS: usize = 6;
/// Number of veerings, crossings and doubts each that are shown.
const MOST_ROWS: usize = 40;

pub fn section(followed: &Followed) -> Section {
    let intro = match followed.classes {
        1 => Vec::new(),
        count => vec![Block::Line(line![count, " blocks of coordinates, which nothing couples anywhere in the range"])],
    };
    let is_veering = |kind: &MeetingKind| matches!(kind, MeetingKind::Veering { .. });
    let is_crossing = |kind: &MeetingKind| matches!(kind, MeetingKind::Crossing { .. });
    let veerings = table(followed, ["veering of curves", "smallest distance"], is_veering);
    let crossings = table(followed, ["crossing of curves", "frequency"], is_crossing);
    let open: Vec<&Meeting> = followed.meetings.iter().filter(|meeting| !meeting.kind.is_decided()).collect();
    let mut doubts: Vec<Block> =
        open.iter().take(MOST_ROWS).map(|meeting| Block::Item(doubt(followed, meeting))).collect();
    doubts.extend(more(open.len()));
    let blocks =
        [intro, vec![links(followed).into()], veerings, crossings, doubts, critical(followed), onsets(followed)];
    Section::new("Curves", blocks.concat())
}

/// Where the number of growing motions changes.
fn onsets(followed: &Followed) -> Vec<Block> {
    let (found, what) = (&followed.onsets, growing(followed.onsets.of));
    let mut table = Table::new()
        .column(what, "", Align::Left)
        .column(at(followed), "", Align::Point)
        .column("error ≤", "", Align::Right)
        .column("", "", Align::Left);
    for onset in found.list.iter().take(MOST_ROWS) {
        let [before, after] = onset.growing;
        let place = followed.place(onset.place);
        table.row(vec![
            line![before, "\u{a0}to\u{a0}", after].into(),
            Figure::ball(place, DIGITS).into(),
            Figure::bound(Bound::relative(place)).into(),
            if onset.proof.is_some() { Cell::default() } else { "not proved".into() },
        ]);
    }
    let mut blocks = if found.list.is_empty() { Vec::new() } else { vec![Block::from(table)] };
    blocks.extend(more(found.list.len()));
    let undecided =
        line!["it is not known how many grow in ", found.undecided, " of ", followed.places.len(), " cases"];
    blocks.extend((found.undecided > 0).then_some(Block::Item(undecided)));
    blocks
}

/// Where the curves have the frequencies of the orders.
fn critical(followed: &Followed) -> Vec<Block> {
    let mut table = Table::new()
        .column("order", "", Align::Right)
        .column("curve", "", Align::Right)
        .column("frequency", "[Hz]", Align::Point)
        .column("error ≤", "", Align::Right)
        .column(at(followed), "", Align::Point)
        .column("error ≤", "", Align::Right);
    let list = &followed.orders.critical;
    for critical in list.iter().take(MOST_ROWS) {
        let [order, curve] = [critical.order as usize, critical.curve + 1].map(|count| Cell::from(Line::from(count)));
        let place = followed.place(critical.place);
        let frequency = match critical.frequency {
            Some(frequency) => {
                [Figure::ball(frequency, DIGITS).into(), Figure::bound(Bound::relative(frequency)).into()]
            }
            None => ["not proved".into(), Cell::default()],
        };
        let place = [Figure::ball(place, DIGITS).into(), Figure::bound(Bound::relative(place)).into()];
        table.row([vec![order, curve], frequency.to_vec(), place.to_vec()].concat());
    }
    let shown = if list.is_empty() { Vec::new() } else { vec![Block::from(table)] };
    let none = (list.is_empty() && !followed.orders.list.is_empty())
        .then(|| Block::Line("no curve has the frequency of an order at a place between two values".into()));
    shown.into_iter().chain(more(list.len())).chain(none).collect()
}

fn growing(of: Grows) -> &'static str {
    match of {
        Grows::Modes => "number of growing modes",
        Grows::Poles => "number of growing poles",
    }
}

/// `at k [N/m]`
fn at(followed: &Followed) -> String {
    let (name, unit) = (&followed.parameter.0, &followed.parameter.1.text);
    if unit.is_empty() { format!("at {name}") } else { format!("at {name} [{unit}]") }
}

fn links(followed: &Followed) -> Table {
    let mut table = Table::of([
        ("", Align::Left),
        ("block", Align::Right),
        ("links", Align::Right),
        ("proved", Align::Right),
        ("not proved", Align::Left),
    ]);
    let open = |cases: Vec<usize>| match cases.first() {
        Some(&case) => line!["the first ", between(followed, [followed.places[case - 1], followed.places[case]])],
        None => Line::default(),
    };
    let mut row = |name: String, block: Line, count: usize, cases: Vec<usize>| {
        let proved = Line::from(count - cases.len());
        table.row(vec![name.into(), block.into(), Line::from(count).into(), proved.into(), open(cases).into()]);
    };
    for (i, curve) in followed.curves.iter().enumerate() {
        let count = (0..curve.points.len()).filter(|&case| curve.has_link(case)).count();
        row(format!("curve_{}", i + 1), curve.class.into(), count, curve.open_links().collect());
    }
    for (i, locus) in followed.loci.iter().enumerate() {
        row(format!("pole_{}", i + 1), Line::default(), locus.links.len() - 1, locus.open_links().collect());
    }
    table
}

/// A table of the meetings of one kind; nothing if there are none.
fn table(followed: &Followed, [curves, value]: [&'static str; 2], is_one: impl Fn(&MeetingKind) -> bool) -> Vec<Block> {
    let mut table = Table::new()
        .column(curves, "", Align::Left)
        .column(value, "[Hz]", Align::Point)
        .column("error ≤", "", Align::Right)
        .column(at(followed), "", Align::Point)
        .column("error ≤", "", Align::Right);
    let list: Vec<&Meeting> = followed.meetings.iter().filter(|meeting| is_one(&meeting.kind)).collect();
    for meeting in list.iter().take(MOST_ROWS) {
        let (MeetingKind::Veering { distance: value, .. } | MeetingKind::Crossing { frequency: value, .. }) =
            meeting.kind
        else {
            continue;
        };
        let place = followed.place(meeting.place);
        let number = |value| [Cell::from(Figure::ball(value, DIGITS)), Figure::bound(Bound::relative(value)).into()];
        table.row([vec![pair(meeting).into()], number(value).to_vec(), number(place).to_vec()].concat());
    }
    match list.len() {
        0 => Vec::new(),
        count => std::iter::once(Block::from(table)).chain(more(count)).collect(),
    }
}

fn more(count: usize) -> Option<Block> {
    (count > MOST_ROWS).then(|| Block::Line(line![count - MOST_ROWS, " more (--format json has all)"]))
}

fn pair(meeting: &Meeting) -> Line {
    line![meeting.curves[0] + 1, " and ", meeting.curves[1] + 1]
}

/// A sentence about two curves near each other of which it is not proved whether they cross.
fn doubt(followed: &Followed, meeting: &Meeting) -> Line {
    let line = line!["curves ", pair(meeting), " ", between(followed, meeting.place)];
    let line = line.and(": not proved whether they cross, touch or veer");
    match meeting.kind {
        MeetingKind::Undecided { distance: Some(distance) } => {
            line.and("; they come within ").and(few_digits(distance.magnitude())).and("\u{a0}Hz")
        }
        _ => line,
    }
}

/// `from k = 1 N/m to 1.5 N/m`
fn between(followed: &Followed, ends: [f64; 2]) -> String {
    let (name, unit) = (&followed.parameter.0, &followed.parameter.1.text);
    let [low, high] = ends.map(|end| few_digits(followed.in_unit(end).to_f64()));
    let place = match low == high {
        true => format!("near {name}\u{a0}=\u{a0}{low}\u{a0}{unit}"),
        false => format!("from {name}\u{a0}=\u{a0}{low} to {high}\u{a0}{unit}"),
    };
    place.trim_end().to_string()
}
