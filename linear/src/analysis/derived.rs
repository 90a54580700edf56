//! Quantities that follow from an answer: frequencies in hertz, periods, decay times, half-lives, levels and angles,
//! and the bounds of the binary64 numbers that are printed for them. Measures, reports and JSON take them from here, so
//! that each is chosen and computed only once. See docs/method/report.md#numbers and
//! docs/method/report.md#error-bounds.

use crate::analysis::answer::{Mode, ModeKind, Pole, PoleKind};
use crate::analysis::modes::buckling::Buckling;
use crate::analysis::modes::splits::Split;
use crate::analysis::response::History;
use crate::analysis::transfer::Disc;
use crate::base::{Ball, Bound, Number, down, up};

/// Converts rad/s to Hz.
pub fn hertz(omega: Ball) -> Ball {
    omega / full_turn()
}

/// The time of one cycle in s, from an angular frequency in rad/s.
pub fn period(omega: Ball) -> Ball {
    full_turn() / omega
}

/// The time in s in which a motion that grows at this rate, in 1/s, doubles.
pub fn doubling_time(rate: Ball) -> Ball {
    Ball::LN_2 / rate
}

/// Converts radians to degrees.
pub fn degrees(angle: Ball) -> Ball {
    angle * Ball::from(180.0) / Ball::PI
}

/// 20 log10 of an amplitude ratio, dB; `None` for zero.
pub fn level(ratio: Ball) -> Option<Ball> {
    let level = Number::Ball(Ball::exact(ratio.mid)).to_decibel()?.to_ball();
    // d(20 log10 g) = 8.69 dg / g, and slightly more for a wide ball.
    Some(level.widen(8.7 * ratio.relative_error().min(1e300)))
}

fn full_turn() -> Ball {
    Ball::from(2.0) * Ball::PI
}

impl Mode {
    /// The angular frequency in rad/s; 0 for a rigid-body mode, `None` if it is not certain that the mode oscillates.
    pub fn angular_frequency(&self) -> Option<Ball> {
        matches!(self.kind, ModeKind::Oscillation | ModeKind::Rigid).then_some(self.omega)
    }

    /// The frequency in Hz; `None` if there is no angular frequency.
    pub fn frequency(&self) -> Option<Ball> {
        self.angular_frequency().map(hertz)
    }

    /// The period in s; `None` if the mode does not oscillate.
    pub fn period(&self) -> Option<Ball> {
        (self.kind == ModeKind::Oscillation).then(|| period(self.omega))
    }

    /// The growth rate in 1/s; `None` if the mode does not diverge.
    pub fn growth_rate(&self) -> Option<Ball> {
        (self.kind == ModeKind::Divergence).then_some(self.omega)
    }

    /// A bound of the relative error of the angular frequency and of the frequency (of the growth rate if the mode
    /// diverges), each as binary64; infinite if none is known.
    pub fn error_bound(&self) -> Bound {
        let frequency = if self.kind == ModeKind::Divergence { Ball::ZERO } else { hertz(self.omega) };
        Bound::relative(self.omega).or_larger(Bound::relative(frequency))
    }

    /// A bound of the relative error of the enclosures themselves, whose digits may go beyond binary64.
    pub fn enclosure_bound(&self) -> Bound {
        Bound::of_midpoint(self.omega).or_larger(Bound::of_midpoint(hertz(self.omega)))
    }
}

impl Split {
    /// The difference of the frequencies, Hz.
    pub fn frequency(&self) -> Ball {
        hertz(self.omega)
    }

    /// The largest difference that the bounds allow, rad/s.
    pub fn largest(&self) -> Bound {
        Bound::size(self.omega)
    }

    /// The period of the beat of the two modes, s.
    pub fn beat(&self) -> Ball {
        period(self.omega)
    }

    /// A bound of the relative error of both differences, in rad/s and Hz, as binary64.
    pub fn error_bound(&self) -> Bound {
        Bound::relative(self.omega).or_larger(Bound::relative(self.frequency()))
    }
}

impl Buckling {
    /// The relative amount by which the loads may grow; negative if they are too large already.
    pub fn margin(&self) -> Ball {
        self.load_factor - Ball::ONE
    }
}

impl Pole {
    /// |s| / (2 pi), Hz.
    pub fn frequency(&self) -> Ball {
        hertz(self.modulus())
    }

    /// |im s| / (2 pi), Hz.
    pub fn damped_frequency(&self) -> Ball {
        hertz(self.im.abs())
    }

    /// Whether the pole is one of a complex pair.
    pub fn is_complex(&self) -> bool {
        match self.kind {
            PoleKind::Oscillation | PoleKind::Flutter => true,
            PoleKind::Undetermined => self.im.mid.hi != 0.0,
            PoleKind::Overdamped | PoleKind::Rigid | PoleKind::Divergence => false,
        }
    }

    /// Whether the pole is the lower one of its pair; only the upper one counts as a motion.
    pub fn is_lower_half(&self) -> bool {
        self.is_complex() && self.im.mid.hi < 0.0
    }

    pub fn grows(&self) -> bool {
        matches!(self.kind, PoleKind::Flutter | PoleKind::Divergence)
    }

    /// 1 / |re s| in s, the time in which the amplitude falls to 1/e. `None` if the motion does not decay.
    pub fn decay_time(&self) -> Option<Ball> {
        (!self.grows() && !self.re.is_zero()).then(|| Ball::ONE / self.re.abs())
    }

    /// Number of cycles after which the amplitude has halved: ln 2 |im| / (2 pi |re|). `None` if the motion does not
    /// oscillate and decay.
    pub fn half_life(&self) -> Option<Ball> {
        let halves = self.is_complex() && !self.grows() && !self.re.is_zero();
        halves.then(|| hertz(Ball::LN_2 * self.im.abs() / self.re.abs()))
    }

    /// The time in s in which the amplitude doubles; `None` if the motion does not grow.
    pub fn doubling_time(&self) -> Option<Ball> {
        self.grows().then(|| doubling_time(self.re))
    }

    /// A bound of the relative error as binary64: of the point in the complex plane, of its modulus and of its frequency.
    pub fn error_bound(&self) -> Bound {
        let omega = self.modulus();
        if omega.is_zero() {
            return self.enclosure_bound();
        }
        let in_plane = (Bound::absolute(self.re) + Bound::absolute(self.im)).per(omega);
        in_plane.or_larger(Bound::relative(omega)).or_larger(Bound::relative(self.frequency()))
    }

    /// A bound of the relative error of the disc itself, whose digits may go beyond binary64.
    pub fn enclosure_bound(&self) -> Bound {
        Bound::by_proof(self.relative_error)
    }
}

impl Disc {
    /// The angle of the value in radians, in (-pi, pi]; `None` for zero.
    pub fn angle(&self) -> Option<Ball> {
        // At most the arcsine of the relative radius, which is less than pi / 2 times it.
        Some(self.midpoint_angle()?.widen(1.6 * self.relative_error().min(1e300)))
    }

    /// The angle in degrees, in (-180, 180]; `None` for zero.
    pub fn phase(&self) -> Option<Ball> {
        // The arcsine of the relative radius in degrees, which is less than 90 times it.
        Some(degrees(self.midpoint_angle()?).widen(90.0 * self.relative_error().min(1e300)))
    }

    fn midpoint_angle(&self) -> Option<Ball> {
        let (re, im) = (Number::Ball(Ball::exact(self.value.re)), Number::Ball(Ball::exact(self.value.im)));
        Some(Number::atan2(&im, &re)?.to_ball())
    }

    /// The gain in decibels; `None` for zero.
    pub fn level(&self) -> Option<Ball> {
        level(self.gain())
    }

    /// A bound of |printed - true| / |true| for the printed numbers: the two parts in the complex plane, and the gain.
    pub fn error_bound(&self) -> Bound {
        let [re, im] = [self.value.re, self.value.im].map(|part| Bound::absolute(Ball::exact(part)).value());
        let size = self.value.to_f64().abs() * down::FEW - self.radius;
        let in_plane = match (self.radius + re + im, size) {
            (0.0, _) => 0.0,
            (lost, size) if size > 0.0 => lost / size * up::THOUSANDS,
            _ => f64::INFINITY,
        };
        Bound::by_proof(in_plane).or_larger(Bound::relative(self.gain()))
    }

    /// The real and the imaginary part.
    pub fn parts(&self) -> [Ball; 2] {
        [self.value.re, self.value.im].map(|part| Ball::new(part, self.radius))
    }
}

impl History {
    /// The largest |printed - true| of an output's samples as binary64; infinite if some sample is unknown.
    pub fn error_bound(&self, output: usize) -> Bound {
        self.values.iter().map(|row| Bound::absolute(row[output])).fold(Bound::ZERO, Bound::or_larger)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::answer::Route;

    fn pole(re: f64, im: f64, kind: PoleKind) -> Pole {
        let (re, im) = (Ball::from(re), Ball::from(im));
        let (relative_error, damping_ratio, cluster, defective) = (0.0, None, None, false);
        Pole { re, im, relative_error, damping_ratio, kind, cluster, defective, route: Route::Exact }
    }

    fn assert_near(value: Option<Ball>, truth: f64) {
        let value = value.expect("a value");
        assert!(
            (value.to_f64() / truth - 1.0).abs() < 1e-15 && value.relative_error() < 1e-25,
            "{value:?}, not {truth}"
        );
    }

    /// s = -3 +- 4i: |s| = 5, the amplitude has halved after ln 2 / 3 s, which is 4 ln 2 / (6 pi) cycles.
    #[test]
    fn a_decaying_oscillation() {
        let pole = pole(-3.0, 4.0, PoleKind::Oscillation);
        let turn = std::f64::consts::TAU;
        assert_near(Some(pole.frequency()), 5.0 / turn);
        assert_near(Some(pole.damped_frequency()), 4.0 / turn);
        assert_near(pole.decay_time(), 1.0 / 3.0);
        assert_near(pole.half_life(), 4.0 * std::f64::consts::LN_2 / (3.0 * turn));
        assert!(pole.doubling_time().is_none() && pole.error_bound().value() < 3e-16);
    }

    #[test]
    fn a_growing_motion_has_no_decay_time() {
        let pole = pole(0.5, 1.0, PoleKind::Flutter);
        assert_near(pole.doubling_time(), 2.0 * std::f64::consts::LN_2);
        assert!(pole.decay_time().is_none() && pole.half_life().is_none());
        // Without damping, the motion never decays.
        let undamped = super::tests::pole(0.0, 1.0, PoleKind::Oscillation);
        assert!(undamped.decay_time().is_none() && undamped.half_life().is_none());
    }

    /// 20 log10 2 = 6.02059991327962390427..., from tables of logarithms.
    #[test]
    fn twice_as_much_is_six_decibels() {
        assert_near(level(Ball::from(2.0)), 6.020_599_913_279_624);
        assert!(level(Ball::ZERO).is_none());
        assert!(level(Ball::from(2.0).widen(1e-3)).expect("a level").rad > 4.3e-3);
    }
}
