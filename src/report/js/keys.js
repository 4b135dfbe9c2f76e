// Keyboard control of a plot: arrows move the pointer, + and − zoom, 0 shows everything.

const HINT = 'Arrow keys move the pointer, plus and minus zoom, zero shows everything.';

function reachable(place, chart) {
  place.setAttribute('tabindex', '0');
  place.setAttribute('role', 'application');
  place.setAttribute('aria-label', `${place.closest('figure').getAttribute('aria-label')}. ${HINT}`);
  place.addEventListener('keydown', (event) => {
    const action = ACTIONS[event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action(chart, event.shiftKey ? 10 : 1);
  });
}

const ACTIONS = {
  ArrowLeft: (chart, step) => point(chart, -step),
  ArrowRight: (chart, step) => point(chart, step),
  '+': (chart) => zoom(chart, 0.5),
  '=': (chart) => zoom(chart, 0.5),
  '-': (chart) => zoom(chart, 2),
  0: (chart) => all(chart),
  Escape: (chart) => all(chart),
};

function point(chart, step) {
  const x = chart.data[0];
  const { min, max } = chart.scales.x;
  const middle = x.findIndex((value) => value >= (min + max) / 2);
  const from = chart.cursor.idx === null || chart.cursor.idx === undefined ? Math.max(0, middle) : chart.cursor.idx;
  const to = Math.min(x.length - 1, Math.max(0, from + step));
  const curve = chart.data.slice(1).find((values, at) => chart.series[at + 1].show && Number.isFinite(values[to]));
  const top = curve ? chart.valToPos(curve[to], 'y') : 10;
  chart.setCursor({ left: chart.valToPos(x[to], 'x'), top });
}

function zoom(chart, factor) {
  const log = chart.scales.x.distr === 3;
  const [there, back] = log ? [Math.log, Math.exp] : [(v) => v, (v) => v];
  const [low, high] = [there(chart.scales.x.min), there(chart.scales.x.max)];
  const idx = chart.cursor.idx;
  const centre = idx === null || idx === undefined ? (low + high) / 2 : there(chart.data[0][idx]);
  const ends = [chart.data[0][0], chart.data[0][chart.data[0].length - 1]];
  const min = Math.max(ends[0], back(centre - (centre - low) * factor));
  const max = Math.min(ends[1], back(centre + (high - centre) * factor));
  chart.setScale('x', { min, max });
}

function all(chart) {
  const x = chart.data[0];
  chart.setScale('x', { min: x[0], max: x[x.length - 1] });
}
