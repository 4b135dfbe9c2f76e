//! Helper functions of a model in addition to `math.h`; a source contains those that it uses.

use crate::expr::Function;
use crate::program::{Op, Program};

/// -1, 0 or 1.
pub const SIGN: &str = "sign_of";
/// The smaller of two.
pub const SMALLER: &str = "smaller_of";
/// The larger of two.
pub const LARGER: &str = "larger_of";
/// A curve through points.
pub const TABLE: &str = "curve_at";
/// The helper functions that at least one of these programs uses.
pub fn used<'a>(programs: impl Iterator<Item = &'a Program> + Clone) -> String {
    let any = |is: fn(&Op) -> bool| programs.clone().any(|program| program.ops.iter().any(is));
    let parts = [
        (any(|op| matches!(op, Op::Call(Function::Sign, _))), SIGN_TEXT),
        (any(|op| matches!(op, Op::Min(..))), SMALLER_TEXT),
        (any(|op| matches!(op, Op::Max(..))), LARGER_TEXT),
        (any(|op| matches!(op, Op::Table(..))), TABLE_TEXT),
    ];
    let texts: Vec<&str> = parts.iter().filter(|(used, _)| *used).map(|(_, text)| *text).collect();
    texts.join("\n")
}

const SIGN_TEXT: &str = "/* -1, 0 or 1: at rest there is no direction. */
static double sign_of(double a)
{
    return a > 0.0 ? 1.0 : a < 0.0 ? -1.0 : a == 0.0 ? 0.0 : a;
}
";

const SMALLER_TEXT: &str = "/* The smaller of two; of a number and what is none, the number. */
static double smaller_of(double a, double b)
{
    return b < a || a != a ? b : a;
}
";

const LARGER_TEXT: &str = "/* The larger of two; of a number and what is none, the number. */
static double larger_of(double a, double b)
{
    return b > a || a != a ? b : a;
}
";

const TABLE_TEXT: &str = "/* A derivative of the piecewise cubic curve through points, of an order from 0 to 3, at x; beyond its ends it is a
 * straight line. At a knot, those above the first are of the piece above it. */
static double curve_at(int order, double x, int count, const double *knots, const double *values, const double *slopes)
{
    int above = 0, end = count;
    double t, square = 0.0, cube = 0.0;
    while (above < end) {
        const int middle = above + (end - above) / 2;
        if (knots[middle] <= x)
            above = middle + 1;
        else
            end = middle;
    }
    end = above > 0 ? above - 1 : 0;
    t = x - knots[end];
    if (above > 0 && above < count) {
        const double width = knots[above] - knots[end];
        const double secant = (values[above] - values[end]) / width;
        square = (3.0 * secant - 2.0 * slopes[end] - slopes[above]) / width;
        cube = (slopes[end] + slopes[above] - 2.0 * secant) / (width * width);
    }
    switch (order) {
    case 0: return values[end] + t * (slopes[end] + t * (square + t * cube));
    case 1: return slopes[end] + t * (2.0 * square + t * (3.0 * cube));
    case 2: return 2.0 * square + t * (6.0 * cube);
    default: return 6.0 * cube;
    }
}
";
