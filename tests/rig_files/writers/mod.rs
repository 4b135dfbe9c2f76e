//! Measured files as rigs and other programs write them: just what each format demands, from its specification, and
//! nothing shared with the readers.

pub mod mat5;
pub mod mat73;
pub mod mdf3;
pub mod mdf4;
pub mod rpc;
pub mod tables;
pub mod tdms;
pub mod uff;

/// Channels with common times.
#[derive(Clone)]
pub struct Group {
    /// Hz.
    pub rate: f64,
    /// Times in s, if they are not at this rate.
    pub stamps: Option<Vec<f64>>,
    /// All of one length.
    pub channels: Vec<Channel>,
}

/// A channel of a file.
#[derive(Clone)]
pub struct Channel {
    pub name: String,
    pub unit: String,
    pub samples: Vec<f64>,
}

impl Channel {
    pub fn new(name: &str, unit: &str, samples: Vec<f64>) -> Channel {
        Channel {
            name: name.into(),
            unit: unit.into(),
            samples,
        }
    }
}

impl Group {
    /// Channels at a rate in Hz.
    pub fn at(rate: f64, channels: Vec<Channel>) -> Group {
        Group {
            rate,
            stamps: None,
            channels,
        }
    }

    /// Channels at these times in s.
    pub fn stamped(stamps: Vec<f64>, channels: Vec<Channel>) -> Group {
        Group {
            rate: 1.0 / (stamps[1] - stamps[0]),
            stamps: Some(stamps),
            channels,
        }
    }

    /// Time of a sample in s.
    pub fn time(&self, sample: usize) -> f64 {
        let stamps = self.stamps.as_ref();
        stamps.map_or_else(|| sample as f64 / self.rate, |stamps| stamps[sample])
    }

    pub fn len(&self) -> usize {
        self.channels[0].samples.len()
    }

    /// Time and values of each sample as doubles, sample by sample.
    pub fn records(&self) -> Vec<u8> {
        let mut records = Vec::with_capacity(8 * self.len() * (1 + self.channels.len()));
        for sample in 0..self.len() {
            records.extend(self.time(sample).to_le_bytes());
            let values = self.channels.iter().map(|channel| channel.samples[sample]);
            records.extend(values.flat_map(f64::to_le_bytes));
        }
        records
    }
}
