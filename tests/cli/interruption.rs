//! Ctrl-C at any time: exit status 130, a word on what was written, and no file that is not whole.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::LazyLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::common::{repository, run_line};
use crate::far_starts::write_noisy_road;

/// Starts `qcar` and returns once it listens to Ctrl-C.
fn started(folder: &Path, line: &str) -> Child {
    let child = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while !listens(child.id()) {
        sleep(Duration::from_millis(1));
    }
    child
}

/// Whether a process catches SIGINT, by the mask of its signals.
fn listens(process: u32) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
    u64::from_str_radix(mask.trim(), 16).unwrap() & 2 != 0
}

/// Presses Ctrl-C and gives exit status, standard output and standard error.
fn interrupted(child: Child) -> (Option<i32>, String, String) {
    let pressed = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(pressed.unwrap().success());
    let output = child.wait_with_output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn a_fit_that_is_stopped_says_that_nothing_was_written() {
    let folder = repository();
    let child = started(
        folder.path(),
        "fit models/campaigns/axle_a_rig --starts 10000 --out results",
    );
    sleep(Duration::from_millis(300));
    let (status, said, told) = interrupted(child);
    assert_eq!((status, said.as_str()), (Some(130), ""), "{told}");
    assert!(told.starts_with("interrupted"), "{told}");
    assert!(told.contains("no file was written"), "{told}");
    assert!(!folder.path().join("results").exists());
}

/// What a search tells when it is stopped between the fit of the base model, which takes a part of its time, and its
/// end.
fn stopped_on_the_way(folder: &Path) -> String {
    for doubled in 0..8 {
        let child = started(folder, "discover models/campaigns/axle_c_study --out results");
        sleep(Duration::from_millis(250 << doubled));
        let (status, said, told) = interrupted(child);
        assert_eq!((status, said.as_str()), (Some(130), ""), "{told}");
        if told.contains("so far: the base model alone leaves") {
            return told;
        }
        assert!(told.contains("no file was written"), "{told}");
    }
    panic!("the base model was not fitted");
}

/// What such a search has told, and the files that it has left.
static STOPPED: LazyLock<(String, BTreeMap<PathBuf, Vec<u8>>)> = LazyLock::new(|| {
    let folder = repository();
    let told = stopped_on_the_way(folder.path());
    let results = fs::read_dir(folder.path().join("results")).unwrap();
    let names: Vec<_> = results.map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["unfinished"], "{told}");
    let left = fs::read_dir(folder.path().join("results/unfinished")).unwrap();
    let left = left.map(|entry| Path::new("results/unfinished").join(entry.unwrap().file_name()));
    let read = |file: PathBuf| (file.clone(), fs::read(folder.path().join(file)).unwrap());
    (told, left.map(read).collect())
});

/// A folder with what a search that was stopped has left, and what it has told.
fn stopped() -> (TempDir, &'static str) {
    let folder = repository();
    fs::create_dir_all(folder.path().join("results/unfinished")).unwrap();
    for (file, bytes) in &STOPPED.1 {
        fs::write(folder.path().join(file), bytes).unwrap();
    }
    (folder, &STOPPED.0)
}

#[test]
fn a_search_that_is_stopped_leaves_what_it_has_come_to() {
    let (folder, told) = stopped();
    let left = folder.path().join("results/unfinished");
    for name in ["parameters.toml", "gap.svg"] {
        let text = fs::read_to_string(left.join(name)).unwrap();
        assert!(text.contains("unfinished: the search was stopped"), "{text}");
        assert!(told.contains(&format!("results/unfinished/{name}")), "{told}");
    }
    let again = "simulate models/campaigns/axle_c_study --params results/unfinished/parameters.toml";
    assert_eq!(run_line(folder.path(), again).status, 0);
}

/// What else is there stays, be it by the name of a file that a search leaves.
#[test]
fn a_whole_search_takes_away_what_a_stopped_one_has_left() {
    let (folder, _) = stopped();
    let unfinished = folder.path().join("results/unfinished");
    let own = ["my.axle", "notes.txt"].map(|name| unfinished.join(name));
    fs::write(&own[0], "axle my {}\n").unwrap();
    fs::copy(unfinished.join("parameters.toml"), &own[1]).unwrap();
    let small = folder.path().join("small");
    fs::create_dir(&small).unwrap();
    write_noisy_road(&small);
    let search = "discover small --out results";
    assert_eq!(run_line(folder.path(), search).status, 0);
    let files = fs::read_dir(&unfinished).unwrap().map(|file| file.unwrap().path());
    assert_eq!(files.collect::<BTreeSet<_>>(), BTreeSet::from(own.clone()));
    own.iter().for_each(|file| fs::remove_file(file).unwrap());
    assert_eq!(run_line(folder.path(), search).status, 0);
    assert!(!unfinished.exists());
}

#[test]
fn files_are_whole_whenever_writing_is_stopped() {
    let folder = repository();
    // Three files of some hundred kilobytes each; the interruption comes as soon as their folder shows.
    let rides = folder.path().join("rides");
    let child = started(folder.path(), "simulate models/campaigns/axle_a_rig --out rides");
    while !rides.is_dir() {
        sleep(Duration::from_micros(200));
    }
    let (status, _, told) = interrupted(child);
    let files: Vec<_> = fs::read_dir(&rides)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    let is_run = |file: &&PathBuf| !file.ends_with("simulation.json");
    for file in files.iter().filter(is_run) {
        assert_eq!(file.extension().unwrap(), "csv", "{told}");
        let text = fs::read_to_string(file).unwrap();
        let columns = text.lines().next().unwrap().split(',').count();
        assert!(text.ends_with('\n') && text.lines().all(|line| line.split(',').count() == columns));
        let name = file.file_name().unwrap().to_str().unwrap();
        assert!(status == Some(0) || told.contains(name), "{name} is not in: {told}");
    }
    assert!(matches!(status, Some(0 | 130)), "{status:?} {told}");
    assert!(!files.is_empty(), "{told}");
}

#[test]
fn progress_is_for_terminals_alone() {
    let folder = repository();
    let child = started(folder.path(), "fit models/campaigns/axle_a_rig --starts 2");
    let output = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

/// Many campaigns, interrupted after the time that a few of them take.
#[test]
fn campaigns_that_are_scored_by_then_are_left() {
    const ALL: usize = 60;
    const FEW: u32 = 6;
    let folder = repository();
    let shipped = folder.path().join("models/campaigns/axle_a_rig");
    fs::create_dir(folder.path().join("campaigns")).unwrap();
    for number in 0..ALL {
        std::os::unix::fs::symlink(&shipped, folder.path().join(format!("campaigns/{number:02}"))).unwrap();
    }
    let begun = Instant::now();
    assert_eq!(run_line(folder.path(), "score campaigns/00").status, 0);
    let one = begun.elapsed();
    let child = started(folder.path(), "score campaigns");
    sleep(FEW * one);
    let (status, said, told) = interrupted(child);
    assert_eq!(status, Some(130), "{told}");
    assert!(said.starts_with("axle_a_rig: axle_a lacks nothing"), "{said}{told}");
    assert!(said.ends_with('\n') && said.contains("fit_phase_%"), "{said}{told}");
    assert!(said.matches("lacks nothing").count() < ALL, "{said}");
}
