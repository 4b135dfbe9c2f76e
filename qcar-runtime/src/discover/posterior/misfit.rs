//! Normalised residuals of a fit over all runs: their size and location.

use std::collections::BTreeMap;

use super::initial_states::estimate_initial_states;
use super::refit::Refit;
use super::residual::scaled;
use crate::campaign::Role;
use crate::discover::observe::{Evidence, Kind, PredictError, Run, Series, predict_sides, unsteady};
use crate::mean::rms_or_nan;
use crate::model::Model;
use crate::transmissibility::Point;

/// Normalised residuals of a fitted model: measured minus modelled, over the standard deviation. Noise alone has an RMS
/// of 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Misfit {
    /// RMS of the normalised residual on the fitted runs; NaN without any.
    pub fit: f64,
    /// The same RMS on the held-out runs; NaN without any.
    pub held_out: f64,
    /// The same RMS for each series, in the order of the evidence.
    pub series: Vec<f64>,
    /// Residuals of every series, as counted by [`Series::residuals`].
    pub residuals: Vec<Vec<f64>>,
    /// Parts of the residual, largest first.
    pub tiles: Vec<Tile>,
}

/// Part of the residual of one series.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// The sensor.
    pub sensor: Point,
    /// Kind of its values.
    pub kind: Kind,
    /// Position of its run in the evidence.
    pub run: usize,
    /// Level of the run, in the unit of [`Run::level`](crate::discover::observe::Run::level).
    pub level: f64,
    /// Role of the run.
    pub role: Role,
    /// First and last abscissa, in the unit of [`Kind`]: a sixth of an octave for harmonics; a twentieth of the range
    /// of the series for all others.
    pub span: (f64, f64),
    /// RMS of the residuals.
    pub strength: f64,
    /// Number of residuals.
    pub count: usize,
}

impl Misfit {
    /// Compares a refitted model with all runs, with the sensor errors of the fitted runs.
    ///
    /// # Errors
    /// Fails if the model lacks a measured quantity.
    pub fn of(model: &dyn Model, refit: &Refit, evidence: &Evidence) -> Result<Self, PredictError> {
        let mut residuals = vec![Vec::new(); evidence.series.len()];
        let sensors = (&refit.nuisance, refit.coefficients.as_slice());
        let mut conditions = refit.nuisance.conditions(evidence, &refit.coefficients);
        let is_held_out = |run: &Run| run.role == Role::HeldOut;
        estimate_initial_states(model, &refit.values, sensors, evidence, is_held_out, &mut conditions)?;
        for role in [Role::Fit, Role::HeldOut] {
            let unsteady = unsteady(model, &refit.values, &conditions, evidence, role)?;
            let sides = [&refit.values, &refit.side];
            for mut prediction in predict_sides(model, sides, &conditions, &[], evidence, &|run| run.role == role)? {
                let series = &evidence.series[prediction.series];
                prediction.add(&unsteady[prediction.series]);
                let reading = refit.sensor_output(evidence, &prediction);
                let differences = series
                    .value
                    .iter()
                    .zip(reading)
                    .map(|(measured, reading)| measured - reading);
                scaled(series, &series.sigma, differences, &mut residuals[prediction.series]);
            }
        }
        let of_role = |role| {
            rms_or_nan(
                evidence
                    .of_role(role)
                    .flat_map(|(place, _)| residuals[place].iter().copied()),
            )
        };
        Ok(Self {
            fit: of_role(Role::Fit),
            held_out: of_role(Role::HeldOut),
            series: residuals
                .iter()
                .map(|series| rms_or_nan(series.iter().copied()))
                .collect(),
            tiles: tiles(evidence, &residuals),
            residuals,
        })
    }

    /// RMS on the runs that judge the model.
    pub fn judged(&self, evidence: &Evidence) -> f64 {
        match evidence.judging() {
            Role::HeldOut => self.held_out,
            Role::Fit => self.fit,
        }
    }
}

/// Number of tiles in an octave.
const PER_OCTAVE: f64 = 6.0;
/// Number of tiles in a record.
const PER_RECORD: f64 = 20.0;

fn tiles(evidence: &Evidence, residuals: &[Vec<f64>]) -> Vec<Tile> {
    let mut tiles = Vec::new();
    for (series, residuals) in evidence.series.iter().zip(residuals) {
        let mut sums: BTreeMap<i64, (f64, usize)> = BTreeMap::new();
        let parts = series.kind.parts();
        for (at, of_value) in series.at.iter().zip(residuals.chunks(parts)) {
            let sum = sums.entry(scale(series).place(*at).floor() as i64).or_default();
            sum.0 += of_value.iter().map(|residual| residual * residual).sum::<f64>();
            sum.1 += of_value.len();
        }
        tiles.extend(sums.into_iter().map(|(place, sum)| tile(evidence, series, place, sum)));
    }
    tiles.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    tiles
}

fn tile(evidence: &Evidence, series: &Series, place: i64, (sum, count): (f64, usize)) -> Tile {
    let run = &evidence.runs[series.run];
    let scale = scale(series);
    Tile {
        sensor: series.sensor.clone(),
        kind: series.kind,
        run: series.run,
        level: run.level,
        role: run.role,
        span: (scale.value(place), scale.value(place + 1)),
        strength: (sum / count as f64).sqrt(),
        count,
    }
}

/// Scale on which the values of a series are divided into tiles.
enum Scale {
    Octaves,
    /// First value and width of a tile.
    Even(f64, f64),
}

fn scale(series: &Series) -> Scale {
    match series.kind {
        Kind::Harmonic(_) | Kind::Cycle(_) => Scale::Octaves,
        Kind::Time | Kind::Passage | Kind::Travel | Kind::Width | Kind::Speed => {
            let (first, last) = (series.at[0], series.at[series.at.len() - 1]);
            Scale::Even(first, ((last - first) / PER_RECORD).max(f64::MIN_POSITIVE))
        }
    }
}

impl Scale {
    fn place(&self, at: f64) -> f64 {
        match self {
            Scale::Octaves => PER_OCTAVE * at.log2(),
            Scale::Even(first, width) => (at - first) / width,
        }
    }

    fn value(&self, place: i64) -> f64 {
        match self {
            Scale::Octaves => (place as f64 / PER_OCTAVE).exp2(),
            Scale::Even(first, width) => first + width * place as f64,
        }
    }
}
