// Sobol indices: the share of the variance due to a parameter, alone and together with others.

const SOBOL_BARS = 10;

function sobol({ metrics, parameters, global }) {
  if (!global) return null;
  const indexed = metrics.filter((own) => own.sobol);
  const one = (own) => {
    const totals = Object.entries(own.sobol).map(([name, index]) => [name, index.total]);
    const rows = largest(totals, SOBOL_BARS).map(([name, total]) => ({
      name,
      value: 100 * total,
      inner: 100 * own.sobol[name].first,
      interval: own.sobol[name].total_interval.map((end) => 100 * end),
      said: share(total),
      role: 'after',
    }));
    return bars('sobol', own.name, rows, '% of the variance');
  };
  const columns = [
    ['parameter', 'text'],
    ['alone', 'number'],
    ['95 %', 'text'],
    ['with others', 'number'],
    ['95 %', 'text'],
  ];
  const cells = ({ first, first_interval: alone, total, total_interval: together }) => {
    const span = (ends) => ends.map(share).join(' … ');
    return [share(first), span(alone), share(total), span(together)];
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
        `Shares of the variance for parameters that are uniform within ±${percent(global.spread, 3)} of their values, from ${global.designs} designs. The whole bar is the share of a parameter with others, its `,
        key('after', 'solid part', true),
        ` that of the parameter alone. The line is the 95 % confidence interval of the former.${failed}`,
      ),
      h('div', { class: 'columns two' }, indexed.map(one)),
      parameters.length ? details('Indices as tables', tables) : null,
    ),
  );
}
