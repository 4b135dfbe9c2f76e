//! Records cut into short windows, for a search that begins far from the right model.
//!
//! The errors of a wrong model add up along a record, and its phase drifts away from the measurement, so the cost has
//! many local minima. In a window of a few periods with initial states of its own they hardly add up, and the cost is
//! close to that of one-step prediction errors (multiple shooting: Bock, H. G., Plitt, K. J., IFAC world congress,
//! 1984; Ribeiro, A. H., Tiels, K., Umenberger, J., Schön, T. B., Aguirre, L. A.: On the smoothness of nonlinear system
//! identification, Automatica 121, 2020).

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use super::dataset::Evidence;
use super::run::{Recordings, Restart, Run, Stimulus};
use super::series::Series;
use crate::campaign::Quantity;
use crate::transmissibility::Point;

/// Most windows of a record, evenly spaced. A choice: each window has initial states of its own, which a fit estimates.
const MOST_WINDOWS: usize = 16;
/// Fewest compared values of each sensor in a window: more than the initial position and velocity can reproduce.
const FEWEST_VALUES: usize = 4;
/// Samples at either end of a window that are not compared, because the band limit of the inputs is inaccurate there.
const ENDS: usize = 4;

impl Evidence {
    /// The data with windows of this number of mean periods instead of each record; `None` if no record has room for
    /// two. A periodic record and one of which only a band is compared stay whole.
    pub fn in_windows(&self, periods: f64) -> Option<Self> {
        let (mut runs, mut all) = (Vec::new(), Vec::new());
        for (place, run) in self.runs.iter().enumerate() {
            let series: Vec<&Series> = self.series.iter().filter(|series| series.run == place).collect();
            for (run, series) in parts(run, &series, periods) {
                all.extend(series.into_iter().map(|series| Series {
                    run: runs.len(),
                    ..series
                }));
                runs.push(run);
            }
        }
        let is_cut = runs.len() > self.runs.len();
        is_cut.then(|| Self {
            runs,
            series: all,
            two_sided: self.two_sided,
            notices: self.notices.clone(),
            numbers: self.numbers.clone(),
            held_out_judge: self.held_out_judge,
        })
    }
}

/// The windows of a run with their series, or the whole run.
fn parts(run: &Run, series: &[&Series], periods: f64) -> Vec<(Run, Vec<Series>)> {
    let whole = || vec![(run.clone(), series.iter().copied().cloned().collect())];
    let Stimulus::History {
        inputs,
        rate,
        band: None,
        periodic: false,
        ..
    } = &run.stimulus
    else {
        return whole();
    };
    let period = series
        .iter()
        .map(|series| 2.0 * series.half_a_period())
        .fold(0.0, f64::max);
    let length = (periods * period * rate).ceil() as usize + 2 * ENDS;
    let windows = evenly(inputs.samples, length).into_iter();
    let parts: Vec<_> = windows.filter_map(|window| part(run, series, window)).collect();
    if parts.len() < 2 { whole() } else { parts }
}

/// Windows of a record of `samples` samples.
fn evenly(samples: usize, length: usize) -> Vec<Range<usize>> {
    let count = (samples / length).min(MOST_WINDOWS);
    let first = |k: usize| k * samples.saturating_sub(length) / (count - 1).max(1);
    (0..count).map(|k| first(k)..first(k) + length).collect()
}

/// A window of a run with its series; `None` if a sensor has too few values in it.
fn part(run: &Run, series: &[&Series], window: Range<usize>) -> Option<(Run, Vec<Series>)> {
    let mut part = run.clone();
    part.name = format!("{} from sample {}", run.name, window.start);
    let Stimulus::History {
        inputs,
        rate,
        restarts,
        spread,
        ..
    } = &mut part.stimulus
    else {
        return None;
    };
    // The zero of a sensor does not change within a record, and the initial states of a window make up for it.
    spread.zeros.clear();
    let time = |sample: usize| inputs.start + sample as f64 / *rate;
    let half = 0.5 / *rate;
    let compared = time(window.start + ENDS) - half..time(window.end - ENDS) - half;
    let start = time(window.start);
    let readings = series.iter().flat_map(|series| motion_at(series, start)).collect();
    let series: Vec<Series> = series.iter().map(|series| inside(series, &compared)).collect();
    if series.iter().any(|own| own.at.len() < FEWEST_VALUES) {
        return None;
    }
    *restarts = vec![Restart { sample: 0, readings }];
    *inputs = Recordings {
        start,
        samples: window.len(),
        whole: inputs.whole.clone(),
        signals: inputs
            .signals
            .iter()
            .map(|(point, samples)| (point.clone(), samples[window.clone()].to_vec()))
            .collect(),
    };
    Some((part, series))
}

/// The values of a series within these times (s).
fn inside(series: &Series, times: &Range<f64>) -> Series {
    let mut own = series.clone();
    let place = |time: f64| series.at.partition_point(|at| *at < time);
    own.keep(place(times.start)..place(times.end));
    own
}

/// Reading of a position or velocity sensor at a time (s), and for a position sensor the velocity too. They come from a
/// parabola fitted to the values within a sixteenth of a period on either side (Savitzky, A., Golay, M. J. E.:
/// Analytical Chemistry 36, 1964). Empty for other sensors, and if there are too few values so near.
fn motion_at(series: &Series, time: f64) -> Vec<(Point, f64)> {
    let [first, .., last] = series.at[..] else {
        return Vec::new();
    };
    let spacing = (last - first) / (series.at.len() - 1) as f64;
    let reach = (series.half_a_period() / 8.0).max(2.5 * spacing);
    let place = |time: f64| series.at.partition_point(|at| *at < time);
    let around = place(time - reach)..place(time + reach);
    let times = series.at[around.clone()].iter().map(|at| (at - time) / reach);
    let Some((value, slope)) = parabola(times.zip(series.value[around].iter().map(|value| value.re))) else {
        return Vec::new();
    };
    let known = (series.sensor.clone(), value);
    match series.sensor.quantity {
        Quantity::Velocity => vec![known],
        Quantity::Displacement => {
            let velocity = Point {
                quantity: Quantity::Velocity,
                ..series.sensor.clone()
            };
            vec![known, (velocity, slope / reach)]
        }
        Quantity::Acceleration | Quantity::Force => Vec::new(),
    }
}

/// Value and slope at 0 of the parabola with the least sum of squares; `None` through fewer than three points.
fn parabola(points: impl Iterator<Item = (f64, f64)>) -> Option<(f64, f64)> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (t, y) in points {
        let powers = Vector3::new(1.0, t, t * t);
        normal += powers * powers.transpose();
        right += powers * y;
    }
    let found = normal.cholesky()?.solve(&right);
    Some((found[0], found[1]))
}
