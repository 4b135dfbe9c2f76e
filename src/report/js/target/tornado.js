// What moves the metrics of the targets: percent for one percent of a parameter, at today's values.

function tornado(data) {
  if (!data.sensitivity.length) return null;
  const most = Math.max(...data.sensitivity.flatMap((own) => Object.values(own.elasticities).map(Math.abs)));
  const columns = [['parameter', 'text'], ...data.sensitivity.flatMap((own) => [[own.metric, 'number'], ['', 'text']])];
  const weight = ({ name }) => Math.max(...data.sensitivity.map((own) => Math.abs(own.elasticities[name])));
  const sorted = [...data.parameters].sort((a, b) => weight(b) - weight(a));
  const rows = sorted.map(({ name }) => [
    name,
    ...data.sensitivity.flatMap((own) => [number(own.elasticities[name], 2), changeBar(own.elasticities[name], most)]),
  ]);
  return {
    element: section(
      'sensitivity',
      'What moves them',
      h('p', {}, 'Percent of a metric for one percent of a parameter at the design, mean over the runs.'),
      table('Elasticities', columns, rows),
    ),
  };
}
