//! The rig fit on synthetic measurements of an assembled model whose parameters are known.

use nalgebra::Complex;
use qcar_runtime::campaign::{Parameter, Role};
use qcar_runtime::fit::bootstrap::ParameterBootstrap;
use qcar_runtime::fit::observation::{Difference, Pair};
use qcar_runtime::fit::plan::ChannelWeight;
use qcar_runtime::fit::quality::{K_MAGNITUDE, K_PHASE, quality};
use qcar_runtime::fit::report::{Bound, NoError, ParameterFit};
use qcar_runtime::fit::{Fit, Level, Observation, Plan, Setup, Weighting, channels::across_links};
use qcar_runtime::model::{Channel, Default, Model};
use qcar_runtime::progress::NO_PROGRESS;
use std::collections::BTreeMap;

use super::support::{self, Assembled, CHAIN, Law, acceleration, between, chain};

/// Starts that are off by up to a third, either way.
const OFF: [f64; 10] = [1.0, 1.2, 0.8, 0.75, 1.3, 1.3, 0.7, 1.25, 0.75, 0.9];

fn plan() -> Plan {
    let parameter = |(&(name, unit, value), off): (&support::Given, f64)| Parameter {
        name: name.to_owned(),
        value: value * off,
        unit: unit.to_owned(),
        range: Some((0.5 * value, 2.0 * value)),
        fit: name != "m_corner",
        comment: String::new(),
    };
    Plan {
        source: "campaign.toml".into(),
        parameters: CHAIN.iter().zip(OFF).map(parameter).collect(),
        vehicle: BTreeMap::new(),
        channels: BTreeMap::new(),
        weighting: Weighting::Noise,
        starts: 4,
        seed: 0,
        gain_error: 0.0,
    }
}

fn grid(lines: usize) -> Vec<f64> {
    (0..lines)
        .map(|k| 0.5 * 60_f64.powf(k as f64 / (lines - 1) as f64))
        .collect()
}

fn channel(name: &'static str, far: &'static str, near: &'static str) -> Channel {
    Channel {
        name: name.into(),
        numerator: acceleration(far),
        denominator: acceleration(near),
    }
}

fn chain_channels() -> Vec<Channel> {
    vec![
        channel("pad_to_wheel", "wheel", "pad"),
        channel("wheel_to_body", "body", "wheel"),
        channel("body_to_pwt", "pwt", "body"),
    ]
}

/// What a channel is in truth, from the closed form.
fn exact(model: &Assembled, p: &[f64], channel: &Channel, frequency: f64) -> Complex<f64> {
    let omega = std::f64::consts::TAU * frequency;
    let h = model.closed_form(p, omega);
    let masses = model
        .about()
        .outputs
        .iter()
        .map(|output| output.signal.location.to_string())
        .collect::<Vec<_>>();
    let value = |location: &str| match masses.iter().position(|mass| mass == location) {
        Some(mass) => h[mass],
        None => Complex::from(-omega * omega),
    };
    value(&channel.numerator.location) / value(&channel.denominator.location)
}

fn observation(channel: &Channel, frequency: &[f64], value: Vec<Complex<f64>>, variance: f64) -> Observation {
    Observation {
        channel: channel.clone(),
        fitted: true,
        relative_variance: vec![variance; frequency.len()],
        coherence: vec![1.0; frequency.len()],
        frequency: frequency.to_vec(),
        value,
        band: (0.5, 30.0),
        sensors: (2, 2),
        differences: Vec::new(),
    }
}

/// A run with relative errors of standard deviation `noise` in each quadrature.
fn level(model: &Assembled, p: &[f64], lines: usize, noise: f64, random: &mut Random) -> Level {
    let frequency = grid(lines);
    let observe = |channel: &Channel| {
        let value = frequency
            .iter()
            .map(|&f| exact(model, p, channel, f) * (1.0 + random.complex() * noise));
        let value = value.collect();
        observation(channel, &frequency, value, 2.0 * noise * noise)
    };
    let observations = chain_channels().iter().map(observe).collect();
    Level {
        name: "sweep.csv".into(),
        role: Role::Fit,
        excitation: 0,
        observations,
    }
}

fn clean(model: &Assembled) -> Level {
    level(model, &support::truth(&CHAIN), 60, 0.0, &mut Random(1))
}

/// Normal numbers from a multiplicative generator, reproducible everywhere.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn complex(&mut self) -> Complex<f64> {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        Complex::from_polar(radius, std::f64::consts::TAU * self.uniform())
    }
}

fn run(model: &Assembled, plan: &Plan, levels: &[Level]) -> Fit {
    Setup::new(model, plan, levels)
        .unwrap_or_else(|error| panic!("{error}"))
        .fit()
}

fn parameter<'a>(fit: &'a Fit, name: &str) -> &'a ParameterFit {
    fit.parameters.iter().find(|parameter| parameter.name == name).unwrap()
}

#[track_caller]
fn assert_recovered(fit: &Fit, relative: f64) {
    assert!(fit.converged, "{:?}", fit.stopped);
    for (parameter, truth) in fit.parameters.iter().zip(CHAIN).take(9) {
        let error = parameter.value / truth.2 - 1.0;
        assert!(error.abs() < relative, "{} is off by {error}", parameter.name);
    }
}

#[test]
fn clean_measurements_give_the_truth_back() {
    for model in [chain(true), chain(false)] {
        let fit = run(&model, &plan(), &[clean(&model)]);
        assert_recovered(&fit, 1e-5);
        assert!(fit.cost < 1e-10 * fit.start_cost);
        assert!(
            fit.channels
                .iter()
                .all(|c| c.quality.fit_magnitude > 99.99 && c.quality.fit_phase > 99.99)
        );
    }
}

#[test]
fn what_no_channel_sees_keeps_its_start_and_is_said_to() {
    let model = chain(true);
    let fit = run(&model, &plan(), &[clean(&model)]);
    let unseen = parameter(&fit, "k_wheel_x");
    assert_eq!((unseen.value, unseen.fitted), (unseen.start, false));
    assert_eq!(unseen.why_no_stderr, Some(NoError::NotSeen));
    assert_eq!(parameter(&fit, "m_corner").why_no_stderr, Some(NoError::Known));
}

#[test]
fn standard_errors_cover_the_truth_as_often_as_they_say() {
    let model = chain(true);
    let (mut plan, mut random) = (plan(), Random(7));
    plan.starts = 1;
    let trials = 40;
    let (mut within_one, mut within_two, mut count) = (0, 0, 0);
    for _ in 0..trials {
        let level = level(&model, &support::truth(&CHAIN), 80, 0.02, &mut random);
        let fit = run(&model, &plan, &[level]);
        for (parameter, truth) in fit
            .parameters
            .iter()
            .zip(CHAIN)
            .filter(|(parameter, _)| parameter.fitted)
        {
            let deviation = (parameter.value - truth.2).abs() / parameter.stderr.unwrap();
            count += 1;
            within_one += usize::from(deviation < 1.0);
            within_two += usize::from(deviation < 2.0);
        }
    }
    // Of a normal distribution 68 % and 95 %; with 320 correlated draws these bands are three standard deviations wide.
    let part = |within: usize| within as f64 / f64::from(count);
    assert!((0.55..0.80).contains(&part(within_one)), "{}", part(within_one));
    assert!((0.89..0.99).contains(&part(within_two)), "{}", part(within_two));
}

/// With white errors, and with errors that neighbouring lines share, of which independent lines would make too little.
#[test]
#[ignore = "24 bootstraps; .ci/run runs it"]
fn bootstrap_intervals_cover_the_truth_as_often_as_they_say() {
    let model = chain(true);
    let (mut plan, mut random) = (plan(), Random(11));
    plan.starts = 1;
    for (shared, least) in [(1, 0.86), (6, 0.82)] {
        let (mut within, mut count, mut wide) = (0, 0, 0.0);
        for _ in 0..12 {
            let mut level = level(&model, &support::truth(&CHAIN), 80, 0.02, &mut random);
            share_errors(&model, &mut level, shared);
            let levels = [level];
            let setup = Setup::new(&model, &plan, &levels).unwrap();
            let fit = setup.fit();
            let found = setup.bootstrap(&fit, 100, NO_PROGRESS);
            assert_eq!(found.failed, 0);
            for own in &found.parameters {
                let truth = CHAIN.iter().find(|given| given.0 == own.name).unwrap().2;
                let [from, to] = own.interval;
                within += usize::from((from..=to).contains(&truth));
                wide += own.stderr / parameter(&fit, &own.name).stderr.unwrap();
                count += 1;
            }
        }
        // Intervals are of 95 %; of 96 correlated ones the bands are three standard deviations wide.
        let part = within as f64 / f64::from(count);
        assert!((least..=1.0).contains(&part), "{shared}: {part}");
        let wide = wide / f64::from(count);
        assert!((0.75..1.1).contains(&wide), "{shared}: {wide} standard errors");
    }
}

/// Gives so many neighbouring lines the mean of their errors, times the root of their number.
fn share_errors(model: &Assembled, level: &mut Level, shared: usize) {
    for own in &mut level.observations {
        let truth = |&f: &f64| exact(model, &support::truth(&CHAIN), &own.channel, f);
        let truth: Vec<_> = own.frequency.iter().map(truth).collect();
        let errors: Vec<_> = own
            .value
            .iter()
            .zip(&truth)
            .map(|(value, truth)| value / truth - 1.0)
            .collect();
        for (first, errors) in errors.chunks(shared).enumerate() {
            let error = errors.iter().sum::<Complex<f64>>() / (errors.len() as f64).sqrt();
            let lines = own.value.iter_mut().zip(&truth).skip(first * shared);
            lines
                .take(errors.len())
                .for_each(|(value, truth)| *value = truth * (1.0 + error));
        }
    }
}

#[test]
fn a_bootstrap_depends_on_the_seed_alone_and_has_gains_and_sides_in_it() {
    let model = chain(true);
    let (mut plan, mut level) = (plan(), clean(&model));
    let wide = |plan: &Plan, level: &Level| {
        let levels = [level.clone()];
        let setup = Setup::new(&model, plan, &levels).unwrap();
        let fit = setup.fit();
        let (found, again) = (
            setup.bootstrap(&fit, 100, NO_PROGRESS),
            setup.bootstrap(&fit, 100, NO_PROGRESS),
        );
        assert_eq!(found, again);
        let relative = |own: &ParameterBootstrap| own.stderr / own.value;
        found.parameters.iter().map(relative).fold(0.0, f64::max)
    };
    // Measured without an error, and with errors of 2 % by either cause.
    assert!(wide(&plan, &level) < 1e-6);
    plan.gain_error = 0.02;
    let by_gain = wide(&plan, &level);
    plan.gain_error = 0.0;
    for own in &mut level.observations {
        own.differences.push(Difference {
            pair: Pair::LeftRight,
            half: vec![Complex::from(0.02); own.frequency.len()],
        });
    }
    let by_sides = wide(&plan, &level);
    assert!(by_gain > 0.005 && by_sides > 0.005, "{by_gain} {by_sides}");
}

#[test]
fn several_runs_are_fitted_at_once_and_held_out_ones_never() {
    let model = chain(true);
    let mut stiff = support::truth(&CHAIN);
    stiff[5] *= 1.5;
    let held_out = Level {
        role: Role::HeldOut,
        ..level(&model, &stiff, 60, 0.0, &mut Random(1))
    };
    let other_lines = level(&model, &support::truth(&CHAIN), 45, 0.0, &mut Random(1));
    let fit = run(&model, &plan(), &[clean(&model), other_lines, held_out]);
    assert_recovered(&fit, 1e-5);
    let of_role = |role: &'static str| fit.channels.iter().filter(move |channel| channel.role == role);
    assert_eq!((of_role("fit").count(), of_role("held_out").count()), (6, 3));
    assert!(of_role("held_out").all(|channel| !channel.fitted));
    assert!(of_role("held_out").any(|channel| channel.quality.fit_magnitude < 95.0));
}

#[test]
fn a_gain_error_moves_the_estimate_within_its_stated_share() {
    let model = chain(true);
    let mut level = clean(&model);
    for observation in &mut level.observations {
        let gain = |location: &str| if location == "body" { 1.005 } else { 1.0 };
        let factor = gain(&observation.channel.numerator.location) / gain(&observation.channel.denominator.location);
        observation.value.iter_mut().for_each(|value| *value *= factor);
        observation.sensors = (1, 1);
    }
    let plan = Plan {
        gain_error: 0.005,
        ..plan()
    };
    let fit = run(&model, &plan, &[level]);
    for (parameter, truth) in fit
        .parameters
        .iter()
        .zip(CHAIN)
        .filter(|(parameter, _)| parameter.fitted)
    {
        let error = (parameter.value - truth.2).abs();
        let stated = parameter.stderr_parts.unwrap().gain;
        assert!(
            error < 1.05 * stated,
            "{}: off by {error}, stated {stated}",
            parameter.name
        );
    }
}

#[test]
fn the_difference_of_two_sides_is_in_the_error_bar() {
    let model = chain(true);
    let (mut left, mut right) = (support::truth(&CHAIN), support::truth(&CHAIN));
    (left[5], right[5]) = (1.02 * left[5], 0.98 * right[5]);
    let mut level = clean(&model);
    for observation in &mut level.observations {
        let side = |p: &[f64], f: f64| exact(&model, p, &observation.channel, f);
        let half = observation
            .frequency
            .iter()
            .map(|&f| (side(&left, f) / side(&right, f)).ln() * 0.5)
            .collect();
        observation.differences = vec![Difference {
            pair: Pair::LeftRight,
            half,
        }];
    }
    let fit = run(&model, &plan(), &[level]);
    let stiffness = parameter(&fit, "k_wheel_z");
    assert!(
        (stiffness.relative_stderr.unwrap() - 0.02).abs() < 0.002,
        "{stiffness:?}"
    );
    assert!(fit.asymmetry > 0.002 && fit.asymmetry < 0.02, "{}", fit.asymmetry);
}

#[test]
fn a_parameter_pressed_against_its_range_is_flagged() {
    let model = chain(true);
    let mut plan = plan();
    plan.parameters[5].range = Some((1.2 * CHAIN[5].2, 2.0 * CHAIN[5].2));
    let fit = run(&model, &plan, &[clean(&model)]);
    let pressed = parameter(&fit, "k_wheel_z");
    assert_eq!(pressed.at_bound, Some(Bound::Lower));
    assert_eq!(
        (pressed.stderr, pressed.why_no_stderr.clone()),
        (None, Some(NoError::AtBound))
    );
    assert!((pressed.value / (1.2 * CHAIN[5].2) - 1.0).abs() < 1e-3);
    assert!(parameter(&fit, "k_tire").stderr.is_some());
}

#[test]
fn parallel_springs_are_seen_only_together() {
    let masses: Vec<(&'static str, Law)> =
        vec![("body", |p| p[0] - p[1] - p[2]), ("wheel", |p| p[1]), ("pwt", |p| p[2])];
    let elements = vec![
        between("tire", "wheel", "pad", [|p| p[3], |p| p[4]]),
        between("spring", "body", "wheel", [|p| p[5], |p| p[6]]),
        between("bushing", "body", "wheel", [|p| p[7], |_| 0.0]),
        between("powertrain_mount", "pwt", "body", [|_| 210e3, |p| p[8]]),
    ];
    let model = Assembled::new("parallel", &CHAIN, masses, elements, true);
    let plan = plan();
    let fit = run(&model, &plan, &[clean(&model)]);
    let together = |other: &str| {
        Some(NoError::OnlyTogether {
            with: vec![other.to_owned()],
        })
    };
    assert_eq!(parameter(&fit, "k_wheel_z").why_no_stderr, together("k_pwt_z"));
    assert_eq!(parameter(&fit, "k_pwt_z").why_no_stderr, together("k_wheel_z"));
    assert!(parameter(&fit, "k_tire").stderr.is_some());
}

#[test]
fn a_tied_parameter_follows_the_fit_of_its_leader() {
    let model = chain(true).with_default(8, Default::Same(6));
    let mut truth = support::truth(&CHAIN);
    truth[8] = truth[6];
    let mut plan = plan();
    plan.parameters.remove(8);
    let fit = run(&model, &plan, &[level(&model, &truth, 60, 0.0, &mut Random(1))]);
    let tied = parameter(&fit, "c_pwt_z");
    assert_eq!(tied.tied_to.as_deref(), Some("c_wheel_z"));
    assert!((tied.value / truth[6] - 1.0).abs() < 1e-5 && !tied.fitted);
    assert_eq!(tied.why_no_stderr, Some(NoError::Tied));
}

#[test]
fn lines_of_no_information_do_not_count_unless_the_thesis_weights_are_asked_for() {
    let model = chain(true);
    let mut level = clean(&model);
    for observation in &mut level.observations {
        for line in 40..60 {
            observation.value[line] *= 3.0;
            observation.relative_variance[line] = 100.0;
        }
    }
    let noise = run(&model, &plan(), std::slice::from_ref(&level));
    let thesis = run(
        &model,
        &Plan {
            weighting: Weighting::Thesis,
            ..plan()
        },
        &[level],
    );
    let off = |fit: &Fit| (parameter(fit, "k_wheel_z").value / CHAIN[5].2 - 1.0).abs();
    assert!(
        off(&noise) < 0.001 && off(&thesis) > 0.01,
        "{} {}",
        off(&noise),
        off(&thesis)
    );
}

#[test]
fn lines_outside_the_band_of_a_channel_weigh_a_twentieth() {
    let model = chain(true);
    let cost = |band: (f64, f64), importance: f64| {
        let weight = ChannelWeight {
            band: Some(band),
            importance,
            ..ChannelWeight::default()
        };
        let channels = chain_channels().iter().map(|c| (c.name.to_string(), weight)).collect();
        let plan = Plan {
            channels,
            starts: 1,
            ..plan()
        };
        run(&model, &plan, &[clean(&model)]).start_cost
    };
    let inside = cost((0.1, 50.0), 1.0);
    assert!((cost((40.0, 50.0), 1.0) / inside - 0.05 * 0.05).abs() < 1e-12);
    assert!((cost((0.1, 50.0), 0.5) / inside - 0.25).abs() < 1e-12);
}

#[test]
fn the_result_depends_on_nothing_but_its_inputs() {
    let model = chain(true);
    let level = level(&model, &support::truth(&CHAIN), 60, 0.02, &mut Random(3));
    let json = || serde_json::to_string(&run(&model, &plan(), std::slice::from_ref(&level))).unwrap();
    assert_eq!(json(), json());
}

#[test]
fn everything_wrong_with_a_plan_is_said_at_once() {
    let model = chain(true);
    let mut plan = plan();
    plan.parameters[1].value = 500.0;
    plan.parameters[3].unit = "N s/m".to_owned();
    plan.parameters[5].name = "k_whel_z".to_owned();
    let mut level = clean(&model);
    level.observations[2].channel = channel("body_to_sf", "sf", "body");
    let said = Setup::new(&model, &plan, &[level]).err().unwrap().to_string();
    for part in [
        "campaign.toml, `parameters.m_wheel`: found the start value 500, expected one from 22.5 to 90",
        "`parameters.k_tire`: found unit `N s/m`, expected the unit `N/m` of the model",
        "`k_whel_z`: found this parameter, expected a parameter of model `chain`; did you mean `k_wheel_z`?",
        "`k_wheel_z`: found no value",
        "`body_to_sf`: found `sf` along z, expected a place of model `chain`, which has `body`, `wheel`, `pwt`, `pad`",
    ] {
        assert!(said.contains(part), "{part}\nis not in\n{said}");
    }
}

#[test]
fn a_campaign_without_anything_to_fit_to_is_refused() {
    let model = chain(true);
    let held_out = Level {
        role: Role::HeldOut,
        ..clean(&model)
    };
    let said = Setup::new(&model, &plan(), &[held_out]).err().unwrap().to_string();
    assert!(said.contains("no run with role `fit`"), "{said}");
}

fn names(channels: &[Channel]) -> Vec<&str> {
    channels.iter().map(|channel| &*channel.name).collect()
}

#[test]
fn channels_lie_over_the_force_elements_that_were_measured() {
    let model = chain(true);
    let about = model.about();
    let of = |places: &[&'static str]| {
        let measured: Vec<_> = places.iter().map(|place| acceleration(place)).collect();
        across_links(about, &about.excitations[0], &measured)
    };
    let all = of(&["pad", "wheel", "body", "pwt"]);
    assert_eq!(names(&all.fitted), ["pad_to_wheel", "wheel_to_body", "body_to_pwt"]);
    assert_eq!(names(&all.compared), ["pad_to_body", "pad_to_pwt"]);
    // Without the wheel nothing but the pad tells of the body.
    assert_eq!(
        names(&of(&["pad", "body", "pwt"]).fitted),
        ["body_to_pwt", "pad_to_body"]
    );
}

#[test]
fn a_lever_gives_no_channel_where_simpler_elements_already_tell() {
    let masses: Vec<(&'static str, Law)> =
        vec![("body", |_| 1.0), ("wheel", |_| 1.0), ("sf", |_| 1.0), ("tm", |_| 1.0)];
    let lever = support::Element {
        name: "spring",
        ends: vec![("body", |_| 1.0), ("sf", |_| -0.4), ("wheel", |_| -0.6)],
        law: [|_| 1.0, |_| 0.0],
    };
    let elements = vec![
        between("tire", "wheel", "pad", [|_| 1.0, |_| 1.0]),
        lever,
        between("damper", "tm", "wheel", [|_| 0.0, |_| 1.0]),
        between("subframe_mount", "body", "sf", [|_| 1.0, |_| 1.0]),
    ];
    let model = Assembled::new("arm", &CHAIN, masses, elements, true);
    let about = model.about();
    let measured = ["pad", "wheel", "body", "sf"].map(acceleration);
    let channels = across_links(about, &about.excitations[0], &measured);
    assert_eq!(names(&channels.fitted), ["pad_to_wheel", "sf_to_body", "wheel_to_body"]);
}

#[test]
fn the_fit_percentage_is_that_of_its_definition() {
    let frequency = [0.5, 1.0, 2.0, 8.0];
    let measured = frequency.map(|f| Complex::from_polar(f, -f));
    let model = measured.map(|value| value * Complex::from_polar(10_f64.powf(0.05), 0.1));
    let quality = quality(&frequency, &model, &measured);
    assert!((quality.error_magnitude - 1.0).abs() < 1e-12 && (quality.error_phase - 0.1).abs() < 1e-12);
    assert!((quality.fit_magnitude - 100.0 * (-K_MAGNITUDE).exp()).abs() < 1e-9);
    assert!((quality.fit_phase - 100.0 * (-0.1 * K_PHASE).exp()).abs() < 1e-9);
    // From 0.5 to 8 Hz are four octaves; the last line stands for the nearer half of the two below it.
    let last = [measured[0], measured[1], measured[2], model[3]];
    assert!((self::quality(&frequency, &last, &measured).error_magnitude - 0.25).abs() < 1e-12);
}

#[test]
fn several_starts_find_the_minimum_that_one_misses() {
    // One channel alone, and a start from which the powertrain's resonance is taken for another.
    let model = chain(true);
    let only = channel("pad_to_body", "body", "pad");
    let (frequency, truth) = (grid(60), support::truth(&CHAIN));
    let value = frequency.iter().map(|&f| exact(&model, &truth, &only, f)).collect();
    let levels = [Level {
        observations: vec![observation(&only, &frequency, value, 0.0)],
        ..clean(&model)
    }];
    let mut random = Random(84);
    let mut lost = plan();
    for (parameter, truth) in lost.parameters.iter_mut().zip(CHAIN).skip(1) {
        parameter.value = truth.2 * 0.06 * 130_f64.powf(random.uniform());
        parameter.range = Some((0.05 * truth.2, 8.0 * truth.2));
    }
    let one = run(
        &model,
        &Plan {
            starts: 1,
            ..lost.clone()
        },
        &levels,
    );
    assert!(one.converged && one.cost > 0.1, "{:?} at {}", one.stopped, one.cost);
    let many = run(&model, &Plan { starts: 16, ..lost }, &levels);
    assert_recovered(&many, 1e-4);
    assert!(many.minima.len() > 1);
    assert!(many.minima.windows(2).all(|pair| pair[0].cost < pair[1].cost));
    assert!(many.minima.iter().map(|minimum| minimum.starts).sum::<usize>() <= 16);
}
