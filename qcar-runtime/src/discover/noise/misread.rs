//! Sensor errors that change the prediction itself: the time at which a record begins, its initial states, and the
//! level of a run.

use std::collections::BTreeMap;

use nalgebra::Complex;

use super::calibration::Form;
use super::nuisance::{Beginning, Nuisance};
use crate::discover::observe::{Evidence, Kind, Misread, Prediction, Run, Series, Stimulus};

impl Nuisance {
    /// Delays of each series in s against the excitation, excitation factors of each run, and initial states of each
    /// record, from the nuisance coefficients. Delays that are phases of a harmonic are not included. The excitation
    /// factor is the inverse gain of the reference; it changes only a nonlinear model.
    pub fn misread(&self, evidence: &Evidence, coefficients: &[f64]) -> Misread {
        let late = |series: &Series| {
            let delays = self.late_by(evidence, series).into_iter();
            delays.map(|(k, times)| times * coefficients[k]).sum()
        };
        let louder = |run: &Run| {
            let gains = self.reference_gains(run);
            (-gains.map(|k| coefficients[k]).sum::<f64>()).exp()
        };
        let begun = |run: &Run| {
            let own = self.beginnings_of(run);
            own.map(|(k, own)| (own.state.clone(), coefficients[k])).collect()
        };
        Misread {
            late: evidence.series.iter().map(late).collect(),
            louder: evidence.runs.iter().map(louder).collect(),
            begun: evidence.runs.iter().map(begun).collect(),
        }
    }

    /// Derivatives of a prediction along the coefficients of [`Self::misread`], each with the position of its
    /// coefficient.
    pub fn misread_slopes(&self, evidence: &Evidence, prediction: &Prediction) -> Vec<(usize, Vec<Complex<f64>>)> {
        let mut slopes = self.delays(evidence, prediction);
        let run = &evidence.runs[evidence.series[prediction.series].run];
        for (k, own) in self.beginnings_of(run) {
            let slope = prediction.begun.iter().find(|(state, _)| *state == own.state);
            slopes.extend(slope.map(|(_, slope)| (k, slope.clone())));
        }
        if let Some(louder) = &prediction.louder {
            let along = |k| (k, louder.iter().map(|slope| -slope).collect());
            slopes.extend(self.reference_gains(run).map(along));
        }
        slopes
    }

    /// Initial states of a run, each with the position of its coefficient.
    fn beginnings_of(&self, run: &Run) -> impl Iterator<Item = (usize, &Beginning)> {
        let first = self.of_sensors();
        let all = self.beginnings.iter().enumerate();
        all.filter(|(_, own)| own.run == run.name)
            .map(move |(k, own)| (first + k, own))
    }

    /// Positions of the mean gain coefficients of a run's reference.
    fn reference_gains(&self, run: &Run) -> impl Iterator<Item = usize> {
        let of = |sensor| {
            let own = self.coefficient(sensor, Form::Gain(0));
            own.into_iter().chain(self.suspected(sensor, Form::Gain(0)))
        };
        run.stimulus.reference().into_iter().flat_map(of)
    }

    /// Derivatives of a prediction along the delay coefficients, each with the position of its coefficient.
    fn delays(&self, evidence: &Evidence, prediction: &Prediction) -> Vec<(usize, Vec<Complex<f64>>)> {
        let Some(delay) = &prediction.delay else {
            return Vec::new();
        };
        let mut times: BTreeMap<usize, f64> = BTreeMap::new();
        let shifts = delay.shares.iter().map(|&(series, share)| (series, -share));
        for (series, share) in std::iter::once((prediction.series, 1.0)).chain(shifts) {
            for (k, by) in self.late_by(evidence, &evidence.series[series]) {
                *times.entry(k).or_default() += share * by;
            }
        }
        let along = |(k, times): (usize, f64)| (k, delay.slope.iter().map(|slope| slope * times).collect());
        times.into_iter().map(along).collect()
    }

    /// Positions of the coefficients that delay a series in time, with their factors.
    fn late_by(&self, evidence: &Evidence, series: &Series) -> Vec<(usize, f64)> {
        let prior = || self.coefficient(&series.sensor, Form::Delay).map(|k| (k, 1.0));
        let suspects = |sensor, times| self.suspected(sensor, Form::Delay).map(move |k| (k, times));
        match (series.kind, &evidence.runs[series.run].stimulus) {
            (Kind::Passage, _) => prior().into_iter().chain(suspects(&series.sensor, 1.0)).collect(),
            // Several inputs would need a shift each, so only a single input is shifted.
            (Kind::Time, Stimulus::History { inputs, .. }) if inputs.signals.len() == 1 => {
                let input = suspects(&inputs.signals[0].0, -1.0);
                suspects(&series.sensor, 1.0).chain(input).collect()
            }
            (Kind::Time, _) => suspects(&series.sensor, 1.0).collect(),
            (Kind::Harmonic(_) | Kind::Travel | Kind::Width | Kind::Speed | Kind::Cycle(_), _) => Vec::new(),
        }
    }
}
