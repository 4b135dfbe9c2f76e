//! The first files of somebody who has none yet.

use std::fs;
use std::path::Path;

use crate::common::{run_line as in_folder, sweep};

fn well(folder: &Path, line: &str) -> String {
    let ran = in_folder(folder, line);
    assert_eq!(ran.status, 0, "qcar {line}\n{}{}", ran.stdout, ran.stderr);
    ran.stdout
}

#[test]
fn a_new_axle_compiles_and_runs_with_its_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let said = well(folder.path(), "new axle city_car --dir models");
    assert_eq!(
        well(folder.path(), "check models/city_car.axle"),
        "models/city_car.axle: ok\n"
    );
    // What it says to try.
    let tries: Vec<&str> = said
        .lines()
        .filter_map(|line| line.trim().strip_prefix("qcar "))
        .collect();
    assert_eq!(tries.len(), 2, "{said}");
    tries.iter().for_each(|line| drop(well(folder.path(), line)));
    let values = "--params models/city_car.toml --format json";
    let matrices = well(folder.path(), &format!("matrices models/city_car.axle {values}"));
    assert!(matrices.contains("\"k_wheel_x\":400000.0"), "{matrices}");
}

#[test]
fn a_new_axle_never_stands_over_another() {
    let folder = tempfile::tempdir().unwrap();
    for file in ["first.axle", "second.toml"] {
        fs::write(folder.path().join(file), "mine").unwrap();
    }
    for name in ["first", "second"] {
        let ran = in_folder(folder.path(), &format!("new axle {name}"));
        assert_eq!(ran.status, 2);
        assert!(ran.stderr.contains("exists already"), "{}", ran.stderr);
    }
    assert_eq!(fs::read_to_string(folder.path().join("first.axle")).unwrap(), "mine");
    assert_eq!(
        fs::read_dir(folder.path()).unwrap().count(),
        2,
        "nothing else was written"
    );
}

#[test]
fn names_that_no_model_can_have_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["City", "2nd", "a-b", "../up", "ä", "_x", "self", "if"] {
        let ran = in_folder(folder.path(), &format!("new axle {name}"));
        assert_eq!(ran.status, 2, "{name}");
        assert!(ran.stderr.contains(&format!("`{name}`")), "{}", ran.stderr);
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_new_campaign_says_what_to_put_where_and_fits_once_it_is_there() {
    let folder = tempfile::tempdir().unwrap();
    well(folder.path(), "new axle city_car");
    let said = well(folder.path(), "new campaign rig --dir data --model city_car.axle");
    let header = "time,pad_left_z,pad_right_z,body_left_z,body_right_z,wheel_left_z,wheel_right_z";
    assert!(said.contains(header), "{said}");
    let missing = in_folder(folder.path(), "fit data/rig");
    assert_eq!(missing.status, 2);
    for hint in ["data/rig/rig/sweep_025.csv", "data/rig/rig/sweep_100.csv", header] {
        assert!(missing.stderr.contains(hint), "{}", missing.stderr);
    }
    let to = folder.path().join("data/rig/rig");
    fs::write(to.join("sweep_025.csv"), sweep(0.025, header, [22e3, 200.0])).unwrap();
    fs::write(to.join("sweep_100.csv"), sweep(0.1, header, [22e3, 200.0])).unwrap();
    // What is known of the vehicle has no value that anybody could take for known.
    let unknown = in_folder(folder.path(), "fit data/rig --starts 2");
    assert!(
        unknown.status == 2 && unknown.stderr.contains("fill in the line `# m_corner =`"),
        "{}",
        unknown.stderr
    );
    let manifest = folder.path().join("data/rig/campaign.toml");
    let mut text = fs::read_to_string(&manifest).unwrap();
    for (name, value) in [("m_corner", 315), ("m_half_vehicle", 700), ("m_wheel_other_axle", 40)] {
        assert!(text.contains(&format!("# {name} =")), "{text}");
        text = text.replace(&format!("# {name} ="), &format!("{name} = {value}"));
    }
    fs::write(&manifest, text).unwrap();
    let fitted = well(folder.path(), "fit data/rig --starts 2");
    assert!(fitted.contains("city_car fitted to rig: converged"), "{fitted}");
    let again = in_folder(folder.path(), "new campaign rig --dir data");
    assert!(
        again.status == 2 && again.stderr.contains("exists already"),
        "{}",
        again.stderr
    );
}

#[test]
fn a_campaign_for_a_shipped_model_has_its_masses_as_sensors() {
    let folder = tempfile::tempdir().unwrap();
    let said = well(folder.path(), "new campaign rig --model axle_a");
    assert!(said.contains("tm_left_z") && said.contains("pwt_right_z"), "{said}");
    let unknown = in_folder(folder.path(), "new campaign other --model axle_q");
    assert!(
        unknown.status == 2 && unknown.stderr.contains("`axle_q`"),
        "{}",
        unknown.stderr
    );
    assert!(!folder.path().join("other").exists());
}
