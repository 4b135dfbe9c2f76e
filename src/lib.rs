//! The command line of qcar as a library, so that tests and benchmarks can reach its parts.
//!
//! The modules stand in the order of the data; a file uses only what is declared above it.

pub mod failure;
// Reading and writing.
pub mod files;
// How wide a terminal is, and whether it shows colours.
pub mod terminal;
// The units in which results are shown.
pub mod units;
// Results as text tables,
pub mod table;
// as JSON,
pub mod json;
// as figures,
pub mod figure;
// as time histories of simulations,
pub mod histories;
// and as one page with everything.
pub mod report;
// Results as workbooks.
pub mod spreadsheet;
// Results as columns of numbers.
pub mod parquet;
// Cancelled work
pub mod stopping;
// stops at its next progress report.
pub mod progress;
// What happens to files and progress on Ctrl-C.
pub mod interruption;
// Parameter values from files and flags.
pub mod parameters;
// Parameter sets that would make an inertia zero or negative.
pub mod inertias;
// Roads as a user names them.
pub mod roads;
// Models by name or path.
pub mod catalogue;
// Effects that a model may lack.
pub mod effects;
// Names that a shell completes.
pub mod completion;
// Amplitudes of the parts of a model in a campaign.
pub mod scales;
// Models with effects added.
pub mod workshop;
// The residual of each sensor, in percent.
mod left;
// Dense and named matrices.
pub mod state_space;
// Models for other tools.
pub mod export;
// The verbs of the command line.
pub mod verbs;
// The list of them.
pub mod cli;

/// The guide for users of the library, whose code runs as tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
pub struct Guide;
