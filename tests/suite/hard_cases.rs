//! The certified hard cases of tests/hardcases.
