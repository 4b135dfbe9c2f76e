//! The ride of all programs: axle_d in z and x at 30 km/h over a cleat of 30 mm, from rest to the last state, at a
//! tolerance of 1e-6.

use models::axle_d::AxleD;
use qcar_runtime::model::{LANES, Model, StateKind};
use qcar_runtime::road::Road;
use qcar_runtime::simulate::{
    AntiAlias, Drive, Method, RecordedSignals, RideCase, Settings, end_of_ride, rides_abreast,
};

use crate::child::Peer;
use crate::cleat;

/// Speed, m/s.
const SPEED: f64 = 30.0 / 3.6;
/// Durations of the timed ride, and of two that end on the cleat and soon after it.
const SAMPLES: usize = 1001;
const PROBES: [usize; 3] = [200, 350, SAMPLES];
/// Settings of the rides with which other programs are compared.
const EXACT: f64 = 1e-10;
/// Largest allowed difference, relative to 1 cm and 0.1 m/s: far larger than the accumulated tolerance, far smaller
/// than a wrong term.
const WRONG: f64 = 1e-2;

fn road() -> Road {
    cleat::cleat(0.03)
}

fn drive(road: &Road, samples: usize) -> Drive<'_> {
    Drive {
        samples,
        ..cleat::drive(road, SPEED)
    }
}

/// End of a recording of `samples` samples with its filter, s.
fn end(samples: usize) -> f64 {
    (samples - 1 + AntiAlias::REACH) as f64 / cleat::drive(&road(), SPEED).sample_rate
}

/// Car, tyre and road as text for a program.
pub fn told() -> Vec<String> {
    let (parameters, road) = (cleat::parameters(), road());
    let of_model = AxleD.about().parameters.iter().zip(parameters.as_slice());
    let set = |name: &str, value: f64| format!("set {name} {value:?}");
    let vertices = road.vertices();
    // The circle cannot reach the step before its foremost point does.
    let uneven = vertices.windows(2).find(|pair| pair[0][1] != pair[1][1]);
    let start = (uneven.expect("a cleat")[0][0] - cleat::RADIUS) / SPEED;
    let of_ride = [
        ("radius", cleat::RADIUS),
        ("speed", SPEED),
        ("start", start),
        ("end", end(SAMPLES)),
        ("tolerance", 1e-6),
    ];
    of_model
        .map(|(about, &value)| set(&about.name, value))
        .chain(of_ride.map(|(name, value)| set(name, value)))
        .chain(vertices.iter().map(|[x, z]| format!("vertex {x:?} {z:?}")))
        .collect()
}

/// The work of a single ride.
pub fn alone<M: Model + ?Sized>(model: &M) -> impl FnMut() {
    let (parameters, road) = (cleat::parameters(), road());
    move || {
        let car = cleat::on_tyre(model, &parameters);
        let ended = end_of_ride(&car, &drive(&road, SAMPLES), &Settings::default());
        drop(std::hint::black_box(ended.expect("it rides")));
    }
}

/// Number of rides in each lane, one after another.
const EACH: usize = 4;
/// Number of rides.
pub const ABREAST: usize = EACH * LANES;

/// The work of several rides side by side, without records: axles whose tyres differ by some percent.
pub fn abreast<M: Model + ?Sized>(model: &M) -> impl FnMut() {
    let (parameters, road) = (cleat::parameters(), road());
    let tyre = model.about().parameters.iter().position(|own| own.name == "k_tire");
    let tyre = tyre.expect("an axle has a tyre");
    let sets: Vec<Vec<f64>> = (0..ABREAST)
        .map(|set| {
            let mut own = parameters.as_slice().to_vec();
            own[tyre] *= 1.0 + 1e-3 * set as f64;
            own
        })
        .collect();
    let kept = RecordedSignals {
        outputs: vec![false; model.about().outputs.len()],
        force: false,
        area: false,
    };
    move || {
        let car = cleat::on_tyre(model, &parameters);
        let rides: Vec<RideCase> = sets.iter().map(|own| (own.as_slice(), drive(&road, SAMPLES))).collect();
        let done = |_, ride: Result<_, _>| drop(std::hint::black_box(ride.expect("it rides")));
        rides_abreast(&car, &rides, &Settings::default(), &kept, done);
    }
}

/// Largest difference of a program's final states over all rides, relative to 1 cm and 0.1 m/s.
///
/// # Panics
/// If the difference is larger than the tolerance explains.
pub fn difference(peer: Option<&Peer>) -> String {
    let worst = PROBES.into_iter().map(|samples| {
        let exact = states(samples, EXACT);
        let found = match peer {
            None => states(samples, 1e-6),
            Some(peer) => {
                peer.tell(&format!("set end {:?}", end(samples)));
                let shown = peer.shown("ride");
                let of = |name: &str| shown.iter().find(|line| line[..3].join(" ") == name);
                let value =
                    |(name, _): &(String, f64)| (name.clone(), of(name).map_or(f64::NAN, |own| number(&own[3])));
                exact.iter().map(value).collect()
            }
        };
        let off = |((name, exact), (_, found)): (&(String, f64), &(String, f64))| {
            let scale = if name.ends_with('0') { 0.01 } else { 0.1 };
            (found - exact).abs() / scale
        };
        exact.iter().zip(&found).map(off).fold(0.0, larger)
    });
    let worst = worst.fold(0.0, larger);
    let name = peer.map_or("qcar", |peer| peer.name);
    assert!(worst < WRONG, "{name} is off by {worst:e} in a ride");
    format!("{worst:.0e}")
}

/// The larger number; NaN if one is NaN, so that a NaN is not accepted.
fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

fn number(word: &str) -> f64 {
    word.parse().expect("a number")
}

/// The states after `samples` samples, by mass, axis and order.
fn states(samples: usize, tolerance: f64) -> Vec<(String, f64)> {
    let (parameters, road) = (cleat::parameters(), road());
    let settings = Settings {
        method: Method::Adaptive(tolerance),
        ..Settings::default()
    };
    let ended = end_of_ride(&cleat::car(&parameters), &drive(&road, samples), &settings);
    let (x, _) = ended.expect("it rides");
    let name = |state: &qcar_runtime::model::State| {
        let order = usize::from(state.kind == StateKind::Velocity);
        format!("{} {} {order}", state.location, state.axis)
    };
    AxleD.about().states.iter().map(name).zip(x).collect()
}
