//! Contents of a measured file. Only a part of the samples of a long recording is in memory at a time.

use std::collections::BTreeSet;
use std::path::Path;
use std::ptr;

use qcar_runtime::bounded;
use qcar_signals::error::ReadError;
use qcar_signals::find::Wanted;
use qcar_signals::read::channels;
use qcar_signals::samples::Samples;
use qcar_signals::signal::{Recording, Signal, TimeBase};

use super::summary::ChannelSummary;
use crate::failure::Failure;

/// Bytes of a file whose samples are in memory at a time. A longer file is read once if its format allows summaries,
/// and otherwise once for each such part.
const AT_ONCE: u64 = 128 << 20;

/// Contents of a file without samples, and the findings in the samples.
pub(in crate::verbs) struct Contents<T> {
    /// The recording, without samples and times of its signals.
    pub recording: Recording,
    found: Vec<(ChannelSummary, Option<T>)>,
}

/// A search in the samples of some channels.
pub(in crate::verbs) struct Look<'l, T> {
    /// True for a channel whose samples are wanted; decided without samples.
    pub is_in: &'l dyn Fn(&Signal) -> bool,
    /// Result of the search in a channel whose samples are all in memory.
    pub take: &'l dyn Fn(&Signal) -> Option<T>,
}

impl Contents<()> {
    /// Reads a file and keeps only the summaries of its samples.
    ///
    /// # Errors
    /// Fails if the file cannot be read.
    pub fn summary(file: &Path) -> Result<Self, Failure> {
        let nothing = Look {
            is_in: &|_| false,
            take: &|_| None,
        };
        Self::of(file, &nothing)
    }
}

impl<T> Contents<T> {
    /// Reads a file and searches the samples of the wanted channels.
    ///
    /// # Errors
    /// Fails if the file cannot be read.
    pub fn of(file: &Path, look: &Look<T>) -> Result<Self, Failure> {
        Self::in_parts(file, AT_ONCE, look)
    }

    fn in_parts(file: &Path, at_once: u64, look: &Look<T>) -> Result<Self, Failure> {
        let content = bounded::measured_file(file, "correct the path, or put the file there")?;
        let read = |wanted: &Wanted| {
            let file = file.into();
            channels(&content, wanted).map_err(|fault| Failure::Input(ReadError { file, fault }.to_string()))
        };
        let parts = content.length().div_ceil(at_once) as usize;
        if parts <= 1 {
            return Ok(Self::of_whole(read(&Wanted::All)?, look));
        }
        let listed = read(&Wanted::Summaries)?;
        // A format that can only be read as a whole has all channels now.
        if listed.signals.iter().any(|signal| !signal.samples.is_empty()) {
            return Ok(Self::of_whole(listed, look));
        }
        let at_a_time = listed.signals.len().div_ceil(parts).max(1);
        if listed
            .signals
            .iter()
            .all(|signal| signal.samples.stored_summary().is_some())
        {
            return Self::of_summarised(listed, at_a_time, read, look);
        }
        let patterns = patterns(&listed.signals);
        let mut contents = Contents {
            recording: Recording {
                signals: Vec::new(),
                ..listed
            },
            found: Vec::new(),
        };
        for names in patterns.chunks(at_a_time) {
            let names = names.concat();
            let wanted = Wanted::These(&names);
            contents.add(read(&wanted)?, &wanted, look);
        }
        Ok(contents)
    }

    /// Contents of summarised channels. Only channels whose samples are wanted are read again.
    fn of_summarised(
        mut recording: Recording,
        at_a_time: usize,
        read: impl Fn(&Wanted) -> Result<Recording, Failure>,
        look: &Look<T>,
    ) -> Result<Self, Failure> {
        let asked: Vec<usize> = (0..recording.signals.len())
            .filter(|&at| (look.is_in)(&recording.signals[at]))
            .collect();
        let mut found: Vec<(ChannelSummary, Option<T>)> = recording
            .signals
            .iter_mut()
            .map(|signal| (given_back(signal), None))
            .collect();
        for places in asked.chunks(at_a_time) {
            let names: Vec<String> = places.iter().map(|&at| recording.signals[at].full_name()).collect();
            let again = read(&Wanted::These(&names))?;
            for &at in places {
                let signal = again.signals.iter().find(|own| is_same(own, &recording.signals[at]));
                found[at].1 = signal.and_then(look.take);
            }
        }
        Ok(Contents { recording, found })
    }

    fn of_whole(mut recording: Recording, look: &Look<T>) -> Self {
        let found = recording.signals.iter_mut().map(|signal| looked_into(signal, look));
        let found = found.collect();
        Contents { recording, found }
    }

    /// The channels, each with its summary.
    pub fn channels(&self) -> impl Iterator<Item = (&Signal, &ChannelSummary)> {
        let found = self.found.iter().map(|(summary, _)| summary);
        self.recording.signals.iter().zip(found)
    }

    /// Summary of a channel of the recording, and the result of the search.
    pub fn found(&self, signal: &Signal) -> Option<&(ChannelSummary, Option<T>)> {
        let at = self.recording.signals.iter().position(|own| ptr::eq(own, signal))?;
        self.found.get(at)
    }

    /// Adds further wanted channels of a recording, and channels that turned out to be unreadable.
    fn add(&mut self, part: Recording, wanted: &Wanted, look: &Look<T>) {
        let before = self.recording.signals.len();
        for mut signal in part.signals {
            let mut known = self.recording.signals[..before].iter();
            if wanted.includes(&signal) && !known.any(|own| is_same(own, &signal)) {
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

/// For each channel the patterns that select it and, for an array of MATLAB that was not split, its columns and rows.
fn patterns(listed: &[Signal]) -> Vec<[String; 2]> {
    let mut left: BTreeSet<String> = listed.iter().map(Signal::full_name).collect();
    let distinct = listed.iter().map(Signal::full_name).filter(|name| left.remove(name));
    distinct.map(|name| [name.clone(), format!("{name}[*")]).collect()
}

fn is_same(one: &Signal, other: &Signal) -> bool {
    one.name == other.name && one.source == other.source
}

/// Summary of a channel and the result of the search; its samples are then released.
fn looked_into<T>(signal: &mut Signal, look: &Look<T>) -> (ChannelSummary, Option<T>) {
    let taken = if (look.is_in)(signal) {
        (look.take)(signal)
    } else {
        None
    };
    (given_back(signal), taken)
}

/// Summary of a channel, whose samples are then released.
fn given_back(signal: &mut Signal) -> ChannelSummary {
    let summary = ChannelSummary::of(signal);
    signal.samples = Samples::default();
    signal.time = TimeBase::Unknown;
    summary
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{AT_ONCE, Contents, Look};

    /// One or two channels at a time, for every format with long files.
    #[test]
    fn a_file_in_parts_gives_the_same_summary() {
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
            let summary = |at_once: u64| {
                let bits = Look {
                    is_in: &|_| true,
                    take: &|signal| Some(signal.samples.iter().map(f64::to_bits).collect()),
                };
                let contents: Contents<Vec<u64>> = Contents::in_parts(&folder.join(name), at_once, &bits).unwrap();
                let found = contents.found.iter().map(|(summary, samples)| {
                    let numbers = [
                        summary.min,
                        summary.max,
                        summary.mean,
                        summary.rms,
                        summary.rate,
                        summary.mean_rate,
                        summary.start,
                    ];
                    (
                        summary.samples,
                        summary.missing,
                        numbers,
                        summary.sparkline.clone(),
                        samples.clone(),
                    )
                });
                let found: Vec<_> = found.collect();
                (format!("{:?}", contents.recording), found)
            };
            let (whole, parts) = (summary(AT_ONCE), summary(1));
            assert_eq!(parts.0, whole.0, "{name}");
            assert_eq!(parts.1, whole.1, "{name}");
        }
    }
}
