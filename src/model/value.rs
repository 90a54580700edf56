//! Values of expressions and their arithmetic. In: quantities and plane vectors. Out: a value, or the reason why there
//! is none. Nothing here knows about names, places or the tree. See spec.md#units.

use crate::base::{Angle, Dimension, Number, Quantity, Rational, Vec3};
use std::sync::Arc;

/// The value of an expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Scalar(Scalar),
    Vector(Vector),
}

/// A quantity, or the bare `0` that fits any dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct Scalar {
    pub quantity: Quantity,
    /// Written as `0` without a unit: it fits wherever a number is expected.
    pub bare_zero: bool,
    /// The power of cycles in it: one for `Hz`, and one less for each `pi`, which only converts to radians. Motion is
    /// computed in radians, so `m * (50 Hz)^2` is not a stiffness.
    pub cycles: f64,
}

/// A position, a displacement or a direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Vector {
    pub si: Arc<Vec3>,
    /// `None` for `(0, 0)`, which fits any dimension.
    pub dimension: Option<Dimension>,
}

/// Why an operation has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Two dimensions that cannot be added or compared.
    Dimensions(Dimension, Dimension),
    /// A number combined with a point, or a point with a number; the needed kind as a phrase.
    Kind {
        needed: &'static str,
        found: &'static str,
    },
    /// A plain number is needed, but this has a dimension.
    NotPlain(Dimension),
    /// The exponent of a quantity with a dimension has to be a fraction of small whole numbers.
    Exponent,
    DivisionByZero,
    RootOfNegative,
    /// The function has no value here; its domain, as a phrase.
    Domain(&'static str),
    Overflow,
}

impl Value {
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Scalar(_) => "a number",
            Value::Vector(_) => "a point",
        }
    }
}

impl From<Quantity> for Value {
    fn from(quantity: Quantity) -> Value {
        Value::Scalar(Scalar::new(quantity))
    }
}

impl Scalar {
    pub fn new(quantity: Quantity) -> Scalar {
        let cycles = if quantity.angle == Angle::Cycles { 1.0 } else { 0.0 };
        Scalar { quantity, bare_zero: false, cycles }
    }

    pub fn bare_zero() -> Scalar {
        Scalar { quantity: Quantity::plain(Number::ZERO), bare_zero: true, cycles: 0.0 }
    }

    pub fn pi() -> Scalar {
        Scalar { cycles: -1.0, ..Scalar::new(Quantity::plain(Number::pi())) }
    }

    /// This value with this power of cycles; a value in radians has no cycles.
    fn of_cycles(self, cycles: f64) -> Scalar {
        let is_angle = self.quantity.angle == Angle::Radians;
        Scalar { cycles: if is_angle { 0.0 } else { cycles }, ..self }
    }

    /// The dimension that has to match; `None` for the bare zero.
    pub fn dimension(&self) -> Option<Dimension> {
        (!self.bare_zero).then_some(self.quantity.dimension)
    }
}

/// (x, y): components of the same dimension; a bare zero takes that of the other one.
pub fn vector(x: &Scalar, y: &Scalar) -> Result<Vector, Fault> {
    let dimension = common_dimension(x.dimension(), y.dimension())?;
    let si = Arc::new(Vec3::planar(x.quantity.si.clone(), y.quantity.si.clone()));
    Ok(Vector { si, dimension })
}

fn common_dimension(a: Option<Dimension>, b: Option<Dimension>) -> Result<Option<Dimension>, Fault> {
    match (a, b) {
        (Some(a), Some(b)) if a != b => Err(Fault::Dimensions(a, b)),
        (a, b) => Ok(a.or(b)),
    }
}

pub fn negate(value: &Value) -> Value {
    match value {
        Value::Scalar(scalar) => {
            let mut scalar = scalar.clone();
            scalar.quantity.si = -&scalar.quantity.si;
            Value::Scalar(scalar)
        }
        Value::Vector(vector) => {
            let si = Arc::new(vector.si.scale(&Number::from(-1)));
            Value::Vector(Vector { si, dimension: vector.dimension })
        }
    }
}

pub fn add(a: &Value, b: &Value) -> Result<Value, Fault> {
    match (a, b) {
        (Value::Scalar(a), Value::Scalar(b)) => add_scalars(a, b).map(Value::Scalar),
        (Value::Vector(a), Value::Vector(b)) => {
            let dimension = common_dimension(a.dimension, b.dimension)?;
            Ok(Value::Vector(Vector { si: Arc::new(a.si.add(&b.si)), dimension }))
        }
        (a, b) => Err(Fault::Kind { needed: a.kind(), found: b.kind() }),
    }
}

pub fn subtract(a: &Value, b: &Value) -> Result<Value, Fault> {
    add(a, &negate(b))
}

fn add_scalars(a: &Scalar, b: &Scalar) -> Result<Scalar, Fault> {
    match (a.bare_zero, b.bare_zero) {
        (true, _) => return Ok(b.clone()),
        (_, true) => return Ok(a.clone()),
        _ => {}
    }
    // Either of the two terms may be the mistake.
    let cycles = a.cycles.max(b.cycles);
    let (a, b) = (&a.quantity, &b.quantity);
    if a.dimension != b.dimension {
        return Err(Fault::Dimensions(a.dimension, b.dimension));
    }
    let angle = if a.angle == b.angle { a.angle } else { Angle::Plain };
    Ok(scalar(&a.si + &b.si, a.dimension, angle)?.of_cycles(cycles))
}

pub fn multiply(a: &Value, b: &Value) -> Result<Value, Fault> {
    match (a, b) {
        (Value::Scalar(a), Value::Scalar(b)) => multiply_scalars(a, b).map(Value::Scalar),
        (Value::Vector(v), Value::Scalar(s)) | (Value::Scalar(s), Value::Vector(v)) => scale(v, &s.quantity),
        (Value::Vector(_), Value::Vector(_)) => Err(Fault::Kind { needed: "a number", found: "a point" }),
    }
}

fn multiply_scalars(a: &Scalar, b: &Scalar) -> Result<Scalar, Fault> {
    let cycles = a.cycles + b.cycles;
    let (a, b) = (&a.quantity, &b.quantity);
    let dimension = a.dimension.times(b.dimension).ok_or(Fault::Exponent)?;
    Ok(scalar(&a.si * &b.si, dimension, product_angle(a, b))?.of_cycles(cycles))
}

fn scale(vector: &Vector, by: &Quantity) -> Result<Value, Fault> {
    let dimension = match vector.dimension {
        None if by.dimension.is_none() => None,
        given => Some(given.unwrap_or(Dimension::NONE).times(by.dimension).ok_or(Fault::Exponent)?),
    };
    Ok(Value::Vector(Vector { si: Arc::new(vector.si.scale(&by.si)), dimension }))
}

pub fn divide(a: &Value, b: &Value) -> Result<Value, Fault> {
    let Value::Scalar(Scalar { quantity: b, cycles: under, .. }) = b else {
        return Err(Fault::Kind { needed: "a number", found: "a point" });
    };
    let inverse = Quantity {
        si: b.si.recip().ok_or(Fault::DivisionByZero)?,
        dimension: b.dimension.pow(-1, 1).ok_or(Fault::Exponent)?,
        angle: Angle::Plain,
    };
    match a {
        Value::Vector(a) => scale(a, &inverse),
        Value::Scalar(Scalar { quantity: a, cycles, .. }) => {
            let dimension = a.dimension.times(inverse.dimension).ok_or(Fault::Exponent)?;
            // Dividing by the number rounds once; multiplying by its inverse would round twice.
            let quotient = scalar(&a.si / &b.si, dimension, quotient_angle(a, b))?;
            Ok(Value::Scalar(quotient.of_cycles(cycles - under)))
        }
    }
}

/// Whether a number only scales: exact, without dimension or angle.
fn only_scales(q: &Quantity) -> bool {
    q.dimension.is_none() && q.angle == Angle::Plain && q.si.exact().is_some()
}

fn is_angle(q: &Quantity) -> bool {
    q.dimension.is_none() && q.angle == Angle::Radians
}

/// `2*fn` stays in cycles, `2*pi*fn` is plain, `w * 1 rad` is in radians.
fn product_angle(a: &Quantity, b: &Quantity) -> Angle {
    if only_scales(b) {
        a.angle
    } else if only_scales(a) {
        b.angle
    } else if is_angle(a) && b.angle != Angle::Radians || is_angle(b) && a.angle != Angle::Radians {
        Angle::Radians
    } else {
        Angle::Plain
    }
}

/// Like [`product_angle`], for quotients: `1 rev / T` is in radians.
fn quotient_angle(a: &Quantity, b: &Quantity) -> Angle {
    if only_scales(b) {
        a.angle
    } else if is_angle(a) && b.angle == Angle::Plain {
        Angle::Radians
    } else {
        Angle::Plain
    }
}

/// a^b: b must be a plain number, and an exact fraction if a has a dimension.
pub fn power(a: &Value, b: &Value) -> Result<Value, Fault> {
    let cycles = cycles(a);
    let (a, b) = (quantity(a)?, quantity(b)?);
    let exponent = plain(b)?;
    let dimension = if a.dimension.is_none() {
        Dimension::NONE
    } else {
        let (numerator, denominator) = exponent.exact().and_then(Rational::to_fraction).ok_or(Fault::Exponent)?;
        a.dimension.pow(numerator, denominator).ok_or(Fault::Exponent)?
    };
    if exponent.is_negative() && a.si.may_be_zero() {
        return Err(Fault::DivisionByZero);
    }
    let raised = a.si.pow(exponent).ok_or_else(|| power_fault(&a.si))?;
    Ok(Value::Scalar(scalar(raised, dimension, Angle::Plain)?.of_cycles(cycles * exponent.to_f64())))
}

fn cycles(value: &Value) -> f64 {
    match value {
        Value::Scalar(scalar) => scalar.cycles,
        Value::Vector(_) => 0.0,
    }
}

fn power_fault(base: &Number) -> Fault {
    if base.is_positive() { Fault::Overflow } else { Fault::RootOfNegative }
}

fn scalar(si: Number, dimension: Dimension, angle: Angle) -> Result<Scalar, Fault> {
    if matches!(&si, Number::Ball(_) | Number::Jet(_)) && !si.is_finite() {
        return Err(Fault::Overflow);
    }
    Ok(Scalar { quantity: Quantity { si, dimension, angle }, bare_zero: false, cycles: 0.0 })
}

fn quantity(value: &Value) -> Result<&Quantity, Fault> {
    match value {
        Value::Scalar(scalar) => Ok(&scalar.quantity),
        Value::Vector(_) => Err(Fault::Kind { needed: "a number", found: "a point" }),
    }
}

fn plain(q: &Quantity) -> Result<&Number, Fault> {
    if q.dimension.is_none() { Ok(&q.si) } else { Err(Fault::NotPlain(q.dimension)) }
}

/// A function of the language.
#[derive(Clone, Copy, Debug)]
pub struct Function {
    pub name: &'static str,
    /// Least and largest number of arguments.
    pub arguments: (usize, usize),
    apply: fn(&[Value]) -> Result<Value, Fault>,
}

/// Every function of numbers.
pub const FUNCTIONS: [Function; 13] = [
    Function { name: "sqrt", arguments: (1, 1), apply: |a| square_root(&a[0]) },
    Function { name: "abs", arguments: (1, 1), apply: |a| absolute(&a[0]) },
    Function { name: "min", arguments: (1, MANY), apply: |a| extreme(a, false) },
    Function { name: "max", arguments: (1, MANY), apply: |a| extreme(a, true) },
    Function { name: "sin", arguments: (1, 1), apply: |a| trigonometric(&a[0], |s, _| Ok(s)) },
    Function { name: "cos", arguments: (1, 1), apply: |a| trigonometric(&a[0], |_, c| Ok(c)) },
    Function { name: "tan", arguments: (1, 1), apply: |a| trigonometric(&a[0], tangent) },
    Function { name: "asin", arguments: (1, 1), apply: |a| angle(plain(quantity(&a[0])?)?.asin(), "from -1 to 1") },
    Function { name: "acos", arguments: (1, 1), apply: |a| angle(plain(quantity(&a[0])?)?.acos(), "from -1 to 1") },
    Function { name: "atan", arguments: (1, 1), apply: |a| arctangent(plain(quantity(&a[0])?)?, &Number::ONE) },
    Function { name: "atan2", arguments: (2, 2), apply: |a| arctangent_of_two(&a[0], &a[1]) },
    Function { name: "exp", arguments: (1, 1), apply: |a| number(plain(quantity(&a[0])?)?.exp(), Fault::Overflow) },
    Function { name: "ln", arguments: (1, 1), apply: |a| logarithm(plain(quantity(&a[0])?)?) },
];

/// The number of arguments is limited only by the length of the text.
const MANY: usize = usize::MAX;

impl Function {
    pub fn by_name(name: &str) -> Option<&'static Function> {
        FUNCTIONS.iter().find(|function| function.name == name)
    }

    /// The value; the caller has checked the number of arguments.
    pub fn apply(&self, arguments: &[Value]) -> Result<Value, Fault> {
        (self.apply)(arguments)
    }
}

fn number(value: Option<Number>, fault: Fault) -> Result<Value, Fault> {
    scalar(value.ok_or(fault)?, Dimension::NONE, Angle::Plain).map(Value::Scalar)
}

fn angle(value: Option<Number>, domain: &'static str) -> Result<Value, Fault> {
    scalar(value.ok_or(Fault::Domain(domain))?, Dimension::NONE, Angle::Radians).map(Value::Scalar)
}

fn square_root(value: &Value) -> Result<Value, Fault> {
    let q = quantity(value)?;
    let dimension = q.dimension.pow(1, 2).ok_or(Fault::Exponent)?;
    let root = scalar(q.si.sqrt().ok_or(Fault::RootOfNegative)?, dimension, Angle::Plain)?;
    Ok(Value::Scalar(root.of_cycles(cycles(value) / 2.0)))
}

fn absolute(value: &Value) -> Result<Value, Fault> {
    let mut result = value.clone();
    let size = quantity(value)?.si.abs();
    if let Value::Scalar(scalar) = &mut result {
        scalar.quantity.si = size;
    }
    Ok(result)
}

fn trigonometric(value: &Value, pick: fn(Number, Number) -> Result<Number, Fault>) -> Result<Value, Fault> {
    let (sine, cosine) = plain(quantity(value)?)?.sin_cos().ok_or(Fault::Domain("known to less than a radian"))?;
    scalar(pick(sine, cosine)?, Dimension::NONE, Angle::Plain).map(Value::Scalar)
}

fn tangent(sine: Number, cosine: Number) -> Result<Number, Fault> {
    sine.checked_div(&cosine).ok_or(Fault::DivisionByZero)
}

fn arctangent(y: &Number, x: &Number) -> Result<Value, Fault> {
    angle(Number::atan2(y, x), "away from (0, 0)")
}

fn arctangent_of_two(y: &Value, x: &Value) -> Result<Value, Fault> {
    let (Value::Scalar(a), Value::Scalar(b)) = (y, x) else {
        return Err(Fault::Kind { needed: "a number", found: "a point" });
    };
    common_dimension(a.dimension(), b.dimension())?;
    arctangent(&a.quantity.si, &b.quantity.si)
}

fn logarithm(x: &Number) -> Result<Value, Fault> {
    number(x.ln(), Fault::Domain("greater than 0"))
}

/// The smallest or the largest value; bare zeros take the dimension of the others.
fn extreme(values: &[Value], largest: bool) -> Result<Value, Fault> {
    let mut best = values[0].clone();
    quantity(&best)?;
    for value in &values[1..] {
        quantity(value)?;
        best = extreme_of_two(&best, value, largest)?;
    }
    Ok(best)
}

fn extreme_of_two(a: &Value, b: &Value, largest: bool) -> Result<Value, Fault> {
    // Their sum exists if they can be compared, and gives the dimension and the angle.
    let Value::Scalar(mut result) = add(a, b)? else { return Ok(a.clone()) };
    let (p, q) = (&quantity(a)?.si, &quantity(b)?.si);
    result.quantity.si = match q.compare(p) {
        Some(order) if order.is_gt() == largest => q.clone(),
        Some(_) => p.clone(),
        // Too close to tell: a ball that contains both.
        None => p.to_ball().widen((p - q).to_ball().magnitude()).into(),
    };
    Ok(Value::Scalar(result))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantity_of(si: &str, dimension: Dimension, angle: Angle) -> Value {
        Quantity { si: Number::from(si), dimension, angle }.into()
    }

    fn plain_number(si: &str) -> Value {
        quantity_of(si, Dimension::NONE, Angle::Plain)
    }

    fn hertz(si: &str) -> Value {
        quantity_of(si, Dimension::FREQUENCY, Angle::Cycles)
    }

    fn angle_of(value: Result<Value, Fault>) -> Angle {
        quantity(&value.expect("a value")).expect("a number").angle
    }

    #[test]
    fn the_kind_of_angle_is_kept_where_only_the_size_changes() {
        let radian = quantity_of("1", Dimension::NONE, Angle::Radians);
        let pi = Value::from(Quantity::plain(Number::pi()));
        let plain_rate = quantity_of("3", Dimension::FREQUENCY, Angle::Plain);
        assert_eq!(angle_of(multiply(&plain_number("2"), &hertz("10"))), Angle::Cycles);
        assert_eq!(angle_of(divide(&hertz("10"), &plain_number("2"))), Angle::Cycles);
        assert_eq!(angle_of(add(&hertz("10"), &hertz("1"))), Angle::Cycles);
        assert_eq!(angle_of(multiply(&pi, &hertz("10"))), Angle::Plain);
        assert_eq!(angle_of(multiply(&plain_rate, &radian)), Angle::Radians);
        assert_eq!(angle_of(multiply(&hertz("10"), &radian)), Angle::Radians);
        assert_eq!(angle_of(divide(&radian, &quantity_of("2", Dimension::TIME, Angle::Plain))), Angle::Radians);
        assert_eq!(angle_of(add(&hertz("10"), &plain_rate)), Angle::Plain);
    }

    #[test]
    fn cycles_are_counted_until_pi_makes_radians_of_them() {
        let (pi, two) = (Value::Scalar(Scalar::pi()), plain_number("2"));
        let (mass, frequency) = (quantity_of("4", Dimension::MASS, Angle::Plain), hertz("50"));
        let times = |a: &Value, b: &Value| multiply(a, b).expect("a number");
        let square = |a: &Value| power(a, &two).expect("a number");
        let trap = times(&mass, &square(&frequency));
        assert_eq!(cycles(&trap), 2.0);
        assert_eq!(cycles(&times(&mass, &square(&times(&times(&two, &pi), &frequency)))), 0.0);
        assert_eq!(cycles(&times(&trap, &square(&pi))), 0.0);
        assert_eq!(cycles(&divide(&frequency, &frequency).expect("a number")), 0.0);
        assert_eq!(cycles(&divide(&mass, &frequency).expect("a number")), -1.0);
        assert_eq!(cycles(&square_root(&trap).expect("a number")), 1.0);
        let radian = quantity_of("1", Dimension::NONE, Angle::Radians);
        assert_eq!(cycles(&times(&frequency, &radian)), 0.0);
    }

    #[test]
    fn roots_and_powers_have_dimensions() {
        let stiffness = quantity_of("400", Dimension::STIFFNESS, Angle::Plain);
        let mass = quantity_of("4", Dimension::MASS, Angle::Plain);
        let rate = divide(&stiffness, &mass).and_then(|ratio| power(&ratio, &plain_number("0.5")));
        assert_eq!(rate, Ok(quantity_of("10", Dimension::FREQUENCY, Angle::Plain)));
        assert_eq!(power(&mass, &mass), Err(Fault::NotPlain(Dimension::MASS)));
        assert_eq!(power(&mass, &Value::from(Quantity::plain(Number::pi()))), Err(Fault::Exponent));
        let area = Quantity { si: Number::from(9), dimension: Dimension::of(0, 2, 0), angle: Angle::Plain };
        assert_eq!(square_root(&area.into()), Ok(quantity_of("3", Dimension::LENGTH, Angle::Plain)));
    }

    #[test]
    fn faults_are_distinguished() {
        let mass = quantity_of("4", Dimension::MASS, Angle::Plain);
        let apply = |name: &str, values: &[Value]| Function::by_name(name).expect("a function").apply(values);
        assert_eq!(divide(&mass, &plain_number("0")), Err(Fault::DivisionByZero));
        assert_eq!(power(&plain_number("0"), &negate(&plain_number("1"))), Err(Fault::DivisionByZero));
        assert_eq!(apply("sqrt", &[negate(&mass)]), Err(Fault::RootOfNegative));
        assert_eq!(apply("sin", std::slice::from_ref(&mass)), Err(Fault::NotPlain(Dimension::MASS)));
        assert_eq!(apply("exp", &[plain_number("1e6")]), Err(Fault::Overflow));
        assert_eq!(add(&mass, &hertz("1")), Err(Fault::Dimensions(Dimension::MASS, Dimension::FREQUENCY)));
        assert!(matches!(apply("asin", &[plain_number("2")]), Err(Fault::Domain(_))));
    }

    #[test]
    fn a_bare_zero_takes_any_dimension() {
        let zero = Value::Scalar(Scalar::bare_zero());
        let mass = quantity_of("4", Dimension::MASS, Angle::Plain);
        assert_eq!(add(&zero, &mass), Ok(mass.clone()));
        let largest = Function::by_name("max").expect("a function").apply(&[zero.clone(), mass.clone()]);
        assert_eq!(largest, Ok(mass));
        let Value::Scalar(zero) = zero else { panic!("a number") };
        assert_eq!(vector(&zero, &zero).map(|v| v.dimension), Ok(None));
    }
}
