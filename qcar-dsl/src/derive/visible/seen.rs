//! The observable quantities of a model, and their derivatives by the parameters.

use num_complex::Complex64;

/// Change of an observable quantity by the estimated parameters.
#[derive(Clone)]
pub struct Seen {
    /// What it is.
    pub value: Complex64,
    /// Its derivatives.
    pub gradient: Vec<Complex64>,
}

impl Seen {
    /// Multiplies by a number.
    pub fn scaled(&self, factor: Complex64) -> Seen {
        Seen {
            value: self.value * factor,
            gradient: self.gradient.iter().map(|change| change * factor).collect(),
        }
    }

    /// Divides by another.
    pub fn over(&self, other: &Seen) -> Seen {
        let value = self.value / other.value;
        let changes = self.gradient.iter().zip(&other.gradient);
        Seen {
            value,
            gradient: changes.map(|(a, b)| (a - value * b) / other.value).collect(),
        }
    }
}
