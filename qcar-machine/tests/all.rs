//! Machine code, judged by the interpreter bit by bit.

mod both;
mod models;
mod programs;
