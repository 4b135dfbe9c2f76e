//! Design for targets: the design of least cost that meets all targets, the front between metrics, and the box of
//! parameter intervals in which all targets hold.

// What is wanted, and what may move.
mod task;
// An axle as such a task sees it.
mod axle;
// A quadratic programme of which only what is not linear is separable.
mod quadratic;
// The design of least cost.
mod search;
// Designs of which none is better in everything.
mod front;
// The largest box of good designs,
mod space;
// and what lies around it.
mod cut;

pub use axle::{Axle, Move};
pub use cut::{Cut, Dot, cut};
pub use front::{Front, Point, Settings as FrontSettings, front};
pub use search::{Found, search};
pub use space::{Settings as SpaceSettings, Space, space};
pub use task::{Coupling, Designs, Knob, Limit, Sense, Task, is_met};
