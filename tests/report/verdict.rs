//! The verdict says what is true of its study, also where that is less than the word `found` promises.

use std::path::Path;

use serde_json::{Value, json};

use super::browser::{browser_or_word, look, texts};
use super::{NOTHING_MISSING, ONE_MISSING, page};

#[test]
fn beside_nothing_missing_stands_the_worst_sensor() {
    let Some(browser) = browser_or_word() else { return };
    let found = look(&browser, &page(&NOTHING_MISSING), 1280, "light");
    let said = paragraphs(&found);
    let tables = found["tables"].to_string();
    assert!(tables.contains("Usual size over the smallest certain size"), "{tables}");
    assert!(said[0].starts_with("No effect found"), "{said:?}");
    assert!(said[1].contains("Largest residual: body x in cleat runs, "), "{said:?}");
    assert!(
        said[1].contains(" % of the signal, 0.") || said[1].contains(" % of the signal, 1."),
        "{said:?}"
    );
}

#[test]
fn where_much_is_left_it_is_partly_explained() {
    let Some(browser) = browser_or_word() else { return };
    let whole = verdict(&browser, &page(&ONE_MISSING));
    assert_eq!(whole[0], "Missing: suspended mass at body.");
    let partly = verdict(
        &browser,
        &with(|data| {
            data["discover"]["partly_explained"] = json!(true);
            data["discover"]["left"][0]["after_percent"] = json!(18.0);
            data["discover"]["by_channel"]["wheel_z"]["after"] = json!(7.0);
        }),
    );
    assert_eq!(
        partly[0],
        "Partly explained by suspended mass at body. Large residuals remain."
    );
    assert!(
        partly[1].contains("Largest residual: wheel z in sweeps, 18 % of the signal, 7.00"),
        "{partly:?}"
    );
}

#[test]
fn a_rival_that_is_level_or_ahead_is_not_told_apart() {
    let Some(browser) = browser_or_word() else { return };
    for (behind, odds) in [(0.0, "as probable"), (-2.0, "7.4 times more probable")] {
        let said = verdict(
            &browser,
            &with(|data| {
                let rival = json!({ "effect": "subframe", "at": "body", "behind": behind });
                data["discover"]["effects"][0]["rivals"][0] = rival;
            }),
        );
        let lead = "Missing: suspended mass at body, not distinguishable from subframe at body.";
        assert_eq!(said[0], lead);
        assert!(said[1].contains(&format!("subframe at body, is {odds}")), "{said:?}");
    }
}

#[test]
fn a_learned_law_is_told_without_a_cause() {
    let Some(browser) = browser_or_word() else { return };
    let said = verdict(
        &browser,
        &with(|data| {
            data["summary"]["verdict"] = json!("unknown");
            data["discover"]["verdict"] = json!("unknown");
            data["discover"]["effects"] = json!([]);
            data["discover"]["learned"] = json!({
                "at": "damper",
                "explained": 0.93,
                "gap": { "fit": { "before": 59.0, "after": 4.0 }, "held_out": { "before": 36.0, "after": 3.0 } },
                "laws": [{
                    "name": "damping_law", "at": "damper", "words": "it falls with the speed",
                    "parameters": { "d_1": 0.4 }, "stderr": { "d_1": 0.1 }, "units": { "d_1": "1" }, "effect_file": null,
                }],
                "model_file": null,
            });
        }),
    );
    let law =
        "Learned from the data, without a physical cause: damping law at damper, which would explain 93.0 % of it.";
    assert!(said[1].contains(law), "{said:?}");
}

#[test]
fn a_fit_that_falls_is_explained() {
    let Some(browser) = browser_or_word() else { return };
    let whole = verdict(&browser, &page(&ONE_MISSING));
    assert!(!whole.concat().contains("The fit percentage falls"), "{whole:?}");
    let said = verdict(
        &browser,
        &with(|data| {
            for ratio in data["rig"].as_array_mut().unwrap() {
                ratio["quality_after"]["fit_magnitude"] = json!(61.25);
            }
        }),
    );
    let falls = "The fit percentage falls: magnitude from 85.3 to 61.3 % (fit runs), magnitude from 85.3 to 61.3 % (held out runs).";
    assert!(said[2].starts_with(falls), "{said:?}");
}

/// The verdict's paragraphs.
fn verdict(browser: &Path, page: &str) -> Vec<String> {
    paragraphs(&texts(browser, page))
}

fn paragraphs(found: &Value) -> Vec<String> {
    let paragraphs = found["paragraphs"].as_array().unwrap();
    paragraphs.iter().map(|own| own.as_str().unwrap().to_owned()).collect()
}

/// The report of a study whose numbers have been changed.
fn with(change: impl Fn(&mut Value)) -> String {
    const OPEN: &str = "<script type=\"application/json\" id=\"data\">";
    let page = page(&ONE_MISSING);
    let (head, rest) = page.split_once(OPEN).unwrap();
    let (data, tail) = rest.split_once("</script>").unwrap();
    let mut data: Value = serde_json::from_str(data).unwrap();
    change(&mut data);
    let data = data.to_string().replace('<', "\\u003c");
    format!("{head}{OPEN}{data}</script>{tail}")
}
