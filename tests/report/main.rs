//! The report as a reader meets it: in a browser, wide and narrow, light and dark, without a network.

#[path = "../support/studied.rs"]
mod studied;
#[path = "../support/swept.rs"]
mod swept;

// Chromium.
mod browser;
// The report on A4.
mod paper;
// Records over time.
mod records;
// Elasticities, their uncertainty and Sobol indices.
mod sensitivities;
// Responses that the page computes.
mod sliders;
// The measured car beside today's axle and the design.
mod targets;
// What its first sentences say.
mod verdict;

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use browser::{browser_or_word, look};
use serde_json::Value;
use studied::Studied;
use swept::two_sensors;

static NOTHING_MISSING: LazyLock<Studied> = LazyLock::new(|| Studied::new("axle_a_rig"));
static ONE_MISSING: LazyLock<Studied> = LazyLock::new(|| Studied::new("axle_c_study"));

fn page(of: &Studied) -> String {
    page_in(&of.folder)
}

fn page_in(folder: &Path) -> String {
    fs::read_to_string(folder.join("report.html")).unwrap()
}

#[test]
fn a_study_writes_all_that_it_promises() {
    let (folder, said) = (&NOTHING_MISSING.folder, &NOTHING_MISSING.said);
    let result: Value = serde_json::from_str(&fs::read_to_string(folder.join("study.json")).unwrap()).unwrap();
    assert_eq!(result["discover"]["verdict"], "none", "{said}");
    for file in [
        "report.html",
        "results.xlsx",
        "fit/parameters.toml",
        "fit/transmissibility.csv",
        "kc/gradients.json",
        "cleat/errors.csv",
        "cleat/v30_h30.csv",
        "discovery/discovery.json",
    ] {
        assert!(folder.join(file).is_file(), "{file}");
    }
    let report = folder.join("report.html").display().to_string();
    assert!(said.contains(&report), "{said}");
}

/// Width in pixels, and theme.
type Page = (u64, &'static str);

/// The pages that are looked at.
const PAGES: [Page; 2] = [(1280, "light"), (400, "dark")];
/// The other pages, in tests of their own, since each takes seconds.
const OTHER_PAGES: [Page; 2] = [(1280, "dark"), (400, "light")];

#[test]
fn the_report_is_whole_in_a_browser() {
    report_is_whole([&PAGES[..1], &PAGES]);
}

#[test]
#[ignore = "a browser for each of more pages; .ci/run runs it"]
fn the_report_is_whole_in_a_browser_in_other_ways() {
    report_is_whole([&others(&PAGES[..1]), &OTHER_PAGES]);
}

/// All pages but these.
fn others(pages: &[Page]) -> Vec<Page> {
    let all = PAGES.into_iter().chain(OTHER_PAGES);
    all.filter(|page| !pages.contains(page)).collect()
}

/// The pages of the study without a finding, and of that with one.
fn report_is_whole(pages: [&[Page]; 2]) {
    let Some(browser) = browser_or_word() else { return };
    for ((study, changed), pages) in [(&NOTHING_MISSING, false), (&ONE_MISSING, true)].into_iter().zip(pages) {
        let page = page(study);
        for &(width, theme) in pages {
            let found = look(&browser, &page, width, theme);
            let place = format!("{width} px, {theme}: {found}");
            check(&found, (width, &place), &STUDY);
            assert_eq!(found["sections"].as_array().unwrap().len(), 10, "{place}");
            let [before, narrower, after] = [0, 1, 2].map(|at| found["resized"][at].as_f64().unwrap());
            assert!(narrower < before && after == before, "{place}");
            let map = found["keyboard"]["map"].as_str().unwrap();
            assert!(map.contains("standard deviations"), "{place}");
            assert_eq!(changed, figures(&found).contains(&"gap-after"), "{}", study.said);
        }
    }
}

/// A zoom holds for the next run, and the value under the pointer has its unit and its uncertainty.
#[test]
fn a_plot_answers_to_its_reader() {
    let Some(browser) = browser_or_word() else { return };
    let found = look(&browser, &page(&ONE_MISSING), 1280, "light");
    let [at_first, zoomed] = [0, 1].map(|place| found["zoom"][place].as_f64().unwrap());
    assert!(zoomed > 1.5 * at_first, "{found}");
    let pointer = strings(&found["pointer"]);
    assert!(pointer[0].ends_with("Hz"), "{pointer:?}");
    assert!(pointer[1].contains(" ± ") && pointer[1].ends_with("dB"), "{pointer:?}");
}

/// Lines in legends and in the text are those of the plots.
#[test]
fn legends_have_the_dashes_of_their_curves() {
    let Some(browser) = browser_or_word() else { return };
    let found = look(&browser, &page(&ONE_MISSING), 1280, "light");
    for (role, dash) in [
        ("start", "2 4"),
        ("inwards", "2 3"),
        ("after", ""),
        ("locked", "10 3 2 3"),
        ("vertical", "2 3"),
    ] {
        assert_eq!(strings(&found["dashes"][role]), [dash], "{role}");
    }
}

/// Residuals over a cleat have a row for every speed and height, and every axis its own quantity.
#[test]
fn maps_tell_runs_and_axes_apart() {
    let Some(browser) = browser_or_word() else { return };
    let found = look(&browser, &page(&ONE_MISSING), 1280, "light");
    let map = |kind: &str| strings(&found["maps"][kind]);
    let rows: Vec<&str> = map("cleat runs")
        .into_iter()
        .filter(|text| text.ends_with("km/h"))
        .collect();
    for run in ["20 km/h", "30 km/h", "40 km/h"]
        .iter()
        .flat_map(|speed| ["20\u{202f}mm", "30\u{202f}mm"].map(|height| format!("{height}, {speed}")))
    {
        assert_eq!(
            rows.iter().filter(|row| **row == run).count(),
            4,
            "{run} of four sensors in {rows:?}"
        );
    }
    for (kind, axis) in [
        ("first harmonic", "frequency, Hz"),
        ("cleat runs", "time, s"),
        ("K&C curves", "travel, mm"),
        ("first harmonic of K&C sines", "frequency, Hz"),
    ] {
        assert_eq!(map(kind).last(), Some(&axis), "{kind}");
    }
}

/// All levels of the rig lie over each other in one choice, and all estimates have their correlations in one table.
#[test]
fn what_belongs_together_stands_in_one_figure() {
    let Some(browser) = browser_or_word() else { return };
    let found = look(&browser, &page(&ONE_MISSING), 1280, "light");
    let printed = strings(&found["on_paper"]);
    assert_eq!(
        printed.iter().filter(|figure| **figure == "levels-magnitude").count(),
        3,
        "{printed:?}"
    );
    let drawn = strings(&found["figures"]);
    assert_eq!(drawn.iter().filter(|figure| **figure == "grid").count(), 6, "{drawn:?}");
    assert!(
        strings(&found["tables"]).contains(&"Correlations of the estimates"),
        "{found}"
    );
}

/// What is saved or copied is plain text for a spreadsheet.
#[test]
fn figures_and_tables_can_be_taken_away() {
    let Some(browser) = browser_or_word() else { return };
    let found = look(&browser, &page(&ONE_MISSING), 1280, "light");
    let saved = strings(&found["saved"]);
    let [figure, table, copied] = saved[..] else {
        panic!("{saved:?}")
    };
    assert!(
        figure.starts_with("\"displacement, mm\",\"outwards, force, N\""),
        "{figure}"
    );
    assert!(
        figure.lines().count() > 100 && figure.lines().nth(1).unwrap().starts_with('-'),
        "{figure}"
    );
    assert!(table.contains("\nz body,mass,246 kg,\n"), "{table}");
    assert_eq!(copied.replace('\t', ","), table);
}

/// One switch takes all values to SI units; only lines of a model file stay as they are written.
#[test]
fn units_change_everywhere() {
    let Some(browser) = browser_or_word() else { return };
    for report in [&page(&ONE_MISSING), &*COMPARISONS[1]] {
        let found = look(&browser, report, 1280, "light");
        let [mm, si] = ["mm", "si"].map(|system| found["units"][system].as_str().unwrap());
        for unit in ["N/mm", "N·s/mm", "\u{202f}mm"] {
            assert!(mm.contains(unit), "{unit} in {mm}");
            assert!(!si.replace("N/mm, mm, g", "").contains(unit), "{unit} in {si}");
        }
        assert!(si.contains("\u{202f}N/m") && si.contains("\u{202f}N·s/m"), "{si}");
        let in_g = |text: &str| text.contains("acceleration, g") || text.contains("body z, g");
        assert!(in_g(mm) && !in_g(si) && si.contains(", m/s²"), "{si}");
    }
}

/// What is after is with the best of several that the data cannot tell apart, and each of them is one of these.
#[test]
fn a_class_is_told_as_one_of_several() {
    class_is_told(PAGES);
}

#[test]
#[ignore = "a browser for each of more pages; .ci/run runs it"]
fn a_class_is_told_as_one_of_several_in_other_ways() {
    class_is_told(OTHER_PAGES);
}

fn class_is_told(pages: [(u64, &str); 2]) {
    let Some(browser) = browser_or_word() else { return };
    let Studied { folder, said } = two_sensors();
    let result: Value = serde_json::from_str(&fs::read_to_string(folder.join("study.json")).unwrap()).unwrap();
    let [best, other] = [0, 1].map(|place| {
        let own = &result["discover"]["effects"][place];
        format!("sensor gain at {}", own["at"].as_str().unwrap())
    });
    let page = page_in(&folder);
    for (width, theme) in pages {
        let found = look(&browser, &page, width, theme);
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
                format!("These data cannot distinguish {best} and {other}.")
            ),
            "{place}"
        );
        assert!(
            has("headings", format!("Either {best}")) && has("headings", format!("Or {other}")),
            "{place}"
        );
        assert!(
            has("captions", format!("Extended model, with {best}: first harmonic")),
            "{place}"
        );
        let consequence = found["paragraphs"][1].as_str().unwrap();
        assert!(
            consequence.contains(&format!(
                "With {other} instead the fitted runs are explained equally well"
            )),
            "{place}"
        );
    }
}

/// What a study and every comparison of a rolling model draw.
const STUDY: [&str; 12] = [
    "axle-z",
    "loop-bounce",
    "axle-x",
    "rig-magnitude",
    "rig-phase",
    "rig-coherence",
    "modes-before",
    "trace",
    "grid",
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
    comparison_is_whole(|first| vec![first]);
}

#[test]
#[ignore = "a browser for each of more pages; .ci/run runs it"]
fn a_comparison_is_whole_in_a_browser_in_other_ways() {
    comparison_is_whole(|first| others(&[first]));
}

/// The pages of each comparison, by the one that is looked at first: narrow and wide in turn.
fn comparison_is_whole(pages: fn(Page) -> Vec<Page>) {
    let Some(browser) = browser_or_word() else { return };
    let first = [PAGES[1], PAGES[0], PAGES[1]];
    for (((subject, sections), page), first) in COMPARED.iter().zip(&COMPARISONS).zip(first) {
        for (width, theme) in pages(first) {
            let found = look(&browser, page, width, theme);
            let place = format!("{subject}, {width} px, {theme}: {found}");
            check(&found, (width, &place), &COMPARISON);
            assert_eq!(found["sections"].as_array().unwrap().len(), *sections, "{place}");
            let is_measured = !subject.contains("--params");
            assert_eq!(figures(&found).contains(&"ratio-coherence"), is_measured, "{place}");
        }
    }
}

/// The reports of the comparisons, in the order of `COMPARED`.
static COMPARISONS: [LazyLock<String>; 3] = [
    LazyLock::new(|| compare(COMPARED[0].0)),
    LazyLock::new(|| compare(COMPARED[1].0)),
    LazyLock::new(|| compare(COMPARED[2].0)),
];

fn compare(subject: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let arguments: Vec<&str> = std::iter::once("compare").chain(subject.split_whitespace()).collect();
    qcar(&arguments, folder.path());
    page_in(folder.path())
}

fn check(found: &Value, at: (u64, &str), wanted: &[&str]) {
    check_page(found, at, wanted);
    assert!(strings(&found["keyboard"]["plot"]).len() > 2, "{}", at.1);
}

/// A page without plots that answer to a pointer.
fn check_page(found: &Value, (width, place): (u64, &str), wanted: &[&str]) {
    for list in ["errors", "violations", "blank", "requests", "faint", "unnamed"] {
        assert_eq!(found[list], Value::Array(Vec::new()), "{list} at {place}");
    }
    assert_eq!(found["width"], width, "{place}");
    assert_eq!(found["overflow"], 0, "{place}");
    assert_eq!(found["unlabelled"], 0, "{place}");
    assert_eq!(found["bad_numbers"], 0, "{place}");
    assert_eq!(
        (&found["narrower"], &found["alarms"]),
        (&true.into(), &0.into()),
        "{place}"
    );
    assert_eq!(found["printed"], paper(), "{place}");
    // A narrow page lets the reader push a table aside; a wide one shows all of it.
    assert!(width < 1000 || found["cut"] == Value::Array(Vec::new()), "{place}");
    for figure in wanted {
        assert!(figures(found).contains(figure), "no {figure} at {place}");
    }
    assert_ne!(found["themes"][0], found["themes"][1], "{place}");
}

/// What every page shows of itself to a printer: as wide as A4, no canvas, nothing that answers to a pointer.
fn paper() -> Value {
    serde_json::json!({ "width": 703, "wide": [], "controls": 0, "canvases": 0, "restored": true })
}

fn figures(found: &Value) -> Vec<&str> {
    strings(&found["figures"])
}

fn strings(list: &Value) -> Vec<&str> {
    list.as_array().unwrap().iter().filter_map(Value::as_str).collect()
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
