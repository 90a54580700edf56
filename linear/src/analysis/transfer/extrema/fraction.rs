//! H of an input and an output as a quotient of two polynomials in s: det [Q, b; -p^T, d] / det Q. In: a small system.
//! Out: its zeros and poles, and the factor before them. Rational numbers give exact polynomials, and common factors
//! are cancelled; for others the midpoints are used, and each coefficient gets an error bound. See
//! docs/method/transfer.md#extrema.

use super::expansion::{Sized, spread};
use super::far::Far;
use super::roots::{Coefficients, Place, Root, Roots, near_and_far};
use crate::analysis::modes::parts::Part;
use crate::base::{Ball, Dd, Number, Rational, down, up};
use crate::kernel::polynomial::{Polynomial, determinant};
use crate::system::{CoordinateId, Form, LinearSystem, Output};
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Zero};
use std::cmp::Ordering;

/// For more coordinates than this, exact arithmetic takes longer than the tables.
const MOST_COORDINATES: usize = 12;

/// Limit of coordinates for numbers known as enclosures.
pub const MOST_ENCLOSED: usize = 9;

/// det Q of a system, prepared for its inputs and outputs.
#[derive(Clone, Debug)]
pub struct Denominator {
    /// The coordinates of Q, ascending.
    coordinates: Vec<u32>,
    q: Vec<Vec<Entry>>,
    determinant: Determinant,
    roots: Roots,
}

/// The coordinates of the independent parts on which the input acts and that the output sees: no others contribute to
/// H.
pub fn coordinates_between(system: &LinearSystem, parts: &[Part], input: usize, output: usize) -> Vec<u32> {
    let among = |powers: &[Vec<(CoordinateId, Number)>; 3], part: &Part| {
        powers.iter().flatten().any(|(i, _)| part.coordinates.binary_search(&i.0).is_ok())
    };
    let seen = |part: &&Part| among(&system.inputs[input].b, part) && among(&system.outputs[output].p, part);
    let mut list: Vec<u32> = parts.iter().filter(seen).flat_map(|part| part.coordinates.iter().copied()).collect();
    list.sort_unstable();
    list
}

/// H(s) = lead prod ((s - z) / unit) / prod ((s - p) / unit), but for roots that are far away
#[derive(Clone, Debug)]
pub struct Factored {
    pub lead: Ball,
    /// A power of two, rad/s.
    pub unit: f64,
    pub zeros: Vec<Root>,
    pub poles: Vec<Root>,
    pub far: Far,
}

/// H = factor above / below of inputs that act together, exactly. Common factors are not cancelled.
pub struct Quotient {
    pub factor: Rational,
    pub above: Polynomial,
    /// det Q
    pub below: Polynomial,
}

impl Quotient {
    /// `None` if the system is too large, det Q vanishes for every s, or a number is not rational.
    pub fn of(system: &LinearSystem, inputs: &[usize], output: &Output) -> Option<Quotient> {
        let n = system.n();
        if n > MOST_COORDINATES {
            return None;
        }
        let all: Vec<u32> = (0..n as u32).collect();
        let mut rows = dynamic_stiffness(system, &all)?;
        let below = Determinant::of(&rows, 2 * n)?;
        let together = |power: usize| inputs.iter().flat_map(|&input| system.inputs[input].b[power].clone()).collect();
        let (b, p) = (column(&[together(0), together(1), together(2)], &all)?, column(&output.p, &all)?);
        let above = bordered_determinant(&mut rows, b, p, through(output, inputs)?, 2 * n + 2)?;
        let is_known = above.polynomial.is_exact() && below.polynomial.is_exact() && !below.polynomial.middle.is_zero();
        let factor = || Rational::from(&above.factor / &below.factor);
        is_known.then(|| Quotient { factor: factor(), above: above.polynomial.middle, below: below.polynomial.middle })
    }
}

impl Factored {
    /// A function whose square on the axis is above / below, two polynomials in omega^2 that are not negative there, but for a
    /// factor: the zeros and poles on the left, and half of those on the axis.
    pub fn of_square(above: &Polynomial, below: &Polynomial) -> Option<Factored> {
        let common = above.gcd(below)?;
        let half = |f: &Polynomial| {
            let mut list =
                near_and_far(&Coefficients::exact(f.primitive().divided_by(&common)?.of_minus_square()))?.list;
            list.retain(|root| root.centre.re.sign() != Ordering::Greater);
            for root in list.iter_mut().filter(|root| root.centre.re.is_zero()) {
                let is_whole = root.multiplicity % 2 == 0 && root.place != Place::Cluster;
                is_whole.then(|| root.multiplicity /= 2)?;
            }
            Some(list)
        };
        let (zeros, poles) = (half(above)?, half(below)?);
        Some(Factored { lead: Ball::ONE, unit: 1.0, zeros, poles, far: Far::NONE })
    }
}

/// a0 + a1 s + a2 s^2
type Entry = [MidRadius; 3];

/// The midpoint of an enclosure, and its radius.
#[derive(Clone, Debug)]
struct MidRadius {
    middle: Rational,
    radius: f64,
}

/// A determinant: `factor` times a polynomial.
#[derive(Clone, Debug)]
struct Determinant {
    factor: BigRational,
    polynomial: Coefficients,
}

impl Denominator {
    /// `None` if the system is too large, det Q vanishes for every s, or its roots cannot be separated.
    pub fn of(system: &LinearSystem, coordinates: &[u32]) -> Option<Denominator> {
        let n = coordinates.len();
        if n > MOST_COORDINATES {
            return None;
        }
        let q = dynamic_stiffness(system, coordinates)?;
        let determinant = Determinant::of(&q, 2 * n)?;
        if determinant.polynomial.middle.is_zero() {
            return None;
        }
        let roots = near_and_far(&determinant.polynomial)?;
        Some(Denominator { coordinates: coordinates.to_vec(), q, determinant, roots })
    }

    /// `None` if roots cannot be separated, or a number of the input or the output is unknown.
    pub fn pair(&self, system: &LinearSystem, input: usize, output: usize) -> Option<Factored> {
        let n = self.coordinates.len();
        let column = |powers| column(powers, &self.coordinates);
        let (b, p) = (column(&system.inputs[input].b)?, column(&system.outputs[output].p)?);
        let through = through(&system.outputs[output], &[input])?;
        let numerator = bordered_determinant(&mut self.q.clone(), b, p, through, 2 * n + 2)?;
        if numerator.polynomial.middle.is_zero() {
            // The input has no effect on the output.
            let (zeros, poles) = (Vec::new(), Vec::new());
            let nothing = Factored { lead: Ball::ZERO, unit: 1.0, zeros, poles, far: Far::NONE };
            return numerator.polynomial.is_exact().then_some(nothing);
        }
        let (above, below) = (&numerator.polynomial, &self.determinant.polynomial);
        let factor = Rational::from(&numerator.factor / &self.determinant.factor).to_ball();
        let common = match above.is_exact() && below.is_exact() {
            true => above.middle.gcd(&below.middle)?,
            false => Polynomial::new(vec![BigInt::one()]),
        };
        let rest = |f: &Coefficients| Some(Coefficients::exact(f.middle.divided_by(&common)?));
        let (zeros, poles) = match common.degree() {
            0 => (near_and_far(above)?, self.roots.clone()),
            _ => (near_and_far(&rest(above)?)?, near_and_far(&rest(below)?)?),
        };
        let lead = factor * (zeros.lead / poles.lead);
        let far = zeros.far.and(poles.far);
        Some(Factored { lead, unit: 1.0, zeros: zeros.list, poles: poles.list, far })
    }
}

impl Determinant {
    /// The determinant, of degree at most `most`; `None` if that is too large for the arithmetic here.
    fn of(rows: &[Vec<Entry>], most: usize) -> Option<Determinant> {
        let is_exact = rows.iter().flatten().flatten().all(|x| x.radius == 0.0);
        if !is_exact && rows.len() > MOST_ENCLOSED + 1 {
            return None;
        }
        let numbers = || rows.iter().flatten().flatten().map(|x| x.middle.to_big());
        let common = numbers().fold(BigInt::one(), |lcm, x| lcm.lcm(x.denom()));
        let mut cleared = numbers().map(|x| x.numer() * (&common / x.denom()));
        let cleared: Vec<Vec<[BigInt; 3]>> = rows
            .iter()
            .map(|row| row.iter().map(|_| [(); 3].map(|_| cleared.next().unwrap_or_default())).collect())
            .collect();
        let at = |s: i64| {
            let value = |[a, b, c]: &[BigInt; 3]| (c * s + b) * s + a;
            determinant(cleared.iter().map(|row| row.iter().map(value).collect()).collect())
        };
        let values: Vec<BigInt> = (0..=most as i64).map(at).collect();
        let middle = Polynomial::through(&values);
        if middle.is_zero() {
            let radii = if is_exact { Vec::new() } else { vec![f64::INFINITY] };
            return Some(Determinant {
                factor: BigRational::one(),
                polynomial: Coefficients { middle, radii, far: 0 },
            });
        }
        // The polynomial is primitive: one value determines the missing factor.
        let (s, found) = values.iter().enumerate().find(|(_, value)| !value.is_zero())?;
        let all = (0..rows.len()).fold(BigInt::one(), |power, _| power * &common);
        let factor = BigRational::new(found.clone(), all * value(&middle, s as i64));
        let sized = |x: &MidRadius| Sized { size: x.middle.to_f64().abs() * up::FEW, radius: x.radius };
        let radii = if is_exact {
            Vec::new()
        } else {
            let sized: Vec<Vec<[Sized; 3]>> =
                rows.iter().map(|row| row.iter().map(|entry| entry.each_ref().map(sized)).collect()).collect();
            let scale = Rational::from(factor.clone()).to_f64().abs() * down::FEW;
            spread(&sized).into_iter().map(|radius| radius / scale * up::DOZENS).collect()
        };
        Some(Determinant { factor, polynomial: Coefficients { middle, radii, far: 0 } })
    }
}

fn value(f: &Polynomial, s: i64) -> BigInt {
    f.coefficients().iter().rev().fold(BigInt::zero(), |sum, a| sum * s + a)
}

impl MidRadius {
    /// `None` if nothing is known of the number.
    fn of(number: &Number) -> Option<MidRadius> {
        if let Some(exact) = number.exact() {
            return Some(MidRadius { middle: exact.clone(), radius: 0.0 });
        }
        let Ball { mid: Dd { hi, lo }, rad } = number.to_ball();
        let middle = &Rational::from_f64(hi)? + &Rational::from_f64(lo)?;
        rad.is_finite().then_some(MidRadius { middle, radius: rad })
    }
}

fn entry(numbers: [Number; 3]) -> Option<Entry> {
    let [a, b, c] = numbers.each_ref().map(MidRadius::of);
    Some([a?, b?, c?])
}

/// Q of some coordinates; `None` if nothing is known of a number.
fn dynamic_stiffness(system: &LinearSystem, coordinates: &[u32]) -> Option<Vec<Vec<Entry>>> {
    let n = coordinates.len();
    let mut q: Vec<Vec<[Number; 3]>> = vec![vec![[Number::ZERO, Number::ZERO, Number::ZERO]; n]; n];
    for (power, form) in [&system.k, &system.c, &system.m].into_iter().enumerate() {
        add(form, power, coordinates, &mut q);
    }
    let known = |row: Vec<[Number; 3]>| row.into_iter().map(entry).collect();
    q.into_iter().map(known).collect()
}

/// det [Q, b; -p^T, d] = det Q (d + p^T Q^-1 b), of degree at most `most`.
fn bordered_determinant(
    q: &mut Vec<Vec<Entry>>,
    b: Vec<Entry>,
    p: Vec<Entry>,
    d: Entry,
    most: usize,
) -> Option<Determinant> {
    q.iter_mut().zip(b).for_each(|(row, b)| row.push(b));
    let negated = |entry: Entry| entry.map(|x| MidRadius { middle: -&x.middle, ..x });
    q.push(p.into_iter().map(negated).chain([d]).collect());
    Determinant::of(q, most)
}

/// Adds sum w a a^T, times s^power.
fn add(form: &Form, power: usize, coordinates: &[u32], q: &mut [Vec<[Number; 3]>]) {
    for term in form.terms() {
        let row = || form.row(term).iter().filter_map(|(i, a)| Some((coordinates.binary_search(&i.0).ok()?, a)));
        for (i, a) in row() {
            let weighted = term.weight * a;
            for (j, b) in row() {
                let entry = &mut q[i][j][power];
                *entry = &*entry + &(&weighted * b);
            }
        }
    }
}

/// Entries of other coordinates have no effect on H.
fn column(powers: &[Vec<(CoordinateId, Number)>; 3], coordinates: &[u32]) -> Option<Vec<Entry>> {
    let mut dense: Vec<[Number; 3]> = vec![[Number::ZERO, Number::ZERO, Number::ZERO]; coordinates.len()];
    for (power, list) in powers.iter().enumerate() {
        for (i, x) in list {
            let Ok(place) = coordinates.binary_search(&i.0) else { continue };
            dense[place][power] = &dense[place][power] + x;
        }
    }
    dense.into_iter().map(entry).collect()
}

fn through(output: &Output, inputs: &[usize]) -> Option<Entry> {
    let of = |power: usize| {
        let list = output.d[power].iter().filter(|(u, _)| inputs.contains(&(*u as usize)));
        list.fold(Number::ZERO, |sum, (_, x)| &sum + x)
    };
    entry([of(0), of(1), of(2)])
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::analysis::test_systems::{blank, oscillator, push};
    use crate::analysis::transfer::Frequency;
    use crate::analysis::transfer::extrema::Exactly;

    /// A stiffness known to 1e-3: the enclosure of the gain contains that for 4.001 too.
    #[test]
    fn uncertainty_of_a_stiffness_is_in_the_gain() {
        let gain = |stiffness: Number| {
            let mut system = oscillator("1", "0.5", "4");
            let term = system.k.term(0);
            let mut k = Form::new();
            let source = k.source(system.k.source_of(term.source));
            k.push(source, term.nature, stiffness, system.k.row(term).copies());
            system.k = k;
            let factored = Denominator::of(&system, &[0]).expect("roots").pair(&system, 0, 0).expect("roots");
            Exactly::of(&factored).expect("in range").gain(&Frequency::radians(&Number::ONE)).disc().expect("finite")
        };
        let (reported, truth) = (gain(Number::Ball(Ball::from(4.0).widen(1e-3))), gain(Number::from("4.001")));
        let error = (reported.value - truth.value).to_f64().abs();
        assert!(error > 1e-5 && error <= reported.radius && reported.radius < 0.01, "{error:e} {:e}", reported.radius);
    }

    /// Two masses between walls, Q = [s^2 + 2, -1; -1, s^2 + s + 2], with forces f and 2 f on them: the sum of both displacements and f.
    #[test]
    fn inputs_that_act_together_have_one_quotient() {
        let mut system = blank(2);
        for i in 0..2 {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "1", i, None);
        }
        push(&mut system.k, "1", 0, Some(1));
        push(&mut system.c, "1", 1, None);
        system.inputs[1].b[0][0].1 = Number::from("2");
        system.outputs[0].p[0].push((CoordinateId(1), Number::ONE));
        system.outputs[0].d[0].push((1, Number::from("0.5")));
        let output = system.outputs[0].clone();
        let found = Quotient::of(&system, &[0, 1], &output).expect("rational");
        let at = |f: &Polynomial, s: i64| Rational::from(BigRational::from(value(f, s)));
        for s in 1..6i64 {
            let [first, second] = [s * s + 2, s * s + s + 2];
            let determinant = first * second - 1;
            // p^T adj(Q) b + d det Q, with b = (1, 2) and p = (1, 1).
            let above = BigRational::from(BigInt::from(second + 2 + 1 + 2 * first))
                + BigRational::new(BigInt::from(determinant), BigInt::from(2));
            let truth = Rational::from(above / BigRational::from(BigInt::from(determinant)));
            let both = &found.factor * &at(&found.above, s);
            assert_eq!(both, &truth * &at(&found.below, s), "{s}");
        }
        // 1 / (s^2 + s / 2 + 4), and s^2 + 1 / det Q of three masses between walls, from the last to the first.
        let mut row = blank(3);
        for i in 0..3 {
            push(&mut row.m, "1", i, None);
            push(&mut row.k, "1", i, i.checked_sub(1));
        }
        push(&mut row.k, "1", 2, None);
        row.outputs[0].d[2].push((2, Number::ONE));
        for (system, input) in [(oscillator("1", "0.5", "4"), 0), (row, 2)] {
            let output = system.outputs[0].clone();
            let found = Quotient::of(&system, &[input], &output).expect("rational");
            for s in 0..12i64 {
                let d = s * s + 2;
                let [below, above] = match input {
                    0 => [2 * s * s + s + 8, 2],
                    _ => [d * (d * d - 2), 1 + s * s * d * (d * d - 2)],
                };
                let both = &(&found.factor * &at(&found.above, s)) * &Rational::from(below);
                assert_eq!(both, &Rational::from(above) * &at(&found.below, s), "{input} {s}");
            }
        }
        // Uncertain numbers, no stiffness at all, and too many coordinates.
        let mut uncertain = oscillator("1", "0.5", "4");
        uncertain.inputs[0].b[0][0].1 = Number::Ball(Ball::ONE.widen(1e-3));
        let mut uncertain_below = oscillator("1", "0.5", "4");
        let term = uncertain_below.k.term(0);
        let (nature, source) = (term.nature, uncertain_below.k.source_of(term.source));
        let row: Vec<_> = uncertain_below.k.row(term).iter().map(|(i, a)| (*i, a.clone())).collect();
        let source = uncertain_below.k.source(source);
        uncertain_below.k.push(source, nature, Number::Ball(Ball::ZERO.widen(1e-3)), row);
        let nothing = blank(1);
        let large = blank(MOST_COORDINATES + 1);
        for system in [uncertain, uncertain_below, nothing, large] {
            let output = system.outputs[0].clone();
            assert!(Quotient::of(&system, &[0], &output).is_none());
        }
    }

    /// |H|^2 = (u - 4)^2 / (u^2 - 6 u + 25), u = omega^2, of H = (s^2 + 4) / (s^2 + 2 s + 5): the roots on the left, and half of those on the
    /// axis, common factors aside.
    #[test]
    fn a_function_has_half_of_the_roots_of_its_square() {
        let polynomial = |list: &[i64]| Polynomial::new(list.iter().map(|&a| a.into()).collect());
        let facts = |list: &[Root]| -> Vec<(f64, f64, usize)> {
            list.iter().map(|root| (root.centre.re.to_f64(), root.centre.im.to_f64(), root.multiplicity)).collect()
        };
        // s^4 + 6 s^2 + 25 = (s^2 + 2 s + 5)(s^2 - 2 s + 5)
        let below = polynomial(&[25, -6, 1]);
        let found = Factored::of_square(&polynomial(&[16, -8, 1]), &below).expect("roots");
        assert_eq!((facts(&found.zeros), facts(&found.poles)), (vec![(0.0, 2.0, 1)], vec![(-1.0, 2.0, 1)]));
        assert_eq!((found.lead, found.unit), (Ball::ONE, 1.0));
        // Times u^2 + 1 and 3 u^2 + 3.
        let found = Factored::of_square(&polynomial(&[16, -8, 17, -8, 1]), &polynomial(&[75, -18, 78, -18, 3]));
        let found = found.expect("roots");
        assert_eq!((facts(&found.zeros), facts(&found.poles)), (vec![(0.0, 2.0, 1)], vec![(-1.0, 2.0, 1)]));
        // u is omega squared, and u^2 is that of omega^2.
        for (above, multiplicity) in [(polynomial(&[0, 1]), 1), (polynomial(&[0, 0, 1]), 2)] {
            assert_eq!(facts(&Factored::of_square(&above, &below).expect("roots").zeros), [(0.0, 0.0, multiplicity)]);
        }
        // u - 4 has a sign: the square of no function.
        assert!(Factored::of_square(&polynomial(&[-4, 1]), &below).is_none());
    }
}
