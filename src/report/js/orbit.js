// A quantity over another one that moves back and forth, such as a force over the travel that causes it.

// `curves` are `{role, values}` over the values `at` of x.
function orbit(place, asked) {
  const own = inChosenUnits({ height: 300, gaps: true, ...asked });
  const [width, height] = [Math.max(200, place.clientWidth), view.printing ? 150 : 260];
  const y = upY(own, height);
  const range = () => padded(null, Math.min(...own.at), Math.max(...own.at));
  const x = alongX({ x: { ...own.x, range } }, leftOf(y, view.printing ? 5 : 6.5), width);
  const name = place.closest('figure').getAttribute('aria-label');
  place.replaceChildren(
    svg(
      'svg',
      {
        class: view.printing ? 'sketch' : 'sketch orbit',
        viewBox: `0 0 ${width} ${height}`,
        width,
        height,
        role: 'img',
        'aria-label': name,
      },
      frame(own, x, y, width, height),
      own.curves.map((curve) => curveShape(own, curve, x, y)),
    ),
    h(
      'p',
      { class: 'legend' },
      own.curves.map((curve) => [h('span', {}, sample(curve.role), curve.label), ' ']),
    ),
  );
  if (!view.printing) place.before(exports(name, () => curveRows(own, own.curves)));
  drawn(place);
}
