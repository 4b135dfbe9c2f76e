//! Recorded rig motions, replayed in the time domain through compiled models, against what is known in closed form.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;

use models::find;
use nalgebra::Complex;
use qcar::catalogue::load_text;
use qcar_runtime::campaign::{Axis, Campaign, Quantity, Test, Truth};
use qcar_runtime::model::Model;
use qcar_runtime::response::Response;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::simulate::replay::{Deviation, Direction};
use qcar_runtime::simulate::{Accuracy, Between, Reading, Recorded, Replay, SimulateError, replay};
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
        accuracy: Accuracy::USUAL,
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

/// A reading under a force that is held from sample to sample.
fn pushed(model: &dyn Model, p: &[f64], (samples, rate): (&[f64], f64), reading: Reading) -> Vec<f64> {
    let recorded = Recorded {
        excitation: 0,
        power: 0,
        samples,
    };
    let held = Between {
        band_limited: false,
        ..band_limited(rate, samples.len())
    };
    replay(model, p, vec![recorded], held, vec![reading]).unwrap().remove(0)
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
    let position = model.about().states.iter().position(|s| s.name == "z_body").unwrap();
    let replayed = pushed(model, &p, (&samples, rate), Reading::State(position));
    let (decay, omega) = (c / (2.0 * m), (k / m - (c / (2.0 * m)).powi(2)).sqrt());
    let step = |t: f64| {
        let swing = (omega * t).cos() + decay / omega * (omega * t).sin();
        if t > 0.0 {
            5.0 / k * (1.0 - (-decay * t).exp() * swing)
        } else {
            0.0
        }
    };
    for (n, z) in replayed.iter().enumerate() {
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
    let all: Vec<Direction> = (0..states).map(Direction::Initial).collect();
    let derivatives = replay.along(&base, (p, &[]), &all);
    for (state, derivatives) in derivatives.iter().enumerate() {
        let begin = Deviation {
            sample: 0,
            state,
            by: 1.0,
        };
        let signals = replay.run(p, &[begin]).signals;
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

/// A critically damped mass, whose motion from an initial velocity decays by 1000 per second: after 0.7 s it is subnormal,
/// with which some processors compute a hundred times more slowly.
#[test]
fn derivatives_that_have_vanished_are_zero() {
    let model = find("one_mass").unwrap().model;
    let place = |name: &str| model.about().parameters.iter().position(|p| p.name == name).unwrap();
    let mut p = vec![0.0; model.about().parameters.len()];
    (p[place("m_body")], p[place("c_body")], p[place("k_body")]) = (2.0, 4e3, 2e6);
    let samples = vec![0.0; 2000];
    let recorded = Recorded {
        excitation: 0,
        power: 0,
        samples: &samples,
    };
    let state = |name: &str| model.about().states.iter().position(|s| s.name == name).unwrap();
    let readings = vec![Reading::State(state("z_body"))];
    // With a restart, derivatives by initial states are integrated in a linear model too.
    let restart = vec![(1999, Vec::new())];
    let replay = Replay::new(
        model,
        vec![recorded],
        band_limited(2000.0, samples.len()),
        restart,
        readings,
    );
    let base = replay.run(&p, &[]);
    let slopes = replay.along(&base, (&p, &[]), &[Direction::Initial(state("z_body"))]);
    let slopes = &slopes[0][0];
    assert!((slopes[2] - 2.0 / std::f64::consts::E).abs() < 1e-3, "{}", slopes[2]);
    assert!(slopes.iter().all(|slope| !slope.is_subnormal()));
    assert_eq!(slopes[1999], 0.0);
}

/// A mass under a constant force, and what this adds to its motion under another force.
#[test]
fn the_derivative_by_the_zero_of_a_force_is_the_response_to_a_constant_one() {
    let model = find("one_mass").unwrap().model;
    let place = |name: &str| model.about().parameters.iter().position(|p| p.name == name).unwrap();
    let mut p = vec![0.0; model.about().parameters.len()];
    (p[place("m_body")], p[place("c_body")], p[place("k_body")]) = (2.0, 6.0, 800.0);
    let state = |name: &str| model.about().states.iter().position(|s| s.name == name).unwrap();
    let replay = |samples: &[f64], by_zero: bool| {
        let recorded = Recorded {
            excitation: 0,
            power: 0,
            samples,
        };
        let readings = vec![Reading::State(state("z_body"))];
        let how = band_limited(200.0, samples.len());
        let replay = Replay::new(model, vec![recorded], how, Vec::new(), readings);
        let base = replay.run(&p, &[]);
        let along = |directions: &[Direction]| replay.along(&base, (&p, &[]), directions)[0][0].clone();
        if by_zero {
            along(&[Direction::Zero(0)])
        } else {
            base.signals[0].clone()
        }
    };
    let slopes = replay(&rough_road(1.0, 200.0, 400), true);
    let constant = replay(&[1.0; 400], false);
    for (slope, constant) in slopes.iter().zip(&constant) {
        assert!((slope - constant).abs() < 1e-12, "{slope}, {constant}");
    }
    assert!((slopes[399] - 1.0 / 800.0).abs() < 1e-4, "{}", slopes[399]);
}

/// A quarter car with the laws that have kinks: dry friction, a digressive and asymmetric damper, a bump stop, a
/// progressive tyre.
const WITH_KINKS: &str = "
axle kinks {
    known param m_body: kg = 400;
    known param m_wheel: kg = 40;
    param k: N/m = 25e3 in 5e3..200e3;
    param c: N s/m = 1500;
    param v0: m/s = 0.3;
    param rebound: 1 = 1.7;
    param f_dry: N = 90;
    param k_dry: N/m = 20e3;
    param k_stop: N/m^2 = 4e6;
    param gap: m = 0.01;
    param k_tire: N/m = 220e3;
    param soft: N/m^2 = 3e6;
    direction z {
        road pad;
        mass body = m_body;
        mass wheel = m_wheel;
        link tire: wheel - pad { force = k_tire * s + soft * s * abs(s); }
        link spring: body - wheel {
            spring k;
            force = if s < -gap { -k_stop * (s + gap)^2 } else { 0 };
        }
        link damper: body - wheel {
            force = (if v > 0 { rebound } else { 1 }) * c * v / (1 + abs(v) / v0);
        }
        link friction: body - wheel {
            state f: N;
            rate f = k_dry * (v - abs(v) * f / f_dry);
            force = f;
        }
        output body.acceleration;
        output wheel.acceleration;
    }
}
";

/// Sum of forty sines over time, by a factor.
fn rough_road(factor: f64, rate: f64, samples: usize) -> Vec<f64> {
    let sine = |t: f64, k: f64| 0.02 * (TAU * 0.5 * (k + 1.0) * t + k * k).sin();
    let at = |sample: usize| (0..40).map(|k| sine(sample as f64 / rate, f64::from(k))).sum::<f64>();
    (0..samples).map(|sample| factor * at(sample)).collect()
}

/// Derivatives along all parameters, the amplitude of the road and all initial states are those of differences, to the
/// accuracy of these.
#[test]
fn derivatives_through_kinks_are_those_of_differences() {
    derivatives_agree(WITH_KINKS, 1, 1e-6, true);
}

/// A friction so stiff that its state would not decay in a step while it slides.
fn with_stiff_friction() -> String {
    WITH_KINKS.replace("k_dry: N/m = 20e3", "k_dry: N/m = 200e3")
}

/// Where its state decays within a step, its derivatives follow another method than the motion, so they agree with
/// differences to the accuracy of the steps: 7e-4.
#[test]
fn derivatives_of_a_stiff_friction_do_not_grow() {
    derivatives_agree(&with_stiff_friction(), 1, 2e-3, false);
}

/// In steps in which it decays, they are as exact as those of any other law.
#[test]
fn derivatives_of_a_stiff_friction_are_those_of_differences_in_short_steps() {
    derivatives_agree(&with_stiff_friction(), 16, 1e-6, true);
}

/// Compares derivatives with central differences of whole replays, with states that are measured anew in between.
/// Records have `times` as many samples a second as steps of a millisecond allow.
fn derivatives_agree(model: &str, times: usize, within: f64, by_states: bool) {
    const STEP: f64 = 1e-6;
    /// Of the positions, the velocities and the force of friction.
    const SIZES: [f64; 5] = [0.05, 0.05, 1.0, 1.0, 90.0];
    let loaded = load_text("kinks", model)
        .map_err(|failure| failure.to_string())
        .unwrap();
    let model: &dyn Model = &*loaded;
    let given = BTreeMap::new();
    let p = Values::resolve(model.about(), &given, &given)
        .unwrap()
        .as_slice()
        .to_vec();
    let (rate, samples, states) = (200.0 * times as f64, 500 * times, model.about().states.len());
    let readings: Vec<Reading> = (0..2).map(Reading::Output).chain([Reading::State(0)]).collect();
    let restarts = vec![(0, vec![(0, 0.001)]), (240 * times, vec![(0, 0.002), (1, -0.01)])];
    let roads = [1.0, 1.0 + STEP, 1.0 - STEP].map(|factor| rough_road(factor, rate, samples));
    for periodic in [false, true] {
        let how = Between {
            periodic,
            ..band_limited(rate, samples)
        };
        let [replay, up, down] = roads.each_ref().map(|samples| {
            let recorded = Recorded {
                excitation: 0,
                power: 1,
                samples,
            };
            Replay::new(model, vec![recorded], how, restarts.clone(), readings.clone())
        });
        // At rest, tiny differences of the states would change the steps; links at rest would begin at a kink.
        let by = |sample| {
            move |state| Deviation {
                sample,
                state,
                by: 0.01 * (state + 1) as f64,
            }
        };
        let begin: Vec<Deviation> = (0..states).map(by(0)).chain((0..2).map(by(240 * times))).collect();
        let base = replay.run(&p, &begin);
        let both = |step: f64, run: &dyn Fn(f64) -> Vec<Vec<f64>>| (step, [run(step), run(-step)]);
        let differences = |direction: &Direction| match *direction {
            Direction::Parameters(ref own) => both(STEP * p[own[0]], &|by| {
                let mut moved = p.clone();
                own.iter().for_each(|&own| moved[own] += by);
                replay.run(&moved, &begin).signals
            }),
            Direction::Amplitude(_) => both(STEP, &|by| if by > 0.0 { &up } else { &down }.run(&p, &begin).signals),
            Direction::Zero(_) => unreachable!("a road has no zero"),
            Direction::Initial(state) => both(STEP * SIZES[state], &|by| {
                let mut moved = begin.clone();
                let own = moved.iter_mut().filter(|own| own.state == state);
                own.for_each(|own| own.by += by);
                replay.run(&p, &moved).signals
            }),
        };
        let parameters = (0..p.len()).map(|at| Direction::Parameters(vec![at]));
        let mut directions: Vec<Direction> = parameters.chain([Direction::Amplitude(0)]).collect();
        if by_states && !periodic {
            directions.extend((0..states).map(Direction::Initial));
        }
        let slopes = replay.along(&base, (&p, &begin), &directions);
        for (direction, slopes) in directions.iter().zip(&slopes) {
            let (step, [up, down]) = differences(direction);
            for (signal, slope) in slopes.iter().enumerate() {
                let difference = up[signal]
                    .iter()
                    .zip(&down[signal])
                    .map(|(up, down)| (up - down) / (2.0 * step));
                let (error, size) = difference
                    .zip(slope)
                    .fold((0.0, 0.0), |(error, size), (difference, slope)| {
                        (error + (slope - difference).powi(2), size + difference * difference)
                    });
                let error = (error / size).sqrt();
                assert!(
                    error < within,
                    "{error:.1e} in signal {signal} by {direction:?}, periodic: {periodic}"
                );
            }
        }
    }
}

/// Dry friction that sticks over a micrometre or a hundredth of it: at 10 m/s the state of the first decays within 0.1
/// microseconds, a ten-thousandth of a step. Sliding, it is a constant force.
#[test]
fn a_friction_of_any_stiffness_is_a_constant_force_while_it_slides() {
    let text = "
axle slider {
    param m: kg = 2;
    param f_dry: N = 4;
    param k_dry: N/m = 4e6;
    direction x {
        mass body = m;
        force push on body;
        link friction: body {
            state f: N;
            rate f = k_dry * (v - abs(v) * f / f_dry);
            force = f;
        }
        output body.position;
    }
}
";
    let model = load_text("slider", text)
        .map_err(|failure| failure.to_string())
        .unwrap();
    let (rate, push, mass, end) = (400.0, 14.0, 2.0, 2.0_f64);
    let samples = vec![push; 801];
    let how = Between {
        band_limited: false,
        ..band_limited(rate, samples.len())
    };
    for stiffness in [4e6, 4e8] {
        let p = [mass, 4.0, stiffness];
        let recorded = Recorded {
            excitation: 0,
            power: 0,
            samples: &samples,
        };
        let replay = Replay::new(&*model, vec![recorded], how, Vec::new(), vec![Reading::Output(0)]);
        let base = replay.run(&p, &[]);
        let directions = [0, 1].map(|parameter| Direction::Parameters(vec![parameter]));
        let slopes = replay.along(&base, (&p, &[]), &directions);
        let moved = end.powi(2) / 2.0;
        let expected = [(push - 4.0) / mass, -(push - 4.0) / mass.powi(2), -1.0 / mass].map(|slope| slope * moved);
        let found = [base.signals[0][800], slopes[0][0][800], slopes[1][0][800]];
        for (found, expected) in found.iter().zip(expected) {
            let error = found / expected - 1.0;
            assert!(error.abs() < 1e-3, "{found}, not {expected}, with {stiffness} N/m");
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
            accuracy: Accuracy::USUAL,
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
