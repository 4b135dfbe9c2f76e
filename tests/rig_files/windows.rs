//! Parts of a recording, and channels of several rates, against what is known of the signals.

use std::f64::consts::TAU;

use qcar_runtime::campaign::History;
use qcar_signals::resample::RIPPLE;

use crate::writers::{Channel, Group, mdf4};
use crate::{channel, folder, history, open};

const SECONDS: f64 = 8.0;
/// What rounding of the times makes of samples that are taken as they are.
const ROUNDING: f64 = 1e-12;

fn sampled(rate: f64, of: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..(SECONDS * rate) as usize + 1)
        .map(|k| of(k as f64 / rate))
        .collect()
}

fn pad(t: f64) -> f64 {
    (TAU * 3.0 * t).sin()
}

fn body(t: f64) -> f64 {
    0.5 * (TAU * 7.0 * t + 0.4).cos()
}

/// The pad at 1000 Hz in m/s^2 with a light barrier that is broken at 2.5 s, the body at 250 Hz in mm/s^2.
fn recording() -> Vec<u8> {
    let barrier = |t: f64| if (2.5..2.6).contains(&t) { 5.0 } else { 0.1 };
    let fast = Group::at(
        1000.0,
        vec![
            Channel::new("Pad_FL", "m/s^2", sampled(1000.0, pad)),
            Channel::new("Barrier", "V", sampled(1000.0, barrier)),
        ],
    );
    let slow = Group::at(
        250.0,
        vec![Channel::new("Body_FL", "mm/s^2", sampled(250.0, |t| 1e3 * body(t)))],
    );
    mdf4::file(&[fast, slow])
}

fn sensors() -> String {
    channel("pad", "source = \"Pad_*\"") + &channel("body", "source = \"group 1/Body_FL\"")
}

/// The only run of a campaign with these keys.
fn read(keys: &str) -> History {
    let file = recording();
    let folder = folder(&(sensors() + &history("long.mf4", keys)), ("long.mf4", &file));
    let campaign = open(folder.path()).unwrap();
    assert_eq!(campaign.notices, [] as [&str; 0]);
    campaign.history(&campaign.runs[0]).unwrap()
}

/// Deviation of the samples from what they are of, `shift` s after the beginning of the recording.
fn worst(history: &History, channel: &str, shift: f64, of: fn(f64) -> f64) -> f64 {
    let samples = history.signal(channel).unwrap().iter().enumerate();
    let time = |k: usize| shift + history.start + k as f64 / history.sample_rate;
    samples
        .map(|(k, value)| (value - of(time(k))).abs())
        .fold(0.0, f64::max)
}

#[test]
fn channels_come_to_the_highest_rate() {
    let history = read("from = 1.0\nto = 6.0");
    assert_eq!((history.sample_rate, history.len(), history.start), (1000.0, 5001, 0.0));
    // Samples that were taken at these instants stay as they are.
    assert!(worst(&history, "pad_left_z", 1.0, pad) < ROUNDING);
    assert!(worst(&history, "body_left_z", 1.0, body) < 2.0 * RIPPLE);
}

#[test]
fn channels_come_to_the_rate_that_is_stated() {
    let history = read("from = 1.0\nto = 6.0\nsample_rate = 250");
    assert_eq!((history.sample_rate, history.len()), (250.0, 1251));
    assert!(worst(&history, "pad_left_z", 1.0, pad) < 2.0 * RIPPLE);
    assert!(worst(&history, "body_left_z", 1.0, body) < ROUNDING);
}

#[test]
fn a_trigger_begins_a_run() {
    let history = read("trigger = { channel = \"Barrier\", above = 2.0 }\nfrom = -0.5\nto = 3.0");
    assert_eq!((history.len(), history.start), (3501, 0.0));
    assert!(worst(&history, "pad_left_z", 2.0, pad) < ROUNDING);
}

#[test]
fn a_run_without_a_window_keeps_the_clock_of_its_file() {
    let history = read("");
    assert_eq!((history.len(), history.start), (8001, 0.0));
    assert_eq!(worst(&history, "pad_left_z", 0.0, pad), 0.0);
}

#[test]
fn one_recording_holds_several_runs() {
    let file = recording();
    let runs =
        history("long.mf4", "name = \"first\"\nto = 2.0") + &history("long.mf4", "name = \"second\"\nfrom = 2.0");
    let folder = folder(&(sensors() + &runs), ("long.mf4", &file));
    let campaign = open(folder.path()).unwrap();
    let lengths: Vec<usize> = campaign
        .runs
        .iter()
        .map(|run| campaign.history(run).unwrap().len())
        .collect();
    assert_eq!(lengths, [2001, 6001]);
    assert_eq!(campaign.runs[1].name, "second");
}

/// `(value * scale + offset)` in the unit, then the sign, then less the mean of the beginning.
#[test]
fn values_become_si() {
    let volts = sampled(100.0, |t| if t < 1.0 { 0.25 } else { 0.75 });
    let file = mdf4::file(&[Group::at(
        100.0,
        vec![
            Channel::new("AI1", "V", volts.clone()),
            Channel::new("Travel", "mm", volts),
        ],
    )]);
    let keys = "source = \"AI1\"\nunit = \"g\"\nscale = 10.0\noffset = -1.0\nsign = -1";
    let travel = "[[channel]]\nname = \"travel\"\nlocation = \"wheel\"\nside = \"left\"\naxis = \"z\"\n\
                  quantity = \"displacement\"\nsource = \"Travel\"\nzero = \"start\"\nzero_span = 0.5\n\n";
    let folder = folder(
        &(channel("pad", keys) + travel + &history("a.mf4", "")),
        ("a.mf4", &file),
    );
    let campaign = open(folder.path()).unwrap();
    let history = campaign.history(&campaign.runs[0]).unwrap();
    let near = |name: &str, at: usize, expected: f64| {
        let found = history.signal(name).unwrap()[at];
        assert!((found - expected).abs() < 1e-14, "{name}: {found}, not {expected}");
    };
    near("pad_left_z", 0, -1.5 * 9.80665);
    near("pad_left_z", 200, -6.5 * 9.80665);
    near("travel", 0, 0.0);
    near("travel", 200, 0.0005);
}

/// The columns of a K&C curve are found in the same way, and need no times.
#[test]
fn curves_are_read_from_any_file() {
    let text = "Weg [mm];Kraft [kN]\n10,5;0,3\n0;0\n-10,5;-0,3\n";
    let columns = "displacement = { source = \"Weg\", sign = -1 }\nforce = { source = \"Kraft\", unit = \"kN\" }";
    let run = format!("[[run]]\nkind = \"bounce\"\nfile = \"kc.txt\"\nrole = \"fit\"\n{columns}\n");
    let folder = folder(&run, ("kc.txt", text.as_bytes()));
    let campaign = open(folder.path()).unwrap();
    let curve = campaign.curve(&campaign.runs[0]).unwrap();
    assert_eq!(
        (curve.displacement, curve.force),
        (vec![-0.0105, 0.0, 0.0105], vec![300.0, 0.0, -300.0])
    );
}

/// A sine on the K&C rig, its velocity and force at a rate of their own.
#[test]
fn sines_of_a_rig_come_to_one_rate() {
    let rate_of_pad = |t: f64| (TAU * 3.0 * t).cos();
    let peak = 20.0 * TAU * 3.0;
    let file = mdf4::file(&[
        Group::at(
            500.0,
            vec![
                Channel::new("Weg", "mm", sampled(500.0, |t| 20.0 * pad(t))),
                Channel::new("unused", "V", sampled(500.0, pad)),
            ],
        ),
        Group::at(
            250.0,
            vec![
                Channel::new("Geschwindigkeit", "mm/s", sampled(250.0, |t| peak * rate_of_pad(t))),
                Channel::new("Kraft", "kN", sampled(250.0, |t| 0.4 * pad(t))),
            ],
        ),
    ]);
    let columns =
        "displacement = { source = \"Weg\" }\nvelocity = { source = \"Gesch*\" }\nforce = { source = \"Kraft\" }";
    let run = "[[run]]\nkind = \"dynamic_bounce\"\nfile = \"kc.mf4\"\nrole = \"fit\"\npeak_velocity = 0.377\namplitude = 0.02\n";
    let folder = folder(&format!("{run}{columns}\n"), ("kc.mf4", &file));
    let campaign = open(folder.path()).unwrap();
    let curve = campaign.dynamic_curve(&campaign.runs[0]).unwrap();
    assert_eq!((curve.time.len(), curve.time[1]), (4001, 0.002));
    type Shape<'a> = &'a dyn Fn(f64) -> f64;
    let columns: [(&[f64], f64, Shape); 3] = [
        (&curve.displacement, 0.02, &pad),
        (&curve.velocity, 1e-3 * peak, &rate_of_pad),
        (&curve.force, 400.0, &pad),
    ];
    for (column, size, shape) in columns {
        let inner = 200..3800;
        let worst = inner
            .map(|k| (column[k] / size - shape(curve.time[k])).abs())
            .fold(0.0, f64::max);
        assert!(worst < 2.0 * RIPPLE, "{size}: {worst}");
    }
}

/// Stamps of messages on a bus, 10 ms apart and up to 6 ms late, and the body at 1 Hz.
fn messages(without: std::ops::Range<usize>) -> Vec<u8> {
    let mut text = "time;Pad_FL [m/s^2];Body_FL [m/s^2]\n".to_string();
    for k in (0..800).filter(|k| !without.contains(k)) {
        let t = 0.01 * k as f64 + 0.006 * (k as f64 * 0.618).fract();
        text += &format!("{t:.6};{};{}\n", slow(t), slow(t + 0.1));
    }
    text.into_bytes()
}

fn slow(t: f64) -> f64 {
    (TAU * t).sin()
}

#[test]
fn messages_of_a_bus_are_interpolated_linearly() {
    let sections =
        channel("pad", "source = \"Pad_FL\"") + &channel("body", "source = \"Body_FL\"") + &history("can.txt", "");
    let whole = folder(&sections, ("can.txt", &messages(0..0)));
    let campaign = open(whole.path()).unwrap();
    let history = campaign.history(&campaign.runs[0]).unwrap();
    // A straight line over the longest step, 16 ms, misses a sine of 1 Hz by no more than (0.016 × 2π)² / 8.
    for (name, shift) in [("pad_left_z", 0.0), ("body_left_z", 0.1)] {
        let off = worst(&history, name, shift, slow);
        assert!(off < 1.3e-3 && off > 1e-6, "{name}: {off}");
    }
    assert!(
        (history.sample_rate / 100.0 - 1.0).abs() < 0.1,
        "{}",
        history.sample_rate
    );
    assert_eq!(campaign.notices.len(), 2, "{:?}", campaign.notices);
    assert!(
        campaign.notices[0].contains("`pad_left_z`, 0.000 s to 7.99"),
        "{:?}",
        campaign.notices
    );
    assert!(
        campaign.notices[0].contains("samples are uneven"),
        "{:?}",
        campaign.notices
    );
    let cut = folder(&sections, ("can.txt", &messages(300..330)));
    let error = open(cut.path()).unwrap_err().to_string();
    assert!(
        error.contains("Pad_FL") && error.contains("without values") && error.contains("outside of it"),
        "{error}"
    );
}
