//! Readers of measured files, and what is done with their signals.

mod damaged;
mod flaws;
mod habits;
mod parts;
mod resampling;
mod roads;
mod samples;
mod written;
