//! The first files of somebody who has none yet.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use serde_json::Value;

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

const DRIVE: &str = "axle drive { \"A motor turns a load through a shaft\"
    known param j_m: kg m^2 = 0.02125;
    param j_l: kg m^2 = 0.5 in 0.05..5 \"Load\"; param k_sh: N m/rad = 500 in 50..1e5; param c_sh: N m s/rad = 0.3 in 0.01..100;
    direction phi {
        inertia motor = j_m; inertia load = j_l; force torque on motor;
        link shaft: motor - load { spring k_sh; damper c_sh; }
        link bearing: load { damper 0.4 N m s; }
        output motor.velocity; output load.velocity; output shaft.force;
    } }";

/// A record of 10 s of the drive with a shaft of 800 N m/rad and 0.5 N m s/rad: eleven sines of torque, which differ from
/// run to run, by small steps.
fn record_of_drive(header: &str, run: usize) -> String {
    let torque = |t: f64| -> f64 {
        let sine = |k: usize| (TAU * (0.7 * k as f64) * t + (k * k * (run + 2)) as f64).sin();
        (1..60).step_by(6).map(sine).sum()
    };
    let ([mut motor, mut load, mut twist], dt) = ([0.0; 3], 2e-5);
    let mut text = header.to_string();
    for step in 0..500_000 {
        let t = step as f64 * dt;
        let shaft = 800.0 * twist + 0.5 * (motor - load);
        if step % 50 == 0 {
            text += &format!("\n{t:.3},{:.6},{motor:.8},{load:.8},{shaft:.7}", torque(t));
        }
        motor += dt * (torque(t) - shaft) / 0.02125;
        load += dt * (shaft - 0.4 * load) / 0.5;
        twist += dt * (motor - load);
    }
    text
}

#[test]
fn a_campaign_of_a_machine_has_its_inputs_and_outputs_and_fits_once_the_records_are_there() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("drive.axle"), DRIVE).unwrap();
    let said = well(folder.path(), "new campaign rig --model drive.axle --dir .");
    let header = "time,torque_force,motor_velocity,load_velocity,shaft_force";
    assert!(said.contains(header), "{said}");
    let manifest = fs::read_to_string(folder.path().join("rig/campaign.toml")).unwrap();
    for lines in [
        "location = \"torque\"\nside = \"centre\"\naxis = \"phi\"\nquantity = \"force\"\nunit = \"N m\"",
        "location = \"load\"\nside = \"centre\"\naxis = \"phi\"\nquantity = \"velocity\"\nunit = \"rad/s\"",
        "j_m = 0.02125 # kg m^2; as in the model, give yours",
        "[parameters.j_l] # Load\n",
        "[parameters.k_sh]\nvalue = 500\nunit = \"N m/rad\"\nrange = [50, 100000]\nfit = true",
        header,
    ] {
        assert!(manifest.contains(lines), "expected\n{lines}\nin\n{manifest}");
    }
    for absent in ["tire", "sweep", "cleat", "bounce", "pad"] {
        assert!(!manifest.contains(absent), "{absent} in\n{manifest}");
    }
    for run in [1, 2] {
        let file = folder.path().join(format!("rig/records/run_{run}.csv"));
        fs::write(file, record_of_drive(header, run)).unwrap();
    }
    let checked = well(folder.path(), "check rig");
    assert!(checked.contains("ok"), "{checked}");
    let fitted: Value = serde_json::from_str(&well(folder.path(), "fit rig --starts 1 --format json")).unwrap();
    for (name, truth) in [("k_sh", 800.0), ("c_sh", 0.5), ("j_l", 0.5)] {
        let value = fitted["parameters"][name]["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.01, "{name} is {value}");
    }
}

/// A mass on a spring and a damper, let go at 10 mm: what nothing drives has responses alone.
#[test]
fn a_campaign_of_what_nothing_drives_is_of_free_decays() {
    let folder = tempfile::tempdir().unwrap();
    let text = "axle decay { \"A mass on a spring\"
        known param m: kg = 2; param k: N/m in 100..1e5; param c: N s/m in 0.01..100; param loose: N/m = 10;
        direction z { mass body = m; link spring: body { spring k + loose; damper c; } output body.position; } }";
    fs::write(folder.path().join("decay.axle"), text).unwrap();
    let said = well(folder.path(), "new campaign rig --model decay.axle");
    assert!(said.contains("time,body_displacement\n"), "{said}");
    for (run, start) in [(1, 0.01), (2, 0.007)] {
        let omega = (5e3_f64 / 2.0 - 4.0).sqrt();
        let motion = |t: f64| start * (-2.0 * t).exp() * ((omega * t).cos() + 2.0 / omega * (omega * t).sin());
        let line = |k: usize| format!("\n{:.3},{:.9}", k as f64 * 1e-3, motion(k as f64 * 1e-3));
        let table = "time,body_displacement".to_string() + &(0..2000).map(line).collect::<String>();
        fs::write(folder.path().join(format!("rig/records/run_{run}.csv")), table).unwrap();
    }
    let checked = well(folder.path(), "check rig");
    assert!(checked.contains("ok"), "{checked}");
    let fitted: Value = serde_json::from_str(&well(folder.path(), "fit rig --format json")).unwrap();
    // The model has no range of the other spring, which keeps its value.
    for (name, truth) in [("k", 4990.0), ("c", 8.0), ("loose", 10.0)] {
        let value = fitted["parameters"][name]["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.01, "{name} is {value}");
    }
}

/// A sweep on one pad does not describe a car on two: each pad is an input.
#[test]
fn a_campaign_of_two_tyres_has_both_pads() {
    let folder = tempfile::tempdir().unwrap();
    let text = "axle two { \"A beam on two wheels\"
        known param m: kg = 800; known param a: m = 1.3; known param j: kg m^2 = 1200; param m_w: kg = 40 in 10..80; param k: N/m = 25e3 in 1e4..8e4;
        param c: N s/m = 1500 in 100..5e3; param kt: N/m = 2e5 in 1e5..4e5;
        direction z {
            road front_pad; road rear_pad; mass body = m; inertia pitch = j; mass front = m_w; mass rear = m_w;
            link front_tire: front - front_pad { spring kt; } link rear_tire: rear - rear_pad { spring kt; }
            link front_strut: body + a*pitch - front { spring k; damper c; }
            link rear_strut: body - a*pitch - rear { spring k; damper c; }
            output body.acceleration; output pitch.acceleration; output front.acceleration; output rear.acceleration;
        } }";
    fs::write(folder.path().join("two.axle"), text).unwrap();
    let said = well(folder.path(), "new campaign rig --model two.axle");
    assert!(
        said.contains("time,front_pad_acceleration,rear_pad_acceleration,body_acceleration,pitch_acceleration"),
        "{said}"
    );
    let manifest = fs::read_to_string(folder.path().join("rig/campaign.toml")).unwrap();
    assert!(
        manifest.contains(
            "location = \"pitch\"\nside = \"centre\"\naxis = \"z\"\nquantity = \"acceleration\"\nunit = \"rad/s^2\""
        ),
        "{manifest}"
    );
    assert!(
        manifest.contains("m = 800 # kg; as in the model, give yours\n"),
        "{manifest}"
    );
    assert!(manifest.contains("\n[parameters.m_w]\nvalue = 40\n"), "{manifest}");
}
