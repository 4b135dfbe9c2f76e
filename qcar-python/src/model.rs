//! The model of Python's `qcar.Model`.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use ndarray::{Array3, Array4};
use numpy::{
    Complex64, IntoPyArray, PyArray1, PyArray2, PyArray3, PyArray4, PyArray5, PyReadonlyArray1, PyReadonlyArray2,
};
use pyo3::prelude::*;
use qcar::catalogue::{self, Loaded};
use qcar_dsl::show::{Stage, show};
use qcar_runtime::modes;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::road::Road;
use qcar_runtime::simulate::tyre_of;

use crate::dense::{self, At, FEW};
use crate::described::described;
use crate::long::long;
use crate::rides::{self, Common, Each};
use crate::verbs::variant_named;
use crate::{errors, ratios, responses, sets};

/// A runnable model.
#[pyclass(frozen, module = "qcar._native")]
pub struct Model {
    pub(crate) loaded: Arc<Loaded>,
}

type Matrices<'py> = [Bound<'py, PyArray3<f64>>; 4];
type Jacobians<'py> = [Bound<'py, PyArray4<f64>>; 4];
type RatiosOfSets<'py> = (Bound<'py, PyArray3<Complex64>>, Option<Bound<'py, PyArray4<Complex64>>>);
type Response<'py> = (Bound<'py, PyArray4<Complex64>>, Option<Bound<'py, PyArray5<Complex64>>>);

#[pymethods]
impl Model {
    /// A shipped model by its name, or a model file by its path.
    #[staticmethod]
    fn load(py: Python<'_>, model: &str) -> PyResult<Self> {
        let loaded = py.detach(|| catalogue::load(model)).map_err(errors::of_model)?;
        Ok(Model {
            loaded: Arc::new(loaded),
        })
    }

    /// A model from its text.
    #[staticmethod]
    fn text(py: Python<'_>, text: &str, name: &str) -> PyResult<Self> {
        let loaded = py
            .detach(|| catalogue::load_text(name, text))
            .map_err(errors::of_model)?;
        Ok(Model {
            loaded: Arc::new(loaded),
        })
    }

    /// A stage of a model by name, path or text.
    #[staticmethod]
    fn shown(py: Python<'_>, stage: &str, name: &str, text: Option<&str>) -> PyResult<String> {
        let stage = stage_named(stage)?;
        let compiled = py.detach(|| match text {
            Some(text) => catalogue::compiled_text(name, text),
            None => catalogue::compiled(name),
        });
        Ok(show(&compiled.map_err(errors::of_model)?, stage))
    }

    /// Names, units and sizes as JSON.
    fn about(&self) -> String {
        described(self.loaded.about())
    }

    /// All parameters (sets, parameters) from the columns `given` (sets, names) of some, and for each parameter the one
    /// to which it is tied.
    fn resolve<'py>(
        &self,
        py: Python<'py>,
        names: Vec<String>,
        given: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Vec<usize>)> {
        let sets = sets::resolve(&self.loaded, &names, given.as_array())?;
        Ok((sets.p.into_pyarray(py), sets.leader))
    }

    /// Rates of the states: (sets, states).
    fn derivatives<'py>(&self, py: Python<'py>, points: Points<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let at = points.at();
        let found = batch(py, at.p.nrows(), || dense::derivatives(&**self.loaded, &at))?;
        Ok(found.into_pyarray(py))
    }

    /// Outputs: (sets, outputs).
    fn outputs<'py>(&self, py: Python<'py>, points: Points<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let at = points.at();
        let found = batch(py, at.p.nrows(), || dense::outputs(&**self.loaded, &at))?;
        Ok(found.into_pyarray(py))
    }

    /// A, B, C and D, each (sets, rows, columns).
    fn matrices<'py>(&self, py: Python<'py>, points: Points<'py>) -> PyResult<Matrices<'py>> {
        let at = points.at();
        let all: [Array3<f64>; 4] = batch(py, at.p.nrows(), || dense::matrices(&**self.loaded, &at))?;
        Ok(all.map(|matrix| matrix.into_pyarray(py)))
    }

    /// The derivatives of A, B, C and D, each (sets, parameters, rows, columns).
    fn jacobians<'py>(&self, py: Python<'py>, points: Points<'py>, leader: Vec<usize>) -> PyResult<Jacobians<'py>> {
        let at = points.at();
        let all: [Array4<f64>; 4] = batch(py, at.p.nrows(), || dense::jacobians(&**self.loaded, &at, &leader))?;
        Ok(all.map(|matrix| matrix.into_pyarray(py)))
    }

    /// Responses of outputs to excitations (sets, lines, outputs, excitations), and their derivatives if wanted.
    fn responses<'py>(
        &self,
        py: Python<'py>,
        sets: PyReadonlyArray2<'py, f64>,
        leader: Vec<usize>,
        frequency: PyReadonlyArray1<'py, f64>,
        jacobian: bool,
    ) -> PyResult<Response<'py>> {
        let (sets, frequency) = (sets.as_array(), frequency.as_array().to_vec());
        let evaluate = || responses::responses(&**self.loaded, sets, &leader, &frequency, jacobian);
        let found = batch(py, sets.nrows(), evaluate)?;
        let slopes = found.jacobian.map(|own| own.into_pyarray(py));
        Ok((found.value.into_pyarray(py), slopes))
    }

    /// Ratios of the channels (sets, lines, channels), and their derivatives if wanted.
    fn ratios<'py>(
        &self,
        py: Python<'py>,
        sets: PyReadonlyArray2<'py, f64>,
        leader: Vec<usize>,
        frequency: PyReadonlyArray1<'py, f64>,
        jacobian: bool,
    ) -> PyResult<RatiosOfSets<'py>> {
        let (sets, frequency) = (sets.as_array(), frequency.as_array().to_vec());
        let evaluate = || ratios::ratios(&self.loaded, sets, &leader, &frequency, jacobian);
        let found = batch(py, sets.nrows(), evaluate)?.map_err(errors::of_model)?;
        let slopes = found.jacobian.map(|own| own.into_pyarray(py));
        Ok((found.value.into_pyarray(py), slopes))
    }

    /// Frequencies (Hz), damping ratios and, for each mode, the amplitudes of moving parts by location and axis.
    fn modes(&self, p: PyReadonlyArray1<'_, f64>) -> PyResult<Vec<Mode>> {
        let about = self.loaded.about();
        let names = about.parameters.iter().map(|own| own.name.to_string());
        let given: BTreeMap<String, f64> = names.zip(p.as_array().iter().copied()).collect();
        let values = Values::resolve(about, &given, &BTreeMap::new());
        let values = values.map_err(|errors| errors::of_parameters(errors[0].clone()))?;
        let mode = |own: modes::Mode| {
            let shape = own.shape.into_iter();
            let shape = shape.map(|part| (part.location, part.axis, part.amplitude));
            (own.frequency, own.damping, shape.collect())
        };
        Ok(modes::modes(&**self.loaded, &values).into_iter().map(mode).collect())
    }

    /// Rides: outputs, tyre, peaks, after-shakes, static deflections and lift-offs; see `rides.rs`.
    fn rides<'py>(
        &self,
        py: Python<'py>,
        p: PyReadonlyArray2<'py, f64>,
        height: PyReadonlyArray1<'py, f64>,
        speed: PyReadonlyArray1<'py, f64>,
        setup: Setup,
    ) -> PyResult<Rides<'py>> {
        let each = Each {
            p: p.as_array(),
            height: height.as_array(),
            speed: speed.as_array(),
        };
        let common = setup.common()?;
        let recorded = long(py, || rides::rides(&self.loaded, &common, &each))?.map_err(errors::of_ride)?;
        Ok((
            recorded.outputs.into_pyarray(py),
            recorded.tyre.into_pyarray(py),
            recorded.peak.into_pyarray(py),
            recorded.after_shake.into_pyarray(py),
            recorded.static_deflection.into_pyarray(py),
            recorded.lift_offs,
        ))
    }
}

/// Parameters (sets, parameters), states (sets, states) and inputs (sets, inputs).
#[derive(FromPyObject)]
struct Points<'py>(
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray2<'py, f64>,
);

impl Points<'_> {
    fn at(&self) -> At<'_> {
        At {
            p: self.0.as_array(),
            x: self.1.as_array(),
            u: self.2.as_array(),
        }
    }
}

/// Stages of a model.
fn stage_named(name: &str) -> PyResult<Stage> {
    match name {
        "model" => Ok(Stage::Model),
        "equations" => Ok(Stage::Equations),
        "matrices" => Ok(Stage::Matrices),
        "rust" => Ok(Stage::Rust),
        "latex" => Ok(Stage::Latex),
        "dot" => Ok(Stage::Dot),
        other => {
            let stages = "\"model\", \"equations\", \"matrices\", \"rust\", \"latex\" or \"dot\"";
            Err(errors::of_parameters(format!("`stage` is {other:?}; write {stages}")))
        }
    }
}

/// Runs work on `count` parameter sets without the lock of the interpreter; for many sets, a signal cancels it.
fn batch<T: Send>(py: Python<'_>, sets: usize, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    match sets {
        0..FEW => Ok(py.detach(work)),
        _ => long(py, work),
    }
}

/// Frequency, damping, and amplitudes by location and axis.
type Mode = (f64, f64, Vec<(String, String, Complex64)>);

type Rides<'py> = (
    Bound<'py, PyArray3<f64>>,
    Bound<'py, PyArray3<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Vec<Vec<f64>>,
);

/// The common settings of all rides, as Python gives them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Setup {
    vehicle: BTreeMap<String, f64>,
    variant: String,
    road: Option<Vec<[f64; 2]>>,
    cleat: [f64; 3],
    sample_rate: f64,
    samples: usize,
    tolerance: f64,
}

impl Setup {
    fn common(&self) -> PyResult<Common> {
        let (tyre, load) =
            tyre_of(&|name| self.vehicle.get(name).copied(), Path::new("vehicle")).map_err(errors::of_parameters)?;
        let road = self
            .road
            .as_deref()
            .map(Road::from_points)
            .transpose()
            .map_err(errors::of_ride)?;
        Ok(Common {
            tyre,
            load,
            variant: variant_named(&self.variant)?.into(),
            road,
            cleat: self.cleat,
            sample_rate: self.sample_rate,
            samples: self.samples,
            tolerance: self.tolerance,
        })
    }
}
