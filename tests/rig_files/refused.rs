//! Files and mappings that cannot be used: each is refused with channel, place and remedy.

use std::fmt::Write as _;

use tempfile::TempDir;

use crate::writers::{Channel, Group, mdf4};
use crate::{channel, folder, history, open};

/// A pad in g and a body in mm/s^2, of so many samples at 100 Hz, with `body` put in its place at some samples.
fn text(edit: impl Fn(usize) -> Option<&'static str>) -> String {
    let mut text = "Time [s];FL_Pad_Acc_Z [g];FL_Body_Acc_Z [mm/s^2];FR_Body_Acc_Z [mm/s^2];Temp [°C]\n".to_string();
    for k in 0..200 {
        let (pad, body) = ((0.3 * f64::from(k)).sin(), (0.2 * f64::from(k)).cos());
        let body = edit(k as usize).map_or(format!("{body:.6}"), String::from);
        let _ = writeln!(text, "{:.2};{pad:.6};{body};1;20", f64::from(k) / 100.0);
    }
    text
}

fn pad() -> String {
    channel("pad", "source = \"FL_Pad_Acc_Z\"")
}

/// A campaign of these sections with the text as its file is refused, and this is said.
fn refused(sections: &str, text: &str, said: &[&str]) {
    let folder = folder(sections, ("rig.txt", text.as_bytes()));
    let error = open(folder.path()).unwrap_err().to_string();
    for part in said {
        assert!(error.contains(part), "no `{part}` in\n{error}");
    }
}

/// How many samples the only run of a campaign has.
fn samples(folder: &TempDir) -> usize {
    let campaign = open(folder.path()).unwrap();
    campaign.history(&campaign.runs[0]).unwrap().len()
}

/// The body with these keys, in a run with those.
fn body(keys: &str, of_run: &str, said: &[&str]) {
    refused(
        &(pad() + &channel("body", keys) + &history("rig.txt", of_run)),
        &text(|_| None),
        said,
    );
}

#[test]
fn the_file_that_the_others_spoil_is_sound() {
    let sections = pad() + &channel("body", "source = \"FL_Body*\"") + &history("rig.txt", "");
    let content = text(|_| None);
    let folder = folder(&sections, ("rig.txt", content.as_bytes()));
    open(folder.path()).unwrap();
}

#[test]
fn a_source_that_is_missing_names_the_nearest() {
    body(
        "source = \"FL_Body_AccZ\"",
        "",
        &[
            "rig.txt, channel `FL_Body_AccZ`",
            "nearest are `FL_Body_Acc_Z`",
            "`source` of `body_left_z`",
            "qcar inspect",
        ],
    );
    body(
        "source = \"*Hub*\"",
        "",
        &["channel `*Hub*`", "no channel of this name"],
    );
}

#[test]
fn a_pattern_that_several_fit_names_them() {
    body(
        "source = \"*Body_Acc_Z\"",
        "",
        &["2 channels: `FL_Body_Acc_Z`, `FR_Body_Acc_Z`", "write more of the name"],
    );
}

#[test]
fn units_that_are_none_of_the_quantity_are_refused() {
    body(
        "source = \"Temp\"",
        "",
        &["channel `Temp`", "values in \"°C\"", "such as \"g\""],
    );
    body(
        "source = \"FL_Body_Acc_Z\"\nunit = \"mm\"",
        "",
        &["campaign.toml, line", "`channel[2].unit`", "\"mm\"", "m/s^2"],
    );
    body(
        "source = \"FL_Body_Acc_Z\"\nunit = \"furlong\"",
        "",
        &["\"furlong\"", "m/s^2"],
    );
    let contradiction = [
        "values in \"mm/s^2\"",
        "values in \"g\" as `unit` of `body_left_z` says",
        "`scale = 1`",
    ];
    body("source = \"FL_Body_Acc_Z\"\nunit = \"g\"", "", &contradiction);
}

#[test]
fn mappings_are_read_with_care() {
    body(
        "source = \"FL_Body_Acc_Z\"\nsign = 2",
        "",
        &["`channel[2].sign`", "1 or -1"],
    );
    body("source = \"FL_Body_Acc_Z\"\nzero = \"end\"", "", &["\"start\""]);
    body(
        "source = \"FL_Body_Acc_Z\"\nzero = \"start\"\nzero_span = 5",
        "",
        &["channel `FL_Body_Acc_Z`", "first 5 s", "reduce"],
    );
    body("source = \"FL_Body_Acc_Z\"\nzero_span = 5", "", &["no `zero`"]);
    let run = "without = [\"body_left_y\"]";
    body(
        "source = \"FL_Body_Acc_Z\"",
        run,
        &["`run[1].without`", "\"body_left_y\"", "did you mean `body_left_z`?"],
    );
}

#[test]
fn windows_without_samples_are_refused() {
    let body = |of_run: &str, said: &[&str]| body("source = \"FL_Body_Acc_Z\"", of_run, said);
    body("from = 1.0\nto = 1.0", &["`run[1].to`", "the window is empty"]);
    body(
        "from = 3.0",
        &["a window from 3 to 1.99 s", "within the recording, from 0 to 1.99 s"],
    );
    body("to = 7.0", &["a window from 0 to 7 s"]);
    body("from = 1.001\nto = 1.008", &["a window from 1.001 to 1.008 s"]);
}

#[test]
fn a_trigger_that_is_never_met_says_what_the_channel_reaches() {
    let run = "trigger = { channel = \"FL_Pad_Acc_Z\", above = 4.0 }";
    body(
        "source = \"FL_Body_Acc_Z\"",
        run,
        &["channel `FL_Pad_Acc_Z`", "never rise above 4", "g", "`trigger`"],
    );
    let run = "trigger = { channel = \"Barrier\", above = 4.0 }";
    body(
        "source = \"FL_Body_Acc_Z\"",
        run,
        &["channel `Barrier`", "no channel of this name"],
    );
}

#[test]
fn samples_that_were_lost_inside_the_window_are_refused() {
    let sections = |keys: &str| pad() + &channel("body", "source = \"FL_Body_Acc_Z\"") + &history("rig.txt", keys);
    let lost = text(|k| (50..53).contains(&k).then_some("NaN"));
    refused(
        &sections(""),
        &lost,
        &[
            "channel `FL_Body_Acc_Z` at 0.5000 s",
            "3 samples without values",
            "cannot be filled in",
        ],
    );
    let beside = folder(&sections("from = 0.6"), ("rig.txt", lost.as_bytes()));
    assert_eq!(samples(&beside), 140);
    let without = folder(&sections("without = [\"body_left_z\"]"), ("rig.txt", lost.as_bytes()));
    assert_eq!(samples(&without), 200);
    let gap: String = text(|_| None)
        .lines()
        .filter(|line| !line.starts_with("0.7"))
        .map(|line| format!("{line}\n"))
        .collect();
    refused(
        &sections(""),
        &gap,
        &["at 0.8000 s", "a step of 0.11", "steps of 0.01 s"],
    );
}

#[test]
fn a_channel_of_another_length_is_named() {
    let group = |rate: f64, name: &str, count: usize| {
        Group::at(
            rate,
            vec![Channel::new(name, "g", (0..count).map(|k| (k as f64).sin()).collect())],
        )
    };
    let file = mdf4::file(&[group(100.0, "FL_Pad_Acc_Z", 1000), group(100.0, "FL_Body_Acc_Z", 700)]);
    let sensors = pad() + &channel("body", "source = \"FL_Body_Acc_Z\"");
    let short = folder(&(sensors.clone() + &history("a.mf4", "")), ("a.mf4", &file));
    let error = open(short.path()).unwrap_err().to_string();
    for part in [
        "channel `group 1/FL_Body_Acc_Z`",
        "samples from 0 to 6.99 s",
        "0 to 9.99 s",
        "`from` and `to`",
    ] {
        assert!(error.contains(part), "no `{part}` in\n{error}");
    }
    let cut = folder(&(sensors + &history("a.mf4", "to = 6.0")), ("a.mf4", &file));
    assert_eq!(samples(&cut), 601);
}

#[test]
fn channels_without_samples_are_named() {
    let group = |name: &str, count: usize| Group::at(100.0, vec![Channel::new(name, "g", vec![0.5; count])]);
    for (count, said) in [(0, "0 values in the first 1 s"), (1, "1 values in the first 1 s")] {
        let file = mdf4::file(&[group("FL_Pad_Acc_Z", 1000), group("FL_Body_Acc_Z", count)]);
        let keys = "source = \"FL_Body_Acc_Z\"\nzero = \"start\"";
        let sections = pad() + &channel("body", keys) + &history("a.mf4", "sample_rate = 100");
        let folder = folder(&sections, ("a.mf4", &file));
        let error = open(folder.path()).unwrap_err().to_string();
        assert!(
            error.contains("channel `FL_Body_Acc_Z`") && error.contains(said),
            "{error}"
        );
    }
}

#[test]
fn rates_beyond_reason_are_refused() {
    let body = |of_run: &str, said: &[&str]| body("source = \"FL_Body_Acc_Z\"", of_run, said);
    body(
        "sample_rate = 1e12",
        &[
            "`sample_rate = 1000000000000`",
            "at most 10 times the highest rate of its channels, 100 Hz",
        ],
    );
    body(
        "sample_rate = 1e-300",
        &["1.99 s that all channels cover", "two samples"],
    );
}

#[test]
fn a_run_without_channels_is_told_what_it_lacks() {
    for keys in ["", "sample_rate = 100"] {
        let folder = folder(
            &history("a.mf4", keys),
            (
                "a.mf4",
                &mdf4::file(&[Group::at(
                    100.0,
                    vec![Channel::new("FL_Body_Acc_Z", "g", vec![0.5; 200])],
                )]),
            ),
        );
        let error = open(folder.path()).unwrap_err().to_string();
        assert!(
            error.contains("`[[channel]]`") && error.contains("qcar inspect"),
            "{error}"
        );
    }
}

#[test]
fn a_file_without_times_needs_a_rate() {
    let text = "FL_Pad_Acc_Z [g];FL_Body_Acc_Z [g]\n1;2\n2;3\n3;1\n4;7\n";
    let sections = |keys: &str| pad() + &channel("body", "source = \"FL_Body_Acc_Z\"") + &history("rig.txt", keys);
    refused(&sections(""), text, &["channels without times", "`sample_rate`"]);
    let rated = folder(&sections("sample_rate = 100"), ("rig.txt", text.as_bytes()));
    assert_eq!(samples(&rated), 4);
}

#[test]
fn a_dead_channel_is_refused_where_a_sweep_needs_it() {
    let sweep = "[[run]]\nkind = \"sweep\"\nfile = \"rig.txt\"\nrole = \"fit\"\npeak_velocity = 0.1\nstart_frequency = 1\n\
                 end_frequency = 10\nspacing = \"linear\"\n";
    let dead = channel("body", "source = \"FR_Body_Acc_Z\"");
    refused(
        &(pad() + &dead + sweep),
        &text(|_| None),
        &["`body_left_z`", "the channel is dead", "`without = [\"body_left_z\"]`"],
    );
    let warned = folder(
        &(pad() + &dead + &history("rig.txt", "")),
        ("rig.txt", text(|_| None).as_bytes()),
    );
    let notices = open(warned.path()).unwrap().notices;
    assert!(
        notices.len() == 1 && notices[0].contains("rig.txt, `body_left_z`, 0.000 s to 1.990 s: every sample is"),
        "{notices:?}"
    );
}

#[test]
fn a_sensor_stands_in_one_file() {
    let folder = folder("", ("rig.txt", text(|_| None).as_bytes()));
    let path = |name: &str| folder.path().join(name);
    let write = |manifest: String| std::fs::write(path("campaign.toml"), manifest).unwrap();
    let head = crate::HEAD.replace("[vehicle]", "mapping = \"rig.toml\"\n\n[vehicle]");
    write(head.clone() + &history("rig.txt", ""));
    let error = open(folder.path()).unwrap_err().to_string();
    assert!(
        error.contains("`mapping`: found") && error.contains("rig.toml: no such file"),
        "{error}"
    );
    std::fs::write(path("rig.toml"), pad() + "[[channels]]\n").unwrap();
    let error = open(folder.path()).unwrap_err().to_string();
    assert!(
        error.contains("rig.toml, line") && error.contains("did you mean `channel`?"),
        "{error}"
    );
    std::fs::write(path("rig.toml"), pad()).unwrap();
    open(folder.path()).unwrap();
    write(head + &pad() + &history("rig.txt", ""));
    let error = open(folder.path()).unwrap_err().to_string();
    assert!(
        error.contains("`mapping`") && error.contains("\"pad_left_z\""),
        "{error}"
    );
}
