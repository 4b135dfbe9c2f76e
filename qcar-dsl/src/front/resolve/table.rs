//! Tables: curves through points, their units checked.

use super::value::{Locals, Value};
use super::{Resolved, Resolver};
use crate::diagnostic::{tables, units as mistakes};
use crate::expr::{Curve, Expr};
use crate::front::syntax::{List, Table};
use crate::source::Span;
use crate::units::Unit;

/// Largest number of points: measured curves have fewer, and a reader could not follow more.
const MOST: usize = 64;

impl Resolver<'_> {
    /// The ordinate of a curve. A curve through two points is a straight line.
    pub fn table(&mut self, table: &Table, locals: &Locals) -> Resolved<Value> {
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

    fn entries(&mut self, list: &List, locals: &Locals) -> Resolved<Vec<Value>> {
        let entries: Vec<Resolved<Value>> = list.entries.iter().map(|entry| self.value(entry, locals)).collect();
        entries.into_iter().collect()
    }

    /// Checks that there are as many abscissae as ordinates, and that their number is allowed.
    fn points_agree(&mut self, table: &Table) -> Resolved<()> {
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

    /// The common unit of a value and of all entries of a list; a literal zero fits any unit.
    fn agree_with(
        &mut self,
        first: (Span, Option<Unit>),
        list: &List,
        values: &[Value],
        what: &str,
    ) -> Resolved<Option<Unit>> {
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
    fn increasing(&mut self, list: &List, values: &[Value]) -> Resolved<Vec<f64>> {
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
