//! Errors that lowering finds in a scene: facts, and the diagnostics for them.

use super::constraints::{Elsewhere, Why};
use super::kinematics::Unreleased;
use super::reactions::Open;
use crate::base::{Code, Diagnostic, Span};
use crate::model::TABLE_UNREADABLE;
use crate::model::scene::{BodyId, Scene};

/// An unbalance without a speed, when a motion in time is asked for.
pub const SPEED_MISSING: Code = Code::model("vib::unbalance::speed");
/// Bodies without a freedom clause that no joint connects to the ground.
pub const LOOSE: Code = Code::model("vib::freedom::loose");
/// Nothing in the scene can move.
pub const NO_FREEDOM: Code = Code::model("vib::freedom::none");
/// A degree of freedom without mass, stiffness or damping.
pub const NO_INERTIA: Code = Code::model("vib::freedom::no_inertia");
/// A body turns about a point whose place is unknown.
pub const UNKNOWN_PLACE: Code = Code::model("vib::position::unknown");
/// Joints and couplings that lock each other.
pub const CONFLICT: Code = Code::model("vib::loop::conflict");
/// A position in which joints leave more motions than in neighbouring positions.
pub const RANK_DROP: Code = Code::model("vib::loop::rank_drop");
/// A joint or a coupling that follows from others.
pub const REDUNDANT: Code = Code::model("vib::loop::redundant");
/// More row entries than fit into memory.
pub const TOO_DEEP: Code = Code::limit("vib::limit::depth");
/// More rows of tables than fit into memory.
const TOO_MANY_ROWS: Code = Code::limit("vib::limit::values");
/// Too many coordinates in closed loops to search for a rest.
pub const LARGE_LOOP: Code = Code::limit("vib::limit::loops");
/// No static rest.
const LAW_UNDEFINED: Code = Code::model("vib::law::undefined");
const LAW_KINK: Code = Code::model("vib::law::kink");
pub const NO_REST: Code = Code::limit("vib::rest::not_found");
/// A rest that is not proven.
pub const UNPROVEN: Code = Code::limit("vib::rest::unproven");
/// A drawing that is declared to be the rest but cannot be.
pub const UNHELD: Code = Code::model("vib::rest::unbalanced");
/// A reaction that the scene does not determine.
pub const REACTION: Code = Code::model("vib::reaction::undetermined");
/// A reaction that damping by modes takes part in.
pub const REACTION_DAMPED: Code = Code::limit("vib::reaction::damped");
/// Initial motions that contradict each other or are incomplete.
pub const INITIAL: Code = Code::model("vib::initial::undetermined");

/// At most this many places are shown in addition to the primary one.
const SHOWN: usize = 6;

#[derive(Clone, Debug, PartialEq)]
pub enum LowerError {
    /// A law that has no value or no slope at a stretch, m or rad, that the rest needs.
    LawUndefined {
        span: Span,
        why: &'static str,
        element: String,
        stretch: f64,
        turns: bool,
    },
    /// A law whose slope jumps at the stretch at rest.
    LawKink {
        span: Span,
        element: String,
        stretch: f64,
        turns: bool,
    },
    /// Bodies that joints connect to each other and to nothing else.
    Loose {
        names: Vec<String>,
        spans: Vec<Span>,
    },
    NoFreedom {
        span: Span,
    },
    NoInertia {
        coordinate: String,
        body: String,
        span: Span,
        turns: bool,
    },
    UnknownPlace {
        body: String,
        span: Span,
        used: Span,
    },
    /// Joints and couplings that do not go together, the one that closes the loop first.
    Loop {
        joints: Vec<(String, Span)>,
        why: Why,
    },
    TableUnread {
        span: Span,
    },
    /// The tables of all inputs together have so many rows, those of delayed inputs included.
    TooManyRows {
        span: Span,
        rows: usize,
        limit: usize,
    },
    SpeedMissing {
        span: Span,
    },
    TooDeep {
        entries: u64,
        span: Span,
    },
    /// Closed loops and couplings that take more than `limit` numbers to solve, or to explain which follow from others.
    TangledLoops {
        limit: usize,
        span: Span,
    },
    /// More coordinates in closed loops than a rest is searched for.
    LargeLoop {
        coordinates: usize,
        span: Span,
    },
    NoRest {
        span: Span,
        left: Vec<Unbalanced>,
        reason: NoRestReason,
        /// The springs on these bodies, if all of them have laws.
        laws: Vec<String>,
    },
    /// `rest as drawn`, but no tensions of springs balance these forces; `given` is the place of a spring whose tension
    /// is given.
    Unheld {
        declared: Span,
        left: Vec<Unbalanced>,
        given: Option<Span>,
    },
    /// A reaction without a value.
    Reaction {
        name: String,
        holder: Span,
        span: Span,
        why: Open,
    },
    Initial {
        span: Span,
        message: String,
        help: &'static str,
    },
}

/// A coordinate with an unbalanced force.
#[derive(Clone, Debug, PartialEq)]
pub struct Unbalanced {
    pub coordinate: String,
    pub span: Span,
    /// N or N m.
    pub force: f64,
    pub turns: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRestReason {
    /// The energy decreases without limit along a motion that nothing restrains.
    Falls,
    /// The iteration did not converge within its number of steps.
    NotSettled,
}

impl LowerError {
    pub fn loose_bodies(scene: &Scene, bodies: &[BodyId]) -> LowerError {
        let body = |id: &BodyId| &scene.bodies[id.index()];
        LowerError::Loose {
            names: bodies.iter().take(SHOWN).map(|id| scene.words.display(body(id).name)).collect(),
            spans: bodies.iter().take(SHOWN).map(|id| body(id).span).collect(),
        }
    }

    pub fn to_diagnostic(&self) -> Diagnostic {
        match self {
            LowerError::Loose { names, spans } => loose_error(names, spans),
            LowerError::NoFreedom { span } => Diagnostic::error(NO_FREEDOM, *span, "nothing in this scene can move")
                .label("no body here has a degree of freedom")
                .help("give a body a freedom clause, such as `moves x`, or hang it on a pivot")
                .fix_by_field(*span, &["moves x", "moves y", "free"]),
            LowerError::NoInertia { coordinate, body, span, turns } => no_inertia(coordinate, body, *span, *turns),
            LowerError::UnknownPlace { body, span, used } => {
                Diagnostic::error(UNKNOWN_PLACE, *used, format!("`{body}` turns, but about which point is not known"))
                    .label("the motion of this point depends on it")
                    .with_related(*span, "declared here, without a place")
                    .help(format!("give `{body}` a place: `at = (0, 0)`"))
                    .fix_by_field(*span, &["at = (0, 0)"])
            }
            LowerError::Loop { joints, why } => closed_loop(joints, *why),
            LowerError::TableUnread { span } => Diagnostic::error(TABLE_UNREADABLE, *span, "this table was not read")
                .help("name fewer different tables in one model"),
            LowerError::TooManyRows { span, rows, limit } => {
                let message = format!(
                    "the tables that drive all inputs have {rows} rows, counted anew for each delayed input; the limit is {limit}"
                );
                Diagnostic::error(TOO_MANY_ROWS, *span, message)
                    .help("leave out rows of the table, or inputs that delay it")
            }
            LowerError::SpeedMissing { span } => {
                Diagnostic::error(SPEED_MISSING, *span, "a motion in time needs the speed of this unbalance")
                    .help("write it in the braces, as in `speed = 3000 rpm`")
            }
            LowerError::TooDeep { entries, span } => Diagnostic::error(
                TOO_DEEP,
                *span,
                format!("the links of this scene hang so deep that its matrices would have {entries} entries"),
            )
            .label("bodies hang one under another down to here")
            .help("use fewer links, or let bodies move on the ground with a freedom clause"),
            LowerError::TangledLoops { limit, span } => Diagnostic::error(
                LARGE_LOOP,
                *span,
                format!("the equations of the closed loops and couplings up to here have more than {limit} entries"),
            )
            .label("this connects parts that are already connected")
            .help("use fewer of them, or leave out those that follow from the others"),
            LowerError::LargeLoop { coordinates, span } => Diagnostic::error(
                LARGE_LOOP,
                *span,
                format!("closed loops couple {coordinates} coordinates: too many to search for their rest"),
            )
            .label("the first of the joints that close a loop there")
            .help("use fewer links, draw the scene at its rest, or remove the load"),
            LowerError::LawUndefined { span, why, element, stretch, turns } => {
                let stretch = law_stretch(*stretch, *turns);
                let message =
                    format!("the law of `{element}` is not defined at a stretch of {stretch}, which its rest needs");
                Diagnostic::error(LAW_UNDEFINED, *span, message)
                    .label(*why)
                    .help("write a law that is defined there, or draw the scene nearer to its rest")
            }
            LowerError::LawKink { span, element, stretch, turns } => {
                let stretch = law_stretch(*stretch, *turns);
                let message = format!("the law of `{element}` has a kink where it rests, at a stretch of {stretch}");
                Diagnostic::error(LAW_KINK, *span, message)
                    .label("its slope jumps here, so motions about the rest have no tangent")
                    .help("let a load or a `free_length` put the rest on one side of the kink, or write a law that is smooth there")
            }
            LowerError::NoRest { span, left, reason, laws } => no_rest_error(*span, left, *reason, laws),
            LowerError::Unheld { declared, left, given } => unheld_error(*declared, left, *given),
            LowerError::Reaction { name, holder, span, why } => reaction_error(name, *holder, *span, why),
            LowerError::Initial { span, message, help } => {
                Diagnostic::error(INITIAL, *span, message.clone()).help(*help)
            }
        }
    }
}

fn loose_error(names: &[String], spans: &[Span]) -> Diagnostic {
    let message = match names {
        [one] => format!("nothing holds `{one}`: it has no freedom clause, and no joint connects it to the ground"),
        many => format!("nothing holds {}: no joint connects them to the ground", enumeration(many)),
    };
    let mut diagnostic = Diagnostic::error(LOOSE, spans[0], message).label("held by nothing");
    for span in &spans[1..] {
        diagnostic = diagnostic.with_related(*span, "and this one with it");
    }
    diagnostic.help(format!(
        "say how it moves on the ground: `free`, `moves x`, `turns`, or connect it to the ground: `pivot p: ground@(0, 0) -- {}`",
        names[0]
    ))
    .fix_by_field(spans[0], &["free", "moves x", "moves y", "turns"])
}

fn no_inertia(coordinate: &str, body: &str, span: Span, turns: bool) -> Diagnostic {
    let (what, field, stiffness) =
        if turns { ("inertia", "inertia = 0.1 kg*m^2", "10 N*m/rad") } else { ("mass", "mass = 1 kg", "10 N/m") };
    Diagnostic::error(
        NO_INERTIA,
        span,
        format!("`{coordinate}` moves no {what}, and no spring or damper acts on it: its position is undetermined"),
    )
    .label(format!("a degree of freedom needs {what}, stiffness or damping"))
    .help(format!(
        "give `{body}`, or a body that it carries, `{field}`; or hold it: `spring s: ground -- {body} {{ k = {stiffness} }}`"
    ))
    .fix_by_field(span, &[field])
}

fn closed_loop(joints: &[(String, Span)], why: Why) -> Diagnostic {
    let names: Vec<String> = joints.iter().map(|(name, _)| name.clone()).collect();
    let (code, hold) = match why {
        Why::InLine | Why::Branching | Why::Unclear => (RANK_DROP, "part of the loop"),
        Why::Locked | Why::AsDrawn | Why::Opposed | Why::Open | Why::Driven => (CONFLICT, "together with this one"),
    };
    let alone = names.len() == 1;
    let names = enumeration(&names);
    let message = match why {
        Why::Locked if alone => format!("{names} prevents all motion"),
        Why::InLine => {
            format!(
                "all links of the loop of {names} are in line: its degrees of freedom are not determined in this position"
            )
        }
        Why::Branching => {
            format!(
                "the loop of {names} can move in several ways from this position: its degrees of freedom are not determined"
            )
        }
        Why::Unclear => {
            format!("the known digits do not decide whether {names} depend on each other")
        }
        Why::Locked => format!("{names} lock each other: the parts they connect cannot move"),
        Why::AsDrawn => {
            format!("{names} fit each other only as drawn: they lock each other where the parts move further")
        }
        Why::Opposed => format!("{names} contradict each other: only zero motion satisfies them"),
        Why::Open => format!("{names} cannot all be closed where the bases are held"),
        Why::Driven => format!("{names} hold a base whose motion is prescribed"),
    };
    let help = match why {
        Why::InLine | Why::Branching => "draw it in a slightly different position",
        Why::Unclear => "draw it in another position, or leave one of them out",
        Why::Locked if alone => "remove it, or use a joint that allows more motion",
        Why::Locked => "leave one of them out, or draw the links so that they fit each other as they move",
        Why::AsDrawn => {
            "for small motions about this position leave one of them out; or draw the links so that they fit each other as they move"
        }
        Why::Opposed => "leave one of them out, or correct its ratio",
        Why::Open => "hold the bases nearer to where they are drawn",
        Why::Driven => "remove the joint, or give the parts between the base and the ground one more degree of freedom",
    };
    let mut diagnostic = Diagnostic::error(code, joints[0].1, message).label("closes the loop");
    for (_, span) in joints[1..].iter().take(SHOWN) {
        diagnostic = diagnostic.with_related(*span, hold);
    }
    diagnostic.help(help)
}

fn reaction_error(name: &str, holder: Span, span: Span, why: &Open) -> Diagnostic {
    let error = |code, message: String| Diagnostic::error(code, span, message);
    let undetermined = |message, help| {
        error(REACTION, message).label("asked for here").with_related(holder, "by which it is held").help(help)
    };
    match why {
        Open::Unreleased(Unreleased::Redundant) => undetermined(
            format!("the scene does not determine this reaction of `{name}`: other joints hold the same parts"),
            "leave out what holds the parts a second time, or put a spring in its place: rigid parts share a load in no certain way",
        ),
        Open::Unreleased(Unreleased::Unclear) => undetermined(
            format!("the known digits do not decide whether the scene determines this reaction of `{name}`"),
            "draw the scene in another position",
        ),
        Open::Unreleased(Unreleased::NoMass { span: lost }) => {
            error(REACTION, format!("this reaction of `{name}` carries a body whose mass is not given"))
                .label("asked for here")
                .with_related(*lost, "declared here, without a mass")
                .help("give it one: `mass = 1 kg`, or `mass = 0 kg`")
        }
        Open::Unreleased(Unreleased::NoPlace { span: lost }) => {
            error(UNKNOWN_PLACE, format!("a moment of `{name}` needs the places of all parts that it holds"))
                .label("asked for here")
                .with_related(*lost, "its place is not known")
                .help("give it a place: `at = (0, 0)`, or a point after `@`")
        }
        Open::Unreleased(Unreleased::Limit(limit)) => limit.to_diagnostic(),
        Open::Lossy => {
            error(REACTION_DAMPED, format!("what `{name}` carries of a spring with a loss factor is not computed"))
                .label("asked for here")
                .help("write a damper in place of `loss`; `rest(...)` of the reaction needs no damping")
        }
        Open::DampedRelative => error(
            REACTION_DAMPED,
            format!("damping by masses relative to a base does not say which part of its forces `{name}` carries"),
        )
        .label("asked for here")
        .help("declare dampers, or `damping rayleigh(0 /s, ...)`; `rest(...)` of the reaction needs no damping"),
        Open::DampedByModes => {
            error(REACTION_DAMPED, format!("`damping modal` does not say which part of its forces `{name}` carries"))
                .label("asked for here")
                .help("declare dampers, or `damping rayleigh(...)`; `rest(...)` of the reaction needs no damping")
        }
    }
}

/// The note on a redundant joint or coupling, which comes first in the list, with what other positions say about it.
pub fn redundant(joints: &[(String, Span)], said: Elsewhere) -> Diagnostic {
    let others: Vec<String> = joints[1..].iter().map(|(name, _)| name.clone()).collect();
    let (name, span) = &joints[0];
    let message = match others.as_slice() {
        [] => format!("`{name}` connects parts that are already connected"),
        others => format!("`{name}` repeats in part what already follows from {}", enumeration(others)),
    };
    let mut diagnostic = Diagnostic::note(REDUNDANT, *span, message).label("redundant");
    for (_, span) in joints[1..].iter().take(SHOWN) {
        diagnostic = diagnostic.with_related(*span, "with this one");
    }
    let (lost, seen) = match said {
        Elsewhere::Same => ("nothing is lost: motions and frequencies", ""),
        Elsewhere::Holds => ("nothing is lost: motions and frequencies", ", as two other positions show"),
        Elsewhere::Broken | Elsewhere::Unknown => {
            ("small motions and frequencies", "; no other position of these loops was found in which to compare them")
        }
    };
    diagnostic.help(format!("{lost} are the same without it{seen}; the forces in these joints are not determined"))
}

/// The warning about a rest that could not be proven: the coordinate that moved farthest to it, if any moved, and the
/// place of its declaration or another's.
pub fn unproven(moved: Option<&str>, span: Span) -> Diagnostic {
    let (message, label) = match moved {
        Some(name) => {
            let message = "a rest was found but not proven: there may be none here, or several";
            (message, format!("`{name}` moved farthest to it"))
        }
        None => {
            let message =
                "the drawing is in balance as far as its numbers are known, but it is not proven that it rests there";
            (message, "part of the scene that should be at rest there".to_string())
        }
    };
    Diagnostic::warning(UNPROVEN, span, message).label(label).help(
        "results are for the scene linearised here, and have no bounds; draw the scene nearer to its rest, or add a spring \
         to a motion that is hardly restrained",
    )
}

fn no_rest_error(span: Span, left: &[Unbalanced], reason: NoRestReason, laws: &[String]) -> Diagnostic {
    let forces: Vec<String> = left.iter().take(SHOWN).map(Unbalanced::to_phrase).collect();
    let of_laws = || match laws {
        [one] => format!("the law of `{one}`"),
        many => format!("the laws of {}", enumeration(many)),
    };
    let message = match reason {
        _ if !laws.is_empty() => {
            format!(
                "no rest found: {} did not balance the load on {} where tried",
                of_laws(),
                enumeration(&names(left))
            )
        }
        NoRestReason::Falls => format!("no rest: nothing holds {}", enumeration(&names(left))),
        NoRestReason::NotSettled => format!("no rest found: {} did not converge", enumeration(&names(left))),
    };
    let mut diagnostic = Diagnostic::error(NO_REST, left.first().map_or(span, |u| u.span), message)
        .label(format!("force left: {}", forces.join(", ")));
    for unbalanced in left.iter().skip(1).take(SHOWN) {
        diagnostic = diagnostic.with_related(unbalanced.span, format!("{} left on this one", unbalanced.size()));
    }
    diagnostic.help(match reason {
        _ if !laws.is_empty() => "give the law forces as large as the load, or draw the scene nearer to its rest",
        NoRestReason::Falls => "hold it with a spring or a joint, or remove its load",
        NoRestReason::NotSettled => "draw the scene nearer to its rest",
    })
}

fn unheld_error(declared: Span, left: &[Unbalanced], given: Option<Span>) -> Diagnostic {
    let message = format!("no tension of the springs holds {} as drawn", enumeration(&names(left)));
    let forces: Vec<String> = left.iter().take(SHOWN).map(Unbalanced::to_phrase).collect();
    let mut diagnostic = Diagnostic::error(UNHELD, left.first().map_or(declared, |u| u.span), message)
        .label(format!("nothing balances {}", forces.join(", ")))
        .with_related(declared, "the drawing is declared to be the rest here");
    if let Some(given) = given {
        diagnostic = diagnostic.with_related(given, "the tension of this spring is given, so it is not solved for");
    }
    diagnostic.help("draw the scene at its rest, add a spring that can hold it, or remove `rest as drawn`: then the rest is searched for")
}

impl Unbalanced {
    /// `block.y`: -9.81 N
    fn to_phrase(&self) -> String {
        format!("`{}`: {}", self.coordinate, self.size())
    }

    fn size(&self) -> String {
        let unit = if self.turns { "N*m" } else { "N" };
        match self.force {
            force if force.is_finite() => format!("{} {unit}", four_digits(force)),
            _ => format!("more than 1.8e308 {unit}"),
        }
    }
}

/// `12 mm` as `0.012 m`.
fn law_stretch(stretch: f64, turns: bool) -> String {
    format!("{} {}", four_digits(stretch), if turns { "rad" } else { "m" })
}

/// Four digits, without zeros at the end: -9.81, 4905, 1.2e-7.
pub(super) fn four_digits(value: f64) -> String {
    let scientific = format!("{value:.3e}");
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trimmed = |text: &str| match text.split_once('.') {
        Some(_) => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        None => text.to_string(),
    };
    match exponent {
        -3..=6 => trimmed(&format!("{value:.*}", usize::try_from(3 - exponent).unwrap_or(0))),
        _ => format!("{}e{exponent}", trimmed(mantissa)),
    }
}

fn names(left: &[Unbalanced]) -> Vec<String> {
    left.iter().map(|u| u.coordinate.clone()).collect()
}

/// `a`, `b` and `c`.
fn enumeration(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().take(SHOWN).map(|name| format!("`{name}`")).collect();
    let rest = names.len().saturating_sub(SHOWN);
    match (quoted.as_slice(), rest) {
        ([], _) => "it".into(),
        ([one], 0) => one.clone(),
        ([most @ .., last], 0) => format!("{} and {last}", most.join(", ")),
        (all, more) => format!("{} and {more} more", all.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::four_digits;

    #[test]
    fn forces_have_four_digits() {
        let reported: Vec<String> = [-9.81, 4905.0, 0.002, 123456.0, 1.25e-7, -1e30].map(four_digits).into();
        assert_eq!(reported, ["-9.81", "4905", "0.002", "123456", "1.25e-7", "-1e30"]);
    }
}
