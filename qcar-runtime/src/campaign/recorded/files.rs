//! Measured files of any format, each read once for all the runs that are parts of it, unless they are very large.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use qcar_signals::error::{Fault, Place as Within};
use qcar_signals::read::recognise;
use qcar_signals::signal::Recording;

use crate::bounded;
use crate::error::{InputError, Place, Problem};

/// Samples that are kept for further runs, half a gigabyte of them; a file with more is forgotten when the next is read.
const KEPT: usize = 1 << 26;

/// The files of a campaign.
#[derive(Default)]
pub(in crate::campaign) struct Files {
    read: RefCell<HashMap<PathBuf, Result<Rc<Recording>, InputError>>>,
}

impl Files {
    /// The recording in a file.
    pub fn get(&self, file: &Path) -> Result<Rc<Recording>, InputError> {
        let known = self.read.borrow().get(file).cloned();
        known.unwrap_or_else(|| {
            self.forget_what_is_too_much();
            let recording = recording(file, BESIDE_MANIFEST).map(Rc::new);
            self.read.borrow_mut().insert(file.into(), recording.clone());
            recording
        })
    }

    fn forget_what_is_too_much(&self) {
        let mut read = self.read.borrow_mut();
        let samples: usize = read.values().flatten().map(|recording| samples(recording)).sum();
        if samples > KEPT {
            read.clear();
        }
    }
}

fn samples(recording: &Recording) -> usize {
    recording.signals.iter().map(|signal| signal.samples.len()).sum()
}

/// What to do about a file of a campaign that is not there.
pub(in crate::campaign) const BESIDE_MANIFEST: &str =
    "correct the path (it is relative to the folder of campaign.toml) or put the file there";

/// The recording in a file; `wrong_path` is what to do where it is not there.
///
/// # Errors
/// A file that cannot be read.
pub(in crate::campaign) fn recording(file: &Path, wrong_path: &str) -> Result<Recording, InputError> {
    let bytes = bounded::measured_file(file, wrong_path)?;
    recognise(&bytes).map_err(|fault| problem(file, &fault).into())
}

/// A fault of a file as the workbench reports it.
pub(in crate::campaign) fn problem(file: &Path, fault: &Fault) -> Problem {
    let place = match (&fault.place, &fault.channel) {
        (Within::File, None) => Place::File,
        (Within::File, Some(channel)) => Place::Channel(channel.clone(), None),
        (place, None) => Place::Words(place.to_string()),
        (place, Some(channel)) => Place::Words(format!("{place}, channel `{channel}`")),
    };
    Problem::new(file, place, &fault.found, &fault.expected, &fault.remedy)
}
