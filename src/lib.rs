//! The command line of qcar as a library, so that tests and benchmarks can reach its parts.
//!
//! The modules stand in the order of the data; a file uses only what is declared above it.

pub mod failure;
// Reading and writing of files.
pub mod files;
// Folders of results, in which only a verb's own files are replaced.
pub mod results;
// Width and colours of the terminal.
pub mod terminal;
// The units in which results are shown.
pub mod units;
// Results as text tables.
pub mod table;
// Results as JSON.
pub mod json;
// Results as figures.
pub mod figure;
// Results as time histories.
pub mod histories;
// Results as one HTML page.
pub mod report;
// Results as workbooks.
pub mod spreadsheet;
// Results as Parquet tables.
pub mod parquet;
// Cancellation of long work.
pub mod stopping;
// Progress bars, where cancelled work stops.
pub mod progress;
// Handling of Ctrl-C.
pub mod interruption;
// Sensors of a campaign that a model lacks.
mod sensors;
// Parameter values from files and flags.
pub mod parameters;
// Parameter sets for which a mass is zero or negative.
pub mod inertias;
// Parameter values at which a model is unstable.
mod stability;
// Resonances between the lines of a response.
mod lines;
// Names of roads on the command line.
pub mod roads;
// Models by name or path.
pub mod catalogue;
// Effects that a model may lack.
pub mod effects;
// Names for the completion of a shell.
pub mod completion;
// Amplitudes of a model's parts in a campaign.
pub mod scales;
// Models with effects added.
pub mod workshop;
// The residual of each sensor, in percent.
mod sensor_residuals;
// The shape of a mode, as amplitudes and phases.
mod mode_shape;
// Units that the samples of a channel contradict.
mod suspect_unit;
// Dense and named matrices.
pub mod state_space;
// Models for other tools.
pub mod export;
// The verbs of the command line.
pub mod verbs;
// The command line.
pub mod cli;

/// The guide for users of the library, whose code runs as tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
pub struct Guide;
