//! The program `vibc`.

fn main() {}
