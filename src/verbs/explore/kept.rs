//! Rows of an earlier run.

/// Rows that are there already.
#[derive(Default)]
pub(super) struct Kept {
    /// How many are whole.
    pub rows: u64,
    /// The last of them.
    pub last: Option<Vec<f64>>,
}
