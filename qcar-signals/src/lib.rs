//! Measured files: what a rig, a logger or another program wrote, read into channels.
//!
//! The crate knows formats and nothing of axles. Every reader works on the bytes of the file, checks each claimed size
//! against them before it takes memory, and never panics: what cannot be read is an error with its place.
//!
//! The modules stand in the order of the data; a file uses only what is declared above it.

pub mod error;
// Values as narrow as they are stored.
pub mod samples;
// What all formats are read into.
pub mod signal;
// Which of its channels a name means.
pub mod find;
// Their samples at one rate.
pub mod resample;
// What is wrong with them.
pub mod health;
// The bytes of a file, in memory or on the disk.
pub mod content;
// Checked access to them.
mod bytes;
// Which texts are units.
mod units;
// What they are in SI.
pub mod si;
// Names, units and columns of a table, whatever it is stored in.
mod table;
// One module a format.
mod csv;
// Of ASAM.
pub mod mdf;
// Of SDRC.
mod uff;
// Of MTS.
mod rpc;
// Of LabVIEW.
mod tdms;
// Of MATLAB.
pub mod mat;
// Of Excel.
mod excel;
// Of ASAM, for roads.
mod crg;
// The door: which format it is, and its channels.
pub mod read;
