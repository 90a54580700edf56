//! The answers of the analyses.

use crate::analysis::poles::companion::StateForm;
use crate::analysis::poles::coordinates::PoleCoordinates;
use crate::analysis::poles::count::PoleCount;
use crate::analysis::poles::residues::Residues;
use crate::base::{Ball, Dd, Unproven};
use crate::system::{CoordinateId, Source};
use std::sync::Arc;

/// The method that found a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Route {
    /// Decided exactly, on rational numbers: a rigid motion, a root of the polynomial det(K - x M).
    Exact,
    /// One-sided Jacobi on the factors in binary64, Rayleigh quotients and certificate in double-double.
    Factored,
    /// Like [`Route::Factored`], in double-double throughout.
    FactoredDoubleDouble,
    /// The assembled matrices in double-double.
    Assembled,
    /// Subtraction-free elimination of a network of springs, then Jacobi.
    StarMesh,
    /// The assembled matrices in binary64, then residuals of the terms in double-double.
    Dense,
    /// Sparse elimination, the Lanczos method, residuals in double-double and a count.
    Sparse,
    /// Bisection and Newton steps on a tree.
    Tree,
    /// Counts of negative pivots in floating point of hundreds of bits.
    Counted,
    /// The modes of the positive terms first, then Jacobi in their energies: for negative stiffness.
    Energy,
    /// Classical damping: each mode is an independent oscillator.
    Decoupled,
    /// Companion matrix, then Newton steps with residuals of the terms in double-double.
    Refined,
}

impl Route {
    /// The name in reports: `factored`, `star-mesh`, ...
    pub fn name(self) -> &'static str {
        match self {
            Route::Exact => "exact",
            Route::Factored => "factored",
            Route::FactoredDoubleDouble => "factored-dd",
            Route::Assembled => "assembled-dd",
            Route::StarMesh => "star-mesh",
            Route::Dense => "dense",
            Route::Sparse => "sparse",
            Route::Tree => "tree",
            Route::Counted => "counted",
            Route::Energy => "energy",
            Route::Decoupled => "decoupled",
            Route::Refined => "refined",
        }
    }
}

/// The undamped modes, ascending in omega^2 (divergences first, then rigid motions, then oscillations).
#[derive(Clone, Debug, Default)]
pub struct Modes {
    pub list: Vec<Mode>,
    /// Number of motions without inertia, whose frequency is infinite: they follow the others and are not in the list.
    pub infinite: usize,
    /// Number of modes below those of the list: they were not requested, and are counted without being computed.
    pub before: Before,
    /// Number of modes above those of the list: they were not requested, and are counted without being computed.
    pub after: usize,
}

/// The number of modes of each kind that come before those of a list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Before {
    pub divergences: usize,
    pub undetermined: usize,
    pub rigid: usize,
    pub oscillations: usize,
}

impl Before {
    pub fn count(self) -> usize {
        self.divergences + self.undetermined + self.rigid + self.oscillations
    }

    pub(in crate::analysis) fn plus(self, other: Before) -> Before {
        Before {
            divergences: self.divergences + other.divergences,
            undetermined: self.undetermined + other.undetermined,
            rigid: self.rigid + other.rigid,
            oscillations: self.oscillations + other.oscillations,
        }
    }
}

impl Modes {
    /// Whether every mode is in the list.
    pub fn is_complete(&self) -> bool {
        self.before.count() + self.after == 0
    }

    /// The modes with their numbers, counted from 1 for the lowest of all.
    pub fn with_numbers(&self) -> impl Iterator<Item = (usize, &Mode)> {
        (self.before.count() + 1..).zip(&self.list)
    }
}

/// Up to this many coordinates, modes keep their shapes in double-double. Beyond it, the analyses that need them are
/// not available either.
pub(in crate::analysis) const PRECISE: usize = 128;

/// A mode of M q'' + K q = 0.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Mode {
    pub kind: ModeKind,
    /// omega^2 as an enclosure, 1/s^2; exactly zero for a rigid motion.
    pub omega_squared: Ball,
    /// omega in rad/s for an oscillation, the growth rate in 1/s for a divergence, exactly zero for a rigid motion. The
    /// radius is a proven absolute bound; infinite if nothing could be certified.
    pub omega: Ball,
    /// Modes that are certified only together (a repeated frequency or a tight cluster) share a number; `None` for a
    /// single mode.
    pub cluster: Option<u32>,
    /// Displacement of each coordinate, mass-normalised (shape^T M shape = 1), sign as spec.md's "Normalisation" says.
    pub shape: Vec<f64>,
    /// The shape in double-double as computed: most modes of fewer than 64 coordinates have about 30 correct digits.
    /// `None` if it was computed in binary64, and in systems of more than 128 coordinates.
    pub precise: Option<Vec<Dd>>,
    /// The sensitivity of omega to relative errors of the inputs; log10 of the inverse of this times their relative
    /// error is the number of digits that they determine. (sum |k e^2| + sum |g e^2|) / |omega^2 m x^2| + 1. `None` for
    /// rigid motions.
    pub input_condition: Option<Unproven>,
    /// The coordinate whose displacement leads the shape: the first of the largest translations, or of the largest
    /// rotations if the translations have no kinetic energy. `None` if nothing moves.
    pub leading: Option<CoordinateId>,
    /// Shares of the kinetic energy by body, largest first, none negative, summing to 1.
    pub kinetic: Vec<Share<Source>>,
    /// Shares of the strain energy by its source (a spring's name, gravity), largest first, summing to 1 (shares of
    /// geometric terms may be negative). Empty for rigid motions, and if the parts cancel.
    pub strain: Vec<Share<Source>>,
    pub route: Route,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModeKind {
    /// omega^2 > 0
    Oscillation,
    /// omega^2 = 0 exactly
    Rigid,
    /// omega^2 < 0: the motion grows like exp(growth t)
    Divergence,
    /// The enclosure of omega^2 contains zero and no exact argument settles its sign; omega is then 0 with the radius
    /// sqrt(bound of |omega^2|).
    Undetermined,
}

/// A share of a total.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share<T> {
    pub of: T,
    /// Computed from a shape, which has no bound.
    pub part: Unproven,
}

/// The poles of M s^2 + C s + K, ascending in |s|, then in the real part, then in the imaginary part; both
/// of a complex pair.
#[derive(Clone, Debug, Default)]
pub struct Poles {
    pub list: Vec<Pole>,
    /// The number of poles, if it is proved that all were found, each once.
    pub count: Option<PoleCount>,
    /// Number of poles that were not computed or are not listed, because not all modes were requested.
    pub left_out: usize,
    /// Whether each pole was followed from a mode separately. It is then not proved that there are no others in
    /// between.
    pub followed: bool,
    /// Transfer functions as sums over the poles, if they were requested and proved.
    pub residues: Option<Arc<Residues>>,
    /// The motion in coordinates of the poles, where it was asked for and proved.
    pub coordinates: Option<Arc<PoleCoordinates>>,
    /// The state matrix with its Schur form, where the poles were found by one of a system that is one part.
    pub state: Option<Arc<StateForm>>,
}

impl Poles {
    /// The number of infinite poles (of two for each coordinate), due to motions without inertia, if it is proved.
    pub fn infinite(&self) -> Option<usize> {
        self.count.map(PoleCount::infinite)
    }

    /// Whether all poles should be in the list, but this is not proved.
    pub fn is_uncounted(&self) -> bool {
        self.left_out == 0 && self.count.is_none()
    }

    /// Whether every pole is in the list, and this is proved.
    pub fn is_complete(&self) -> bool {
        self.count.is_some_and(|count| count.finite() == self.list.len())
    }
}

#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Pole {
    /// Real part, 1/s.
    pub re: Ball,
    /// Imaginary part, rad/s.
    pub im: Ball,
    /// Bound of |computed - true| / |true|; infinite if nothing could be certified, 0 for an exact zero.
    pub relative_error: f64,
    /// zeta = -re / |s|; `None` for a pole at zero.
    pub damping_ratio: Option<Ball>,
    pub kind: PoleKind,
    /// Poles that are certified only together: a double pole, or several that are not separated.
    pub cluster: Option<u32>,
    /// Whether it is proved that the poles of the cluster are exactly equal and have fewer vectors than their number, as in critical
    /// damping: motions like t exp(s t) occur. Where it is not, nothing is claimed.
    pub defective: bool,
    pub route: Route,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoleKind {
    /// A complex pair with re <= 0.
    Oscillation,
    /// Real and negative.
    Overdamped,
    /// Exactly zero.
    Rigid,
    /// Real and positive.
    Divergence,
    /// A complex pair with re > 0.
    Flutter,
    /// The sign of the real part is not certain.
    Undetermined,
}

impl Pole {
    /// |s|, rad/s.
    pub fn modulus(&self) -> Ball {
        modulus(self.re, self.im)
    }
}

/// sqrt(re^2 + im^2), scaled by a power of two so that the squares stay within the range of binary64.
pub(in crate::analysis) fn modulus(re: Ball, im: Ball) -> Ball {
    if im.is_zero() {
        return re.abs();
    }
    if re.is_zero() {
        return im.abs();
    }
    let largest = re.magnitude().max(im.magnitude());
    let power = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
    let inverse = 1.0 / power;
    if !(power.is_normal() && inverse.is_normal()) {
        return Ball::new(re.mid, f64::INFINITY);
    }
    // Powers of two change no digit, except for an underflow, which is less than the least positive number.
    let scaled = |x: Ball, by: f64| Ball::new(x.mid.scale(by), x.rad * by).widen(f64::MIN_POSITIVE);
    let (re, im) = (scaled(re, inverse), scaled(im, inverse));
    scaled((re.square() + im.square()).sqrt(), power)
}

impl PoleKind {
    /// The name in JSON and in reports.
    pub fn name(self) -> &'static str {
        match self {
            PoleKind::Oscillation => "oscillation",
            PoleKind::Overdamped => "overdamped",
            PoleKind::Rigid => "rigid",
            PoleKind::Divergence => "divergence",
            PoleKind::Flutter => "flutter",
            PoleKind::Undetermined => "undetermined",
        }
    }
}

impl ModeKind {
    /// The name in JSON and in reports.
    pub fn name(self) -> &'static str {
        match self {
            ModeKind::Oscillation => "oscillation",
            ModeKind::Rigid => "rigid",
            ModeKind::Divergence => "divergence",
            ModeKind::Undetermined => "undetermined",
        }
    }
}
