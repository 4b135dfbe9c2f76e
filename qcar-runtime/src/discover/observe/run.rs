//! The runs of a campaign, and what drove them.

// The frequency band of a record that is compared.
mod band;
// Initial states, and resets of states that drift.
mod restart;
// A record reduced to weighted means.
mod means;
// A ride over an obstacle.
mod passage;

pub use band::Band;
pub use means::Means;
pub use passage::Passage;
pub(super) use passage::{COARSE_POINTS, FINE_POINTS, HURRIED, PATIENT};
pub use restart::{Restart, Spread, is_seen};

use std::sync::Arc;

use crate::campaign::{Axis, Role};
use crate::roles::OnRig;
use crate::transmissibility::Point;
use crate::transmissibility::harmonics::Swept;

/// A run of the campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its file, as the campaign calls it.
    pub name: String,
    /// What it may be used for.
    pub role: Role,
    /// How strongly it was driven, in the unit of its test: peak velocity (m/s) of a sweep, RMS of a
    /// history's input, height (m) of an obstacle, largest travel (m) of a K&C cycle,
    /// highest speed (m/s) of a dynamometer.
    pub level: f64,
    /// What drove it.
    pub stimulus: Stimulus,
}

/// What drove a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Stimulus {
    /// A swept sine.
    Sweep {
        /// The sensor that the responses are related to.
        reference: Point,
        /// Its mean signal over the sides.
        signal: Vec<f64>,
        /// Reads responses to it; `None` where its record is not at hand.
        swept: Option<Arc<Swept>>,
        /// Hz.
        rate: f64,
        /// Hz, increasing: where responses were asked for.
        frequency: Vec<f64>,
        /// Amplitude of the reference there, in its unit.
        amplitude: Vec<f64>,
        /// When the sweep passed there, s from its first sample.
        time: Vec<f64>,
        /// First and last frequency of the sweep, Hz.
        band: (f64, f64),
    },
    /// Anything else, as it was recorded.
    History {
        /// What drove the model.
        inputs: Recordings,
        /// Hz.
        rate: f64,
        /// True where the inputs hold nothing above half the sample rate, false where they are held between samples.
        band_limited: bool,
        /// From where the model sets out, and where it is set right; the first is at the first sample.
        restarts: Vec<Restart>,
        /// How far from there it may have been when the record began.
        spread: Spread,
        /// Which frequencies are compared; all without one.
        band: Option<Band>,
        /// True where the record is made of whole periods of a motion that repeats.
        periodic: bool,
    },
    /// A road under a rolling tyre.
    Cleat(Passage),
    /// A K&C rig that moved the wheel slowly against the body.
    Travel {
        /// What these are in the model.
        on: OnRig,
        /// Along which it moved.
        axis: Axis,
        /// m.
        ends: [f64; 2],
    },
    /// The same as a sine.
    Sine {
        /// What these are in the model.
        on: OnRig,
        /// Along which it moved.
        axis: Axis,
        /// Hz.
        frequency: f64,
    },
    /// A dynamometer that moved a link alone, as sines of several peak velocities.
    Dynamometer {
        /// Its name in the model.
        link: String,
        /// The axis of the model along which it stands.
        axis: Axis,
        /// m.
        amplitude: f64,
    },
}

/// Signals of one record.
#[derive(Clone, Debug, PartialEq)]
pub struct Recordings {
    /// Time of the first sample, s.
    pub start: f64,
    /// Number of samples.
    pub samples: usize,
    /// The sensors with their samples.
    pub signals: Vec<(Point, Vec<f64>)>,
}

impl Stimulus {
    /// What is compared of a signal that was recorded in the run, sample by sample.
    pub fn of_band(&self, signal: &[f64]) -> Vec<f64> {
        match self {
            Stimulus::History {
                band: Some(band),
                periodic,
                ..
            } => band.of(signal, *periodic),
            _ => signal.to_vec(),
        }
    }

    /// Samples at either end of a record that are not compared, since a band reaches beyond them.
    pub fn cut(&self) -> usize {
        match self {
            Stimulus::History {
                band: Some(band),
                periodic: false,
                ..
            } => band.half(),
            _ => 0,
        }
    }

    /// True where what never changes is compared too.
    pub fn holds_rest(&self) -> bool {
        match self {
            Stimulus::History { band: Some(band), .. } => band.holds_rest(),
            _ => true,
        }
    }

    /// The sensor of what drove the run; none measures a road, and a mass that swings out is driven by nothing.
    pub fn reference(&self) -> Option<&Point> {
        match self {
            Stimulus::Sweep { reference, .. } => Some(reference),
            Stimulus::History { inputs, .. } => inputs.signals.first().map(|(sensor, _)| sensor),
            Stimulus::Cleat(_) | Stimulus::Travel { .. } | Stimulus::Sine { .. } | Stimulus::Dynamometer { .. } => None,
        }
    }
}
