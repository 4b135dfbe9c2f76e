//! Models at an edge: modes with equal eigenvalues, without damping, unstable ones, and those that no road carries.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{Ran, refused, run_line};

/// Two equal masses on one frame, which nothing couples, with a stiffness each.
const TWINS: &str = "axle twins { \"Two equal masses\"
    known param m: kg = 10; param k_left: N/m = 4e4 in 1..1e6; param k_right: N/m = 4e4 in 1..1e6; known param c: N s/m = 20;
    direction z { motion base; mass left = m; mass right = m;
        link one: left - base { spring k_left; damper c; } link other: right - base { spring k_right; damper c; }
        channel to_left = left.acceleration / base.acceleration; } }";

/// A mass of which the natural frequency is 1 Hz without rounding, or as good as, and that may be driven to move ever more.
const UNDAMPED: &str = "axle undamped { \"A mass on a spring\"
    known param m: kg = 100; param k: N/m = 3947.8417604357434 in 1..1e6; param c: N s/m = 0 in -1e4..1e4;
    direction z { motion base; mass body = m; link spring: body - base { active; spring k; force = c*v; }
        channel to_body = body.acceleration / base.acceleration; } }";

/// A mass with a broad resonance at 2 Hz, and a stiff one on the same base. A point that moves with the first and a share of
/// the second is measured.
const BESIDE: &str = "axle beside { \"Two masses\"
    known param m: kg = 10; known param k: N/m = 1579; known param c: N s/m = 12.6; known param k_far: N/m = 4.1e4;
    param c_far: N s/m = 0.2 in 0..1e3;
    direction z { motion base; mass near = m; mass far = m; point sum = near + 0.01*far;
        link one: near - base { spring k; damper c; } link other: far - base { spring k_far; damper c_far; }
        channel to_sum = sum.acceleration / base.acceleration; } }";

/// A wheel and a body that a link drives to move ever more.
const DRIVEN: &str = "axle driven_corner { \"A driven corner\"
    known param m: kg = 40; param k: N/m = 2e5 in 1..1e6; param c: N s/m = -9000 in -1e5..1e5;
    direction z { road pad; mass body = 9*m; mass wheel = m; link tire: wheel - pad { spring k; }
        link strut: body - wheel { active; spring 25 N/mm; force = c*v; } output wheel.acceleration; } }";

/// A body that pitches on two wheels.
const TWO_TYRES: &str = "axle half_car { \"Two wheels\"
    known param m: kg = 40; param k: N/m = 3e4 in 1..1e6; param k_tire: N/m = 2e5 in 1..1e6;
    direction z { road pad_front; road pad_rear; mass body = 10*m; inertia pitch = 600 kg m^2; mass front = m; mass rear = m;
        link tire_front: front - pad_front { spring k_tire; damper 500 N s/m; }
        link tire_rear: rear - pad_rear { spring k_tire; damper 500 N s/m; }
        link strut_front: body + 1.2 m*pitch - front { spring k; damper 1500 N s/m; }
        link strut_rear: body - 1.4 m*pitch - rear { spring k; damper 1500 N s/m; }
        channel to_body = body.acceleration / pad_front.acceleration; } }";

/// Vehicle data of a tyre.
const VEHICLE: &str = "[parameters]\n[vehicle]\nr_tire = 0.33\nstatic_tire_load = 3924.0\nstatic_tire_def = 0.02\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let files = [
        ("twins.axle", TWINS),
        ("undamped.axle", UNDAMPED),
        ("beside.axle", BESIDE),
        ("driven.axle", DRIVEN),
        ("half_car.axle", TWO_TYRES),
        ("vehicle.toml", VEHICLE),
    ];
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn said(folder: &Path, line: &str) -> String {
    let Ran { status, stdout, stderr } = run_line(folder, line);
    assert_eq!(status, 0, "{line}: {stderr}{stdout}");
    stdout
}

fn json(folder: &Path, line: &str) -> Value {
    serde_json::from_str(&said(folder, &format!("{line} --format json"))).unwrap()
}

/// Whatever combination of the two is a shape, but only two that differ are the modes.
#[test]
fn equal_modes_have_shapes_of_their_own() {
    let folder = folder();
    let found = json(folder.path(), "modes twins.axle");
    for (mode, moving) in found["modes"].as_array().unwrap().iter().zip(["left", "right"]) {
        let parts = mode["parts"].as_array().unwrap();
        assert_eq!((parts.len(), &parts[0]["point"]), (1, &moving.into()), "{found}");
        assert_eq!((&parts[0]["amplitude"], &parts[0]["phase"]), (&1.0.into(), &0.0.into()));
    }
    let pairs = said(folder.path(), "compare twins.axle twins.axle");
    for pair in [["1", "1"], ["2", "2"]] {
        let is_pair = |line: &str| line.split_whitespace().take(2).eq(pair);
        assert!(pairs.lines().any(is_pair), "{pair:?} in {pairs}");
    }
}

/// A change of one stiffness parts two equal frequencies, so that neither has a derivative.
#[test]
fn equal_modes_have_no_elasticities() {
    let folder = folder();
    let line = "sensitivity twins.axle --metrics mode.1.frequency,to_left.peak";
    let found = json(folder.path(), line);
    let of = |metric: usize| &found["metrics"][metric]["elasticities"]["k_left"];
    assert!(of(0).is_null() && of(1).is_number(), "{found}");
    let notices = found["notices"].as_array().unwrap();
    assert!(
        notices[0]
            .as_str()
            .unwrap()
            .contains("mode.1.frequency: modes with equal"),
        "{notices:?}"
    );
    assert!(
        json(folder.path(), &format!("{line} --set k_left=4.1e4"))["metrics"][0]["elasticities"]["k_left"].is_number()
    );
}

/// The resonance of an undamped mode is infinite: whatever a grid of lines finds is the distance from the pole.
#[test]
fn a_peak_without_damping_has_no_height() {
    let folder = folder();
    let found = json(
        folder.path(),
        "sensitivity undamped.axle --metrics to_body.peak,mode.1.frequency",
    );
    let metrics = found["metrics"].as_array().unwrap();
    assert!(
        metrics.len() == 1 && metrics[0]["name"] == "mode.1.frequency",
        "{found}"
    );
    assert!(
        found["notices"][0]
            .as_str()
            .unwrap()
            .contains("`to_body.peak`: the mode at 1.0000 Hz is undamped")
    );
    let told = said(
        folder.path(),
        "explore undamped.axle --vary k=-1%..1% --count 2 --out sets.csv",
    );
    assert!(
        told.contains("2 of the rows computed now have no height of a peak"),
        "{told}"
    );
    let table = fs::read_to_string(folder.path().join("sets.csv")).unwrap();
    let row: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
    assert!(
        row[2].is_empty() && row[3].parse::<f64>().unwrap() > 0.9 && row[5] == "0",
        "{table}"
    );
    // With a damping ratio of 1e-3 the peak is as high as the closed form says, about 1 / (2 ζ).
    let damped = json(
        folder.path(),
        "sensitivity undamped.axle --metrics to_body.peak --set c=1.2566370614",
    );
    let height = damped["metrics"][0]["value"].as_f64().unwrap();
    assert!((height / 500.0 - 1.0).abs() < 1e-3, "{height}");
}

/// Two masses that nothing couples beside the stated ratio's own: of a large peak and of one with little or no damping
/// between two lines, the higher one is the peak. The height of a resonance with a damping ratio ζ is 1 / (2 ζ), but for
/// (2 ζ)² / 2 of it.
#[test]
fn a_narrow_peak_between_lines_is_found_beside_a_broad_one() {
    let folder = folder();
    let beside = |damping: &str, metric: &str| {
        let line = format!("sensitivity beside.axle --metrics {metric} --set c_far={damping}");
        json(folder.path(), &line)
    };
    for damping in [0.02, 0.2] {
        let ratio = damping / (2.0 * (10.0_f64 * 4.1e4).sqrt());
        let share = 0.01;
        let found = beside(&damping.to_string(), "to_sum.peak,to_sum.peak_frequency");
        let [height, frequency] = [0, 1].map(|at| found["metrics"][at]["value"].as_f64().unwrap());
        // The other mass adds about its own motion above its resonance.
        assert!((height / (share / (2.0 * ratio)) - 1.0).abs() < 0.02, "{height}");
        assert!((frequency / (4.1e3_f64.sqrt() / TAU) - 1.0).abs() < 1e-4, "{frequency}");
    }
    let found = beside("0", "to_sum.peak,mode.1.frequency");
    assert!(found["notices"][0].as_str().unwrap().contains("is undamped"), "{found}");
    // With much damping it is the peak of the other mass.
    let found = beside("200", "to_sum.peak_frequency");
    assert!(found["metrics"][0]["value"].as_f64().unwrap() < 3.0, "{found}");
}

/// The mode at 10.19 Hz is between two of 40 lines from 1 to 30 Hz; a line at it reads its height.
#[test]
fn a_peak_between_the_lines_of_a_response_is_named() {
    let folder = folder();
    let told = |lines: &str| {
        said(
            folder.path(),
            &format!("frf beside.axle --set c_far=0.2 --frequencies {lines}"),
        )
    };
    let words = |text: String| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let missed = words(told("1:30:40"));
    assert!(
        missed.contains("the peak of a mode at 10.191 Hz (damping ratio 0.00016)"),
        "{missed}"
    );
    assert!(!words(told("10.18:10.2:40")).contains("the peak of a mode"));
    let both = words(said(folder.path(), "compare beside.axle beside.axle --set c_far=0.2"));
    assert!(both.contains("the peak of a mode at 10.191 Hz"), "{both}");
}

/// 101 masses have 202 states.
#[test]
fn a_model_with_too_many_states_for_the_check_of_its_stability_says_so() {
    let folder = folder();
    let member = |at: usize| {
        format!(
            "mass q{at} = m; link l{at}: q{at} - q{} {{ spring k; damper c; }} ",
            at - 1
        )
    };
    let members: String = (1..=101).map(member).collect();
    let chain = format!(
        "axle chain {{ \"A chain\" known param m: kg = 2; known param k: N/m = 4e3; known param c: N s/m = 30;
         direction z {{ motion q0; {members} channel to_q1 = q1.acceleration / q0.acceleration; }} }}"
    );
    fs::write(folder.path().join("chain.axle"), chain).unwrap();
    let frf = said(folder.path(), "frf chain.axle --frequencies 1:2:2");
    let words = frf.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.contains("whether model chain is stable was not checked, since it has 202 states"),
        "{words}"
    );
    assert!(!said(folder.path(), "modes chain.axle").contains("not checked"));
}

#[test]
fn a_line_at_an_undamped_resonance_is_named() {
    let folder = folder();
    let ran = run_line(folder.path(), "frf undamped.axle --frequencies 1:10:3");
    refused(
        &ran,
        &[
            "--frequencies",
            "1 Hz, where a mode without damping resonates",
            "`to_body`",
        ],
    );
    said(folder.path(), "frf undamped.axle --frequencies 1.1:10:3");
}

/// A negative damping keeps the damping ratio below any limit, and no design that has it is one.
#[test]
fn an_unstable_design_meets_no_target() {
    let folder = folder();
    let targets = |range: &str| {
        let text = format!(
            "subject = \"undamped.axle\"\n[[target]]\nmetric = \"mode.1.damping\"\nat_most = 0.2\n\
             [[parameter]]\nname = \"c\"\nrange = {range}\n"
        );
        fs::write(folder.path().join("targets.toml"), text).unwrap();
    };
    targets("[-600, 600]");
    let found = json(folder.path(), "target targets.toml --set c=-300");
    assert!(
        found["met"] == true && found["parameters"][0]["design"].as_f64().unwrap() > -1e-3,
        "{found}"
    );
    assert!(
        found["notices"][0]
            .as_str()
            .unwrap()
            .contains("is unstable at these values"),
        "{found}"
    );
    targets("[-600, -300]");
    refused(
        &run_line(folder.path(), "target targets.toml --set c=-300"),
        &["no design in range that is stable"],
    );
}

#[test]
fn an_unstable_model_is_named_where_its_numbers_are_used() {
    let folder = folder();
    for line in [
        "sensitivity undamped.axle --metrics mode.1.damping --set c=-300",
        "compare undamped.axle twins.axle --set c=-300",
        "explore undamped.axle --vary k=-1%..1% --count 2 --metrics modes --out unstable.csv --set c=-300",
    ] {
        let told = said(folder.path(), line);
        assert!(
            told.contains("is unstable at these values") && told.contains("gains and delays"),
            "{told}"
        );
    }
    let rides =
        "explore driven.axle --params vehicle.toml --vary k=-1%..1% --count 2 --rides 20mm@30km/h --out rides.csv";
    let ran = run_line(folder.path(), rides);
    assert!(
        ran.stdout.contains("the model is unstable with these parameters"),
        "{}{}",
        ran.stdout,
        ran.stderr
    );
}

/// What rolls is one wheel on one road.
#[test]
fn a_road_under_a_model_that_does_not_roll_is_refused() {
    let folder = folder();
    let several = "`half_car` has 2 tyres";
    for line in [
        "sensitivity half_car.axle --params vehicle.toml --road C@60km/h",
        "explore half_car.axle --params vehicle.toml --vary k=-1%..1% --count 2 --rides standard --out rides.csv",
        "export half_car.axle --params vehicle.toml --as fmu --road C@60km/h --out unit.fmu",
    ] {
        refused(
            &run_line(folder.path(), line),
            &[several, "a model that stands on one road"],
        );
    }
    let ran = run_line(folder.path(), "sensitivity twins.axle --road C@60km/h");
    refused(&ran, &["`twins` has no tyre that can roll"]);
    let text = said(folder.path(), "sensitivity half_car.axle --params vehicle.toml");
    assert!(text.starts_with("half_car.axle: half_car, without rides"), "{text}");
    said(folder.path(), "new campaign rig --model half_car.axle");
    let manifest = fs::read_to_string(folder.path().join("rig/campaign.toml")).unwrap();
    assert!(!manifest.contains("r_tire"), "{manifest}");
}

/// Every mode is overdamped, and nothing else could be measured.
#[test]
fn a_model_without_metrics_is_told_why() {
    let folder = folder();
    let text = UNDAMPED.replace("channel to_body = body.acceleration / base.acceleration;", "");
    fs::write(folder.path().join("slow.axle"), text).unwrap();
    let told = said(folder.path(), "sensitivity slow.axle --set c=9000");
    assert!(told.contains("No metric has a value: a mode must vibrate"), "{told}");
}
