//! Plans and profiles: what a further sensor is expected to say is what a fit with it says, and intervals are those of
//! standard errors where the model is as linear as its Jacobian.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{copy, qcar_in, repository, run_line, succeeds};
use crate::document::{blocks, commands};

const AXLE: &str = "models/campaigns/axle_a_rig";

fn result(arguments: &[&str]) -> Value {
    let all: Vec<&str> = arguments.iter().copied().chain(["--format", "json"]).collect();
    serde_json::from_str(&succeeds(&all)).unwrap()
}

#[test]
fn the_commands_of_the_page_run() {
    let blocks = blocks("docs/plan.md");
    let commands: Vec<&str> = blocks.iter().flat_map(commands).collect();
    assert!(commands.len() >= 3, "{commands:?}");
    for command in commands {
        succeeds(&command.split_whitespace().collect::<Vec<_>>());
    }
}

/// The campaign without what the powertrain's sensor says along z: it is declared along x, where no sweep drives.
fn without_powertrain(to: &Path) {
    copy(Path::new(env!("CARGO_MANIFEST_DIR")).join(AXLE).as_path(), to);
    let file = to.join("campaign.toml");
    let text = fs::read_to_string(&file).unwrap();
    let (before, after) = text.split_once("name = \"pwt_centre_z\"").unwrap();
    let after = after.replacen("axis = \"z\"", "axis = \"x\"", 1);
    fs::write(&file, format!("{before}name = \"pwt_centre_z\"{after}")).unwrap();
}

/// The referee is the record of the sensor itself, which the plan has not seen.
#[test]
fn a_sensor_that_is_planned_gives_the_errors_that_it_is_expected_to() {
    let folder = tempfile::tempdir().unwrap();
    let less = folder.path().join("less");
    without_powertrain(&less);
    let plan = result(&["plan", less.to_str().unwrap()]);
    let further = plan["further"].as_array().unwrap();
    let named = |own: &&Value| own["what"] == "acceleration of pwt along z";
    let planned = further.iter().find(named).unwrap_or_else(|| panic!("{further:?}"));
    assert!(planned["rise"].as_f64().unwrap() > 0.0);
    let fit = result(&["fit", AXLE]);
    let mut moved = 0;
    for (name, expected) in planned["stderr"].as_object().unwrap() {
        let Some(expected) = expected.as_f64() else { continue };
        let found = fit["parameters"][name]["stderr"].as_f64().unwrap();
        let now = plan["parameters"][name]["stderr"].as_f64().unwrap();
        // A standard error is itself known to some percent, from residuals that are drawn once.
        assert!((expected / found - 1.0).abs() < 0.15, "{name}: {expected} and {found}");
        moved += i32::from((found / now - 1.0).abs() > 0.3);
    }
    assert!(moved >= 2, "the sensor changes nothing that could be foreseen: {plan}");
}

/// What nothing excites has the whole of its range for an error, and a run along that axis says most.
#[test]
fn what_is_not_known_at_all_is_to_be_measured_first() {
    let plan = result(&["plan", AXLE]);
    let first = &plan["further"][0];
    assert_eq!(first["what"], "a run driven by f_wheel_x", "{first}");
    assert_eq!(plan["parameters"]["k_pwt_x"]["stderr"], Value::Null);
    assert!(first["stderr"]["k_pwt_x"].as_f64().unwrap() > 0.0);
    let rises: Vec<f64> = plan["further"]
        .as_array()
        .unwrap()
        .iter()
        .map(|own| own["rise"].as_f64().unwrap())
        .collect();
    // Information adds up: nothing takes it away.
    assert!(
        rises.is_sorted_by(|a, b| a >= b) && rises.iter().all(|rise| *rise >= 0.0),
        "{rises:?}"
    );
    // Of the tyre's damping the band beyond the wheel's bounce says more than the same band once more.
    let asked = result(&["plan", AXLE, "--parameters", "c_tire"]);
    let of = |what: &str| {
        let all = asked["further"].as_array().unwrap().iter();
        let mut found = all.filter(|own| own["what"].as_str().unwrap().ends_with(what));
        found.next().unwrap()["rise"].as_f64().unwrap()
    };
    assert!(of("up to 60 Hz") > of("once more"), "{asked}");
}

#[test]
fn a_plan_is_the_same_every_time() {
    assert_eq!(succeeds(&["plan", AXLE]), succeeds(&["plan", AXLE]));
}

#[test]
fn what_cannot_be_planned_or_profiled_is_refused() {
    let folder = repository();
    let bent = "patch axle_a digressive_damper --at damper --out bent.axle";
    assert_eq!(run_line(folder.path(), bent).status, 0);
    for (line, said) in [
        ("plan AXLE --parameters k_tyre", "did you mean `k_tire`?"),
        ("fit AXLE --profile k_tyre", "did you mean `k_tire`?"),
        ("fit AXLE --profile c_wheel_x", "on which no fitted channel depends"),
        ("fit AXLE --model bent.axle --profile k_tyre", "did you mean `k_tire`?"),
        ("fit AXLE --all-runs --bootstrap 100", "use `--profile`"),
        ("fit AXLE --model bent.axle --bootstrap 100", "use `--profile`"),
        ("fit AXLE --bootstrap 99", "99 is not in 100..=1000000"),
    ] {
        let ran = run_line(folder.path(), &line.replace("AXLE", AXLE));
        assert_eq!((ran.status, ran.stdout.as_str()), (2, ""), "{line}");
        assert!(ran.stderr.contains(said), "{}", ran.stderr);
    }
}

/// The scatter, gains and measured differences of sides are in both; standard errors may have more, by the least
/// asymmetry.
#[test]
fn bootstrap_intervals_are_about_as_wide_as_standard_errors() {
    let arguments = ["fit", AXLE, "--bootstrap", "200", "--starts", "1"];
    let fit = result(&arguments);
    let found = &fit["bootstrap"];
    assert_eq!(
        (&found["resamples"], &found["failed"]),
        (&200.into(), &0.into()),
        "{found}"
    );
    let parameters = found["parameters"].as_array().unwrap();
    assert!(parameters.len() >= 10, "{parameters:?}");
    for own in parameters {
        let parameter = &fit["parameters"][own["name"].as_str().unwrap()];
        let [value, error] = ["value", "stderr"].map(|key| parameter[key].as_f64().unwrap());
        let [from, to] = [0, 1].map(|end| own["interval"][end].as_f64().unwrap());
        assert!(from < value && value < to, "{own}");
        let part = |of: &str| parameter["stderr_parts"][of].as_f64().unwrap();
        let least = part("scatter").hypot(part("gain"));
        let wide = own["stderr"].as_f64().unwrap();
        assert!((0.6 * least..1.3 * error).contains(&wide), "{own}: {least} to {error}");
    }
    let text = succeeds(&arguments);
    assert!(text.contains("95 % intervals by 200 fits to resamples\n"), "{text}");
}

/// Near its minimum the model is linear within these errors of a few percent, so that both intervals agree; an end of
/// the range within them leaves the interval open.
#[test]
fn profiles_are_as_wide_as_standard_errors_and_open_at_a_bound() {
    let fit = result(&["fit", AXLE, "--profile", "all", "--starts", "2"]);
    let profiles = fit["profiles"].as_array().unwrap();
    assert!(profiles.len() >= 10, "{profiles:?}");
    for own in profiles {
        let parameter = &fit["parameters"][own["name"].as_str().unwrap()];
        let [value, error] = ["value", "stderr"].map(|key| parameter[key].as_f64().unwrap());
        for (at, side) in [-1.0, 1.0].into_iter().enumerate() {
            let end = own["interval"][at].as_f64().unwrap();
            let wide = side * (end - value) / (1.96 * error);
            assert!((wide - 1.0).abs() < 0.1, "{own}: {wide}");
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let narrow = folder.path().join("narrow");
    copy(Path::new(env!("CARGO_MANIFEST_DIR")).join(AXLE).as_path(), &narrow);
    let file = narrow.join("campaign.toml");
    let text = fs::read_to_string(&file).unwrap();
    // The estimate of 136 N s/m has a standard error of 6.
    let text = text.replace("range = [32.4, 810.0]", "range = [32.4, 142.0]");
    fs::write(&file, text.replace("value = 162.0", "value = 130.0")).unwrap();
    let ran = qcar_in(&narrow, &["fit", ".", "--profile", "c_tire"]);
    assert_eq!(ran.status, 0, "{}", ran.stderr);
    assert!(
        ran.stdout.contains("open  no upper end within its range"),
        "{}",
        ran.stdout
    );
}
