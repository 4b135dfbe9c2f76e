//! Refused models: rustc draws its caret at the mistaken token, and all mistakes come out together.

use std::fs;
use std::path::Path;

#[test]
fn mistakes_are_shown_where_they_are() {
    beside_the_cases("refused.axle");
    trybuild::TestCases::new().compile_fail("tests/refused/*.rs");
}

/// The package of the cases lies in `tests/trybuild/qcar-derive` of the target folder; `tmp` of that folder is where a
/// test may put what they read.
fn beside_the_cases(file: &str) {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(file);
    fs::copy(own, Path::new(env!("CARGO_TARGET_TMPDIR")).join(file)).unwrap();
}
