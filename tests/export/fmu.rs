//! Exported units in FMPy: valid, and moving as qcar's own integrator moves the model that it interprets.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use qcar::catalogue::{self, Loaded};
use qcar::parameters;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::solver::{DormandPrince, Reason, Settings, System};
use serde_json::Value;

use crate::programs::{python_with, qcar, run};

/// Samples of the inputs.
pub const RATE: f64 = 250.0;
pub const SAMPLES: usize = 251;

/// How far trajectories may be from ours, in parts of the largest value of each.
const TOLERANCE: f64 = 1e-6;

/// A campaign of `axle_c`.
pub const STUDY: &str = "models/campaigns/axle_c_study";

/// FMPy brings the headers of the FMI project, which list what a library must have.
#[test]
fn libraries_have_every_function_of_the_headers_of_the_standard() {
    let Some(python) = python_with("fmpy", "functions of libraries") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    for (fmi, least) in [("2", 44), ("3", 75)] {
        let unit = folder.path().join(format!("unit{fmi}.fmu"));
        let out = ["--as", "fmu", "--fmi", fmi, "--out", unit.to_str().unwrap()];
        qcar(&[&["export", "quarter_car"], &out[..]].concat());
        let program = format!(
            "
import ctypes, fmpy, pathlib, re
header = (pathlib.Path(fmpy.__file__).parent / 'c-code' / 'fmi{fmi}Functions.h').read_text()
names = re.findall(r'#define (fmi{fmi}\\w+) +fmi{fmi}FullName', header)
folder = pathlib.Path(fmpy.extract('unit{fmi}.fmu'))
library = ctypes.CDLL(str(next((folder / 'binaries').rglob('*.so'))))
print(len(names), *[name for name in names if not hasattr(library, name)])"
        );
        let said = run(&python, &["-c", &program], folder.path());
        let words: Vec<&str> = said.split_whitespace().collect();
        assert!(words[0].parse::<usize>().unwrap() >= least, "{said}");
        assert_eq!(words[1..], [""; 0], "missing in FMI {fmi}");
    }
}

#[test]
fn a_linear_axle_moves_in_fmpy_as_here() {
    compare("axle_d", Some("tests/data/axle_d.toml"), None);
}

#[test]
fn a_parameter_that_is_changed_in_fmpy_is_that_of_the_model() {
    compare("axle_d", Some("tests/data/axle_d.toml"), Some(("k_tire", 230e3)));
}

/// A block that slides and stops: v0 m/F after v0² m/(2 F), and there it stays.
#[test]
fn a_law_that_jumps_holds_the_motion_in_co_simulation() {
    let Some(python) = python_with("fmpy", "a law that jumps") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    fs::write(path("block.axle"), BLOCK).unwrap();
    qcar(&[
        "export",
        &path("block.axle"),
        "--as",
        "fmu",
        "--out",
        &path("block.fmu"),
    ]);
    let program = "
from fmpy import simulate_fmu
found = simulate_fmu('block.fmu', fmi_type='CoSimulation', stop_time=0.4, output_interval=0.1,
                     start_values={'vx_block': 0.5}, output=['x_block', 'vx_block'])
print(*[value for row in found for value in row])";
    let out = run(&python, &["-c", program], folder.path());
    let numbers: Vec<f64> = out.split_whitespace().map(|word| word.parse().unwrap()).collect();
    let rows: Vec<&[f64]> = numbers.chunks(3).collect();
    assert_eq!(rows.len(), 5, "{out}");
    let deceleration = 20.0 / 10.0;
    for row in rows {
        let t = row[0].min(0.5 / deceleration);
        let (x, v) = (0.5 * t - deceleration * t * t / 2.0, 0.5 - deceleration * t);
        // What the block does in a step of a microsecond at the jump.
        assert!(
            (row[1] - x).abs() < 1e-8 && (row[2] - v).abs() < 4e-6,
            "{row:?}, expected {x} and {v}"
        );
    }
}

const BLOCK: &str = r#"
axle block {
    "A block on dry ground"

    param m: kg = 10 "Mass";
    param f: N = 20 "Friction";

    direction x {
        motion ground;
        mass block = m;
        link friction: block - ground { force = f * sign(v); }
        output block.position;
        output block.velocity;
    }
}
"#;

#[test]
fn an_axle_with_friction_moves_in_fmpy_as_here() {
    let folder = tempfile::tempdir().unwrap();
    let patched = with_friction(folder.path());
    compare(patched.to_str().unwrap(), Some(STUDY), None);
}

/// `axle_c` with dry friction in its damper, as a study finds it.
pub fn with_friction(folder: &Path) -> PathBuf {
    let patched = folder.join("friction.axle");
    let out = patched.to_str().unwrap();
    let effect = ["coulomb_friction", "--at", "damper", "--params", STUDY, "--out", out];
    qcar(&[&["patch", "axle_c"], &effect[..]].concat());
    patched
}

#[test]
fn laws_that_bend_move_in_fmpy_as_here() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("bends.axle");
    fs::write(&model, BENDS).unwrap();
    compare(model.to_str().unwrap(), None, None);
}

/// Bends of every kind, none of which jumps, and curves through points.
pub const BENDS: &str = r#"
axle bends {
    "A wheel and a body with a stop, a digressive damper and a spring by points"

    param m: kg = 300 "Mass of the body";
    param m_wheel: kg = 40 "Mass of the wheel";
    param k_tire: N/m = 200e3 "Stiffness of the tyre";
    param c_tire: N s/m = 100 "Damping of the tyre";
    param gap: m = 5e-3 "Travel up to the stop";
    param k_stop: N/m = 60e3 "Stiffness of the stop";
    param c: N s/m = 1500 "Damping at low speed";
    param v0: m/s = 0.3 "Speed at which it has fallen to a half";

    direction z {
        road pad;
        gravity g;
        mass body = m;
        mass wheel = m_wheel;
        force f on body;
        link tire: wheel - pad { spring k_tire; damper c_tire; }
        link stop: body - wheel { force = k_stop * min(s + gap, 0 m) + k_stop * max(s - gap, 0 m); }
        link damper: body - wheel { force = if v < 0 m/s { c * v / (1 + abs(v) / v0) } else { 0.5 * c * v }; }
        link spring: body - wheel {
            force = table(s, [-0.05 m, -0.01 m, 0 m, 0.01 m, 0.05 m], [-2500 N, -250 N, 0 N, 200 N, 900 N]);
        }
        link friction: body - wheel {
            state f_dry: N;
            rate f_dry = 1e5 N/m * (v - abs(v) * f_dry / 40 N);
            force = f_dry;
        }
        output body.acceleration;
        output wheel.position;
        output spring.force;
    }
}
"#;

/// Exports a model for both versions of the interface and holds it against what the workbench makes of it.
fn compare(model: &str, params: Option<&str>, changed: Option<(&str, f64)>) {
    let Some(python) = python_with("fmpy", "exported units") else {
        return;
    };
    for version in ["2", "3"] {
        compare_version(&python, model, params, changed, version);
    }
}

fn compare_version(python: &Path, model: &str, params: Option<&str>, changed: Option<(&str, f64)>, version: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let (unit, input, result) = (path("model.fmu"), path("input.csv"), path("result.json"));
    let given: Vec<&str> = params.into_iter().flat_map(|file| ["--params", file]).collect();
    let said = qcar(
        &[
            &["export", model, "--as", "fmu", "--fmi", version, "--out", &unit],
            &given[..],
        ]
        .concat(),
    );
    assert!(said.contains("compiled by"), "{said}");
    let subject = Subject::new(model, params, changed);
    fs::write(&input, subject.input_file()).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export/fmu.py");
    let changed = changed.map(|(name, value)| [name.to_string(), value.to_string()]);
    let changed = changed.iter().flatten().map(String::as_str);
    let arguments: Vec<&str> = [script, &unit, &input, &result].into_iter().chain(changed).collect();
    run(python, &arguments, folder.path());
    let answer: Value = serde_json::from_str(&fs::read_to_string(&result).unwrap()).unwrap();
    assert_eq!(answer["problems"], serde_json::json!([]));
    assert_eq!((&answer["returns"], &answer["refuses"]), (&true.into(), &true.into()));
    subject.check_variables(&answer["variables"]);
    let check = |between, way: &str, kind: &str| {
        let (own, other) = (subject.ride(between), &answer[way][kind]);
        subject.check_ride(&own, other, &format!("{way} {kind} of FMI {version}"));
    };
    check(Between::Straight, "straight", "model_exchange");
    if version == "2" {
        check(Between::Straight, "straight", "co_simulation");
    }
    check(Between::Before, "held", "co_simulation");
    check(Between::After, "held", "model_exchange");
    subject.check_jacobian(&answer["jacobian"]);
}

/// A model behind the seam of the workbench.
pub struct Subject {
    model: Loaded,
    /// What parameters have in the unit at first, and what they are given.
    exported: Values,
    values: Values,
    constants: Vec<f64>,
}

impl Subject {
    pub fn new(model: &str, params: Option<&str>, changed: Option<(&str, f64)>) -> Subject {
        let model = catalogue::load(model).unwrap();
        let params = params.map(PathBuf::from);
        let mut values = parameters::resolve(model.about(), params.as_deref(), &[]).unwrap();
        let exported = values.clone();
        if let Some((name, value)) = changed {
            let names = &mut model.about().parameters.iter();
            values.set(names.position(|own| own.name == name).unwrap(), value);
        }
        let mut constants = vec![0.0; model.about().constants];
        model.prepare(values.as_slice(), &mut constants);
        Subject {
            model,
            exported,
            values,
            constants,
        }
    }

    /// A bump of 20 mm and 0.2 s, first under the wheel and then along it, with its exact rates at the samples.
    fn input(&self, name: &str, t: f64) -> f64 {
        let bump = |from: f64| {
            let w = std::f64::consts::TAU / 0.2;
            let phase = w * (t - from);
            match (0.0..0.2).contains(&(t - from)) {
                true => [
                    0.01 * (1.0 - phase.cos()),
                    0.01 * w * phase.sin(),
                    0.01 * w * w * phase.cos(),
                ],
                false => [0.0; 3],
            }
        };
        let [z, v, a] = if name.contains("x_") { bump(0.35) } else { bump(0.05) };
        match name {
            _ if name.starts_with("f_") => 100.0 * bump(0.5)[0] / 0.02,
            _ if name.starts_with('v') => v,
            _ if name.starts_with('a') => a,
            "g" => 0.0,
            _ => z,
        }
    }

    pub fn samples(&self) -> Vec<Vec<f64>> {
        let row = |name: &&str| (0..SAMPLES).map(|k| self.input(name, k as f64 / RATE)).collect();
        self.inputs().iter().map(row).collect()
    }

    pub fn inputs(&self) -> Vec<&str> {
        self.model.about().inputs.iter().map(|input| &*input.name).collect()
    }

    pub fn input_file(&self) -> String {
        let names = self.inputs();
        let samples = self.samples();
        let line = |k: usize| {
            let values: Vec<String> = samples.iter().map(|row| format!("{:?}", row[k])).collect();
            format!("{:?},{}\n", k as f64 / RATE, values.join(","))
        };
        format!(
            "time,{}\n{}",
            names.join(","),
            (0..SAMPLES).map(line).collect::<String>()
        )
    }

    /// The outputs at the samples, by the runtime's integrator at a tolerance that is tighter by two orders.
    pub fn ride(&self, between: Between) -> Vec<Vec<f64>> {
        self.ride_of(self.samples(), between)
    }

    /// The same with other inputs: a row for each, with as many samples.
    pub fn ride_of(&self, samples: Vec<Vec<f64>>, between: Between) -> Vec<Vec<f64>> {
        let about = self.model.about();
        let mut system = Driven {
            subject: self,
            samples,
            leg: 0,
            between,
        };
        let settings = Settings {
            relative: 1e-11,
            absolute: vec![1e-13; about.states.len()],
            longest_step: 1.0,
            most_steps: 1_000_000,
        };
        let mut solver = DormandPrince::new(settings, 0);
        let mut x = vec![0.0; about.states.len()];
        let mut outputs = vec![Vec::new(); about.outputs.len()];
        for k in 0..SAMPLES {
            let t = k as f64 / RATE;
            let mut y = vec![0.0; outputs.len()];
            if between == Between::After {
                system.leg = k;
            }
            self.model.outputs(&self.constants, &x, &system.inputs(t), &mut y);
            outputs.iter_mut().zip(y).for_each(|(row, value)| row.push(value));
            if k + 1 < SAMPLES {
                system.leg = k;
                let report = solver.integrate(&mut system, (t, (k + 1) as f64 / RATE), &[], &mut x);
                assert_eq!(report.reason, Reason::End, "at {t} s");
            }
        }
        outputs
    }

    pub fn check_ride(&self, own: &[Vec<f64>], other: &Value, kind: &str) {
        for (output, own) in self.model.about().outputs.iter().zip(own) {
            let other: Vec<f64> = serde_json::from_value(other[&*output.name].clone()).unwrap();
            let peak = own.iter().fold(0.0f64, |peak, value| peak.max(value.abs()));
            assert!(peak > 0.0, "{} does not move", output.name);
            let off = own.iter().zip(&other).map(|(a, b)| (a - b).abs());
            let off = off.fold(0.0, f64::max) / peak;
            assert!(off < TOLERANCE, "{} by {kind}: {off:e} of its peak", output.name);
            println!("{} by {kind}: {off:.1e} of its peak", output.name);
        }
    }

    fn check_variables(&self, variables: &Value) {
        let about = self.model.about();
        for (parameter, value) in about.parameters.iter().zip(self.exported.as_slice()) {
            let own = &variables[&*parameter.name];
            assert_eq!(
                (own[0].as_str(), own[1].as_str()),
                (Some("parameter"), Some(&*parameter.unit))
            );
            assert_eq!(own[2].as_str().unwrap().parse::<f64>().unwrap(), *value);
        }
        for input in about.inputs.iter() {
            let own = &variables[&*input.name];
            assert_eq!((own[0].as_str(), own[1].as_str()), (Some("input"), Some(&*input.unit)));
        }
    }

    /// Against central differences of the equations of motion and of the outputs.
    fn check_jacobian(&self, columns: &Value) {
        let columns: BTreeMap<String, Vec<f64>> = serde_json::from_value(columns.clone()).unwrap();
        let about = self.model.about();
        let (states, inputs) = (about.states.len(), about.inputs.len());
        let moving: Vec<f64> = (0..states + inputs)
            .map(|k| 1e-3 * (k as f64 + 1.0) * [1.0, -1.0][k % 2])
            .collect();
        let point: Vec<f64> = moving.iter().chain(self.values.as_slice()).copied().collect();
        let names = about
            .states
            .iter()
            .map(|own| &own.name)
            .chain(about.inputs.iter().map(|own| &own.name));
        let names = names.chain(about.parameters.iter().map(|own| &own.name));
        for (place, name) in names.enumerate() {
            let h = 1e-6 * point[place].abs().max(1e-6);
            let at = |shift: f64| {
                let mut moved = point.clone();
                moved[place] += shift;
                self.evaluate(&moved)
            };
            let (low, high) = (at(-h), at(h));
            for (row, given) in columns[&**name].iter().enumerate() {
                let expected = (high[row] - low[row]) / (2.0 * h);
                // Rounding of the difference, and its curvature.
                let allowed = 1e-5 * expected.abs() + 1e-9 * high[row].abs() / h + 1e-9;
                assert!(
                    (given - expected).abs() < allowed,
                    "row {row} by {name}: {given} and {expected}"
                );
            }
        }
    }

    fn evaluate(&self, point: &[f64]) -> Vec<f64> {
        let about = self.model.about();
        let (x, rest) = point.split_at(about.states.len());
        let (u, p) = rest.split_at(about.inputs.len());
        let mut constants = vec![0.0; about.constants];
        self.model.prepare(p, &mut constants);
        let (mut dx, mut y) = (vec![0.0; about.states.len()], vec![0.0; about.outputs.len()]);
        self.model.derivative(&constants, x, u, &mut dx);
        self.model.outputs(&constants, x, u, &mut y);
        [dx, y].concat()
    }
}

/// What inputs do between their samples.
#[derive(Clone, Copy, PartialEq)]
pub enum Between {
    Straight,
    /// They stay, and outputs at a sample are of the inputs before it.
    Before,
    /// They stay, and outputs at a sample are of its inputs.
    After,
}

/// A model between two samples of its inputs.
struct Driven<'a> {
    subject: &'a Subject,
    samples: Vec<Vec<f64>>,
    leg: usize,
    between: Between,
}

impl Driven<'_> {
    fn inputs(&self, t: f64) -> Vec<f64> {
        let part = match self.between {
            Between::Straight => t * RATE - self.leg as f64,
            Between::Before | Between::After => 0.0,
        };
        let at = |row: &Vec<f64>| row[self.leg] + part * (row[(self.leg + 1).min(SAMPLES - 1)] - row[self.leg]);
        self.samples.iter().map(at).collect()
    }
}

impl System for Driven<'_> {
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        let u = self.inputs(t);
        self.subject.model.derivative(&self.subject.constants, x, &u, dx);
    }
}
