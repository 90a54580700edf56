//! Rows of systems with so many coordinates that their modes are not at hand. In: the frequencies of a table. Out: its rows, as sums
//! over modes that are computed now where nothing else has a bound that is good enough. See
//! docs/method/transfer.md#sum-over-modes.

use super::{Methods, Pairs, Row, Sweep, is_within, modes_of_many};
use crate::analysis::answer::Poles;
use crate::analysis::transfer::modal::ModalSum;
use crate::analysis::transfer::{Frequency, MOST_DENSE, TO_THE_LAST_DIGIT};

/// Rows at given frequencies. Where dampers do not resist every motion, elimination is sharp if it fills little, as in trees. If it is
/// not at an end of the list, all rows are sums over modes, otherwise those that are left.
pub fn rows(methods: &Methods, pairs: &Pairs, sweep: &Sweep, at: &[Frequency]) -> Vec<Row> {
    let tolerance = sweep.tolerance.unwrap_or(TO_THE_LAST_DIGIT);
    let is_good = |row: &Row| row.gains.iter().flatten().all(|gain| is_within(gain, tolerance));
    let needs_none = methods.sum.is_some()
        || methods.system.n() <= MOST_DENSE
        || methods.system.losses.is_some()
        || methods.transfer.is_held();
    let (Some(first), Some(last), false) = (at.first(), at.last(), needs_none) else {
        return methods.rows(pairs, sweep, at);
    };
    let by_modes = |at: &[Frequency]| {
        let sum = ModalSum::of(methods.system, &modes_of_many(methods.system)?)?;
        let methods = Methods { sum: Some(sum), ..methods.clone() };
        Some(methods.rows(&methods.pairs(&Poles::default(), sweep, false), sweep, at))
    };
    let is_sharp = methods.rows(pairs, sweep, &[first.clone(), last.clone()]).iter().all(is_good);
    if !is_sharp {
        return by_modes(at).unwrap_or_else(|| methods.rows(pairs, sweep, at));
    }
    let mut rows = methods.rows(pairs, sweep, at);
    let left: Vec<usize> = (0..rows.len()).filter(|&i| !is_good(&rows[i])).collect();
    let frequencies: Vec<Frequency> = left.iter().map(|&i| at[i].clone()).collect();
    if let Some(better) = (!left.is_empty()).then(|| by_modes(&frequencies)).flatten() {
        left.iter().zip(better).for_each(|(&i, row)| rows[i] = row);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::super::table;
    use super::*;
    use crate::analysis::answer::Modes;
    use crate::analysis::test_systems::{blank, push};
    use crate::base::Number;
    use crate::system::LinearSystem;

    /// Unit masses on springs to the next and to the second next, such that with T the chain alone K = 9 T - T^2: the modes are
    /// sines, and omega^2 = t (9 - t) with t = 4 sin^2 (theta / 2).
    fn doubled_chain(n: usize) -> LinearSystem {
        let mut system = blank(n);
        for i in 0..n {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "5", i, i.checked_sub(1));
            if i >= 2 {
                push(&mut system.k, "1", i, Some(i - 2));
            }
        }
        for (weight, i) in [("2", 0), ("1", 1), ("1", n - 2), ("7", n - 1)] {
            push(&mut system.k, weight, i, None);
        }
        system
    }

    fn truth(n: usize, omega: f64, input: usize, output: usize) -> f64 {
        let term = |mode: usize| {
            let theta = std::f64::consts::PI * mode as f64 / (n + 1) as f64;
            let t = 4.0 * (0.5 * theta).sin().powi(2);
            let shape = |i: usize| (theta * (i + 1) as f64).sin();
            2.0 / (n + 1) as f64 * shape(input) * shape(output) / (t * (9.0 - t) - omega * omega)
        };
        (1..=n).map(term).sum()
    }

    /// Among the frequencies of an undamped system that is no tree elimination has no digits. Its ends are both good in the second
    /// list, from which one row is left.
    #[test]
    fn rows_of_a_large_system_that_nothing_damps_are_bounded() {
        let n = MOST_DENSE + 2;
        let system = doubled_chain(n);
        let methods = Methods::of(&system, &Modes::default());
        let list =
            |texts: &[&str]| texts.iter().map(|text| Frequency::radians(&Number::from(*text))).collect::<Vec<_>>();
        let alone = methods.transfer.between(&list(&["3.1"])[0], &[3], &[290])[0][0];
        assert!(!is_within(&alone, TO_THE_LAST_DIGIT), "{alone:?}");
        let whole = (list(&["0.001", "0.7", "3.1", "4.4"]), 290);
        for (at, output) in [whole, (list(&["0.001", "3.1", "7"]), 5)] {
            let sweep = Sweep { at: at.clone(), inputs: vec![3], outputs: vec![output], ..Sweep::default() };
            let rows = table(&methods, &Poles::default(), &sweep).expect("a small table").rows;
            assert_eq!(rows.len(), at.len());
            for (row, frequency) in rows.iter().zip(&at) {
                let disc = row.gains[0][0].disc().expect("a value");
                let truth = truth(n, frequency.omega.to_f64(), 3, output);
                assert!(disc.relative_error() <= TO_THE_LAST_DIGIT, "{frequency:?}: {:e}", disc.relative_error());
                assert!((disc.value.re.to_f64() / truth - 1.0).abs() < 1e-9, "{frequency:?}: {disc:?} {truth:e}");
            }
        }
    }
}
