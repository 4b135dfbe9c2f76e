// All elasticities: parameters down, metrics across, the stronger the darker.

const MATRIX = { left: 120, head: 120, cell: [58, 20], right: 40 };
// The elasticity of full colour, and how much colour leaves the number readable.
const FULL = 1;
const DEEPEST = 0.5;

function matrix({ metrics, parameters }) {
  if (!metrics.length || !parameters.length) return null;
  const names = byWeight(metrics, parameters);
  const [width, height] = MATRIX.cell;
  const x = (column) => MATRIX.left + width * column;
  const y = (row) => MATRIX.head + height * row;
  const heads = metrics.map((own, column) => {
    const [at, up] = [x(column) + width / 2, MATRIX.head - 8];
    return svg('text', { x: at, y: up, transform: `rotate(-40 ${at} ${up})` }, own.name);
  });
  const cell = (own, column, name, row) => {
    const value = own.elasticities[name];
    const role = value < 0 ? 'before' : 'after';
    const depth = Number.isFinite(value) ? DEEPEST * Math.min(1, Math.abs(value) / FULL) : 0;
    const text = number(value, 2);
    return svg(
      'g',
      {},
      svg('title', {}, `${own.name} by ${name}: ${text}`),
      svg('rect', {
        x: x(column) + 1,
        y: y(row) + 1,
        width: width - 2,
        height: height - 2,
        style: `fill:var(--${role});fill-opacity:${depth.toFixed(3)}`,
      }),
      svg('text', { x: x(column) + width / 2, y: y(row) + height - 6, 'text-anchor': 'middle' }, text),
    );
  };
  const body = names.map((name, row) => [
    svg('text', { x: MATRIX.left - 8, y: y(row) + height - 6, 'text-anchor': 'end' }, name),
    metrics.map((own, column) => cell(own, column, name, row)),
  ]);
  const size = [x(metrics.length) + MATRIX.right, y(names.length) + 6];
  const caption = 'Elasticities of all metrics by all parameters';
  const drawing = captioned(
    'matrix',
    caption,
    h(
      'div',
      { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': caption },
      svg(
        'svg',
        {
          class: 'matrix',
          viewBox: `0 0 ${size[0]} ${size[1]}`,
          style: `min-width:${view.printing ? 0 : Math.min(size[0], 560)}px;max-width:${size[0]}px`,
          role: 'img',
          'aria-label': `${caption}; the table below it has the numbers`,
        },
        heads,
        body,
      ),
    ),
  );
  const rows = (some) => names.map((name) => [name, ...some.map((own) => number(own.elasticities[name], 3))]);
  return drawAll(
    section(
      'matrix',
      'All elasticities',
      h(
        'p',
        {},
        'Percent of a metric per percent of a parameter: ',
        key('after', 'both grow', true),
        ', or ',
        key('before', 'one grows as the other falls', true),
        '. Full colour is one percent per percent, or more.',
      ),
      drawing,
      details('Elasticities as a table', metricTables('Elasticities', metrics, (own) => own.name, rows)),
    ),
  );
}
