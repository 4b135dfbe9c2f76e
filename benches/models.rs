//! Times of compiled models: matrices, responses, a fit, and the compiler itself. `docs/benchmarks.md` has the table.

mod subject;

use divan::{Bencher, black_box};
use nalgebra::Complex;
use qcar_dsl::disk::compile_file;
use qcar_dsl::rust::module;
use qcar_runtime::campaign::{Parameter, Role};
use qcar_runtime::fit::{Level, Observation, Plan, Setup, Weighting};
use std::path::Path;
use subject::{MODEL, Sets, Subject, frequency};

fn main() {
    let about = MODEL.about();
    let nonzeros = about.matrices.len() + about.sensitivities.len();
    println!(
        "axle_d, vertical: {} parameters, {nonzeros} nonzeros of A, B, C, D and their Jacobians",
        about.parameters.len()
    );
    divan::main();
}

/// A, B, C, D and all their parameter Jacobians.
#[divan::bench(sample_size = 1000)]
fn matrices_and_jacobians(bencher: Bencher) {
    let mut subject = Subject::new();
    bencher.bench_local(|| black_box(&mut subject).linearise());
}

/// The same of eight parameter sets together.
#[divan::bench(sample_size = 1000)]
fn matrices_and_jacobians_of_eight_sets(bencher: Bencher) {
    let mut sets = Sets::new();
    bencher.bench_local(|| black_box(&mut sets).linearise());
}

/// Three hundred lines of five channels with the full Jacobian.
#[divan::bench]
fn response_and_jacobian(bencher: Bencher) {
    let mut subject = Subject::new();
    bencher.bench_local(|| black_box(&mut subject).respond());
}

/// The equations of motion once.
#[divan::bench(sample_size = 1000)]
fn derivative(bencher: Bencher) {
    let subject = Subject::new();
    let mut dx = vec![0.0; subject.x.len()];
    bencher.bench_local(|| MODEL.derivative(black_box(&subject.constants), &subject.x, &subject.u, &mut dx));
}

/// One local search over twelve parameters at three hundred lines, from starts 20 % off.
#[divan::bench]
fn fit_of_twelve(bencher: Bencher) {
    let (plan, levels) = (plan(), [level()]);
    let setup = Setup::new(MODEL, &plan, &levels).expect("the plan suits the model");
    let start = setup.start();
    assert_eq!(start.len(), 12);
    bencher.bench_local(|| setup.local(black_box(&start)));
}

/// Model text to Rust text, files included.
#[divan::bench(args = ["quarter_car", "axle_d"])]
fn compile(name: &str) -> String {
    let from_disk =
        compile_file(Path::new("models"), &format!("axles/{name}.axle")).expect("a shipped model can be read");
    module(&from_disk.compiled.expect("a shipped model compiles"))
}

fn plan() -> Plan {
    let subject = Subject::new();
    let parameter = |(about, &value): (&qcar_runtime::model::Parameter, &f64)| Parameter {
        name: about.name.to_string(),
        value: if about.known { value } else { 1.2 * value },
        unit: about.unit.to_string(),
        range: (!about.known).then_some((0.5 * value, 2.0 * value)),
        fit: !about.known,
        comment: String::new(),
    };
    Plan {
        source: "benches".into(),
        parameters: MODEL.about().parameters.iter().zip(&subject.p).map(parameter).collect(),
        vehicle: Default::default(),
        channels: Default::default(),
        weighting: Weighting::Thesis,
        starts: 1,
        seed: 0,
        gain_error: 0.0,
    }
}

/// The model's own response as a measurement.
fn level() -> Level {
    let mut subject = Subject::new();
    subject.respond();
    let about = MODEL.about();
    let of_pad = about
        .channels
        .iter()
        .filter(|channel| channel.denominator.location == "pad");
    let observations = of_pad.map(|channel| {
        let output = about
            .outputs
            .iter()
            .position(|output| output.signal == channel.numerator);
        let output = output.expect("every numerator is an output");
        let row = about.responses[0]
            .outputs
            .iter()
            .position(|&responds| usize::from(responds) == output);
        let row = row.expect("every output responds to the pad");
        observation(channel.clone(), &subject, row)
    });
    Level {
        name: "model".into(),
        role: Role::Fit,
        excitation: 0,
        observations: observations.collect(),
    }
}

/// The acceleration over that of the pad, which is `-ω²` for a unit of displacement.
fn observation(channel: qcar_runtime::model::Channel, subject: &Subject, row: usize) -> Observation {
    let value = |(line, omega): (usize, &f64)| {
        let at = row * subject.omega.len() + line;
        Complex::new(subject.response[0][at], subject.response[1][at]) / -(omega * omega)
    };
    Observation {
        channel,
        fitted: true,
        frequency: (0..subject.omega.len()).map(frequency).collect(),
        value: subject.omega.iter().enumerate().map(value).collect(),
        relative_variance: vec![0.0; subject.omega.len()],
        coherence: vec![1.0; subject.omega.len()],
        band: (0.5, 30.0),
        sensors: (1, 1),
        differences: Vec::new(),
    }
}
