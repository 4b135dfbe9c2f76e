//! The rig fit of thesis section 3.5.2: model parameters from measured transmissibilities.
//!
//! [`Setup::new`] checks a [`Plan`] against model and measurement; whatever is wrong comes out there. [`Setup::fit`]
//! is total: it searches from several starts and returns a [`Fit`], also where little could be determined.

// What is fitted to.
pub mod observation;
// Which ratios of the measured signals to take.
pub mod channels;
// From the runs of a campaign to what is fitted.
pub mod measure;
// What the engineer decides: starts, bounds, weights.
pub mod plan;
// The residual of thesis section 3.5.2.1.
mod cost;
// Plan, model and measurement checked against each other.
mod setup;
// Several starts over the bounds.
mod search;
// From the Jacobian at the optimum to honest error bars.
mod uncertainty;
// The fit percentage of thesis section 3.5.2.4.
pub mod quality;
// The result as values to print or to serialise.
pub mod report;
// Intervals of parameters by their profiles,
pub mod profile;
// and by fits to what might have been measured.
pub mod bootstrap;
// The errors that a fit is expected to have.
mod forecast;
// What a run says of a place,
mod record;
// as it is and as it would be,
mod supposed;
// what else could be measured,
mod candidate;
// and what it would say.
pub mod prospect;

pub use observation::{Level, Observation};
pub use plan::{Plan, Weighting};
pub use report::Fit;
pub(crate) use search::starts;
pub use setup::Setup;

use crate::model::Model;
use crate::progress::{Told, UNTOLD};
use search::Search;

impl<M: Model + ?Sized> Setup<'_, M> {
    /// Searches from all starts and reports the best minimum with its error bars.
    pub fn fit(&self) -> Fit {
        self.fit_telling(UNTOLD)
    }

    /// The same; `told` hears search by search how far it is.
    pub fn fit_telling(&self, told: Told<'_>) -> Fit {
        let search = Search::run(self, told);
        let uncertainty = uncertainty::estimate(self, &search.best);
        report::report(self, &search, &uncertainty)
    }
}
