//! An account of the parts of a scene that lowering kept and left out, and why. In: a checked scene and its lowering.
//! Out: lists for users. They are made on demand only, so that other runs do not pay for them. See
//! docs/method/system.md#only-what-the-scene-needs.
//!
//! Nothing that could change an answer is left out: only terms whose row is zero, weights that do no work, and
//! properties that no degree of freedom uses. Results with and without them are therefore the same numbers.

use super::Lowered;
use super::kinematics::{End, Kinematics, Path};
use super::loads::{self, EndPath};
use crate::base::{Name, Number};
use crate::elements::{KINDS, Kind};
use crate::kinds::enumeration;
use crate::model::CheckedScene;
use crate::model::scene::{Body, BodyId, Element, InputKind, Part, Scene};
use crate::system::{Form, LinearSystem, Origin};

/// The parts of a model that lowering kept and left out.
#[derive(Clone, Debug, Default)]
pub struct Account {
    pub kept: Vec<Remark>,
    pub left_out: Vec<Remark>,
}

/// An item of the model and the remark about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    pub what: String,
    pub why: String,
}

/// Explains how a scene was lowered.
pub fn account(scene: &CheckedScene, lowered: &Lowered) -> Account {
    let mut explanation = Explanation {
        scene: scene.scene(),
        kinematics: &lowered.mechanism.kinematics,
        system: &lowered.system,
        path: Path::default(),
        account: Account::default(),
    };
    explanation.freedoms();
    explanation.bodies();
    explanation.gravity();
    explanation.elements();
    explanation.inputs_and_outputs();
    explanation.account
}

struct Explanation<'a> {
    scene: &'a Scene,
    kinematics: &'a Kinematics,
    system: &'a LinearSystem,
    path: Path<Number>,
    account: Account,
}

impl Explanation<'_> {
    fn keep(&mut self, what: impl Into<String>, why: impl Into<String>) {
        self.account.kept.push(Remark { what: what.into(), why: why.into() });
    }

    fn leave_out(&mut self, what: impl Into<String>, why: impl Into<String>) {
        self.account.left_out.push(Remark { what: what.into(), why: why.into() });
    }

    fn name(&self, name: Name) -> String {
        self.scene.words.display(name)
    }

    fn freedoms(&mut self) {
        let (n, all) = (self.system.n(), self.kinematics.n());
        self.keep(
            count_of(n, "degree of freedom", "degrees of freedom"),
            "only those given by the bodies' freedom clauses and the joints",
        );
        if n < all {
            let dependent = count_of(all - n, "motion", "motions");
            self.leave_out(dependent, "they follow the others through joints that close loops, or couplings");
        }
    }

    fn bodies(&mut self) {
        let mut members: Vec<u32> = vec![0; self.kinematics.tree.pieces.len()];
        for piece in &self.kinematics.tree.bodies {
            members[*piece as usize] += 1;
        }
        let welded = members.iter().filter(|count| **count > 1).count();
        if welded > 0 {
            let what = count_of(welded, "set of welded bodies", "sets of welded bodies");
            self.keep(what, "each is one rigid piece");
        }
        for (index, body) in self.scene.bodies.iter().enumerate() {
            self.body(BodyId(index as u32), body);
        }
    }

    fn body(&mut self, id: BodyId, body: &Body) {
        let piece = self.kinematics.tree.piece(Part::Body(id));
        let turns = self.kinematics.angle(piece).is_some();
        loads::path_from_ground(self.kinematics, End { piece, at: body.centre.as_deref() }, &mut self.path);
        let moves = !self.path.is_empty();
        let name = self.name(body.name);
        let has = |property: Option<&Number>| property.is_some_and(|value| !value.is_zero());
        if !moves && !turns {
            return self.leave_out(name, "it is fixed to the ground");
        }
        if has(body.mass.as_ref()) && !moves {
            self.leave_out(format!("mass of {name}"), "its centre does not move");
        }
        if has(body.inertia.as_deref()) && !turns {
            self.leave_out(format!("inertia of {name}"), "it does not turn");
        }
        if !(has(body.mass.as_ref()) || turns && has(body.inertia.as_deref())) {
            self.keep(
                name,
                "no inertia: its springs make it follow the others, or its dampers make it lag behind them",
            );
        }
    }

    fn gravity(&mut self) {
        if self.scene.gravity.is_zero() {
            return;
        }
        let way = self.kinematics.mass_weighted_path(self.scene, &self.scene.gravity);
        let stiffens = origins(&self.system.k).any(|origin| origin == Origin::Gravity);
        if way.is_empty() {
            self.leave_out("gravity", "no weight can do work in any motion of the scene");
        } else if stiffens {
            self.keep("gravity", "weights load the rest and add stiffness to bodies that turn");
        } else {
            self.keep("gravity", "weights load the rest; no motion changes this load, so it adds no stiffness");
        }
    }

    fn elements(&mut self) {
        let mut acts = vec![false; self.scene.elements.len()];
        for form in [&self.system.k, &self.system.c, &self.system.m] {
            for origin in origins(form) {
                if let Origin::Element(element) = origin {
                    acts[element as usize] = true;
                }
            }
        }
        let mut between = EndPath::default();
        for (element, _) in self.scene.elements.iter().zip(&acts).filter(|(_, acts)| !**acts) {
            let why = self.why_idle(element, &mut between);
            self.leave_out(self.name(element.name), why);
        }
        let of = |kind: &'static Kind| {
            let elements = self.scene.elements.iter().zip(&acts);
            let count = elements.filter(|(element, acts)| **acts && element.law.kind == kind).count();
            (count > 0).then(|| count_of(count, kind.keyword, kind.plural))
        };
        let counts: Vec<String> = KINDS.iter().filter_map(|kind| of(kind)).collect();
        if !counts.is_empty() {
            self.keep(enumeration(&counts, "and"), "their ends move relative to each other");
        }
    }

    fn why_idle(&self, element: &Element, between: &mut EndPath<Number>) -> &'static str {
        let [a, b] = [0, 1].map(|end| self.kinematics.end(&element.ends[end]).piece);
        between.set_ends(self.kinematics, &element.ends, &element.law.geometry);
        match () {
            () if element.law.is_zero() => "its value is zero",
            () if a == b => "both ends are on one rigid piece",
            () if between.path.is_empty() && between.angles == [None; 2] => {
                "its ends cannot move relative to each other"
            }
            () => "no motion stretches it, and it has no tension",
        }
    }

    fn inputs_and_outputs(&mut self) {
        let mut stiffens = vec![false; self.scene.inputs.len()];
        for origin in origins(&self.system.k) {
            if let Origin::Input(input) = origin {
                stiffens[input as usize] = true;
            }
        }
        for ((declared, input), stiffens) in self.scene.inputs.iter().zip(&self.system.inputs).zip(stiffens) {
            if input.b.iter().all(Vec::is_empty) {
                let name = self.system.display(input.name);
                if stiffens || loads::displaces_a_base(self.scene, declared) {
                    self.keep(name, "it drives no motion, but its constant part loads the rest");
                    continue;
                }
                let why = match declared.kind {
                    InputKind::Base { .. } => "nothing that moves is attached to this motion",
                    _ => "it does no work in any motion of the scene",
                };
                self.leave_out(name, why);
            }
        }
        for output in &self.system.outputs {
            if output.p.iter().all(Vec::is_empty) && output.d.iter().all(Vec::is_empty) {
                self.leave_out(self.system.display(output.name), "it is zero in every motion of the scene");
            }
        }
    }
}

/// The origins of the terms of a form.
fn origins(form: &Form) -> impl Iterator<Item = Origin> {
    form.terms().map(|term| form.source_of(term.source).origin)
}

fn count_of(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
