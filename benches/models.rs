//! Times of compiled models: matrices, responses, a fit, and the compiler itself. `docs/benchmarks.md` has the table.

mod fit;
mod subject;

use divan::{Bencher, black_box};
use qcar_dsl::disk::compile_file;
use qcar_dsl::rust::module;
use qcar_runtime::fit::Setup;
use std::path::Path;
use subject::{MODEL, Sets, Subject};

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
    let mut subject = Subject::new(MODEL);
    bencher.bench_local(|| black_box(&mut subject).linearise());
}

/// The same for eight parameter sets together.
#[divan::bench(sample_size = 1000)]
fn matrices_and_jacobians_of_eight_sets(bencher: Bencher) {
    let mut sets = Sets::new(MODEL);
    bencher.bench_local(|| black_box(&mut sets).linearise());
}

/// Three hundred lines of five channels with the full Jacobian.
#[divan::bench]
fn response_and_jacobian(bencher: Bencher) {
    let mut subject = Subject::new(MODEL);
    bencher.bench_local(|| black_box(&mut subject).respond());
}

/// The same for eight parameter sets together, four lines at a time.
#[divan::bench]
fn response_and_jacobian_of_eight_sets(bencher: Bencher) {
    let mut sets = Sets::new(MODEL);
    bencher.bench_local(|| black_box(&mut sets).respond());
}

/// The equations of motion once.
#[divan::bench(sample_size = 1000)]
fn derivative(bencher: Bencher) {
    let subject = Subject::new(MODEL);
    let mut dx = vec![0.0; subject.x.len()];
    bencher.bench_local(|| MODEL.derivative(black_box(&subject.constants), &subject.x, &subject.u, &mut dx));
}

/// One local search over twelve parameters at three hundred lines, from starts 20 % off.
#[divan::bench]
fn fit_of_twelve(bencher: Bencher) {
    let (plan, levels) = (fit::plan(), [fit::level()]);
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
