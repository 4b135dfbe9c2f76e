//! The compiler as those who call it see it.

mod alone;
mod balance;
mod common;
mod couplings;
mod effect_limits;
mod effects;
mod equations;
mod expressions;
mod forces;
mod frequency_response;
mod interpreter;
mod kinds;
mod language_reference;
mod models_read;
mod never_panics;
mod nonlinear;
mod power;
mod print;
mod refused;
mod rules;
mod scale;
mod tables;
