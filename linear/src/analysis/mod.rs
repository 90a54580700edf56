//! Analyses of a linear system: modes, poles, transfer functions, motions, and the stability that follows from them.
//! Each answer carries its error bound and the route that found it. Nothing here depends on the language or the scene.
//! See docs/method/modes.md, docs/method/poles.md, docs/method/transfer.md and docs/method/response.md.

pub mod accuracy;
pub mod answer;
pub mod damped_shapes;
pub mod damping;
pub mod derived;
pub mod discrete;
pub mod error;
pub mod excitation;
mod following;
mod forms;
pub mod fractions;
mod largest;
pub mod measures;
pub mod modal;
pub mod modes;
pub mod nets;
pub mod peak;
mod poles;
pub mod projection;
pub mod random;
pub mod range;
pub mod rates;
pub mod response;
pub mod response_spectrum;
pub mod settling;
pub mod shock;
mod stability;
pub mod steady;
#[cfg(test)]
pub mod test_systems;
pub mod transfer;

pub use crate::system::Signal;
pub use accuracy::shortfall;
pub use answer::{Before, Mode, ModeKind, Modes, Pole, PoleKind, Poles, Route, Share};
pub use damped_shapes::{DampedShape, ShapeEntries, damped_shapes};
pub use discrete::{DiscreteSystem, discretise};
pub use error::AnalysisError;
pub use excitation::{Excitation, Excitations};
pub use measures::Measurement;
pub use modal::{Modal, modal, modal_by_ratio, modal_from, takes_chained};
pub use modes::buckling::{Buckling, buckling};
pub use modes::parts::separate;
pub use modes::parts::{joined_by, undamped_block};
pub use modes::request::{Band, Request, Which};
pub use modes::shape::{Normalise, normalise};
pub use modes::splits::{Split, splits};
pub use modes::{all_modes, modes, modes_as};
pub use nets::{Net, NetForm, nets, parts_of_modes};
pub use poles::count::PoleCount;
pub use poles::feedback::{Feedback, WeighedRow};
pub use poles::poles;
pub use poles::residues::Residues;
pub use random::{Noisy, Peak, Spread};
pub use response::{History, MOST_SAMPLES, grid, refuse_too_many, respond, respond_with, samples};
pub use stability::is_passive;
pub use stability::{Reason, Stability, Verdict, stability};
pub use steady::{Steady, steady, steady_alone};
pub use transfer::extrema::{Extrema, Extremum, FeatureKind};
pub use transfer::modal::{ModalPair, ModalSum};
pub use transfer::table::{Methods, Row, Sweep, Table, modes_of_many, poles_for_table, table, table_around};
pub use transfer::{Disc, Frequency, Gain, Transfer, table_findings};
