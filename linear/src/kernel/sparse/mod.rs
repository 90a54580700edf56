//! Sparse symmetric matrices: the order of elimination and factors in binary64 and in floats of many bits.

pub mod ldl;
pub mod order;
pub mod tree;
pub mod wide;
