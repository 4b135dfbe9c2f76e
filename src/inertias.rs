//! Masses that a parameter set makes zero or negative, which makes results meaningless.

use qcar_dsl::expr::{Expr, Graph, Symbol};
use qcar_dsl::model::CoordinateKind;
use qcar_dsl::schedule::Compiled;
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::shown::six_digits;

/// The masses and inertias of a model, as expressions of its parameters.
pub struct Inertias {
    graph: Graph,
    all: Vec<Inertia>,
}

struct Inertia {
    /// The line of its declaration.
    line: String,
    value: Expr,
}

impl Inertias {
    /// The inertias of a model.
    pub fn of(compiled: &Compiled) -> Inertias {
        let inertia = |coordinate: &qcar_dsl::model::Coordinate| match coordinate.kind {
            CoordinateKind::Mass(value) => Some(Inertia {
                line: coordinate.declared.line.clone(),
                value,
            }),
            _ => None,
        };
        Inertias {
            graph: compiled.model.graph.clone(),
            all: compiled.model.coordinates.iter().filter_map(inertia).collect(),
        }
    }

    /// Checks the inertias at the values `p` of all parameters of the model `model`.
    ///
    /// # Errors
    /// Fails with every inertia that is not positive.
    pub fn check(&self, model: &str, p: &[f64]) -> Result<(), InputError> {
        let leaf = |symbol| match symbol {
            Symbol::Parameter(place) => p[usize::from(place)],
            _ => f64::NAN,
        };
        let problem = |inertia: &Inertia| {
            let value = self.graph.evaluate(inertia.value, &leaf);
            let place = Place::Name(inertia.line.clone());
            let remedy = "correct the parameter values that it is made of";
            let wrong = || {
                Problem::new(
                    format!("model {model}"),
                    place,
                    six_digits(value).to_string(),
                    "a value above zero",
                    remedy,
                )
            };
            (value.is_nan() || value <= 0.0).then(wrong)
        };
        InputError::unless_empty(self.all.iter().filter_map(problem).collect(), Some(()))
    }
}
