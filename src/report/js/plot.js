// Plots: uPlot in the colours of the page, as wide as their place, with a keyboard.

const plots = new Set();

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

// What a curve stands for decides how it is drawn, everywhere.
const ROLES = {
  measured: { label: 'measured', width: 4 },
  'measured-a': { label: 'measured A', width: 4 },
  'measured-b': { label: 'measured B', width: 4 },
  band: { label: 'band', width: 0 },
  start: { label: 'start values', width: 1.1, dash: [2, 4] },
  before: { label: 'before', width: 1.6, dash: [7, 4] },
  after: { label: 'after', width: 1.6 },
  change: { label: 'B over A', width: 1.6 },
  locked: { label: 'locked', width: 1.4, dash: [7, 4] },
  vertical: { label: 'vertical', width: 1.4, dash: [2, 3] },
};

// `curves` are `{role, label?, values, hidden?, beside?}`; `x` and `y` are
// `{label, log?, range?, say?, whole?}`.
// A curve of role `band` is one edge of a band; edges come in pairs. `beside` makes bars of a curve: -1 to the left of
// their places, 1 to the right, 0 upon them. `gaps` says whether lines end where a value is missing.
function plot(place, { x, y, at, curves, height = 220, sync, digits = 3, gaps = true }) {
  const series = curves.map((curve) => ({ ...seriesOf(curve, digits), spanGaps: !gaps }));
  const say = x.say || ((v) => number(v, 4));
  const options = {
    width: Math.max(200, place.clientWidth),
    height,
    class: 'plot',
    scales: {
      x: { time: false, distr: x.log ? 3 : 1, range: x.range || (x.log ? tight : undefined) },
      y: { range: y.range || padded },
    },
    axes: [axis(x, 26, x.log ? 30 : 50), axis(y, room, 40)],
    series: [{ label: x.label, value: (u, v) => (v === null || v === undefined ? '' : say(v)) }, ...series],
    bands: bands(curves),
    cursor: { sync: sync && { key: sync, setSeries: false }, points: { size: 6 }, drag: { x: true, y: false } },
    legend: { live: true },
    hooks: { draw: [(u) => marked(u, place)], setScale: sync ? [(u, scale) => follow(u, scale, sync)] : [] },
  };
  const data = [at, ...curves.map((curve) => curve.values)];
  const chart = new uPlot(options, data, place);
  chart.group = sync;
  plots.add(chart);
  reachable(place, chart);
  new ResizeObserver(() => resize(chart, place, height)).observe(place);
  return chart;
}

// The axis of a transmissibility.
const FREQUENCY = {
  label: 'frequency, Hz',
  log: true,
  ticks: (u, splits) => splits.map((v) => (v !== null && /^[125]/.test(v.toExponential()) ? plain(v) : '')),
};

// The plots of a transmissibility: magnitude, phase, and what else is said of it `below`.
function polarPlots(column, { at, sync, curves, below }) {
  const parts = [
    { y: { label: 'magnitude, dB' }, curves: curves('magnitude') },
    { y: { label: 'phase, °' }, height: 190, curves: curves('phase') },
    below,
  ];
  const places = column.querySelectorAll('.canvas');
  return parts.map((part, place) => plot(places[place], { x: FREQUENCY, at, sync, ...part }));
}

// The axes of an acceleration over time.
const SECONDS = { label: 'time, s' };
const ACCELERATION = { label: 'acceleration, m/s²' };

// The place of such a plot.
function traceColumn(trace, kind) {
  return h(
    'div',
    { class: 'column' },
    h('h4', {}, `${words(trace.mass)}, ${trace.axis}`),
    figure(kind, null, h('div', { class: 'canvas' })),
  );
}

function seriesOf({ role, label, hidden, beside }, digits) {
  const { width, dash, label: usual } = ROLES[role];
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
    label: label || usual,
    class: role,
    width,
    dash,
    show: !hidden,
    stroke: width > 0 ? () => colour(role) : undefined,
    points: { show: false },
    value: (u, v) => (v === null || v === undefined ? '' : number(v, digits)),
    ...bars,
  };
}

function axis({ label, ticks, whole }, size, space) {
  return {
    label,
    size,
    space,
    labelSize: 16,
    labelFont: '12px system-ui, sans-serif',
    font: '11.5px system-ui, sans-serif',
    gap: 4,
    stroke: () => colour('muted'),
    grid: { stroke: () => colour('grid'), width: 1 },
    ticks: { stroke: () => colour('grid'), width: 1, size: 4 },
    incrs: whole ? [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000] : undefined,
    filter: ticks ? (u, splits) => splits : undefined,
    values: ticks || ((u, splits) => splits.map((v) => (v === null ? '' : plain(v)))),
  };
}

// As wide as the longest number beside an axis.
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

function bands(curves) {
  const edges = curves.map((curve, at) => (curve.role === 'band' ? at + 1 : 0)).filter((at) => at > 0);
  const pairs = [];
  for (let at = 0; at + 1 < edges.length; at += 2) {
    pairs.push({ series: [edges[at + 1], edges[at]], fill: () => colour('band') });
  }
  return pairs;
}

// Only a plot with something to see counts as drawn.
function marked(u, place) {
  const visible = u.series.some(
    (series, at) => at > 0 && series.show && u.data[at].some((v) => v !== null && Number.isFinite(v)),
  );
  if (visible && u.bbox.width > 0) drawn(place);
}

// Plots of one group keep to one range of x.
let following = false;
function follow(u, scale, group) {
  if (scale !== 'x' || following) return;
  following = true;
  const { min, max } = u.scales.x;
  for (const other of plots) {
    const moved = other !== u && other.group === group && (other.scales.x.min !== min || other.scales.x.max !== max);
    if (moved && min !== undefined && min !== null) other.setScale('x', { min, max });
  }
  following = false;
}

function resize(chart, place, height) {
  const width = Math.max(200, place.clientWidth);
  if (width !== chart.width) chart.setSize({ width, height });
}

// New curves in an old plot, which keeps its zoom.
function replace(chart, at, curves) {
  chart.setData([at, ...curves.map((curve) => curve.values)], true);
}

function forget(chart) {
  plots.delete(chart);
  chart.destroy();
}

function recolour() {
  plots.forEach((chart) => chart.redraw(false, true));
}
