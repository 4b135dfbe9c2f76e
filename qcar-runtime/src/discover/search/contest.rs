//! Many explanations, few of which deserve a sharp look: a knock-out.
//!
//! A wrong model that is pressed to fit a precise measurement hides its fault in all its parameters and ends in a poor
//! local minimum. So each explanation is first fitted from several starts to a part of the lines, with a tolerance in
//! which only the large features count. The best go on, sharply; all lines and all rides are kept for the last.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::{News, Progress};
use crate::discover::evidence::Evidence;
use crate::discover::explain::{Explanandum, Explanation};
use crate::discover::predict::PredictError;
use crate::discover::refit::Refit;
use crate::response::parameters::Values;

/// What the explanations are held against.
pub struct Looks<'a> {
    /// What is worth a first look: a part of all.
    pub first: Evidence,
    /// Enough to choose by: all but what takes much time and tells little more.
    pub most: Evidence,
    /// All there is, less what no search looks at: see [`settle`](crate::discover::refit::settle).
    pub all: Evidence,
    /// What the last word is about.
    pub whole: &'a Evidence,
    /// The share of every value that is forgiven at first.
    pub tolerance: f64,
    /// The share of what no change at all leaves that the best must gain, or nobody goes on.
    pub least: f64,
}

/// Which runs a round looks at.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// A part of them.
    First,
    /// All but most rides.
    Most,
    /// All.
    All,
}

impl Look {
    /// It looks at every so many-th value.
    pub fn thinned(self) -> usize {
        match self {
            Look::First => 6,
            Look::Most => 3,
            Look::All => 1,
        }
    }
}

/// A round of the knock-out.
struct Stage {
    /// Which runs it looks at.
    look: Look,
    /// Whether large features alone count.
    tolerant: bool,
    /// Evaluations of a fit.
    evaluations: usize,
    /// Starts of an explanation that go on.
    starts: usize,
    /// Explanations that go on,
    kept: usize,
    /// if they gain this share of what the best of them gains over no change at all, where a share is asked for,
    share: Option<f64>,
    /// and leave no more than so many times what the best leaves.
    times_best: f64,
}

/// So few steps tell who is far from any use, not yet who is better than no change.
const FIRST: Stage = Stage {
    look: Look::First,
    tolerant: true,
    evaluations: 3,
    starts: 2,
    kept: 12,
    share: None,
    times_best: f64::INFINITY,
};

/// Who is far behind after the first steps on all sweeps needs no more of them.
const MOST: Stage = Stage {
    look: Look::Most,
    evaluations: 6,
    kept: 7,
    share: Some(0.3),
    ..FIRST
};

const STAGES: [Stage; 6] = [
    // Of many starts most are far from any use.
    Stage {
        evaluations: 1,
        kept: usize::MAX,
        ..FIRST
    },
    FIRST,
    Stage {
        evaluations: 4,
        share: None,
        ..MOST
    },
    MOST,
    Stage {
        tolerant: false,
        evaluations: 12,
        starts: 1,
        kept: 4,
        times_best: 5.0,
        ..MOST
    },
    Stage {
        look: Look::All,
        tolerant: false,
        evaluations: 25,
        starts: 1,
        kept: 4,
        share: Some(0.0),
        times_best: 3.0,
    },
];

/// So many times as many evaluations are for a linear model where large features alone count, which costs little,
const PATIENCE: usize = 3;
/// and in a first look for one beside a bent law, where all cost alike.
const LESS_PATIENCE: usize = 2;

/// Starts of one entrant whose scores differ by less than this share have come to the same place.
const SAME: f64 = 0.005;

impl Stage {
    /// The part of a gain that must show by now: where large features alone count, some of it is forgiven.
    fn credit(&self) -> f64 {
        if self.tolerant { 0.25 } else { 1.0 }
    }

    /// Evaluations of a fit of this entrant: before the sharp looks one that costs no more than no change has time, and
    /// one more resonance is not dropped for want of a few steps, neither in a first look nor where more runs join.
    fn evaluations(&self, entrant: &Entrant, entrants: &[Entrant]) -> usize {
        let is_linear = |entrant: &Entrant| entrant.explanandum.model.about().linear;
        let times = match self.look {
            _ if self.tolerant && is_linear(entrant) => PATIENCE,
            Look::First if !is_linear(&entrants[0]) => LESS_PATIENCE,
            _ => 1,
        };
        self.evaluations * times
    }
}

/// An explanation of several, with its place among those that entered.
pub struct Finalist {
    /// Its place.
    pub entrant: usize,
    /// How well it explains.
    pub explanation: Explanation,
    /// Sum of squares with the penalty of its unknowns.
    pub score: f64,
}

/// One that was left behind before the end.
pub struct Dropped {
    /// Its place among those that entered.
    pub entrant: usize,
    /// How far behind the best it was then: difference of the scores in units of the scatter that the best left.
    pub behind: f64,
}

/// An explanation that enters the contest.
pub struct Entrant<'a> {
    /// The explanation.
    pub explanandum: Explanandum<'a>,
    /// Number of its unknowns beside those of the base model.
    pub unknowns: usize,
    /// What it is called.
    pub name: String,
}

/// One start of one entrant, and how far it has come.
struct Runner {
    entrant: usize,
    values: Values,
    refit: Option<Refit>,
    score: f64,
}

/// The best of the entrants, the very best first, and the others, those that came far first. One without unknowns is no
/// change at all: it sets the measure.
///
/// # Errors
/// Where a parameter has no value.
pub fn contest(
    entrants: &[Entrant],
    looks: &Looks,
    progress: Progress<'_>,
) -> Result<(Vec<Finalist>, Vec<Dropped>), PredictError> {
    let (mut field, mut dropped) = (Vec::new(), Vec::new());
    for (entrant, of) in entrants.iter().enumerate() {
        field.extend(of.explanandum.starts()?.into_iter().map(|values| Runner {
            entrant,
            values,
            refit: None,
            score: f64::INFINITY,
        }));
    }
    for stage in &STAGES {
        let seen = looks.at(stage);
        let (all, done) = (field.len(), AtomicUsize::new(0));
        progress(News::Far(0, all));
        let fitted = field.into_par_iter().filter_map(|runner| {
            let fitted = runner.run(entrants, &seen, stage);
            progress(News::Far(done.fetch_add(1, Ordering::Relaxed) + 1, all));
            fitted
        });
        let fitted: Vec<Runner> = fitted.collect();
        let before = distances(&fitted);
        field = best(fitted, entrants, stage, looks.least);
        let stays = |entrant: usize| field.iter().any(|runner| runner.entrant == entrant);
        let left = before.into_iter().filter(|left| !stays(left.entrant));
        dropped.splice(0..0, left);
        let is_measure = |runner: &Runner| entrants[runner.entrant].unknowns == 0;
        if entrants.len() > 1 && field.iter().all(is_measure) {
            return Ok((Vec::new(), dropped));
        }
        progress(News::Doing(&told(entrants, &field)));
    }
    // The measure has done its work, unless it is all there is.
    field.retain(|runner| entrants.len() == 1 || entrants[runner.entrant].unknowns > 0);
    let finalists = field.into_par_iter().map(|runner| {
        let entrant = &entrants[runner.entrant];
        let refit = runner.refit.ok_or(PredictError::NoNumber)?;
        let explanation = entrant.explanandum.explanation(refit, looks.whole)?;
        Ok(Finalist {
            entrant: runner.entrant,
            score: entrant.score(&explanation.refit),
            explanation,
        })
    });
    let mut finalists = that_answer(finalists.collect(), entrants.len() == 1)?;
    // What sweeps show beyond their steady harmonics is seen only now, and may change the order.
    finalists.sort_by(|a, b| a.score.total_cmp(&b.score));
    Ok((finalists, dropped))
}

/// Those that say something of all runs: of many, one that gives no number in some is no explanation; of one `alone`, the
/// reason is told.
fn that_answer(finalists: Vec<Result<Finalist, PredictError>>, alone: bool) -> Result<Vec<Finalist>, PredictError> {
    if alone {
        return finalists.into_iter().collect();
    }
    Ok(finalists.into_iter().filter_map(Result::ok).collect())
}

impl Entrant<'_> {
    /// Sum of squares with the penalty of the unknowns.
    fn score(&self, refit: &Refit) -> f64 {
        refit.chi2 + (refit.residuals as f64).ln() * self.unknowns as f64
    }
}

impl Looks<'_> {
    fn at(&self, stage: &Stage) -> Evidence {
        let seen = match stage.look {
            Look::First => &self.first,
            Look::Most => &self.most,
            Look::All => &self.all,
        };
        let thinned = seen.thinned(stage.look.thinned());
        if stage.tolerant {
            thinned.tolerant(self.tolerance)
        } else {
            thinned
        }
    }
}

/// So many of those who are left are named: a line of a terminal has room for no more.
const NAMED: usize = 2;

/// Who is left, the best first.
fn told(entrants: &[Entrant], field: &[Runner]) -> String {
    let mut met = BTreeSet::new();
    let names = field.iter().map(|runner| entrants[runner.entrant].name.as_str());
    let names: Vec<&str> = names.filter(|name| met.insert(*name)).collect();
    let (named, others) = names.split_at(names.len().min(NAMED));
    let more = match others.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("looking into {}{more}", named.join(", "))
}

impl Runner {
    /// `None` where the model gives no number.
    fn run(self, entrants: &[Entrant], evidence: &Evidence, stage: &Stage) -> Option<Runner> {
        let entrant = &entrants[self.entrant];
        let earlier = self.refit.as_ref();
        let refit = entrant
            .explanandum
            .refit(&self.values, earlier, evidence, stage.evaluations(entrant, entrants))
            .ok()?;
        let score = entrant.score(&refit);
        score.is_finite().then(|| Runner {
            entrant: self.entrant,
            values: refit.values.clone(),
            refit: Some(refit),
            score,
        })
    }
}

/// How far each entrant is behind the best, the best first.
fn distances(field: &[Runner]) -> Vec<Dropped> {
    let mut order: Vec<&Runner> = field.iter().collect();
    order.sort_by(|a, b| a.score.total_cmp(&b.score));
    let Some(&first) = order.first() else { return Vec::new() };
    let left = first.refit.as_ref().map_or(1.0, |r| r.chi2 / r.residuals as f64);
    let behind = |runner: &Runner| (runner.score - first.score) / left.max(1.0);
    let mut met = BTreeSet::new();
    let of_each = order.into_iter().filter(|runner| met.insert(runner.entrant));
    let distance = |runner: &Runner| Dropped {
        entrant: runner.entrant,
        behind: behind(runner),
    };
    of_each.map(distance).collect()
}

/// Of each of the best entrants the best runners, the very best first.
fn best(mut field: Vec<Runner>, entrants: &[Entrant], stage: &Stage, least_gain: f64) -> Vec<Runner> {
    field.sort_by(|a, b| a.score.total_cmp(&b.score));
    let unchanged = field.iter().find(|runner| entrants[runner.entrant].unknowns == 0);
    let least = match (field.first(), unchanged, stage.share) {
        (Some(first), Some(unchanged), Some(share)) => {
            let gain = (share * (unchanged.score - first.score)).max(stage.credit() * least_gain * unchanged.score);
            unchanged.score - gain
        }
        _ => f64::INFINITY,
    };
    let farthest = field
        .first()
        .map_or(f64::INFINITY, |first| stage.times_best * first.score);
    let mut passed: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    field.retain(|runner| {
        let is_measure = entrants[runner.entrant].unknowns == 0;
        let changes = passed.keys().filter(|&&entrant| entrants[entrant].unknowns > 0);
        // Forms of one effect at one place are one explanation, and take the room of one.
        let names: BTreeSet<&str> = changes.map(|&entrant| entrants[entrant].name.as_str()).collect();
        let has_passed = names.contains(entrants[runner.entrant].name.as_str());
        let room = has_passed || names.len() < stage.kept;
        let starts = passed.get(&runner.entrant).map_or(&[][..], Vec::as_slice);
        let is_there = starts.iter().any(|score| runner.score - score < SAME * score);
        let is_wanted = is_measure || room && runner.score <= least.min(farthest);
        let passes = is_wanted && !is_there && starts.len() < stage.starts;
        if passes {
            passed.entry(runner.entrant).or_default().push(runner.score);
        }
        passes
    });
    field
}

#[cfg(test)]
mod tests;
