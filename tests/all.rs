//! Tests of the library and of searches in one program: each program is linked with all that it uses, and one that ends
//! with a long test leaves other processors idle.

mod discover;
mod evidence;
mod examples;
#[path = "family/main.rs"]
mod family;
mod held_out_records;
mod machines;
mod replay;
mod rig_fit;
mod travel;
mod workshop;
