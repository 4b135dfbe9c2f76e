//! The cleat run of the benchmark, against itself at a tolerance that leaves nothing to be desired.

use models::axle_d::AxleD;
use qcar_runtime::model::Model;
use qcar_runtime::road::{Class, Random, Road};
use qcar_runtime::simulate::{Method, Ride, Settings, SimulateError, ride};
use qcar_runtime::solver::Reason;

use super::cleat;

fn ridden(kmh: f64, height: f64, tolerance: f64) -> Ride {
    let (parameters, road) = (cleat::parameters(), cleat::cleat(height));
    let settings = Settings {
        method: Method::Adaptive(tolerance),
        ..Settings::default()
    };
    ride(&cleat::car(&parameters), &cleat::drive(&road, kmh / 3.6), &settings).expect("it rides")
}

/// The largest difference over the whole run, over the peak.
fn error(found: &[f64], exact: &[f64]) -> f64 {
    let differences = found.iter().zip(exact).map(|(found, exact)| (found - exact).abs());
    differences.fold(0.0, f64::max) / exact.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

#[test]
fn every_signal_is_right_through_the_whole_transient() {
    for (kmh, height) in [(30.0, 0.03), (20.0, 0.01), (40.0, 0.04)] {
        let (found, exact) = (ridden(kmh, height, 1e-6), ridden(kmh, height, 1e-11));
        assert!(found.effort.evaluations < exact.effort.evaluations / 4);
        for (output, (found, exact)) in AxleD
            .about()
            .outputs
            .iter()
            .zip(found.outputs.iter().zip(&exact.outputs))
        {
            let error = error(found, exact);
            assert!(
                error < 3e-4,
                "{kmh} km/h, {height} m: {} is off by {error} of its peak",
                output.name
            );
        }
        for (found, exact) in found.force.iter().zip(&exact.force) {
            assert!(
                error(found, exact) < 3e-6,
                "{kmh} km/h, {height} m: {}",
                error(found, exact)
            );
        }
    }
}

#[test]
fn a_rough_road_takes_hardly_more_than_a_step_a_sample() {
    let parameters = cleat::parameters();
    let random = Random {
        class: Class::C,
        seed: 3,
        length: 20.0,
        spacing: 0.01,
    };
    let road = Road::from_random(&random).expect("a road");
    let drive = cleat::drive(&road, 30.0 / 3.6);
    let ridden = |tolerance| {
        let settings = Settings {
            method: Method::Adaptive(tolerance),
            ..Settings::default()
        };
        ride(&cleat::car(&parameters), &drive, &settings).expect("it rides")
    };
    let (found, exact) = (ridden(1e-6), ridden(1e-11));
    assert!(found.effort.evaluations < 1300, "{:?}", found.effort);
    for (found, exact) in found.outputs.iter().zip(&exact.outputs) {
        assert!(error(found, exact) < 3e-4, "{}", error(found, exact));
    }
    for (found, exact) in found.force.iter().zip(&exact.force) {
        assert!(error(found, exact) < 3e-6, "{}", error(found, exact));
    }
}

#[test]
fn a_ride_attempts_no_more_steps_than_allowed_by_all_methods_together() {
    let (parameters, road) = (cleat::parameters(), cleat::cleat(0.03));
    let (car, drive) = (cleat::car(&parameters), cleat::drive(&road, 30.0 / 3.6));
    let with = |most_steps| {
        let settings = Settings {
            most_steps,
            ..Settings::default()
        };
        ride(&car, &drive, &settings)
    };
    let effort = with(10_000).expect("it rides").effort;
    let steps = effort.accepted + effort.rejected;
    assert!(with(steps).is_ok());
    // The exponential method takes most of them, and the last.
    for most in [steps / 2, steps - 1] {
        let Err(SimulateError::Stopped { report, .. }) = with(most) else {
            panic!("{most} of {steps} steps are not enough");
        };
        assert_eq!(report.reason, Reason::TooManySteps);
        assert_eq!(report.effort.accepted + report.effort.rejected, most);
    }
}

#[test]
fn steps_from_sample_to_sample_agree_with_short_ones() {
    let (parameters, road) = (cleat::parameters(), cleat::cleat(0.1));
    let car = cleat::car(&parameters);
    // So high and fast that the tyre leaves the ground.
    let drive = cleat::drive(&road, 42.0 / 3.6);
    let ridden = |method| {
        let settings = Settings {
            method,
            ..Settings::default()
        };
        ride(&car, &drive, &settings).expect("it rides")
    };
    let exact = ridden(Method::Fixed(2e-5));
    assert_eq!((exact.lift_offs.len(), exact.landings.len()), (1, 1));
    // At the smaller tolerance the motion is handed back and forth between the two methods.
    for (tolerance, most) in [(1e-6, 1200), (1e-7, 3000)] {
        let found = ridden(Method::Adaptive(tolerance));
        assert!(found.effort.evaluations < most, "{:?}", found.effort);
        assert!((found.lift_offs[0] - exact.lift_offs[0]).abs() < 1e-6);
        assert!((found.landings[0] - exact.landings[0]).abs() < 1e-6);
        for (found, exact) in found.outputs.iter().zip(&exact.outputs) {
            assert!(error(found, exact) < 1e-3, "{}", error(found, exact));
        }
        for (found, exact) in found.force.iter().zip(&exact.force) {
            assert!(error(found, exact) < 1e-5, "{}", error(found, exact));
        }
    }
}
