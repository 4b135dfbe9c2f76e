//! The verbs as a user runs them: what is printed, for people and for programs.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::process::{Command, Stdio};

use crate::common::{qcar, succeeds};
use crate::help::verbs;
use serde_json::Value;

#[test]
fn every_verb_explains_itself_with_an_example() {
    insta::assert_snapshot!("help", succeeds(&["--help"]));
    for verb in verbs() {
        let help = succeeds(&[&verb, "--help"]);
        assert!(help.contains("Example"), "{help}");
        insta::assert_snapshot!(format!("help_{verb}"), help);
    }
}

#[test]
fn matrices_of_a_quarter_car_are_those_of_the_textbook() {
    let json = parsed(&["matrices", "quarter_car", "--axis", "z", "--format", "json"]);
    let value = |name: &str| json["values"][name].as_f64().unwrap();
    let (m_wheel, m_body) = (value("m_wheel"), value("m_corner") - value("m_wheel"));
    let (k, c, k_tire, c_tire) = (value("k_wheel_z"), value("c_wheel_z"), value("k_tire"), value("c_tire"));
    let states = names(&json, "states", &["kind", "mass"]);
    let inputs = names(&json, "inputs", &["kind", "name"]);
    let entry = |matrix: &str, row: &str, columns: &[String], column: &str| {
        let place = |among: &[String], name: &str| among.iter().position(|n| n == name).unwrap();
        json[matrix][place(&states, row)][place(columns, column)]
            .as_f64()
            .unwrap()
    };
    let a = |row, column| entry("A", row, &states, column);
    let b = |row, column| entry("B", row, &inputs, column);
    close(a("velocity body", "position body"), -k / m_body);
    close(a("velocity body", "position wheel"), k / m_body);
    close(a("velocity body", "velocity body"), -c / m_body);
    close(a("velocity wheel", "position body"), k / m_wheel);
    close(a("velocity wheel", "position wheel"), -(k + k_tire) / m_wheel);
    close(a("velocity wheel", "velocity wheel"), -(c + c_tire) / m_wheel);
    close(a("position wheel", "velocity wheel"), 1.0);
    close(b("velocity wheel", "road pad"), k_tire / m_wheel);
    close(b("velocity wheel", "road_rate pad"), c_tire / m_wheel);
    close(b("velocity wheel", "force f_wheel_z"), 1.0 / m_wheel);
    close(b("velocity body", "gravity g"), -1.0);
}

#[test]
fn sensitivities_are_the_differences_of_the_matrices() {
    let at = |k: f64| {
        let set = format!("k_tire={k}");
        parsed(&["matrices", "quarter_car", "--set", &set, "--format", "json"])
    };
    let (low, high, middle) = (at(199e3), at(201e3), at(200e3));
    for matrix in ["A", "B", "C", "D"] {
        let rows = |json: &Value| -> Vec<f64> {
            json.as_array()
                .unwrap()
                .iter()
                .flat_map(|row| row.as_array().unwrap())
                .map(|v| v.as_f64().unwrap())
                .collect()
        };
        let slope = &middle[format!("d{matrix}")]["k_tire"];
        for ((low, high), slope) in rows(&low[matrix]).iter().zip(rows(&high[matrix])).zip(rows(slope)) {
            close((high - low) / 2e3, slope);
        }
    }
}

#[test]
fn a_value_that_another_parameter_takes_over_moves_both() {
    let folder = "tests/data/axle_a.toml";
    let tied = parsed(&[
        "matrices", "axle_a", "--params", folder, "--axis", "x", "--format", "json",
    ]);
    assert!(
        !tied["parameters"]
            .as_array()
            .unwrap()
            .contains(&"k_wheel_x_other".into())
    );
    let free = [
        "matrices",
        "axle_a",
        "--params",
        folder,
        "--axis",
        "x",
        "--format",
        "json",
        "--set",
        "k_wheel_x_other=471000",
    ];
    let free = parsed(&free);
    let sum = |json: &Value, name: &str| -> f64 {
        let rows = json["dA"][name].as_array().unwrap().iter();
        rows.flat_map(|row| row.as_array().unwrap())
            .map(|v| v.as_f64().unwrap().abs())
            .sum()
    };
    close(
        sum(&tied, "k_wheel_x"),
        sum(&free, "k_wheel_x") + sum(&free, "k_wheel_x_other"),
    );
}

#[test]
fn a_slow_road_carries_everything_along() {
    let json = parsed(&[
        "frf",
        "axle_d",
        "--params",
        "tests/data/axle_d.toml",
        "--frequencies",
        "1e-4:1e-4:1",
        "--format",
        "json",
    ]);
    let channels = json["channels"].as_object().unwrap();
    assert!(channels.len() > 8);
    for (name, channel) in channels.iter().filter(|(name, _)| !name.ends_with("_x")) {
        assert!((channel["re"][0].as_f64().unwrap() - 1.0).abs() < 1e-6, "{name}");
        assert!(channel["im"][0].as_f64().unwrap().abs() < 1e-6, "{name}");
    }
}

#[test]
fn derivatives_of_the_response_are_its_differences() {
    let at = |c: f64| {
        let set = format!("c_wheel_z={c}");
        parsed(&[
            "frf",
            "quarter_car",
            "--set",
            &set,
            "--frequencies",
            "1:20:9",
            "--format",
            "json",
        ])
    };
    let (low, high, middle) = (at(1499.0), at(1501.0), at(1500.0));
    for (name, channel) in middle["channels"].as_object().unwrap() {
        for (part, slope) in [("re", "d_re"), ("im", "d_im")] {
            for line in 0..9 {
                let of = |json: &Value| json["channels"][name][part][line].as_f64().unwrap();
                let difference = (of(&high) - of(&low)) / 2.0;
                let slope = channel[slope]["c_wheel_z"][line].as_f64().unwrap();
                assert!(
                    (difference - slope).abs() < 1e-9 + 1e-5 * slope.abs(),
                    "{name} {part}: {difference} {slope}"
                );
            }
        }
    }
}

#[test]
fn tables_for_people_stay_as_they_are() {
    insta::assert_snapshot!("matrices_quarter_car", succeeds(&["matrices", "quarter_car"]));
    insta::assert_snapshot!(
        "frf_quarter_car",
        succeeds(&["frf", "quarter_car", "--frequencies", "0.5:30:8"])
    );
    insta::assert_snapshot!("check_shipped", succeeds(&["check"]));
}

#[test]
fn csv_holds_the_numbers_of_json() {
    let command = [
        "frf",
        "quarter_car",
        "--channels",
        "pad_to_body",
        "--frequencies",
        "1:10:3",
    ];
    let csv = succeeds(&[&command[..], &["--format", "csv"]].concat());
    let channel = &parsed(&[&command[..], &["--format", "json"]].concat())["channels"]["pad_to_body"];
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("frequency [Hz],pad_to_body_re,pad_to_body_im"));
    for (at, line) in lines.enumerate() {
        let row: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let expected = ["frequency", "re", "im"].map(|part| channel[part][at].as_f64().unwrap());
        assert_eq!(row, expected);
    }
    assert_eq!(csv.lines().count(), 4);
}

#[test]
fn the_same_command_prints_the_same_bytes() {
    let command = [
        "frf",
        "axle_a",
        "--params",
        "tests/data/axle_a.toml",
        "--format",
        "json",
    ];
    assert_eq!(succeeds(&command), succeeds(&command));
}

#[test]
fn a_path_gives_the_same_numbers_as_the_name_of_the_shipped_model() {
    let rest = ["--params", "tests/data/axle_d.toml", "--format", "json"];
    for verb in ["matrices", "frf"] {
        let by_name = parsed(&[&[verb, "axle_d"], &rest[..]].concat());
        let by_path = parsed(&[&[verb, "models/axles/axle_d.axle"], &rest[..]].concat());
        alike(&by_name, &by_path, verb);
    }
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(["frf", "quarter_car", "--frequencies", "0.5:30:20000", "--format", "csv"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut errors = String::new();
    child.stderr.take().unwrap().read_to_string(&mut errors).unwrap();
    assert_eq!((child.wait().unwrap().code(), errors.as_str()), (Some(0), ""));
}

#[test]
fn every_member_of_the_family_passes_the_checks() {
    let said = succeeds(&["check", "--members", "models/families/corner.axle"]);
    assert_eq!(said, "models/families/corner.axle: 256 members, 0 refused\n");
}

#[test]
fn a_finding_has_its_own_exit_status() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("loose.axle");
    fs::write(&file, "axle loose { direction z { road pad; mass wheel = m; } }").unwrap();
    let ran = qcar(&["check", file.to_str().unwrap()]);
    assert_eq!(ran.status, 1, "{}{}", ran.stdout, ran.stderr);
    assert!(ran.stdout.contains("loose.axle"), "{}", ran.stdout);
}

fn parsed(arguments: &[&str]) -> Value {
    serde_json::from_str(&succeeds(arguments)).unwrap()
}

fn names(json: &Value, list: &str, keys: &[&str]) -> Vec<String> {
    let name = |entry: &Value| {
        keys.iter()
            .map(|key| entry[*key].as_str().unwrap())
            .collect::<Vec<_>>()
            .join(" ")
    };
    json[list].as_array().unwrap().iter().map(name).collect()
}

fn close(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= 1e-9 * expected.abs().max(1e-9),
        "found {found}, expected {expected}"
    );
}

/// Equal names, and numbers equal to twelve digits.
fn alike(a: &Value, b: &Value, place: &str) {
    match (a, b) {
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{place}");
            a.iter()
                .zip(b)
                .enumerate()
                .for_each(|(at, (a, b))| alike(a, b, &format!("{place}[{at}]")));
        }
        (Value::Object(a), Value::Object(b)) => {
            let keys = |of: &serde_json::Map<String, Value>| of.keys().cloned().collect::<Vec<_>>();
            assert_eq!(keys(a), keys(b), "{place}");
            let b: BTreeMap<_, _> = b.iter().collect();
            a.iter()
                .for_each(|(key, a)| alike(a, b[key], &format!("{place}.{key}")));
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            assert!((a - b).abs() <= 1e-12 * a.abs().max(b.abs()), "{place}: {a} and {b}");
        }
        (a, b) => assert_eq!(a, b, "{place}"),
    }
}

/// Channels of unlike kinds: of an angle, a force and an acceleration over a force, a moment and a position.
#[test]
fn channels_have_the_units_of_their_signals() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("unlike.axle");
    let text = r#"axle unlike {
        "A body that pitches on two springs"
        known param m: kg = 300;
        known param j: kg m^2 = 400;
        param k: N/m = 2e4 in 1e3..1e5 "Each spring";
        param arm: m = 1.2 in 0.5..2 "From the centre to each spring";
        direction z {
            road pad;
            mass body = m;
            inertia pitch = j;
            force lift on body;
            force turn on pitch;
            link front: body + arm*pitch - pad { spring k; damper 0.01 s*k; }
            link rear: body - arm*pitch { spring k; damper 0.01 s*k; }
            channel accelerance = body.acceleration / lift.force;
            channel turned = pitch.position / turn.force;
            channel transmitted = front.force / lift.force;
            channel nodding = pitch.acceleration / pad.position;
            channel pitching = pitch.acceleration / pad.acceleration;
            channel plain = body.acceleration / pad.acceleration;
        }
    }"#;
    std::fs::write(&path, text).unwrap();
    let frf = |format: &str| {
        let path = path.to_str().unwrap();
        crate::common::succeeds(&["frf", path, "--frequencies", "1:2:2", "--format", format])
    };
    let json: serde_json::Value = serde_json::from_str(&frf("json")).unwrap();
    let table = frf("text");
    for (channel, unit) in [
        ("accelerance", "(m/s^2)/N"),
        ("turned", "rad/(N m)"),
        ("transmitted", "1"),
        ("nodding", "(rad/s^2)/m"),
        ("pitching", "rad/m"),
        ("plain", "1"),
    ] {
        assert_eq!(json["channels"][channel]["unit"], unit, "{channel}");
        let heading = match unit {
            "1" => format!("{channel}_dB "),
            unit => format!("{channel}_dB re 1 {unit}"),
        };
        assert!(table.contains(&heading), "{table}");
    }
}
