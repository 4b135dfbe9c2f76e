//! A file gone through channel by channel: of a long recording only a part of the samples is in memory at a time.

use std::collections::BTreeSet;
use std::path::Path;
use std::ptr;

use qcar_runtime::bounded;
use qcar_signals::error::ReadError;
use qcar_signals::find::Wanted;
use qcar_signals::read::channels;
use qcar_signals::samples::Samples;
use qcar_signals::signal::{Recording, Signal, TimeBase};

use super::course::Course;
use crate::failure::Failure;

/// Bytes of a file whose samples are in memory at a time. A file that is longer is gone through once for each such part of it.
const AT_ONCE: u64 = 128 << 20;

/// What is in a file, without the samples, and what was found in those.
pub(in crate::verbs) struct Contents<T> {
    /// Its signals have no samples and no times any more.
    pub recording: Recording,
    found: Vec<(Course, T)>,
}

impl<T> Contents<T> {
    /// Of a file, and of each channel also what `look` finds in its samples.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn of(file: &Path, look: impl Fn(&Signal) -> T) -> Result<Self, Failure> {
        Self::in_parts(file, AT_ONCE, look)
    }

    fn in_parts(file: &Path, at_once: u64, look: impl Fn(&Signal) -> T) -> Result<Self, Failure> {
        let content = bounded::measured_file(file, "correct the path, or put the file there")?;
        let read = |wanted: &Wanted| {
            let file = file.into();
            channels(&content, wanted).map_err(|fault| Failure::Input(ReadError { file, fault }.to_string()))
        };
        let parts = content.length().div_ceil(at_once) as usize;
        if parts <= 1 {
            return Ok(Self::of_whole(read(&Wanted::All)?, &look));
        }
        let listed = read(&Wanted::These(&[]))?;
        // Of a format that is read from the first byte to the last, all is there now.
        if listed.signals.iter().any(|signal| !signal.samples.is_empty()) {
            return Ok(Self::of_whole(listed, &look));
        }
        let patterns = patterns(&listed.signals);
        let mut contents = Contents {
            recording: Recording {
                signals: Vec::new(),
                ..listed
            },
            found: Vec::new(),
        };
        for names in patterns.chunks(patterns.len().div_ceil(parts).max(1)) {
            let names = names.concat();
            let wanted = Wanted::These(&names);
            contents.add(read(&wanted)?, &wanted, &look);
        }
        Ok(contents)
    }

    fn of_whole(mut recording: Recording, look: &impl Fn(&Signal) -> T) -> Self {
        let found = recording.signals.iter_mut().map(|signal| looked_into(signal, look));
        let found = found.collect();
        Contents { recording, found }
    }

    /// The channels, each with its course.
    pub fn channels(&self) -> impl Iterator<Item = (&Signal, &Course)> {
        let found = self.found.iter().map(|(course, _)| course);
        self.recording.signals.iter().zip(found)
    }

    /// What was found in a channel of the recording.
    pub fn found(&self, signal: &Signal) -> Option<&(Course, T)> {
        let at = self.recording.signals.iter().position(|own| ptr::eq(own, signal))?;
        self.found.get(at)
    }

    /// Adds the wanted channels of a recording that are not there yet, and what turned out to be none as its samples were read.
    fn add(&mut self, part: Recording, wanted: &Wanted, look: &impl Fn(&Signal) -> T) {
        let before = self.recording.signals.len();
        for mut signal in part.signals {
            let is_same = |own: &Signal| own.name == signal.name && own.source == signal.source;
            if wanted.means(&signal) && !self.recording.signals[..before].iter().any(is_same) {
                self.found.push(looked_into(&mut signal, look));
                self.recording.signals.push(signal);
            }
        }
        let passed = part.passed_over.into_iter();
        let new = passed.filter(|passed| !self.recording.passed_over.contains(passed));
        let new: Vec<_> = new.collect();
        self.recording.passed_over.extend(new);
    }
}

/// For each channel the patterns that mean it and, where it is an array of MATLAB that was not taken apart, its columns and rows.
fn patterns(listed: &[Signal]) -> Vec<[String; 2]> {
    let mut left: BTreeSet<String> = listed.iter().map(Signal::full_name).collect();
    let distinct = listed.iter().map(Signal::full_name).filter(|name| left.remove(name));
    distinct.map(|name| [name.clone(), format!("{name}[*")]).collect()
}

/// What a channel holds, whose samples are given back.
fn looked_into<T>(signal: &mut Signal, look: &impl Fn(&Signal) -> T) -> (Course, T) {
    let found = (Course::of(signal), look(signal));
    signal.samples = Samples::default();
    signal.time = TimeBase::Unknown;
    found
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{AT_ONCE, Contents, Signal};

    /// One channel or two at a time, of every format that may be long.
    #[test]
    fn a_file_in_parts_is_told_as_the_whole() {
        for name in [
            "mdf/plain_3groups.mf4",
            "mdf/special_text_invalid_bits.mf4",
            "mdf/v330_3groups.mdf",
            "rpc/short_4frames_group.tim",
            "rpc/drive_spaces_zero_channel.drv",
            "tdms/waveform_2segments.tdms",
            "tdms/int16_linear_scale_time_channel.tdms",
            "mat/labcontrol_ensaio_A1.mat",
            "mat/dspace_v6.mat",
            "mat/testlab_v7.mat",
            "mat/testlab_v73.mat",
            "mat/h5py_v114.mat",
            "table/rig_units_row_bom_crlf.csv",
        ] {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("qcar-signals/tests/samples");
            let told = |at_once: u64| {
                let bits = |signal: &Signal| signal.samples.iter().map(f64::to_bits).collect();
                let contents: Contents<Vec<u64>> = Contents::in_parts(&folder.join(name), at_once, bits).unwrap();
                let found = contents.found.iter().map(|(course, samples)| {
                    let numbers = [
                        course.min,
                        course.max,
                        course.mean,
                        course.rms,
                        course.rate,
                        course.start,
                    ];
                    (
                        course.samples,
                        course.missing,
                        numbers,
                        course.sparkline.clone(),
                        samples.clone(),
                    )
                });
                let found: Vec<_> = found.collect();
                (format!("{:?}", contents.recording), found)
            };
            let (whole, parts) = (told(AT_ONCE), told(1));
            assert_eq!(parts.0, whole.0, "{name}");
            assert_eq!(parts.1, whole.1, "{name}");
        }
    }
}
