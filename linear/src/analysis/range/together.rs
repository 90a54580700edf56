//! Systems over one box of parameters. In: the system with the derivatives by each parameter in turn, and the system in the middle of
//! the box. Out: the same systems in coordinates in which they are nearly diagonal, with narrower numbers. See
//! docs/method/studies.md#coordinates-over-a-box.
//!
//! A ball of an entry of K does not know that the same spring is in its neighbours, nor that the same parameter is. In the coordinates
//! of the modes in the middle, with the mean value theorem for each entry from the derivatives by all parameters, what is left of this
//! is of the second order of the widths.

use super::linear::{JetMatrix, border};
use super::{Family, Lead, number};
use crate::base::{Ball, Jet, Number, up};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::product;
use crate::system::LinearSystem;
use nalgebra::{DMatrix, SymmetricEigen};

type Entries = Vec<Vec<Number>>;

/// What families over one box share.
#[derive(Clone, Debug)]
pub struct Together {
    /// The coordinates of the system as combinations of those of the families.
    basis: Entries,
    /// M, C and K with the derivatives by each parameter.
    forms: Vec<[Entries; 3]>,
    /// The same in the middle.
    centre: [Entries; 3],
    radius: Vec<f64>,
}

impl Together {
    /// `systems`: over the box, each with the derivatives by another parameter; `middle`: with every parameter in the middle of its part;
    /// `radius`: half the width of each part. `None` if they are too large, or have not the same coordinates.
    pub fn of(systems: &[&LinearSystem], middle: &LinearSystem, radius: &[f64]) -> Option<Together> {
        let plain = systems.iter().map(|system| Family::of(system, false)).collect::<Option<Vec<Family>>>()?;
        let centre = Family::of(middle, false)?;
        let names = middle.coordinate_names();
        if plain.len() != radius.len() || systems.iter().any(|system| system.coordinate_names() != names) {
            return None;
        }
        let n = centre.coordinates();
        let one = || Matrix::from_fn(n, n, |i, j| if i == j { Ball::ONE } else { Ball::ZERO });
        // Any regular matrix would be valid; a singular one makes every system singular, which no proof takes for regular.
        let basis = modes(&centre).unwrap_or_else(one);
        let narrowed = |pick: for<'a> fn(&'a Family) -> &'a Entries| {
            let forms: Vec<&Entries> = plain.iter().map(pick).collect();
            narrow(&forms, pick(&centre), &basis, radius)
        };
        let [m, c, k] = [narrowed(|family| &family.m), narrowed(|family| &family.c), narrowed(|family| &family.k)];
        let forms = m.into_iter().zip(c).zip(k).map(|((m, c), k)| [m, c, k]).collect();
        let transposed = Matrix::from_fn(n, n, |i, j| basis[(j, i)]);
        let still = |form: &Entries| -> Entries {
            let middle = Matrix::from_fn(n, n, |i, j| form[i][j].enclosure());
            let middle = product(&transposed, &product(&middle, &basis));
            (0..n).map(|i| (0..n).map(|j| Number::Ball(middle[(i, j)])).collect()).collect()
        };
        let centre = [still(&centre.m), still(&centre.c), still(&centre.k)];
        let basis = (0..n).map(|i| (0..n).map(|j| Number::Ball(basis[(i, j)])).collect()).collect();
        Some(Together { basis, forms, centre, radius: radius.to_vec() })
    }

    /// The family with the derivatives by the parameter with this index.
    pub fn family<'a>(&self, system: &'a LinearSystem, own: usize) -> Option<Family<'a>> {
        let [m, c, k] = self.forms.get(own)?.clone();
        Some(Family { system, lost: false, m, c, k, basis: Some(self.basis.clone()), lead: None })
    }

    /// The families led by a mode ([`Family::led_by`]), whose omega^2 is enclosed with the derivative by each parameter, and in the middle.
    pub fn led_families<'a>(&self, families: &[Family<'a>], squares: &[Jet], middle: Ball) -> Option<Vec<Family<'a>>> {
        let led = families.iter().zip(squares).map(|(family, square)| family.led_by(square));
        let mut led = led.collect::<Option<Vec<Family>>>()?;
        let [m, c, k] = self.centre.clone();
        let centre = Family { m, c, k, ..families.first()?.clone() };
        // Which coordinate the mode takes the place of is decided by the same numbers for all, in the middle by others.
        let centre = centre.led_by(&Jet { value: middle, slope: Ball::ZERO });
        let index = |family: &Family| family.lead.as_ref().map(|lead| lead.index);
        let Some(centre) = centre.filter(|centre| led.iter().all(|family| index(family) == index(centre))) else {
            return Some(led);
        };
        for pick in [Family::numbers_of_m, Family::numbers_of_c, Family::numbers_of_k, Family::numbers_of_basis] {
            let mut middle = centre.clone();
            let middle: Vec<Ball> = pick(&mut middle).map(|number| number.enclosure()).collect();
            let all: Vec<Vec<Jet>> =
                led.iter_mut().map(|family| pick(family).map(|number| Jet::of(number)).collect()).collect();
            let value = |place: usize| {
                let slopes = all.iter().zip(&self.radius);
                let reach = slopes.fold(0.0, |sum, (jets, radius)| sum + jets[place].slope.magnitude() * radius);
                let by_mean = middle[place].widen(reach * up::THOUSANDS);
                let own = all[0][place].value;
                narrower(own, by_mean)
            };
            let values: Vec<Ball> = (0..middle.len()).map(value).collect();
            for (family, jets) in led.iter_mut().zip(&all) {
                for ((entry, jet), value) in pick(family).zip(jets).zip(&values) {
                    *entry = number(Jet { value: *value, slope: jet.slope });
                }
            }
        }
        Some(led)
    }

    /// How much each parameter changes the system in its part, about relative to it.
    pub fn changes(&self) -> Vec<f64> {
        let size = |number: &Number| number.enclosure().magnitude();
        let of = |entries: &Entries| {
            let slope = |i: usize, j: usize| Jet::of(&entries[i][j]).slope.magnitude();
            let scale = |i: usize, j: usize| (size(&entries[i][i]) * size(&entries[j][j])).sqrt();
            let n = entries.len();
            let each = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            each.map(|(i, j)| if scale(i, j) > 0.0 { slope(i, j) / scale(i, j) } else { 0.0 }).fold(0.0, f64::max)
        };
        let own = |(forms, radius): (&[Entries; 3], &f64)| forms.iter().map(of).fold(0.0, f64::max) * radius;
        self.forms.iter().zip(&self.radius).map(own).collect()
    }
}

type Numbers<'s> = Box<dyn Iterator<Item = &'s mut Number> + 's>;

impl<'a> Family<'a> {
    fn numbers_of_m(&mut self) -> Numbers<'_> {
        Box::new(self.m.iter_mut().flatten())
    }

    fn numbers_of_c(&mut self) -> Numbers<'_> {
        Box::new(self.c.iter_mut().flatten())
    }

    fn numbers_of_k(&mut self) -> Numbers<'_> {
        Box::new(self.k.iter_mut().flatten())
    }

    /// The numbers of the coordinates, and the frequency of the lead.
    fn numbers_of_basis(&mut self) -> Numbers<'_> {
        let lead = self.lead.iter_mut().map(|lead| &mut lead.omega);
        Box::new(self.basis.iter_mut().flatten().flatten().chain(lead))
    }

    /// The family without derivatives.
    pub fn without_derivatives(&self) -> Family<'a> {
        let of = |number: &Number| Number::Ball(number.enclosure());
        let all = |form: &Entries| -> Entries { form.iter().map(|row| row.iter().map(of).collect()).collect() };
        let lead = self.lead.as_ref().map(|lead| Lead { index: lead.index, omega: of(&lead.omega) });
        let basis = self.basis.as_ref().map(all);
        Family { m: all(&self.m), c: all(&self.c), k: all(&self.k), basis, lead, ..*self }
    }

    /// The family in coordinates of which one is the mode with this omega^2, wherever the parameter is; frequencies are then multiples of
    /// its omega, and M and C are multiplied by omega^2 and omega. `None` if the mode may not be simple.
    ///
    /// With x the mode, and other coordinates as they are, the row and the column of x in K - (rho omega)^2 M are 1 - rho^2 times those
    /// of omega^2 M, so that nothing cancels near the resonance.
    pub fn led_by(&self, omega_squared: &Jet) -> Option<Family<'a>> {
        let n = self.coordinates();
        if self.lost || self.lead.is_some() || !omega_squared.value.is_positive() {
            return None;
        }
        let square = number(omega_squared.clone());
        let shifted = |i: usize, j: usize| &self.k[i][j] - &(&square * &self.m[i][j]);
        let sizes = self.sizes(omega_squared.value.magnitude().sqrt());
        // Along the eigenvalue s vanishes, so that x and its derivative are those of the shape.
        let x = border(&JetMatrix::from_fn(n, n, shifted), &sizes, 1)?.x;
        let moved = |i: &usize| x.value[(*i, 0)].mid.hi.abs() * self.m[*i][*i].enclosure().magnitude().sqrt();
        let index = (0..n).max_by(|a, b| moved(a).total_cmp(&moved(b)))?;
        // Of one sign, so that it is the same one over a part of the ranges.
        let sign = match x.value[(index, 0)] {
            own if own.is_positive() => Number::ONE,
            own if own.is_negative() => -&Number::ONE,
            _ => return None,
        };
        let x: Vec<Number> = (0..n).map(|i| &sign * &number(x.entry(i, 0))).collect();
        let along =
            |row: &Vec<Number>, x: &[Number]| row.iter().zip(x).fold(Number::ZERO, |sum, (a, x)| &sum + &(a * x));
        // Of the size for which omega^2 x^T M x is 1: what the parameters change in this stays out of the resonance.
        let inertia: Vec<Number> = self.m.iter().map(|row| along(row, &x)).collect();
        let size = (&square * &along(&inertia, &x)).sqrt()?;
        let x = x.iter().map(|x| x.checked_div(&size)).collect::<Option<Vec<Number>>>()?;
        let times = |row: &Vec<Number>| along(row, &x);
        let framed = |form: &Entries| -> Entries {
            let along: Vec<Number> = form.iter().map(times).collect();
            let own = times(&along);
            let entry = |i: usize, j: usize| match (i == index, j == index) {
                (true, true) => own.clone(),
                (true, false) => along[j].clone(),
                (false, true) => along[i].clone(),
                (false, false) => form[i][j].clone(),
            };
            (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
        };
        let scaled = |form: Entries, by: &Number| -> Entries {
            form.iter().map(|row| row.iter().map(|entry| entry * by).collect()).collect()
        };
        let omega = square.sqrt()?;
        let (mut m, c, k) = (scaled(framed(&self.m), &square), scaled(framed(&self.c), &omega), framed(&self.k));
        m[index][index] = Number::ONE;
        let basis = self.basis.as_ref().map_or_else(
            || {
                let one = |i: usize, j: usize| if i == j { Number::ONE } else { Number::ZERO };
                (0..n).map(|i| (0..n).map(|j| if j == index { x[i].clone() } else { one(i, j) }).collect()).collect()
            },
            |basis| {
                let row = |row: &Vec<Number>| {
                    let own = times(row);
                    row.iter()
                        .enumerate()
                        .map(|(j, known)| if j == index { own.clone() } else { known.clone() })
                        .collect()
                };
                basis.iter().map(row).collect()
            },
        );
        Some(Family {
            system: self.system,
            lost: false,
            m,
            c,
            k,
            basis: Some(basis),
            lead: Some(Lead { index, omega }),
        })
    }
}

/// Of two enclosures of one number.
fn narrower(a: Ball, b: Ball) -> Ball {
    if b.is_finite() && !(a.is_finite() && a.rad <= b.rad) { b } else { a }
}

/// X^T A X of one of the matrices of all families, each entry by what is narrower: its own balls, or the middle and all derivatives.
fn narrow(forms: &[&Entries], centre: &Entries, basis: &Matrix<Ball>, radius: &[f64]) -> Vec<Entries> {
    let n = centre.len();
    let transposed = Matrix::from_fn(n, n, |i, j| basis[(j, i)]);
    let congruent = |form: &Entries, pick: fn(&Jet) -> Ball| {
        let part = Matrix::from_fn(n, n, |i, j| pick(&Jet::of(&form[i][j])));
        product(&transposed, &product(&part, basis))
    };
    let slopes: Vec<Matrix<Ball>> = forms.iter().map(|form| congruent(form, |jet| jet.slope)).collect();
    let middle = congruent(centre, |jet| jet.value);
    let plain = forms.first().map(|form| congruent(form, |jet| jet.value));
    let value = |i: usize, j: usize| {
        let reach =
            slopes.iter().zip(radius).fold(0.0, |sum, (slope, radius)| sum + slope[(i, j)].magnitude() * radius);
        let by_mean = middle[(i, j)].widen(reach * up::THOUSANDS);
        let own = plain.as_ref().map_or(by_mean, |plain| plain[(i, j)]);
        narrower(own, by_mean)
    };
    let values = Matrix::from_fn(n, n, value);
    let entry = |slope: &Matrix<Ball>, i: usize, j: usize| number(Jet { value: values[(i, j)], slope: slope[(i, j)] });
    slopes.iter().map(|slope| (0..n).map(|i| (0..n).map(|j| entry(slope, i, j)).collect()).collect()).collect()
}

/// The modes in binary64, each of the size that makes its x^T K x about 1 (that of the fastest for one that is not held).
fn modes(centre: &Family) -> Option<Matrix<Ball>> {
    let n = centre.coordinates();
    let plain = |form: &Entries| DMatrix::from_fn(n, n, |i, j| form[i.max(j)][i.min(j)].enclosure().to_f64());
    let inverse = plain(&centre.m).cholesky()?.l().try_inverse()?;
    let eigen = SymmetricEigen::try_new(&inverse * plain(&centre.k) * inverse.transpose(), f64::EPSILON, 1000)?;
    let shapes = inverse.transpose() * eigen.eigenvectors;
    let fastest = eigen.eigenvalues.iter().fold(0.0f64, |most, square| most.max(square.abs()));
    let scale = |i: usize| {
        let own = eigen.eigenvalues[i].abs();
        let square = if own > 1e-12 * fastest { own } else { fastest };
        if square > 0.0 { 1.0 / square.sqrt() } else { 1.0 }
    };
    let basis = Matrix::from_fn(n, n, |i, j| Ball::from(shapes[(i, j)] * scale(j)));
    basis.is_finite().then_some(basis)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::system::{CoordinateId, Nature};

    /// Two blocks of 1 kg on springs of k N/m and between them one of l: (1, 1) with omega^2 = k, and (1, -1) with k + 2 l; of the size for
    /// which omega^2 x^T M x is 1, and with the sign that makes the one that is replaced positive.
    #[test]
    fn a_mode_as_a_coordinate_has_one_sign() {
        for (k, l) in [(1, 1), (3, 1), (1, 5), (40, 2), (2, 30)] {
            let mut system = blank(2);
            for i in 0..2 {
                push(&mut system.m, "1", i, None);
                push(&mut system.k, &k.to_string(), i, None);
            }
            push(&mut system.k, &l.to_string(), 0, Some(1));
            let family = Family::of(&system, false).expect("a family");
            for (square, sign) in [(f64::from(k), 1.0), (f64::from(k + 2 * l), -1.0)] {
                let led = family.led_by(&Jet { value: Ball::from(square), slope: Ball::ZERO }).expect("simple");
                let (index, basis) = (led.lead.as_ref().expect("a lead").index, led.basis.as_ref().expect("a basis"));
                let size = 1.0 / (2.0 * square).sqrt();
                for (i, row) in basis.iter().enumerate() {
                    let truth = if i == index { size } else { sign * size };
                    assert!((row[index].to_f64() - truth).abs() < 1e-14, "{k} {l} {sign} {i} {:?}", row[index]);
                }
            }
        }
    }

    /// The same with k of 3.9 to 4.1 N/m and l of 0.9 to 1.1 N/m. The mode (1, 1) leads: its omega is sqrt(k), and with the other one of the size
    /// that makes its x^T K x 1 in the middle, that is (k + 2 l) / 6 elsewhere, and omega^2 x^T M x is k / 6.
    #[test]
    fn coordinates_hold_what_all_parameters_change() {
        let system = |value: [Ball; 2], own: Option<usize>| {
            let slope = |i: usize| if own == Some(i) { Ball::ONE } else { Ball::ZERO };
            let [k, l] = [0, 1].map(|i| number(Jet { value: value[i], slope: slope(i) }));
            let one = |i: u32| (CoordinateId(i), Number::ONE);
            let mut system = blank(2);
            let source = system.k.source(system.coordinates[0].name);
            for i in 0..2 {
                push(&mut system.m, "1", i as usize, None);
                system.k.push(source, Nature::Property, k.clone(), [one(i)]);
            }
            system.k.push(source, Nature::Property, l, [one(0), (CoordinateId(1), -&Number::ONE)]);
            system
        };
        let (middle, radius) = ([Ball::from(4.0), Ball::from(1.0)], [0.1, 0.1]);
        let wide = [middle[0].widen(radius[0]), middle[1].widen(radius[1])];
        let over = [0, 1].map(|own| system(wide, Some(own)));
        let together = Together::of(&over.each_ref(), &system(middle, None), &radius).expect("one form");
        let families: Vec<Family> = (0..2).map(|own| together.family(&over[own], own).expect("a family")).collect();
        let squares = [Ball::ONE, Ball::ZERO].map(|slope| Jet { value: wide[0], slope });
        let led = together.led_families(&families, &squares, middle[0]).expect("simple");
        let holds = |number: &Number, least: f64, largest: f64| {
            let ball = number.enclosure();
            let (low, high) = (ball.to_f64() - ball.rad, ball.to_f64() + ball.rad);
            let slack = 0.2 * (largest - least);
            assert!(low <= least + 1e-15 && largest - 1e-15 <= high, "{low} {high} {least} {largest}");
            assert!(low >= least - slack && high <= largest + slack, "{low} {high} {least} {largest}");
        };
        for family in led {
            let lead = family.lead.as_ref().expect("a lead");
            let other = 1 - lead.index;
            holds(&lead.omega, 3.9f64.sqrt(), 4.1f64.sqrt());
            holds(&family.k[other][other], 5.7 / 6.0, 6.3 / 6.0);
            holds(&family.m[other][other], 3.9 / 6.0, 4.1 / 6.0);
        }
    }
}
