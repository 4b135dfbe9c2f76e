// Sobol indices: the share of the variance that is a parameter's, alone and with others.

const SOBOL_BARS = 10;

function sobol({ metrics, parameters, global }) {
  if (!global) return null;
  const indexed = metrics.filter((own) => own.sobol);
  const one = (own) => {
    const sorted = Object.entries(own.sobol).sort((a, b) => b[1].total - a[1].total);
    const hundred = (values) => values.map((value) => 100 * value);
    const rows = sorted.slice(0, SOBOL_BARS).map(([name, index]) => ({
      name,
      value: 100 * index.total,
      inner: 100 * index.first,
      interval: hundred(index.total_interval),
      said: percent(index.total),
      role: 'after',
    }));
    return bars('sobol', own.name, rows, '% of the variance');
  };
  const columns = [
    ['parameter', 'text'],
    ['alone, %', 'number'],
    ['95 %', 'text'],
    ['with others, %', 'number'],
    ['95 %', 'text'],
  ];
  const cells = ({ first, first_interval: alone, total, total_interval: together }) => {
    const share = (value) => number(100 * value, 2);
    return [share(first), alone.map(share).join(' … '), share(total), together.map(share).join(' … ')];
  };
  const tables = indexed.map((own) =>
    table(
      `Sobol indices of ${own.name}`,
      columns,
      Object.entries(own.sobol).map(([name, index]) => [name, ...cells(index)]),
    ),
  );
  const failed = global.failed ? ` ${global.failed} of the base designs could not be simulated and are left out.` : '';
  return drawAll(
    section(
      'sobol',
      'Sobol indices',
      h(
        'p',
        {},
        `Each parameter is uniform within ±${percent(global.spread, 3)} of its value, ${global.designs} designs. A bar is the share of the variance in which the parameter takes part with others, its `,
        key('after', 'solid part', true),
        ` the share that is its alone; the line is the 95 % confidence interval of the former.${failed}`,
      ),
      h('div', { class: 'columns two' }, indexed.map(one)),
      parameters.length ? details('Indices as tables', tables) : null,
    ),
  );
}
