//! The report as a reader meets it: in a browser, wide and narrow, light and dark, without a network.

#[path = "support/swept.rs"]
mod swept;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use swept::two_sensors;

const PROBE: &str = include_str!("browser/probe.js");

/// A page around the report, since a window cannot be as narrow as a telephone.
const FRAME: &str = "<!doctype html><script>addEventListener('message', (event) => \
                     document.documentElement.setAttribute('data-found', event.data));</script>";

/// What the browser is called.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// A campaign with nothing missing, and one that hides an effect.
const CAMPAIGNS: [(&str, &str); 2] = [("axle_a_rig", "none"), ("axle_c_study", "found")];

#[test]
fn a_study_writes_all_that_it_promises() {
    let folder = tempfile::tempdir().unwrap();
    let (campaign, verdict) = CAMPAIGNS[0];
    let said = study(campaign, folder.path());
    let result: Value = serde_json::from_str(&fs::read_to_string(folder.path().join("study.json")).unwrap()).unwrap();
    assert_eq!(result["discover"]["verdict"], verdict, "{said}");
    for file in [
        "report.html",
        "fit/parameters.toml",
        "fit/transmissibility.csv",
        "kc/gradients.json",
        "cleat/errors.csv",
        "cleat/v30_h30.csv",
        "discovery/discovery.json",
    ] {
        assert!(folder.path().join(file).is_file(), "{file}");
    }
    let report = folder.path().join("report.html").display().to_string();
    assert!(said.contains(&report), "{said}");
}

/// The pages that are looked at: width in pixels, and theme.
const PAGES: [(u64, &str); 4] = [(1280, "light"), (1280, "dark"), (400, "light"), (400, "dark")];

#[test]
fn the_report_is_whole_in_a_browser() {
    let Some(browser) = browser_or_word() else { return };
    for (campaign, verdict) in CAMPAIGNS {
        let folder = tempfile::tempdir().unwrap();
        let said = study(campaign, folder.path());
        for (width, theme) in PAGES {
            let found = look(&browser, folder.path(), width, theme);
            let place = format!("{width} px, {theme}: {found}");
            check(&found, (width, &place), &STUDY);
            assert_eq!(found["sections"].as_array().unwrap().len(), 10, "{place}");
            let map = found["keyboard"]["map"].as_str().unwrap();
            assert!(map.contains("times the uncertainty"), "{place}");
            assert_eq!(verdict == "found", figures(&found).contains(&"gap-after"), "{said}");
        }
    }
}

/// What is after is with the best of several that the data cannot tell apart, and each of them is one of these.
#[test]
fn a_class_is_told_as_one_of_several() {
    let Some(browser) = browser_or_word() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (campaign, out) = (folder.path().join("campaign"), folder.path().join("out"));
    fs::create_dir(&campaign).unwrap();
    two_sensors(&campaign);
    let said = qcar(&["study", campaign.to_str().unwrap()], &out);
    let result: Value = serde_json::from_str(&fs::read_to_string(out.join("study.json")).unwrap()).unwrap();
    let [best, other] = [0, 1].map(|place| {
        let own = &result["discover"]["effects"][place];
        format!("sensor gain at {}", own["at"].as_str().unwrap())
    });
    for (width, theme) in PAGES {
        let found = look(&browser, &out, width, theme);
        let place = format!("{width} px, {theme}: {found} {said}");
        check(
            &found,
            (width, &place),
            &["rig-magnitude", "modes-before", "gap-before", "gap-after"],
        );
        let has = |list: &str, text: String| found[list].as_array().unwrap().contains(&Value::String(text));
        assert!(
            has(
                "paragraphs",
                format!("These data cannot tell apart {best} and {other}.")
            ),
            "{place}"
        );
        assert!(
            has("headings", format!("Either {best}")) && has("headings", format!("Or {other}")),
            "{place}"
        );
        assert!(has("captions", format!("The model with {best}")), "{place}");
        let consequence = found["paragraphs"][1].as_str().unwrap();
        assert!(
            consequence.contains(&format!("With {other} instead the fitted runs are explained as well")),
            "{place}"
        );
    }
}

/// What a study and every comparison of a rolling model draw.
const STUDY: [&str; 11] = [
    "axle-z",
    "loop-bounce",
    "axle-x",
    "rig-magnitude",
    "rig-phase",
    "rig-coherence",
    "modes-before",
    "trace",
    "histogram-peak-body_z",
    "variant",
    "gap-before",
];
const COMPARISON: [&str; 7] = [
    "axle-z",
    "axle-x",
    "modes",
    "ratio-magnitude",
    "ratio-phase",
    "ratio-change",
    "passage",
];

/// Two models, two parameter sets beside a campaign, and two campaigns; and how many sections each has.
const COMPARED: [(&str, usize); 3] = [
    ("axle_c axle_c_rigid_tm --params models/campaigns/axle_c_study", 6),
    (
        "models/campaigns/axle_a_rig/campaign.toml models/campaigns/axle_a_rig/truth.toml --campaign models/campaigns/axle_a_rig",
        6,
    ),
    ("models/campaigns/axle_a_rig models/campaigns/axle_c_study", 7),
];

#[test]
fn a_comparison_is_whole_in_a_browser() {
    let Some(browser) = browser_or_word() else { return };
    for (subject, sections) in COMPARED {
        let folder = tempfile::tempdir().unwrap();
        let arguments: Vec<&str> = std::iter::once("compare").chain(subject.split_whitespace()).collect();
        qcar(&arguments, folder.path());
        for (width, theme) in PAGES {
            let found = look(&browser, folder.path(), width, theme);
            let place = format!("{subject}, {width} px, {theme}: {found}");
            check(&found, (width, &place), &COMPARISON);
            assert_eq!(found["sections"].as_array().unwrap().len(), sections, "{place}");
        }
    }
}

fn check(found: &Value, (width, place): (u64, &str), wanted: &[&str]) {
    for list in ["errors", "violations", "blank", "requests"] {
        assert_eq!(found[list], Value::Array(Vec::new()), "{list} at {place}");
    }
    assert_eq!(found["width"], width, "{place}");
    assert_eq!(found["overflow"], 0, "{place}");
    assert_eq!(found["unlabelled"], 0, "{place}");
    assert_eq!(found["bad_numbers"], 0, "{place}");
    // A narrow page lets the reader push a table aside; a wide one shows all of it.
    assert!(width < 1000 || found["cut"] == Value::Array(Vec::new()), "{place}");
    for figure in wanted {
        assert!(figures(found).contains(figure), "no {figure} at {place}");
    }
    assert!(found["keyboard"]["plot"].as_u64().unwrap() > 2, "{place}");
    assert_ne!(found["themes"][0], found["themes"][1], "{place}");
}

fn figures(found: &Value) -> Vec<&str> {
    found["figures"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_str)
        .collect()
}

fn study(campaign: &str, out: &Path) -> String {
    qcar(&["study", &format!("models/campaigns/{campaign}")], out)
}

/// Runs `qcar`, whose files go into a folder.
fn qcar(arguments: &[&str], out: &Path) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(arguments)
        .args([Path::new("--out"), out])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The browser; without one, a word past the capture of the test's output, so that nobody takes this for a check.
fn browser_or_word() -> Option<PathBuf> {
    let found = browser();
    if found.is_none() {
        let mut out = std::io::stderr();
        let word = "not checked: reports in a browser, since Chromium is absent (apt-get install chromium)";
        writeln!(out, "{word}").unwrap();
    }
    found
}

fn browser() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    let candidates = BROWSERS
        .iter()
        .flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    candidates.into_iter().find(|file| file.is_file())
}

/// Opens the report with the probe before its scripts, and gives what that has found.
fn look(browser: &Path, folder: &Path, width: u64, theme: &str) -> Value {
    let report = fs::read_to_string(folder.join("report.html")).unwrap();
    let opened = report
        .replacen(
            "<html lang=\"en\">",
            &format!("<html lang=\"en\" data-theme=\"{theme}\">"),
            1,
        )
        .replacen("<style>", &format!("<script>{PROBE}</script><style>"), 1);
    fs::write(folder.join("probed.html"), opened).unwrap();
    let page = folder.join("frame.html");
    let frame =
        format!("{FRAME}<iframe src=\"probed.html\" width=\"{width}\" height=\"900\" frameborder=\"0\"></iframe>");
    fs::write(&page, frame).unwrap();
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
            "--hide-scrollbars",
        ])
        .args([
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
        ])
        .args([
            "--host-resolver-rules=MAP * ~NOTFOUND",
            "--virtual-time-budget=10000",
            "--dump-dom",
        ])
        .arg("--window-size=1400,1000")
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout);
    let found = dom
        .split("data-found=\"")
        .nth(1)
        .and_then(|rest| rest.split('"').next());
    let found = found.unwrap_or_else(|| panic!("the probe said nothing: {}", String::from_utf8_lossy(&output.stderr)));
    let json = found
        .replace("&quot;", "\"")
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&amp;", "&");
    serde_json::from_str(&json).unwrap()
}
