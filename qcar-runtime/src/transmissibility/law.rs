//! The law by which the frequency of a sweep grows, from the times at which it passes three frequencies.

use super::Point;
use super::harmonics::Swept;
use crate::campaign::{History, Spacing, Test};
use crate::error::{InputError, Place, Problem};

/// Smallest difference of the shares of both laws that is clear: a fifth of the share of a logarithmic sweep. The laws of
/// a sweep over less than a factor of five differ by less, and so do their spectra.
const CLEAR: f64 = 0.1;
/// Samples in a period of the highest frequency that the check uses. A choice: enough for the times of passage, at a
/// fraction of the cost of all samples. What is folded is noise and harmonics, which do not move these times.
const IN_A_PERIOD: f64 = 8.0;

/// Refuses a sweep whose frequency grows by the other law than declared. One that does not pass its whole band is left to
/// other checks.
///
/// # Errors
/// Fails if `excitation`, the signal of `reference`, passes the middle of its band (on a logarithmic scale) at a time
/// that is nearer to that of the other law.
pub(super) fn check(history: &History, reference: &Point, excitation: &[f64]) -> Result<(), InputError> {
    let Test::Sweep(sweep) = &history.test else {
        return Ok(());
    };
    let band = (sweep.start_frequency, sweep.end_frequency);
    let quarter = (band.1 / band.0).powf(0.25);
    let [logarithmic, linear] = [0.5, 1.0 / (1.0 + quarter)];
    let (declared, other, name) = match sweep.spacing {
        Spacing::Logarithmic => (logarithmic, linear, ["logarithmic", "linear"]),
        Spacing::Linear => (linear, logarithmic, ["linear", "logarithmic"]),
    };
    if logarithmic - linear < CLEAR {
        return Ok(());
    }
    let stride = ((history.sample_rate / (IN_A_PERIOD * band.1)) as usize).max(1);
    let samples: Vec<f64> = excitation.iter().step_by(stride).copied().collect();
    let swept = Swept::new(&samples, history.sample_rate / stride as f64, band, 1);
    let times = [1, 2, 3].map(|power| swept.passage(band.0 * quarter.powi(power)).map(|own| own.time));
    let [Some(first), Some(middle), Some(last)] = times else {
        return Ok(());
    };
    let share = (middle - first) / (last - first);
    let is_other = (share - other).abs() < (share - declared).abs();
    if !is_other {
        return Ok(());
    }
    let found = format!("a frequency that grows by a {} law", name[1]);
    let (expected, remedy) = (
        format!("`spacing = \"{}\"`", name[0]),
        format!("write `spacing = \"{}\"` in campaign.toml", name[1]),
    );
    Err(Problem::new(
        &history.file,
        Place::Name(reference.to_string()),
        found,
        expected,
        remedy,
    )
    .into())
}
