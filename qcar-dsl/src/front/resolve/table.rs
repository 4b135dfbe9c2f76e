//! Tables: curves through points, their units checked.

use super::value::{Locals, Value};
use super::{Known, Resolver};
use crate::diagnostic::{tables, units as mistakes};
use crate::expr::{Curve, Expr};
use crate::front::syntax::{List, Table};
use crate::source::Span;
use crate::units::Unit;

/// More points than a measured curve has, or a reader can follow.
const MOST: usize = 64;

impl Resolver<'_> {
    /// The ordinate of a curve; through two points it is a straight line.
    pub fn table(&mut self, table: &Table, locals: &Locals) -> Known<Value> {
        let x = self.value(&table.x, locals);
        let (knots, values) = (self.entries(&table.knots, locals), self.entries(&table.values, locals));
        let (x, knots, values) = (x?, knots?, values?);
        self.points_agree(table)?;
        let (argument, first) = ((table.x.span, x.unit), (table.values.entries[0].span, values[0].unit));
        let of_knots = self.agree_with(
            argument,
            &table.knots,
            &knots,
            "the argument and the abscissae of a table are",
        );
        let unit = self.agree_with(first, &table.values, &values, "the ordinates of a table are")?;
        of_knots?;
        let knots = self.increasing(&table.knots, &knots)?;
        let graph = &mut self.model.graph;
        let values: Vec<Expr> = values.iter().map(|value| value.expr).collect();
        let curve = Curve::monotone(graph, &knots, values);
        let expr = match (knots.as_slice(), curve.slopes.as_slice()) {
            (&[start, _], &[slope, _]) => {
                let start = graph.constant(start);
                graph.of(curve.values[0] + slope * (x.expr - start))
            }
            _ => graph.table(0, x.expr, curve),
        };
        Ok(Value { expr, unit })
    }

    fn entries(&mut self, list: &List, locals: &Locals) -> Known<Vec<Value>> {
        let entries: Vec<Known<Value>> = list.entries.iter().map(|entry| self.value(entry, locals)).collect();
        entries.into_iter().collect()
    }

    /// As many abscissae as ordinates, and neither too few nor too many.
    fn points_agree(&mut self, table: &Table) -> Known<()> {
        let (knots, values) = (table.knots.entries.len(), table.values.entries.len());
        if knots != values {
            let mistake = tables::lengths_differ((table.knots.span, knots), (table.values.span, values));
            return Err(self.report(mistake));
        }
        if !(2..=MOST).contains(&knots) {
            return Err(self.report(tables::size(table.knots.span, knots, MOST)));
        }
        Ok(())
    }

    /// The unit of something and of all entries of a list; literal zeros fit to any.
    fn agree_with(
        &mut self,
        first: (Span, Option<Unit>),
        list: &List,
        values: &[Value],
        what: &str,
    ) -> Known<Option<Unit>> {
        let (mut known, mut agrees) = (first, Ok(()));
        for (entry, value) in list.entries.iter().zip(values) {
            known = match (known, value.unit) {
                ((_, None), unit) => (entry.span, unit),
                ((span, Some(one)), Some(other)) if one != other => {
                    let sides = ((span, one.to_string()), (entry.span, other.to_string()));
                    agrees = Err(self.report(mistakes::units_differ(sides.0, sides.1, what)));
                    (span, Some(one))
                }
                (known, _) => known,
            };
        }
        agrees.map(|()| known.1)
    }

    /// The abscissae as numbers.
    fn increasing(&mut self, list: &List, values: &[Value]) -> Known<Vec<f64>> {
        let mut knots: Vec<f64> = Vec::new();
        for (entry, value) in list.entries.iter().zip(values) {
            let Some(knot) = self.model.graph.as_constant(value.expr) else {
                return Err(self.report(tables::not_constant(entry.span)));
            };
            if let Some(&before) = knots.last()
                && knot <= before
            {
                return Err(self.report(tables::not_increasing(entry.span, before, knot)));
            }
            knots.push(knot);
        }
        Ok(knots)
    }
}
