//! Measured files of any format. Each is read once for all its runs, unless it is very large.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use qcar_signals::error::{Fault, Place as Within};
use qcar_signals::find::Wanted;
use qcar_signals::read::channels;
use qcar_signals::signal::Recording;

use crate::bounded;
use crate::error::{InputError, Place, Problem};

/// Number of samples that are kept for further runs, half a gigabyte. A larger file is read again for the next run.
const KEPT: usize = 1 << 26;

/// The files of a campaign.
#[derive(Default)]
pub(in crate::campaign) struct Files {
    read: RefCell<HashMap<PathBuf, FileContents>>,
}

/// Contents of a file.
struct FileContents {
    /// Names and patterns of the channels with samples; `None` for all.
    wanted: Option<Vec<String>>,
    recording: Result<Rc<Recording>, InputError>,
}

impl FileContents {
    fn has(&self, sources: &[String]) -> bool {
        let known = self.wanted.as_ref();
        known.is_none_or(|known| sources.iter().all(|source| known.contains(source)))
    }
}

impl Files {
    /// The recording in a file.
    pub fn get(&self, file: &Path) -> Result<Rc<Recording>, InputError> {
        let known = self
            .read
            .borrow_mut()
            .remove(file)
            .filter(|known| known.wanted.is_none());
        let known = known.map(|known| known.recording);
        self.keep(file, None, known.unwrap_or_else(|| self.read(file, &Wanted::All)))
    }

    /// The same with the samples of at least the channels that these names and patterns select, since a long recording
    /// has many more than a campaign needs.
    pub fn with(&self, file: &Path, sources: &[String]) -> Result<Rc<Recording>, InputError> {
        let known = self.read.borrow_mut().remove(file);
        match known {
            Some(known) if known.has(sources) => self.keep(file, known.wanted, known.recording),
            // A later run may name more channels.
            known => {
                let mut wanted = known.and_then(|known| known.wanted).unwrap_or_default();
                wanted.extend_from_slice(sources);
                let recording = self.read(file, &Wanted::These(&wanted));
                self.keep(file, Some(wanted), recording)
            }
        }
    }

    fn read(&self, file: &Path, wanted: &Wanted<'_>) -> Result<Rc<Recording>, InputError> {
        self.forget_what_is_too_much();
        wanted_recording(file, BESIDE_MANIFEST, wanted).map(Rc::new)
    }

    fn keep(
        &self,
        file: &Path,
        wanted: Option<Vec<String>>,
        recording: Result<Rc<Recording>, InputError>,
    ) -> Result<Rc<Recording>, InputError> {
        let known = FileContents {
            wanted,
            recording: recording.clone(),
        };
        self.read.borrow_mut().insert(file.into(), known);
        recording
    }

    fn forget_what_is_too_much(&self) {
        let mut read = self.read.borrow_mut();
        let samples: usize = read
            .values()
            .flat_map(|known| &known.recording)
            .map(|recording| samples(recording))
            .sum();
        if samples > KEPT {
            read.clear();
        }
    }
}

fn samples(recording: &Recording) -> usize {
    recording.signals.iter().map(|signal| signal.samples.len()).sum()
}

/// Remedy for a missing file of a campaign.
pub(in crate::campaign) const BESIDE_MANIFEST: &str =
    "correct the path (relative to the folder of campaign.toml), or put the file there";

/// The recording in a file; `wrong_path` is the remedy if the file is missing.
///
/// # Errors
/// Fails if the file cannot be read.
pub(in crate::campaign) fn recording(file: &Path, wrong_path: &str) -> Result<Recording, InputError> {
    wanted_recording(file, wrong_path, &Wanted::All)
}

fn wanted_recording(file: &Path, wrong_path: &str, wanted: &Wanted<'_>) -> Result<Recording, InputError> {
    let content = bounded::measured_file(file, wrong_path)?;
    channels(&content, wanted).map_err(|fault| problem(file, &fault).into())
}

/// Converts an error of a reader to an error of the workbench.
pub(in crate::campaign) fn problem(file: &Path, fault: &Fault) -> Problem {
    let place = match (&fault.place, &fault.channel) {
        (Within::File, None) => Place::File,
        (Within::File, Some(channel)) => Place::Channel(channel.clone(), None),
        (place, None) => Place::Words(place.to_string()),
        (place, Some(channel)) => Place::Words(format!("{place}, channel `{channel}`")),
    };
    Problem::new(file, place, &fault.found, &fault.expected, &fault.remedy)
}
