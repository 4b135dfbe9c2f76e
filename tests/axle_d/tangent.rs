//! Derivatives of a ride, against rides whose parameters are moved.

use std::collections::BTreeMap;
use std::sync::Arc;

use models::axle_d::AxleD;
use qcar::catalogue::compiled;
use qcar::effects;
use qcar::workshop::Bench;
use qcar_runtime::discover::candidate::Workshop;
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::road::Road;
use qcar_runtime::sensitivity::direction;
use qcar_runtime::simulate::{Car, Drive, Method, Settings, Tangent, ride, tangent, variation};

use super::cleat;
use super::general::General;

/// Points a sample of derivatives, in the last fits of a search and in those before.
const FINE: usize = 2;
const COARSE: usize = 1;

fn settings(tolerance: f64) -> Settings {
    Settings {
        method: Method::Adaptive(tolerance),
        ..Settings::default()
    }
}

/// A tolerance at which derivatives have eight digits.
const EXACT: f64 = 1e-12;
/// One at which a difference of rides has seven.
const MOST_EXACT: f64 = 1e-14;
/// Samples of an impact and the first of its after-shake.
const IMPACT: usize = 501;

/// The signals of a ride with parameter `k` moved by a part of itself, in the order of a [`Tangent`].
fn moved(k: usize, part: f64, drive: &Drive<'_>) -> Vec<Vec<f64>> {
    let mut parameters = cleat::parameters();
    let value = parameters.as_slice()[k];
    parameters.set(k, value * (1.0 + part));
    let (own, model) = (cleat::car(&parameters), General::new());
    let car = Car {
        model: &model,
        parameters: own.parameters,
        tyre: own.tyre,
        load: own.load,
        variant: own.variant,
    };
    let ride = ride(&car, drive, &settings(MOST_EXACT)).expect("it rides");
    let [vertical, _] = ride.force;
    ride.outputs.into_iter().chain([vertical]).collect()
}

/// The derivative by that part, by differences of fourth order. The descent of a cleat is made of chords, and at a
/// sample at which the rim comes over an end of one, a difference is of both sides: the smaller the part, the fewer
/// such samples there are.
fn difference(k: usize, drive: &Drive<'_>) -> Vec<Vec<f64>> {
    const PART: f64 = 2e-4;
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

/// Places of the parameters that a designer moves. Facts of the vehicle are those of its tyre, too, and move with it
/// alone.
fn leaders() -> Vec<usize> {
    let (parameters, about) = (cleat::parameters(), AxleD.about());
    let all = 0..parameters.as_slice().len();
    let own = all.filter(|&k| parameters.leader(k) == k && !about.parameters[k].known);
    own.filter(|&k| !about.parameters[k].name.starts_with("static"))
        .collect()
}

fn along_each(drive: &Drive<'_>, tolerance: f64) -> Tangent {
    let parameters = cleat::parameters();
    let directions: Vec<_> = leaders().into_iter().map(|k| direction(&parameters, k)).collect();
    tangent(&cleat::car(&parameters), drive, &settings(tolerance), &directions).expect("it rides")
}

/// The root mean square of a difference, over that of a signal.
fn error(found: &[f64], exact: &[f64], signal: &[f64]) -> f64 {
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
    let off = square(&mut found.iter().zip(exact).map(|(found, exact)| found - exact));
    (off / square(&mut signal.iter().map(|value| value - signal[0]))).sqrt()
}

/// The largest error over all signals and every so many parameters, with those that it is of, in the impact and the
/// first of its after-shake.
fn worst(height: f64, every: usize) -> (f64, usize, String) {
    let road = cleat::cleat(height);
    let drive = Drive {
        samples: IMPACT,
        ..cleat::drive(&road, 30.0 / 3.6)
    };
    let tangent = along_each(&drive, EXACT);
    let mut worst = (0.0, 0, String::new());
    for (k, slopes) in leaders().into_iter().zip(&tangent.slopes).step_by(every) {
        for (signal, (slope, difference)) in slopes.iter().zip(difference(k, &drive)).enumerate() {
            let error = error(slope, &difference, &tangent.signals[signal]);
            if error > worst.0 {
                worst = (error, signal, AxleD.about().parameters[k].name.to_string());
            }
        }
    }
    worst
}

#[test]
fn sensitivities_are_the_limit_of_differences() {
    let worst = worst(0.01, 4);
    assert!(worst.0 < 1e-6, "{worst:?}");
}

/// A higher cleat throws the wheel further, and bends the force of the tyre more.
#[test]
fn a_hard_impact_does_not_spoil_them() {
    let worst = worst(0.03, 1);
    assert!(worst.0 < 1e-6, "{worst:?}");
}

/// What metrics are derived with: an error of this part of the signal for a parameter that is moved by all of itself.
#[test]
fn the_usual_tolerance_is_enough_for_a_sensitivity() {
    let road = cleat::cleat(0.02);
    let drive = cleat::drive(&road, 20.0 / 3.6);
    let (usual, exact) = (along_each(&drive, 1e-6), along_each(&drive, EXACT));
    let mut worst: f64 = 0.0;
    for (found, slopes) in usual.slopes.iter().zip(&exact.slopes) {
        for (signal, (found, slope)) in found.iter().zip(slopes).enumerate() {
            worst = worst.max(error(found, slope, &exact.signals[signal]));
        }
    }
    assert!(worst < 2e-3, "{worst:e}");
}

/// What discovery fits by: derivatives on the grid of the samples, of every output, over a cleat that throws the wheel.
#[test]
fn derivatives_of_a_linear_axle_on_the_grid_of_the_samples_are_those_of_its_ride() {
    let (parameters, road) = (cleat::parameters(), cleat::cleat(0.02));
    let (car, drive) = (cleat::car(&parameters), cleat::drive(&road, 30.0 / 3.6));
    let outputs: Vec<usize> = (0..AxleD.about().outputs.len()).collect();
    let exact = along_each(&drive, EXACT);
    let mut worst: f64 = 0.0;
    for (k, exact_slopes) in leaders().into_iter().zip(&exact.slopes) {
        const PART: f64 = 1e-4;
        let mut moved = parameters.clone();
        moved.set(k, parameters.as_slice()[k] * (1.0 + PART));
        let found = variation(&car, &drive, &outputs, &[(moved.as_slice(), PART)], FINE);
        let found = found.expect("it rides");
        for (signal, found) in found[0].iter().enumerate() {
            worst = worst.max(error(found, &exact_slopes[signal], &exact.signals[signal]));
        }
    }
    assert!(worst < 1e-2, "{worst:e}");
}

/// A ride of a model over a cleat that throws the wheel, with the values of axle D and those of an effect.
struct Thrown<'m> {
    model: &'m dyn Model,
    values: Values,
    road: Road,
    samples: usize,
}

impl<'m> Thrown<'m> {
    fn new(model: &'m dyn Model, added: &[(&str, f64)], samples: usize) -> Self {
        let own = cleat::parameters();
        let names = AxleD.about().parameters.iter().map(|parameter| &*parameter.name);
        let all = names.zip(own.as_slice().iter().copied()).chain(added.iter().copied());
        let has = |name: &str| model.about().parameters.iter().any(|own| own.name == name);
        let given: BTreeMap<String, f64> = all
            .filter(|(name, _)| has(name))
            .map(|(name, value)| (name.to_string(), value))
            .collect();
        Self {
            model,
            values: Values::resolve(model.about(), &given, &BTreeMap::new()).unwrap(),
            road: cleat::cleat(0.02),
            samples,
        }
    }

    fn car<'a>(&'a self, parameters: &'a [f64]) -> Car<'a, dyn Model + 'a> {
        let own = cleat::parameters();
        let Car {
            tyre, load, variant, ..
        } = cleat::car(&own);
        Car {
            model: self.model,
            parameters,
            tyre,
            load,
            variant,
        }
    }

    fn drive(&self) -> Drive<'_> {
        Drive {
            samples: self.samples,
            ..cleat::drive(&self.road, 30.0 / 3.6)
        }
    }

    /// The parameters with one moved by a part of itself.
    fn moved(&self, name: &str, part: f64) -> Vec<f64> {
        let mut parameters = self.model.about().parameters.iter();
        let k = parameters.position(|own| own.name == name).unwrap();
        let mut moved = self.values.clone();
        moved.set(k, self.values.as_slice()[k] * (1.0 + part));
        moved.as_slice().to_vec()
    }

    fn outputs(&self, parameters: &[f64], tolerance: f64) -> Vec<Vec<f64>> {
        let ride = ride(&self.car(parameters), &self.drive(), &settings(tolerance));
        ride.expect("it rides").outputs
    }

    /// Derivatives of all outputs by the logarithm of a parameter, by differences of fourth order.
    fn difference(&self, name: &str, part: f64, tolerance: f64) -> Vec<Vec<f64>> {
        let rides = [1.0, -1.0, 2.0, -2.0].map(|times| self.outputs(&self.moved(name, times * part), tolerance));
        let signals = 0..rides[0].len();
        let at = |signal: usize, i: usize| {
            let [up, down, far_up, far_down] = rides.each_ref().map(|ride| ride[signal][i]);
            (8.0 * (up - down) - (far_up - far_down)) / (12.0 * part)
        };
        let samples = |signal: usize| (0..rides[0][signal].len()).map(|i| at(signal, i)).collect();
        signals.map(samples).collect()
    }

    /// The same derivatives as a fit takes them.
    fn variation(&self, name: &str, points_a_sample: usize) -> Vec<Vec<f64>> {
        const PART: f64 = 1e-4;
        let here = self.values.as_slice();
        let outputs: Vec<usize> = (0..self.model.about().outputs.len()).collect();
        let moved = self.moved(name, PART);
        let (car, drive) = (self.car(here), self.drive());
        let found = variation(&car, &drive, &outputs, &[(&moved, PART)], points_a_sample);
        found.expect("it rides").remove(0)
    }

    /// The same derivatives, integrated with the motion.
    fn tangent(&self, name: &str, tolerance: f64) -> Vec<Vec<f64>> {
        let here = self.values.as_slice();
        let moved = self.moved(name, 1.0);
        let direction: Vec<f64> = moved.iter().zip(here).map(|(to, from)| to - from).collect();
        let found = tangent(&self.car(here), &self.drive(), &settings(tolerance), &[direction]);
        found.expect("it rides").slopes.remove(0)
    }
}

/// The largest error of the derivatives that a fit takes, of all outputs of a model by some of its parameters and those
/// of an effect, against differences: a part of the signal, or of the derivative where that is larger.
fn worst_on_the_grid(model: &dyn Model, added: &[(&str, f64)], points_a_sample: usize) -> f64 {
    let road = cleat::cleat(0.02);
    let thrown = Thrown::new(model, added, cleat::drive(&road, 1.0).samples);
    let still = thrown.outputs(thrown.values.as_slice(), 1e-10);
    let own = ["k_tire", "c_tire", "m_wheel", "k_sf_z", "c_wheel_x"];
    let mut worst: f64 = 0.0;
    for name in own.into_iter().chain(added.iter().map(|own| own.0)) {
        let found = thrown.variation(name, points_a_sample);
        let difference = thrown.difference(name, 1e-3, 1e-10);
        for ((found, difference), still) in found.iter().zip(&difference).zip(&still) {
            worst = worst.max(error(found, difference, still).min(error(found, difference, difference)));
        }
    }
    worst
}

/// What a tyre with states of its own is told, deflection and its rate, acts beside the force.
#[test]
fn derivatives_on_the_grid_know_tyres_with_states_of_their_own() {
    let catalogue = Arc::new(effects::catalogue().map_err(|_| "the catalogue reads").unwrap());
    let axle = compiled("axle_d").map_err(|_| "it compiles").unwrap().model;
    let bench = Bench::new(axle, catalogue, Arc::new(BTreeMap::new()));
    let relaxing = [("stiffness_ratio", 1.6), ("relaxation_frequency", 12.0)];
    let belt = [("m_belt", 7.0), ("k_sidewall", 9e5), ("c_sidewall", 250.0)];
    let cases = [
        ("tire_dynamic_stiffness", "always", &relaxing[..]),
        ("tire_dynamic_stiffness", "rolling", &relaxing),
        ("tire_belt", "in_plane", &belt),
    ];
    for (effect, form, added) in cases {
        let with = bench
            .with(effect, "tire", Some(form))
            .expect("the effect has this form");
        for (points_a_sample, enough) in [(FINE, 1.5e-2), (COARSE, 5e-2)] {
            let worst = worst_on_the_grid(with.model(), added, points_a_sample);
            assert!(worst < enough, "{effect} {form}, {points_a_sample} points: {worst:e}");
        }
    }
}

/// The largest errors of the derivatives of a nonlinear axle by a parameter of the tyre and by those of an effect,
/// against differences: with an exact ride, and as a fit takes them.
fn worst_of_nonlinear(model: &dyn Model, added: &[(&str, f64)]) -> [f64; 2] {
    // At a kink of a law a difference is of both sides: the smaller the part, the fewer such samples there are.
    const PART: f64 = 4e-5;
    let thrown = Thrown::new(model, added, IMPACT);
    let still = thrown.outputs(thrown.values.as_slice(), EXACT);
    let mut worst: [f64; 2] = [0.0; 2];
    for name in ["k_tire"].into_iter().chain(added.iter().map(|own| own.0)) {
        let difference = thrown.difference(name, PART, MOST_EXACT);
        let found = [thrown.tangent(name, EXACT), thrown.variation(name, COARSE)];
        for (signal, still) in still.iter().enumerate() {
            for (worst, found) in worst.iter_mut().zip(&found) {
                *worst = worst.max(error(&found[signal], &difference[signal], still));
            }
        }
    }
    worst
}

/// A friction with a state, a damper that saturates, and a stop with a kink. A fit integrates with a tolerance of 3e-6,
/// as it does the motion. Quotients of two such rides with parameters that differ by 0.3 % were wrong by 2 to 11 %.
#[test]
fn derivatives_of_a_nonlinear_axle_are_the_limit_of_differences() {
    let catalogue = Arc::new(effects::catalogue().map_err(|_| "the catalogue reads").unwrap());
    let axle = compiled("axle_d").map_err(|_| "it compiles").unwrap().model;
    let bench = Bench::new(axle, catalogue, Arc::new(BTreeMap::new()));
    let friction = [("f_coulomb", 150.0), ("k_presliding", 4e5)];
    let damper = [("c0", 3000.0), ("v0", 0.25)];
    let stop = [("gap", 0.006), ("k_stop", 2e5)];
    let cases = [
        ("coulomb_friction", "damper", "in_damper", friction),
        ("digressive_damper", "damper", "blow_off", damper),
        ("bump_stop", "spring", "in_compression", stop),
    ];
    for (effect, place, form, added) in cases {
        let with = bench.with(effect, place, Some(form)).expect("the effect has this form");
        let [exact, fitted] = worst_of_nonlinear(with.model(), &added);
        assert!(exact < 1e-6, "{effect}: {exact:e}");
        assert!(fitted < 1e-2, "{effect}: {fitted:e}");
    }
}
