// The uncertainty of each metric, and the parameters that cause it.

const UNCERTAINTY_BARS = 8;

function uncertaintySection({ metrics }) {
  const uncertain = metrics.filter((own) => own.uncertainty && own.uncertainty.deviation > 0);
  if (!uncertain.length) return null;
  const columns = [
    ['metric', 'text'],
    ['value', 'number'],
    ['standard deviation', 'number'],
    ['95 % interval', 'text'],
    ...Object.keys(uncertain[0].uncertainty.sources).map((source) => [`by ${words(source)}`, 'number']),
  ];
  const rows = uncertain.map((own) => [
    own.name,
    quantity(own.value, own.unit),
    quantity(own.uncertainty.deviation, own.unit, 2),
    own.uncertainty.interval.map((end) => quantity(end, own.unit)).join(' … '),
    ...Object.values(own.uncertainty.sources).map(share),
  ]);
  const one = (own) => {
    const bar = ([name, part]) => ({ name, value: 100 * part, said: share(part), role: part < 0 ? 'before' : 'after' });
    const rows = largest(Object.entries(own.uncertainty.shares), UNCERTAINTY_BARS).map(bar);
    return bars('shares', own.name, rows, '% of the variance');
  };
  return drawAll(
    section(
      'uncertainty',
      'Uncertainty',
      h(
        'p',
        {},
        'Errors of the fit, tolerances and the temperature, to first order. A negative share is that of an error that compensates another with which it is correlated.',
      ),
      table('Uncertainty of the metrics', columns, rows),
      h('div', { class: 'columns two' }, uncertain.map(one)),
    ),
  );
}
