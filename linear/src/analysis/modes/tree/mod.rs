//! The lowest modes of a tree of bodies and springs, each certified by itself, in time proportional to its size.
//!
//! 1. Brackets: counts of eigenvalues below many shifts at once, in binary64 ([`brackets`]), until each wanted one is
//!    alone and narrowly enclosed. A count at s is exact for some shift s (1 +- eta).
//! 2. Vectors: the null vector of the elimination at a shift; its Rayleigh quotient is the next shift.
//! 3. Bounds of Kato and Temple in the norm of K ([`bounds`]).
//! 4. Steps 2 and 3 in double-double if more digits are requested.
//!
//! See docs/method/modes.md#large-trees.

pub mod bounds;
pub mod brackets;
pub mod forest;
pub mod impedance;
pub mod lanes;

use crate::analysis::modes::pair::Displacements;
use crate::analysis::modes::request::Band;
use crate::analysis::modes::tree::bounds::{Enclosed, Frame, Tree, enclose_lanes};
use crate::analysis::modes::tree::brackets::{Bracket, Brackets};
use crate::analysis::modes::tree::forest::{Forest, Node};
use crate::analysis::modes::tree::impedance::{root, shapes, twisted_null_vector};
use crate::base::Dd;
use crate::kernel::real::Float;
use crate::kernel::simd::each;
use crate::kernel::triple::Triple;
use std::ops::Range;

/// A mode of a tree.
#[derive(Clone, Debug)]
pub struct TreeMode {
    pub lambda: Triple,
    pub radius: f64,
    /// M-normalised to working precision.
    pub x: Displacements,
}

/// An approximate mode: its nodes' displacements.
struct Vector {
    shift: f64,
    x: Vec<f64>,
}

/// Why modes are missing.
enum Lack {
    /// An iteration left its bracket; it may stay in a narrower one.
    Bracket,
    Bound,
}

/// Widths of a bracket relative to the distance of its neighbours, tried in turn.
const NARROW: [f64; 4] = [0.25, 0.01, 1e-4, 1e-8];
/// After a relative step this small in double-double, the next one, its square, would have no effect.
const SETTLED: f64 = 1e-18;
/// Quadratic convergence from a narrow bracket takes two or three steps.
const MAX_ITERATIONS: usize = 6;

/// The `wanted` lowest elastic modes, ascending; `None` if the tree is not suitable for this method: frequencies are
/// too close to be separated in binary64, or vectors are out of range.
pub fn lowest(forest: &Forest, wanted: usize, tolerance: f64) -> Option<Vec<TreeMode>> {
    let search = Search::of(forest);
    search.modes(&mut search.brackets(), 0..wanted, tolerance)
}

/// The elastic modes that may lie in the band, ascending, and how many elastic modes come before them.
pub fn modes_within(forest: &Forest, band: Band, tolerance: f64) -> Option<(usize, Vec<TreeMode>)> {
    let search = Search::of(forest);
    let mut brackets = search.brackets();
    let wanted = brackets.numbers(band)?;
    let before = wanted.start;
    Some((before, search.modes(&mut brackets, wanted, tolerance)?))
}

/// The rigid motion of a tree without ground: all displacements are equal, so that no spring is stretched.
pub fn rigid_motion(forest: &Forest) -> Vec<Dd> {
    let inertia = forest.nodes.iter().fold(Dd::ZERO, |sum, node| sum + node.mass);
    let scale = inertia.sqrt().recip();
    by_coordinate(forest, |i| forest.scales.get(i).map_or(scale, |&sigma| scale * sigma), Dd::ZERO)
}

/// The values of the nodes, in the order of the coordinates.
fn by_coordinate<T: Copy>(forest: &Forest, of: impl Fn(usize) -> T, zero: T) -> Vec<T> {
    let mut result = vec![zero; forest.n()];
    for (node, &coordinate) in forest.coordinates.iter().enumerate() {
        result[coordinate as usize] = of(node);
    }
    result
}

struct Search<'a> {
    forest: &'a Forest,
    nodes: Vec<Node<f64>>,
    tree: Tree,
}

impl<'a> Search<'a> {
    fn of(forest: &'a Forest) -> Search<'a> {
        Search { forest, nodes: forest.nodes_in(), tree: Tree::of(forest) }
    }

    fn brackets(&self) -> Brackets<'_> {
        Brackets::new(self.forest, &self.nodes)
    }

    /// The modes with these numbers, counted from the first elastic one.
    fn modes(&self, brackets: &mut Brackets, wanted: Range<usize>, tolerance: f64) -> Option<Vec<TreeMode>> {
        let elastic = self.forest.n() - usize::from(self.forest.floats);
        let wanted = wanted.start.min(elastic)..wanted.end.min(elastic);
        if wanted.is_empty() {
            return Some(Vec::new());
        }
        // The neighbours on either side are bracketed too.
        let bracketed = wanted.start.saturating_sub(1)..(wanted.end + 1).min(elastic);
        let first = wanted.start - bracketed.start;
        for narrow in NARROW {
            let list = brackets.narrow(&bracketed, narrow)?;
            let frames: Vec<Frame> = (0..list.len()).map(|k| brackets.frame(&list, k)).collect();
            let chosen = first..first + wanted.len();
            match self.certify(&list[chosen.clone()], &frames[chosen], tolerance) {
                Ok(modes) => return Some(modes),
                Err(Lack::Bracket) => {}
                Err(Lack::Bound) => return None,
            }
        }
        None
    }

    /// The modes in the brackets, eight at a time in binary64, and one by one if that is not enough.
    fn certify(&self, brackets: &[Bracket], frames: &[Frame], tolerance: f64) -> Result<Vec<TreeMode>, Lack> {
        let mut all = Vec::with_capacity(brackets.len());
        let mut room = Vec::new();
        for (brackets, frames) in brackets.chunks(8).zip(frames.chunks(8)) {
            let (shifts, settled) = self.iterate(brackets);
            shapes(&self.nodes, shifts, &mut room);
            let last = brackets.len() - 1;
            let found = enclose_lanes(&self.nodes, &room, &self.tree, &each(|lane| frames[lane.min(last)]));
            // Next to a close neighbour, a binary64 vector is a mixture of the two modes.
            let good = |lane: &usize| {
                *lane <= last
                    && settled[*lane]
                    && found[*lane].relative() <= tolerance
                    && !frames[*lane].is_close(brackets[*lane].middle())
            };
            let lanes: Vec<usize> = (0..8).filter(good).collect();
            let mut shapes = self.spread(&room, &lanes, |lane| found[lane].scale.hi).into_iter();
            for (lane, (bracket, frame)) in brackets.iter().zip(frames).enumerate() {
                let Enclosed { lambda, radius, .. } = found[lane];
                all.push(match (settled[lane], lanes.contains(&lane)) {
                    (true, true) => {
                        let x = Displacements::Plain(shapes.next().unwrap_or_default());
                        TreeMode { lambda, radius, x }
                    }
                    (true, false) => self.mode_in_double_double(shifts[lane], frame).ok_or(Lack::Bound)?,
                    (false, _) => self.mode_at_twist(bracket, frame, tolerance)?,
                });
            }
        }
        Ok(all)
    }

    /// The scaled displacements in the chosen lanes, by coordinate.
    fn spread(&self, room: &[[f64; 8]], lanes: &[usize], scale: impl Fn(usize) -> f64) -> Vec<Vec<f64>> {
        let scales: Vec<f64> = lanes.iter().map(|&lane| scale(lane)).collect();
        let mut all = vec![vec![0.0; room.len()]; lanes.len()];
        for (node, (&coordinate, x)) in self.forest.coordinates.iter().zip(room).enumerate() {
            let sigma = self.sigma(node).hi;
            for ((shape, &lane), scale) in all.iter_mut().zip(lanes).zip(&scales) {
                shape[coordinate as usize] = x[lane] * (sigma * scale);
            }
        }
        all
    }

    fn sigma(&self, node: usize) -> Dd {
        self.forest.scales.get(node).copied().unwrap_or(Dd::ONE)
    }

    /// A mode in which the root hardly moves.
    fn mode_at_twist(&self, bracket: &Bracket, frame: &Frame, tolerance: f64) -> Result<TreeMode, Lack> {
        let Vector { shift, x } = self.twisted_vector(bracket).ok_or(Lack::Bracket)?;
        let room: Vec<[f64; 1]> = x.iter().map(|&x| [x]).collect();
        let [found] = enclose_lanes(&self.nodes, &room, &self.tree, &[*frame]);
        if found.relative() > tolerance || frame.is_close(bracket.middle()) {
            return self.mode_in_double_double(shift, frame).ok_or(Lack::Bound);
        }
        let x = by_coordinate(self.forest, |i| x[i] * (self.sigma(i).hi * found.scale.hi), 0.0);
        Ok(TreeMode { lambda: found.lambda, radius: found.radius, x: Displacements::Plain(x) })
    }

    /// A mode near a shift in double-double.
    fn mode_in_double_double(&self, shift: f64, frame: &Frame) -> Option<TreeMode> {
        let nodes = self.forest.nodes_in::<Dd>();
        let (mut shift, mut at) = (Dd::from(shift), None);
        // Two steps if the neighbours are far; more if the shift is hardly nearer to one eigenvalue than to another.
        for _ in 0..MAX_ITERATIONS {
            let next = twisted_null_vector(&nodes, shift, at);
            let change = next.residual / inertia(&nodes, &next.x);
            shift += change;
            if at.is_some() && change.abs().to_f64() <= SETTLED * shift.abs().to_f64() {
                break;
            }
            at = Some(next.at);
        }
        let x: Vec<[Dd; 1]> = twisted_null_vector(&nodes, shift, at).x.into_iter().map(|x| [x]).collect();
        let [found] = enclose_lanes(&nodes, &x, &self.tree, &[*frame]);
        let x = by_coordinate(self.forest, |i| Triple::from(x[i][0] * (self.sigma(i) * found.scale)), Triple::ZERO);
        let x = Displacements::Precise(x);
        found.radius.is_finite().then_some(TreeMode { lambda: found.lambda, radius: found.radius, x })
    }

    /// The shifts at which v of the root is zero, in up to eight brackets, and whether each converged inside its
    /// bracket: Newton's step for v gives the Rayleigh quotient of the null vector.
    fn iterate(&self, brackets: &[Bracket]) -> ([f64; 8], [bool; 8]) {
        let mut shifts = [brackets[0].middle(); 8];
        shifts.iter_mut().zip(brackets).for_each(|(shift, bracket)| *shift = bracket.middle());
        let mut settled = [false; 8];
        for _ in 0..MAX_ITERATIONS {
            let (v, slope) = root(&self.nodes, shifts);
            for (lane, bracket) in brackets.iter().enumerate() {
                let next = shifts[lane] - v[lane] / slope[lane];
                settled[lane] = bracket.contains(next) && is_settled(shifts[lane], next);
                if bracket.contains(next) {
                    shifts[lane] = next;
                }
            }
            if settled[..brackets.len()].iter().all(|&settled| settled) {
                break;
            }
        }
        (shifts, settled)
    }

    /// The vector of one bracket, for modes in which the root hardly moves.
    fn twisted_vector(&self, bracket: &Bracket) -> Option<Vector> {
        let mut shift = bracket.middle();
        for _ in 0..MAX_ITERATIONS {
            let found = twisted_null_vector(&self.nodes, shift, None);
            let next = shift + found.residual / inertia(&self.nodes, &found.x);
            if !bracket.contains(next) {
                return None;
            }
            if is_settled(shift, next) {
                return Some(Vector { shift: next, x: twisted_null_vector(&self.nodes, next, None).x });
            }
            shift = next;
        }
        None
    }
}

/// x^T M x, one after the other: for the next shift only.
fn inertia<T: Float>(nodes: &[Node<T>], x: &[T]) -> T {
    let one = |sum: T, (node, &own): (&Node<T>, &T)| {
        let b = own - x[node.parent as usize];
        sum + (node.mass * own * own - node.coupling * b * b)
    };
    nodes.iter().zip(x).fold(T::ZERO, one)
}

/// The error of a quotient is the square of its vector's error.
fn is_settled(shift: f64, next: f64) -> bool {
    (next - shift).abs() <= 2e-9 * shift
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes::eigen::eigenpairs;
    use crate::analysis::modes::pair::Eigenvalue;
    use crate::analysis::modes::terms::Terms;
    use crate::analysis::test_systems::{blank, push};
    use crate::system::{Form, LinearSystem};

    /// A tree of n bodies: body i hangs on body (i x 7 + 3) mod i, with numbers spread over this many decades.
    fn tree(n: usize, decades: i32, grounded: bool) -> LinearSystem {
        let mut system = blank(n);
        let number = |i: usize, salt: usize| {
            let e = (i * 5 + salt) as i32 % (decades + 1) - decades / 2;
            format!("{}e{e}", 1000 + (i * 7919 + salt * 104_729) % 9000)
        };
        for i in 0..n {
            push(&mut system.m, &number(i, 1), i, None);
            if i > 0 {
                push(&mut system.k, &number(i, 2), (i * 7 + 3) % i, Some(i));
            }
        }
        if grounded {
            push(&mut system.k, &number(n, 3), 0, None);
            push(&mut system.k, &number(n, 4), n / 2, None);
        }
        system
    }

    fn forest(system: &LinearSystem) -> Forest {
        Forest::of(&Terms::of(&system.m), &Terms::of(&system.k), system.n()).expect("a tree")
    }

    /// Checks that the lowest modes agree with those of the dense method within both bounds, and that the bounds meet
    /// the tolerance.
    fn check(system: &LinearSystem, tolerance: f64) {
        let forest = forest(system);
        let found = lowest(&forest, 6, tolerance).expect("modes apart");
        let known = eigenpairs(&system.k, &system.m, system.n(), 1e-12).expect("a regular system");
        let known = known.iter().filter_map(|pair| match pair.value {
            Eigenvalue::Near { value, radius, .. } => Some((value, radius)),
            Eigenvalue::Zero => None,
        });
        for (mode, (value, radius)) in found.iter().zip(known) {
            let error = (mode.lambda - value).hi().abs();
            assert!(error <= mode.radius + radius, "{error:e} {:e} {radius:e}", mode.radius);
            assert!(mode.radius <= tolerance * value.hi(), "{:e}", mode.radius / value.hi());
        }
    }

    #[test]
    fn trees_agree_with_dense_matrices() {
        for decades in [0, 6, 20] {
            check(&tree(14, decades, true), 1e-12);
            check(&tree(14, decades, true), 1e-28);
            check(&tree(13, decades, false), 1e-12);
            check(&tree(13, decades, false), 1e-28);
        }
    }

    #[test]
    fn gears_are_trees_too() {
        let mut system = tree(9, 4, true);
        let mut form = Form::new();
        for term in system.k.terms() {
            let source = form.source(system.k.source_of(term.source));
            let row = system.k.row(term).iter().enumerate();
            let row = row.map(|(i, (c, a))| (*c, a * &crate::base::Number::from(["1", "2.3"][i])));
            form.push(source, term.nature, term.weight.clone(), row.collect::<Vec<_>>());
        }
        system.k = form;
        check(&system, 1e-12);
        check(&system, 1e-27);
    }

    #[test]
    fn the_rigid_motion_stretches_nothing() {
        let system = tree(9, 3, false);
        let x = rigid_motion(&forest(&system));
        assert!(x.iter().all(|&entry| entry == x[0] && entry.hi > 0.0));
    }
}
