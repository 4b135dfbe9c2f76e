//! Measured files of any format, each read once for all the runs that are parts of it.

use std::cell::RefCell;
use std::collections::HashMap;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use flate2::read::MultiGzDecoder;
use qcar_signals::error::{Fault, Place as Within};
use qcar_signals::read::recognise;
use qcar_signals::signal::Recording;

use crate::bounded;
use crate::error::{InputError, Place, Problem};

/// What gzip packed begins with this.
const GZIP: &[u8] = b"\x1f\x8b";

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
            let recording = recording(file).map(Rc::new);
            self.read.borrow_mut().insert(file.into(), recording.clone());
            recording
        })
    }
}

/// The recording in a file.
///
/// # Errors
/// A file that cannot be read.
pub(in crate::campaign) fn recording(file: &Path) -> Result<Recording, InputError> {
    let bytes = unpacked(file).map_err(|error| {
        let remedy = match error.kind() {
            io::ErrorKind::FileTooLarge => "if the file is what it should be, raise the limit",
            _ => "correct the path (it is relative to the folder of campaign.toml) or put the file there",
        };
        InputError::from(Problem::new(
            file,
            Place::File,
            error.to_string(),
            "a readable file",
            remedy,
        ))
    })?;
    recognise(&bytes).map_err(|fault| problem(file, &fault).into())
}

fn unpacked(file: &Path) -> io::Result<Vec<u8>> {
    let (mut bytes, mut whole) = (Vec::new(), Vec::new());
    bounded::limited(bounded::open(file)?).read_to_end(&mut bytes)?;
    if !bytes.starts_with(GZIP) {
        return Ok(bytes);
    }
    bounded::limited(MultiGzDecoder::new(bytes.as_slice())).read_to_end(&mut whole)?;
    Ok(whole)
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
