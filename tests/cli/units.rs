//! Units: what a file declares means the same as its SI value, and everything is shown in the units that were asked
//! for.

use std::fs;
use std::path::Path;

use qcar_signals::read::read;
use serde_json::Value;

use crate::common::{copy, qcar, qcar_in, refused, repository, run_line, succeeds};
use crate::document::{blocks, commands};

const CAMPAIGN: &str = "models/campaigns/axle_a_rig";

/// Factors of units that a reader would look up, and of which none comes from the code.
const SIZES: [(&str, &str, f64); 7] = [
    ("N/m", "N/mm", 1e-3),
    ("N s/m", "N s/mm", 1e-3),
    ("m", "mm", 1e3),
    ("m/s", "mm/s", 1e3),
    ("m/s^2", "g", 1.0 / 9.80665),
    ("N", "N", 1.0),
    ("kg", "kg", 1.0),
];

fn size(shown: &str) -> (&'static str, f64) {
    let found = SIZES.iter().find(|(_, unit, _)| *unit == shown);
    let (si, _, size) = found.unwrap_or_else(|| panic!("the unit {shown} was not asked for"));
    (si, *size)
}

/// The rows of a table of the terminal, by heading; words are parted by two spaces.
fn rows(text: &str, first: &str) -> Vec<Vec<String>> {
    let lines = text.lines().skip_while(|line| !line.starts_with(first));
    let cells = |line: &str| {
        line.split("  ")
            .map(|cell| cell.trim().to_string())
            .filter(|cell| !cell.is_empty())
            .collect()
    };
    lines.take_while(|line| !line.is_empty()).map(cells).collect()
}

/// Five digits are printed.
fn same(a: &str, b: f64) -> bool {
    (a.parse::<f64>().unwrap() - b).abs() <= 1e-3 * b.abs()
}

#[test]
fn fitted_values_are_shown_in_the_units_asked_for() {
    let json: Value = serde_json::from_str(&succeeds(&[
        "fit",
        CAMPAIGN,
        "--format",
        "json",
        "--units",
        "engineering",
    ]))
    .unwrap();
    let text = succeeds(&["fit", CAMPAIGN, "--units", "engineering"]);
    let shown = rows(&text, "parameter");
    assert!(shown.len() > 10, "{text}");
    for row in &shown[1..] {
        let own = &json["parameters"][&row[0]];
        let (si, size) = size(&row[1]);
        assert_eq!(own["unit"], si, "{row:?}");
        assert!(same(&row[2], own["start"].as_f64().unwrap() * size), "{row:?}");
        assert!(same(&row[3], own["value"].as_f64().unwrap() * size), "{row:?}");
    }
}

#[test]
fn gradients_are_shown_in_the_units_asked_for() {
    let json: Value = serde_json::from_str(&succeeds(&["kc", CAMPAIGN, "--format", "json"])).unwrap();
    let text = succeeds(&["--units", "N/mm,N s/mm", "kc", CAMPAIGN]);
    for (row, own) in rows(&text, "test").iter().skip(1).zip(json.as_array().unwrap()) {
        let (si, size) = size(&row[2]);
        assert_eq!(own["unit"], si, "{row:?}");
        assert!(same(&row[3], own["value"].as_f64().unwrap() * size), "{row:?}");
    }
}

#[test]
fn matrices_are_shown_in_the_units_asked_for() {
    let of = |more: &[&str]| succeeds(&[&["matrices", "axle_a", "--params", CAMPAIGN], more].concat());
    let json: Value = serde_json::from_str(&of(&["--format", "json"])).unwrap();
    let text = of(&["--units", "mm,mm/s,g,kN"]);
    let sizes = [
        ("m", "mm", 1e3),
        ("m/s", "mm/s", 1e3),
        ("m/s^2", "g", 1.0 / 9.80665),
        ("N", "kN", 1e-3),
    ];
    for (block, of_rows, of_columns) in [
        ("A", "states", "states"),
        ("B", "states", "inputs"),
        ("D", "outputs", "inputs"),
    ] {
        let shown = rows(&text, &format!("{block} "));
        let named = |place: usize, kind: &str, cell: &str| {
            let own = &json[kind][place];
            let name = own["variable"].as_str().or(own["name"].as_str()).unwrap();
            let (_, unit, size) = sizes.iter().find(|(si, ..)| own["unit"] == *si).unwrap();
            assert_eq!(cell, format!("{name} [{unit}]"));
            *size
        };
        assert_eq!(shown.len(), 1 + json[block].as_array().unwrap().len(), "{text}");
        for (at, row) in shown[1..].iter().enumerate() {
            for (column, cell) in row[1..].iter().enumerate() {
                let size = named(at, of_rows, &row[0]) / named(column, of_columns, &shown[0][1 + column]);
                let own = json[block][at][column].as_f64().unwrap();
                assert!(same(cell, own * size), "{block} {row:?} {own}");
            }
        }
    }
}

#[test]
fn true_values_are_shown_in_the_units_asked_for() {
    let (si, own) = (
        succeeds(&["score", CAMPAIGN]),
        succeeds(&["score", CAMPAIGN, "--units", "engineering"]),
    );
    let (si, own) = (rows(&si, "parameter"), rows(&own, "parameter"));
    assert!(si.len() > 5 && si.len() == own.len(), "{own:?}");
    for (si, own) in si.iter().zip(&own).skip(1) {
        let (unit, size) = size(&own[1]);
        assert_eq!((&si[0], si[1].as_str()), (&own[0], unit));
        for at in [2, 3] {
            assert!(same(&own[at], si[at].parse::<f64>().unwrap() * size), "{own:?}");
        }
    }
}

#[test]
fn channels_of_a_file_are_shown_in_the_units_asked_for() {
    let file = "qcar-signals/tests/samples/mdf/plain_3groups.mf4";
    let json: Value = serde_json::from_str(&succeeds(&["inspect", file, "--format", "json"])).unwrap();
    let text = succeeds(&["inspect", file, "--units", "g,N,m"]);
    let shown = rows(&text, "channel");
    let expected = [
        ("wheel_left_z", "g", 1.0 / 9.80665),
        ("body_left_z", "g", 1.0),
        ("damper_force", "N", 1e3),
        ("spring_travel", "m", 1e-3),
        ("damper_temperature", "°C", 1.0),
    ];
    for (at, (name, unit, size)) in expected.into_iter().enumerate() {
        let (row, own) = (&shown[1 + at], &json["channels"][at]);
        assert_eq!((row[0].as_str(), row[2].as_str()), (name, unit));
        for (cell, key) in [(7, "min"), (8, "max"), (9, "rms")] {
            assert!(same(&row[cell], own[key].as_f64().unwrap() * size), "{row:?}");
        }
    }
    let workbook = succeeds(&[
        "inspect",
        "qcar-signals/tests/samples/table/vehicle_template.xlsx",
        "--units",
        "m,N/m",
    ]);
    let shown = rows(&workbook, "value");
    assert!(
        shown.iter().any(|row| row[..3] == ["wheelbase", "m", "2.65"]),
        "{workbook}"
    );
    assert!(
        shown.iter().any(|row| row[..3] == ["k_tire", "N/m", "225000"]),
        "{workbook}"
    );
}

#[test]
fn the_speed_of_a_sweep_is_told_in_the_unit_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let out = |parent: &str| folder.path().join(parent).join("campaign");
    let imported = |parent: &str, units: &str| {
        let (file, out) = (format!("{CAMPAIGN}/rig/sweep_025.csv.gz"), out(parent));
        fs::create_dir(out.parent().unwrap()).unwrap();
        let out = out.to_str().unwrap();
        succeeds(&["import", &file, "--out", out, "--model", "axle_a", "--units", units])
    };
    assert!(imported("si", "si").contains("30 Hz at 0.025 m/s"));
    assert!(imported("own", "mm/s").contains("30 Hz at 25 mm/s"));
    // What is written is the same.
    let written = |parent: &str| fs::read_to_string(out(parent).join("campaign.toml")).unwrap();
    assert_eq!(written("si"), written("own"));
}

#[test]
fn messages_about_roads_and_tyres_are_in_the_units_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    copy(Path::new(CAMPAIGN), &own);
    let text = fs::read_to_string(own.join("campaign.toml")).unwrap();
    let deep = text.replace("static_tire_def = 0.02361", "static_tire_def = 0.4");
    assert_ne!(text, deep);
    fs::write(own.join("campaign.toml"), deep).unwrap();
    let simulate = ["simulate", own.to_str().unwrap(), "--units"];
    let tyre = |units| qcar(&[&simulate[..], &[units]].concat());
    refused(
        &tyre("si"),
        &[
            "found a static deflection of 0.4 m, expected more than 0",
            "the radius, 0.35 m",
        ],
    );
    refused(
        &tyre("mm"),
        &[
            "found a static deflection of 400 mm, expected more than 0",
            "the radius, 350 mm",
        ],
    );
    // What is wrong in a file is quoted as it stands there, whatever the units of results.
    let slow = text.replacen("peak_velocity = 0.025", "peak_velocity = \"-25 mm/s\"", 1);
    assert_ne!(text, slow);
    fs::write(own.join("campaign.toml"), slow).unwrap();
    refused(
        &tyre("si"),
        &["peak_velocity`", "found \"-25 mm/s\", expected a number above zero"],
    );
    let profile = folder.path().join("back.csv");
    fs::write(&profile, "x [m],z [m]\n0,0\n1,0.01\n0.5,0\n2,0\n").unwrap();
    let road = format!("{}@30km/h", profile.display());
    let road = |units| qcar(&["simulate", CAMPAIGN, "--road", &road, "--units", units]);
    refused(&road("si"), &["found 0.5 m after 1 m at sample 3"]);
    refused(&road("engineering"), &["found 500 mm after 1000 mm at sample 3"]);
    let fast = |units| qcar(&["simulate", CAMPAIGN, "--road", "C@720km/h", "--units", units]);
    refused(
        &fast("si"),
        &["a speed of 200 m/s", "at least 0.5 m/s and at most 100 m/s"],
    );
    refused(
        &fast("km/h"),
        &["a speed of 720 km/h", "at least 1.8 km/h and at most 360 km/h"],
    );
}

/// A machine on mounts: its channel is a speed over a force.
const MACHINE: &str = "axle machine {
    \"A machine on mounts\"
    param m: kg = 100;
    param k: N/m = 300 N/mm;
    param c: N s/m = 400;
    direction z {
        mass engine = m;
        force shaker on engine;
        link mount: engine { spring k; damper c; }
        output engine.acceleration;
        channel mobility = engine.velocity / shaker.force;
    }
}
";

#[test]
fn a_channel_has_the_unit_of_its_signals_in_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("machine.axle");
    fs::write(&file, MACHINE).unwrap();
    let model = file.to_str().unwrap();
    let of = |verb: &[&str], units: &str| succeeds(&[&[verb[0], model], &verb[1..], &["--units", units]].concat());
    let frf = ["frf", "--frequencies", "5:10:2", "--format", "csv"];
    let magnitude = |text: &str| {
        let row: Vec<f64> = text
            .lines()
            .nth(1)
            .unwrap()
            .split(',')
            .map(|cell| cell.parse().unwrap())
            .collect();
        row[1].hypot(row[2])
    };
    let (si, own) = (of(&frf, "si"), of(&frf, "engineering"));
    assert!(
        si.starts_with("frequency [Hz],mobility_re [(m/s)/N],mobility_im [(m/s)/N]\n"),
        "{si}"
    );
    assert!(
        own.starts_with("frequency [Hz],mobility_re [(mm/s)/N],mobility_im [(mm/s)/N]\n"),
        "{own}"
    );
    assert!((magnitude(&own) / magnitude(&si) - 1e3).abs() < 1e-6, "{own}");
    let text = of(&["frf", "--frequencies", "5:10:2"], "engineering");
    assert!(text.contains("mobility_dB re 1 (mm/s)/N"), "{text}");
    // A comparison has the same decibels, with their reference.
    for (units, reference, size) in [("si", "(m/s)/N", 1.0), ("engineering", "(mm/s)/N", 1e3)] {
        let out = folder.path().join(units);
        let target = out.to_str().unwrap();
        succeeds(&[
            "compare",
            model,
            model,
            "--frequencies",
            "5:10:2",
            "--units",
            units,
            "--out",
            target,
        ]);
        let table = fs::read_to_string(out.join("transmissibility.csv")).unwrap();
        let row: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
        assert_eq!(row[1..3], ["mobility", &format!("dB re 1 {reference}")], "{table}");
        let decibels: f64 = row[4].parse().unwrap();
        assert!(
            (decibels - 20.0 * (size * magnitude(&si)).log10()).abs() < 1e-3,
            "{table}"
        );
        let page = fs::read_to_string(out.join("report.html")).unwrap();
        assert!(page.contains("\"unit\":\"(m/s)/N\""));
    }
    for (units, unit, size) in [("si", "(m/s)/N", 1.0), ("engineering", "(mm/s)/N", 1e3)] {
        let listed = of(&["sensitivity", "--list"], units);
        assert!(
            rows(&listed, "metric")
                .iter()
                .any(|row| row[..2] == ["mobility.peak", unit]),
            "{listed}"
        );
        // The largest mobility of a mass on a spring and a damper is 1/c.
        let table = of(&["sensitivity", "--metrics", "mobility.peak"], units);
        let row = rows(&table, "metric")
            .into_iter()
            .find(|row| row[0] == "mobility.peak")
            .unwrap();
        assert_eq!(row[2], unit);
        assert!(same(&row[1], size / 400.0), "{row:?}");
    }
}

/// A rotor on a shaft: its states turn.
const ROTOR: &str = "axle rotor {
    \"A rotor on a shaft\"
    param j: kg m^2 = 0.5;
    param k: N m/rad = 800 N m/rad;
    param c: N m s/rad = 0.5;
    direction phi {
        inertia load = j;
        force torque on load;
        link shaft: load { spring k; damper c; }
        output load.velocity;
        channel compliance = load.acceleration / torque.force;
    }
}
";

#[test]
fn an_angle_is_in_rad_and_no_other_number_is() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("rotor.axle");
    fs::write(&file, ROTOR).unwrap();
    let model = file.to_str().unwrap();
    let matrices = succeeds(&["matrices", model]);
    assert!(matrices.contains("phi_load [rad]  vphi_load [rad/s]"), "{matrices}");
    let matrices = succeeds(&["matrices", model, "--units", "deg,deg/s"]);
    assert!(matrices.contains("phi_load [deg]  vphi_load [deg/s]"), "{matrices}");
    let frf = succeeds(&["frf", model, "--frequencies", "1:2:2"]);
    assert!(frf.contains("compliance_dB re 1 (rad/s^2)/(N m)"), "{frf}");
    let table = succeeds(&["sensitivity", model, "--metrics", "mode.1.damping", "--units", "deg"]);
    let row = rows(&table, "metric")
        .into_iter()
        .find(|row| row[0] == "mode.1.damping")
        .unwrap();
    // c / (2 √(k j)).
    assert_eq!(row[2], "1");
    assert!(same(&row[1], 0.5 / (2.0 * 400f64.sqrt())), "{row:?}");
}

/// All files of a folder that are tables.
fn tables(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        match entry.is_dir() {
            true => found.extend(tables(&entry)),
            false if entry.extension().is_some_and(|ending| ending == "csv") => found.push(entry),
            false => {}
        }
    }
    found
}

/// Columns of words and of pure numbers, and those whose unit stands in a column `unit` beside them.
const WITHOUT: &str = "run channel role mass axis parameter quantity unit matrix row column fitted measured_re measured_im \
    before_re before_im after_re after_im peak_error after_shake_error nrms relative standard_errors measured_rms rms_error \
    a b difference stderr_a stderr_b coherence coherence_a coherence_b";

fn names_its_unit(heading: &str, headings: &[&str]) -> bool {
    let pure = WITHOUT.split_whitespace().any(|name| name == heading);
    let beside = [
        "measured_re",
        "measured_im",
        "before_re",
        "before_im",
        "after_re",
        "after_im",
        "measured_rms",
        "rms_error",
        "a",
        "b",
        "difference",
        "stderr_a",
        "stderr_b",
    ];
    let needs_beside = beside.contains(&heading);
    let ends = ["_re", "_im", "_dB", "_deg", "_%", "]"];
    (pure && (!needs_beside || headings.contains(&"unit"))) || ends.iter().any(|end| heading.ends_with(end))
}

#[test]
fn every_column_with_a_dimension_names_its_unit() {
    let folder = tempfile::tempdir().unwrap();
    let out = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let units = ["--units", "mm,g"];
    let write = |arguments: &[&str]| succeeds(&[arguments, &units].concat());
    write(&["fit", CAMPAIGN, "--out", &out("fit")]);
    write(&["simulate", CAMPAIGN, "--out", &out("rides")]);
    write(&["compare", CAMPAIGN, CAMPAIGN, "--out", &out("compared")]);
    let printed = [
        write(&["simulate", CAMPAIGN, "--format", "csv"]),
        write(&["frf", "axle_a", "--params", CAMPAIGN, "--format", "csv"]),
    ];
    let mut texts: Vec<(String, String)> = printed
        .into_iter()
        .map(|text| ("standard output".into(), text))
        .collect();
    let files = tables(folder.path());
    assert!(files.len() >= 8, "{files:?}");
    texts.extend(
        files
            .iter()
            .map(|file| (file.display().to_string(), fs::read_to_string(file).unwrap())),
    );
    for (name, text) in &texts {
        let heads = text.split("\n\n").filter_map(|table| table.trim_start().lines().next());
        for head in heads {
            let headings: Vec<&str> = head.split(',').collect();
            for heading in &headings {
                assert!(
                    names_its_unit(heading, &headings),
                    "{name}: `{heading}` has no unit in\n{head}"
                );
            }
        }
    }
}

/// What was written in other units is, for the reader of measured files, the run in SI.
#[test]
fn a_run_in_other_units_is_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    succeeds(&["simulate", CAMPAIGN, "--out", &out("si")]);
    succeeds(&["simulate", CAMPAIGN, "--out", &out("own"), "--units", "g,kN,ms,mm^2"]);
    let [si, own] = ["si", "own"].map(|name| read(&folder.path().join(name).join("v30_h20.csv")).unwrap());
    assert_eq!(si.signals.len(), own.signals.len());
    for (a, b) in si.signals.iter().zip(&own.signals) {
        let (unit, size) = match a.unit.as_str() {
            "m/s^2" => ("g", 1.0 / 9.80665),
            "N" => ("kN", 1e-3),
            "m^2" => ("mm^2", 1e6),
            other => (other, 1.0),
        };
        assert_eq!((&a.name, b.unit.as_str()), (&b.name, unit));
        let largest = a.samples.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        for (a, b) in a.samples.iter().zip(b.samples.iter()) {
            assert!((a * size - b).abs() <= 1e-12 * largest * size);
        }
    }
    let rates = [si, own].map(|recording| recording.signals[0].time.rate().unwrap());
    assert!((rates[0] / rates[1] - 1.0).abs() < 1e-9, "{rates:?}");
}

/// A campaign whose values, runs and tables are in other units gives what that in SI gives.
#[test]
fn a_campaign_may_declare_its_units() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    copy(Path::new(CAMPAIGN), &own);
    let text = fs::read_to_string(own.join("campaign.toml")).unwrap();
    let changed = [
        (
            "value = 187000.0\nunit = \"N/m\"\nrange = [93500.0, 374000.0]",
            "value = 187.0\nunit = \"N/mm\"\nrange = [93.5, 374.0]",
        ),
        (
            "value = 162.0\nunit = \"N s/m\"\nrange = [32.4, 810.0]",
            "value = 0.162\nunit = \"kN s/m\"\nrange = [0.0324, 0.81]",
        ),
        ("r_tire = 0.35", "r_tire = \"350 mm\""),
        ("static_tire_load = 4815.7", "static_tire_load = \"4.8157 kN\""),
        ("speed = 8.3333333", "speed = \"29.99999988 km/h\""),
        ("peak_velocity = 0.025\nstart", "peak_velocity = \"25 mm/s\"\nstart"),
        ("kc/bounce.csv.gz", "kc/bounce.csv"),
    ];
    let changed = changed.iter().fold(text, |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    fs::write(own.join("campaign.toml"), changed).unwrap();
    fs::write(own.join("kc/bounce.csv"), in_millimetres(&own.join("kc/bounce.csv.gz"))).unwrap();
    let own = own.to_str().unwrap();
    for verb in ["kc", "fit", "simulate"] {
        assert_eq!(seen(verb, own), seen(verb, CAMPAIGN), "{verb}");
    }
}

/// What a verb prints, but for the time it took.
fn seen(verb: &str, campaign: &str) -> Vec<String> {
    succeeds(&[verb, campaign]).lines().map(String::from).collect()
}

/// A curve of m and N in mm and kN.
fn in_millimetres(file: &Path) -> String {
    use std::io::Read;
    let mut text = String::new();
    flate2::read::GzDecoder::new(fs::File::open(file).unwrap())
        .read_to_string(&mut text)
        .unwrap();
    let row = |line: &str| {
        let values: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        format!("{},{}\n", values[0] * 1e3, values[1] * 1e-3)
    };
    "displacement [mm],force [kN]\n".to_string() + &text.lines().skip(1).map(row).collect::<String>()
}

#[test]
fn units_of_another_kind_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = |text: &str| fs::write(folder.path().join("values.toml"), text).unwrap();
    let frf = ["frf", "quarter_car", "--params", "values.toml"];
    for (text, expected) in [
        (
            "[parameters]\nk_tire = \"200 N s/m\"",
            "expected a unit of the kind of N/m, such as \"N/mm\"",
        ),
        (
            "[parameters]\nk_tire = \"200 N/mmm\"",
            "expected a number with its unit",
        ),
        (
            "[parameters]\nk_tire = { value = 200, unit = \"V\" }",
            "found the unit \"V\"",
        ),
        (
            "[vehicle]\nr_tire = \"3 kg\"\n[parameters]",
            "expected a number with a unit of the kind of m",
        ),
    ] {
        file(text);
        let ran = qcar_in(folder.path(), &frf);
        assert_eq!(ran.status, 2, "{text}\n{}", ran.stderr);
        assert!(
            ran.stderr.contains("values.toml, line ") && ran.stderr.contains(expected),
            "{text}\n{}",
            ran.stderr
        );
    }
    for (arguments, expected) in [
        (
            ["frf", "quarter_car", "--set", "k_tire=200 kg"],
            "a unit of the kind of N/m",
        ),
        (["frf", "quarter_car", "--units", "N/mmm"], "found `N/mmm`"),
        (["frf", "quarter_car", "--units", "m,mm"], "are of the same kind"),
    ] {
        let ran = qcar(&arguments);
        assert_eq!(ran.status, 2, "{arguments:?}");
        assert!(ran.stderr.contains(expected), "{arguments:?}\n{}", ran.stderr);
    }
    let [own, si] = ["k_tire=200 N/mm", "k_tire=2e5"].map(|set| succeeds(&["frf", "quarter_car", "--set", set]));
    assert_eq!(own, si);
}

/// `qcar kc --write` keeps the unit in which a value stands.
#[test]
fn a_start_value_is_written_in_its_unit() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    copy(Path::new(CAMPAIGN), &own);
    let text = fs::read_to_string(own.join("campaign.toml")).unwrap();
    let si = "value = 30500.0\nunit = \"N/m\"\nrange = [15200.0, 61000.0]";
    assert!(text.contains(si));
    fs::write(
        own.join("campaign.toml"),
        text.replace(si, "value = 30.5\nunit = \"N/mm\"\nrange = [15.2, 61.0]"),
    )
    .unwrap();
    succeeds(&["kc", own.to_str().unwrap(), "--write"]);
    let gradients: Value = serde_json::from_str(&succeeds(&["kc", CAMPAIGN, "--format", "json"])).unwrap();
    let of_wheel = gradients
        .as_array()
        .unwrap()
        .iter()
        .find(|own| own["parameter"] == "k_wheel_z")
        .unwrap();
    let value = of_wheel["parameter_value"].as_f64().unwrap();
    let written = fs::read_to_string(own.join("campaign.toml")).unwrap();
    let section = written.split("[parameters.k_wheel_z]\nvalue = ").nth(1).unwrap();
    let stated: f64 = section.lines().next().unwrap().parse().unwrap();
    assert!(
        (stated * 1e3 / value - 1.0).abs() < 1e-4,
        "{stated} N/mm and {value} N/m"
    );
}

/// The page opens in the units that were asked for, and still knows its own.
#[test]
fn a_report_opens_in_the_units_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let page = |units: &[&str]| {
        let out = folder.path().join(units.concat().replace('/', "_"));
        let compare = [
            "compare",
            "axle_c",
            "axle_c_rigid_tm",
            "--params",
            "models/campaigns/axle_c_study",
            "--out",
        ];
        succeeds(&[&compare[..], &[out.to_str().unwrap()], units].concat());
        fs::read_to_string(out.join("report.html")).unwrap()
    };
    assert!(!page(&[]).contains("view.units = 'si';"));
    assert!(page(&["--units", "si"]).contains("view.units = 'si';"));
    let own = page(&["--units", "kN/mm,cm"]);
    let chosen = own
        .split("SYSTEMS.chosen = ")
        .nth(1)
        .unwrap()
        .split(";\n")
        .next()
        .unwrap();
    let chosen: Value = serde_json::from_str(chosen).unwrap();
    assert_eq!(chosen["name"], "kN/mm, cm");
    assert_eq!(chosen["scales"]["N/m"], serde_json::json!([1e-6, "kN/mm"]));
    assert_eq!(chosen["scales"]["m"], serde_json::json!([100.0, "cm"]));
    assert!(own.contains("view.units = 'chosen';"));
}

#[test]
fn the_commands_of_the_documents_run() {
    let folder = repository();
    let commands: Vec<String> = ["docs/excel.md", "docs/campaign-format.md"]
        .iter()
        .flat_map(|document| blocks(document))
        .flat_map(|block| commands(&block).into_iter().map(String::from).collect::<Vec<_>>())
        .collect();
    assert!(commands.len() >= 4, "{commands:?}");
    for line in commands {
        let ran = run_line(folder.path(), &line);
        assert_eq!(ran.status, 0, "qcar {line}\n{}", ran.stderr);
    }
}
