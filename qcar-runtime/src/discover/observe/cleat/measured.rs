//! Reads a cleat run: accelerations while a tyre rolls over an obstacle, as weighted means at evenly spaced times.

use nalgebra::Complex;

use crate::campaign::Campaign;
use crate::discover::observe::run::{FINE_POINTS, STEP_LIMIT};
use crate::discover::observe::sensor::sensors;
use crate::discover::observe::{Evidence, Kind, Means, Passage, Run, Series, Stimulus, signal_of};
use crate::error::InputError;
use crate::mean::rms;
use crate::model::About;
use crate::response::signal::output_of;
use crate::road::Road;
use crate::roles::Roles;
use crate::simulate::{Cleat, tyre};
use crate::transmissibility::{Point, signal};

/// Half width and spacing of the means, s. The gain is one half at 100 Hz and zero at 200 Hz. This keeps the modes of
/// an axle and removes effects of the recorder's filter and of the tyre's contact with an edge.
const HALF: f64 = 5e-3;
/// Duration of the evidence after the tyre circle reaches the obstacle, s: impact and after-shake.
const DURATION: f64 = 1.0;
/// Largest clock error of a record, s, from the trigger and from the speed error over the run-in.
pub const TIMING: f64 = 5e-3;
/// Largest time by which one sensor may lead the others, s.
const AHEAD: f64 = 0.01;
/// Error of any tyre model on an edge, and difference between the two sensors of a pair, as a share of the envelope. A
/// choice.
const SHARE: f64 = 0.025;
/// Error as a share of the RMS of the record, so that a record without noise has an uncertainty too. A choice.
const FLOOR: f64 = 0.002;
/// Number of values to each side for the envelope, an RMS over one period of wheel hop.
const AROUND: usize = 10;
/// Fewest samples at rest before the obstacle for an estimate of the noise.
const QUIET: usize = 20;

impl Evidence {
    pub(in crate::discover::observe) fn add_cleat(
        &mut self,
        campaign: &Campaign,
        about: &About,
        run: &crate::campaign::Run,
    ) -> Result<(), InputError> {
        let Some(cleat) = Cleat::read(campaign, run)? else {
            return Ok(());
        };
        if let Err(error) = Roles::of(about, &campaign.roles) {
            self.notices.push(format!("{}: {error}; the run is left out", run.name));
            return Ok(());
        }
        let (tyre, load) = tyre(campaign)?;
        let window = match Window::of(&cleat, tyre.radius()) {
            Ok(window) => window,
            Err(reason) => {
                self.notices
                    .push(format!("{}: {reason}; the run is left out", run.name));
                return Ok(());
            }
        };
        let (place, before) = (self.runs.len(), self.series.len());
        for sensor in self.keep_known(about, &run.name, sensors(about, &cleat.measured)) {
            let series = window.series(place, sensor.clone(), &signal(&cleat.measured, &sensor)?);
            match series.filter(|_| is_output(about, &sensor)) {
                Some(series) => self.series.push(series),
                None => self.notices.push(format!(
                    "{}: {sensor} has a constant signal, or one that the simulation does not give; it is left out",
                    run.name
                )),
            }
        }
        if self.series.len() > before {
            self.runs.push(Run {
                name: run.name.clone(),
                role: run.role,
                level: rise(&cleat.road),
                stimulus: Stimulus::Cleat(Passage {
                    speed: cleat.speed,
                    tyre,
                    load,
                    duration: window.end(),
                    means: window.means.sparse(),
                    most_steps: STEP_LIMIT,
                    points_a_sample: FINE_POINTS,
                    road: cleat.road,
                }),
            });
        }
        Ok(())
    }
}

/// True if a passage gives the measured quantity without differentiation.
fn is_output(about: &About, sensor: &Point) -> bool {
    output_of(about, &signal_of(about, sensor)).is_ok_and(|(_, power)| power == 0)
}

/// Height difference between the lowest and the highest point of the road, m.
fn rise(road: &Road) -> f64 {
    let heights = || road.vertices().iter().map(|vertex| vertex[1]);
    heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min)
}

/// The part of a record that is compared, in s after the wheel centre passes x = 0.
struct Window {
    means: Means,
    /// Time of the first sample.
    first: f64,
    /// Time before which the car is at rest.
    start: f64,
    /// Number of means.
    count: usize,
}

impl Window {
    fn of(cleat: &Cleat, radius: f64) -> Result<Self, String> {
        let (rate, first) = (cleat.measured.sample_rate, cleat.measured.start);
        let means = Means::new(rate, HALF);
        let start = (obstacle(&cleat.road) - radius) / cleat.speed;
        if (start - first) * rate < QUIET as f64 {
            return Err(format!(
                "the obstacle comes at {start:.3} s, too soon to estimate the noise before it"
            ));
        }
        let last = first + (cleat.measured.len() - 1) as f64 / rate;
        let end = (start + DURATION).min(last - means.half() - TIMING);
        let count = ((end - start) / means.half()).floor().max(0.0) as usize;
        if count < 2 * AROUND {
            return Err(format!("the record ends at {last:.3} s, before the obstacle is passed"));
        }
        Ok(Self {
            means,
            first,
            start,
            count,
        })
    }

    /// Duration of a simulated passage that covers the record, s.
    fn end(&self) -> f64 {
        self.start + (self.count + 1) as f64 * self.means.half() + TIMING + AHEAD
    }

    /// Series of one sensor; `None` if its signal never changes.
    fn series(&self, run: usize, sensor: Point, samples: &[f64]) -> Option<Series> {
        let at: Vec<f64> = (0..self.count)
            .map(|k| self.start + k as f64 * self.means.half())
            .collect();
        let (offset, noise) = self.quiet(samples);
        let value: Vec<f64> = at
            .iter()
            .map(|&t| self.means.at(samples, t - self.first).0 - offset)
            .collect();
        let floor = noise.hypot(FLOOR * rms(&value));
        let sigma = (0..value.len()).map(|k| floor.hypot(SHARE * envelope(&value, k)));
        (floor > 0.0).then(|| Series {
            run,
            sensor,
            kind: Kind::Passage,
            sigma: sigma.collect(),
            noise: vec![floor; value.len()],
            least_discrepancy: SHARE,
            value: value.iter().copied().map(Complex::from).collect(),
            at,
        })
    }

    /// Mean of the record before the obstacle, and the standard deviation of its weighted means.
    fn quiet(&self, samples: &[f64]) -> (f64, f64) {
        let rest = &samples[..((self.start - self.first) * self.means.rate()) as usize];
        let offset = rest.iter().sum::<f64>() / rest.len() as f64;
        let means: Vec<f64> = self.means.inside(rest).map(|mean| mean - offset).collect();
        (offset, rms(&means))
    }
}

/// Position at which a road first leaves its initial height, m.
fn obstacle(road: &Road) -> f64 {
    let vertices = road.vertices();
    let flat = vertices.iter().take_while(|vertex| vertex[1] == vertices[0][1]).count();
    vertices[flat - 1][0]
}

/// RMS of a passage around the `k`-th of its values, over one period of wheel hop.
pub fn envelope(values: &[f64], k: usize) -> f64 {
    rms(&values[k.saturating_sub(AROUND)..(k + AROUND + 1).min(values.len())])
}
