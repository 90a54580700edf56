//! A small computer algebra: sums of products of names, sines, cosines and roots over exact numbers, in a canonical
//! form that decides equality.
//!
//! - A [`Sum`] is a polynomial with rational coefficients. Two sums that are equal as polynomials in names, sines and
//!   cosines (with sin^2 + cos^2 = 1) and square roots are the same value.
//! - A product contains at most one sine or cosine: products of two become sums (Werner's formulas), so `cos(a - b)`
//!   appears where a textbook writes it.
//! - Divisors stay whole; [`Sum::vanishes`] clears denominators before it decides.
//!
//! The module knows no mechanics. Numbers are those of `base`, so a value has an enclosure.

mod derivative;
mod factors;
mod powers;
mod product;
mod root;
mod sum;
mod trigonometry;
mod value;

pub use derivative::{Dependence, Lengths};
pub use factors::{Factored, common_factors};
pub use powers::{Power, Powers};
pub use product::{Factor, Function, Product};
pub use sum::Sum;

/// A name, by its place in a table that its owner keeps. Its order is the order of factors: the class first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Symbol(u32);

/// Bits for the place within a class.
const PLACE_BITS: u32 = 24;

impl Symbol {
    /// The greatest place.
    pub const LAST: usize = (1 << PLACE_BITS) - 1;

    pub fn new(class: u8, place: usize) -> Symbol {
        let place = u32::try_from(place).unwrap_or(u32::MAX).min(Symbol::LAST as u32);
        Symbol(u32::from(class) << PLACE_BITS | place)
    }

    pub fn class(self) -> u8 {
        (self.0 >> PLACE_BITS) as u8
    }

    pub fn place(self) -> usize {
        (self.0 & ((1 << PLACE_BITS) - 1)) as usize
    }
}

#[cfg(test)]
mod tests;
