//! Elimination of a network K - s M, node by node, in binary64: for solutions, and for certified counts.
//!
//! Eliminating node p with d_p = v_p + sum_j c_pj is c_ij += c_pi c_pj / d_p, v_i += c_pi v_p / d_p: nothing is
//! subtracted if couplings and grounds are positive, whatever their sizes. The negative grounds (the shift's s m_i) are
//! carried separately from the positive ones and are combined with them only in d_p.
//!
//! A certified count: forms are partially ordered, and lowering a coupling or a ground of the remaining form lowers the
//! original form by as much, because adding a form on the remaining nodes commutes with eliminating the others. So if
//! every rounding goes down, the factors are exactly those of a form A' <= A, and A has at most as many negative
//! eigenvalues as there are negative pivots (Courant and Fischer; Sylvester): at most that many omega^2 are below s.
//! Rounding up gives at least that many. The pivot is rounded down like the rest because some factors 1 - t of the
//! positive and 1 + t of the negative numbers of its star, with t of a few roundings, give exactly the pivot used. No
//! bound of growth is needed: if roundings matter, the count comes out too high (too low), and proves nothing.
//!
//! The elimination order is approximate minimum degree. See docs/method/modes.md#sparse-parts.

use crate::analysis::modes::mesh::network::{Near, Network, U, UP};
use crate::analysis::modes::mesh::postponed::{Postponed, pivot};
use crate::kernel::sparse::order::least_fill;
use std::ops::Range;

/// The order of elimination and the pattern of its fill.
#[derive(Clone, Debug)]
pub struct Pattern {
    /// Position of each node in the order.
    place: Vec<u32>,
    starts: Vec<usize>,
    rows: Vec<u32>,
    /// Entries of K, then of M, then of others, by column: (row, index of the pair); ascending columns.
    given: Vec<Given>,
}

/// The pairs of a network, grouped by their earlier node.
#[derive(Clone, Debug)]
struct Given {
    starts: Vec<usize>,
    entries: Vec<(u32, u32)>,
}

/// The direction of rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rounding {
    Nearest,
    Down,
    #[cfg_attr(not(test), expect(dead_code, reason = "bands away from zero will count from this side"))]
    Up,
}

/// L and D: -L_ip = c_pi / d_p.
#[derive(Clone, Debug)]
pub struct Factors<'a> {
    pattern: &'a Pattern,
    /// c_pi by columns.
    couplings: Vec<f64>,
    pivots: Vec<f64>,
}

/// A pivot below this part of the positive numbers of its star is postponed.
const CANCELS: f64 = 0.5;
/// More entries than this do not fit into memory.
const MOST_ENTRIES: usize = 60_000_000;
const NONE: u32 = u32::MAX;

impl Pattern {
    /// The pattern for K, M and any other added networks; `None` if elimination fills in too much.
    pub fn of(networks: &[&Network]) -> Option<Pattern> {
        let n = networks.first()?.n();
        let place = least_fill(n, networks.iter().flat_map(|network| network.pairs.iter().copied()))?;
        let given: Vec<Given> = networks.iter().map(|network| Given::of(network, &place)).collect();
        let mut starts = vec![0];
        let mut rows: Vec<u32> = Vec::new();
        let mut mark = vec![NONE; n];
        // Linked lists of the columns whose first row is a given one.
        let (mut first_child, mut next_child) = (vec![NONE; n], vec![NONE; n]);
        for column in 0..n {
            let start = rows.len();
            mark[column] = column as u32;
            for given in &given {
                for &(row, _) in given.column(column) {
                    if std::mem::replace(&mut mark[row as usize], column as u32) != column as u32 {
                        rows.push(row);
                    }
                }
            }
            let mut child = first_child[column];
            while child != NONE {
                for at in starts[child as usize]..starts[child as usize + 1] {
                    let row = rows[at];
                    if std::mem::replace(&mut mark[row as usize], column as u32) != column as u32 {
                        rows.push(row);
                    }
                }
                child = next_child[child as usize];
            }
            rows[start..].sort_unstable();
            if let Some(&parent) = rows.get(start) {
                next_child[column] = std::mem::replace(&mut first_child[parent as usize], column as u32);
            }
            if rows.len() > MOST_ENTRIES {
                return None;
            }
            starts.push(rows.len());
        }
        Some(Pattern { place, starts, rows, given })
    }

    /// The position of each node in the order of elimination.
    pub fn place(&self) -> &[u32] {
        &self.place
    }

    /// The number of entries below the pivots, over all columns.
    pub fn entries(&self) -> usize {
        self.rows.len()
    }

    /// The range of a column's entries.
    #[inline]
    pub fn range(&self, column: usize) -> Range<usize> {
        self.starts[column]..self.starts[column + 1]
    }

    /// The rows of the entries in this range.
    #[inline]
    pub fn rows(&self, range: Range<usize>) -> &[u32] {
        &self.rows[range]
    }

    /// The entries of one of the networks in a column: (row, index of the pair).
    #[inline]
    pub fn given_entries(&self, which: usize, column: usize) -> &[(u32, u32)] {
        self.given[which].column(column)
    }

    /// The factors of K - s M; `None` if it is not positive definite to working precision.
    pub fn factor(&self, k: &Network, m: &Network, s: f64) -> Option<Factors<'_>> {
        let (pivots, couplings, postponed) = Elimination::new(self, Rounding::Nearest, 0.0).run(k, m, s)?;
        let positive = postponed.is_empty() && pivots.iter().all(|&pivot| pivot > 0.0);
        positive.then_some(Factors { pattern: self, couplings, pivots })
    }

    /// The number of negative eigenvalues of K - s M: an upper bound (rounding down), a lower bound (up) or an
    /// estimate.
    pub fn count(&self, k: &Network, m: &Network, s: f64, rounding: Rounding) -> Option<usize> {
        let (pivots, _, postponed) = Elimination::new(self, rounding, CANCELS).run(k, m, s)?;
        let negative = pivots.iter().filter(|&&pivot| pivot < 0.0).count();
        Some(negative + postponed.negative()?)
    }
}

impl Given {
    fn of(network: &Network, place: &[u32]) -> Given {
        let mut entries: Vec<(u32, u32, u32)> = (network.pairs.iter().zip(0..))
            .map(|(&(i, j), index)| {
                let (a, b) = (place[i as usize], place[j as usize]);
                (a.min(b), a.max(b), index)
            })
            .collect();
        entries.sort_unstable();
        let mut starts = vec![0; place.len() + 1];
        entries.iter().for_each(|entry| starts[entry.0 as usize + 1] += 1);
        for column in 0..place.len() {
            starts[column + 1] += starts[column];
        }
        Given { starts, entries: entries.into_iter().map(|(_, row, index)| (row, index)).collect() }
    }

    fn column(&self, column: usize) -> &[(u32, u32)] {
        &self.entries[self.starts[column]..self.starts[column + 1]]
    }
}

/// The state of an elimination.
struct Elimination<'a> {
    pattern: &'a Pattern,
    /// -1, 0 or 1: the direction of rounding.
    side: f64,
    couplings: Vec<f64>,
    pivots: Vec<f64>,
    /// Positive and negative grounds, by position.
    grounds: [Vec<f64>; 2],
    /// Whether some coupling or the pivot of the column is negative.
    signed: Vec<bool>,
    /// Couplings of the current column by row: the sum, and twice its negative part.
    sum: Vec<f64>,
    twice_negative: Vec<f64>,
    /// For each column the entry that is needed next, and lists of the columns needed at a row.
    due: Vec<usize>,
    first: Vec<u32>,
    next: Vec<u32>,
    /// Largest relative error so far of the numbers that a column passes on.
    carried: f64,
    /// Pivots below this part of their star are postponed.
    cancels: f64,
    postponed: Postponed,
}

impl<'a> Elimination<'a> {
    fn new(pattern: &'a Pattern, rounding: Rounding, cancels: f64) -> Elimination<'a> {
        let n = pattern.place.len();
        let side = match rounding {
            Rounding::Nearest => 0.0,
            Rounding::Down => -1.0,
            Rounding::Up => 1.0,
        };
        Elimination {
            pattern,
            side,
            couplings: vec![0.0; pattern.rows.len()],
            pivots: vec![0.0; n],
            grounds: [vec![0.0; n], vec![0.0; n]],
            signed: vec![false; n],
            sum: vec![0.0; n],
            twice_negative: vec![0.0; n],
            due: pattern.starts[..n].to_vec(),
            first: vec![NONE; n],
            next: vec![NONE; n],
            carried: 0.0,
            cancels,
            postponed: Postponed::new(side),
        }
    }

    /// Pivots, couplings by columns, and the postponed nodes, whose pivots are set to one.
    fn run(mut self, k: &Network, m: &Network, s: f64) -> Option<(Vec<f64>, Vec<f64>, Postponed)> {
        self.set_grounds(k, m, s);
        for column in 0..self.pivots.len() {
            self.set_couplings(column, k, m, s);
            let count = self.gather(column);
            if self.finish(column, count)? {
                self.link(column as u32);
            }
        }
        Some((self.pivots, self.couplings, self.postponed))
    }

    /// v = positive - negative - s (row sum of M), each side rounded in its safe direction.
    fn set_grounds(&mut self, k: &Network, m: &Network, s: f64) {
        let size = s.abs();
        // A negative shift swaps the signs of M's grounds.
        let (adds, takes) = if s < 0.0 { (&m.positive, &m.negative) } else { (&m.negative, &m.positive) };
        for (node, &place) in self.pattern.place.iter().enumerate() {
            let both = |k: Near, m: Near| {
                let value = k.value + size * m.value;
                (value, (k.error + size * m.error + 3.0 * U * value.abs()) * UP)
            };
            let (mut positive, error) = both(k.positive[node], adds[node]);
            let (mut negative, negative_error) = both(k.negative[node], takes[node]);
            positive += self.side * error;
            negative -= self.side * negative_error;
            // A number that rounding moves past zero changes its sign class.
            if positive < 0.0 {
                (positive, negative) = (0.0, (negative - positive) * UP);
            }
            if negative < 0.0 {
                (positive, negative) = ((positive - negative) * UP, 0.0);
            }
            self.grounds[0][place as usize] = positive;
            self.grounds[1][place as usize] = negative;
        }
    }

    /// The entries of K - s M in the column.
    fn set_couplings(&mut self, column: usize, k: &Network, m: &Network, s: f64) {
        let pattern = self.pattern;
        for at in pattern.starts[column]..pattern.starts[column + 1] {
            self.sum[pattern.rows[at] as usize] = 0.0;
            self.twice_negative[pattern.rows[at] as usize] = 0.0;
        }
        for (given, network, factor) in [(&pattern.given[0], k, 1.0), (&pattern.given[1], m, -s)] {
            for &(row, index) in given.column(column) {
                let Near { value, error } = network.couplings[index as usize];
                let part = value * factor;
                self.take(row as usize, part, (error * factor.abs() + U * part.abs()) * UP);
            }
        }
    }

    fn take(&mut self, row: usize, part: f64, error: f64) {
        let part = part + self.side * error;
        self.sum[row] += part;
        if part < 0.0 {
            self.twice_negative[row] -= 2.0 * part;
        }
    }

    /// Adds the contributions of the columns needed at this row; returns their number.
    fn gather(&mut self, column: usize) -> usize {
        let pattern = self.pattern;
        let mut count = 0;
        let mut from = std::mem::replace(&mut self.first[column], NONE);
        while from != NONE {
            let j = from as usize;
            from = self.next[j];
            count += 1;
            let at = self.due[j];
            let end = pattern.starts[j + 1];
            let ratio = self.couplings[at] / self.pivots[j];
            let (rows, couplings) = (&pattern.rows[at + 1..end], &self.couplings[at + 1..end]);
            if self.signed[j] {
                for (&row, &c) in rows.iter().zip(couplings) {
                    let part = ratio * c;
                    self.sum[row as usize] += part;
                    if part < 0.0 {
                        self.twice_negative[row as usize] -= 2.0 * part;
                    }
                }
            } else {
                for (&row, &c) in rows.iter().zip(couplings) {
                    self.sum[row as usize] += ratio * c;
                }
            }
            let (same, other) = if ratio < 0.0 { (1, 0) } else { (0, 1) };
            self.grounds[same][column] += ratio.abs() * self.grounds[0][j];
            self.grounds[other][column] += ratio.abs() * self.grounds[1][j];
            self.due[j] += 1;
            self.link(j as u32);
        }
        count
    }

    /// Adds the column to the list of the row that needs it next.
    fn link(&mut self, column: u32) {
        let j = column as usize;
        if self.due[j] < self.pattern.starts[j + 1] {
            let row = self.pattern.rows[self.due[j]] as usize;
            self.next[j] = std::mem::replace(&mut self.first[row], column);
        }
    }

    /// Computes the column's couplings and its pivot, all rounded in one direction; `false` if the column is postponed.
    fn finish(&mut self, column: usize, count: usize) -> Option<bool> {
        let pattern = self.pattern;
        let (start, end) = (pattern.starts[column], pattern.starts[column + 1]);
        // Each number is a sum of `count` contributions, each with the error that its column passes on and three
        // roundings.
        let error = ((count + 4) as f64 * U + self.carried + 4.0 * U) * UP;
        let (mut adds, mut takes, mut signed) = (0.0, 0.0, false);
        for at in start..end {
            let row = pattern.rows[at] as usize;
            let c = self.sum[row] + self.side * error * (self.sum[row].abs() + self.twice_negative[row]) * UP;
            self.couplings[at] = c;
            if c < 0.0 {
                takes -= c;
                signed = true;
            } else {
                adds += c;
            }
        }
        let mut grounds = [self.grounds[0][column], self.grounds[1][column]];
        grounds[0] *= 1.0 + self.side * error;
        grounds[1] *= 1.0 - self.side * error;
        (self.grounds[0][column], self.grounds[1][column]) = (grounds[0], grounds[1]);
        let (more, less, others) = self.postponed.couplings(column);
        let own = ((end - start + others + 8) as f64 * U) * UP;
        let (adds, takes) = (adds + grounds[0] + more, takes + grounds[1] + less);
        let pivot = pivot(adds, takes, self.side, own);
        let (rows, couplings) = (&pattern.rows[start..end], &self.couplings[start..end]);
        if pivot < self.cancels * adds {
            self.postponed.add(column, self.pivots.len(), rows, couplings, grounds)?;
            self.pivots[column] = 1.0;
            return Some(false);
        }
        if !pivot.is_finite() || pivot == 0.0 && end > start {
            return None;
        }
        self.signed[column] = signed || pivot < 0.0;
        self.pivots[column] = pivot;
        // Two couplings scaled by up to 1 + 3 own each, divided by the pivot.
        let handed_on = if self.side == 0.0 { 0.0 } else { 8.0 * own };
        self.carried = self.carried.max(handed_on);
        if others > 0 {
            self.postponed.eliminate(column, pivot, rows, couplings, grounds, handed_on);
        }
        Some(true)
    }
}

impl Factors<'_> {
    /// x = (K - s M)^-1 b for several b at once, in place; `room` is scratch space as long as a column.
    pub fn solve(&self, columns: &mut [Vec<f64>], room: &mut Vec<f64>) {
        let (n, width) = (self.pivots.len(), columns.len());
        room.clear();
        room.resize(n * width, 0.0);
        for (node, &place) in self.pattern.place.iter().enumerate() {
            for (lane, column) in columns.iter().enumerate() {
                room[place as usize * width + lane] = column[node];
            }
        }
        match width {
            1 => self.substitute::<1>(room),
            2 => self.substitute::<2>(room),
            3 => self.substitute::<3>(room),
            _ => self.substitute::<4>(room),
        }
        for (node, &place) in self.pattern.place.iter().enumerate() {
            for (lane, column) in columns.iter_mut().enumerate() {
                column[node] = room[place as usize * width + lane];
            }
        }
    }

    /// Substitution for W columns in parallel.
    fn substitute<const W: usize>(&self, room: &mut [f64]) {
        let (x, _) = room.as_chunks_mut::<W>();
        let (starts, rows) = (&self.pattern.starts, &self.pattern.rows);
        for column in 0..self.pivots.len() {
            let range = starts[column]..starts[column + 1];
            let scaled = x[column].map(|x| x / self.pivots[column]);
            for (&row, &c) in rows[range.clone()].iter().zip(&self.couplings[range]) {
                for lane in 0..W {
                    x[row as usize][lane] += c * scaled[lane];
                }
            }
            x[column] = scaled;
        }
        for column in (0..self.pivots.len()).rev() {
            let range = starts[column]..starts[column + 1];
            let mut sum = [0.0; W];
            for (&row, &c) in rows[range.clone()].iter().zip(&self.couplings[range]) {
                for lane in 0..W {
                    sum[lane] += c * x[row as usize][lane];
                }
            }
            for lane in 0..W {
                x[column][lane] += sum[lane] / self.pivots[column];
            }
        }
    }
}
