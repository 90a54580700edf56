//! The binomial distribution in binary64, with the same bits on every machine: for statistics, not for bounds.

/// The two-sided interval of 95 % for the probability of an event that was seen in `seen` of `number` independent cases, from below:
/// the probability at which so many or more are seen with a chance of 2.5 % (C. J. Clopper, E. S. Pearson, Biometrika 26, 1934,
/// 404-413). The upper end is 1 less that of the cases without the event. It holds in at least 95 % of all studies, however few the
/// cases.
pub fn least_probability(seen: u64, number: u64) -> f64 {
    if seen == 0 {
        return 0.0;
    }
    let (a, b) = (seen as f64, (number - seen) as f64 + 1.0);
    let [mut low, mut high] = [0.0, 1.0];
    // Halved until no number lies between.
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return low;
        }
        match beta_share(a, b, middle) < 0.025 {
            true => low = middle,
            false => high = middle,
        }
    }
}

/// The regularised incomplete beta function I_x(a, b), 0 < x < 1: the probability of `a` events or more in a + b - 1 cases.
fn beta_share(a: f64, b: f64, x: f64) -> f64 {
    // The fraction converges fast on this side of the mean.
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - beta_share(b, a, 1.0 - x);
    }
    let log = libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * libm::log(x) + b * libm::log1p(-x);
    libm::exp(log) / (a * fraction(a, b, x))
}

/// The continued fraction of NIST DLMF 8.17.22, by the method of Lentz. Some sqrt(max(a, b)) terms are enough.
fn fraction(a: f64, b: f64, x: f64) -> f64 {
    let (mut value, mut c, mut d) = (1.0, 1.0, 0.0);
    let most = 100 + 10 * libm::sqrt(a.max(b)) as u64;
    for term in 0..most {
        let m = term as f64;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let next = m + 1.0;
        let even = next * (b - next) * x / ((a + 2.0 * next - 1.0) * (a + 2.0 * next));
        let mut change = 1.0;
        for numerator in [odd, even] {
            d = 1.0 / (1.0 + numerator * d);
            c = 1.0 + numerator / c;
            change = c * d;
            value *= change;
        }
        if (change - 1.0).abs() < f64::EPSILON {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::least_probability;

    /// The sum of the chances of `seen` or more events.
    fn chance(seen: u64, number: u64, p: f64) -> f64 {
        let mut term = crate::base::Power::power(1.0 - p, number as i32);
        let mut below = 0.0;
        for k in 0..seen {
            below += term;
            term *= (number - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
        }
        1.0 - below
    }

    /// By the sum itself, and by closed forms for none and for all.
    #[test]
    fn the_chance_at_the_end_of_the_interval_is_a_fortieth() {
        for (seen, number) in [(1, 1), (1, 2), (3, 10), (10, 10), (32, 50), (49, 50), (7, 400), (200, 400)] {
            let p = least_probability(seen, number);
            assert!((chance(seen, number, p) - 0.025).abs() < 1e-9, "{seen} of {number}: {p}");
        }
        assert_eq!(least_probability(0, 17), 0.0);
        let all = least_probability(20, 20);
        assert!((all - libm::pow(0.025, 0.05)).abs() < 1e-12, "{all}");
    }

    /// Far more cases than a sum could take: near the normal distribution there.
    #[test]
    fn many_cases_are_no_obstacle() {
        let (number, p) = (1_000_000_000_u64, 0.3_f64);
        let normal = p - 1.959_963_985 * libm::sqrt(p * (1.0 - p) / number as f64);
        assert!((least_probability(300_000_000, number) - normal).abs() < 1e-8);
        let one = least_probability(1, number);
        // A Poisson variable with this mean is not zero with a chance of a fortieth.
        assert!((one * 1e9 - 0.025_317_807_984_289_86).abs() < 1e-6, "{one}");
    }
}
