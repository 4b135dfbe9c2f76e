//! Valid MATLAB names of variables and fields.

use std::collections::HashMap;

use hdf5_pure::mat::identifier::sanitize_name;

/// Largest length, characters.
const LONGEST: usize = super::LONGEST_NAME;

/// The names in one scope as they are written: a character that is not an ASCII letter, a digit or `_` becomes `_`, `x`
/// is prefixed to a name that does not begin with a letter, `_` is appended to a keyword, and a long name is cut.
///
/// # Errors
/// Fails if two names would be written alike.
pub(super) fn names<'a>(given: impl IntoIterator<Item = &'a str>) -> Result<Vec<String>, String> {
    let mut known = HashMap::new();
    let written = given.into_iter().map(|name| {
        let mut written = sanitize_name(name);
        written.truncate(LONGEST);
        match known.insert(written.clone(), name) {
            None => Ok(written),
            Some(other) => Err(format!(
                "`{other}` and `{name}`, which would both be called `{written}`"
            )),
        }
    });
    written.collect()
}
