//! From stored to physical values.

/// A rule from stored to physical values.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Conversion {
    /// Offset and factor.
    Linear { offset: f64, factor: f64 },
    /// (p1 x² + p2 x + p3) / (p4 x² + p5 x + p6)
    Rational([f64; 6]),
    /// (p2 − p4 (x − p5 − p6)) / (p3 (x − p5 − p6) − p1), the polynomial conversion of MDF 3.
    Polynomial([f64; 6]),
    /// Pairs of stored and physical values, with straight lines between them or without.
    Table { pairs: Vec<(f64, f64)>, interpolated: bool },
    /// Ranges from the first to the second number, each with its physical value, and the value outside of all ranges.
    Ranges {
        ranges: Vec<(f64, f64, f64)>,
        otherwise: f64,
    },
    /// Texts of single values.
    Labels(Vec<(f64, String)>),
}

impl Conversion {
    /// Stored values are physical values.
    pub(super) const NONE: Conversion = Conversion::Linear {
        offset: 0.0,
        factor: 1.0,
    };

    /// Converts stored to physical values; values with a text do not change.
    pub(super) fn apply(&self, values: &mut [f64]) {
        let mut each = |rule: &dyn Fn(f64) -> f64| values.iter_mut().for_each(|value| *value = rule(*value));
        match self {
            Conversion::Linear { offset, factor } if (*offset, *factor) == (0.0, 1.0) => {}
            Conversion::Linear { offset, factor } => each(&|x| x * factor + offset),
            Conversion::Rational([a, b, c, d, e, f]) => {
                each(&|x| (a * x * x + b * x + c) / (d * x * x + e * x + f));
            }
            Conversion::Polynomial([a, b, c, d, e, f]) => {
                each(&|x| (b - d * (x - e - f)) / (c * (x - e - f) - a));
            }
            Conversion::Table { pairs, interpolated } => each(&|x| in_table(pairs, *interpolated, x)),
            Conversion::Ranges { ranges, otherwise } => each(&|x| {
                let within = ranges.iter().find(|(from, to, _)| (*from..=*to).contains(&x));
                within.map_or(*otherwise, |range| range.2)
            }),
            Conversion::Labels(_) => {}
        }
    }

    /// The texts of values.
    pub(super) fn labels(&self) -> Vec<(f64, String)> {
        match self {
            Conversion::Labels(labels) => labels.clone(),
            _ => Vec::new(),
        }
    }
}

/// The physical value of the pairs at `x`: the value of the nearer pair without interpolation, and the end values
/// outside.
fn in_table(pairs: &[(f64, f64)], interpolated: bool, x: f64) -> f64 {
    let above = pairs.partition_point(|pair| pair.0 <= x);
    match (above.checked_sub(1).map(|below| pairs[below]), pairs.get(above)) {
        _ if x.is_nan() => x,
        (None, None) => f64::NAN,
        (None, Some(end)) => end.1,
        (Some(end), None) => end.1,
        (Some(low), Some(high)) if interpolated => low.1 + (high.1 - low.1) * (x - low.0) / (high.0 - low.0),
        (Some(low), Some(high)) => {
            if x - low.0 <= high.0 - x {
                low.1
            } else {
                high.1
            }
        }
    }
}
