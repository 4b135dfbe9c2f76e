//! Cleat runs of a second: z and x chains of axle_d, area tyre, relative tolerance 1e-6.

mod cleat;

use cleat::{car, cleat, drive, parameters};
use divan::Bencher;
use models::axle_d::AxleD;
use qcar_runtime::model::Model;
use qcar_runtime::progress::NO_PROGRESS;
use qcar_runtime::simulate::{
    Car, RecordedSignals, RideCase, Settings, Standard, end_of_ride, ride, rides, rides_abreast,
};

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

/// The same without a record, for comparison with other programs.
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
    bencher.bench_local(|| rides(&car, &drives, &Settings::default(), NO_PROGRESS));
}

/// Eight different parameter sets.
fn sets() -> Vec<Vec<f64>> {
    let (own, about) = (parameters(), AxleD.about());
    let changed = |set: usize| {
        let values = own.as_slice().iter().zip(about.parameters.iter());
        let value = |(value, own): (&f64, &qcar_runtime::model::Parameter)| match own.known {
            true => *value,
            false => value * (1.0 + 0.003 * set as f64),
        };
        values.map(value).collect()
    };
    (0..8).map(changed).collect()
}

/// The twelve standard runs of eight parameter sets, one after another on one core.
#[divan::bench]
fn ninety_six_rides_alone(bencher: Bencher<'_, '_>) {
    let (sets, all) = (sets(), Standard::all().expect("the standard cleats are roads"));
    let own = parameters();
    let car = car(&own);
    bencher.bench_local(|| {
        for parameters in &sets {
            for standard in &all {
                let car = Car { parameters, ..car };
                divan::black_box(ride(&car, &standard.drive(), &Settings::default()).expect("it rides"));
            }
        }
    });
}

/// The same side by side on one core, with ten recorded accelerations.
#[divan::bench]
fn ninety_six_rides_abreast(bencher: Bencher<'_, '_>) {
    let (sets, all) = (sets(), Standard::all().expect("the standard cleats are roads"));
    let own = parameters();
    let car = car(&own);
    let of_set = |set| all.iter().map(move |standard| (set, standard.drive()));
    let rides: Vec<RideCase<'_>> = sets.iter().flat_map(|set| of_set(set.as_slice())).collect();
    let kept = RecordedSignals {
        force: false,
        area: false,
        ..RecordedSignals::all(AxleD.about())
    };
    bencher.bench_local(|| {
        rides_abreast(&car, &rides, &Settings::default(), &kept, |_, ride| {
            divan::black_box(ride.expect("it rides"));
        });
    });
}
