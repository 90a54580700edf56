//! The undamped modes: their frequencies and shapes, and which mode is which.

use super::super::ReportOptions;
use super::super::decimal::{Decimal, certain, upper};
use super::table::{Align, Table};
use super::{INDENT, WIDTH, carried_by, counted, largest_shares, line, unit};
use crate::analysis::derived::{hertz, period};
use crate::analysis::{Mode, ModeKind, Normalise, normalise, splits};
use crate::answers::ModalAnswer;
use crate::base::{Dd, Unproven};
use crate::system::{Coordinate, CoordinateKind, LinearSystem};

/// Modes that are listed; the JSON has all.
pub const MOST: usize = 20;
const DIGITS: usize = 7;
const SHAPE_DIGITS: usize = 5;
/// Entries of a shape that are named where a column for each does not fit.
const LARGEST: usize = 3;

pub fn table(answer: &ModalAnswer, options: &ReportOptions) -> String {
    if answer.modes.list.is_empty() {
        return left_out(answer);
    }
    let with_columns = filled(answer, options, true);
    let fits = answer.system.n() <= WIDTH / 10 && with_columns.width() + INDENT <= WIDTH;
    let table = if fits { with_columns } else { filled(answer, options, false) };
    line(format!("undamped modes ({})", scaling(options.normalise, &answer.system)))
        + &table.text(INDENT)
        + &remarks(answer, options)
        + &without_inertia(answer.modes.infinite)
}

/// Motions that have no frequency.
fn without_inertia(count: usize) -> String {
    match count {
        0 => String::new(),
        1 => line("one motion has no inertia: it follows the others, and has no frequency"),
        _ => line(format!("{count} motions have no inertia: they follow the others, and have no frequency")),
    }
}

fn scaling(normalise: Normalise, system: &LinearSystem) -> &'static str {
    let translates = |coordinate: &Coordinate| coordinate.kind == CoordinateKind::Translation;
    let mixed = system.coordinates.iter().any(translates) && !system.coordinates.iter().all(translates);
    match normalise {
        Normalise::Translation if mixed => "shapes: largest translation 1, or rotation where nothing translates",
        Normalise::Translation | Normalise::Max => "shapes: largest entry 1",
        Normalise::First => "shapes: first entry 1",
        Normalise::Mass => "shapes: mass-normalised",
    }
}

/// The table, with a column for each coordinate or with the largest entries in one.
fn filled(answer: &ModalAnswer, options: &ReportOptions, columns: bool) -> Table {
    let system = &answer.system;
    let mut table = Table::new()
        .column("mode", "", Align::Right)
        .column("f", "[Hz]", Align::Point)
        .column("ω", "[rad/s]", Align::Point)
        .column("T", "[s]", Align::Point)
        .column("error ≤", "", Align::Right);
    if columns {
        for coordinate in &system.coordinates {
            table = table.column(system.display(coordinate.name), format!("[{}]", unit(coordinate.kind)), Align::Point);
        }
    } else {
        table = table.column("shape, largest entries", "", Align::Left);
    }
    for (number, mode) in answer.modes.numbered().take(MOST) {
        let shape = normalise(mode, options.normalise);
        let mut cells = frequency_cells(number, mode, options);
        bound_only_if(answer.rest.is_proven(), &mut cells, BOUND);
        if columns {
            let largest = shape.iter().fold(0.0, |largest: f64, entry| largest.max(entry.0.abs()));
            cells.extend(shape.iter().map(|entry| rounded(*entry, largest)));
        } else {
            cells.push(largest_entries(system, &shape));
        }
        table.row(cells);
    }
    table
}

/// The column of the bound in [`frequency_cells`].
const BOUND: usize = 4;

/// At a rest that is not proven no bound is shown: it would be about a place that may be no rest.
pub fn bound_only_if(proven: bool, cells: &mut [String], column: usize) {
    for cell in cells.iter_mut().enumerate().filter(|(at, cell)| !proven && (*at == column || cell.starts_with('≤')))
    {
        *cell.1 = "?".into();
    }
}

/// Number, f, omega, T and the bound; for a divergence its growth rate in the place of omega.
fn frequency_cells(number: usize, mode: &Mode, options: &ReportOptions) -> Vec<String> {
    let digits = options.digits(DIGITS);
    let (frequency, period) = (hertz(mode.omega), period(mode.omega));
    let (f, omega, t) = match mode.kind {
        ModeKind::Oscillation => {
            (certain(&frequency, digits), certain(&mode.omega, digits), certain(&period, options.digits(SHAPE_DIGITS)))
        }
        ModeKind::Rigid => ("0".into(), "0".into(), "rigid".into()),
        ModeKind::Divergence => ("".into(), format!("{}i", certain(&mode.omega, digits)), "unstable".into()),
        ModeKind::Undetermined => ("".into(), certain(&mode.omega, digits), "undetermined".into()),
    };
    let bound = match mode.kind {
        ModeKind::Rigid => "exact".into(),
        // Digits beyond binary64 are those of the enclosures: so are the bounds beside them.
        _ if options.digits.is_some() => upper(mode.enclosure_error()),
        ModeKind::Undetermined => "?".into(),
        ModeKind::Oscillation | ModeKind::Divergence => upper(mode.error_bound()),
    };
    vec![number.to_string(), f, omega, t, bound]
}

/// An entry of a shape. Shapes carry no bound: binary64 gives them to more digits than are shown.
fn rounded(Unproven(entry): Unproven, largest: f64) -> String {
    /// Below this part of the largest entry it is rounding, no motion (docs/method/report.md#numbers).
    const NOTHING: f64 = 1e-12;
    if entry.abs() <= NOTHING * largest { "0".into() } else { Decimal::round(Dd::from(entry), SHAPE_DIGITS).text() }
}

fn largest_entries(system: &LinearSystem, shape: &[Unproven]) -> String {
    let mut order: Vec<usize> = (0..shape.len()).filter(|i| shape[*i].0 != 0.0).collect();
    order.sort_by(|a, b| shape[*b].0.abs().total_cmp(&shape[*a].0.abs()).then(a.cmp(b)));
    let largest = order.first().map_or(0.0, |i| shape[*i].0.abs());
    let named = order.iter().take(LARGEST);
    let name = |i: usize| system.display(system.coordinates[i].name);
    named.map(|i| format!("{} {}", name(*i), rounded(shape[*i], largest))).collect::<Vec<_>>().join(", ")
}

/// What cannot be seen in the table.
fn remarks(answer: &ModalAnswer, options: &ReportOptions) -> String {
    let list = &answer.modes.list;
    let mut text = String::new();
    if list.len() > MOST {
        let highest = list.last().map_or(String::new(), |mode| certain(&hertz(mode.omega), 4));
        text += &line(format!("... and {} modes more, up to {highest} Hz (--format json has all)", list.len() - MOST));
    }
    text + &left_out(answer) + &clusters(answer) + &beats(answer, options) + &sensitive(answer)
}

/// The modes that were not asked for, or not computed because they are too many.
fn left_out(answer: &ModalAnswer) -> String {
    let (below, above) = (answer.modes.before.count(), answer.modes.after);
    let told = match (below, above) {
        (0, 0) => return String::new(),
        (0, above) => format!("{} above", counted(above, "mode")),
        (below, 0) => format!("{} below", counted(below, "mode")),
        (below, above) => format!("{} below and {above} above", counted(below, "mode")),
    };
    let empty = if answer.modes.list.is_empty() { "no undamped mode is in the band; " } else { "" };
    line(format!("{empty}not computed: {told} (--modes N and --band FROM..TO ask for others)"))
}

/// Close frequencies: their difference keeps the digits that the two numbers share.
fn beats(answer: &ModalAnswer, options: &ReportOptions) -> String {
    let shown = answer.modes.before.count() + MOST;
    splits(&answer.modes)
        .into_iter()
        .filter(|split| split.lower < shown)
        .map(|split| {
            let range = range(split.lower, split.lower + 1);
            let difference = certain(&split.omega, options.digits(DIGITS));
            let beat = certain(&split.beat(), SHAPE_DIGITS);
            let proven = answer.rest.is_proven();
            let bound = if proven { format!("≤ {}", upper(split.error_bound())) } else { "?".into() };
            line(format!("modes {range} are {difference} rad/s apart (error {bound}): a beat of {beat} s"))
        })
        .collect()
}

/// Modes that are certified together only.
fn clusters(answer: &ModalAnswer) -> String {
    let (list, below) = (&answer.modes.list, answer.modes.before.count());
    let mut text = String::new();
    let mut seen = None;
    for (first, mode) in list.iter().enumerate().filter(|(_, mode)| mode.cluster.is_some()) {
        let members: Vec<usize> = (first..list.len()).filter(|i| list[*i].cluster == mode.cluster).collect();
        if seen == mode.cluster {
            continue;
        }
        seen = mode.cluster;
        if members.len() == 1 {
            let number = below + first + 1;
            let text_of_one =
                format!("mode {number}: one of a repeated frequency or a tight cluster that goes on above");
            text += &line(text_of_one);
            continue;
        }
        let range = range(below + members[0] + 1, below + members[members.len() - 1] + 1);
        text +=
            &line(format!("modes {range}: one repeated frequency or a tight cluster; their shapes span it together"));
    }
    text
}

/// `2 and 3`, `2 to 5`
fn range(first: usize, last: usize) -> String {
    if last == first + 1 { format!("{first} and {last}") } else { format!("{first} to {last}") }
}

/// Frequencies that the model's numbers do not fix as well as they are computed.
fn sensitive(answer: &ModalAnswer) -> String {
    const WORTH_TELLING: f64 = 100.0;
    let told = answer
        .modes
        .numbered()
        .filter(|(_, mode)| mode.input_condition.is_some_and(|factor| factor.0 >= WORTH_TELLING));
    told.take(MOST)
        .map(|(number, mode)| {
            let factor = upper(mode.input_condition.map_or(f64::INFINITY, |factor| factor.0));
            line(format!("mode {number} is sensitive: its ω moves up to {factor} times as much as masses, stiffnesses and tensions, relatively"))
        })
        .collect()
}

/// Which mode is which: what moves in it, and what holds it.
pub fn shares(answer: &ModalAnswer) -> String {
    if answer.system.n() < 2 || answer.modes.list.is_empty() {
        return String::new();
    }
    let system = &answer.system;
    let mut table = Table::new()
        .column("mode", "", Align::Right)
        .column("moves (share of kinetic energy)", "", Align::Left)
        .column("is held by (share of strain energy)", "", Align::Left);
    for (number, mode) in answer.modes.numbered().take(MOST) {
        let held = match mode.kind {
            ModeKind::Rigid => "nothing".into(),
            _ => largest_shares(&mode.strain, |of| system.display(of)),
        };
        table.row(vec![format!("{number}"), carried_by(system, mode), held]);
    }
    line("which mode is which") + &table.text(INDENT)
}
