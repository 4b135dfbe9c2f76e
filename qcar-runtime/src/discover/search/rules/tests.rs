//! What earns a name, of explanations with given gaps.

use super::super::state::made::{RESIDUALS, contender, leaving, state, two_sweeps, with_chi2};
use super::{Contender, Explanation, Field, Finding, Judge, Path};
use crate::discover::nuisance::SENSOR;

fn finding(effect: &str) -> Finding {
    Finding {
        effect: effect.into(),
        at: "wheel".into(),
        form: None,
        parameters: Vec::new(),
        evidence: 0.0,
        closed: 0.0,
        rivals: Vec::new(),
    }
}

/// With so many effects that leave this.
fn path(explanation: Explanation, effects: usize) -> Path {
    Path {
        state: state(explanation),
        findings: vec![finding("effect"); effects],
        class: Vec::new(),
    }
}

/// The same with sensors whose gains are wrong by so many times what is usual.
fn strained(mut explanation: Explanation, times: f64) -> Explanation {
    let refit = &mut explanation.refit;
    for gain in (0..refit.nuisance.of_calibration()).step_by(SENSOR.len()) {
        refit.coefficients[gain] = times * SENSOR[0].sigma;
    }
    explanation
}

fn names<'c>(contenders: impl Iterator<Item = &'c Contender>) -> Vec<&'c str> {
    contenders.map(|own| own.candidate.effect.as_str()).collect()
}

/// An unknown without any use lowers the sum of squares by a little; one that is worth its penalty makes another answer.
#[test]
fn what_contains_the_best_and_explains_no_more_is_no_other_answer() {
    let (evidence, before) = (two_sweeps(), leaving(10.0));
    let judge = Judge::new(&evidence, &before);
    let noise = RESIDUALS as f64;
    let contenders = [
        contender("best", 1, with_chi2(noise)),
        contender("as simple", 1, with_chi2(noise + 1.0)),
        contender("contains it", 2, with_chi2(noise - 1.0)),
        contender("explains more", 2, with_chi2(noise - 20.0)),
        contender("far behind", 1, with_chi2(noise + 30.0)),
    ];
    assert_eq!(
        names(judge.alike(&contenders, 0)),
        ["best", "as simple", "explains more"]
    );
}

/// Those of a class are no rivals of each other.
#[test]
fn the_next_best_explanations_are_those_beyond_a_class() {
    let (evidence, before) = (two_sweeps(), leaving(10.0));
    let judge = Judge::new(&evidence, &before);
    let contenders = [("best", 1.0), ("alike", 1.1), ("next", 3.0)]
        .map(|(name, gap)| contender(name, 1, leaving(gap)))
        .into();
    let field = Field {
        contenders,
        dropped: Vec::new(),
    };
    let alike: Vec<&Contender> = field.contenders[..2].iter().collect();
    for member in &alike {
        let rivals = judge.finding(&state(leaving(10.0)), member, &alike, &field).rivals;
        assert_eq!(
            rivals.iter().map(|own| own.effect.as_str()).collect::<Vec<_>>(),
            ["next"]
        );
    }
}

/// What was found before a class is part of the answer, and no member of it.
#[test]
fn members_of_a_class_come_after_what_was_found_before_it() {
    let of = |class: &[&str]| {
        let path = Path {
            findings: vec![finding("first"), finding("best")],
            class: class.iter().copied().map(finding).collect(),
            ..path(leaving(1.0), 0)
        };
        let (findings, alike) = path.named();
        (
            findings
                .into_iter()
                .map(|own| own.effect)
                .collect::<Vec<_>>()
                .join(", "),
            alike,
        )
    };
    assert_eq!(of(&["best", "alike"]), ("first, best, alike".into(), 2));
    assert_eq!(of(&["best"]), ("first, best".into(), 0));
}

/// What leaves something unexplained cannot judge differences below a twentieth of that.
#[test]
fn of_those_that_explain_alike_the_simplest_comes_first() {
    let (evidence, before) = (two_sweeps(), leaving(100.0));
    let judge = Judge::new(&evidence, &before);
    let (chi2, vague) = (RESIDUALS as f64 + 10e3, 500.0);
    let order = |behind: f64| {
        let explaining = |name, unknowns, score| {
            let mut own = contender(name, unknowns, with_chi2(chi2));
            own.score = score;
            own
        };
        let mut contenders = [
            explaining("best", 3, chi2),
            explaining("next", 2, chi2 + 1.0),
            explaining("simple", 1, chi2 + behind),
        ];
        judge.simplest_first(&mut contenders);
        names(contenders.iter()).join(", ")
    };
    assert_eq!(order(vague - 1.0), "simple, best, next");
    assert_eq!(order(vague + 1.0), "next, best, simple");
}

/// Beside effects that explain enough, another must close as much as a first one, be determined, leave little of a gap that
/// was not wide, and be more than chance.
#[test]
fn a_further_effect_must_earn_its_place() {
    let (evidence, before) = (two_sweeps(), leaving(4.0));
    let judge = Judge::new(&evidence, &before);
    let adds = |present: f64, with: &Contender| judge.adds_much(&state(leaving(present)), with, 2);
    assert!(adds(1.4, &contender("all", 1, leaving(1.0))));
    let determined = |error: f64| {
        let mut own = contender("all", 1, leaving(1.0));
        own.parameters = vec![("own".into(), 1.0, error)];
        own
    };
    assert!(adds(1.4, &determined(0.1)) && !adds(1.4, &determined(f64::NAN)));
    assert!(!adds(1.4, &contender("half", 1, leaving(1.19))), "it closes too little");
    assert!(!adds(3.0, &contender("most", 1, leaving(1.25))), "it leaves too much");
    assert!(!adds(1.4, &contender("complex", 200, leaving(1.0))), "that is chance");
}

/// What the errors of sensors and sides let an effect gain where nothing is missing is a few percent.
#[test]
fn where_calibrations_alone_are_strained_a_further_effect_gains_more_than_by_chance() {
    let (evidence, before) = (two_sweeps(), leaving(20.0));
    let judge = Judge::new(&evidence, &before);
    let present = state(strained(leaving(1.0), 4.0));
    let adds = |left: f64| judge.adds_much(&present, &contender("gain", 1, leaving(left)), 2);
    let by_chance = contender("gain", 1, leaving(0.96));
    assert!(judge.is_significant(&present, &by_chance) && !adds(0.96));
    assert!(adds(0.9));
}

/// Several effects bend to much that they are not the cause of.
#[test]
fn one_effect_must_leave_little_or_close_next_to_all_and_several_both() {
    let evidence = two_sweeps();
    let enough = |before: f64, gap: f64, effects: usize| {
        Judge::new(&evidence, &leaving(before)).is_enough(&path(leaving(gap), effects))
    };
    assert!(enough(20.0, 1.1, 1) && enough(20.0, 1.1, 2));
    // Next to all of a wide gap is closed, and not of a narrow one.
    assert!(enough(20.0, 1.4, 1) && enough(20.0, 1.4, 2));
    assert!(enough(5.0, 1.4, 1) && !enough(5.0, 1.4, 2));
    // It leaves more, but closes next to all.
    assert!(enough(20.0, 3.0, 1) && !enough(20.0, 3.0, 2));
    assert!(!enough(20.0, 5.0, 1));
    assert!(!enough(20.0, 1.1, 0), "nothing explains nothing");
}

#[test]
fn beside_several_that_leave_little_nothing_is_looked_for_but_a_sensor() {
    let evidence = two_sweeps();
    let before = leaving(20.0);
    let judge = Judge::new(&evidence, &before);
    let more = |after: Explanation, effects: usize| judge.wants_more(&path(after, effects));
    assert!(more(leaving(1.4), 1) && !more(leaving(1.4), 2));
    assert!(more(leaving(3.0), 2), "that is not enough");
    assert!(!more(leaving(1.1), 1) && more(strained(leaving(1.1), 4.0), 2));
}

/// One that leaves little of little has closed too little of it.
#[test]
fn what_is_enough_has_closed_most_of_the_gap() {
    let (evidence, before) = (two_sweeps(), leaving(1.6));
    let judge = Judge::new(&evidence, &before);
    assert!(judge.is_enough(&path(leaving(1.1), 1)));
    assert!(!judge.is_enough(&path(leaving(1.4), 1)));
}

/// Where no gap shows in the runs that judge, it is closed if what was strained is no more, or if the fit gains by it.
#[test]
fn a_gap_that_does_not_show_is_closed_where_the_strain_is_gone_or_the_fit_gains() {
    let (evidence, plain) = (two_sweeps(), leaving(1.0));
    let judge = Judge::new(&evidence, &plain);
    let closed = |before: &Explanation, after: &Explanation| judge.closed(before, after);
    let before = strained(leaving(1.0), 4.0);
    assert_eq!(closed(&before, &leaving(1.0)), 1.0);
    assert_eq!(closed(&before, &before), 0.0);
    assert_eq!(closed(&plain, &leaving(0.98)), 0.0);
    assert_eq!(closed(&plain, &leaving(0.9)), 1.0);
    let mut local = leaving(0.9);
    local.gap.residuals[1] = vec![3.0; RESIDUALS];
    assert_eq!(closed(&plain, &local), 0.0, "it leaves a gap elsewhere");
}

#[test]
fn a_sensor_is_wanted_where_the_rest_is_explained_and_calibrations_are_strained() {
    let evidence = two_sweeps();
    let sensor = |before: f64, after: f64| {
        let (before, after) = (leaving(before), strained(leaving(after), 4.0));
        let judge = Judge::new(&evidence, &before);
        judge.wanted_beside(&path(after, 1), 2).sensor
    };
    assert!(sensor(20.0, 1.0));
    assert!(!sensor(20.0, 1.4), "a gap is left");
    assert!(!sensor(1.25, 1.19), "little of little is explained");
}

/// Where there is a gap anything may be a step; beside effects that explain enough, only what closes as much again.
#[test]
fn what_is_looked_for_must_gain_what_would_earn_a_name() {
    let (evidence, before) = (two_sweeps(), leaving(20.0));
    let judge = Judge::new(&evidence, &before);
    let first = |gap: f64| judge.wanted_first(&state(leaving(gap))).least;
    assert_eq!((first(1.0), first(2.0)), (0.1, 0.0));
    // 99 and 75 % of the sum of squares are more than noise; of two effects each must take a half of what all must close.
    let beside = |gap: f64| judge.wanted_beside(&path(leaving(gap), 1), 2).least;
    assert!((beside(10.0) - 0.99 * 0.6 / 2.0).abs() < 1e-12);
    assert!((beside(2.0) - 0.75 * 0.6).abs() < 1e-12);
}

/// What is left in the end must do much worse without an effect, and leave more than a little.
#[test]
fn an_effect_is_missed_where_the_others_do_much_worse() {
    let (evidence, before) = (two_sweeps(), leaving(20.0));
    let judge = Judge::new(&evidence, &before);
    let missed = |with: f64, without: f64| judge.is_missed(&state(leaving(with)), &state(leaving(without)));
    assert!(missed(1.0, 1.6));
    assert!(!missed(1.0, 1.4), "that is little");
    assert!(!missed(1.59, 1.6), "that is no worse");
}

/// Of two effects that may be taken each must close its half of what all must, and be more than chance.
#[test]
fn a_step_takes_its_share_of_what_is_left() {
    let (evidence, before) = (two_sweeps(), leaving(20.0));
    let judge = Judge::new(&evidence, &before);
    let is_step = |left: f64, effects: usize| {
        let chi2 = RESIDUALS as f64 * (1.0 + 99.0 * left);
        judge.is_step(&state(leaving(10.0)), &contender("step", 1, with_chi2(chi2)), effects)
    };
    assert!(is_step(0.69, 2) && !is_step(0.71, 2));
    assert!(is_step(0.39, 1) && !is_step(0.41, 1));
}

/// A search goes on from what does half as much as the best.
#[test]
fn a_search_may_begin_with_what_comes_close_to_the_best() {
    let (evidence, before) = (two_sweeps(), leaving(10.0));
    let judge = Judge::new(&evidence, &before);
    let best = contender("best", 1, with_chi2(20e3));
    let close = |chi2: f64| judge.comes_close(&state(leaving(10.0)), &contender("other", 1, with_chi2(chi2)), &best);
    assert!(close(59e3) && !close(61e3));
}
