//! What may import what.
