//! Rows of an earlier run.

/// Existing rows.
#[derive(Default)]
pub(super) struct ExistingRows {
    /// Number of complete rows.
    pub rows: u64,
    /// The last of them.
    pub last: Option<Vec<f64>>,
}
