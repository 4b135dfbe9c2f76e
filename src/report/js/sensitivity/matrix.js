// All elasticities: a row for each parameter, a column for each metric; darker means larger.

const MATRIX = { left: 120, head: 112, cell: [50, 20], right: 70, most: 16 };
// The elasticity with full colour, and the most colour that leaves the number readable.
const FULL = 1;
const DEEPEST = 0.5;

function matrix({ metrics, parameters }) {
  if (!metrics.length || !parameters.length) return null;
  const names = byWeight(metrics, parameters);
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
      parted('Elasticities', metrics, MATRIX.most).map(([name, part]) => cells(name, part, names)),
      details('Elasticities as a table', metricTables('Elasticities', metrics, (own) => own.name, rows)),
    ),
  );
}

function cells(caption, metrics, names) {
  const [width, height] = MATRIX.cell;
  const left = roomFor(names, MATRIX.left);
  const x = (column) => left + width * column;
  const y = (row) => MATRIX.head + height * row;
  const head = (own, column) => {
    const [at, up] = [x(column) + width / 2, MATRIX.head - 8];
    return svg('text', { x: at, y: up, transform: `rotate(-40 ${at} ${up})` }, own.name);
  };
  const row = (name, at) => [
    svg('text', { x: left - 8, y: y(at) + height - 6, 'text-anchor': 'end' }, brief(name)),
    metrics.map((own, column) => cell(own.elasticities[name], x(column), y(at), `${own.name} by ${name}`)),
  ];
  const size = [x(metrics.length) + MATRIX.right, y(names.length) + 6];
  const least = view.printing ? 0 : Math.min(size[0], 560);
  const drawing = svg(
    'svg',
    {
      class: 'matrix',
      viewBox: `0 0 ${size[0]} ${size[1]}`,
      style: `min-width:${least}px;max-width:${size[0]}px`,
      role: 'img',
      'aria-label': `${caption}; the table below has the numbers`,
    },
    metrics.map(head),
    names.map(row),
  );
  return captioned(
    'matrix',
    caption,
    h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': caption }, drawing),
  );
}

function cell(value, x, y, what) {
  const [width, height] = MATRIX.cell;
  const isKnown = Number.isFinite(value);
  const depth = isKnown ? DEEPEST * Math.min(1, Math.abs(value) / FULL) : 0;
  const text = isKnown ? minus((Math.round(100 * value) / 100 || 0).toFixed(2)) : '–';
  return svg(
    'g',
    {},
    svg('title', {}, `${what}: ${number(value, 3)}`),
    svg('rect', {
      x: x + 1,
      y: y + 1,
      width: width - 2,
      height: height - 2,
      style: `fill:var(--${value < 0 ? 'before' : 'after'});fill-opacity:${depth.toFixed(3)}`,
    }),
    svg('text', { x: x + width / 2, y: y + height - 6, 'text-anchor': 'middle' }, text),
  );
}
