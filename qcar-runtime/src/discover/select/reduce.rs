//! Sets with one effect less.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::assembly::{Hypothesis, Place, Placed};
use super::fidelity::Fidelity;
use super::finite_explanation;
use super::race::{FINE_BUDGET, continued, through_windows};
use super::set::{Set, by_log_posterior};
use super::tangent::Tangent;
use super::window_check::WindowCheck;
use crate::discover::answer::{Progress, Update};
use crate::discover::observe::Evidence;
use crate::discover::posterior::{Explanation, Refit};
use crate::least_squares::gram;

/// Refits the set without each of its effects in turn, the last one included. From this start the remaining effects may
/// reach a better optimum than the set that was extended.
pub fn reductions(set: &Set, base: &Set, evidence: &Evidence, progress: Progress<'_>) -> Vec<Set> {
    progress(Update::Step("fitting with one effect less"));
    let reduction = Reduction::of(set, base, evidence);
    (0..set.assembly.effects().len())
        .into_par_iter()
        .filter_map(|left_out| reduction.without(left_out))
        .collect()
}

/// A set whose effects are left out in turn.
pub struct Reduction<'a> {
    set: &'a Set,
    base: &'a Set,
    evidence: &'a Evidence,
    /// The fit of the set, linearised.
    tangent: Tangent,
    /// The evidence without the non-steady parts, and its runs that are fitted.
    steady: Evidence,
    fitted: Evidence,
    /// The same with records in windows; `None` without records that can be cut.
    windows: Option<Fidelity>,
    /// Shows which smaller sets are not worth a fit to whole records.
    check: Option<WindowCheck>,
}

impl<'a> Reduction<'a> {
    /// The reductions of a set of effects that were added to a base model.
    pub fn of(set: &'a Set, base: &'a Set, evidence: &'a Evidence) -> Self {
        let refit = &set.explanation.refit;
        let steady = evidence.minus(&refit.unsteady).with_step_limit();
        let fitted = Fidelity::of(&steady).fine;
        let windows = Fidelity::in_windows(&steady);
        Self {
            set,
            base,
            evidence,
            tangent: Tangent::new(refit, &set.assembly, &fitted),
            check: windows.as_ref().map(|windows| WindowCheck::of(set, windows)),
            windows,
            fitted,
            steady,
        }
    }

    /// The set without one of its effects, by position; `None` if it cannot be assembled or fitted.
    pub fn without(&self, left_out: usize) -> Option<Set> {
        let effects = self.set.assembly.effects();
        let others: Vec<&Placed> = effects[..left_out].iter().chain(&effects[left_out + 1..]).collect();
        let assembly = self.base.assembly.with_all(&others)?;
        let hypothesis = assembly.hypothesis();
        let share = self.set.log_prior * others.len() as f64 / effects.len() as f64;
        let starts = self.starts_without(&effects[left_out], &hypothesis);
        let is_hopeless = |check: &WindowCheck| {
            let starts = starts.par_iter();
            starts.all(|from| check.is_hopeless(&hypothesis, from, share))
        };
        if self.check.as_ref().is_some_and(is_hopeless) {
            return None;
        }
        let set = |refit: Refit| {
            let explanation = self.explanation(&hypothesis, refit)?;
            Some(Set::new(assembly.clone(), explanation, share))
        };
        let to_whole = |from: &Place| hypothesis.fit(from, &self.steady, FINE_BUDGET).ok();
        let from_whole = starts.par_iter().filter_map(to_whole).filter_map(set);
        let best = from_whole.max_by(by_log_posterior);
        let suffices = |own: &Set| own.log_posterior() >= self.set.log_posterior();
        if best.as_ref().is_some_and(suffices) {
            return best;
        }
        // The phase errors of whole records may have led all of them to a local minimum.
        let windows = self.windows.as_ref().zip(starts.first());
        let in_windows = windows.and_then(|(windows, from)| through_windows(&hypothesis, from, windows));
        let in_windows = in_windows.and_then(set);
        best.into_iter().chain(in_windows).max_by(by_log_posterior)
    }

    /// The explanation by a fit, which is continued if it has not converged.
    fn explanation(&self, hypothesis: &Hypothesis<'_>, refit: Refit) -> Option<Explanation> {
        let refit = continued(hypothesis, refit, &self.steady, |_| true)?;
        finite_explanation(hypothesis, refit, self.evidence)
    }

    /// The optimum of the set as a start without one of its effects, and if that leaves a smaller residual, the same with
    /// the part of the effect taken over by the other unknowns to first order. Otherwise an effect that they imitate
    /// completely, such as a gain of the input, would be kept if the motion is so sensitive that a fit from elsewhere
    /// ends in another local minimum.
    fn starts_without(&self, effect: &Placed, hypothesis: &Hypothesis<'_>) -> Vec<Place> {
        let (explanation, refit) = (&self.set.explanation, &self.set.explanation.refit);
        let start = |mut place: Place| {
            place.errors.resize(hypothesis.sensor_errors(), 0.0);
            place
        };
        let left = |place: &Place| {
            let residual = hypothesis.residuals_at(place, refit, &self.fitted);
            residual.map_or(f64::INFINITY, |residual| residual.norm_squared())
        };
        let here = self.set.assembly.hypothesis().place(refit);
        let removal = effect.unknowns.removal(explanation);
        let unknowns = removal.and_then(|removal| compensated(self.tangent.white_jacobian(), &removal));
        let changed = unknowns.map(|own| start(here.changed_by(&own, refit, self.set.assembly.model())));
        let here = start(here);
        let changed = changed.filter(|changed| left(changed) < left(&here));
        [here].into_iter().chain(changed).collect()
    }
}

/// Changes of all unknowns if some of them, by column of the Jacobian, change by these amounts and the others cancel as
/// much of the change of the residuals as they can; `None` if the normal matrix of the others is singular.
fn compensated(jacobian: &DMatrix<f64>, changed: &[(usize, f64)]) -> Option<DVector<f64>> {
    let mut all = DVector::zeros(jacobian.ncols());
    changed.iter().for_each(|&(column, change)| all[column] = change);
    let is_other = |column: &usize| changed.iter().all(|(own, _)| own != column);
    let others: Vec<usize> = (0..jacobian.ncols()).filter(is_other).collect();
    let own = jacobian.select_columns(&others);
    let step = gram(&own).cholesky()?.solve(&own.tr_mul(&(jacobian * &all)));
    others.iter().zip(&step).for_each(|(&column, step)| all[column] = -step);
    Some(all)
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::compensated;

    /// The first unknown acts as twice the third, but for one residual, and another is left out with it. The second is
    /// orthogonal to both.
    #[test]
    fn what_other_unknowns_imitate_they_take_over() {
        let jacobian = DMatrix::from_columns(&[
            DVector::from_vec(vec![2.0, 4.0, 0.0, 0.0, 0.1]),
            DVector::from_vec(vec![0.0, 0.0, 5.0, 0.0, 0.0]),
            DVector::from_vec(vec![1.0, 2.0, 0.0, 0.0, 0.0]),
            DVector::from_vec(vec![0.0, 0.0, 0.0, 7.0, 0.0]),
        ]);
        let change = compensated(&jacobian, &[(0, -3.0), (3, 0.0)]).unwrap();
        assert!(
            (&change - DVector::from_vec(vec![-3.0, 0.0, 6.0, 0.0])).norm() < 1e-12,
            "{change}"
        );
        assert!(((&jacobian * change).norm() - 0.3).abs() < 1e-12);
    }
}
