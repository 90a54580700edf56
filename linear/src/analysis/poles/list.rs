//! Collects poles as they are found: determines the kind, damping ratio and bound of each from its enclosure, and
//! finally sorts them. In: modes, roots, discs. Out: the list.
//! See docs/method/poles.md#definition and docs/method/poles.md#kinds-and-stability.

use crate::analysis::answer::{Mode, ModeKind, Modes, Pole, PoleKind, Poles, Route, modulus};
use crate::analysis::poles::companion::StateForm;
use crate::analysis::poles::coordinates::PoleCoordinates;
use crate::analysis::poles::count::Tally;
use crate::analysis::poles::discs::PoleEnclosure;
use crate::analysis::poles::exact::{ExactPoles, ExactRoot};
use crate::analysis::poles::passive::Passive;
use crate::analysis::poles::quadratic::{Root, Roots};
use crate::analysis::poles::residues::Residues;
use crate::base::{Ball, Dd, OrderBy, up};
use crate::kernel::complex::Complex;
use std::cmp::Ordering;
use std::sync::Arc;

/// Poles in the order in which they are found.
#[derive(Default)]
pub struct PoleList {
    list: Vec<Pole>,
    next_cluster: u32,
    /// Number of infinite poles of the current part.
    infinite: usize,
    tally: Tally,
    /// Index at which the current part begins.
    first: usize,
    /// Indices at which the poles of each part end, and those of each mode that is an independent oscillator.
    ends: Vec<usize>,
    /// The residues of a system that is one part.
    pub residues: Option<Residues>,
    /// The same.
    pub coordinates: Option<PoleCoordinates>,
    /// The same.
    pub state: Option<StateForm>,
}

/// The known facts about a pole that is not exactly zero.
struct PoleFacts {
    s: Complex<Ball>,
    kind: PoleKind,
    cluster: Option<u32>,
    defective: bool,
    route: Route,
}

impl PoleList {
    /// Adds the poles of modes without damping.
    pub fn add_undamped(&mut self, modes: &Modes) {
        let first = self.next_cluster;
        for mode in &modes.list {
            self.undamped_mode(mode, first);
        }
    }

    /// `first` is the first cluster number of this part.
    fn undamped_mode(&mut self, mode: &Mode, first: u32) {
        let sides = [0, 1].map(|side| self.renumber(first, mode.cluster.map(|number| 2 * number + side)));
        let zero = Ball::ZERO;
        let ends = match mode.kind {
            ModeKind::Rigid => return self.zeros(2),
            ModeKind::Oscillation => {
                [(zero, -mode.omega, PoleKind::Oscillation), (zero, mode.omega, PoleKind::Oscillation)]
            }
            ModeKind::Divergence => {
                [(-mode.omega, zero, PoleKind::Overdamped), (mode.omega, zero, PoleKind::Divergence)]
            }
            // The poles lie on one of the two axes, no farther from zero than this.
            ModeKind::Undetermined => [(mode.omega, mode.omega, PoleKind::Undetermined); 2],
        };
        for ((re, im, kind), cluster) in ends.into_iter().zip(sides) {
            self.push(PoleFacts { s: Complex::new(re, im), kind, cluster, defective: false, route: mode.route });
        }
    }

    /// Adds poles that are exactly zero.
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

    /// Adds poles that exist, but of which nothing else is known.
    pub fn unknown(&mut self, count: usize) {
        let anything = Ball::new(Dd::ZERO, f64::INFINITY);
        for _ in 0..count {
            let s = Complex::new(anything, anything);
            let kind = PoleKind::Undetermined;
            self.push(PoleFacts { s, kind, cluster: None, defective: false, route: Route::Refined });
        }
    }

    /// Records `count` infinite poles of the current part, proved by its motions without inertia.
    pub fn infinite(&mut self, count: usize) {
        self.infinite += count;
    }

    /// The number of poles, out of `of`, that are neither in the list nor known to be infinite.
    pub fn missing(&self, of: usize) -> usize {
        of.saturating_sub(self.list.len() + self.infinite)
    }

    /// Records that all poles of a part with this many coordinates are found.
    pub fn end_part(&mut self, coordinates: usize) {
        self.tally.part(coordinates, self.list.len() - self.first, self.infinite);
        if !self.list[self.first..].iter().all(is_enclosed) {
            self.tally.add_uncertain();
        }
        (self.first, self.infinite) = (self.list.len(), 0);
        self.ends.push(self.first);
    }

    /// Adds the roots of a quadratic.
    pub fn quadratic(&mut self, roots: Roots, passive: Passive) {
        let (pair, together, defective) = match roots {
            Roots::Distinct(pair) => (pair, false, false),
            Roots::Double(root) => ([root, root], true, true),
            Roots::Unseparated(pair) => (pair, true, false),
        };
        let cluster = together.then(|| self.new_cluster());
        for root in pair {
            self.root(root, cluster, defective, passive);
        }
        self.ends.push(self.list.len());
    }

    /// Adds a root that `count` motions share.
    pub fn add_repeated(&mut self, root: Root, count: usize, passive: Passive) {
        let cluster = (count > 1).then(|| self.new_cluster());
        (0..count).for_each(|_| self.root(root, cluster, false, passive));
        self.ends.push(self.list.len());
    }

    /// Adds a single root.
    pub fn root(&mut self, Root { re, im, kind }: Root, cluster: Option<u32>, defective: bool, passive: Passive) {
        // A ball around zero leaves the sign open; the dampers may decide it.
        let kind = match kind {
            PoleKind::Undetermined if im.is_zero() => real_kind(re, passive),
            PoleKind::Undetermined => complex_kind(Complex::new(re, im), passive),
            kind => kind,
        };
        self.push(PoleFacts { s: Complex::new(re, im), kind, cluster, defective, route: Route::Decoupled });
    }

    /// Adds the discs of a part's pairs, each marked if its centre is real.
    pub fn add_refined(&mut self, discs: impl Iterator<Item = (bool, PoleEnclosure)>, passive: Passive) {
        let first = self.next_cluster;
        for (real, disc) in discs {
            let [cluster, conjugate] = disc.clusters.map(|cluster| self.renumber(first, cluster));
            // A disc around a real centre that contains one pole also contains its conjugate: so the pole is real.
            let im = if real && cluster.is_none() { Ball::ZERO } else { disc.s.im };
            let known = |im: Ball, cluster: Option<u32>| PoleFacts {
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

    /// Adds poles from exact arithmetic.
    pub fn exact(&mut self, poles: &ExactPoles, passive: Passive) {
        self.zeros(poles.zeros());
        for root in poles.roots() {
            let sides = if root.real { vec![root.s.im] } else { vec![-root.s.im, root.s.im] };
            for im in sides {
                self.exact_side(root, im, passive);
            }
        }
    }

    fn exact_side(&mut self, root: &ExactRoot, im: Ball, passive: Passive) {
        let cluster = (root.multiplicity > 1).then(|| self.new_cluster());
        for _ in 0..root.multiplicity {
            self.push(PoleFacts {
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

    /// Renumbers a cluster so that it follows those of earlier parts, whose numbers are below `first`.
    fn renumber(&mut self, first: u32, cluster: Option<u32>) -> Option<u32> {
        let number = first + cluster?;
        self.next_cluster = self.next_cluster.max(number + 1);
        Some(number)
    }

    fn push(&mut self, known: PoleFacts) {
        let (re, im) = (centred_if_sign_unknown(known.s.re, known.s.im), known.s.im);
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
            relative_error: if low > 0.0 && size.is_finite() { radius / low * up::THOUSANDS } else { f64::INFINITY },
            damping_ratio: zeta.is_finite().then_some(zeta),
            kind: known.kind,
            cluster: known.cluster,
            defective: known.defective,
            route: known.route,
        });
    }

    /// Sorts the poles by |s|, re, im, and numbers the clusters in that order. `coordinates`: those of the system, each
    /// of which has two poles, some of them infinite.
    pub fn into_sorted(mut self, coordinates: usize) -> Poles {
        self.join_parts();
        let order = |a: Dd, b: Dd| a.partial_cmp(&b).unwrap_or(Ordering::Equal);
        self.list.order_by(|a, b| {
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
        Poles {
            count: self.tally.certain_count(coordinates),
            list: self.list,
            residues: self.residues.map(Arc::new),
            coordinates: self.coordinates.map(Arc::new),
            state: self.state.map(Arc::new),
            ..Poles::default()
        }
    }

    /// Poles of different parts, or of different modes, whose enclosures meet are a cluster too: they are equal, or not
    /// separated. Exact zeros are left alone, and a defective pole keeps its number, which says that it has one shape.
    fn join_parts(&mut self) {
        let may_join = |pole: &Pole| is_enclosed(pole) && pole.kind != PoleKind::Rigid && !pole.defective;
        let one = |i: usize| One {
            pole: i,
            part: self.ends.partition_point(|&end| end <= i),
            least: self.list[i].modulus().mignitude(),
            most: self.list[i].modulus().magnitude(),
        };
        let mut order: Vec<One> = (0..self.list.len()).filter(|&i| may_join(&self.list[i])).map(one).collect();
        order.order_by(|a, b| a.least.total_cmp(&b.least));
        let mut joined = Joined { above: (0..self.list.len()).collect() };
        let mut any = false;
        for (at, a) in order.iter().enumerate() {
            for b in order[at + 1..].iter().take_while(|b| b.least <= a.most) {
                if a.part != b.part && meet(&self.list[a.pole], &self.list[b.pole]) {
                    joined.join(a.pole, b.pole);
                    any = true;
                }
            }
        }
        if any {
            self.number_anew(joined);
        }
    }

    /// Renumbers the clusters: those that were known, and those that were joined.
    fn number_anew(&mut self, mut joined: Joined) {
        let mut first: Vec<Option<usize>> = vec![None; self.next_cluster as usize];
        for i in 0..self.list.len() {
            if let Some(number) = self.list[i].cluster {
                let of = *first[number as usize].get_or_insert(i);
                joined.join(of, i);
            }
        }
        let mut members = vec![0; self.list.len()];
        (0..self.list.len()).for_each(|i| members[joined.root(i)] += 1);
        for i in 0..self.list.len() {
            let root = joined.root(i);
            // A pole that cannot be distinguished from its conjugate may be a cluster by itself.
            if members[root] > 1 {
                self.list[i].cluster = Some(self.next_cluster + root as u32);
            }
        }
    }
}

/// A pole with the index of its part and the bounds of |s|.
struct One {
    pole: usize,
    part: usize,
    least: f64,
    most: f64,
}

/// Disjoint sets with path halving; a set's root is its least member.
struct Joined {
    above: Vec<usize>,
}

impl Joined {
    fn root(&mut self, mut i: usize) -> usize {
        while self.above[i] != i {
            self.above[i] = self.above[self.above[i]];
            i = self.above[i];
        }
        i
    }

    fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.root(i), self.root(j));
        self.above[i.max(j)] = i.min(j);
    }
}

fn size(pole: &Pole) -> Dd {
    pole.modulus().mid
}

fn is_enclosed(pole: &Pole) -> bool {
    pole.re.rad.is_finite() && pole.im.rad.is_finite()
}

fn meet(a: &Pole, b: &Pole) -> bool {
    (a.re - b.re).contains_zero() && (a.im - b.im).contains_zero()
}

/// If the real part of an oscillation cannot be distinguished from zero, it is shown as zero with a bound.
fn centred_if_sign_unknown(re: Ball, im: Ball) -> Ball {
    if re.contains_zero() && re.rad.is_finite() && !im.is_zero() { Ball::new(Dd::ZERO, re.magnitude()) } else { re }
}

/// The kind of a pole whose enclosure has a real centre.
fn real_kind(re: Ball, passive: Passive) -> PoleKind {
    match re.contains_zero() {
        false if re.mid.hi > 0.0 => PoleKind::Divergence,
        true if !passive.nothing_grows() => PoleKind::Undetermined,
        _ => PoleKind::Overdamped,
    }
}

/// For x^H Q(s) x = 0 the imaginary part is im (2 re x^H M x + x^H C x): with M > 0 and C >= 0 no oscillation grows.
fn complex_kind(s: Complex<Ball>, passive: Passive) -> PoleKind {
    let off_axis = !s.im.contains_zero();
    match s.re.contains_zero() {
        _ if passive.nothing_grows() || (passive.damped && off_axis) => PoleKind::Oscillation,
        false if s.re.mid.hi > 0.0 => PoleKind::Flutter,
        true if !s.re.is_zero() => PoleKind::Undetermined,
        _ => PoleKind::Oscillation,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::poles::quadratic::real_root;

    const PASSIVE: Passive = Passive { damped: true, held: true };

    fn root(re: f64, radius: f64) -> Root {
        real_root(Ball::new(Dd::from(re), radius))
    }

    #[test]
    fn a_list_with_a_pole_of_which_nothing_is_known_is_not_counted() {
        let mut found = PoleList::default();
        found.add_repeated(root(-1.0, 1e-20), 1, PASSIVE);
        found.unknown(1);
        found.end_part(1);
        let poles = found.into_sorted(1);
        assert_eq!((poles.list.len(), poles.count), (2, None));
        assert!(poles.is_uncounted());
    }

    #[test]
    fn a_list_is_counted_part_by_part() {
        let mut found = PoleList::default();
        found.zeros(2);
        found.end_part(1);
        found.add_repeated(root(-1.0, 1e-20), 1, PASSIVE);
        found.infinite(1);
        found.end_part(1);
        assert_eq!(found.into_sorted(2).infinite(), Some(1));
        // Three in one part and one in the other also make four, but are wrong.
        let mut found = PoleList::default();
        found.zeros(3);
        found.end_part(1);
        found.zeros(1);
        found.end_part(1);
        assert_eq!(found.into_sorted(2).count, None);
    }

    #[test]
    fn poles_that_meet_are_joined_with_their_clusters() {
        let mut found = PoleList::default();
        found.add_repeated(root(-1.0, 1e-20), 2, PASSIVE);
        found.add_repeated(root(-1.0 - 1e-15, 1e-12), 1, PASSIVE);
        found.add_repeated(root(-2.0, 1e-12), 1, PASSIVE);
        found.add_repeated(root(-2.0 - 1e-11, 1e-12), 1, PASSIVE);
        found.end_part(3);
        let clusters: Vec<Option<u32>> = found.into_sorted(3).list.iter().map(|pole| pole.cluster).collect();
        assert_eq!(clusters, [Some(0), Some(0), Some(0), None, None]);
    }

    /// A real part of 1 +- 3 is reported as zero with a radius that contains 4.
    #[test]
    fn a_real_part_about_zero_keeps_all_of_its_enclosure() {
        let reported = centred_if_sign_unknown(Ball::new(Dd::from(1.0), 3.0), Ball::ONE);
        assert!(reported.mid.is_zero() && reported.rad >= 4.0, "{reported:?}");
        assert_eq!(centred_if_sign_unknown(Ball::new(Dd::from(1.0), 3.0), Ball::ZERO).mid, Dd::from(1.0));
    }

    /// A pole whose enclosure crosses the axis is of a certain kind only if nothing can grow.
    #[test]
    fn poles_about_the_axis_are_undetermined() {
        let (about, feeding) = (Ball::new(Dd::from(-1e-20), 1e-19), Passive { damped: false, held: true });
        assert_eq!(real_kind(about, feeding), PoleKind::Undetermined);
        assert_eq!(real_kind(about, PASSIVE), PoleKind::Overdamped);
        assert_eq!(complex_kind(Complex::new(about, Ball::ONE), feeding), PoleKind::Undetermined);
        // With passive dampers a real pole of a falling part may still grow, so the kind of a pole that may be real is
        // undetermined.
        let falling = Passive { damped: true, held: false };
        assert_eq!(complex_kind(Complex::new(about, about), falling), PoleKind::Undetermined);
        assert_eq!(complex_kind(Complex::new(about, Ball::ONE), falling), PoleKind::Oscillation);
    }
}
