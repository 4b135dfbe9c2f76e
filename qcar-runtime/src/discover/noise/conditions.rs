//! Unknown test conditions, which change the prediction itself: delays of sensors, initial states of records, and the
//! drive amplitude of runs.

use std::collections::BTreeMap;

use nalgebra::Complex;

use super::calibration::Form;
use super::nuisance::{InitialState, Nuisance};
use crate::discover::observe::{Evidence, Initial, Kind, Prediction, Run, Series, Stimulus, TestConditions};
use crate::transmissibility::Point;

impl Nuisance {
    /// Test conditions for these nuisance coefficients: the delay of each series against the excitation, the drive
    /// factors of each run, and the initial states of each record. The phase that a delay adds to a harmonic is part of
    /// [`Self::sensor_output`] instead. A drive factor is the inverse gain of a reference sensor. It does not change
    /// the transmissibilities of a linear model.
    pub fn conditions(&self, evidence: &Evidence, coefficients: &[f64]) -> TestConditions {
        let delay = |series: &Series| {
            let delays = self.delay_factors(evidence, series).into_iter();
            delays.map(|(k, factor)| factor * coefficients[k]).sum()
        };
        let factor = |run: &Run, reference: &Point| {
            let gains = self.drive_gains(run, reference);
            (-gains.map(|k| coefficients[k]).sum::<f64>()).exp()
        };
        let drive = |run: &Run| {
            let references = run.stimulus.references().into_iter();
            references.map(|reference| factor(run, reference)).collect()
        };
        let initial_states = |run: &Run| {
            let own = self.initial_states_of(run);
            let at_start = |(k, own): (usize, &InitialState)| Initial {
                sample: 0,
                state: own.state.clone(),
                by: coefficients[k],
            };
            own.map(at_start).collect()
        };
        TestConditions {
            delays: evidence.series.iter().map(delay).collect(),
            drive: evidence.runs.iter().map(drive).collect(),
            initial_states: evidence.runs.iter().map(initial_states).collect(),
        }
    }

    /// Derivatives of a prediction by the coefficients that [`Self::conditions`] uses, each with the position of its
    /// coefficient.
    pub fn condition_slopes(&self, evidence: &Evidence, prediction: &Prediction) -> Vec<(usize, Vec<Complex<f64>>)> {
        let mut slopes = self.delays(evidence, prediction);
        let run = &evidence.runs[evidence.series[prediction.series].run];
        for (k, own) in self.initial_states_of(run) {
            let slope = prediction
                .by_initial_states
                .iter()
                .find(|(state, _)| *state == own.state);
            slopes.extend(slope.map(|(_, slope)| (k, slope.clone())));
        }
        for (reference, by_drive) in run.stimulus.references().into_iter().zip(&prediction.by_drive) {
            let along = |k| (k, by_drive.iter().map(|slope| -slope).collect());
            slopes.extend(self.drive_gains(run, reference).map(along));
        }
        slopes
    }

    /// Initial states of a run, each with the position of its coefficient.
    fn initial_states_of(&self, run: &Run) -> impl Iterator<Item = (usize, &InitialState)> {
        let first = self.of_sensors();
        let all = self.initial_states.iter().enumerate();
        all.filter(|(_, own)| own.run == run.name)
            .map(move |(k, own)| (first + k, own))
    }

    /// Positions of the coefficients that set the true amplitude of an excitation. A suspected gain of a recorded input
    /// is left out: beyond its calibration, the gain of an input is an effect of the model.
    fn drive_gains(&self, run: &Run, reference: &Point) -> impl Iterator<Item = usize> {
        let is_record = matches!(run.stimulus, Stimulus::History { .. });
        let suspects = self.suspected(reference, Form::Gain).filter(move |_| !is_record);
        self.coefficient(reference, Form::Gain).into_iter().chain(suspects)
    }

    /// Derivatives of a prediction by the delay coefficients, each with the position of its coefficient.
    fn delays(&self, evidence: &Evidence, prediction: &Prediction) -> Vec<(usize, Vec<Complex<f64>>)> {
        let Some(delay) = &prediction.delay else {
            return Vec::new();
        };
        let mut factors: BTreeMap<usize, f64> = BTreeMap::new();
        let shifts = delay.shares.iter().map(|&(series, share)| (series, -share));
        for (series, share) in std::iter::once((prediction.series, 1.0)).chain(shifts) {
            for (k, factor) in self.delay_factors(evidence, &evidence.series[series]) {
                *factors.entry(k).or_default() += share * factor;
            }
        }
        let along = |(k, factor): (usize, f64)| (k, delay.slope.iter().map(|slope| slope * factor).collect());
        factors.into_iter().map(along).collect()
    }

    /// Positions of the coefficients that delay a series in time, with their factors.
    fn delay_factors(&self, evidence: &Evidence, series: &Series) -> Vec<(usize, f64)> {
        let prior = || self.coefficient(&series.sensor, Form::Delay).map(|k| (k, 1.0));
        let suspects = |sensor, factor| self.suspected(sensor, Form::Delay).map(move |k| (k, factor));
        match (series.kind, &evidence.runs[series.run].stimulus) {
            (Kind::Passage, _) => prior().into_iter().chain(suspects(&series.sensor, 1.0)).collect(),
            // Each of several inputs would need a shift of its own, so only a single input is shifted.
            (Kind::Time, Stimulus::History { inputs, .. }) if inputs.signals.len() == 1 => {
                let input = suspects(&inputs.signals[0].0, -1.0);
                suspects(&series.sensor, 1.0).chain(input).collect()
            }
            (Kind::Time, _) => suspects(&series.sensor, 1.0).collect(),
            (Kind::Harmonic(_) | Kind::Travel | Kind::Width | Kind::Speed | Kind::Cycle(_), _) => Vec::new(),
        }
    }
}
