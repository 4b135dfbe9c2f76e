//! A data set in part, or with other uncertainty: what the stages of a search are fitted to.

use nalgebra::Complex;

use super::dataset::Evidence;
use super::run::{Band, COARSE_POINTS, HURRIED, Run, Stimulus};
use super::series::Series;

/// A record keeps at least this part of its length: what it begins with need not tell what comes later.
const MOST_SHORTENED: usize = 2;

impl Evidence {
    /// The same with this share of every value added to its uncertainty: for a model that is known to lack something.
    pub fn tolerant(&self, share: f64) -> Self {
        let mut tolerant = self.clone();
        for series in &mut tolerant.series {
            let values = series.value.iter().zip(&mut series.sigma);
            values.for_each(|(value, sigma)| *sigma = sigma.hypot(share * value.norm()));
        }
        tolerant
    }

    /// The same for a search among many, in which a ride that takes far longer than others is refused.
    pub fn hurried(&self) -> Self {
        let mut hurried = self.clone();
        for run in &mut hurried.runs {
            if let Stimulus::Cleat(passage) = &mut run.stimulus {
                passage.most_steps = HURRIED;
            }
        }
        hurried
    }

    /// The same with every so many-th value of each series, for a coarse fit; of a history and a ride their beginning,
    /// since a model has to be driven through whatever it is held against.
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

    /// The same less what its series show beyond what a search predicts, series by series.
    pub fn less(&self, beyond: &[Vec<Complex<f64>>]) -> Self {
        let mut less = self.clone();
        for (series, beyond) in less.series.iter_mut().zip(beyond) {
            series
                .value
                .iter_mut()
                .zip(beyond)
                .for_each(|(value, beyond)| *value -= beyond);
        }
        less
    }

    /// The same with only the runs that `keep` wants.
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
        }
    }
}

impl Stimulus {
    /// Leaves less of a record through which a model has to be driven, so many times less of a history and half of a
    /// ride whose values stand `at` these times: when it ends now, and by how much fewer of its values are then to be
    /// compared. Anything else stays.
    fn shorten(&mut self, times: usize, at: &[f64]) -> (f64, usize) {
        match self {
            // Part of a period is no period.
            Stimulus::History { periodic: true, .. } => (f64::INFINITY, times),
            Stimulus::History { inputs, rate, band, .. } => {
                let reach = band.as_ref().map_or(0, Band::half);
                inputs.samples = (inputs.samples / times.min(MOST_SHORTENED) + reach).min(inputs.samples);
                let (length, signals) = (inputs.samples, inputs.signals.iter_mut());
                signals.for_each(|(_, samples)| samples.truncate(length));
                (inputs.start + ((length - reach) as f64 - 0.5) / *rate, 1)
            }
            // The impact and the first of the after-shake have all modes of an axle.
            Stimulus::Cleat(passage) if at.len() > 1 && times > 1 => {
                let last = at[at.len() - 1];
                let end = at[at.len() / 2];
                passage.duration -= last - end;
                passage.points_a_sample = COARSE_POINTS;
                (end.next_up(), times.div_ceil(2))
            }
            _ => (f64::INFINITY, times),
        }
    }
}
