//! The values that a study gives to parameters: `k=5N/m..50N/m:200`, `m=0.1kg,0.5kg,1kg`; and the measures that are asked for from
//! outside the model. In: their texts. Out: for each parameter a list of values of its kind; measures like those of requirements.

use super::Check;
use super::error::{NameError, QuestionError};
use super::evaluate::{Evaluated, Stop};
use super::overrides::{coerce_to, trimmed_span};
use super::scene::{Parameter, Written};
use super::scope::{DefinitionId, DefinitionKind, Environment, State};
use super::value::{Scalar, Value};
use crate::base::{FileId, Name, Number, Quantity, Rational, Span};
use num_integer::Integer;

/// A parameter and the values that a study gives to it.
#[derive(Clone, Debug)]
pub struct Swept {
    /// The parameter as declared; its value has the angle and the dimension of the values below.
    pub parameter: Parameter,
    pub points: Points,
}

/// Values in SI units.
#[derive(Clone, Debug)]
pub enum Points {
    /// At equal distances from `low` to `high`, both included; at least two.
    Even {
        low: Number,
        high: Number,
        count: u64,
        /// See [`in_integers`].
        fraction: Option<[i64; 3]>,
    },
    Listed(Vec<Number>),
}

impl Points {
    pub fn even(low: Number, high: Number, count: u64) -> Points {
        let between = &(&high - &low) / &Number::from(count as i64 - 1);
        let fraction = in_integers([Some(low.clone()), Some(between)], count);
        Points::Even { low, high, count, fraction }
    }

    pub fn count(&self) -> u64 {
        match self {
            Points::Even { count, .. } => *count,
            Points::Listed(list) => list.len() as u64,
        }
    }

    /// The value with this index, which is less than the count.
    pub fn value(&self, index: u64) -> Number {
        match self {
            Points::Listed(list) => list[index as usize].clone(),
            Points::Even { fraction: Some([a, b, c]), .. } => Rational::new(a + b * index as i64, *c).into(),
            Points::Even { low, high, count, fraction: None } => {
                let part = &Number::from(index as i64) / &Number::from(*count as i64 - 1);
                low + &(&(high - low) * &part)
            }
        }
    }
}

/// Integers up to this size are exact in binary64.
const EXACT: u64 = 1 << 53;

/// Integers a, b and c, exact in binary64, such that the value with index i is (a + i b) / c: of the first value and the distance of
/// neighbours. `None` if there are none for all values.
pub fn in_integers(of: [Option<Number>; 2], count: u64) -> Option<[i64; 3]> {
    let [first, between] = of.map(|number| number.and_then(|number| number.exact()?.to_fraction()));
    let ((a, c), (b, d)) = (first?, between?);
    let over = i128::from(c).lcm(&i128::from(d));
    let [a, b] = [(a, c), (b, d)].map(|(number, divisor)| i128::from(number) * (over / i128::from(divisor)));
    let most = a.abs().checked_add(b.abs().checked_mul(i128::from(count))?)?.max(over);
    let fits = most < i128::from(EXACT);
    fits.then_some([a as i64, b as i64, over as i64])
}

impl Swept {
    /// The value with this index as a setting.
    pub fn quantity(&self, index: u64) -> Quantity {
        Quantity { si: self.points.value(index), ..self.parameter.value.clone() }
    }
}

/// The texts of the values in `5N/m..50N/m:200` or `0.1kg,0.5kg`.
pub enum Shape<'a> {
    Range { low: &'a str, high: &'a str, count: u64 },
    List(Vec<&'a str>),
}

/// The most values of one parameter; all values of a study are fewer than the integers that binary64 holds.
const MOST_POINTS: u64 = 1_000_000_000;

/// Takes the values of a study apart; `Err` says what to write.
pub fn shape_of_values(text: &str) -> Result<Shape<'_>, &'static str> {
    let Some((low, rest)) = text.split_once("..") else {
        let list: Vec<&str> = text.split(',').collect();
        let is_empty = list.iter().any(|value| value.trim().is_empty());
        return if is_empty { Err("a value is missing: write k=5N/m,10N/m,20N/m") } else { Ok(Shape::List(list)) };
    };
    const HOW_MANY: &str = "write how many values after a colon, from 2 to 1000000000, such as k=5N/m..50N/m:200";
    let (high, count) = rest.rsplit_once(':').ok_or(HOW_MANY)?;
    let digits = count.trim();
    let count = digits.parse().ok().filter(|count| (2..=MOST_POINTS).contains(count) && !digits.starts_with('+'));
    match count {
        _ if low.trim().is_empty() || high.trim().is_empty() => Err("an end is missing: write k=5N/m..50N/m:200"),
        Some(count) => Ok(Shape::Range { low, high, count }),
        None => Err(HOW_MANY),
    }
}

/// A line `NAME=VALUES`.
pub(super) struct Line {
    name: Name,
    values: Span,
}

impl<'a> Check<'a> {
    /// Reads the names of the lines, before anything is declared.
    pub(super) fn swept_lines(&mut self, file: FileId) -> Vec<Line> {
        let (text, mut start, mut lines) = (self.sources.text(file), 0, Vec::new());
        for line in text.split_inclusive('\n') {
            let from = start;
            start += line.len();
            let Some(at) = line.find('=') else {
                self.report(Environment::TOP, NameError::NoEqualsSign { span: trimmed_span(file, from, line) });
                continue;
            };
            let (word, span) = (line[..at].trim(), trimmed_span(file, from, &line[..at]));
            match self.read_name(word) {
                Some(name) => {
                    self.overrides.mention(name, word, span);
                    lines.push(Line { name, values: trimmed_span(file, from + at + 1, &line[at + 1..]) });
                }
                None => self.report(Environment::TOP, NameError::SettingName { span }),
            }
        }
        lines
    }

    /// The values of the lines. Names that are no parameters have been reported.
    pub(super) fn sweep_lines(&mut self, lines: &[Line]) -> Vec<Swept> {
        lines.iter().filter_map(|line| self.swept_line(line).ok()).collect()
    }

    fn swept_line(&mut self, line: &Line) -> Evaluated<Swept> {
        let (id, declared) = self.parameter_named(line.name).ok_or(Stop::Reported)?;
        let (span, text) = (line.values, self.sources.slice(line.values));
        let Ok(shape) = shape_of_values(text) else {
            return self.fail(Environment::TOP, NameError::SettingValue { span });
        };
        let place = |part: &str| {
            trimmed_span(span.file(), span.start() + (part.as_ptr() as usize - text.as_ptr() as usize), part)
        };
        let mut parameter = self.parameter(id, &declared);
        let texts = match &shape {
            Shape::Range { low, high, .. } => vec![*low, *high],
            Shape::List(list) => list.clone(),
        };
        let mut values = Vec::with_capacity(texts.len());
        for text in texts {
            values.push(self.swept_value(&declared, place(text))?);
        }
        if declared.bare_zero {
            // Declared as a plain `0`: its dimension follows from the values.
            let like = values[0].clone();
            let text = like.dimension.usual_unit();
            parameter.unit = Written { text, factor: Some(Number::ONE) };
            parameter.value = like;
        }
        let mut values: Vec<Number> = values.into_iter().map(|value| value.si).collect();
        let points = match (shape, &values[..]) {
            (Shape::Range { count, .. }, [low, high]) => {
                if !(high - low).is_positive() {
                    return self.fail(Environment::TOP, QuestionError::RangeReversed { span });
                }
                Points::even(low.clone(), high.clone(), count)
            }
            _ => Points::Listed(std::mem::take(&mut values)),
        };
        Ok(Swept { parameter, points })
    }

    /// A value like the declared one.
    fn swept_value(&mut self, declared: &Scalar, span: Span) -> Evaluated<Quantity> {
        let value = self.value_from_outside(span)?;
        match coerce_to(declared, &value) {
            Ok(value) => Ok(value.quantity),
            Err(mismatch) => self.fail(Environment::TOP, mismatch.error(span, declared)),
        }
    }

    fn parameter_named(&self, name: Name) -> Option<(DefinitionId, Scalar)> {
        let id = self.values.get(name)?;
        let definition = &self.definitions[id.0 as usize];
        match (definition.kind, &definition.state) {
            (DefinitionKind::Param, State::Settled(Ok(Value::Scalar(value)))) => Some((id, value.clone())),
            _ => None,
        }
    }

    /// The measures that are asked for from outside.
    pub(super) fn check_asked_measures(&mut self) {
        for &expr in &self.tree.asked {
            self.walk.varies = false;
            if let Ok(question) = self.objective(expr, Environment::TOP) {
                self.scene.asked.push(question);
            }
        }
    }
}
