//! What is tried on a state, and what that is held against.

use super::made::{Levers, contender, evidence, history, leaving, ride, setting, state, sweep};
use super::{Evidence, Given, Role, Setting, State, Stimulus, Wanted};
use nalgebra::Complex;

const ANYTHING: Wanted = Wanted {
    least: 0.0,
    sensor: false,
};

/// The state of evidence whose runs leave these residuals.
fn with_residuals(fit: f64, of_runs: &[(usize, f64)]) -> State {
    let mut explanation = leaving(fit);
    let residuals = of_runs.iter().map(|&(count, residual)| vec![residual; 2 * count]);
    explanation.gap.residuals = residuals.collect();
    state(explanation)
}

/// A few values that are far off and many that are a little off tell of what is missing; noise tells nothing, however
/// much of it there is, and what is held out is not asked.
#[test]
fn a_first_look_is_at_runs_whose_gap_is_wide_or_heavy() {
    let (few, many, more) = (2, 400, 500);
    let of_runs = [(few, 10.0), (many, 2.0), (few, 2.0), (more, 1.0), (many, 10.0)];
    let roles = [Role::Fit, Role::Fit, Role::Fit, Role::Fit, Role::HeldOut];
    let runs = roles
        .iter()
        .zip(of_runs)
        .map(|(role, (count, _))| (*role, sweep(), count));
    let evidence = evidence(1.0, runs.collect());
    assert_eq!(with_residuals(2.0, &of_runs).telling(&evidence), [0, 1]);
}

#[test]
fn until_the_last_look_it_is_at_the_widest_ride_and_at_every_sweep() {
    let of_runs = [8.0, 7.0, 10.0, 6.0, 2.0].map(|gap| (50, gap));
    let stimuli = [ride(), sweep(), ride(), sweep(), sweep()];
    let evidence = evidence(1.0, stimuli.map(|stimulus| (Role::Fit, stimulus, 50)).to_vec());
    let state = with_residuals(8.0, &of_runs);
    assert_eq!(state.widest(&evidence), [2, 1, 3, 4]);
    assert_eq!(state.telling(&evidence), [2, 1, 3]);
    let looks = state.looks(&ANYTHING, &evidence);
    let runs = [&looks.first, &looks.most, &looks.all].map(|of| of.runs.len());
    assert_eq!(runs, [3, 4, 5]);
}

/// A model may bend to what sweeps show alone, and to what a cycle shows alone.
#[test]
fn a_first_look_is_at_one_run_of_each_kind_beside_but_at_no_ride_for_that() {
    let of_runs = [10.0, 1.0, 9.0, 1.2, 1.1].map(|gap| (50, gap));
    let stimuli = [sweep(), ride(), sweep(), history(), history()];
    let evidence = evidence(1.0, stimuli.map(|stimulus| (Role::Fit, stimulus, 50)).to_vec());
    assert_eq!(with_residuals(8.0, &of_runs).telling(&evidence), [0, 2, 3]);
}

#[test]
fn a_ride_may_take_fewer_steps_for_one_of_many_than_for_the_last_word() {
    let evidence = evidence(1.0, vec![(Role::Fit, ride(), 50)]);
    let state = with_residuals(8.0, &[(50, 8.0)]);
    let looks = state.looks(&ANYTHING, &evidence);
    let most = |of: &Evidence| match &of.runs[0].stimulus {
        Stimulus::Cleat(passage) => passage.most_steps,
        other => panic!("{other:?} is no ride"),
    };
    for look in [&looks.first, &looks.most, &looks.all] {
        assert!(most(look) < most(looks.whole));
    }
}

#[test]
fn next_to_noise_a_first_look_is_at_the_worst_run_of_each_kind() {
    let of_runs = [(50, 1.0), (50, 1.1), (50, 0.9), (50, 1.3)];
    let runs = vec![
        (Role::Fit, sweep(), 50),
        (Role::Fit, sweep(), 50),
        (Role::Fit, history(), 50),
        (Role::HeldOut, sweep(), 50),
    ];
    assert_eq!(with_residuals(1.0, &of_runs).telling(&evidence(1.0, runs)), [1, 2]);
}

/// The first look is at two of three runs.
#[test]
fn what_is_unsteady_is_taken_off_all_but_the_last_look() {
    let evidence = evidence(1.0, vec![(Role::Fit, sweep(), 2); 3]);
    let mut state = with_residuals(2.0, &[(2, 2.0), (2, 1.0), (2, 2.0)]);
    let beyond = |by: f64| vec![Complex::from(by), Complex::from(2.0 * by)];
    state.explanation.refit.unsteady = [0.1, 0.2, 0.3].map(beyond).to_vec();
    let looks = state.looks(&ANYTHING, &evidence);
    let values = |of: &Evidence| -> Vec<f64> { of.series.iter().flat_map(|s| s.value.iter().map(|v| v.re)).collect() };
    assert_eq!(values(&looks.first), [0.9, 0.8, 0.7, 0.4]);
    assert_eq!(values(&looks.all), [0.9, 0.8, 0.8, 0.6, 0.7, 0.4]);
    assert_eq!(values(looks.whole), [1.0; 6]);
}

/// What is forgiven of values that are all this, where the model shows 1 and misses them by so many of their hundredths.
fn forgiven(value: f64, gap: f64, residual: f64) -> f64 {
    let evidence = evidence(value, vec![(Role::Fit, sweep(), 50)]);
    let state = with_residuals(gap, &[(50, residual)]);
    state.looks(&ANYTHING, &evidence).tolerance
}

/// The median of what the model misses, within limits.
#[test]
fn a_first_look_forgives_what_the_model_misses_itself() {
    assert!((forgiven(1.4, 2.0, 2.0) * 1.4 - 0.02).abs() < 1e-12);
    assert_eq!((forgiven(1.4, 2.0, 0.1), forgiven(1.4, 2.0, 50.0)), (0.003, 0.1));
}

/// Refitted, the model shows what there is: what it misses in other runs must not be forgiven here.
#[test]
fn a_first_look_forgives_less_where_the_model_bends_to_it() {
    assert_eq!(forgiven(1.0, 2.0, 50.0), 0.003);
    // A gap that is no wider than noise is seen in no look, and a sharper one shows no more of it.
    assert_eq!(forgiven(1.0, 1.0, 50.0), 0.1);
}

/// The effects that were fitted to the end where the wheel moves more than the lever says: another ratio explains that, and
/// another gain of the sensor.
fn tried(wanted: &Wanted) -> Vec<String> {
    let evidence = evidence(1.2, vec![(Role::Fit, sweep(), 60)]);
    let workshop = Box::new(Levers::new());
    let state = State::base(workshop, &setting(), &evidence, &|_| ()).expect("a lever answers to a sweep");
    let field = state.contenders(wanted, &evidence, &|_| ()).expect("so does another");
    let mut tried: Vec<String> = field.contenders.into_iter().map(|own| own.candidate.effect).collect();
    tried.sort();
    tried
}

#[test]
fn where_a_sensor_is_wanted_nothing_else_is_tried() {
    assert_eq!(tried(&ANYTHING), ["gain", "ratio"]);
    let sensor = Wanted {
        sensor: true,
        ..ANYTHING
    };
    assert_eq!(tried(&sensor), ["gain"]);
}

#[test]
fn where_nobody_gains_what_is_wanted_nobody_goes_on() {
    let more_than_all = Wanted { least: 1.1, ..ANYTHING };
    assert_eq!(tried(&more_than_all), Vec::<String>::new());
}

/// A wheel on a cam, seen to travel four times as far as the pad: it does where the ratio is 2.196, and comes no nearer
/// than twice as far between there and the hollow at -1.
fn on_a_cam(evidence: &Evidence, start: f64) -> State {
    let ratio = Given {
        name: "ratio".into(),
        value: start,
        range: Some((-1.9, 3.0)),
    };
    let setting = Setting {
        given: vec![ratio],
        ..setting()
    };
    let cam = Levers::of(|ratio| [ratio.powi(3) - 3.0 * ratio, 3.0 * ratio * ratio - 3.0]);
    State::base(Box::new(cam), &setting, evidence, &|_| ()).expect("a cam answers to a sweep")
}

fn four_times() -> Evidence {
    evidence(4.0, vec![(Role::Fit, sweep(), 60)])
}

/// The ratios of both axles.
fn ratios(state: &State) -> Vec<f64> {
    state.explanation.refit.values.as_slice().to_vec()
}

#[test]
fn an_effect_gains_nothing_by_leading_a_search_to_a_better_place() {
    let evidence = four_times();
    let [stuck, free] = [-1.2, 2.5].map(|start| on_a_cam(&evidence, start));
    let effect = contender("effect", 1, free.explanation.clone());
    assert!(stuck.lowered(&effect) > 1e3);
    let led = stuck.led_by(Some(&effect), &evidence);
    assert!(led.lowered(&effect) < 0.0, "that of its unknown is left to pay");
    let [ratio, other] = ratios(&led)[..] else {
        panic!("there are two axles")
    };
    assert!((ratio - 2.196).abs() < 0.01, "{ratio}");
    assert_eq!(ratio, other, "what is tied stays tied");
}

#[test]
fn a_model_is_not_led_to_where_it_is_no_better() {
    let evidence = four_times();
    let [stuck, free] = [-1.2, 2.5].map(|start| on_a_cam(&evidence, start));
    let mut nowhere = stuck.explanation.clone();
    nowhere.named[0].1 = f64::NAN;
    for end in [stuck.explanation, nowhere] {
        let led = free.led_by(Some(&contender("effect", 1, end)), &evidence);
        assert_eq!(ratios(&led), ratios(&free));
    }
    assert_eq!(ratios(&free.led_by(None, &evidence)), ratios(&free));
}

/// An effect that replaces a law takes its parameters away.
#[test]
fn what_a_contender_does_not_have_is_sought_from_where_it_was() {
    let evidence = four_times();
    let free = on_a_cam(&evidence, 2.5);
    let mut without = free.explanation.clone();
    without.named.clear();
    let known = free.known();
    let refit = free.unchanged(Some(&known)).refit_from(&without, &evidence, 1);
    let ratio = refit.expect("a cam answers to a sweep").values.as_slice()[0];
    assert!((ratio - ratios(&free)[0]).abs() < 1e-3, "{ratio}");
}
