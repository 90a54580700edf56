//! The modal analysis of a model: modes, poles and what is printed of them.

use crate::{printed, rows};
use numpy::{Complex64, PyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use vibc::{ModalAnswer, Mode, Normalise, Pole, ReportOptions, Share, Source};

/// Modes and poles, computed once.
#[pyclass(frozen, module = "vibc._vibc")]
pub struct Analysis(pub ModalAnswer);

fn normalisation(name: &str) -> PyResult<Normalise> {
    Ok(match name {
        "translation" => Normalise::Translation,
        "max" => Normalise::Max,
        "first" => Normalise::First,
        "mass" => Normalise::Mass,
        _ => return Err(PyValueError::new_err("normalise is \"translation\", \"max\", \"first\" or \"mass\"")),
    })
}

impl Analysis {
    /// A bound, which at a rest that is not proven is none.
    pub fn proven(&self, bound: vibc::Bound) -> f64 {
        if self.0.rest.is_proven() { bound.value() } else { f64::INFINITY }
    }

    fn shares(&self, shares: &[Share<Source>]) -> Vec<(String, f64)> {
        shares.iter().map(|share| (self.0.system.display(share.of), share.part.0 + 0.0)).collect()
    }
}

#[pymethods]
impl Analysis {
    /// The modes that were computed, by the names of the fields of `vibc.Modes`; the shapes are modes by coordinates.
    fn modes<'py>(&self, py: Python<'py>, normalise: &str) -> PyResult<Bound<'py, PyDict>> {
        let answer = &self.0;
        let (normalise, list) = (normalisation(normalise)?, &answer.modes.list);
        let column = |of: &dyn Fn(&Mode) -> f64| PyArray1::from_vec(py, list.iter().map(of).collect());
        let shapes = py.detach(|| {
            let of_mode = |mode| vibc::normalise(mode, normalise).into_iter().map(|shown| shown.0 + 0.0);
            list.iter().flat_map(of_mode).collect::<Vec<f64>>()
        });
        let found = PyDict::new(py);
        found.set_item("number", answer.modes.with_numbers().map(|(number, _)| number).collect::<Vec<_>>())?;
        found.set_item("kind", list.iter().map(|mode| mode.kind.name()).collect::<Vec<_>>())?;
        found.set_item("omega", column(&|mode| printed(mode.angular_frequency())))?;
        found.set_item("frequency", column(&|mode| printed(mode.frequency())))?;
        found.set_item("growth_rate", column(&|mode| printed(mode.growth_rate())))?;
        found.set_item("bound", column(&|mode| self.proven(mode.error_bound())))?;
        found.set_item("shapes", rows(py, (list.len(), answer.system.n()), shapes))?;
        let energies =
            list.iter().map(|mode| (self.shares(&mode.kinetic), self.shares(&vibc::shares_by_name(&mode.strain))));
        found.set_item("energies", energies.collect::<Vec<_>>())?;
        found.set_item("cluster", list.iter().map(|mode| mode.cluster).collect::<Vec<_>>())?;
        found.set_item("below", answer.modes.before.count())?;
        found.set_item("above", answer.modes.after)?;
        found.set_item("infinite", answer.modes.infinite)?;
        Ok(found)
    }

    /// The poles that were computed, by the names of the fields of `vibc.Poles`.
    fn poles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let poles = &self.0.poles;
        let column = |of: &dyn Fn(&Pole) -> f64| PyArray1::from_vec(py, poles.list.iter().map(of).collect());
        let value = |pole: &Pole| Complex64::new(printed(Some(pole.re)), printed(Some(pole.im)));
        let ratio_bound =
            |pole: &Pole| self.proven(pole.damping_ratio.map_or(vibc::Bound::UNKNOWN, vibc::Bound::relative));
        let found = PyDict::new(py);
        found.set_item("values", PyArray1::from_vec(py, poles.list.iter().map(value).collect()))?;
        found.set_item("bound", column(&|pole| self.proven(pole.error_bound())))?;
        found.set_item("omega", column(&|pole| printed(Some(pole.modulus()))))?;
        found.set_item("frequency", column(&|pole| printed(Some(pole.frequency()))))?;
        found.set_item("damped_frequency", column(&|pole| printed(Some(pole.damped_frequency()))))?;
        found.set_item("damping_ratio", column(&|pole| printed(pole.damping_ratio)))?;
        found.set_item("damping_ratio_bound", column(&ratio_bound))?;
        found.set_item("kind", poles.list.iter().map(|pole| pole.kind.name()).collect::<Vec<_>>())?;
        found.set_item("cluster", poles.list.iter().map(|pole| pole.cluster).collect::<Vec<_>>())?;
        found.set_item("defective", poles.list.iter().map(|pole| pole.defective).collect::<Vec<_>>())?;
        found.set_item("left_out", poles.left_out)?;
        found.set_item("complete", poles.is_complete())?;
        Ok(found)
    }

    /// The verdict on the rest, and what the report says that is not proved.
    fn verdict(&self) -> (&'static str, Vec<&'static str>) {
        (self.0.stability.kind().name(), self.0.not_proved().collect())
    }

    /// The tables of modes and poles as HTML.
    fn table(&self) -> String {
        vibc::modal_table(&self.0, &ReportOptions::default())
    }
}
