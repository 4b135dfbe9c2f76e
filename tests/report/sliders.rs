//! The sliders of a study: the page computes what qcar computes.

use std::collections::BTreeMap;

use qcar::{catalogue, parameters};
use qcar_runtime::response::parameters::Values;
use qcar_runtime::response::ratio::ratio;
use qcar_runtime::response::signal::driver;
use serde_json::Value;

use super::browser::{browser_or_word, look, texts};
use super::{ONE_MISSING, page, strings};

/// The parameter that the probe moves to the middle of its slider.
const MOVED: &str = "k_wheel_z";

#[test]
fn a_moved_parameter_moves_the_response_as_qcar_does() {
    let Some(browser) = browser_or_word() else { return };
    let found = look(&browser, &page(&ONE_MISSING), 400, "dark");
    let tried = &found["tried"];
    assert_eq!(
        (&tried["blank"], &tried["overflow"]),
        (&Value::from(0), &Value::from(0)),
        "{tried}"
    );
    assert!(strings(&tried["labels"]).len() > 8, "{tried}");
    let channel = tried["channel"]
        .as_str()
        .unwrap()
        .replace(" → ", "_to_")
        .replace(' ', "_");
    let expected = |moved: bool| magnitude(&channel, &columns(&tried["before"])[0], moved);
    for (text, moved) in [("before", false), ("after", true), ("reset", false)] {
        let own = columns(&tried[text]);
        agree(own.last().unwrap(), &expected(moved), text);
        agree(&own[own.len() - 2], &expected(false), text);
    }
}

/// The response of a model that is not linear comes with no program.
#[test]
fn a_nonlinear_model_has_a_word_in_place_of_sliders() {
    let Some(browser) = browser_or_word() else { return };
    let linear = page(&ONE_MISSING);
    let nonlinear = linear.replace("const PROGRAM = ", "const PROGRAM = null;\nconst UNUSED = ");
    assert_ne!(linear, nonlinear);
    let words = |page: &str| strings(&texts(&browser, page)["ofRig"]).join(" ");
    assert!(words(&nonlinear).contains("There are no sliders here: this model is nonlinear"));
    assert!(!words(&linear).contains("no sliders"));
}

/// Before it is moved, a design is where the report has it; a slider moves it, and one button takes it back.
pub fn check_design(tried: &Value) {
    assert_eq!(
        (&tried["blank"], &tried["overflow"]),
        (&Value::from(0), &Value::from(0)),
        "{tried}"
    );
    let [before, after, reset] = ["before", "after", "reset"].map(|text| columns(&tried[text]));
    assert_eq!(before, reset);
    let [own, design] = [1, 2].map(|back| &before[before.len() - back]);
    agree(own, design, "design");
    assert_ne!(after.last(), before.last(), "{tried}");
}

/// The columns of a figure as a spreadsheet gets them: frequency, what was measured, as found, as tried.
fn columns(text: &Value) -> Vec<Vec<f64>> {
    let lines = text.as_str().unwrap().lines().skip(1);
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    (0..rows[0].len())
        .map(|at| rows.iter().map(|row| row[at]).collect())
        .collect()
}

/// The magnitude (dB) of a channel of the extended model with the values found, one of which may be in the middle of
/// its range by its logarithm.
fn magnitude(channel: &str, frequency: &[f64], moved: bool) -> Vec<f64> {
    let folder = ONE_MISSING.folder.join("discovery");
    let model = catalogue::load(folder.join("axle_c_with_suspended_mass.axle").to_str().unwrap()).unwrap();
    let about = model.about();
    let found = parameters::resolve(about, [folder.join("parameters.toml").as_path()], &[]).unwrap();
    let names = about.parameters.iter().map(|own| own.name.to_string());
    let mut given: BTreeMap<String, f64> = names.zip(found.as_slice().iter().copied()).collect();
    if moved {
        let own = about.parameters.iter().find(|own| own.name == MOVED).unwrap();
        let (low, high) = own.range.unwrap();
        given.insert(MOVED.into(), (low * high).sqrt());
    }
    let values = Values::resolve(about, &given, &BTreeMap::new()).unwrap();
    let own = about.channels.iter().find(|own| own.name == channel).unwrap();
    let excitation = driver(about, own).unwrap();
    let ratio = ratio(
        &*model,
        &values,
        excitation,
        &own.numerator,
        &own.denominator,
        frequency,
    )
    .unwrap();
    ratio.value.iter().map(|value| 20.0 * value.norm().log10()).collect()
}

/// A figure is saved with six digits, and so are the frequencies at which it is compared.
fn agree(found: &[f64], expected: &[f64], what: &str) {
    assert_eq!(found.len(), expected.len());
    for (own, other) in found.iter().zip(expected) {
        assert!(
            (own - other).abs() < 1e-4 * other.abs().max(1.0),
            "{what}: {own} dB is not {other} dB"
        );
    }
}
