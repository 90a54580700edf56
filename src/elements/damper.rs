//! A damper: force c de/dt of a stretch e. At rest it does nothing, so it adds C = c (grad e)(grad e)^T and no stiffness.
//! See docs/method/linearisation.md.

use super::Stretch;

#[derive(Clone, Debug)]
pub struct Damper<S> {
    pub stretch: Stretch<S>,
    /// N s/m or N m s/rad.
    pub damping: S,
}
