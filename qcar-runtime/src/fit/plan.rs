//! Choices of the engineer: starts, bounds, weights.

use crate::campaign::{Campaign, Parameter};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The decisions of a fit.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The file with these choices, for error messages.
    pub source: PathBuf,
    /// Start values and bounds, and the choice of the fitted parameters.
    pub parameters: Vec<Parameter>,
    /// Vehicle data, which may include parameters of the model.
    pub vehicle: BTreeMap<String, f64>,
    /// Weights of channels by name; the others have [`ChannelWeight::default`].
    pub channels: BTreeMap<String, ChannelWeight>,
    /// Weighting of the lines.
    pub weighting: Weighting,
    /// Number of local searches: the first from the start values, the others spread over the bounds.
    pub starts: usize,
    /// Seed of the other starts.
    pub seed: u64,
    /// Relative standard deviation of a sensor's gain, for the error bars.
    pub gain_error: f64,
}

/// How the errors of a channel are weighted (thesis sections 3.5.2.1 and 3.5.2.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelWeight {
    /// λ: the share of the magnitude; the phase has the rest.
    pub lambda: f64,
    /// Band, Hz; `None` for the band of the excitation.
    pub band: Option<(f64, f64)>,
    /// Weight inside the band; outside it is 0.05 times as large.
    pub importance: f64,
}

/// Weighting of the lines of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighting {
    /// The bands of the thesis alone.
    Thesis,
    /// The bands, times `1/√(1 + (σ/1 %)²)`. This fades out lines whose random error σ exceeds the 1 % that sensors and
    /// asymmetry cause in every line.
    Noise,
}

/// The λ that weights magnitude and phase errors of equal size in the complex plane equally: one neper is 8.69 dB over
/// 3 dB; one radian is 1/π. The thesis leaves λ to the engineer.
pub const BALANCED_LAMBDA: f64 = 0.099;

impl Default for ChannelWeight {
    fn default() -> Self {
        Self {
            lambda: BALANCED_LAMBDA,
            band: None,
            importance: 1.0,
        }
    }
}

impl Plan {
    /// The plan of a campaign: its start values and bounds, the default weights, sixteen starts, and a
    /// gain error of 0.5 %, the class of a calibrated accelerometer.
    pub fn new(campaign: &Campaign) -> Self {
        Self {
            source: campaign.manifest(),
            parameters: campaign.parameters.clone(),
            vehicle: campaign.vehicle.iter().cloned().collect(),
            channels: BTreeMap::new(),
            weighting: Weighting::Noise,
            starts: 16,
            seed: 0,
            gain_error: 0.005,
        }
    }

    /// The weights of a channel.
    pub fn weight(&self, channel: &str) -> ChannelWeight {
        self.channels.get(channel).copied().unwrap_or_default()
    }
}
