//! Cleat runs of a second: z and x chains of axle_d, area tyre, relative tolerance 1e-6.

mod cleat;

use cleat::{car, cleat, drive, parameters};
use divan::Bencher;
use qcar_runtime::progress::UNTOLD;
use qcar_runtime::simulate::{Settings, end_of_ride, ride, rides};

fn main() {
    divan::main();
}

/// 30 km/h over 30 mm on one core, with all signals through the anti-alias filter.
#[divan::bench]
fn cleat_run(bencher: Bencher<'_, '_>) {
    let (parameters, road) = (parameters(), cleat(0.03));
    let (car, drive) = (car(&parameters), drive(&road, 30.0 / 3.6));
    bencher.bench_local(|| ride(&car, &drive, &Settings::default()).expect("it rides"));
}

/// The same without a record: what other programs' figures are of.
#[divan::bench]
fn cleat_run_unrecorded(bencher: Bencher<'_, '_>) {
    let (parameters, road) = (parameters(), cleat(0.03));
    let (car, drive) = (car(&parameters), drive(&road, 30.0 / 3.6));
    bencher.bench_local(|| end_of_ride(&car, &drive, &Settings::default()).expect("it rides"));
}

/// 20, 30, 40 km/h over 10, 20, 30, 40 mm on all cores.
#[divan::bench]
fn twelve_cleat_runs(bencher: Bencher<'_, '_>) {
    let (parameters, roads) = (parameters(), [0.01, 0.02, 0.03, 0.04].map(cleat));
    let car = car(&parameters);
    let drives: Vec<_> = [20.0, 30.0, 40.0]
        .into_iter()
        .flat_map(|kmh| roads.iter().map(move |r| drive(r, kmh / 3.6)))
        .collect();
    bencher.bench_local(|| rides(&car, &drives, &Settings::default(), UNTOLD));
}
