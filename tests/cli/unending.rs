//! Input without end: long lines, deep brackets, long numbers, files that unpack to gigabytes, pipes and devices.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::common::{Ran, copy, qcar_in, run_line};

/// Checks a model of this text, which must take no time and no space.
fn checked(text: &str) -> Ran {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("long.axle"), text).unwrap();
    let begun = Instant::now();
    let ran = run_line(folder.path(), "check long.axle");
    assert!(
        begun.elapsed() < Duration::from_secs(10),
        "it took {:?}",
        begun.elapsed()
    );
    assert!(ran.stdout.len() < 100_000, "it said {} bytes", ran.stdout.len());
    assert!(!ran.stderr.contains("panicked"), "{}", ran.stderr);
    assert_eq!(ran.status, 1);
    ran
}

#[test]
fn a_mistake_far_to_the_right_is_named_by_its_column() {
    let ran = checked(&format!(
        "axle a {{ {} direction z {{ mass body = m; }} }}",
        " ".repeat(70_000)
    ));
    assert!(ran.stdout.contains("long.axle:1:70"), "{}", ran.stdout);
}

#[test]
fn open_brackets_are_told_once() {
    let ran = checked(&"(".repeat(10_000));
    assert_eq!(ran.stdout.matches("nested_too_deep").count(), 1, "{}", ran.stdout);
    let ran = checked(&")\n".repeat(10_000));
    assert!(ran.stdout.contains("and 9975 more mistakes"), "{}", ran.stdout);
}

#[test]
fn a_number_of_a_hundred_thousand_digits_is_refused_at_once() {
    let ran = checked(&format!("axle a {{ let x = {}; }}", "1".repeat(100_000)));
    assert!(ran.stdout.contains("this number has 100000 digits"), "{}", ran.stdout);
}

/// A campaign whose only run is this file.
fn campaign(folder: &Path, file: &str) -> Ran {
    copy(
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/trials")),
        folder,
    );
    let manifest = format!(
        "format = 1\nname = \"long\"\nmodel = \"hub.axle\"\n[[run]]\nkind = \"bounce\"\nfile = \"{file}\"\nrole = \"fit\"\n"
    );
    fs::write(folder.join("campaign.toml"), manifest).unwrap();
    qcar_in(folder, &["kc", "."])
}

#[test]
fn a_small_file_that_unpacks_to_a_large_one_ends_at_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(b"displacement,force\n").unwrap();
    let row = b"0.01,310\n".repeat(1 << 16);
    (0..8).for_each(|_| packed.write_all(&row).unwrap());
    fs::write(folder.path().join("large.csv.gz"), packed.finish().unwrap()).unwrap();
    let within = |limit: &str| {
        campaign(folder.path(), "large.csv.gz");
        let mut command = Command::new(env!("CARGO_BIN_EXE_qcar"));
        let ran = command
            .args(["kc", "."])
            .env("QCAR_MAX_MIB", limit)
            .current_dir(folder.path())
            .output();
        String::from_utf8(ran.unwrap().stderr).unwrap()
    };
    let said = within("1");
    for fragment in ["large.csv.gz", "set QCAR_MAX_MIB", "raise the limit"] {
        assert!(said.contains(fragment), "expected `{fragment}` in\n{said}");
    }
    // All of it is read where the limit allows: then it is the curve that is wrong.
    assert!(
        within("64").contains("travel in one direction only"),
        "{}",
        within("64")
    );
}

#[test]
fn a_measured_file_ends_at_the_limit_packed_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("t;a\n{}", "0;1\n".repeat(1 << 19));
    fs::write(folder.path().join("plain.csv"), &text).unwrap();
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(text.as_bytes()).unwrap();
    fs::write(folder.path().join("packed.csv.gz"), packed.finish().unwrap()).unwrap();
    for file in ["plain.csv", "packed.csv.gz"] {
        let within = |limit: &str| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_qcar"));
            let ran = command.args(["inspect", file]).env("QCAR_MAX_MIB", limit);
            let ran = ran.current_dir(folder.path()).output().unwrap();
            (ran.status.code(), String::from_utf8(ran.stderr).unwrap())
        };
        let (status, said) = within("1");
        assert_eq!(status, Some(2), "{said}");
        for fragment in [file, "set QCAR_MAX_MIB", "raise the limit"] {
            assert!(said.contains(fragment), "expected `{fragment}` in\n{said}");
        }
        assert_eq!(within("3").0, Some(0), "{}", within("3").1);
    }
}

#[test]
fn packed_data_of_every_format_end_at_the_limit() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/packed"));
    let inspected = |file: &str, limit: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_qcar"));
        let ran = command.args(["inspect", file]).env("QCAR_MAX_MIB", limit);
        let ran = ran.current_dir(folder).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (ran.status.code(), text(ran.stdout) + &text(ran.stderr))
    };
    let cases = [
        ("zeros.mf4", "byte 248", "a1 "),
        ("zeros.mat", "byte 1306", "\nb "),
        ("zeros_v73.mat", "channel `b`", "\nb "),
        ("inline.xlsx", "xl/worksheets/sheet1.xml", "\na "),
        ("shared.xlsx", "sheet `rig`, cell A37", "\na "),
        ("zeros.csv.gz", "zeros.csv.gz: found", "\na "),
    ];
    for (file, place, channel) in cases {
        let (status, said) = inspected(file, "1");
        assert_eq!(status, Some(2), "{said}");
        for fragment in [file, place, "set QCAR_MAX_MIB", "raise the limit"] {
            assert!(said.contains(fragment), "expected `{fragment}` in\n{said}");
        }
        let (status, said) = inspected(file, "64");
        assert!(status == Some(0) && said.contains(channel), "{file}: {said}");
    }
    // Variables of this version of HDF5 are passed over one by one.
    let (_, said) = inspected("zeros_v110.mat", "1");
    assert!(
        said.contains("\na ") && said.contains("b at `b`: more data than a file of this size may give"),
        "{said}"
    );
    assert!(inspected("zeros_v110.mat", "64").1.contains("\nb "));
}

#[test]
fn pipes_and_devices_are_no_files() {
    let folder = tempfile::tempdir().unwrap();
    assert!(
        Command::new("mkfifo")
            .arg(folder.path().join("pipe.csv"))
            .status()
            .unwrap()
            .success()
    );
    for file in ["pipe.csv", "/dev/zero"] {
        let ran = campaign(folder.path(), file);
        assert!(
            ran.status == 2 && ran.stderr.contains("found a pipe or device"),
            "{}",
            ran.stderr
        );
    }
    for line in [
        "check /dev/zero",
        "check ./pipe.csv",
        "inspect /dev/zero",
        "inspect pipe.csv",
        "matrices quarter_car --params /dev/zero",
    ] {
        let ran = run_line(folder.path(), line);
        assert!(
            ran.status == 2 && ran.stderr.contains("a pipe or device"),
            "{line}: {}",
            ran.stderr
        );
    }
}
