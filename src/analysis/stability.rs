//! What modes and poles say about the rest: unstable if anything certainly grows; undetermined if something may grow and
//! nothing tells; neutral if a rigid motion is left; stable otherwise. In: the certified answers. Out: the verdict.
//! Clause: spec.md 11.8.

use crate::analysis::answer::{ModeKind, Modes, PoleKind, Poles, Stability};

/// The verdict. A kind is certain or it is `Undetermined`, so no verdict rests on the midpoint of an enclosure.
pub fn stability(modes: &Modes, poles: &Poles) -> Stability {
    let pole = |is: fn(PoleKind) -> bool| poles.list.iter().any(|pole| is(pole.kind));
    let mode = |kind: ModeKind| modes.before.has(kind) || modes.list.iter().any(|mode| mode.kind == kind);
    // With M > 0 and C >= 0 there are as many growing poles as negative omega^2 (Chetaev); with C of any sign the poles tell.
    if pole(|kind| matches!(kind, PoleKind::Divergence | PoleKind::Flutter)) || mode(ModeKind::Divergence) {
        return Stability::Unstable;
    }
    if pole(|kind| kind == PoleKind::Undetermined) || mode(ModeKind::Undetermined) {
        return Stability::Undetermined;
    }
    // A rigid motion has a pole at zero, whatever damps it.
    if pole(|kind| kind == PoleKind::Rigid) || poles.left_out > 0 && mode(ModeKind::Rigid) {
        return Stability::Neutral;
    }
    Stability::Stable
}
