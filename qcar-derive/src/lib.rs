//! The macro door of the axle compiler.
