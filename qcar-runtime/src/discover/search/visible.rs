//! What `none` is worth: which effects would have been seen.
//!
//! An effect of its usual size is put into the explanation. What of its trace in the fitted runs no other unknown can
//! imitate, to first order, is held against the least that earns a name.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::rules::Judge;
use super::state::State;
use crate::discover::candidate::Change;
use crate::discover::evidence::Evidence;

/// An effect that was not found, and whether it would have been.
#[derive(Clone, Debug, PartialEq)]
pub struct Visible {
    /// Its name.
    pub effect: String,
    /// Its place.
    pub at: String,
    /// Its usual size: parameters and values, SI.
    pub usual: Vec<(String, f64)>,
    /// Its trace at this size over the least that earns a name (RMS): below 1 it would not have been seen.
    pub times: f64,
}

/// Each effect of the model at each place, in its usual form, the best seen first.
pub fn visible(base: &State, judge: &Judge, evidence: &Evidence) -> Vec<Visible> {
    let (here, jacobian) = base.linearised(evidence);
    // The unknowns that the runs do not see at all can imitate nothing.
    let seen: Vec<_> = jacobian.column_iter().filter(|column| column.norm() > 0.0).collect();
    let imitated = DMatrix::from_columns(&seen).qr().q();
    let mut candidates = base.candidates();
    candidates.dedup_by(|next, first| next.effect == first.effect && next.at == first.at);
    // What holds the other unknowns is the same with the effect.
    let trace = |there: DVector<f64>| {
        let mut trace = DVector::zeros(here.len());
        trace
            .rows_mut(0, there.len())
            .copy_from(&(&there - here.rows(0, there.len())));
        (&trace - &imitated * imitated.tr_mul(&trace)).norm_squared()
    };
    let of = candidates.into_par_iter().filter_map(|candidate| {
        let Change::Model { parameters, .. } = &candidate.change else {
            return None;
        };
        let trace = trace(base.residuals_with(&candidate, evidence)?);
        let times = (trace / judge.least_to_name(base, candidate.unknowns())).sqrt();
        times.is_finite().then(|| Visible {
            effect: candidate.effect.clone(),
            at: candidate.at.clone(),
            usual: parameters.iter().map(|p| (p.effect_name.clone(), p.start)).collect(),
            times,
        })
    });
    let mut visible: Vec<Visible> = of.collect();
    visible.sort_by(|a, b| b.times.total_cmp(&a.times));
    visible
}
