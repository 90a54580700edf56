//! A nonlinear law of an element: its force as a function of its stretch or of its rate. Evaluated in enclosures, with its
//! first derivative (automatic differentiation), for the proof of a rest and the tangent there; and in binary64, with its
//! integral, for the search. See docs/method/rest.md#laws.
//!
//! A law is a list of operations in postfix order over exact numbers, so no evaluation recurses. At a kink of `abs`, `min`
//! or `max` the derivative is an enclosure of both one-sided derivatives: [`Curve::kink`] reports whether these differ.

use super::Scalar;
use crate::base::number::Dd;
use crate::base::{Ball, Number, Span, up};
use std::cmp::Ordering;
use std::sync::Arc;

/// A law.
#[derive(Clone, Debug)]
pub struct Curve {
    steps: Vec<Step>,
}

/// One operation on the stack, and the place where it is written.
#[derive(Clone, Debug)]
pub struct Step {
    pub operation: Operation,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum Operation {
    /// SI.
    Constant(Number),
    /// The stretch, m or rad, or the rate.
    Variable,
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Call(Function, usize),
    /// Interpolates at the value on the stack.
    Table(Arc<Rows>),
}

/// A function of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    Sqrt,
    Abs,
    Min,
    Max,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Exp,
    Ln,
}

/// Why a law has no value, or no derivative, at some stretch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Undefined {
    pub span: Span,
    /// The reason as a phrase.
    pub why: &'static str,
}

/// A number and its derivative by the variable.
#[derive(Clone, Debug)]
pub struct Dual {
    pub value: Number,
    pub slope: Number,
}

/// The derivative that is used at a kink.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    /// An enclosure of both.
    Either,
    Below,
    Above,
}

const ROOT: &str = "the root of a number that may be negative";
const STEEP: &str = "its slope has no limit here";
const ZERO: &str = "a division by a number that may be zero";
const RANGE: &str = "the argument is outside of what the function takes";
const OUTSIDE: &str = "it lies outside of the rows of the table";

impl Function {
    /// The function with a name of the language.
    pub fn by_name(name: &str) -> Option<Function> {
        Some(match name {
            "sqrt" => Function::Sqrt,
            "abs" => Function::Abs,
            "min" => Function::Min,
            "max" => Function::Max,
            "sin" => Function::Sin,
            "cos" => Function::Cos,
            "tan" => Function::Tan,
            "asin" => Function::Asin,
            "acos" => Function::Acos,
            "atan" => Function::Atan,
            "atan2" => Function::Atan2,
            "exp" => Function::Exp,
            "ln" => Function::Ln,
            _ => return None,
        })
    }
}

impl Curve {
    /// Whether it depends on a parameter that is a range.
    pub fn is_ranged(&self) -> bool {
        let depends = |step: &Step| match &step.operation {
            Operation::Constant(number) => number.is_range(),
            _ => false,
        };
        self.steps.iter().any(depends)
    }

    /// The law with these operations; `None` if they do not leave exactly one number.
    pub fn new(steps: Vec<Step>) -> Option<Curve> {
        let mut height = 0_usize;
        for step in &steps {
            let takes = match step.operation {
                Operation::Constant(_) | Operation::Variable => 0,
                Operation::Negate | Operation::Table(_) => 1,
                Operation::Call(_, count) => count,
                _ => 2,
            };
            height = height.checked_sub(takes)? + 1;
        }
        (height == 1).then_some(Curve { steps })
    }

    /// The operations in postfix order.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Force and derivative: enclosures over all stretches in `x`.
    pub fn at(&self, x: &Number) -> Result<Dual, Undefined> {
        self.run(x, Side::Either)
    }

    /// The force alone, which may be defined where the derivative is not.
    pub fn value(&self, x: &Number) -> Result<Number, Undefined> {
        match self.run(x, Side::Either) {
            Ok(dual) => Ok(dual.value),
            Err(Undefined { why: STEEP, .. }) => Ok(Number::unknown()),
            Err(undefined) => Err(undefined),
        }
    }

    /// Force and derivative in the numbers of a search or of a proof; unknown values if the law is not defined there.
    pub fn of<S: Scalar>(&self, x: &S) -> (S, S) {
        let found = if x.to_f64().is_finite() { self.at(&x.number()).ok() } else { None };
        found.map_or_else(|| (S::unknown(), S::unknown()), |dual| (S::of(&dual.value), S::of(&dual.slope)))
    }

    /// The place of a kink at some number in `x`, where the derivatives on the two sides certainly differ.
    pub fn kink(&self, x: &Number) -> Option<Span> {
        let mut met = None;
        let [below, above] = [Side::Below, Side::Above].map(|side| self.run_noting(x, side, &mut met).ok());
        let jump = &above?.slope - &below?.slope;
        met.filter(|_| !jump.may_be_zero())
    }

    fn run(&self, x: &Number, side: Side) -> Result<Dual, Undefined> {
        self.run_noting(x, side, &mut None)
    }

    /// Notes the place of the first function that may be at its kink.
    fn run_noting(&self, x: &Number, side: Side, met: &mut Option<Span>) -> Result<Dual, Undefined> {
        let mut stack: Vec<Dual> = Vec::new();
        for step in &self.steps {
            let undefined = |why| Undefined { span: step.span, why };
            let made = match &step.operation {
                Operation::Constant(value) => Dual { value: value.clone(), slope: Number::ZERO },
                Operation::Variable => Dual { value: x.clone(), slope: Number::ONE },
                Operation::Call(function, count) => {
                    let arguments = stack.split_off(stack.len() - count);
                    if met.is_none() && function.is_kinked(&arguments) {
                        *met = Some(step.span);
                    }
                    call(*function, &arguments, side).map_err(undefined)?
                }
                Operation::Table(rows) => {
                    let a = stack.pop().ok_or_else(|| undefined(RANGE))?;
                    rows.at(&a).ok_or_else(|| undefined(OUTSIDE))?
                }
                Operation::Negate => {
                    let a = stack.pop().ok_or_else(|| undefined(RANGE))?;
                    Dual { value: -&a.value, slope: -&a.slope }
                }
                operation => {
                    let (b, a) = (stack.pop(), stack.pop());
                    let (Some(a), Some(b)) = (a, b) else { return Err(undefined(RANGE)) };
                    binary(operation, &a, &b).map_err(undefined)?
                }
            };
            if !(made.value.is_finite() && made.slope.is_finite()) {
                return Err(undefined("it is too large"));
            }
            stack.push(made);
        }
        Ok(stack.pop().unwrap_or(Dual { value: Number::ZERO, slope: Number::ZERO }))
    }
}

impl Function {
    /// Whether the arguments may be at a kink.
    fn is_kinked(self, arguments: &[Dual]) -> bool {
        match self {
            Function::Abs => arguments[0].value.may_be_zero(),
            Function::Min | Function::Max => {
                let pairs = arguments.iter().enumerate().flat_map(|(i, a)| arguments[..i].iter().map(move |b| (a, b)));
                pairs.into_iter().any(|(a, b)| (&a.value - &b.value).may_be_zero())
            }
            _ => false,
        }
    }
}

fn binary(operation: &Operation, a: &Dual, b: &Dual) -> Result<Dual, &'static str> {
    Ok(match operation {
        Operation::Add => Dual { value: &a.value + &b.value, slope: &a.slope + &b.slope },
        Operation::Subtract => Dual { value: &a.value - &b.value, slope: &a.slope - &b.slope },
        Operation::Multiply => {
            Dual { value: &a.value * &b.value, slope: &(&a.slope * &b.value) + &(&a.value * &b.slope) }
        }
        Operation::Divide => {
            let value = a.value.checked_div(&b.value).ok_or(ZERO)?;
            let slope = &(&a.slope - &(&value * &b.slope)) / &b.value;
            Dual { value, slope }
        }
        _ => power(a, b)?,
    })
}

fn power(a: &Dual, b: &Dual) -> Result<Dual, &'static str> {
    let value = a.value.pow(&b.value).ok_or(RANGE)?;
    let by_base = match b.value.is_zero() {
        true => Number::ZERO,
        false if a.slope.is_zero() => Number::ZERO,
        false => &(&b.value * &a.value.pow(&(&b.value - &Number::ONE)).ok_or(STEEP)?) * &a.slope,
    };
    let by_exponent = match b.slope.is_zero() {
        true => Number::ZERO,
        false => &(&value * &a.value.ln().ok_or(RANGE)?) * &b.slope,
    };
    Ok(Dual { value, slope: &by_base + &by_exponent })
}

fn call(function: Function, arguments: &[Dual], side: Side) -> Result<Dual, &'static str> {
    let [u, others @ ..] = arguments else { return Err(RANGE) };
    let chain = |value: Number, slope: Number| Dual { value, slope: &slope * &u.slope };
    let one_minus_square = || &Number::ONE - &(&u.value * &u.value);
    Ok(match function {
        Function::Sqrt => {
            let value = u.value.sqrt().ok_or(ROOT)?;
            let slope = Number::ONE.checked_div(&(&value + &value)).ok_or(STEEP)?;
            chain(value, slope)
        }
        Function::Abs => magnitude(u, side),
        Function::Min => others.iter().fold(u.clone(), |best, other| extreme(&best, other, true, side)),
        Function::Max => others.iter().fold(u.clone(), |best, other| extreme(&best, other, false, side)),
        Function::Sin => {
            let (sine, cosine) = u.value.sin_cos().ok_or(RANGE)?;
            chain(sine, cosine)
        }
        Function::Cos => {
            let (sine, cosine) = u.value.sin_cos().ok_or(RANGE)?;
            chain(cosine, -&sine)
        }
        Function::Tan => {
            let (sine, cosine) = u.value.sin_cos().ok_or(RANGE)?;
            let value = sine.checked_div(&cosine).ok_or(ZERO)?;
            let slope = &Number::ONE + &(&value * &value);
            chain(value, slope)
        }
        Function::Asin => {
            let value = u.value.asin().ok_or(RANGE)?;
            let root = one_minus_square().sqrt().ok_or(RANGE)?;
            chain(value, Number::ONE.checked_div(&root).ok_or(STEEP)?)
        }
        Function::Acos => {
            let value = u.value.acos().ok_or(RANGE)?;
            let root = one_minus_square().sqrt().ok_or(RANGE)?;
            chain(value, -&Number::ONE.checked_div(&root).ok_or(STEEP)?)
        }
        Function::Atan => {
            let value = Number::atan2(&u.value, &Number::ONE).ok_or(RANGE)?;
            let slope = &Number::ONE / &(&Number::ONE + &(&u.value * &u.value));
            chain(value, slope)
        }
        Function::Atan2 => {
            let x = others.first().ok_or(RANGE)?;
            let value = Number::atan2(&u.value, &x.value).ok_or(RANGE)?;
            let turn = &(&u.slope * &x.value) - &(&u.value * &x.slope);
            let square = &(&u.value * &u.value) + &(&x.value * &x.value);
            Dual { value, slope: turn.checked_div(&square).ok_or(ZERO)? }
        }
        Function::Exp => {
            let value = exponential(&u.value).ok_or("it is too large")?;
            chain(value.clone(), value)
        }
        Function::Ln => {
            let value = u.value.ln().ok_or("the logarithm of a number that may not be positive")?;
            chain(value, u.value.recip().ok_or(ZERO)?)
        }
    })
}

/// e^u, even if it is too small for binary64: then between zero and its value at the upper end of `u`.
fn exponential(u: &Number) -> Option<Number> {
    let near = u.exp();
    if near.is_some() {
        return near;
    }
    let (ball, lowest) = (u.to_ball(), Ball::from(-699.0));
    let upper = ball.mid + Dd::from(ball.rad);
    let upper = Ball::exact(if upper > lowest.mid { upper } else { lowest.mid }).widen(upper.hi.abs() * f64::EPSILON);
    let top = Number::Ball(upper).exp()?.to_ball().magnitude();
    Some(Number::Ball(Ball::from(0.5 * top).widen(0.5 * top * up::FEW)))
}

/// |u|. At a kink its derivative is -|u'| below and |u'| above.
fn magnitude(u: &Dual, side: Side) -> Dual {
    let slope = match () {
        () if u.value.is_positive() => u.slope.clone(),
        () if u.value.is_negative() => -&u.slope,
        () => match side {
            Side::Above => u.slope.abs(),
            Side::Below => -&u.slope.abs(),
            // A plain ball: its derivative by a parameter would not be that of the kink.
            Side::Either => Number::Ball(Ball::ZERO.widen(u.slope.to_ball().magnitude())),
        },
    };
    Dual { value: u.value.abs(), slope }
}

fn extreme(a: &Dual, b: &Dual, smallest: bool, side: Side) -> Dual {
    let difference = Dual { value: &a.value - &b.value, slope: &a.slope - &b.slope };
    let first_is_larger = difference.value.is_positive();
    if first_is_larger || difference.value.is_negative() {
        return if first_is_larger == smallest { b.clone() } else { a.clone() };
    }
    // (a + b -+ |a - b|) / 2
    let two = Number::from(2);
    let size = magnitude(&difference, side);
    let half = |a: &Number, b: &Number, size: &Number| {
        let sum = a + b;
        &(if smallest { &sum - size } else { &sum + size }) / &two
    };
    Dual { value: half(&a.value, &b.value, &size.value), slope: half(&a.slope, &b.slope, &size.slope) }
}

/// Rows of a table, and the slopes of the monotone cubic through them: F. N. Fritsch, J. Butland, *A method for
/// constructing local monotone piecewise cubic interpolants*, SIAM J. Sci. Stat. Comput. 5 (1984) 300, with their
/// weighted harmonic means of the slopes of the chords and a one-sided three-point formula at the ends.
#[derive(Clone, Debug)]
pub struct Rows {
    x: Vec<Number>,
    y: Vec<Number>,
    slopes: Vec<Number>,
}

impl Rows {
    /// `None` for fewer than two rows, or if the known digits do not decide whether a chord rises.
    pub fn new(x: Vec<Number>, y: Vec<Number>) -> Option<Rows> {
        if x.len() < 2 || x.len() != y.len() {
            return None;
        }
        let h: Vec<Number> = x.windows(2).map(|pair| &pair[1] - &pair[0]).collect();
        let chords: Option<Vec<Number>> = y.windows(2).zip(&h).map(|(y, h)| (&y[1] - &y[0]).checked_div(h)).collect();
        let chords = chords?;
        let signs: Option<Vec<Ordering>> = chords.iter().map(|chord| chord.compare(&Number::ZERO)).collect();
        let signs = signs?;
        if chords.len() == 1 {
            return Some(Rows { slopes: vec![chords[0].clone(); 2], x, y });
        }
        let last = chords.len() - 1;
        let mut slopes = vec![end(&h[0], &h[1], &chords[0], &chords[1])?];
        for k in 1..chords.len() {
            slopes.push(if signs[k - 1] != signs[k] || signs[k] == Ordering::Equal {
                Number::ZERO
            } else {
                let before = &(&h[k] + &h[k]) + &h[k - 1];
                let after = &(&h[k - 1] + &h[k - 1]) + &h[k];
                &(&before + &after) / &(&(&before / &chords[k - 1]) + &(&after / &chords[k]))
            });
        }
        slopes.push(end(&h[last], &h[last - 1], &chords[last], &chords[last - 1])?);
        Some(Rows { x, y, slopes })
    }

    /// The first and the last stretch.
    pub fn range(&self) -> [&Number; 2] {
        [&self.x[0], &self.x[self.x.len() - 1]]
    }

    /// The interpolant; `None` if the argument may be outside the rows.
    fn at(&self, u: &Dual) -> Option<Dual> {
        let order = |knot: &Number| u.value.compare(knot);
        let below = self.x.partition_point(|knot| order(knot) == Some(Ordering::Greater));
        let reached = self.x.partition_point(|knot| order(knot) != Some(Ordering::Less));
        if reached == below + 1 && order(&self.x[below]) == Some(Ordering::Equal) {
            return Some(Dual { value: self.y[below].clone(), slope: &self.slopes[below] * &u.slope });
        }
        if below == 0 || reached == self.x.len() {
            return None;
        }
        let mut pieces = (below - 1..reached).map(|piece| self.cubic(piece, &u.value));
        let first = pieces.next()?;
        let found =
            pieces.fold(first, |a, b| Dual { value: hull(&a.value, &b.value), slope: hull(&a.slope, &b.slope) });
        Some(Dual { slope: &found.slope * &u.slope, ..found })
    }

    fn cubic(&self, piece: usize, x: &Number) -> Dual {
        let (t, h) = (x - &self.x[piece], &self.x[piece + 1] - &self.x[piece]);
        let (m0, m1) = (&self.slopes[piece], &self.slopes[piece + 1]);
        let chord = &(&self.y[piece + 1] - &self.y[piece]) / &h;
        let (two, three) = (Number::from(2), Number::from(3));
        let second = &(&(&(&three * &chord) - &(&two * m0)) - m1) / &h;
        let third = &(&(m0 + m1) - &(&two * &chord)) / &(&h * &h);
        let inner = &second + &(&t * &third);
        let value = &self.y[piece] + &(&t * &(m0 + &(&t * &inner)));
        let slope = m0 + &(&t * &(&(&two * &second) + &(&(&three * &t) * &third)));
        Dual { value, slope }
    }
}

/// The slope at an end, from the two chords next to it.
fn end(h0: &Number, h1: &Number, chord: &Number, next: &Number) -> Option<Number> {
    let slope = &(&(&(&(h0 + h0) + h1) * chord) - &(h0 * next)) / &(h0 + h1);
    let sign = |number: &Number| number.compare(&Number::ZERO);
    let steepest = &Number::from(3) * chord;
    Some(if sign(&slope)? != sign(chord)? {
        Number::ZERO
    } else if sign(chord)? != sign(next)? && slope.abs().compare(&steepest.abs())? == Ordering::Greater {
        steepest
    } else {
        slope
    })
}

/// A ball that holds all of both.
fn hull(a: &Number, b: &Number) -> Number {
    a.to_ball().widen((a - b).to_ball().magnitude()).into()
}

/// The integral of a function from 0 to a number, in binary64: eight nodes of Gauss in each half until a piece and its
/// halves agree. Only the search reads it, to compare energies.
pub fn integral(f: &mut impl FnMut(f64) -> f64, to: f64) -> f64 {
    let whole = gauss(f, 0.0, to);
    let mut halving = Halving { f, tolerance: AGREED * whole.size, pieces: MOST_PIECES };
    halving.integral(0.0, to, whole)
}

/// Agreement of a sum and its halves, as a share of the magnitudes in the whole integral.
const AGREED: f64 = 4e-16;
/// Pieces for one integral: at a kink some thirty are halved.
const MOST_PIECES: u32 = 500;
const NODES: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// The sum over the nodes of an interval, and that of its magnitudes.
#[derive(Clone, Copy)]
struct Sum {
    value: f64,
    size: f64,
}

fn gauss(f: &mut impl FnMut(f64) -> f64, from: f64, to: f64) -> Sum {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let mut sum = Sum { value: 0.0, size: 0.0 };
    for (x, weight) in NODES {
        for side in [-x, x] {
            let part = weight * half * f(middle + side * half);
            sum = Sum { value: sum.value + part, size: sum.size + part.abs() };
        }
    }
    sum
}

struct Halving<'f, F> {
    f: &'f mut F,
    tolerance: f64,
    pieces: u32,
}

impl<F: FnMut(f64) -> f64> Halving<'_, F> {
    fn integral(&mut self, from: f64, to: f64, whole: Sum) -> f64 {
        let middle = 0.5 * (from + to);
        let (a, b) = (gauss(self.f, from, middle), gauss(self.f, middle, to));
        let both = a.value + b.value;
        let apart = (both - whole.value).abs() > self.tolerance;
        if !apart || self.pieces == 0 {
            return both;
        }
        self.pieces -= 1;
        self.integral(from, middle, a) + self.integral(middle, to, b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Dd, FileId};

    /// x, value, slope
    const PCHIP: [(f64, f64, f64); 9] = [
        (0.0, 0.0, 2.5),
        (0.25, 0.623_883_928_571_428_5, 2.450_892_857_142_856_8),
        (0.75, 1.684_151_785_714_285_6, 1.629_464_285_714_286),
        (1.0, 2.0, 0.857_142_857_142_857_1),
        (1.125, 2.098_272_728_643_822_3, 0.718_463_441_119_691_1),
        (2.0, 2.471_042_471_042_471, 0.292_471_042_471_042_4),
        (3.0, 3.0, 0.972_972_972_972_973),
        (3.5, 4.475_788_288_288_288, 4.465_090_090_090_09),
        (4.0, 7.0, 5.166_666_666_666_668),
    ];

    fn step(operation: Operation) -> Step {
        Step { operation, span: Span::new(FileId(0), 0, 0) }
    }

    fn law(steps: Vec<Operation>) -> Curve {
        Curve::new(steps.into_iter().map(step).collect()).expect("one number")
    }

    fn number(text: &str) -> Number {
        match text.strip_prefix('-') {
            Some(size) => -&Number::from(size),
            None => Number::from(text),
        }
    }

    /// 10 e + 2e5 e^3
    fn duffing() -> Curve {
        use Operation::*;
        let constant = |text| Constant(number(text));
        law(vec![constant("10"), Variable, Multiply, constant("2e5"), Variable, constant("3"), Power, Multiply, Add])
    }

    #[test]
    fn a_polynomial_and_its_derivative_are_exact() {
        let at = duffing().at(&number("-0.01")).expect("defined");
        assert_eq!((at.value, at.slope), (number("-0.3"), number("70")));
    }

    /// Each function compared with central differences of itself, whose error is h^2/6 times the third derivative, plus
    /// eps/h: below 1e-9.
    #[test]
    fn derivatives_are_those_of_the_functions() {
        use Function::*;
        let h = 1e-5;
        for function in [Sqrt, Abs, Sin, Cos, Tan, Asin, Acos, Atan, Exp, Ln] {
            let curve = law(vec![Operation::Variable, Operation::Call(function, 1)]);
            let value = |x: f64| curve.of(&x).0;
            let (x, slope) = (0.4, curve.of(&0.4).1);
            assert!((slope - (value(x + h) - value(x - h)) / (2.0 * h)).abs() < 1e-8, "{function:?}");
        }
        for function in [Min, Max, Atan2] {
            let constant = Operation::Constant(number("0.7"));
            let curve = law(vec![Operation::Variable, constant, Operation::Call(function, 2)]);
            let value = |x: f64| curve.of(&x).0;
            let slope = (value(0.4 + h) - value(0.4 - h)) / (2.0 * h);
            assert!((curve.of(&0.4).1 - slope).abs() < 1e-9, "{function:?}");
        }
    }

    /// The values and slopes of SciPy's `PchipInterpolator([0, 1, 3, 4], [0, 2, 3, 7])`.
    #[test]
    fn a_table_is_a_monotone_cubic() {
        let numbers = |list: &[i64]| list.iter().map(|n| Number::from(*n)).collect::<Vec<_>>();
        let rows = Arc::new(Rows::new(numbers(&[0, 1, 3, 4]), numbers(&[0, 2, 3, 7])).expect("rows"));
        let curve = law(vec![Operation::Variable, Operation::Table(rows)]);
        for (x, value, slope) in PCHIP {
            let (found, steep) = curve.of(&x);
            assert!((found - value).abs() < 1e-14 && (steep - slope).abs() < 1e-13, "{x}: {found} {steep}");
        }
        assert!(curve.at(&number("-0.001")).is_err() && curve.at(&number("4.001")).is_err());
        // Across a row both pieces count.
        let around = Number::Ball(Ball::new(Dd::from(1.0), 0.25));
        let found = curve.at(&around).expect("inside").value.to_ball();
        for (x, value, _) in PCHIP.into_iter().filter(|(x, ..)| (0.75..=1.25).contains(x)) {
            assert!((found.mid.hi - value).abs() <= found.rad, "{x}");
        }
    }

    #[test]
    fn a_kink_is_where_the_sides_differ() {
        use Operation::*;
        let sized = |factor: &str| {
            let steps = vec![Variable, Constant(number(factor)), Variable, Call(Function::Abs, 1), Multiply, Add];
            law(steps)
        };
        let near = |middle: f64| Number::Ball(Ball::new(Dd::from(middle), 1e-20));
        assert!(sized("3").kink(&near(0.0)).is_some() && sized("3").kink(&Number::ZERO).is_some());
        assert!(sized("3").kink(&near(1e-3)).is_none() && sized("0").kink(&near(0.0)).is_none());
        // e |e| has no kink, and its slope there is 0.
        let smooth = law(vec![Variable, Variable, Call(Function::Abs, 1), Multiply]);
        assert!(smooth.kink(&Number::ZERO).is_none());
        assert!(smooth.at(&Number::ZERO).expect("defined").slope.is_zero());
    }

    #[test]
    fn what_is_not_defined_has_no_value() {
        let root = law(vec![Operation::Variable, Operation::Call(Function::Sqrt, 1)]);
        assert!(root.at(&number("-1")).is_err() && root.at(&Number::ZERO).is_err());
        assert!(root.of(&-1.0).0.is_nan());
    }

    #[test]
    fn energies_are_integrals() {
        let near = |value: f64, truth: f64| (value / truth - 1.0).abs() < 1e-14;
        assert!(near(integral(&mut |x| 10.0 * x + 2e5 * x.powi(3), 0.01), 5e-4 + 5e4 * 1e-8));
        assert!(near(integral(&mut f64::exp, 2.0), f64::exp_m1(2.0)));
        let mut kinked = |x: f64| (x - 1.0 / 3.0).abs();
        assert!((integral(&mut kinked, 1.0) - 5.0 / 18.0).abs() < 1e-12);
        // The work is bounded even if the integral does not converge.
        assert!(integral(&mut |x| (1e9 * x).sin(), 1.0).is_finite());
    }
}
