#![no_main]

#[allow(dead_code, reason = "each target runs one of its bodies")]
#[path = "../bodies/campaign.rs"]
mod campaign;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| campaign::survives_workbook(bytes));
