//! What is tried on a state, and what that is held against.

use super::made::{Levers, contender, evidence, setting, sweep};
use super::{Evidence, Given, Setting, State, Wanted};
use crate::campaign::Role;

const ANYTHING: Wanted = Wanted {
    least: 0.0,
    sensor: false,
};

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
