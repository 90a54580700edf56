//! Arithmetic and linear algebra that the stages share: numbers of two and three words with their error bounds, complex
//! numbers, polynomials, dense and sparse elimination, and loops over wide registers. Nothing here depends on a
//! mechanical system. docs/method/kernel.md says which of them to use.

pub mod big_float;
pub mod binomial;
pub mod bounded;
pub mod complex;
pub mod cores;
pub mod dense;
pub mod disc;
pub mod lanes;
pub mod low_rank;
pub mod normal;
pub mod pairwise;
pub mod pencils;
pub mod philox;
pub mod polynomial;
pub mod precise;
pub mod pseudosymmetric;
pub mod rank_one;
pub mod real;
pub mod residues;
pub mod secular;
pub mod simd;
pub mod sobol;
pub mod sparse;
pub mod squares;
pub mod sturm;
pub mod symmetric;
pub mod triple;
