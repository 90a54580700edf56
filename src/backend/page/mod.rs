//! The report as a page: one HTML file with the moving figure, the report's tables, the curves and the model's text. It
//! needs no network and no other file, and its security policy allows only its own script. See docs/report.md.
//!
//! Its words and tables are the report of `answers::report`; the data that the script animates and draws are the
//! payload.

mod html;
mod payload;
mod tables;

pub use html::{modal_table, page};

use crate::analysis::fractions::{Curve, Pencil};
use crate::analysis::{History, Table};
use crate::answers::report::Report;
use crate::base::{Diagnostic, FileId, Sources, Span};
use crate::kernel::complex::Complex;
use crate::lower::Displacement;
use crate::picture::{Figure, Item, Moving};
use crate::questions::answer::Sensitivity;
use crate::system::LinearSystem;

/// The text that numbers, glyphs and findings link to.
#[derive(Clone, Copy)]
pub struct Text<'a> {
    pub sources: &'a Sources,
    pub model: FileId,
}

/// The contents of a page.
pub struct Page<'a> {
    /// The model's name.
    pub name: &'a str,
    /// The text that the answers belong to.
    pub of: Text<'a>,
    /// The text that the findings belong to: a newer text if that has errors.
    pub text: Text<'a>,
    /// The text is shown, which an editor does by itself.
    pub shows_text: bool,
    pub findings: &'a [Diagnostic],
    /// The version that is served, if the page asks its server for newer ones.
    pub version: Option<u64>,
    pub answers: Option<Answers<'a>>,
}

/// The answers for a model without errors.
pub struct Answers<'a> {
    pub system: &'a LinearSystem,
    /// The figure, or the reason why there is none.
    pub figure: Result<&'a (Figure, Moving), &'a str>,
    pub movements: &'a Movements,
    pub report: &'a Report,
    /// The declarations behind the entries of M, C and K, row by row.
    pub entries: &'a [Vec<Vec<Option<Span>>>],
    /// Sections with MathML, as `backend::equations` makes them.
    pub equations: Option<&'a str>,
    pub poles: &'a [PoleShown],
    pub transfer: Option<&'a TransferShown>,
    pub motion: Option<&'a MotionShown>,
    pub sensitivities: &'a [Sensitivity],
}

/// The possible motions of a figure.
#[derive(Clone, Debug, Default)]
pub struct Movements {
    /// For each coordinate, the motion of the pieces per metre or radian of it, in the order of
    /// [`Poses::values`](crate::lower::Poses::values).
    pub basis: Vec<Vec<Displacement>>,
    /// The second-order motion due to joints that close loops.
    pub bends: Vec<Bend>,
    pub list: Vec<Movement>,
}

/// The contribution of the product of two coordinates to the values of pieces, in the same order.
#[derive(Clone, Debug)]
pub struct Bend {
    pub by: [usize; 2],
    pub values: Vec<f64>,
}

/// A mode, or the motion of a pole.
#[derive(Clone, Debug)]
pub struct Movement {
    /// `mode 2: 0.5964 Hz (3.747 rad/s)`
    pub caption: String,
    /// The motion is proportional to exp(s t).
    pub s: Complex<f64>,
    /// The coordinates, m and rad.
    pub shape: Vec<Complex<f64>>,
    /// The factor by which the shape is multiplied.
    pub amount: f64,
    /// Shares of the kinetic energy of bodies and of the strain energy of elements.
    pub energy: Vec<(Item, f64)>,
}

/// A pole in its plane.
#[derive(Clone, Debug)]
pub struct PoleShown {
    pub s: Complex<f64>,
    pub title: String,
    /// Its place among the movements.
    pub movement: Option<usize>,
}

/// Transfer functions as tables and as curves.
#[derive(Clone, Debug)]
pub struct TransferShown {
    pub table: Table,
    /// `[input][output]`; `None` if only the rows of the table are known.
    pub curves: Vec<Vec<Option<Curve>>>,
    /// The matrices, if a curve needs them.
    pub pencil: Option<Pencil>,
    /// A report for each pair, input by input.
    pub reports: Vec<Report>,
    /// Frequencies at which the curves bend, Hz.
    pub centres: Vec<f64>,
}

/// The motion in time.
#[derive(Clone, Debug)]
pub struct MotionShown {
    pub history: History,
    /// The coordinates at the same times.
    pub states: Vec<Vec<f64>>,
    pub amount: f64,
    pub report: Report,
}
