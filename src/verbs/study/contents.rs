//! A study as JSON: the results of all verbs, and the curves for the report.

use std::collections::BTreeMap;

use qcar_dsl::difference::Difference;
use qcar_runtime::fit::report::Correlation;
use serde::{Serialize, Serializer};

use super::axle::Axle;
use super::gather::Study;
use super::loops::{Loop, loops};
use super::record::{Record, record};
use super::records::{Replayed, records};
use super::residuals::{Explanation, Patch, Refitted, changes, explanations, patches, refitted};
use super::rig::{Ratio, ratios};
use super::shapes::{Shapes, shapes};
use super::summary::{Summary, summary};
use super::track::{Track, track};
use crate::verbs::diff::parts;
use crate::verbs::discover::result as discovered;
use crate::verbs::fit::render as fitted;
use crate::verbs::kc::Gradient;
use crate::verbs::simulate::comparison::Compared;

/// Data of the report.
#[derive(Serialize)]
pub struct Contents<'a> {
    /// The results.
    #[serde(flatten)]
    pub result: Result<'a>,
    axles: Axles,
    loops: Vec<Loop>,
    rig: Vec<Ratio>,
    track: Option<Track<'a>>,
    records: Vec<Replayed>,
    correlations: &'a [Correlation],
    /// Number of other minima of a fit to all runs as they are; `None` for a fit to transmissibilities.
    other_minima: Option<usize>,
    gap_map: GapMap,
    kappa: Vec<Explanation>,
    refitted: Vec<Refitted>,
    changes: Option<Changes>,
    record: Record,
}

/// The results of all verbs.
#[derive(Serialize)]
pub struct Result<'a> {
    /// Name of the campaign.
    pub campaign: &'a str,
    /// The name of the model.
    pub model: &'a str,
    /// Summary.
    pub summary: Summary,
    fit: fitted::Result<'a>,
    kc: &'a [Gradient],
    modes: Shapes,
    simulate: Option<BTreeMap<&'static str, &'a Compared>>,
    discover: discovered::Result<'a>,
    seconds: f64,
}

#[derive(Serialize)]
struct Axles {
    before: Axle,
    after: Option<Axle>,
}

#[derive(Serialize)]
struct GapMap {
    before: Vec<Patch>,
    after: Vec<Patch>,
}

/// Tables, by heading.
struct Changes(Difference);

impl Serialize for Changes {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        parts(&self.0).serialize(serializer)
    }
}

impl<'a> Contents<'a> {
    /// The contents of a study.
    pub fn of(study: &'a Study) -> Self {
        let discovery = &study.answer.discovery;
        let after = study.after.as_ref();
        let rig = ratios(study);
        Contents {
            result: Result::of(study, summary(study, &rig)),
            axles: Axles {
                before: Axle::of(&study.compiled, study.fitted.values().as_slice()),
                after: after.map(|after| Axle::of(&after.compiled, after.values.as_slice())),
            },
            loops: loops(study),
            rig,
            track: track(study),
            records: records(study),
            correlations: &study.fitted.fit.all_correlations,
            other_minima: study.fitted.other_minima,
            gap_map: GapMap {
                before: patches(study, &discovery.before.misfit.tiles),
                after: patches(study, &discovery.after.misfit.tiles),
            },
            kappa: explanations(study),
            refitted: refitted(study),
            changes: changes(study).map(Changes),
            record: record(study),
        }
    }
}

impl<'a> Result<'a> {
    fn of(study: &'a Study, summary: Summary) -> Self {
        Result {
            campaign: &study.fitted.campaign.name,
            model: &study.fitted.fit.model,
            summary,
            fit: fitted::result(&study.fitted),
            kc: &study.gradients,
            modes: shapes(study),
            simulate: study.track.as_ref().map(simulated),
            discover: discovered::result(&study.answer),
            seconds: study.seconds,
        }
    }
}

fn simulated(of: &super::gather::Track) -> BTreeMap<&'static str, &Compared> {
    let all = [
        ("before", Some(&of.before)),
        ("after", of.after.as_ref()),
        ("longitudinally_locked", Some(&of.locked)),
        ("pure_vertical", Some(&of.vertical)),
    ];
    let driven = all
        .into_iter()
        .filter_map(|(name, driven)| Some((name, &driven?.compared)));
    driven.collect()
}
