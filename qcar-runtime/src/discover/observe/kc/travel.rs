//! Reads a quasi-static K&C cycle: the force over the travel, as the mean of both directions and as half their
//! difference.
//!
//! Friction and damping raise the force in one direction as much as they lower it in the other, so the mean is the
//! force of springs, stops and bushings. Half the width of the loop is the dry friction plus the damper force at the
//! rig speed. A campaign does not specify that speed. Sines of known speed limit the damper force; without them the
//! width is not used.

use nalgebra::Complex;

use crate::campaign::{Axis, Campaign, Quantity, Role, Test};
use crate::discover::observe::series::LEAST_NOISE;
use crate::discover::observe::{Evidence, Kind, Run, Series, Stimulus};
use crate::error::InputError;
use crate::kc::{SineSamples, sines};
use crate::model::{About, StateKind};
use crate::roles::{OnRig, Roles, state};
use crate::transmissibility::Point;

/// Location of the sensor for the force between wheel and body.
const LOCATION: &str = "wheel_to_body";

/// Largest number of values of a curve.
const VALUES: usize = 24;
/// Share of the travel that the values cover; at the ends the direction reverses.
const COVERED: f64 = 0.94;
/// Fewest samples of each direction for a value.
const FEWEST: usize = 4;
/// Fewest values that show the shape of a curve.
const FEWEST_VALUES: usize = 5;
/// Number of parts of the curve; the direction is taken over one part before and one after a sample.
const DIRECTION_PARTS: usize = 100;
/// Linearity error of a load cell relative to the largest force.
pub const FLOOR: f64 = 0.001;
/// Speed of a quasi-static rig, m/s: a whole cycle through 0.15 m of travel takes half a minute or longer.
const RIG: f64 = 0.01;

impl Evidence {
    pub(in crate::discover::observe) fn add_travel(
        &mut self,
        campaign: &Campaign,
        about: &About,
        run: &crate::campaign::Run,
        axis: Axis,
    ) -> Result<(), InputError> {
        let curve = campaign.curve(run)?;
        let Some(on) = self.on_rig(campaign, about, run, &axis) else {
            return Ok(());
        };
        let damping = (axis == Axis::Z).then(|| damping(campaign)).transpose()?.flatten();
        let Some(cycle) = Loop::read(&curve.displacement, &curve.force) else {
            self.notices
                .push(format!("{}: no whole cycle; the run is left out", run.name));
            return Ok(());
        };
        let place = self.runs.len();
        self.series.push(cycle.series(place, &axis, Kind::Travel, 0.0));
        self.series
            .extend(damping.map(|c| cycle.series(place, &axis, Kind::Width, c.abs() * RIG)));
        self.runs.push(Run {
            name: run.name.clone(),
            role: run.role,
            level: cycle.ends[1].max(-cycle.ends[0]),
            stimulus: Stimulus::Travel {
                on,
                axis,
                ends: cycle.ends,
            },
        });
        Ok(())
    }

    /// Wheel and body on the rig in a model; adds a notice and returns `None` if the model lacks them.
    pub fn on_rig(
        &mut self,
        campaign: &Campaign,
        about: &About,
        run: &crate::campaign::Run,
        axis: &Axis,
    ) -> Option<OnRig> {
        let moves = |location: &str| state(about, StateKind::Velocity, location, axis.name()).is_some();
        let roles = Roles::of(about, &campaign.roles).and_then(|roles| roles.on_rig());
        let on = roles.map_err(|error| error.to_string()).and_then(|on| {
            let fixed = |name: &str| format!("`{name}` of model `{}` does not move along {}", about.name, axis.name());
            let immobile = [&on.wheel, &on.body]
                .into_iter()
                .find(|name| !moves(name))
                .map(|name| fixed(name));
            immobile.map_or(Ok(on), Err)
        });
        on.map_err(|why| self.notices.push(format!("{}: {why}; the run is left out", run.name)))
            .ok()
    }
}

/// The sensor of the force on the wheel.
pub fn sensor(axis: Axis) -> Point {
    Point::new(LOCATION, axis, Quantity::Force)
}

/// Damping between wheel and body from the fitted sines of a campaign, N s/m; `None` if they do not determine it.
fn damping(campaign: &Campaign) -> Result<Option<f64>, InputError> {
    let is_sine = |run: &&crate::campaign::Run| run.role == Role::Fit && matches!(run.test, Test::DynamicBounce { .. });
    let curves = campaign
        .runs
        .iter()
        .filter(is_sine)
        .map(|run| campaign.dynamic_curve(run));
    let curves = curves.collect::<Result<Vec<_>, _>>()?;
    let samples: Vec<_> = curves.iter().map(SineSamples::from).collect();
    Ok(sines(&samples).ok().map(|sine| sine.damping.value))
}

/// Force over travel in both directions.
struct Loop {
    /// Lowest and highest travel, m.
    ends: [f64; 2],
    at: Vec<f64>,
    /// Force (N) for increasing and decreasing travel, each with its standard error.
    forces: Vec<[(f64, f64); 2]>,
    /// Largest absolute force, N.
    most: f64,
}

impl Loop {
    /// Reads a loop; `None` without enough travel in both directions.
    fn read(displacement: &[f64], force: &[f64]) -> Option<Self> {
        let (low, high) = displacement
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(*x), high.max(*x))
            });
        // A curve with few samples has fewer values, each from enough samples.
        let values = (displacement.len() / (2 * (FEWEST + 1))).clamp(FEWEST_VALUES, VALUES);
        let width = COVERED * (high - low) / values as f64;
        let first = low + (1.0 - COVERED) * (high - low) / 2.0;
        let (mut at, mut forces) = (Vec::new(), Vec::new());
        for value in 0..values {
            let middle = first + (value as f64 + 0.5) * width;
            let both = [1.0, -1.0].map(|sign| {
                let inside =
                    |&i: &usize| (displacement[i] - middle).abs() <= width / 2.0 && direction(displacement, i) == sign;
                let samples = (0..displacement.len()).filter(inside);
                line(samples.map(|i| [displacement[i] - middle, force[i]]).collect())
            });
            if let [Some(there), Some(back)] = both {
                at.push(middle);
                forces.push([there, back]);
            }
        }
        let most = force.iter().fold(0.0, |most: f64, f| f.abs().max(most));
        let ends = [low, high];
        (at.len() > values / 2).then_some(Self { ends, at, forces, most })
    }

    /// Series of the mean or of half the width. All travels share the error `common` (N). It is scaled so that all
    /// values together are as uncertain as a single one with this error.
    fn series(&self, run: usize, axis: &Axis, kind: Kind, common: f64) -> Series {
        let sign = if kind == Kind::Width { -1.0 } else { 1.0 };
        let floor = (FLOOR * self.most).hypot(common * (self.at.len() as f64).sqrt());
        let least = (LEAST_NOISE * self.most).hypot(common * (self.at.len() as f64).sqrt());
        let value = |[there, back]: &[(f64, f64); 2]| Complex::from((there.0 + sign * back.0) / 2.0);
        let noise = |[there, back]: &[(f64, f64); 2]| there.1.hypot(back.1) / 2.0;
        Series {
            run,
            sensor: sensor(axis.clone()),
            kind,
            at: self.at.clone(),
            value: self.forces.iter().map(value).collect(),
            sigma: self.forces.iter().map(|forces| noise(forces).hypot(floor)).collect(),
            noise: self.forces.iter().map(|forces| noise(forces).hypot(least)).collect(),
            least_discrepancy: FLOOR,
        }
    }
}

/// Value of a straight line through the samples at zero, and its standard error; `None` for too few samples.
fn line(samples: Vec<[f64; 2]>) -> Option<(f64, f64)> {
    let n = samples.len() as f64;
    let mean = |of: fn(&[f64; 2]) -> f64| samples.iter().map(of).sum::<f64>() / n;
    let (x, y, xx, xy) = (
        mean(|s| s[0]),
        mean(|s| s[1]),
        mean(|s| s[0] * s[0]),
        mean(|s| s[0] * s[1]),
    );
    let spread = xx - x * x;
    if samples.len() < FEWEST || spread <= 0.0 {
        return None;
    }
    let slope = (xy - x * y) / spread;
    let height = y - slope * x;
    let square = samples
        .iter()
        .map(|s| (s[1] - height - slope * s[0]).powi(2))
        .sum::<f64>();
    let variance = square / (n - 2.0) * (1.0 / n + x * x / (n * spread));
    Some((height, variance.sqrt()))
}

/// 1 if the travel increases, -1 if it decreases.
fn direction(displacement: &[f64], at: usize) -> f64 {
    let reach = (displacement.len() / DIRECTION_PARTS).max(1);
    let behind = displacement[at.saturating_sub(reach)];
    let before = displacement[(at + reach).min(displacement.len() - 1)];
    (before - behind).signum()
}
