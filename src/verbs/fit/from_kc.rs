//! Parameters that no channel of the rig determines, but a K&C curve does: they take the value from the curve.

use qcar_runtime::error::InputError;
use qcar_runtime::fit::report::{NoError, ParameterFit};

use super::Fitted;
use crate::parameters::quoted;
use crate::verbs::kc::{self, Gradient};

/// Relative change of another open parameter, to test whether the value from a curve depends on it.
const TRIAL_FACTOR: f64 = 1.1;

/// Sets the parameters that the fit left at their start values to the values for which the fitted model has the
/// measured gradients, if these are within their ranges. Otherwise a notice says why not.
///
/// # Errors
/// Fails if a curve has no gradient.
pub(super) fn take_over(fitted: &mut Fitted) -> Result<(), InputError> {
    let open: Vec<String> = fitted
        .fit
        .parameters
        .iter()
        .filter(|p| is_open(p))
        .map(|p| p.name.clone())
        .collect();
    if open.is_empty() || !kc::has_curves(&fitted.campaign) {
        return Ok(());
    }
    for mut gradient in kc::gradients(&fitted.campaign)? {
        if gradient.parameter.as_ref().is_some_and(|name| open.contains(name)) {
            kc::take_apart(&mut gradient, &fitted.campaign, &fitted.model, &fitted.values());
            if let Err(why) = adopt(fitted, &gradient) {
                fitted.campaign.notices.push(why);
            }
        }
    }
    Ok(())
}

fn is_open(parameter: &ParameterFit) -> bool {
    parameter.why_no_stderr == Some(NoError::NotSeen)
}

/// # Errors
/// Why the parameter keeps its start value.
fn adopt(fitted: &mut Fitted, gradient: &Gradient) -> Result<(), String> {
    let name = gradient.parameter.as_deref().unwrap_or_default();
    let kept = |why: &str| format!("{name} keeps its start value: {why}");
    let unknown = gradient.why_no_parameter_value.as_deref().unwrap_or_default();
    let value = gradient.parameter_value.ok_or_else(|| kept(unknown))?;
    let with = partners(fitted, gradient, value);
    let parameters = &mut fitted.fit.parameters;
    let own = parameters.iter_mut().find(|own| own.name == name);
    let own = own.expect("the fit has not determined it");
    if let Some((low, high)) = own.range.filter(|(low, high)| !(*low..=*high).contains(&value)) {
        let [value, range] = [&[value][..], &[low, high]].map(|values| quoted(values, &own.unit, None));
        let test = gradient.test;
        return Err(kept(&format!(
            "the K&C {test} curve gives {value}, outside its range {range}"
        )));
    }
    let error = with.is_empty().then_some(gradient.uncertainty);
    own.value = value;
    own.stderr = error;
    own.relative_stderr = error.map(|error| error / value);
    own.why_no_stderr = (!with.is_empty()).then_some(NoError::OnlyTogether { with });
    own.curve = Some(gradient.test);
    let tied = |other: &&mut ParameterFit| other.tied_to.as_deref() == Some(name);
    parameters.iter_mut().filter(tied).for_each(|tied| tied.value = value);
    Ok(())
}

/// The open parameters whose start values influence the result of a curve by more than its error.
fn partners(fitted: &Fitted, gradient: &Gradient, value: f64) -> Vec<String> {
    let moves = |at: usize| {
        let (mut values, mut moved) = (fitted.values(), gradient.clone());
        values.set(at, TRIAL_FACTOR * values.as_slice()[at]);
        kc::take_apart(&mut moved, &fitted.campaign, &fitted.model, &values);
        moved
            .parameter_value
            .is_none_or(|moved| (moved - value).abs() > gradient.uncertainty)
    };
    let others = fitted.fit.parameters.iter().enumerate();
    let others = others.filter(|(_, other)| is_open(other) && Some(&other.name) != gradient.parameter.as_ref());
    others
        .filter(|(at, _)| moves(*at))
        .map(|(_, other)| other.name.clone())
        .collect()
}
