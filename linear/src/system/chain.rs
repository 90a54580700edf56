//! Chained rows of scenes that hang deep. The motion of a link is that of the link above it plus its own contribution, so
//! its row is written in terms of that link's row: M of N links takes N short rows, not N^2 numbers. In: a system with
//! chained rows. Out: the same system with rows over coordinates alone, if there is room for them. See
//! docs/method/system.md#deep-trees.

use super::{CoordinateId, Form, LinearSystem};
use crate::base::{Number, OrderBy};
use std::collections::BTreeMap;

/// A row over coordinates (ids below n) and the chained motions before it (ids from n on).
pub type ChainedRow = Vec<(CoordinateId, Number)>;

/// Error: rows over coordinates alone would have more entries than allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong {
    pub entries: u64,
    /// A coordinate of the longest row.
    pub deepest: CoordinateId,
}

impl LinearSystem {
    /// Whether rows of M, C or K refer to chained motions, whose ids start at n.
    pub fn is_chained(&self) -> bool {
        !self.chain.is_empty()
    }

    /// Rewrites the system with rows over coordinates alone; an error if they have more than `most` entries.
    pub fn into_flat(mut self, most: u64) -> Result<LinearSystem, TooLong> {
        self.flatten(most)?;
        Ok(self)
    }

    /// Like [`LinearSystem::into_flat`], in place; the system is unchanged after an error.
    pub fn flatten(&mut self, most: u64) -> Result<(), TooLong> {
        if !self.is_chained() {
            return Ok(());
        }
        self.room_for(most)?;
        let chain = std::mem::take(&mut self.chain);
        let n = self.n();
        for form in [&mut self.m, &mut self.c, &mut self.k] {
            *form = flatten_form(form, &chain, n);
        }
        Ok(())
    }

    /// Number of products of two entries of the same row, over all rows written out: the cost of assembling the matrices.
    pub fn products(&self) -> u64 {
        let (n, lengths) = (self.n(), self.lengths());
        let terms = [&self.m, &self.c, &self.k].into_iter().flat_map(|form| form.terms().map(|t| form.row(t)));
        terms.fold(0, |sum: u64, row| sum.saturating_add(length(row.coordinates(), &lengths, n).saturating_pow(2)))
    }

    /// Upper bounds on the number of entries in the row of each chained motion, written out.
    fn lengths(&self) -> Vec<u64> {
        let mut lengths: Vec<u64> = Vec::with_capacity(self.chain.len());
        for row in &self.chain {
            lengths.push(length(row.iter().map(|(i, _)| i), &lengths, self.n()));
        }
        lengths
    }

    /// Counts the entries that rows over coordinates alone would have, before any row is made.
    fn room_for(&self, most: u64) -> Result<(), TooLong> {
        let n = self.n();
        let lengths = self.lengths();
        let terms = [&self.m, &self.c, &self.k].into_iter().flat_map(|form| form.terms().map(|t| form.row(t)));
        let (mut entries, mut longest, mut deepest) = (0u64, 0, CoordinateId(0));
        for row in terms {
            let own = length(row.coordinates(), &lengths, n);
            entries = entries.saturating_add(own);
            if own > longest {
                longest = own;
                deepest = row.iter().map(|(i, _)| *i).filter(|i| i.index() < n).max().unwrap_or(deepest);
            }
        }
        if entries <= most { Ok(()) } else { Err(TooLong { entries, deepest }) }
    }
}

/// Upper bound on the number of entries of a row with its chained motions written out.
fn length<'a>(row: impl IntoIterator<Item = &'a CoordinateId>, lengths: &[u64], n: usize) -> u64 {
    let lengths = row.into_iter().map(|i| i.index().checked_sub(n).map_or(1, |chained| lengths[chained]));
    lengths.fold(0, u64::saturating_add)
}

fn flatten_form(form: &Form, chain: &[ChainedRow], n: usize) -> Form {
    let mut result = Form::with_sources_of(form);
    for term in form.terms() {
        let row = write_out_row(&form.row(term).to_vec(), chain, n);
        result.push(term.source, term.nature, term.weight.clone(), row);
    }
    result
}

/// The row over coordinates alone, ascending: chained motions are replaced one by one, the last one first.
pub fn write_out_row(row: &[(CoordinateId, Number)], chain: &[ChainedRow], n: usize) -> ChainedRow {
    let mut waiting: BTreeMap<usize, Number> = BTreeMap::new();
    let mut own: ChainedRow = Vec::new();
    let mut sort = |row: &[(CoordinateId, Number)], factor: &Number, waiting: &mut BTreeMap<usize, Number>| {
        for (i, value) in row {
            let value = value * factor;
            match i.index().checked_sub(n) {
                None => own.push((*i, value)),
                Some(chained) => {
                    let sum = waiting.entry(chained).or_insert(Number::ZERO);
                    *sum = &*sum + &value;
                }
            }
        }
    };
    sort(row, &Number::ONE, &mut waiting);
    while let Some((chained, factor)) = waiting.pop_last() {
        sort(&chain[chained], &factor, &mut waiting);
    }
    own.order_by_key(|(i, _)| *i);
    own.dedup_by(|(i, value), (last, sum)| {
        let same = i == last;
        if same {
            *sum = &*sum + &*value;
        }
        same
    });
    own
}
