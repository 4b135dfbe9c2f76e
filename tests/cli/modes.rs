//! Natural frequencies, damping ratios and shapes against closed forms, and models that are unstable.

use std::f64::consts::TAU;
use std::fs;

use serde_json::Value;

use crate::common::{qcar, qcar_in, succeeds};

fn modes(arguments: &[&str]) -> Value {
    let line = [&["modes"], arguments, &["--format", "json"]].concat();
    serde_json::from_str(&succeeds(&line)).unwrap()
}

/// The modes of a model file with this body.
fn of_text(body: &str, set: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("own.axle"),
        format!("axle own {{ \"A model\" {body} }}"),
    )
    .unwrap();
    let mut line = vec!["modes", "own.axle", "--format", "json"];
    line.extend(set.iter().flat_map(|set| ["--set", set]));
    let ran = qcar_in(folder.path(), &line);
    assert_eq!(ran.status, 0, "{}", ran.stderr);
    serde_json::from_str(&ran.stdout).unwrap()
}

const ONE_MASS: &str = "param m: kg = 4 in 1..10; param k: N/m = 900 in 1..1e4; param c: N s/m = 12 in 0..1e4;
    direction z { mass body = m; link spring: body { spring k; damper c; } output body.position; }";

fn number(of: &Value) -> f64 {
    of.as_f64().unwrap()
}

fn close(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() < 1e-8 * expected.abs().max(1e-3),
        "{found}, not {expected}"
    );
}

/// The squares of the frequencies of `det(K - ω² M) = 0` are the roots of a quadratic, and a mode with `ω²` moves the body
/// by `k / (k - ω² m_body)` times the wheel.
#[test]
fn an_undamped_quarter_car_has_the_modes_of_the_quadratic_formula() {
    let matrices = succeeds(&["matrices", "quarter_car", "--format", "json"]);
    let matrices: Value = serde_json::from_str(&matrices).unwrap();
    let value = |name: &str| number(&matrices["values"][name]);
    let (wheel, body) = (value("m_wheel"), value("m_corner") - value("m_wheel"));
    let (k, k_tire) = (value("k_wheel_z"), value("k_tire"));
    let (half, product) = (((k + k_tire) / wheel + k / body) / 2.0, k * k_tire / (wheel * body));
    let root = (half * half - product).sqrt();
    let squares = [half - root, half + root];
    let found = modes(&["quarter_car", "--set", "c_wheel_z=0", "--set", "c_tire=0"]);
    let along_z = found["modes"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|mode| mode["parts"][0]["axis"] == "z");
    let along_z: Vec<&Value> = along_z.collect();
    assert_eq!(along_z.len(), 2, "{found}");
    for (mode, square) in along_z.into_iter().zip(squares) {
        close(number(&mode["frequency"]), square.sqrt() / TAU);
        assert!(number(&mode["damping"]).abs() < 1e-9, "{mode}");
        assert_eq!((&mode["kind"], &mode["unstable"]), (&"vibration".into(), &false.into()));
        let part = |point: &str| {
            mode["parts"]
                .as_array()
                .unwrap()
                .iter()
                .find(|part| part["point"] == point)
                .unwrap()
        };
        let ratio = k / (k - square * body);
        let [of_body, of_wheel] = ["body", "wheel"].map(part);
        close(
            number(&of_body["amplitude"]) / number(&of_wheel["amplitude"]),
            ratio.abs(),
        );
        let apart = number(&of_body["phase"]) - number(&of_wheel["phase"]);
        assert!((apart.to_radians().cos() - ratio.signum()).abs() < 1e-9, "{mode}");
        let largest = number(&of_body["amplitude"]).max(number(&of_wheel["amplitude"]));
        close(largest, 1.0);
    }
}

/// `ω² = k / m` and `ζ = c / (2 √(k m))`, whether it oscillates or not.
#[test]
fn a_damped_mass_has_its_frequency_and_damping_ratio() {
    for (c, kind) in [(12.0, "vibration"), (300.0, "overdamped")] {
        let found = of_text(ONE_MASS, &[&format!("c={c}")]);
        let all = found["modes"].as_array().unwrap();
        assert_eq!(all.len(), 1, "{found}");
        close(number(&all[0]["frequency"]), 15.0 / TAU);
        close(number(&all[0]["damping"]), c / 120.0);
        assert_eq!(all[0]["kind"], kind);
        assert_eq!(
            found["notices"].as_array().unwrap().len(),
            usize::from(c > 120.0),
            "{found}"
        );
    }
}

/// Which real eigenvalues belong together does not follow if there are four, or one of a law with memory.
#[test]
fn real_eigenvalues_that_have_no_certain_partner_stand_alone() {
    let two = "param c: N s/m = 300 in 0..1e4;
        direction z { mass low = 4 kg; mass high = 4 kg; link a: low { spring 900 N/m; damper c; }
            link b: high { spring 400 N/m; damper c; } output low.position; output high.position; }";
    let found = of_text(two, &[]);
    let rates: Vec<f64> = found["modes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|own| number(&own["frequency"]) * TAU)
        .collect();
    // λ² + 75 λ + 225 and λ² + 75 λ + 100.
    let mut expected = [225.0_f64, 100.0]
        .map(|square| {
            let root = (37.5_f64.powi(2) - square).sqrt();
            [37.5 - root, 37.5 + root]
        })
        .concat();
    expected.sort_by(f64::total_cmp);
    assert_eq!(rates.len(), 4, "{found}");
    rates
        .iter()
        .zip(expected)
        .for_each(|(rate, expected)| close(*rate, expected));
    assert!(
        found["modes"]
            .as_array()
            .unwrap()
            .iter()
            .all(|own| own["kind"] == "aperiodic" && own["damping"] == 1.0)
    );
}

#[test]
fn a_mass_that_nothing_holds_has_no_frequency() {
    let found = of_text(
        "param m: kg = 4 in 1..10; direction z { mass body = m; force f on body; output body.acceleration; }",
        &[],
    );
    assert_eq!(
        (found["modes"].as_array().unwrap().len(), &found["rigid"]),
        (0, &2.into()),
        "{found}"
    );
    assert!(
        found["notices"][0]
            .as_str()
            .unwrap()
            .contains("2 eigenvalues of the model are zero"),
        "{found}"
    );
}

/// About rest, a spring that grows with the third power of the travel has its linear stiffness.
#[test]
fn a_nonlinear_model_is_linearised_at_rest() {
    let body = ONE_MASS.replace("damper c;", "damper c; force = 1e6 N/m^3 * s^3;");
    let found = of_text(&body, &[]);
    assert_eq!(found["linear"], false, "{found}");
    close(number(&found["modes"][0]["frequency"]), 15.0 / TAU);
}

/// A table with a row for each mode; the damping ratio has no unit.
#[test]
fn modes_are_a_table() {
    let text = succeeds(&["modes", "quarter_car"]);
    let csv = succeeds(&["modes", "quarter_car", "--format", "csv"]);
    let head = csv.lines().next().unwrap();
    assert!(
        head.starts_with("mode,kind,unstable,frequency [Hz],damping_ratio,"),
        "{head}"
    );
    assert!(
        head.contains(",z_body,z_body_deg") && text.starts_with("mode  kind"),
        "{head}\n{text}"
    );
    let columns = head.split(',').count();
    assert!(csv.lines().all(|line| line.split(',').count() == columns), "{csv}");
    assert_eq!(text.lines().count(), csv.lines().count());
}

/// A negative damping feeds the mode: each verb that computes from the matrices says so.
#[test]
fn an_unstable_model_is_named() {
    let set = ["--set", "c_wheel_z=-500"];
    let notice = "quarter_car is unstable at these values: it has the eigenvalue ";
    for (verb, more) in [
        ("modes", &[][..]),
        ("matrices", &[]),
        ("frf", &["--frequencies", "1:2:2"]),
    ] {
        let line = [&[verb, "quarter_car"], more, &set].concat();
        assert!(succeeds(&line).contains(notice), "{verb}");
        let stable = succeeds(&line[..line.len() - 2]);
        assert!(!stable.contains("unstable"), "{verb}: {stable}");
    }
    let csv = qcar(&[
        "frf",
        "quarter_car",
        "--frequencies",
        "1:2:2",
        "--format",
        "csv",
        set[0],
        set[1],
    ]);
    assert!(
        csv.stderr.contains(notice) && !csv.stdout.contains("unstable"),
        "{}",
        csv.stderr
    );
    let found = modes(&["quarter_car", set[0], set[1]]);
    let growing: Vec<&Value> = found["modes"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|own| own["unstable"] == true)
        .collect();
    assert!(
        !growing.is_empty() && growing.iter().all(|own| number(&own["damping"]) < 0.0),
        "{found}"
    );
}
