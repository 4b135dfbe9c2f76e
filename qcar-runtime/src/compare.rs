//! Comparison of a simulated cleat run with the measured one: the two metrics of the thesis (section 3.6.2), and
//! vibration comfort.

mod comfort;
mod errors;
mod histogram;

pub use crate::mean::rms;
pub use comfort::{Weighting, vibration_dose};
pub use errors::{Alignment, CompareError, Errors, Windows, onset, sizes};
pub use histogram::{Histogram, Summary};
