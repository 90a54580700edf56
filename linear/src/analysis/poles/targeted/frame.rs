//! Bounds of all motions outside the span of the lowest undamped modes. In: the terms, approximate modes. Out: a bound
//! mu such that y^T K y >= mu y^T M y for every y in a complement Y of the modes X, and bounds of the coupling of X and
//! Y, in the norm of P = K + tau M. See docs/method/poles.md#poles-followed-from-modes.
//!
//! K - mu M has at most k negative eigenvalues (a certified count) and is negative definite on the k vectors X, so it
//! is positive semidefinite on Y = {y : X^T (K - mu M) y = 0} (Sylvester). With R = K X - M X Theta and X^T K Y = mu
//! X^T M Y, X^T M Y = (mu - Theta)^-1 R^T Y. So for any choice of the numbers a in C X = M X a^T + F,
//!
//!   X_i^T Q(s) Y = s F_i^T Y + sum_l (s a_il + delta_il (s^2 + mu)) / (mu - theta_l) R_l^T Y,
//!
//! and |f^T y| <= |f|_(P^-1) |y|_P.

use crate::analysis::modes::gram::Gram;
use crate::analysis::modes::mesh::elimination::{Factors, Rounding};
use crate::analysis::modes::mesh::least_inertia;
use crate::analysis::modes::mesh::network::UP;
use crate::analysis::modes::mesh::residual::{Image, Multiplier};
use crate::analysis::modes::terms::Terms;
use crate::analysis::poles::targeted::elimination::Networks;
use crate::base::{Dd, OrderBy, down, up};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::simd::simd;
use crate::kernel::triple::Triple;

/// The forms of a system as terms.
pub struct Forms<'a> {
    pub k: Terms<'a>,
    pub c: Terms<'a>,
    pub m: Terms<'a>,
}

/// An entry of X^T (form) X and a bound of its error.
#[derive(Clone, Copy, Debug, Default)]
pub struct Entry {
    pub value: f64,
    pub error: f64,
}

/// The first `count` modes of a frame; every y in their complement satisfies y^T K y >= mu y^T M y.
#[derive(Clone, Copy, Debug)]
pub struct Level {
    pub count: usize,
    mu: f64,
}

pub struct Frame<'a> {
    networks: &'a Networks,
    norm: DualNorm<'a>,
    pub x: Vec<Vec<f64>>,
    /// All modes of the frame.
    pub top: Level,
    theta: Vec<f64>,
    /// X^T K X, X^T C X, X^T M X.
    pub k: Matrix<Entry>,
    pub c: Matrix<Entry>,
    pub m: Matrix<Entry>,
    /// |F_i| and |R_i| in the norm of P^-1.
    damping: Vec<f64>,
    residual: Vec<f64>,
}

/// |f|_(P^-1) with P = K + tau M.
struct DualNorm<'a> {
    factors: Factors<'a>,
    k: Multiplier<'a>,
    m: Multiplier<'a>,
    tau: f64,
    /// M >= diag(scale), P >= least M.
    scale: Vec<f64>,
    least: f64,
}

/// The most corrections of the solution from which a norm is computed.
const MOST_CORRECTIONS: usize = 3;

impl<'a> Frame<'a> {
    /// A frame of the first modes, at least `wanted` of them, up to a gap; `modes` ascend, each with its omega^2 and
    /// shape. `None` if this gives no proof.
    pub fn of(
        forms: &'a Forms<'a>,
        networks: &'a Networks,
        modes: &[(f64, &[f64])],
        wanted: usize,
    ) -> Option<Frame<'a>> {
        let (count, mu) = gap(networks, modes, wanted)?;
        let norm = DualNorm::of(forms, networks, modes)?;
        let (theta, x): (Vec<f64>, Vec<Vec<f64>>) =
            modes[..count].iter().map(|&(theta, x)| (theta, x.to_vec())).unzip();
        let n = networks.k.n();
        let basis = Matrix::from_fn(n, count, |i, j| Triple::from(x[j][i]));
        let [k, c, m] = [&forms.k, &forms.c, &forms.m].map(|form| entries(&Gram::of(form, &basis)));
        let top = Level { count, mu };
        let frame = Frame { networks, norm, x, top, theta, k, c, m, damping: Vec::new(), residual: Vec::new() };
        frame.is_below(top).then(|| frame.with_couplings(forms))
    }

    /// The first `count` modes of the frame, if a gap follows them.
    pub fn level(&self, count: usize) -> Option<Level> {
        let (below, above) = (self.theta[count - 1], *self.theta.get(count)?);
        let mu = in_gap(self.networks, count, below, above)?;
        Some(Level { count, mu }).filter(|&level| self.is_below(level))
    }

    /// Whether X^T (K - mu M) X is negative definite (Gershgorin).
    fn is_below(&self, Level { count, mu }: Level) -> bool {
        let entry = |i: usize, j: usize| {
            let (k, m) = (self.k[(i, j)], self.m[(i, j)]);
            (k.value - mu * m.value, (k.error + mu * m.error) * UP + 1e-15 * (k.value.abs() + mu * m.value.abs()))
        };
        (0..count).all(|i| {
            let others: f64 = (0..count).filter(|&j| j != i).map(|j| entry(i, j).0.abs() + entry(i, j).1).sum();
            entry(i, i).0 + entry(i, i).1 + others * UP < 0.0
        })
    }

    /// Adds the norms of F and R. They need not be sharp: below `enough` they do no harm.
    fn with_couplings(mut self, forms: &Forms) -> Frame<'a> {
        let n = self.norm.scale.len();
        let c = Multiplier::of(&forms.c, n);
        let words: Vec<Vec<Dd>> = self.x.iter().map(|x| x.iter().map(|&x| Dd::from(x)).collect()).collect();
        let momenta: Vec<Image> = words.iter().map(|x| self.norm.m.apply(x)).collect();
        let gap = self.theta.windows(2).map(|pair| pair[1] - pair[0]).fold(self.top.mu, f64::min).max(0.0);
        let enough = 1e-2 * gap / self.top.mu;
        for (i, x) in words.iter().enumerate() {
            let mut rest = self.norm.k.apply(x);
            subtract(&mut rest, self.theta[i], &momenta[i]);
            self.residual.push(self.norm.of_image(&rest, enough * gap / self.top.mu.sqrt()));
            let mut rest = c.apply(x);
            for (l, momentum) in momenta.iter().enumerate() {
                subtract(&mut rest, self.c[(i, l)].value, momentum);
            }
            self.damping.push(self.norm.of_image(&rest, enough));
        }
        self
    }

    /// |y^H Q(s) y| is at least this times |y|_P^2 on Y, for every s within `radius` of the given one, in the upper
    /// half plane: with real m, c, k = y^H (M, C, K) y, im(y^H Q(s) y / s) = im s (m - k / |s|^2), and m <= k / mu.
    pub fn stiffness(&self, level: Level, s: Complex<f64>, radius: f64) -> f64 {
        let (size, height) = ((s.abs() + radius) * UP, s.im - radius);
        let slack = up::THOUSANDS;
        let part = 1.0 - size * size * slack / level.mu;
        height / size * part / (1.0 + self.norm.tau / level.mu) / slack
    }

    /// A bound of |X_i^T Q(s) y| / |y|_P on Y, for |s| <= size. Modes beyond the level are in Y: F contains their
    /// coupling by damping, and (theta + tau) M x = P x - R.
    pub fn coupling(&self, level: Level, i: usize, size: f64) -> f64 {
        let through = |l: usize| {
            let own = if l == i { size * size + level.mu } else { 0.0 };
            (size * self.c[(i, l)].value.abs() + own) * self.residual[l] / (level.mu - self.theta[l])
        };
        let beyond = |l: usize| {
            let (k, m) = (self.k[(l, l)], self.m[(l, l)]);
            let energy = k.value + k.error + self.norm.tau * (m.value + m.error);
            let momentum = ((energy * UP).sqrt() * UP + self.residual[l]) / (self.theta[l] + self.norm.tau);
            size * self.c[(i, l)].value.abs() * momentum
        };
        let inside: f64 = (0..level.count).map(through).sum();
        (size * self.damping[i] + inside + (level.count..self.theta.len()).map(beyond).sum::<f64>()) * UP
    }

    /// A bound of |f|_(P^-1) for a complex vector, from its real and imaginary parts.
    pub fn dual(&self, re: &Image, im: &Image, enough: f64) -> f64 {
        libm::hypot(self.norm.of_image(re, enough), self.norm.of_image(im, enough)) * UP
    }

    /// Like [`Self::dual`], without solving: at most the norm in diag(scale)^-1 over a root.
    pub fn rough_dual(&self, sizes: &[f64]) -> f64 {
        self.norm.rough(sizes.iter().copied())
    }
}

impl<'a> DualNorm<'a> {
    fn of(forms: &'a Forms<'a>, networks: &'a Networks, modes: &[(f64, &[f64])]) -> Option<DualNorm<'a>> {
        let lowest = modes.first()?.0;
        let next = modes.iter().map(|mode| mode.0).find(|&theta| theta > 1e-9 * modes[modes.len() - 1].0)?;
        // A part that floats or diverges is held by springs tau m.
        let (tau, below) =
            if lowest >= next { (0.0, 0.9 * lowest) } else { (2.0 * lowest.abs() + 0.1 * next, lowest.min(0.0)) };
        let below = below - 0.5 * tau;
        let count = networks.pattern.count(&networks.k, &networks.m, below, Rounding::Down);
        let n = networks.k.n();
        (count == Some(0)).then_some(())?;
        Some(DualNorm {
            factors: networks.pattern.factor(&networks.k, &networks.m, -tau)?,
            k: Multiplier::of(&forms.k, n),
            m: Multiplier::of(&forms.m, n),
            tau,
            scale: least_inertia(&networks.m)?,
            least: (below + tau) * down::THOUSANDS,
        })
    }

    /// A bound of |f|_(P^-1); a rough one if that is at most `enough`.
    fn of_image(&self, f: &Image, enough: f64) -> f64 {
        let mut best = self.rough(sizes(f));
        if best <= enough || !best.is_finite() {
            return best;
        }
        // f = P u + rest, |P u|_(P^-1) = |u|_P.
        let mut u = vec![Dd::ZERO; f.value.len()];
        let mut rest = f.clone();
        for _ in 0..MOST_CORRECTIONS {
            let mut change = vec![rest.value.iter().map(|f| f.to_f64()).collect::<Vec<f64>>()];
            self.factors.solve(&mut change, &mut Vec::new());
            u.iter_mut().zip(&change[0]).for_each(|(u, &d)| *u += Dd::from(d));
            let mut image = self.k.apply(&u);
            subtract(&mut image, -self.tau, &self.m.apply(&u));
            rest = f.clone();
            subtract(&mut rest, 1.0, &image);
            let tail = self.rough(sizes(&rest));
            let bound = (norm_of(&u, &image) + tail) * UP;
            if bound < best {
                best = bound;
            }
            if tail <= 0.1 * bound || best <= enough {
                break;
            }
        }
        best
    }

    /// |f|_(P^-1) <= |f|_(diag(scale)^-1) / sqrt(least), from the magnitudes of the entries.
    fn rough(&self, sizes: impl Iterator<Item = f64>) -> f64 {
        let sum: f64 = sizes.zip(&self.scale).map(|(f, scale)| f * f / scale).sum();
        (sum * UP / self.least).sqrt() * UP
    }
}

/// Upper bounds of the magnitudes of an image's entries.
fn sizes(f: &Image) -> impl Iterator<Item = f64> {
    f.value.iter().zip(&f.error).map(|(f, error)| f.hi.abs() * up::FEW + error)
}

/// A bound of |u|_P, where P u is the image: sums of a million products in double-double have an error below 1e-24 of
/// their parts.
fn norm_of(u: &[Dd], image: &Image) -> f64 {
    let (mut energy, mut doubt) = (Dd::ZERO, 0.0);
    for (&u, (&p, error)) in u.iter().zip(image.value.iter().zip(&image.error)) {
        energy += u * p;
        doubt += u.hi.abs() * (error + 1e-24 * p.hi.abs());
    }
    ((energy.hi.abs() + doubt * UP) * UP).sqrt() * UP
}

simd! {
    /// f <- f - factor g
    fn subtract(f: &mut Image, factor: f64, g: &Image) {
        let given = g.value.iter().zip(&g.error);
        for ((value, error), (&g, g_error)) in f.value.iter_mut().zip(&mut f.error).zip(given) {
            let part = g * factor;
            let sizes = value.hi.abs() + part.hi.abs();
            *value -= part;
            *error = (*error + factor.abs() * g_error + 2.0 * Dd::EPSILON * sizes) * up::FEW;
        }
    }
}

fn entries(gram: &Gram) -> Matrix<Entry> {
    let n = gram.mid.columns();
    Matrix::from_fn(n, n, |i, j| {
        let value = gram.mid[(i, j)].hi;
        Entry { value, error: gram.radius(i, j) + 2e-16 * value.abs() }
    })
}

/// A gap after the wanted modes: the number of modes below it, and a number in it below which there are no more.
fn gap(networks: &Networks, modes: &[(f64, &[f64])], wanted: usize) -> Option<(usize, f64)> {
    let room = |count: usize| (modes[count].0 - modes[count - 1].0) / modes[count].0;
    let mut counts: Vec<usize> = (wanted.max(1)..modes.len()).collect();
    counts.order_by(|&a, &b| room(b).total_cmp(&room(a)));
    for count in counts.into_iter().take(3) {
        if let Some(mu) = in_gap(networks, count, modes[count - 1].0, modes[count].0) {
            return Some((count, mu));
        }
    }
    None
}

/// A number in the gap such that at most `count` omega^2 lie below it.
fn in_gap(networks: &Networks, count: usize, below: f64, above: f64) -> Option<f64> {
    let holds = |mu: f64| {
        let most = networks.pattern.count(&networks.k, &networks.m, mu, Rounding::Down);
        mu > below && most.is_some_and(|most| most <= count)
    };
    [0.9, 0.5].into_iter().map(|part| below + part * (above - below)).find(|&mu| holds(mu))
}
