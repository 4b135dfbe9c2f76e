//! Mistakes of tables.

use super::{Code, Diagnostic};
use crate::source::Span;

/// Lists of different lengths.
pub fn lengths_differ(knots: (Span, usize), values: (Span, usize)) -> Diagnostic {
    let message = format!("a table has {} abscissae and {} ordinates", knots.1, values.1);
    Diagnostic::error(Code::TableLengthsDiffer, message)
        .label(values.0, format!("{} ordinates", values.1))
        .label(knots.0, format!("{} abscissae", knots.1))
        .hint("write one ordinate for each abscissa: `table(x, [x0, x1, …], [y0, y1, …])`")
}

/// Fewer than two points, or too many.
pub fn size(span: Span, found: usize, most: usize) -> Diagnostic {
    let points = if found == 1 { "point" } else { "points" };
    Diagnostic::error(Code::TableSize, format!("a table has {found} {points}"))
        .label(span, format!("{found} {points}"))
        .hint(format!(
            "write 2 to {most} points; of a finer measurement, leave points out where the curve is smooth"
        ))
}

/// An abscissa that is not a constant.
pub fn not_constant(span: Span) -> Diagnostic {
    Diagnostic::error(Code::TableNotConstant, "an abscissa of a table is not a constant")
        .label(span, "depends on a parameter or on the motion")
        .hint("write a number with its unit; to stretch the curve by a parameter, divide the argument: `table(v/v_ref, …)`")
}

/// Abscissae out of order.
pub fn not_increasing(span: Span, before: f64, found: f64) -> Diagnostic {
    let message = format!("the abscissae of a table do not increase: {found} follows {before}");
    Diagnostic::error(Code::TableNotIncreasing, message)
        .label(span, "not above the one before it")
        .hint("write the points in the order of increasing abscissae, and each abscissa once")
}
