// A tornado chart of the elasticities of each metric.

const TORNADO_BARS = 10;

function tornado({ metrics, parameters }) {
  if (!metrics.length || !parameters.length) return null;
  const one = (own) => {
    const rows = largest(Object.entries(own.elasticities), TORNADO_BARS).map(([name, value]) => ({
      name,
      value,
      said: signedNumber(value),
      role: value < 0 ? 'before' : 'after',
    }));
    return rows.length ? bars('tornado', own.name, rows, '% per % of the parameter') : null;
  };
  return drawAll(
    section(
      'tornado',
      'What moves each metric',
      h(
        'p',
        {},
        `Elasticities: percent of a metric per percent of a parameter, mean over the runs; of each metric the ${TORNADO_BARS} largest.`,
      ),
      h('div', { class: 'columns two' }, metrics.map(one)),
    ),
  );
}
