//! Times that are stored with the samples and are uneven mean the same in every format that stores times.

use std::f64::consts::TAU;

use qcar_runtime::campaign::Campaign;
use tempfile::TempDir;

use crate::writers::{Channel, Group, mat5, mat73, mdf3, mdf4, tables, tdms};
use crate::{channel, folder, history, open};

/// Ending and writer of a format.
type Format = (&'static str, fn(&Group) -> Vec<u8>);

/// The formats that store times.
const FORMATS: [Format; 7] = [
    ("mf4", |group| mdf4::file(std::slice::from_ref(group))),
    ("mdf", mdf3::file),
    ("mat", mat5::file),
    ("h5.mat", mat73::file),
    ("tdms", tdms::file),
    ("csv", tables::text),
    ("xlsx", tables::workbook),
];

/// Steps of 10 ms, of which each stamp is up to `late` s late.
fn stamps(late: f64) -> impl Iterator<Item = f64> {
    (0..800).map(move |k| 0.01 * k as f64 + late * (k as f64 * 0.618).fract())
}

fn signal(t: f64) -> f64 {
    (TAU * t).sin()
}

/// A pad and a body that were sampled at these times.
fn group(stamps: impl Iterator<Item = f64>) -> Group {
    let stamps: Vec<f64> = stamps.collect();
    let sampled = |shift: f64| stamps.iter().map(|t| signal(t + shift)).collect();
    let channels = vec![
        Channel::new("Pad_FL", "m/s^2", sampled(0.0)),
        Channel::new("Body_FL", "m/s^2", sampled(0.1)),
    ];
    Group::stamped(stamps, channels)
}

/// A campaign with this file as its only run. MAT knows no units, so the campaign states them.
fn campaign((ending, file): Format, group: &Group) -> TempDir {
    let sensor = |location: &str, source: &str| channel(location, &format!("source = \"{source}\"\nunit = \"m/s^2\""));
    let name = format!("bus.{ending}");
    let sections = sensor("pad", "Pad_FL") + &sensor("body", "Body_FL") + &history(&name, "");
    folder(&sections, (&name, &file(group)))
}

/// Start, rate and samples of both sensors, and what was noticed of the run.
type Seen = ((f64, f64), [Vec<f64>; 2], Vec<String>);

fn read(campaign: &Campaign) -> Seen {
    let run = &campaign.runs[0];
    let history = campaign.history(run).unwrap();
    let samples = ["pad_left_z", "body_left_z"].map(|name| history.signal(name).unwrap().to_vec());
    let notices = campaign.notices.iter().map(|own| own.replace(&run.name, "run"));
    ((history.start, history.sample_rate), samples, notices.collect())
}

#[test]
fn late_stamps_are_interpolated_alike() {
    let late = group(stamps(6e-3));
    let all = FORMATS.map(|format| (format.0, read(&open(campaign(format, &late).path()).unwrap())));
    let (_, ((start, rate), samples, notices)) = &all[0];
    // A straight line over the longest step, 16 ms, misses a sine of 1 Hz by no more than (0.016 × 2π)² / 8.
    let off = |(k, value): (usize, &f64)| (value - signal(start + k as f64 / rate)).abs();
    let worst = samples[0].iter().enumerate().map(off).fold(0.0, f64::max);
    assert!(worst < 1.3e-3 && worst > 1e-6, "{worst}");
    assert_eq!(notices.len(), 2, "{notices:?}");
    for (ending, found) in &all {
        assert_eq!((found.0, &found.2), ((*start, *rate), notices), "{ending}");
        assert!(found.1 == *samples, "{ending} has other samples than {}", all[0].0);
    }
}

#[test]
fn a_gap_is_refused_alike() {
    // Among even stamps it is a longer step, among late ones a time without values.
    for (late, said) in [(0.0, "a step of 0.31"), (6e-3, "samples without values")] {
        let stamps: Vec<f64> = stamps(late).collect();
        let cut = group(
            stamps
                .iter()
                .enumerate()
                .filter(|(k, _)| !(300..330).contains(k))
                .map(|own| *own.1),
        );
        for format in FORMATS {
            let error = open(campaign(format, &cut).path()).unwrap_err().to_string();
            for part in ["Pad_FL", said, "`from`"] {
                assert!(error.contains(part), "{}: {error}", format.0);
            }
        }
    }
}

#[test]
fn stamps_that_fall_are_refused_alike() {
    let back = group(
        stamps(0.0)
            .enumerate()
            .map(|(k, t)| t - if k < 500 { 0.0 } else { 0.2 }),
    );
    for format in FORMATS {
        let error = open(campaign(format, &back).path()).unwrap_err().to_string();
        for part in ["after 4.99 s", "never decrease"] {
            assert!(error.contains(part), "{}: {error}", format.0);
        }
    }
}
