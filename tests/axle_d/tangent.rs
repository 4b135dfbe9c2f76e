//! Derivatives of a ride, against rides whose parameters are moved.

use qcar_runtime::simulate::{Drive, Method, Settings, Tangent, ride, tangent};

use crate::cleat;

/// So exact that a difference of two rides still has eight digits.
fn settings() -> Settings {
    Settings {
        method: Method::Adaptive(1e-12),
        ..Settings::default()
    }
}

/// By steps of a length of their own: neither the method nor the steps are those of the tangent, and between rides whose
/// parameters differ the steps do not.
fn referee() -> Settings {
    Settings {
        method: Method::Fixed(2e-5),
        ..Settings::default()
    }
}

/// The signals of a ride with parameter `k` moved by a part of itself, in the order of a [`Tangent`].
fn moved(k: usize, part: f64, drive: &Drive<'_>) -> Vec<Vec<f64>> {
    let mut parameters = cleat::parameters();
    let value = parameters.as_slice()[k];
    parameters.set(k, value * (1.0 + part));
    let ride = ride(&cleat::car(&parameters), drive, &referee()).expect("it rides");
    let [vertical, _] = ride.force;
    ride.outputs.into_iter().chain([vertical]).collect()
}

/// The derivative by that part, by differences of fourth order.
fn difference(k: usize, drive: &Drive<'_>) -> Vec<Vec<f64>> {
    const PART: f64 = 1e-3;
    let rides = [1.0, -1.0, 2.0, -2.0].map(|times| moved(k, times * PART, drive));
    let signals = 0..rides[0].len();
    let at = |signal: usize, i: usize| {
        let [up, down, far_up, far_down] = rides.each_ref().map(|ride| ride[signal][i]);
        (8.0 * (up - down) - (far_up - far_down)) / (12.0 * PART)
    };
    signals
        .map(|signal| (0..rides[0][signal].len()).map(|i| at(signal, i)).collect())
        .collect()
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| most.max(value.abs()))
}

fn along_each(drive: &Drive<'_>, settings: &Settings) -> Tangent {
    let parameters = cleat::parameters();
    let unit = |k: usize| -> Vec<f64> {
        let own = parameters.as_slice().iter().enumerate();
        own.map(|(at, value)| if at == k { *value } else { 0.0 }).collect()
    };
    let directions: Vec<_> = (0..parameters.as_slice().len()).map(unit).collect();
    tangent(&cleat::car(&parameters), drive, settings, &directions).expect("it rides")
}

#[test]
fn sensitivities_are_the_limit_of_differences() {
    let road = cleat::cleat(0.03);
    let drive = cleat::drive(&road, 30.0 / 3.6);
    let tangent = along_each(&drive, &settings());
    for (k, slopes) in tangent.slopes.iter().enumerate() {
        for (signal, (slope, difference)) in slopes.iter().zip(difference(k, &drive)).enumerate() {
            let size = largest(tangent.signals[signal].iter().copied());
            let error = largest(slope.iter().zip(&difference).map(|(a, b)| a - b)) / size;
            assert!(error < 1e-6, "signal {signal} by parameter {k}: {error:e} of its peak");
        }
    }
}

#[test]
fn the_usual_tolerance_is_enough_for_a_sensitivity() {
    let road = cleat::cleat(0.02);
    let drive = cleat::drive(&road, 20.0 / 3.6);
    let (usual, whole) = (
        along_each(&drive, &Settings::default()),
        along_each(&drive, &settings()),
    );
    for (found, exact) in usual.slopes.iter().zip(&whole.slopes) {
        for (signal, (found, exact)) in found.iter().zip(exact).enumerate() {
            let size = largest(whole.signals[signal].iter().copied());
            let error = largest(found.iter().zip(exact).map(|(a, b)| a - b)) / size;
            assert!(error < 1e-3, "signal {signal}: {error:e} of its peak");
        }
    }
}
