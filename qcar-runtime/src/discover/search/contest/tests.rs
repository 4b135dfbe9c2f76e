//! Who goes on, of runners with given scores.

use super::{Entrant, Finalist, Runner, STAGES, Stage, best, that_answer, told};
use crate::discover::explain::Explanandum;
use crate::discover::nuisance::Nuisance;
use crate::discover::predict::PredictError;
use crate::discover::search::state::made::{Lever, leaving, setting, two_sweeps};

/// No change at all, and an entrant with one unknown for each of these names.
fn with_entrants<R>(names: &[&str], ask: impl FnOnce(&[Entrant]) -> R) -> R {
    let (model, setting, nuisance) = (Lever::new(), setting(), Nuisance::of(&two_sweeps()));
    let entrant = |(unknowns, name): (usize, &str)| Entrant {
        explanandum: Explanandum {
            model: &model,
            added: &[],
            setting: &setting,
            known: None,
            nuisance: nuisance.clone(),
        },
        unknowns,
        name: name.into(),
    };
    let changes = names.iter().map(|&name| (1, name));
    let entrants: Vec<Entrant> = std::iter::once((0, "no change")).chain(changes).map(entrant).collect();
    ask(&entrants)
}

fn runner(entrant: usize, score: f64) -> Runner {
    Runner {
        entrant,
        values: Lever::new().values(),
        refit: None,
        score,
    }
}

/// The names of those that go on, where no change comes to 1000 and the best must gain the share `least_gain`.
fn kept(stage: &Stage, least_gain: f64, changes: &[(&str, f64)]) -> Vec<String> {
    let (names, scores): (Vec<&str>, Vec<f64>) = changes.iter().copied().unzip();
    let scores = std::iter::once(1000.0).chain(scores).enumerate();
    let field = scores.map(|(entrant, score)| runner(entrant, score)).collect();
    with_entrants(&names, |entrants| {
        let best = best(field, entrants, stage, least_gain).into_iter();
        best.map(|runner| entrants[runner.entrant].name.clone()).collect()
    })
}

#[test]
fn what_gains_less_than_is_asked_for_goes_no_further() {
    let sharp = STAGES.iter().find(|stage| !stage.tolerant).expect("a sharp look");
    assert_eq!(
        kept(sharp, 0.1, &[("much", 880.0), ("little", 920.0)]),
        ["much", "no change"]
    );
    assert_eq!(kept(sharp, 0.1, &[("little", 920.0)]), ["no change"]);
    assert_eq!(kept(sharp, 0.0, &[("little", 920.0)]), ["little", "no change"]);
}

/// Where a share of every value is forgiven, a part of what is gained does not show.
#[test]
fn a_quarter_of_the_gain_is_enough_while_large_features_alone_count() {
    let tolerant = STAGES.iter().find(|stage| stage.tolerant && stage.share.is_some());
    let tolerant = tolerant.expect("a tolerant look");
    let runners = [("quarter", 970.0), ("less", 980.0)];
    assert_eq!(kept(tolerant, 0.1, &runners), ["quarter", "no change"]);
}

#[test]
fn what_leaves_many_times_what_the_best_leaves_goes_no_further() {
    let sharp = STAGES.iter().find(|stage| !stage.tolerant).expect("a sharp look");
    let runners = [
        ("best", 10.0),
        ("near", 9.0 * sharp.times_best),
        ("far", 11.0 * sharp.times_best),
    ];
    assert_eq!(kept(sharp, 0.0, &runners), ["best", "near", "no change"]);
}

#[test]
fn a_first_look_drops_nobody_for_a_small_gain() {
    assert_eq!(kept(&STAGES[0], 0.1, &[("little", 990.0)]), ["little", "no change"]);
}

/// One form that comes in late too.
#[test]
fn forms_of_one_effect_take_the_room_of_one() {
    let last = STAGES.last().expect("a last look");
    let others: Vec<String> = (1..=last.kept).map(|k| format!("other {k}")).collect();
    let mut runners = vec![("many", 100.0), ("many", 110.0), ("many", 120.0), ("many", 290.0)];
    let scores = (0..).map(|k| 200.0 + 10.0 * f64::from(k));
    runners.extend(others.iter().map(String::as_str).zip(scores));
    let kept = kept(last, 0.0, &runners);
    let count = |start: &str| kept.iter().filter(|name| name.starts_with(start)).count();
    assert_eq!((count("many"), count("other")), (4, last.kept - 1), "{kept:?}");
}

#[test]
fn of_many_one_that_gives_no_number_drops_out_and_one_alone_says_why() {
    let answer = || Finalist {
        entrant: 0,
        explanation: leaving(1.0),
        score: 1.0,
    };
    let of = |alone: bool| that_answer(vec![Ok(answer()), Err(PredictError::NoNumber)], alone);
    assert_eq!(of(false).expect("one answers").len(), 1);
    assert!(matches!(of(true), Err(PredictError::NoNumber)));
}

/// An effect that has several forms or starts is named once.
#[test]
fn of_many_that_are_looked_into_a_few_are_named() {
    let names = ["first", "second", "first", "third", "fourth", "fifth"];
    let of = |field: &[usize]| {
        let field: Vec<Runner> = field.iter().map(|&entrant| runner(entrant, 0.0)).collect();
        with_entrants(&names, |entrants| told(entrants, &field))
    };
    assert_eq!(of(&[1]), "looking into first");
    assert_eq!(of(&[1, 3, 2]), "looking into first, second");
    assert_eq!(of(&[1, 3, 2, 4, 5, 6, 0]), "looking into first, second and 4 more");
}
