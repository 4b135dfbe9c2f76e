//! Bad input: exit status 2, nothing on standard output, and a message that says where and what to do.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

use flate2::read::GzDecoder;

use crate::common::{self, copy, qcar};

/// Runs in the repository with `FILE` standing for a file of this content.
fn refused(content: &str, arguments: &[&str], said: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("given.toml");
    fs::write(&file, content).unwrap();
    let file = file.to_str().unwrap();
    let arguments: Vec<&str> = arguments
        .iter()
        .map(|argument| if *argument == "FILE" { file } else { argument })
        .collect();
    common::refused(&qcar(&arguments), said);
}

fn params(content: &str, said: &[&str]) {
    refused(content, &["matrices", "quarter_car", "--params", "FILE"], said);
}

#[test]
fn parameter_files_are_read_with_care() {
    params("", &["given.toml", "no [parameters]", "[parameters]"]);
    params("[parameters\n", &["given.toml", "line 1"]);
    params(
        "[parameters]\nk_tyre = 2e5\n",
        &["line 2, column 1", "parameters.k_tyre", "did you mean `k_tire`?"],
    );
    params("[parameters]\nk_tire = \"2e5\"\n", &["line 2", "string", "a number"]);
    params("[parameters]\nk_tire = inf\n", &["line 2", "a number"]);
    params(
        "[parameters.k_tire]\nvalue = 200\nunit = \"N s/mm\"\n",
        &["line 1", "the unit \"N s/mm\"", "of the kind of N/m, such as \"N/mm\""],
    );
    params("[parameters.k_tire]\nunit = \"N/m\"\n", &["no `value`"]);
    params(
        "[parameters.k_tire]\nvalue = 2e5\nunits = \"N/m\"\n",
        &["line 3, column 1, `parameters.k_tire.units`", "did you mean `unit`?"],
    );
    params("parameters = 3\n", &["a table"]);
    params("[paramters]\nk_tire = 2e5\n", &["`paramters`", "[parameters]"]);
    params(
        "[parameters]\nk_tire = \"200 kN\"\n",
        &["line 2", "the unit \"kN\"", "of the kind of N/m"],
    );
    params(
        "[parameters]\nk_tire = 2e5\n[vehicle]\nk_tire = 3e5\n",
        &[
            "line 2, column 1, `parameters.k_tire`",
            "200000 here and 300000 at [vehicle]",
            "leave out one of them",
        ],
    );
}

#[test]
fn all_problems_of_a_file_come_together() {
    params(
        "[parameters]\nk_tyre = 2e5\nfriction = 3.0\n",
        &["parameters.k_tyre", "parameters.friction"],
    );
}

#[test]
fn flags_are_read_with_care() {
    let matrices = |rest: &[&str], said: &[&str]| refused("", &[&["matrices", "quarter_car"], rest].concat(), said);
    matrices(&["--set", "k_tire"], &["name=value"]);
    matrices(&["--set", "k_tire=stiff"], &["a number"]);
    matrices(&["--set", "k_tyre=2e5"], &["did you mean `k_tire`?"]);
    matrices(&["--axis", "y"], &["`y`", "--axis"]);
    matrices(&["--params", "nowhere.toml"], &["nowhere.toml", "a readable text file"]);
    let frf = |rest: &[&str], said: &[&str]| refused("", &[&["frf", "quarter_car"], rest].concat(), said);
    frf(&["--frequencies", "30:0.5:300"], &["above the first"]);
    frf(&["--frequencies", "0:30:300"], &["above 0 Hz"]);
    frf(&["--frequencies", "1:30"], &["FROM:TO:LINES"]);
    frf(&["--channels", "pad_to_moon"], &["`pad_to_moon`", "`pad_to_body`"]);
}

/// The last of two flags does not quietly take precedence.
#[test]
fn flags_that_contradict_each_other_are_refused() {
    let axle = "models/campaigns/axle_a_rig";
    let both = ["fit", axle, "--free", "k_tire", "--fix", "c_tm,k_tire"];
    refused("", &both, &["--free", "`k_tire`, which --fix names too"]);
    let set = ["matrices", "quarter_car", "--set", "k_tire=2e5", "--set", "k_tire=3e5"];
    refused("", &set, &["--set k_tire", "a second value", "leave one of them out"]);
    let tolerance = ["sensitivity", "axle_a", "--campaign", axle, "--metrics", "body_x.peak"];
    let twice = ["--tolerance", "k_tire=5%", "--tolerance", "k_tire=6%"];
    refused(
        "",
        &[&tolerance[..], &twice].concat(),
        &["--tolerance", "`k_tire` twice"],
    );
    let explored = [
        "explore",
        "axle_a",
        "--params",
        axle,
        "--vary",
        "k_tire=-1%..1%",
        "--count",
        "2",
        "--metrics",
        "peak",
    ];
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("sets.csv");
    let rides = ["--rides", "20mm@30km/h,20 mm@30km/h", "--out", out.to_str().unwrap()];
    refused("", &[&explored[..], &rides].concat(), &["--rides", "a ride twice"]);
    assert!(!out.exists());
}

#[test]
fn text_that_is_not_utf_8_is_shown_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("latin.axle");
    fs::write(&file, b"axle car {\n    \"K\xF6rper\"\n}\n").unwrap();
    let said = [
        "latin.axle",
        "the byte 0xF6 in line 2 at byte 7",
        "save the file as UTF-8",
    ];
    common::refused(&qcar(&["check", file.to_str().unwrap()]), &said);
}

#[test]
fn a_misspelt_name_is_recognised() {
    for (line, said) in [
        ("frf quarter_cra", "did you mean `quarter_car`?"),
        ("frf quarter_car --channels pad_to_bdy", "did you mean `pad_to_body`?"),
        (
            "patch axle_c coulomb_frictoin --at damper",
            "did you mean `coulomb_friction`?",
        ),
    ] {
        let words: Vec<&str> = line.split(' ').collect();
        common::refused(&qcar(&words), &[said]);
    }
}

#[test]
fn numbers_and_names_of_flags_are_checked() {
    let score = ["score", "models/campaigns/axle_a_rig", "--within"];
    for value in ["nan", "-5", "inf", "three"] {
        let said = ["--within <PERCENT>", "expected percent, zero or more", value];
        refused("", &[&score[..], &[value]].concat(), &said);
    }
    refused(
        "",
        &["frf", "quarter_car", "--set", "=3"],
        &["--set", "expected name=value"],
    );
    let export = ["export", "quarter_car", "--as", "c", "--out", ".."];
    refused("", &export, &["a file that ends in .c", "write --out ../model.c"]);
    let slow = ["--road", "C@80km/h", "--road", "B@0km/h"];
    let said = ["`--road B@0km/h`", "a speed of 0 m/s"];
    refused(
        "",
        &[&["simulate", "models/campaigns/axle_a_rig"][..], &slow].concat(),
        &said,
    );
}

/// The message offers the model file beside the campaign, and the file is found there.
#[test]
fn a_campaign_names_a_shipped_model_or_a_file_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = folder.path().join("campaign");
    copy(Path::new("models/campaigns/axle_a_rig"), &campaign);
    let families = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/families");
    let model = fs::read_to_string("models/axles/axle_a.axle").unwrap();
    let model = model.replace("../families", families.to_str().unwrap());
    fs::write(campaign.join("base.axle"), model).unwrap();
    let named = |model: &str| {
        let manifest = campaign.join("campaign.toml");
        let text = fs::read_to_string(&manifest).unwrap();
        let own = text.lines().find(|line| line.starts_with("model = ")).expect("a model");
        fs::write(&manifest, text.replace(own, &format!("model = {model:?}"))).unwrap();
        qcar(&["check", campaign.to_str().unwrap()])
    };
    common::refused(&named("base"), &["campaign.toml", "`base`", "model = \"base.axle\""]);
    let checked = named("base.axle");
    assert_eq!(checked.status, 0, "{}", checked.stderr);
}

/// As `head` does after some lines.
#[test]
fn a_reader_that_has_read_enough_of_a_message_is_no_reason_to_panic() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(["frf", "no_such_model"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(2));
}

/// A stiffness in N/mm without its unit.
#[test]
fn values_outside_the_ranges_of_the_model_are_not_passed_on() {
    let folder = tempfile::tempdir().unwrap();
    let out = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let said = [
        "--set k_tire",
        "found 220 N/m, expected a value from 50000 to 1000000 N/m, for which the model is declared",
        "correct the value or its unit",
    ];
    let code = out("model.c");
    refused(
        "",
        &[
            "export",
            "quarter_car",
            "--set",
            "k_tire=220",
            "--as",
            "c",
            "--out",
            &code,
        ],
        &said,
    );
    // In the unit in which the user has written the value, or else in that of the results.
    let export = ["export", "quarter_car", "--as", "c", "--out", &code];
    let units: [(&[&str], &str); 3] = [
        (
            &["--set", "k_tire=20 N/mm"],
            "found 20 N/mm, expected a value from 50 to 1000 N/mm, for",
        ),
        (
            &["--set", "k_tire=0.02 kN/mm", "--units", "N/mm"],
            "found 0.02 kN/mm, expected a value from 0.05 to 1 kN/mm",
        ),
        (
            &["--set", "k_tire=20000", "--units", "N/mm"],
            "found 20 N/mm, expected a value from 50 to 1000 N/mm, for",
        ),
    ];
    for (set, said) in units {
        refused("", &[&export[..], set].concat(), &["--set k_tire", said]);
    }
    let sets = out("sets.csv");
    let explored = [
        "explore",
        "quarter_car",
        "--set",
        "k_tire=220",
        "--vary",
        "m_wheel=-1%..1%",
        "--count",
        "2",
    ];
    refused(
        "",
        &[&explored[..], &["--metrics", "modes", "--out", &sets]].concat(),
        &said,
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    // A replay says so beside its result.
    let ran = qcar(&[
        "simulate",
        "models/campaigns/emps",
        "--set",
        "m_body=1e7",
        "--format",
        "json",
    ]);
    assert!(
        ran.stdout.contains("the plausible range of model"),
        "{}{}",
        ran.stdout,
        ran.stderr
    );
}

/// In a campaign and in a parameter file, with the line and the value as it stands there.
#[test]
fn gravity_is_that_of_a_planet() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    copy(Path::new("models/campaigns/axle_a_rig"), &own);
    let manifest = own.join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let line = 1 + text.lines().position(|line| line == "gravity = 9.81").unwrap();
    let campaign = own.to_str().unwrap();
    let frf = ["frf", "quarter_car", "--params", "FILE"];
    let magnitude = "the magnitude of the acceleration of gravity";
    for value in ["0", "0.0", "-9.81", "1", "9810.0", "\"-1 g\""] {
        fs::write(&manifest, text.replace("gravity = 9.81", &format!("gravity = {value}"))).unwrap();
        let place = format!("campaign.toml, line {line}, column");
        let said = [&place, &format!("found {value}, expected {magnitude}"), "leave it out"];
        common::refused(&qcar(&["check", campaign]), &said);
        common::refused(&qcar(&["frf", "axle_a", "--params", campaign]), &said);
        let [_, found, remedy] = said;
        let content = format!("[vehicle]\ngravity = {value}\n");
        refused(&content, &frf, &["line 2, column 1, `vehicle.gravity`", found, remedy]);
    }
    fs::write(&manifest, text.replace("gravity = 9.81", "gravity = nan")).unwrap();
    common::refused(&qcar(&["check", campaign]), &[&format!("line {line}"), "found nan"]);
    refused(
        "[vehicle]\ngravity = nan\n",
        &frf,
        &["line 2", "found nan, expected a finite number"],
    );
    refused(
        "[vehicle]\ngravity = { value = 9.81, unit = \"kg\" }\n",
        &frf,
        &["line 2", "the unit \"kg\"", "of the kind of m/s^2"],
    );
    fs::write(&manifest, text.replace("gravity = 9.81", "gravity = \"1 g\"")).unwrap();
    assert_eq!(qcar(&["check", campaign]).status, 0);
}

#[test]
fn values_for_a_patch_have_names_of_its_model() {
    let patch = ["patch", "axle_c", "digressive_damper", "--at", "damper"];
    let set = ["--set", "c_whel_z=2000"];
    refused(
        "",
        &[&patch[..], &set].concat(),
        &["--set c_whel_z", "did you mean `c_wheel_z`?"],
    );
    let params = ["--params", "FILE"];
    let said = ["line 2", "parameters.c_whel_z", "did you mean `c_wheel_z`?"];
    refused("[parameters]\nc_whel_z = 2e3\n", &[&patch[..], &params].concat(), &said);
}

#[test]
fn what_is_wrong_in_every_run_is_said_once() {
    let ran = qcar(&["fit", "models/campaigns/axle_a_rig", "--channels", "pad_to_whel"]);
    common::refused(&ran, &["`pad_to_whel`", "not measured"]);
    assert_eq!(ran.stderr.matches("pad_to_whel").count(), 1, "{}", ran.stderr);
}

/// Before the work, whose result nobody would see.
#[test]
fn a_folder_that_cannot_be_written_to_is_refused() {
    let said: &[&str] = &["--out <DIR>", "given.toml", "a writable place", "choose another folder"];
    for verb in ["fit", "simulate", "discover", "study"] {
        refused("", &[verb, "models/campaigns/axle_a_rig", "--out", "FILE"], said);
    }
    refused("", &["compare", "axle_a", "axle_a", "--out", "FILE"], said);
}

#[test]
fn parameters_without_a_value_are_all_named() {
    refused(
        "",
        &["matrices", "axle_c"],
        &["`m_wheel`", "`k_tire`", "--params", "--set"],
    );
    let content = "[parameters]\nk_tire = 2e5\n";
    refused(
        content,
        &["matrices", "axle_c", "--params", "FILE"],
        &["given.toml", "`m_wheel`: found no value", "`k_wheel_z`: found no value"],
    );
}

#[test]
fn values_that_make_no_sense_are_refused() {
    let set = |setting: &str, said: &[&str]| {
        refused("", &["frf", "quarter_car", "--set", setting], said);
        refused("", &["matrices", "quarter_car", "--set", setting], said);
    };
    set("m_wheel=500", &["`mass body = m_body;`", "-100"]);
    set("m_corner=40", &["`mass body = m_body;`", "found 0"]);
    refused("", &["frf", "quarter_car", "--set", "k_tire=1e308"], &["finite"]);
}

#[test]
fn models_are_found_or_missed_by_name() {
    refused("", &["matrices", "axle_q"], &["`axle_q`", "`axle_a`"]);
    refused("", &["matrices", "nowhere/my.axle"], &["nowhere/my.axle"]);
    refused("not a model", &["matrices", "FILE"], &["given.toml"]);
    refused("", &["show", "axle_q", "--stage", "model"], &["`axle_q`"]);
}

#[test]
fn campaigns_are_read_with_care() {
    refused("", &["fit", "nowhere"], &["nowhere", "campaign.toml"]);
    assert!(!Path::new("nowhere").exists());
}

#[test]
fn facts_of_the_vehicle_are_known_to_somebody() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/campaigns/axle_a_rig");
    copy(&shipped, folder.path());
    let file = folder.path().join("campaign.toml");
    let manifest = fs::read_to_string(&file).unwrap();
    let line = 1 + manifest.lines().position(|line| line.starts_with("r_tire")).unwrap();
    fs::write(&file, manifest.replacen("r_tire", "r_tyre", 1)).unwrap();
    let said = [
        &*format!("campaign.toml, line {line}, column 1, `vehicle.r_tyre`: found an unknown key"),
        "did you mean `r_tire`?",
    ];
    for verb in ["fit", "simulate", "discover"] {
        refused("", &[verb, folder.path().to_str().unwrap()], &said);
    }
    params(
        "[parameters]\n[vehicle]\nc_tyre = 90.0\n",
        &["line 3", "vehicle.c_tyre", "did you mean `c_tire`?"],
    );
}

/// A copy of the campaign whose first sweep has been through `change`, line by line; empty lines go.
fn damaged(change: impl Fn(usize, Vec<&str>) -> String) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/campaigns/axle_a_rig");
    copy(&shipped, folder.path());
    let manifest = fs::read_to_string(shipped.join("campaign.toml")).unwrap();
    let manifest = manifest.replace("rig/sweep_025.csv.gz", "sweep.csv");
    fs::write(folder.path().join("campaign.toml"), manifest).unwrap();
    let packed = fs::File::open(shipped.join("rig/sweep_025.csv.gz")).unwrap();
    let mut text = String::new();
    GzDecoder::new(packed).read_to_string(&mut text).unwrap();
    let lines = text.lines().enumerate();
    let changed: Vec<String> = lines.map(|(at, line)| change(at, line.split(',').collect())).collect();
    let kept: Vec<String> = changed.into_iter().filter(|line| !line.is_empty()).collect();
    fs::write(folder.path().join("sweep.csv"), kept.join("\n")).unwrap();
    folder
}

/// Old line ends would make one line of the table, with a name for each cell.
#[test]
fn a_table_of_many_wrong_columns_is_told_in_a_few_lines() {
    let unchanged = damaged(|_, cells| cells.join(","));
    let (file, path) = (unchanged.path().join("sweep.csv"), unchanged.path().to_str().unwrap());
    fs::write(&file, fs::read_to_string(&file).unwrap().replace('\n', "\r")).unwrap();
    let ran = qcar(&["check", path]);
    common::refused(
        &ran,
        &["sweep.csv, line 1", "carriage return", "line ends of Windows or Unix"],
    );
    assert_eq!(ran.stderr.lines().count(), 1, "{}", ran.stderr);
    let more: String = (0..200).map(|number| format!(",x_{number}")).collect();
    let wide = damaged(|line, cells| cells.join(",") + if line == 0 { &more } else { "" });
    let ran = qcar(&["check", wide.path().to_str().unwrap()]);
    common::refused(&ran, &["column `x_0`", "further columns of these are wrong too"]);
    assert!(ran.stderr.lines().count() < 30, "{}", ran.stderr);
}

/// Multiplies a column of a table.
fn scaled(column: usize, factor: f64) -> impl Fn(usize, Vec<&str>) -> String {
    move |line, cells| {
        let cell = |(at, text): (usize, &str)| match at == column && line > 0 {
            true => (text.parse::<f64>().unwrap() * factor).to_string(),
            false => text.to_string(),
        };
        cells.into_iter().enumerate().map(cell).collect::<Vec<_>>().join(",")
    }
}

fn fit_refused(folder: &Path, said: &[&str]) {
    refused("", &["fit", folder.to_str().unwrap()], said);
}

#[test]
fn sensors_that_contradict_each_other_are_refused() {
    let unchanged = damaged(scaled(3, 1.0));
    assert_eq!(
        qcar(&["fit", unchanged.path().to_str().unwrap(), "--starts", "1"]).status,
        0
    );
    // time, pad_left_z, pad_right_z, wheel_left_z, ...
    let (wheel_in_g, wheel_flipped, pad_flipped) = (
        damaged(scaled(3, 1.0 / 9.81)),
        damaged(scaled(3, -1.0)),
        damaged(scaled(1, -1.0)),
    );
    let sides = [
        "sweep.csv",
        "`wheel_left_z`, `wheel_right_z`",
        "unit, sign or calibration",
    ];
    fit_refused(wheel_in_g.path(), &sides);
    fit_refused(wheel_flipped.path(), &sides);
    fit_refused(
        pad_flipped.path(),
        &["sweep.csv", "`pad z acceleration`", "`peak_velocity = 0.025`"],
    );
}

#[test]
fn records_with_holes_are_refused() {
    let lost = damaged(|line, mut cells| {
        if line == 99 {
            cells[3] = "NaN";
        }
        cells.join(",")
    });
    fit_refused(lost.path(), &["sweep.csv, line 100, column `wheel_left_z`", "NaN"]);
    let gap = damaged(|line, cells| {
        if (500..520).contains(&line) {
            String::new()
        } else {
            cells.join(",")
        }
    });
    fit_refused(
        gap.path(),
        &["sweep.csv, line 501, column `time`", "a gap cannot be filled"],
    );
    let renamed = damaged(|line, cells| {
        let text = cells.join(",");
        if line == 0 {
            text.replace("wheel_left_z", "hub_left_z")
        } else {
            text
        }
    });
    fit_refused(
        renamed.path(),
        &["sweep.csv, line 1, column `hub_left_z`", "an unknown column"],
    );
}
