//! Refused models: rustc draws its caret at the mistaken token, and all mistakes come out together.

use std::fs;
use std::path::Path;

#[test]
fn mistakes_are_shown_where_they_are() {
    into_the_package_of_the_cases("refused.axle");
    trybuild::TestCases::new().compile_fail("tests/refused/*.rs");
}

/// That package lies in `tests/trybuild` of the target folder, whose `tmp` cargo names. A model is named by its path in
/// the package.
fn into_the_package_of_the_cases(file: &str) {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let package = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../tests/trybuild/qcar-derive");
    fs::create_dir_all(package.join("axles")).unwrap();
    fs::copy(tests.join(file), package.join("axles").join(file)).unwrap();
}
