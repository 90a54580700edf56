//! The native half of the Python package: a model, and its numbers as NumPy arrays. Arrays are moved into NumPy, not copied, and
//! other Python threads run while something is computed.
//!
//! Nothing is raised for a model that is wrong: each call returns its answer or `None`, then the findings as JSON and as they are
//! drawn. The other half, `vibc/`, makes exceptions and warnings of them.

#[path = "../../src/named.rs"]
mod named;

mod analysis;
mod model;
mod sweep;

use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray2};
use pyo3::prelude::*;
use vibc::{Ball, Diagnostic, HumanStyle, Rounded, Sources};

/// An answer if there is one, the findings as JSON, one object a line, and as they are drawn.
type Told<T> = (Option<T>, String, String);

fn told<T>(answer: Option<T>, sources: &Sources, findings: &[Diagnostic]) -> Told<T> {
    if findings.is_empty() {
        return (answer, String::new(), String::new());
    }
    let drawn = vibc::diagnostics_text(sources, findings, HumanStyle::default());
    (answer, vibc::diagnostics_json(sources, findings), drawn)
}

/// The number that the program prints for an enclosed one; NaN where it prints `null`.
fn printed(value: Option<Ball>) -> f64 {
    value.and_then(Rounded::of).map_or(f64::NAN, Rounded::value)
}

/// Numbers row by row as an array, without a copy.
fn rows<T: numpy::Element>(py: Python<'_>, shape: (usize, usize), numbers: Vec<T>) -> Bound<'_, PyArray2<T>> {
    Array2::from_shape_vec(shape, numbers).expect("as many numbers as the shape has").into_pyarray(py)
}

#[pymodule]
mod _vibc {
    #[pymodule_export]
    use crate::analysis::Analysis;
    #[pymodule_export]
    use crate::model::{Model, read};
}
