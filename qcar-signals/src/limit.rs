//! How much packed data may unpack to, so that no small file can fill the memory.

use std::cell::Cell;
use std::io::Read as _;

use crate::error::{Fault, Place, Read};

/// The environment variable with another limit, in MiB.
pub const VARIABLE: &str = "QCAR_MAX_MIB";

/// Unpacked bytes that are allowed for any file.
const ALWAYS: u64 = 256 << 20;
/// Unpacked bytes for each packed byte. Recordings have two to twenty, and dead channels a few hundred.
const PER_BYTE: u64 = 64;

/// The limit that the user has set with [`VARIABLE`], bytes.
pub fn given() -> Option<u64> {
    let given = std::env::var(VARIABLE).ok()?.parse::<u64>().ok()?;
    Some(given.saturating_mul(1 << 20))
}

/// The most bytes to which a file with so many packed bytes may unpack: the limit of the user, otherwise 64 times as
/// many and at least 256 MiB.
pub fn of_unpacked(packed: u64) -> u64 {
    given().unwrap_or_else(|| ALWAYS.max(PER_BYTE.saturating_mul(packed)))
}

/// The bytes to which the packed parts of a file may still unpack.
pub(crate) struct Budget {
    packed: u64,
    most: u64,
    left: Cell<u64>,
}

impl Budget {
    /// For a file of so many bytes.
    pub(crate) fn of_file(packed: u64) -> Self {
        let most = of_unpacked(packed);
        Budget {
            packed,
            most,
            left: Cell::new(most),
        }
    }

    /// Counts unpacked bytes of the part at `place`.
    pub(crate) fn count(&self, bytes: u64, place: &Place) -> Read<()> {
        let left = self.left.get().checked_sub(bytes);
        self.left.set(left.ok_or_else(|| self.exceeded(place))?);
        Ok(())
    }

    fn exceeded(&self, place: &Place) -> Box<Fault> {
        let found = format!(
            "packed data that unpack to more than {} MiB in a file of {} bytes",
            self.most >> 20,
            self.packed
        );
        let remedy = format!("if the file is the right one, raise the limit: set {VARIABLE} to a larger number of MiB");
        Fault::new(place.clone(), found, format!("at most {} MiB", self.most >> 20), remedy)
    }

    /// Everything that `unpacking` gives; `damaged` is the fault for its error.
    pub(crate) fn unpack(
        &self,
        unpacking: impl std::io::Read,
        place: &Place,
        damaged: impl FnOnce(std::io::Error) -> Box<Fault>,
    ) -> Read<Vec<u8>> {
        let mut unpacked = Vec::new();
        let outcome = unpacking
            .take(self.left.get().saturating_add(1))
            .read_to_end(&mut unpacked);
        self.count(unpacked.len() as u64, place)?;
        outcome.map_err(damaged)?;
        Ok(unpacked)
    }
}

#[cfg(test)]
mod tests {
    use super::{ALWAYS, Budget, Place, of_unpacked};

    #[test]
    fn the_limit_counts_all_packed_parts_of_a_file() {
        assert_eq!(of_unpacked(0), ALWAYS);
        assert_eq!(of_unpacked(ALWAYS), 64 * ALWAYS);
        let budget = Budget::of_file(1000);
        let unpack = |bytes: u64| {
            budget.unpack(
                std::io::Read::take(std::io::repeat(7), bytes),
                &Place::Byte(3),
                |error| panic!("{error}"),
            )
        };
        assert_eq!(unpack(1000).unwrap(), [7; 1000]);
        budget.count(ALWAYS - 2000, &Place::File).unwrap();
        assert_eq!(unpack(1000).unwrap().len(), 1000);
        let fault = unpack(1).unwrap_err();
        assert_eq!(fault.place, Place::Byte(3));
        assert!(
            fault.to_string().contains("more than 256 MiB in a file of 1000 bytes"),
            "{fault}"
        );
    }
}
