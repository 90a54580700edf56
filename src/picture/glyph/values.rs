//! The texts of labels and titles: names, values with their units, and the motion of a part in the displayed mode.

use super::initial::is_rate;
use crate::base::{Name, Number};
use crate::model::scene::{Body, Element, Geometry, Law, Motion, Part, Scene};
use crate::picture::layout::Parts;
use crate::picture::{Request, text};

/// A scene in words.
pub struct Says<'a> {
    pub scene: &'a Scene,
    pub request: &'a Request<'a>,
}

impl Says<'_> {
    pub fn display(&self, name: Name) -> String {
        self.scene.words.display(name)
    }

    pub fn part_name(&self, part: Part) -> String {
        let parts = Parts::new(self.scene);
        parts.name(self.scene, parts.number(part)).map_or_else(|| "ground".into(), |name| self.display(name))
    }

    /// Room that the label of an element takes, px.
    pub fn element_width(&self, index: usize) -> f64 {
        width(&element_label(self, &self.scene.elements[index]))
    }

    /// The width of the label of a body or a base, px.
    pub fn part_width(&self, number: usize) -> f64 {
        match Parts::new(self.scene).part(number) {
            Part::Ground => 0.0,
            Part::Body(body) => width(&body_label(self, &self.scene.bodies[body.index()])),
            Part::Base(base) => width(&self.display(self.scene.bases[base.index()].name)),
        }
    }
}

fn width(label: &str) -> f64 {
    text::width(&text::clip(label)) * text::SPARE
}

/// The coefficient with its unit, such as `k = 10 N/m`; `None` for an element with a law.
fn value(says: &Says, element: &Element) -> Option<String> {
    let turns = element.law.geometry == Geometry::Torsion;
    let Law { kind, coefficient, curve, .. } = &*element.law;
    let (letter, unit) = (kind.coefficient().name, kind.unit(turns));
    curve.is_none().then(|| format!("{letter} = {} {unit}", (says.request.digits)(coefficient)))
}

/// A name, followed by its value if values are asked for. A name that equals the letter of the value is not repeated.
fn name_with_value(says: &Says, name: String, value: impl FnOnce() -> Option<String>) -> String {
    match says.request.values.then(value).flatten() {
        None => name,
        Some(value) if value.strip_prefix(name.as_str()).is_some_and(|rest| rest.starts_with(" = ")) => value,
        Some(value) => format!("{name}: {value}"),
    }
}

pub fn element_label(says: &Says, element: &Element) -> String {
    name_with_value(says, says.display(element.name), || value(says, element))
}

pub fn element_title(says: &Says, element: &Element) -> String {
    let word = element.law.kind.keyword;
    let [a, b] = [0, 1].map(|end| says.part_name(element.ends[end].part));
    let name = says.display(element.name);
    let value = value(says, element).unwrap_or_else(|| "by its law".into());
    format!("{word} {name}: {value}, {a} to {b}{}", mode_motion(says, element.name))
}

fn mode_motion(says: &Says, name: Name) -> String {
    says.request.mode_motion(name).map_or(String::new(), |does| format!("; {does}"))
}

fn body_values(says: &Says, body: &Body) -> Option<String> {
    let known = |number: Option<&Number>, letter: &str, unit: &str| {
        let number = number.filter(|number| !number.is_zero())?;
        Some(format!("{letter} = {} {unit}", (says.request.digits)(number)))
    };
    let (mass, inertia) = (known(body.mass.as_ref(), "m", "kg"), known(body.inertia.as_deref(), "J", "kg*m^2"));
    let all: Vec<String> = [mass, inertia].into_iter().flatten().collect();
    (!all.is_empty()).then(|| all.join(", "))
}

pub fn body_label(says: &Says, body: &Body) -> String {
    name_with_value(says, says.display(body.name), || body_values(says, body))
}

pub fn body_title(says: &Says, body: &Body) -> String {
    let name = says.display(body.name);
    let values = body_values(says, body).map_or(String::new(), |values| format!(": {values}"));
    format!("body {name}{values}{}", mode_motion(says, body.name))
}

/// The letter of a motion: `x`, `vy`, `angle`, `omega`.
pub fn motion_word(motion: &Motion) -> &'static str {
    match motion {
        Motion::Point { direction, .. } => match (direction.y.is_zero(), direction.x.is_zero(), is_rate(motion)) {
            (true, _, false) => "x",
            (true, _, true) => "vx",
            (false, true, false) => "y",
            (false, true, true) => "vy",
            (false, false, false) => "s",
            (false, false, true) => "v",
        },
        Motion::Turn { .. } if is_rate(motion) => "omega",
        Motion::Turn { .. } => "angle",
        Motion::Force { .. } => "force",
        Motion::Stretch { .. } => "stretch",
        Motion::Reaction(_) => "force",
    }
}

pub fn motion_value(says: &Says, motion: &Motion, value: &Number) -> String {
    let unit = match motion {
        Motion::Point { .. } if is_rate(motion) => "m/s",
        Motion::Point { .. } | Motion::Stretch { .. } => "m",
        Motion::Turn { .. } if is_rate(motion) => "rad/s",
        Motion::Turn { .. } => "rad",
        Motion::Force { .. } | Motion::Reaction(_) => "N",
    };
    format!("{} {unit}", (says.request.digits)(value))
}
