//! Campaigns of time histories alone, as small as shows what is tested.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{qcar, refused, succeeds};

/// Samples of every record, and their rate in Hz.
const SAMPLES: usize = 1000;
pub const RATE: f64 = 200.0;

/// A mass of 2 kg on a spring of 800 N/m and a damper of 3 N s/m under a force, by steps far shorter than a sample.
fn mass(begin: [f64; 2], force: impl Fn(f64) -> f64) -> Vec<f64> {
    mass_for(SAMPLES, begin, force)
}

fn mass_for(count: usize, begin: [f64; 2], force: impl Fn(f64) -> f64) -> Vec<f64> {
    const FINER: usize = 50;
    let [m, c, k] = [2.0, 3.0, 800.0];
    let (h, [mut z, mut v]) = (1.0 / (RATE * FINER as f64), begin);
    let mut samples = Vec::new();
    for step in 0..count * FINER {
        if step % FINER == 0 {
            samples.push(z);
        }
        // Leapfrog with the damper taken at the middle of the step.
        let push = force((step as f64 + 0.5) * h);
        let middle = z + 0.5 * h * v;
        v += h * (push - k * middle - c * v) / (m + 0.5 * h * c);
        z = middle + 0.5 * h * v;
    }
    samples
}

/// Columns of a run, by the names of their channels.
pub type Columns<'a> = &'a [(&'a str, Vec<f64>)];

/// Writes a campaign of the shipped model of one mass: parameters and further keys of the runs as in `campaign.toml`,
/// and a run for each set of columns, the last of them held out where there are several.
pub fn campaign(folder: &Path, model: &str, parameters: &str, keys: &str, runs: &[Columns]) {
    let mut text = format!("format = 1\nname = \"c\"\nmodel = \"{model}\"\n\n{parameters}\n");
    for (name, location, quantity, unit) in [("push", "f", "force", "N"), ("z", "body", "displacement", "m")] {
        text += &format!(
            "[[channel]]\nname = \"{name}\"\nlocation = \"{location}\"\nside = \"centre\"\naxis = \"z\"\n\
             quantity = \"{quantity}\"\nunit = \"{unit}\"\n\n"
        );
    }
    for (place, columns) in runs.iter().enumerate() {
        let role = if place > 0 && place + 1 == runs.len() {
            "held_out"
        } else {
            "fit"
        };
        text += &format!(
            "[[run]]\nkind = \"time_history\"\nfile = \"run_{place}.csv\"\nrole = \"{role}\"\nsample_rate = {RATE}\n{keys}\n\n"
        );
        let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
        let mut table = format!("time,{}\n", names.join(","));
        for sample in 0..columns[0].1.len() {
            let row: Vec<String> = columns.iter().map(|(_, values)| values[sample].to_string()).collect();
            table += &format!("{},{}\n", sample as f64 / RATE, row.join(","));
        }
        fs::write(folder.join(format!("run_{place}.csv")), table).unwrap();
    }
    fs::write(folder.join("campaign.toml"), text).unwrap();
}

pub fn parameter(name: &str, value: f64, unit: &str, range: &str) -> String {
    format!("[parameters.{name}]\nvalue = {value:?}\nunit = \"{unit}\"\n{range}fit = true\n\n")
}

/// A force that is held between samples.
fn push(t: f64) -> f64 {
    let sample = (t * RATE).floor() / RATE;
    (7.0 * sample).sin() + (23.0 * sample).sin() + (41.0 * sample).cos()
}

/// A record of the pushed mass.
pub fn pushed() -> Vec<(&'static str, Vec<f64>)> {
    let force = (0..SAMPLES).map(|k| push((k as f64 + 0.5) / RATE)).collect();
    vec![("push", force), ("z", mass([0.0, 0.0], push))]
}

/// A campaign of one record of the shipped model of one mass, with inputs that are held between samples.
fn recorded_campaign(folder: &Path, parameters: &str, columns: Columns) {
    campaign(folder, "one_mass", parameters, "band_limited = false", &[columns]);
}

/// A campaign of one record of the pushed mass.
fn pushed_campaign(folder: &Path, model: &str, parameters: &str) {
    campaign(folder, model, parameters, "band_limited = false", &[&pushed()]);
}

fn discovered(campaign: &str) -> Value {
    serde_json::from_str(&succeeds(&["discover", campaign, "--format", "json"])).unwrap()
}

/// What a search with results in `out` has printed, and its answer.
fn discovered_into(out: &Path, campaign: &str) -> (String, Value) {
    let said = succeeds(&["discover", campaign, "--out", out.to_str().unwrap()]);
    let answer = fs::read_to_string(out.join("discovery.json")).unwrap();
    (said, serde_json::from_str(&answer).unwrap())
}

/// Every verb that estimates must say so rather than leave such a parameter at its start.
#[test]
fn what_is_to_be_fitted_without_any_range_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = fs::read_to_string("models/axles/one_mass.axle").unwrap();
    fs::write(folder.path().join("open.axle"), shipped.replace(" in 1e-9..1e9", "")).unwrap();
    let [mass, spring] = [("m_body", 2.0, "kg"), ("k_body", 700.0, "N/m")]
        .map(|(name, value, unit)| parameter(name, value, unit, "range = [0.5, 2000.0]\n"));
    let parameters = format!("{mass}{}{spring}", parameter("c_body", 2.0, "N s/m", ""));
    let path = folder.path().to_str().unwrap();
    pushed_campaign(folder.path(), "./open.axle", &parameters);
    let line = fs::read_to_string(folder.path().join("campaign.toml")).unwrap();
    let line = 1 + line.lines().position(|line| line == "[parameters.c_body]").unwrap();
    for verb in ["fit", "discover", "study"] {
        let out = folder.path().join("out");
        let more: &[&str] = if verb == "study" {
            &["--out", out.to_str().unwrap()]
        } else {
            &[]
        };
        let ran = qcar(&[&[verb, path], more].concat());
        assert_eq!((ran.status, ran.stdout.as_str()), (2, ""), "{verb}");
        let said = format!("campaign.toml, line {line}, column 13, `parameters.c_body`");
        for said in [&said, "`range = [lower, upper]`", "`fit = false`"] {
            assert!(
                ran.stderr.contains(said),
                "{verb}: expected `{said}` in\n{}",
                ran.stderr
            );
        }
    }
    assert_eq!(qcar(&["fit", path, "--fix", "c_body", "--starts", "1"]).status, 0);
    // The shipped model has ranges of its own.
    pushed_campaign(folder.path(), "one_mass", &parameters);
    let ran = qcar(&["discover", path, "--out", folder.path().join("found").to_str().unwrap()]);
    assert_eq!(ran.status, 0, "{}", ran.stderr);
    let found = fs::read_to_string(folder.path().join("found/parameters.toml")).unwrap();
    let found = found.lines().find_map(|line| line.strip_prefix("c_body = ")).unwrap();
    assert!((found.parse::<f64>().unwrap() - 3.0).abs() < 0.03, "{found}");
}

/// Without noise, mass and stiffness are as uncertain as the gains of the two sensors, 0.7 % each, and the range of the
/// damping is no matter for its value.
#[test]
fn gains_of_input_and_output_limit_what_a_record_determines() {
    let folder = tempfile::tempdir().unwrap();
    let parameters = parameter("m_body", 2.0, "kg", "range = [0.5, 2000.0]\n")
        + &parameter("c_body", 2.0, "N s/m", "range = [1e-9, 1e9]\n")
        + &parameter("k_body", 700.0, "N/m", "range = [0.5, 2000.0]\n");
    pushed_campaign(folder.path(), "one_mass", &parameters);
    let line = ["fit", folder.path().to_str().unwrap(), "--all-runs", "--starts", "1"];
    let fit: Value = serde_json::from_str(&succeeds(&[&line[..], &["--format", "json"]].concat())).unwrap();
    for (name, truth) in [("m_body", 2.0), ("c_body", 3.0), ("k_body", 800.0)] {
        let own = &fit["parameters"][name];
        let [value, error] = ["value", "stderr"].map(|key| own[key].as_f64().unwrap());
        assert!((value / truth - 1.0).abs() < 1e-4, "{name}: {own}");
        let expected = 0.007 * 2_f64.sqrt();
        assert!((error / value / expected - 1.0).abs() < 0.05, "{name}: {own}");
    }
    // With all of them known there is no search that could converge.
    let known = succeeds(&[&line[..], &["--fix", "m_body,c_body,k_body"]].concat());
    assert!(
        known.contains("no parameter was free") && !known.contains("1 start,"),
        "{known}"
    );
    assert!(
        known.contains("these values are wrong, or the model lacks something"),
        "{known}"
    );
}

const TRUTH: [(&str, f64, &str); 3] = [
    ("m_body", 2.0, "kg"),
    ("c_body", 3.0, "N s/m"),
    ("k_body", 800.0, "N/m"),
];

/// The true mass, whose parameters no fit changes.
fn all_known() -> String {
    let stated = TRUTH.map(|(name, value, unit)| parameter(name, value, unit, ""));
    stated.concat().replace("true", "false")
}

/// A campaign of a mass that starts in motion, which transmissibilities take for a response to the force.
fn moving_campaign(folder: &Path) {
    let start = |(name, value, unit): &(&str, f64, &str)| parameter(name, 0.8 * value, unit, "");
    let parameters: String = TRUTH.iter().map(start).collect();
    let force = (0..SAMPLES).map(|k| push((k as f64 + 0.5) / RATE)).collect();
    let columns = [("push", force), ("z", mass([0.02, -0.4], push))];
    recorded_campaign(folder, &parameters, &columns);
}

/// A fit to the samples finds the start of the motion too. Channels are only those of transmissibilities, so that
/// naming one asks for them.
#[test]
fn a_linear_model_is_fitted_to_the_samples_of_time_histories_alone() {
    let folder = tempfile::tempdir().unwrap();
    moving_campaign(folder.path());
    let path = folder.path().to_str().unwrap();
    let fit = |more: &[&str]| -> Value {
        let words = [&["fit", path, "--starts", "1", "--format", "json"], more].concat();
        serde_json::from_str(&succeeds(&words)).unwrap()
    };
    let (of_samples, of_channel) = (fit(&[]), fit(&["--channels", "f_to_body"]));
    for (name, truth, _) in TRUTH {
        let error = |fitted: &Value| (fitted["parameters"][name]["value"].as_f64().unwrap() / truth - 1.0).abs();
        assert!(error(&of_samples) < 1e-3, "{name}: {of_samples}");
        assert!(error(&of_channel) > 1e-3, "{name}: {of_channel}");
    }
}

/// A direction may have any name, and so may the axis of a sensor.
#[test]
fn a_sensor_measures_along_any_direction_of_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    moving_campaign(folder.path());
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/axles/one_mass.axle");
    let model = fs::read_to_string(shipped).unwrap();
    let model = model.replace("direction z", "direction lateral");
    fs::write(folder.path().join("lateral.axle"), model).unwrap();
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let (model, along) = ("model = \"one_mass\"", "axis = \"z\"");
    let text = text.replace(model, "model = \"lateral.axle\"");
    fs::write(&manifest, text.replace(along, "axis = \"lateral\"")).unwrap();
    let fit: Value = serde_json::from_str(&succeeds(&["fit", path, "--starts", "1", "--format", "json"])).unwrap();
    for (name, truth, _) in TRUTH {
        let value = fit["parameters"][name]["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 1e-3, "{name}: {fit}");
    }
    // The same sensors along a direction that the model lacks are told.
    fs::write(&manifest, text.replace(along, "axis = \"lateral_2\"")).unwrap();
    let checked = qcar(&["check", path]);
    let told = "no displacement of `body` along lateral_2";
    assert!(checked.stdout.contains(told), "{}", checked.stdout);
}

/// What `qcar check` proposes is what the language has: a displacement is the stretch of a link.
#[test]
fn a_proposed_output_is_one_of_the_language() {
    let folder = tempfile::tempdir().unwrap();
    moving_campaign(folder.path());
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, text.replace("location = \"body\"", "location = \"damper\"")).unwrap();
    let checked = qcar(&["check", folder.path().to_str().unwrap()]);
    let proposed = "add `output damper.stretch;` to the model";
    assert!(checked.stdout.contains(proposed), "{}", checked.stdout);
}

/// Every verb that fits uses the values of `qcar fit`.
#[test]
fn score_compare_and_study_fit_the_samples_of_time_histories_alone() {
    let folder = tempfile::tempdir().unwrap();
    moving_campaign(folder.path());
    let path = folder.path().to_str().unwrap();
    let truth = TRUTH.map(|(name, value, _)| format!("{name} = {value:?}\n")).concat();
    fs::write(folder.path().join("truth.toml"), format!("[parameters]\n{truth}")).unwrap();
    let score = succeeds(&["score", path, "--within", "0.1"]);
    assert_eq!(score.matches(" well").count(), TRUTH.len(), "{score}");
    let compared: Value = serde_json::from_str(&succeeds(&["compare", path, path, "--format", "json"])).unwrap();
    for ((name, truth, _), own) in TRUTH.iter().zip(compared["parameters"].as_array().unwrap()) {
        let value = own["a"].as_f64().unwrap();
        assert!(
            own["name"] == *name && (value / truth - 1.0).abs() < 1e-3,
            "{name}: {own}"
        );
    }
    let out = folder.path().join("out");
    succeeds(&["study", path, "--out", out.to_str().unwrap()]);
    let fit: Value = serde_json::from_str(&fs::read_to_string(out.join("fit/fit.json")).unwrap()).unwrap();
    for (name, truth, _) in TRUTH {
        let value = fit["parameters"][name]["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 1e-3, "{name}: {fit}");
    }
}

/// A campaign of a mass that is let go, or struck: nothing drives it, and no sensor shows how fast it is at first.
fn decaying_campaign(folder: &Path) {
    let parameters = parameter("c_body", 2.0, "N s/m", "range = [0.5, 20.0]\n")
        + &parameter("k_body", 700.0, "N/m", "range = [100.0, 2000.0]\n")
        + &parameter("m_body", 2.0, "kg", "").replace("true", "false");
    let decay = |begin| vec![("z", mass(begin, |_| 0.0))];
    let runs = [decay([0.02, 0.3]), decay([-0.03, 0.1]), decay([0.0, -0.5])];
    let runs: Vec<Columns> = runs.iter().map(Vec::as_slice).collect();
    campaign(folder, "one_mass", &parameters, "band_limited = false", &runs);
}

/// They have no transmissibilities, and every verb that fits works without.
#[test]
fn score_compare_and_study_fit_free_decays() {
    let folder = tempfile::tempdir().unwrap();
    decaying_campaign(folder.path());
    let path = folder.path().to_str().unwrap();
    fs::write(
        folder.path().join("truth.toml"),
        "[parameters]\nc_body = 3.0\nk_body = 800.0\n",
    )
    .unwrap();
    let score = succeeds(&["score", path, "--within", "0.2"]);
    assert_eq!(score.matches(" well").count(), 2, "{score}");
    let compared: Value = serde_json::from_str(&succeeds(&["compare", path, path, "--format", "json"])).unwrap();
    let out = folder.path().join("out");
    let study = succeeds(&["study", path, "--out", out.to_str().unwrap()]);
    assert!(!study.contains("rig_fit") && study.contains("report.html"), "{study}");
    let fit: Value = serde_json::from_str(&fs::read_to_string(out.join("fit/fit.json")).unwrap()).unwrap();
    for (name, truth) in [("c_body", 3.0), ("k_body", 800.0)] {
        let of_study = fit["parameters"][name]["value"].as_f64().unwrap();
        let own = compared["parameters"]
            .as_array()
            .unwrap()
            .iter()
            .find(|own| own["name"] == name);
        let of_comparison = own.unwrap()["a"].as_f64().unwrap();
        for value in [of_study, of_comparison] {
            assert!((value / truth - 1.0).abs() < 2e-3, "{name}: {value}, not {truth}");
        }
    }
}

/// The model outputs the position of the mass and not its acceleration, so a record has no further sensor. A run once
/// more at most doubles the information.
#[test]
fn a_plan_proposes_to_repeat_free_decays() {
    let folder = tempfile::tempdir().unwrap();
    decaying_campaign(folder.path());
    let words = ["plan", folder.path().to_str().unwrap(), "--format", "json"];
    let plan: Value = serde_json::from_str(&succeeds(&words)).unwrap();
    let further = plan["further"].as_array().unwrap();
    for run in ["run_0.csv once more", "run_1.csv once more"] {
        let repeated = further.iter().find(|own| own["what"] == run);
        let repeated = repeated.unwrap_or_else(|| panic!("no {run}: {plan}"));
        for name in ["c_body", "k_body"] {
            let now = plan["parameters"][name]["stderr"].as_f64().unwrap();
            let then = repeated["stderr"][name].as_f64().unwrap();
            assert!(then < now && then > 0.7 * now, "{run}, {name}: {now}, then {then}");
        }
    }
    assert!(further.iter().all(|own| own["kind"] != "sensor"), "{plan}");
}

/// Nothing can drive this model, and every verb replays its decays.
#[test]
fn a_model_without_inputs_decays_freely() {
    let folder = tempfile::tempdir().unwrap();
    decaying_campaign(folder.path());
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, text.replace("model = \"one_mass\"", "model = \"free.axle\"")).unwrap();
    fs::write(folder.path().join("free.axle"), FREE).unwrap();
    let path = folder.path().to_str().unwrap();
    let fit: Value = serde_json::from_str(&succeeds(&["fit", path, "--format", "json"])).unwrap();
    for (name, truth) in [("c_body", 3.0), ("k_body", 800.0)] {
        let value = fit["parameters"][name]["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 2e-3, "{name}: {fit}");
    }
    succeeds(&["simulate", path]);
    let (found, answer) = discovered_into(&folder.path().join("out"), path);
    assert_eq!(answer["verdict"], "none", "{found}");
    assert!(!found.contains("no input"), "{found}");
}

const FREE: &str = "axle free {
    \"A mass on a spring and a damper\"
    known param m_body: kg = 2 in 0.1..10 \"Mass\";
    param c_body: N s/m = 2 in 0.5..20 \"Damper\";
    param k_body: N/m = 700 in 100..2000 \"Spring\";
    direction z {
        mass body = m_body;
        link own: body { spring k_body; damper c_body; }
        output body.position;
    }
}
";

/// The truth is 3 N s/m. An effect that damps less would make up for the range.
#[test]
fn a_range_that_excludes_the_truth_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let parameters = parameter("m_body", 2.0, "kg", "").replace("true", "false")
        + &parameter("c_body", 6.0, "N s/m", "range = [4.0, 20.0]\n")
        + &parameter("k_body", 700.0, "N/m", "range = [100.0, 2000.0]\n");
    pushed_campaign(folder.path(), "one_mass", &parameters);
    let answer = discovered(folder.path().to_str().unwrap());
    assert_eq!(answer["verdict"], "none", "{answer}");
    let told =
        "c_body = 3 N s/m explains the data better than any value in its range in the campaign, 4 N s/m to 20 N s/m";
    assert!(answer["notices"].to_string().contains(told), "{answer}");
}

/// No sensor shows where the mass begins, and a model that begins at rest never reaches the stop. The same motion a
/// thousand times smaller has a gap of 5 µm.
#[test]
fn accelerometers_show_a_stop_in_free_decays() {
    for size in [1.0, 1e-3] {
        assert_stop_is_found(size);
    }
}

fn assert_stop_is_found(size: f64) {
    let folder = tempfile::tempdir().unwrap();
    let parameters = parameter("c_body", 2.0, "N s/m", "") + &parameter("k_body", 700.0, "N/m", "");
    let runs = [[0.02, 0.3], [-0.025, 0.1], [0.03, -0.5]].map(|begin| {
        let samples = with_stop(begin).into_iter().map(|value| size * value);
        vec![("z", samples.collect())]
    });
    let runs: Vec<Columns> = runs.iter().map(Vec::as_slice).collect();
    campaign(folder.path(), "free.axle", &parameters, "band_limited = false", &runs);
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let measured = text.replace("\"displacement\"\nunit = \"m\"", "\"acceleration\"\nunit = \"m/s²\"");
    fs::write(&manifest, measured).unwrap();
    let model = FREE.replace("body.position", "body.acceleration");
    fs::write(folder.path().join("free.axle"), model).unwrap();
    let (found, answer) = discovered_into(&folder.path().join("out"), folder.path().to_str().unwrap());
    assert_eq!(answer["verdict"], "found", "{found}");
    let [stop] = &answer["effects"].as_array().unwrap()[..] else {
        panic!("{found}");
    };
    assert_eq!(stop["name"], "bump_stop", "{found}");
    for (name, truth) in [("gap", size * 0.005), ("k_stop", 3000.0)] {
        let value = stop["parameters"][name].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.01, "{name} = {value}\n{found}");
    }
}

/// Accelerations of a mass on a spring and a light damper, with a stop at 5 mm of compression.
fn with_stop(begin: [f64; 2]) -> Vec<f64> {
    const FINER: usize = 200;
    let h = 1.0 / (RATE * FINER as f64);
    let acceleration = |z: f64, v: f64| (-800.0 * z - v - 3000.0 * (z + 0.005).min(0.0)) / 2.0;
    let [mut z, mut v] = begin;
    let mut samples = Vec::new();
    for step in 0..400 * FINER {
        if step % FINER == 0 {
            samples.push(acceleration(z, v));
        }
        let [z_middle, v_middle] = [z + 0.5 * h * v, v + 0.5 * h * acceleration(z, v)];
        z += h * v_middle;
        v += h * acceleration(z_middle, v_middle);
    }
    samples
}

/// A disc on a shaft that a motor turns, with an encoder for its speed and dry friction in its bearing. Effects apply to
/// an angle as to a travel.
#[test]
fn friction_of_a_part_that_turns_is_named() {
    let shaft = "link shaft: disc { spring 8 N m/rad; damper c; }";
    let friction = |angle: f64, speed: f64| 8.0 * angle + 0.03 * speed + 0.12 * (speed / 2e-3_f64).tanh();
    let folder = turning(shaft, 0.5, friction);
    let (found, answer) = discovered_into(&folder.path().join("out"), folder.path().to_str().unwrap());
    is_effect(&answer, ("coulomb_friction", "shaft"), &[("f_coulomb", 0.12)]);
    assert!(
        found.contains("f_coulomb  N m ") && answer["offsets"][0]["unit"] == "rad/s",
        "{found}"
    );
    // A force is no moment.
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(
        &manifest,
        text.replace("\"N m\"\n\n[[channel]]", "\"N\"\n\n[[channel]]"),
    )
    .unwrap();
    let said = ["channel push", "unit of its input", "write `unit = \"N m\"`"];
    refused(&qcar(&["check", folder.path().to_str().unwrap()]), &said);
    fs::write(&manifest, text).unwrap();
    // `1/min` does not say whether it counts revolutions.
    let records = folder.path().join("run_0.csv");
    let table = fs::read_to_string(&records).unwrap();
    fs::write(&records, table.replace("[deg/s]", "[1/min]")).unwrap();
    let said = ["run_0.csv, line 1, column `z`", "\"1/min\"", "\"rpm\""];
    refused(&qcar(&["check", folder.path().to_str().unwrap()]), &said);
}

/// A disc that turns by several revolutions, with a weight beside its axis. Its speed does not tell where the weight is.
#[test]
fn an_unbalance_is_named() {
    let weight = |angle: f64, speed: f64| 0.03 * speed + 0.6 * (angle + 0.8).sin();
    let folder = turning("link bearing: disc { damper c; }", 8.0, weight);
    let (_, answer) = discovered_into(&folder.path().join("out"), folder.path().to_str().unwrap());
    is_effect(&answer, ("unbalance", "disc"), &[("t_weight", 0.6)]);
}

/// Of a part that turns, the detection limits are moments.
#[test]
fn nothing_is_missing_in_a_part_that_turns() {
    let shaft = "link shaft: disc { spring 8 N m/rad; damper c; }";
    let folder = turning(shaft, 0.5, |angle, speed| 8.0 * angle + 0.03 * speed);
    let (said, answer) = discovered_into(&folder.path().join("out"), folder.path().to_str().unwrap());
    assert_eq!(answer["verdict"], "none", "{said}");
    let limit = said.lines().find(|line| line.starts_with("coulomb_friction "));
    let limit = limit.unwrap_or_else(|| panic!("{said}"));
    assert!(
        limit.contains(" N m, k_presliding ") && limit.ends_with(" N m/rad"),
        "{limit}"
    );
}

/// The shaft holds the disc only beyond 0.03 rad to either side.
#[test]
fn backlash_is_named() {
    let beyond = |angle: f64| (angle - 0.03).max(0.0) + (angle + 0.03).min(0.0);
    let shaft = "link shaft: disc { spring 8 N m/rad; damper c; }";
    let folder = turning(shaft, 0.5, |angle, speed| 8.0 * beyond(angle) + 0.03 * speed);
    let (_, answer) = discovered_into(&folder.path().join("out"), folder.path().to_str().unwrap());
    is_effect(&answer, ("backlash", "shaft"), &[("gap", 0.06)]);
}

/// A disc on a wire swings freely. The ranges of effects follow from its motion: the friction is far below a
/// usual force.
#[test]
fn friction_of_a_free_decay_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let model = MODEL.replace("        force motor on disc;\n", "");
    let wire = "link wire: disc { spring 0.8 N m/rad; }\n        link air: disc { damper c; }";
    let moment = |angle: f64, speed: f64| 0.8 * angle + 0.002 * speed + 0.015 * (speed / 2e-3_f64).tanh();
    let runs = [1.0, 0.7, 0.8].map(|angle| vec![("z [deg/s]", disc(angle, |_| 0.0, moment))]);
    write_turning(folder.path(), &model.replace("LINK", wire), 0.005, &runs);
    let (_, answer) = discovered_into(&folder.path().join("out"), folder.path().to_str().unwrap());
    is_effect(&answer, ("coulomb_friction", "air"), &[("f_coulomb", 0.015)]);
}

/// That this effect is found alone, with values within 3 % of the truth.
fn is_effect(answer: &Value, (name, place): (&str, &str), truth: &[(&str, f64)]) {
    assert_eq!(answer["verdict"], "found", "{answer}");
    let [effect] = &answer["effects"].as_array().unwrap()[..] else {
        panic!("{answer}");
    };
    assert_eq!(
        (&effect["name"], &effect["at"]),
        (&name.into(), &place.into()),
        "{answer}"
    );
    for (name, truth) in truth {
        let value = effect["parameters"][name].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.03, "{name} = {value}\n{effect}");
    }
}

const MODEL: &str = "axle turning {
    \"A disc\"
    param c: N m s/rad = 0.05 in 1e-4..1;
    direction phi {
        inertia disc = 0.02 kg m^2;
        force motor on disc;
        LINK
        output disc.velocity;
    }
}
";

/// A campaign of a disc of 0.02 kg m² on a `link` with the unknown damping `c`, which a torque of this size (N m) turns
/// against a moment that depends on angle and speed.
fn turning(link: &str, size: f64, moment: impl Fn(f64, f64) -> f64) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let runs = [1.0, 1.6, 0.6].map(|level| {
        let torque = |t: f64| size * level * push(t);
        let given = (0..SAMPLES).map(|k| torque((k as f64 + 0.5) / RATE)).collect();
        vec![("push", given), ("z [deg/s]", disc(0.0, torque, &moment))]
    });
    write_turning(folder.path(), &MODEL.replace("LINK", link), 0.05, &runs);
    folder
}

/// Writes the model and the campaign of a disc with these records. The damping starts at `c` N m s/rad.
fn write_turning(folder: &Path, model: &str, c: f64, runs: &[Vec<(&str, Vec<f64>)>]) {
    fs::write(folder.join("turning.axle"), model).unwrap();
    let runs: Vec<Columns> = runs.iter().map(Vec::as_slice).collect();
    let damping = parameter("c", c, "N m s/rad", "range = [0.0001, 1.0]\n");
    campaign(folder, "turning.axle", &damping, "band_limited = false", &runs);
    let manifest = folder.join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let turned = text
        .replace("axis = \"z\"", "axis = \"phi\"")
        .replace("\"f\"", "\"motor\"")
        .replace("unit = \"N\"", "unit = \"N m\"")
        .replace("\"body\"", "\"disc\"")
        .replace("\"displacement\"\nunit = \"m\"", "\"velocity\"\nunit = \"rad/s\"");
    fs::write(&manifest, turned).unwrap();
}

/// Speed of the disc in deg/s from an angle at rest, by the semi-implicit Euler method in fine steps.
fn disc(mut angle: f64, torque: impl Fn(f64) -> f64, moment: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    const FINER: usize = 400;
    let h = 1.0 / (RATE * FINER as f64);
    let (mut speed, mut samples) = (0.0_f64, Vec::new());
    for step in 0..SAMPLES * FINER {
        if step % FINER == 0 {
            samples.push(speed.to_degrees());
        }
        speed += h * (torque(step as f64 * h) - moment(angle, speed)) / 0.02;
        angle += h * speed;
    }
    samples
}

/// Of a model that nothing excites, a free decay shows what it shows of others.
#[test]
fn effects_apply_to_a_model_without_inputs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("glider.axle");
    let links = "link wire: body { spring k_body; }\n        link air: body { damper c_body; }";
    let model = FREE.replace("link own: body { spring k_body; damper c_body; }", links);
    fs::write(&path, model).unwrap();
    for effect in ["coulomb_friction", "segmented_polynomial_damper"] {
        let patched = succeeds(&["patch", path.to_str().unwrap(), effect, "--at", "air"]);
        assert!(patched.contains(&format!("free_with_{effect}")), "{patched}");
    }
}

/// No sensor shows how fast it is at first.
#[test]
fn a_record_that_starts_in_motion_needs_no_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    decaying_campaign(folder.path());
    let (found, answer) = discovered_into(&folder.path().join("out"), path);
    assert_eq!(answer["verdict"], "none", "{answer}");
    for role in ["fit", "held_out"] {
        let gap = answer["gap"][role]["before"].as_f64().unwrap();
        assert!(gap < 0.1, "{role}: {gap}");
    }
    assert!(answer["notices"].to_string().contains("no input"), "{answer}");
    let values = fs::read_to_string(folder.path().join("out/parameters.toml")).unwrap();
    for (name, truth) in [("c_body", 3.0), ("k_body", 800.0)] {
        let own = values.lines().find_map(|line| line.strip_prefix(&format!("{name} = ")));
        let value: f64 = own.unwrap().split('#').next().unwrap().trim().parse().unwrap();
        assert!((value / truth - 1.0).abs() < 0.002, "{name} = {value}\n{found}");
    }
}

/// Of the sensor where the model has none; a force that shifts the mass for good is the same to every sensor.
#[test]
fn an_offset_is_told_and_counted_once() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path().to_str().unwrap(), folder.path().join("out"));
    let known = parameter("m_body", 2.0, "kg", "").replace("true", "false");
    let parameters = known
        + &parameter("c_body", 2.0, "N s/m", "range = [0.5, 20.0]\n")
        + &parameter("k_body", 700.0, "N/m", "range = [100.0, 2000.0]\n");
    let mut columns = pushed();
    columns[1].1.iter_mut().for_each(|z| *z += 2e-4);
    recorded_campaign(folder.path(), &parameters, &columns);
    let (said, answer) = discovered_into(&out, path);
    let own = &answer["offsets"][0];
    assert_eq!((&own["channel"], &own["unit"]), (&"body_z".into(), &"m".into()));
    let (offset, error) = (own["offset"].as_f64().unwrap(), own["stderr"].as_f64().unwrap());
    assert!((offset - 2e-4).abs() < 3.0 * error && error < 4e-5, "{own}");
    assert!(said.contains("zero offsets of the sensors of records"), "{said}");
    let file = fs::read_to_string(out.join("parameters.toml")).unwrap();
    assert!(file.contains("# offset of body_z displacement: "), "{file}");
    let parameters = parameters + &parameter("f_offset", 0.0, "N", "range = [-10.0, 10.0]\n");
    recorded_campaign(folder.path(), &parameters, &columns);
    let answer = discovered(path);
    assert_eq!(answer["offsets"], serde_json::json!([]), "{answer}");
    assert!(
        answer["notices"]
            .to_string()
            .contains("the parameter `f_offset` acts like an offset of this sensor"),
        "{answer}"
    );
}

/// Two runs of the true mass, the second from a start in motion: nothing is left of either, and 5 % of a spring shows.
#[test]
fn records_are_replayed_and_what_is_left_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path().to_str().unwrap(), folder.path().join("out"));
    let parameters = all_known();
    let moving: Vec<(&str, Vec<f64>)> = vec![pushed().remove(0), ("z", mass([0.02, 0.2], push))];
    campaign(
        folder.path(),
        "one_mass",
        &parameters,
        "band_limited = false",
        &[&pushed(), &moving],
    );
    let simulated = |more: &[&str]| -> Value {
        let arguments = [&["simulate", path, "--format", "json"], more].concat();
        serde_json::from_str(&succeeds(&arguments)).unwrap()
    };
    let truth = simulated(&["--out", out.to_str().unwrap()]);
    for (place, role) in ["fit", "held_out"].into_iter().enumerate() {
        let own = &truth["records"][place];
        assert_eq!((&own["role"], &own["channel"]), (&role.into(), &"body_z".into()));
        assert!(own["nrms"].as_f64().unwrap() < 1e-3, "{own}");
        let columns = fs::read_to_string(out.join(format!("run_{place}.csv"))).unwrap();
        let head = "time [s],body_z_displacement_measured [m],body_z_displacement_simulated [m]\n";
        assert!(columns.starts_with(head));
        assert_eq!(columns.lines().count(), SAMPLES + 1);
        assert!(
            fs::read_to_string(out.join(format!("run_{place}.svg")))
                .unwrap()
                .contains("time, s")
        );
    }
    let off = simulated(&["--set", "k_body=840"]);
    let error = &off["records"][0];
    let (rms, left) = (
        error["measured_rms"].as_f64().unwrap(),
        error["rms_error"].as_f64().unwrap(),
    );
    let measured = mass([0.0, 0.0], push);
    let mean = measured.iter().sum::<f64>() / SAMPLES as f64;
    let scatter = (measured.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / SAMPLES as f64).sqrt();
    assert!((rms / scatter - 1.0).abs() < 1e-6, "{error}");
    assert!(
        (error["nrms"].as_f64().unwrap() - left / rms).abs() < 1e-9 && left > 0.02 * rms,
        "{error}"
    );
    assert!(succeeds(&["simulate", path]).contains("nrms_%"));
    assert!(
        succeeds(&["simulate", path, "--format", "csv"]).starts_with("run,role,channel,quantity,unit,measured_rms")
    );
}

/// The force between the first samples is not known from the samples alone, so neither a fit nor a simulation compares the
/// first and last 2 % of a record whose inputs are interpolated. Compared there, this one would leave ten times as much.
#[test]
fn the_ends_of_a_band_limited_record_are_not_compared() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path().to_str().unwrap(), folder.path().join("out"));
    let parameters = all_known();
    let tone = |t: f64| (std::f64::consts::TAU * 3.0 * t).cos() + (std::f64::consts::TAU * 17.0 * t).cos();
    let force: Vec<f64> = (0..SAMPLES).map(|k| tone(k as f64 / RATE)).collect();
    let z = mass_for(5 * SAMPLES, [0.0, 0.0], tone)[4 * SAMPLES..].to_vec();
    let columns = vec![("push", force), ("z", z)];
    campaign(
        folder.path(),
        "one_mass",
        &parameters,
        "band_limited = true",
        &[&columns],
    );
    let arguments = ["simulate", path, "--format", "json", "--out", out.to_str().unwrap()];
    let result: Value = serde_json::from_str(&succeeds(&arguments)).unwrap();
    let nrms = result["records"][0]["nrms"].as_f64().unwrap();
    assert!(nrms < 1e-3, "{nrms}");
    let compared = fs::read_to_string(out.join("run_0.csv")).unwrap().lines().count() - 1;
    assert_eq!(compared, SAMPLES - 2 * (SAMPLES / 50));
}

/// Ten periods that repeat, recorded with a slow drift of the sensor that is none of the mass's: a band leaves it out.
#[test]
fn a_band_and_a_steady_state_are_compared_as_the_campaign_says() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    let parameters = all_known();
    let tone = |t: f64| (std::f64::consts::TAU * 2.0 * t).sin() + (std::f64::consts::TAU * 4.0 * t).cos();
    let held = |t: f64| tone((t * RATE).floor() / RATE);
    let force: Vec<f64> = (0..SAMPLES).map(|k| tone(k as f64 / RATE)).collect();
    // Begun twenty seconds earlier, as long as fifteen of its time constants.
    let z = |count: usize| -> Vec<f64> { mass_for(5 * SAMPLES, [0.0, 0.0], held)[4 * SAMPLES..][..count].to_vec() };
    let nrms = |keys: &str, z: Vec<f64>| {
        let keys = format!("band_limited = false\n{keys}");
        let columns = vec![("push", force.clone()), ("z", z)];
        campaign(folder.path(), "one_mass", &parameters, &keys, &[&columns]);
        let result: Value = serde_json::from_str(&succeeds(&["simulate", path, "--format", "json"])).unwrap();
        result["records"][0]["nrms"].as_f64().unwrap()
    };
    assert!(nrms("periodic = true", z(SAMPLES)) < 1e-3);
    let drifting = |k: usize| 0.01 * k as f64 / SAMPLES as f64;
    let drifted: Vec<f64> = z(SAMPLES).iter().enumerate().map(|(k, z)| z + drifting(k)).collect();
    assert!(nrms("", drifted.clone()) > 0.5);
    assert!(nrms("band = [1.0, 20.0]", drifted.clone()) < 0.02);
    let refused = |keys: &str, said: &str| {
        let keys = format!("band_limited = false\n{keys}");
        let columns = vec![("push", force.clone()), ("z", drifted.clone())];
        campaign(folder.path(), "one_mass", &parameters, &keys, &[&columns]);
        let ran = qcar(&["simulate", path]);
        assert!(ran.status == 2 && ran.stderr.contains(said), "{}", ran.stderr);
    };
    refused("band = [1.0, 100.0]", "below half the sample rate, 100 Hz");
    refused("band = [20.0, 1.0]", "the lower bound below the upper");
    refused("band = [0.01, 20.0]", "longer than the");
}

/// A damper that may not be quite as hard as it is stands at the end of its range, and a spring that is known wrongly
/// leaves a residual over time.
#[test]
fn bounds_and_spans_of_time_are_told_as_such() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path().to_str().unwrap(), folder.path().join("out"));
    let with_spring = |spring: f64| {
        let known = parameter("m_body", 2.0, "kg", "") + &parameter("k_body", spring, "N/m", "");
        let parameters = known.replace("true", "false") + &parameter("c_body", 1.0, "N s/m", "range = [0.5, 2.99]\n");
        pushed_campaign(folder.path(), "one_mass", &parameters);
        discovered_into(&out, path)
    };
    let (said, answer) = with_spring(800.0);
    assert!(said.contains("c_body is at the upper end of its range"), "{said}");
    let file = fs::read_to_string(out.join("parameters.toml")).unwrap();
    let told = |line: &str| line.starts_with("c_body = 2.9") && line.ends_with(" # at the upper end of its range");
    assert!(file.lines().any(told), "{file}");
    assert_eq!(answer["at_bound"], serde_json::json!({"c_body": "upper"}), "{answer}");
    let (said, _) = with_spring(600.0);
    let mut lines = said
        .lines()
        .skip_while(|line| !line.starts_with("largest residuals"))
        .skip(1);
    let heading: Vec<&str> = lines.next().unwrap().split_whitespace().collect();
    let first: Vec<&str> = lines.next().unwrap().split_whitespace().collect();
    assert_eq!((heading[5], first[5]), ("unit", "s"), "{said}");
    assert_eq!((heading[1], first[1]), ("run", "run_0.csv"), "{said}");
}

/// A mass that a constant force pushes against a damper on a stiff spring, in closed form. The spring relaxes in 50 µs;
/// a record of this rate gets steps of 1 ms, and the Runge-Kutta method diverges where a step is longer than 2.8
/// relaxation times.
#[test]
fn steps_are_halved_where_a_law_is_too_stiff_for_them() {
    let [mass, drag, rate, force]: [f64; 4] = [2.0, 300.0, 2e4, 10.0];
    let stiffness = rate * drag;
    let root = (rate * rate / 4.0 - stiffness / mass).sqrt();
    let [slow, fast] = [-rate / 2.0 + root, -rate / 2.0 - root];
    let end = force / drag;
    // Velocity and acceleration at the start are 0 and force / mass.
    let b = (force / mass + end * slow) / (fast - slow);
    let a = -end - b;
    let place = |t: f64| end * t + a * (slow * t).exp_m1() / slow + b * (fast * t).exp_m1() / fast;
    let times = (0..SAMPLES).map(|k| k as f64 / RATE);
    let run: [(&str, Vec<f64>); 2] = [("push", vec![force; SAMPLES]), ("z", times.map(place).collect())];
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("stiff.axle"), STIFF).unwrap();
    campaign(
        folder.path(),
        "./stiff.axle",
        "[parameters]\n",
        "band_limited = false",
        &[&run],
    );
    let simulated = succeeds(&["simulate", folder.path().to_str().unwrap(), "--format", "json"]);
    let simulated: Value = serde_json::from_str(&simulated).unwrap();
    let left = simulated["records"][0]["nrms"].as_f64().expect("a finite replay");
    assert!(left < 1e-4, "{simulated}");
}

const STIFF: &str = "axle stiff {
    \"A mass against a damper that stands on a stiff spring\"
    known param m: kg = 2 in 0.1..10 \"Mass\";
    param c: N s/m = 300 in 1..1e4 \"Damper\";
    param k: N/m = 6e6 in 1..1e9 \"Spring in series with it\";
    direction z {
        mass body = m;
        force f on body;
        link damper: body {
            state f_damper: N;
            rate f_damper = k * (v - f_damper / c);
            force = f_damper;
        }
        output body.position;
    }
}
";

/// The force of an actuator between two masses, with a gain of its own, and a second input that only one run has.
#[test]
fn an_input_between_two_masses_has_a_gain_and_what_is_not_recorded_rests() {
    finds_the_gain(PAIR);
}

/// The same where the input itself acts between the masses.
#[test]
fn a_force_between_two_points_drives_a_record() {
    finds_the_gain(&with_actuator("force f on gain*(body - other);", ""));
}

/// The same where the input acts through the law of a link, which holds its ends apart.
#[test]
fn a_force_in_a_law_drives_a_record() {
    finds_the_gain(&with_actuator(
        "force f;",
        "link actuator: body - other { force = -gain*f; }",
    ));
}

/// The pair with an actuator of another kind.
fn with_actuator(input: &str, link: &str) -> String {
    let text = PAIR.replace("node rod;\n        force f on rod;", input);
    text.replace("link actuator: rod - gain*(body - other) { spring 1 kN/mm; }", link)
}

fn finds_the_gain(model: &str) {
    const GAIN: f64 = 1.3;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    fs::write(folder.path().join("pair.axle"), model).unwrap();
    let wind = |t: f64| (11.0 * (t * RATE).floor() / RATE).sin();
    // Each swings on its own, one with the actuator, the other against it.
    let run = |blown: f64| {
        let of =
            |force: &dyn Fn(f64) -> f64| -> Vec<f64> { (0..SAMPLES).map(|k| force((k as f64 + 0.5) / RATE)).collect() };
        let mut columns = vec![
            ("push", of(&push)),
            ("z", mass([0.0; 2], |t| GAIN * push(t) + blown * wind(t))),
        ];
        columns.push(("z_other", mass([0.0; 2], |t| -GAIN * push(t))));
        if blown > 0.0 {
            columns.push(("wind", of(&|t| blown * wind(t))));
        }
        columns
    };
    let runs = [run(1.0), run(0.0), run(2.0)];
    let runs: Vec<Columns> = runs.iter().map(Vec::as_slice).collect();
    let gain = parameter("gain", 0.9, "1", "range = [0.2, 5.0]\n");
    campaign(folder.path(), "./pair.axle", &gain, "band_limited = false", &runs);
    let manifest = folder.path().join("campaign.toml");
    let more = "[[channel]]\nname = \"z_other\"\nlocation = \"other\"\nside = \"centre\"\naxis = \"z\"\n\
                quantity = \"displacement\"\nunit = \"m\"\n\n[[channel]]\nname = \"wind\"\nlocation = \"g\"\n\
                side = \"centre\"\naxis = \"z\"\nquantity = \"force\"\nunit = \"N\"\n\n[[run]]";
    let text = fs::read_to_string(&manifest).unwrap().replacen("[[run]]", more, 1);
    fs::write(&manifest, text).unwrap();
    let simulated = succeeds(&[
        "simulate", path, "--set", "gain=1.3", "--set", "k=800", "--set", "c=3", "--format", "json",
    ]);
    let simulated: Value = serde_json::from_str(&simulated).unwrap();
    let errors = simulated["records"].as_array().unwrap();
    assert_eq!(errors.len(), 6);
    assert!(
        errors.iter().all(|own| own["nrms"].as_f64().unwrap() < 2e-3),
        "{simulated}"
    );
    let out = folder.path().join("out");
    succeeds(&["discover", path, "--out", out.to_str().unwrap()]);
    let file = fs::read_to_string(out.join("parameters.toml")).unwrap();
    let gain = file.lines().find_map(|line| line.strip_prefix("gain = ")).unwrap();
    assert!((gain.parse::<f64>().unwrap() / GAIN - 1.0).abs() < 0.005, "{file}");
}

/// A massless point on which a force acts passes it on, by the lever of the link that holds it.
const PAIR: &str = "axle pair {
    \"Two masses, an actuator between them and a force on one\"
    known param m: kg = 2 in 0.1..10 \"Each mass\";
    param k: N/m = 700 in 100..4000 \"Each spring\";
    param c: N s/m = 4 in 0.1..50 \"Each damper\";
    param gain: 1 = 0.9 in 0.2..5 \"Force of the actuator over its signal\";
    direction z {
        mass body = m;
        mass other = m;
        node rod;
        force f on rod;
        force g on body;
        link left: body { spring k; damper c; }
        link right: other { spring k; damper c; }
        link actuator: rod - gain*(body - other) { spring 1 kN/mm; }
        output body.position;
        output other.position;
    }
}
";
