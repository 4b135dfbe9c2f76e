//! Changes of parameters that responses do not show, found while the responses are computed.

use crate::check::rank::{INSIGNIFICANT, NEGLIGIBLE, eliminate, largest_entry};

/// Factor on the smallest pivot while only some of the rows are known, since the largest entry of all is unknown then.
const CLEARLY: f64 = 1e3;

/// The derivatives of the responses so far: a row for each response, with an entry for each parameter. Rows that show no
/// more than others are not kept, so that eliminating all of them is no more work than for as many as parameters.
pub struct Shown {
    parameters: usize,
    rows: Vec<Vec<f64>>,
    /// The largest entry of all rows, kept or not.
    scale: f64,
    /// A basis of the changes that the first rows do not clearly show.
    hidden: Vec<Vec<f64>>,
    /// The number of these first rows.
    eliminated: usize,
}

impl Shown {
    /// No response of this number of parameters.
    pub fn nothing(parameters: usize) -> Self {
        Shown {
            parameters,
            rows: Vec::new(),
            scale: 0.0,
            hidden: eliminate(Vec::new(), parameters, 0.0).null_space,
            eliminated: 0,
        }
    }

    /// Adds rows. Returns whether they determine all parameters with a wide margin, so that further rows are not needed.
    pub fn add(&mut self, rows: Vec<Vec<f64>>) -> bool {
        self.scale = self.scale.max(largest_entry(&rows));
        for row in rows {
            if self.shows_more(&row) {
                self.rows.push(row);
            }
            // As many new rows as old ones, so that all eliminations take not much longer than the last.
            if self.rows.len() >= self.parameters.max(2 * self.eliminated) {
                self.eliminate();
            }
        }
        self.hidden.is_empty()
    }

    fn shows_more(&self, row: &[f64]) -> bool {
        let along = |change: &Vec<f64>| row.iter().zip(change).map(|(by, share)| by * share).sum::<f64>();
        let mut changes = self.hidden.iter();
        changes.any(|change| along(change).abs() > NEGLIGIBLE * self.scale)
    }

    /// Finds what the rows clearly show, and keeps those that show it and those that may show more.
    fn eliminate(&mut self) {
        let found = eliminate(self.rows.clone(), self.parameters, CLEARLY * NEGLIGIBLE * self.scale);
        self.hidden = found.null_space;
        let mut clear = vec![false; self.rows.len()];
        found.pivots.iter().for_each(|&row| clear[row] = true);
        let rows = std::mem::take(&mut self.rows).into_iter().zip(clear);
        let kept: Vec<Vec<f64>> = rows
            .filter(|(row, clear)| *clear || self.shows_more(row))
            .map(|(row, _)| row)
            .collect();
        self.eliminated = kept.len();
        self.rows = kept;
    }

    /// A basis of the changes that no row shows.
    pub fn hidden(&self) -> Vec<Vec<f64>> {
        let every_row_is_clear = self.rows.len() + self.hidden.len() == self.parameters;
        if every_row_is_clear {
            return self.hidden.clone();
        }
        eliminate(self.rows.clone(), self.parameters, NEGLIGIBLE * self.scale).null_space
    }
}

/// A basis of those of some changes that concern a group of parameters alone, given in increasing order.
pub fn within(changes: &[Vec<f64>], group: &[usize]) -> Vec<Vec<f64>> {
    let size = changes.first().map_or(0, Vec::len);
    let others = (0..size).filter(|column| group.binary_search(column).is_err());
    let rows = others.map(|column| changes.iter().map(|change| change[column]).collect());
    let mixtures = eliminate(rows.collect(), changes.len(), INSIGNIFICANT).null_space;
    let mixed = |mixture: Vec<f64>| {
        let entry = |column| {
            mixture
                .iter()
                .zip(changes)
                .map(|(share, change)| share * change[column])
                .sum()
        };
        (0..size).map(entry).collect()
    };
    mixtures.into_iter().map(mixed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of 0.001 to 1 that show `x - y` and `z`: `x + y` stays hidden.
    #[test]
    fn rows_that_show_no_more_are_not_kept() {
        let mut shown = Shown::nothing(3);
        for turn in 1..=1000 {
            let (a, b) = (0.001 * f64::from(turn), f64::from(turn).cos());
            assert!(!shown.add(vec![vec![a, -a, b]]));
        }
        assert!(shown.rows.len() <= 3, "{} rows", shown.rows.len());
        let [change] = &shown.hidden()[..] else {
            panic!("{:?}", shown.hidden());
        };
        assert!(
            (change[0] - change[1]).abs() < 1e-12 && change[2].abs() < 1e-12,
            "{change:?}"
        );
    }

    /// Two parameters that differ by 1e-7 are told apart, but not so clearly that further rows are not needed; by 1e-12
    /// is roundoff.
    #[test]
    fn a_row_that_shows_little_is_kept() {
        for (difference, hidden) in [(1e-3, 0), (1e-7, 0), (1e-12, 1)] {
            let mut shown = Shown::nothing(2);
            let all = shown.add(vec![vec![1.0, 1.0], vec![1.0, 1.0 + difference]]);
            assert_eq!(
                (all, shown.hidden().len()),
                (difference == 1e-3, hidden),
                "{difference}"
            );
        }
    }

    #[test]
    fn a_group_has_those_changes_that_leave_the_others_as_they_are() {
        let changes = [vec![1.0, 1.0, 1.0, 0.0], vec![0.0, 0.0, 1.0, 1.0]];
        assert!(within(&changes, &[0, 1]).is_empty());
        assert_eq!(within(&changes, &[0, 1, 2]), [changes[0].clone()]);
        assert_eq!(within(&changes, &[0, 1, 2, 3]).len(), 2);
    }
}
