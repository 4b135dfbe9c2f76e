//! The state-space form of a model for one parameter set, dense and with names.
//!
//! A nonlinear model is linearised at rest: all states and inputs zero.

use std::collections::BTreeMap;

use qcar_runtime::matrices::{at_rest, sensitivities_at_rest};
use qcar_runtime::model::{About, Input, InputKind, Matrix, Model, Output, Quantity, Signal, State, StateKind};
use qcar_runtime::response::parameters::Values;
use serde::Serialize;

use crate::parameters::out_of_range;
use crate::stability::unstable;

/// Rows of numbers.
pub type Rows = Vec<Vec<f64>>;

/// A, B, C and D with their parameter Jacobians, and the names of rows and columns.
#[derive(Debug, Serialize)]
pub struct StateSpace {
    /// Name of the model.
    pub model: String,
    /// True if the matrices hold for any state; false for a linearisation at rest.
    pub linear: bool,
    /// Rows and columns of A, rows of B, columns of C.
    pub states: Vec<StateName>,
    /// Columns of B and D.
    pub inputs: Vec<InputName>,
    /// Rows of C and D.
    pub outputs: Vec<OutputName>,
    /// Every parameter that is not tied to another, in the order of the model.
    pub parameters: Vec<String>,
    /// The value of every parameter, SI.
    pub values: BTreeMap<String, f64>,
    /// Values outside the ranges of the model and those at which it is unstable, as sentences.
    pub notices: Vec<String>,
    /// A, B, C and D.
    #[serde(flatten)]
    pub matrices: BTreeMap<String, Rows>,
    /// dA, dB, dC and dD: a matrix of derivatives for each parameter.
    #[serde(flatten)]
    pub sensitivities: BTreeMap<String, BTreeMap<String, Rows>>,
}

/// A state: with `mass` for a motion, with `link` for an inner state.
#[derive(Debug, Serialize)]
pub struct StateName {
    /// Name in equations.
    pub name: String,
    /// The moving mass or node.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass: Option<String>,
    /// The link of an inner state.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub link: Option<String>,
    /// Axis: `z` or `x`.
    pub axis: String,
    /// Kind: `position`, `velocity` or `inner`.
    pub kind: &'static str,
    /// Unit.
    pub unit: String,
}

/// An input.
#[derive(Debug, Serialize)]
pub struct InputName {
    /// The road, motion, force or gravity.
    pub name: String,
    /// Name in equations.
    pub variable: String,
    /// Axis: `z` or `x`.
    pub axis: String,
    /// Kind: `road`, `road_rate`, `road_acceleration`, the same of `motion`, `force` or `gravity`.
    pub kind: &'static str,
    /// Unit.
    pub unit: String,
}

/// An output.
#[derive(Debug, Serialize)]
pub struct OutputName {
    /// Name as declared.
    pub name: String,
    /// The mass, node or link that is measured.
    pub location: String,
    /// Axis: `z` or `x`.
    pub axis: String,
    /// Kind: `position`, `velocity`, `acceleration`, `force` or `stretch`.
    pub kind: &'static str,
    /// Unit.
    pub unit: String,
}

/// Evaluates a model with its derivatives, along one axis or along all.
pub fn state_space(model: &dyn Model, values: &Values, axis: Option<&str>) -> StateSpace {
    StateSpace {
        sensitivities: sensitivities(model, values, &Kept::new(model.about(), axis)),
        ..without_sensitivities(model, values, axis)
    }
}

/// The same without derivatives, which are dense and so outgrow a long model.
pub fn without_sensitivities(model: &dyn Model, values: &Values, axis: Option<&str>) -> StateSpace {
    let about = model.about();
    let p = values.as_slice();
    let keep = Kept::new(about, axis);
    let names = about.parameters.iter().map(|parameter| parameter.name.to_string());
    let leaders = (0..p.len()).filter(|&k| values.leader(k) == k);
    StateSpace {
        model: about.name.to_string(),
        linear: about.linear,
        states: keep.states.iter().map(|&at| state_name(&about.states[at])).collect(),
        inputs: keep
            .inputs
            .iter()
            .map(|&at| input_name(about, &about.inputs[at]))
            .collect(),
        outputs: keep.outputs.iter().map(|&at| output_name(&about.outputs[at])).collect(),
        parameters: leaders.map(|k| about.parameters[k].name.to_string()).collect(),
        values: names.zip(p.iter().copied()).collect(),
        notices: out_of_range(about, p)
            .into_iter()
            .chain(unstable(model, values))
            .collect(),
        matrices: matrices(model, p, &keep),
        sensitivities: BTreeMap::new(),
    }
}

/// Positions of the states, inputs and outputs that are shown.
struct Kept {
    states: Vec<usize>,
    inputs: Vec<usize>,
    outputs: Vec<usize>,
}

impl Kept {
    fn new(about: &About, axis: Option<&str>) -> Self {
        let wanted = |of: &str| axis.is_none_or(|axis| axis == of);
        Kept {
            states: (0..about.states.len())
                .filter(|&i| wanted(&about.states[i].axis))
                .collect(),
            inputs: (0..about.inputs.len())
                .filter(|&i| wanted(&about.inputs[i].axis))
                .collect(),
            outputs: (0..about.outputs.len())
                .filter(|&i| wanted(&about.outputs[i].signal.axis))
                .collect(),
        }
    }

    fn rows_and_columns(&self, matrix: Matrix) -> (&[usize], &[usize]) {
        match matrix {
            Matrix::A => (&self.states, &self.states),
            Matrix::B => (&self.states, &self.inputs),
            Matrix::C => (&self.outputs, &self.states),
            Matrix::D => (&self.outputs, &self.inputs),
        }
    }

    fn zeros(&self, matrix: Matrix) -> Rows {
        let (rows, columns) = self.rows_and_columns(matrix);
        vec![vec![0.0; columns.len()]; rows.len()]
    }

    /// Position of an entry of the whole matrix in the part that is shown.
    fn place(&self, matrix: Matrix, row: u16, column: u16) -> Option<(usize, usize)> {
        let (rows, columns) = self.rows_and_columns(matrix);
        Some((
            rows.binary_search(&row.into()).ok()?,
            columns.binary_search(&column.into()).ok()?,
        ))
    }
}

const ALL: [(Matrix, &str); 4] = [(Matrix::A, "A"), (Matrix::B, "B"), (Matrix::C, "C"), (Matrix::D, "D")];

fn matrices(model: &dyn Model, p: &[f64], keep: &Kept) -> BTreeMap<String, Rows> {
    let about = model.about();
    let nonzeros = at_rest(model, p);
    let dense = ALL.map(|(matrix, name)| {
        let mut rows = keep.zeros(matrix);
        for (entry, value) in about
            .matrices
            .iter()
            .zip(&nonzeros)
            .filter(|(entry, _)| entry.matrix == matrix)
        {
            if let Some((row, column)) = keep.place(matrix, entry.row, entry.column) {
                rows[row][column] = *value;
            }
        }
        (name.to_string(), rows)
    });
    BTreeMap::from(dense)
}

/// The derivative by a parameter includes the parameters that are tied to it.
fn sensitivities(model: &dyn Model, values: &Values, keep: &Kept) -> BTreeMap<String, BTreeMap<String, Rows>> {
    let about = model.about();
    let nonzeros = sensitivities_at_rest(model, values.as_slice());
    let leaders = (0..about.parameters.len()).filter(|&k| values.leader(k) == k);
    let dense = ALL.map(|(matrix, name)| {
        let mut of: BTreeMap<usize, Rows> = leaders.clone().map(|k| (k, keep.zeros(matrix))).collect();
        let entries = about.sensitivities.iter().zip(&nonzeros);
        for ((entry, parameter), value) in entries.filter(|((entry, _), _)| entry.matrix == matrix) {
            let rows = of.get_mut(&values.leader(usize::from(*parameter)));
            if let (Some(rows), Some((row, column))) = (rows, keep.place(matrix, entry.row, entry.column)) {
                rows[row][column] += *value;
            }
        }
        let named = of
            .into_iter()
            .map(|(k, rows)| (about.parameters[k].name.to_string(), rows));
        (format!("d{name}"), named.collect())
    });
    BTreeMap::from(dense)
}

/// A state for JSON.
pub fn state_name(state: &State) -> StateName {
    let location = Some(state.location.to_string());
    let (mass, link, kind) = match state.kind {
        StateKind::Position => (location, None, "position"),
        StateKind::Velocity => (location, None, "velocity"),
        StateKind::Inner => (None, location, "inner"),
    };
    StateName {
        name: state.name.to_string(),
        mass,
        link,
        axis: state.axis.to_string(),
        kind,
        unit: state.unit.to_string(),
    }
}

/// An input for JSON.
pub fn input_name(about: &About, input: &Input) -> InputName {
    let (name, kind) = match input.kind {
        InputKind::Gravity => (&input.name, "gravity"),
        InputKind::Force(at) => (&about.excitations[usize::from(at)].name, "force"),
        InputKind::Motion(at, quantity) => {
            let motion = &about.excitations[usize::from(at)];
            (&motion.name, motion_kind(motion.road, quantity))
        }
    };
    InputName {
        name: name.to_string(),
        variable: input.name.to_string(),
        axis: input.axis.to_string(),
        kind,
        unit: input.unit.to_string(),
    }
}

fn motion_kind(road: bool, quantity: Quantity) -> &'static str {
    match (road, quantity) {
        (true, Quantity::Position) => "road",
        (true, Quantity::Velocity) => "road_rate",
        (true, Quantity::Acceleration) => "road_acceleration",
        (false, Quantity::Position) => "motion",
        (false, Quantity::Velocity) => "motion_rate",
        (false, Quantity::Acceleration) => "motion_acceleration",
    }
}

/// An output for JSON.
pub fn output_name(output: &Output) -> OutputName {
    let Signal { location, axis, kind } = &output.signal;
    let [name, location, axis, unit] = [&output.name, location, axis, &output.unit].map(|text| text.to_string());
    OutputName {
        name,
        location,
        axis,
        kind: kind.word(),
        unit,
    }
}
