// Elasticities of the target metrics at the design: percent per percent of a parameter.

function tornado(data) {
  if (!data.sensitivity.length) return null;
  const one = ({ metric, elasticities }) => {
    const sorted = Object.entries(elasticities).sort((a, b) => Math.abs(b[1]) - Math.abs(a[1]));
    const most = Math.abs(sorted[0][1]);
    const rows = sorted.map(([name, value]) => [name, number(value, 2), changeBar(value, most)]);
    const columns = [
      ['parameter', 'text'],
      ['%', 'number'],
      ['', 'text'],
    ];
    return table(metric, columns, rows);
  };
  return {
    element: section(
      'sensitivity',
      'What moves them',
      h('p', {}, 'Elasticities at the design: percent of a metric per percent of a parameter, mean over the runs.'),
      h('div', { class: 'columns' }, data.sensitivity.map(one)),
    ),
  };
}
