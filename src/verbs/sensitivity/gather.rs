//! Sensitivities of each metric as means over its runs.

use std::borrow::Cow;
use std::ops::Range;

use qcar_runtime::metric::{Ground, MetricError, Reading};
use qcar_runtime::progress::OnProgress;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::sensitivity::{
    Elasticities, Index, Indices, Interval, ParameterUncertainty, Plan, Source, elasticities, indices, size,
};
use serde::Serialize;

use super::subject::Subject;
use super::uncertainty::UncertaintySources;
use crate::json::Ordered;

/// Smaller relative values are rounding errors.
const ROUNDING: f64 = 1e-9;

/// The result.
#[derive(Serialize)]
pub(crate) struct Sensitivity {
    pub subject: String,
    pub model: String,
    /// Names of the runs over which metrics of rides are means.
    pub runs: Vec<String>,
    pub parameters: Vec<Parameter>,
    pub metrics: Vec<MetricResult>,
    /// Notices on the parameters, as sentences.
    pub notices: Vec<String>,
    /// Settings of the Sobol indices, if they were requested.
    pub global: Option<Global>,
}

/// A varied parameter.
#[derive(Serialize)]
pub(crate) struct Parameter {
    pub name: String,
    pub unit: String,
    pub value: f64,
    /// Standard error, if it is known from a fit.
    pub stderr: Option<f64>,
    /// Relative tolerance, if the user gives it.
    pub tolerance: Option<f64>,
    /// Relative change per kelvin, if the user gives it.
    pub per_kelvin: Option<f64>,
}

/// A metric. All sensitivities are those of the mean of its relative values over the runs.
#[derive(Serialize)]
pub(crate) struct MetricResult {
    pub name: String,
    pub unit: Cow<'static, str>,
    pub doc: String,
    /// Mean over the runs.
    pub value: f64,
    /// Value in each run.
    pub values: Ordered<f64>,
    /// For each parameter, percent of the metric per percent of the parameter; NaN if the metric is zero, or that of a
    /// mode with the eigenvalue of another one.
    pub elasticities: Ordered<f64>,
    /// The same for each run and parameter.
    pub by_run: Ordered<Vec<f64>>,
    /// Its uncertainty, if that of any parameter is known.
    pub uncertainty: Option<UncertainMetric>,
    /// Sobol indices for each parameter.
    pub sobol: Option<Ordered<Index>>,
    /// Mean and standard deviation over the designs of the Sobol indices.
    pub spread: Option<[f64; 2]>,
}

/// Uncertainty of a metric.
#[derive(Serialize)]
pub(crate) struct UncertainMetric {
    /// Standard deviation.
    pub deviation: f64,
    /// 95 % of a normal distribution, about the value at the mean temperature.
    pub interval: [f64; 2],
    /// Shares of the fit, of tolerances and of the temperature in the variance.
    pub sources: Ordered<f64>,
    /// Share of each parameter in the variance: the requested ones, then all others with a known uncertainty.
    pub shares: Ordered<f64>,
}

/// Settings of the Sobol indices.
#[derive(Serialize)]
pub(crate) struct Global {
    /// Relative range of each parameter about its value.
    pub spread: f64,
    pub designs: usize,
    /// Number of base designs that could not be simulated and were left out.
    pub failed: usize,
}

/// Settings of an analysis.
pub(crate) struct AnalysisSettings<'a> {
    pub metrics: &'a [usize],
    /// Positions of the parameters.
    pub parameters: &'a [usize],
    pub sources: &'a UncertaintySources,
    /// Number of designs of the Sobol indices, seed, and relative range of the parameters.
    pub global: Option<(Plan, f64)>,
}

/// Computes the sensitivities.
///
/// # Errors
/// Fails if a metric cannot be computed.
pub(crate) fn gather(
    subject: &Subject,
    ground: &mut Ground<'_>,
    asked: &AnalysisSettings<'_>,
    on_progress: OnProgress<'_>,
) -> Result<Sensitivity, MetricError> {
    let groups: Vec<Vec<Reading>> = asked.metrics.iter().map(|&metric| ground.readings_of(metric)).collect();
    let sizes: Vec<usize> = groups.iter().map(Vec::len).collect();
    ground.choose(groups.concat());
    let moved = moved(subject, asked);
    let mut local = elasticities(ground, &subject.values, &moved)?;
    let mut notices = subject.notes.clone();
    notices.extend(without_derivatives(ground, &subject.values, &mut local));
    let about = ground.about();
    let names: Vec<String> = moved.iter().map(|&k| about.parameters[k].name.to_string()).collect();
    let shown = &names[..asked.parameters.len()];
    let uncertainty = asked.sources.uncertainty(subject, &moved);
    let sizes_of: Vec<f64> = moved.iter().map(|&k| size(&subject.values, k)).collect();
    let mut first = 0;
    let mut metric = |(&metric, &size): (&usize, &usize)| {
        let range = first..first + size;
        first = range.end;
        result(
            ground,
            &local,
            (metric, range),
            (shown, &names),
            (uncertainty.as_ref(), &sizes_of),
        )
    };
    let metrics = asked.metrics.iter().zip(&sizes).map(&mut metric).collect();
    let mut found = Sensitivity {
        subject: subject.name.clone(),
        model: about.name.to_string(),
        runs: ground.courses().iter().map(|course| course.name.clone()).collect(),
        parameters: parameters(subject, asked, shown, ground),
        metrics,
        notices,
        global: None,
    };
    if let Some((plan, spread)) = asked.global {
        let relative = |designs: &[Values]| {
            let measured = ground.measure_all(designs).into_iter();
            let own = measured.map(|values| Some(means(&values.ok()?, &local.values, &sizes)));
            own.collect::<Vec<_>>()
        };
        let own = drawn(subject, asked, (plan, spread), on_progress, relative);
        add(&mut found, &own, spread);
    }
    Ok(found)
}

/// Removes the elasticities of modes with equal eigenvalues, which they do not have; a sentence on these.
fn without_derivatives(ground: &Ground<'_>, values: &Values, local: &mut Elasticities) -> Option<String> {
    let equal = ground.of_equal_modes(values);
    let mut names = Vec::new();
    for (at, reading) in ground.readings().iter().enumerate() {
        if equal.contains(&reading.metric) {
            local.elasticities[at].fill(f64::NAN);
            local.slopes[at].fill(f64::NAN);
            names.push(ground.metrics()[reading.metric].name.as_str());
        }
    }
    let names = names.join(", ");
    (!names.is_empty()).then(|| format!("{names}: modes with equal eigenvalues have no derivatives by parameters"))
}

/// The requested parameters, then all others with a known uncertainty: they contribute to the uncertainty of a metric
/// in any case.
fn moved(subject: &Subject, asked: &AnalysisSettings<'_>) -> Vec<usize> {
    let others = asked.sources.places(subject).into_iter();
    let others = others.filter(|place| !asked.parameters.contains(place));
    asked.parameters.iter().copied().chain(others).collect()
}

/// A metric from a range of readings. Elasticities are those of the shown parameters; the uncertainty is due to all.
fn result(
    ground: &Ground<'_>,
    local: &Elasticities,
    (metric, range): (usize, Range<usize>),
    (shown, names): (&[String], &[String]),
    (uncertainty, sizes): (Option<&ParameterUncertainty>, &[f64]),
) -> MetricResult {
    let own = &ground.metrics()[metric];
    let run = |at: usize| {
        let course = ground.readings()[at].course;
        course.map_or("at rest".into(), |run| ground.courses()[run].name.clone())
    };
    let mean = |of: &dyn Fn(usize) -> f64| range.clone().map(of).sum::<f64>() / range.len() as f64;
    let by_parameter =
        |of: &dyn Fn(usize, usize) -> f64| (0..names.len()).map(|k| mean(&|at| of(at, k))).collect::<Vec<_>>();
    let value = mean(&|at| local.values[at]);
    let slopes = by_parameter(&|at, k| value * local.slopes[at][k] * sizes[k] / local.values[at]);
    let elastic = by_parameter(&|at, k| local.elasticities[at][k])
        .into_iter()
        .map(rounded);
    MetricResult {
        name: own.name.clone(),
        unit: own.unit.clone(),
        doc: own.doc.clone(),
        value,
        values: range.clone().map(|at| (run(at), local.values[at])).collect(),
        elasticities: shown.iter().cloned().zip(elastic).collect(),
        by_run: range
            .clone()
            .map(|at| (run(at), local.elasticities[at][..shown.len()].to_vec()))
            .collect(),
        uncertainty: uncertainty
            .filter(|_| slopes.iter().all(|slope| slope.is_finite()))
            .map(|uncertainty| uncertain_metric(value, names, &uncertainty.of(&slopes))),
        sobol: None,
        spread: None,
    }
}

/// The value; zero if it is a rounding error.
pub(crate) fn rounded(value: f64) -> f64 {
    if value.abs() < ROUNDING { 0.0 } else { value }
}

fn parameters(
    subject: &Subject,
    asked: &AnalysisSettings<'_>,
    names: &[String],
    ground: &Ground<'_>,
) -> Vec<Parameter> {
    let own = |(&k, name): (&usize, &String)| Parameter {
        name: name.clone(),
        unit: ground.about().parameters[k].unit.to_string(),
        value: subject.values.as_slice()[k],
        stderr: subject.errors.deviations.get(name).copied(),
        tolerance: (asked.sources.tolerances.get(&k)).map(|part| (part * subject.values.as_slice()[k]).abs()),
        per_kelvin: asked.sources.per_kelvin.get(&k).copied(),
    };
    asked.parameters.iter().zip(names).map(own).collect()
}

/// The uncertainty of a metric with a value, from its interval.
pub(crate) fn uncertain_metric(value: f64, names: &[String], of: &Interval) -> UncertainMetric {
    /// Number of standard deviations that contain 95 % of a normal distribution.
    const NORMAL: f64 = 1.96;
    let (mean, reach) = (value + of.shift, NORMAL * of.deviation);
    UncertainMetric {
        deviation: of.deviation,
        interval: [mean - reach, mean + reach],
        sources: Source::ALL
            .iter()
            .zip(of.sources)
            .map(|(source, share)| (source.name().into(), share))
            .collect(),
        shares: names.iter().cloned().zip(of.shares.iter().copied()).collect(),
    }
}

/// Sobol indices of the results of `relative`, for parameters within the relative range `spread` of their values.
fn drawn(
    subject: &Subject,
    asked: &AnalysisSettings<'_>,
    (plan, spread): (Plan, f64),
    on_progress: OnProgress<'_>,
    relative: impl Fn(&[Values]) -> Vec<Option<Vec<f64>>> + Sync + Send,
) -> Indices {
    let design = |u: &Vec<f64>| {
        let mut values = subject.values.clone();
        for (&parameter, u) in asked.parameters.iter().zip(u) {
            let own = subject.values.as_slice()[parameter];
            values.set(parameter, own * (1.0 + spread * (2.0 * u - 1.0)));
        }
        values
    };
    indices(asked.parameters.len(), plan, on_progress, |designs| {
        relative(&designs.iter().map(design).collect::<Vec<_>>())
    })
}

fn add(to: &mut Sensitivity, own: &Indices, spread: f64) {
    for ((metric, of), moments) in to.metrics.iter_mut().zip(&own.of).zip(&own.moments) {
        let names = to.parameters.iter().map(|parameter| parameter.name.clone());
        metric.sobol = Some(names.zip(of.iter().copied()).collect());
        metric.spread = Some(moments.map(|moment| moment * metric.value));
    }
    to.global = Some(Global {
        spread,
        designs: own.designs,
        failed: own.failed,
    });
}

/// The mean of each metric over its runs, relative to its present value.
fn means(values: &[f64], today: &[f64], sizes: &[usize]) -> Vec<f64> {
    let mut first = 0;
    let mean = |&size: &usize| {
        let range = first..first + size;
        first = range.end;
        range.map(|at| values[at] / today[at]).sum::<f64>() / size as f64
    };
    sizes.iter().map(mean).collect()
}
