//! The damped motion: each pole, a complex pair once.

use super::super::ReportOptions;
use super::super::decimal::{certain, upper};
use super::modes::MOST;
use super::table::{Align, Table};
use super::{INDENT, counted, line};
use crate::analysis::{Pole, Route, Stability};
use crate::answers::ModalAnswer;

const DIGITS: usize = 6;
const FEW: usize = 4;

pub fn text(answer: &ModalAnswer, options: &ReportOptions) -> String {
    if answer.poles.list.is_empty() && !answer.system.c.is_empty() {
        return left_out(answer);
    }
    // A damping ratio of all modes of a large system is in no C.
    let by_modes = answer.poles.list.iter().any(|pole| pole.route == Route::Decoupled);
    if answer.system.c.is_empty() && !by_modes {
        let poles = if answer.stability == Stability::Unstable {
            "±iω of its mode, or ± its growth"
        } else {
            "±iω of its mode"
        };
        return line(format!("damped motion: nothing damps; every pole is {poles}"));
    }
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
    let shown: Vec<(usize, &Pole)> = answer.motions().collect();
    for (number, pole) in shown.iter().take(MOST) {
        let mut cells = cells(*number, pole, options);
        super::modes::bound_only_if(answer.rest.is_proven(), &mut cells, BOUND);
        table.row(cells);
    }
    let left = shown.len().saturating_sub(MOST);
    let more = if left > 0 { line(format!("... and {left} more (--format json has all)")) } else { String::new() };
    line("damped motion")
        + &table.text(INDENT)
        + &more
        + &clusters(&shown)
        + &infinite(answer)
        + &not_proved(answer)
        + &left_out(answer)
}

/// Poles that are equal or are certified only together.
fn clusters(shown: &[(usize, &Pole)]) -> String {
    let mut text = String::new();
    let mut told = Vec::new();
    for (_, pole) in shown.iter().take(MOST) {
        let Some(cluster) = pole.cluster.filter(|cluster| !told.contains(cluster)) else { continue };
        told.push(cluster);
        let members: Vec<String> =
            shown.iter().filter(|(_, other)| other.cluster == Some(cluster)).map(|(n, _)| n.to_string()).collect();
        let members = members.join(", ");
        text += &line(match (members.contains(','), pole.defective) {
            (false, _) => format!("pole {members}: not told from its conjugate; certified together"),
            (true, true) => {
                format!(
                    "poles {members}: one pole with a single shape, exactly: critical damping, the motion has t·exp(re s·t)"
                )
            }
            (true, false) => format!("poles {members}: one repeated pole or a tight cluster; certified together"),
        });
    }
    text
}

/// Poles that were not computed.
fn left_out(answer: &ModalAnswer) -> String {
    match (answer.poles.left_out, answer.poles.list.is_empty()) {
        (0, _) => String::new(),
        (count, false) if answer.poles.followed => line(format!(
            "not computed: {}; each of these was followed from its mode, and another one may lie between them",
            counted(count, "pole")
        )),
        (count, false) => line(format!("not computed: {} of other modes", counted(count, "pole"))),
        (count, true) => line(format!(
            "not computed: {}; this damping joins the modes, and poles are followed from the lowest ones alone",
            counted(count, "pole")
        )),
    }
}

/// What follows without inertia has no pole of its own.
fn infinite(answer: &ModalAnswer) -> String {
    match answer.poles.infinite().unwrap_or(0) {
        0 => String::new(),
        1 => line("one pole is infinite: a motion without inertia follows the others"),
        count => line(format!("{count} poles are infinite: motions without inertia follow the others")),
    }
}

/// That the list has them all is a claim of its own.
fn not_proved(answer: &ModalAnswer) -> String {
    if !answer.poles.is_uncounted() {
        return String::new();
    }
    let is_bounded = |pole: &Pole| pole.re.rad.is_finite() && pole.im.rad.is_finite();
    let unbounded = answer.motions().filter(|(_, pole)| !is_bounded(pole)).count();
    let why = match unbounded {
        0 => String::new(),
        1 => ": 1 has no bound".into(),
        count => format!(": {count} have no bound"),
    };
    line(format!("NOT proved: that these are all poles, and each is there once{why}"))
}

/// The column of the bound in [`cells`].
const BOUND: usize = 7;

fn cells(number: usize, pole: &Pole, options: &ReportOptions) -> Vec<String> {
    let digits = options.digits(DIGITS);
    // Digits beyond binary64 are those of the enclosures: so are the bounds beside them.
    let bound = if options.digits.is_some() { pole.relative_error } else { pole.error_bound() };
    let omega = pole.modulus();
    let complex = pole.is_complex();
    let im = if complex { format!("±{}", certain(&pole.im.abs(), digits)) } else { "0".into() };
    let frequency = if complex { certain(&pole.frequency(), digits) } else { String::new() };
    let half_life = pole.half_life().map_or(String::new(), |cycles| certain(&cycles, FEW));
    vec![
        number.to_string(),
        certain(&pole.re, digits),
        im,
        frequency,
        pole.damping_ratio.as_ref().filter(|_| complex).map_or(String::new(), |zeta| certain(zeta, digits)),
        decay_time(pole),
        half_life,
        if omega.is_zero() { "exact".into() } else { upper(bound) },
        kind(pole),
    ]
}

/// The kind; how fast it grows, where it does.
fn kind(pole: &Pole) -> String {
    let name = pole.kind.name();
    match pole.doubling_time() {
        Some(time) => format!("{name}, doubles in {} s", certain(&time, FEW)),
        None => name.to_string(),
    }
}

/// `never` where nothing decays, nothing where it grows.
fn decay_time(pole: &Pole) -> String {
    match pole.decay_time() {
        Some(time) => certain(&time, FEW),
        None if pole.grows() => String::new(),
        None => "never".into(),
    }
}
