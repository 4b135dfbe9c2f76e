#![no_main]

#[path = "../bodies/effect.rs"]
mod effect;

libfuzzer_sys::fuzz_target!(|text: &str| effect::survives(text));
