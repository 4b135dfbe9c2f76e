// The front: designs of which none is better in every metric.

function front(data) {
  const own = data.front;
  if (!own || !own.points.length) return null;
  const pairs = own.metrics.flatMap((_, a) => own.metrics.slice(a + 1).map((_, b) => [a, a + 1 + b]));
  const said = (point) => Object.entries(point.parameters).map(([name, value]) => `${name} ${number(value)}`).join(', ');
  const figures = pairs.map(([a, b]) => {
    const axes = [a, b].map((at) => [own.metrics[at].name, own.metrics[at].unit]);
    const dots = own.points.map((point) => ({ at: [point.values[a], point.values[b]], role: 'after', size: 3.5, said: said(point) }));
    const single = (what, role) => ({ at: [own.metrics[a][what], own.metrics[b][what]], role, size: 5, hollow: true, said: what });
    return plane('front', `${axes[0][0]} against ${axes[1][0]}`, axes, [...dots, single('today', 'before'), single('design', 'after')]);
  });
  const columns = [
    ...own.metrics.map((metric) => [headed(metric.name, metric.unit), 'number']),
    ...data.parameters.map((parameter) => [headed(parameter.name, parameter.unit), 'number']),
    ['cost', 'number'],
  ];
  const rows = own.points.map((point) => [
    ...point.values.map((value, at) => number(inUnit(value, own.metrics[at].unit).value)),
    ...data.parameters.map(({ name, unit }) => number(inUnit(point.parameters[name], unit).value)),
    number(point.cost),
  ]);
  return drawAll(
    section(
      'front',
      'Front',
      h('p', {}, `${frontOf(own)}; values are means over the runs. Rings are `, ringKey('before', 'today'), ' and ', ringKey('after', 'the design of least cost'), '.'),
      h('div', { class: 'columns two' }, figures),
      details('Designs of the points', table('Designs of the front', columns, rows)),
    ),
  );
}

function frontOf({ evaluated, points }) {
  return points.length === 1
    ? `Of ${evaluated} designs this one meets all targets, and no other that does is better in every metric`
    : `Of ${evaluated} designs these ${points.length} meet all targets, and none is better than another in every metric`;
}
