//! Tables of a dynamometer as evidence: forces in closed form are predicted, and parameters of their laws are found
//! again.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use qcar_runtime::campaign::Truth;
use serde_json::Value;

use crate::common::{Ran, copy, qcar, succeeds};

/// Peak velocities of the sines, m/s, as the trade drives them.
const SPEEDS: [f64; 7] = [0.05, 0.13, 0.26, 0.39, 0.52, 0.79, 1.05];
/// Half the stroke, m.
const AMPLITUDE: f64 = 0.02;
/// Standard deviation of the forces, N.
const NOISE: f64 = 5.0;

/// A damper whose rebound and compression differ, with the friction of its seals, which slips slowly enough to show.
const DAMPER: &str = "
element dahl(f_c: N, k: N/m) {
    state f: N;
    rate f = k*v - k*abs(v)*f/f_c;
    force = f;
}

axle sealed {
    \"A body on a spring and a damper with seals\"

    known param m_body: kg = 390;
    param k: N/m = 25 N/mm in 10 N/mm..80 N/mm \"Spring\";
    param c_out: N s/m = 1500 in 100..9000 \"Damping in rebound at low speed\";
    param c_in: N s/m = 1500 in 100..9000 \"Damping in compression at low speed\";
    param v_0: m/s = 0.5 in 0.02..3 \"Speed at which the damping has fallen to a half\";
    param f_seal: N = 50 in 5..300 \"Friction of the seals\";
    param k_seal: N/m = 10 N/mm in 1 N/mm..200 N/mm \"Their stiffness before they slip\";

    direction z {
        motion wheel;
        mass body = m_body;
        link spring: body - wheel { spring k; }
        link damper: body - wheel {
            force = (if v > 0 { c_out } else { c_in })*v/(1 + abs(v)/v_0);
            dahl(f_seal, k_seal);
        }
        channel wheel_to_body = body.acceleration / wheel.acceleration;
    }
}
";

/// What the campaign hides: c_out, c_in, v_0, f_seal, k_seal.
const TRUTH: [(&str, f64); 5] = [
    ("c_out", 4200.0),
    ("c_in", 2100.0),
    ("v_0", 0.21),
    ("f_seal", 90.0),
    ("k_seal", 9e3),
];

/// The force in the middle of the travel. The friction is the periodic solution of Dahl's law: from a reversal, where
/// it is `-f tanh(kA/f)`, it nears `f` by a factor of e every `f/k` of travel.
fn force(speed: f64, amplitude: f64) -> f64 {
    let [c_out, c_in, v_0, f, k] = TRUTH.map(|(_, value)| value);
    let c = if speed > 0.0 { c_out } else { c_in };
    let turned = f * (k * amplitude / f).tanh();
    let friction = f - (f + turned) * (-k * amplitude / f).exp();
    c * speed / (1.0 + speed.abs() / v_0) + friction * speed.signum()
}

/// A normal deviate for each place, the same everywhere: the sum of twelve even ones less six.
fn normal(place: usize) -> f64 {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(place as u64 + 1);
    let mut even = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..12).map(|_| even()).sum::<f64>() - 6.0
}

fn table(noise: f64) -> String {
    table_of(noise, AMPLITUDE)
}

fn table_of(noise: f64, amplitude: f64) -> String {
    let speeds = SPEEDS.iter().flat_map(|speed| [*speed, -speed]).enumerate();
    speeds.fold("velocity,force\n".into(), |mut text: String, (place, speed)| {
        let _ = writeln!(
            text,
            "{speed},{:.4}",
            force(speed, amplitude) + noise * normal(place + (1e6 * amplitude) as usize)
        );
        text
    })
}

fn campaign(folder: &Path, run: &str, table: &str) {
    fs::write(folder.join("sealed.axle"), DAMPER).unwrap();
    fs::write(folder.join("damper.csv"), table).unwrap();
    let text = format!(
        "format = 1\nname = \"bench\"\nmodel = \"./sealed.axle\"\n\n[parameters.k]\nvalue = 25000\nunit = \"N/m\"\nfit = false\n\n\
         [[run]]\nkind = \"dynamometer\"\nfile = \"damper.csv\"\nrole = \"fit\"\nlink = \"damper\"\namplitude = \"20 mm\"\n{run}\n"
    );
    fs::write(folder.join("campaign.toml"), text).unwrap();
}

fn fit(folder: &Path) -> Value {
    serde_json::from_str(&succeeds(&["fit", folder.to_str().unwrap(), "--format", "json"])).unwrap()
}

/// All five parameters of a law with memory come out within what the fit says that it does not know. Strokes of two
/// lengths tell how stiffly the seals begin to slip.
#[test]
fn a_law_that_remembers_is_found_from_its_tables() {
    let folder = tempfile::tempdir().unwrap();
    let short = "\n[[run]]\nkind = \"dynamometer\"\nfile = \"short.csv\"\nrole = \"fit\"\nlink = \"damper\"\namplitude = 0.005\n\
                 uncertainty = 5";
    campaign(folder.path(), &format!("uncertainty = \"5 N\"\n{short}"), &table(NOISE));
    fs::write(folder.path().join("short.csv"), table_of(NOISE, 0.005)).unwrap();
    let fitted = fit(folder.path());
    let gap = fitted["gap"]["fit"].as_f64().unwrap();
    assert!((0.4..1.4).contains(&gap), "{fitted}");
    for (name, truth) in TRUTH {
        let own = &fitted["parameters"][name];
        let (value, error) = (own["value"].as_f64().unwrap(), own["stderr"].as_f64());
        let error = error.unwrap_or_else(|| panic!("{name} has no standard error: {own}"));
        assert!(
            (value - truth).abs() < 3.0 * error,
            "{name}: {value} ± {error}, not {truth}"
        );
        assert!(error < 0.3 * truth, "{name}: ± {error} says little");
    }
}

/// Without noise the closed form itself is met, far below the friction, whatever the search had to do.
#[test]
fn forces_are_those_of_the_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    campaign(folder.path(), "uncertainty = \"10 mN\"", &table(0.0));
    let start: String = TRUTH.iter().fold(String::new(), |mut text, (name, value)| {
        let unit = if name.starts_with("c_") { "N s/m" } else { "N/m" };
        let unit = match *name {
            "v_0" => "m/s",
            "f_seal" => "N",
            _ => unit,
        };
        let _ = write!(
            text,
            "\n[parameters.{name}]\nvalue = {value}\nunit = \"{unit}\"\nfit = {}\n",
            *name == "c_out"
        );
        if *name == "c_out" {
            text += "range = [100, 9000]\n";
        }
        text
    });
    let file = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&file).unwrap() + &start;
    fs::write(&file, text).unwrap();
    let fitted = fit(folder.path());
    let found = fitted["parameters"]["c_out"]["value"].as_f64().unwrap();
    // The table has four decimals.
    assert!((found / 4200.0 - 1.0).abs() < 1e-5, "{found}");
    assert!(fitted["gap"]["fit"].as_f64().unwrap() < 0.1, "{fitted}");
}

fn refused(run: &str, table: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    campaign(folder.path(), run, table);
    let Ran { status, stderr, .. } = qcar(&["fit", folder.path().to_str().unwrap()]);
    assert_eq!(status, 2, "{stderr}");
    stderr
}

#[test]
fn what_is_wrong_with_a_table_is_told_with_its_place() {
    let sure = "uncertainty = \"5 N\"";
    let says = |run: &str, table: &str, words: &[&str]| {
        let told = refused(run, table);
        for word in words {
            assert!(told.contains(word), "{word} in\n{told}");
        }
    };
    says(
        "",
        &table(0.0),
        &["damper.csv", "no uncertainty", "uncertainty = \"10 N\""],
    );
    says(
        "uncertainty = \"5 N/m\"",
        &table(0.0),
        &["campaign.toml, line 16", "N/m"],
    );
    says(
        "uncertainty = 0",
        &table(0.0),
        &["campaign.toml, line 16", "above zero"],
    );
    says(
        sure,
        "velocity,force\n0.1,200\n0,3\n",
        &["damper.csv, line 3", "`velocity`", "remove the row"],
    );
    says(
        sure,
        "velocity,force\n-0.1,200\n",
        &[
            "damper.csv, line 2",
            "`force`",
            "acts in the direction of the motion",
            "sign = -1",
        ],
    );
    says(sure, "speed,force\n0.1,200\n", &["damper.csv, line 1", "`velocity`"]);
    says(
        sure,
        "velocity [mm],force\n0.1,200\n",
        &["damper.csv, line 1", "\"mm\"", "m/s"],
    );
    says(sure, "velocity,force,uncertainty\n0.1,200,4\n", &["one of them"]);
    says(
        "",
        "velocity,force,uncertainty\n0.1,200,0\n",
        &["damper.csv, line 2", "`uncertainty`", "above zero"],
    );
    says(
        &format!("{sure}\naxis = \"x\""),
        &table(0.0),
        &["`damper` in the run damper.csv", "along x", "none"],
    );
}

/// A table in the units and signs of its maker is the same table.
#[test]
fn units_and_signs_of_a_table_are_those_that_it_states() {
    let (plain, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    campaign(plain.path(), "uncertainty = \"5 N\"", &table(NOISE));
    let lines = table(NOISE);
    let rows = lines.lines().skip(1).map(|line| line.split_once(',').unwrap());
    let number = |text: &str| text.parse::<f64>().unwrap();
    let turned = rows.fold("Speed,Load\n".to_string(), |mut text, (speed, force)| {
        let _ = writeln!(text, "{},{}", 1e3 * number(speed), -number(force));
        text
    });
    let mapped = "uncertainty = \"5 N\"\nvelocity = { source = \"Speed\", unit = \"mm/s\" }\nforce = { source = \"Load\", unit = \"N\", sign = -1 }";
    campaign(other.path(), mapped, &turned);
    let value = |of: &Path| fit(of)["parameters"]["c_out"]["value"].as_f64().unwrap();
    assert!((value(other.path()) / value(plain.path()) - 1.0).abs() < 1e-6);
}

/// The least sum of squares for a held speed at which the damping has fallen to a half: over the damping in rebound, in
/// which forces are linear, and over the gain of the load cell, which is known to 0.7 %.
fn least_squares(text: &str, v_0: f64) -> f64 {
    let rows: Vec<(f64, f64)> = text
        .lines()
        .skip(1)
        .map(|line| line.split_once(',').unwrap())
        .map(|(speed, force)| (speed.parse().unwrap(), force.parse().unwrap()))
        .collect();
    let [_, c_in, ..] = TRUTH.map(|(_, value)| value);
    let rest = |speed: f64| {
        force(speed, AMPLITUDE) - if speed > 0.0 { 4200.0 } else { c_in } * speed / (1.0 + speed.abs() / TRUTH[2].1)
    };
    let shape = |speed: f64| speed / (1.0 + speed.abs() / v_0);
    let of_gain = |gain: f64| {
        let own = |speed: f64| gain.exp() * (rest(speed) + if speed > 0.0 { 0.0 } else { c_in * shape(speed) });
        let slope = |speed: f64| if speed > 0.0 { gain.exp() * shape(speed) } else { 0.0 };
        let (mut top, mut bottom) = (0.0, 0.0);
        for (speed, measured) in &rows {
            top += slope(*speed) * (measured - own(*speed));
            bottom += slope(*speed).powi(2);
        }
        let left = rows
            .iter()
            .map(|(speed, measured)| measured - own(*speed) - top / bottom * slope(*speed));
        left.map(|left| (left / NOISE).powi(2)).sum::<f64>() + (gain / 0.007).powi(2)
    };
    (-400..=400)
        .map(|step| of_gain(1e-4 * f64::from(step)))
        .fold(f64::INFINITY, f64::min)
}

/// An end of a profile is where a least squares of its own, over the closed form, has risen by the 95 % quantile of
/// chi-square.
#[test]
fn a_profile_ends_where_the_closed_form_puts_it() {
    let folder = tempfile::tempdir().unwrap();
    // Noise that is smaller than stated leaves nothing for the model to miss.
    let measured = table(0.8 * NOISE);
    campaign(folder.path(), "uncertainty = \"5 N\"", &(measured.clone()));
    let file = folder.path().join("campaign.toml");
    let known = ["c_in", "f_seal", "k_seal"].map(|name| {
        let value = TRUTH.iter().find(|own| own.0 == name).unwrap().1;
        let unit = ["N s/m", "N", "N/m"][["c_in", "f_seal", "k_seal"]
            .iter()
            .position(|own| *own == name)
            .unwrap()];
        format!("\n[parameters.{name}]\nvalue = {value}\nunit = \"{unit}\"\nfit = false\n")
    });
    fs::write(&file, fs::read_to_string(&file).unwrap() + &known.concat()).unwrap();
    let path = folder.path().to_str().unwrap();
    let text = succeeds(&["fit", path, "--profile", "v_0", "--format", "json"]);
    let fitted: Value = serde_json::from_str(&text).unwrap();
    let profile = &fitted["profiles"][0];
    let least = least_squares(&measured, profile["value"].as_f64().unwrap());
    for side in 0..2 {
        let end = profile["interval"][side].as_f64().unwrap();
        let rise = least_squares(&measured, end) - least;
        assert!((rise / 3.841 - 1.0).abs() < 0.05, "{end}: {rise}, {profile}");
    }
}

/// A record of the body over a wheel that is moved, for a damper without seals (the parts of `TRUTH` that it has):
/// Runge and Kutta's method in steps of a tenth of a sample.
fn record() -> String {
    const RATE: f64 = 200.0;
    let wheel = |t: f64| {
        [(2.1, 0.012), (5.3, 0.006), (11.9, 0.0025)].map(|(hertz, size)| {
            let (sin, cos) = (std::f64::consts::TAU * hertz * t).sin_cos();
            let omega = std::f64::consts::TAU * hertz;
            [size * (1.0 - cos), size * omega * sin]
        })
    };
    let sum = |t: f64, k: usize| wheel(t).iter().map(|own| own[k]).sum::<f64>();
    let pull = |t: f64, [x, v]: [f64; 2]| {
        let (s, rate) = (x - sum(t, 0), v - sum(t, 1));
        let c = if rate > 0.0 { TRUTH[0].1 } else { TRUTH[1].1 };
        -(25e3 * s + c * rate / (1.0 + rate.abs() / TRUTH[2].1)) / 390.0
    };
    let rates = |t: f64, y: [f64; 2]| [y[1], pull(t, y)];
    let (mut y, h) = ([0.0, 0.0], 0.1 / RATE);
    let mut text = String::from("time,wheel,body\n");
    for sample in 0..600 {
        let t0 = f64::from(sample) / RATE;
        let noise = 0.2 * normal(sample as usize + 1000);
        let _ = writeln!(text, "{t0:.4},{:.8},{:.6}", sum(t0, 0), pull(t0, y) + noise);
        for step in 0..10 {
            let t = t0 + f64::from(step) * h;
            let add = |y: [f64; 2], k: [f64; 2], h: f64| [y[0] + h * k[0], y[1] + h * k[1]];
            let a = rates(t, y);
            let b = rates(t + h / 2.0, add(y, a, h / 2.0));
            let c = rates(t + h / 2.0, add(y, b, h / 2.0));
            let d = rates(t + h, add(y, c, h));
            y = [0, 1].map(|k| y[k] + h / 6.0 * (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]));
        }
    }
    text
}

/// Metrics of a campaign whose model is nonlinear are as sure as its fit: a natural frequency has half the relative
/// error of the stiffness.
fn is_as_sure_as_its_fit(path: &str) {
    let fitted = fit(Path::new(path));
    let own = succeeds(&["sensitivity", path, "--metrics", "mode.1.frequency", "--format", "json"]);
    let own: Value = serde_json::from_str(&own).unwrap();
    let (metric, k) = (&own["metrics"][0], &fitted["parameters"]["k"]);
    let relative = metric["uncertainty"]["deviation"].as_f64().unwrap() / metric["value"].as_f64().unwrap();
    assert!(
        (relative / (0.5 * k["relative_stderr"].as_f64().unwrap()) - 1.0).abs() < 1e-6,
        "{metric} and {k}"
    );
}

/// The referee is the table itself, which the plan has not seen: errors come out as they were foreseen.
#[test]
fn a_dynamometer_that_is_planned_gives_the_errors_that_it_is_expected_to() {
    let folder = tempfile::tempdir().unwrap();
    let model = DAMPER.replace("            dahl(f_seal, k_seal);\n", "");
    let unused = |line: &&str| !line.contains("f_seal: N = ") && !line.contains("k_seal: N/m = ");
    let model: String = model.lines().filter(unused).map(|line| format!("{line}\n")).collect();
    fs::write(folder.path().join("sealed.axle"), model).unwrap();
    fs::write(folder.path().join("record.csv"), record()).unwrap();
    let channel = |name: &str, quantity: &str, unit: &str| {
        format!(
            "[[channel]]\nname = \"{name}\"\nlocation = \"{name}\"\nside = \"centre\"\naxis = \"z\"\nquantity = \"{quantity}\"\n\
             unit = \"{unit}\"\n\n"
        )
    };
    let text = format!(
        "format = 1\nname = \"record\"\nmodel = \"./sealed.axle\"\n\n[parameters.k]\nvalue = 25000\nunit = \"N/m\"\n\
         fit = true\n\n{}{}[[run]]\nkind = \"time_history\"\nfile = \"record.csv\"\n\
         role = \"fit\"\nsample_rate = 200\nband_limited = true\n",
        channel("wheel", "displacement", "m"),
        channel("body", "acceleration", "m/s^2")
    );
    let file = folder.path().join("campaign.toml");
    fs::write(&file, &text).unwrap();
    let path = folder.path().to_str().unwrap();
    is_as_sure_as_its_fit(path);
    let plan: Value = serde_json::from_str(&succeeds(&["plan", path, "--format", "json"])).unwrap();
    let further = plan["further"].as_array().unwrap();
    let is_it = |own: &&Value| own["what"] == "a dynamometer's table of damper";
    let planned = further.iter().find(is_it).unwrap_or_else(|| panic!("{plan}"));
    assert!(planned["rise"].as_f64().unwrap() > 0.0);
    // The forces of the law alone, off by one percent of their RMS value: the errors of fourteen draws would themselves
    // scatter by a fifth.
    let force = |speed: f64| {
        let c = if speed > 0.0 { TRUTH[0].1 } else { TRUTH[1].1 };
        c * speed / (1.0 + speed.abs() / TRUTH[2].1)
    };
    let speeds: Vec<f64> = SPEEDS.iter().flat_map(|speed| [*speed, -speed]).collect();
    let sigma = 0.01 * (speeds.iter().map(|speed| force(*speed).powi(2)).sum::<f64>() / speeds.len() as f64).sqrt();
    let rows = speeds.iter().enumerate();
    let measured = rows.fold("velocity,force\n".to_string(), |mut text, (place, speed)| {
        let _ = writeln!(text, "{speed},{:.4}", force(*speed) + sigma * normal(place).signum());
        text
    });
    fs::write(folder.path().join("damper.csv"), measured).unwrap();
    let run = format!(
        "\n[[run]]\nkind = \"dynamometer\"\nfile = \"damper.csv\"\nrole = \"fit\"\nlink = \"damper\"\namplitude = 0.05\n\
         uncertainty = {sigma:.4}\n"
    );
    fs::write(&file, text + &run).unwrap();
    let fitted = fit(folder.path());
    for name in ["c_out", "c_in", "v_0"] {
        let expected = planned["stderr"][name].as_f64().unwrap();
        let found = fitted["parameters"][name]["stderr"].as_f64().unwrap();
        let now = plan["parameters"][name]["stderr"].as_f64().unwrap();
        assert!(
            (expected / found - 1.0).abs() < 0.15,
            "{name}: {expected} and {found}, now {now}"
        );
        assert!(found < 0.8 * now, "{name}: {found}, and {now} without the table");
        let value = fitted["parameters"][name]["value"].as_f64().unwrap();
        let truth = TRUTH.iter().find(|own| own.0 == name).unwrap().1;
        assert!(
            (value - truth).abs() < 3.5 * found,
            "{name}: {value} ± {found}, not {truth}"
        );
    }
}

/// In the middle of one stroke friction is one number, whatever it is made of: the fit says which parameters are seen
/// only together, and the plan which measurement tells them apart.
#[test]
fn what_one_stroke_cannot_tell_apart_is_named_with_its_remedy() {
    let folder = tempfile::tempdir().unwrap();
    campaign(folder.path(), "uncertainty = \"5 N\"", &table(NOISE));
    let fitted = fit(folder.path());
    for (name, other) in [("f_seal", "k_seal"), ("k_seal", "f_seal")] {
        let why = &fitted["parameters"][name]["why_no_stderr"];
        assert_eq!(
            (&why["reason"], &why["with"][0]),
            (&"only_together".into(), &other.into()),
            "{fitted}"
        );
    }
    let path = folder.path().to_str().unwrap();
    let told = succeeds(&["fit", path]);
    assert!(
        told.contains("`qcar plan CAMPAIGN --parameters f_seal,k_seal`"),
        "{told}"
    );
    let text = succeeds(&["plan", path, "--parameters", "f_seal,k_seal", "--format", "json"]);
    let plan: Value = serde_json::from_str(&text).unwrap();
    let first = &plan["further"][0];
    assert_eq!(
        first["what"], "damper.csv once more with a tenth of its stroke",
        "{plan}"
    );
    for name in ["f_seal", "k_seal"] {
        assert_eq!(plan["parameters"][name]["stderr"], Value::Null);
        assert!(first["stderr"][name].as_f64().unwrap() > 0.0, "{first}");
    }
}

/// The cost of a linear fit is made of transmissibilities, and says so; with `--all-runs` a linear model is fitted to
/// tables, cleats and K&C curves too, to the truth of its campaign.
#[test]
fn a_linear_model_is_fitted_to_all_runs_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    copy(
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("models/campaigns/axle_a_rig")
            .as_path(),
        &own,
    );
    let truth = Truth::read(&own.join("truth.toml")).unwrap().parameters;
    let damping = truth.iter().find(|own| own.0 == "c_wheel_z").unwrap().1;
    let speeds = SPEEDS[..5].iter().flat_map(|speed| [*speed, -speed]).enumerate();
    let table = speeds.fold("velocity,force\n".to_string(), |mut text, (place, speed)| {
        let _ = writeln!(text, "{speed},{:.3}", damping * speed + 10.0 * normal(place));
        text
    });
    fs::write(own.join("damper.csv"), table).unwrap();
    let file = own.join("campaign.toml");
    let run = "\n[[run]]\nkind = \"dynamometer\"\nfile = \"damper.csv\"\nrole = \"fit\"\nlink = \"damper\"\namplitude = 0.05\nuncertainty = 10\n";
    fs::write(&file, fs::read_to_string(&file).unwrap() + run).unwrap();
    let path = own.to_str().unwrap();
    assert!(
        succeeds(&["fit", path, "--starts", "1"])
            .contains("damper.csv: a fit to transmissibilities does not use the table of a dynamometer")
    );
    let all = succeeds(&["fit", path, "--starts", "1", "--all-runs", "--format", "json"]);
    let fitted: Value = serde_json::from_str(&all).unwrap();
    assert!(fitted["gap"]["fit"].as_f64().unwrap() < 1.2, "{fitted}");
    let mut seen = 0;
    for (name, truth) in &truth {
        let own = &fitted["parameters"][name];
        let Some(error) = own["stderr"].as_f64() else { continue };
        let value = own["value"].as_f64().unwrap();
        assert!(
            (value - truth).abs() < 3.0 * error,
            "{name}: {value} ± {error}, not {truth}"
        );
        seen += 1;
    }
    assert!(seen >= 12, "{fitted}");
}
