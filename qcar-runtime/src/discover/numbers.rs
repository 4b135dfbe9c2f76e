//! Assumptions of discovery that the data do not determine, each with its source or marked as a choice.

/// Assumptions of a search. The defaults are those of `qcar discover`.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    /// Prior mean of the discrepancy's standard deviation, relative to the signal. A choice without a source. The prior
    /// is exponential, so zero is allowed. It is also the limit beyond which a model without findings is `unknown`.
    pub expected_discrepancy: f64,

    /// Correlation of the discrepancy of one sensor between two runs of one kind. Part of a model error depends on
    /// frequency alone, such as a missing mode, and part depends on level, such as a wrong law. Without more knowledge
    /// each part is one half.
    pub common_to_levels: f64,

    /// Correlation length of the discrepancy over frequency, octaves: the half-power bandwidth of a mode with a damping
    /// ratio of one quarter. That ratio is a choice.
    pub correlation_octaves: f64,

    /// False-alarm rate of the screening: at most this share of clean campaigns has a candidate above the threshold. By
    /// chance, the largest log likelihood gain of `m` candidates exceeds `ln(m / rate)` in at most this share of draws
    /// (Chernoff bound of the χ² distribution with one degree of freedom, summed over the candidates).
    pub false_alarms: f64,

    /// Prior odds of a further effect beside one that is present: ten single causes for each pair. A choice; it costs
    /// 2.3 in log evidence.
    pub further: f64,

    /// Accepted probability of a wrong answer: the usual significance level.
    pub error_probability: f64,

    /// Share of the excess residual that a learned law may leave on the held-out runs if it counts as an explanation. A
    /// further effect may leave the same share of what the other effects leave. A choice. What a first effect leaves on
    /// hardware mostly has no cause in the catalogue, and some effect explains half of that by chance.
    pub left: f64,
}

/// Largest number of effects in a set. A choice: the search time grows with each effect.
pub const MOST_EFFECTS: usize = 3;

/// Share of the excess residual on the held-out runs that an answer must explain. An effect that explains less is only
/// a candidate. A learned law at the place of a named effect must explain this share of what the name leaves.
pub const GREATER_PART: f64 = 0.5;

/// Standard deviations by which a mean square must exceed its expected value under noise: the one-sided 5 % quantile of
/// the normal distribution.
pub const ONE_SIDED: f64 = 1.645;

/// RMS residual in standard deviations above which noise does not explain it. Sensors with errors beyond their data
/// sheets leave less. A choice. `LARGE` in the report's `judgement.js` is the same limit.
pub const LARGE: f64 = 2.0;

/// Probability of the base model below which it is doubtful: something is then probably missing, and a law is learned
/// even if no effect is certain.
pub const DOUBTFUL_BELOW: f64 = 0.5;

impl Default for Numbers {
    fn default() -> Self {
        Self {
            expected_discrepancy: 0.05,
            common_to_levels: 0.5,
            correlation_octaves: 0.7,
            false_alarms: 0.01,
            further: 0.1,
            error_probability: 0.05,
            left: 0.2,
        }
    }
}

impl Numbers {
    /// Names of the assumptions, as `qcar discover --assume` has them.
    pub const NAMES: [&str; 7] = [
        "expected_discrepancy",
        "common_to_levels",
        "correlation_octaves",
        "false_alarms",
        "further",
        "doubt",
        "left",
    ];

    /// Multiplies one assumption, to show its influence on an answer; `None` if no assumption has that name.
    pub fn with(mut self, name: &str, factor: f64) -> Option<Self> {
        let own = match name {
            "expected_discrepancy" => &mut self.expected_discrepancy,
            "common_to_levels" => &mut self.common_to_levels,
            "correlation_octaves" => &mut self.correlation_octaves,
            "false_alarms" => &mut self.false_alarms,
            "further" => &mut self.further,
            "doubt" => &mut self.error_probability,
            "left" => &mut self.left,
            _ => return None,
        };
        *own *= factor;
        Some(self)
    }

    /// Smallest probability of a certain answer.
    pub fn certain(&self) -> f64 {
        1.0 - self.error_probability
    }

    /// Odds of a certain answer.
    pub fn odds_of_certain(&self) -> f64 {
        self.certain() / self.error_probability
    }

    /// Share of the excess residual that a learned law or a further effect must explain.
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
