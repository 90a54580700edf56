//! Linear system to answers: modes, poles, and what they say about stability. Each answer carries its error bound and the
//! route that found it. Nothing here knows the language or the scene. Clause: spec.md, "Modes" and "Poles".

mod aberth;
pub mod answer;
mod buckling;
mod certificate;
mod companion;
pub mod complex;
mod condense;
mod correction;
pub mod dense;
mod discs;
mod eigen;
mod enclosure;
pub mod error;
mod exponential;
mod gram;
mod jacobi;
mod mass;
pub mod modes;
mod parts;
mod pencil;
mod pivoted_qr;
mod pole_proportional;
mod pole_quadratic;
mod pole_rigid;
mod poles;
mod propagator;
mod refinement;
mod residues;
pub mod response;
pub mod shape;
pub mod signal;
pub mod squares;
mod stability;
mod star_mesh;
mod start;
mod structure;
mod terms;
#[cfg(test)]
mod test_systems;
pub mod transfer;
mod transfer_exact;
mod transfer_inverse;
pub mod transfer_table;
mod triple;

pub use answer::{Mode, ModeKind, Modes, Pole, PoleKind, Poles, Route, Share, Stability};
pub use buckling::{Buckling, buckling};
pub use error::AnalysisError;
pub use modes::modes;
pub use poles::poles;
pub use response::{History, grid, respond};
pub use shape::{Normalise, normalise};
pub use signal::Signal;
pub use stability::stability;
pub use transfer::{Disc, Frequency, Gain, Transfer};
pub use transfer_table::{Feature, FeatureKind, Row, Sweep, Table, table};
