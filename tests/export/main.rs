//! Exported models against other programs: FMPy, SciPy, GNU Octave; and tables against pyarrow.

mod fmu;
mod histories;
mod matlab;
mod modelica;
mod programs;
mod tables;
mod workbook;
