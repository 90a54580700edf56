//! Combines the signals of one input: a sum of polynomials between jumps is again such a signal. So a force of a
//! thousand steps has one state instead of a thousand that become active one after another. In: sources. Out: fewer
//! sources with the same sum. See docs/method/response.md#signals.

use super::signal::{Piece, Source, taylor};
use crate::base::{Number, OrderBy};

impl Source {
    /// Whether the source consists of exact polynomials that may jump wherever they change. Splines do not jump, and
    /// chirps are not exact: they stay separate.
    pub fn is_sum_of_jumps(&self) -> bool {
        matches!(self, Source::Pieces { pieces, error, .. } if *error == 0.0 && pieces.iter().all(|piece| piece.jump))
    }
}

/// The sum of sources that all satisfy [`Source::is_sum_of_jumps`].
pub fn sum(sources: &[Source]) -> Source {
    let lists: Vec<&[Piece]> = sources.iter().map(pieces).collect();
    let order = sources.iter().map(Source::order).max().unwrap_or(0);
    let mut changes: Vec<(&[Piece], usize)> = Vec::new();
    for list in lists {
        changes.extend((0..list.len()).map(|i| (list, i)));
    }
    let at = |change: &(&[Piece], usize)| change.0[change.1].at.clone();
    changes.order_by(|a, b| a.0[a.1].at.to_f64().total_cmp(&b.0[b.1].at.to_f64()));
    // The constant part, and the active pieces that will change.
    let (mut rest, mut on): (Number, Vec<&Piece>) = (Number::ZERO, Vec::new());
    let mut sums: Vec<Piece> = Vec::new();
    for together in changes.chunk_by(|a, b| at(a) == at(b)) {
        for &(list, i) in together {
            if let Some(before) = i.checked_sub(1) {
                on.retain(|piece| !std::ptr::eq(*piece, &list[before]));
            }
            match list[i].derivatives.as_slice() {
                [] => {}
                [constant] if i + 1 == list.len() => rest = &rest + constant,
                _ => on.push(&list[i]),
            }
        }
        let at = at(&together[0]);
        let highest = on.iter().map(|piece| piece.derivatives.len()).max().unwrap_or(0).max(1);
        let mut derivatives = vec![Number::ZERO; highest];
        derivatives[0] = rest.clone();
        for piece in &on {
            let time = &at - &piece.at;
            for (k, sum) in derivatives.iter_mut().enumerate().take(piece.derivatives.len()) {
                *sum = &*sum + &taylor(&piece.derivatives[k..], &time);
            }
        }
        sums.push(Piece::jump(at, derivatives));
    }
    Source::Pieces { order, pieces: sums, error: 0.0, rise: 1.0 }
}

fn pieces(source: &Source) -> &[Piece] {
    match source {
        Source::Pieces { pieces, .. } => pieces,
        Source::Harmonic { .. } | Source::Impulse { .. } => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Course, Signal, Table};

    /// At and between all knots, the value and slope of the sum are the sums of the values and slopes, and signals that
    /// add up to zero have no state.
    #[test]
    fn a_sum_has_the_values_of_its_parts() {
        let n = |text: &str| Number::from(text);
        let numbers = |list: &[&str]| list.iter().map(|&text| n(text)).collect::<Vec<_>>();
        let signals = [
            Signal::Step { value: n("3"), at: n("0.5") },
            Signal::Ramp { value: -&n("10"), from: n("0.25"), to: n("1.75") },
            Signal::Pulse { value: -&n("7"), from: n("0.5"), to: n("1") },
            Signal::Table(Table {
                times: numbers(&["0.1", "1", "1.2"]),
                values: numbers(&["0", "2", "7"]),
                course: Course::Lines,
                period: None,
            }),
            Signal::Step { value: n("0.1"), at: n("2.5") },
            Signal::Step { value: -&n("0.1"), at: n("3") },
        ];
        let parts: Vec<Source> =
            signals.iter().map(|signal| Source::of(signal, None, None).expect("few pieces")).collect();
        assert!(parts.iter().all(Source::is_sum_of_jumps));
        let whole = sum(&parts);
        let value = |source: &Source, t: &Number| {
            let piece = pieces(source).iter().rev().find(|piece| !(t - &piece.at).is_negative());
            piece.map_or([Number::ZERO, Number::ZERO], |piece| piece.values_after(t))
        };
        for i in 0..80 {
            let t = &Number::from(i) / &n("20");
            let found = value(&whole, &t);
            let wanted = parts
                .iter()
                .map(|part| value(part, &t))
                .fold([Number::ZERO, Number::ZERO], |sum, part| [&sum[0] + &part[0], &sum[1] + &part[1]]);
            assert!(found.iter().zip(&wanted).all(|(a, b)| (a - b).is_zero()), "{}: {found:?} {wanted:?}", t.to_f64());
        }
        let knots: Vec<f64> = pieces(&whole).iter().map(|piece| piece.at.to_f64()).collect();
        assert_eq!(knots, [0.0, 0.1, 0.25, 0.5, 1.0, 1.2, 1.75, 2.5, 3.0]);
        assert_eq!(whole.order(), 2);
        // 3 - 10 + 7 and 0.1 - 0.1
        assert!(pieces(&whole)[8].derivatives.is_empty());
    }
}
