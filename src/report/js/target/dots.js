// Dots in a plane, with axes in the chosen units.

const PLANE = { width: 420, height: 300, left: 62, right: 14, top: 10, bottom: 42 };

// `dots` are `{at: [x, y], role, size, hollow?, said}` in SI; `axes` are `[[label, unit], [label, unit]]`.
function plane(kind, name, axes, dots, shapes = () => []) {
  const scaled = [0, 1].map((side) => dots.map((dot) => inUnit(dot.at[side], axes[side][1]).value));
  const ends = scaled.map((values) => padded(null, Math.min(...values), Math.max(...values)));
  const [left, right] = [PLANE.left, PLANE.width - PLANE.right];
  const [low, high] = [PLANE.height - PLANE.bottom, PLANE.top];
  const x = (value) => left + ((right - left) * (value - ends[0][0])) / (ends[0][1] - ends[0][0]);
  const y = (value) => low + ((high - low) * (value - ends[1][0])) / (ends[1][1] - ends[1][0]);
  const label = (at, up, text, anchor, turn) =>
    svg('text', { x: at, y: up, 'text-anchor': anchor, transform: turn }, text);
  const across = evenTicks(...ends[0], 7).map((v) => [
    svg('path', { d: `M${x(v)} ${low}V${high}`, style: 'stroke:var(--grid)' }),
    label(x(v), low + 16, plain(v), 'middle'),
  ]);
  const upward = evenTicks(...ends[1], 7).map((v) => [
    svg('path', { d: `M${left} ${y(v)}H${right}`, style: 'stroke:var(--grid)' }),
    label(left - 6, y(v) + 4, plain(v), 'end'),
  ]);
  const marks = dots.map((dot, at) =>
    svg(
      'circle',
      {
        cx: x(scaled[0][at]),
        cy: y(scaled[1][at]),
        r: dot.size,
        style: dot.hollow ? `fill:none;stroke:var(--${dot.role})` : `fill:var(--${dot.role})`,
      },
      svg('title', {}, dot.said),
    ),
  );
  const middle = (high + low) / 2;
  return captioned(
    kind,
    name,
    svg(
      'svg',
      { class: 'plane', viewBox: `0 0 ${PLANE.width} ${PLANE.height}`, role: 'img', 'aria-label': name },
      across,
      upward,
      shapes(x, y),
      marks,
      label((left + right) / 2, PLANE.height - 6, headed(...axes[0]), 'middle'),
      label(14, middle, headed(...axes[1]), 'middle', `rotate(-90 14 ${middle})`),
    ),
  );
}
