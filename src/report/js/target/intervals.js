// A bar for each parameter: its range, today's value, the design and the solution space.

function intervals(data) {
  const columns = [
    ['parameter', 'text'],
    ['range', 'text'],
    ['today', 'number'],
    ['design', 'number'],
    ['change', 'number'],
    ['solution space', 'text'],
    ['', 'text'],
  ];
  const span = ([low, high], unit) => `${quantity(low, unit)} … ${quantity(high, unit)}`;
  const rows = data.parameters.map((own) => [
    own.name,
    span(own.range, own.unit),
    h('span', { class: 'before' }, quantity(own.today, own.unit)),
    h('span', { class: 'after' }, quantity(own.design, own.unit)),
    signed(own.design / own.today - 1),
    own.interval ? span(own.interval, own.unit) : '–',
    intervalBar(own),
  ]);
  const { space } = data;
  const words = space
    ? `Of the designs in the solution space ${percent(space.probability, 3)} meet all targets (at least ${percent(space.at_least, 3)} with 95\u00a0% confidence; wanted: ${percent(space.wanted, 3)}). Each team may choose freely within its interval.`
    : 'Each bar is the range of a parameter.';
  const trial = tried(data);
  const element = section(
    'parameters',
    'Parameters',
    h('p', {}, words, ' The thin mark is ', markKey('before', 'today', 1.5), ', the thick one ', markKey('after', 'the design', 3), '.'),
    table('Parameters', columns, rows),
    trial.element,
  );
  return { element, draw: trial.draw };
}

const RANGE_BAR = { width: 180, height: 18 };

function intervalBar({ range, today, design, interval }) {
  const x = (value) => (RANGE_BAR.width * (value - range[0])) / (range[1] - range[0]);
  const mark = (value, role, width) =>
    value >= range[0] && value <= range[1]
      ? svg('path', { d: `M${x(value)} 1V${RANGE_BAR.height - 1}`, style: `stroke:var(--${role})`, 'stroke-width': width })
      : null;
  return svg(
    'svg',
    { class: 'interval', viewBox: `-2 0 ${RANGE_BAR.width + 4} ${RANGE_BAR.height}`, width: RANGE_BAR.width + 4, height: RANGE_BAR.height, 'aria-hidden': 'true' },
    svg('rect', { x: 0, y: 6, width: RANGE_BAR.width, height: 6, style: 'fill:var(--grid)' }),
    interval
      ? svg('rect', { x: x(interval[0]), y: 3, width: x(interval[1]) - x(interval[0]), height: 12, style: 'fill:var(--band)' })
      : null,
    mark(today, 'before', 1.5),
    mark(design, 'after', 3),
  );
}
