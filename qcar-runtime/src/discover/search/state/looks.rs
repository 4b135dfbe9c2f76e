//! What explanations are held against, look by look: first what the present model is wrong in most.

use super::State;
use crate::campaign::Role;
use crate::discover::evidence::{Evidence, Stimulus};
use crate::discover::search::contest::{Look, Looks};
use crate::discover::search::rules::{NOISE, Wanted};

/// The most that is forgiven at first, as a share of every value.
const TOLERANCE: f64 = 0.1;
/// The least: what lines differ by from what a smooth response would be.
const LEAST_TOLERANCE: f64 = 0.003;

/// Where the present model bends to all that a first look shows, that forgives too much: so many times less is forgiven,
const SHARPER: f64 = 3.0;
/// and again, while this many evaluations come to no more than noise.
const TO_BEND: usize = 9;

/// A run whose gap, or sum of squares, is more than this share of the largest is worth a first look: what a few values show
/// clearly and what many show together.
const MUCH: f64 = 0.25;
/// A ride takes the time of many sweeps, and until the last look so many tell enough.
const RIDES: usize = 1;

impl State {
    /// First at the fitted runs in which the present model is wrong most, and with as much tolerance as it needs itself:
    /// what is wrong with it must be seen. What it shows beyond steady harmonics changes little with one effect more, and
    /// would hide a faint one.
    pub(super) fn looks<'e>(&self, wanted: &Wanted, evidence: &'e Evidence) -> Looks<'e> {
        let (telling, most) = (self.telling(evidence), self.widest(evidence));
        let steady = evidence.less(&self.explanation.refit.unsteady).hurried();
        let first = steady.only(|run| telling.contains(&run));
        Looks {
            tolerance: self.tolerance(&first, evidence),
            first,
            most: steady.only(|run| most.contains(&run)),
            all: steady,
            whole: evidence,
            least: wanted.least,
        }
    }

    /// What is forgiven until looks are sharp: what the present model needs, but less where a wide gap would not be seen in a
    /// first look any more.
    fn tolerance(&self, first: &Evidence, evidence: &Evidence) -> f64 {
        let mut tolerance = self.explanation.misfit(evidence).clamp(LEAST_TOLERANCE, TOLERANCE);
        let is_wide = self.explanation.gap.fit > NOISE;
        while is_wide && tolerance > LEAST_TOLERANCE && self.bends_to(&first.tolerant(tolerance)) {
            tolerance = (tolerance / SHARPER).max(LEAST_TOLERANCE);
        }
        tolerance
    }

    /// True where the present model, refitted, leaves no more than noise of what a first look shows.
    fn bends_to(&self, first: &Evidence) -> bool {
        let known = self.known();
        let explanandum = self.unchanged(Some(&known));
        let beside_known = explanandum.starts().ok().and_then(|starts| starts.into_iter().nth(1));
        let seen = first.thinned(Look::First.thinned());
        let bent = beside_known.and_then(|start| explanandum.refit(&start, None, &seen, TO_BEND).ok());
        bent.is_some_and(|refit| refit.chi2 < NOISE.powi(2) * refit.residuals as f64)
    }

    /// The fitted runs but for most rides, those with the widest gaps first.
    fn widest(&self, evidence: &Evidence) -> Vec<usize> {
        let runs = self.explanation.gap.by_run(evidence);
        let is_fitted = |run: &usize| evidence.runs[*run].role == Role::Fit && runs[*run].0.is_finite();
        let mut fitted: Vec<usize> = (0..runs.len()).filter(is_fitted).collect();
        fitted.sort_by(|&a, &b| runs[b].0.total_cmp(&runs[a].0));
        with_few_rides(fitted, evidence)
    }

    /// Of the widest runs those whose gap is wide or heavy. Where it is next to noise, no run stands out: then one of each
    /// kind. One of each stands beside those that do, too, since a model may bend to what runs of one kind show, and not to
    /// all at once; but no ride does.
    fn telling(&self, evidence: &Evidence) -> Vec<usize> {
        let runs = self.explanation.gap.by_run(evidence);
        let mut telling = self.widest(evidence);
        let firsts = first_of_each_kind(&telling, evidence);
        if self.explanation.gap.fit <= NOISE {
            return firsts;
        }
        // What is no more than noise tells nothing, however much of it there is.
        let width = |run: usize| (runs[run].0.powi(2) - 1.0).max(0.0).sqrt();
        let weight = |run: usize| runs[run].1 * (1.0 - runs[run].0.powi(-2)).max(0.0);
        let most = |of: &dyn Fn(usize) -> f64| telling.iter().map(|&run| of(run)).fold(0.0, f64::max);
        let (widest, heaviest) = (most(&width), most(&weight));
        telling.retain(|&run| {
            let stands_out = width(run) > MUCH * widest || weight(run) > MUCH * heaviest;
            stands_out || firsts.contains(&run) && !is_ride(evidence, run)
        });
        telling
    }
}

/// What one model alone is fitted to: nothing is known yet of where it is wrong.
pub fn of_one(evidence: &Evidence) -> Looks<'_> {
    let fitted = (0..evidence.runs.len()).filter(|&run| evidence.runs[run].role == Role::Fit);
    let few = with_few_rides(fitted.collect(), evidence);
    let most = evidence.only(|run| few.contains(&run));
    Looks {
        first: most.clone(),
        most,
        all: evidence.clone(),
        whole: evidence,
        tolerance: TOLERANCE,
        least: 0.0,
    }
}

/// True for a run over an obstacle.
fn is_ride(evidence: &Evidence, run: usize) -> bool {
    matches!(evidence.runs[run].stimulus, Stimulus::Cleat(_))
}

/// Of some runs the first [`RIDES`] over obstacles, and all others.
fn with_few_rides(mut runs: Vec<usize>, evidence: &Evidence) -> Vec<usize> {
    let mut rides = 0;
    runs.retain(|&run| {
        let is_ride = is_ride(evidence, run);
        rides += usize::from(is_ride);
        !is_ride || rides <= RIDES
    });
    runs
}

/// Of some runs the first of each kind.
fn first_of_each_kind(runs: &[usize], evidence: &Evidence) -> Vec<usize> {
    let mut kinds = Vec::new();
    let is_first = |run: &&usize| {
        let kind = std::mem::discriminant(&evidence.runs[**run].stimulus);
        let is_first = !kinds.contains(&kind);
        kinds.push(kind);
        is_first
    };
    runs.iter().filter(is_first).copied().collect()
}

#[cfg(test)]
mod tests;
