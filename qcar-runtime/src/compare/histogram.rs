//! Errors of a whole set of runs: histograms (thesis figures 4.9 to 4.12) and their summary.

/// Counts of values in bins of equal width.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Histogram {
    /// Lower edge of the first bin, a multiple of the width.
    pub start: f64,
    /// Width of a bin.
    pub width: f64,
    /// Number of values in each bin, its lower edge included.
    pub counts: Vec<usize>,
}

impl Histogram {
    /// Counts the finite `values` in bins of `width`; without any there are no bins.
    pub fn new(values: &[f64], width: f64) -> Self {
        let bins = || {
            values
                .iter()
                .filter(|v| v.is_finite())
                .map(|v| (v / width).floor() as i64)
        };
        let (Some(first), Some(last)) = (bins().min(), bins().max()) else {
            return Self {
                start: 0.0,
                width,
                counts: Vec::new(),
            };
        };
        let mut counts = vec![0; (last - first) as usize + 1];
        bins().for_each(|bin| counts[(bin - first) as usize] += 1);
        Self {
            start: first as f64 * width,
            width,
            counts,
        }
    }
}

/// Summary of the absolute values of relative errors.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Summary {
    /// Median.
    pub median: f64,
    /// Maximum.
    pub worst: f64,
}

impl Summary {
    /// `None` if no error is finite.
    pub fn of(errors: &[f64]) -> Option<Self> {
        let mut sizes: Vec<f64> = errors.iter().filter(|e| e.is_finite()).map(|e| e.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let middle = sizes.len() / 2;
        let worst = *sizes.last()?;
        let median = if sizes.len() % 2 == 1 {
            sizes[middle]
        } else {
            (sizes[middle - 1] + sizes[middle]) / 2.0
        };
        Some(Self { median, worst })
    }
}
