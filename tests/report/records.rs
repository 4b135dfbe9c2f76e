//! Records over time, beside what the models make of them.

use std::fs;
use std::path::Path;

use super::browser::{browser_or_word, look};
use super::studied::Studied;
use super::{check, page, strings};

const DAMPER: &str = "models/campaigns/mr_damper";

#[test]
fn records_are_drawn_beside_what_the_models_make_of_them() {
    let from = [DAMPER, file!()].map(Path::new);
    are_drawn(&Studied::made("short_records", write_short, &from), SHORT.len());
}

#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn whole_records_are_drawn_beside_what_the_models_make_of_them() {
    are_drawn(&Studied::new("mr_damper"), 5);
}

/// The runs that are searched in a few seconds, each of five seconds.
const SHORT: [&str; 3] = ["crank_3.csv.gz", "crank_5.csv.gz", "crank_7.csv.gz"];

fn write_short(folder: &Path) {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join(DAMPER);
    for run in SHORT {
        fs::copy(shipped.join(run), folder.join(run)).unwrap();
    }
    let text = fs::read_to_string(shipped.join("campaign.toml")).unwrap();
    let (head, runs) = text.split_once("[[run]]").unwrap();
    let runs = runs
        .split("[[run]]")
        .filter(|own| SHORT.iter().any(|run| own.contains(run)));
    let runs: String = runs
        .map(|own| format!("[[run]]\n{}\nfrom = 0\nto = 5\n\n", own.trim()))
        .collect();
    fs::write(folder.join("campaign.toml"), head.to_owned() + &runs).unwrap();
}

/// Records are replayed over time, and the force of a damper over what moves it.
fn are_drawn(study: &Studied, runs: usize) {
    let Some(browser) = browser_or_word() else { return };
    let found = look(&browser, &page(study), 1280, "light");
    let wanted = [
        "record",
        "record-velocity",
        "record-displacement",
        "gap-before",
        "gap-after",
    ];
    check(&found, (1280, &found.to_string()), &wanted);
    assert!(strings(&found["tables"]).contains(&"NRMS of each run"), "{found}");
    let lead = found["paragraphs"][0].as_str().unwrap();
    assert!(
        lead.starts_with("Partly explained by ") && lead.ends_with("Large residuals remain."),
        "{lead}"
    );
    let text = found["units"]["mm"].as_str().unwrap();
    assert!(text.contains("sampled at 100\u{202f}Hz"), "{text}");
    let printed: Vec<&str> = strings(&found["on_paper"]);
    assert_eq!(
        printed.iter().filter(|figure| **figure == "record").count(),
        runs,
        "{printed:?}"
    );
}
