//! Studies: a model at many values of its parameters. In: the texts, the values, what is asked. Out: a [`Study`], whose cases are
//! computed in any order, on all cores. See docs/method/studies.md.

use crate::Outcome;
use crate::base::{Angle, Dimension, FileId, Number, Sources};
use crate::kernel::cores;
use crate::kernel::sobol;
use crate::model::scene::Parameter;
use crate::model::{self, Overrides};
use crate::questions::answer::Case;
use crate::questions::cases::{Asked, Study, Varied};
use crate::questions::follow::{MOST_COORDINATES, MOST_POINTS, Unfollowed};
use crate::questions::rows::Rows;
pub use crate::questions::samples::Draws;
use crate::questions::samples::Samples;
use crate::reading::{self, Reading};
use crate::syntax;

/// The cases of a study and the answers computed for each.
#[derive(Clone, Debug)]
pub struct StudyRequest {
    /// A file with a line for each parameter and its values: `k=5N/m..50N/m:200`, `m=1kg,2kg`.
    pub over: FileId,
    /// Random values in place of these.
    pub samples: Option<Draws>,
    /// A file with a measure a line, written as in a model: `gain(F -> x, 3 Hz)`.
    pub measures: Option<FileId>,
    /// The number of lowest modes; `None` for the usual six if nothing else is asked for.
    pub modes: Option<u32>,
    /// Modes are curves along the one parameter, not numbers in an order.
    pub follow: bool,
    /// Orders of the parameter that are compared with the curves.
    pub orders: Vec<u32>,
    pub poles: bool,
    /// Parameters that the model determines keep the values that it gives them as declared.
    pub hold_solved: bool,
    /// Simulated time for `peak` and `rms`, s.
    pub until: Option<Number>,
    /// A relative bound that is good enough for a frequency; `None` for the usual one.
    pub tolerance: Option<f64>,
}

impl StudyRequest {
    /// The name of each parameter of a model, with a unit whose values are those in SI; empty for a plain number.
    pub fn units(sources: &Sources, model: FileId, overrides: &Overrides) -> Vec<(String, String)> {
        let tree = syntax::parse(sources, model).tree;
        let unit = |parameter: Parameter| {
            let (of, value) = (&parameter.unit, &parameter.value);
            let text = match value.angle {
                _ if of.factor.as_ref().is_some_and(Number::is_one) => of.text.clone(),
                Angle::Radians if value.dimension == Dimension::FREQUENCY => "rad/s".into(),
                _ => value.dimension.usual_unit(),
            };
            (parameter.name, text)
        };
        model::parameters(sources, &tree, overrides, &[]).into_iter().map(unit).collect()
    }
}

/// The modes of a study that asks for nothing.
const USUAL_MODES: u32 = 6;

/// The relative bound of a frequency that is good enough if no other is asked for.
const USUAL_TOLERANCE: f64 = 1e-10;

const NOTHING_RANDOM: &str = "no parameter of the model is random: write `spread 3 %` or `within 5 %` after its value";

/// Prepares a study; the inner error says why there is none.
pub fn study<'a>(
    sources: &'a Sources,
    model: FileId,
    overrides: &'a Overrides,
    request: StudyRequest,
) -> Outcome<Result<(String, Study<'a>), String>> {
    Outcome::of(|diagnostics| {
        let mut measures = Ok(());
        let found = reading::read_and_check_swept(sources, model, overrides, diagnostics, |tree| {
            if let Some(file) = request.measures {
                measures = syntax::parse_asked(tree, sources, file);
            }
            model::check_swept(sources, tree, overrides, request.over)
        });
        if let Err(span) = measures {
            let text = sources.slice(span);
            return Some(Err(format!("`{text}` is no measure: write one as in a model, such as `gain(F -> x, 3 Hz)`")));
        }
        let (tree, scene, swept) = found?;
        let scene = scene?;
        if let Some(twice) =
            (1..swept.len()).find(|&i| (0..i).any(|j| swept[j].parameter.name == swept[i].parameter.name))
        {
            return Some(Err(format!("`--over` gives values for `{}` twice", swept[twice].parameter.name)));
        }
        let asks = request.poles || !scene.scene().requires.is_empty() || !scene.scene().asked.is_empty();
        let modes = request.modes.unwrap_or(if asks && !request.follow { 0 } else { USUAL_MODES }) as usize;
        let mut reading = Reading::read_declared(sources, overrides, tree, scene.clone());
        let hold_solved = request.hold_solved || request.samples.is_some();
        if hold_solved {
            reading.settle(diagnostics)?;
        }
        let asked = Asked {
            modes,
            poles: request.poles,
            hold_solved,
            until: request.until,
            tolerance: request.tolerance.unwrap_or(USUAL_TOLERANCE),
        };
        let (name, held) = (reading.name(), std::mem::take(&mut reading.settings));
        let varied = match request.samples {
            None => Varied::Over(swept),
            Some(draws) => Varied::Drawn(Samples::of(scene.scene(), &held, draws)),
        };
        if let Varied::Drawn(samples) = &varied
            && samples.tolerances.is_empty()
        {
            return Some(Err(NOTHING_RANDOM.into()));
        }
        if let Varied::Drawn(samples) = &varied
            && samples.draws.sobol
            && samples.tolerances.len() > sobol::DIMENSIONS
        {
            return Some(Err(format!(
                "`--sobol` fills the ranges of at most {} random parameters, and the model has {}: leave it out",
                sobol::DIMENSIONS,
                samples.tolerances.len()
            )));
        }
        let mut study = Study::new((sources, reading.tree, overrides), &scene, varied, held, asked);
        if request.follow
            && let Err(why) = study.follow(&request.orders)
        {
            return Some(Err(unfollowed_message(&why)));
        }
        Some(Ok((name, study)))
    })
}

/// The reason why modes cannot be followed, as a message that says what to write instead.
fn unfollowed_message(why: &Unfollowed) -> String {
    match why {
        Unfollowed::NotInOrder => "`--follow` takes values in ascending or descending order".into(),
        Unfollowed::TooManyPoints(count) => format!("`--follow` takes at most {MOST_POINTS} values, and these are {count}"),
        Unfollowed::TooManyCoordinates(n) => {
            format!("`--follow` takes models of at most {MOST_COORDINATES} coordinates, and this one has {n}")
        }
        Unfollowed::Determined => {
            "`--follow` follows the modes of one model: add `--hold-solved`, since this one determines parameters itself".into()
        }
        Unfollowed::NoRate => {
            "`--orders` are multiples of a rate of rotation: give values in rpm, rad/s or Hz of such a parameter".into()
        }
        Unfollowed::NoModes => {
            "`--follow` finds no modes: no case has a proven rest and undamped modes (`vibc analyze --set ...` says why)".into()
        }
    }
}

/// Applies `make` to the rows of these cases on all cores; the results in order.
pub fn cases<T: Send>(study: &Study, numbers: &[u64], make: impl Fn(Case) -> T + Sync) -> Vec<T> {
    let of_some = |rows: &Rows| {
        let mut made = Vec::with_capacity(rows.len());
        rows.for_each(|case| made.push(make(case.clone())));
        made
    };
    some_rows(study, numbers, of_some).into_iter().flatten().collect()
}

/// Applies `make` to the rows of these cases, some at a time, on all cores; the results in order.
pub fn some_rows<T: Send>(study: &Study, numbers: &[u64], make: impl Fn(&Rows) -> T + Sync) -> Vec<T> {
    cores::in_pieces(numbers, 1, 1, |piece| {
        // The same memory for all, so that the system need not make room again.
        let mut rows = Rows::default();
        let made = piece.chunks(AT_ONCE).map(|numbers| {
            study.rows(numbers, &mut rows);
            make(&rows)
        });
        made.collect()
    })
}

/// Rows that are computed at once: few enough for the nearest memory, many enough that what they share costs little.
const AT_ONCE: usize = 1024;
