//! A file that stays on the disk is read as one in memory, and a channel that is read alone as one among all.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use qcar_signals::content::Content;
use qcar_signals::find::Wanted;
use qcar_signals::read::{channels, recognise};
use qcar_signals::signal::{Recording, Signal, TimeBase};

/// Every sample file that is not packed, and those of the folder that `QCAR_FORMAT_SAMPLES` names.
fn files() -> Vec<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/samples");
    let elsewhere = std::env::var_os("QCAR_FORMAT_SAMPLES").map(PathBuf::from);
    let samples = [Some(own), elsewhere].into_iter().flatten();
    let folders = samples
        .flat_map(|folder| fs::read_dir(folder).unwrap())
        .map(|entry| entry.unwrap().path());
    let files = folders
        .filter(|path| path.is_dir())
        .flat_map(|folder| fs::read_dir(folder).unwrap());
    let files = files.map(|entry| entry.unwrap().path());
    files
        .filter(|path| path.extension().is_none_or(|end| end != "gz"))
        .collect()
}

fn on_disk(file: &Path, wanted: &Wanted<'_>) -> Recording {
    let content = Content::of_file(File::open(file).unwrap()).unwrap();
    channels(&content, wanted).unwrap_or_else(|fault| panic!("{}: {fault}", file.display()))
}

/// Samples and times with their bits, since what is missing is not a number.
fn bits(signal: &Signal) -> (Vec<u64>, Option<Vec<u64>>) {
    let times = match &signal.time {
        TimeBase::Even { start, step } => Some(vec![*start, *step]),
        TimeBase::Times(times) => Some(times.to_vec()),
        TimeBase::Uneven { .. } | TimeBase::Unknown => None,
    };
    let own = signal.samples.iter().map(f64::to_bits).collect();
    (own, times.map(|times| times.into_iter().map(f64::to_bits).collect()))
}

#[test]
fn reading_from_disk_gives_the_same_as_from_memory() {
    let mut read = 0;
    for file in files() {
        let Ok(memory) = recognise(&fs::read(&file).unwrap()) else {
            continue;
        };
        let disk = on_disk(&file, &Wanted::All);
        let about = |recording: &Recording| {
            format!(
                "{} {:?} {:?}",
                recording.format, recording.scalars, recording.passed_over
            )
        };
        assert_eq!(about(&disk), about(&memory), "{}", file.display());
        assert_eq!(disk.signals.len(), memory.signals.len());
        for (a, b) in disk.signals.iter().zip(&memory.signals) {
            assert_eq!(
                (&a.name, &a.unit, &a.source, &a.labels),
                (&b.name, &b.unit, &b.source, &b.labels)
            );
            assert_eq!(bits(a), bits(b), "{}, {}", file.display(), a.name);
        }
        read += 1;
    }
    assert!(read > 20, "{read} files");
}

#[test]
fn a_channel_that_is_read_alone_has_the_same_samples_and_times() {
    let mut alone = 0;
    for file in files() {
        let Ok(all) = recognise(&fs::read(&file).unwrap()) else {
            continue;
        };
        for signal in all.signals.iter().take(4).chain(all.signals.last()) {
            let name = [signal.full_name()];
            let Ok(expected) = all.find(&name[0]) else { continue };
            let recording = on_disk(&file, &Wanted::These(&name));
            let own = recording
                .find(&name[0])
                .unwrap_or_else(|fault| panic!("{}: {fault}", file.display()));
            assert_eq!(bits(own), bits(expected), "{}, {}", file.display(), name[0]);
            alone += 1;
        }
    }
    assert!(alone > 50, "{alone} channels");
}

/// Formats of long recordings, whose other channels are not read.
#[test]
fn unwanted_channels_are_listed_without_samples() {
    let nobody = ["no channel is called so".to_string()];
    for end in ["mf4", "mdf", "rsp", "drv", "rpc", "tim", "tdms", "mat"] {
        let of_kind = || {
            files()
                .into_iter()
                .filter(|file| file.extension().is_some_and(|own| own == end))
        };
        assert!(of_kind().count() > 0, "no sample ends in .{end}");
        for file in of_kind() {
            let Ok(all) = recognise(&fs::read(&file).unwrap()) else {
                continue;
            };
            let none = on_disk(&file, &Wanted::These(&nobody));
            let matlab = end == "mat";
            assert!(matlab || none.signals.len() == all.signals.len(), "{}", file.display());
            assert!(
                none.signals.iter().all(|signal| signal.samples.is_empty()),
                "{}",
                file.display()
            );
        }
    }
}
