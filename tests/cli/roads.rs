//! Rides over roads without a measured run, and what they do.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use qcar_signals::read::read;
use serde_json::Value;

use crate::common::{copy, qcar, succeeds};

const AXLE: &str = "models/campaigns/axle_a_rig";
const CRG: &str = "qcar-signals/tests/samples/crg/slope_banking_krbi.crg";

/// The columns of a table of numbers by their headings.
fn columns(file: &Path) -> BTreeMap<String, Vec<f64>> {
    let text = fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut columns: BTreeMap<String, Vec<f64>> = names.iter().map(|name| ((*name).into(), Vec::new())).collect();
    for line in lines {
        for (name, cell) in names.iter().zip(line.split(',')) {
            columns.get_mut(*name).unwrap().push(cell.parse().unwrap());
        }
    }
    columns
}

fn rolled(roads: &[&str], out: &Path) -> Value {
    let mut arguments = vec!["simulate", AXLE, "--format", "json", "--out", out.to_str().unwrap()];
    arguments.extend(roads.iter().flat_map(|road| ["--road", road]));
    serde_json::from_str(&succeeds(&arguments)).unwrap()
}

/// Power of a record in each line of its Fourier transform from 0.1 to 100 Hz, weighted.
fn weighted_power(samples: &[f64], rate: f64, weight: impl Fn(f64) -> f64) -> f64 {
    let length = samples.len() as f64;
    let lines = (0.1 * length / rate).ceil() as usize..(100.0 * length / rate) as usize;
    let power = |line: usize| {
        let (mut re, mut im) = (0.0, 0.0);
        for (at, sample) in samples.iter().enumerate() {
            let (sine, cosine) = (TAU * ((line * at) as f64 % length) / length).sin_cos();
            (re, im) = (re + sample * cosine, im + sample * sine);
        }
        2.0 * (re * re + im * im) / (length * length) * weight(line as f64 * rate / length).powi(2)
    };
    lines.map(power).sum()
}

/// Magnitude of a weighting of ISO 2631-1 (1997, annex A, equations A.1 to A.4) at a frequency, Hz.
fn magnitude(vertical: bool, frequency: f64) -> f64 {
    // Of (f0² - f² + j f f0/Q) over f0².
    let pole = |f0: f64, q: f64| (1.0 - (frequency / f0).powi(2)).hypot(frequency / (f0 * q));
    let root = 0.5_f64.sqrt();
    let band = (frequency / 0.4).powi(2) / pole(0.4, root) / pole(100.0, root);
    let corner = if vertical { 12.5 } else { 2.0 };
    let transition = 1.0_f64.hypot(frequency / corner) / pole(corner, 0.63);
    let step = match vertical {
        true => pole(2.37, 0.91) / pole(3.35, 0.91) * (2.37_f64 / 3.35).powi(2),
        false => 1.0,
    };
    band * transition * step
}

#[test]
fn weighted_vibration_is_that_of_the_standard() {
    let folder = tempfile::tempdir().unwrap();
    let result = rolled(&["C@80km/h:12s"], folder.path());
    let record = columns(&folder.path().join("iso_C_80kmh_12s.csv"));
    for (mass, axis, vertical) in [("body", "z", true), ("wheel", "z", true), ("body", "x", false)] {
        let vibration = result["vibration"].as_array().unwrap().iter();
        let own = vibration
            .clone()
            .find(|own| own["mass"] == mass && own["axis"] == axis)
            .unwrap();
        let samples = &record[&format!("{axis}_{mass}_acceleration [m/s^2]")];
        let expected = weighted_power(samples, 1000.0, |frequency| magnitude(vertical, frequency)).sqrt();
        let found = own["weighted_rms"].as_f64().unwrap();
        // A filter begins at rest, and a transform takes the record for a period of a longer one.
        assert!(
            (found / expected - 1.0).abs() < 0.01,
            "{mass} {axis}: {found}, not {expected}"
        );
        assert_eq!(own["weighting"], if vertical { "Wk" } else { "Wd" });
        let plain = weighted_power(samples, 1000.0, |_| 1.0).sqrt();
        assert!((own["rms"].as_f64().unwrap() / plain - 1.0).abs() < 0.01);
    }
}

#[test]
fn spectra_of_a_linear_axle_are_those_of_the_road_times_its_response() {
    let folder = tempfile::tempdir().unwrap();
    rolled(&["B@100km/h:60s"], folder.path());
    let spectra = columns(&folder.path().join("iso_B_100kmh_60s_spectra.csv"));
    let response = succeeds(&[
        "frf",
        "axle_a",
        "--params",
        AXLE,
        "--channels",
        "pad_to_body",
        "--frequencies",
        "2:16:4",
        "--format",
        "json",
    ]);
    let response: Value = serde_json::from_str(&response).unwrap();
    let own = &response["channels"]["pad_to_body"];
    let list = |key: &str| {
        own[key]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_f64().unwrap())
            .collect::<Vec<_>>()
    };
    for (frequency, [re, im]) in list("frequency")
        .into_iter()
        .zip(list("re").into_iter().zip(list("im")).map(|(a, b)| [a, b]))
    {
        let line = spectra["frequency [Hz]"]
            .iter()
            .position(|own| (own - frequency).abs() < 1e-9);
        let line = line.unwrap();
        let road = spectra["road [m^2/Hz]"][line] * (TAU * frequency).powi(4);
        let found = (spectra["z_body_acceleration [(m/s^2)^2/Hz]"][line] / road).sqrt();
        let expected = re.hypot(im);
        // The axle is linear but for its tyre, which does not roll into the shortest waves and pulls at it, too; thirty
        // segments.
        assert!(
            (found / expected - 1.0).abs() < 0.06,
            "{frequency} Hz: {found}, not {expected}"
        );
    }
}

/// Its second difference is the acceleration of the wheel less that of the body, but for the error of the difference,
/// (2π f dt)²/12: 1 % at 55 Hz.
#[test]
fn the_suspension_travel_of_a_ride_is_the_height_of_the_wheel_over_the_body() {
    let folder = tempfile::tempdir().unwrap();
    let result = rolled(&["C@80km/h:5s"], folder.path());
    let record = columns(&folder.path().join("iso_C_80kmh_5s.csv"));
    let travel = &record["suspension_travel [m]"];
    let [wheel, body] = ["wheel", "body"].map(|mass| &record[&format!("z_{mass}_acceleration [m/s^2]")]);
    let (mut error, mut power) = (0.0, 0.0);
    for at in 1..travel.len() - 1 {
        let second = (travel[at + 1] - 2.0 * travel[at] + travel[at - 1]) * 1000.0_f64.powi(2);
        error += (second - (wheel[at] - body[at])).powi(2);
        power += second.powi(2);
    }
    assert!((error / power).sqrt() < 0.01, "{}", (error / power).sqrt());
    let largest = travel
        .iter()
        .fold(0.0_f64, |most, own| most.max((own - travel[0]).abs()));
    let found = result["loads"][0]["suspension_travel"].as_f64().unwrap();
    assert!(
        largest > 0.005 && (found - largest).abs() < 1e-9,
        "{found}, not {largest}"
    );
}

#[test]
fn a_road_is_the_same_from_whichever_file() {
    let folder = tempfile::tempdir().unwrap();
    let road = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(CRG)).unwrap();
    let [u, left] = ["u", "v=0.3"].map(|name| &road.signal(name).unwrap().samples);
    let table = |head: &str, scale: f64| {
        let rows = u
            .iter()
            .zip(left.iter())
            .map(|(u, z)| format!("{u};{};{}\n", scale * z, 0.0));
        format!("{head}\n{}", rows.collect::<String>())
    };
    fs::write(folder.path().join("metres.csv"), table("x;z;other [V]", 1.0)).unwrap();
    fs::write(
        folder.path().join("millimetres.txt"),
        table("Distance [m];right track [mm];left track [mm]", 1e3),
    )
    .unwrap();
    let [crg, metres, millimetres] = [
        format!("{CRG}#v=0.3@20km/h"),
        format!("{}@20km/h", folder.path().join("metres.csv").display()),
        format!("{}#right*@20km/h:1s", folder.path().join("millimetres.txt").display()),
    ];
    let out = folder.path().join("out");
    let result = rolled(&[&crg, &metres, &millimetres], &out);
    let names: Vec<&str> = result["loads"]
        .as_array()
        .unwrap()
        .iter()
        .map(|own| own["road"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        [
            "slope_banking_krbi_v=0.3_20kmh",
            "metres_20kmh",
            "millimetres_right__20kmh_1s"
        ]
    );
    let [crg, metres, millimetres] = [0, 1, 2].map(|at| columns(&out.join(format!("{}.csv", names[at]))));
    let (first, second) = (
        &crg["z_body_acceleration [m/s^2]"],
        &metres["z_body_acceleration [m/s^2]"],
    );
    assert_eq!((first.len(), millimetres["time [s]"].len()), (1071, 1000));
    for (at, (first, second)) in first.iter().zip(second).enumerate() {
        assert!((first - second).abs() < 1e-6, "{at}: {first} {second}");
    }
    // The third road is driven over as far as it was asked for.
    for (at, third) in millimetres["road [m]"].iter().enumerate() {
        assert!((third - metres["road [m]"][at]).abs() < 1e-6, "{at}");
    }
}

#[test]
fn what_is_no_road_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("gap.csv", "x,z\n0,0\n0.1,\n0.2,0.001\n0.3,0.002\n");
    write("back.csv", "x,z\n0,0\n0.1,0.001\n0.1,0.002\n0.2,0\n");
    write("times.csv", "time,z\n0,0\n0.1,0.001\n0.2,0.002\n");
    write("volts.csv", "x,z [V]\n0,0\n0.1,0.001\n0.2,0.002\n");
    write("two.csv", "x,position,z\n0,0,0\n0.1,0.1,0.001\n0.2,0.2,0.002\n");
    write("degrees.csv", "x,z,slope [deg]\n0,0,0\n0.1,0.001,0\n0.2,0.002,0\n");
    write("dash.csv", "x,z\n0,0\n0.1,0.001\n0.2,0.002\n");
    write("rough.csv", "x,z\n0,0\n0.1,0.01\n0.2,-0.01\n0.3,0.01\n0.4,-0.01\n");
    let border = "qcar-signals/tests/samples/crg/missing_border_kdbi.crg";
    let own = |file: &str| folder.path().join(file).display().to_string();
    for (road, parts) in [
        (
            format!("{}@20km/h", own("none.csv")),
            &["none.csv", "put the file there"][..],
        ),
        (
            format!("{}@20km/h", own("gap.csv")),
            &["gap.csv", "`z`", "sample 2 of 4", "fill the gap"],
        ),
        (
            format!("{}@20km/h", own("back.csv")),
            &["back.csv", "`x`", "0.1 m after 0.1 m at sample 3"],
        ),
        (
            format!("{}@20km/h", own("times.csv")),
            &["times.csv", "no channel of distances", "chainage"],
        ),
        (
            format!("{}@20km/h", own("volts.csv")),
            &["volts.csv", "no channel of heights in this file", "in m or mm"],
        ),
        (
            format!("{}#z@20km/h", own("volts.csv")),
            &["volts.csv", "`z`", "the unit `V`"],
        ),
        (
            format!("{}@20km/h", own("two.csv")),
            &["two.csv", "several channels of distances: `x`, `position`"],
        ),
        (
            format!("{}@20km/h", own("degrees.csv")),
            &["degrees.csv", "`slope`", "the unit `deg`", "1, m/m or %"],
        ),
        (
            format!("{}#x@20km/h", own("dash.csv")),
            &[
                "dash.csv",
                "`x`",
                "the distances along the road",
                "choose the channel of heights",
            ],
        ),
        (
            format!("{}@20km/h", own("dash.csv")),
            &["dash.csv", "a road that takes 0.036 s", "at least 1 s"],
        ),
        (
            format!("{}@20km/h", own("rough.csv")),
            &[
                "rough.csv",
                "rougher than its sampling",
                "a tyre can roll on chords; sample the profile finer",
            ],
        ),
        (
            format!("{CRG}@20km/h"),
            &["5 channels of heights, from `v=-0.6` to `v=0.6`", "after a `#`"],
        ),
        (format!("{CRG}#v=0.2@20km/h"), &["v=0.2", "the nearest are", "`v=0`"]),
        (format!("{CRG}#v=0@20km/h:9s"), &["ends at x = 5.95 m", "x = 50 m"]),
        (
            format!("{border}#v=-0.6@20km/h"),
            &["`v=-0.6`", "no value at sample 11 of 120"],
        ),
        ("C@20".into(), &["class of ISO 8608", "found `C@20`"]),
    ] {
        let ran = qcar(&["simulate", AXLE, "--road", &road]);
        assert_eq!(ran.status, 2, "{road}: {}", ran.stdout);
        let said = ran.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        for part in parts {
            assert!(said.contains(part), "{road}: `{part}` is not in: {said}");
        }
    }
    let short = qcar(&["simulate", AXLE, "--road", "C@20km/h:0.1s"]);
    assert!(
        short.status == 2 && short.stderr.contains("at least 1 s and at most 600 s"),
        "{}",
        short.stderr
    );
}

#[test]
fn a_ride_is_asked_for_once_by_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    let targets = folder.path().join("targets.toml");
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join(AXLE);
    let text = format!(
        "subject = \"axle_a\"\ncampaign = \"{}\"\nroads = [\"C@36km/h\", \"C@10m/s\"]\n\n\
         [[target]]\nmetric = \"mode.1.damping\"\nat_least = 0.1\n\n[[parameter]]\nname = \"k_susp\"\nrange = [\"80 %\", \"120 %\"]\n",
        campaign.display()
    );
    fs::write(&targets, text).unwrap();
    let twins = ["--road", "C@36km/h", "--road", "C@10m/s"];
    for (arguments, place) in [
        (
            &[&["simulate", AXLE][..], &twins].concat(),
            "command line, `--road C@10m/s`: ",
        ),
        (
            &[&["sensitivity", "axle_a", "--campaign", AXLE][..], &twins].concat(),
            "command line, `--road C@10m/s`: ",
        ),
        (&vec!["target", targets.to_str().unwrap()], "targets.toml, `roads`: "),
    ] {
        let ran = qcar(arguments);
        let said = ran.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            ran.status == 2 && said.contains(&format!("{place}found two rides called iso_C_36kmh")),
            "{arguments:?}: {said}"
        );
    }
}

#[test]
fn roads_carry_the_notes_of_their_campaign() {
    let text = succeeds(&["simulate", AXLE, "--road", "C@80km/h:1s", "--road", "C@80km/h:1.5s"]);
    let result: Value = serde_json::from_str(&succeeds(&[
        "simulate",
        AXLE,
        "--road",
        "C@80km/h:1s",
        "--format",
        "json",
    ]))
    .unwrap();
    let guessed: Vec<&str> = result["at_start"]
        .as_array()
        .unwrap()
        .iter()
        .map(|own| own.as_str().unwrap())
        .collect();
    assert!(!guessed.is_empty() && result["notices"].is_array());
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        text.contains(&format!(
            "note: {} still have the start values of the campaign",
            guessed.join(", ")
        )),
        "{text}"
    );
}

#[test]
fn a_cleat_may_be_a_road_of_a_measured_file() {
    let folder = tempfile::tempdir().unwrap();
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join(AXLE), folder.path());
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let road = read(&folder.path().join("road/cleat_20.csv.gz")).unwrap();
    let own = ["x", "z", "slope"].map(|name| road.signal(name).unwrap().samples.to_vec());
    let row = |at: usize| format!("{}\t{}\t{}\n", own[0][at], 1e3 * own[1][at], own[2][at]);
    let rows = (0..own[0].len()).map(row);
    let table = format!("Distance [m]\tProfile [mm]\tslope\n{}", rows.collect::<String>());
    fs::write(folder.path().join("road/cleat_20.txt"), table).unwrap();
    let measured = "file = \"road/cleat_20.txt\"\nsource = \"Prof*\"";
    assert!(text.contains("file = \"road/cleat_20.csv.gz\""));
    fs::write(&manifest, text.replace("file = \"road/cleat_20.csv.gz\"", measured)).unwrap();
    let of = |campaign: &str| -> Value {
        let result: Value = serde_json::from_str(&succeeds(&["simulate", campaign, "--format", "json"])).unwrap();
        result["summary"]["body_z"].clone()
    };
    let [own, plain] =
        [of(folder.path().to_str().unwrap()), of(AXLE)].map(|errors| errors["peak"]["median"].as_f64().unwrap());
    // What lies on one line to the micrometre becomes one piece, and a rounded millimetre may be on the other side of
    // that.
    assert!((own / plain - 1.0).abs() < 1e-5, "{own} {plain}");
}

#[test]
fn a_road_that_ends_before_its_run_makes_a_campaign_unfit() {
    let folder = tempfile::tempdir().unwrap();
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join(AXLE), folder.path());
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let path = folder.path().to_str().unwrap();
    assert_eq!(qcar(&["check", path]).status, 0);
    let cleat = text.find("kind = \"cleat\"").unwrap();
    let (before, after) = text.split_at(cleat);
    fs::write(
        &manifest,
        before.to_owned() + &after.replacen("speed = ", "speed = 9", 1),
    )
    .unwrap();
    let checked = qcar(&["check", path]);
    assert_eq!(checked.status, 1, "{}", checked.stdout);
    assert!(
        checked.stdout.contains("a road that ends at x = "),
        "{}",
        checked.stdout
    );
}
