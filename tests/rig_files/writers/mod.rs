//! Measured files as rigs and other programs write them: just what each format demands, from its specification, and nothing
//! shared with the readers.

pub mod mat5;
pub mod mdf4;
pub mod rpc;
pub mod tables;
pub mod tdms;
pub mod uff;

/// Channels of one rate.
pub struct Group {
    /// Hz.
    pub rate: f64,
    /// All of one length.
    pub channels: Vec<Channel>,
}

/// A channel of a file.
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
    pub fn len(&self) -> usize {
        self.channels[0].samples.len()
    }
}
