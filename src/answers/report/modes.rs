//! The undamped modes: their frequencies and shapes, and the parts of the scene that take part in them.

use super::table::{Align, Cell, Table};
use super::{
    Block, Figure, Line, Options, Section, Value, carried_by, coordinate, count_of, enumeration, line,
    shares as largest_shares, unit,
};
use crate::analysis::{Mode, ModeKind, Normalise, Split, derived, normalise, splits};
use crate::answers::{ModalAnswer, by_name};
use crate::base::{Number, Unproven, first_by};
use crate::lower::ShapeNode;
use crate::system::{Coordinate, CoordinateId, CoordinateKind, LinearSystem, Output};

/// Number of modes that are listed; the JSON has all.
pub const MOST: usize = 20;
const DIGITS: usize = 7;
const SHAPE_DIGITS: usize = 5;
/// Number of a shape's entries that are listed if there is no room for a column for each.
const LARGEST: usize = 3;
/// Limit on the coordinates for a column each.
const MOST_COLUMNS: usize = 10;

pub fn section(answer: &ModalAnswer, options: &Options) -> Section {
    let mut blocks: Vec<Block> = Vec::new();
    if !answer.modes.list.is_empty() {
        blocks.push(line!["undamped modes (", scaling(options.normalise, &answer.system), ")"].into());
        blocks.push(table(answer, options).into());
        blocks.extend(omitted_line(answer).map(Block::from));
        if options.all_shapes && (answer.system.n() > MOST_COLUMNS || !answer.system.outputs.is_empty()) {
            blocks.extend(whole_shapes(answer, options).map(Block::from));
        }
        blocks.extend(nodes(answer));
    }
    blocks.extend(left_out(answer).map(Block::from));
    if !answer.modes.list.is_empty() {
        blocks.extend(clusters(answer).into_iter().map(Block::from));
        blocks.extend(beats(answer, options).map(Block::from));
        blocks.extend(sensitive_lines(answer).map(Block::from));
        blocks.extend(without_inertia(answer.modes.infinite).map(Block::from));
    }
    Section::new("Undamped modes", blocks)
}

/// Motions without a frequency.
fn without_inertia(count: usize) -> Option<Line> {
    match count {
        0 => None,
        1 => Some("one motion has no inertia and no frequency: it follows the others".into()),
        _ => Some(line![count, " motions have no inertia and no frequency: they follow the others"]),
    }
}

fn scaling(normalise: Normalise, system: &LinearSystem) -> &'static str {
    let translates = |coordinate: &Coordinate| coordinate.kind == CoordinateKind::Translation;
    let mixed = system.coordinates.iter().any(translates) && !system.coordinates.iter().all(translates);
    match normalise {
        Normalise::Translation if mixed => "shapes: largest translation 1, or largest rotation if nothing translates",
        Normalise::Translation | Normalise::Max => "shapes: largest entry 1",
        Normalise::First => "shapes: first entry 1",
        Normalise::Mass => "shapes: mass-normalised",
    }
}

/// The table with a column for each coordinate, if there are few, and a narrower one with the largest entries in a single
/// column.
fn table(answer: &ModalAnswer, options: &Options) -> Table {
    let short = fill_table(answer, options, false);
    if answer.system.n() > MOST_COLUMNS {
        return short;
    }
    Table { narrower: Some(Box::new(short)), ..fill_table(answer, options, true) }
}

fn fill_table(answer: &ModalAnswer, options: &Options, columns: bool) -> Table {
    let system = &answer.system;
    let mut table = Table::new()
        .column("mode", "", Align::Right)
        .column("f", "[Hz]", Align::Point)
        .column("ω", "[rad/s]", Align::Point)
        .column("T", "[s]", Align::Point)
        .column("error ≤", "", Align::Right);
    if columns {
        for of in &system.coordinates {
            let unit = if unit(of.kind) == "m" { "[m]" } else { "[rad]" };
            table = table.column(coordinate(system, of), unit, Align::Point);
        }
    } else {
        table = table.column("shape, largest entries", "", Align::Left);
    }
    for (number, mode) in answer.modes.with_numbers().take(MOST) {
        let shape = normalise(mode, options.normalise);
        let mut cells = frequency_cells(number, mode, options);
        if columns {
            let largest = shape.iter().fold(0.0, |largest: f64, entry| largest.max(entry.0.abs()));
            cells.extend(shape.iter().map(|entry| Cell::from(displacement(*entry, largest))));
        } else {
            cells.push(largest_entries(system, &shape));
        }
        table.row(cells);
    }
    table
}

/// Number of shapes beside each other, with a row for each coordinate.
const BESIDE: usize = 6;

/// A shape at the outputs of displacements and angles: name, unit and value of each.
pub fn at_outputs(system: &LinearSystem, shape: &[Unproven]) -> Vec<(String, String, Unproven)> {
    let still = |output: &&Output| output.p[1].is_empty() && output.p[2].is_empty();
    let largest = |row: &[(CoordinateId, Number)]| {
        row.iter().map(|(i, factor)| (factor.to_f64() * shape[i.index()].0).abs()).fold(0.0, f64::max)
    };
    let seen = |output: &Output| {
        let row = &output.p[0];
        let sum: f64 = row.iter().map(|(i, factor)| factor.to_f64() * shape[i.index()].0).sum();
        // A sum that cancels down to the rounding of its parts is no motion.
        let value = if sum.abs() <= NOTHING * largest(row) { 0.0 } else { sum };
        (system.display(output.name), output.unit.clone(), Unproven(value))
    };
    system.outputs.iter().filter(still).map(seen).collect()
}

/// Every entry of the shapes of the modes that are listed.
fn whole_shapes<'a>(answer: &'a ModalAnswer, options: &'a Options) -> impl Iterator<Item = Table> + 'a {
    let shapes: Vec<(usize, Vec<Unproven>)> = (answer.modes.with_numbers().take(MOST))
        .map(|(number, mode)| (number, normalise(mode, options.normalise)))
        .collect();
    let tables = shapes.chunks(BESIDE).map(|some| {
        let mut table = Table::of([("shapes", Align::Left), ("", Align::Left)]);
        for (number, _) in some {
            table = table.column(line!["mode ", *number], "", Align::Point);
        }
        let hidden = answer.system.n() > MOST_COLUMNS;
        for (place, of) in answer.system.coordinates.iter().enumerate().filter(|_| hidden) {
            let unit = if unit(of.kind) == "m" { "[m]" } else { "[rad]" };
            let entries = some.iter().map(|(_, shape)| {
                let largest = shape.iter().fold(0.0, |largest: f64, entry| largest.max(entry.0.abs()));
                Cell::from(displacement(shape[place], largest))
            });
            let name = [coordinate(&answer.system, of).into(), unit.into()];
            table.row(name.into_iter().chain(entries).collect());
        }
        let seen: Vec<_> = some.iter().map(|(_, shape)| at_outputs(&answer.system, shape)).collect();
        for (place, (name, unit, _)) in seen.first().into_iter().flatten().enumerate() {
            let entries = seen.iter().map(|values| {
                let value = values[place].2;
                Cell::from(displacement(value, 0.0))
            });
            let name: [Cell; 2] = [name.clone().into(), format!("[{unit}]").into()];
            table.row(name.into_iter().chain(entries).collect());
        }
        table
    });
    tables.collect::<Vec<_>>().into_iter()
}

/// The points of turning bodies that stay in place, if they were asked for and there are any.
fn nodes(answer: &ModalAnswer) -> Vec<Block> {
    let mut table = Table::of([("mode", Align::Right), ("body", Align::Left)])
        .column("x", "[m]", Align::Point)
        .column("y", "[m]", Align::Point)
        .column("", "", Align::Left);
    let mut found = false;
    for ((number, _), nodes) in answer.modes.with_numbers().zip(&answer.nodes).take(MOST) {
        for ShapeNode { body, at, from_centre, .. } in nodes {
            let [x, y] = at.map(|place| Cell::from(displacement(place, 0.0)));
            let origin = if *from_centre { "from its centre" } else { "" };
            table.row(vec![number.into(), answer.system.words.display(*body).into(), x, y, origin.into()]);
            found = true;
        }
    }
    let caption = "nodes: the points about which bodies turn, at rest";
    if found { vec![Block::Line(caption.into()), table.into()] } else { Vec::new() }
}

/// Number, f, omega, T and the bound; for a divergence, its growth rate in place of omega.
fn frequency_cells(number: usize, mode: &Mode, options: &Options) -> Vec<Cell> {
    let ball = |value, usual| Figure::ball(value, options.digits(usual));
    let (f, omega) = (mode.frequency().map(|f| ball(f, DIGITS)), ball(mode.omega, DIGITS));
    // Digits beyond binary64 come from the enclosures, and so do the bounds beside them.
    let bound = if options.digits.is_some() { mode.enclosure_bound() } else { mode.error_bound() };
    let bound = Cell::from(Figure::bound(bound));
    let period = mode.period().map(|period| ball(period, SHAPE_DIGITS));
    let [f, omega, period, bound] = match mode.kind {
        ModeKind::Oscillation => [f.into(), omega.into(), period.into(), bound],
        ModeKind::Rigid => ["0".into(), "0".into(), "rigid".into(), Figure::exact().into()],
        ModeKind::Divergence => [Cell::default(), line![omega, "i"].into(), "unstable".into(), bound],
        ModeKind::Undetermined => [
            Cell::default(),
            omega.into(),
            "undetermined".into(),
            if options.digits.is_some() { bound } else { "?".into() },
        ],
    };
    vec![number.into(), f, omega, period, bound]
}

/// Entries below this share of the largest are rounding errors, not motion (docs/method/report.md#numbers).
const NOTHING: f64 = 1e-12;

/// An entry of a shape. Shapes have no bound: binary64 gives them to more digits than are shown.
fn displacement(entry: Unproven, largest: f64) -> Figure {
    let number = if entry.0.abs() <= NOTHING * largest { Unproven(0.0) } else { entry };
    Figure::of(Value::Unproven { number, digits: SHAPE_DIGITS })
}

fn largest_entries(system: &LinearSystem, shape: &[Unproven]) -> Cell {
    let moving = (0..shape.len()).filter(|i| shape[*i].0 != 0.0);
    let order = first_by(moving, LARGEST, |a, b| shape[*b].0.abs().total_cmp(&shape[*a].0.abs()));
    let largest = order.first().map_or(0.0, |i| shape[*i].0.abs());
    let entry = |i: &usize| {
        let name = coordinate(system, &system.coordinates[*i]);
        line![name, "\u{a0}", displacement(shape[*i], largest)]
    };
    Cell::wordings((1..=order.len()).rev().map(|count| enumeration(order.iter().take(count).map(entry))))
}

/// The modes that the table leaves out.
fn omitted_line(answer: &ModalAnswer) -> Option<Line> {
    let list = &answer.modes.list;
    let highest = list.last().filter(|_| list.len() > MOST)?;
    let highest = Figure::ball(derived::hertz(highest.omega), 4).unit("Hz");
    Some(line!["... and ", list.len() - MOST, " more modes, up to ", highest, " (--format json has all)"])
}

/// The modes that were not requested, or not computed because there are too many.
fn left_out(answer: &ModalAnswer) -> Option<Line> {
    let (below, above) = (answer.modes.before.count(), answer.modes.after);
    let modes = |count| count_of(count, "mode", "modes");
    let which = match (below, above) {
        (0, 0) => return None,
        (0, above) => line![modes(above), " above"],
        (below, 0) => line![modes(below), " below"],
        (below, above) => line![modes(below), " below and ", above, " above"],
    };
    let empty = if answer.modes.list.is_empty() { "no undamped mode is in the band; " } else { "" };
    Some(line![empty, "not computed: ", which, " (use --modes N or --band FROM..TO for others)"])
}

/// Close frequencies: their difference keeps the digits that cancel in the two numbers. Where not one digit of it is
/// certain, what is proved is that they differ, and by how much at most.
fn beats<'a>(answer: &'a ModalAnswer, options: &Options) -> impl Iterator<Item = Line> + use<'a> {
    let digits = options.digits(DIGITS);
    let shown = answer.modes.before.count() + MOST;
    let beat = move |split: Split| {
        let both = range(split.lower, split.lower + 1);
        let apart = Figure::ball(split.omega, digits).unit("rad/s");
        if apart.is_bound() {
            let most = Figure::bound(split.largest()).unit("rad/s");
            return line!["modes ", both, " differ, by at most ", most];
        }
        line![
            "modes ",
            both,
            " are ",
            apart,
            " apart (error ",
            super::error(split.error_bound()),
            "): a beat of ",
            Figure::ball(split.beat(), SHAPE_DIGITS).unit("s")
        ]
    };
    splits(&answer.modes).into_iter().filter(move |split| split.lower < shown).map(beat)
}

/// Modes that are certified only together.
fn clusters(answer: &ModalAnswer) -> Vec<Line> {
    let (list, below) = (&answer.modes.list, answer.modes.before.count());
    let mut lines = Vec::new();
    let mut seen = None;
    for (first, mode) in list.iter().enumerate().filter(|(_, mode)| mode.cluster.is_some()) {
        let members: Vec<usize> = (first..list.len()).filter(|i| list[*i].cluster == mode.cluster).collect();
        if seen == mode.cluster {
            continue;
        }
        seen = mode.cluster;
        // Without bounds they are members of one cluster as far as is known, and no more.
        let unknown = members.iter().any(|i| !list[*i].omega.is_finite());
        lines.push(match members[..] {
            [first, .., last] if unknown => line![
                "modes ",
                range(below + first + 1, below + last + 1),
                ": no bound of their frequencies is known, and nothing is proved of their shapes"
            ],
            [first, .., last] => line![
                "modes ",
                range(below + first + 1, below + last + 1),
                ": one repeated frequency or a tight cluster; only the span of their shapes is determined"
            ],
            _ => {
                line![
                    "mode ",
                    below + first + 1,
                    ": part of a repeated frequency or a tight cluster that continues above"
                ]
            }
        });
    }
    lines
}

/// `2 and 3`, `2 to 5`
fn range(first: usize, last: usize) -> Line {
    line![first, if last == first + 1 { " and " } else { " to " }, last]
}

/// Frequencies that the model's numbers determine less accurately than they are computed.
fn sensitive_lines(answer: &ModalAnswer) -> impl Iterator<Item = Line> {
    const WORTH_TELLING: f64 = 100.0;
    let factors = answer.modes.with_numbers().filter_map(|(number, mode)| Some((number, mode.input_condition?)));
    factors.filter(|(_, factor)| factor.0 >= WORTH_TELLING).take(MOST).map(|(number, factor)| {
        line![
            "mode ",
            number,
            " is sensitive: its ω changes by about ",
            Figure::of(Value::Unproven { number: factor, digits: 1 }),
            " times the relative change of masses, stiffnesses and tensions"
        ]
    })
}

/// A description of each mode: the bodies that move in it, and the elements that restrain it.
pub fn split_lines(answer: &ModalAnswer) -> Section {
    const HEADING: &str = "Which mode is which";
    if answer.system.n() < 2 || answer.modes.list.is_empty() {
        return Section::new(HEADING, []);
    }
    let system = &answer.system;
    let mut table = Table::of([
        ("mode", Align::Right),
        ("moves (share of kinetic energy)", Align::Left),
        ("is held by (share of strain energy)", Align::Left),
    ]);
    for (number, mode) in answer.modes.with_numbers().take(MOST) {
        let held = match mode.kind {
            ModeKind::Rigid => "nothing".into(),
            _ => largest_shares(system, &by_name(&mode.strain)),
        };
        table.row(vec![number.into(), largest_shares(system, &mode.kinetic), held]);
    }
    Section::new(HEADING, [Block::Line("which mode is which".into()), table.into()])
}

/// `mode 3 (rod 74 %, block 26 %)`
pub fn mode_named(system: &LinearSystem, number: usize, mode: &Mode) -> Line {
    line!["mode ", number, " (", carried_by(system, mode), ")"]
}
