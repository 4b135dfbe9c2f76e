//! Hash tables for the small keys of this compiler: a fifth of its work went into SipHash, which defends against keys
//! that an enemy chooses. Nothing depends on the order of a table.

pub use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};
