//! Bounds of rounding. A bound that is itself computed in binary64 is multiplied by one of these factors, which cover the
//! roundings that it took: k roundings make a number at most 1/(1 - k u) times too small, u the unit roundoff.

/// Unit roundoff u = 2^-53: the relative error of one operation in binary64, barring underflow.
pub const UNIT: f64 = f64::EPSILON / 2.0;

/// u^2 = 2^-106, the unit in which errors of double-double arithmetic are counted.
pub const UNIT_SQUARED: f64 = UNIT * UNIT;

/// Factors that make an upper bound not too small. The factor's own product is among the roundings.
pub mod up {
    /// Eight roundings.
    pub const FEW: f64 = 1.0 + 1e-15;
    /// Eighty roundings.
    pub const DOZENS: f64 = 1.0 + 1e-14;
    /// 8,000 roundings: sums of thousands of numbers that are not negative.
    pub const THOUSANDS: f64 = 1.0 + 1e-12;
    /// Eight million roundings.
    pub const MILLIONS: f64 = 1.0 + 1e-9;
    /// 800 million roundings: sums over all coordinates of the largest systems.
    pub const HUNDREDS_OF_MILLIONS: f64 = 1.0 + 1e-7;
}

/// Factors that make a lower bound not too large.
pub mod down {
    /// Eight roundings.
    pub const FEW: f64 = 1.0 - 1e-15;
    /// Eighty roundings.
    pub const DOZENS: f64 = 1.0 - 1e-14;
    /// 8,000 roundings.
    pub const THOUSANDS: f64 = 1.0 - 1e-12;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (1 - u)^k >= 1 - k u, so a true bound b comes out as b (1 - k u) at least, and times the factor it is b again.
    #[test]
    fn each_factor_covers_its_roundings() {
        let factors = [(8.0, up::FEW), (80.0, up::DOZENS), (8e3, up::THOUSANDS), (8e6, up::MILLIONS)];
        for (roundings, factor) in factors.into_iter().chain([(8e8, up::HUNDREDS_OF_MILLIONS)]) {
            let lost = roundings * UNIT;
            assert!(factor - 1.0 >= lost / (1.0 - lost) * 1.1, "{roundings}");
        }
        // From above, (1 + u)^k <= 1 / (1 - k u), so the remaining factor is below 1 - k u.
        for (roundings, factor) in [(8.0, down::FEW), (80.0, down::DOZENS), (8e3, down::THOUSANDS)] {
            assert!(1.0 - factor >= roundings * UNIT * 1.1, "{roundings}");
        }
        assert_eq!((UNIT, UNIT_SQUARED), (2f64.powi(-53), 2f64.powi(-106)));
    }

    /// The worst possible sums: each addition of half a unit is lost.
    #[test]
    fn a_sum_of_many_small_numbers_is_covered() {
        let lost = UNIT * 0.999;
        let sum = (0..8_000).fold(1.0, |sum, _| sum + lost);
        assert_eq!(sum, 1.0);
        assert!(sum * up::THOUSANDS >= 1.0 + 8_000.0 * lost);
    }
}
