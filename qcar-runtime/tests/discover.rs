//! Evidence made from closed forms, with sensors that are wrong by known amounts, against refit and misfit.

use nalgebra::Complex;
use qcar_runtime::campaign::{Axis, Role};
use qcar_runtime::discover::locate::{MissingStiffness, RunStiffness, Shape, shape};
use qcar_runtime::discover::noise::{Form, Nuisance};
use qcar_runtime::discover::observe::{Evidence, Kind, Series, Stimulus, predict};
use qcar_runtime::discover::posterior::refit_with;
use qcar_runtime::discover::{Free, Misfit, Place, Refit, Sweeps, refit, stiffness_map};
use qcar_runtime::model::{Clock, Model};
use qcar_runtime::response::parameters::Values;
use qcar_runtime::response::ratio::ratio;
use qcar_runtime::roles::OnRig;
use qcar_runtime::transmissibility::{Point, logarithmic};

use super::support::random::Random;
use super::support::strut::{Parts, Strut};
use super::support::swept::{self, point};

const PLAIN: Parts = Parts {
    powertrain: false,
    friction: false,
};
const TRUTH: [f64; 9] = [400.0, 42.0, 6.0, 25e3, 1500.0, 600e3, 900.0, 240e3, 160.0];
const NOISE: f64 = 0.004;

/// Sweeps at two levels, one of them held out, of an axle whose sensors see `gain(location, f)` of its motions.
fn evidence<G: Into<Complex<f64>>>(model: &Strut, p: &[f64], gain: impl Fn(&str, f64) -> G) -> Evidence {
    let frequency = logarithmic(0.6, 28.0, 60);
    let values = resolve(model, p);
    let signal = |point: &Point| qcar_runtime::discover::observe::signal_of(model.about(), point);
    let mut random = Random(7);
    let (mut runs, mut series) = (Vec::new(), Vec::new());
    for (run, (level, role)) in [(0.025, Role::Fit), (0.1, Role::HeldOut)].into_iter().enumerate() {
        runs.push(swept::run(run, level, role, &frequency));
        for location in ["wheel", "body"] {
            let h = ratio(
                model,
                &values,
                0,
                &signal(&point(location)),
                &signal(&point("pad")),
                &frequency,
            );
            let value: Vec<Complex<f64>> = h
                .expect("the axle has these sensors")
                .value
                .iter()
                .zip(&frequency)
                .map(|(h, &f)| {
                    let noise = Complex::new(random.normal(), random.normal()) * NOISE / std::f64::consts::SQRT_2;
                    h * gain(location, f).into() / gain("pad", f).into() * (1.0 + noise)
                })
                .collect();
            series.push(Series {
                noise: vec![0.001; 1],
                least_discrepancy: 0.0,
                run,
                sensor: point(location),
                kind: Kind::Harmonic(1),
                at: frequency.clone(),
                sigma: value.iter().map(|h| NOISE * h.norm()).collect(),
                value,
            });
        }
    }
    swept::evidence(runs, series)
}

fn resolve(model: &Strut, p: &[f64]) -> Values {
    let given = model
        .about()
        .parameters
        .iter()
        .zip(p)
        .map(|(parameter, &value)| (parameter.name.to_string(), value));
    Values::resolve(model.about(), &given.collect(), &Default::default()).expect("every parameter is given")
}

/// Starts a fifth off and fits all but the known masses.
fn fitted(model: &Strut, evidence: &Evidence) -> (Refit, Misfit) {
    let start: Vec<f64> = TRUTH
        .iter()
        .enumerate()
        .map(|(k, p)| if free(k) { 1.2 * p } else { *p })
        .collect();
    let all: Vec<Free> = (0..TRUTH.len())
        .filter(|&k| free(k))
        .map(|parameter| Free {
            parameter,
            lower: 0.3 * TRUTH[parameter],
            upper: 3.0 * TRUTH[parameter],
        })
        .collect();
    let refit = refit(model, &resolve(model, &start), &all, evidence).expect("the model has the sensors");
    let misfit = Misfit::of(model, &refit, evidence).expect("the model has the sensors");
    (refit, misfit)
}

fn free(parameter: usize) -> bool {
    parameter != 0 && parameter != 2
}

#[test]
fn a_smooth_calibration_error_leave_noise_alone() {
    let model = Strut::new(PLAIN);
    let wrong = |location: &str, f: f64| match location {
        "pad" => 1.008 - 0.003 * f.ln(),
        "wheel" => 0.993 + 0.002 * f.ln(),
        _ => 1.005 + 0.004 * (f / 5.0).ln().sin(),
    };
    let evidence = evidence(&model, &TRUTH, wrong);
    let (refit, misfit) = fitted(&model, &evidence);
    assert!(refit.stop.converged());
    assert!((0.85..1.15).contains(&misfit.fit), "{}", misfit.fit);
    assert!((0.85..1.15).contains(&misfit.held_out), "{}", misfit.held_out);
    for ((free, estimate), stderr) in refit.free.iter().zip(&refit.estimate).zip(refit.stderr()) {
        let error = (estimate - TRUTH[free.parameter]).abs();
        assert!(
            error < 4.0 * stderr,
            "{}: {estimate} ± {stderr}",
            model.about().parameters[free.parameter].name
        );
    }
}

/// A strut with a parameter that is the time since a run began.
fn timed(parameter: usize, clock: Clock) -> Strut {
    let mut model = Strut::new(PLAIN);
    model.about.parameters.to_mut()[parameter].clock = Some(clock);
    model
}

/// Its value is another in each line of a sweep: that of the moment in which the sweep passes there.
#[test]
fn a_parameter_that_is_the_time_changes_through_a_run() {
    let model = Strut::new(PLAIN);
    let mut evidence = evidence(&model, &TRUTH, |_, _| 1.0);
    let count = evidence.series[0].at.len();
    // Five steps of 400 s, and lines between them: the damping grows by 1 N s/m in a second.
    let moments: Vec<f64> = (0..count).map(|k| 2000.0 * k as f64 / (count - 1) as f64).collect();
    for run in &mut evidence.runs {
        if let Stimulus::Sweep { time, .. } = &mut run.stimulus {
            time.clone_from(&moments);
        }
    }
    let damping = model.about().parameters.iter().position(|p| p.name == "c_wheel_z");
    let damping = damping.expect("it has a damper");
    let still = resolve(&model, &TRUTH);
    let drifting = timed(damping, Clock::Seconds);
    let seen = predict(&drifting, &resolve(&drifting, &TRUTH), &[], &evidence, Role::Fit).expect("it has the sensors");
    let at = |time: f64| {
        let mut then = still.clone();
        then.set(damping, time);
        predict(&model, &then, &[], &evidence, Role::Fit).expect("it has the sensors")
    };
    let steps: Vec<_> = (0..=5).map(|k| at(400.0 * f64::from(k))).collect();
    for (place, own) in seen.iter().enumerate() {
        for (k, value) in own.value.iter().enumerate() {
            let (step, part) = ((moments[k] / 400.0).floor().min(4.0), moments[k] / 400.0);
            let [earlier, later] = [0, 1].map(|next| steps[step as usize + next][place].value[k]);
            let expected = earlier + (later - earlier) * (part - step);
            assert!((value - expected).norm() < 1e-12 * expected.norm(), "line {k}");
        }
    }
    let of_run = timed(damping, Clock::PartOfRun);
    let of_run = resolve(&of_run, &TRUTH).at_part(0.25, 2000.0);
    assert_eq!(of_run.as_slice()[damping], 0.25);
}

/// 4 % at one of three sensors that are good to 0.7 % each: all would have to be wrong, and that is no explanation.
#[test]
fn a_gain_beyond_calibration_is_told_when_suspected() {
    let model = Strut::new(PLAIN);
    let wrong = evidence(
        &model,
        &TRUTH,
        |location, _| if location == "wheel" { 1.04 } else { 1.0 },
    );
    let (base, _) = fitted(&model, &wrong);
    let suspected = Nuisance::of(&wrong).with_suspect("wheel", Some(&Axis::Z), Form::Gain, 1.0);
    let suspected = suspected.expect("the wheel has a sensor");
    let refit = refit_with(&model, &base.values, &base.free, &wrong, suspected, 60).expect("sensors are there");
    let gain = refit.coefficients[refit.nuisance.count() - 1].exp();
    assert!((gain - 1.04).abs() < 0.015, "{gain}");
    assert!(refit.chi2 < base.chi2 - 10.0, "{} {}", refit.chi2, base.chi2);
}

/// An accelerometer whose gain rises by 4 % below 3 Hz and falls by 5 % about 14 Hz, with the phase of such filters: up
/// to 1.2 degrees.
#[test]
fn a_smooth_calibration_curve_is_no_residual() {
    let shelf = |f: f64, corner: f64, height: f64| {
        let [zero, pole] = [corner / (height / 2.0).exp(), corner * (height / 2.0).exp()];
        Complex::new(1.0, f / zero) / Complex::new(1.0, f / pole)
    };
    let curve = |location: &str, f: f64| match location {
        "body" => 0.99 * shelf(f, 1.8, 0.04) * shelf(f, 14.0, -0.05),
        _ => Complex::ONE,
    };
    let model = Strut::new(PLAIN);
    let (_, misfit) = fitted(&model, &evidence(&model, &TRUTH, curve));
    assert!(
        misfit.fit < 1.1 && misfit.held_out < 1.2,
        "{} {}",
        misfit.fit,
        misfit.held_out
    );
}

#[test]
fn a_missing_mass_leaves_a_gap_around_its_mode() {
    let (real, model) = (
        Strut::new(Parts {
            powertrain: true,
            ..PLAIN
        }),
        Strut::new(PLAIN),
    );
    // A powertrain of 70 kg on mounts with a mode at 9.5 Hz.
    let p: Vec<f64> = TRUTH.iter().copied().chain([70.0, 250e3, 600.0]).collect();
    let evidence = evidence(&real, &p, |_, _| 1.0);
    let (refit, misfit) = fitted(&model, &evidence);
    assert!(
        misfit.fit > 5.0 && misfit.held_out > 5.0,
        "{} {}",
        misfit.fit,
        misfit.held_out
    );
    let strongest = &misfit.tiles[0];
    assert!(
        strongest.span.1 > 6.0 && strongest.span.0 < 14.0,
        "{:?}",
        strongest.span
    );
    let sweeps = Sweeps::new(&model, &refit, &evidence).expect("the model has the sensors");
    let nothing_better = sweeps.explained_by(&misfit, &evidence).expect("there is a residual");
    let best = sweeps.places[0].ceiling;
    assert!(
        nothing_better < best && best < 1.0,
        "a refit explains {nothing_better}, a place {best}"
    );
}

/// Laws in closed form, each at two levels with some noise of one percent. The second run may begin at a higher
/// frequency.
#[test]
fn laws_are_told_by_their_shape() {
    type Law = fn(Complex<f64>, f64) -> Complex<f64>;
    let laws: [(Law, Shape); 6] = [
        (|s, _| 2e4 + 300.0 * s, Shape::SpringDamper),
        (|s, _| 7.0 * s * s, Shape::Mass),
        // On a mount with a mode at 9.5 Hz.
        (
            |s, _| {
                let mount = 250e3 + 600.0 * s;
                70.0 * s * s * mount / (70.0 * s * s + mount)
            },
            Shape::Mass,
        ),
        (|s, _| 1e5 * s / (s + 60.0), Shape::Relaxation),
        (|_, level| Complex::I * 400.0 / level, Shape::FrictionLike),
        (|s, level| 1e4 * level * s, Shape::Other),
    ];
    let cases = laws.iter().flat_map(|law| [0.6, 6.0].map(|first| (law, first)));
    for ((law, expected), first) in cases {
        let mut random = Random(3);
        let mut run = |level: f64, first: f64| {
            let frequency = logarithmic(first, 28.0, 60);
            let at = |f: &f64| {
                let exact = law(Complex::I * std::f64::consts::TAU * f, level);
                exact * (1.0 + 0.01 * Complex::new(random.normal(), random.normal()))
            };
            let value: Vec<Complex<f64>> = frequency.iter().map(at).collect();
            RunStiffness {
                run: 0,
                level,
                sigma: value.iter().map(|stiffness| 0.014 * stiffness.norm()).collect(),
                frequency,
                value,
            }
        };
        let stiffness = MissingStiffness {
            place: Place::Parameter(0),
            ceiling: 1.0,
            common: 1.0,
            runs: vec![run(0.025, 0.6), run(0.1, first)],
        };
        assert_eq!(shape(&stiffness), *expected, "from {first} Hz");
    }
}

#[test]
fn held_out_runs_are_not_seen_by_the_fit() {
    let model = Strut::new(PLAIN);
    let mut evidence = evidence(&model, &TRUTH, |_, _| 1.0);
    let (before, _) = fitted(&model, &evidence);
    for series in evidence.series.iter_mut().filter(|series| series.run == 1) {
        series.value.iter_mut().for_each(|value| *value *= 3.0);
    }
    let (after, misfit) = fitted(&model, &evidence);
    assert_eq!(before.estimate, after.estimate);
    assert!(misfit.held_out > 100.0);
}

/// A spring of 30 N/mm in parallel to the sub-spring: κ is 30 N/mm at every frequency, whatever the size of the change.
#[test]
fn kappa_is_the_stiffness_that_was_taken_away() {
    let model = Strut::new(PLAIN);
    let mut real = TRUTH;
    real[3] += 30e3;
    let evidence = evidence(&model, &real, |_, _| 1.0);
    let base = refit(&model, &resolve(&model, &TRUTH), &[], &evidence.with_tolerance(0.05)).expect("sensors are there");
    let base = Refit {
        coefficients: vec![0.0; base.coefficients.len()],
        ..base
    };
    let map = stiffness_map(&model, &base, &evidence).expect("sensors are there");
    let spring = map
        .iter()
        .find(|stiffness| stiffness.place == Place::Parameter(3))
        .expect("channels see the spring");
    assert!(
        spring.ceiling > 0.99 && spring.ceiling > map[0].ceiling - 0.002,
        "{}",
        spring.ceiling
    );
    assert_eq!(shape(spring), Shape::SpringDamper);
    let run = &spring.runs[0];
    for ((f, stiffness), sigma) in run.frequency.iter().zip(&run.value).zip(&run.sigma) {
        assert!(
            (stiffness - 30e3).norm() < 4.0 * sigma + 600.0,
            "{stiffness} ± {sigma} N/m at {f} Hz"
        );
        assert!(*f > 4.0 || *sigma < 3e3, "± {sigma} N/m at {f} Hz");
    }
    let sensor = map
        .iter()
        .find(|stiffness| stiffness.place == Place::Sensor(point("body")))
        .expect("it was measured");
    assert!(sensor.ceiling < 0.9, "{}", sensor.ceiling);
}

/// A damper that is too weak looks like a stiffness `jωc` in parallel to the spring. A second run that begins at a higher
/// frequency shows the same.
#[test]
fn runs_with_other_bands_have_a_common_kappa() {
    let model = Strut::new(PLAIN);
    let mut real = TRUTH;
    real[4] += 1000.0;
    let mut evidence = evidence(&model, &real, |_, _| 1.0);
    evidence.runs[1].role = Role::Fit;
    for series in evidence.series.iter_mut().filter(|series| series.run == 1) {
        series.at.drain(..20);
        series.value.drain(..20);
        series.sigma.drain(..20);
    }
    let base = refit(&model, &resolve(&model, &TRUTH), &[], &evidence.with_tolerance(0.05)).expect("sensors are there");
    let map = stiffness_map(&model, &base, &evidence).expect("sensors are there");
    let is_spring = |own: &&MissingStiffness| own.place == Place::Parameter(3);
    let spring = map.iter().find(is_spring).expect("channels see the spring");
    assert!(
        spring.common > spring.ceiling - 0.01,
        "{} of {}",
        spring.common,
        spring.ceiling
    );
}

/// With a Jacobian that is too small by far, each step of Newton's method more than doubles the error.
#[test]
fn a_rig_whose_states_cannot_be_found_has_no_force() {
    let on = OnRig {
        wheel: "wheel".into(),
        body: "body".into(),
    };
    let mut evidence = evidence(&Strut::new(PLAIN), &TRUTH, |_, _| 1.0);
    evidence.runs.truncate(1);
    evidence.runs[0].stimulus = Stimulus::Travel {
        on,
        axis: Axis::Z,
        ends: [-0.05, 0.05],
    };
    evidence.series.truncate(1);
    evidence.series[0].kind = Kind::Travel;
    evidence.series[0].at = vec![-0.02, 0.0, 0.02];
    let forces = |jacobian_factor: f64| {
        let mut model = Strut::new(PLAIN);
        model.about.linear = false;
        model.jacobian_factor = jacobian_factor;
        let predictions = predict(&model, &resolve(&model, &TRUTH), &[], &evidence, Role::Fit);
        predictions.expect("the model has both masses")[0].value.clone()
    };
    let spring = TRUTH[3];
    for (force, travel) in forces(1.0).iter().zip([-0.02, 0.0, 0.02]) {
        assert!((force.re - spring * travel).abs() < 1.0, "{force} N at {travel} m");
    }
    assert!(forces(0.3).iter().all(|force| force.is_nan()));
}
