//! Linear system to answers: modes, poles, and what they say about stability. Each answer carries its error bound and the
//! route that found it. Nothing here knows the language or the scene. Clause: spec.md, "Modes" and "Poles".

mod aberth;
pub mod answer;
mod big_float;
mod buckling;
mod certificate;
mod companion;
pub mod complex;
mod condense;
mod correction;
pub mod damping;
pub mod dense;
mod disc_columns;
mod discs;
mod eigen;
mod enclosure;
pub mod error;
mod forest;
mod exponential;
mod gram;
mod jacobi;
mod lanes;
mod mass;
pub mod measures;
pub mod modes;
mod pairwise;
mod parts;
mod pencil;
mod pivoted_qr;
mod pole_exact;
mod pole_list;
mod pole_proportional;
mod pole_quadratic;
mod pole_rigid;
mod poles;
mod polynomial;
mod precise;
mod propagator;
mod refinement;
pub mod request;
mod residues;
pub mod response;
pub mod shape;
pub mod signal;
mod sparse;
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
mod transfer_modal;
mod transfer_sparse;
pub mod transfer_table;
mod tree_modes;
mod triple;

pub use crate::system::Signal;
pub use answer::{Mode, ModeKind, Modes, Pole, PoleKind, Poles, Route, Share, Stability};
pub use buckling::{Buckling, buckling};
pub use error::AnalysisError;
<<<<<<< HEAD
pub use measures::Measurement;
pub use modes::modes;
=======
pub use modes::{modes, modes_as};
>>>>>>> 85aaaf7 (The lowest modes of large trees, and a request for modes and accuracy)
pub use poles::poles;
pub use response::{History, grid, respond};
pub use request::{Request, Which};
pub use shape::{Normalise, normalise};
pub use stability::stability;
pub use transfer::{Disc, Frequency, Gain, Transfer};
pub use transfer_modal::{ModalPair, ModalSum};
pub use transfer_table::{Feature, FeatureKind, Roads, Row, Sweep, Table, table};
