//! What was measured, beside what a model says of it.
//!
//! A data set is made of series. Every series knows its run, its sensor and what its values are; every run its role, its
//! level and what drove it. Uncertainty is the noise of a value, independent from line to line. What is common to all lines
//! of a sensor, such as its calibration, is not in it: see [`noise`](super::noise). Each kind of run has a module of
//! its own, which reads what was measured and predicts the same of a model.

// Sensors in the words of a model.
mod sensor;
// Runs, and what drove them.
mod run;
// Values of one sensor in one run.
mod series;
// All of them: the data set.
mod dataset;
// The same in part.
mod views;
// What a model says of a series.
mod prediction;
// Swept sines: the first harmonics at each frequency.
mod sweep;
// Rides over an obstacle: their impact and after-shake.
mod cleat;
// Any other excitation: the responses themselves.
mod time_history;
// The K&C rig: slow cycles and sines.
mod kc;
// A link alone: forces over its speed.
mod dynamometer;
// Runs through which a parameter changes.
mod drift;
// From a campaign to a data set.
mod read;
// From a model to predictions.
mod predict;

pub use dataset::Evidence;
pub use predict::{predict, predict_begun, predict_sides, replayed};
pub use prediction::{Delay, Free, Misread, PredictError, Prediction};
pub use run::{Band, Means, Passage, Recordings, Restart, Run, Spread, Stimulus, is_seen};
pub use sensor::{excitation_of, order_of, signal_of};
pub use series::{Kind, Series};
pub use sweep::unsteady;
