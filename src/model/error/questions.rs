//! Errors of motions and measures, and warnings about declarations without effect.

use super::{enumeration, error, kind_noun, name_phrase, with_suggestion};
use crate::base::{Angle, Change, Code, Diagnostic, Dimension, Span};
use crate::kinds::Function;
use crate::kinds::functions::MEASURES;
use crate::model::scope::DefinitionKind;

/// A word of the language.
type Word = &'static str;

/// Errors of questions, and declarations without effect.
#[derive(Clone, Debug, PartialEq)]
pub enum QuestionError {
    NoMotion { span: Span },
    OutputUnit { span: Span, found: (Dimension, Angle), wanted: Dimension, is_angle: bool },
    LevelOfOutput { span: Span },
    CyclesOfOutput { span: Span },
    NonLinear { span: Span },
    PointWithoutMotion { span: Span },
    MotionOfWhat { span: Span },
    UnknownMotion { span: Span, word: String, of: Word, suggestion: Option<Word>, known: Vec<Word> },
    NoSuchFreedom { span: Span, name: String, turns: bool },
    NoSuchReaction { span: Span, name: String, why: &'static str, help: &'static str },
    CoupleOfOthers { span: Span },
    NoInitialState { span: Span, word: String, found: &'static str },
    NotAMeasure { span: Span, suggestion: Option<Word>, form: Option<Word> },
    UnknownMeasure { span: Span, word: String, suggestion: Option<&'static str> },
    MeasureArguments { span: Span, function: &'static Function },
    CauseUnknown { span: Span },
    BandOutOfRange { span: Span },
    ArrowMissing { span: Span },
    NotAnInput { span: Span, found: &'static str },
    NoMotionOfBase { span: Span, word: String, inputs: Vec<String> },
    SeveralInputs { span: Span, inputs: Vec<String> },
    NotABase { span: Span },
    NotAnOutput { span: Span, word: String, found: &'static str, declared: Span },
    ModeNumber { span: Span },
    FrequencyBelowZero { span: Span },
    RangeBelowZero { span: Span },
    RangeReversed { span: Span },
    GivenAndSolved { span: Span, word: String, solved: Span, by: Word },
    VariedTwice { span: Span, word: String, first: Span },
    RequireWhat { span: Span, suggestion: Option<&'static str> },
    RateAtRest { span: Span },
    RequireChain { span: Span },
    ChainWithoutMeasure { span: Span },
    MeasureAsValue { span: Span },
    MeasureInFunction { span: Span, function: String },
    MeasuresDiffer { span: Span, left: Dimension, right: Dimension },
    Unused { span: Span, name: String, kind: DefinitionKind },
    Idle { span: Span, name: String, word: &'static str, why: &'static str },
    IdleGravity { span: Span },
}

impl QuestionError {
    /// The diagnostic for it.
    pub fn diagnostic(self) -> Diagnostic {
        use QuestionError::*;
        match self {
            NoMotion { span } => error("vib::motion::none", span, "there is no motion in this")
                .help("write a motion, such as `block.x`, `rod.angle` or `s.force`"),
            OutputUnit { span, found, wanted, is_angle } => output_unit(span, found, wanted, is_angle),
            LevelOfOutput { span } => error(
                "vib::unit::mismatch",
                span,
                "`dB` is the ratio of two amplitudes, so an output has no value in it",
            )
            .help("leave it out: transfer functions are shown in dB as well"),
            CyclesOfOutput { span } => {
                error("vib::unit::frequency", span, "an angular velocity is in radians, `Hz` counts cycles")
                    .help("write `in rad/s`, `in rev/s` or `in rpm`")
                    .fix(span, Change::Replace("rev/s".into()))
            }
            NonLinear { span } => error("vib::motion::non_linear", span, "this is not linear in the motions")
                .help("motions can only be added, and multiplied by numbers"),
            PointWithoutMotion { span } => {
                error("vib::motion::none", span, "which motion of this point?").help("add it, as in `rod@(0, -2 m).x`")
            }
            MotionOfWhat { span } => error("vib::motion::none", span, "a motion belongs to a body or an element")
                .help("write its name before the dot, as in `block.x`"),
            UnknownMotion { span, word, of, suggestion, known } => {
                let help = suggestion.is_none().then(|| format!("{of} has {}", enumeration(&known)));
                let message = format!("{of} has no `{word}`");
                with_suggestion(error("vib::motion::unknown", span, message), suggestion.map(str::to_string), help)
            }
            NoSuchFreedom { span, name, turns } => {
                let message = if turns {
                    format!("`{name}` does not turn")
                } else {
                    format!("`{name}` does not move in this direction")
                };
                error("vib::motion::impossible", span, message)
                    .label("always zero")
                    .help(format!("let `{name}` move that way, or remove this motion"))
            }
            NoSuchReaction { span, name, why, help } => {
                error("vib::motion::impossible", span, format!("`{name}` {why}")).label("always zero").help(help)
            }
            CoupleOfOthers { span } => {
                error("vib::couple::motions", span, "a coupling relates displacements and angles of bodies")
                    .help("write it in `x`, `y` and `angle`, as in `wheel.angle = -block.x / 0.3 m`")
            }
            CauseUnknown { span } => error("vib::measure::arguments", span, "`rms` is under noise or over time")
                .help("write `rms(x, noise)`, `rms(x, time)` or `rms(x)`"),
            BandOutOfRange { span } => {
                error("vib::measure::arguments", span, "the band is not between 0 and 100 % of the final value")
                    .help("write a fraction of the final value, as in `settling(x, 2 %)`")
            }
            NoInitialState { span, word, found } => {
                error("vib::part::kind", span, format!("`{word}` is {found}: only bodies have an initial state"))
            }
            NotAMeasure { span, suggestion, form } => {
                let all = "`frequency(1)`, `damping(1)`, `gain(input -> output, 30 Hz)`, `stable`, ...".to_string();
                let help = format!("write {}", form.map_or(all, |form| format!("`{form}`")));
                let finding = error("vib::measure::unknown", span, "a measure is expected here");
                let help = suggestion.is_none().then_some(help);
                with_suggestion(finding, suggestion.map(str::to_string), help)
            }
            UnknownMeasure { span, word, suggestion } => {
                let names: Vec<&str> = MEASURES.iter().map(|measure| measure.function.name).collect();
                let help = format!("the measures are {}", names.join(", "));
                let help = suggestion.is_none().then_some(help);
                let message = format!("there is no measure `{word}`");
                with_suggestion(error("vib::measure::unknown", span, message), suggestion.map(str::to_string), help)
            }
            MeasureArguments { span, function } => {
                error("vib::measure::arguments", span, format!("`{}` has other arguments", function.name))
                    .help(format!("write `{}`", function.example))
            }
            ArrowMissing { span } => error("vib::measure::arguments", span, "from which input to which output?")
                .help("write `input -> output`, as in `gain(floor -> table.y, 30 Hz)`"),
            NotABase { span } => {
                error("vib::measure::input", span, "an effective mass is that of a mode under the motion of a base")
                    .help("name a base, as in `effective_mass(floor, 1)`")
            }
            NotAnInput { span, found } => {
                error("vib::measure::input", span, format!("one input is expected here, this is {found}"))
                    .help("name a force, a torque or a base, or one motion of a base, as in `floor.y` or `floor.ay`")
            }
            NoMotionOfBase { span, word, inputs } => {
                let names: Vec<String> = inputs.iter().map(|name| format!("`{name}`")).collect();
                error("vib::measure::input", span, format!("`{word}` is no motion of this base"))
                    .help(format!("write {}", names.join(" or ")))
            }
            SeveralInputs { span, inputs } => {
                let names: Vec<String> = inputs.iter().map(|name| format!("`{name}`")).collect();
                error("vib::measure::input", span, format!("one input is expected here, these are {}", inputs.len()))
                    .help(format!("write {}", names.join(" or ")))
            }
            NotAnOutput { span, word, found, declared } => {
                error("vib::measure::output", span, format!("`{word}` is {found}, not an output"))
                    .with_related(declared, "declared here")
                    .help("name an output, or a motion such as `table.y`")
            }
            ModeNumber { span } => {
                error("vib::measure::mode", span, "modes are numbered from 1").fix(span, Change::Replace("1".into()))
            }
            FrequencyBelowZero { span } => error("vib::measure::arguments", span, "this frequency is negative")
                .help("a measure takes a frequency from `0 Hz` on"),
            RangeBelowZero { span } => error("vib::solve::range", span, "frequencies of a range are not negative")
                .help("begin at `0 Hz` or above"),
            RangeReversed { span } => {
                error("vib::solve::range", span, "the range is empty").help("write the lower bound first")
            }
            VariedTwice { span, word, first } => {
                error("vib::minimise::twice", span, format!("`{word}` is determined by two lines"))
                    .with_related(first, "here first")
                    .help("let each parameter be determined by one `solve`, `minimise` or `maximise`")
            }
            GivenAndSolved { span, word, solved, by } => {
                let is_solved = by == "solve";
                let what = if is_solved { "is solved for" } else { "is varied" };
                let message = format!("`{word}` {what}: a value from outside would not be used");
                error("vib::setting::solved", span, message)
                    .with_related(solved, if is_solved { "solved for here" } else { "varied here" })
                    .help(format!("remove this setting, or the `{by}` line of the model"))
            }
            RequireWhat { span, suggestion } => {
                let help = "write `require frequency(1) > 2 Hz` or `require stable`".to_string();
                let finding = error("vib::require::form", span, "a comparison of a measure is expected here");
                let help = suggestion.is_none().then_some(help);
                with_suggestion(finding, suggestion.map(str::to_string), help)
            }
            RateAtRest { span } => {
                error("vib::measure::arguments", span, "at rest nothing has a velocity or an acceleration")
                    .help("write `x`, `y` or `angle` of a part, or `tension` or `stretch` of a spring")
            }
            RequireChain { span } => {
                error("vib::require::form", span, "the comparisons of a chain point in different directions")
                    .help("write all of them with `<` and `<=`, or all with `>` and `>=`; or write two lines")
            }
            ChainWithoutMeasure { span } => {
                error("vib::require::form", span, "a measure is expected on one side of each comparison")
                    .help("write the measure between its limits, as in `1 Hz < frequency(1) < 5 Hz`")
            }
            MeasureInFunction { span, function } => {
                error("vib::measure::value", span, format!("`{function}` takes no measures"))
                    .help("measures may be added, subtracted, multiplied and divided; for `min` and `max`, write a line for each measure")
            }
            MeasureAsValue { span } => {
                error("vib::measure::value", span, "this is no arithmetic of measures that are numbers")
                    .help("measures that are numbers may be added, subtracted, multiplied and divided")
            }
            MeasuresDiffer { span, left, right } => {
                let (left, right) = (name_phrase(left), name_phrase(right));
                error("vib::unit::mismatch", span, format!("{left} and {right} cannot be added or compared"))
                    .help("compare measures of one dimension")
            }
            Unused { span, name, kind } => unused_definition(span, &name, kind),
            Idle { span, name, word, why } => {
                let message = format!("this {word} of `{name}` {why}");
                Diagnostic::warning(Code::model("vib::unused::property"), span, message)
                    .help("remove it, or add the degree of freedom that uses it")
                    .fix(span, Change::DropField)
            }
            IdleGravity { span } => {
                Diagnostic::note(Code::model("vib::unused::gravity"), span, "gravity has no effect in this scene")
            }
        }
    }
}

fn unused_definition(span: Span, name: &str, kind: DefinitionKind) -> Diagnostic {
    let code = match kind {
        DefinitionKind::Point => Code::model("vib::unused::point"),
        DefinitionKind::Param | DefinitionKind::Let => Code::model("vib::unused::parameter"),
    };
    Diagnostic::warning(code, span, format!("the {} `{name}` is never used", kind_noun(kind)))
        .help("use it, or remove it")
        .fix(span, Change::DropDeclaration)
}

/// The unit of an output is one of another dimension.
fn output_unit(span: Span, found: (Dimension, Angle), wanted: Dimension, is_angle: bool) -> Diagnostic {
    let noun = match (is_angle, wanted) {
        (true, Dimension::NONE) => "an angle".to_string(),
        (true, Dimension::ANGULAR_VELOCITY) => "an angular velocity".to_string(),
        _ => name_phrase(wanted),
    };
    let unit = match (is_angle, wanted) {
        (true, Dimension::NONE) => "deg".to_string(),
        (true, Dimension::ANGULAR_VELOCITY) => "rpm".to_string(),
        _ => wanted.usual_unit(),
    };
    let found = match found {
        (Dimension::NONE, Angle::Radians) => "an angle".to_string(),
        (found, _) => name_phrase(found),
    };
    let message = format!("the output is {noun}, this is the unit of {found}");
    let diagnostic = error("vib::unit::mismatch", span, message);
    match unit.is_empty() {
        true => diagnostic.help("leave the unit out, or write `in %`"),
        false => diagnostic.help(format!("write a unit such as `{unit}`")).fix(span, Change::Replace(unit)),
    }
}
