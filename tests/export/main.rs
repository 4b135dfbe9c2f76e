//! Exported models against other programs: FMPy, SciPy, GNU Octave.

mod fmu;
mod matlab;
mod programs;
