//! Transmissibilities beside a fit to all runs.
//!
//! A campaign with time histories alone, or with a nonlinear model, is fitted to its runs as they are. Its
//! transmissibilities are then compared at the values of that fit.

use qcar_runtime::campaign::Campaign;
use qcar_runtime::fit::Plan;
use qcar_runtime::fit::report::NOTEWORTHY;
use qcar_runtime::least_squares::Stop;
use qcar_runtime::model::About;

use super::nonlinear::{self, Nonlinear};
use super::{Choices, Fitted, is_by_transmissibilities};
use crate::failure::Failure;

/// The fit to all runs; `None` if the model is fitted to transmissibilities.
///
/// # Errors
/// Fails as [`nonlinear::fit`] does.
pub(super) fn fit(campaign: &Campaign, about: &About, choices: &Choices) -> Result<Option<Nonlinear>, Failure> {
    if is_by_transmissibilities(campaign, about, choices) {
        return Ok(None);
    }
    nonlinear::fit(campaign.clone(), choices).map(Some)
}

/// A plan that fits nothing, at the values of a fit.
pub(super) fn known(mut plan: Plan, found: &Nonlinear) -> Plan {
    for own in &mut plan.parameters {
        let of_fit = found.parameters.iter().find(|other| other.name == own.name);
        own.value = of_fit.map_or(own.value, |other| other.value);
        own.fit = false;
    }
    plan
}

impl Nonlinear {
    /// True if a run records an excitation. Free decays have no transmissibilities.
    pub(super) fn is_driven(&self) -> bool {
        let mut runs = self.found.evidence.runs.iter();
        runs.any(|run| !run.stimulus.references().is_empty())
    }
}

/// Takes over parameters, errors and notices of a fit to all runs.
pub(super) fn take_over(fitted: &mut Fitted, found: Nonlinear) {
    let correlations = found.correlations();
    let (stop, starts) = (found.found.explanation.refit.stop, found.starts);
    let fit = &mut fitted.fit;
    fit.correlations = correlations
        .iter()
        .filter(|own| own.value.abs() > NOTEWORTHY)
        .cloned()
        .collect();
    fit.all_correlations = correlations;
    (fit.stopped, fit.stopped_because) = (stop, stop.sentence());
    (fit.converged, fit.starts) = (stop.converged(), starts);
    fitted.other_minima = (stop != Stop::NothingToFit).then_some(found.found.others.len());
    fit.minima.clear();
    fit.parameters = found.parameters;
    fitted.profiles = found.profiles;
    let notices = &mut fitted.campaign.notices;
    notices.extend(found.found.evidence.notices);
    notices.push("the parameters are fitted to all runs as they are, and transmissibilities only compared".into());
}
