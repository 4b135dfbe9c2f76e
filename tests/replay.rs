//! Recorded rig motions, replayed in the time domain through compiled models, against what is known in closed form.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;

use models::find;
use nalgebra::Complex;
use qcar_runtime::campaign::{Axis, Campaign, Quantity, Test, Truth};
use qcar_runtime::model::Model;
use qcar_runtime::response::Response;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::simulate::{Between, Reading, Recorded, Replay, SimulateError, replay};
use qcar_runtime::spectrum::{synthesize, transform};
use qcar_runtime::transmissibility::{Point, signal};

/// How often an acceleration has been differentiated.
const ACCELERATION: i32 = 2;

fn axle_a() -> (&'static dyn Model, Values) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/campaigns/axle_a_rig");
    let truth = Truth::read(&folder.join("truth.toml")).unwrap();
    let campaign = Campaign::open(folder).unwrap();
    let model = find("axle_a").unwrap().model;
    let given: BTreeMap<String, f64> = truth.parameters.into_iter().collect();
    let vehicle: BTreeMap<String, f64> = campaign.vehicle.into_iter().collect();
    (model, Values::resolve(model.about(), &given, &vehicle).unwrap())
}

/// The mean pad acceleration of the first sweep of the shipped campaign, and its rate.
fn measured_pad() -> (Vec<f64>, f64) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/campaigns/axle_a_rig");
    let campaign = Campaign::open(folder).unwrap();
    let run = campaign
        .runs
        .iter()
        .find(|run| matches!(run.test, Test::Sweep(_)))
        .unwrap();
    let history = campaign.history(run).unwrap();
    let pad = Point::new("pad", Axis::Z, Quantity::Acceleration);
    (signal(&history, &pad).unwrap(), history.sample_rate)
}

fn band_limited(rate: f64, samples: usize) -> Between {
    Between {
        rate,
        band_limited: true,
        band: (0.0, rate),
        periodic: false,
        samples,
    }
}

/// All outputs under what was recorded of the first excitation.
fn replayed(model: &dyn Model, p: &[f64], power: i32, samples: &[f64], rate: f64) -> Vec<Vec<f64>> {
    let recorded = Recorded {
        excitation: 0,
        power,
        samples,
    };
    let outputs = (0..model.about().outputs.len()).map(Reading::Output).collect();
    replay(model, p, vec![recorded], band_limited(rate, samples.len()), outputs).unwrap()
}

/// The periodic response of each output to a periodic pad acceleration, by the frequency response of the model.
fn steady(model: &dyn Model, p: &[f64], samples: &[f64], rate: f64) -> Vec<Vec<f64>> {
    let lines = transform(samples);
    let below_half = samples.len().div_ceil(2);
    let line = |k: usize| k as f64 * rate / samples.len() as f64;
    let mut response = Response::new(model, 0, &(1..below_half).map(line).collect::<Vec<_>>());
    response.evaluate(p);
    let row = |output: usize| response.layout().outputs.iter().position(|&o| usize::from(o) == output);
    let of = |output: usize| {
        let Some(row) = row(output) else {
            return vec![0.0; samples.len()];
        };
        let (re, im) = response.row(row);
        let answer = |k: usize| Complex::new(re[k - 1], im[k - 1]) * lines[k] / -(TAU * line(k)).powi(2);
        let answers = std::iter::once(Complex::ZERO).chain((1..below_half).map(answer));
        synthesize(&answers.collect::<Vec<_>>(), samples.len())
    };
    (0..model.about().outputs.len()).map(of).collect()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

fn relative(found: &[f64], expected: &[f64]) -> f64 {
    let difference: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
    rms(&difference) / rms(expected)
}

#[test]
fn a_measured_sweep_gives_what_the_frequency_response_says() {
    let (model, values) = axle_a();
    let (pad, rate) = measured_pad();
    let replay = replayed(model, values.as_slice(), ACCELERATION, &pad, rate);
    let steady = steady(model, values.as_slice(), &pad, rate);
    // After ten seconds nothing is left of how the body began to move.
    let settled = (10.0 * rate) as usize;
    for (place, output) in model
        .about()
        .outputs
        .iter()
        .enumerate()
        .filter(|(_, o)| o.signal.axis == "z")
    {
        let error = relative(&replay[place][settled..], &steady[place][settled..]);
        assert!(error < 1e-3, "{}: {error}", output.name);
    }
}

#[test]
fn it_does_not_matter_what_was_recorded_of_a_motion() {
    let (model, values) = axle_a();
    let (n, rate, f) = (8000, 1000.0, 5.0);
    let wave = |amplitude: f64, phase: f64| -> Vec<f64> {
        let angle = |k: usize| TAU * f * k as f64 / rate + phase;
        (0..n).map(|k| amplitude * angle(k).sin()).collect()
    };
    let (omega, quarter) = (TAU * f, TAU / 4.0);
    let records = [
        (0, wave(0.002, 0.0)),
        (1, wave(0.002 * omega, quarter)),
        (2, wave(0.002 * omega * omega, 2.0 * quarter)),
    ];
    let outputs: Vec<Reading> = (0..model.about().outputs.len()).map(Reading::Output).collect();
    let [position, velocity, acceleration] = records.map(|(power, samples)| {
        let recorded = Recorded {
            excitation: 0,
            power,
            samples: &samples,
        };
        let how = band_limited(rate, samples.len());
        replay(model, values.as_slice(), vec![recorded], how, outputs.clone()).unwrap()
    });
    for other in [velocity, acceleration] {
        for (a, b) in position.iter().zip(&other).filter(|(a, _)| rms(a) > 0.0) {
            assert!(relative(b, a) < 1e-3, "{}", relative(b, a));
        }
    }
}

/// One mass on a spring and damper under a force that steps at a sample: the step response in closed form.
#[test]
fn a_held_force_acts_from_its_sample_on() {
    let model = find("one_mass").unwrap().model;
    let (m, c, k, rate, first) = (2.0, 3.0, 800.0, 200.0, 40);
    let place = |name: &str| model.about().parameters.iter().position(|p| p.name == name).unwrap();
    let mut p = vec![0.0; model.about().parameters.len()];
    (p[place("m_body")], p[place("c_body")], p[place("k_body")]) = (m, c, k);
    let samples: Vec<f64> = (0..400).map(|n| if n < first { 0.0 } else { 5.0 }).collect();
    let recorded = Recorded {
        excitation: 0,
        power: 0,
        samples: &samples,
    };
    let held = Between {
        band_limited: false,
        ..band_limited(rate, samples.len())
    };
    let position = model.about().states.iter().position(|s| s.name == "z_body").unwrap();
    let replay = replay(model, &p, vec![recorded], held, vec![Reading::State(position)]).unwrap();
    let (decay, omega) = (c / (2.0 * m), (k / m - (c / (2.0 * m)).powi(2)).sqrt());
    let step = |t: f64| {
        let swing = (omega * t).cos() + decay / omega * (omega * t).sin();
        if t > 0.0 {
            5.0 / k * (1.0 - (-decay * t).exp() * swing)
        } else {
            0.0
        }
    };
    for (n, z) in replay[0].iter().enumerate() {
        let expected = step((n as f64 - first as f64) / rate);
        assert!((z - expected).abs() < 1e-5 * 5.0 / k, "{n}: {z} {expected}");
    }
}

/// Of a linear model no other run is needed for them.
#[test]
fn derivatives_by_initial_states_are_those_of_differences() {
    let (model, values) = axle_a();
    let p = values.as_slice();
    let (pad, rate) = measured_pad();
    let samples = &pad[..600];
    let recorded = Recorded {
        excitation: 0,
        power: ACCELERATION,
        samples,
    };
    let (outputs, states) = (model.about().outputs.len(), model.about().states.len());
    let readings = (0..outputs).map(Reading::Output).chain([Reading::State(1)]).collect();
    let how = band_limited(rate, samples.len());
    let replay = Replay::new(model, vec![recorded], how, Vec::new(), readings);
    let base = replay.run(p, &[]);
    // A linear model: no step is too long for a difference.
    let moved: Vec<(usize, f64)> = (0..states).map(|state| (state, 1.0)).collect();
    let derivatives = replay.by_initial_states(&base, p, &[], &moved);
    for (state, derivatives) in derivatives.iter().enumerate() {
        let signals = replay.run(p, &[(state, 1.0)]).signals;
        for ((moved, base), derivative) in signals.iter().zip(&base.signals).zip(derivatives) {
            let difference: Vec<f64> = moved.iter().zip(base).map(|(moved, base)| moved - base).collect();
            let error = derivative
                .iter()
                .zip(&difference)
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>();
            let size = difference.iter().map(|d| d * d).sum::<f64>();
            assert!(error <= 1e-6 * size, "state {state}: {error} of {size}");
        }
    }
}

#[test]
fn records_that_do_not_fit_are_refused() {
    let (pad, force) = (find("axle_a").unwrap().model, find("one_mass").unwrap().model);
    let refused = |model: &dyn Model, excitation, power, samples: &[f64], band_limited| {
        let recorded = Recorded {
            excitation,
            power,
            samples,
        };
        let how = Between {
            rate: 100.0,
            band_limited,
            band: (0.0, 100.0),
            periodic: false,
            samples: samples.len(),
        };
        let p = vec![1.0; model.about().parameters.len()];
        let error: SimulateError = replay(model, &p, vec![recorded], how, Vec::new()).expect_err("it does not fit");
        error.to_string()
    };
    let zeros = &[0.0; 8];
    assert!(refused(pad, 9, ACCELERATION, zeros, true).contains("model `axle_a` has 3"));
    assert!(refused(force, 0, ACCELERATION, zeros, true).starts_with("excitation `f` is a force"));
    assert!(refused(pad, 0, ACCELERATION, zeros, false).contains("band_limited = true"));
    assert!(refused(pad, 0, ACCELERATION, &[0.0, f64::NAN], true).contains("at sample 1"));
    assert!(refused(pad, 0, ACCELERATION, &[], true).contains("number of samples is 0"));
}
