//! An answer is read whichever of its fields are there, kept as a line, and counted for what it is.

use qcar_blind::matrix::{Case, Kind, cases};
use qcar_blind::outcome::Outcome;
use qcar_blind::tables::tables;
use serde_json::{Value, json};

fn case(seed: u64, name: &str) -> Case {
    let case = cases(seed).into_iter().find(|case| case.name == name);
    case.expect("a case of the matrix")
}

/// The outcome, by way of its line.
fn outcome(case: &Case, answer: &Value) -> Outcome {
    let outcome = Outcome::new(case, answer, 3.0);
    let read = Outcome::parse(&outcome.line()).expect("a line");
    assert_eq!(read.line(), outcome.line());
    read
}

/// The result in the row of a table that begins with these words.
fn row(outcome: &Outcome, words: &str) -> String {
    let text = tables(std::slice::from_ref(outcome));
    let line = text.lines().find(|line| line.starts_with(&format!("| {words} |")));
    let line = line.unwrap_or_else(|| panic!("no row {words} in\n{text}"));
    line.split('|').nth(3).expect("a result").trim().to_owned()
}

#[test]
fn a_full_answer_is_read() {
    let case = case(1, "coulomb_friction@damper 1 seed 1");
    let answer = json!({
        "verdict": "found",
        "probability": 0.97,
        "findings": [{
            "effect": "coulomb_friction", "at": "damper", "form": "in_damper",
            "parameters": {"f_coulomb": 61.0, "k_presliding": 660e3},
            "stderr": {"f_coulomb": 1.0, "k_presliding": 20e3},
        }],
        "alike": [],
        "candidates": [{"effect": "free_play", "at": "damper", "form": null, "probability": 0.02, "explained": 0.4}],
        "explained": 0.99,
        "left": [{"channel": "body_z", "kind": "sweep", "before_percent": 4.0, "after_percent": 1.5}],
        "learned": {"at": "damper", "words": "stiff", "file": null, "explained": 0.9},
        "seconds": 12.0,
    });
    let outcome = outcome(&case, &answer);
    assert_eq!(outcome.probability, Some(0.97));
    assert_eq!(outcome.covered, (1, 2));
    assert!((outcome.error - 0.1).abs() < 1e-9 && (outcome.closed - 0.99).abs() < 1e-9);
    assert_eq!(outcome.candidates, ["free_play@damper:0.020:0.400"]);
    assert_eq!(outcome.left, ["body_z/sweep:1.50"]);
    assert_eq!(outcome.learned, Some(("damper".to_owned(), 0.9)));
    assert_eq!(row(&outcome, "separable single effects named and placed"), "1 (100 %)");
    assert_eq!(row(&outcome, "0.95 to 0.99"), "1 (100 %)");
}

/// An answer assumes the half length: what it scales is compared in the answer's terms, and it is not counted itself.
#[test]
fn a_pitch_angle_has_no_scale_of_its_own() {
    let case = case(71, "subframe_pitch@subframe 0 seed 71");
    let hidden = &case.order.effects[0];
    let assumed = 0.3;
    let ratio = assumed / hidden.get("half_length");
    let answer = |inertia: f64| {
        json!({
            "verdict": "found",
            "findings": [{
                "effect": "subframe_pitch", "at": "subframe", "form": null,
                "parameters": {"inertia": inertia, "half_length": assumed, "arm_offset": ratio * hidden.get("arm_offset")},
                "stderr": {"inertia": 0.01, "half_length": 0.0, "arm_offset": 0.001},
            }],
        })
    };
    let scaled = ratio.powi(2) * hidden.get("inertia");
    let right = outcome(&case, &answer(scaled));
    assert_eq!(right.covered, (2, 2));
    assert!(right.error < 1e-9, "{}", right.error);
    assert_eq!(outcome(&case, &answer(scaled + 0.03)).covered, (1, 2));
}

#[test]
fn a_second_name_beside_the_right_one_is_wrong() {
    let case = case(1, "coulomb_friction@damper 1 seed 1");
    let finding = |name: &str| json!({"name": name, "at": "damper"});
    let answer = json!({"verdict": "found", "effects": [finding("coulomb_friction"), finding("inerter")]});
    let outcome = outcome(&case, &answer);
    assert_eq!(row(&outcome, "separable single effects named and placed"), "0 (0 %)");
    assert_eq!(row(&outcome, "the same, given a wrong effect"), "1 (100 %)");
}

#[test]
fn a_class_counts_where_it_holds_the_truth() {
    let case = case(1, "coulomb_friction@damper 1 seed 1");
    let mut alike = vec![json!({"name": "free_play", "at": "damper", "one_of": true})];
    let without = outcome(&case, &json!({"verdict": "class", "effects": alike}));
    assert_eq!(row(&without, "the same, given a wrong effect"), "1 (100 %)");
    alike.push(json!({"name": "coulomb_friction", "at": "damper", "one_of": true}));
    let with = outcome(&case, &json!({"verdict": "class", "effects": alike}));
    assert_eq!(row(&with, "the same, answered by a class with it"), "1 (100 %)");
    let listed = json!({"verdict": "class", "findings": [], "alike": ["inerter@damper", "coulomb_friction@damper"]});
    assert_eq!(
        row(&outcome(&case, &listed), "the same, answered by a class with it"),
        "1 (100 %)"
    );
}

#[test]
fn a_law_of_another_form_has_a_family() {
    let case = case(3, "table_damper@damper 0 seed 3");
    let finding = |name: &str| json!({"effect": name, "at": "damper"});
    let two = [finding("asymmetric_damper"), finding("digressive_damper")];
    let family = outcome(&case, &json!({"verdict": "found", "findings": two}));
    assert_eq!(row(&family, "laws of another form: named by their family"), "1 (100 %)");
    let other = outcome(&case, &json!({"verdict": "found", "findings": [finding("free_play")]}));
    assert_eq!(row(&other, "laws of another form: wrong"), "1 (100 %)");
    let unknown = outcome(
        &case,
        &json!({"verdict": "unknown", "places": [{"at": "damper"}, {"at": "spring"}]}),
    );
    assert_eq!(
        row(&unknown, "laws of another form: unknown at their place"),
        "1 (100 %)"
    );
}

#[test]
fn a_search_that_fails_is_counted() {
    let case = cases(3)
        .into_iter()
        .find(|case| case.kind == Kind::FastClean)
        .expect("a case");
    let failed = Outcome::failed(&case, 0.0);
    let read = Outcome::parse(&failed.line()).expect("a line");
    assert_eq!(row(&read, "searches that failed"), "1 (100 %)");
}
