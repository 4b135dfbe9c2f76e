//! Reads a sweep: the first three harmonics of every sensor over the amplitude of the pad.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::Complex;

use crate::campaign::{Campaign, Sweep};
use crate::discover::observe::sensor::{is_motion, sensors};
use crate::discover::observe::series::LEAST_NOISE;
use crate::discover::observe::{Evidence, Kind, Run, Series, Stimulus};
use crate::error::{InputError, Place, Problem};
use crate::model::About;
use crate::transmissibility::harmonics::{HarmonicLine, Neighbourhood, Passage, Swept};
use crate::transmissibility::{Point, signal};

/// Number of harmonics in the evidence: the second shows asymmetric laws, the third symmetric nonlinear ones.
pub const ORDERS: usize = 3;

/// Neighbourhood of a line: wide enough for eight unknowns and narrow enough to resolve a mode.
pub const AROUND: Neighbourhood = Neighbourhood {
    lines: 10,
    width: 0.035,
};

/// Smallest relative distance of frequencies; closer lines repeat the same information.
const RATIO: f64 = 0.05;

/// Smallest distance of frequencies in spectral lines; closer neighbourhoods repeat the same information.
const LINES_APART: f64 = 6.0;

/// Relative error of the first harmonic from the estimator (see
/// [`Estimator::LOCAL`](crate::transmissibility::Estimator)) and from differences between the sides of a car. For the
/// higher harmonics it is the smallest discrepancy, relative to the first.
const FLOOR: f64 = 0.002;

/// Relative difference of the first harmonic between the mean of two sides and one side with mean parameters. If
/// stiffnesses differ by 1.5 %, resonances differ by 0.75 %. With a damping ratio of 5 %, the mean of two peaks is
/// lower than one peak by half the square of 0.75 / 2 / 5, and the flanks differ by as much again.
const OF_SIDES: f64 = 0.005;

impl Evidence {
    pub(in crate::discover::observe) fn add_sweep(
        &mut self,
        campaign: &Campaign,
        about: &About,
        run: &crate::campaign::Run,
        sweep: &Sweep,
    ) -> Result<(), InputError> {
        let history = campaign.history(run)?;
        let (pads, others): (Vec<_>, Vec<_>) = sensors(about, &history)
            .into_iter()
            .partition(|point| is_motion(about, point));
        let reference = only_pad(about, &pads, &history.file)?;
        let sensors = self.keep_known(about, &run.name, others);
        if sensors.is_empty() {
            self.notices
                .push(format!("{}: no sensor but the pad's; the run is left out", run.name));
            return Ok(());
        }
        let excitation = signal(&history, &reference)?;
        let band = (sweep.start_frequency, sweep.end_frequency);
        let rate = history.sample_rate;
        let swept = Swept::new(&excitation, rate, band, ORDERS);
        let grid = grid(band, rate / excitation.len() as f64);
        let passed: Vec<(f64, Passage)> = grid.into_iter().filter_map(|f| Some((f, swept.passage(f)?))).collect();
        let frequency: Vec<f64> = passed.iter().map(|(f, _)| *f).collect();
        let (place, before) = (self.runs.len(), self.series.len());
        for sensor in sensors {
            let samples = signal(&history, &sensor)?;
            let harmonics = (1..=ORDERS).map(|order| {
                let at: Vec<f64> = usable(&frequency, order, rate);
                let response: Vec<f64> = at.iter().map(|f| f * order as f64).collect();
                let lines = swept.responses(&samples, &response, AROUND);
                series(place, &sensor, order, (at, lines))
            });
            self.add_harmonics(&run.name, &sensor.location, harmonics);
        }
        if self.series.len() == before {
            return Ok(());
        }
        self.runs.push(Run {
            name: run.name.clone(),
            role: run.role,
            level: sweep.peak_velocity,
            stimulus: Stimulus::Sweep {
                reference,
                signal: excitation,
                swept: Some(Arc::new(swept)),
                rate,
                frequency,
                amplitude: passed.iter().map(|(_, own)| own.amplitude).collect(),
                time: passed.iter().map(|(_, own)| own.time).collect(),
                band,
            },
        });
        Ok(())
    }

    /// Adds the harmonics of a sensor, the first one first, or a notice if that shows nothing but noise.
    fn add_harmonics(&mut self, run: &str, location: &str, mut harmonics: impl Iterator<Item = Series>) {
        match harmonics.next().filter(is_above_noise) {
            Some(first) => self.series.extend(std::iter::once(first).chain(harmonics)),
            None => self.notices.push(format!(
                "{run}: `{location}` shows nothing but noise; that sensor is left out"
            )),
        }
    }
}

/// The sensor of the motion that drives the model in a sweep.
///
/// # Errors
/// Fails if the sensors measure none or several of these motions.
fn only_pad(about: &About, pads: &[Point], file: &Path) -> Result<Point, InputError> {
    let place = |pad: &Point| (pad.location.clone(), pad.axis.clone());
    match pads {
        [reference, others @ ..] if others.iter().all(|pad| place(pad) == place(reference)) => Ok(reference.clone()),
        _ => Err(not_one_pad(about, pads, file.to_path_buf()).into()),
    }
}

fn not_one_pad(about: &About, pads: &[Point], file: PathBuf) -> Problem {
    let (place, name) = (Place::Line(1), |point: &Point| point.to_string());
    if pads.is_empty() {
        let motions = about.excitations.iter().filter(|e| !e.force);
        let motions: Vec<String> = motions.map(|e| format!("`{}` along {}", e.name, e.axis)).collect();
        let expected = match &motions[..] {
            [] => "a model that is driven by a motion".to_string(),
            some => format!("a channel at {}", some.join(" or ")),
        };
        let remedy = "add the pad's channel to the run: it is what the responses are related to";
        return Problem::new(file, place, "no sensor at what moves the model", expected, remedy);
    }
    let found = format!(
        "sensors at several pads: {}",
        pads.iter().map(name).collect::<Vec<_>>().join(", ")
    );
    let remedy = "remove the channels of all pads but the one that was driven, and take a model with one tyre";
    Problem::new(file, place, found, "one that drives the model", remedy)
}

/// True if at least 5 % of the values exceed three standard deviations. Noise alone exceeds them once in eight thousand
/// values.
fn is_above_noise(series: &Series) -> bool {
    const SIGNIFICANT: f64 = 3.0;
    const SHARE: f64 = 0.05;
    let pairs = series.value.iter().zip(&series.sigma);
    let significant = pairs
        .filter(|(value, sigma)| value.norm() > SIGNIFICANT * **sigma)
        .count();
    significant as f64 > SHARE * series.value.len() as f64
}

/// Frequencies whose neighbourhoods overlap little: equally spaced at low frequencies, in equal ratios above.
fn grid((first, last): (f64, f64), spacing: f64) -> Vec<f64> {
    /// Distance from the lower end of the band as a frequency ratio; its square root at the upper end. The ends of a
    /// sweep are faded, and the noise cannot be estimated beyond them.
    const INSIDE: f64 = 1.2;
    let next = |f: &f64| Some(f + (RATIO * f).max(LINES_APART * spacing));
    std::iter::successors(Some(first * INSIDE), next)
        .take_while(|f| *f * INSIDE.sqrt() < last)
        .collect()
}

/// The frequencies whose harmonic of this order lies well below half the sample `rate` (Hz). A higher harmonic uses
/// every second frequency.
fn usable(frequency: &[f64], order: usize, rate: f64) -> Vec<f64> {
    let highest = 0.2 * rate;
    let step = if order == 1 { 1 } else { 2 };
    frequency
        .iter()
        .copied()
        .step_by(step)
        .filter(|f| f * (order as f64) < highest)
        .collect()
}

fn series(run: usize, sensor: &Point, order: usize, (at, lines): (Vec<f64>, Vec<HarmonicLine>)) -> Series {
    let noise = smooth(&lines.iter().map(|line| line.variance[order - 1]).collect::<Vec<_>>());
    let value: Vec<Complex<f64>> = lines
        .iter()
        .map(|line| line.value[order - 1].unwrap_or_default())
        .collect();
    let floor = |value: &Complex<f64>| {
        if order == 1 {
            (FLOOR * value.norm()).powi(2)
        } else {
            0.0
        }
    };
    Series {
        run,
        sensor: sensor.clone(),
        kind: Kind::Harmonic(order),
        noise: noise
            .iter()
            .zip(&value)
            .map(|(noise, value)| noise.sqrt().hypot(LEAST_NOISE * value.norm()).max(f64::MIN_POSITIVE))
            .collect(),
        least_discrepancy: if order == 1 { OF_SIDES } else { FLOOR },
        sigma: noise
            .iter()
            .zip(&value)
            .map(|(noise, value)| (noise + floor(value)).sqrt())
            .collect(),
        at,
        value,
    }
}

/// Median over five neighbours: a variance from few lines is itself uncertain.
fn smooth(variance: &[f64]) -> Vec<f64> {
    const HALF: usize = 2;
    (0..variance.len())
        .map(|k| {
            let mut around = variance[k.saturating_sub(HALF)..(k + HALF + 1).min(variance.len())].to_vec();
            let middle = around.len() / 2;
            *around.select_nth_unstable_by(middle, f64::total_cmp).1
        })
        .collect()
}
