//! From expressions of the tree to expressions of the graph, with their units.

use super::{Reported, Resolved, Resolver};
use crate::diagnostic::{names, units as mistakes};
use crate::expr::{Expr, Function};
use crate::front::parse::FUNCTIONS;
use crate::front::syntax::{Comparison, Expression, ExpressionKind, Logic, Name, Operator, Order};
use crate::source::Span;
use crate::units::Unit;

/// An expression with its unit. A literal zero has none, since it is zero in any unit.
#[derive(Clone, Copy, Debug)]
pub struct Value {
    /// The expression in the graph of the model.
    pub expr: Expr,
    /// `None` for a literal zero.
    pub unit: Option<Unit>,
}

impl Value {
    /// The unit in words.
    pub fn unit_text(&self) -> String {
        self.unit.unwrap_or(Unit::ONE).to_string()
    }

    fn is_plain(&self) -> bool {
        self.unit.is_none_or(|unit| unit == Unit::ONE)
    }
}

/// Local names that an expression can use in addition to those of the model.
#[derive(Clone, Debug, Default)]
pub struct Locals {
    /// Names with their values; the last entry of a name counts. `None` if the declaration of a name has a mistake.
    pub names: Vec<(String, Option<Value>)>,
    /// True if the names of the model cannot be used, as in an element.
    pub closed: bool,
    /// The direction whose force inputs can be used, as in the law of a link.
    pub home: Option<String>,
}

impl Locals {
    /// A name with its value.
    pub fn add(&mut self, name: &str, value: Resolved<Value>) {
        self.names.push((name.to_string(), value.ok()));
    }

    /// The value of a name, if there is such a name.
    pub fn get(&self, name: &str) -> Option<Resolved<Value>> {
        let (_, value) = self.names.iter().rev().find(|(known, _)| known == name)?;
        Some(value.ok_or(Reported))
    }
}

impl Resolver<'_> {
    /// An expression that must be in a unit; `what` is its subject in the message.
    pub fn value_in(&mut self, expression: &Expression, locals: &Locals, unit: Unit, what: &str) -> Resolved<Expr> {
        let value = self.value(expression, locals)?;
        self.require_unit(value, expression.span, unit, what)?;
        Ok(value.expr)
    }

    /// A value must be in a unit.
    pub fn require_unit(&mut self, value: Value, span: Span, unit: Unit, what: &str) -> Resolved<()> {
        if value.unit.is_none_or(|own| own == unit) {
            return Ok(());
        }
        Err(self.report(mistakes::wrong_unit(span, what, &unit.to_string(), &value.unit_text())))
    }

    /// The value of an expression in any unit. Its constant parts must be finite.
    pub fn value(&mut self, expression: &Expression, locals: &Locals) -> Resolved<Value> {
        let value = self.any_value(expression, locals)?;
        match self.model.graph.as_constant(value.expr) {
            Some(constant) if !constant.is_finite() => {
                Err(self.report(mistakes::not_finite(expression.span, constant)))
            }
            _ => Ok(value),
        }
    }

    fn any_value(&mut self, expression: &Expression, locals: &Locals) -> Resolved<Value> {
        match &expression.kind {
            ExpressionKind::Number(number) => {
                let (value, unit) = self.number(number)?;
                let unit = if value == 0.0 && unit.is_none() {
                    None
                } else {
                    Some(unit.unwrap_or(Unit::ONE))
                };
                Ok(Value {
                    expr: self.model.graph.constant(value),
                    unit,
                })
            }
            ExpressionKind::Name(name) => self.named(name, locals),
            ExpressionKind::Negative(operand) => {
                let Value { expr, unit } = self.value(operand, locals)?;
                Ok(Value {
                    expr: self.model.graph.neg(expr),
                    unit,
                })
            }
            ExpressionKind::Binary(operator, left, right) => self.binary(*operator, left, right, locals),
            ExpressionKind::Call(function, arguments) => self.call(function, arguments, locals),
            ExpressionKind::Table(table) => self.table(table, locals),
            ExpressionKind::If(condition, then, otherwise) => self.branches(condition, then, otherwise, locals),
        }
    }

    fn branches(
        &mut self,
        condition: &Logic<Comparison>,
        then: &Expression,
        otherwise: &Expression,
        locals: &Locals,
    ) -> Resolved<Value> {
        let (a, b) = (self.value(then, locals), self.value(otherwise, locals));
        let (a, b) = (a?, b?);
        let unit = self.agree(a, then.span, b, otherwise.span, "the branches of an `if` are")?;
        Ok(Value {
            expr: self.choose(condition, a.expr, b.expr, locals)?,
            unit,
        })
    }

    fn binary(
        &mut self,
        operator: Operator,
        left: &Expression,
        right: &Expression,
        locals: &Locals,
    ) -> Resolved<Value> {
        let (a, b) = (self.value(left, locals), self.value(right, locals));
        let (a, b) = (a?, b?);
        let graph = &mut self.model.graph;
        match operator {
            Operator::Add => {
                let expr = graph.add(a.expr, b.expr);
                Ok(Value {
                    expr,
                    unit: self.agree(a, left.span, b, right.span, "the sum is")?,
                })
            }
            Operator::Subtract => {
                let expr = graph.sub(a.expr, b.expr);
                Ok(Value {
                    expr,
                    unit: self.agree(a, left.span, b, right.span, "the difference is")?,
                })
            }
            Operator::Multiply => {
                let unit = a.unit.zip(b.unit).map(|(a, b)| a.times(b));
                Ok(Value {
                    expr: graph.mul(a.expr, b.expr),
                    unit,
                })
            }
            Operator::Divide if graph.as_constant(b.expr) == Some(0.0) => {
                Err(self.report(mistakes::division_by_zero(right.span)))
            }
            Operator::Divide => {
                let unit = a.unit.map(|above| above.per(b.unit.unwrap_or(Unit::ONE)));
                Ok(Value {
                    expr: graph.div(a.expr, b.expr),
                    unit,
                })
            }
            Operator::Power => self.power(a, left.span, b, right.span),
        }
    }

    fn power(&mut self, base: Value, base_span: Span, exponent: Value, span: Span) -> Resolved<Value> {
        self.require_unit(exponent, span, Unit::ONE, "an exponent")?;
        let constant = self.model.graph.as_constant(exponent.expr);
        let unit = match (base.unit, constant) {
            (None | Some(Unit::ONE), _) => base.unit,
            (Some(unit), None) => return Err(self.report(mistakes::exponent_not_constant(span, &unit.to_string()))),
            (Some(unit), Some(exponent)) => match unit.power(exponent) {
                Some(raised) => Some(raised),
                None => return Err(self.report(mistakes::odd_exponent(base_span.join(span), "this power"))),
            },
        };
        let graph = &mut self.model.graph;
        let expr = match constant {
            Some(0.5) => graph.call(Function::Sqrt, base.expr),
            _ => graph.pow(base.expr, exponent.expr),
        };
        Ok(Value { expr, unit })
    }

    /// The common unit of two values; a literal zero fits any unit.
    pub fn agree(&mut self, a: Value, a_span: Span, b: Value, b_span: Span, what: &str) -> Resolved<Option<Unit>> {
        match (a.unit, b.unit) {
            (Some(left), Some(right)) if left != right => {
                let sides = ((a_span, left.to_string()), (b_span, right.to_string()));
                Err(self.report(mistakes::units_differ(sides.0, sides.1, what)))
            }
            (left, right) => Ok(left.or(right)),
        }
    }

    fn call(&mut self, function: &Name, arguments: &[Expression], locals: &Locals) -> Resolved<Value> {
        let values: Vec<Resolved<Value>> = arguments.iter().map(|argument| self.value(argument, locals)).collect();
        let expected: &[&str] = match function.text.as_str() {
            "min" | "max" => &["a", "b"],
            "pow" => &["base", "exponent"],
            name if FUNCTIONS.contains(&name) => &["x"],
            name => return Err(self.report(names::unknown_function(function.span, name, &FUNCTIONS))),
        };
        if values.len() != expected.len() {
            let expected: Vec<String> = expected.iter().map(ToString::to_string).collect();
            let mistake = names::wrong_arguments(function.span, &function.text, &expected, values.len());
            return Err(self.report(mistake));
        }
        let values = values.into_iter().collect::<Resolved<Vec<Value>>>()?;
        let spans: Vec<Span> = arguments.iter().map(|argument| argument.span).collect();
        match *values.as_slice() {
            [a, b] => self.call_of_two(&function.text, (a, spans[0]), (b, spans[1])),
            _ => self.call_of_one(&function.text, values[0], spans[0]),
        }
    }

    fn call_of_two(&mut self, function: &str, a: (Value, Span), b: (Value, Span)) -> Resolved<Value> {
        if function == "pow" {
            return self.power(a.0, a.1, b.0, b.1);
        }
        let unit = self.agree(a.0, a.1, b.0, b.1, &format!("the arguments of `{function}` are"))?;
        let graph = &mut self.model.graph;
        let (a, b) = (a.0.expr, b.0.expr);
        let expr = if function == "min" {
            graph.min(a, b)
        } else {
            graph.max(a, b)
        };
        Ok(Value { expr, unit })
    }

    fn call_of_one(&mut self, name: &str, argument: Value, span: Span) -> Resolved<Value> {
        let (function, unit) = match name {
            "abs" => (Function::Abs, argument.unit),
            "sign" => (Function::Sign, Some(Unit::ONE)),
            "sqrt" => match argument.unit.map(|unit| unit.power(0.5)) {
                Some(None) => return Err(self.report(mistakes::odd_exponent(span, "this root"))),
                Some(root) => (Function::Sqrt, root),
                None => (Function::Sqrt, None),
            },
            _ if !argument.is_plain() => {
                return Err(self.report(mistakes::argument_has_unit(span, name, &argument.unit_text())));
            }
            "exp" => (Function::Exp, Some(Unit::ONE)),
            "ln" => (Function::Ln, Some(Unit::ONE)),
            "sin" => (Function::Sin, Some(Unit::ONE)),
            "cos" => (Function::Cos, Some(Unit::ONE)),
            "tan" => (Function::Tan, Some(Unit::ONE)),
            "atan" => (Function::Atan, Some(Unit::ONE)),
            _ => (Function::Tanh, Some(Unit::ONE)),
        };
        Ok(Value {
            expr: self.model.graph.call(function, argument.expr),
            unit,
        })
    }

    /// `then` if the condition holds, else `otherwise`.
    fn choose(
        &mut self,
        condition: &Logic<Comparison>,
        then: Expr,
        otherwise: Expr,
        locals: &Locals,
    ) -> Resolved<Expr> {
        match condition {
            Logic::Test(test) => self.compare(test, then, otherwise, locals),
            Logic::Not(part) => self.choose(part, otherwise, then, locals),
            Logic::And(a, b) => {
                let inner = self.choose(b, then, otherwise, locals)?;
                self.choose(a, inner, otherwise, locals)
            }
            Logic::Or(a, b) => {
                let inner = self.choose(b, then, otherwise, locals)?;
                self.choose(a, then, inner, locals)
            }
        }
    }

    fn compare(&mut self, test: &Comparison, then: Expr, otherwise: Expr, locals: &Locals) -> Resolved<Expr> {
        let (left, right) = (self.value(&test.left, locals), self.value(&test.right, locals));
        let (left, right) = (left?, right?);
        self.agree(
            left,
            test.left.span,
            right,
            test.right.span,
            "the sides of a comparison are",
        )?;
        let graph = &mut self.model.graph;
        let less = graph.sub(right.expr, left.expr);
        let greater = graph.sub(left.expr, right.expr);
        Ok(match test.order {
            Order::Less => graph.select(less, then, otherwise),
            Order::Greater => graph.select(greater, then, otherwise),
            Order::LessEqual => graph.select(greater, otherwise, then),
            Order::GreaterEqual => graph.select(less, otherwise, then),
        })
    }
}
