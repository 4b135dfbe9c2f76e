//! Every number of discovery that is not a fact of the data, each with its source, or said to be a choice.

/// Standard deviation that is expected of a discrepancy before any measurement, in parts of the signal. A choice that no
/// source gives. The prior is exponential, so that zero is allowed; it is also the limit beyond which a model is `unknown`.
pub const EXPECTED_DISCREPANCY: f64 = 0.05;

/// Correlation of the discrepancy of one sensor between two runs of one kind: what a model misses is in part a function of
/// frequency alone, such as a missing mode, and in part of level, such as a law. Without more knowledge, half and half.
pub const COMMON_TO_LEVELS: f64 = 0.5;

/// Distance at which discrepancies of two frequencies have nothing in common, octaves: the half-power bandwidth of a mode
/// with a damping ratio of a quarter. That ratio is a choice.
pub const CORRELATION_OCTAVES: f64 = 0.7;

/// Rate of false alarms: the threshold of the screening is where one clean campaign in a hundred has a candidate above it.
/// Of `m` candidates the largest gain in the logarithm of the likelihood exceeds `ln(m / rate)` by chance in at most this
/// share of draws (Chernoff's bound of the χ² distribution with one degree of freedom, summed over the candidates).
pub const FALSE_ALARMS: f64 = 0.01;

/// Odds of a further effect beside one that is there, before any measurement: ten single causes for each pair.
/// A choice, not a measurement: it counts 2.3 in the logarithm of the evidence.
pub const FURTHER: f64 = 0.1;

/// Effects of a set. A choice: the time of a search grows with each.
pub const MOST_EFFECTS: usize = 3;

/// Probability from which an answer is given as one: the usual level of significance.
pub const CERTAIN: f64 = 0.95;

/// Share of the excess of the squared gap that an answer has to close on the runs that judge: what leaves more was a part of
/// the truth at best, and is listed as a candidate. A choice, made after clean
/// hardware draws of seed 3 had been given a name: later seeds have to judge it.
pub const EXPLAINED: f64 = 0.8;
