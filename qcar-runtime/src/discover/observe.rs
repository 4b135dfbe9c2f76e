//! What was measured, beside what a model says of it.
//!
//! A data set is made of series. Every series knows its run, its sensor and what its values are; every run its role, its
//! level and what drove it. Uncertainty is the noise of a value, independent from line to line. What is common to all lines
//! of a sensor, such as its calibration, is not in it: see [`noise`](super::noise). Each kind of run has a module of
//! its own, which reads what was measured and predicts the same of a model.

// The signal of the model that a sensor measures.
mod sensor;
// Runs and their excitation.
mod run;
// The values of one sensor in one run.
mod series;
// All series of a campaign.
mod dataset;
// Selections of the data set.
mod views;
// A model's prediction of a series, with its derivatives.
mod prediction;
// Sweeps: harmonics at each frequency.
mod sweep;
// Cleat runs: impact and after-shake.
mod cleat;
// Time histories under any other excitation.
mod time_history;
// K&C cycles, slow ones and sines.
mod kc;
// The force of a single link over its speed.
mod dynamometer;
// Runs during which a parameter changes slowly.
mod drift;
// From a campaign to a data set.
mod read;
// Predictions of all series by a model.
mod predict;

pub use dataset::Evidence;
pub use predict::{predict, predict_begun, predict_sides, replayed};
pub use prediction::{Delay, Free, Misread, PredictError, Prediction};
pub use run::{Band, Means, Passage, Recordings, Restart, Run, Spread, Stimulus, is_seen};
pub use sensor::{excitation_of, order_of, signal_of};
pub use series::{Kind, Series};
pub use sweep::unsteady;
