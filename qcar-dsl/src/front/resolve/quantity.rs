//! From units and numbers as written to values in SI.

use super::{Resolved, Resolver};
use crate::diagnostic::reading::number_too_large;
use crate::diagnostic::units as mistakes;
use crate::front::syntax::{Number, UnitText};
use crate::source::Span;
use crate::units::{Symbol, Unit, symbol};

impl Resolver<'_> {
    /// The size in SI and the coherent unit of a unit as written.
    pub fn unit(&mut self, text: &UnitText) -> Resolved<Symbol> {
        let mut whole = Symbol {
            multiply: 1.0,
            divide: 1.0,
            unit: Unit::ONE,
        };
        for factor in &text.factors {
            let Some(known) = symbol(&factor.symbol.text) else {
                return Err(self.report(mistakes::unknown_unit(factor.symbol.span, &factor.symbol.text)));
            };
            let exponent = f64::from(factor.numerator) / f64::from(factor.denominator);
            let Some(unit) = known.unit.power(exponent) else {
                return Err(self.report(mistakes::odd_exponent(factor.symbol.span, &format!("`{text}`"))));
            };
            let size = exponent.abs();
            let (above, below) = (known.multiply.powf(size), known.divide.powf(size));
            let (above, below) = if exponent > 0.0 { (above, below) } else { (below, above) };
            whole.multiply *= above;
            whole.divide *= below;
            whole.unit = whole.unit.times(unit);
        }
        Ok(whole)
    }

    /// The unit of a declaration, which must be coherent; `example` writes the declaration in another unit.
    pub fn coherent(&mut self, text: &UnitText, span: Span, example: impl Fn(&str) -> String) -> Resolved<Unit> {
        let symbol = self.unit(text)?;
        if symbol.multiply != symbol.divide {
            let is_angle = text.factors.iter().any(|factor| factor.symbol.text == "deg");
            let coherent = if is_angle {
                "rad".to_string()
            } else {
                symbol.unit.to_string()
            };
            let mistake = mistakes::not_coherent(span, &text.to_string(), &coherent, &example(&coherent));
            return Err(self.report(mistake));
        }
        Ok(symbol.unit)
    }

    /// A number in SI, with its unit; `None` for a plain number.
    pub fn number(&mut self, number: &Number) -> Resolved<(f64, Option<Unit>)> {
        let symbol = self.unit(&number.unit)?;
        let value = number.value * symbol.multiply / symbol.divide;
        if !value.is_finite() {
            return Err(self.report(number_too_large(number.span)));
        }
        Ok((value, (!number.unit.factors.is_empty()).then_some(symbol.unit)))
    }

    /// A number that belongs to a declaration: a plain one is in the declared unit.
    pub fn number_in(&mut self, number: &Number, unit: Unit, what: &str) -> Resolved<f64> {
        match self.number(number)? {
            (value, None) => Ok(value),
            (value, Some(own)) if own == unit => Ok(value),
            (_, Some(own)) => {
                let mistake = mistakes::wrong_unit(number.span, what, &unit.to_string(), &own.to_string());
                Err(self.report(mistake))
            }
        }
    }
}
