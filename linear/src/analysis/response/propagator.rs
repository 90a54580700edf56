//! A system and the sources that drive it as one linear equation z' = A z in energy coordinates, and every motion as a
//! row over z. In: the system, the states w of the sources (w' = G w) and the forces F w. Out: A with its error, its
//! norm and a bound of its logarithmic norm; rows for displacement, velocity and acceleration. See
//! docs/method/response.md.
//!
//! With P = K + sigma M + sqrt(sigma) C_0, S^T S near P and N^T N near M, the state is z = (S q, N q', w / W): then
//! |z|^2 is about twice the energy, and d|z|^2/dt = -2 q'^T C q' + rest. The part of A other than the dissipation L^T C
//! L is computed with balls, so `rate` holds however rough S and N are. sigma is 0 if K is safely positive definite;
//! otherwise it is the smallest power of four times (2/T)^2 that makes P positive definite: rigid motions then cost a
//! factor e, divergences their own growth. C_0 is the part of C on coordinates without mass, whose equations are of
//! first order; coordinates with neither mass nor damping follow at once: they are eliminated.

use crate::analysis::error::AnalysisError;
use crate::analysis::response::exponential::Generator;
use crate::base::{Ball, Dd, Power, two_to};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::cholesky;
use crate::kernel::dense::enclosure::{norm_bound, product, solve};
use crate::kernel::squares::Squares;
use crate::system::{CoordinateId, LinearSystem};

/// A pivot made of rounding is below 2^-100 of its diagonal; twenty digits keep a distance from that.
const LEAST_PIVOT: f64 = 1e-20;

/// The states of the sources: w' = G w, forces F w on the coordinates.
#[derive(Clone, Debug)]
pub struct Exogenous {
    pub count: usize,
    /// Entries of G.
    pub generator: Vec<(usize, usize, Ball)>,
    /// Force on each coordinate: coordinate, state, factor.
    pub force: Vec<(usize, usize, Ball)>,
    /// The longest time for which state i acts before it is reset.
    pub longest: Vec<f64>,
    /// Whether state i is the derivative of state i - 1 (a chain), so that its scale follows.
    pub chained: Vec<bool>,
    /// Whether state i shares the scale of state i - 1 (sine and cosine).
    pub paired: Vec<bool>,
}

/// The system in energy coordinates.
#[derive(Clone, Debug)]
pub struct StateSpace {
    a: Matrix<Ball>,
    /// |(A + A^T) / 2 + L^T C L|: the part that may make |z| grow.
    rest: Matrix<f64>,
    /// Number of mechanical states; the sources' follow.
    pub mechanical: usize,
    /// A bound of the logarithmic norm of the mechanical part alone.
    pub own_rate: f64,
    /// Powers of two: w = W w~.
    pub scale: Vec<f64>,
    /// Rows over z for each coordinate: q, q', q''.
    pub rows: [Matrix<Ball>; 3],
    /// q of every coordinate as rows over the physical states: displacements, velocities, sources.
    displacements: Matrix<Ball>,
    /// z from (q, q') of the coordinates that are states.
    to_z: Matrix<Ball>,
    parts: Parts,
    m: Matrix<Ball>,
    c: Matrix<Ball>,
}

/// Coordinates by the order of their equations.
#[derive(Clone, Debug)]
pub struct Parts {
    /// Coordinates with mass, of second order.
    pub heavy: Vec<usize>,
    /// Without mass but damped: first order.
    pub damped: Vec<usize>,
    /// Coordinates with neither, which follow without delay.
    pub following: Vec<usize>,
}

/// With more states, a dense exponential takes minutes.
pub const MOST_STATES: usize = 400;
/// 4^MOST_SHIFTS times (2/T)^2 exceeds any stiffness.
const MOST_SHIFTS: i32 = 200;

impl Parts {
    pub fn of(system: &LinearSystem) -> Parts {
        let touched = |form: &crate::system::Form| {
            let mut touched = vec![false; system.n()];
            for term in form.terms() {
                form.row(term).iter().for_each(|(i, _)| touched[i.index()] = true);
            }
            touched
        };
        let (mass, damping) = (touched(&system.m), touched(&system.c));
        let pick = |wanted: &dyn Fn(usize) -> bool| (0..system.n()).filter(|&i| wanted(i)).collect::<Vec<_>>();
        Parts {
            heavy: pick(&|i| mass[i]),
            damped: pick(&|i| !mass[i] && damping[i]),
            following: pick(&|i| !mass[i] && !damping[i]),
        }
    }

    fn states(&self) -> Vec<usize> {
        self.heavy.iter().chain(&self.damped).copied().collect()
    }
}

impl StateSpace {
    /// The state space for motions up to the time `horizon`, s.
    pub fn of(system: &LinearSystem, sources: &Exogenous, horizon: f64) -> Result<StateSpace, AnalysisError> {
        let parts = Parts::of(system);
        let size = 2 * parts.heavy.len() + parts.damped.len() + sources.count;
        if size > MOST_STATES {
            return Err(AnalysisError::too_many_states(system, size, MOST_STATES));
        }
        let physical = Physical::of(system, &parts, sources)?;
        let shaping = Shaping::of(system, &parts, &physical, horizon)?;
        let relaxation = relaxation(&physical, &shaping, horizon);
        let sources =
            Exogenous { longest: sources.longest.iter().map(|time| time.min(relaxation)).collect(), ..sources.clone() };
        Ok(finish(system, parts, physical, shaping, &sources))
    }

    pub fn size(&self) -> usize {
        self.a.rows()
    }

    /// z' = A z on some of the states, the mechanical ones first; the others are zero.
    pub fn generator(&self, states: &[usize]) -> Generator {
        let n = states.len();
        let a = Matrix::from_fn(n, n, |i, j| self.a[(states[i], states[j])]);
        Generator {
            a: a.mid(),
            error: a.radius(),
            rate: norm_bound(n, n, |i, j| self.rest[(states[i], states[j])]),
            norm: norm_bound(n, n, |i, j| a[(i, j)].magnitude()),
        }
    }

    /// The mechanical part of z from displacements and velocities of all coordinates.
    pub fn state(&self, q: &[Ball], v: &[Ball]) -> Vec<Ball> {
        let states = self.parts.states();
        let x = states.iter().map(|&i| q[i]).chain(self.parts.heavy.iter().map(|&i| v[i]));
        let x: Vec<Ball> = x.collect();
        let image = product(&self.to_z, &Matrix::from_fn(x.len(), 1, |i, _| x[i]));
        image.column(0).to_vec()
    }

    /// The mechanical part of z at which nothing moves while the sources keep these values; `None` if there may be
    /// several.
    pub fn equilibrium(&self, sources: &[Ball]) -> Option<Vec<Ball>> {
        let n = self.mechanical;
        let a = Matrix::from_fn(n, n, |i, j| self.a[(i, j)]);
        let force = |i: usize| sources.iter().enumerate().fold(Ball::ZERO, |sum, (j, &w)| sum + self.a[(i, n + j)] * w);
        let forces = Matrix::from_fn(n, 1, |i, _| -force(i));
        Some(solve(&a, &forces)?.column(0).to_vec())
    }

    /// A, without its errors.
    pub fn matrix(&self) -> Matrix<Dd> {
        self.a.mid()
    }

    /// The mechanical part of z as rows over displacements, then velocities, of all n coordinates.
    pub fn motion_rows(&self, n: usize) -> Matrix<Dd> {
        let mut rows = Matrix::zeros(self.mechanical, 2 * n);
        let velocities = self.parts.heavy.iter().map(|&i| n + i);
        for (position, column) in self.parts.states().into_iter().chain(velocities).enumerate() {
            for i in 0..self.mechanical {
                rows[(i, column)] = self.to_z[(i, position)].mid;
            }
        }
        rows
    }

    /// The effect of an impulse: forces g0 delta + g1 delta' (delta the unit impulse) change q and q' by M dq = g1, C_0
    /// dq_0 = g0 - C dq on coordinates without mass, M dq' = g0 - C dq. Coordinates that follow pass their forces on.
    pub fn impulse_response_jump(&self, g0: &[Ball], g1: &[Ball]) -> Option<Vec<Ball>> {
        let n = g0.len();
        let g0 = &self.passed_on(g0);
        let (heavy, damped) = (&self.parts.heavy, &self.parts.damped);
        let column = |values: &[Ball], of: &[usize]| Matrix::from_fn(of.len(), 1, |i, _| values[of[i]]);
        let m = select(&self.m, heavy, heavy);
        let (mut dq, mut dv) = (vec![Ball::ZERO; n], vec![Ball::ZERO; n]);
        let jump = solve(&m, &column(g1, heavy))?;
        heavy.iter().zip(jump.column(0)).for_each(|(&i, &x)| dq[i] = x);
        let rest = |dq: &[Ball]| -> Vec<Ball> {
            let pushed = product(&self.c, &Matrix::from_fn(n, 1, |i, _| dq[i]));
            g0.iter().zip(pushed.column(0)).map(|(&g, &c)| g - c).collect()
        };
        if !damped.is_empty() {
            let creep = solve(&select(&self.c, damped, damped), &column(&rest(&dq), damped))?;
            damped.iter().zip(creep.column(0)).for_each(|(&i, &x)| dq[i] = x);
        }
        let kick = solve(&m, &column(&rest(&dq), heavy))?;
        heavy.iter().zip(kick.column(0)).for_each(|(&i, &x)| dv[i] = x);
        Some(self.state(&dq, &dv))
    }
}

impl StateSpace {
    /// The forces on the coordinates that are states, including those that the following coordinates pass on to them
    /// through springs: since q_f = -X q + ..., a force f on the following coordinates does the work of -X^T f.
    fn passed_on(&self, force: &[Ball]) -> Vec<Ball> {
        let mut sum = force.to_vec();
        for (position, &i) in self.parts.states().iter().enumerate() {
            for &j in &self.parts.following {
                sum[i] = sum[i] + self.displacements[(j, position)] * force[j];
            }
        }
        sum
    }
}

/// x' = A x in physical coordinates x = (q, q', w).
struct Physical {
    m: Matrix<Ball>,
    c: Matrix<Ball>,
    /// K after eliminating the coordinates that follow, on the coordinates that are states.
    k: Matrix<Ball>,
    a: Matrix<Ball>,
    /// q of every coordinate as rows over x.
    q: Matrix<Ball>,
}

impl Physical {
    fn of(system: &LinearSystem, parts: &Parts, sources: &Exogenous) -> Result<Physical, AnalysisError> {
        let n = system.n();
        let singular = |of: &[usize]| AnalysisError::singular_mass(system, of);
        let matrix = |form: &crate::system::Form| {
            let rows = form.assemble(n);
            Matrix::from_fn(n, n, |i, j| rows[i][j])
        };
        let (m, c, k) = (matrix(&system.m), matrix(&system.c), matrix(&system.k));
        let mut force = Matrix::none(n, sources.count);
        for &(i, state, factor) in &sources.force {
            force[(i, state)] = force[(i, state)] + factor;
        }
        let states = parts.states();
        let (heavy, damped, following) = (&parts.heavy, &parts.damped, &parts.following);
        let all: Vec<usize> = (0..sources.count).collect();
        // q_f = -X q + Y w
        let stiff = select(&k, following, following);
        let x = solve(&stiff, &select(&k, following, &states)).ok_or_else(|| singular(following))?;
        let y = solve(&stiff, &select(&force, following, &all)).ok_or_else(|| singular(following))?;
        let coupling = select(&k, &states, following);
        let k_states = difference(&select(&k, &states, &states), &product(&coupling, &x));
        let f_states = difference(&select(&force, &states, &all), &product(&coupling, &y));
        let (nr, na, e) = (states.len(), heavy.len(), sources.count);
        let size = nr + na + e;
        // C_0 q_0' = F_0 w - K_0 q - C_0a q_a'
        let low: Vec<usize> = (na..nr).collect();
        let rhs = Matrix::from_fn(low.len(), size, |i, j| {
            if j < nr {
                -k_states[(low[i], j)]
            } else if j < nr + na {
                -c[(damped[i], heavy[j - nr])]
            } else {
                f_states[(low[i], j - nr - na)]
            }
        });
        let creep = solve(&select(&c, damped, damped), &rhs)
            .ok_or_else(|| AnalysisError::dependent_mass(system, damped, true))?;
        let mut a = Matrix::none(size, size);
        for i in 0..na {
            a[(i, nr + i)] = Ball::ONE;
        }
        for j in 0..size {
            for i in 0..low.len() {
                a[(na + i, j)] = creep[(i, j)];
            }
        }
        // M q_a'' = F_a w - K_a q - C_aa q_a' - C_a0 q_0'
        let reaction = product(&select(&c, heavy, damped), &creep);
        let rhs = Matrix::from_fn(na, size, |i, j| {
            let direct = if j < nr {
                -k_states[(i, j)]
            } else if j < nr + na {
                -c[(heavy[i], heavy[j - nr])]
            } else {
                f_states[(i, j - nr - na)]
            };
            direct - reaction[(i, j)]
        });
        let acceleration = solve(&select(&m, heavy, heavy), &rhs)
            .ok_or_else(|| AnalysisError::dependent_mass(system, heavy, false))?;
        for j in 0..size {
            for i in 0..na {
                a[(nr + i, j)] = acceleration[(i, j)];
            }
        }
        for &(i, j, value) in &sources.generator {
            a[(nr + na + i, nr + na + j)] = value;
        }
        let mut q = Matrix::none(n, size);
        for (position, &i) in states.iter().enumerate() {
            q[(i, position)] = Ball::ONE;
        }
        for (row, &i) in following.iter().enumerate() {
            for j in 0..nr {
                q[(i, j)] = -x[(row, j)];
            }
            for j in 0..e {
                q[(i, nr + na + j)] = y[(row, j)];
            }
        }
        Ok(Physical { m, c, k: k_states, a, q })
    }
}

/// The transformation to energy coordinates, block by block, with its inverse.
struct Shaping {
    to: Matrix<Ball>,
    back: Matrix<Ball>,
}

impl Shaping {
    fn of(system: &LinearSystem, parts: &Parts, physical: &Physical, horizon: f64) -> Result<Shaping, AnalysisError> {
        let (na, nr) = (parts.heavy.len(), parts.heavy.len() + parts.damped.len());
        let m = select(&physical.m, &parts.heavy, &parts.heavy).mid();
        let n_factor = cholesky::upper(&m, LEAST_PIVOT)
            .ok_or_else(|| AnalysisError::dependent_mass(system, &parts.heavy, false))?;
        let c = select(&physical.c, &parts.damped, &parts.damped).mid();
        let k = physical.k.mid();
        let shifted = |sigma: f64| {
            Matrix::from_fn(nr, nr, |i, j| {
                let extra = if i < na && j < na {
                    m[(i, j)] * sigma
                } else if i >= na && j >= na {
                    c[(i - na, j - na)] * sigma.sqrt()
                } else {
                    Dd::ZERO
                };
                k[(i, j)] + extra
            })
        };
        let least = (2.0 / horizon.max(1e-150)).power(2);
        let mut s_factor = cholesky::upper(&shifted(0.0), LEAST_PIVOT);
        for shift in 0..MOST_SHIFTS {
            if s_factor.is_some() {
                break;
            }
            s_factor = cholesky::upper(&shifted(least * 4f64.power(shift)), LEAST_PIVOT);
            if s_factor.is_some() && shift > 0 {
                // Twice the least shift has the smallest rate: sigma / (2 sqrt(sigma - mu^2)) at sigma = 2 mu^2.
                s_factor = cholesky::upper(&shifted(2.0 * least * 4f64.power(shift)), LEAST_PIVOT);
            }
        }
        // M and C_0 are definite, so some shift suits unless the time, or what a number grows to in it, has no square in binary64.
        let s_factor = s_factor.ok_or_else(|| AnalysisError::out_of_range(system))?;
        let size = nr + na;
        let block = |s: &Matrix<Ball>, n: &Matrix<Ball>| {
            Matrix::from_fn(size, size, |i, j| match (i < nr, j < nr) {
                (true, true) => s[(i, j)],
                (false, false) => n[(i - nr, j - nr)],
                _ => Ball::ZERO,
            })
        };
        let exact = |factor: &Matrix<Dd>| factor.map(Ball::exact);
        let inverse = |factor: &Matrix<Dd>| {
            let identity =
                Matrix::from_fn(factor.rows(), factor.rows(), |i, j| if i == j { Ball::ONE } else { Ball::ZERO });
            solve(&exact(factor), &identity)
        };
        let (s_back, n_back) =
            inverse(&s_factor).zip(inverse(&n_factor)).ok_or_else(|| AnalysisError::out_of_range(system))?;
        Ok(Shaping { to: block(&exact(&s_factor), &exact(&n_factor)), back: block(&s_back, &n_back) })
    }
}

fn finish(
    system: &LinearSystem,
    parts: Parts,
    physical: Physical,
    shaping: Shaping,
    sources: &Exogenous,
) -> StateSpace {
    let (mechanical, size) = (shaping.to.rows(), physical.a.rows());
    let coupling = Matrix::from_fn(mechanical, size - mechanical, |i, j| physical.a[(i, mechanical + j)]);
    let scale = scales(&product(&shaping.to, &coupling), sources);
    let inverse: Vec<f64> = scale.iter().map(|w| 1.0 / w).collect();
    let whole = |block: &Matrix<Ball>, scale: &[f64]| {
        Matrix::from_fn(size, size, |i, j| {
            if i < mechanical && j < mechanical {
                block[(i, j)]
            } else if i == j {
                Ball::from(scale[i - mechanical])
            } else {
                Ball::ZERO
            }
        })
    };
    let (to, back) = (whole(&shaping.to, &inverse), whole(&shaping.back, &scale));
    let a = product(&to, &product(&physical.a, &back));
    let velocity = product(&physical.q, &physical.a);
    let acceleration = product(&velocity, &physical.a);
    let rows = [product(&physical.q, &back), product(&velocity, &back), product(&acceleration, &back)];
    let rest = sources_of_growth(&a, &rows[1], &Squares::of_form(&system.c)).map(|ball| ball.magnitude());
    let own_rate = norm_bound(mechanical, mechanical, |i, j| rest[(i, j)]);
    let (displacements, m, c) = (physical.q, physical.m, physical.c);
    StateSpace { a, rest, mechanical, own_rate, scale, rows, displacements, to_z: shaping.to, parts, m, c }
}

/// Approximate time in which the system forgets half of its state, if that is long before the horizon: the effect of
/// the sources accumulates no longer than that. It only chooses scales, so no result depends on its accuracy.
fn relaxation(physical: &Physical, shaping: &Shaping, horizon: f64) -> f64 {
    let n = shaping.to.rows();
    let own = Matrix::from_fn(n, n, |i, j| physical.a[(i, j)]);
    let size = |a: &Matrix<f64>| norm_bound(n, n, |i, j| a[(i, j)].abs());
    let times = |a: &Matrix<f64>, b: &Matrix<f64>| {
        Matrix::from_fn(n, n, |i, j| (0..n).map(|k| a[(i, k)] * b[(k, j)]).sum::<f64>())
    };
    if n > MOST_TO_RELAX {
        return f64::INFINITY;
    }
    let rough = |a: &Matrix<Ball>| a.map(|x| x.to_f64());
    let a = times(&rough(&shaping.to), &times(&rough(&own), &rough(&shaping.back)));
    let rate = size(&a);
    if !(rate * horizon > MANY_TURNS && rate.is_finite()) {
        return f64::INFINITY;
    }
    // exp(A h) by five terms, h = 1 / (8 |A|).
    let mut time = 0.125 / rate;
    let one = Matrix::from_fn(n, n, |i, j| if i == j { 1.0 } else { 0.0 });
    let mut power = one.clone();
    for k in (1..=5).rev() {
        let next = times(&a, &power);
        power = Matrix::from_fn(n, n, |i, j| one[(i, j)] + next[(i, j)] * time / f64::from(k));
    }
    while time < horizon {
        if size(&power) < 0.5 {
            return time;
        }
        power = times(&power, &power);
        time *= 2.0;
    }
    f64::INFINITY
}

/// Shorter motions do not need this, and for larger systems it takes too long.
const MANY_TURNS: f64 = 1e6;
const MOST_TO_RELAX: usize = 64;

/// Powers of two W that bring the effect of the sources on the system near 1 / T, where T is the longest time they act
/// or that the system remembers, and the states of a chain to the same magnitude.
pub fn scales(coupling: &Matrix<Ball>, sources: &Exogenous) -> Vec<f64> {
    let natural = |j: usize| {
        let size = coupling.column(j).iter().map(|x| x.magnitude().power(2)).sum::<f64>().sqrt();
        if size > 0.0 { 1.0 / (size * sources.longest[j]) } else { f64::INFINITY }
    };
    let mut scale: Vec<f64> = Vec::with_capacity(sources.count);
    for j in 0..sources.count {
        let paired = sources.paired.get(j + 1) == Some(&true);
        let wanted = if sources.paired[j] {
            scale[j - 1]
        } else if paired {
            natural(j).min(natural(j + 1))
        } else if sources.chained[j] {
            natural(j).min(scale[j - 1] / sources.longest[j])
        } else {
            natural(j)
        };
        scale.push(power_of_two_near(wanted));
    }
    scale
}

fn power_of_two_near(x: f64) -> f64 {
    if !(x.is_finite() && x > 0.0) {
        return 1.0;
    }
    let exponent = ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    two_to(exponent.clamp(-500, 500))
}

/// The part that may make |z| grow: (A + A^T) / 2 without the dissipation -L^T C L (L: the rows of the velocities, C:
/// its positive terms). The logarithmic norm of A is at most its largest eigenvalue, so at most its 2-norm.
fn sources_of_growth(a: &Matrix<Ball>, velocities: &Matrix<Ball>, c: &Squares) -> Matrix<Ball> {
    let size = a.rows();
    let half = Ball::from(0.5);
    let mut rest = Matrix::from_fn(size, size, |i, j| (a[(i, j)] + a[(j, i)]) * half);
    for t in (0..c.len()).filter(|&t| c.weights[t].is_positive()) {
        let (indices, values) = c.row(t);
        let mut stretch = vec![Ball::ZERO; size];
        for (&i, &factor) in indices.iter().zip(values) {
            for (j, entry) in stretch.iter_mut().enumerate() {
                *entry = *entry + factor * velocities[(i as usize, j)];
            }
        }
        for j in 0..size {
            let weighted = c.weights[t] * stretch[j];
            for i in 0..size {
                rest[(i, j)] = rest[(i, j)] + weighted * stretch[i];
            }
        }
    }
    rest
}

fn select(matrix: &Matrix<Ball>, rows: &[usize], columns: &[usize]) -> Matrix<Ball> {
    Matrix::from_fn(rows.len(), columns.len(), |i, j| matrix[(rows[i], columns[j])])
}

fn difference(a: &Matrix<Ball>, b: &Matrix<Ball>) -> Matrix<Ball> {
    Matrix::from_fn(a.rows(), a.columns(), |i, j| a[(i, j)] - b[(i, j)])
}

/// A sparse column as a dense one.
pub fn dense(column: &[(CoordinateId, crate::base::Number)], n: usize) -> Vec<Ball> {
    let mut values = vec![Ball::ZERO; n];
    for (i, value) in column {
        values[i.index()] = values[i.index()] + value.to_ball();
    }
    values
}
