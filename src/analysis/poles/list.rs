//! Poles as they are found: what is known of each becomes its kind, its damping ratio and its bound, and at the end all are
//! put in order. In: modes, roots, discs. Out: the list. Clauses: spec.md 11.1, 11.8.

use crate::analysis::answer::{Mode, ModeKind, Modes, Pole, PoleKind, Poles, Route, modulus};
use crate::analysis::numeric::complex::Complex;
use crate::analysis::poles::discs::Disc;
use crate::analysis::poles::exact::{ExactPoles, ExactRoot};
use crate::analysis::poles::quadratic::{Root, Roots};
use crate::base::{Ball, Dd};
use std::cmp::Ordering;

/// What is certain of a part whatever its poles' enclosures say.
#[derive(Clone, Copy, Debug)]
pub struct Passive {
    /// No term of M or C is negative: no oscillation grows.
    pub damped: bool,
    /// No omega^2 is negative: with `damped`, no pole has a positive real part.
    pub held: bool,
}

impl Passive {
    fn nothing_grows(self) -> bool {
        self.damped && self.held
    }
}

/// Poles in the order in which they are found.
#[derive(Default)]
pub struct PoleList {
    list: Vec<Pole>,
    next_cluster: u32,
}

/// What is known of a pole that is not exactly zero.
struct Known {
    s: Complex<Ball>,
    kind: PoleKind,
    cluster: Option<u32>,
    defective: bool,
    route: Route,
}

impl PoleList {
    /// The poles of modes without damping.
    pub fn undamped(&mut self, modes: &Modes) {
        let first = self.next_cluster;
        for mode in &modes.list {
            self.undamped_mode(mode, first);
        }
    }

    /// `first` is where the numbers of this part's clusters start.
    fn undamped_mode(&mut self, mode: &Mode, first: u32) {
        let sides = [0, 1].map(|side| self.numbered(first, mode.cluster.map(|number| 2 * number + side)));
        let zero = Ball::ZERO;
        let ends = match mode.kind {
            ModeKind::Rigid => return self.zeros(2),
            ModeKind::Oscillation => {
                [(zero, -mode.omega, PoleKind::Oscillation), (zero, mode.omega, PoleKind::Oscillation)]
            }
            ModeKind::Divergence => {
                [(-mode.omega, zero, PoleKind::Overdamped), (mode.omega, zero, PoleKind::Divergence)]
            }
            // On one of the two axes, both of them no farther from zero than this.
            ModeKind::Undetermined => [(mode.omega, mode.omega, PoleKind::Undetermined); 2],
        };
        for ((re, im, kind), cluster) in ends.into_iter().zip(sides) {
            self.push(Known { s: Complex::new(re, im), kind, cluster, defective: false, route: mode.route });
        }
    }

    /// Poles that are exactly zero.
    pub fn zeros(&mut self, count: usize) {
        let zero = Pole {
            re: Ball::ZERO,
            im: Ball::ZERO,
            relative_error: 0.0,
            damping_ratio: None,
            kind: PoleKind::Rigid,
            cluster: None,
            defective: false,
            route: Route::Exact,
        };
        self.list.extend(std::iter::repeat_n(zero, count));
    }

    /// Poles that are there, and of which nothing is known.
    pub fn unknown(&mut self, count: usize) {
        let anything = Ball::new(Dd::ZERO, f64::INFINITY);
        for _ in 0..count {
            let s = Complex::new(anything, anything);
            let kind = PoleKind::Undetermined;
            self.push(Known { s, kind, cluster: None, defective: false, route: Route::Refined });
        }
    }

    /// The roots of a quadratic.
    pub fn quadratic(&mut self, roots: Roots) {
        let (pair, together, defective) = match roots {
            Roots::Apart(pair) => (pair, false, false),
            Roots::Double(root) => ([root, root], true, true),
            Roots::Together(pair) => (pair, true, false),
        };
        let cluster = together.then(|| self.new_cluster());
        for root in pair {
            self.root(root, cluster, defective);
        }
    }

    /// A root by itself.
    pub fn root(&mut self, Root { re, im, kind }: Root, cluster: Option<u32>, defective: bool) {
        self.push(Known { s: Complex::new(re, im), kind, cluster, defective, route: Route::Decoupled });
    }

    /// The discs of a part's pairs, each marked where its centre is real.
    pub fn refined(&mut self, discs: impl Iterator<Item = (bool, Disc)>, passive: Passive) {
        let first = self.next_cluster;
        for (real, disc) in discs {
            let [cluster, conjugate] = disc.clusters.map(|cluster| self.numbered(first, cluster));
            // A disc around a real centre that holds one pole holds its conjugate too: it is real.
            let im = if real && cluster.is_none() { Ball::ZERO } else { disc.s.im };
            let known = |im: Ball, cluster: Option<u32>| Known {
                s: Complex::new(disc.s.re, im),
                kind: if real { real_kind(disc.s.re, passive) } else { complex_kind(disc.s, passive) },
                cluster,
                defective: false,
                route: Route::Refined,
            };
            self.push(known(im, cluster));
            if !real {
                self.push(known(-im, conjugate));
            }
        }
    }

    /// Poles from exact arithmetic.
    pub fn exact(&mut self, poles: &ExactPoles, passive: Passive) {
        self.zeros(poles.zeros);
        for root in &poles.roots {
            let sides = if root.real { vec![root.s.im] } else { vec![-root.s.im, root.s.im] };
            for im in sides {
                self.exact_side(root, im, passive);
            }
        }
    }

    fn exact_side(&mut self, root: &ExactRoot, im: Ball, passive: Passive) {
        let cluster = (root.multiplicity > 1).then(|| self.new_cluster());
        for _ in 0..root.multiplicity {
            self.push(Known {
                s: Complex::new(root.s.re, im),
                kind: if root.real { real_kind(root.s.re, passive) } else { complex_kind(root.s, passive) },
                cluster,
                defective: root.defective,
                route: Route::Exact,
            });
        }
    }

    fn new_cluster(&mut self) -> u32 {
        self.next_cluster += 1;
        self.next_cluster - 1
    }

    /// A cluster's number beside those of the parts before, which end below `first`.
    fn numbered(&mut self, first: u32, cluster: Option<u32>) -> Option<u32> {
        let number = first + cluster?;
        self.next_cluster = self.next_cluster.max(number + 1);
        Some(number)
    }

    fn push(&mut self, known: Known) {
        let (re, im) = (not_told_from_zero(known.s.re, known.s.im), known.s.im);
        if re.is_zero() && im.is_zero() {
            return self.zeros(1);
        }
        let size = modulus(re, im);
        let zeta = if im.is_zero() { Ball::from(-re.mid.hi.signum()) } else { -re / size };
        let low = size.mignitude();
        let radius = Complex::new(re, im).radius();
        self.list.push(Pole {
            re,
            im,
            relative_error: if low > 0.0 && size.is_finite() { radius / low * (1.0 + 1e-12) } else { f64::INFINITY },
            damping_ratio: zeta.is_finite().then_some(zeta),
            kind: known.kind,
            cluster: known.cluster,
            defective: known.defective,
            route: known.route,
        });
    }

    /// Ascending in |s|, re, im; clusters numbered in that order. `coordinates` of the system: each has two poles, some of
    /// them infinite.
    pub fn sorted(mut self, coordinates: usize) -> Poles {
        let size = |pole: &Pole| pole.modulus().mid;
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
        Poles { infinite: (2 * coordinates).saturating_sub(self.list.len()), list: self.list, ..Poles::default() }
    }
}

/// The real part of an oscillation that is not told from zero is shown as zero and its bound.
fn not_told_from_zero(re: Ball, im: Ball) -> Ball {
    if re.contains_zero() && re.rad.is_finite() && !im.is_zero() { Ball::new(Dd::ZERO, re.magnitude()) } else { re }
}

/// The kind of a pole around a real centre.
fn real_kind(re: Ball, passive: Passive) -> PoleKind {
    match re.contains_zero() {
        false if re.mid.hi > 0.0 => PoleKind::Divergence,
        true if !passive.nothing_grows() => PoleKind::Undetermined,
        _ => PoleKind::Overdamped,
    }
}

/// x^H Q(s) x = 0 has the imaginary part im (2 re x^H M x + x^H C x): with M > 0 and C >= 0 no oscillation grows.
fn complex_kind(s: Complex<Ball>, passive: Passive) -> PoleKind {
    let off_axis = !s.im.contains_zero();
    match s.re.contains_zero() {
        _ if passive.nothing_grows() || (passive.damped && off_axis) => PoleKind::Oscillation,
        false if s.re.mid.hi > 0.0 => PoleKind::Flutter,
        true if !s.re.is_zero() => PoleKind::Undetermined,
        _ => PoleKind::Oscillation,
    }
}
