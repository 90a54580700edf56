//! Constraint equations: the sums that joints closing loops, and couplings, hold at zero. In: the scene's motion. Out:
//! a sum for each, and a multiplier's name. See docs/method/kinematics.md#constraints.

use super::motion::Motion;
use super::names::{Label, Names, class};
use crate::base::Span;
use crate::model::scene::Motion as Moved;
use crate::model::scene::{MotionTerm, Part, Scene};
use crate::model::written::{Pair, Written, WrittenTerm, difference, dot};
use crate::symbols::{Sum, Symbol};

/// `equation = 0`.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// The name of the joint or coupling.
    pub name: String,
    pub span: Span,
    pub multiplier: Symbol,
    pub equation: Sum,
    /// Whether it relates the coordinates linearly.
    pub is_linear: bool,
}

/// All constraints: joints in order of declaration, then couplings.
pub fn constraints(scene: &Scene, written: &Written, motion: &Motion, names: &mut Names) -> Option<Vec<Constraint>> {
    let mut list = Vec::new();
    for &index in &motion.closing {
        let (joint, written) = (scene.joints.get(index)?, written.joints.get(index)?);
        let parts = [0, 1].map(|end| joint.ends[end].part);
        let turn = &motion.angle(parts[1]).unwrap_or_default() - &motion.angle(parts[0]).unwrap_or_default();
        let equations = match (joint.kind.turns, joint.kind.slides) {
            (true, false) => difference_of_ends(motion, parts, written.at.as_ref()).to_vec(),
            (false, false) => {
                let at = written.ends[0].as_ref().or(written.ends[1].as_ref());
                let [x, y] = difference_of_ends(motion, parts, at);
                vec![x, y, turn]
            }
            (turns, true) => {
                let along = names.unit(written.along.as_ref()?);
                let across = motion.rotate(parts[0], &[-&along[1], along[0].clone()]);
                let at = written.ends[0].as_ref().or(written.ends[1].as_ref());
                let mut equations = vec![dot(&across, &difference_of_ends(motion, parts, at))];
                equations.extend((!turns).then_some(turn));
                equations
            }
        };
        for equation in equations.into_iter().filter(|equation| !equation.is_zero()) {
            push(&mut list, scene.words.display(joint.name), joint.span, equation, names);
        }
    }
    for (couple, terms) in scene.couples.iter().zip(&written.couples) {
        let mut equation = Sum::ZERO;
        for (term, own) in couple.terms.iter().zip(terms) {
            equation = &equation + &(&own.coefficient * &displacement(motion, term, own, written)?);
        }
        push(&mut list, scene.words.display(couple.name), couple.span, equation, names);
    }
    Some(list)
}

fn push(list: &mut Vec<Constraint>, name: String, span: Span, equation: Sum, names: &mut Names) {
    let multiplier = Symbol::new(class::MULTIPLIER, list.len());
    names.set(multiplier, Label::new("lambda", (list.len() + 1).to_string()), None);
    let is_linear = equation.terms().iter().all(|(product, _)| {
        let moving = product.factors().iter().filter(|(factor, _)| factor.mentions(&super::energy::is_motion));
        let moving: Vec<_> = moving.collect();
        matches!(&moving[..], [] | [(crate::symbols::Factor::Name(_), 1)])
    });
    list.push(Constraint { name, span, multiplier, equation, is_linear });
}

/// The displacement of a common point of two parts, second against first.
fn difference_of_ends(motion: &Motion, parts: [Part; 2], at: Option<&Pair>) -> Pair {
    let [a, b] = parts.map(|part| motion.place(part, at));
    difference(&b, &a)
}

/// A motion of a coupling, measured from the drawing.
fn displacement(motion: &Motion, term: &MotionTerm, own: &WrittenTerm, written: &Written) -> Option<Sum> {
    match &term.motion {
        Moved::Point { part, direction, at, .. } => {
            let exact = |number: &crate::base::Number| number.exact().map(|exact| Sum::number(exact.clone()));
            let direction = [exact(&direction.x)?, exact(&direction.y)?];
            let at = own.at.clone().or_else(|| written.own_place(*part)).or_else(|| {
                let at = at.as_ref()?;
                Some([exact(&at.x)?, exact(&at.y)?])
            });
            let place = motion.place(*part, at.as_ref());
            let place = match &at {
                Some(at) => difference(&place, at),
                None => place,
            };
            Some(dot(&direction, &place))
        }
        Moved::Turn { part, .. } => Some(motion.angle(*part).unwrap_or_default()),
        Moved::Force { .. } | Moved::Stretch { .. } | Moved::Reaction(_) => None,
    }
}
