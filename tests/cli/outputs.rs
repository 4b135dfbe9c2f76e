//! Results replace neither measurements nor each other.

use std::fs;
use std::path::Path;

use crate::common::{qcar, refused, succeeds};
use crate::records::{campaign, parameter, pushed};

/// Values at which nothing is fitted.
fn known() -> String {
    let known = [
        ("m_body", 2.0, "kg"),
        ("c_body", 3.0, "N s/m"),
        ("k_body", 800.0, "N/m"),
    ];
    known
        .map(|(name, value, unit)| parameter(name, value, unit, ""))
        .concat()
        .replace("true", "false")
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = entries.map(|name| name.into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn replays_replace_no_record_of_the_campaign() {
    let folder = tempfile::tempdir().unwrap();
    campaign(
        folder.path(),
        "one_mass",
        &known(),
        "band_limited = false",
        &[&pushed()],
    );
    fs::create_dir(folder.path().join("other")).unwrap();
    let (before, path) = (names(folder.path()), folder.path().to_str().unwrap());
    let record = fs::read(folder.path().join("run_0.csv")).unwrap();
    for out in [path.to_string(), format!("{path}/other/..")] {
        let said = [
            "--out",
            "run_0.csv, a measured file of the campaign",
            "choose another folder",
        ];
        refused(&qcar(&["simulate", path, "--out", &out]), &said);
    }
    assert_eq!(fs::read(folder.path().join("run_0.csv")).unwrap(), record);
    assert_eq!(names(folder.path()), before);
    // Files of another kind have other names.
    succeeds(&["simulate", path, "--out", path, "--as", "mat"]);
    assert_eq!(fs::read(folder.path().join("run_0.csv")).unwrap(), record);
}

/// Files of one name in two folders, and names that the manual gives as examples.
#[test]
fn every_run_has_files_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path().to_str().unwrap(), folder.path().join("out"));
    let runs = pushed();
    campaign(
        folder.path(),
        "one_mass",
        &known(),
        "band_limited = false",
        &[&runs, &runs, &runs, &runs],
    );
    fs::create_dir(folder.path().join("other")).unwrap();
    fs::rename(folder.path().join("run_1.csv"), folder.path().join("other/run_0.csv")).unwrap();
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest)
        .unwrap()
        .replace("run_1.csv", "other/run_0.csv");
    let text = text.replace("\"run_2.csv\"", "\"run_2.csv\"\nname = \"sweep at 25 mm/s\"");
    let text = text.replace("\"run_3.csv\"", "\"run_3.csv\"\nname = \"sweep at 50 mm/s\"");
    fs::write(&manifest, text).unwrap();
    succeeds(&["simulate", path, "--out", out.to_str().unwrap()]);
    let of = |name: &str| ["csv", "svg"].map(|extension| format!("{name}.{extension}"));
    let expected = ["run_0", "run_0_2", "sweep at 25 mm_s", "sweep at 50 mm_s"].map(of);
    assert_eq!(names(&out), expected.concat());
}

#[test]
fn a_patch_replaces_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let notes = folder.path().join("notes.txt");
    fs::write(&notes, "of a year").unwrap();
    let arguments = ["patch", "axle_c", "coulomb_friction", "--at", "damper", "--out"];
    let ran = qcar(&[&arguments[..], &[notes.to_str().unwrap()]].concat());
    refused(
        &ran,
        &["--out", "notes.txt, which exists already", "choose another name"],
    );
    assert_eq!(fs::read_to_string(&notes).unwrap(), "of a year");
}

#[test]
fn a_new_campaign_may_have_a_name_with_quotation_marks() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("rig \"front\"");
    let record = "models/campaigns/axle_a_rig/rig/sweep_025.csv.gz";
    succeeds(&["import", record, "--out", out.to_str().unwrap(), "--model", "axle_a"]);
    let text = fs::read_to_string(out.join("campaign.toml")).unwrap();
    let campaign: toml::Table = toml::from_str(&text).unwrap();
    assert_eq!(campaign["name"].as_str(), Some("rig \"front\""));
}
