//! One file a kind of element: what it adds to energy, dissipation and load, and its first and second derivatives.
//! Clause: spec.md, "Linearisation".
