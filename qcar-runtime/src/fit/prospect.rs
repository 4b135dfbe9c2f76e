//! Information that further measurements would add about the parameters of a fit: a D-optimal choice among sensors, runs and levels.
//!
//! The criterion is the rise of the log determinant of the information about some parameters, all others being estimated, too
//! (Atkinson, Donev & Tobias, "Optimum Experimental Designs, with SAS", 2007, chapters 10 and 11); what the ranges say is part of
//! the information, so that parameters that nothing determines have one (Chaloner & Verdinelli, "Bayesian experimental design: a
//! review", Statistical Science 10, 1995). The expected errors are counted as the fit counts them: scatter, sides of the axle, and
//! gains. Since the fit does not weight channels by what these leave, an error may grow where information does.

pub use super::candidate::Kind;
use super::candidate::candidates;
use super::forecast::{Said, errors};
use super::observation::Level;
use super::plan::Plan;
use super::setup::Setup;
use crate::error::InputError;
use crate::model::Model;
use crate::progress::{self, OnProgress};

/// The present standard errors, and further measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct Prospects {
    /// Places in the model of the parameters that the plan wants fitted.
    pub parameters: Vec<usize>,
    /// Their standard errors; `None` for a parameter that the fitted runs do not determine.
    pub errors: Vec<Option<f64>>,
    /// The most informative first.
    pub further: Vec<Prospect>,
}

/// A further measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Prospect {
    /// Its kind.
    pub kind: Kind,
    /// Description.
    pub what: String,
    /// Rise of the log determinant of the information.
    pub rise: f64,
    /// The standard errors that a fit with it is expected to have.
    pub errors: Vec<Option<f64>>,
}

/// The information that each further measurement would add. The start values of `plan` must be the fitted values; `matter` names
/// the parameters that count (all, if empty). `on_progress` receives the progress.
///
/// # Errors
/// Those of [`super::Setup::new`].
pub fn prospects<M: Model + ?Sized>(
    model: &M,
    plan: &Plan,
    levels: &[Level],
    matter: &[String],
    on_progress: OnProgress<'_>,
) -> Result<Prospects, InputError> {
    let about = model.about();
    let values = Setup::new(model, plan, levels)?.values;
    let is_asked = |place: &usize| {
        let is_own = |own: &&crate::campaign::Parameter| own.name == about.parameters[*place].name;
        values.leader(*place) == *place && plan.parameters.iter().find(is_own).is_some_and(|own| own.fit)
    };
    let asked: Vec<usize> = (0..about.parameters.len()).filter(is_asked).collect();
    let counts =
        |&place: &usize| matter.is_empty() || matter.iter().any(|name| *name == about.parameters[asked[place]].name);
    let counted: Vec<usize> = (0..asked.len()).filter(counts).collect();
    let now = Said::by(model, plan, levels, &asked)?;
    let before = now.log_information(None, &counted);
    let all = candidates(model, &values, levels);
    let further = progress::map(&all, on_progress, |own| {
        let more = Said::by(model, plan, &own.added, &asked)?;
        Ok(Prospect {
            kind: own.kind,
            what: own.what.clone(),
            rise: now.log_information(Some(&more), &counted) - before,
            errors: errors(model, plan, &own.levels, &asked)?,
        })
    });
    let mut further = further.into_iter().collect::<Result<Vec<_>, InputError>>()?;
    further.sort_by(|a, b| b.rise.total_cmp(&a.rise));
    Ok(Prospects {
        errors: errors(model, plan, levels, &asked)?,
        parameters: asked,
        further,
    })
}
