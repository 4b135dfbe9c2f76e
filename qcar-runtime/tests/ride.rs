//! Rides of a hand-written model against what must hold of any ride.

use qcar_runtime::progress::NO_PROGRESS;
use qcar_runtime::road::{Road, RoadError};
use qcar_runtime::simulate::{Drive, Method, Ride, Settings, SimulateError, Variant, ride, rides};

use super::roller::{GAP, K_STOP, LOAD, OUTPUTS, RADIUS, Roller, STATIC_DEFLECTION, car, parameters};
use super::support::track::{cleat, drive};

fn flat() -> Road {
    Road::from_points(&[[0.0, 0.0], [20.0, 0.0]]).expect("it is a road")
}

fn ridden(variant: Variant, road: &Road, speed: f64, settings: &Settings) -> Ride {
    let (model, parameters) = (Roller::new(), parameters());
    let mut drive = drive(road, speed);
    drive.samples = drive.samples.min((12.0 / speed * drive.sample_rate) as usize);
    ride(&car(&model, &parameters, variant), &drive, settings).expect("it rides")
}

fn output<'a>(ride: &'a Ride, name: &str) -> &'a [f64] {
    &ride.outputs[OUTPUTS
        .iter()
        .position(|output| *output == name)
        .expect("it is an output")]
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

const ALL: [Variant; 3] = [Variant::Complete, Variant::LongitudinallyLocked, Variant::PureVertical];

#[test]
fn nothing_moves_on_a_flat_road() {
    for variant in ALL {
        let ride = ridden(variant, &flat(), 25.0 / 3.0, &Settings::default());
        assert!(
            (ride.static_deflection - STATIC_DEFLECTION).abs() < 1e-9,
            "{}",
            ride.static_deflection
        );
        for name in [
            "z_body_acceleration",
            "z_wheel_acceleration",
            "x_body_acceleration",
            "x_wheel_acceleration",
        ] {
            assert!(
                largest(output(&ride, name)) < 1e-9,
                "{variant:?} {name}: {}",
                largest(output(&ride, name))
            );
        }
        assert!(largest(output(&ride, "z_wheel")) < 1e-9);
        assert!(largest(output(&ride, "x_wheel")) < 1e-9);
        assert!(
            ride.force[0].iter().all(|force| (force - LOAD).abs() < 1e-4),
            "{variant:?}"
        );
        assert!(ride.lift_offs.is_empty() && ride.landings.is_empty());
    }
}

#[test]
fn a_bump_stop_sees_the_travel_from_the_design_position_and_no_sag() {
    let ridden = |height: f64, k_stop: f64| {
        let (model, mut p, road) = (Roller::new(), parameters(), cleat(height));
        p[K_STOP] = k_stop;
        let car = car(&model, &p, Variant::Complete);
        ride(&car, &drive(&road, 25.0 / 3.0), &Settings::default()).expect("it rides")
    };
    let travel = |ride: &Ride| {
        let wheel = output(ride, "z_wheel").iter();
        wheel
            .zip(output(ride, "z_body"))
            .fold(0.0, |most: f64, (wheel, body)| most.max(wheel - body))
    };
    let low = ridden(0.01, 500e3);
    assert!(travel(&low) < GAP && low == ridden(0.01, 0.0), "{}", travel(&low));
    let (high, free) = (ridden(0.06, 500e3), ridden(0.06, 0.0));
    assert!(
        travel(&free) > GAP + 0.005 && travel(&high) < travel(&free),
        "{} {}",
        travel(&high),
        travel(&free)
    );
}

#[test]
fn the_drag_of_a_rolling_tyre_is_balanced_and_a_point_has_none() {
    let traction = |variant| ridden(variant, &flat(), 10.0, &Settings::default()).traction;
    assert!(traction(Variant::Complete) > 1.0);
    assert_eq!(traction(Variant::LongitudinallyLocked), traction(Variant::Complete));
    assert_eq!(traction(Variant::PureVertical), 0.0);
}

#[test]
fn energy_that_is_fed_is_stored_or_lost() {
    let ride = ridden(Variant::Complete, &cleat(0.03), 25.0 / 3.0, &Settings::default());
    let imbalance = output(&ride, "imbalance");
    let start = imbalance[0];
    let swing = difference(&ride.force[0], &vec![ride.force[0][0]; ride.time.len()]);
    assert!(swing > 1000.0, "the cleat must be felt: {swing}");
    // Of the order of 100 J go through the suspension.
    assert!(imbalance.iter().all(|now| (now - start).abs() < 1e-3), "{start}");
}

#[test]
fn before_the_tyre_meets_the_cleat_nothing_moves_and_then_both_axes_do() {
    let speed = 25.0 / 3.0;
    let ride = ridden(Variant::Complete, &cleat(0.03), speed, &Settings::default());
    // The circle first meets the upper edge of the step; the filter looks ahead by 13 samples.
    let height: f64 = RADIUS - STATIC_DEFLECTION - 0.03;
    let meets = (1.5 - (RADIUS * RADIUS - height * height).sqrt()) / speed;
    let before = (meets * 1000.0) as usize - 13;
    for name in &OUTPUTS[..4] {
        let signal = output(&ride, name);
        assert!(largest(&signal[..before]) < 1e-9, "{name}");
        assert!(largest(&signal[before + 13..]) > 1.0, "{name}");
    }
    assert!(
        ride.force[1].iter().fold(0.0, |least: f64, f| least.min(*f)) < -500.0,
        "the cleat pushes back first"
    );
}

#[test]
fn both_methods_agree_through_the_whole_transient() {
    let road = cleat(0.03);
    let fixed = Settings {
        method: Method::Fixed(2e-5),
        ..Settings::default()
    };
    for variant in ALL {
        let adaptive = ridden(variant, &road, 25.0 / 3.0, &Settings::default());
        let reference = ridden(variant, &road, 25.0 / 3.0, &fixed);
        for name in &OUTPUTS[..4] {
            let (a, b) = (output(&adaptive, name), output(&reference, name));
            assert!(
                difference(a, b) <= 1e-3 * largest(b),
                "{variant:?} {name}: {} {}",
                difference(a, b),
                largest(b)
            );
        }
        assert!(difference(&adaptive.force[0], &reference.force[0]) < 1e-3 * largest(&reference.force[0]));
    }
}

#[test]
fn a_tyre_in_the_air_pushes_with_nothing_and_lands_again() {
    let road = cleat(0.06);
    for variant in ALL {
        let ride = ridden(variant, &road, 15.0, &Settings::default());
        assert!(
            !ride.lift_offs.is_empty() && ride.lift_offs.len() == ride.landings.len(),
            "{variant:?}"
        );
        let flight = |t: f64| {
            ride.lift_offs
                .iter()
                .zip(&ride.landings)
                .any(|(off, on)| *off < t && t < *on)
        };
        let (mut in_air, mut on_ground) = (0, 0);
        for (i, &t) in ride.time.iter().enumerate() {
            let forces = [ride.force[0][i], ride.force[1][i], ride.area[i]];
            if flight(t) {
                in_air += 1;
                assert_eq!(forces, [0.0; 3], "{variant:?} at {t}");
            } else {
                on_ground += 1;
                assert!(ride.area[i] > 0.0 && ride.force[0][i] >= 0.0, "{variant:?} at {t}");
            }
        }
        assert!(in_air > 5 && on_ground > 500, "{variant:?}: {in_air} {on_ground}");
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let roads: Vec<Road> = [0.01, 0.02, 0.03, 0.04].map(cleat).into();
    let drives: Vec<Drive<'_>> = [20.0, 30.0, 40.0]
        .iter()
        .flat_map(|kmh| roads.iter().map(move |road| drive(road, kmh / 3.6)))
        .collect();
    let (model, p) = (Roller::new(), parameters());
    let car = car(&model, &p, Variant::Complete);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| rides(&car, &drives, &Settings::default(), NO_PROGRESS))
    };
    let (one, four) = (with(1), with(4));
    assert_eq!(one.len(), 12);
    assert!(one == four && one.iter().all(Result::is_ok));
}

#[test]
fn a_mirrored_road_pushes_the_other_way() {
    // So slowly that nothing swings and the damping of the tyre is nil: what is left is where the ground is. A car that
    // is free in x would not climb the ramp at this speed.
    let (speed, middle) = (0.1, 1.0);
    let points = [[0.0, 0.0], [0.8, 0.0], [0.9, 0.02], [1.2, 0.0], [2.0, 0.0]];
    let there = Road::from_points(&points).expect("it is a road");
    let back: Vec<[f64; 2]> = points.iter().rev().map(|[x, z]| [2.0 * middle - x, *z]).collect();
    let back = Road::from_points(&back).expect("it is a road");
    let force = |road: &Road| {
        let (model, p) = (Roller::new(), parameters());
        let drive = Drive {
            samples: 20_001,
            ..drive(road, speed)
        };
        let ride = ride(
            &car(&model, &p, Variant::LongitudinallyLocked),
            &drive,
            &Settings::default(),
        )
        .expect("it rides");
        ride.force[1]
            .iter()
            .map(|force| force + ride.traction)
            .collect::<Vec<_>>()
    };
    let (there, mut back) = (force(&there), force(&back));
    back.reverse();
    let sum: Vec<f64> = there.iter().zip(&back).map(|(a, b)| a + b).collect();
    assert!(largest(&there) > 100.0);
    assert!(
        largest(&sum) < 0.01 * largest(&there),
        "{} {}",
        largest(&sum),
        largest(&there)
    );
}

#[test]
fn a_locked_ride_stays_in_x_and_differs_little_in_z() {
    let road = cleat(0.02);
    let complete = ridden(Variant::Complete, &road, 25.0 / 3.0, &Settings::default());
    let locked = ridden(Variant::LongitudinallyLocked, &road, 25.0 / 3.0, &Settings::default());
    let point = ridden(Variant::PureVertical, &road, 25.0 / 3.0, &Settings::default());
    for ride in [&locked, &point] {
        assert!(largest(output(ride, "x_wheel")) < 1e-20);
    }
    assert!(largest(&point.force[1]) == 0.0 && largest(&locked.force[1]) > 100.0);
    // Thesis section 4.4.3.1: locking x hardly matters, while a point contact hits the step at once.
    let body = |ride| output(ride, "z_body_acceleration");
    let peak = largest(body(&complete));
    assert!((largest(body(&locked)) - peak).abs() < 0.1 * peak);
    assert!(largest(output(&point, "z_wheel_acceleration")) > 2.0 * largest(output(&complete, "z_wheel_acceleration")));
}

#[test]
fn a_ride_is_the_same_wherever_the_road_begins_to_be_described() {
    let road = cleat(0.03);
    let longer: Vec<[f64; 2]> = std::iter::once([-3.0, 0.0])
        .chain(road.vertices().iter().copied())
        .collect();
    let longer = Road::from_points(&longer).expect("it is a road");
    let (a, b) = (
        ridden(Variant::Complete, &road, 10.0, &Settings::default()),
        ridden(Variant::Complete, &longer, 10.0, &Settings::default()),
    );
    for (a, b) in a.outputs.iter().zip(&b.outputs).take(4) {
        assert!(difference(a, b) < 1e-4 * largest(a).max(1.0));
    }
}

fn refused(change: impl Fn(&mut Drive<'_>)) -> SimulateError {
    let (road, model, p) = (cleat(0.03), Roller::new(), parameters());
    let mut drive = drive(&road, 8.0);
    change(&mut drive);
    ride(&car(&model, &p, Variant::Complete), &drive, &Settings::default()).expect_err("it makes no sense")
}

#[test]
fn a_drive_that_makes_no_sense_is_refused() {
    for speed in [0.0, -8.0, f64::NAN, f64::INFINITY] {
        let error = refused(|drive| drive.speed = speed);
        assert!(error.to_string().starts_with("the speed is"), "{error}");
    }
    assert!(
        refused(|drive| drive.sample_rate = 0.0)
            .to_string()
            .starts_with("the sample rate is 0 Hz")
    );
    assert!(
        refused(|drive| drive.samples = 0)
            .to_string()
            .starts_with("the number of samples is 0")
    );
    let error = refused(|drive| (drive.sample_rate, drive.samples) = (100.0, 101));
    assert!(matches!(error, SimulateError::TooFewSamples { .. }), "{error}");
    let error = refused(|drive| drive.samples = 10_001);
    assert!(
        matches!(error, SimulateError::Road(RoadError::TooShort { needed: 80.0, .. })),
        "{error}"
    );
}

fn refused_car(change: impl Fn(&mut Vec<f64>)) -> SimulateError {
    let (road, model, mut p) = (cleat(0.03), Roller::new(), parameters());
    change(&mut p);
    ride(
        &car(&model, &p, Variant::Complete),
        &drive(&road, 8.0),
        &Settings::default(),
    )
    .expect_err("it cannot stand")
}

#[test]
fn a_car_that_cannot_stand_is_refused() {
    let error = refused_car(|p| p[2] = -10e3);
    assert!(matches!(error, SimulateError::Unstable { .. }), "{error}");
    let error = refused_car(|p| p[4] = 1e9);
    assert!(matches!(error, SimulateError::NoEquilibrium { .. }), "{error}");
    let error = refused_car(|p| p[5] = f64::NAN);
    assert!(matches!(error, SimulateError::NoEquilibrium { .. }), "{error}");
    let error = refused_car(|p| p.truncate(9));
    assert!(
        matches!(
            error,
            SimulateError::Count {
                found: 9,
                expected: 11,
                ..
            }
        ),
        "{error}"
    );
    let error = refused_car(|p| (p[2], p[4]) = (12e3, 1.25 * RADIUS));
    assert!(
        matches!(error, SimulateError::TooSoft { radius: RADIUS, .. }),
        "{error}"
    );
}
