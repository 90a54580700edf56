//! The results of following the modes of a study: the curves, and the places where they come near each other.

use super::answer::{Proved, shown_in};
use super::tolerated::hull;
use crate::base::{Ball, Number};
use crate::model::scene::Written;

/// The curves of a study over one parameter.
#[derive(Clone, Debug)]
pub struct Followed {
    /// In the order of their frequencies at the first point where they have any.
    pub curves: Vec<Curve>,
    /// In the order of the parameter.
    pub meetings: Vec<Meeting>,
    /// The poles as curves, in the order of the first case; empty if they were not requested, or are not all known.
    pub loci: Vec<Locus>,
    pub onsets: Onsets,
    pub orders: Orders,
    /// Name and unit of the parameter.
    pub parameter: (String, Written),
    /// Its values, SI.
    pub places: Vec<f64>,
    /// The number of classes: blocks of coordinates that are not coupled for any value of the parameter.
    pub classes: usize,
}

/// A frequency that keeps its identity.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Counted from 1.
    pub class: usize,
    /// In Hz, for each case.
    pub points: Vec<Option<Ball>>,
    /// Whether it is proved that the point of each case lies on the same curve as that of the previous case.
    pub links: Vec<Option<Proved>>,
}

/// A pole that keeps its identity.
#[derive(Clone, Debug)]
pub struct Locus {
    /// Real part, 1/s, and imaginary part, rad/s, for each case.
    pub points: Vec<[Ball; 2]>,
    /// Whether it is proved that the point of each case lies on the same curve as that of the previous case.
    pub links: Vec<Option<Proved>>,
}

/// Two curves, counted from 0, near each other.
#[derive(Clone, Debug)]
pub struct Meeting {
    pub curves: [usize; 2],
    /// The parameter lies between these, SI.
    pub place: [f64; 2],
    pub kind: MeetingKind,
}

#[derive(Clone, Copy, Debug)]
pub enum MeetingKind {
    /// They veer: their distance has a least value, Hz, within that place, and both frequencies there lie in an
    /// enclosure.
    Veering { distance: Ball, frequency: Ball, proof: Proved },
    /// They cross there, at this frequency, Hz: they belong to blocks that are not coupled.
    Crossing { frequency: Ball, proof: Proved },
    /// Neither is proved; they come at least as near as this, Hz.
    Undecided { distance: Option<Ball> },
}

/// Orders of the parameter, which is a rate of rotation, and the places where curves have their frequencies.
#[derive(Clone, Debug, Default)]
pub struct Orders {
    pub list: Vec<u32>,
    /// By order, curve and place.
    pub critical: Vec<Critical>,
    /// The frequency of the first order, in Hz, per SI unit of the rate.
    pub per_unit: f64,
}

/// A curve, counted from 0, has the frequency of an order somewhere in the place (SI).
#[derive(Clone, Copy, Debug)]
pub struct Critical {
    pub curve: usize,
    pub order: u32,
    pub place: [f64; 2],
    /// In Hz; `None` if it is not proved.
    pub frequency: Option<Ball>,
}

/// The places where the number of growing motions changes.
#[derive(Clone, Debug)]
pub struct Onsets {
    pub of: Grows,
    /// In the order of the cases.
    pub list: Vec<Onset>,
    /// The number of cases for which the number of growing motions is not known.
    pub undecided: usize,
}

/// The kind of motion that may grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grows {
    /// Undamped modes: the number of negative eigenvalues of K.
    Modes,
    /// Poles with a positive real part.
    Poles,
}

/// A change of the number of growing motions.
#[derive(Clone, Copy, Debug)]
pub struct Onset {
    /// The parameter lies between these, SI; the first is on the side of earlier cases.
    pub place: [f64; 2],
    /// The numbers of growing motions at both.
    pub growing: [usize; 2],
    /// Whether it is proved that an eigenvalue of K, or a real part of a pole, is zero in the place.
    pub proof: Option<Proved>,
}

impl Followed {
    /// An enclosed place in the unit of the parameter.
    pub fn place(&self, ends: [f64; 2]) -> Ball {
        let [low, high] = ends.map(Ball::from);
        shown_in(&Number::Ball(hull(low, high)), &self.parameter.1, false).number
    }

    /// A value of the parameter in its unit.
    pub fn in_unit(&self, si: f64) -> Ball {
        shown_in(&Number::Ball(Ball::from(si)), &self.parameter.1, false).number
    }
}

impl Locus {
    /// The cases whose link to the previous case is not proved.
    pub fn open_links(&self) -> impl Iterator<Item = usize> {
        (1..self.links.len()).filter(|&i| self.links[i].is_none())
    }
}

impl Curve {
    /// The cases whose link to the previous case is not proved.
    pub fn open_links(&self) -> impl Iterator<Item = usize> {
        (1..self.points.len()).filter(|&i| self.has_link(i) && self.links[i].is_none())
    }

    /// Whether both this case and the previous one have a point.
    pub fn has_link(&self, case: usize) -> bool {
        case > 0 && self.points[case].is_some() && self.points[case - 1].is_some()
    }
}
