//! A quasi-static K&C cycle as evidence: the force over the travel, as the middle between both directions and as half
//! their distance.
//!
//! What friction and damping add to one direction they take from the other, so that the mean of both is what springs,
//! stops and bushings give. Half the width of the loop is the dry friction, and what dampers add at the speed of the rig.
//! A campaign does not say that speed; sines of known speed tell how much it may be, and without them the width is no
//! evidence.

use nalgebra::Complex;

use crate::campaign::{Axis, Campaign, Quantity, Role, Test};
use crate::discover::observe::series::LEAST_NOISE;
use crate::discover::observe::{Evidence, Kind, Run, Series, Stimulus};
use crate::error::InputError;
use crate::kc::{SineSamples, sines};
use crate::model::{About, StateKind};
use crate::roles::{OnRig, Roles, state};
use crate::transmissibility::Point;

/// Where the force between what the rig moves and what it holds is measured.
const LOCATION: &str = "wheel_to_body";

/// Values of a curve, and the share of the travel that they cover: at its ends the direction changes.
const VALUES: usize = 24;
const COVERED: f64 = 0.94;
/// A value needs so many samples of each direction.
const FEWEST: usize = 4;
/// A curve has at least so many values, or else its shape cannot be seen.
const FEWEST_VALUES: usize = 5;
/// The direction of travel is that over so many parts of the curve before and behind a sample.
const DIRECTION_PARTS: usize = 100;
/// Of the largest force: how straight a load cell is.
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
        let Some(on) = self.on_rig(campaign, about, run, axis) else {
            return Ok(());
        };
        let damping = (axis == Axis::Z).then(|| damping(campaign)).transpose()?.flatten();
        let Some(cycle) = Loop::read(&curve.displacement, &curve.force) else {
            self.notices
                .push(format!("{}: no whole cycle; the run is left out", run.name));
            return Ok(());
        };
        let place = self.runs.len();
        self.series.push(cycle.series(place, axis, Kind::Travel, 0.0));
        self.series
            .extend(damping.map(|c| cycle.series(place, axis, Kind::Width, c.abs() * RIG)));
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

    /// What the rig moves and holds in a model; leaves a notice where the model has no such parts.
    pub fn on_rig(
        &mut self,
        campaign: &Campaign,
        about: &About,
        run: &crate::campaign::Run,
        axis: Axis,
    ) -> Option<OnRig> {
        let moves = |location: &str| state(about, StateKind::Velocity, location, axis.name()).is_some();
        let roles = Roles::of(about, &campaign.roles).and_then(|roles| roles.on_rig());
        let on = roles.map_err(|error| error.to_string()).and_then(|on| {
            let still = |name: &str| format!("`{name}` of model `{}` does not move along {}", about.name, axis.name());
            let resting = [&on.wheel, &on.body]
                .into_iter()
                .find(|name| !moves(name))
                .map(|name| still(name));
            resting.map_or(Ok(on), Err)
        });
        on.map_err(|why| self.notices.push(format!("{}: {why}; the run is left out", run.name)))
            .ok()
    }
}

/// The sensor of the force on the wheel.
pub fn sensor(axis: Axis) -> Point {
    Point::new(LOCATION, axis, Quantity::Force)
}

/// What the fitted sines of a campaign say of the damping between wheel and body, N s/m; `None` without any.
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

/// Force over travel, there and back.
struct Loop {
    /// m, of the travel.
    ends: [f64; 2],
    at: Vec<f64>,
    /// Height of both ways, each with its standard error.
    ways: Vec<[(f64, f64); 2]>,
    /// The largest force.
    most: f64,
}

impl Loop {
    /// `None` without travel in both directions.
    fn read(displacement: &[f64], force: &[f64]) -> Option<Self> {
        let (low, high) = displacement
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(*x), high.max(*x))
            });
        // A curve of few samples has fewer values, each of enough of them.
        let values = (displacement.len() / (2 * (FEWEST + 1))).clamp(FEWEST_VALUES, VALUES);
        let width = COVERED * (high - low) / values as f64;
        let first = low + (1.0 - COVERED) * (high - low) / 2.0;
        let (mut at, mut ways) = (Vec::new(), Vec::new());
        for value in 0..values {
            let middle = first + (value as f64 + 0.5) * width;
            let both = [1.0, -1.0].map(|way| {
                let inside =
                    |&i: &usize| (displacement[i] - middle).abs() <= width / 2.0 && direction(displacement, i) == way;
                let samples = (0..displacement.len()).filter(inside);
                line(samples.map(|i| [displacement[i] - middle, force[i]]).collect())
            });
            if let [Some(there), Some(back)] = both {
                at.push(middle);
                ways.push([there, back]);
            }
        }
        let most = force.iter().fold(0.0, |most: f64, f| f.abs().max(most));
        let ends = [low, high];
        (at.len() > values / 2).then_some(Self { ends, at, ways, most })
    }

    /// The middle, or half the width, which may be off by `common` N alike at every travel. That is spread over the
    /// values, so that all of them together say no more than it allows.
    fn series(&self, run: usize, axis: Axis, kind: Kind, common: f64) -> Series {
        let sign = if kind == Kind::Width { -1.0 } else { 1.0 };
        let floor = (FLOOR * self.most).hypot(common * (self.at.len() as f64).sqrt());
        let least = (LEAST_NOISE * self.most).hypot(common * (self.at.len() as f64).sqrt());
        let value = |[there, back]: &[(f64, f64); 2]| Complex::from((there.0 + sign * back.0) / 2.0);
        let noise = |[there, back]: &[(f64, f64); 2]| there.1.hypot(back.1) / 2.0;
        Series {
            run,
            sensor: sensor(axis),
            kind,
            at: self.at.clone(),
            value: self.ways.iter().map(value).collect(),
            sigma: self.ways.iter().map(|ways| noise(ways).hypot(floor)).collect(),
            noise: self.ways.iter().map(|ways| noise(ways).hypot(least)).collect(),
            least_discrepancy: FLOOR,
        }
    }
}

/// Of samples on a straight line its height at zero, and the standard error of that; `None` of too few.
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

/// 1 where the travel grows, -1 where it falls.
fn direction(displacement: &[f64], at: usize) -> f64 {
    let reach = (displacement.len() / DIRECTION_PARTS).max(1);
    let behind = displacement[at.saturating_sub(reach)];
    let before = displacement[(at + reach).min(displacement.len() - 1)];
    (before - behind).signum()
}
