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
// Results for people, programs and eyes.
pub mod table;
// The same for other programs.
pub mod json;
// And drawn.
pub mod figure;
// Simulated time histories.
pub mod histories;
// And all of it on one page.
pub mod report;
// Results as workbooks.
pub mod spreadsheet;
// Results as columns of numbers.
pub mod parquet;
// Work that is given up
pub mod stopping;
// at one of its signs of life.
pub mod progress;
// What becomes of both when the user stops the work.
pub mod interruption;
// Parameter values from files and flags.
pub mod parameters;
// What a parameter set must not do to a model.
pub mod inertias;
// Roads as a user names them.
pub mod roads;
// Models by name or path.
pub mod catalogue;
// Effects that a model may miss.
pub mod effects;
// Names that a shell completes.
pub mod completion;
// How far and how hard the parts of a model move in a campaign.
pub mod scales;
// Models with effects in them.
pub mod workshop;
// What a model leaves of each sensor, in percent.
mod left;
// Dense and named matrices.
pub mod state_space;
// Models for other tools.
pub mod export;
// What the user can ask for.
pub mod verbs;
// The list of it.
pub mod cli;

/// The guide for users of the library, whose code runs as tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
pub struct Guide;
