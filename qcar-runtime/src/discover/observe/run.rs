//! Runs of a campaign and their excitation.

// Frequency band of a record.
mod band;
// Initial states and restarts of a record.
mod restart;
// Weighted means of a record.
mod means;
// A passage over an obstacle.
mod passage;

pub use band::Band;
pub use means::{Means, Pulses};
pub use passage::Passage;
pub(super) use passage::{COARSE_POINTS, FINE_POINTS, SEARCH_STEP_LIMIT, STEP_LIMIT};
pub use restart::{Restart, Spread, measures, zero_of};

use std::ops::Range;
use std::sync::Arc;

use crate::campaign::{Axis, Role};
use crate::roles::OnRig;
use crate::simulate::Accuracy;
use crate::transmissibility::Point;
use crate::transmissibility::harmonics::Swept;

/// A run of the campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its file, as named in the campaign.
    pub name: String,
    /// Its role: fitted or held out.
    pub role: Role,
    /// Level of its excitation, in the unit of the test: peak velocity (m/s) of a sweep, standard deviation of a
    /// history's first input (or of its first response without inputs), height (m) of an obstacle, largest travel (m)
    /// of a K&C cycle, amplitude (m) of a K&C sine, highest speed (m/s) of a dynamometer.
    pub level: f64,
    /// Its excitation.
    pub stimulus: Stimulus,
}

/// Excitation of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Stimulus {
    /// A swept sine.
    Sweep {
        /// Reference sensor of the responses.
        reference: Point,
        /// Samples of the reference, averaged over the sides.
        signal: Vec<f64>,
        /// Estimator of responses to the reference; `None` if its record is not available.
        swept: Option<Arc<Swept>>,
        /// Sample rate, Hz.
        rate: f64,
        /// Frequencies of the responses, Hz, increasing. Each value of a series of the run is at one of them.
        frequency: Vec<f64>,
        /// Amplitude of the reference at these frequencies, in its unit.
        amplitude: Vec<f64>,
        /// Time at which the sweep passes these frequencies, s after the first sample.
        time: Vec<f64>,
        /// First and last frequency of the sweep, Hz.
        band: (f64, f64),
    },
    /// Any other excitation, as recorded.
    History {
        /// Inputs of the model.
        inputs: Recordings,
        /// Sample rate, Hz.
        rate: f64,
        /// True if the inputs contain nothing above half the sample rate; false if they are held between samples.
        band_limited: bool,
        /// Initial states and later restarts of the model; the first is at the first sample.
        restarts: Vec<Restart>,
        /// Standard deviations of the initial states.
        spread: Spread,
        /// Frequency band that is compared; `None` for all frequencies.
        band: Option<Band>,
        /// True if the record consists of whole periods of a periodic motion.
        periodic: bool,
        /// Accuracy of its predictions.
        accuracy: Accuracy,
    },
    /// A road under a rolling tyre.
    Cleat(Passage),
    /// A K&C test: the rig moves the wheel slowly against the body.
    Travel {
        /// Wheel and body in the model.
        on: OnRig,
        /// Axis of the motion.
        axis: Axis,
        /// Lowest and highest travel, m.
        ends: [f64; 2],
    },
    /// A K&C test with a sine.
    Sine {
        /// Wheel and body in the model.
        on: OnRig,
        /// Axis of the motion.
        axis: Axis,
        /// Frequency of the sine, Hz.
        frequency: f64,
    },
    /// A dynamometer test: a single link is moved by sines of several peak velocities.
    Dynamometer {
        /// Name of the link in the model.
        link: String,
        /// Axis of the link in the model.
        axis: Axis,
        /// Amplitude of the sines, m.
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
    /// Times of the whole record, of which this may be a part, s.
    pub whole: Range<f64>,
    /// Sensors with their samples.
    pub signals: Vec<(Point, Vec<f64>)>,
}

/// Position of a value at `at` (Hz) among the frequencies of its sweep.
pub(super) fn line_at(frequency: &[f64], at: f64) -> usize {
    let line = frequency.iter().position(|own| *own == at);
    line.expect("a value of a sweep is at one of its frequencies")
}

/// Share of a record at each end that is not compared if its inputs are band-limited: their interpolation is inaccurate
/// there.
const ENDS: f64 = 0.02;

/// Number of samples at either end of a record that are not compared: where the band filter reaches beyond the record,
/// and where inputs that are interpolated within their band are inaccurate. None of a periodic record.
pub(super) fn left_out(band: Option<&Band>, is_interpolated: bool, periodic: bool, samples: usize) -> usize {
    if periodic {
        return 0;
    }
    let ends = if is_interpolated { ENDS } else { 0.0 };
    band.map_or(0, Band::half).max((ends * samples as f64) as usize)
}

impl Stimulus {
    /// The compared part of a recorded signal: filtered by the band, if there is one.
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

    /// Number of samples at either end of a record that are not compared: where the band filter reaches beyond the
    /// record, and the first and last 2 % if inputs are interpolated.
    pub fn cut(&self) -> usize {
        match self {
            Stimulus::History {
                band,
                band_limited,
                periodic,
                inputs,
                ..
            } => {
                let is_interpolated = *band_limited && !inputs.signals.is_empty();
                left_out(band.as_ref(), is_interpolated, *periodic, inputs.samples)
            }
            _ => 0,
        }
    }

    /// True if the mean of a signal is compared too.
    pub fn passes_mean(&self) -> bool {
        match self {
            Stimulus::History { band: Some(band), .. } => band.passes_mean(),
            _ => true,
        }
    }

    /// True for a free decay at whose beginning no sensor shows a position or a velocity.
    pub fn is_unmeasured_decay(&self) -> bool {
        let Stimulus::History { inputs, restarts, .. } = self else {
            return false;
        };
        inputs.signals.is_empty() && restarts.first().is_some_and(|first| first.readings.is_empty())
    }

    /// Sensors that record the excitation: one of a sweep, one for each input of a history. None for a road, a K&C or
    /// dynamometer test, and a free decay.
    pub fn references(&self) -> Vec<&Point> {
        match self {
            Stimulus::Sweep { reference, .. } => vec![reference],
            Stimulus::History { inputs, .. } => inputs.signals.iter().map(|(sensor, _)| sensor).collect(),
            Stimulus::Cleat(_) | Stimulus::Travel { .. } | Stimulus::Sine { .. } | Stimulus::Dynamometer { .. } => {
                Vec::new()
            }
        }
    }
}
