//! Random systems by kind, from fixed seeds, and the results of a sweep over them: violated bounds, ratios of bounds to
//! errors, numbers without a bound. The tests take few of each kind, `cargo bench --bench bounds` takes ten thousand.
//!
//! The truth is computed in exact arithmetic: the k-th enclosure must contain the k-th eigenvalue (counted by signs of
//! leading minors), and the error of a pole is Newton's correction |p / p'| of the exact determinant.

use super::exact::{ExactPencil, Quadratic, binary, value};
use super::systems::{Builder, Random};
use num_rational::BigRational;
use vibc::analysis::{self, ModeKind, PoleKind};
use vibc::base::{Ball, Dd, Number};
use vibc::system::{CoordinateId, Form, LinearSystem, Nature};

/// The name of a kind of system, and its generator; the number varies size and range.
pub type Kind = (&'static str, fn(&mut Random, usize) -> LinearSystem);

/// Undamped systems.
pub const UNDAMPED: [Kind; 7] = [
    ("networks, k and m over 24 decades", |random, i| {
        network(random, 2 + i % 4, [0.0, 4.0, 12.0, 24.0][i / 4 % 4], i % 3, i % 5 != 0)
    }),
    ("networks of 6 to 8, 24 decades", |random, i| network(random, 6 + i % 3, 24.0, i % 5, i % 2 == 0)),
    ("levers and coupled masses, 16 decades", |random, i| {
        levers(random, 2 + i % 3, [0.0, 4.0, 16.0][i / 3 % 3], false)
    }),
    ("negative stiffness, 6 decades", |random, i| levers(random, 2 + i % 3, [0.0, 2.0, 6.0][i / 3 % 3], true)),
    ("graded networks with gravity, margins to 1e-12", |random, i| near_buckling(random, 2 + i % 4, i % 13)),
    ("rings: repeated frequencies", |random, i| ring(random, 3 + i % 4)),
    ("massless nodes", |random, i| with_massless_nodes(random, 3 + i % 3)),
];

/// Damped systems.
pub const DAMPED: [Kind; 8] = [
    ("nets, 1 to 24 decades", |random, i| damped_net(random, 1 + i % 5, [1.0, 4.0, 12.0, 24.0][i % 4], 0.0, false)),
    ("lightly damped, zeta down to 1e-13", |random, i| damped_net(random, 1 + i % 5, 4.0, -((i % 14) as f64), false)),
    ("heavily damped, rates over 1e19", |random, i| damped_net(random, 1 + i % 5, 6.0, (i % 10) as f64, false)),
    ("negative damping", |random, i| damped_net(random, 2 + i % 3, 3.0, 0.0, true)),
    ("free, dragged by dampers", |random, i| dragged(random, 2 + i % 4)),
    ("symmetric: repeated poles", |random, i| symmetric(random, 2 + i % 3)),
    ("critical and nearly critical", |random, i| critical(random, 1 + i % 3, i % 8)),
    ("beyond exact arithmetic: 13 to 16", |random, i| damped_net(random, 13 + i % 4, [1.0, 6.0][i % 2], 0.0, false)),
];

/// The statistics of a sweep.
#[derive(Default)]
pub struct Figures {
    pub numbers: usize,
    pub violations: Vec<String>,
    /// Numbers whose relative bound is above 1e-12 or infinite, and systems that are refused.
    pub uncertified: Vec<String>,
    /// Numbers that are certified only together.
    pub clustered: usize,
    /// Ratios of bounds to errors for the others.
    pub ratios: Vec<f64>,
    pub worst_bound: f64,
    /// Coordinates, summed over the numbers.
    pub size: usize,
}

impl Figures {
    pub fn median(&mut self) -> f64 {
        self.ratios.sort_by(f64::total_cmp);
        self.ratios.get(self.ratios.len() / 2).copied().unwrap_or(1.0)
    }

    /// Average of n over all numbers.
    pub fn average_size(&self) -> f64 {
        self.size as f64 / self.numbers.max(1) as f64
    }

    fn bound(&mut self, relative: f64, n: usize, what: impl Fn() -> String) {
        self.numbers += 1;
        self.size += n;
        if relative.is_nan() || relative > 1e-12 {
            self.uncertified.push(what());
        } else {
            self.worst_bound = self.worst_bound.max(relative);
        }
    }

    /// An exact zero error gives no information about the sharpness of a bound.
    fn error(&mut self, error: f64, bound: f64, what: impl Fn() -> String) {
        if error.is_nan() || error > bound * (1.0 + 1e-6) {
            self.violations.push(format!("{}: error {error:e}, bound {bound:e}", what()));
        } else if error > 0.0 {
            self.ratios.push(bound / error);
        }
    }
}

/// Checks all frequencies of one system; `truth` has the same frequencies, but rational numbers.
pub fn check_modes(system: &LinearSystem, truth: &LinearSystem, figures: &mut Figures, what: &str) {
    let (exact, quadratic) = (ExactPencil::of(truth), Quadratic::of(truth));
    let modes = match analysis::modes(system) {
        Ok(modes) => modes,
        Err(error) => return figures.uncertified.push(format!("{what}: refused, {error:?}")),
    };
    for (k, mode) in modes.list.iter().enumerate() {
        let what = || format!("{what}: mode {} {:?} {:?}", k + 1, mode.kind, mode.omega);
        figures.bound(mode.omega.relative_error(), system.n(), what);
        let square = mode.omega_squared;
        let room = if mode.kind == ModeKind::Rigid { 1e-300 } else { square.rad };
        // Counts by leading minors of K - s M include the infinite eigenvalues of motions without inertia: these are not
        // compared.
        if modes.infinite == 0 && square.rad.is_finite() && !encloses(&exact, square, k, room) {
            figures.violations.push(format!("{}: not the {}-th eigenvalue", what(), k + 1));
        }
        let (re, im) = match mode.kind {
            ModeKind::Oscillation => (Dd::ZERO, mode.omega.mid),
            ModeKind::Divergence => (mode.omega.mid, Dd::ZERO),
            ModeKind::Rigid | ModeKind::Undetermined => continue,
        };
        match mode.cluster {
            Some(_) => figures.clustered += 1,
            None => figures.error(quadratic.error(re, im), mode.omega.rad, what),
        }
    }
}

/// Checks all poles of one system; `truth` has the same poles, but rational numbers.
pub fn check_poles(system: &LinearSystem, truth: &LinearSystem, figures: &mut Figures, what: &str) {
    let poles = analysis::modes(system).and_then(|modes| analysis::poles(system, &modes));
    let poles = match poles {
        Ok(poles) => poles,
        Err(error) => return figures.uncertified.push(format!("{what}: refused, {error:?}")),
    };
    let counted = poles.infinite().is_none_or(|infinite| poles.list.len() + infinite == 2 * system.n());
    if !counted || poles.list.len() > 2 * system.n() {
        figures.violations.push(format!("{what}: {} poles", poles.list.len()));
    }
    let exact = Quadratic::of(truth);
    for pole in poles.list.iter().filter(|pole| pole.im.mid.hi >= 0.0 && pole.kind != PoleKind::Rigid) {
        let what = || format!("{what}: {pole:?}");
        figures.bound(pole.relative_error, system.n(), what);
        if pole.cluster.is_some() {
            figures.clustered += 1;
        } else if pole.relative_error.is_finite() {
            figures.error(exact.error(pole.re.mid, pole.im.mid), pole.re.rad.hypot(pole.im.rad), what);
        }
    }
}

/// The system in coordinates that are rotated in pairs by 30 degrees: cos 30° is not rational, so that no structure can
/// be decided exactly.
pub fn turned(system: &LinearSystem) -> LinearSystem {
    let cos = &Number::from(3).sqrt().expect("positive") / &Number::from(2);
    let half = Number::from("0.5");
    let n = system.n();
    let turn = |form: &Form| {
        let mut turned = Form::new();
        for term in form.terms() {
            let source = turned.source(form.source_of(term.source));
            let mut row = vec![Number::ZERO; n];
            for (i, a) in form.row(term) {
                let (i, partner) = (i.index(), i.index() ^ 1);
                let sign = if i < partner { Number::ONE } else { Number::from(-1) };
                match partner < n {
                    true => {
                        row[i] = &row[i] + &(a * &cos);
                        row[partner] = &row[partner] + &(&(a * &half) * &sign);
                    }
                    false => row[i] = &row[i] + a,
                }
            }
            let row = (0u32..).map(CoordinateId).zip(row).filter(|(_, a)| !a.is_zero());
            turned.push(source, term.nature, term.weight.clone(), row);
        }
        turned
    };
    LinearSystem { m: turn(&system.m), c: turn(&system.c), k: turn(&system.k), ..system.clone() }
}

/// Whether the k-th eigenvalue (from 0) is within `radius` of the ball's midpoint.
fn encloses(exact: &ExactPencil, ball: Ball, k: usize, radius: f64) -> bool {
    let (mid, radius) = (value(ball.mid), binary(radius));
    let (low, high) = (&mid - &radius, mid + radius);
    // A leading minor that vanishes exactly at a bound would make the count fail; moving outwards by 2^-900 does not
    // matter.
    let nudge = binary(2f64.powi(-900));
    let count = |s: &BigRational, step: &BigRational| {
        (0..4).scan(s.clone(), |s, _| Some(std::mem::replace(s, &*s + step))).find_map(|s| exact.below(&s))
    };
    let below = count(&low, &-&nudge).expect("a regular point");
    let beyond = count(&high, &nudge).expect("a regular point");
    below <= k && beyond > k
}

/// A connected network of n masses with decimal springs over this many decades, and `extra` more springs that close
/// cycles.
pub fn network(random: &mut Random, n: usize, decades: f64, extra: usize, grounded: bool) -> LinearSystem {
    let mut b = Builder::numbered(n);
    (0..n).for_each(|i| b.mass(i, &random.decimal(decades)));
    if grounded {
        b.spring(None, random.below(n), &random.decimal(decades));
    }
    for i in 1..n {
        let from = random.below(i);
        b.spring(Some(from), i, &random.decimal(decades));
    }
    for _ in 0..extra {
        let (i, j) = (random.below(n), random.below(n));
        if i != j {
            b.spring(Some(i), j, &random.decimal(decades));
        }
    }
    b.finish()
}

/// Rows and coupled masses with arbitrary coefficients, with both signs if `mixed`.
pub fn levers(random: &mut Random, n: usize, decades: f64, mixed: bool) -> LinearSystem {
    let mut b = Builder::numbered(n);
    for i in 0..n {
        b.mass(i, &random.decimal(decades / 2.0));
        let row: Vec<(usize, Number)> = (0..n).map(|j| (j, random.signed())).collect();
        b.coupled_mass(&random.decimal(decades / 2.0), &row);
    }
    for t in 0..n + 1 {
        let row: Vec<(usize, Number)> = (0..n).map(|j| (j, random.signed())).collect();
        let weight = random.decimal(decades);
        let negative = mixed && t == n;
        b.stiffness(&format!("s{t}"), Nature::Property, &if negative { -&weight } else { weight }, &row);
    }
    b.finish()
}

/// Hinges over six decades under loads that leave 10^-margin of one hinge.
fn near_buckling(random: &mut Random, n: usize, margin: usize) -> LinearSystem {
    let mut b = Builder::numbered(n);
    for i in 0..n {
        b.mass(i, &random.decimal(6.0));
        let k = random.decimal(6.0);
        let (from, row) = (i.checked_sub(1), |sign: i64| (i, Number::from(sign)));
        let row: Vec<(usize, Number)> = [row(1)].into_iter().chain(from.map(|j| (j, Number::from(-1)))).collect();
        b.stiffness(&format!("k{i}"), Nature::Property, &k, &row);
        // -k (1 - 10^-margin), except for the first hinge, which also supports the others: half of it.
        let left = if i == 0 { Number::from("0.5") } else { Number::from(format!("1e-{margin}").as_str()) };
        b.stiffness(&format!("g{i}"), Nature::Geometric, &-&(&k * &(&Number::ONE - &left)), &row);
    }
    b.finish()
}

/// Equal masses in a ring of equal springs, all with equal springs to the ground.
fn ring(random: &mut Random, n: usize) -> LinearSystem {
    let mut b = Builder::numbered(n);
    let (m, k, ground) = (random.decimal(4.0), random.decimal(6.0), random.decimal(6.0));
    for i in 0..n {
        b.mass(i, &m);
        b.spring(Some(i), (i + 1) % n, &k);
        b.spring(None, i, &ground);
    }
    b.finish()
}

/// A chain in which every second node has no mass.
fn with_massless_nodes(random: &mut Random, n: usize) -> LinearSystem {
    let mut b = Builder::numbered(n);
    for i in 0..n {
        if i % 2 == 0 {
            b.mass(i, &random.decimal(6.0));
        }
        b.spring(i.checked_sub(1), i, &random.decimal(12.0));
        if random.below(3) == 0 {
            b.spring(None, i, &random.decimal(12.0));
        }
    }
    b.finish()
}

/// A net of n masses with springs and dampers over this many decades, some of them to the ground; the dampers are
/// 10^level times as strong.
pub fn damped_net(random: &mut Random, n: usize, decades: f64, level: f64, negative: bool) -> LinearSystem {
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
    let factor = Number::from(10).powi(level as i32).expect("ten is not zero");
    for at in 0..=random.below(n) {
        let c = &random.decimal(decades) * &factor;
        let c = if negative && at == 0 { -&c } else { c };
        let to = random.below(n);
        b.damper((to > 0 && at % 2 == 0).then_some(0), to, &c);
    }
    b.finish()
}

/// No spring holds the system as a whole; dampers drag one or two masses along the ground.
fn dragged(random: &mut Random, n: usize) -> LinearSystem {
    let mut b = Builder::numbered(n);
    for i in 0..n {
        b.mass(i, &random.decimal(3.0));
        if i > 0 && random.below(4) > 0 {
            b.spring(Some(random.below(i)), i, &random.decimal(6.0));
        }
    }
    for _ in 0..=random.below(3) {
        b.damper(None, random.below(n), &random.decimal(6.0));
    }
    for _ in 0..random.below(3) {
        let (i, j) = (random.below(n), random.below(n));
        if i != j {
            b.damper(Some(i), j, &random.decimal(6.0));
        }
    }
    b.finish()
}

/// A hub with n equal arms, each with a spring and a damper to the hub and to the ground: n - 1 equal pairs.
fn symmetric(random: &mut Random, n: usize) -> LinearSystem {
    let mut b = Builder::numbered(n + 1);
    b.mass(0, &random.decimal(3.0));
    b.spring(None, 0, &random.decimal(3.0));
    let [m, k, c, ground] = [(); 4].map(|()| random.decimal(3.0));
    for i in 1..=n {
        b.mass(i, &m);
        b.spring(Some(0), i, &k);
        b.damper(Some(0), i, &c);
        b.damper(None, i, &ground);
    }
    b.finish()
}

/// Oscillators with c = 2 sqrt(k m) (1 + 10^-d), or exactly critical, possibly coupled by a damper.
fn critical(random: &mut Random, n: usize, d: usize) -> LinearSystem {
    let mut b = Builder::numbered(n);
    for i in 0..n {
        let (m, rate) = (random.decimal(2.0), random.decimal(2.0));
        let off = if d == 0 { Number::ZERO } else { Number::from(format!("1e-{}", 2 * d).as_str()) };
        b.mass(i, &m);
        b.spring(None, i, &(&m * &rate.square()));
        b.damper(None, i, &(&(&Number::from(2) * &(&m * &rate)) * &(&Number::ONE + &off)));
        if i > 0 && random.below(2) == 0 {
            b.damper(Some(i - 1), i, &random.decimal(2.0));
        }
    }
    b.finish()
}
