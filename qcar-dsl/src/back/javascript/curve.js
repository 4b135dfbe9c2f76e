// A derivative of the piecewise cubic curve through points, of an order from 0 to 3, at x; beyond its ends it is a straight
// line. At a knot, those above the first are of the piece above it.
function curve_at(order, x, knots, values, slopes) {
  const above = knots.filter((knot) => knot <= x).length;
  const left = Math.max(above, 1) - 1;
  const t = x - knots[left];
  let [square, cube] = [0, 0];
  if (above > 0 && above < knots.length) {
    const width = knots[above] - knots[left];
    const secant = (values[above] - values[left]) / width;
    square = (3 * secant - 2 * slopes[left] - slopes[above]) / width;
    cube = (slopes[left] + slopes[above] - 2 * secant) / (width * width);
  }
  return [
    values[left] + t * (slopes[left] + t * (square + t * cube)),
    slopes[left] + t * (2 * square + t * (3 * cube)),
    2 * square + t * (6 * cube),
    6 * cube,
  ][order];
}
