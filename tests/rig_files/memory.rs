//! Of a long recording, a campaign holds the channels that its sensors name, as narrow as the file stores them, and not
//! the file.

use std::fs::{self, File};
use std::process::Command;

use qcar_signals::content::Content;
use qcar_signals::find::Wanted;
use qcar_signals::read::channels;

use crate::counting::memory_of;
use crate::writers::{Channel, Group, mat5, mdf4, rpc, tdms};
use crate::{channel, folder, history, open};

/// Sixteen channels of so many samples at 1 kHz.
fn group(samples: usize) -> Group {
    let wave = |channel: usize| {
        (0..samples)
            .map(|at| ((at + 31 * channel) % 1009) as f64 - 504.0)
            .collect()
    };
    let named = |at: usize| Channel::new(&format!("channel_{at}"), "m/s^2", wave(at));
    Group::at(1000.0, (0..16).map(named).collect())
}

/// The share of a file that is held, at most, while a campaign of two sensors and two windows is opened; `unit` of the
/// sensors where the file states none.
fn share(name: &str, file: &[u8], unit: &str) -> f64 {
    let sensors = channel("pad", &format!("source = \"channel_0\"{unit}"))
        + &channel("body", &format!("source = \"channel_1\"{unit}"));
    let first = history(name, "name = \"first\"\nfrom = 0\nto = 20");
    let later = history(name, "name = \"later\"\nfrom = 100\nto = 110");
    let folder = folder(&(sensors + &first + &later), (name, file));
    let held = memory_of(|| assert_eq!(open(folder.path()).unwrap().runs.len(), 2));
    held as f64 / file.len() as f64
}

/// Two of sixteen channels are an eighth. The times of MDF are there in the record and, while they are read, as a
/// channel; the pages and pieces in which a file is read, and the samples of the windows, are a few megabytes.
#[test]
fn a_campaign_holds_the_channels_that_it_names() {
    let (doubles, shorts) = (group(500_000), group(2_000_000));
    let of = |name: &str, file: Vec<u8>, unit: &str, most: f64| {
        assert!(file.len() > 60_000_000, "{name}: {}", file.len());
        let share = share(name, &file, unit);
        println!("{name}: {share:.3} of the file");
        assert!(share < most, "{name}: {share:.3} of the file");
    };
    of("long.mf4", mdf4::file(std::slice::from_ref(&doubles)), "", 0.4);
    of("long.tdms", tdms::file(&doubles), "", 0.25);
    of("long.mat", mat5::file(&doubles), "\nunit = \"m/s^2\"", 0.4);
    of("long.rsp", rpc::file(&shorts), "", 0.25);
}

/// Eight million bytes of times pass by like the samples: their first and their steps are kept.
#[test]
fn summaries_of_mdf_keep_no_times() {
    let file = mdf4::file(&[group(1_000_000)]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.mf4");
    fs::write(&path, file).unwrap();
    let held = memory_of(|| {
        let content = Content::of_file(File::open(&path).unwrap()).unwrap();
        let recording = channels(&content, &Wanted::Summaries).unwrap();
        assert_eq!(recording.signals.len(), 16);
        assert_eq!(recording.signals[0].time.rate().map(f64::round), Some(1000.0));
    });
    println!("{held} bytes");
    assert!(held < 4_000_000, "{held} bytes");
}

/// A program that may take no more than 400 MB of addresses tells all sixteen channels of 520 MB, which it looks at in
/// parts.
#[cfg(target_os = "linux")]
#[test]
fn all_channels_of_a_long_recording_are_told_in_less_memory_than_it_has() {
    const FRAMES: usize = 8000;
    let folder = tempfile::tempdir().unwrap();
    let mut file = rpc::file(&group(2048));
    let data = file.len() - 16 * 2048 * 2;
    for (name, value) in [("FRAMES", FRAMES), ("SAMPLES", 2048 * FRAMES)] {
        let at = file
            .windows(33)
            .position(|bytes| bytes.starts_with(format!("{name}\0").as_bytes()));
        let value = format!("{value}\0");
        file[at.unwrap() + 32..][..value.len()].copy_from_slice(value.as_bytes());
    }
    fs::write(folder.path().join("long.rsp"), &file).unwrap();
    // Zeros that take no place on the disk follow.
    let length = (data + FRAMES * 16 * 2048 * 2) as u64;
    let long = File::options()
        .write(true)
        .open(folder.path().join("long.rsp"))
        .unwrap();
    long.set_len(length).unwrap();
    let limited = |kilobytes: &str, file: &str| {
        let qcar = env!("CARGO_BIN_EXE_qcar");
        let line = format!("ulimit -v {kilobytes}; exec {qcar} inspect {file}");
        let ran = Command::new("sh")
            .args(["-c", &line])
            .current_dir(folder.path())
            .output();
        ran.unwrap()
    };
    let told = limited("400000", "long.rsp");
    let text = String::from_utf8_lossy(&told.stdout);
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    assert_eq!(text.matches("16384000").count(), 16, "{text}");
}
