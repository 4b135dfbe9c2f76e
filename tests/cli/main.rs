//! The command line as a user meets it.

#[path = "../support/studied.rs"]
mod studied;

mod bad_input;
mod command_line;
mod common;
mod compare;
mod contradictions;
mod document;
mod dynamometer;
mod effects;
mod explore;
mod export;
mod extremes;
mod far_starts;
mod fits;
mod help;
mod interruption;
mod json_reference;
mod laws;
mod lost_sensors;
mod modes;
mod newcomer;
mod noisy_inputs;
mod outputs;
mod plans;
mod published;
mod ranges;
mod readme;
mod records;
mod rides;
mod rigs;
mod roads;
mod targets;
mod terminal;
mod trials;
mod tutorial;
mod uncertainty;
mod unending;
mod units;
