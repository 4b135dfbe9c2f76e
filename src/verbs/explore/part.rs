//! `--part`: one of several equal parts of a design, for as many machines.

use std::ops::Range;
use std::str::FromStr;

/// A part; the first is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Part {
    /// Number of the part.
    pub number: u64,
    /// Number of parts.
    pub of: u64,
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(number, of)| {
            let (number, of) = (number.trim().parse().ok()?, of.trim().parse().ok()?);
            (1..=of).contains(&number).then_some(Part { number, of })
        });
        parts.ok_or_else(|| format!("expected K/N with K from 1 to N, such as 3/8, found `{text}`"))
    }
}

impl Part {
    /// The sets of this part.
    pub fn sets(self, count: u64) -> Range<u64> {
        let until = |part: u64| (u128::from(count) * u128::from(part) / u128::from(self.of)) as u64;
        until(self.number - 1)..until(self.number)
    }
}

#[cfg(test)]
mod tests {
    use super::Part;

    #[test]
    fn parts_are_all_of_it_and_nothing_twice() {
        for (count, of) in [(10, 3), (2, 5), (1 << 40, 7), (8, 8)] {
            let mut next = 0;
            for number in 1..=of {
                let sets = Part { number, of }.sets(count);
                assert_eq!(sets.start, next);
                next = sets.end;
            }
            assert_eq!(next, count);
        }
    }

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "1", "0/3", "4/3", "1/0", "-1/3", "a/b"] {
            assert!(text.parse::<Part>().is_err(), "{text}");
        }
    }
}
