//! Least squares in a box with linear inequalities, whose violation has a price.
//!
//! `min Σ w (d - e)² + Σ price max(0, g + A d)` over `low ≤ d ≤ high`. For given multipliers, the best `d` follows for
//! each design variable separately; the multipliers maximise the dual, one after another (Hildreth, Naval Res. Logist.
//! Quart. 4, 1957).

/// The programme.
pub(super) struct Quadratic<'a> {
    /// Weights, above zero.
    pub weights: &'a [f64],
    /// Unconstrained optimum of each design variable.
    pub wanted: &'a [f64],
    pub low: &'a [f64],
    pub high: &'a [f64],
    /// Violation of each inequality at zero.
    pub excess: &'a [f64],
    /// For each inequality, its derivative by each design variable.
    pub slopes: &'a [Vec<f64>],
    /// Upper bound of the multiplier of each inequality.
    pub prices: &'a [f64],
}

const SWEEPS: usize = 400;
const HALVINGS: usize = 50;
/// Multipliers that change by less than this fraction of the highest price have converged.
const SETTLED: f64 = 1e-9;

impl Quadratic<'_> {
    /// The step, and the multiplier of each inequality.
    pub fn solve(&self) -> (Vec<f64>, Vec<f64>) {
        let highest = self.prices.iter().copied().fold(0.0, f64::max);
        let mut multipliers = vec![0.0; self.excess.len()];
        let mut pull = vec![0.0; self.weights.len()];
        for _ in 0..SWEEPS {
            let mut moved: f64 = 0.0;
            for (row, slopes) in self.slopes.iter().enumerate() {
                let before = multipliers[row];
                let after = self.best(row, before, &pull);
                for (pull, slope) in pull.iter_mut().zip(slopes) {
                    *pull += (after - before) * slope;
                }
                multipliers[row] = after;
                moved = moved.max((after - before).abs());
            }
            if moved < SETTLED * highest {
                break;
            }
        }
        (self.step(&pull), multipliers)
    }

    /// The best step under the pull of the inequalities.
    fn step(&self, pull: &[f64]) -> Vec<f64> {
        (0..pull.len())
            .map(|variable| self.variable(variable, pull[variable]))
            .collect()
    }

    fn variable(&self, variable: usize, pull: f64) -> f64 {
        let free = self.wanted[variable] - pull / (2.0 * self.weights[variable]);
        free.clamp(self.low[variable], self.high[variable])
    }

    /// The best multiplier of a row with all others fixed; the remaining excess decreases as it grows.
    fn best(&self, row: usize, now: f64, pull: &[f64]) -> f64 {
        let slopes = &self.slopes[row];
        let left = |multiplier: f64| {
            let variables = slopes.iter().enumerate().filter(|(_, slope)| **slope != 0.0);
            let moved = variables.map(|(k, slope)| slope * self.variable(k, pull[k] + (multiplier - now) * slope));
            self.excess[row] + moved.sum::<f64>()
        };
        if left(0.0) <= 0.0 {
            return 0.0;
        }
        let price = self.prices[row];
        if left(price) >= 0.0 {
            return price;
        }
        let (mut low, mut high) = (0.0, price);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if left(middle) > 0.0 {
                low = middle
            } else {
                high = middle
            }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests {
    use super::Quadratic;

    /// The nearest point to (2, 1) with x + y ≤ 1 is (1, 0); its multiplier is 2 (x - 2) = -2.
    #[test]
    fn the_nearest_point_of_a_half_plane() {
        let quadratic = Quadratic {
            weights: &[1.0, 1.0],
            wanted: &[2.0, 1.0],
            low: &[-9.0, -9.0],
            high: &[9.0, 9.0],
            excess: &[-1.0],
            slopes: &[vec![1.0, 1.0]],
            prices: &[100.0],
        };
        let (step, multipliers) = quadratic.solve();
        assert!((step[0] - 1.0).abs() < 1e-7 && step[1].abs() < 1e-7, "{step:?}");
        assert!((multipliers[0] - 2.0).abs() < 1e-6, "{multipliers:?}");
    }
}
