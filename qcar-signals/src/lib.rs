//! Reads measured files of rigs, loggers and other programs into channels.
//!
//! The crate knows file formats, but nothing of axles. Every reader works on the bytes of the file, checks each
//! declared size against them before it allocates memory, and never panics: unreadable data are an error with a
//! position.
//!
//! The modules stand in the order of the data; a file uses only what is declared above it.

pub mod error;
// Range and means of samples that are not kept.
pub mod summary;
// Samples in the type in which they are stored.
pub mod samples;
// A channel, whatever the format of its file.
pub mod signal;
// Channels by name or pattern.
pub mod find;
// Resampling to one rate.
pub mod resample;
// Flaws of samples.
pub mod health;
// The most that packed data may unpack to.
pub mod limit;
// The bytes of a file, in memory or on the disk.
pub mod content;
// Checked access to the bytes of a file.
mod bytes;
// Spellings of units.
mod units;
// Spellings of dates and clock times.
mod clock;
// Conversion of units to SI.
pub mod si;
// Names, units and columns of a table in any format.
mod table;
// Text tables.
mod csv;
// ASAM MDF.
pub mod mdf;
// UFF dataset 58.
mod uff;
// MTS RPC III.
mod rpc;
// LabVIEW TDMS.
mod tdms;
// MATLAB MAT.
pub mod mat;
// Excel workbooks.
mod excel;
// OpenCRG roads.
mod crg;
// Detection of the format, and reading of the channels.
pub mod read;
