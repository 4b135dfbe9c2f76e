//! Predicts sweeps by a nonlinear model: harmonics of its periodic response at each frequency and measured amplitude.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Complex;

use super::excitation;
use crate::discover::observe::run::line_at;
use crate::discover::observe::{Evidence, Free, Kind, PredictError, Prediction, Series, Stimulus, order_of, signal_of};
use crate::model::Model;
use crate::response::parameters::Values;
use crate::response::periodic::{Course, Cycle, Drive, Periodic};
use crate::response::signal::output_of;

/// Harmonics of the harmonic balance: the measured three, and two more for convergence.
const HARMONICS: usize = 5;

/// Predicts a sweep by harmonic balance. `drive` is the factor of the true excitation on that of the reference sensor.
pub fn sweep(
    model: &dyn Model,
    values: &Values,
    drive: f64,
    free: &[Free],
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    let about = model.about();
    let Stimulus::Sweep {
        reference,
        frequency,
        amplitude,
        time,
        ..
    } = &evidence.runs[run].stimulus
    else {
        return Ok(Vec::new());
    };
    let excitation = excitation(model, evidence, run, reference)?;
    let power = order_of(reference);
    let drives = frequency.iter().zip(amplitude).map(|(&frequency, &amplitude)| Drive {
        frequency,
        amplitude: drive * amplitude,
        power,
    });
    let drives: Vec<Drive> = drives.collect();
    let mut readings = Vec::new();
    for (place, series) in evidence
        .series
        .iter()
        .enumerate()
        .filter(|(_, series)| series.run == run)
    {
        let (output, power) = output_of(about, &signal_of(about, &series.sensor))?;
        readings.push(Reading {
            place,
            series,
            lines: series.at.iter().map(|at| line_at(frequency, *at)).collect(),
            output,
            power,
        });
    }
    let outputs: Vec<usize> = readings.iter().map(|reading| reading.output).collect();
    let groups: Vec<Vec<usize>> = free.iter().map(|free| values.tied_to(free.parameter)).collect();
    // Coarse data leave most lines out.
    let compared: BTreeSet<usize> = readings.iter().flat_map(|own| own.lines.iter().copied()).collect();
    let periodic = Periodic::new(model, excitation, HARMONICS);
    let found = periodic.walk(values.as_slice(), &drives, course(time), &compared, &outputs, &groups);
    let cycles: BTreeMap<usize, Cycle> = compared.into_iter().zip(found).collect();
    let predict = |reading: &Reading| reading.prediction(&drives, &cycles, free.len());
    Ok(readings.iter().map(predict).collect())
}

/// The course of a sweep from the times at which it passes increasing frequencies.
fn course(time: &[f64]) -> Course {
    match (time.first(), time.last()) {
        (Some(first), Some(last)) if first > last => Course::Falling,
        _ => Course::Rising,
    }
}

/// How a series is read from the periodic responses.
struct Reading<'a> {
    place: usize,
    series: &'a Series,
    /// Positions of its values among the frequencies of the sweep.
    lines: Vec<usize>,
    /// Position of the output.
    output: usize,
    /// Power of jω from the output to the sensor.
    power: i32,
}

impl Reading<'_> {
    fn prediction(&self, drives: &[Drive], cycles: &BTreeMap<usize, Cycle>, free: usize) -> Prediction {
        let Kind::Harmonic(harmonic) = self.series.kind else {
            unreachable!("a sweep has no other series")
        };
        let scale = |line: usize| {
            let drive = drives[line];
            let omega = std::f64::consts::TAU * drive.frequency * harmonic as f64;
            Complex::new(0.0, omega).powi(self.power) / drive.amplitude
        };
        let value = |&line: &usize| cycles[&line].output(self.output)[harmonic] * scale(line);
        let slope = |k: usize| {
            let along = |&line: &usize| cycles[&line].slope(k, self.output)[harmonic] * scale(line);
            self.lines.iter().map(along).collect()
        };
        let by_drive = |&line: &usize| {
            let moved = cycles[&line].louder(self.output)[harmonic] - cycles[&line].output(self.output)[harmonic];
            moved * scale(line)
        };
        Prediction {
            series: self.place,
            value: self.lines.iter().map(value).collect(),
            by_drive: if free > 0 {
                vec![self.lines.iter().map(by_drive).collect()]
            } else {
                Vec::new()
            },
            by_initial_states: Vec::new(),
            slopes: (0..free).map(slope).collect(),
            delay: None,
        }
    }
}
