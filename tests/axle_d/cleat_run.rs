//! The cleat run of the benchmark, against itself at a tolerance that leaves nothing to be desired.

use models::axle_d::AxleD;
use qcar_runtime::model::Model;
use qcar_runtime::simulate::{Method, Ride, Settings, ride};

use crate::cleat;

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
                error < 1e-3,
                "{kmh} km/h, {height} m: {} is off by {error} of its peak",
                output.name
            );
        }
        for (found, exact) in found.force.iter().zip(&exact.force) {
            assert!(
                error(found, exact) < 1e-5,
                "{kmh} km/h, {height} m: {}",
                error(found, exact)
            );
        }
    }
}
