//! Hash tables for the small keys of this compiler. SipHash, which protects against malicious keys, took a fifth of the
//! compile time. No result depends on the order of a table.

pub use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};
