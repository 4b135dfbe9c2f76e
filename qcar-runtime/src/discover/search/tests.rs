//! The way of a search, of a wheel that may move by another ratio of what the pad does.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::state::made::{Levers, evidence, setting, sweep};
use super::{Evidence, Judge, News, Path, Role, State, Verdict, discover};

const FROM_THE_START: &str = "fitting all of it from the start";

/// The wheel moves by 1.2 times what the pad does.
fn more_than_the_lever_says() -> Evidence {
    evidence(1.2, vec![(Role::Fit, sweep(), 60)])
}

/// What of the base model and of a path that took another ratio comes of `then`.
fn with_another_ratio<T>(then: impl Fn(&State, Path, &Judge, &Evidence) -> T) -> T {
    let evidence = more_than_the_lever_says();
    let base = State::base(Box::new(Levers::new()), &setting(), &evidence, &|_| ()).expect("a lever answers");
    let judge = Judge::new(&evidence, &base.explanation);
    let field = base.contenders(&judge.wanted_first(&base), &evidence, &|_| ());
    let field = field.expect("so does another");
    let of = field.contenders.iter().position(|own| own.candidate.effect == "ratio");
    let path = Path::begin(&base, &field, of.expect("it explains all"), &judge);
    then(&base, path, &judge, &evidence)
}

/// One effect closes what is gone between the base model and the better place.
#[test]
fn a_path_goes_on_from_the_start_where_that_ends_at_a_better_place() {
    with_another_ratio(|base, mut path, judge, evidence| {
        path.state.explanation = base.explanation.clone();
        path.findings[0].parameters.clear();
        (path.findings[0].evidence, path.findings[0].closed) = (0.0, 0.0);
        let path = path.afresh(base, judge, evidence, &|_| ());
        let [before, after] = [&base.explanation, &path.state.explanation];
        let [finding] = &path.findings[..] else {
            panic!("there is one effect")
        };
        let (name, ratio, _) = &finding.parameters[0];
        assert!(name == "ratio" && (ratio - 1.2).abs() < 0.01, "{name} {ratio}");
        assert!((finding.evidence - (before.refit.chi2 - after.refit.chi2)).abs() < 1e-9 * finding.evidence);
        assert!((finding.closed - judge.closed(before, after)).abs() < 1e-9);
        assert!(finding.closed > 0.99, "{}", finding.closed);
    });
}

#[test]
fn a_path_stays_where_the_start_ends_at_no_better_place() {
    with_another_ratio(|base, mut path, judge, evidence| {
        path.state.explanation.refit.chi2 *= 0.5;
        let before = path.state.explanation.refit.chi2;
        let path = path.afresh(base, judge, evidence, &|_| ());
        assert_eq!(path.state.explanation.refit.chi2, before);
    });
}

/// How often a search begins from the start again, and its answer.
fn searched(evidence: &Evidence) -> (usize, Verdict) {
    let times = AtomicUsize::new(0);
    let told = |news: News| {
        if matches!(news, News::Doing(FROM_THE_START)) {
            times.fetch_add(1, Ordering::Relaxed);
        }
    };
    let found = discover(Box::new(Levers::new()), &setting(), evidence, &told).expect("a lever answers");
    (times.into_inner(), found.verdict)
}

/// That another gain of the sensor is as good as another ratio does not matter here.
#[test]
fn only_what_is_not_enough_is_fitted_from_the_start_and_once() {
    let explained = more_than_the_lever_says();
    assert_eq!(searched(&explained), (0, Verdict::Class));
    let mut torn = explained;
    let values = torn.series.iter_mut().flat_map(|series| &mut series.value);
    values.step_by(2).for_each(|value| *value *= 1.2);
    assert_eq!(searched(&torn), (1, Verdict::Unknown));
}
