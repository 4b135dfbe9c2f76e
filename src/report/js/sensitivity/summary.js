// The metrics with their uncertainty, and the parameters on which they depend most.

function summary(data) {
  const { metrics, parameters, runs } = data;
  const notices = data.notices.map((text) => h('p', { class: 'note caution' }, text));
  if (!metrics.length) {
    const words = runs.length
      ? 'The model has no metric that could be measured on these runs.'
      : 'No metric has a value: a mode must vibrate, a channel needs damping, and a ride needs a rolling tyre.';
    return { element: section('summary', 'Metrics', h('p', { class: 'lead' }, words), notices) };
  }
  const isUncertain = metrics.some((own) => own.uncertainty);
  const columns = [
    ['metric', 'text'],
    ['value', 'number'],
    ...(isUncertain ? [['95 % interval', 'text']] : []),
    ...(parameters.length ? [['moved most by', 'text']] : []),
    ['meaning', 'text'],
  ];
  const strongest = (own) =>
    largest(Object.entries(own.elasticities), 2)
      .map(([name, value]) => `${name} ${signedNumber(value)}`)
      .join(', ');
  const rows = metrics.map((own) => [
    own.name,
    quantity(own.value, own.unit),
    ...(isUncertain ? [own.uncertainty ? own.uncertainty.interval.map((end) => quantity(end, own.unit)).join(' … ') : '–'] : []),
    ...(parameters.length ? [strongest(own) || 'none'] : []),
    h('span', { class: 'doc' }, own.doc.replace(/`/g, '')),
  ]);
  const ridden = metrics.some((own) => Object.keys(own.values).length > 1);
  return {
    element: section(
      'summary',
      'Metrics',
      h('p', { class: 'lead' }, lead(data)),
      notices,
      ridden ? h('p', {}, `Metrics of rides are means over ${runs.length} runs.`) : null,
      table('Metrics', columns, rows),
      ridden ? details('Values of each run', runTables(data)) : null,
    ),
  };
}

function lead({ metrics, parameters }) {
  const names = byWeight(metrics, parameters).slice(0, 3);
  if (!names.length) return 'No parameter can vary: all are known or zero.';
  const listed = names.length > 1 ? `${names.slice(0, -1).join(', ')} and ${names[names.length - 1]}` : names[0];
  return `Of ${parameters.length} parameters, ${listed} ${names.length > 1 ? 'move' : 'moves'} a metric most.`;
}

// Names of the parameters, the one that changes any metric most first.
function byWeight(metrics, parameters) {
  const size = (value) => (Number.isFinite(value) ? Math.abs(value) : 0);
  const weight = ({ name }) => Math.max(...metrics.map((own) => size(own.elasticities[name])));
  return [...parameters].sort((a, b) => weight(b) - weight(a)).map(({ name }) => name);
}

function runTables({ metrics, runs }) {
  const ridden = metrics.filter((own) => Object.keys(own.values).some((run) => runs.includes(run)));
  const cell = (own, run) => (run in own.values ? number(inUnit(own.values[run], own.unit).value) : '–');
  return metricTables('Values of each run', ridden, (own) => headed(own.name, own.unit), (some) =>
    runs.map((run) => [runName(run), ...some.map((own) => cell(own, run))]),
  );
}

function signedNumber(value) {
  return `${value > 0 ? '+' : ''}${number(value, 2)}`;
}
