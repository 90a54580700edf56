//! Models in, scenes and findings out: each test is the smallest model that shows its case.

use super::scene::*;
use super::*;
use crate::base::{Number, SourceFile};
use crate::syntax;

/// The findings of a model, each as `code: message [label] (help)`.
fn findings(checked: &Checked) -> Vec<String> {
    let shown = |d: &crate::base::Diagnostic| {
        format!("{}: {} [{}] ({})", d.code, d.message, d.primary.text, d.help.as_deref().unwrap_or(""))
    };
    checked.diagnostics.clone().sorted().iter().map(shown).collect()
}

fn checked(text: &str) -> Checked {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("scene.vib", text));
    let parsed = syntax::parse(&sources, file);
    assert!(parsed.errors.is_empty(), "{:?}", parsed.errors);
    check(&sources, &parsed.tree, &Overrides::default())
}

/// The scene of a model without errors.
fn scene(text: &str) -> Scene {
    let checked = checked(text);
    let findings = findings(&checked);
    checked.scene.unwrap_or_else(|| panic!("{findings:#?}")).scene
}

#[test]
fn the_cart_is_resolved() {
    let scene = scene(include_str!("../../examples/cart.vib"));
    assert_eq!(scene.name, "cart");
    assert_eq!(scene.bodies.len(), 2);
    let rod = &scene.bodies[1];
    assert_eq!(rod.inertia, Some(Number::from(crate::base::Rational::new(1, 6))));
    assert_eq!(rod.centre.as_deref(), Some(&Vec3::planar(Number::ZERO, Number::from(-1))));
    assert_eq!(rod.freedom, Freedom::FromJoints);
    assert!(matches!(&scene.joints[0].kind, JointKind::Pivot { at } if at.is_zero()));
    assert_eq!(scene.elements[0].geometry, Geometry::Line);
    assert_eq!(scene.gravity, Vec3::planar(Number::ZERO, -&Number::from("9.81")));
    assert_eq!((scene.inputs.len(), scene.outputs.len()), (1, 2));
    assert!(scene.outputs[1].is_angle);
}
