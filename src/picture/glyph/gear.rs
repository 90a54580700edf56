//! A pair of gears: teeth on two disks that touch and turn against each other.

use crate::model::scene::{Motion, MotionTerm, Part};
use crate::picture::figure::{Pen, Ride, Stroke};
use crate::picture::geometry::{Point, Turn};
use crate::picture::layout::{Outline, Parts};
use crate::picture::stage::Stage;
use std::f64::consts::PI;

/// Length of a tooth and the way from one to the next, px.
const TOOTH: f64 = 3.5;
const PITCH: f64 = 7.0;

/// Strokes, each group with the part it rides on, and a point.
type Teeth = (Vec<(Ride, Vec<Stroke>)>, Point);

/// The teeth, and the point where the disks touch; `None` if this is not a pair of gears.
pub fn strokes(stage: &Stage, terms: &[MotionTerm], parts: &Parts) -> Option<Teeth> {
    let [first, second] = terms else { return None };
    let wheel = |motion: &Motion| match motion {
        Motion::Turn { part, derivative: 0 } if *part != Part::Ground => {
            let number = parts.number(*part);
            match stage.layout.parts[number].outline {
                Outline::Disk { radius } | Outline::Ring { radius } | Outline::Wheel { radius } => {
                    Some((number, radius))
                }
                _ => None,
            }
        }
        _ => None,
    };
    let ((a, ra), (b, rb)) = (wheel(&first.motion)?, wheel(&second.motion)?);
    let (at, to) = (stage.place(a), stage.place(b));
    let touches = (at.distance(to) - ra - rb).abs() < 0.02 * (ra + rb) + 1.0;
    let along = to.minus(at).unit().filter(|_| touches)?;
    // The teeth of one wheel stand in the gaps of the other.
    let (own, other) = (teeth(at, ra, along, 0.0), teeth(to, rb, along.times(-1.0), 0.5));
    let strokes = vec![(Ride::With(a), own), (Ride::With(b), other)];
    Some((strokes, at.towards(along, ra)))
}

/// Teeth round a wheel. At the point where the other wheel touches it, there is a tooth or the middle of a gap.
fn teeth(centre: Point, radius: f64, towards: Point, offset: f64) -> Vec<Stroke> {
    let count = (2.0 * PI * radius / PITCH).round().max(6.0);
    let step = Turn::from_angle(2.0 * PI / count);
    let mut arm = towards.rotate(Turn::from_angle(2.0 * PI / count * offset));
    let mut strokes = Vec::new();
    for _ in 0..count as usize {
        strokes.push(Stroke::line([centre.towards(arm, radius), centre.towards(arm, radius + TOOTH)], Pen::Normal));
        arm = arm.rotate(step);
    }
    strokes
}
