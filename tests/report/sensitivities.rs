//! The report of sensitivities: whole in a browser, with the numbers of the JSON beside it.

use std::fs;

use serde_json::Value;

use super::browser::{browser_or_word, look, printed, printer_or_word};
use super::studied::Studied;
use super::{OTHER_PAGES, PAGES, check_page, figures, page, strings};

/// What of it is drawn.
const DRAWN: [&str; 4] = ["tornado", "matrix", "shares", "sobol"];

#[test]
fn sensitivities_are_whole_in_a_browser() {
    are_whole(PAGES);
}

#[test]
#[ignore = "a browser for each of more pages; .ci/run runs it"]
fn sensitivities_are_whole_in_a_browser_in_other_ways() {
    are_whole(OTHER_PAGES);
}

fn are_whole(pages: [(u64, &str); 2]) {
    let Some(browser) = browser_or_word() else { return };
    let studied = Studied::sensitivities();
    let page = page(&studied);
    let count = metrics(&studied).len();
    for (width, theme) in pages {
        let found = look(&browser, &page, width, theme);
        let place = format!("{width} px, {theme}: {found}");
        check_page(&found, (width, &place), &DRAWN);
        assert_eq!(found["sections"].as_array().unwrap().len(), 5, "{place}");
        assert_eq!(found["renamed"], Value::Array(Vec::new()), "{place}");
        for kind in ["tornado", "sobol"] {
            let drawn = figures(&found).iter().filter(|own| **own == kind).count();
            assert_eq!(drawn, count, "{kind} at {place}");
        }
        for table in ["Metrics", "Uncertainty of the metrics"] {
            assert!(strings(&found["tables"]).contains(&table), "{table} at {place}");
        }
    }
}

/// A drawing says to who cannot see it what it shows: names with their numbers, the largest first.
#[test]
fn a_tornado_says_its_numbers() {
    let Some(printer) = printer_or_word() else { return };
    let studied = Studied::sensitivities();
    // Paper has every detail open.
    let text = printed(&printer, &page(&studied), &["-layout"]);
    let metrics = metrics(&studied);
    let first = metrics[0]["elasticities"].as_object().unwrap();
    let (name, value) = first
        .iter()
        .map(|(name, value)| (name, value.as_f64().unwrap()))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        .unwrap();
    let row = text.lines().find(|line| {
        let mut words = line.split_whitespace();
        words.next() == Some(name.as_str()) && words.next() == Some(&format!("+{value:.2}"))
    });
    assert!(row.is_some(), "{name} +{value:.2} in\n{text}");
    for metric in &metrics {
        let own = metric["name"].as_str().unwrap();
        assert!(text.contains(own), "{own} in\n{text}");
    }
    for heading in ["Elasticities: ", "Sobol indices of ", "Values of each run: "] {
        assert!(text.contains(heading), "{heading} in\n{text}");
    }
}

fn metrics(of: &Studied) -> Vec<Value> {
    let text = fs::read_to_string(of.folder.join("sensitivity.json")).unwrap();
    let json: Value = serde_json::from_str(&text).unwrap();
    json["metrics"].as_array().unwrap().clone()
}
