//! Design for targets: the design of least cost that meets all targets, the front between metrics, and the box of
//! parameter intervals in which all targets hold.

// The targets, and the parameters that may change.
mod task;
// The metrics of an axle with their derivatives.
mod axle;
// A quadratic programme with separable nonlinear terms.
mod quadratic;
// The design of least cost.
mod search;
// The Pareto front between metrics.
mod front;
// The largest box of designs that meet all targets.
mod space;
// Slices through the design space around that box.
mod cut;

pub use axle::{Axle, Move};
pub use cut::{Cut, Dot, cut};
pub use front::{Front, Point, Settings as FrontSettings, front};
pub use search::{Found, search};
pub use space::{Settings as SpaceSettings, Space, space};
pub use task::{Coupling, DesignVariable, Designs, Limit, Sense, Task, is_met};
