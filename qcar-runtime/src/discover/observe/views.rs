//! Parts of a data set, or a data set with other uncertainty, for the stages of a search.

use nalgebra::Complex;

use super::dataset::Evidence;
use super::run::{Band, COARSE_POINTS, Run, SEARCH_STEP_LIMIT, Stimulus};
use super::series::Series;
use crate::simulate::Accuracy;

/// Largest factor by which a record is shortened, since its beginning may not represent the rest.
const MOST_SHORTENED: usize = 2;

impl Evidence {
    /// Adds a share of every value in quadrature to its uncertainty, for a model that is known to lack an effect.
    pub fn with_tolerance(&self, share: f64) -> Self {
        let mut tolerant = self.clone();
        for series in &mut tolerant.series {
            let values = series.value.iter().zip(&mut series.sigma);
            values.for_each(|(value, sigma)| *sigma = sigma.hypot(share * value.norm()));
        }
        tolerant
    }

    /// Limits the integration steps of cleat runs, so that a search over many candidates rejects a model whose passages
    /// take far longer than those of others.
    pub fn with_step_limit(&self) -> Self {
        let mut limited = self.clone();
        for run in &mut limited.runs {
            if let Stimulus::Cleat(passage) = &mut run.stimulus {
                passage.most_steps = SEARCH_STEP_LIMIT;
            }
        }
        limited
    }

    /// Integrates records with this accuracy.
    pub fn integrated_with(&self, accuracy: Accuracy) -> Self {
        let mut other = self.clone();
        for run in &mut other.runs {
            if let Stimulus::History { accuracy: own, .. } = &mut run.stimulus {
                *own = accuracy;
            }
        }
        other
    }

    /// True if a record can be integrated more accurately.
    pub fn could_be_more_accurate(&self) -> bool {
        let usual =
            |run: &Run| matches!(run.stimulus, Stimulus::History { accuracy, .. } if accuracy != Accuracy::HIGH);
        self.runs.iter().any(usual)
    }

    /// Keeps every `step`-th value of each series for a coarse fit. Histories and cleat runs keep their beginning
    /// instead, because their simulation computes every sample up to the last one that is compared. K&C runs keep all
    /// values.
    pub fn thinned(&self, step: usize) -> Self {
        let mut thinned = self.clone();
        let shorten = |(run, of): (usize, &mut Run)| {
            let series = self.series.iter().find(|series| series.run == run);
            of.stimulus.shorten(step, series.map_or(&[], |series| &series.at))
        };
        let ends: Vec<(f64, usize)> = thinned.runs.iter_mut().enumerate().map(shorten).collect();
        for series in &mut thinned.series {
            let (end, step) = ends[series.run];
            let inside = series.at.partition_point(|at| *at < end);
            series.keep((0..inside).step_by(step));
        }
        thinned
    }

    /// Subtracts the non-steady part, which a search does not predict, series by series.
    pub fn minus(&self, unsteady: &[Vec<Complex<f64>>]) -> Self {
        let mut steady = self.clone();
        for (series, unsteady) in steady.series.iter_mut().zip(unsteady) {
            series
                .value
                .iter_mut()
                .zip(unsteady)
                .for_each(|(value, unsteady)| *value -= unsteady);
        }
        steady
    }

    /// Keeps only the runs for which `keep` is true.
    pub fn only(&self, keep: impl Fn(usize) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.runs.len()).filter(|&run| keep(run)).collect();
        let place = |run: usize| kept.iter().position(|&k| k == run);
        let series = self.series.iter().filter_map(|series| {
            let run = place(series.run)?;
            Some(Series { run, ..series.clone() })
        });
        Evidence {
            runs: kept.iter().map(|&run| self.runs[run].clone()).collect(),
            series: series.collect(),
            two_sided: self.two_sided,
            notices: self.notices.clone(),
            numbers: self.numbers.clone(),
            held_out_judge: self.held_out_judge,
        }
    }
}

impl Stimulus {
    /// Shortens a record that a model is simulated through: a history by the factor `times` up to a limit, a passage
    /// with values `at` these times (s) to half of them. Returns the new end time (s) and the decimation of the
    /// remaining values. Other excitations are only decimated.
    fn shorten(&mut self, times: usize, at: &[f64]) -> (f64, usize) {
        match self {
            // A part of a period is not periodic.
            Stimulus::History { periodic: true, .. } => (f64::INFINITY, times),
            Stimulus::History { inputs, rate, band, .. } => {
                let reach = band.as_ref().map_or(0, Band::half);
                inputs.samples = (inputs.samples / times.min(MOST_SHORTENED) + reach).min(inputs.samples);
                let (length, signals) = (inputs.samples, inputs.signals.iter_mut());
                signals.for_each(|(_, samples)| samples.truncate(length));
                (inputs.start + ((length - reach) as f64 - 0.5) / *rate, 1)
            }
            // The impact and the early after-shake contain all modes of an axle.
            Stimulus::Cleat(passage) if at.len() > 1 && times > 1 => {
                let last = at[at.len() - 1];
                let end = at[at.len() / 2];
                passage.duration -= last - end;
                passage.points_a_sample = COARSE_POINTS;
                (end.next_up(), times.div_ceil(2))
            }
            // A K&C rig is followed along its whole path, whatever is compared, and what a stop does may be seen at a
            // few values at the end of the travel only.
            Stimulus::Travel { .. } | Stimulus::Sine { .. } => (f64::INFINITY, 1),
            _ => (f64::INFINITY, times),
        }
    }
}
