//! Results replace neither measurements nor each other.

use std::fs;
use std::io::Read;
use std::path::Path;

use crate::common::{copy, qcar, qcar_in, refused, repository, succeeds};
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
    let mut expected = ["run_0", "run_0_2", "sweep at 25 mm_s", "sweep at 50 mm_s"]
        .map(of)
        .concat();
    expected.insert(4, "simulation.json".into());
    assert_eq!(names(&out), expected);
}

/// A file of someone else, of a name that each verb gives to one of its own, stops the verb. Its own files do not, but
/// for results of another subject.
#[test]
fn a_verb_replaces_only_what_it_has_written() {
    const RIG: &str = "models/campaigns/axle_a_rig";
    const KNOWN: &str = "models/campaigns/axle_a_rig/campaign.toml";
    const TRUE: &str = "models/campaigns/axle_a_rig/truth.toml";
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&str, &[&str], &str, &str); 6] = [
        ("report.html", &["compare", KNOWN, TRUE, "--campaign", RIG], TRUE, KNOWN),
        ("cleat.csv", &["compare", KNOWN, TRUE, "--campaign", RIG], TRUE, KNOWN),
        (
            "report.html",
            &["sensitivity", "quarter_car"],
            "quarter_car",
            "one_mass",
        ),
        ("parameters.toml", &["fit", RIG, "--starts", "1"], "", ""),
        ("v30_h20.csv", &["simulate", RIG], "", ""),
        (
            "iso_B_80kmh_2s.csv",
            &["simulate", RIG, "--road", "B@80km/h:2s"],
            "",
            "",
        ),
    ];
    for (place, (name, line, subject, other)) in cases.into_iter().enumerate() {
        let out = folder.path().join(place.to_string());
        fs::create_dir(&out).unwrap();
        let into_out = |line: &[&str]| qcar(&[line, &["--out", out.to_str().unwrap()]].concat());
        fs::write(out.join(name), "of another program").unwrap();
        let said = [
            "a file of another origin",
            name,
            "a new folder, or results of",
            "move the file away",
        ];
        refused(&into_out(line), &said);
        assert_eq!(names(&out), [name]);
        assert_eq!(fs::read_to_string(out.join(name)).unwrap(), "of another program");
        fs::remove_file(out.join(name)).unwrap();
        for _ in 0..2 {
            assert_eq!(into_out(line).status, 0);
        }
        let whole = fs::read(out.join(name)).unwrap();
        let others: Vec<&str> = line
            .iter()
            .map(|word| if *word == subject { other } else { *word })
            .collect();
        if others != line {
            refused(
                &into_out(&others),
                &[subject, other, "choose another folder, or remove them"],
            );
        }
        assert_eq!(fs::read(out.join(name)).unwrap(), whole);
    }
}

/// Files of `study` and `discover` and `target`, which take long: all are refused before the work.
#[test]
fn long_work_is_not_begun_where_it_would_replace_a_file() {
    const STUDY: &str = "models/campaigns/axle_c_study";
    let cases: [(&[&str], &str); 11] = [
        (&["study", STUDY], "report.html"),
        (&["study", STUDY], "results.xlsx"),
        (&["study", STUDY], "fit/transmissibility.svg"),
        (&["study", STUDY], "kc/gradients.json"),
        (&["study", STUDY], "cleat/v30_h20.csv"),
        (&["study", STUDY], "discovery/gap.svg"),
        (&["discover", STUDY], "parameters.toml"),
        (&["discover", STUDY], "axle_c_with_suspended_mass.axle"),
        (&["discover", STUDY], "learned_elastic_law_at_top_mount.axle"),
        (&["discover", STUDY], "unfinished/parameters.toml"),
        (&["target", "models/targets/axle_a.toml"], "results.xlsx"),
    ];
    for (line, name) in cases {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(name);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(&file, "of another program").unwrap();
        let ran = qcar(&[line, &["--out", folder.path().to_str().unwrap()]].concat());
        refused(&ran, &["a file of another origin", name, "choose another folder"]);
        assert_eq!(fs::read_to_string(&file).unwrap(), "of another program");
    }
}

/// The measured files of a campaign are in a folder of the name that a study gives to its own simulated runs.
#[test]
fn a_study_in_the_folder_of_its_campaign_replaces_no_record() {
    let repository = repository();
    let campaign = repository.path().join("own");
    copy(&repository.path().join("models/campaigns/axle_c_study"), &campaign);
    let packed = campaign.join("cleat/v30_h20.csv.gz");
    let mut record = String::new();
    let mut unpacked = flate2::read::GzDecoder::new(fs::File::open(&packed).unwrap());
    unpacked.read_to_string(&mut record).unwrap();
    fs::write(campaign.join("cleat/v30_h20.csv"), record).unwrap();
    fs::remove_file(packed).unwrap();
    let manifest = campaign.join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, text.replace("v30_h20.csv.gz", "v30_h20.csv")).unwrap();
    let fitted = ["fit", "own", "--starts", "1", "--out", "own/fit"];
    assert_eq!(qcar_in(repository.path(), &fitted).status, 0);
    let before = names(&campaign.join("cleat"));
    let ran = qcar_in(repository.path(), &["study", "own", "--out", "own"]);
    refused(&ran, &["a measured file of the campaign", "choose another folder"]);
    assert_eq!(names(&campaign.join("cleat")), before);
}

#[test]
fn the_description_of_a_design_replaces_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let [sets, beside] = ["sets.csv", "sets.csv.design.json"].map(|name| folder.path().join(name));
    fs::write(&beside, "of another program").unwrap();
    let line = "explore quarter_car --vary m_wheel=-1%..1% --count 2 --metrics modes --out";
    let line: Vec<&str> = line.split(' ').chain([sets.to_str().unwrap()]).collect();
    refused(
        &qcar(&line),
        &[
            "sets.csv.design.json",
            "a file of another origin",
            "choose another file",
        ],
    );
    assert_eq!(fs::read_to_string(&beside).unwrap(), "of another program");
    fs::remove_file(&beside).unwrap();
    succeeds(&line);
    // Without its results, a description is worth nothing.
    fs::remove_file(&sets).unwrap();
    succeeds(
        &line
            .iter()
            .map(|word| if *word == "2" { "3" } else { word })
            .collect::<Vec<_>>(),
    );
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
fn a_file_is_imported_once() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("rig");
    let record = "models/campaigns/axle_a_rig/rig/sweep_025.csv.gz";
    let again = format!("./{record}");
    let ran = qcar(&["import", record, &again, "--out", out.to_str().unwrap()]);
    refused(&ran, &[&again, "a second time", "leave one of them out"]);
    assert!(!out.exists());
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
