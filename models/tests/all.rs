//! The shipped models, compiled and interpreted.

mod c99;
mod doors;
mod interpreted;
mod patched;
mod stages;
