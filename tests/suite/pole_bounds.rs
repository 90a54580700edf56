//! Every printed bound of a pole holds: random damped systems against Newton's correction in exact arithmetic.

use super::exact::value;
use super::systems::{Builder, Random};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};
use vibc::analysis::{self, Pole};
use vibc::base::Number;
use vibc::system::{Form, LinearSystem};

/// x + i y
#[derive(Clone)]
struct Gauss(BigInt, BigInt);

impl Gauss {
    fn times(&self, z: &Gauss) -> Gauss {
        Gauss(&self.0 * &z.0 - &self.1 * &z.1, &self.0 * &z.1 + &self.1 * &z.0)
    }

    fn minus(&self, z: &Gauss) -> Gauss {
        Gauss(&self.0 - &z.0, &self.1 - &z.1)
    }

    fn norm(&self) -> BigInt {
        &self.0 * &self.0 + &self.1 * &self.1
    }

    /// An exact quotient.
    fn over(&self, z: &Gauss) -> Gauss {
        let product = self.times(&Gauss(z.0.clone(), -&z.1));
        Gauss(product.0 / z.norm(), product.1 / z.norm())
    }
}

/// M, C, K times a common denominator.
struct Exact {
    forms: [Vec<Vec<BigInt>>; 3],
}

impl Exact {
    fn of(system: &LinearSystem) -> Exact {
        let n = system.n();
        let forms = [&system.m, &system.c, &system.k].map(|form| assembled(form, n));
        let denominators = forms.iter().flatten().flatten().map(|x| x.denom().clone());
        let common = denominators.fold(BigInt::one(), num_integer::lcm);
        let cleared = |x: &BigRational| x.numer() * (&common / x.denom());
        Exact { forms: forms.map(|form| form.iter().map(|row| row.iter().map(cleared).collect()).collect()) }
    }

    /// det(M s^2 + C s 2^k + K 4^k) for s 2^-k, by Bareiss' elimination.
    fn determinant(&self, s: &Gauss, k: u64) -> Gauss {
        let n = self.forms[0].len();
        let square = s.times(s);
        let entry = |i: usize, j: usize| {
            let [m, c, stiffness] = self.forms.each_ref().map(|form| &form[i][j]);
            let c = c << k;
            Gauss(m * &square.0 + &c * &s.0 + (stiffness << (2 * k)), m * &square.1 + c * &s.1)
        };
        let mut a: Vec<Vec<Gauss>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        let mut last = Gauss(BigInt::one(), BigInt::zero());
        for p in 0..n {
            let row = a[p].clone();
            for r in a.iter_mut().skip(p + 1) {
                let factor = r[p].clone();
                for j in p + 1..n {
                    r[j] = r[j].times(&row[p]).minus(&factor.times(&row[j])).over(&last);
                }
            }
            last = row[p].clone();
        }
        last
    }

    /// |p / p'| at the pole's midpoint: its error, to as many digits as the difference quotient has.
    fn error(&self, pole: &Pole) -> f64 {
        let size = pole.re.to_f64().hypot(pole.im.to_f64());
        // A step between the error (1e-30) and the distance of the next pole.
        let step = super::exact::binary(2f64.powi((size * 1e-20).log2() as i32));
        let (re, im) = (value(pole.re.mid), value(pole.im.mid));
        let k = [&re, &im, &step].iter().map(|x| x.denom().bits() - 1).max().expect("three");
        let scaled = |x: &BigRational| (x.numer() << k) / x.denom();
        let s = Gauss(scaled(&re), scaled(&im));
        let beyond = Gauss(&s.0 + scaled(&step), s.1.clone());
        let (p, q) = (self.determinant(&s, k), self.determinant(&beyond, k));
        let ratio = BigRational::new(p.norm(), q.minus(&p).norm()).to_f64().expect("a number");
        ratio.sqrt() * step.to_f64().expect("a number")
    }
}

fn assembled(form: &Form, n: usize) -> Vec<Vec<BigRational>> {
    let mut matrix = vec![vec![BigRational::zero(); n]; n];
    let exact = |x: &Number| x.exact().expect("rational").to_big();
    for term in form.terms() {
        for (i, a) in form.row(term) {
            for (j, b) in form.row(term) {
                matrix[i.index()][j.index()] += exact(&term.weight) * exact(a) * exact(b);
            }
        }
    }
    matrix
}

/// A net of n masses with springs and dampers over so many decades, some of them to the ground.
fn damped_net(random: &mut Random, n: usize, decades: f64, negative: bool) -> LinearSystem {
    let mut b = Builder::numbered(n);
    for i in 0..n {
        b.mass(i, &random.decimal(decades / 2.0));
        let from = (i > 0).then(|| random.below(i));
        // A third of the nets is free.
        if from.is_some() || random.below(3) > 0 {
            b.spring(from, i, &random.decimal(decades));
        }
        if random.below(2) == 0 {
            b.spring(None, i, &random.decimal(decades));
        }
    }
    for at in 0..=random.below(n) {
        let c = random.decimal(decades);
        let c = if negative && at == 0 { -&c } else { c };
        let to = random.below(n);
        b.damper((to > 0 && at % 2 == 0).then_some(0), to, &c);
    }
    b.finish()
}

/// What a sweep saw: bounds over errors.
fn check(system: &LinearSystem, ratios: &mut Vec<f64>, what: &str) {
    let modes = analysis::modes(system).expect("a regular system");
    let poles = analysis::poles(system, &modes).expect("poles");
    assert_eq!(poles.list.len(), 2 * system.n(), "{what}");
    let exact = Exact::of(system);
    for pole in poles.list.iter().filter(|pole| pole.im.mid.hi >= 0.0 && pole.damping_ratio.is_some()) {
        assert!(pole.relative_error < 1e-27, "{what}: {pole:?}");
        if pole.cluster.is_some() {
            continue;
        }
        let (error, bound) = (exact.error(pole), pole.re.rad.hypot(pole.im.rad));
        assert!(error <= bound * (1.0 + 1e-6), "{what}: error {error:e}, bound {bound:e}, {pole:?}");
        ratios.push(if error > 0.0 { bound / error } else { 1.0 });
    }
}

/// Half of the bounds are at most 4 n times the error.
fn assert_tight(mut ratios: Vec<f64>) {
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    assert!(median <= 4.0, "bounds are {median} times the errors");
}

#[test]
fn bounds_of_damped_nets_hold_and_are_tight() {
    let (mut random, mut ratios) = (Random::new(20_261_122), Vec::new());
    for i in 0..100 {
        let decades = [1.0, 4.0, 12.0, 24.0][i % 4];
        let system = damped_net(&mut random, 1 + i % 4, decades, false);
        check(&system, &mut ratios, &format!("net {i}"));
    }
    assert_tight(ratios);
}

#[test]
fn bounds_hold_where_damping_is_negative() {
    let (mut random, mut ratios) = (Random::new(7), Vec::new());
    for i in 0..40 {
        let system = damped_net(&mut random, 2 + i % 3, 3.0, true);
        check(&system, &mut ratios, &format!("net {i}"));
    }
    assert_tight(ratios);
}
