//! Derivatives of rides on a point contact, whose force jumps at steps and bends of the road and when it lands.

use models::axle_d::AxleD;
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::road::Road;
use qcar_runtime::sensitivity::direction;
use qcar_runtime::simulate::{Car, Drive, Method, Ride, Settings, Tangent, Variant, ride, tangent, variation};
use qcar_runtime::tyre::Geometry;

use super::cleat;
use super::general::General;

/// Parameters of the tyre, of masses and of the suspension.
const NAMES: [&str; 5] = ["k_tire", "c_tire", "m_wheel", "k_wheel_z", "c_sf_z"];
/// At no recorded point the wheel is on a corner of the road.
const SPEED: f64 = 8.21;

/// A step up, a ramp down, and a step down.
fn bar(height: f64) -> Road {
    let points = [
        [0.0, 0.0],
        [1.5, 0.0],
        [1.5, height],
        [1.7, height],
        [1.9, 0.6 * height],
        [1.9, 0.0],
        [60.0, 0.0],
    ];
    Road::from_points(&points).expect("a road")
}

fn drive(road: &Road, samples: usize) -> Drive<'_> {
    Drive {
        samples,
        ..cleat::drive(road, SPEED)
    }
}

fn settings(tolerance: f64) -> Settings {
    Settings {
        method: Method::Adaptive(tolerance),
        ..Settings::default()
    }
}

fn place(name: &str) -> usize {
    let mut parameters = AxleD.about().parameters.iter();
    parameters.position(|own| own.name == name).expect("axle D has it")
}

/// Axle D on a point contact.
fn car<'a, M: Model>(model: &'a M, parameters: &'a Values, variant: Variant) -> Car<'a, M> {
    let own = cleat::on_tyre(model, parameters);
    Car {
        tyre: own.tyre.with_geometry(Geometry::Point),
        variant,
        ..own
    }
}

fn ridden(name: &str, part: f64, variant: Variant, drive: &Drive<'_>) -> Ride {
    let mut parameters = cleat::parameters();
    let value = parameters.as_slice()[place(name)];
    parameters.set(place(name), value * (1.0 + part));
    ride(&car(&General::new(), &parameters, variant), drive, &settings(1e-13)).expect("it rides")
}

fn along_each(variant: Variant, drive: &Drive<'_>, tolerance: f64) -> Tangent {
    let parameters = cleat::parameters();
    let directions: Vec<_> = NAMES.iter().map(|name| direction(&parameters, place(name))).collect();
    tangent(
        &car(&AxleD, &parameters, variant),
        drive,
        &settings(tolerance),
        &directions,
    )
    .expect("it rides")
}

/// The largest error of the derivatives of some signals, against differences of fourth order of rides: a part of the
/// signal.
fn worst(found: &Tangent, signals: &[usize], variant: Variant, drive: &Drive<'_>) -> (f64, usize, &'static str) {
    // An event must not pass a sample within a difference, and the error of a ride must be far below it.
    const PART: f64 = 5e-4;
    let mut worst = (0.0, 0, "");
    for (name, slopes) in NAMES.into_iter().zip(&found.slopes) {
        let rides = [1.0, -1.0, 2.0, -2.0].map(|times| {
            let ride = ridden(name, times * PART, variant, drive);
            let [vertical, _] = ride.force;
            ride.outputs.into_iter().chain([vertical]).collect::<Vec<_>>()
        });
        for &signal in signals {
            let still = &found.signals[signal];
            let (mut off, mut size) = (0.0, 0.0);
            for (i, slope) in slopes[signal].iter().enumerate() {
                let [up, down, far_up, far_down] = rides.each_ref().map(|ride| ride[signal][i]);
                let difference = (8.0 * (up - down) - (far_up - far_down)) / (12.0 * PART);
                off += (slope - difference).powi(2);
                size += (still[i] - still[0]).powi(2);
            }
            let error = (off / size).sqrt();
            if error > worst.0 {
                worst = (error, signal, name);
            }
        }
    }
    worst
}

/// Nothing moves along the road, so every jump has its time.
#[test]
fn derivatives_of_a_point_contact_are_the_limit_of_differences() {
    let road = bar(0.004);
    let drive = drive(&road, 501);
    let still = ridden("k_tire", 0.0, Variant::PureVertical, &drive);
    assert!(still.lift_offs.is_empty() && still.force[0][300] > 0.0);
    let found = along_each(Variant::PureVertical, &drive, 1e-12);
    let moving: Vec<usize> = (0..found.signals.len())
        .filter(|&signal| {
            found.signals[signal]
                .iter()
                .any(|value| *value != found.signals[signal][0])
        })
        .collect();
    assert!(moving.len() > 4);
    let worst = worst(&found, &moving, Variant::PureVertical, &drive);
    assert!(worst.0 < 1e-6, "{worst:?}");
}

/// The wheel moves along the road, leaves it and lands: the times of all events depend on the parameters.
#[test]
fn derivatives_jump_where_the_force_of_a_point_contact_does() {
    let road = bar(0.06);
    let drive = drive(&road, 501);
    let still = ridden("k_tire", 0.0, Variant::Complete, &drive);
    assert!(!still.landings.is_empty(), "it stays on the ground");
    let found = along_each(Variant::Complete, &drive, 1e-12);
    let worst = worst(&found, &[found.signals.len() - 1], Variant::Complete, &drive);
    assert!(worst.0 < 1e-6, "{worst:?}");
}

/// The force of the tyre is a sample, but an acceleration passes the filter, so a jump that shifts counts as an impulse.
/// At the end the wheel is at rest for all parameters, so the derivative of its acceleration has no integral.
#[test]
fn a_jump_that_shifts_is_an_impulse_in_the_derivative() {
    let road = bar(0.06);
    let drive = drive(&road, 4001);
    let wheel = AxleD.about().outputs.iter();
    let wheel = wheel.clone().position(|output| output.name == "z_wheel_acceleration");
    let found = along_each(Variant::Complete, &drive, 1e-8);
    for (name, slopes) in NAMES.iter().zip(&found.slopes) {
        let mut sum = 0.0;
        let sums: Vec<f64> = slopes[wheel.expect("it is measured")]
            .iter()
            .map(|slope| {
                sum += slope / drive.sample_rate;
                sum
            })
            .collect();
        let largest = sums.iter().map(|sum| sum.abs()).fold(0.0, f64::max);
        assert!(sum.abs() < 5e-3 * largest, "{name}: {sum} of {largest}");
    }
}

/// A fit takes the same derivatives, to the accuracy of its rides.
#[test]
fn a_fit_takes_them_for_a_linear_axle_on_a_point_contact() {
    const PART: f64 = 1e-4;
    let road = bar(0.004);
    let (drive, parameters) = (drive(&road, 501), cleat::parameters());
    let exact = along_each(Variant::PureVertical, &drive, 1e-12);
    let outputs: Vec<usize> = (0..AxleD.about().outputs.len()).collect();
    for (name, exact_slopes) in NAMES.iter().zip(&exact.slopes) {
        let mut moved = parameters.clone();
        moved.set(place(name), parameters.as_slice()[place(name)] * (1.0 + PART));
        let car = car(&AxleD, &parameters, Variant::PureVertical);
        let found = variation(&car, &drive, &outputs, &[(moved.as_slice(), PART)], 1).expect("it rides");
        for (signal, found) in found[0].iter().enumerate() {
            let square = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
            let off = square(
                &mut found
                    .iter()
                    .zip(&exact_slopes[signal])
                    .map(|(found, exact)| found - exact),
            );
            let size = square(&mut exact.signals[signal].iter().copied());
            assert!(off <= 1e-4 * size, "{name}, {signal}: {off} of {size}");
        }
    }
}
