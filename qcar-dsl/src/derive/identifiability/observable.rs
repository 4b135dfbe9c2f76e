//! The observable quantities of a model, and their derivatives by the parameters.

use num_complex::Complex64;

/// Change of an observable quantity by the estimated parameters.
#[derive(Clone)]
pub struct Observable {
    /// Its value.
    pub value: Complex64,
    /// Its derivatives.
    pub gradient: Vec<Complex64>,
}

impl Observable {
    /// Multiplies by a number.
    pub fn scaled(&self, factor: Complex64) -> Observable {
        Observable {
            value: self.value * factor,
            gradient: self.gradient.iter().map(|change| change * factor).collect(),
        }
    }

    /// Divides by another.
    pub fn over(&self, other: &Observable) -> Observable {
        let value = self.value / other.value;
        let changes = self.gradient.iter().zip(&other.gradient);
        Observable {
            value,
            gradient: changes.map(|(a, b)| (a - value * b) / other.value).collect(),
        }
    }

    /// Rows of the real and the imaginary part of its derivatives, relative to its size and to the parameters.
    pub fn relative_to(&self, parameters: &[f64]) -> [Vec<f64>; 2] {
        let size = self.value.norm().max(f64::MIN_POSITIVE);
        let row = |part: fn(&Complex64) -> f64| -> Vec<f64> {
            let changes = self.gradient.iter().zip(parameters);
            changes.map(|(by, p)| part(by) * p / size).collect()
        };
        [row(|z| z.re), row(|z| z.im)]
    }
}
