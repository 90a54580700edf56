//! `noise(...)`: stationary noise by its power spectral density. In: the arguments of the call. Out: the density in SI,
//! and the derivative of the input that it refers to. See spec.md#signals.

use super::Check;
use super::error::{PartError, ValueError};
use super::evaluate::Evaluated;
use super::expect::Expected;
use super::scope::Environment;
use super::suggestion::nearest;
use super::tables::{First, TableRequest};
use super::value::{Scalar, Value};
use crate::base::density::{Band, Course, Density};
use crate::base::{Angle, Dimension, Number, Span};
use crate::kinds::functions::{self, SignalKind};
use crate::syntax::tree::{Binary, ExprId, ExprKind};

const ROUGHNESS: Expected = Expected::new("a density of the height of a road", Dimension::of(0, 3, 0), "16e-6 m^3");
const SPEED: Expected = Expected::new("a speed", Dimension::VELOCITY, "20 m/s");
const WAVE_NUMBER: Expected = Expected::new("a wave number", Dimension::of(0, -1, 0), "0.1 /m");

/// The wave numbers of ISO 8608, 1/m: the reference, and the range of its classes.
const REFERENCE: &str = "0.1";
const ROAD: [&str; 2] = ["0.011", "2.83"];

/// A call of `noise`.
pub struct NoiseCall {
    pub span: Span,
    pub given: Vec<ExprId>,
}

/// A density, and the index of its kind among the kinds that the input takes.
pub struct Noisy {
    pub density: Density,
    pub derivative: usize,
}

impl<'a> Check<'a> {
    pub fn noise(&mut self, call: &NoiseCall, kinds: &[SignalKind], environment: Environment) -> Evaluated<Noisy> {
        let kind_of = |check: &Check<'a>, expr: ExprId| check.tree.expr(expr).kind;
        let wrong = |check: &mut Check<'a>| check.fail(environment, PartError::NoiseArguments { span: call.span });
        match call.given[..] {
            [one] => match kind_of(self, one) {
                ExprKind::Named { value, .. } if self.is_white(one, value) => {
                    let (value, derivative) = self.density(value, kinds, environment)?;
                    Ok(Noisy { density: Density::White(value), derivative })
                }
                ExprKind::Call { name_len, arguments } => {
                    let start = self.tree.expr(one).span.start();
                    let file = self.tree.expr(one).span.file();
                    let called = Span::new(file, start, start + usize::from(name_len));
                    let word = self.sources.slice(called);
                    let arguments = self.tree.list(arguments).to_vec();
                    match (word, &arguments[..]) {
                        ("table", [file, unit]) => self.density_table([*file, *unit], kinds, environment),
                        ("road", [roughness, speed]) => self.road((*roughness, *speed), None, kinds, call, environment),
                        ("road", [roughness, speed, range]) => {
                            self.road((*roughness, *speed), Some(*range), kinds, call, environment)
                        }
                        ("table" | "road", _) => wrong(self),
                        _ => {
                            let (word, suggestion) = (word.to_string(), nearest(word, ["road", "table"]));
                            self.fail(environment, PartError::UnknownNoise { span: called, word, suggestion })
                        }
                    }
                }
                // `white -3 N^2/Hz` reads as a difference.
                ExprKind::Binary { operator: Binary::Subtract, left, right } if self.is_word(left, "white") => {
                    let span = self.tree.expr(right).span;
                    self.fail(environment, PartError::NoiseDensity { span })
                }
                _ => wrong(self),
            },
            [density, range] if matches!(kind_of(self, range), ExprKind::Range { .. }) => {
                let (value, derivative) = self.density(density, kinds, environment)?;
                let ExprKind::Range { low, high } = kind_of(self, range) else { return wrong(self) };
                let (from, to) = (self.frequency(low, environment)?, self.frequency(high, environment)?);
                self.starts_at_zero_or_above(&from, low, environment)?;
                self.ascending(&from, &to, high, environment)?;
                let density = Density::Bands(vec![Band { from, to, course: Course::Flat(value) }]);
                Ok(Noisy { density, derivative })
            }
            _ => self.corners(call, kinds, environment),
        }
    }

    /// `white 3 N^2/Hz`, and not `white = 3 N^2/Hz`.
    fn is_white(&self, argument: ExprId, value: ExprId) -> bool {
        let (whole, value) = (self.tree.expr(argument).span, self.tree.expr(value).span);
        let before = self.sources.slice(Span::new(whole.file(), whole.start(), value.start()));
        before.trim_end() == "white"
    }

    fn is_word(&self, expr: ExprId, word: &str) -> bool {
        self.sources.slice(self.tree.expr(expr).span) == word
    }

    /// Corner points, connected by straight lines in logarithmic axes.
    fn corners(&mut self, call: &NoiseCall, kinds: &[SignalKind], environment: Environment) -> Evaluated<Noisy> {
        let rises = |check: &mut Self, before: &Number, frequency: &Number, at| {
            check.ascending(before, frequency, at, environment)
        };
        let density = |check: &mut Self, value| check.density(value, kinds, environment);
        let Some((points, derivative)) = self.corner_points(&call.given, environment, rises, density)? else {
            return self.fail(environment, PartError::NoiseArguments { span: call.span });
        };
        let bands = points.iter().zip(points.iter().skip(1)).map(|((from, low), (to, high))| {
            let course = Course::between([from, to], [low, high]);
            Band { from: from.clone(), to: to.clone(), course }
        });
        Ok(Noisy { density: Density::Bands(bands.collect()), derivative })
    }

    /// `table("psd.csv", 1 m^2/Hz)`: frequencies and densities, on a line between its rows.
    fn density_table(
        &mut self,
        [name, unit]: [ExprId; 2],
        kinds: &[SignalKind],
        environment: Environment,
    ) -> Evaluated<Noisy> {
        let (factor, derivative) = self.density(unit, kinds, environment)?;
        let read = kinds[derivative].density;
        let node = *self.tree.expr(name);
        if !matches!(node.kind, ExprKind::Text) {
            let error = ValueError::Kind { span: node.span, needed: "a file name in quotes", found: "a number" };
            return self.fail(environment, error);
        }
        let file = self.sources.slice(node.span).trim_matches('"').to_string();
        let Some(table) = self.sources.table(node.span.file(), &file) else {
            return Ok(Noisy { density: Density::Bands(Vec::new()), derivative });
        };
        let unit = Some((factor, self.tree.expr(unit).span));
        let asked = TableRequest { named: node.span, unit, first: First::Frequency, read: &read };
        let rows = self.table_rows(table, &asked, environment)?;
        let is_wrong = |(f, s): (&Number, &Number)| f.is_negative() || s.is_negative();
        if rows.times.iter().zip(&rows.values).any(is_wrong) || rows.values.iter().all(Number::is_zero) {
            return self.fail(environment, PartError::NoiseTable { span: node.span });
        }
        let ends: Vec<(&Number, &Number)> = rows.times.iter().zip(&rows.values).collect();
        let bands = ends.windows(2).map(|pair| {
            let [(from, low), (to, high)] = [pair[0], pair[1]];
            let course = Course::Line { low: low.clone(), high: high.clone() };
            Band { from: from.clone(), to: to.clone(), course }
        });
        Ok(Noisy { density: Density::Bands(bands.collect()), derivative })
    }

    /// G(n) = G(n0) (n / n0)^-2 over wave numbers, at a speed: S(f) = G(f / v) / v (ISO 8608:2016).
    fn road(
        &mut self,
        (roughness, speed): (ExprId, ExprId),
        range: Option<ExprId>,
        kinds: &[SignalKind],
        call: &NoiseCall,
        environment: Environment,
    ) -> Evaluated<Noisy> {
        if kinds.first().is_none_or(|kind| kind.amplitude.dimension != Dimension::LENGTH) {
            return self.fail(environment, PartError::RoadOfNoBase { span: call.span });
        }
        let of_reference = self.number(roughness, environment, &ROUGHNESS)?;
        self.positive_density(&of_reference, roughness, environment)?;
        let value = self.number(speed, environment, &SPEED)?;
        if !value.is_positive() {
            let span = self.tree.expr(speed).span;
            return self.fail(environment, PartError::RoadSpeed { span });
        }
        let waves = match range {
            None => ROAD.map(Number::from),
            Some(range) => {
                let ExprKind::Range { low, high } = self.tree.expr(range).kind else {
                    return self.fail(environment, PartError::NoiseArguments { span: call.span });
                };
                let (from, to) =
                    (self.number(low, environment, &WAVE_NUMBER)?, self.number(high, environment, &WAVE_NUMBER)?);
                self.ascending(&Number::ZERO, &from, low, environment)?;
                self.ascending(&from, &to, high, environment)?;
                [from, to]
            }
        };
        let reference = Number::from(REFERENCE);
        let density = |wave: &Number| {
            let ratio = &reference / wave;
            &(&of_reference * &ratio.square()) / &value
        };
        let [low, high] = [density(&waves[0]), density(&waves[1])];
        let [from, to] = [&waves[0] * &value, &waves[1] * &value];
        let course = Course::Power { low, high, slope: Some(-2) };
        Ok(Noisy { density: Density::Bands(vec![Band { from, to, course }]), derivative: 0 })
    }

    /// A density per Hz, and the place of its kind.
    fn density(&mut self, expr: ExprId, kinds: &[SignalKind], environment: Environment) -> Evaluated<(Number, usize)> {
        let value = self.evaluate(expr, environment)?;
        let found = match &value {
            Value::Scalar(scalar) => scalar.dimension(),
            Value::Vector(_) => None,
        };
        let place = kinds.iter().position(|kind| Some(kind.density.dimension) == found);
        // The usual kind of a base is the last one, an acceleration.
        let expected = place.map_or(kinds.last(), |place| kinds.get(place)).unwrap_or(&functions::FORCE_SIGNAL).density;
        let si = self.as_number(&value, expr, environment, &expected)?;
        self.positive_density(&si, expr, environment)?;
        let Value::Scalar(Scalar { quantity, .. }) = &value else { return Ok((si, place.unwrap_or(0))) };
        let is_of_angles = [0, 2, 4].map(|per| Dimension::of(0, 0, 1 - per)).contains(&expected.dimension);
        let per_radian = || &si * &(&Number::from(2) * &Number::pi());
        let per_hertz = match quantity.angle {
            Angle::PerCycle => si,
            Angle::PerRadian => per_radian(),
            // `N^2*s/rad`
            Angle::Radians if !is_of_angles => per_radian(),
            _ => {
                let (span, size) = (self.tree.expr(expr).span, quantity.si.to_f64());
                let unit = over_time(expected.dimension);
                return self.fail(environment, ValueError::DensityReading { span, value: size, unit });
            }
        };
        Ok((per_hertz, place.unwrap_or(0)))
    }

    /// The density that an output's is compared with, per Hz.
    pub fn measured_density(
        &mut self,
        expr: ExprId,
        dimension: Dimension,
        environment: Environment,
    ) -> Evaluated<Number> {
        let value = self.evaluate(expr, environment)?;
        let expected = Expected::new("a power spectral density of this output", dimension, "1e-6 m^2/Hz");
        let si = self.as_number(&value, expr, environment, &expected)?;
        match &value {
            Value::Scalar(Scalar { bare_zero: true, .. }) => Ok(si),
            Value::Scalar(Scalar { quantity, .. }) if quantity.angle != Angle::PerCycle => {
                let (span, size) = (self.tree.expr(expr).span, quantity.si.to_f64());
                self.fail(environment, ValueError::DensityReading { span, value: size, unit: over_time(dimension) })
            }
            _ => Ok(si),
        }
    }

    fn positive_density(&mut self, value: &Number, at: ExprId, environment: Environment) -> Evaluated<()> {
        if value.is_positive() {
            return Ok(());
        }
        let span = self.tree.expr(at).span;
        self.fail(environment, PartError::NoiseDensity { span })
    }

    fn starts_at_zero_or_above(&mut self, value: &Number, at: ExprId, environment: Environment) -> Evaluated<()> {
        if !value.is_negative() {
            return Ok(());
        }
        let span = self.tree.expr(at).span;
        self.fail(environment, PartError::NoiseFrequency { span, is_first: true })
    }

    /// Checks that a frequency is certainly above another.
    fn ascending(&mut self, from: &Number, to: &Number, at: ExprId, environment: Environment) -> Evaluated<()> {
        if (to - from).is_positive() {
            return Ok(());
        }
        let span = self.tree.expr(at).span;
        self.fail(environment, PartError::NoiseFrequency { span, is_first: from.is_zero() })
    }
}

/// The SI unit of a density without the frequency below: `m^2`.
fn over_time(density: Dimension) -> String {
    let named = [
        (Dimension::of(2, 2, -3), "N^2"),
        (Dimension::of(2, 4, -3), "N^2*m^2"),
        (Dimension::of(0, 0, 1), "rad^2"),
        (Dimension::of(0, 0, -1), "rad^2/s^2"),
        (Dimension::of(0, 0, -3), "rad^2/s^4"),
    ];
    match named.iter().find(|(known, _)| *known == density) {
        Some((_, unit)) => (*unit).to_string(),
        None => density.per(Dimension::TIME).map_or(String::new(), |squared| squared.to_string()),
    }
}
