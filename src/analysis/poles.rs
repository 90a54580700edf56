//! The poles of M s^2 + C s + K: every one of the 2n, each with a bound that holds. In: the linear system and its undamped
//! modes. Out: poles, ascending in |s|. Clause: spec.md 11.
//!
//! Independent parts are taken one by one. Without damping the poles are +-i omega; one coordinate is a quadratic; damping
//! C = alpha M + beta K makes a quadratic of each mode; what is left is refined from the companion matrix.

use super::aberth::aberth;
use super::answer::{Mode, ModeKind, Modes, Pole, PoleKind, Poles, Route};
use super::companion::Basis;
use super::complex::Complex;
use super::discs::{Disc, discs};
use super::error::AnalysisError;
use super::parts::{Part, as_system, independent};
use super::pencil::Pencil;
use super::pole_proportional::{Proportional, proportional};
use super::pole_quadratic::{Root, Roots, roots};
use super::pole_rigid::{RigidMotions, rigid_motions};
use super::refinement::{Pair, refine};
use crate::base::{Ball, Dd, Number};
use crate::system::{Form, LinearSystem};
use std::cmp::Ordering;

/// All poles.
pub fn poles(system: &LinearSystem, modes: &Modes) -> Result<Poles, AnalysisError> {
    let mut found = Found::default();
    if system.c.is_empty() {
        found.undamped(modes);
        return Ok(found.sorted());
    }
    let parts = independent(system);
    let mut local = vec![0u32; system.n()];
    for part in &parts {
        part.coordinates.iter().enumerate().for_each(|(i, &c)| local[c as usize] = i as u32);
    }
    for part in &parts {
        if part.coordinates.len() == 1 {
            single(system, part, &mut found)?;
        } else if parts.len() == 1 {
            solve_part(system, part, &local, modes, &mut found)?;
        } else {
            // Modes of the whole may mix equal frequencies of different parts.
            let own = super::modes(&as_system(system, part, &local))?;
            solve_part(system, part, &local, &own, &mut found)?;
        }
    }
    Ok(found.sorted())
}

/// `modes` are those of the part.
fn solve_part(
    system: &LinearSystem,
    part: &Part,
    local: &[u32],
    modes: &Modes,
    found: &mut Found,
) -> Result<(), AnalysisError> {
    if modes.list.len() != part.coordinates.len() {
        return Err(massless(system, part));
    }
    if part.c.is_empty() {
        found.undamped(modes);
    } else if let Some(proportional) = proportional(system, part) {
        modes.list.iter().for_each(|mode| found.decoupled(mode, &proportional));
    } else {
        general(system, part, local, modes, found);
    }
    Ok(())
}

/// Without inertia in some motion: as many modes are missing.
fn massless(system: &LinearSystem, part: &Part) -> AnalysisError {
    let coordinates: Vec<usize> = part.coordinates.iter().map(|&c| c as usize).collect();
    AnalysisError::singular_mass(system, &coordinates)
}

/// One coordinate: the sums of its terms, exact where they are.
fn single(system: &LinearSystem, part: &Part, found: &mut Found) -> Result<(), AnalysisError> {
    let m = diagonal(&system.m, &part.m);
    if !m.is_positive() {
        return Err(massless(system, part));
    }
    found.quadratic(roots(&m, &diagonal(&system.c, &part.c), &diagonal(&system.k, &part.k)), Route::Decoupled);
    Ok(())
}

/// sum w a^2 of terms on one coordinate.
fn diagonal(form: &Form, terms: &[u32]) -> Number {
    terms.iter().fold(Number::ZERO, |sum, &index| {
        let term = &form.terms()[index as usize];
        let square = form.row(term).iter().fold(Number::ZERO, |sum, (_, a)| &sum + &a.square());
        &sum + &(&term.weight * &square)
    })
}

/// Companion, refinement, discs.
fn general(system: &LinearSystem, part: &Part, local: &[u32], modes: &Modes, found: &mut Found) {
    let pencil = Pencil::of(system, part, local);
    let rigid = if modes.list.iter().any(|mode| mode.kind == ModeKind::Rigid) {
        rigid_motions(&as_system(system, part, local))
    } else {
        RigidMotions::default()
    };
    let working = pencil.to_dd();
    let basis = Basis::of(&working, modes, &rigid);
    let certified = |starts: &[Complex<f64>]| {
        let refined = starts.iter().enumerate().filter_map(|(seed, &start)| refine(&working, &basis, start, seed));
        let pairs: Vec<Pair> = refined.collect();
        let discs = discs(&pencil, &rigid, &pairs, 2 * pencil.n);
        (pairs, discs)
    };
    let starts = basis.starts();
    let (mut pairs, mut discs) = certified(&starts);
    if discs.is_empty() || !discs.iter().all(Disc::is_certified) {
        (pairs, discs) = certified(&aberth(&basis, &starts));
    }
    (0..basis.zeros()).for_each(|_| found.zero());
    let dissipative = pencil.c.all_positive() && pencil.m.all_positive();
    let first = found.next_cluster;
    for (pair, disc) in pairs.iter().zip(&discs) {
        found.refined(pair.is_real(), disc, dissipative, first);
    }
}

/// Poles as they are found.
#[derive(Default)]
struct Found {
    list: Vec<Pole>,
    next_cluster: u32,
}

impl Found {
    fn undamped(&mut self, modes: &Modes) {
        let first = self.next_cluster;
        modes.list.iter().for_each(|mode| self.undamped_mode(mode, first));
    }

    /// `first` is where the numbers of this part's clusters start.
    fn undamped_mode(&mut self, mode: &Mode, first: u32) {
        let sides = [0, 1].map(|side| self.numbered(first, mode.cluster.map(|number| 2 * number + side)));
        let pole = |re: Ball, im: Ball, zeta: Ball, kind: PoleKind, side: usize| Pole {
            re,
            im,
            relative_error: mode.omega.relative_error(),
            damping_ratio: Some(zeta),
            kind,
            cluster: sides[side],
            route: mode.route,
        };
        match mode.kind {
            ModeKind::Rigid => (0..2).for_each(|_| self.zero()),
            ModeKind::Oscillation => {
                self.list.push(pole(Ball::ZERO, -mode.omega, Ball::ZERO, PoleKind::Oscillation, 0));
                self.list.push(pole(Ball::ZERO, mode.omega, Ball::ZERO, PoleKind::Oscillation, 1));
            }
            ModeKind::Divergence => {
                self.list.push(pole(-mode.omega, Ball::ZERO, Ball::ONE, PoleKind::Overdamped, 0));
                self.list.push(pole(mode.omega, Ball::ZERO, -Ball::ONE, PoleKind::Divergence, 1));
            }
        }
    }

    /// A pole that is exactly zero.
    fn zero(&mut self) {
        self.list.push(Pole {
            re: Ball::ZERO,
            im: Ball::ZERO,
            relative_error: 0.0,
            damping_ratio: None,
            kind: PoleKind::Rigid,
            cluster: None,
            route: Route::Exact,
        });
    }

    /// s^2 + (alpha + beta omega^2) s + omega^2.
    fn decoupled(&mut self, mode: &Mode, damping: &Proportional) {
        let omega_squared = Number::Ball(mode.omega_squared);
        let c = damping.of_mode(&omega_squared);
        self.quadratic(roots(&Number::ONE, &c, &omega_squared), Route::Decoupled);
    }

    fn quadratic(&mut self, roots: Roots, route: Route) {
        let (pair, cluster) = match roots {
            Roots::Apart(pair) => (pair, None),
            Roots::Together(pair) => (pair, Some(self.new_cluster())),
        };
        for Root { re, im, kind } in pair {
            self.push(Complex::new(re, im), kind, cluster, route);
        }
    }

    fn new_cluster(&mut self) -> u32 {
        self.next_cluster += 1;
        self.next_cluster - 1
    }

    /// A refined pair's disc; `first` is where the numbers of this part's clusters start.
    fn refined(&mut self, real: bool, disc: &Disc, dissipative: bool, first: u32) {
        let [cluster, conjugate] = disc.clusters.map(|cluster| self.numbered(first, cluster));
        let Complex { re, im } = disc.s;
        if real {
            // A disc around a real centre that holds one pole holds its conjugate too: it is real.
            let im = if cluster.is_none() { Ball::ZERO } else { im };
            let kind = if re.is_positive() { PoleKind::Divergence } else { PoleKind::Overdamped };
            self.push(Complex::new(re, im), kind, cluster, Route::Refined);
            return;
        }
        // x^H Q(s) x = 0 has the imaginary part im (2 re x^H M x + x^H C x): with C >= 0 no oscillation grows.
        let kind = if re.is_positive() && !dissipative { PoleKind::Flutter } else { PoleKind::Oscillation };
        self.push(Complex::new(re, im), kind, cluster, Route::Refined);
        self.push(Complex::new(re, -im), kind, conjugate, Route::Refined);
    }

    /// A cluster's number beside those of the parts before, which end below `first`.
    fn numbered(&mut self, first: u32, cluster: Option<u32>) -> Option<u32> {
        let number = first + cluster?;
        self.next_cluster = self.next_cluster.max(number + 1);
        Some(number)
    }

    fn push(&mut self, s: Complex<Ball>, kind: PoleKind, cluster: Option<u32>, route: Route) {
        if s.re.is_zero() && s.im.is_zero() {
            return self.zero();
        }
        let size = (s.re.square() + s.im.square()).sqrt();
        let zeta = if s.im.is_zero() { Ball::from(-s.re.mid.hi.signum()) } else { -s.re / size };
        let low = size.mignitude();
        let relative_error = if low > 0.0 { s.radius() / low * (1.0 + 1e-12) } else { f64::INFINITY };
        self.list.push(Pole { re: s.re, im: s.im, relative_error, damping_ratio: Some(zeta), kind, cluster, route });
    }

    /// Ascending in |s|, re, im; clusters numbered in that order.
    fn sorted(mut self) -> Poles {
        let size = |pole: &Pole| pole.re.mid.square() + pole.im.mid.square();
        let order = |a: Dd, b: Dd| a.partial_cmp(&b).unwrap_or(Ordering::Equal);
        self.list.sort_by(|a, b| {
            order(size(a), size(b)).then_with(|| order(a.re.mid, b.re.mid)).then_with(|| order(a.im.mid, b.im.mid))
        });
        let mut numbers: Vec<u32> = Vec::new();
        for cluster in self.list.iter_mut().filter_map(|pole| pole.cluster.as_mut()) {
            let at = numbers.iter().position(|number| number == cluster).unwrap_or_else(|| {
                numbers.push(*cluster);
                numbers.len() - 1
            });
            *cluster = at as u32;
        }
        Poles { list: self.list }
    }
}
