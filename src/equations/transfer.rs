//! Outputs as rows over the coordinates, and transfer functions as quotients of polynomials in s. In: the linearised equations; out:
//! for each input and output a numerator over the common characteristic polynomial.

use super::Equations;
use super::linear::AtRest;
use crate::model::scene::Scene;
use crate::model::written::Written;
use crate::symbols::Sum;

/// A linear combination of motions: by the order of the derivative, a sum for each independent coordinate.
#[derive(Clone, Debug)]
pub struct Output {
    pub name: String,
    pub rows: Vec<Vec<Sum>>,
}

pub fn outputs(_scene: &Scene, _written: &Written, _equations: &Equations, _at_rest: &AtRest) -> Vec<Output> {
    Vec::new()
}
