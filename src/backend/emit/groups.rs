//! Similar pairs of states become loops over tables: in blocks of eight lanes, then one or two loops for the remaining
//! ones. In: the cells of a discrete system. Out: the groups, and the single cells. See docs/method/emit.md.

use crate::analysis::discrete::{Cell, Decay, Form, Operand};

/// Number of lanes of a block: as many as the widest vectors have doubles.
pub const LANES: usize = 8;
/// The widths of the loops for the pairs that remain after whole blocks; any others are single. There are no loops of
/// five or seven lanes: without wide vectors, compilers do not vectorise loops of such odd lengths (measured in
/// benches/README.md).
fn lanes_of_rest(rest: usize) -> &'static [usize] {
    match rest {
        2 => &[2],
        3 => &[3],
        4 | 5 => &[4],
        6 => &[6],
        7 => &[4, 3],
        _ => &[],
    }
}

/// Groups of similar cells, which become loops, and the single cells.
pub fn groups(cells: &[Cell], signals: usize) -> (Vec<Vec<usize>>, Vec<usize>) {
    let mut kinds: Vec<(Kind, Vec<usize>)> = Vec::new();
    let mut single = Vec::new();
    for (i, cell) in cells.iter().enumerate().skip(signals) {
        let Some(kind) = Kind::of(cell) else {
            single.push(i);
            continue;
        };
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, members)) => members.push(i),
            None => kinds.push((kind, vec![i])),
        }
    }
    let mut loops = Vec::new();
    for (_, members) in kinds {
        let whole = members.len() / LANES * LANES;
        let lengths = [whole].into_iter().chain(lanes_of_rest(members.len() - whole).iter().copied());
        let mut rest = members.as_slice();
        for length in lengths.filter(|&length| length > 0) {
            let (group, others) = rest.split_at(length);
            loops.push(group.to_vec());
            rest = others;
        }
        single.extend(rest);
    }
    single.sort_unstable();
    (loops, single)
}

/// The features of a pair's step: pairs of one kind share a loop.
#[derive(Clone, Debug, PartialEq)]
struct Kind {
    turned: bool,
    loses: bool,
    keeps: bool,
    has_k: bool,
    unit_p: bool,
    /// Operands of x and of v, and whether the factor is one.
    input: [Vec<(Operand, bool)>; 2],
    output: [Vec<usize>; 2],
}

impl Kind {
    fn of(cell: &Cell) -> Option<Kind> {
        let Form::Pair(lift) = &cell.form else { return None };
        Some(Kind {
            turned: lift.turned,
            loses: matches!(lift.decay, Decay::Lose(c) if c != 0.0),
            keeps: matches!(lift.decay, Decay::Keep(_)),
            has_k: lift.k != 0.0,
            unit_p: lift.p == 1.0,
            input: [0, 1].map(|i| cell.input[i].iter().map(|&(operand, g)| (operand, g == 1.0)).collect()),
            output: [0, 1].map(|i| cell.output[i].iter().map(|&(output, _)| output).collect()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::discrete::Lift;

    fn pair(k: f64, output: usize) -> Cell {
        let lift = Lift { turned: false, decay: Decay::Lose(0.1), k, p: 0.5 };
        let output = vec![vec![(output, 2.0)], Vec::new()];
        let (input, to, back) = (vec![Vec::new(), vec![(Operand::Input(0), 1.0)]], vec![], vec![]);
        Cell { name: String::new(), form: Form::Pair(lift), input, output, to, back, start: vec![0.0; 2] }
    }

    /// Whole blocks come first, then the rest in the measured widths; pairs with another output or without a restoring
    /// term are in other groups, and the order of cells is kept.
    #[test]
    fn cells_that_are_alike_are_grouped() {
        let widths = |count: usize| -> (Vec<usize>, usize) {
            let cells: Vec<Cell> = (0..count).map(|_| pair(0.3, 0)).collect();
            let (loops, single) = groups(&cells, 0);
            (loops.iter().map(Vec::len).collect(), single.len())
        };
        let expected = [
            (1, vec![], 1),
            (2, vec![2], 0),
            (5, vec![4], 1),
            (6, vec![6], 0),
            (7, vec![4, 3], 0),
            (8, vec![8], 0),
            (9, vec![8], 1),
            (20, vec![16, 4], 0),
            (23, vec![16, 4, 3], 0),
        ];
        for (count, loops, single) in expected {
            assert_eq!(widths(count), (loops, single), "{count}");
        }
        let cells = [pair(0.3, 0), pair(0.3, 1), pair(0.0, 0), pair(0.2, 0), pair(0.1, 1)];
        assert_eq!(groups(&cells, 0), (vec![vec![0, 3], vec![1, 4]], vec![2]));
        // A factor of one is free only if it is one for all pairs.
        let mut other = pair(0.3, 0);
        other.input[1][0].1 = 0.5;
        assert_eq!(groups(&[pair(0.3, 0), other], 0), (vec![], vec![0, 1]));
    }
}
