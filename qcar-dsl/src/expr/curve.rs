//! Curves through points: monotone cubic interpolation, and linear extrapolation with the slopes of the ends.
//!
//! Fritsch, F. N., Carlson, R. E.: Monotone piecewise cubic interpolation, SIAM J. Numerical Analysis 17, 1980; slopes
//! by Fritsch, F. N., Butland, J.: A method for constructing local monotone piecewise cubic interpolants, SIAM J.
//! Scientific and Statistical Computing 5, 1984, and at the ends as in Moler, C.: Numerical computing with MATLAB,
//! section 3.6, 2004.

use super::{Expr, Graph};

/// Points with the slopes there. `T` is the type of a value: an expression, or the position where a program stores it.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub struct Curve<T> {
    /// The abscissae by their bits, so that they can be hashed; strictly increasing, two at least.
    knots: Vec<u64>,
    /// The ordinates.
    pub values: Vec<T>,
    /// dy/dx at the points.
    pub slopes: Vec<T>,
    /// True if the slopes follow from the ordinates, false for a derivative of such a curve.
    pub monotone: bool,
}

impl<T> Curve<T> {
    /// The abscissae.
    pub fn knots(&self) -> impl Iterator<Item = f64> {
        self.knots.iter().map(|&bits| f64::from_bits(bits))
    }

    /// Ordinates, then slopes.
    pub fn entries(&self) -> impl Iterator<Item = &T> {
        self.values.iter().chain(&self.slopes)
    }

    /// The same curve with other entries.
    pub fn map<U>(&self, mut f: impl FnMut(&T) -> U) -> Curve<U> {
        Curve {
            knots: self.knots.clone(),
            values: self.values.iter().map(&mut f).collect(),
            slopes: self.slopes.iter().map(&mut f).collect(),
            monotone: self.monotone,
        }
    }

    /// The derivative at `x`, of an order from 0 to 3. At a knot, derivatives above the first are those of the piece
    /// above it.
    pub fn at(&self, order: u8, x: f64, number: impl Fn(&T) -> f64) -> f64 {
        let knot = |place: usize| f64::from_bits(self.knots[place]);
        let (value, slope) = (|place| number(&self.values[place]), |place| number(&self.slopes[place]));
        let above = self.knots.partition_point(|&bits| f64::from_bits(bits) <= x);
        let left = above.saturating_sub(1);
        let t = x - knot(left);
        let [mut square, mut cube] = [0.0; 2];
        if above > 0 && above < self.knots.len() {
            let width = knot(above) - knot(left);
            let secant = (value(above) - value(left)) / width;
            square = (3.0 * secant - 2.0 * slope(left) - slope(above)) / width;
            cube = (slope(left) + slope(above) - 2.0 * secant) / (width * width);
        }
        match order {
            0 => value(left) + t * (slope(left) + t * (square + t * cube)),
            1 => slope(left) + t * (2.0 * square + t * (3.0 * cube)),
            2 => 2.0 * square + t * (6.0 * cube),
            _ => 6.0 * cube,
        }
    }
}

impl Curve<Expr> {
    /// The monotone curve through points; the abscissae increase strictly.
    pub fn monotone(g: &mut Graph, knots: &[f64], values: Vec<Expr>) -> Self {
        let widths: Vec<f64> = knots.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let rises = values.windows(2).zip(&widths).map(|(pair, &width)| {
            let rise = g.of(pair[1] - pair[0]);
            g.of(1.0 / width * rise)
        });
        let pieces: Vec<Piece> = rises
            .collect::<Vec<_>>()
            .into_iter()
            .zip(widths)
            .map(Piece::of)
            .collect();
        Curve {
            knots: knots.iter().map(|knot| knot.to_bits()).collect(),
            slopes: slopes(g, &pieces),
            values,
            monotone: true,
        }
    }
}

/// The interval between two points.
#[derive(Clone, Copy)]
struct Piece {
    secant: Expr,
    width: f64,
}

impl Piece {
    fn of((secant, width): (Expr, f64)) -> Piece {
        Piece { secant, width }
    }
}

/// The slope at each point.
fn slopes(g: &mut Graph, pieces: &[Piece]) -> Vec<Expr> {
    let &[first, .., last] = pieces else {
        return vec![pieces[0].secant; 2];
    };
    let (second, second_last) = (pieces[1], pieces[pieces.len() - 2]);
    let mut slopes = vec![end_slope(g, first, second)];
    slopes.extend(pieces.windows(2).map(|pair| inner_slope(g, pair[0], pair[1])));
    slopes.push(end_slope(g, last, second_last));
    slopes
}

/// The weighted harmonic mean of the secants on both sides; 0 if their signs differ.
fn inner_slope(g: &mut Graph, before: Piece, after: Piece) -> Expr {
    let (of_before, of_after) = (before.width + 2.0 * after.width, 2.0 * before.width + after.width);
    let product = g.of(before.secant * after.secant);
    let (left, right) = (g.of(of_after * before.secant), g.of(of_before * after.secant));
    let mean = g.of((of_before + of_after) * product / (left + right));
    let zero = g.constant(0.0);
    g.select(product, mean, zero)
}

/// The slope of the parabola through the last three points: 0 if the last secant has another sign, and at most three
/// times this secant if the next one has another sign.
fn end_slope(g: &mut Graph, own: Piece, next: Piece) -> Expr {
    let share = own.width / (own.width + next.width);
    let parabola = g.of((1.0 + share) * own.secant - share * next.secant);
    let steepest = g.of(3.0 * own.secant);
    let rises = g.of(parabola * own.secant);
    let excess = g.of(rises - steepest * own.secant);
    let same_way = g.of(own.secant * next.secant);
    let zero = g.constant(0.0);
    let held = g.select(excess, steepest, parabola);
    let slope = g.select(same_way, parabola, held);
    g.select(rises, slope, zero)
}
