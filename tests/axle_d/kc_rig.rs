//! Models on a K&C rig against the closed forms of springs in series and on levers.

use models::axle_d::AxleD;
use qcar_runtime::kc::{Slope, gradient, value_for};
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::roles::OnRig;

use super::cleat;

fn place(name: &str) -> usize {
    let mut parameters = AxleD.about().parameters.iter();
    parameters
        .position(|parameter| parameter.name == name)
        .expect("axle_d has it")
}

fn of(values: &Values, name: &str) -> f64 {
    values.as_slice()[place(name)]
}

fn on(body: &str) -> OnRig {
    let [wheel, body] = ["wheel", body].map(String::from);
    OnRig { wheel, body }
}

fn found(values: &Values, axis: &str, slope: Slope) -> f64 {
    gradient(&AxleD, values.as_slice(), &on("body"), axis, slope).expect("it has a gradient")
}

fn assert_close(found: f64, exact: f64) {
    assert!((found / exact - 1.0).abs() < 1e-5, "{found} {exact}");
}

#[test]
fn along_x_wheel_and_sub_frame_yield_in_series() {
    let values = cleat::parameters();
    let series = |wheel: f64, sub_frame: f64| wheel * sub_frame / (wheel + sub_frame);
    let exact = series(of(&values, "k_wheel_x"), of(&values, "k_sf_x"));
    assert_close(found(&values, "x", Slope::Stiffness), exact);
}

#[test]
fn along_z_the_sub_frame_yields_to_the_arms_that_turn_about_it() {
    let values = cleat::parameters();
    let [k, c, k_sf, c_sf] = ["k_wheel_z", "c_wheel_z", "k_sf_z", "c_sf_z"].map(|name| of(&values, name));
    let [spring, damper] = ["mr_spring", "mr_damper"].map(|name| of(&values, name));
    // With the wheel moved by 1 and the sub-frame by y, a spring on an arm is stretched by r + (1 - r) y.
    let rate = k / spring.powi(2);
    let yielding = -rate * spring * (1.0 - spring) / (k_sf + rate * (1.0 - spring).powi(2));
    let stiffness = rate * (spring + (1.0 - spring) * yielding).powi(2) + k_sf * yielding.powi(2);
    assert_close(found(&values, "z", Slope::Stiffness), stiffness);
    let travel = damper + (1.0 - damper) * yielding;
    let damping = c / damper.powi(2) * travel.powi(2) + c_sf * yielding.powi(2);
    assert_close(found(&values, "z", Slope::Damping), damping);
}

#[test]
fn a_parameter_is_found_from_the_gradient_that_it_gives() {
    let values = cleat::parameters();
    for (name, axis, slope) in [
        ("k_wheel_x", "x", Slope::Stiffness),
        ("k_wheel_z", "z", Slope::Stiffness),
        ("c_wheel_z", "z", Slope::Damping),
    ] {
        let measured = found(&values, axis, slope);
        let value = value_for(&AxleD, &values, place(name), (&on("body"), axis, slope), measured);
        assert_close(value.expect("there is one"), of(&values, name));
        // Springs in series are never stiffer than the other one.
        let beyond = value_for(&AxleD, &values, place(name), (&on("body"), axis, slope), 1e9);
        assert_eq!(beyond, None, "{name}");
    }
}

#[test]
fn what_is_not_there_has_no_gradient() {
    let values = cleat::parameters();
    let of = |body, axis| gradient(&AxleD, values.as_slice(), &on(body), axis, Slope::Stiffness);
    assert_eq!([of("roof", "z"), of("body", "y")], [None, None]);
}
