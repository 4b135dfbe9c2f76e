//! The axle models that qcar ships, compiled.
