//! Axle D whose rides are stepped by the general method.

use models::axle_d::AxleD;
use qcar_runtime::model::{About, Contact, Model};

/// Axle D that does not say that it is linear, so that its rides are stepped by the general method throughout: that
/// ends its steps where the force of the tyre bends, and has no polynomials between them.
pub struct General(About);

impl General {
    pub fn new() -> Self {
        General(About {
            linear: false,
            ..AxleD.about().clone()
        })
    }
}

impl Model for General {
    fn about(&self) -> &About {
        &self.0
    }

    fn prepare(&self, p: &[f64], constants: &mut [f64]) {
        AxleD.prepare(p, constants);
    }

    fn derivative(&self, constants: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]) {
        AxleD.derivative(constants, x, u, dx);
    }

    fn outputs(&self, constants: &[f64], x: &[f64], u: &[f64], y: &mut [f64]) {
        AxleD.outputs(constants, x, u, y);
    }

    fn matrices(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        AxleD.matrices(p, x, u, nonzeros);
    }

    fn sensitivities(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        AxleD.sensitivities(p, x, u, nonzeros);
    }

    fn parameter_jacobian(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        AxleD.parameter_jacobian(p, x, u, nonzeros);
    }

    fn contact_force(&self, constants: &[f64], x: &[f64], s: f64, v: f64) -> f64 {
        AxleD.contact_force(constants, x, s, v)
    }

    fn rolling_derivative(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &Contact, dx: &mut [f64]) {
        AxleD.rolling_derivative(constants, x, u, contact, dx);
    }

    fn rolling_outputs(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &Contact, y: &mut [f64]) {
        AxleD.rolling_outputs(constants, x, u, contact, y);
    }
}
