//! Peak and after-shake errors after alignment at the wheel's peak (thesis sections 2.1 and 3.6.2).

use crate::mean::mean_square;

/// The compared parts of a run, in s after its onset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Windows {
    /// Duration of the impact from the onset (section 2.1: 100 ms), in which peaks are searched.
    pub impact: f64,
    /// Duration of the after-shake after the impact; it ends earlier if the shorter record does.
    pub after_shake: f64,
}

impl Default for Windows {
    fn default() -> Self {
        Self {
            impact: 0.1,
            after_shake: 1.0,
        }
    }
}

/// Alignment of two records of one run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Alignment {
    /// The sample of the measurement at which the wheel reaches the obstacle.
    pub onset: usize,
    /// Delay of the simulation relative to the measurement, in samples.
    pub delay: isize,
}

/// Difference of a simulated acceleration from the measured one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Largest magnitude during the impact, m/s²: measured, simulated.
    pub peaks: [f64; 2],
    /// RMS during the after-shake, m/s²: measured without the noise before the onset, simulated.
    pub after_shakes: [f64; 2],
}

/// Reason why two records cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the message says it")]
pub enum CompareError {
    #[error("no upward acceleration of the wheel in the {record}")]
    NoPeak { record: &'static str },
    #[error("the after-shake of the {record} starts at sample {start}, but it has only {samples}; record for longer")]
    TooShort {
        record: &'static str,
        start: isize,
        samples: usize,
    },
}

/// The onset is where the wheel's acceleration first exceeds this share of its peak, upward or downward.
const ONSET_SHARE: f64 = 0.1;
/// Smallest simulated peak, relative to the highest, that may correspond to that of the measurement: an obstacle throws
/// the wheel up at both ends, and either peak may be the higher.
const PEAK_SHARE: f64 = 0.5;
/// Longest time between the onset and the peak of the wheel, s; earlier samples are noise.
const GUARD: f64 = 0.02;

impl Alignment {
    /// Aligns two records of the wheel's vertical acceleration, of one sample rate, by their upward peaks: the highest
    /// of the measurement, and that high peak of the simulation with which the records agree best.
    ///
    /// # Errors
    /// Fails if a record never rises above zero.
    pub fn at_peak(measured: &[f64], simulated: &[f64]) -> Result<Self, CompareError> {
        let (peak, onset) = peak_and_onset(measured, "measurement")?;
        let (_, highest) = upward_peak(simulated).ok_or(CompareError::NoPeak { record: "simulation" })?;
        let delays = high_peaks(simulated, PEAK_SHARE * highest).map(|place| place as isize - peak as isize);
        let apart = |delay: &isize| difference(measured, simulated, *delay);
        let delay = delays.min_by(|a, b| apart(a).total_cmp(&apart(b)));
        Ok(Self {
            onset,
            delay: delay.expect("the highest is among them"),
        })
    }
}

/// The first sample of a simulation at which the wheel reaches the obstacle, from its vertical acceleration.
///
/// # Errors
/// Fails if a record never rises above zero.
pub fn onset(record: &[f64]) -> Result<usize, CompareError> {
    Ok(peak_and_onset(record, "simulation")?.1)
}

fn peak_and_onset(samples: &[f64], record: &'static str) -> Result<(usize, usize), CompareError> {
    let (peak, height) = upward_peak(samples).ok_or(CompareError::NoPeak { record })?;
    let onset = samples.iter().position(|a| a.abs() > ONSET_SHARE * height);
    Ok((peak, onset.unwrap_or(peak)))
}

/// Local maxima of at least this height.
fn high_peaks(record: &[f64], least: f64) -> impl Iterator<Item = usize> + '_ {
    let beside = |at: usize| record.get(at).copied().unwrap_or(f64::NEG_INFINITY);
    let is_peak = move |&at: &usize| {
        let here = record[at];
        here >= least && here >= beside(at.wrapping_sub(1)) && here >= beside(at + 1)
    };
    (0..record.len()).filter(is_peak)
}

/// Sum of squared differences of a simulation with this delay, in samples; beyond its ends the simulation is zero.
fn difference(measured: &[f64], simulated: &[f64], delay: isize) -> f64 {
    let simulated = |at: usize| {
        usize::try_from(at as isize + delay)
            .ok()
            .and_then(|at| simulated.get(at))
    };
    let apart = |(at, own): (usize, &f64)| (own - simulated(at).copied().unwrap_or(0.0)).powi(2);
    measured.iter().enumerate().map(apart).sum()
}

fn upward_peak(record: &[f64]) -> Option<(usize, f64)> {
    let peak = record.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    peak.filter(|&(_, height)| height > 0.0)
}

/// Largest magnitude during the impact and RMS during the after-shake of a record without noise, m/s²; the impact
/// begins at the sample `onset`.
///
/// # Errors
/// Fails if the record ends before the after-shake begins.
pub fn sizes(record: &[f64], onset: usize, sample_rate: f64, windows: &Windows) -> Result<[f64; 2], CompareError> {
    let samples = |seconds: f64| (seconds * sample_rate).round() as isize;
    let onset = onset as isize;
    let impact_end = onset + samples(windows.impact);
    check_reaches("simulation", record, impact_end)?;
    let shake = cut(record, impact_end, impact_end + samples(windows.after_shake));
    Ok([magnitude(cut(record, onset, impact_end)), mean_square(shake).sqrt()])
}

impl Errors {
    /// Compares two records of one acceleration, both at `sample_rate` (Hz).
    ///
    /// # Errors
    /// Fails if a record ends before the after-shake begins.
    pub fn between(
        measured: &[f64],
        simulated: &[f64],
        alignment: &Alignment,
        sample_rate: f64,
        windows: &Windows,
    ) -> Result<Self, CompareError> {
        let onset = alignment.onset as isize;
        let impact_end = onset + (windows.impact * sample_rate).round() as isize;
        let wanted_end = impact_end + (windows.after_shake * sample_rate).round() as isize;
        let end = wanted_end
            .min(measured.len() as isize)
            .min(simulated.len() as isize - alignment.delay);
        check_reaches("measurement", measured, impact_end)?;
        check_reaches("simulation", simulated, impact_end + alignment.delay)?;
        let aligned = |from, to| {
            [
                cut(measured, from, to),
                cut(simulated, from + alignment.delay, to + alignment.delay),
            ]
        };
        let quiet = cut(measured, 0, onset - (GUARD * sample_rate) as isize);
        let [measured_shake, simulated_shake] = aligned(impact_end, end).map(mean_square);
        Ok(Self {
            peaks: aligned(onset, impact_end).map(magnitude),
            after_shakes: [
                (measured_shake - mean_square(quiet)).max(0.0).sqrt(),
                simulated_shake.sqrt(),
            ],
        })
    }

    /// Relative error of the peak, positive if the simulation is larger.
    pub fn peak(&self) -> f64 {
        relative(self.peaks)
    }

    /// Relative error of the RMS during the after-shake, positive if the simulation is larger.
    pub fn after_shake(&self) -> f64 {
        relative(self.after_shakes)
    }
}

fn check_reaches(record: &'static str, samples: &[f64], start: isize) -> Result<(), CompareError> {
    if start < samples.len() as isize {
        return Ok(());
    }
    Err(CompareError::TooShort {
        record,
        start,
        samples: samples.len(),
    })
}

fn relative([measured, simulated]: [f64; 2]) -> f64 {
    (simulated - measured) / measured
}

/// The samples of a record between two positions, as far as they exist.
fn cut(record: &[f64], from: isize, to: isize) -> &[f64] {
    let place = |i: isize| (i.max(0) as usize).min(record.len());
    &record[place(from)..place(to).max(place(from))]
}

fn magnitude(record: &[f64]) -> f64 {
    record.iter().fold(0.0, |largest, a| largest.max(a.abs()))
}
