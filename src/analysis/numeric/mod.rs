//! Arithmetic and dense linear algebra that the analyses share: numbers of two and three words, complex numbers,
//! matrices. Nothing here depends on a system.

pub(in crate::analysis) mod big_float;
pub mod complex;
pub mod dense;
pub mod divide;
pub(in crate::analysis) mod enclosure;
pub(in crate::analysis) mod fused;
pub(in crate::analysis) mod inverse_factor;
pub(in crate::analysis) mod jacobi;
pub(in crate::analysis) mod pairwise;
pub(in crate::analysis) mod pivoted_qr;
pub(in crate::analysis) mod polynomial;
pub(in crate::analysis) mod precise;
pub(in crate::analysis) mod product;
pub(in crate::analysis) mod residues;
pub(in crate::analysis) mod secular;
pub(in crate::analysis) mod sturm;
pub mod symmetric;
pub(in crate::analysis) mod tridiagonal;
pub(in crate::analysis) mod triple;
pub(in crate::analysis) mod wide;
