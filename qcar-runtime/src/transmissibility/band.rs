//! Frequencies at which a response can be estimated from a run.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::{Estimator, Options, Point};
use crate::campaign::{History, Quantity, Spacing, Sweep, Test};
use crate::error::{InputError, Place, Problem};
use crate::proportion::is_alike;
use crate::shown::shown;

/// Default number of frequencies.
const COUNT: usize = 300;
/// A time history is evaluated where it has at least this share of its largest power.
const EXCITED: f64 = 1e-3;
/// A sweep counts as present where it has at least this share of its typical power; leakage at the edge of a cut is
/// smaller.
const SWEPT: f64 = 0.05;
/// Fewest cycles of the lowest frequency in the record.
const CYCLES: f64 = 5.0;

/// `count` frequencies from `first` to `last`, Hz, evenly spaced on a logarithmic scale.
pub fn logarithmic(first: f64, last: f64, count: usize) -> Vec<f64> {
    let growth = (last / first).ln() / (count.max(2) - 1) as f64;
    let mut frequencies: Vec<f64> = (0..count).map(|k| first * (growth * k as f64).exp()).collect();
    if let Some(end) = frequencies.last_mut().filter(|_| count > 1) {
        *end = last;
    }
    frequencies
}

/// The frequencies of the estimate, after the record has been checked; `spectrum` is that of its reference.
pub(super) fn frequencies(
    history: &History,
    reference: &Point,
    spectrum: &[Complex<f64>],
    options: &Options,
) -> Result<Vec<f64>, InputError> {
    if let Test::Sweep(sweep) = &history.test {
        lasts(history, CYCLES / sweep.start_frequency, sweep.start_frequency)?;
    }
    let bands = bands(spectrum, history, reference.quantity);
    if bands.iter().all(|band| band.1 <= 0.0) {
        let remedy = "choose another reference, or export the record again";
        let place = Place::Name(reference.to_string());
        return Err(Problem::new(&history.file, place, "a signal that is zero", "an excitation", remedy).into());
    }
    if let Test::Sweep(sweep) = &history.test {
        reaches_its_ends(history, reference, sweep, &bands)?;
        has_its_velocity(history, reference, sweep, &bands)?;
    }
    let frequencies = options.frequencies.clone().unwrap_or_else(|| match &history.test {
        Test::Sweep(sweep) => logarithmic(sweep.start_frequency, sweep.end_frequency, COUNT),
        _ => {
            let strongest = bands.iter().map(|band| band.1).fold(0.0, f64::max);
            let excited = excited(&bands, EXCITED * strongest);
            logarithmic(excited.0, excited.1, COUNT)
        }
    });
    long_enough(history, &frequencies, &options.estimator)?;
    Ok(frequencies)
}

/// Centre (Hz) and mean power of logarithmic bands, normalised so that a sweep has the same power in all of them: the
/// power of a velocity over the time that the sweep spends there.
fn bands(spectrum: &[Complex<f64>], history: &History, quantity: Quantity) -> Vec<(f64, f64)> {
    const WIDTH: f64 = 1.05;
    let power: Vec<f64> = spectrum.iter().map(|line| line.norm_sqr()).collect();
    let (rate, spacing) = (history.sample_rate, history.sample_rate / history.len() as f64);
    let lowest = CYCLES * spacing;
    let edges = std::iter::successors(Some(lowest), |f| Some(f * WIDTH)).take_while(|f| f * WIDTH < rate / 2.0);
    let band = |first: f64| {
        let lines = (first / spacing) as usize..((first * WIDTH / spacing) as usize + 1).min(power.len());
        let mean = power[lines.clone()].iter().sum::<f64>() / lines.len().max(1) as f64;
        let centre = first * WIDTH.sqrt();
        (centre, mean * evened(centre, &history.test, quantity))
    };
    edges.map(band).collect()
}

fn evened(f: f64, test: &Test, quantity: Quantity) -> f64 {
    let as_velocity = match quantity {
        Quantity::Acceleration => (TAU * f).powi(-2),
        Quantity::Displacement => (TAU * f).powi(2),
        Quantity::Velocity | Quantity::Force => 1.0,
    };
    match test {
        Test::Sweep(Sweep {
            spacing: Spacing::Logarithmic,
            ..
        }) => as_velocity * f,
        Test::Sweep(_) => as_velocity,
        _ => 1.0,
    }
}

/// Lowest and highest frequency with at least the power `floor`.
fn excited(bands: &[(f64, f64)], floor: f64) -> (f64, f64) {
    let mut held = bands.iter().filter(|band| band.1 >= floor).map(|band| band.0);
    let first = held.next().unwrap_or(f64::INFINITY);
    (first, held.next_back().unwrap_or(first))
}

/// Median over the bands of a sweep.
fn typical(sweep: &Sweep, bands: &[(f64, f64)]) -> f64 {
    let swept = |f: f64| (sweep.start_frequency..=sweep.end_frequency).contains(&f);
    let mut powers: Vec<f64> = bands.iter().filter(|band| swept(band.0)).map(|band| band.1).collect();
    powers.sort_by(f64::total_cmp);
    powers.get(powers.len() / 2).copied().unwrap_or(0.0)
}

/// A sweep that was cut has no power beyond the cut.
fn reaches_its_ends(
    history: &History,
    reference: &Point,
    sweep: &Sweep,
    bands: &[(f64, f64)],
) -> Result<(), InputError> {
    /// The ends are faded: distance from them at which power is required.
    const INSIDE: f64 = 1.15;
    let (first, last) = excited(bands, SWEPT * typical(sweep, bands));
    let place = || Place::Name(reference.to_string());
    let wrong = |found: String, expected: String| {
        let remedy = "export the whole sweep, or correct its frequencies in campaign.toml";
        Err(Problem::new(&history.file, place(), found, expected, remedy).into())
    };
    if last * INSIDE < sweep.end_frequency {
        let expected = format!("a sweep to `end_frequency = {}`", sweep.end_frequency);
        return wrong(format!("an excitation that ends at {last:.1} Hz"), expected);
    }
    if first > sweep.start_frequency * INSIDE {
        let expected = format!("a sweep from `start_frequency = {}`", sweep.start_frequency);
        return wrong(format!("an excitation that starts at {first:.2} Hz"), expected);
    }
    Ok(())
}

/// A sweep of another amplitude than declared has another unit, or is the mean of sensors with opposite signs.
fn has_its_velocity(
    history: &History,
    reference: &Point,
    sweep: &Sweep,
    bands: &[(f64, f64)],
) -> Result<(), InputError> {
    if reference.quantity == Quantity::Force {
        return Ok(());
    }
    // The power spectrum of a sine of amplitude V whose frequency passes f at the rate r is V²/(4 r).
    let pace = match sweep.spacing {
        Spacing::Logarithmic => (sweep.end_frequency / sweep.start_frequency).ln(),
        Spacing::Linear => sweep.end_frequency - sweep.start_frequency,
    };
    let duration = history.len() as f64 / history.sample_rate;
    let velocity = 2.0 * (typical(sweep, bands) * pace / duration).sqrt() / history.sample_rate;
    if is_alike(velocity / sweep.peak_velocity) {
        return Ok(());
    }
    let (place, found) = (
        Place::Name(reference.to_string()),
        format!("a peak velocity of {:.2e}", shown(velocity, "m/s")),
    );
    let expected = format!("one near `peak_velocity = {}`", sweep.peak_velocity);
    let remedy = "correct the unit, sign or calibration of its sensors, or the peak velocity in campaign.toml";
    Err(Problem::new(&history.file, place, found, expected, remedy).into())
}

fn long_enough(history: &History, frequencies: &[f64], estimator: &Estimator) -> Result<(), InputError> {
    let wrong = |found: String, expected: String, remedy: &str| {
        Err(Problem::new(&history.file, Place::File, found, expected, remedy).into())
    };
    let (Some(&first), Some(&last)) = (frequencies.first(), frequencies.last()) else {
        return wrong(
            "no frequency".into(),
            "at least one".into(),
            "name the frequencies to estimate at",
        );
    };
    let rate = history.sample_rate;
    let seconds = match estimator {
        Estimator::Local { .. } => CYCLES / first,
        Estimator::Welch(segments) => segments.length as f64 / rate,
    };
    lasts(history, seconds, first)?;
    if first <= 0.0 || last >= rate / 2.0 || frequencies.windows(2).any(|pair| pair[1] <= pair[0]) {
        let expected = format!(
            "increasing ones above 0 and below {} Hz, half the sample rate",
            rate / 2.0
        );
        return wrong(
            format!("frequencies from {first} to {last} Hz"),
            expected,
            "ask for others",
        );
    }
    Ok(())
}

/// A record that ends too soon resembles one without power at `frequency`, so this is checked before any spectrum.
fn lasts(history: &History, seconds: f64, frequency: f64) -> Result<(), InputError> {
    let recorded = history.len() as f64 / history.sample_rate;
    if recorded >= seconds {
        return Ok(());
    }
    let (found, expected) = (
        format!("a record of {recorded:.1} s, which is too short"),
        format!("at least {seconds:.1} s for {frequency} Hz"),
    );
    let remedy = "export the whole record, record longer, or start at a higher frequency";
    Err(Problem::new(&history.file, Place::File, found, expected, remedy).into())
}
