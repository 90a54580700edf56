//! Limits on the size of a model. See spec.md#limits.

/// Bytes of a file. Spans hold 32-bit positions; a network of a million bodies written out in full takes some 100 MiB.
pub const FILE: usize = 256 << 20;

/// Bytes of a declaration, not counting the body of a `repeat`: no offset within it exceeds `Span::MAX_LEN`.
pub const DECLARATION: usize = 1 << 20;

/// Levels of brackets in a declaration. pest and the code that reads the tree recurse once per level.
pub const BRACKETS: usize = 64;

/// Levels of `repeat`; a name has at most three indices, so deeper ones are of little use.
pub const REPEATS: usize = 8;

/// Levels of operators, calls and members of one expression: `a + b + c` has three. Code that reads the tree recurses
/// over them.
pub const EXPRESSION_DEPTH: u16 = 256;

/// Bytes of a word.
pub const WORD: usize = 255;

/// Bytes of a number without its unit.
pub const NUMBER: usize = 1000;

/// Errors reported one by one; any others are counted.
pub const ERRORS: usize = 100;

/// Total number of bytes in all tables of a model.
pub const TABLES: usize = 64 << 20;

/// Total number of bytes in all files that a model uses for their components.
pub const USED: usize = 16 << 20;
