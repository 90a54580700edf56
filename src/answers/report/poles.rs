//! The damped motion: each pole, with a complex pair listed once.

use super::modes::MOST;
use super::table::{Align, Cell, Table};
use super::{Block, Figure, Line, Options, Section, count_of, enumeration, line};
use crate::analysis::{Pole, PoleKind, Route, Stability};
use crate::answers::ModalAnswer;

const DIGITS: usize = 6;
const FEW: usize = 4;

pub fn section(answer: &ModalAnswer, options: &Options) -> Section {
    Section::new("Damped motion", blocks(answer, options))
}

fn blocks(answer: &ModalAnswer, options: &Options) -> Vec<Block> {
    let is_lossy = answer.system.losses.is_some();
    if is_lossy && answer.poles.list.is_empty() {
        return vec![Block::Line(
            "damped motion: the poles with these loss factors are not found; they are for up to 12 coupled coordinates of rational \
             numbers, if none is double and every motion has inertia"
                .into(),
        )];
    }
    let undamped = answer.system.c.is_empty() && !is_lossy;
    if answer.poles.list.is_empty() && !undamped {
        return left_out(answer).map(Block::from).into_iter().collect();
    }
    // For a large system, a damping ratio common to all modes is not in C.
    let by_modes = answer.poles.list.iter().any(|pole| pole.route == Route::Decoupled);
    if undamped && !by_modes {
        let growth = if answer.stability == Stability::Unstable { ", or ± its growth" } else { "" };
        return vec![line!["damped motion: no damping; every pole is ±iω of its mode", growth].into()];
    }
    let shown: Vec<(usize, &Pole)> = answer.motions().collect();
    let mut blocks = vec![Block::Line("damped motion".into()), table(&shown, options).into()];
    let left = shown.len().saturating_sub(MOST);
    let more = (left > 0).then(|| line!["... and ", left, " more (--format json has all)"]);
    let remarks = more.into_iter().chain(clusters(&shown)).chain(infinite(answer)).chain(not_proved(answer));
    blocks.extend(remarks.chain(left_out(answer)).map(Block::from));
    if is_lossy {
        blocks.push(Block::Line("loss factors act with the sign of im s; C and K do not contain them".into()));
    }
    blocks
}

fn table(shown: &[(usize, &Pole)], options: &Options) -> Table {
    let mut table = Table::new()
        .column("pole", "", Align::Right)
        .column("re s", "[1/s]", Align::Point)
        .column("im s", "[rad/s]", Align::Point)
        .column("f", "[Hz]", Align::Point)
        .column("ζ", "", Align::Point)
        .column("decay time", "[s]", Align::Point)
        .column("half-life", "[cycles]", Align::Point)
        .column("error ≤", "", Align::Right)
        .column("kind", "", Align::Left);
    for (number, pole) in shown.iter().take(MOST) {
        table.row(cells(*number, pole, options));
    }
    table
}

/// Poles that are equal, or certified only together.
fn clusters(shown: &[(usize, &Pole)]) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut seen = Vec::new();
    for (_, pole) in shown.iter().take(MOST) {
        let Some(cluster) = pole.cluster.filter(|cluster| !seen.contains(cluster)) else { continue };
        seen.push(cluster);
        let members: Vec<usize> =
            shown.iter().filter(|(_, other)| other.cluster == Some(cluster)).map(|(number, _)| *number).collect();
        let numbers = enumeration(members.iter().map(|number| Line::from(*number)));
        lines.push(match (members.len() > 1, pole.defective) {
            (false, _) => line!["pole ", numbers, ": not separated from its conjugate; certified together"],
            (true, true) if members.len() == 2 => line![
                "poles ",
                numbers,
                ": one pole with a single shape, exactly: critical damping, the motion has t·exp(re s·t)"
            ],
            (true, true) => line![
                "poles ",
                numbers,
                ": one pole with fewer shapes than its multiplicity, exactly: the motion has t·exp(re s·t)"
            ],
            (true, false) => {
                line!["poles ", numbers, ": one repeated pole or a tight cluster; certified together"]
            }
        });
    }
    lines
}

/// Poles that were not computed.
fn left_out(answer: &ModalAnswer) -> Option<Line> {
    let poles = match answer.poles.left_out {
        0 => return None,
        count => count_of(count, "pole", "poles"),
    };
    Some(match (answer.poles.list.is_empty(), answer.poles.followed) {
        (true, _) => line![
            "not computed: ",
            poles,
            "; this damping couples the modes, and poles are only followed from the lowest ones"
        ],
        (false, true) => line![
            "not computed: ",
            poles,
            "; each of these was followed from its mode, and there may be others between them"
        ],
        (false, false) => line!["not computed: ", poles, " of other modes"],
    })
}

/// Motions without inertia have no finite pole.
fn infinite(answer: &ModalAnswer) -> Option<Line> {
    match answer.poles.infinite().unwrap_or(0) {
        0 => None,
        1 => Some("one pole is infinite: a motion without inertia follows the others".into()),
        count => Some(line![count, " poles are infinite: motions without inertia follow the others"]),
    }
}

/// The completeness of the list is a separate claim.
fn not_proved(answer: &ModalAnswer) -> Option<Line> {
    if !answer.poles.is_uncounted() {
        return None;
    }
    let is_bounded = |pole: &Pole| pole.re.rad.is_finite() && pole.im.rad.is_finite();
    let why = match answer.motions().filter(|(_, pole)| !is_bounded(pole)).count() {
        0 => Line::default(),
        1 => ": 1 has no bound".into(),
        count => line![": ", count, " have no bound"],
    };
    Some(line!["NOT proved: that these are all poles, and each is there once", why])
}

fn cells(number: usize, pole: &Pole, options: &Options) -> Vec<Cell> {
    let digits = options.digits(DIGITS);
    let figure = |value| Figure::ball(value, digits);
    let few = |value| Figure::ball(value, FEW);
    // Digits beyond binary64 come from the enclosures, and so do the bounds beside them.
    let bound = if options.digits.is_some() { pole.enclosure_bound() } else { pole.error_bound() };
    let complex = pole.is_complex();
    let decay = match pole.decay_time() {
        Some(time) => few(time).into(),
        None if pole.grows() => Cell::default(),
        None => "never".into(),
    };
    vec![
        number.into(),
        figure(pole.re).into(),
        if complex { line!["±", figure(pole.im.abs())].into() } else { "0".into() },
        complex.then(|| figure(pole.frequency())).into(),
        pole.damping_ratio.filter(|_| complex).map(figure).into(),
        decay,
        pole.half_life().map(few).into(),
        if pole.modulus().is_zero() { Figure::exact().into() } else { Figure::bound(bound).into() },
        kind(pole).into(),
    ]
}

/// The kind of a pole and, if it grows, how fast.
fn kind(pole: &Pole) -> Line {
    match pole.doubling_time() {
        Some(time) => line![pole.kind.name(), ", doubles in ", Figure::ball(time, FEW).unit("s")],
        // A real pole whose motions have t exp(s t) lies between the two kinds.
        None if pole.kind == PoleKind::Overdamped && pole.defective => "critical".into(),
        None => pole.kind.name().into(),
    }
}
