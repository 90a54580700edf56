//! Answers as values: the results of the stages and the questions about a model, and the reports on them, for back ends
//! to lay out. Nothing is computed or rounded here. See docs/method/report.md.

pub mod ranges;
pub mod report;

use crate::analysis::response_spectrum::Spectral;
use crate::analysis::shock::{Quantity, ShockSpectrum};
use crate::analysis::{Buckling, DampedShape, Excitation, Modes, Noisy, Pole, Poles, Share, Verdict};
use crate::base::{Name, Number, OrderBy};
use crate::lower::{Account, Rest, ShapeNode};
use crate::questions::answer::{Optimised, Requirement, Sensitivity, Solved, Tolerated};
use crate::system::{Coordinate, LinearSystem, Origin, Source};
use std::collections::HashMap;

/// The contents of a modal report.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ModalAnswer {
    /// The model's name.
    pub model: String,
    pub system: LinearSystem,
    pub rest: Rest,
    pub modes: Modes,
    pub poles: Poles,
    pub stability: Verdict,
    /// Set if gravity, tensions or reactions reduce the stiffness.
    pub buckling: Option<Buckling>,
    /// The parts of the model that were kept and left out, if requested.
    pub account: Option<Account>,
    /// Parameters that were solved for, in order of their lines.
    pub solved: Vec<Solved>,
    /// Results of the lines `minimise` and `maximise`, in order of the lines.
    pub optimised: Vec<Optimised>,
    pub requirements: Vec<Requirement>,
    /// The outputs that noise reaches.
    pub noisy: Vec<Noisy>,
    /// The maxima under response spectra.
    pub spectral: Spectral,
    /// Empty unless requested.
    pub sensitivities: Vec<Sensitivity>,
    /// Results for all values within the tolerances, if requested and any parameter has a range.
    pub tolerated: Option<Tolerated>,
    /// The modes that each motion of a base excites, or the reason why they are not known; empty unless requested.
    pub excitations: Vec<(usize, Result<Excitation, &'static str>)>,
    /// The complex shapes of the damped motions; empty unless requested.
    pub damped_shapes: Vec<DampedShape>,
    /// For each mode of the list the points of turning bodies that stay in place; empty unless requested.
    pub nodes: Vec<Vec<ShapeNode>>,
}

/// Shares with one entry for each name: a belt is one part of the model, and two spans in the system. Largest first; where no
/// name comes twice the list stays as it is, so that equal shares keep their order, which is not that of their last bits.
pub fn by_name(list: &[Share<Source>]) -> Vec<Share<Source>> {
    let of_elements = list.iter().filter(|share| matches!(share.of.origin, Origin::Element(_)));
    let mut names: Vec<Name> = of_elements.map(|share| share.of.name).collect();
    names.sort_unstable();
    if names.windows(2).all(|pair| pair[0] != pair[1]) {
        return list.to_vec();
    }
    let mut named: Vec<Share<Source>> = Vec::with_capacity(list.len());
    let mut places: HashMap<Name, usize> = HashMap::new();
    for share in list {
        match (share.of.origin, places.get(&share.of.name)) {
            (Origin::Element(_), Some(&place)) => named[place].part.0 += share.part.0,
            (Origin::Element(_), None) => {
                places.insert(share.of.name, named.len());
                named.push(*share);
            }
            _ => named.push(*share),
        }
    }
    named.order_by(|a, b| b.part.0.total_cmp(&a.part.0));
    named
}

/// The shock response spectra of a model's bases.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Shock {
    /// The model's name.
    pub model: String,
    pub list: Vec<ShockOf>,
}

/// The spectrum of one base.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ShockOf {
    /// Its name.
    pub input: String,
    pub unit: &'static str,
    pub spectrum: ShockSpectrum,
}

impl Shock {
    pub fn new(model: String, list: Vec<ShockOf>) -> Shock {
        Shock { model, list }
    }
}

impl ShockOf {
    /// `turns`: whether the base turns.
    pub fn new(input: String, turns: bool, spectrum: ShockSpectrum) -> ShockOf {
        let unit = match (spectrum.quantity, turns) {
            (Quantity::PseudoAcceleration, false) => "m/s^2",
            (Quantity::PseudoAcceleration, true) => "rad/s^2",
            (Quantity::RelativeDisplacement, false) => "m",
            (Quantity::RelativeDisplacement, true) => "rad",
        };
        ShockOf { input, unit, spectrum }
    }
}

impl ModalAnswer {
    /// Every coordinate with its displacement at rest: those of the system, then those that depend on them.
    pub fn displacements(&self) -> impl Iterator<Item = (&Coordinate, &Number)> {
        let own = self.system.coordinates.iter().zip(&self.rest.displacement);
        let dependent = self.rest.dependent.iter().map(|dependent| (&dependent.coordinate, &dependent.displacement));
        own.chain(dependent)
    }

    /// The poles as motions, counted from 1; of a complex pair, only the one in the upper half plane.
    pub fn motions(&self) -> impl Iterator<Item = (usize, &Pole)> {
        (1..).zip(self.poles.list.iter().filter(|pole| !pole.is_lower_half()))
    }

    /// Claims in the report that are not proved: that the list of poles is complete, and the verdict on the rest.
    pub fn not_proved(&self) -> impl Iterator<Item = &'static str> {
        let count = self.poles.is_uncounted().then_some("that these are all poles, and each is there once");
        let verdict = Some(self.stability.reason().not_proved()).filter(|claim| !claim.is_empty());
        count.into_iter().chain(verdict)
    }
}
