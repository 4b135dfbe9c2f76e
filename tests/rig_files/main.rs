//! A campaign whose runs are files of rigs and other programs.

// The same fit from every format.
mod formats;
// What is written and read again.
mod writers;
