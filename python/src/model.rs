//! A model as it was read: its linear system, and what is computed from it on request.

use crate::analysis::Analysis;
use crate::named::{add_named, read_limited};
use crate::sweep::{Asked, Heading, table};
use crate::{Told, printed, rows, told};
use numpy::{Complex64, PyArray1, PyArray2};
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use vibc::{
    Ball, CoordinateId, CoordinateKind, Dynamics, FigureOptions, FileId, Form, Frequency, Gain, Input, LinearSystem,
    Literals, Methods, Number, Outcome, Output, Overrides, Rational, Request, SourceFile, SourceKind, Sources, Study,
    StudyRequest, Sweep, Which,
};

/// The texts of a model and its linear system.
#[pyclass(frozen, module = "vibc._vibc")]
pub struct Model {
    pub sources: Sources,
    pub file: FileId,
    pub overrides: Overrides,
    #[pyo3(get)]
    name: String,
    system: LinearSystem,
    /// The basis of transfer functions, once one was asked for.
    dynamics: OnceLock<Outcome<Dynamics>>,
}

/// A sparse row or column of the system.
type Line = [Vec<(CoordinateId, Number)>; 3];

/// Reads a model from the file at `path`, or from `text` with `path` as its name. `settings`: parameters and their values as a
/// model writes them.
#[pyfunction]
#[pyo3(signature = (path, text, settings, root, binary64))]
pub fn read(
    py: Python<'_>,
    path: PathBuf,
    text: Option<String>,
    settings: Vec<(String, String)>,
    root: Option<PathBuf>,
    binary64: bool,
) -> PyResult<Told<Model>> {
    let name = path.to_string_lossy().into_owned();
    let file = match text {
        Some(text) => SourceFile::model(name, text),
        None => {
            let bytes = py.detach(|| File::open(&path).and_then(read_limited));
            let bytes = bytes.map_err(|error| unreadable(&path, &error))?;
            SourceFile::decode(SourceKind::Model, name, bytes)
        }
    };
    Ok(py.detach(|| {
        let mut sources = Sources::new();
        let file = sources.add(file);
        let lines: String = settings.iter().map(|(name, value)| format!("{name}={value}\n")).collect();
        let arguments = SourceFile { kind: SourceKind::Arguments, ..SourceFile::model("parameters", lines) };
        let arguments = (!settings.is_empty()).then(|| sources.add(arguments));
        let outside = "it lies outside the model's folder; `root=` allows another";
        add_named(&mut sources, file, &path, root.as_deref(), outside);
        let literals = if binary64 { Literals::Binary64 } else { Literals::Decimal };
        let overrides = Overrides { arguments, literals, ..Overrides::default() };
        let Outcome { answer, diagnostics } = vibc::linear(&sources, file, &overrides);
        let (_, json, drawn) = told::<()>(None, &sources, &diagnostics);
        let model =
            answer.map(|(name, system)| Model { sources, file, overrides, name, system, dynamics: OnceLock::new() });
        (model, json, drawn)
    }))
}

/// The exception that Python itself would raise for the file.
fn unreadable(path: &Path, error: &io::Error) -> PyErr {
    let text = error.to_string();
    match error.raw_os_error() {
        // Python shows the number itself.
        Some(number) => {
            let text = text.trim_end_matches(&format!(" (os error {number})")).to_string();
            PyOSError::new_err((number, text, path.to_path_buf()))
        }
        None => PyOSError::new_err(format!("{}: {error}", path.display())),
    }
}

impl Model {
    /// A Python float as the decimal that Python prints for it, as a model's literals are read; with binary64 literals as the
    /// number that it is.
    fn number(&self, x: f64) -> PyResult<Number> {
        let read = match self.overrides.literals {
            Literals::Decimal => {
                Rational::from_decimal(&format!("{:e}", x.abs())).map(|size| if x < 0.0 { -&size } else { size })
            }
            Literals::Binary64 => Rational::from_f64(x),
        };
        read.map(Number::from).ok_or_else(|| PyValueError::new_err(format!("{x} is not a number to compute with")))
    }

    fn time(&self, what: &str, x: f64) -> PyResult<Number> {
        let time = self.number(x)?;
        match time.is_positive() {
            true => Ok(time),
            false => Err(PyValueError::new_err(format!("{what} is a time greater than zero, in s"))),
        }
    }
}

#[pymethods]
impl Model {
    /// Names and units of the coordinates.
    fn coordinates(&self) -> Vec<(String, &'static str)> {
        let unit = |kind| if kind == CoordinateKind::Rotation { "rad" } else { "m" };
        let kinds = self.system.coordinates.iter().map(|coordinate| unit(coordinate.kind));
        self.system.coordinate_names().into_iter().zip(kinds).collect()
    }

    /// Names of the parameters, with the units of their values in SI.
    fn units(&self) -> Vec<(String, String)> {
        StudyRequest::units(&self.sources, self.file, &self.overrides)
    }

    /// Names and units of the inputs.
    fn inputs(&self) -> Vec<(String, &'static str)> {
        self.system.inputs.iter().map(|input| (self.system.display(input.name), input.unit)).collect()
    }

    /// Names and units of the outputs.
    fn outputs(&self) -> Vec<(String, String)> {
        self.system.outputs.iter().map(|output| (self.system.display(output.name), output.unit.clone())).collect()
    }

    /// M, C and K.
    fn matrices<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray2<f64>>; 3] {
        let n = self.system.n();
        let assembled = |form: &Form| -> Vec<f64> {
            form.assemble(n).into_iter().flatten().map(|entry: Ball| printed(Some(entry))).collect()
        };
        let all = py.detach(|| [&self.system.m, &self.system.c, &self.system.k].map(assembled));
        all.map(|matrix| rows(py, (n, n), matrix))
    }

    /// The factors of u, u' and u'' in the forces, coordinates by inputs; of q, q' and q'' in the outputs, outputs by coordinates;
    /// of u, u' and u'' in the outputs, outputs by inputs.
    #[allow(clippy::type_complexity)]
    fn ports<'py>(
        &self,
        py: Python<'py>,
    ) -> ([Bound<'py, PyArray2<f64>>; 3], [Bound<'py, PyArray2<f64>>; 3], [Bound<'py, PyArray2<f64>>; 3]) {
        let LinearSystem { inputs, outputs, .. } = &self.system;
        let n = self.system.n();
        let of = |lines: &mut dyn Iterator<Item = &Line>, order: usize| -> Vec<f64> {
            let mut all = Vec::new();
            for line in lines {
                let start = all.len();
                all.resize(start + n, 0.0);
                line[order].iter().for_each(|(i, x)| all[start + i.index()] += printed(Some(x.to_ball())));
            }
            all
        };
        let b = [0, 1, 2].map(|order| of(&mut inputs.iter().map(|input: &Input| &input.b), order));
        let p = [0, 1, 2].map(|order| of(&mut outputs.iter().map(|output: &Output| &output.p), order));
        let d = [0, 1, 2].map(|order: usize| {
            let mut all = vec![0.0; outputs.len() * inputs.len()];
            for (o, output) in outputs.iter().enumerate() {
                let row = &mut all[o * inputs.len()..][..inputs.len()];
                output.d[order].iter().for_each(|(u, x)| row[*u as usize] += printed(Some(x.to_ball())));
            }
            all
        });
        (
            b.map(|list| rows(py, (inputs.len(), n), list)),
            p.map(|list| rows(py, (outputs.len(), n), list)),
            d.map(|list| rows(py, (outputs.len(), inputs.len()), list)),
        )
    }

    /// Absolute bounds of the entries of M, C and K, of the least accurate entry each.
    fn matrix_bounds(&self, py: Python<'_>, analysis: &Analysis) -> (f64, f64, f64) {
        let bound = |form: &Form| {
            let entries = form.assemble(self.system.n()).into_iter().flatten();
            analysis.proven(entries.map(vibc::Bound::absolute).fold(vibc::Bound::ZERO, vibc::Bound::or_larger))
        };
        py.detach(|| (bound(&self.system.m), bound(&self.system.c), bound(&self.system.k)))
    }

    /// Modes and poles: the lowest `count` modes, or the usual number for the size of the model.
    #[pyo3(signature = (count))]
    fn analyze(&self, py: Python<'_>, count: Option<usize>) -> Told<Analysis> {
        let which = count.map_or(Which::Usual, Which::Lowest);
        let request = Request { which, ..Request::default() };
        py.detach(|| {
            let found = vibc::analyze_with(&self.sources, self.file, &self.overrides, &request, &Study::default());
            told(found.answer.map(Analysis), &self.sources, &found.diagnostics)
        })
    }

    /// H and its relative bounds at ascending frequencies in Hz, for the input and the output with these numbers.
    #[allow(clippy::type_complexity)]
    fn transfer<'py>(
        &self,
        py: Python<'py>,
        frequencies: Vec<f64>,
        input: usize,
        output: usize,
    ) -> PyResult<Told<(Bound<'py, PyArray1<Complex64>>, Bound<'py, PyArray1<f64>>)>> {
        let at: Vec<Frequency> =
            frequencies.iter().map(|f| Ok(Frequency::hertz(&self.number(*f)?))).collect::<PyResult<_>>()?;
        let (found, json, drawn) = py.detach(|| {
            let dynamics = self.dynamics.get_or_init(|| vibc::dynamics(&self.sources, self.file, &self.overrides));
            let mut findings = dynamics.diagnostics.clone();
            let found = dynamics.answer.as_ref().and_then(|dynamics| {
                let modes = dynamics.modes.clone().unwrap_or_default();
                let sweep = Sweep { at, inputs: vec![input], outputs: vec![output], ..Sweep::default() };
                let poles = dynamics.poles_for(&sweep).ok().flatten().unwrap_or_default();
                let table = vibc::transfer_table(&Methods::of(&dynamics.system, &modes), &poles, &sweep);
                let table = table.map_err(|error| findings.push(error.to_diagnostic())).ok()?;
                let gains = table.rows.iter().map(|row| row.gains[0][0]);
                Some(gains.map(value_and_bound).unzip::<_, _, Vec<Complex64>, Vec<f64>>())
            });
            told(found, &self.sources, &findings)
        });
        let found = found.map(|(values, bounds)| (PyArray1::from_vec(py, values), PyArray1::from_vec(py, bounds)));
        Ok((found, json, drawn))
    }

    /// Times, the outputs at these times and their absolute bounds, samples by outputs.
    #[allow(clippy::type_complexity)]
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        until: f64,
        step: f64,
    ) -> PyResult<Told<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)>> {
        let (until, step) = (self.time("until", until)?, self.time("step", step)?);
        let samples = (&until / &step).to_f64();
        if samples > vibc::MOST_SAMPLES {
            let most = vibc::MOST_SAMPLES;
            return Err(PyValueError::new_err(format!("that would be {samples:.0} samples; the limit is {most}")));
        }
        let (found, json, drawn) = py.detach(|| {
            let times = vibc::times(&until, &step);
            let outcome = vibc::simulate(&self.sources, self.file, &self.overrides, &times);
            let found = outcome.answer.map(|motion| {
                let history = &motion.history;
                let times: Vec<f64> = history.times.iter().map(|time| printed(Some(time.to_ball()))).collect();
                let samples = || history.values.iter().flatten().copied();
                let values: Vec<f64> = samples().map(|sample| printed(Some(sample))).collect();
                let bounds: Vec<f64> = samples().map(|sample| vibc::Bound::absolute(sample).value()).collect();
                (times, values, bounds)
            });
            told(found, &self.sources, &outcome.diagnostics)
        });
        let outputs = self.system.outputs.len();
        let found = found.map(|(times, values, bounds)| {
            let shape = (times.len(), outputs);
            (PyArray1::from_vec(py, times), rows(py, shape, values), rows(py, shape, bounds))
        });
        Ok((found, json, drawn))
    }

    /// The cases of a study: the columns, the numbers and their absolute bounds (cases by columns), and the code of each case; or the
    /// reason why there is none. `over`: parameters and their values as the command line has them.
    #[allow(clippy::too_many_arguments, clippy::type_complexity)]
    #[pyo3(signature = (over, samples, sobol, measures, modes, poles, hold_solved, tolerance))]
    fn sweep<'py>(
        &self,
        py: Python<'py>,
        over: Vec<String>,
        samples: Option<(u64, u64)>,
        sobol: bool,
        measures: Vec<String>,
        modes: Option<u32>,
        poles: bool,
        hold_solved: bool,
        tolerance: Option<f64>,
    ) -> PyResult<Told<(Vec<Heading>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, Vec<&'static str>)>> {
        let options = Asked { over, samples, sobol, measures, modes, poles, hold_solved, tolerance };
        let (found, json, drawn) = py.detach(|| table(self, &options));
        let found = found.transpose().map_err(PyValueError::new_err)?;
        let found = found.map(|table| {
            let shape = (table.codes.len(), table.headings.len());
            (table.headings, rows(py, shape, table.values), rows(py, shape, table.bounds), table.codes)
        });
        Ok((found, json, drawn))
    }

    /// The figure as SVG, as drawn or with a mode, counted from 1, over the rest; or the reason why there is none.
    #[pyo3(signature = (mode, values))]
    fn figure(&self, py: Python<'_>, mode: Option<u32>, values: bool) -> Told<(Option<String>, String)> {
        py.detach(|| {
            let drawn = FigureOptions { mode, values, ..FigureOptions::default() };
            let outcome = vibc::draw(&self.sources, self.file, &self.overrides, &drawn);
            let found = outcome.answer.map(|figure| match figure {
                Ok(figure) => (Some(vibc::figure_svg(&figure, &self.sources, self.file)), String::new()),
                Err(reason) => (None, reason),
            });
            told(found, &self.sources, &outcome.diagnostics)
        })
    }
}

/// An infinite value has no phase; of an unknown one nothing is known.
fn value_and_bound(gain: Gain) -> (Complex64, f64) {
    match gain.disc() {
        Some(disc) => {
            let [re, im] = disc.parts().map(|part| printed(Some(part)));
            (Complex64::new(re, im), disc.error_bound().value())
        }
        None if gain == Gain::Infinite => (Complex64::new(f64::INFINITY, f64::NAN), f64::INFINITY),
        None => (Complex64::new(f64::NAN, f64::NAN), f64::INFINITY),
    }
}
