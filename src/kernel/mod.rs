//! Arithmetic and linear algebra that the stages share: numbers of two and three words with their error bounds, complex
//! numbers, polynomials, dense and sparse elimination, and loops over wide registers. Nothing here depends on a
//! mechanical system. docs/method/kernel.md says which of them to use.

pub(crate) mod big_float;
pub(crate) mod binomial;
pub mod bounded;
pub mod complex;
pub(crate) mod cores;
pub mod dense;
pub mod disc;
pub(crate) mod lanes;
pub mod low_rank;
pub(crate) mod normal;
pub(crate) mod pairwise;
pub mod pencils;
pub(crate) mod philox;
pub(crate) mod polynomial;
pub(crate) mod precise;
pub(crate) mod pseudosymmetric;
pub mod rank_one;
pub mod real;
pub(crate) mod residues;
pub mod secular;
pub(crate) mod simd;
pub(crate) mod sobol;
pub mod sparse;
pub(crate) mod squares;
pub(crate) mod sturm;
pub mod symmetric;
pub(crate) mod triple;
