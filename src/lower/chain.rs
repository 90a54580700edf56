//! Chained rows: the motion of the point that holds each piece of a deep tree, as the motion of its carrier's point plus
//! its own contribution. In: the kinematics and a state. Out: one or two short rows for each piece. See
//! docs/method/system.md#deep-trees.

use super::kinematics::{End, Kinematics, Path, PathEvaluation, State};
use super::tree::PieceId;
use crate::base::Number;
use crate::elements::Vector;
use crate::system::CoordinateId;
use crate::system::chain::ChainedRow;

/// The displacements of the points that hold the pieces.
pub struct Chain {
    /// The rows, each over coordinates and, from n on, rows before it.
    pub rows: Vec<ChainedRow>,
    /// For each piece and axis, the coordinate or row with which its point moves; `None` if it stands still.
    held: Vec<[Option<CoordinateId>; 2]>,
}

impl Chain {
    pub fn new(kinematics: &Kinematics, state: &State<Number>) -> Chain {
        let mut chain = Chain { rows: Vec::new(), held: vec![[None; 2]] };
        let (mut path, mut reach) = (Path::default(), PathEvaluation::default());
        for piece in 1..kinematics.tree.pieces.len() {
            let carrier = kinematics.tree.pieces[piece].carrier;
            kinematics.path_between(anchor(kinematics, carrier), anchor(kinematics, piece as PieceId), &mut path);
            reach.measure(kinematics, state, &path);
            let axes = [0, 1].map(|axis| {
                let row = row(chain.held[carrier as usize][axis], &reach, axis);
                match &row[..] {
                    [] => None,
                    [(only, factor)] if factor.is_one() => Some(*only),
                    _ => {
                        chain.rows.push(row);
                        Some(CoordinateId((kinematics.n() + chain.rows.len() - 1) as u32))
                    }
                }
            });
            chain.held.push(axes);
        }
        chain
    }

    /// The displacement of a point of a piece along x or y. `reach` holds the path to it from the point that holds the
    /// piece.
    pub fn row(&self, piece: PieceId, reach: &PathEvaluation<Number>, axis: usize) -> ChainedRow {
        row(self.held[piece as usize][axis], reach, axis)
    }

    pub fn is_still(&self, piece: PieceId) -> bool {
        self.held[piece as usize] == [None; 2]
    }
}

/// The point that holds a piece.
pub fn anchor(kinematics: &Kinematics, piece: PieceId) -> End<'_> {
    End { piece, at: kinematics.tree.pieces[piece as usize].anchor.as_deref() }
}

fn row(held: Option<CoordinateId>, reach: &PathEvaluation<Number>, axis: usize) -> ChainedRow {
    let mut own = Vec::new();
    let [x, y, _] = Vector::axes();
    reach.row(if axis == 0 { &x } else { &y }, &mut own);
    let own = own.into_iter().map(|(i, value)| (CoordinateId(i), value));
    own.chain(held.map(|held| (held, Number::ONE))).collect()
}
