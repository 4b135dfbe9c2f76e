//! Every sample file is read to what other programs read in it, and every trap is refused for its reason.
//!
//! `samples/README.md` says where the files come from. Those that are not in the repository are read from the folder
//! that `QCAR_FORMAT_SAMPLES` names.

use std::fs;
use std::path::{Path, PathBuf};

use qcar_signals::error::Place;
use qcar_signals::read::{read, recognise};
use qcar_signals::signal::{Recording, Signal, TimeBase, Value};
use serde_json::Value as Json;

fn samples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/samples")
}

/// The path of a sample, or nothing where it is not here.
fn sample(name: &str) -> Option<PathBuf> {
    let elsewhere = std::env::var_os("QCAR_FORMAT_SAMPLES").map(|folder| Path::new(&folder).join(name));
    let found = [Some(samples().join(name)), elsewhere]
        .into_iter()
        .flatten()
        .find(|path| path.exists());
    if found.is_none() {
        println!("{name} is not in the repository: QCAR_FORMAT_SAMPLES names the folder that has it");
    }
    found
}

fn expected() -> Json {
    serde_json::from_str(&fs::read_to_string(samples().join("expected.json")).unwrap()).unwrap()
}

/// Reads all samples of a folder and compares them; gives them back by name.
fn agree(folder: &str) {
    let expected = expected();
    for (name, file) in expected["files"].as_object().unwrap() {
        if !name.starts_with(folder) {
            continue;
        }
        let Some(path) = sample(name) else { continue };
        let recording = read(&path).unwrap_or_else(|error| panic!("{error}"));
        for channel in file["channels"].as_array().unwrap() {
            agree_in_channel(name, channel, &recording);
        }
        let times = file["channels"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|channel| is_time(channel))
            .count();
        let raw = file["channels"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|channel| channel["bytes_per_sample"].is_u64());
        let listed = file["channels"].as_array().unwrap().len() - times - raw.count();
        assert_eq!(recording.signals.len(), listed, "{name}: {:?}", names(&recording));
    }
}

fn names(recording: &Recording) -> Vec<&str> {
    recording.signals.iter().map(|signal| signal.name.as_str()).collect()
}

/// A channel that a recording keeps as the time base of the others.
fn is_time(channel: &Json) -> bool {
    channel["name"] == "Time"
}

fn agree_in_channel(file: &str, channel: &Json, recording: &Recording) {
    let name = channel["name"].as_str().unwrap();
    let what = format!("{file}, {name}");
    if channel["bytes_per_sample"].is_u64() {
        assert!(recording.passed_over.iter().any(|passed| passed.name == name), "{what}");
        return;
    }
    if is_time(channel) {
        let TimeBase::Times(times) = &recording.signals[0].time else {
            panic!("{what}: no times");
        };
        agree_in_numbers(&what, channel, times);
        return;
    }
    let signal = recording
        .signal(name.trim_matches('"'))
        .unwrap_or_else(|fault| panic!("{file}: {fault}"));
    assert_eq!(
        signal.unit,
        channel["unit"].as_str().unwrap().trim_matches('"'),
        "{what}"
    );
    agree_in_time(&what, channel, signal);
    if channel["last"].is_string() {
        agree_in_labels(&what, channel, signal);
    } else {
        agree_in_numbers(&what, channel, &signal.samples.to_vec());
    }
    if let Some(invalid) = channel["invalid_samples"].as_array() {
        let missing = signal.samples.iter().enumerate().filter(|(_, value)| value.is_nan());
        let missing: Vec<u64> = missing.map(|(at, _)| at as u64).collect();
        assert_eq!(
            missing,
            invalid.iter().map(|at| at.as_u64().unwrap()).collect::<Vec<_>>(),
            "{what}"
        );
    }
}

fn agree_in_time(what: &str, channel: &Json, signal: &Signal) {
    if let Some(step) = channel["dt_s"].as_f64() {
        assert!(
            matches!(signal.time, TimeBase::Even { step: own, .. } if (own - step).abs() <= f64::EPSILON * step),
            "{what}: {:?}",
            signal.time
        );
    }
    let Some(time) = channel.get("time") else { return };
    let count = time["n"].as_u64().unwrap() as usize;
    let (start, end) = match &signal.time {
        TimeBase::Even { start, step } => (*start, start + step * (count - 1) as f64),
        TimeBase::Times(times) => {
            assert_eq!(times.len(), count, "{what}");
            (times[0], times[count - 1])
        }
        TimeBase::Uneven { .. } | TimeBase::Unknown => panic!("{what}: no time base"),
    };
    for (found, expected) in [(start, &time["start"]), (end, &time["end"])] {
        let expected = expected.as_f64().unwrap();
        assert!(
            (found - expected).abs() <= 1e-14 * expected.abs(),
            "{what}: {found} s, not {expected} s"
        );
    }
}

fn agree_in_labels(what: &str, channel: &Json, signal: &Signal) {
    let label = |value: f64| &signal.labels.iter().find(|(code, _)| *code == value).unwrap().1;
    let first: Vec<_> = signal.samples.range(0..3).map(|value| label(value).as_str()).collect();
    let expected: Vec<_> = channel["first3"]
        .as_array()
        .unwrap()
        .iter()
        .map(|text| text.as_str().unwrap())
        .collect();
    assert_eq!(first, expected, "{what}");
    assert_eq!(
        label(signal.samples.iter().next_back().unwrap()),
        channel["last"].as_str().unwrap(),
        "{what}"
    );
}

fn agree_in_numbers(what: &str, channel: &Json, samples: &[f64]) {
    assert_eq!(samples.len() as u64, channel["n"].as_u64().unwrap(), "{what}");
    let valid: Vec<f64> = samples.iter().copied().filter(|value| value.is_finite()).collect();
    let missing = channel["n_missing"].as_u64().unwrap_or(0);
    assert_eq!((samples.len() - valid.len()) as u64, missing, "{what}");
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / valid.len() as f64;
    let rms = mean(&mut valid.iter().map(|value| value * value)).sqrt();
    let mut pairs: Vec<(f64, &Json)> = samples
        .iter()
        .copied()
        .zip(channel["first3"].as_array().unwrap())
        .collect();
    pairs.extend([
        (samples[samples.len() - 1], &channel["last"]),
        (mean(&mut valid.iter().copied()), &channel["mean"]),
        (rms, &channel["rms"]),
    ]);
    for (found, expected) in pairs {
        same(what, found, expected, rms);
    }
}

/// Equal in all nine digits that are given. `size` is that of what was summed, whose rounding a small mean shows.
fn same(what: &str, found: f64, expected: &Json, size: f64) {
    let Some(expected) = expected.as_f64() else {
        assert!(found.is_nan(), "{what}: {found}, not nothing");
        return;
    };
    let last_digit = match expected {
        0.0 => 0.0,
        _ => 10f64.powf(expected.abs().log10().floor() - 8.0),
    };
    let rounding = 0.5 * last_digit + 1e-14 * size;
    assert!((found - expected).abs() <= rounding, "{what}: {found}, not {expected}");
}

/// What is said of the first bytes of a sample.
fn fault_of_cut(name: &str, bytes: usize) -> String {
    let whole = fs::read(samples().join(name)).unwrap();
    recognise(&whole[..bytes]).unwrap_err().to_string()
}

fn says(fault: &str, parts: &[&str]) {
    for part in parts {
        assert!(fault.contains(part), "`{part}` is not in: {fault}");
    }
}

#[test]
fn tables_of_text() {
    agree("table/kc_semi");
    agree("table/rig");
}

#[test]
fn workbooks() {
    agree("table/kc_bounce");
    agree("table/vehicle");
    let fault = fault_of_cut("table/kc_bounce.xlsx", 5919);
    says(&fault, &["no ZIP directory at the end", "cut off", "copy it again"]);
}

#[test]
fn named_cells_of_a_workbook_are_single_values() {
    let recording = read(&samples().join("table/vehicle_template.xlsx")).unwrap();
    let expected = &expected()["files"]["table/vehicle_template.xlsx"]["cells"];
    for cell in expected.as_array().unwrap() {
        let name = cell["name"].as_str().unwrap();
        let scalar = recording.scalars.iter().find(|scalar| scalar.name == name).unwrap();
        assert_eq!(scalar.unit, cell["unit"].as_str().unwrap(), "{name}");
        assert_eq!(
            scalar.place,
            Place::Sheet("Vehicle".into(), cell["cell"].as_str().unwrap().into()),
            "{name}"
        );
        let value = match (&cell["value"], name) {
            (Json::Number(number), _) => Value::Number(number.as_f64().unwrap()),
            (Json::String(text), _) => Value::Text(text.clone()),
            (_, "m_sprung") => Value::Formula("C3-C4".into()),
            _ => Value::Empty,
        };
        assert_eq!(scalar.value, value, "{name}");
    }
}

#[test]
fn mdf() {
    agree("mdf/");
    let fault = fault_of_cut("mdf/plain_3groups.mf4", 28683);
    says(
        &fault,
        &["the first data group", "byte 49520", "28683 bytes", "cut off"],
    );
}

#[test]
fn uff() {
    agree("uff/");
    let fault = fault_of_cut("uff/151_164_58_58b.uff", 56067);
    says(
        &fault,
        &[
            "`damper_force`",
            "8192 bytes",
            "1970 bytes",
            "-1",
            "the 3 functions before it are whole",
        ],
    );
}

#[test]
fn a_geometry_has_no_channel_and_says_so() {
    let geometry = read(&samples().join("uff/testlab_151_164_geometry.uff")).unwrap();
    let nodes = &geometry.passed_over[1];
    assert_eq!(
        (nodes.name.as_str(), nodes.why.as_str()),
        ("dataset 15", "nodes of a geometry, no measured function")
    );
}

#[test]
fn rpc() {
    agree("rpc/");
    let fault = fault_of_cut("rpc/short_4frames_group.tim", 26881);
    let parts = [
        "2 groups (7 frames of 512, 4 channels, 32768 bytes)",
        "21249 bytes",
        "1 group is whole",
        "2048 samples",
    ];
    says(&fault, &parts);
}

#[test]
fn crg() {
    agree("crg/");
}

#[test]
fn tdms() {
    agree("tdms/");
    let fault = fault_of_cut("tdms/waveform_2segments.tdms", 68623);
    says(
        &fault,
        &[
            "56000 bytes",
            "38845 bytes",
            "segment 2",
            "the segment before it is whole",
        ],
    );
}

#[test]
fn mat() {
    agree("mat/");
    let fault = fault_of_cut("mat/testlab_v7.mat", 37767);
    says(
        &fault,
        &[
            "`Signal_2`",
            "15827 bytes",
            "6483 bytes",
            "2 variables before it are whole: Signal_0, Signal_1",
        ],
    );
    let fault = fault_of_cut("mat/scipy_v4.mat", 5000);
    says(
        &fault,
        &[
            "`acc`",
            "3200 bytes",
            "1754 bytes",
            "cut off",
            "the variable before it is whole: t",
        ],
    );
}

#[test]
fn single_values_of_a_mat_file_stand_beside_its_channels() {
    let recording = read(&samples().join("mat/labcontrol_ensaio_A1.mat")).unwrap();
    let expected = &expected()["files"]["mat/labcontrol_ensaio_A1.mat"]["scalars"];
    for (name, value) in expected.as_object().unwrap() {
        let scalar = recording.scalars.iter().find(|scalar| scalar.name == *name).unwrap();
        assert_eq!(scalar.value, Value::Number(value.as_f64().unwrap()), "{name}");
    }
}

/// The samples of a group, stored sample by sample instead of channel by channel.
#[test]
fn multiplexed_groups_hold_the_same_as_demultiplexed_ones() {
    let file = fs::read(samples().join("rpc/short_4frames_group.tim")).unwrap();
    let (channels, points) = (4, 2048);
    let start = file.len() - 2 * channels * points * 2;
    let mut multiplexed = file[..start].to_vec();
    for group in file[start..].chunks_exact(channels * points * 2) {
        for (point, channel) in (0..points).flat_map(|point| (0..channels).map(move |channel| (point, channel))) {
            let at = 2 * (channel * points + point);
            multiplexed.extend_from_slice(&group[at..at + 2]);
        }
    }
    let key = multiplexed
        .windows(9)
        .position(|window| window == b"TIME_TYPE")
        .unwrap();
    multiplexed[key + 32..key + 43].copy_from_slice(b"MULT_RESP\0\0");
    assert_eq!(recognise(&multiplexed), recognise(&file));
}

#[test]
fn the_error_about_an_unknown_format_quotes_the_beginning() {
    for name in [
        "mdf/plain_3groups.mf4",
        "rpc/short_4frames_group.tim",
        "tdms/waveform_2segments.tdms",
        "mat/dspace_v6.mat",
        "uff/sample_58b.uff",
        "table/kc_bounce.xlsx",
    ] {
        let mut file = fs::read(samples().join(name)).unwrap();
        // The version of a MAT file is at byte 124.
        file[..128].fill(0);
        file[..8].copy_from_slice(b"\0rubbish");
        let fault = recognise(&file).expect_err(name).to_string();
        says(
            &fault,
            &["byte 0", r"begin with `\x00rubbish`", "`TDSm`", "copy it again"],
        );
    }
}

#[test]
fn a_channel_that_two_groups_have_needs_its_group() {
    // The channel of the second group gets the name of one of the first.
    let mut file = fs::read(samples().join("mdf/plain_3groups.mf4")).unwrap();
    let name = file.windows(13).position(|window| window == b"spring_travel").unwrap();
    file[name..name + 13].copy_from_slice(b"body_left_z\0\0");
    let recording = recognise(&file).unwrap();
    let fault = recording.signal("body_left_z").unwrap_err().to_string();
    says(
        &fault,
        &[
            "2 channels",
            "`rig_500Hz/body_left_z`",
            "`string_pot_100Hz/body_left_z`",
            "`group/name`",
        ],
    );
    assert_eq!(recording.signal("string_pot_100Hz/body_left_z").unwrap().unit, "mm");
    let fault = recording.signal("wheel").unwrap_err().to_string();
    says(&fault, &["no channel of this name", "qcar inspect"]);
    // Groups do not help where one group has both.
    let twice = recognise(b"time;a;a\ns;g;g\n0;1;2\n0.1;2;3\n").unwrap();
    let fault = twice.signal("a").unwrap_err().to_string();
    says(
        &fault,
        &["2 channels", "line 2", "give them different names in the file"],
    );
}

/// Dialects of one table: each line is a separator, a decimal sign and what stands around.
#[test]
fn a_table_is_the_same_in_every_dialect() {
    let rows = [[0.0, 1.5, -2.25], [0.01, 1.625, -2.5], [0.02, 1200.5, -2.75]];
    let written = |separator: &str, decimal: &str, end: &str| {
        let row = |row: &[f64; 3]| row.map(|value| value.to_string().replace('.', decimal)).join(separator);
        let mut lines = vec![["t", "a", "b"].join(separator), ["s", "g", "mm"].join(separator)];
        lines.extend(rows.iter().map(row));
        lines.join(end) + end
    };
    let expected = recognise(written(",", ".", "\n").as_bytes()).unwrap().signals;
    let agrees = |text: &[u8]| {
        let signals = recognise(text).unwrap().signals;
        assert_eq!(signals.len(), expected.len());
        for (own, other) in signals.iter().zip(&expected) {
            assert_eq!(
                (&own.name, &own.unit, &own.samples),
                (&other.name, &other.unit, &other.samples)
            );
            assert_eq!(own.time, other.time);
        }
    };
    assert_eq!(expected[0].samples, [1.5, 1.625, 1200.5]);
    assert_eq!((expected[1].name.as_str(), expected[1].unit.as_str()), ("b", "mm"));
    assert_eq!(expected[0].time.rate().map(f64::round), Some(100.0));
    for separator in [";", "\t", "|", " "] {
        for (decimal, end) in [(".", "\n"), (",", "\r\n")] {
            // With spaces between columns, a comma is taken for what separates them.
            if (separator, decimal) == (" ", ",") {
                continue;
            }
            let text = written(separator, decimal, end);
            agrees(text.as_bytes());
        }
    }
    let utf16: Vec<u8> = "\u{feff}"
        .encode_utf16()
        .chain(written(";", ",", "\n").encode_utf16())
        .flat_map(u16::to_le_bytes)
        .collect();
    agrees(&utf16);
    let cut = recognise(&utf16[..utf16.len() - 1]).unwrap_err().to_string();
    says(&cut, &["half a character", "cut off"]);
    let headings = written(",", ".", "\n").replace("t,a,b\ns,g,mm", "t [s],a [g],b (mm)");
    agrees(headings.as_bytes());
}

#[test]
fn a_cell_that_is_no_number_is_named() {
    let cases = [
        (
            "t;a\n0;1,5\n1;2,5\n2;x\n",
            vec!["line 4, column `a`", "`x`", "decimal comma"],
        ),
        ("t;a\r\n\r\n0;1,5\r\n\r\n1;2,5\r\n2;x\r\n", vec!["line 6, column `a`"]),
        ("t,a\n0,1.5\n1,2.5\n2\n", vec!["line 4", "1 column,", "2 columns"]),
        (
            "t,a\n0,1.5\n1,2.5\n0.5,2\n",
            vec!["line 4, column `t`", "0.5 s after 1 s"],
        ),
        (
            "t [fortnight],a\n0,1.5\n1,2.5\n",
            vec!["column `t`", "`fortnight`", "s, ms, us"],
        ),
        (
            "t;a\n0;1,5\n1;2.5\n",
            vec!["`1,5`", "`2.5`", "line 3", "same decimal sign"],
        ),
        ("t,a\n0,OVLD\n1,2.5\n2,3\n", vec!["line 2, column `a`", "`OVLD`"]),
        (
            "t,a\ns,g\n0,1.5\n1,OVLD\n2,3\n3,1\n",
            vec!["line 4, column `a`", "`OVLD`"],
        ),
        ("t,a\n0,OVLD\n1,OVLD\n2,3\n3,1\n", vec!["line 2, column `a`", "`OVLD`"]),
        ("nothing\nto see\n", vec!["no row of numbers"]),
        (
            "t,a\n0,\"1.5\n1,2.5\n",
            vec!["line 2", "quotation mark that is never closed"],
        ),
        ("t,a\r0,1.5\r1,2\r2,x\r", vec!["line 4, column `a`", "`x`"]),
    ];
    for (table, parts) in cases {
        says(&recognise(table.as_bytes()).unwrap_err().to_string(), &parts);
    }
}

/// A unit may be a number, and lines above a table may begin with one.
#[test]
fn numbers_above_a_table_are_no_samples() {
    let names = |table: &str| -> Vec<(String, String)> {
        let signals = recognise(table.as_bytes()).unwrap().signals;
        signals.into_iter().map(|own| (own.name, own.unit)).collect()
    };
    let named = [("n", "1"), ("a", "g"), ("b", "mm")].map(|(name, unit)| (name.to_string(), unit.to_string()));
    assert_eq!(names("n,a,b\n1,g,mm\n0,1.5,2\n1,2.5,3\n"), named);
    assert_eq!(names("3,runs\n0,1.5,2\n1,2.5,3\n").len(), 3);
}

/// A file of the latest version of HDF5, made by h5py with these formulas: in one piece, and in chunks with each kind
/// of index.
#[test]
fn hdf5_as_newer_libraries_write_it_is_read() {
    let recording = read(&sample("mat/h5py_v114.mat").unwrap()).unwrap_or_else(|error| panic!("{error}"));
    type Formula = (&'static str, fn(f64) -> f64);
    let expected: [Formula; 4] = [
        ("one_piece", |at| 0.25 * at),
        ("packed", |at| at * at),
        ("growing", |at| -at),
        ("short", |at| at),
    ];
    assert_eq!(recording.signals.len(), expected.len(), "{:?}", names(&recording));
    let at = || (0..1000).map(f64::from);
    for (name, of) in expected {
        let signal = recording.signal(name).unwrap_or_else(|fault| panic!("{fault}"));
        assert_eq!(signal.samples, at().map(of).collect::<Vec<_>>(), "{name}");
        let TimeBase::Times(times) = &signal.time else {
            panic!("{name}: no times")
        };
        assert!(times.iter().copied().eq(at().map(|at| at / 500.0)), "{name}");
    }
    let text = recording.scalars.iter().find(|scalar| scalar.name == "text").unwrap();
    assert_eq!(text.value, Value::Text("Grüße".into()));
    let passed: Vec<_> = recording
        .passed_over
        .iter()
        .map(|passed| passed.name.as_str())
        .collect();
    assert_eq!(passed, ["both_growing", "capture"]);
}

/// What the latest version began with is passed over, and the rest is read.
#[test]
fn a_layout_of_hdf5_2_is_passed_over() {
    let recording = read(&sample("mat/h5py_latest.mat").unwrap()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(names(&recording), ["one_piece"]);
    let [passed] = &recording.passed_over[..] else {
        panic!("{:?}", recording.passed_over)
    };
    assert!(passed.name == "packed" && passed.why.contains("HDF5 2.0"), "{passed:?}");
}
