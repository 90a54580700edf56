//! `solve` and `require`: the questions to the analysis. In: measures, comparisons and ranges. Out: the same questions
//! with every name resolved and every number in SI units. See spec.md.

use super::Check;
use super::error::{NameError, PlaceError, QuestionError, ValueError};
use super::evaluate::{Evaluated, Stop};
use super::expect::Expected;
use super::motions::Combination;
use super::overrides::{ANY_NUMBER, KindMismatch, coerce_to};
use super::scene::{
    Cause, Drive, InputId, InputKind, Measure, MotionTerm, Optimum, Parameter, Signal, Solve, Varied, Written,
};
use super::scope::{self, Definition, DefinitionId, DefinitionKind, Environment, Instance, Role, State};
use super::suggestion::nearest;
use super::value::{Scalar, Value};
use crate::base::unit::Scale;
use crate::base::{Angle, Dimension, Name, Number, Quantity, Span, Vec3};
use crate::kinds::functions::{self, MEASURES, Named};
use crate::kinds::motions::{motion_of_rate, rate_of};
use crate::syntax::tree::{Binary, DeclKind, ExprId, ExprKind, ExprList, FormalKind, Path, Rare};

const RATIO: Expected = Expected::new("a damping ratio", Dimension::NONE, "2 %");
const PHASE: Expected = Expected::new("an angle", Dimension::NONE, "-90 deg");

const BAND: Expected = Expected::new("a fraction of the final value", Dimension::NONE, "2 %");

/// Makes a measure of an output.
type MakeMeasure = fn(Vec<MotionTerm>) -> Measure;

/// A measure with the dimension of its value.
pub struct Measured {
    pub measure: Measure,
    pub dimension: Dimension,
}

/// The path from an input to an output.
struct Pair {
    input: Drive,
    output: Vec<MotionTerm>,
    /// The dimension of the gain.
    dimension: Dimension,
}

impl<'a> Check<'a> {
    pub fn solves(&mut self) {
        for index in 0..self.instances.solves.len() {
            let Instance { decl, environment } = self.instances.solves[index];
            let DeclKind::Rare { index } = decl.kind else { continue };
            let Rare::Solve { parameter, low, high, measure, value } = self.tree.rare[index as usize] else { continue };
            self.walk.varies = false;
            if let Ok(solve) = self.solve(parameter, (low, high), measure, value, environment) {
                self.scene.solves.push(solve);
            }
        }
    }

    fn solve(
        &mut self,
        parameter: Path,
        (low, high): (ExprId, ExprId),
        measure: ExprId,
        value: ExprId,
        environment: Environment,
    ) -> Evaluated<Solve> {
        let varied = self.varied_parameter(parameter, (low, high), "solve", environment);
        let question = self.comparison_side(measure, value, environment);
        let Varied { parameter, span, low, high } = varied?;
        Ok(Solve { parameter, span, low, high, question: question? })
    }

    /// A parameter that a line determines, and its range.
    fn varied_parameter(
        &mut self,
        parameter: Path,
        (low, high): (ExprId, ExprId),
        by: &'static str,
        environment: Environment,
    ) -> Evaluated<Varied> {
        let (id, declared) = self.solved_parameter(parameter, environment)?;
        let name = self.definitions[id.0 as usize].name;
        if let Some(span) = self.overrides.named_at(name) {
            let word = self.words.display(name);
            let solved = self.path_span(parameter);
            return self.fail(environment, QuestionError::GivenAndSolved { span, word, solved, by });
        }
        let (like, high_value) = self.range_of(&declared, low, high, environment)?;
        let (low_value, high_value) = (like.si.clone(), high_value.si);
        if !(&high_value - &low_value).is_positive() {
            let span = self.tree.expr(low).span.to(self.tree.expr(high).span);
            return self.fail(environment, QuestionError::RangeReversed { span });
        }
        let mut found = self.parameter(id, &declared);
        if declared.bare_zero {
            // Declared as a plain `0`: its dimension follows from the range.
            found.value = Quantity { si: Number::ZERO, ..like };
            found.unit = self.written_unit(low, found.value.dimension);
        }
        let span = self.path_span(parameter);
        Ok(Varied { parameter: found, span, low: low_value, high: high_value })
    }

    /// The lines `minimise` and `maximise`.
    pub fn optima(&mut self) {
        for index in 0..self.instances.optima.len() {
            let Instance { decl, environment } = self.instances.optima[index];
            let DeclKind::Rare { index } = decl.kind else { continue };
            let Rare::Optimum { highest, measure, varied, limits } = self.tree.rare[index as usize] else { continue };
            self.walk.varies = false;
            if let Ok(optimum) = self.optimum((decl.span, highest), measure, varied, limits, environment) {
                self.scene.optima.push(optimum);
            }
        }
    }

    fn optimum(
        &mut self,
        (span, highest): (Span, bool),
        measure: ExprId,
        list: (u32, u32),
        limits: ExprList,
        environment: Environment,
    ) -> Evaluated<Optimum> {
        let by = if highest { "maximise" } else { "minimise" };
        let question = self.objective(measure, environment);
        let tree = self.tree;
        let mut found = Ok(Vec::new());
        for item in tree.varied_parameters(list) {
            let one = self.varied_parameter(item.parameter, (item.low, item.high), by, environment);
            let one = one.and_then(|one| self.determined_once(one, &found, environment));
            found = match (found, one) {
                (Ok(list), Ok(one)) => Ok([list, vec![one]].concat()),
                (Err(stop), _) | (_, Err(stop)) => Err(stop),
            };
        }
        let mut conditions = Vec::new();
        let mut failed = None;
        for &limit in tree.list(limits) {
            match self.requirement(limit, environment) {
                Ok(list) => conditions.extend(list),
                Err(stop) => failed = Some(stop),
            }
        }
        let (question, varied) = (question?, found?);
        failed.map_or(Ok(Optimum { span, highest, question, varied, limits: conditions }), Err)
    }

    /// Refuses a parameter that another line, or this one, determines as well.
    fn determined_once(
        &mut self,
        one: Varied,
        here: &Evaluated<Vec<Varied>>,
        environment: Environment,
    ) -> Evaluated<Varied> {
        let solved = self.scene.solves.iter().map(|solve| (&solve.parameter.name, solve.span));
        let earlier = self.scene.optima.iter().flat_map(|optimum| &optimum.varied);
        let varied = earlier.chain(here.iter().flatten()).map(|varied| (&varied.parameter.name, varied.span));
        let first = solved.chain(varied).find(|(name, _)| **name == one.parameter.name).map(|(_, first)| first);
        match first {
            None => Ok(one),
            Some(first) => {
                let (span, word) = (one.span, one.parameter.name);
                self.fail(environment, QuestionError::VariedTwice { span, word, first })
            }
        }
    }

    /// Every `param` that is a number.
    pub fn parameters(&self) -> Vec<Parameter> {
        let ids = (0..).map(DefinitionId).zip(&self.definitions);
        let numbers = ids.filter_map(|(id, definition)| match (definition.kind, &definition.state) {
            (DefinitionKind::Param, State::Settled(Ok(Value::Scalar(value)))) => Some(self.parameter(id, value)),
            _ => None,
        });
        numbers.collect()
    }

    /// A parameter with its current value.
    pub fn parameter(&self, id: DefinitionId, value: &Scalar) -> Parameter {
        let definition = &self.definitions[id.0 as usize];
        let Quantity { dimension, angle, .. } = value.quantity;
        let unit = self.unit_in(definition.expr, dimension).or_else(|| self.unit_of_formal(definition, dimension));
        let unit = unit.unwrap_or_else(|| {
            let text = match angle {
                Angle::Cycles if dimension == Dimension::FREQUENCY => "Hz".into(),
                Angle::Radians if dimension == Dimension::FREQUENCY => "rad/s".into(),
                _ if dimension == Dimension::FREQUENCY => "1/s".into(),
                _ => usual_unit(dimension),
            };
            Written { text, factor: Some(Number::ONE) }
        });
        let span = match definition.role {
            Role::Parameter { given: true, .. } => self.tree.expr(definition.expr).span,
            _ => definition.span,
        };
        Parameter { name: self.words.display(definition.name), span, value: value.quantity.clone(), unit }
    }

    /// The unit in the brackets of a component for one of its parameters, or that of its default.
    fn unit_of_formal(&self, definition: &Definition, dimension: Dimension) -> Option<Written> {
        let Role::Parameter { frame, formal, .. } = definition.role else { return None };
        let component = self.tree.component(self.frame(frame).component?);
        let FormalKind::Number { unit, default } = component.formals[formal as usize].kind else { return None };
        match unit {
            Some(unit) => self.unit_named(self.sources.slice(unit), dimension),
            None => self.unit_in(default?, dimension),
        }
    }

    /// The unit of the first number of this dimension in an expression, or the usual unit if there is no such number.
    pub fn written_unit(&self, expr: ExprId, dimension: Dimension) -> Written {
        self.unit_in(expr, dimension)
            .unwrap_or_else(|| Written { text: usual_unit(dimension), factor: Some(Number::ONE) })
    }

    fn unit_in(&self, expr: ExprId, dimension: Dimension) -> Option<Written> {
        let node = self.tree.expr(expr);
        match node.kind {
            ExprKind::Literal { number_len } => {
                let text = self.sources.slice(node.span).get(usize::from(number_len)..)?.trim();
                self.unit_named(text, dimension)
            }
            ExprKind::Negate { operand } => self.unit_in(operand, dimension),
            ExprKind::Binary { left, right, .. } => {
                self.unit_in(left, dimension).or_else(|| self.unit_in(right, dimension))
            }
            _ => None,
        }
    }

    /// A unit that is in use, if it is one of this dimension.
    fn unit_named(&self, text: &str, dimension: Dimension) -> Option<Written> {
        let unit = self.units.get(text).filter(|unit| unit.dimension == dimension)?;
        let factor = match &unit.scale {
            Scale::Linear(factor) => Some(factor.clone()),
            Scale::Decibel => None,
        };
        Some(Written { text: text.to_string(), factor })
    }

    /// The parameter to be solved for, with its declared value.
    pub fn solved_parameter(&mut self, path: Path, environment: Environment) -> Evaluated<(DefinitionId, Scalar)> {
        let id = self.named_definition(path, environment)?;
        let definition = &mut self.definitions[id.0 as usize];
        definition.used = true;
        let (kind, declared, name) = (definition.kind, definition.span, definition.name);
        let at = self.path_span(path);
        if let Role::Parameter { given: true, .. } = self.definitions[id.0 as usize].role {
            let given = self.tree.expr(self.definitions[id.0 as usize].expr).span;
            let word = self.words.display(name);
            return self.fail(environment, PlaceError::GivenBySolve { span: at, word, given });
        }
        match (kind, self.definitions[id.0 as usize].state.clone()) {
            (DefinitionKind::Param, State::Settled(Ok(Value::Scalar(value)))) => Ok((id, value)),
            (DefinitionKind::Param, _) => Err(Stop::Reported),
            _ => {
                let word = self.words.display(name);
                self.fail(environment, NameError::NotAParameter { span: at, word, kind, declared })
            }
        }
    }

    /// The parameter, point or `let` that a path names.
    fn named_definition(&mut self, path: Path, environment: Environment) -> Evaluated<DefinitionId> {
        let Path { first: ident, whole } = path;
        if let Some(whole) = whole
            && let ExprKind::Member { base, member_len, indices } = self.tree.expr(whole).kind
        {
            let frame = self.frame_before(base, environment)?;
            return self.member_definition(frame, self.tree.member(base, member_len, indices), environment);
        }
        let name = self.name(ident, environment)?;
        match self.values.get(name) {
            Some(id) => Ok(id),
            None => {
                let error = self.unknown_value(ident, Some(name), environment);
                self.fail_unless_broken(environment, ident.span, error)
            }
        }
    }

    /// The ends of a parameter's range, which must be of the same kind as the parameter. Where both are of another kind, that is
    /// one mistake.
    pub fn range_of(
        &mut self,
        declared: &Scalar,
        low: ExprId,
        high: ExprId,
        environment: Environment,
    ) -> Evaluated<(Quantity, Quantity)> {
        let ends = [low, high].map(|expr| {
            let value = self.evaluate(expr, environment)?;
            let given = self.as_scalar(&value, expr, environment, &ANY_NUMBER)?;
            Ok((coerce_to(declared, given), self.tree.expr(expr).span, expr))
        });
        let wrong = |end: &Evaluated<(Result<Scalar, KindMismatch>, Span, ExprId)>| match end {
            Ok((Err(mismatch), span, _)) => Some((*mismatch, *span)),
            _ => None,
        };
        let mismatch = match (wrong(&ends[0]), wrong(&ends[1])) {
            (Some((mismatch, first)), Some((_, second))) => Some((mismatch, first.to(second))),
            (one, other) => one.or(other),
        };
        if let Some((mismatch, span)) = mismatch {
            return self.fail(environment, mismatch.error(span, declared));
        }
        let [low, high] = ends.map(|end| match end? {
            (Ok(scalar), _, expr) => {
                self.check_range(&scalar.quantity.si, expr, environment)?;
                Ok(scalar.quantity)
            }
            (Err(_), ..) => Err(Stop::Reported),
        });
        Ok((low?, high?))
    }

    /// Whether a name is the measure `load_factor`, and no number of the model.
    fn is_load_factor(&self, text: &str) -> bool {
        text == "load_factor" && self.words.get(text).is_none_or(|word| self.values.get(Name::plain(word)).is_none())
    }

    pub fn is_measure(&self, expr: ExprId) -> bool {
        let node = self.tree.expr(expr);
        let text = self.sources.slice(node.span);
        match node.kind {
            ExprKind::Call { name_len, .. } => functions::by_name(MEASURES, &text[..usize::from(name_len)]).is_some(),
            ExprKind::Name { .. } => text == "stable" || self.is_load_factor(text),
            _ => false,
        }
    }

    pub fn measure(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Measured> {
        let tree = self.tree;
        let node = *tree.expr(expr);
        let text = self.sources.slice(node.span);
        match node.kind {
            ExprKind::Name { .. } if text == "stable" => {
                Ok(Measured { measure: Measure::Stable, dimension: Dimension::NONE })
            }
            ExprKind::Name { .. } if self.is_load_factor(text) => {
                Ok(Measured { measure: Measure::LoadFactor, dimension: Dimension::NONE })
            }
            ExprKind::Call { name_len, arguments } => {
                let word = Span::new(node.span.file(), node.span.start(), node.span.start() + usize::from(name_len));
                self.called_measure(word, node.span, tree.list(arguments), environment)
            }
            _ => {
                let is_name = matches!(node.kind, ExprKind::Name { .. });
                let named = functions::by_name(MEASURES, text).filter(|_| is_name);
                let known = ["stable", "load_factor"];
                let suggestion = is_name.then(|| nearest(text, known)).flatten().filter(|_| named.is_none());
                let form = named.map(|measure| measure.function.example);
                self.fail(environment, QuestionError::NotAMeasure { span: node.span, suggestion, form })
            }
        }
    }

    fn called_measure(
        &mut self,
        word: Span,
        span: Span,
        arguments: &[ExprId],
        environment: Environment,
    ) -> Evaluated<Measured> {
        use functions::Measure as Word;
        let text = self.sources.slice(word);
        let Some(Named { kind, function }) = functions::by_name(MEASURES, text) else {
            let suggestion = nearest(text, MEASURES.iter().map(|measure| measure.function.name));
            return self
                .fail(environment, QuestionError::UnknownMeasure { span: word, word: text.to_string(), suggestion });
        };
        let (make, output) = match (*kind, arguments) {
            (Word::Frequency, &[mode]) => {
                let mode = self.mode(mode, environment)?;
                return Ok(Measured { measure: Measure::Frequency { mode }, dimension: Dimension::FREQUENCY });
            }
            (Word::Damping, &[mode]) => {
                let mode = self.mode(mode, environment)?;
                return Ok(Measured { measure: Measure::DampingRatio { mode }, dimension: Dimension::NONE });
            }
            (measure @ (Word::Gain | Word::Phase), &[path, frequency]) => {
                return self.response(measure, path, frequency, environment);
            }
            (Word::PeakGain, &[path]) => return self.peak_gain(path, None, environment),
            (Word::PeakGain, &[path, range]) => return self.peak_gain(path, Some(range), environment),
            (Word::EffectiveMass, &[base, mode]) => return self.effective_mass(base, mode, environment),
            (Word::Rest, &[quantity]) => {
                let Combination { terms, dimension, .. } = self.at_rest(quantity, environment)?;
                return Ok(Measured { measure: Measure::Rest { terms }, dimension });
            }
            (Word::Amplitude, &[output]) => ((|output| Measure::Amplitude { output }) as MakeMeasure, output),
            (Word::Static, &[output]) => ((|output| Measure::Static { output }) as MakeMeasure, output),
            (Word::Peak, &[output]) => ((|output| Measure::Peak { output }) as MakeMeasure, output),
            (Word::Settling, &[output, band]) => return self.settling(output, band, environment),
            (Word::Overshoot, &[output]) => {
                let output = self.measured_output(output, environment)?.terms;
                return Ok(Measured { measure: Measure::Overshoot { output }, dimension: Dimension::NONE });
            }
            (Word::Rms, &[output, cause]) => return self.rms(output, Some(cause), environment),
            (Word::Rms, &[output]) => return self.rms(output, None, environment),
            (Word::Psd, &[output, frequency]) => return self.psd(output, frequency, environment),
            (Word::Crossings, &[output]) => {
                let output = self.measured_output(output, environment)?.terms;
                return Ok(Measured { measure: Measure::Crossings { output }, dimension: Dimension::FREQUENCY });
            }
            _ => return self.fail(environment, QuestionError::MeasureArguments { span, function }),
        };
        let Combination { terms, dimension, .. } = self.measured_output(output, environment)?;
        Ok(Measured { measure: make(terms), dimension })
    }

    /// `gain(input -> output, f)`, `phase(input -> output, f)`.
    fn response(
        &mut self,
        measure: functions::Measure,
        path: ExprId,
        frequency: ExprId,
        environment: Environment,
    ) -> Evaluated<Measured> {
        let path = self.path(path, environment);
        let frequency = self.frequency_from_zero(frequency, environment)?;
        let Pair { input, output, dimension } = path?;
        if measure == functions::Measure::Phase {
            return Ok(Measured { measure: Measure::Phase { input, output, frequency }, dimension: Dimension::NONE });
        }
        Ok(Measured { measure: Measure::Gain { input, output, frequency }, dimension })
    }

    /// `settling(x, 2 %)`
    fn settling(&mut self, output: ExprId, band: ExprId, environment: Environment) -> Evaluated<Measured> {
        let Combination { terms: output, .. } = self.measured_output(output, environment)?;
        let span = self.tree.expr(band).span;
        let band = self.number(band, environment, &BAND)?;
        if !band.is_positive() || !(&Number::ONE - &band).is_positive() {
            return self.fail(environment, QuestionError::BandOutOfRange { span });
        }
        Ok(Measured { measure: Measure::Settling { output, band }, dimension: Dimension::TIME })
    }

    /// `rms(x)`, `rms(x, noise)`, `rms(x, time)`, `rms(x, 20 Hz .. 2 kHz)`.
    fn rms(&mut self, output: ExprId, cause: Option<ExprId>, environment: Environment) -> Evaluated<Measured> {
        if let Some(range) = cause.filter(|&cause| matches!(self.tree.expr(cause).kind, ExprKind::Range { .. })) {
            let combination = self.measured_output(output, environment);
            let range = self.frequencies(range, environment)?;
            let Combination { terms: output, dimension, .. } = combination?;
            return Ok(Measured { measure: Measure::RmsWithin { output, range }, dimension });
        }
        let Combination { terms: output, dimension, .. } = self.measured_output(output, environment)?;
        let signals = || self.scene.inputs.iter().flat_map(|input| &input.signal);
        let has_noise = signals().any(Signal::has_noise);
        let moves_in_time = signals().any(Signal::has_course) || !self.scene.initial.is_empty();
        let of = match cause.map(|cause| self.tree.expr(cause).span) {
            Some(span) => match self.sources.slice(span) {
                "noise" => Cause::Noise,
                "time" => Cause::Time,
                _ => return self.fail(environment, QuestionError::CauseUnknown { span }),
            },
            None if !has_noise => Cause::Time,
            None if !moves_in_time => Cause::Noise,
            None => Cause::Either,
        };
        Ok(Measured { measure: Measure::Rms { output, of }, dimension })
    }

    /// `psd(x, 10 Hz)`: its dimension is the square of the output's per frequency.
    fn psd(&mut self, output: ExprId, frequency: ExprId, environment: Environment) -> Evaluated<Measured> {
        let span = self.tree.expr(output).span;
        let combination = self.measured_output(output, environment);
        let frequency = self.frequency_from_zero(frequency, environment)?;
        let Combination { terms: output, dimension, .. } = combination?;
        let Some(dimension) = dimension.pow(2, 1).and_then(|square| square.times(Dimension::TIME)) else {
            return self.fail(environment, ValueError::Overflow { span });
        };
        Ok(Measured { measure: Measure::Psd { output, frequency }, dimension })
    }

    /// `peak_gain(input -> output)`, `peak_gain(input -> output, 1 Hz .. 50 Hz)`.
    fn peak_gain(&mut self, path: ExprId, range: Option<ExprId>, environment: Environment) -> Evaluated<Measured> {
        let path = self.path(path, environment);
        let range = range.map(|range| self.frequencies(range, environment)).transpose()?;
        let Pair { input, output, dimension } = path?;
        Ok(Measured { measure: Measure::PeakGain { input, output, range }, dimension })
    }

    /// `effective_mass(floor, 1)`
    fn effective_mass(&mut self, base: ExprId, mode: ExprId, environment: Environment) -> Evaluated<Measured> {
        let (input, _) = self.measured_input(base, environment)?;
        let mode = self.mode(mode, environment)?;
        let dimension = match self.scene.inputs[input.index()].kind {
            InputKind::Base { translation: Some(_), .. } => Dimension::MASS,
            InputKind::Base { translation: None, .. } => Dimension::INERTIA,
            _ => {
                let span = self.tree.expr(base).span;
                return self.fail(environment, QuestionError::NotABase { span });
            }
        };
        Ok(Measured { measure: Measure::EffectiveMass { input, mode }, dimension })
    }

    /// `1 Hz .. 50 Hz`
    fn frequencies(&mut self, range: ExprId, environment: Environment) -> Evaluated<[Number; 2]> {
        let node = *self.tree.expr(range);
        let ExprKind::Range { low, high } = node.kind else {
            let error =
                ValueError::Kind { span: node.span, needed: "a range such as `1 Hz .. 50 Hz`", found: "a number" };
            return self.fail(environment, error);
        };
        let low = self.frequency(low, environment)?;
        let high = self.frequency(high, environment)?;
        let error = if low.is_negative() {
            QuestionError::RangeBelowZero { span: node.span }
        } else if !(&high - &low).is_positive() {
            QuestionError::RangeReversed { span: node.span }
        } else {
            return Ok([low, high]);
        };
        self.fail(environment, error)
    }

    /// The frequency of a measure, which is not negative.
    fn frequency_from_zero(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Number> {
        let frequency = self.frequency(expr, environment)?;
        if frequency.is_negative() {
            let span = self.tree.expr(expr).span;
            return self.fail(environment, QuestionError::FrequencyBelowZero { span });
        }
        Ok(frequency)
    }

    /// `input -> output`, with the dimension of its gain.
    fn path(&mut self, path: ExprId, environment: Environment) -> Evaluated<Pair> {
        let node = *self.tree.expr(path);
        let ExprKind::Binary { operator: Binary::Arrow, left, right } = node.kind else {
            return self.fail(environment, QuestionError::ArrowMissing { span: node.span });
        };
        let input = self.measured_drive(left, environment);
        let output = self.measured_output(right, environment);
        let (input, per) = input?;
        let Combination { terms: output, dimension, .. } = output?;
        let Some(dimension) = dimension.per(per) else {
            return self.fail(environment, ValueError::Overflow { span: node.span });
        };
        Ok(Pair { input, output, dimension })
    }

    /// An output by its name, or the motions in an expression.
    fn measured_output(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Combination> {
        let node = *self.tree.expr(expr);
        let names_part = match node.kind {
            ExprKind::Name { .. } => true,
            ExprKind::Member { base, .. } => self.is_value_of_place(base, environment),
            _ => false,
        };
        let combination = match names_part {
            true => self.named_output(expr, environment)?,
            false => self.combination(expr, environment)?,
        };
        match combination.terms.is_empty() {
            true => self.fail(environment, QuestionError::NoMotion { span: node.span }),
            false => Ok(combination),
        }
    }

    fn named_output(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Combination> {
        let node = *self.tree.expr(expr);
        match self.expression_part(expr, environment, "output")? {
            scope::Part::Output(index) => {
                let Instance { decl, environment } = self.instances.outputs[index as usize];
                let DeclKind::Rare { index } = decl.kind else { return Err(Stop::Reported) };
                let Rare::Output { value, .. } = self.tree.rare[index as usize] else { return Err(Stop::Reported) };
                self.combination(value, environment)
            }
            other => {
                let span = match node.kind {
                    ExprKind::Name { .. } => self.word_of(node.span),
                    _ => node.span,
                };
                let (word, found) = (self.sources.slice(span).to_string(), self.noun_of(other));
                let declared = self.part_span(other);
                self.fail(environment, QuestionError::NotAnOutput { span, word, found, declared })
            }
        }
    }

    /// A force, a torque, or a motion of a base: `floor`, `front.road`, or `floor.y` if it has several.
    pub fn measured_input(&mut self, expr: ExprId, environment: Environment) -> Evaluated<(InputId, Dimension)> {
        self.input_or_rate(expr, false, environment).map(|(Drive { input, .. }, dimension)| (input, dimension))
    }

    /// An input, or the velocity or acceleration of a base: `quake.ax`.
    fn measured_drive(&mut self, expr: ExprId, environment: Environment) -> Evaluated<(Drive, Dimension)> {
        self.input_or_rate(expr, true, environment)
    }

    fn input_or_rate(
        &mut self,
        expr: ExprId,
        takes_rates: bool,
        environment: Environment,
    ) -> Evaluated<(Drive, Dimension)> {
        let node = *self.tree.expr(expr);
        let (owner, motion) = match node.kind {
            ExprKind::Member { base, member_len, indices } if !self.is_value_of_place(base, environment) => {
                (base, Some(self.tree.member(base, member_len, indices).span))
            }
            _ => (expr, None),
        };
        let owner_node = *self.tree.expr(owner);
        if !matches!(owner_node.kind, ExprKind::Name { .. } | ExprKind::Member { .. }) {
            let span = owner_node.span;
            return self.fail(environment, QuestionError::NotAnInput { span, found: "an expression" });
        }
        let part = self.expression_part(owner, environment, "input")?;
        if self.broken_inputs {
            return Err(Stop::Reported);
        }
        let name = self.input_name(part)?;
        let rate = motion.filter(|_| takes_rates && matches!(part, scope::Part::Base(_)));
        let rate = rate.and_then(|word| motion_of_rate(self.sources.slice(word)));
        let derivative = rate.map_or(0, |(_, derivative)| derivative);
        let word = motion;
        let motion = match motion {
            Some(word) => {
                let text: &'a str = rate.map_or(self.sources.slice(word), |(motion, _)| motion);
                Some(self.motion_in_scene(part, (word, text, rate.is_some()), environment)?)
            }
            None => None,
        };
        match name.and_then(|name| self.input_of(name, motion)) {
            Some((input, _)) => {
                let dimension = dimension_of_drive(&self.scene.inputs[input.index()].kind, derivative);
                Ok((Drive { input, derivative }, dimension))
            }
            None => {
                let inputs = name.map_or_else(Vec::new, |name| self.motions_of(name, owner));
                let error = match word {
                    Some(word) if matches!(part, scope::Part::Base(_)) && !inputs.is_empty() => {
                        let (text, rates) = (self.sources.slice(word).to_string(), takes_rates);
                        let inputs = name.map_or_else(Vec::new, |name| self.inputs_of_base(name, owner, rates));
                        QuestionError::NoMotionOfBase { span: word, word: text, inputs }
                    }
                    None if inputs.len() > 1 => QuestionError::SeveralInputs { span: node.span, inputs },
                    _ => QuestionError::NotAnInput { span: node.span, found: self.noun_of(part) },
                };
                self.fail(environment, error)
            }
        }
    }

    /// The name that a part has among the inputs.
    fn input_name(&mut self, part: scope::Part) -> Evaluated<Option<Name>> {
        match part {
            scope::Part::Base(index) => Ok(self.scene.bases.get(index as usize).map(|base| base.name)),
            scope::Part::Input(index) => {
                let Instance { decl, environment } = self.instances.inputs[index as usize];
                self.declared_ident(decl).map(|ident| self.name(ident, environment)).transpose()
            }
            _ => Ok(None),
        }
    }

    /// The name in the scene of a base's motion: `x` or `y` in a rotated component may be the other one, if the base
    /// has several motions, or its velocity or acceleration is meant.
    fn motion_in_scene(
        &mut self,
        part: scope::Part,
        (word, text, is_rate): (Span, &'a str, bool),
        environment: Environment,
    ) -> Evaluated<&'a str> {
        let Some(placed) = self.placement(environment)? else { return Ok(text) };
        let scope::Part::Base(base) = part else { return Ok(text) };
        let Some(base) = self.scene.bases.get(base as usize) else { return Ok(text) };
        let is_named = is_rate || base.translations.len() > 1;
        let axis = match text {
            "x" if is_named => placed.scene.direction(&Vec3::X),
            "y" if is_named => placed.scene.direction(&Vec3::Y),
            "angle" if placed.scene.reverses() => Vec3::ZERO,
            _ => return Ok(text),
        };
        let along = |axis: &Vec3| base.translations.iter().find(|own| own.direction == *axis).map(|own| own.motion);
        match along(&axis) {
            Some(motion) => Ok(motion),
            // The only motion is another one.
            None if is_rate && axis != Vec3::ZERO && along(&axis.scale(&Number::from(-1))).is_none() => Ok(""),
            None => self.fail(environment, PlaceError::TurnedMotion { span: word, word: text.to_string() }),
        }
    }

    /// The only input of this name, or the one for the given motion.
    fn input_of(&self, name: Name, motion: Option<&str>) -> Option<(InputId, Dimension)> {
        let inputs = self.scene.inputs.iter().enumerate().filter(|(_, input)| input.name == name);
        let named = inputs.filter(|(_, input)| motion.is_none_or(|motion| self.motion_of(&input.kind) == motion));
        let mut named = named.map(|(index, input)| (InputId(index as u32), dimension_of(&input.kind)));
        let first = named.next()?;
        named.next().is_none().then_some(first)
    }

    /// The names of the motions of all inputs with this name, as `owner` would write them.
    fn motions_of(&self, name: Name, owner: ExprId) -> Vec<String> {
        let owner = self.sources.slice(self.tree.expr(owner).span);
        let inputs = self.scene.inputs.iter().filter(|input| input.name == name);
        inputs.map(|input| format!("{owner}.{}", self.motion_of(&input.kind))).collect()
    }

    /// The inputs of a base as `owner` would write them, with their velocities and accelerations if these are wanted.
    fn inputs_of_base(&self, name: Name, owner: ExprId, with_rates: bool) -> Vec<String> {
        let text = self.sources.slice(self.tree.expr(owner).span);
        let inputs = self.scene.inputs.iter().filter(|input| input.name == name);
        let motions: Vec<&'static str> = inputs.map(|input| self.motion_of(&input.kind)).collect();
        let rates = motions.iter().flat_map(|motion| [rate_of(motion, 1), rate_of(motion, 2)]).flatten();
        let rates: Vec<String> = rates.filter(|_| with_rates).map(|rate| format!("{text}.{rate}")).collect();
        let own = if motions.len() > 1 { self.motions_of(name, owner) } else { vec![text.to_string()] };
        [own, rates].concat()
    }

    /// `x`, `y`, `along` or `angle` of a base, the axis of an unbalance.
    fn motion_of(&self, kind: &InputKind) -> &'static str {
        match kind {
            InputKind::Unbalance { axis, .. } => axis.name(),
            kind => self.scene.motion_of_base(kind).unwrap_or_default(),
        }
    }

    /// The number of a mode, from 1.
    fn mode(&mut self, expr: ExprId, environment: Environment) -> Evaluated<u32> {
        let mode = self.whole(expr, environment)?;
        match u32::try_from(mode) {
            Ok(mode) if mode > 0 => Ok(mode),
            _ => {
                let span = self.tree.expr(expr).span;
                self.fail(environment, QuestionError::ModeNumber { span })
            }
        }
    }

    /// The number that a measure is compared with.
    pub fn value_of_measure(
        &mut self,
        measured: &Measured,
        expr: ExprId,
        environment: Environment,
    ) -> Evaluated<Number> {
        let expected = match measured.measure {
            Measure::Frequency { .. } | Measure::Crossings { .. } => return self.frequency(expr, environment),
            Measure::Psd { .. } => return self.measured_density(expr, measured.dimension, environment),
            Measure::DampingRatio { .. } => RATIO,
            Measure::Phase { .. } => PHASE,
            Measure::Stable => {
                let span = self.tree.expr(expr).span;
                return self.fail(environment, QuestionError::RequireWhat { span, suggestion: None });
            }
            Measure::Combined(_) if measured.dimension == Dimension::FREQUENCY => {
                return self.frequency(expr, environment);
            }
            Measure::Gain { input, .. } | Measure::PeakGain { input, .. } if !measured.dimension.is_none() => {
                let input = dimension_of_drive(&self.scene.inputs[input.input.index()].kind, input.derivative);
                let output = measured.dimension.times(input).unwrap_or(measured.dimension);
                Expected::gain(measured.dimension, input, output)
            }
            ref measure => expected_of(measured.dimension, matches!(measure, Measure::Combined(_))),
        };
        self.number(expr, environment, &expected)
    }
}

/// The usual unit of a dimension; empty for 1/s, which has two.
fn usual_unit(dimension: Dimension) -> String {
    if dimension == Dimension::FREQUENCY { String::new() } else { dimension.usual_unit() }
}

/// The dimension of an input.
pub fn dimension_of(kind: &InputKind) -> Dimension {
    match kind {
        InputKind::Force { .. } | InputKind::ForceBetween { .. } => Dimension::FORCE,
        InputKind::Torque { .. } => Dimension::TORQUE,
        InputKind::Unbalance { .. } => Dimension::UNBALANCE,
        InputKind::Base { translation: Some(_), .. } => Dimension::LENGTH,
        InputKind::Base { translation: None, .. } => Dimension::NONE,
    }
}

/// The dimension of an input, or of the velocity or acceleration of a base.
fn dimension_of_drive(kind: &InputKind, derivative: u8) -> Dimension {
    let per_time = |dimension: Dimension| dimension.per(Dimension::TIME).unwrap_or(dimension);
    (0..derivative).fold(dimension_of(kind), |dimension, _| per_time(dimension))
}

/// A value of a dimension. One in 1/s or 1/s^2 is of an angle if it is that of a motion; a combination of measures may
/// be anything.
fn expected_of(dimension: Dimension, is_combined: bool) -> Expected {
    match (dimension, is_combined) {
        (Dimension::ANGULAR_VELOCITY, false) => Expected::angular("an angular velocity", dimension, "2 rad/s"),
        (Dimension::ANGULAR_ACCELERATION, false) => {
            Expected::angular("an angular acceleration", dimension, "2 rad/s^2")
        }
        (Dimension::ANGULAR_ACCELERATION, true) => Expected::without_name(dimension),
        _ => match dimension.noun() {
            Some(noun) => Expected::new(noun, dimension, example_of(dimension)),
            None => Expected::without_name(dimension),
        },
    }
}

/// An example of a number with its unit, for a help.
fn example_of(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::NONE => "0.25",
        Dimension::LENGTH => "2 mm",
        Dimension::VELOCITY => "0.1 m/s",
        Dimension::ACCELERATION => "0.003 g0",
        Dimension::FORCE => "10 N",
        Dimension::TORQUE => "2 N*m",
        _ => "",
    }
}
