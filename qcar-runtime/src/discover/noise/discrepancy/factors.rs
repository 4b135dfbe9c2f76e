//! Cholesky factors of many estimates of one discrepancy.
//!
//! Each estimate searches `τ` in the same interval in the same way, so estimates from similar residuals meet the same
//! values of `τ`, whose factors take most of the time.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use super::banded::Banded;

/// Number of entries of all kept factors: 256 MB. A choice.
const MOST_ENTRIES: usize = 1 << 25;

/// Factors by the position of their group and the bits of `τ`. The first ones are kept, since all searches begin with
/// them.
#[derive(Debug, Default)]
pub struct Factors {
    known: Mutex<Known>,
}

#[derive(Debug, Default)]
struct Known {
    factors: BTreeMap<(usize, u64), Arc<Banded>>,
    entries: usize,
}

impl Factors {
    /// The factor of a group for this `τ`, which `factor` computes unless it is known.
    pub fn of(&self, group: usize, tau: f64, factor: impl Fn() -> Banded) -> Arc<Banded> {
        let known = || self.known.lock().expect("no thread panics with the lock");
        let key = (group, tau.to_bits());
        if let Some(factor) = known().factors.get(&key) {
            return factor.clone();
        }
        let factor = Arc::new(factor());
        let mut known = known();
        if known.entries + factor.entries() <= MOST_ENTRIES && known.factors.insert(key, factor.clone()).is_none() {
            known.entries += factor.entries();
        }
        factor
    }
}
