//! The independent parts of a system, and how the coordinates of each are coupled: as a chain, a tree, a band, or
//! another net. In: a linear system. Out: the parts, in the order of their first coordinates. Cost: linear in its
//! terms. See docs/method/system.md#parts.

use crate::analysis::answer::Mode;
use crate::analysis::modes::parts::{independent, independent_chained};
use crate::system::{CoordinateId, LinearSystem};

/// Coordinates that are coupled with each other and with nothing else.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Net {
    /// Ascending.
    pub coordinates: Vec<CoordinateId>,
    pub form: NetForm,
}

/// The way in which the terms of M, C and K couple coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetForm {
    /// One coordinate without spring, damper or load: it keeps the velocity with which it started.
    Free,
    /// One coordinate.
    Single,
    /// Each coordinate is coupled only to the next.
    Chain,
    /// A tree: there is no cycle.
    Tree,
    /// In a suitable order, each coordinate is coupled with at most the next `width`.
    Band {
        width: usize,
    },
    General,
    /// Bodies that hang so deep that M is kept as chained rows (docs/method/system.md#deep-trees).
    Linkage,
}

impl NetForm {
    pub fn name(self) -> &'static str {
        match self {
            NetForm::Free => "free",
            NetForm::Single => "single",
            NetForm::Chain => "chain",
            NetForm::Tree => "tree",
            NetForm::Band { .. } => "band",
            NetForm::General => "general",
            NetForm::Linkage => "linkage",
        }
    }
}

/// Terms on more coordinates couple each of them with each other; the part then has no useful band.
const LONGEST_ROW: usize = 16;
/// A band is used if this many times its width is at most the number of coordinates.
const BAND_PAYS: usize = 4;

/// The parts of a system.
pub fn nets(system: &LinearSystem) -> Vec<Net> {
    if system.is_chained() {
        return chained_parts(system);
    }
    let mut local = vec![0u32; system.n()];
    let parts = independent(system).into_iter().map(|part| {
        part.coordinates.iter().enumerate().for_each(|(place, &i)| local[i as usize] = place as u32);
        let terms = [(&system.m, &part.m), (&system.c, &part.c), (&system.k, &part.k)];
        let rows = terms.into_iter().flat_map(|(form, list)| list.iter().map(|&t| form.row(form.term(t as usize))));
        let mut edges = Vec::new();
        let mut longest = 0;
        for row in rows {
            longest = longest.max(row.len());
            let row = row.coordinates();
            for (a, i) in row.iter().enumerate().take(LONGEST_ROW) {
                edges.extend(row[..a].iter().map(|j| (local[i.index()], local[j.index()])));
            }
        }
        let n = part.coordinates.len();
        let form = match n {
            1 if part.k.is_empty() && part.c.is_empty() && !is_driven(system, part.coordinates[0]) => NetForm::Free,
            1 => NetForm::Single,
            _ if longest > LONGEST_ROW => NetForm::General,
            _ => Graph::new(n, edges).form(),
        };
        Net { coordinates: part.coordinates.into_iter().map(CoordinateId).collect(), form }
    });
    parts.collect()
}

/// The parts of a system with chained rows: those with several coordinates are linkages.
fn chained_parts(system: &LinearSystem) -> Vec<Net> {
    let parts = independent_chained(system).into_iter().map(|part| Net {
        form: if part.coordinates.len() == 1 { NetForm::Single } else { NetForm::Linkage },
        coordinates: part.coordinates.into_iter().map(CoordinateId).collect(),
    });
    parts.collect()
}

fn is_driven(system: &LinearSystem, coordinate: u32) -> bool {
    system.inputs.iter().flat_map(|input| input.b.iter().flatten()).any(|(i, _)| i.0 == coordinate)
}

/// For each mode, the index of the part that moves in it.
pub fn parts_of_modes(nets: &[Net], modes: &[Mode]) -> Vec<usize> {
    let n = nets.iter().map(|net| net.coordinates.len()).sum();
    let mut part_of = vec![0; n];
    for (part, net) in nets.iter().enumerate() {
        net.coordinates.iter().for_each(|i| part_of[i.index()] = part);
    }
    let largest = |mode: &Mode| {
        let sizes = mode.shape.iter().map(|x| x.abs()).enumerate();
        sizes.fold((0, 0.0), |best, (i, size)| if size > best.1 { (i, size) } else { best }).0
    };
    modes.iter().map(|mode| part_of[largest(mode)]).collect()
}

/// The pairs of coupled coordinates, without repetition.
struct Graph {
    starts: Vec<usize>,
    ends: Vec<u32>,
}

impl Graph {
    fn new(n: usize, edges: Vec<(u32, u32)>) -> Graph {
        let mut both: Vec<(u32, u32)> = edges.into_iter().flat_map(|(i, j)| [(i, j), (j, i)]).collect();
        both.sort_unstable();
        both.dedup();
        let mut starts = vec![0; n + 1];
        both.iter().for_each(|(i, _)| starts[*i as usize + 1] += 1);
        (0..n).for_each(|i| starts[i + 1] += starts[i]);
        Graph { starts, ends: both.into_iter().map(|(_, j)| j).collect() }
    }

    fn n(&self) -> usize {
        self.starts.len() - 1
    }

    fn of(&self, i: usize) -> &[u32] {
        &self.ends[self.starts[i]..self.starts[i + 1]]
    }

    /// The form of a part, whose graph is connected.
    fn form(&self) -> NetForm {
        let n = self.n();
        if self.ends.len() == 2 * (n - 1) {
            let chain = (0..n).all(|i| self.of(i).len() <= 2);
            return if chain { NetForm::Chain } else { NetForm::Tree };
        }
        let width = self.band();
        if BAND_PAYS * (width + 1) <= n { NetForm::Band { width } } else { NetForm::General }
    }

    /// Half the bandwidth: in the order of the model, or in that of Cuthill and McKee (Proc. 24th ACM Nat. Conf. (1969)
    /// 157) from an end of the graph.
    fn band(&self) -> usize {
        let far = *self.levels(0).last().unwrap_or(&0);
        let order = self.levels(far);
        let mut place = vec![0usize; self.n()];
        order.iter().enumerate().for_each(|(at, i)| place[*i as usize] = at);
        let as_given: Vec<usize> = (0..self.n()).collect();
        self.width(&place).min(self.width(&as_given))
    }

    fn width(&self, place: &[usize]) -> usize {
        let width = |i: usize| self.of(i).iter().map(|j| place[i].abs_diff(place[*j as usize])).max().unwrap_or(0);
        (0..self.n()).map(width).max().unwrap_or(0)
    }

    /// Breadth-first order, with the coordinates of fewest neighbours first.
    fn levels(&self, first: u32) -> Vec<u32> {
        let mut seen = vec![false; self.n()];
        seen[first as usize] = true;
        let mut order = vec![first];
        let mut next = 0;
        while next < order.len() {
            let start = order.len();
            for &j in self.of(order[next] as usize) {
                if !std::mem::replace(&mut seen[j as usize], true) {
                    order.push(j);
                }
            }
            order[start..].sort_by_key(|j| (self.of(*j as usize).len(), *j));
            next += 1;
        }
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(n: usize, edges: &[(u32, u32)]) -> NetForm {
        Graph::new(n, edges.to_vec()).form()
    }

    #[test]
    fn chains_trees_bands_and_others_are_classified() {
        assert_eq!(form(4, &[(2, 0), (0, 3), (3, 1), (2, 0)]), NetForm::Chain);
        assert_eq!(form(4, &[(0, 1), (0, 2), (0, 3)]), NetForm::Tree);
        let ladder: Vec<(u32, u32)> = (0..40).flat_map(|i| [(i, i + 1), (i, i + 2)]).collect();
        assert_eq!(form(42, &ladder), NetForm::Band { width: 2 });
        assert_eq!(form(3, &[(0, 1), (1, 2), (2, 0)]), NetForm::General);
    }
}
