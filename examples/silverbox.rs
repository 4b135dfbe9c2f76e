//! The error of a model on the whole Silverbox record, of which the repository contains four periods.
//!
//! ```text
//! qcar discover models/campaigns/silverbox --out results
//! cargo run --release --example silverbox -- SNLS80mV.csv results
//! ```
//!
//! The model and its parameters are those of the discovery, without the sensor's delay of some microseconds. The zero
//! offset of the sensor, which is no parameter of the model, is the mean error of the model over the fitted periods.
//!
//! The record is that of T. Wigren and J. Schoukens, "Three free data sets for development and benchmarking in
//! nonlinear system identification", European Control Conference 2013: columns V1 (taken for N) and V2 (taken for m) at
//! 610.35 Hz.

use std::error::Error;
use std::fs;
use std::ops::Range;
use std::path::Path;

use qcar::catalogue;
use qcar::parameters;
use qcar_runtime::simulate::{Accuracy, Between, Reading, Recorded, replay};
use serde_json::Value;

/// Sample rate, Hz.
const RATE: f64 = 610.35;
/// Samples of the growing random signal, without its start, where the circuit was not at rest as the model is.
const ARROW: Range<usize> = 50..40_000;
/// The last whole period of the first multisine, and length, distance and number of the multisines.
const MULTISINE: usize = 40_973;
const PERIOD: usize = 8192;
const SPACING: usize = 8695;
const MULTISINES: usize = 10;
/// The model has been fitted to the first of them.
const FITTED: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [record, results] = arguments.as_slice() else {
        return Err("expected the record (CSV) and the folder that `qcar discover --out` has written".into());
    };
    let results = Path::new(results);
    let found: Value = serde_json::from_str(&fs::read_to_string(results.join("discovery.json"))?)?;
    let model = found["model_file"].as_str().ok_or("the discovery has found no model")?;
    let [force, measured] = columns(record)?;
    let modelled = respond(model, &results.join("parameters.toml"), &force)?;
    let errors: Vec<f64> = modelled.iter().zip(&measured).map(|(own, other)| own - other).collect();
    let period = |at: usize| &errors[MULTISINE + at * SPACING..][..PERIOD];
    let zero = mean(&(0..FITTED).flat_map(period).copied().collect::<Vec<_>>());
    let power = |of: &[f64]| mean(&of.iter().map(|error| (error - zero).powi(2)).collect::<Vec<_>>());
    let unseen: Vec<f64> = (FITTED..MULTISINES).flat_map(period).copied().collect();
    println!(
        "zero of the sensor  {:.3} mV, from the periods that were fitted",
        -1e3 * zero
    );
    println!("arrow               {:.3} mV RMS", 1e3 * power(&errors[ARROW]).sqrt());
    println!(
        "multisines          {:.3} mV RMS, over the {} that no fit has seen",
        1e3 * power(&unseen).sqrt(),
        MULTISINES - FITTED
    );
    Ok(())
}

/// The first two columns of a CSV with a header line.
fn columns(file: &str) -> Result<[Vec<f64>; 2], Box<dyn Error>> {
    let text = fs::read_to_string(file).map_err(|error| format!("{file}: {error}"))?;
    let mut columns = [vec![], vec![]];
    for (at, line) in text
        .lines()
        .enumerate()
        .skip(1)
        .filter(|(_, line)| !line.trim().is_empty())
    {
        let mut cells = line.split(',');
        for column in &mut columns {
            let cell = cells.next().and_then(|cell| cell.trim().parse().ok());
            column.push(cell.ok_or_else(|| format!("{file}, line {}: expected two numbers", at + 1))?);
        }
    }
    let (needed, found) = (MULTISINE + (MULTISINES - 1) * SPACING + PERIOD, columns[0].len());
    if found < needed {
        return Err(format!("{file}: {found} samples, expected at least {needed}; take the whole record").into());
    }
    Ok(columns)
}

/// The only output of a model under its only force.
fn respond(model: &str, values: &Path, force: &[f64]) -> Result<Vec<f64>, Box<dyn Error>> {
    let model = catalogue::load(model).map_err(|failure| format!("{failure:?}"))?;
    let values = parameters::resolve(model.about(), [values], &[])?;
    let recorded = Recorded {
        excitation: 0,
        power: 0,
        samples: force,
    };
    let how = Between {
        rate: RATE,
        band_limited: true,
        band: (0.0, RATE),
        periodic: false,
        samples: force.len(),
        accuracy: Accuracy::HIGH,
    };
    let mut replayed = replay(
        &*model,
        values.as_slice(),
        vec![recorded],
        how,
        vec![Reading::Output(0)],
    )?;
    Ok(replayed.swap_remove(0))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
