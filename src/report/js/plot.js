// Plots: uPlot in the colours of the page, as wide as their place, with keyboard control; on paper, SVG.

const plots = new Set();

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

// `curves` are `{role, label?, values, error?, hidden?, beside?}`; `x` and `y` are `{label, unit?, log?, range?, say?,
// whole?}`, values being SI where there is a unit. `error` is drawn as a band about the curve, and shown under the
// pointer. `beside` draws a curve as bars: -1 to the left of their positions, 1 to the right, 0 at them. `gaps` says
// whether lines end where a value is missing, `from` the range of x that is shown first.
function plot(place, asked) {
  const own = inChosenUnits({ height: 220, digits: 3, gaps: true, ...asked });
  if (view.printing) return sketch(place, own);
  const chart = new uPlot(optionsOf(own, place), [own.at, ...own.curves.map((curve) => curve.values)], place);
  chart.group = own.sync;
  plots.add(chart);
  named(chart, own, place);
  reachable(place, chart);
  keepWidth(chart, place, own.height);
  const range = view.zoomed.get(own.sync) || own.from;
  if (range) chart.setScale('x', { min: range[0], max: range[1] });
  return chart;
}

// Axes with units, and their curves; the edges of the band of a curve with an error precede the curve.
function inChosenUnits(own) {
  const [across, up] = [unitOf(own.x.unit), unitOf(own.y.unit)];
  const scaled = (values, { factor }) => (factor === 1 ? values : values.map((v) => (v === null ? null : v * factor)));
  const curves = own.curves.flatMap((curve) => {
    const [values, error] = [scaled(curve.values, up), curve.error && scaled(curve.error, up)];
    const edge = (sign) => ({
      role: 'band',
      values: values.map((v, at) => (v === null ? null : v + sign * error[at])),
    });
    return [...(error ? [edge(-1), edge(1)] : []), { ...curve, values, error }];
  });
  return {
    ...own,
    at: scaled(own.at, across),
    x: { ...own.x, ...across, text: headed(own.x.label, own.x.unit) },
    y: { ...own.y, ...up, text: headed(own.y.label, own.y.unit) },
    curves: curves.map((curve) => ({ ...curve, label: curve.label || ROLES[curve.role].label })),
  };
}

function optionsOf(own, place) {
  const { x, y, curves, sync } = own;
  const say = x.say || ((v) => withUnit(number(v, 4), x.unit));
  return {
    width: Math.max(200, place.clientWidth),
    height: own.height,
    class: 'plot',
    padding: [22, null, null, null],
    scales: {
      x: { time: false, distr: x.log ? 3 : 1, range: x.range || (x.log ? tight : undefined) },
      y: { range: y.range || padded },
    },
    axes: [axis(x, 26, x.log ? 30 : 50), axis(y, room, (u, at, low, high, length) => Math.min(28, length / 4))],
    series: [
      { label: x.label, value: (u, v) => (v === null || v === undefined ? '' : say(v)) },
      ...curves.map((curve) => seriesOf(curve, own)),
    ],
    bands: bands(curves),
    cursor: { sync: sync && { key: sync, setSeries: false }, points: { size: 6 }, drag: { x: true, y: false } },
    legend: { live: true, markers: { width: () => 0, fill: () => 'transparent' } },
    hooks: { draw: [(u) => marked(u, place)], setScale: sync ? [(u, scale) => follow(u, scale, sync)] : [] },
  };
}

// Magnitude and phase over frequency of a ratio in the SI unit `unit`, with further plots `below`.
const FREQUENCY = {
  label: 'frequency',
  unit: 'Hz',
  log: true,
  ticks: (u, splits) => {
    const isShown = labelled(splits.filter((v) => v !== null));
    return splits.map((v) => (v !== null && isShown(v) ? plain(v) : ''));
  },
};

// Which of the ticks of a logarithmic axis have a number: those of 1, 2 and 5; on a short axis those of any single digit.
function labelled(ticks) {
  const isDigit = (v) => Math.abs(v / Number(v.toPrecision(1)) - 1) < 1e-9;
  const isRound = (v) => isDigit(v) && /^[125]/.test(v.toExponential(0));
  return ticks.filter(isRound).length > 1 ? isRound : isDigit;
}

function polarPlots(column, { unit, curves, below = [], ...how }) {
  const label = unit && unit !== '1' ? `magnitude re 1 ${pretty(unit)}` : 'magnitude';
  const parts = [
    { y: { label, unit: 'dB' }, curves: curves('magnitude') },
    { y: { label: 'phase', unit: '°' }, height: 190, curves: curves('phase') },
    ...below,
  ];
  const places = column.querySelectorAll('.canvas');
  return parts.map((part, place) => plot(places[place], { x: FREQUENCY, ...how, ...part }));
}

// The coherence of measurements, for a plot below a ratio.
function coherencePlot(curves) {
  return { y: { label: 'coherence', range: coherenceRange }, height: 130, digits: 5, curves };
}

function coherenceRange(u, low) {
  return [low === null ? 0 : Math.min(0.9, low - 0.01), 1.002];
}

// Values at the positions `at`, arranged at other positions; null where there is none.
function along(values, at, others) {
  const known = new Map(at.map((own, place) => [own, values[place]]));
  return others.map((own) => (known.has(own) ? known.get(own) : null));
}

function zoomHint() {
  const text = 'Drag over a plot to zoom, double-click to see everything; a click in the legend hides a curve.';
  return h('span', { class: 'hint' }, ` ${text}`);
}

// The axes of an acceleration over time.
const TIME = { label: 'time', unit: 's' };
const ACCELERATION = { label: 'acceleration', unit: 'm/s^2' };

// A single plot of an acceleration, under a heading with its unit.
function acceleration(value) {
  return number(inUnit(value, ACCELERATION.unit).value);
}

// The element of such a plot.
function traceColumn(trace, kind, run) {
  const name = `${words(trace.mass)}, ${trace.axis}`;
  return h(
    'div',
    { class: 'column' },
    h('h4', {}, name),
    figure(kind, `${run}: acceleration of ${name}`, h('div', { class: 'canvas' })),
  );
}

function seriesOf({ role, label, hidden, beside, error }, { y, digits, gaps }) {
  const { width, dash } = ROLES[role];
  const bars =
    beside === undefined
      ? {}
      : {
          paths: uPlot.paths.bars({ size: [beside ? 0.42 : 0.85, 60], align: beside }),
          fill: () => colour(role),
          dash: undefined,
          width: 0,
        };
  return {
    label,
    class: role,
    width,
    dash,
    show: !hidden,
    spanGaps: !gaps,
    stroke: width > 0 ? () => colour(role) : undefined,
    points: { show: false },
    value: (u, v, series, at) => (v === null || v === undefined ? '' : told(v, error && error[at], y.unit, digits)),
    ...bars,
  };
}

// A value under the pointer, in the unit of its axis.
function told(value, error, unit, digits) {
  return withUnit(error > 0 ? measured(value, error, '1') : number(value, digits), unit);
}

function axis({ text, ticks, whole }, size, space) {
  return {
    label: text,
    size,
    space,
    labelSize: 16,
    labelFont: '12px system-ui, sans-serif',
    font: '11.5px system-ui, sans-serif',
    gap: 4,
    stroke: () => colour('muted'),
    grid: { stroke: () => colour('grid'), width: 1 },
    ticks: { stroke: () => colour('muted'), width: 1, size: 4 },
    incrs: whole ? [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000] : undefined,
    filter: ticks ? (u, splits) => splits : undefined,
    values: ticks || ((u, splits) => splits.map((v) => (v === null ? '' : plain(v)))),
  };
}

// Width of the longest number at an axis.
function room(u, texts) {
  return Math.max(46, 14 + 7 * Math.max(0, ...(texts || []).map((text) => text.length)));
}

function tight(u, low, high) {
  return [low, high];
}

function padded(u, low, high) {
  if (low === null || high === null) return [0, 1];
  const margin = Math.max((high - low) * 0.06, Math.abs(high) * 1e-6, 1e-9);
  return [low - margin, high + margin];
}

// Edges of bands come in pairs, the lower one first.
function bandPairs(curves) {
  const edges = curves.map((curve, at) => (curve.role === 'band' ? at : -1)).filter((at) => at >= 0);
  return edges.filter((_, at) => at % 2 === 0).map((low) => [low, low + 1]);
}

function bands(curves) {
  return bandPairs(curves).map(([low, high]) => ({ series: [high + 1, low + 1], fill: () => colour('band') }));
}

// Only a plot with visible data counts as drawn.
function marked(u, place) {
  const visible = u.series.some(
    (series, at) => at > 0 && series.show && u.data[at].some((v) => v !== null && Number.isFinite(v)),
  );
  if (visible && u.bbox.width > 0) drawn(place);
}

// A name for screen readers, a legend with the lines as drawn, and the values for a spreadsheet.
function named(chart, own, place) {
  const name = place.closest('figure').getAttribute('aria-label');
  const shown = own.curves.filter((curve) => curve.role !== 'band');
  const what = `${name}: ${shown.map((curve) => curve.label).join(', ')} over ${own.x.label}`;
  fill(chart.root.querySelector('canvas'), { role: 'img', 'aria-label': what }, []);
  const markers = [...chart.root.querySelectorAll('.u-legend .u-series')].slice(1);
  own.curves.forEach((curve, at) =>
    markers[at].querySelector('.u-marker').replaceChildren(sample(curve.role, curve.beside !== undefined || undefined)),
  );
  const now = () => shown.map((curve) => ({ ...curve, values: chart.data[own.curves.indexOf(curve) + 1] }));
  place.before(exports(name, () => curveRows(own, now())));
}

function curveRows({ x, y, at }, curves) {
  const text = (v) => (v === null || v === undefined || !Number.isFinite(v) ? '' : String(Number(v.toPrecision(6))));
  const heads = ({ label, error }) => [
    `${label}, ${y.text}`,
    ...(error ? [`uncertainty of ${label}${y.unit ? `, ${y.unit}` : ''}`] : []),
  ];
  const cells = ({ values, error }, line) => [text(values[line]), ...(error ? [text(error[line])] : [])];
  return [
    [x.text, ...curves.flatMap(heads)],
    ...at.map((value, line) => [text(value), ...curves.flatMap((curve) => cells(curve, line))]),
  ];
}

// Plots of one group share a range of x, which also applies to the plots that replace them.
let following = false;
function follow(u, scale, group) {
  const { min, max } = u.scales.x;
  if (scale !== 'x' || following || min === undefined || min === null) return;
  following = true;
  for (const other of plots) {
    const moved = other !== u && other.group === group && (other.scales.x.min !== min || other.scales.x.max !== max);
    if (moved) other.setScale('x', { min, max });
  }
  following = false;
}

// A plot whose width changes during a layout is drawn in the next frame, so that the layout does not wait for it.
function keepWidth(chart, place, height) {
  const observer = new ResizeObserver(() =>
    requestAnimationFrame(() => {
      const width = Math.max(200, place.clientWidth);
      if (plots.has(chart) && width !== chart.width) chart.setSize({ width, height });
    }),
  );
  observer.observe(place);
  chart.hooks.destroy = [() => observer.disconnect()];
}

function forget(chart) {
  plots.delete(chart);
  const { min, max } = chart.scales.x;
  const [from, to] = [chart.data[0][0], chart.data[0][chart.data[0].length - 1]];
  if (chart.group && (min > from || max < to)) view.zoomed.set(chart.group, [min, max]);
  else view.zoomed.delete(chart.group);
  chart.destroy();
}

function recolour() {
  plots.forEach((chart) => chart.redraw(false, true));
}
