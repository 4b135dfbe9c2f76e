//! Every number of discovery that is not a fact of the data, each with its source, or said to be a choice.

/// What a search assumes. The default is what `qcar discover` uses.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    /// Standard deviation that is expected of a discrepancy before any measurement, in parts of the signal. A choice that no
    /// source gives. The prior is exponential, so that zero is allowed; it is also the limit beyond which a model is `unknown`.
    pub expected_discrepancy: f64,

    /// Correlation of the discrepancy of one sensor between two runs of one kind: what a model misses is in part a function of
    /// frequency alone, such as a missing mode, and in part of level, such as a law. Without more knowledge, half and half.
    pub common_to_levels: f64,

    /// Distance at which discrepancies of two frequencies have nothing in common, octaves: the half-power bandwidth of a mode
    /// with a damping ratio of a quarter. That ratio is a choice.
    pub correlation_octaves: f64,

    /// Rate of false alarms: the threshold of the screening is where one clean campaign in a hundred has a candidate above it.
    /// Of `m` candidates the largest gain in the logarithm of the likelihood exceeds `ln(m / rate)` by chance in at most this
    /// share of draws (Chernoff's bound of the χ² distribution with one degree of freedom, summed over the candidates).
    pub false_alarms: f64,

    /// Odds of a further effect beside one that is there, before any measurement: ten single causes for each pair.
    /// A choice, not a measurement: it counts 2.3 in the logarithm of the evidence.
    pub further: f64,

    /// Probability that an answer may be wrong: the usual level of significance.
    pub doubt: f64,

    /// Share of the excess of the squared gap that may be left on the runs that judge where it counts as closed: by a learned
    /// law, and by a further effect, of what the others leave. A choice: beside a first effect most of what hardware leaves
    /// is its own, and an effect that bends to half of that is easily found.
    pub left: f64,
}

/// Effects of a set. A choice: the time of a search grows with each.
pub const MOST_EFFECTS: usize = 3;

/// Share of the excess of the squared gap that an answer explains at least on the runs that judge: the greater part. What
/// explains less is a candidate. What an answer leaves is held against a learned law, which takes its place where it is
/// more probable.
pub const GREATER_PART: f64 = 0.5;

/// Standard deviations by which a mean square exceeds that of noise where it is more than noise: the normal distribution exceeds
/// them once in twenty draws, the usual level of significance.
pub const ONE_SIDED: f64 = 1.645;

/// Probability of the base model below which a law is learned though no effect is certain: something is missing more probably
/// than not.
pub const EVEN: f64 = 0.5;

impl Default for Numbers {
    fn default() -> Self {
        Self {
            expected_discrepancy: 0.05,
            common_to_levels: 0.5,
            correlation_octaves: 0.7,
            false_alarms: 0.01,
            further: 0.1,
            doubt: 0.05,
            left: 0.2,
        }
    }
}

impl Numbers {
    /// Their names.
    pub const NAMES: [&str; 7] = [
        "expected_discrepancy",
        "common_to_levels",
        "correlation_octaves",
        "false_alarms",
        "further",
        "doubt",
        "left",
    ];

    /// The same with one of them multiplied, to see what an answer owes to it; `None` where none has that name.
    pub fn with(mut self, name: &str, factor: f64) -> Option<Self> {
        let own = match name {
            "expected_discrepancy" => &mut self.expected_discrepancy,
            "common_to_levels" => &mut self.common_to_levels,
            "correlation_octaves" => &mut self.correlation_octaves,
            "false_alarms" => &mut self.false_alarms,
            "further" => &mut self.further,
            "doubt" => &mut self.doubt,
            "left" => &mut self.left,
            _ => return None,
        };
        *own *= factor;
        Some(self)
    }

    /// The least probability of an answer that is given as one.
    pub fn certain(&self) -> f64 {
        1.0 - self.doubt
    }

    /// The odds at which an alternative is certain.
    pub fn odds_of_certain(&self) -> f64 {
        self.certain() / self.doubt
    }

    /// The share of the excess from which on it counts as closed.
    pub fn explained(&self) -> f64 {
        1.0 - self.left
    }
}

#[cfg(test)]
mod tests {
    use super::Numbers;

    #[test]
    fn every_number_has_a_name() {
        let numbers = Numbers::default();
        for name in Numbers::NAMES {
            let changed = numbers.clone().with(name, 1.3).expect("it is one of them");
            assert_ne!(changed, numbers, "{name}");
        }
        assert_eq!(numbers.with("luck", 1.3), None);
    }
}
