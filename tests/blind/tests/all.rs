//! The blind simulator as the tests of the workbench trust it.

mod answers;
mod finite;
mod flaws;
mod refused;
mod support;
mod unchanged;
