//! Metrics and their derivatives, against metrics of axles whose parameters are moved.

use models::axle_d::AxleD;
use qcar_runtime::campaign::RoleNames;
use qcar_runtime::metric::{Course, Ground, What};
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::sensitivity::{ParameterUncertainty, elasticities};
use qcar_runtime::simulate::{Method, Settings};

use super::cleat;
use super::general::General;

const COURSES: [&str; 2] = ["30kmh_20mm", "40kmh_30mm"];

fn ground(values: &Values) -> Ground<'static> {
    ground_of(&AxleD, values, &COURSES)
}

fn ground_of<'a>(model: &'a dyn Model, values: &Values, courses: &[&str]) -> Ground<'a> {
    let parameters = cleat::parameters();
    let car = cleat::car(&parameters);
    let all = Course::standard().expect("the standard cleats are roads");
    let some = all.into_iter().filter(|course| courses.contains(&course.name.as_str()));
    Ground::new(
        model,
        values,
        &RoleNames::default(),
        Some((car.tyre, car.load)),
        some.collect(),
    )
}

/// Parameters that a designer moves, by their places.
fn open() -> Vec<usize> {
    let all = AxleD.about().parameters.iter().enumerate();
    all.filter(|(_, own)| !own.known && !own.name.starts_with("static"))
        .map(|(place, _)| place)
        .collect()
}

/// By fourth order, with each parameter moved by a part of itself.
fn differences(ground: &Ground<'_>, values: &Values, parameter: usize, part: f64) -> Vec<f64> {
    let moved = |times: f64| {
        let mut moved = values.clone();
        moved.set(parameter, values.as_slice()[parameter] * (1.0 + times * part));
        ground.measure(&moved).expect("it is measured")
    };
    let [up, down, far_up, far_down] = [1.0, -1.0, 2.0, -2.0].map(moved);
    (0..up.len())
        .map(|at| (8.0 * (up[at] - down[at]) - (far_up[at] - far_down[at])) / (12.0 * part))
        .collect()
}

/// Measures all metrics that are chosen from now on.
fn choose(ground: &mut Ground<'_>, chosen: fn(What) -> bool) {
    let metrics = 0..ground.metrics().len();
    let readings = metrics
        .filter(|&at| chosen(ground.metrics()[at].what))
        .flat_map(|at| ground.readings_of(at))
        .collect();
    ground.choose(readings);
    assert!(!ground.readings().is_empty());
}

fn hold(ground: &Ground<'_>, parameters: &[usize], part: f64, tolerance: f64) {
    let values = cleat::parameters();
    let found = elasticities(ground, &values, parameters).expect("they are measured");
    for (k, &parameter) in parameters.iter().enumerate() {
        for (at, difference) in differences(ground, &values, parameter, part).into_iter().enumerate() {
            let (found, exact) = (found.elasticities[at][k], difference / found.values[at]);
            let name = &ground.metrics()[ground.readings()[at].metric].name;
            assert!(
                (found - exact).abs() < tolerance,
                "{name} by {}: {found} and {exact}",
                AxleD.about().parameters[parameter].name
            );
        }
    }
}

/// Eigenvalues and magnitudes have some twelve digits, of which the difference leaves eight; a frequency of a peak is
/// known less well.
#[test]
fn derivatives_of_vibrations_and_resonances_are_limits_of_differences() {
    let mut ground = ground(&cleat::parameters());
    choose(&mut ground, |what| !what.is_ridden());
    let parameters = open();
    assert!(parameters.len() > 15);
    hold(&ground, &parameters, 2e-4, 1e-5);
}

fn exact(tolerance: f64) -> Settings {
    Settings {
        method: Method::Adaptive(tolerance),
        ..Settings::default()
    }
}

/// One parameter of each kind, on rides so exact that their differences have seven digits.
#[test]
#[ignore = "dozens of exact rides; .ci/run runs it"]
fn derivatives_of_ridden_metrics_are_limits_of_differences() {
    let model = General::new();
    let mut ground = ground_of(&model, &cleat::parameters(), &COURSES[1..]).riding(exact(1e-14));
    choose(&mut ground, What::is_ridden);
    let kinds = ["m_wheel", "k_tire", "c_wheel_z", "k_wheel_x", "mr_damper"];
    let place = |name: &&str| model.about().parameters.iter().position(|own| own.name == **name);
    let parameters: Vec<usize> = kinds.iter().filter_map(place).collect();
    assert_eq!(parameters.len(), kinds.len());
    hold(&ground, &parameters, 1e-4, 1e-6);
}

/// The rides of a linear axle are integrated by the exponential method with a tolerance of 1e-6. No elasticity is off by more than 5e-4 for it.
#[test]
fn elasticities_at_the_usual_tolerance_are_those_of_exact_rides() {
    let values = cleat::parameters();
    let model = General::new();
    let (mut usual, mut exact) = (
        ground(&values),
        ground_of(&model, &values, &COURSES).riding(exact(1e-11)),
    );
    let of = |ground: &mut Ground<'_>| {
        choose(ground, What::is_ridden);
        elasticities(ground, &values, &open()).expect("they are measured")
    };
    let (found, limit) = (of(&mut usual), of(&mut exact));
    let pairs = found
        .elasticities
        .iter()
        .flatten()
        .zip(limit.elasticities.iter().flatten());
    let worst = pairs.map(|(found, limit)| (found - limit).abs()).fold(0.0, f64::max);
    assert!(worst < 5e-4, "{worst:e}");
}

#[test]
fn the_travel_is_that_of_the_wheel_over_the_body() {
    let values = cleat::parameters();
    let mut ground = ground(&values);
    let place = ground
        .metrics()
        .iter()
        .position(|metric| metric.name == "suspension.travel")
        .expect("it is there");
    ground.choose(ground.readings_of(place));
    for travel in ground.measure(&values).expect("it is measured") {
        // Over a cleat of 20 or 30 mm the suspension gives way by about that.
        assert!((0.005..0.05).contains(&travel), "{travel}");
    }
}

/// To first order a metric scatters as designs that are drawn.
#[test]
fn an_interval_is_that_of_drawn_designs() {
    let values = cleat::parameters();
    let mut ground = ground(&values);
    let names = ["body_z.after_shake", "wheel_z.peak"];
    let places = names.map(|name| {
        ground
            .metrics()
            .iter()
            .position(|metric| metric.name == name)
            .expect("it is there")
    });
    let readings = places.iter().flat_map(|&at| ground.readings_of(at)).collect();
    ground.choose(readings);
    let parameters = open();
    let found = elasticities(&ground, &values, &parameters).expect("they are measured");
    let tolerances: Vec<f64> = parameters.iter().map(|&k| 0.03 * values.as_slice()[k]).collect();
    let mut uncertainty = ParameterUncertainty::none(parameters.len());
    uncertainty.add_tolerances(&tolerances);
    let points = qcar_runtime::random::SplitMix::new(5).hypercube(600, parameters.len());
    let drawn = points.iter().map(|point| {
        let mut moved = values.clone();
        for ((&k, u), tolerance) in parameters.iter().zip(point).zip(&tolerances) {
            moved.set(k, values.as_slice()[k] + tolerance * (2.0 * u - 1.0));
        }
        ground.measure(&moved).expect("it is measured")
    });
    let drawn: Vec<Vec<f64>> = drawn.collect();
    for at in 0..found.values.len() {
        let mean = drawn.iter().map(|own| own[at]).sum::<f64>() / drawn.len() as f64;
        let variance = drawn.iter().map(|own| (own[at] - mean).powi(2)).sum::<f64>() / drawn.len() as f64;
        // A standard deviation of 600 is known to 3 %; the rest is what is not linear.
        let ratio = uncertainty.of(&found.slopes[at]).deviation / variance.sqrt();
        assert!((0.9..1.1).contains(&ratio), "{ratio}");
    }
}
