//! Measured data and their predictions by a model.
//!
//! A data set consists of series. Every series knows its run, its sensor and the kind of its values. Every run knows
//! its role, its level and its excitation. The uncertainty of a value consists of noise, which is independent from
//! value to value, and of the smallest discrepancy, which neighbouring values share. Errors that all values of a sensor
//! share, such as its calibration, are not included: see [`noise`](super::noise). The module of each kind of run reads
//! the measurement and predicts it.

// Sensors as signals of a model.
mod sensor;
// Runs and their excitation.
mod run;
// The values of one sensor in one run.
mod series;
// The data set.
mod dataset;
// Parts of a data set.
mod views;
// Records cut into short windows.
mod windows;
// Prediction of one series.
mod prediction;
// Swept sines: harmonics over frequency.
mod sweep;
// Cleat runs: impact and after-shake.
mod cleat;
// Time histories of any other excitation.
mod time_history;
// K&C tests: slow cycles and sines.
mod kc;
// Dynamometer tests of a single link.
mod dynamometer;
// Runs with a slowly changing parameter.
mod drift;
// Reading of a campaign.
mod read;
// Prediction of a data set.
mod predict;
// Recorded inputs without their noise.
mod input_noise;

pub(super) use cleat::envelope;
pub use dataset::Evidence;
pub use input_noise::Quieter;
pub use predict::{predict, predict_by_initial_states, predict_sides, replayed};
pub use prediction::{Delay, Free, Initial, PredictError, Prediction, TestConditions};
pub use run::{Band, Means, Passage, Pulses, Recordings, Restart, Run, Spread, Stimulus, measures, zero_of};
pub use sensor::{excitation_of, is_known, missing, nearest_place, order_of, signal_of};
pub(super) use series::nearest;
pub use series::{Kind, Series};
pub use sweep::unsteady;
