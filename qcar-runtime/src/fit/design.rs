//! Expected information of further measurements about the parameters of a fit: a D-optimal choice among sensors, runs
//! and levels.
//!
//! The criterion is the increase of the log determinant of the information about some parameters, with all others
//! estimated too (Atkinson, Donev & Tobias, "Optimum Experimental Designs, with SAS", 2007, chapters 10 and 11). The
//! ranges count as priors, so that parameters without data have some information (Chaloner & Verdinelli, "Bayesian
//! experimental design: a review", Statistical Science 10, 1995). The expected errors have the same causes as in the
//! fit: scatter, sides of the axle, and gains. The fit does not weight channels by their residuals, so an error may
//! grow with the information.

pub use super::candidate::Kind;
use super::candidate::candidates;
use super::forecast::{Information, errors};
use super::observation::Level;
use super::plan::Plan;
use super::setup::Setup;
use crate::error::InputError;
use crate::model::Model;
use crate::progress::{self, OnProgress};

/// Present standard errors, and the gains of further measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedGains {
    /// Positions in the model of the parameters to fit.
    pub parameters: Vec<usize>,
    /// Their standard errors; `None` for a parameter that the fitted runs do not determine.
    pub errors: Vec<Option<f64>>,
    /// Further measurements, most informative first.
    pub further: Vec<ExpectedGain>,
}

/// A further measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedGain {
    /// Its kind.
    pub kind: Kind,
    /// Description.
    pub what: String,
    /// Increase of the log determinant of the information.
    pub rise: f64,
    /// Expected standard errors of a fit with this measurement.
    pub errors: Vec<Option<f64>>,
}

/// Information that each further measurement would add. The start values of `plan` must be the fitted values. `wanted`
/// names the parameters that count; if it is empty, all count. `on_progress` receives the progress after each
/// measurement.
///
/// # Errors
/// Fails as [`super::Setup::new`] does.
pub fn expected_gains<M: Model + ?Sized>(
    model: &M,
    plan: &Plan,
    levels: &[Level],
    wanted: &[String],
    on_progress: OnProgress<'_>,
) -> Result<ExpectedGains, InputError> {
    let about = model.about();
    let values = Setup::new(model, plan, levels)?.values;
    let is_asked = |place: &usize| {
        let is_own = |own: &&crate::campaign::Parameter| own.name == about.parameters[*place].name;
        values.leader(*place) == *place && plan.parameters.iter().find(is_own).is_some_and(|own| own.fit)
    };
    let asked: Vec<usize> = (0..about.parameters.len()).filter(is_asked).collect();
    let counts =
        |&place: &usize| wanted.is_empty() || wanted.iter().any(|name| *name == about.parameters[asked[place]].name);
    let counted: Vec<usize> = (0..asked.len()).filter(counts).collect();
    let now = Information::by(model, plan, levels, &asked)?;
    let before = now.log_information(None, &counted);
    let all = candidates(model, &values, levels);
    let further = progress::map(&all, on_progress, |own| {
        let more = Information::by(model, plan, &own.added, &asked)?;
        Ok(ExpectedGain {
            kind: own.kind,
            what: own.what.clone(),
            rise: now.log_information(Some(&more), &counted) - before,
            errors: errors(model, plan, &own.levels, &asked)?,
        })
    });
    let mut further = further.into_iter().collect::<Result<Vec<_>, InputError>>()?;
    further.sort_by(|a, b| b.rise.total_cmp(&a.rise));
    Ok(ExpectedGains {
        errors: errors(model, plan, levels, &asked)?,
        parameters: asked,
        further,
    })
}
