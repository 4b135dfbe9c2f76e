//! Instructions of compiled models, counted by valgrind: the same on a busy machine.

#![expect(
    missing_docs,
    reason = "the macros of gungraun make public items without documentation"
)]

mod subject;

use gungraun::{library_benchmark, library_benchmark_group};
use std::hint::black_box;
use std::process::{Command, Stdio};
use subject::{MODEL, Sets, Subject};

#[library_benchmark]
#[bench::axle_d(Subject::new(MODEL))]
fn matrices_and_jacobians(mut subject: Subject<'static>) -> Subject<'static> {
    black_box(&mut subject).linearise();
    subject
}

#[library_benchmark]
#[bench::axle_d(Sets::new(MODEL))]
fn matrices_and_jacobians_of_eight_sets(mut sets: Sets<'static>) -> Sets<'static> {
    black_box(&mut sets).linearise();
    sets
}

#[library_benchmark]
#[bench::axle_d(Subject::new(MODEL))]
fn response_and_jacobian(mut subject: Subject<'static>) -> Subject<'static> {
    black_box(&mut subject).respond();
    subject
}

#[library_benchmark]
#[bench::axle_d(Sets::new(MODEL))]
fn response_and_jacobian_of_eight_sets(mut sets: Sets<'static>) -> Sets<'static> {
    black_box(&mut sets).respond();
    sets
}

library_benchmark_group!(
    name = models;
    benchmarks = matrices_and_jacobians, matrices_and_jacobians_of_eight_sets, response_and_jacobian,
        response_and_jacobian_of_eight_sets
);

/// The counted functions.
#[expect(
    clippy::disallowed_methods,
    reason = "the macro of gungraun ends the process of a bench"
)]
mod counted {
    use super::models;
    gungraun::main!(library_benchmark_groups = models);

    /// Starts the counting, or runs as the counted process.
    pub fn run() {
        main();
    }
}

fn main() {
    let missing: Vec<&str> = ["valgrind", "gungraun-runner"]
        .into_iter()
        .filter(|tool| !is_there(tool))
        .collect();
    match missing.as_slice() {
        [] => counted::run(),
        _ => println!(
            "instructions are not counted: {} is not installed; write `apt-get install valgrind` and \
             `cargo install gungraun-runner --version 0.20.0`",
            missing.join(" and ")
        ),
    }
}

fn is_there(tool: &str) -> bool {
    Command::new(tool)
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok()
}
