//! What modes and poles say about the rest: unstable if anything grows, neutral if a rigid motion is left, stable otherwise.
//! In: the certified answers. Out: the verdict. Clause: spec.md 11.8.

use crate::analysis::answer::{ModeKind, Modes, PoleKind, Poles, Stability};

/// The verdict. A kind is certain where its number is; what could not be certified counts as the kind that it was given.
pub fn stability(modes: &Modes, poles: &Poles) -> Stability {
    let grows = |kind: PoleKind| matches!(kind, PoleKind::Divergence | PoleKind::Flutter);
    // With M > 0 and C >= 0 there are as many growing poles as negative omega^2 (Chetaev); with C of any sign the poles tell.
    if poles.list.iter().any(|pole| grows(pole.kind)) || modes.list.iter().any(|mode| mode.kind == ModeKind::Divergence)
    {
        return Stability::Unstable;
    }
    if poles.list.iter().any(|pole| pole.kind == PoleKind::Rigid) {
        return Stability::Neutral;
    }
    Stability::Stable
}
