//! Sparse symmetric matrices: the order of elimination and factors in binary64.

pub mod ldl;
pub mod order;
pub mod tree;
