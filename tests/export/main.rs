//! Exported models against other programs: FMPy, SciPy, GNU Octave.

mod fmu;
mod histories;
mod matlab;
mod modelica;
mod programs;
mod workbook;
