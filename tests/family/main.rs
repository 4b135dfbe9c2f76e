//! Every valid layout of the corner family compiles, and moves as the tables of the thesis say.
//!
//! The referee shares nothing with the compiler: it lists masses and links of a layout anew, assembles M, C and K from
//! their stretches as numbers, and solves `(K + jωC - ω²M) q = F` at a few frequencies.

mod layout;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use layout::Layout;
use nalgebra::{Complex, DMatrix, DVector};
use qcar::catalogue::{self, Loaded};
use qcar::failure::Failure;
use qcar_runtime::model::{About, Default as Fallback, InputKind, Matrix, Model, Quantity, ResponseMut, SignalKind};

/// From primary ride to impact harshness.
const FREQUENCIES: [f64; 4] = [0.7, 4.3, 13.0, 42.0];

#[test]
fn every_valid_layout_moves_as_the_tables_say() {
    let layouts = layout::valid();
    assert_eq!(layouts.len(), 16 + 96 + 2 * 16);
    for layout in layouts {
        moves_along(
            &layout,
            &layout.choices(),
            &[("z", "pad"), ("z", "f_wheel_z"), ("x", "f_wheel_x")],
        );
        if !layout.moves_in_x_alone() {
            let choices = layout.choices() + " longitudinal = off;";
            moves_along(&layout, &choices, &[("z", "pad"), ("z", "f_wheel_z")]);
        }
    }
}

fn moves_along(layout: &Layout, choices: &str, excitations: &[(&str, &str)]) {
    let model = compile(choices).unwrap_or_else(|refused| panic!("{choices}\n{refused}"));
    for (axis, excitation) in excitations {
        for frequency in FREQUENCIES {
            agree(layout, &*model, axis, excitation, frequency);
        }
    }
}

#[test]
fn invalid_layouts_are_refused_by_name() {
    let cases = [
        (
            "powertrain = subframe;",
            "a powertrain on the sub-frame needs subframe = on",
        ),
        (
            "spring_reaction = subframe;",
            "a spring on the sub-frame needs subframe = on",
        ),
        (
            "damper_reaction = subframe;",
            "a damper on the sub-frame needs subframe = on",
        ),
        (
            "subframe = on; subframe_x = node;",
            "a sub-frame that moves in z has its mass in x as well",
        ),
        (
            "longitudinal = off; subframe_x = mass;",
            "a sub-frame that moves in x needs longitudinal = on",
        ),
    ];
    for (choices, reason) in cases {
        let refused = compile(choices).err().unwrap_or_else(|| panic!("{choices} compiles"));
        assert!(refused.contains(reason), "{choices}\n{refused}");
    }
}

/// An axle with these choices, from a file as a user would write it.
fn compile(choices: &str) -> Result<Loaded, String> {
    let family = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/families/corner.axle");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("member.axle");
    let text = format!(
        "axle member from {:?} {{ \"A layout\" {choices} }}",
        family.to_str().unwrap()
    );
    fs::write(&file, text).unwrap();
    catalogue::load(file.to_str().unwrap()).map_err(|failure| match failure {
        Failure::Input(text) | Failure::Finding(text) => text,
    })
}

fn agree(layout: &Layout, model: &dyn Model, axis: &str, excitation: &str, frequency: f64) {
    let omega = std::f64::consts::TAU * frequency;
    let expected = layout.accelerations(axis, excitation, omega);
    let by_elimination = response(model, axis, excitation, omega);
    let by_matrices = state_space_response(model, axis, excitation, omega);
    for (mass, expected) in expected {
        for (how, found) in [("elimination", by_elimination[&mass]), ("matrices", by_matrices[&mass])] {
            let error = (found - expected).norm() / expected.norm().max(1e-12);
            assert!(
                error < 1e-9,
                "{layout:?}: {axis} {mass} per {excitation} at {frequency} Hz by {how}: {error:e}"
            );
        }
    }
}

/// The accelerations per unit excitation, from the response that the compiler eliminates symbolically.
fn response(model: &dyn Model, axis: &str, excitation: &str, omega: f64) -> BTreeMap<String, Complex<f64>> {
    let about = model.about();
    let at = about
        .excitations
        .iter()
        .position(|e| e.name == excitation && e.axis == axis)
        .unwrap();
    let layout = &about.responses[at];
    let mut constants = vec![0.0; about.constants];
    model.prepare(&parameters(about), &mut constants);
    let (mut re, mut im) = (vec![0.0; layout.outputs.len()], vec![0.0; layout.outputs.len()]);
    model.response(
        at,
        &constants,
        &[omega],
        ResponseMut {
            re: &mut re,
            im: &mut im,
            jacobian: None,
        },
    );
    let outputs = layout.outputs.iter().zip(re.iter().zip(&im));
    outputs
        .map(|(&y, (&re, &im))| (mass_of(about, y.into()), Complex::new(re, im)))
        .collect()
}

/// The same from A, B, C and D: `C (jω - A)⁻¹ B + D`.
fn state_space_response(model: &dyn Model, axis: &str, excitation: &str, omega: f64) -> BTreeMap<String, Complex<f64>> {
    let about = model.about();
    let [a, b, c, d] = matrices(model);
    let u = DVector::from_iterator(
        about.inputs.len(),
        about
            .inputs
            .iter()
            .map(|input| amplitude(about, &input.kind, axis, excitation, omega)),
    );
    let resolvent = DMatrix::identity(a.nrows(), a.nrows()) * Complex::new(0.0, omega) - a;
    let x = resolvent.lu().solve(&(b * &u)).unwrap();
    let y = c * x + d * u;
    let along = (0..y.len()).filter(|&at| about.outputs[at].signal.axis == axis);
    along.map(|at| (mass_of(about, at), y[at])).collect()
}

/// What a unit excitation puts on an input.
fn amplitude(about: &About, input: &InputKind, axis: &str, excitation: &str, omega: f64) -> Complex<f64> {
    let is = |at: u16| {
        let of = &about.excitations[usize::from(at)];
        of.name == excitation && of.axis == axis
    };
    match *input {
        InputKind::Motion(at, Quantity::Position) if is(at) => Complex::new(1.0, 0.0),
        InputKind::Motion(at, Quantity::Velocity) if is(at) => Complex::new(0.0, omega),
        InputKind::Motion(at, Quantity::Acceleration) if is(at) => Complex::new(-omega * omega, 0.0),
        InputKind::Force(at) if is(at) => Complex::new(1.0, 0.0),
        _ => Complex::new(0.0, 0.0),
    }
}

fn matrices(model: &dyn Model) -> [DMatrix<Complex<f64>>; 4] {
    let about = model.about();
    let (x, u) = (vec![0.0; about.states.len()], vec![0.0; about.inputs.len()]);
    let mut nonzeros = vec![0.0; about.matrices.len()];
    model.matrices(&parameters(about), &x, &u, &mut nonzeros);
    let outputs = about.outputs.len();
    [Matrix::A, Matrix::B, Matrix::C, Matrix::D].map(|matrix| {
        let rows = if matches!(matrix, Matrix::A | Matrix::B) {
            x.len()
        } else {
            outputs
        };
        let columns = if matches!(matrix, Matrix::A | Matrix::C) {
            x.len()
        } else {
            u.len()
        };
        let mut dense = DMatrix::zeros(rows, columns);
        for (entry, value) in about
            .matrices
            .iter()
            .zip(&nonzeros)
            .filter(|(entry, _)| entry.matrix == matrix)
        {
            dense[(entry.row.into(), entry.column.into())] = Complex::new(*value, 0.0);
        }
        dense
    })
}

fn mass_of(about: &About, output: usize) -> String {
    let signal = &about.outputs[output].signal;
    assert_eq!(signal.kind, SignalKind::Motion(Quantity::Acceleration));
    signal.location.to_string()
}

fn parameters(about: &About) -> Vec<f64> {
    let of = |name: &str| {
        layout::VALUES
            .iter()
            .any(|(n, _)| *n == name)
            .then(|| layout::value(name))
    };
    let value = |parameter: &qcar_runtime::model::Parameter| match parameter.default {
        Fallback::Same(other) => of(&about.parameters[usize::from(other)].name),
        _ => of(&parameter.name),
    };
    about
        .parameters
        .iter()
        .map(|parameter| value(parameter).unwrap())
        .collect()
}
