//! The unit table and the reading of unit expressions such as `N*s/m`. Clause: spec.md, "Units".
