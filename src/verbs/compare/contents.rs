//! A comparison as JSON: the results, and the curves for the report.

use std::collections::BTreeMap;

use serde::Serialize;

use super::cleat_runs::CleatRun;
use super::gather::Comparison;
use super::gradients::Gradient;
use super::modes::Pair;
use super::parameters::Parameter;
use super::ratios::{Ratio, Summary};
use super::records::{Metric, Metrics, Trace};
use super::sides::Side;
use crate::json::Ordered;
use crate::verbs::diff::{Change, parts};
use crate::verbs::study::axle::Axle;

/// Data of the report.
#[derive(Serialize)]
pub(super) struct Contents<'a> {
    #[serde(flatten)]
    pub result: Result<'a>,
    axles: Axles,
    ratios: &'a [Ratio],
    traces: Vec<Traces<'a>>,
    version: &'static str,
}

/// The results in JSON.
#[derive(Serialize)]
pub(super) struct Result<'a> {
    pub kind: &'static str,
    pub a: Named<'a>,
    pub b: Named<'a>,
    parameters: &'a [Parameter],
    modes: &'a [Pair],
    changes: Ordered<Vec<Change<'a>>>,
    pub transmissibility: Vec<Summary<'a>>,
    pub cleat: Cleat<'a>,
    kc: &'a [Gradient],
    pub notices: &'a [String],
}

/// A side.
#[derive(Serialize)]
pub(super) struct Named<'a> {
    /// Name as the user gave it.
    pub name: &'a str,
    pub model: &'a str,
    /// Description of the model.
    doc: &'a str,
    campaign: Option<&'a str>,
}

/// Peaks and after-shakes.
#[derive(Serialize)]
pub(super) struct Cleat<'a> {
    /// Kind of these runs.
    conditions: &'static str,
    runs: Vec<Run<'a>>,
    /// Changes over all runs, by `mass_axis`.
    pub summary: BTreeMap<String, Changes>,
    /// Changes between the measurements of two campaigns.
    pub measured: Option<BTreeMap<String, Changes>>,
}

/// A mass along an axis in a run.
#[derive(Serialize)]
struct Run<'a> {
    run: &'a str,
    role: Option<&'static str>,
    /// Speed, m/s.
    speed: f64,
    /// Height of the cleat, m.
    height: f64,
    #[serde(flatten)]
    metrics: &'a Metrics,
}

/// Changes over all runs.
#[derive(Serialize)]
pub(super) struct Changes {
    pub peak: Option<Spread>,
    pub after_shake: Option<Spread>,
}

/// Statistics of relative changes.
#[derive(Clone, Copy, Serialize)]
pub(super) struct Spread {
    pub least: f64,
    pub median: f64,
    pub greatest: f64,
}

#[derive(Serialize)]
struct Axles {
    a: Axle,
    b: Axle,
}

#[derive(Serialize)]
struct Traces<'a> {
    run: &'a str,
    role: Option<&'static str>,
    speed: f64,
    height: f64,
    time: &'a [f64],
    traces: &'a [Trace],
}

impl<'a> Contents<'a> {
    /// The contents of a comparison.
    pub fn of(comparison: &'a Comparison) -> Self {
        let [a, b] = &comparison.sides;
        let axle = |side: &Side| Axle::of(&side.compiled, side.values.as_slice());
        Contents {
            result: Result::of(comparison),
            axles: Axles { a: axle(a), b: axle(b) },
            ratios: &comparison.ratios,
            traces: comparison.cleat_runs.iter().map(traces).collect(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}

impl<'a> Result<'a> {
    fn of(comparison: &'a Comparison) -> Self {
        let [a, b] = comparison.sides.each_ref().map(named);
        Result {
            kind: comparison.kind,
            a,
            b,
            parameters: &comparison.parameters,
            modes: &comparison.modes,
            changes: parts(&comparison.difference),
            transmissibility: comparison.ratios.iter().map(Ratio::summary).collect(),
            cleat: Cleat {
                conditions: comparison.conditions,
                runs: comparison.cleat_runs.iter().flat_map(runs).collect(),
                summary: summary(&comparison.cleat_runs, |metric| metric.change),
                measured: Some(summary(&comparison.cleat_runs, Metric::measured_change)).filter(|own| !own.is_empty()),
            },
            kc: &comparison.gradients,
            notices: &comparison.notices,
        }
    }
}

fn named(of: &Side) -> Named<'_> {
    let about = of.model.about();
    Named {
        name: &of.name,
        model: &about.name,
        doc: &about.doc,
        campaign: of.measured.as_ref().map(|own| own.campaign.name.as_str()),
    }
}

fn runs(of: &CleatRun) -> impl Iterator<Item = Run<'_>> {
    of.compared.metrics.iter().map(|metrics| Run {
        run: &of.name,
        role: of.role,
        speed: of.speed,
        height: of.height,
        metrics,
    })
}

fn traces(of: &CleatRun) -> Traces<'_> {
    Traces {
        run: &of.name,
        role: of.role,
        speed: of.speed,
        height: of.height,
        time: &of.compared.time,
        traces: &of.compared.traces,
    }
}

/// Changes of every mass and axis that was compared.
fn summary(of: &[CleatRun], change: fn(&Metric) -> Option<f64>) -> BTreeMap<String, Changes> {
    let mut groups: BTreeMap<String, Vec<&Metrics>> = BTreeMap::new();
    for metrics in of.iter().flat_map(|cleat_run| &cleat_run.compared.metrics) {
        let name = format!("{}_{}", metrics.mass, metrics.axis);
        groups.entry(name).or_default().push(metrics);
    }
    let changes = |(name, group): (String, Vec<&Metrics>)| {
        let peak = spread(group.iter().filter_map(|own| change(&own.peak)).collect());
        let after_shake = spread(group.iter().filter_map(|own| change(&own.after_shake)).collect());
        (peak.is_some() || after_shake.is_some()).then_some((name, Changes { peak, after_shake }))
    };
    groups.into_iter().filter_map(changes).collect()
}

fn spread(mut changes: Vec<f64>) -> Option<Spread> {
    changes.sort_by(f64::total_cmp);
    let last = changes.len().checked_sub(1)?;
    Some(Spread {
        least: changes[0],
        median: (changes[last / 2] + changes[changes.len() / 2]) / 2.0,
        greatest: changes[last],
    })
}
