// How sure each metric is, and which parameters its uncertainty comes from.

const DOUBT_BARS = 8;
// Smaller shares are not drawn.
const SMALLEST_SHARE = 0.005;

function doubt({ metrics }) {
  const doubted = metrics.filter((own) => own.doubt && own.doubt.deviation > 0);
  if (!doubted.length) return null;
  const columns = [
    ['metric', 'text'],
    ['value', 'number'],
    ['standard deviation', 'number'],
    ['95 % interval', 'text'],
    ...Object.keys(doubted[0].doubt.sources).map((source) => [`by ${words(source)}`, 'number']),
  ];
  const rows = doubted.map((own) => [
    own.name,
    quantity(own.value, own.unit),
    quantity(own.doubt.deviation, own.unit, 2),
    own.doubt.interval.map((end) => quantity(end, own.unit)).join(' … '),
    ...Object.values(own.doubt.sources).map((share) => percent(share, 2)),
  ]);
  const one = (own) => {
    const shares = largest(Object.entries(own.doubt.shares), DOUBT_BARS);
    const shown = shares.filter(([, share]) => Math.abs(share) > SMALLEST_SHARE);
    const bar = ([name, share]) => ({ name, value: 100 * share, said: percent(share), role: share < 0 ? 'before' : 'after' });
    return bars('shares', own.name, shown.map(bar), '% of the variance');
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
      h('div', { class: 'columns two' }, doubted.map(one)),
    ),
  );
}
