//! The binomial distribution in binary64, with the same bits on every machine: for statistics, not for bounds.

/// The two-sided interval of 95 % for the probability of an event that was seen in `seen` of `number` independent cases, from below:
/// the probability at which this many or more are seen with a chance of 2.5 % (C. J. Clopper, E. S. Pearson, Biometrika 26, 1934,
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

/// The ranks, from 1, of those of `number` independent values, in ascending order, between which the p-quantile of their
/// distribution lies in at least 95 % of all studies, whatever the distribution (H. A. David, H. N. Nagaraja, *Order Statistics*, 3rd
/// edition, Wiley 2003, section 7.1). `None` for an end beyond all values.
pub fn ranks_of_quantile(p: f64, number: u64) -> [Option<u64>; 2] {
    // The lower one is at most the quantile if this many values or more are: a binomial variable with this p.
    let below = |p: f64| {
        let is_sure = |rank: u64| beta_share(rank as f64, (number - rank) as f64 + 1.0, p) >= 0.975;
        let (mut sure, mut unsure) = (0, number + 1);
        while unsure - sure > 1 {
            let middle = sure + (unsure - sure) / 2;
            match is_sure(middle) {
                true => sure = middle,
                false => unsure = middle,
            }
        }
        (sure > 0).then_some(sure)
    };
    [below(p), below(1.0 - p).map(|rank| number + 1 - rank)]
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
    use super::{least_probability, ranks_of_quantile};

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

    /// Ranks about the median as published (W. J. Conover, *Practical Nonparametric Statistics*, table A3), and by sums of chances: one
    /// rank further inwards is not sure enough.
    #[test]
    fn ranks_are_those_of_the_tables() {
        assert_eq!(ranks_of_quantile(0.5, 5), [None, None]);
        for (number, low, high) in [(6, 1, 6), (8, 1, 8), (10, 2, 9), (15, 4, 12), (20, 6, 15), (1000, 469, 532)] {
            assert_eq!(ranks_of_quantile(0.5, number), [Some(low), Some(high)], "{number}");
        }
        for (p, number) in [(0.05, 100), (0.05, 1000), (0.95, 100), (0.3, 57)] {
            let [low, high] = ranks_of_quantile(p, number).map(|rank| rank.expect("enough values"));
            let at_least = |rank: u64| chance(rank, number, p);
            assert!(at_least(low) >= 0.975 && at_least(low + 1) < 0.975, "{p} {number} {low}");
            assert!(at_least(high) <= 0.025 && at_least(high - 1) > 0.025, "{p} {number} {high}");
        }
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
