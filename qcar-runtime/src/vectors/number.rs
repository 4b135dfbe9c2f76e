//! What straight-line code uses of a single number, beside Rust's own functions.

/// -1, 0 or 1: at rest there is no direction.
#[inline]
pub fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

/// A derivative of the piecewise cubic curve through points, of an order from 0 to 3, at `x`; beyond its ends it is a
/// straight line. At a knot, those above the first are of the piece above it.
pub fn table<const N: usize>(order: u8, x: f64, knots: &[f64; N], values: &[f64; N], slopes: &[f64; N]) -> f64 {
    let right = knots.partition_point(|&knot| knot <= x);
    let left = right.saturating_sub(1);
    let t = x - knots[left];
    let (mut square, mut cube) = (0.0, 0.0);
    if right > 0 && right < N {
        let width = knots[right] - knots[left];
        let secant = (values[right] - values[left]) / width;
        square = (3.0 * secant - 2.0 * slopes[left] - slopes[right]) / width;
        cube = (slopes[left] + slopes[right] - 2.0 * secant) / (width * width);
    }
    match order {
        0 => values[left] + t * (slopes[left] + t * (square + t * cube)),
        1 => slopes[left] + t * (2.0 * square + t * (3.0 * cube)),
        2 => 2.0 * square + t * (6.0 * cube),
        _ => 6.0 * cube,
    }
}
