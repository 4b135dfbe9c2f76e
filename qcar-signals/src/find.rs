//! Channels of a recording by name or pattern.

use std::collections::BTreeSet;

use crate::error::{Fault, Place};
use crate::signal::{Recording, Signal, full_name, is_called};

/// Number of channels in an error.
const LISTED: usize = 6;

/// Channels of a file that are read.
pub enum Wanted<'a> {
    /// All of them.
    All,
    /// Those that match one of these patterns, as in [`Recording::find`].
    These(&'a [String]),
    /// None. If the format interleaves its channels, so that reading one means passing all, each gets a summary instead
    /// ([`Samples::stored_summary`](crate::samples::Samples::stored_summary)).
    Summaries,
}

impl Wanted<'_> {
    /// True if a channel is to be read.
    pub(crate) fn has(&self, group: &str, name: &str) -> bool {
        match self {
            Wanted::All => true,
            Wanted::Summaries => false,
            Wanted::These(patterns) => patterns
                .iter()
                .any(|pattern| is_called(pattern, group, name) || matches_channel(pattern, group, name)),
        }
    }

    /// True if this channel is to be read.
    pub fn includes(&self, signal: &Signal) -> bool {
        self.has(&signal.source.group, &signal.name)
    }

    /// True if a channel whose name begins like this may have to be read.
    pub(crate) fn may_begin(&self, beginning: &str) -> bool {
        match self {
            Wanted::All => true,
            Wanted::Summaries => false,
            Wanted::These(patterns) => patterns.iter().any(|pattern| {
                let plain = pattern.split(['*', '?']).next().unwrap_or("");
                plain.starts_with(beginning) || (plain.len() < pattern.len() && beginning.starts_with(plain))
            }),
        }
    }
}

impl Recording {
    /// The channel that matches `pattern`: a name, `group/name`, or either with `*` for any characters and `?` for one.
    /// An exact match takes precedence.
    ///
    /// # Errors
    /// Fails if no channel matches, with similar names, or if several do.
    pub fn find(&self, pattern: &str) -> Result<&Signal, Box<Fault>> {
        let exact = self.signals.iter().any(|signal| signal.is_called(pattern));
        let passed_over = self.passed_over.iter().any(|passed| passed.name == pattern);
        if exact || passed_over {
            return self.signal(pattern);
        }
        let matching: Vec<&Signal> = self.signals.iter().filter(|signal| signal.matches(pattern)).collect();
        match matching.as_slice() {
            [signal] => Ok(signal),
            [] => Err(self.missing(pattern)),
            several => {
                let found = format!("{} channels: {}", several.len(), listed(several));
                let remedy = "write more of the name, or `group/name`";
                Err(Fault::new(Place::File, found, "one channel that matches", remedy).of(pattern))
            }
        }
    }

    /// True if a channel matches `pattern`, even if it is one of several or could not be read.
    pub fn has(&self, pattern: &str) -> bool {
        let passed_over = self.passed_over.iter().any(|passed| passed.name == pattern);
        let mut signals = self.signals.iter();
        passed_over || signals.any(|signal| signal.is_called(pattern) || signal.matches(pattern))
    }

    fn missing(&self, pattern: &str) -> Box<Fault> {
        let similar = self.similar(pattern);
        let found = match similar.as_slice() {
            [] => "no channel of this name or a similar one".into(),
            similar => format!("no channel of this name; the nearest are {}", listed(similar)),
        };
        let remedy = "correct the name; `qcar inspect` lists the channels of the file";
        Fault::new(Place::File, found, "a channel of the file", remedy).of(pattern)
    }

    /// Channels whose names share at least a third of the letter pairs of a pattern, most similar first.
    fn similar(&self, pattern: &str) -> Vec<&Signal> {
        let wanted = pairs(pattern);
        let mut similar: Vec<(f64, &Signal)> = self
            .signals
            .iter()
            .map(|signal| {
                let own = pairs(&signal.name);
                let common = wanted.intersection(&own).count() as f64;
                (2.0 * common / (wanted.len() + own.len()).max(1) as f64, signal)
            })
            .filter(|(similarity, _)| *similarity > 1.0 / 3.0)
            .collect();
        similar.sort_by(|a, b| b.0.total_cmp(&a.0));
        similar.into_iter().map(|(_, signal)| signal).collect()
    }
}

impl Signal {
    fn matches(&self, pattern: &str) -> bool {
        matches_channel(pattern, &self.source.group, &self.name)
    }
}

fn matches_channel(pattern: &str, group: &str, name: &str) -> bool {
    matches_pattern(pattern, name) || matches_pattern(pattern, &full_name(group, name))
}

fn listed(signals: &[&Signal]) -> String {
    let names: Vec<String> = signals
        .iter()
        .take(LISTED)
        .map(|signal| format!("`{}`", signal.full_name()))
        .collect();
    let more = signals.len().saturating_sub(LISTED);
    let rest = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    names.join(", ") + &rest
}

fn pairs(name: &str) -> BTreeSet<(char, char)> {
    let letters: Vec<char> = name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
    letters.windows(2).map(|two| (two[0], two[1])).collect()
}

/// True if a name matches a pattern of `*` and `?`.
fn matches_pattern(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    let (mut at, mut of) = (0, 0);
    // Position to which matching returns if the part after the last `*` fails; the `*` then takes one more character.
    let mut last_star = None;
    while of < name.len() {
        match pattern.get(at) {
            Some('*') => {
                last_star = Some((at, of));
                at += 1;
            }
            Some(&c) if c == '?' || c == name[of] => (at, of) = (at + 1, of + 1),
            _ => match last_star {
                Some((star, taken)) => {
                    last_star = Some((star, taken + 1));
                    (at, of) = (star + 1, taken + 1);
                }
                None => return false,
            },
        }
    }
    pattern[at..].iter().all(|c| *c == '*')
}

#[cfg(test)]
mod tests {
    use super::matches_pattern;

    #[test]
    fn patterns_match_whole_names() {
        for (pattern, name) in [
            ("*Acc_Z", "FL_Body_Acc_Z"),
            ("FL*Z", "FL_Z"),
            ("a?c", "abc"),
            ("*", ""),
            ("*a*b*", "xaxxb"),
        ] {
            assert!(matches_pattern(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in [
            ("*Acc_Z", "FL_Acc_Z_filtered"),
            ("FL", "FL_Z"),
            ("a?c", "ac"),
            ("", "a"),
            ("*ab", "aab_"),
        ] {
            assert!(!matches_pattern(pattern, name), "{pattern} {name}");
        }
    }
}
