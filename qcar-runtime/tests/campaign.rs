//! A campaign is read as it stands, and whatever is wrong with it is said with file, place and remedy.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use qcar_runtime::campaign::{Axis, Campaign, Quantity, RoadSamples, Role, Side, Spacing, Test, Truth};
use qcar_runtime::error::InputError;
use tempfile::TempDir;

const MANIFEST: &str = r#"format = 1
name = "bench"
description = "Two sweeps, curves and a cleat"
model = "quarter_car"

[vehicle]
m_corner = 400
gravity = 9.81

[parameters.k_tire]
value = 2.0e5
unit = "N/m"
range = [1.0e5, 4.0e5]
fit = true
comment = "static load over deflection"

[parameters.c_tire]
value = 150.0
unit = "N s/m"
fit = false

[[channel]]
name = "pad_left_z"
location = "pad"
side = "left"
axis = "z"
quantity = "acceleration"
unit = "m/s^2"

[[channel]]
name = "body_centre_z"
location = "body"
side = "centre"
axis = "z"
quantity = "acceleration"
unit = "m/s^2"

[[run]]
kind = "sweep"
file = "sweep.csv"
role = "fit"
peak_velocity = 0.1
start_frequency = 0.5
end_frequency = 30.0
spacing = "logarithmic"
sample_rate = 100.0

[[run]]
kind = "bounce"
file = "bounce.csv"
role = "fit"

[[run]]
kind = "dynamic_bounce"
file = "dynamic.csv"
role = "held_out"
peak_velocity = 0.075
amplitude = 0.02

[[run]]
kind = "cleat"
file = "cleat.csv.gz"
role = "held_out"
speed = 8.3333
sample_rate = 100.0
cleat = "step"

[[run]]
kind = "time_history"
file = "random.csv"
role = "fit"
sample_rate = 610.35
band_limited = true

[[road]]
name = "step"
file = "road.csv"
"#;

const SWEEP: &str = "time,pad_left_z,body_centre_z\n0.00,1,2\n0.01,3,4\n0.02,5,6\n0.03,7,8\n0.04,9,10\n";
const CURVE: &str = "displacement,force\n0.01,300\n0.0,0\n-0.01,-300\n";
const DYNAMIC: &str = "time,displacement,velocity,force\n0,0.02,0,500\n0.42,0,-0.075,-100\n0.84,-0.02,0,-500\n";
const CLEAT: &str = "time,body_centre_z\n0.00,0.5\n0.01,0.25\n0.02,0.125\n";
const RANDOM: &str = "time,body_centre_z\n0.0,1\n0.0016,2\n0.0033,3\n0.0049,4\n0.0066,5\n";
const ROAD: &str = "x,z,slope\n0,0,0\n0.5,0,0.1\n1.0,0.05,0\n";

/// A sound campaign, with `text` put for each `(file, old, text)`.
fn campaign(edits: &[(&str, &str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let files = [
        ("campaign.toml", MANIFEST),
        ("sweep.csv", SWEEP),
        ("bounce.csv", CURVE),
        ("dynamic.csv", DYNAMIC),
        ("cleat.csv.gz", CLEAT),
        ("random.csv", RANDOM),
        ("road.csv", ROAD),
    ];
    for (file, content) in files {
        let mut content = content.to_string();
        for (_, old, text) in edits.iter().filter(|edit| edit.0 == file) {
            assert!(content.contains(old), "{file} holds no {old:?}");
            content = content.replacen(old, text, 1);
        }
        write(&folder.path().join(file), &content);
    }
    folder
}

fn write(file: &Path, content: &str) {
    if file.extension().unwrap() != "gz" {
        return fs::write(file, content).unwrap();
    }
    let mut encoder = GzEncoder::new(fs::File::create(file).unwrap(), Compression::default());
    encoder.write_all(content.as_bytes()).unwrap();
    encoder.finish().unwrap();
}

/// Opens a campaign and reads everything in it.
fn read_all(folder: &Path) -> Result<(), InputError> {
    let campaign = Campaign::open(folder)?;
    for run in &campaign.runs {
        match run.test {
            Test::Sweep(_) | Test::Cleat { .. } | Test::TimeHistory(_) => drop(campaign.history(run)?),
            Test::Bounce | Test::Longitudinal => drop(campaign.curve(run)?),
            Test::DynamicBounce { .. } => drop(campaign.dynamic_curve(run)?),
            Test::Dynamometer(_) => drop(campaign.force_table(run)?),
        }
    }
    campaign.roads.iter().try_for_each(|road| campaign.road(road).map(drop))
}

#[test]
fn a_sound_campaign_is_read_as_it_stands() {
    let folder = campaign(&[]);
    let campaign = Campaign::open(folder.path()).unwrap();
    assert_eq!(
        (campaign.name.as_str(), campaign.model.as_str()),
        ("bench", "quarter_car")
    );
    assert_eq!(campaign.vehicle("m_corner"), Some(400.0));
    assert_eq!(campaign.vehicle("r_tire"), None);
    let k_tire = campaign.parameter("k_tire").unwrap();
    assert_eq!(
        (k_tire.value, k_tire.range, k_tire.fit),
        (2.0e5, Some((1.0e5, 4.0e5)), true)
    );
    assert_eq!(campaign.parameters[1].range, None);
    let body = campaign.channel("body_centre_z").unwrap();
    assert_eq!(
        (body.side, body.axis.clone(), body.quantity),
        (Side::Centre, Axis::Z, Quantity::Acceleration)
    );
    let Test::Sweep(sweep) = campaign.runs[0].test else {
        panic!("the first run is a sweep")
    };
    assert_eq!((sweep.start_frequency, sweep.spacing), (0.5, Spacing::Logarithmic));
    assert_eq!(campaign.runs[2].role, Role::HeldOut);
    assert!(campaign.notices.is_empty());
    read_all(folder.path()).unwrap();
}

#[test]
fn numbers_come_back_as_written() {
    let folder = campaign(&[]);
    let campaign = Campaign::open(folder.path()).unwrap();
    let sweep = campaign.history(&campaign.runs[0]).unwrap();
    assert_eq!(sweep.signal("body_centre_z"), Some(&[2.0, 4.0, 6.0, 8.0, 10.0][..]));
    assert_eq!((sweep.len(), sweep.start, sweep.sample_rate), (5, 0.0, 100.0));
    let cleat = campaign.history(&campaign.runs[3]).unwrap();
    assert_eq!(cleat.signal("body_centre_z"), Some(&[0.5, 0.25, 0.125][..]));
    assert_eq!(cleat.signal("pad_left_z"), None);
    assert_eq!(campaign.curve(&campaign.runs[1]).unwrap().force, [300.0, 0.0, -300.0]);
    assert_eq!(
        campaign.dynamic_curve(&campaign.runs[2]).unwrap().velocity,
        [0.0, -0.075, 0.0]
    );
    assert_eq!(campaign.road(&campaign.roads[0]).unwrap().slope, [0.0, 0.1, 0.0]);
}

#[test]
fn a_road_without_slopes_goes_straight_from_sample_to_sample() {
    let folder = campaign(&[("road.csv", ROAD, "x,z\n0,0\n0.5,0.1\n1.0,0.05\n")]);
    let campaign = Campaign::open(folder.path()).unwrap();
    let road = campaign.road(&campaign.roads[0]).unwrap();
    assert_eq!(
        (&road.z[..], &road.slope[..]),
        (&[0.0, 0.1, 0.05][..], &[0.2, -0.1, 0.0][..])
    );
}

#[test]
fn slopes_of_a_measured_road_have_their_unit_and_their_heights() {
    let folder = tempfile::tempdir().unwrap();
    let slopes = |head: &str, chosen: Option<&str>| {
        let file = folder.path().join("road.txt");
        fs::write(&file, format!("{head}\n0;0;0;30\n0.5;0.1;0.2;10\n1.0;0.05;0.1;0\n")).unwrap();
        RoadSamples::measured(&file, chosen).map(|road| road.slope)
    };
    let near = |found: Vec<f64>, expected: [f64; 3]| {
        let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
        assert!(
            found.len() == 3 && off.fold(0.0, f64::max) < 1e-12,
            "{found:?}, not {expected:?}"
        );
    };
    near(slopes("x;z;other;slope [%]", None).unwrap(), [0.3, 0.1, 0.0]);
    near(slopes("x;z;other;slope [m/m]", Some("z")).unwrap(), [30.0, 10.0, 0.0]);
    // Of other heights the slope says nothing.
    near(slopes("x;z;other;slope [%]", Some("other")).unwrap(), [0.4, -0.2, 0.0]);
    let said = slopes("x;z;other;slope [rad]", None).unwrap_err().to_string();
    assert!(said.contains("`slope`") && said.contains("the unit `rad`"), "{said}");
}

#[test]
fn a_channel_that_no_run_recorded_is_noticed() {
    let folder = campaign(&[("sweep.csv", "pad_left_z,body_centre_z", "body_centre_z,pad_left_z")]);
    assert!(Campaign::open(folder.path()).unwrap().notices.is_empty());
    let header = (
        "sweep.csv",
        "time,pad_left_z,body_centre_z\n0.00,1,2\n0.01,3,4\n",
        "time,body_centre_z\n0,1\n0.01,2\n",
    );
    let notices = Campaign::open(campaign(&[header]).path()).unwrap().notices;
    assert!(
        notices.len() == 1 && notices[0].contains("no run records the channel `pad_left_z`"),
        "{notices:?}"
    );
}

#[test]
fn the_answer_of_a_published_campaign_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("truth.toml");
    let text = "generator = \"a program\"\neffects = [ { name = \"dry\", at = \"damper\", parameters = { f = 95.0 } } ]\n\
                [parameters]\nk_tire = 2.1e5\nc_tire = 120\n";
    fs::write(&file, text).unwrap();
    let truth = Truth::read(&file).unwrap();
    assert_eq!(
        truth.parameters,
        [("k_tire".to_string(), 2.1e5), ("c_tire".to_string(), 120.0)]
    );
    assert_eq!(
        (truth.effects[0].at.as_str(), truth.effects[0].parameters[0].1),
        ("damper", 95.0)
    );
    fs::write(&file, text.replace("at =", "on =")).unwrap();
    assert_eq!(
        Truth::read(&file).unwrap_err().problems.len(),
        2,
        "a missing key and an unknown one"
    );
}

/// What each case puts in place of what, in which file.
const MISTAKES: &[(&str, (&str, &str, &str))] = &[
    ("broken syntax", ("campaign.toml", "name = \"bench\"", "name = bench")),
    ("another version", ("campaign.toml", "format = 1", "format = 2")),
    ("missing key", ("campaign.toml", "model = \"quarter_car\"\n", "")),
    (
        "unknown key",
        ("campaign.toml", "amplitude = 0.02", "amplitude = 0.02\nphase = 0"),
    ),
    (
        "misspelt key",
        ("campaign.toml", "side = \"centre\"", "sid = \"centre\""),
    ),
    (
        "unknown section",
        ("campaign.toml", "[[road]]", "[sensors]\na = 1\n\n[[road]]"),
    ),
    ("wrong type", ("campaign.toml", "fit = true", "fit = \"yes\"")),
    (
        "text for a number",
        ("campaign.toml", "m_corner = 400", "m_corner = \"four hundred\""),
    ),
    (
        "fact in a unit of another kind",
        ("campaign.toml", "m_corner = 400", "m_corner = \"400 mm\""),
    ),
    (
        "speed in a unit of another kind",
        ("campaign.toml", "speed = 8.3333", "speed = \"30 km\""),
    ),
    (
        "column in a unit of another kind",
        ("bounce.csv", "displacement,force", "displacement [mm/s],force [kN]"),
    ),
    (
        "axle without a workbook",
        ("campaign.toml", "format = 1", "format = 1\naxle = \"front\""),
    ),
    (
        "missing workbook",
        ("campaign.toml", "format = 1", "format = 1\nworkbook = \"vehicle.xlsx\""),
    ),
    ("infinite number", ("campaign.toml", "value = 150.0", "value = inf")),
    (
        "unknown kind",
        ("campaign.toml", "kind = \"bounce\"", "kind = \"bump\""),
    ),
    (
        "unknown role",
        ("campaign.toml", "role = \"held_out\"", "role = \"holdout\""),
    ),
    ("unknown side", ("campaign.toml", "side = \"left\"", "side = \"l\"")),
    ("unknown axis", ("campaign.toml", "axis = \"z\"", "axis = \"Z\"")),
    (
        "unknown quantity",
        ("campaign.toml", "quantity = \"acceleration\"", "quantity = \"jerk\""),
    ),
    (
        "wrong unit of a channel",
        ("campaign.toml", "unit = \"m/s^2\"", "unit = \"g\""),
    ),
    (
        "unit of another quantity",
        ("campaign.toml", "unit = \"m/s^2\"", "unit = \"m/s\""),
    ),
    (
        "parameter in a unit that nobody knows",
        ("campaign.toml", "unit = \"N/m\"", "unit = \"N/mmm\""),
    ),
    (
        "start outside its range",
        ("campaign.toml", "value = 2.0e5", "value = 2.0e6"),
    ),
    ("reversed range", ("campaign.toml", "[1.0e5, 4.0e5]", "[4.0e5, 1.0e5]")),
    ("half a range", ("campaign.toml", "[1.0e5, 4.0e5]", "[1.0e5]")),
    (
        "channel twice",
        ("campaign.toml", "name = \"body_centre_z\"", "name = \"pad_left_z\""),
    ),
    (
        "channel named time",
        ("campaign.toml", "name = \"pad_left_z\"", "name = \"time\""),
    ),
    (
        "file twice",
        ("campaign.toml", "file = \"random.csv\"", "file = \"sweep.csv\""),
    ),
    ("speed of zero", ("campaign.toml", "speed = 8.3333", "speed = 0.0")),
    (
        "unknown cleat",
        ("campaign.toml", "cleat = \"step\"", "cleat = \"steep\""),
    ),
    (
        "reversed sweep",
        ("campaign.toml", "start_frequency = 0.5", "start_frequency = 31.0"),
    ),
    (
        "sweep above half the rate",
        ("campaign.toml", "end_frequency = 30.0", "end_frequency = 60.0"),
    ),
    (
        "missing file",
        ("campaign.toml", "file = \"bounce.csv\"", "file = \"kc/bounce.csv\""),
    ),
    ("empty file", ("bounce.csv", CURVE, "")),
    ("header only", ("bounce.csv", "\n0.01,300\n0.0,0\n-0.01,-300\n", "\n")),
    ("missing column", ("dynamic.csv", "velocity", "speed")),
    ("unknown column", ("sweep.csv", "body_centre_z", "body_center_z")),
    ("column twice", ("sweep.csv", "body_centre_z", "pad_left_z")),
    ("semicolons", ("bounce.csv", "displacement,force", "displacement;force")),
    ("missing cell", ("sweep.csv", "0.02,5,6", "0.02,5")),
    ("empty cell", ("sweep.csv", "0.02,5,6", "0.02,,6")),
    ("text cell", ("sweep.csv", "0.02,5,6", "0.02,5,overload")),
    ("NaN", ("sweep.csv", "0.02,5,6", "0.02,nan,6")),
    ("infinity", ("bounce.csv", "300", "inf")),
    ("time goes back", ("sweep.csv", "0.02,5,6", "0.005,5,6")),
    ("time stands", ("cleat.csv.gz", "0.02", "0.01")),
    ("gap", ("sweep.csv", "0.03,7,8\n0.04", "0.13,7,8\n0.14")),
    (
        "another sample rate",
        (
            "campaign.toml",
            "sample_rate = 100.0\n\n[[run]]\nkind = \"bounce\"",
            "sample_rate = 1000.0\n\n[[run]]\nkind = \"bounce\"",
        ),
    ),
    (
        "a sample rate that is a little off",
        ("campaign.toml", "sample_rate = 610.35", "sample_rate = 720.0"),
    ),
    (
        "half the sample rate",
        ("campaign.toml", "sample_rate = 610.35", "sample_rate = 305.0"),
    ),
    ("single sample", ("cleat.csv.gz", "0.01,0.25\n0.02,0.125\n", "")),
    ("no channel", ("random.csv", RANDOM, "time\n0\n0.0016\n")),
    ("dynamic time goes back", ("dynamic.csv", "0.84,", "0.05,")),
    ("road goes back", ("road.csv", "1.0,0.05", "0.4,0.05")),
];

#[test]
fn every_mistake_is_named_with_its_place_and_remedy() {
    let mut report = String::new();
    for (name, edit) in MISTAKES {
        let folder = campaign(&[*edit]);
        let error = read_all(folder.path()).expect_err(name);
        let _ = write!(
            report,
            "## {name}\n{}\n\n",
            error.to_string().replace(folder.path().to_str().unwrap(), "DIR")
        );
    }
    insta::assert_snapshot!(report);
}

/// A vertical sine of 20 mm at 0.6 Hz with rests before and after, by its factors on velocity and displacement.
fn sine([velocity, displacement]: [f64; 2]) -> String {
    let mut text = "time,displacement,velocity,force\n".to_string();
    let omega = 0.075 / 0.02;
    for row in 0..1500 {
        let t = 0.01 * f64::from(row);
        let moves = if (2.0..12.0).contains(&t) { 1.0 } else { 0.0 };
        let (sin, cos) = (omega * (t - 2.0)).sin_cos();
        let _ = writeln!(
            text,
            "{t},{},{},{}",
            displacement * moves * 0.02 * sin,
            velocity * moves * 0.075 * cos,
            300.0 * sin
        );
    }
    text
}

#[test]
fn a_sine_agrees_with_itself_and_with_its_set_values() {
    let read = |text: String, old: &str, new: &str| {
        let folder = campaign(&[("dynamic.csv", DYNAMIC, &text), ("campaign.toml", old, new)]);
        let campaign = Campaign::open(folder.path()).unwrap();
        let said = campaign.dynamic_curve(&campaign.runs[2]).map(drop);
        said.map_err(|error| error.to_string())
    };
    let none = ("name = \"bench\"", "name = \"bench\"");
    read(sine([1.0, 1.0]), none.0, none.1).unwrap();
    let refused = |text: String, (old, new): (&str, &str), fragments: &[&str]| {
        let said = read(text, old, new).unwrap_err();
        for fragment in fragments {
            assert!(said.contains(fragment), "expected `{fragment}` in {said}");
        }
        said
    };
    let slow = refused(
        sine([1.0, 1.0]).replace("velocity", "velocity [mm/s]"),
        none,
        &[
            "dynamic.csv, `velocity`",
            "velocities of 0.00",
            "such as `velocity [mm/s]`",
        ],
    );
    assert!(slow.contains("times `peak_velocity`"), "{slow}");
    refused(sine([-1.0, 1.0]), none, &["velocities of -", "or a sign"]);
    let peak = ("peak_velocity = 0.075", "peak_velocity = 7.5");
    let said = refused(
        sine([1.0, 1.0]),
        peak,
        &["a peak velocity of 0.07", "expected one near `peak_velocity = 7.5`"],
    );
    assert_eq!(said.lines().count(), 1, "{said}");
    let amplitude = ("amplitude = 0.02", "amplitude = 20");
    refused(
        sine([1.0, 1.0]),
        amplitude,
        &[
            "dynamic.csv, `displacement`: found an amplitude of 0.0",
            "times `amplitude`",
        ],
    );
}

/// A campaign of one dynamometer run, with its table and the key for its amplitude.
fn forces(table: &str, amplitude: &str) -> Result<(), String> {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "format = 1\nname = \"bench\"\nmodel = \"damper_dyno\"\n[[run]]\nkind = \"dynamometer\"\nfile = \"t.csv\"\n\
         role = \"fit\"\nlink = \"damper\"\namplitude = \"{amplitude}\"\nuncertainty = \"8 N\"\n"
    );
    fs::write(folder.path().join("campaign.toml"), text).unwrap();
    fs::write(folder.path().join("t.csv"), table).unwrap();
    let campaign = Campaign::open(folder.path()).unwrap();
    let read = campaign.force_table(&campaign.runs[0]).map(drop);
    read.map_err(|error| error.to_string())
}

#[test]
fn a_dynamometer_has_speeds_that_its_sines_reach() {
    let rows = "-1,-350\n-0.1,-110\n0.1,110\n1,350\n";
    forces(&format!("velocity,force\n{rows}"), "50 mm").unwrap();
    // Friction at creeping speeds alone.
    forces("velocity,force\n-0.002,-80\n0.002,80\n", "25 mm").unwrap();
    for (header, amplitude) in [
        ("velocity [mm/s],force", "50 mm"),
        ("velocity,force", "50 m"),
        ("velocity,force", "50 um"),
    ] {
        let said = forces(&format!("{header}\n{rows}"), amplitude).unwrap_err();
        assert!(
            said.contains("t.csv, `velocity`: found a largest speed of") && said.contains("from 0.01 to 100 Hz"),
            "{said}"
        );
    }
    let said = forces("velocity,force\n0.1,110\n", "50 mm").unwrap_err();
    assert!(
        said.contains("t.csv: found a single row, expected at least two"),
        "{said}"
    );
}

/// Each says in one sentence what to write.
#[test]
fn tables_of_other_programs_are_told_how_to_be_read() {
    let said = |edit: (&str, &str, &str)| {
        let folder = campaign(&[edit]);
        let said = read_all(folder.path()).unwrap_err().to_string();
        assert_eq!(said.lines().count(), 1, "{said}");
        said
    };
    for (separator, name) in [(";", "semicolons"), ("\t", "tabulators")] {
        let text = SWEEP.replace(',', separator);
        let said = said(("sweep.csv", SWEEP, &text));
        assert!(
            said.contains(&format!(
                "sweep.csv, line 1: found columns that are separated by {name}, expected commas"
            )),
            "{said}"
        );
        assert!(said.contains("rename it to end in .txt"), "{said}");
    }
    for cell in ["overload", "0x10", "1 000.0", "\"1,5\""] {
        let said = said(("sweep.csv", "0.02,5,6", &format!("0.02,{cell},6")));
        assert!(said.contains("write a number such as 1000.0"), "{said}");
    }
    assert!(said(("sweep.csv", "0.02,5,6", "0.02,,6")).contains("a missing sample"));
    assert!(said(("sweep.csv", "time", "tme")).contains("column `tme`: found an unknown column"));
    assert!(said(("sweep.csv", "time", "tme")).contains("did you mean `time`?"));
    assert!(said(("sweep.csv", "body_centre_z", "body_center_z")).contains("did you mean `body_centre_z`?"));
    assert!(said(("campaign.toml", "\"held_out\"", "\"heldout\"")).contains("did you mean \"held_out\"?"));
    assert!(said(("campaign.toml", "cleat = \"step\"", "cleat = \"stepp\"")).contains("did you mean \"step\"?"));
}

/// The renamed file, as the message for it advises, is read to the same numbers.
#[test]
fn a_renamed_table_with_semicolons_is_read() {
    let folder = campaign(&[("campaign.toml", "sweep.csv", "sweep.txt")]);
    let text = SWEEP.replace(',', ";").replace('.', ",");
    fs::write(folder.path().join("sweep.txt"), text).unwrap();
    let campaign = Campaign::open(folder.path()).unwrap();
    let sweep = campaign.history(&campaign.runs[0]).unwrap();
    assert_eq!(sweep.signal("body_centre_z"), Some(&[2.0, 4.0, 6.0, 8.0, 10.0][..]));
}

#[test]
fn broken_toml_is_told_with_its_line_and_a_remedy() {
    let said = |old: &str, new: &str| {
        let folder = campaign(&[("campaign.toml", old, new)]);
        Campaign::open(folder.path()).unwrap_err().to_string()
    };
    let cases = [
        (
            "m_corner = 400",
            "m_corner = 400,5",
            ["found `400,5`", "a number such as 400.5", "write a decimal point"],
        ),
        (
            "[vehicle]",
            "[vehicle",
            ["line 6", "in `[vehicle`", "close it on this line"],
        ),
        (
            "gravity = 9.81",
            "m_corner = 401",
            ["line 8", "in `m_corner = 401`", "rename or remove one of the two"],
        ),
        (
            "name = \"bench\"",
            "name = bench",
            ["line 2", "in `name = bench`", "put the text in quotes"],
        ),
    ];
    for (old, new, fragments) in cases {
        let said = said(old, new);
        for fragment in fragments {
            assert!(said.contains(fragment), "expected `{fragment}` in {said}");
        }
    }
}

#[test]
fn the_file_of_a_campaign_stands_for_its_folder() {
    let folder = campaign(&[]);
    let file = folder.path().join("campaign.toml");
    let opened = Campaign::open(&file).unwrap();
    assert_eq!(opened.folder, folder.path());
    fs::remove_file(&file).unwrap();
    let error = Campaign::open(folder.path()).unwrap_err().to_string();
    assert!(
        error.contains("campaign.toml: found no such file, expected a readable text file"),
        "{error}"
    );
}

#[test]
fn a_folder_without_a_campaign_is_named() {
    let error = Campaign::open("no/such/campaign").unwrap_err().to_string();
    assert!(error.starts_with("no/such/campaign/campaign.toml: found "), "{error}");
}

#[test]
fn blank_lines_and_line_ends_leave_line_numbers_right() {
    let gap = "time,body_centre_z\n0.0,1\n\n  \n0.0016,2\n\n0.5,3\n\n\n0.5016,4\n0.5033,5\n";
    let text = "time,body_centre_z\n0.0,1\n\n0.0016,2\n\n\n0.0033,x";
    for content in [gap, &gap.replace('\n', "\r\n"), text, &text.replace('\n', "\r\n")] {
        let folder = campaign(&[("random.csv", RANDOM, content)]);
        let error = read_all(folder.path()).unwrap_err().to_string();
        assert!(error.contains("random.csv, line 7, "), "{content:?}: {error}");
    }
}

#[test]
fn a_run_of_no_kind_is_refused_for_that_alone() {
    let folder = campaign(&[("campaign.toml", "kind = \"sweep\"", "kind = \"sweeep\"")]);
    let problems = Campaign::open(folder.path()).unwrap_err().problems;
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert!(
        problems[0].to_string().contains("`run[1].kind`: found \"sweeep\""),
        "{}",
        problems[0]
    );
}

#[test]
fn problems_of_one_file_come_together() {
    let folder = campaign(&[
        ("campaign.toml", "role = \"fit\"", "role = \"train\""),
        ("campaign.toml", "speed = 8.3333", "speed = -1"),
        ("campaign.toml", "unit = \"m/s^2\"", "unit = \"mm/s^2\""),
    ]);
    assert_eq!(Campaign::open(folder.path()).unwrap_err().problems.len(), 3);
}

#[test]
fn a_cut_or_false_gzip_file_is_refused() {
    let folder = campaign(&[]);
    let file = folder.path().join("cleat.csv.gz");
    let whole = fs::read(&file).unwrap();
    for length in [0, 5, whole.len() / 2, whole.len() - 4] {
        fs::write(&file, &whole[..length]).unwrap();
        let error = read_all(folder.path()).unwrap_err().to_string();
        assert!(error.contains("cleat.csv.gz"), "{length} bytes: {error}");
    }
    fs::write(&file, CLEAT).unwrap();
    assert!(read_all(folder.path()).unwrap_err().to_string().contains("gz"));
    fs::write(folder.path().join("sweep.csv"), whole).unwrap();
    assert!(read_all(folder.path()).unwrap_err().to_string().contains("sweep.csv"));
}

#[test]
fn a_folder_is_no_file() {
    let folder = campaign(&[]);
    fs::remove_file(folder.path().join("bounce.csv")).unwrap();
    fs::create_dir(folder.path().join("bounce.csv")).unwrap();
    let error = read_all(folder.path()).unwrap_err().to_string();
    assert!(
        error.contains("bounce.csv: found a folder, expected a readable file"),
        "{error}"
    );
}

#[test]
fn a_curve_is_no_time_history() {
    let folder = campaign(&[]);
    let campaign = Campaign::open(folder.path()).unwrap();
    assert!(campaign.history(&campaign.runs[1]).is_err());
    assert!(campaign.curve(&campaign.runs[0]).is_err());
    assert!(campaign.dynamic_curve(&campaign.runs[1]).is_err());
}
