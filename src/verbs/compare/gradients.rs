//! The gradients of the K&C curves of two campaigns.

use serde::Serialize;

use super::sides::Measured;
use crate::verbs::kc;

/// A gradient of both campaigns, or of one of them if the other has no such curve.
#[derive(Serialize)]
pub(super) struct Gradient {
    pub test: &'static str,
    pub quantity: &'static str,
    pub(super) unit: &'static str,
    pub a: Option<Value>,
    pub b: Option<Value>,
    /// Relative difference (B - A)/A; `None` if A is hardly larger than its uncertainty.
    pub relative: Option<f64>,
    /// The difference over the root of the sum of both squared uncertainties.
    pub standard_errors: Option<f64>,
}

/// A value with its standard deviation.
#[derive(Clone, Copy, Serialize)]
pub(super) struct Value {
    pub value: f64,
    uncertainty: f64,
}

/// The gradients of A, then those of B alone.
pub(super) fn gradients([a, b]: [&Measured; 2]) -> Vec<Gradient> {
    let find = |among: &[kc::Gradient], own: &kc::Gradient| {
        let mut all = among.iter();
        let found = all.find(|other| (other.test, other.quantity) == (own.test, own.quantity));
        found.map(value)
    };
    let first = a
        .gradients
        .iter()
        .map(|own| gradient(own, Some(value(own)), find(&b.gradients, own)));
    let added = b.gradients.iter().filter(|own| find(&a.gradients, own).is_none());
    first
        .chain(added.map(|own| gradient(own, None, Some(value(own)))))
        .collect()
}

impl Value {
    /// True if the difference exceeds the scatter.
    fn is_known(&self) -> bool {
        self.value.abs() > 2.0 * self.uncertainty
    }
}

fn value(of: &kc::Gradient) -> Value {
    Value {
        value: of.value,
        uncertainty: of.uncertainty,
    }
}

fn gradient(of: &kc::Gradient, a: Option<Value>, b: Option<Value>) -> Gradient {
    let both = a.zip(b);
    let difference = |a: Value, b: Value| b.value - a.value;
    Gradient {
        test: of.test,
        quantity: of.quantity,
        unit: of.unit,
        relative: both
            .filter(|(a, _)| a.is_known())
            .map(|(a, b)| difference(a, b) / a.value),
        standard_errors: both.map(|(a, b)| difference(a, b) / a.uncertainty.hypot(b.uncertainty)),
        a,
        b,
    }
}
