#![no_main]

#[path = "../bodies/model.rs"]
mod model;

libfuzzer_sys::fuzz_target!(|text: &str| model::survives(text));
