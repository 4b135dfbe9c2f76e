//! Accuracy class of the sensors' calibration curves, estimated from the data.
//!
//! The sensors of a campaign may be less accurate than the data sheets say. All have one accuracy class: the one with
//! the largest evidence, that is, the probability of the data with the shelves of the curves and all other unknowns
//! integrated out (the evidence framework of MacKay, Neural Computation 4, 1992).

use nalgebra::{Cholesky, DMatrix, DVector};

use super::problem::Posterior;
use crate::discover::noise::{AccuracyClass, Known};
use crate::least_squares::{Outcome, Problem, gram};

impl Posterior<'_> {
    /// Sets the accuracy class to the most probable one at the end of a search.
    pub fn estimate_accuracy(&mut self, outcome: &Outcome) {
        if self.nuisance.known != Known::Nothing {
            return;
        }
        let Some(shelves) = Marginal::of(self, outcome) else {
            return;
        };
        self.nuisance.accuracy = shelves.most_probable_class();
        for place in self.nuisance.shelves() {
            self.sigmas[place] = self.nuisance.accuracy.shelf();
        }
    }
}

/// Likelihood of the shelves, with all other unknowns integrated out, along the eigenvectors of its information matrix.
struct Marginal {
    /// Information of the data on each direction.
    information: DVector<f64>,
    /// Slope of the log likelihood along each direction, at zero.
    slope: DVector<f64>,
}

impl Marginal {
    /// At the end of a search; `None` without shelves, or if another unknown is not determined.
    fn of(posterior: &Posterior<'_>, outcome: &Outcome) -> Option<Self> {
        let first = posterior.free.len();
        let shelves: Vec<usize> = posterior.nuisance.shelves().map(|k| first + k).collect();
        if shelves.is_empty() {
            return None;
        }
        let is_other = |k: &usize| outcome.at_bound[*k] == 0 && !shelves.contains(k);
        let others: Vec<usize> = (0..posterior.variables()).filter(is_other).collect();
        let reached = Reached {
            x: &outcome.x,
            gradient: outcome.jacobian.tr_mul(&outcome.residual),
            hessian: gram(&outcome.jacobian),
        };
        reached.marginal(&shelves, &others, posterior.nuisance.accuracy.shelf())
    }

    fn most_probable_class(&self) -> AccuracyClass {
        let cost = |class: &AccuracyClass| self.cost(class.shelf()) + class.cost();
        AccuracyClass::all()
            .min_by(|a, b| cost(a).total_cmp(&cost(b)))
            .unwrap_or_default()
    }

    /// Negative log evidence for a standard deviation of the shelves, up to a constant.
    fn cost(&self, sigma: f64) -> f64 {
        let of = |(information, slope): (&f64, &f64)| {
            let narrowed = 1.0 + information * sigma * sigma;
            (narrowed.ln() - (slope * sigma).powi(2) / narrowed) / 2.0
        };
        self.information.iter().zip(&self.slope).map(of).sum()
    }
}

/// Where a search ended, with the gradient and the Hessian of the negative log posterior density.
struct Reached<'a> {
    x: &'a [f64],
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
}

impl Reached<'_> {
    /// Likelihood of the shelves, whose prior has the standard deviation `shelf`, with the others integrated out.
    fn marginal(&self, shelves: &[usize], others: &[usize], shelf: f64) -> Option<Marginal> {
        let block = |rows: &[usize], columns: &[usize]| -> DMatrix<f64> {
            DMatrix::from_fn(rows.len(), columns.len(), |i, j| self.hessian[(rows[i], columns[j])])
        };
        let slopes = |places: &[usize]| DVector::from_fn(places.len(), |i, _| self.gradient[places[i]]);
        let along = block(others, shelves);
        let imitated = Cholesky::new(block(others, others))?.solve(&along);
        let prior = shelf.powi(-2);
        let data =
            block(shelves, shelves) - along.tr_mul(&imitated) - DMatrix::identity(shelves.len(), shelves.len()) * prior;
        let coefficients = DVector::from_fn(shelves.len(), |i, _| self.x[shelves[i]]);
        // At an optimum the slopes of likelihood and prior cancel. Before it, a part of the gradient remains.
        let remaining = slopes(shelves) - imitated.tr_mul(&slopes(others));
        let slope = &data * &coefficients + &coefficients * prior - remaining;
        let directions = data.symmetric_eigen();
        Some(Marginal {
            information: directions.eigenvalues.map(|value| value.max(0.0)),
            slope: directions.eigenvectors.tr_mul(&slope),
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::{AccuracyClass, Marginal, Reached};

    /// Shelves of this size with alternating signs, each known to `error`.
    fn shelves(size: f64, error: f64) -> Marginal {
        let information = DVector::from_element(48, error.powi(-2));
        let slope = DVector::from_fn(48, |k, _| if k % 2 == 0 { size } else { -size } * error.powi(-2));
        Marginal { information, slope }
    }

    /// The most probable variance of exactly known values is their mean square.
    #[test]
    fn the_class_of_known_shelves_is_their_size() {
        for class in AccuracyClass::all() {
            let found = shelves(class.shelf(), 1e-5).most_probable_class();
            assert_eq!(found, class);
        }
    }

    /// Shelves that differ from zero by no more than their standard error do not show inaccurate sensors.
    #[test]
    fn shelves_within_their_noise_leave_the_class_of_the_data_sheets() {
        assert_eq!(shelves(0.05, 0.05).most_probable_class(), AccuracyClass::default());
    }

    /// A quadratic posterior has the same likelihood of its shelves from everywhere. Without the gradient that remains,
    /// a search that ends early finds sensors of another class.
    #[test]
    fn a_search_that_ends_early_finds_the_class_of_the_optimum() {
        let class = AccuracyClass::all().nth(3).expect("there are nine");
        let variables = 20;
        let jacobian = DMatrix::from_fn(60, variables, |i, j| 1e3 * (1.3 * ((i + 1) * (j + 3)) as f64).sin());
        let shelves: Vec<usize> = (4..variables).collect();
        let others: Vec<usize> = (0..4).collect();
        let prior = AccuracyClass::default().shelf().powi(-2);
        let priors = DMatrix::from_fn(variables, variables, |i, j| if i == j && i >= 4 { prior } else { 0.0 });
        let true_x = DVector::from_fn(
            variables,
            |k, _| if k % 2 == 0 { class.shelf() } else { -class.shelf() },
        );
        let hessian = jacobian.tr_mul(&jacobian) + priors;
        let from = |x: &DVector<f64>| {
            let reached = Reached {
                x: x.as_slice(),
                gradient: &hessian * x - jacobian.tr_mul(&(&jacobian * &true_x)),
                hessian: hessian.clone(),
            };
            let marginal = reached
                .marginal(&shelves, &others, prior.powf(-0.5))
                .expect("all are determined");
            marginal.most_probable_class()
        };
        let start = DVector::from_fn(variables, |k, _| 0.2 * (k as f64).cos());
        assert_eq!((from(&true_x), from(&start)), (class, class));
    }
}
