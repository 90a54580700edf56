//! The normal distribution in binary64, with the same bits on every machine: for random numbers, not for bounds.

/// The probability that a standard normal variable is at most `x`.
pub fn cumulative(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}

/// The number that a standard normal variable exceeds with the probability 1 - `p`, to some 1e-16 of its size: algorithm AS 241,
/// PPND16 (M. J. Wichura, Applied Statistics 37, 1988, 477-484). Probabilities of 0 and 1 are taken for the nearest others.
pub fn quantile(p: f64) -> f64 {
    let p = p.clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON / 2.0);
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180625 - q * q;
        return q * polynomial(&CENTRE[0], r) / polynomial(&CENTRE[1], r);
    }
    let r = libm::sqrt(-libm::log(if q < 0.0 { p } else { 1.0 - p }));
    let [above, below] = if r <= 5.0 { &NEAR } else { &FAR };
    let r = r - if r <= 5.0 { 1.6 } else { 5.0 };
    let size = polynomial(above, r) / polynomial(below, r);
    if q < 0.0 { -size } else { size }
}

/// Horner's scheme, the constant term first.
fn polynomial(coefficients: &[f64; 8], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// Numerator and denominator for |p - 1/2| up to 0.425.
const CENTRE: [[f64; 8]; 2] = [
    [
        3.3871328727963665,
        133.14166789178438,
        1971.5909503065513,
        13731.69376550946,
        45921.95393154987,
        67265.7709270087,
        33430.57558358813,
        2509.0809287301227,
    ],
    [
        1.0,
        42.31333070160091,
        687.1870074920579,
        5394.196021424751,
        21213.794301586597,
        39307.89580009271,
        28729.085735721943,
        5226.495278852854,
    ],
];

/// For probabilities down to exp(-25).
const NEAR: [[f64; 8]; 2] = [
    [
        1.4234371107496835,
        4.630337846156546,
        5.769497221460691,
        3.6478483247632045,
        1.2704582524523684,
        0.2417807251774506,
        0.022723844989269184,
        0.0007745450142783414,
    ],
    [
        1.0,
        2.053191626637759,
        1.6763848301838038,
        0.6897673349851,
        0.14810397642748008,
        0.015198666563616457,
        0.0005475938084995345,
        1.0507500716444169e-09,
    ],
];

/// For smaller ones.
const FAR: [[f64; 8]; 2] = [
    [
        6.657904643501103,
        5.463784911164114,
        1.7848265399172913,
        0.29656057182850487,
        0.026532189526576124,
        0.0012426609473880784,
        2.7115555687434876e-05,
        2.0103343992922881e-07,
    ],
    [
        1.0,
        0.599832206555888,
        0.1369298809227358,
        0.014875361290850615,
        0.0007868691311456133,
        1.8463183175100548e-05,
        1.421511758316446e-07,
        2.0442631033899397e-15,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// The values that Wichura prints to check an implementation, and the usual two-sided 95 %.
    #[test]
    fn published_values() {
        let known =
            [(0.25, -0.674_489_750_196_081_7), (0.001, -3.090_232_306_167_814), (1e-20, -9.262_340_089_798_408)];
        for (p, z) in known.into_iter().chain([(0.975, 1.959_963_984_540_054), (0.5, 0.0)]) {
            assert!((quantile(p) - z).abs() <= 4e-16 * z.abs(), "{p}: {} and {z}", quantile(p));
        }
    }

    /// Each undoes the other; where the distribution is flat, by as much as its slope magnifies the rounding.
    #[test]
    fn quantiles_are_the_inverse() {
        for i in 1..400 {
            let p = f64::from(i) / 400.0;
            assert!((cumulative(quantile(p)) - p).abs() < 4e-16 * 3.0, "{p}");
            let small = libm::exp(-f64::from(i));
            assert!((cumulative(quantile(small)) / small - 1.0).abs() < 1e-12, "{small:e}");
        }
        assert!(quantile(0.0).is_finite() && quantile(1.0).is_finite());
    }
}
