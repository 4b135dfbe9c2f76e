//! Refused models: rustc draws its caret at the mistaken token, and all mistakes come out together.

#[test]
fn mistakes_are_shown_where_they_are() {
    trybuild::TestCases::new().compile_fail("tests/refused/*.rs");
}
