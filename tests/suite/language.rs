//! Parsing, names and units, limits.
