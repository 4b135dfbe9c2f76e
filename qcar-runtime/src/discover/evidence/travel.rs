//! A quasi-static K&C cycle as evidence: the force over the travel, in the middle between both directions.
//!
//! What friction and damping add to one direction they take from the other, so that the mean of both is what springs,
//! stops and bushings give. How wide the loop is depends on the speed of the rig, which a campaign does not say.

use nalgebra::Complex;

use super::{Evidence, Kind, Run, Series, Stimulus};
use crate::campaign::{Axis, Campaign, Quantity};
use crate::error::InputError;
use crate::model::{About, StateKind};
use crate::transmissibility::Point;

/// What the rig moves against each other; also the location of the force between them.
pub(in crate::discover) const MOVED: &str = "wheel";
pub(in crate::discover) const HELD: &str = "body";
const LOCATION: &str = "wheel_to_body";

/// Values of a curve, and the share of the travel that they cover: at its ends the direction changes.
const VALUES: usize = 24;
const COVERED: f64 = 0.94;
/// A value needs so many samples of each direction.
const FEWEST: usize = 4;
/// The direction of travel is that over so many parts of the curve before and behind a sample.
const DIRECTION_PARTS: usize = 100;
/// Of the largest force: how straight a load cell is.
const FLOOR: f64 = 0.001;

impl Evidence {
    pub(super) fn add_travel(
        &mut self,
        campaign: &Campaign,
        about: &About,
        run: &crate::campaign::Run,
        axis: Axis,
    ) -> Result<(), InputError> {
        let curve = campaign.curve(run)?;
        let moves = |location: &str| {
            let mut states = about.states.iter();
            states.any(|s| s.kind == StateKind::Position && s.location == location && s.axis == axis.name())
        };
        let loaded = about.excitations.iter().any(|e| e.force && e.axis == axis.name());
        if !(moves(MOVED) && moves(HELD) && loaded) {
            let what = format!("no {MOVED} that a force moves against a {HELD} along {}", axis.name());
            self.notices
                .push(format!("{}: the model has {what}; the run is left out", run.file));
            return Ok(());
        }
        let Some(series) = series(self.runs.len(), axis, &curve.displacement, &curve.force) else {
            self.notices
                .push(format!("{}: no whole cycle; the run is left out", run.file));
            return Ok(());
        };
        self.series.push(series);
        self.runs.push(Run {
            name: run.file.clone(),
            role: run.role,
            level: curve.displacement.iter().fold(0.0, |most, x| x.abs().max(most)),
            stimulus: Stimulus::Travel(axis),
        });
        Ok(())
    }
}

/// `None` without travel in both directions.
fn series(run: usize, axis: Axis, displacement: &[f64], force: &[f64]) -> Option<Series> {
    let (low, high) = displacement
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(*x), high.max(*x))
        });
    let width = COVERED * (high - low) / VALUES as f64;
    let first = low + (1.0 - COVERED) * (high - low) / 2.0;
    let most = force.iter().fold(0.0, |most: f64, f| f.abs().max(most));
    let mut series = Series {
        run,
        sensor: Point {
            location: LOCATION.into(),
            axis,
            quantity: Quantity::Force,
        },
        kind: Kind::Travel,
        at: Vec::new(),
        value: Vec::new(),
        sigma: Vec::new(),
    };
    for value in 0..VALUES {
        let middle = first + (value as f64 + 0.5) * width;
        let both = [1.0, -1.0].map(|way| {
            let inside =
                |&i: &usize| (displacement[i] - middle).abs() <= width / 2.0 && direction(displacement, i) == way;
            let samples = (0..displacement.len()).filter(inside);
            line(samples.map(|i| [displacement[i] - middle, force[i]]).collect())
        });
        let [Some(there), Some(back)] = both else { continue };
        series.at.push(middle);
        series.value.push(Complex::from((there.0 + back.0) / 2.0));
        series.sigma.push((there.1.hypot(back.1) / 2.0).hypot(FLOOR * most));
    }
    (series.at.len() > VALUES / 2).then_some(series)
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
