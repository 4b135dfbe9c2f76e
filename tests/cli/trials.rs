//! Models and campaigns that once went wrong: masses by other names, two tyres, outputs that are missing, numbers that
//! are none.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{copy, refused, run_line};

const TRIALS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/trials");

/// The made campaign with this model, whose wheel is called so.
fn trial(model: &str, wheel: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    copy(Path::new(TRIALS), folder.path());
    edit(folder.path(), |text| {
        text.replace("MODEL", model).replace("WHEEL", wheel)
    });
    folder
}

fn edit(folder: &Path, change: impl Fn(&str) -> String) {
    let file = folder.join("campaign.toml");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(file, change(&text)).unwrap();
}

fn json(folder: &Path, line: &str) -> Value {
    let ran = run_line(folder, &format!("{line} --format json"));
    assert_eq!(ran.status, 0, "{line}\n{}", ran.stderr);
    serde_json::from_str(&ran.stdout).unwrap()
}

#[test]
fn a_bounce_curve_gives_the_spring_between_wheel_and_body_whatever_they_are_called() {
    for (model, wheel, spring) in [("quarter_car", "wheel", "k_wheel_z"), ("hub.axle", "hub", "k")] {
        let folder = trial(model, wheel);
        if model == "quarter_car" {
            let facts = "[vehicle]\nm_corner = 400\n";
            let values = [
                "m_wheel = 40",
                "k_wheel_z = 25e3",
                "c_wheel_z = 1500",
                "k_tire = 2e5",
                "c_tire = 100",
            ];
            edit(folder.path(), |text| {
                text.replace("[vehicle]\n", &format!("{facts}{}\n", values.join("\n")))
            });
        }
        let gradients = json(folder.path(), "kc .");
        // With body and wheel held, nothing else of these models can yield: the slope is the spring.
        assert_eq!(gradients[0]["parameter"], spring, "{gradients}");
        assert!(
            (gradients[0]["parameter_value"].as_f64().unwrap() - 31e3).abs() < 300.0,
            "{gradients}"
        );
    }
}

#[test]
fn the_mass_on_the_tyre_is_the_wheel() {
    let folder = trial("hub.axle", "hub");
    let found = json(folder.path(), "simulate .");
    let masses: Vec<&str> = found["runs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|run| run["mass"].as_str().unwrap())
        .collect();
    assert_eq!(masses, ["body", "hub"]);
}

#[test]
fn what_is_measured_and_no_output_is_said() {
    let folder = trial("explicit_output.axle", "wheel");
    let found = json(folder.path(), "simulate .");
    assert_eq!(found["runs"].as_array().unwrap().len(), 1);
    let said = found["notices"].to_string();
    assert!(
        said.contains("`wheel` along z") && said.contains("output wheel.acceleration;"),
        "{said}"
    );
    edit(folder.path(), |text| {
        text.replace("location = \"body\"", "location = \"cab\"")
    });
    let ran = run_line(folder.path(), "simulate .");
    refused(
        &ran,
        &[
            "cleat/c.csv",
            "`cab` along z",
            "`z_body_acceleration`",
            "name the channel's location",
        ],
    );
}

#[test]
fn a_model_on_two_tyres_is_not_driven_on_one() {
    let folder = trial("two_tyres.axle", "wheel_f");
    refused(
        &run_line(folder.path(), "simulate ."),
        &["2 tyres", "`tire_f` on `pad_f`", "`tire_r` on `pad_r`"],
    );
    let said = run_line(folder.path(), "kc .").stdout;
    assert!(
        said.contains("no parameter_value of the bounce stiffness: model `g_pitch` has 2 tyres"),
        "{said}"
    );
}

#[test]
fn a_campaign_may_name_the_body() {
    let folder = trial("cab.axle", "wheel");
    let cab = "axle cab {\n    param k: N/m = 25e3 in 1e3..1e6;\n    param k_cab: N/m = 90e3 in 1e3..1e6;\n    direction z {\n        \
               road pad;\n        mass cab = 120 kg;\n        mass frame = 300 kg;\n        mass wheel = 40 kg;\n        \
               link tire: wheel - pad { spring 200 N/mm; }\n        link strut: frame - wheel { spring k; }\n        \
               link mounts: cab - frame { spring k_cab; }\n    }\n}\n";
    fs::write(folder.path().join("cab.axle"), cab).unwrap();
    let open = json(folder.path(), "kc .");
    let why = open[0]["why_no_parameter_value"].as_str().unwrap();
    assert!(
        open[0]["parameter"].is_null() && why.contains("body = \"frame\""),
        "{why}"
    );
    // With the cab held instead of the frame, the mounts yield.
    for (body, value) in [("frame", 31e3), ("cab", 1.0 / (1.0 / 31e3 - 1.0 / 90e3))] {
        edit(folder.path(), |text| {
            text.split("[roles]").next().unwrap().trim_end().to_string()
        });
        edit(folder.path(), |text| format!("{text}\n\n[roles]\nbody = \"{body}\"\n"));
        let found = json(folder.path(), "kc .");
        assert_eq!(found[0]["parameter"], "k");
        let own = found[0]["parameter_value"].as_f64().unwrap();
        assert!((own / value - 1.0).abs() < 0.01, "{body}: {own}");
    }
    edit(folder.path(), |text| text.replace("body = \"cab\"", "body = \"trunk\""));
    let said = run_line(folder.path(), "kc .").stdout;
    assert!(
        said.contains("`roles`: found `trunk`") && said.contains("wheel, frame, cab"),
        "{said}"
    );
}

/// A tyre whose belt is a mass of its own. What is called the belt's record is that of the body, which peaks later.
#[test]
fn the_wheel_that_a_campaign_names_aligns_the_records() {
    let folder = trial("belt.axle", "hub");
    let belt = "axle belted {\n    direction z {\n        road pad;\n        mass body = 355 kg;\n        mass hub = 35 kg;\n        \
                mass belt = 10 kg;\n        link tire: belt - pad { spring 400 N/mm; damper 100 N s/m; }\n        \
                link carcass: hub - belt { spring 800 N/mm; damper 400 N s/m; }\n        \
                link strut: body - hub { spring 25 N/mm; damper 1500 N s/m; }\n    }\n}\n";
    fs::write(folder.path().join("belt.axle"), belt).unwrap();
    let of_hub = |location: &str, wheel: Option<&str>| {
        edit(folder.path(), |text| {
            let roles = wheel.map(|wheel| format!("\n[roles]\nwheel = \"{wheel}\"\n"));
            let text = text.split("\n[roles]").next().unwrap().to_string();
            let (head, tail) = text.split_once("location = \"").unwrap();
            let (_, tail) = tail.split_once('"').unwrap();
            format!("{head}location = \"{location}\"{tail}{}", roles.unwrap_or_default())
        });
        let found = json(folder.path(), "simulate .");
        let runs = found["runs"].as_array().unwrap();
        let own = runs.iter().find(|run| run["mass"] == "hub").unwrap();
        own["simulated_after_shake"].as_f64().unwrap()
    };
    let alone = of_hub("cab", None);
    assert_eq!(of_hub("belt", Some("hub")), alone);
    assert_ne!(of_hub("belt", Some("belt")), alone);
    // The mass nearest to the tyre is the wheel of a campaign that says nothing.
    assert_eq!(of_hub("belt", None), of_hub("belt", Some("belt")));
    edit(folder.path(), |text| {
        text.replace("wheel = \"belt\"", "wheel = \"rim\"")
    });
    for line in ["simulate .", "fit .", "study . --out o", "discover ."] {
        refused(
            &run_line(folder.path(), line),
            &["`roles`: found `rim`", "write one of belt, hub, body"],
        );
    }
}

#[test]
fn a_curve_without_slope_or_in_another_unit_is_refused() {
    let folder = trial("hub.axle", "hub");
    let file = folder.path().join("kc/bounce.csv");
    let text = fs::read_to_string(&file).unwrap();
    let scaled = |displacement: f64, force: f64| {
        let mut lines = text.lines();
        let head = lines.next().unwrap().to_string();
        let scale = |line: &str| {
            let (x, f) = line.split_once(',').unwrap();
            format!(
                "\n{},{}",
                x.parse::<f64>().unwrap() * displacement,
                f.parse::<f64>().unwrap() * force
            )
        };
        head + &lines.map(scale).collect::<String>() + "\n"
    };
    let cases = [
        (scaled(1.0, 0.0), "a force that does not increase with the displacement"),
        (
            scaled(1.0, -1.0),
            "a force that does not increase with the displacement",
        ),
        (scaled(1e3, 1.0), "found a stiffness of 31"),
        (scaled(1e-5, 1.0), "write displacements in m"),
    ];
    for (curve, said) in cases {
        fs::write(&file, curve).unwrap();
        refused(&run_line(folder.path(), "kc ."), &["kc/bounce.csv", said]);
    }
}

#[test]
fn check_refuses_what_every_use_would() {
    let folder = trial("hub.axle", "hub");
    for (model, said) in [
        ("sqrt_neg", "this is not a number"),
        ("huge_number", "this number is too large"),
    ] {
        let checked = run_line(folder.path(), &format!("check {model}.axle"));
        assert_eq!(checked.status, 1);
        assert!(checked.stdout.contains(said), "{}", checked.stdout);
    }
    // What only some values make is a matter of these, not of a flag that nobody gave.
    let text = fs::read_to_string(folder.path().join("hub.axle")).unwrap();
    let text = text.replace(
        "spring k; damper c;",
        "damper c; force = sqrt(k - 30000 N/m)*s*sqrt(k);",
    );
    fs::write(folder.path().join("some.axle"), text).unwrap();
    let ran = run_line(folder.path(), "matrices some.axle");
    assert!(
        ran.status == 2 && ran.stderr.starts_with("model mine, `parameters`"),
        "{}",
        ran.stderr
    );
}

/// Two masses, springs and dampers in a chain whose response stays the same if all are scaled together.
#[test]
fn what_outputs_cannot_tell_apart_stops_a_fit_alone() {
    let folder = trial("chain.axle", "b");
    let chain = "axle chain {\n    param m: kg = 40 in 10..90;\n    param k: N/m = 25e3 in 1e3..1e6;\n    \
                 param c: N s/m = 900 in 10..1e4;\n    direction z {\n        road pad;\n        mass body = m;\n        \
                 link strut: body - pad { spring k; damper c; }\n        \
                 channel pad_to_body = body.acceleration / pad.acceleration;\n    }\n}\n";
    fs::write(folder.path().join("chain.axle"), chain).unwrap();
    for line in ["matrices chain.axle", "frf chain.axle", "show chain.axle"] {
        let ran = run_line(folder.path(), line);
        assert_eq!(ran.status, 0, "{line}\n{}", ran.stderr);
    }
    let checked = run_line(folder.path(), "check chain.axle");
    assert!(
        checked.status == 0 && checked.stdout.contains("ok, with warnings"),
        "{}",
        checked.stdout
    );
    assert!(
        checked.stdout.contains("no output can distinguish `m`, `k` and `c`"),
        "{}",
        checked.stdout
    );
    let simulated = json(folder.path(), "simulate .");
    assert_eq!(simulated["runs"][0]["mass"], "body", "{simulated}");
    refused(
        &run_line(folder.path(), "fit ."),
        &["`m`, `k`, `c`, of which its outputs determine 2", "--fix"],
    );
}
