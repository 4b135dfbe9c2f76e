//! What a swept sine shows beyond the steady harmonics at each of its frequencies.
//!
//! A sweep never settles: friction remembers where it was, and lightly damped modes ring on. And a balance of few
//! harmonics cuts off what sharp laws do. Both are small against the response and change little with the parameters. So
//! the measured motion of the pad is replayed through the model, the responses are read from it by the estimator that
//! read the measurement, and how much they differ from the balance is added to the balance wherever a search goes.

use nalgebra::Complex;
use rayon::prelude::*;

use super::input::{Between, Recorded};
use super::replay::{Reading, Replay, reading};
use super::{Misread, PredictError, excitation, nonlinear};
use crate::campaign::Role;
use crate::discover::evidence::sweep::{AROUND, ORDERS};
use crate::discover::evidence::{Evidence, Kind, Series, Stimulus, order_of, signal_of};
use crate::model::Model;
use crate::response::parameters::Values;
use crate::response::signal::SignalError;
use crate::transmissibility::harmonics::Swept;

/// A sweep is faded in and out beyond its band by this factor, and friction remembers its slow parts; what lies farther
/// out is noise of the pad's sensor.
const BEYOND: f64 = 4.0;

/// For each series what the sweeps of the runs of one role add to the balance; nothing for series of other runs, and for
/// all of a linear model.
///
/// # Errors
/// Where the model lacks what was measured.
pub fn unsteady(
    model: &dyn Model,
    values: &Values,
    misread: &Misread,
    evidence: &Evidence,
    role: Role,
) -> Result<Vec<Vec<Complex<f64>>>, PredictError> {
    let mut added = vec![Vec::new(); evidence.series.len()];
    if model.about().linear {
        return Ok(added);
    }
    let runs: Vec<usize> = (0..evidence.runs.len())
        .filter(|&run| evidence.runs[run].role == role)
        .collect();
    let of_runs = runs
        .into_par_iter()
        .map(|run| of_run(model, values, misread.louder(run), evidence, run));
    for (series, differences) in of_runs.collect::<Result<Vec<_>, _>>()?.into_iter().flatten() {
        added[series] = differences;
    }
    Ok(added)
}

/// Places of series with their differences.
type Differences = Vec<(usize, Vec<Complex<f64>>)>;

fn of_run(
    model: &dyn Model,
    values: &Values,
    louder: f64,
    evidence: &Evidence,
    run: usize,
) -> Result<Differences, PredictError> {
    let Stimulus::Sweep {
        reference,
        signal,
        rate,
        band,
        ..
    } = &evidence.runs[run].stimulus
    else {
        return Ok(Vec::new());
    };
    let signal: Vec<f64> = signal.iter().map(|sample| louder * sample).collect();
    let recorded = Recorded {
        excitation: excitation(model, evidence, run, reference)?,
        power: order_of(reference),
        samples: &signal,
    };
    let how = Between {
        rate: *rate,
        band_limited: true,
        band: (band.0 / BEYOND, band.1 * BEYOND),
        nodes: 0,
    };
    let balanced = nonlinear::sweep(model, values, louder, &[], evidence, run)?;
    let about = model.about();
    let sensors = balanced
        .iter()
        .map(|p| signal_of(about, &evidence.series[p.series].sensor));
    let readings: Vec<Reading> = sensors
        .map(|signal| reading(about, &signal))
        .collect::<Result<_, SignalError>>()?;
    let replayed = Replay::new(model, vec![recorded], how, Vec::new(), readings).run(values.as_slice());
    let swept = Swept::new(&signal, *rate, *band, ORDERS);
    let differences = balanced.into_par_iter().zip(replayed).map(|(balanced, replayed)| {
        let seen = seen(&swept, &replayed, &evidence.series[balanced.series]);
        let differences = seen.iter().zip(&balanced.value).map(|(seen, balanced)| seen - balanced);
        (balanced.series, differences.collect())
    });
    Ok(differences.collect())
}

/// The values of a series in a replayed signal.
fn seen(swept: &Swept, signal: &[f64], series: &Series) -> Vec<Complex<f64>> {
    let Kind::Harmonic(order) = series.kind else {
        unreachable!("a sweep has no other series")
    };
    let responses: Vec<f64> = series.at.iter().map(|f| f * order as f64).collect();
    let lines = swept.responses(signal, &responses, AROUND);
    lines
        .iter()
        .map(|line| line.value[order - 1].unwrap_or_default())
        .collect()
}
