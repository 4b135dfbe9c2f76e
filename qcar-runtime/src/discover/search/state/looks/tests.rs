//! Which runs a look is at, and what it forgives.

use nalgebra::Complex;

use super::{Evidence, Role, State, Stimulus, Wanted};
use crate::discover::search::state::made::{evidence, history, leaving, ride, state, sweep};

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
