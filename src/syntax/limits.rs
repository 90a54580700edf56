//! How large a model file may be. See spec.md#limits.

/// Bytes of a file. Spans hold 32-bit places; a net of a million bodies written out in full has some 100 MiB.
pub const FILE: usize = 256 << 20;

/// Bytes of a declaration without the body of a `repeat`: no place in one is beyond `Span::MAX_LEN`.
pub const DECLARATION: usize = 1 << 20;

/// Levels of brackets in a declaration. pest and the tree's readers recurse once a level.
pub const BRACKETS: usize = 64;

/// Levels of `repeat`; a name has at most three indices, so deeper ones are of little use.
pub const REPEATS: usize = 8;

/// Levels of operators, calls and members of one expression: `a + b + c` has three. What reads the tree recurses over it.
pub const EXPRESSION_DEPTH: u16 = 256;

/// Bytes of a word.
pub const WORD: usize = 255;

/// Bytes of a number without its unit.
pub const NUMBER: usize = 1000;

/// Errors told one by one.
pub const ERRORS: usize = 100;

/// Bytes of all tables of a model together.
pub const TABLES: usize = 64 << 20;
