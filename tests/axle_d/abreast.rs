//! Rides abreast against each of them alone.

use models::axle_d::AxleD;
use qcar_runtime::model::Model;
use qcar_runtime::road::{Class, Random, Road};
use qcar_runtime::simulate::{
    Car, Drive, RecordedSignals, Ride, RideCase, Settings, SimulateError, Variant, ride, rides_abreast,
};
use qcar_runtime::tyre::{Geometry, Rates, Tyre};

use super::cleat;

/// Of each ride, in the order of their numbers.
fn abreast(
    car: &Car<'_, dyn Model>,
    rides: &[RideCase<'_>],
    settings: &Settings,
    kept: &RecordedSignals,
) -> Vec<Result<Ride, SimulateError>> {
    let mut found: Vec<_> = rides.iter().map(|_| None).collect();
    rides_abreast(car, rides, settings, kept, |number, ride| {
        assert!(found[number].replace(ride).is_none(), "{number} ends twice");
    });
    found.into_iter().map(|ride| ride.expect("each ends")).collect()
}

fn alone(car: &Car<'_, dyn Model>, rides: &[RideCase<'_>], settings: &Settings) -> Vec<Result<Ride, SimulateError>> {
    let one = |&(parameters, drive): &RideCase<'_>| ride(&Car { parameters, ..*car }, &drive, settings);
    rides.iter().map(one).collect()
}

/// Cleats that a tyre rolls over and one that throws it up, and a rough road.
fn roads() -> Vec<Road> {
    let random = Random {
        class: Class::C,
        seed: 3,
        length: 20.0,
        spacing: 0.01,
    };
    let rough = Road::from_random(&random).expect("a road");
    [0.01, 0.03, 0.1].map(cleat::cleat).into_iter().chain([rough]).collect()
}

/// That of the benchmark, and others with all masses, springs and dampers changed a little, each by another part.
fn sets() -> Vec<Vec<f64>> {
    let own = cleat::parameters().as_slice().to_vec();
    let about = AxleD.about();
    let is_known = |place: usize| about.parameters[place].known;
    let changed = |set: usize| {
        let part = |place: usize| 1.0 + 0.01 * (((7 * set + 3 * place) % 11) as f64 - 5.0);
        let values = own.iter().enumerate();
        values
            .map(|(place, value)| if is_known(place) { *value } else { value * part(place) })
            .collect()
    };
    std::iter::once(own.clone()).chain((1..5).map(changed)).collect()
}

/// Every set on every road, at speeds and with sample rates that differ.
fn rides<'a>(sets: &'a [Vec<f64>], roads: &'a [Road]) -> Vec<RideCase<'a>> {
    let of_set = |(place, set): (usize, &'a Vec<f64>)| {
        let drive = move |(road, own): (usize, &'a Road)| {
            let [speed, rate] = [
                (20 + 7 * place) as f64 / 3.6,
                [1000.0, 2000.0, 500.0][(place + road) % 3],
            ];
            let samples = if road == 3 { 300 } else { 700 };
            let drive = Drive {
                sample_rate: rate,
                samples: samples * rate as usize / 1000,
                ..cleat::drive(own, speed)
            };
            (set.as_slice(), drive)
        };
        roads.iter().enumerate().map(drive)
    };
    sets.iter().enumerate().flat_map(of_set).collect()
}

fn car<'a>(parameters: &'a [f64], tyre: (Geometry, Rates), variant: Variant) -> Car<'a, dyn Model> {
    Car {
        model: &AxleD,
        parameters,
        tyre: Tyre::new(0.324, 0.03102, tyre.0, tyre.1).expect("a tyre"),
        load: 5749.6,
        variant,
    }
}

#[test]
fn each_ride_has_the_bits_that_it_has_alone() {
    let (sets, roads, settings) = (sets(), roads(), Settings::default());
    let (rides, kept) = (rides(&sets, &roads), RecordedSignals::all(AxleD.about()));
    let usual = (Geometry::Area, Rates::AtStaticDeflection);
    for (tyre, variant) in [
        (usual, Variant::Complete),
        (usual, Variant::LongitudinallyLocked),
        (usual, Variant::PureVertical),
        ((Geometry::Area, Rates::AtDeflection), Variant::Complete),
        ((Geometry::Radial, Rates::AtStaticDeflection), Variant::Complete),
    ] {
        let car = car(&sets[0], tyre, variant);
        let (found, expected) = (abreast(&car, &rides, &settings, &kept), alone(&car, &rides, &settings));
        assert!(expected.iter().all(Result::is_ok));
        for (number, (found, expected)) in found.iter().zip(&expected).enumerate() {
            assert!(found == expected, "{tyre:?} {variant:?}: ride {number}");
        }
    }
}

/// Whatever is beside it: a ride in each of several orders, and fewer than there are lanes.
#[test]
fn a_ride_depends_on_no_other() {
    let (sets, roads, settings) = (sets(), roads(), Settings::default());
    let (rides, kept) = (rides(&sets, &roads), RecordedSignals::all(AxleD.about()));
    let car = car(&sets[0], (Geometry::Area, Rates::AtStaticDeflection), Variant::Complete);
    let all = abreast(&car, &rides, &settings, &kept);
    for count in [1, 2, 3, 9] {
        let some: Vec<_> = rides.iter().rev().take(count).copied().collect();
        let found = abreast(&car, &some, &settings, &kept);
        assert!(found.iter().eq(all.iter().rev().take(count)), "{count}");
    }
}

#[test]
fn of_what_is_not_kept_nothing_is_there() {
    let (sets, roads, settings) = (sets(), roads(), Settings::default());
    let rides = rides(&sets[..2], &roads);
    let car = car(&sets[0], (Geometry::Area, Rates::AtStaticDeflection), Variant::Complete);
    let all = RecordedSignals::all(AxleD.about());
    let mut kept = RecordedSignals {
        force: true,
        area: false,
        ..all.clone()
    };
    let is_kept = |output: usize| output % 3 == 1;
    kept.outputs = (0..kept.outputs.len()).map(is_kept).collect();
    let (found, whole) = (
        abreast(&car, &rides, &settings, &kept),
        abreast(&car, &rides, &settings, &all),
    );
    for (found, whole) in found.into_iter().zip(whole) {
        let (found, mut whole) = (found.expect("it rides"), whole.expect("it rides"));
        whole.area.clear();
        let outputs = whole.outputs.iter_mut().enumerate();
        outputs
            .filter(|(place, _)| !is_kept(*place))
            .for_each(|(_, own)| own.clear());
        assert!(found == whole);
    }
}

#[test]
fn a_ride_that_fails_stops_no_other() {
    let (sets, roads) = (sets(), roads());
    let mut rides = rides(&sets, &roads);
    // Too slow for the cleat to be seen, and further than the road goes.
    rides[3].1.sample_rate = 20.0;
    rides[8].1.samples = 1_000_000;
    let usual = (Geometry::Area, Rates::AtStaticDeflection);
    let (car, kept) = (
        car(&sets[0], usual, Variant::Complete),
        RecordedSignals::all(AxleD.about()),
    );
    let settings = Settings::default();
    let (found, expected) = (abreast(&car, &rides, &settings, &kept), alone(&car, &rides, &settings));
    assert_eq!(expected.iter().filter(|ride| ride.is_err()).count(), 2);
    assert!(found == expected);
    // Half of the others take too many steps.
    let efforts = expected.iter().flatten().map(|ride| ride.effort);
    let mut steps: Vec<usize> = efforts.map(|own| own.accepted + own.rejected).collect();
    steps.sort_unstable();
    let few = Settings {
        most_steps: steps[steps.len() / 2],
        ..settings
    };
    let (found, expected) = (abreast(&car, &rides, &few, &kept), alone(&car, &rides, &few));
    let failed = expected.iter().filter(|ride| ride.is_err()).count();
    assert!((8..=11).contains(&failed), "{failed}");
    assert!(found == expected);
}
