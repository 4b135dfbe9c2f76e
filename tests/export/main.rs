//! Exported models against other programs: FMPy and four other importers of FMUs, fmusim of the FMI project, the FMU
//! Manipulation Toolbox, SciPy, GNU Octave, Node; and tables against pyarrow.

mod conformity;
mod fmu;
mod fmusim;
mod histories;
mod importers;
mod javascript;
mod matlab;
mod modelica;
mod programs;
mod rolling;
mod tables;
mod workbook;
