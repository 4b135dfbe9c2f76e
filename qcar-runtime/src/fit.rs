//! The rig fit of thesis section 3.5.2: model parameters from measured transmissibilities.
//!
//! [`Setup::new`] checks a [`Plan`] against model and measurement; and reports every error. [`Setup::fit`] cannot
//! fail: it searches from several starts and returns a [`Fit`], even if the data determine little.

// Measured ratios with their weights.
pub mod observation;
// The ratios of measured signals that are fitted.
pub mod channels;
// From the runs of a campaign to measured ratios.
pub mod measure;
// Choices of the engineer: starts, bounds, weights.
pub mod plan;
// The residual of thesis section 3.5.2.1.
mod cost;
// Consistency of plan, model and measurement.
mod setup;
// Fits from several starts within the bounds.
mod search;
// Standard errors from the Jacobian at the optimum.
mod uncertainty;
// The fit percentage of thesis section 3.5.2.4.
pub mod quality;
// The result as values to print or to serialise.
pub mod report;
// Intervals by profile likelihood.
pub mod profile;
// Intervals by refits to resampled data.
pub mod bootstrap;
// Standard errors to expect from a measurement.
mod forecast;
// The measured or predicted motion of a place.
mod record;
// A run that was not measured, as the model predicts it.
mod predicted_run;
// Sensors, runs and levels that could be measured in addition.
mod candidate;
// The information that each of them would add.
pub mod design;

pub use observation::{Level, Observation};
pub use plan::{Plan, Weighting};
pub use report::Fit;
pub(crate) use search::starts;
pub use setup::Setup;

use crate::model::Model;
use crate::progress::{NO_PROGRESS, OnProgress};
use search::Search;

impl<M: Model + ?Sized> Setup<'_, M> {
    /// Searches from all starts and reports the best minimum with its error bars.
    pub fn fit(&self) -> Fit {
        self.fit_with_progress(NO_PROGRESS)
    }

    /// The same, with the progress reported to `on_progress` after each search.
    pub fn fit_with_progress(&self, on_progress: OnProgress<'_>) -> Fit {
        let search = Search::run(self, on_progress);
        let uncertainty = uncertainty::estimate(self, &search.best);
        report::report(self, &search, &uncertainty)
    }
}
