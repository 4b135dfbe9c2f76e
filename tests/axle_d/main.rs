//! The benchmark's car, axle_d on an area tyre: over a cleat and on a K&C rig.

#[path = "../../benches/cleat/mod.rs"]
mod cleat;

mod general;

mod abreast;
mod cleat_run;
mod kc_rig;
mod metrics;
mod point;
mod space;
mod tangent;
