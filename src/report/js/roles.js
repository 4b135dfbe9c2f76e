// The role of a curve determines how it is drawn: in figures, in their legends and in the text.

const ROLES = {
  measured: { label: 'measured', width: 4 },
  inwards: { label: 'inwards', width: 1.6, dash: [2, 3] },
  'measured-a': { label: 'measured A', width: 4 },
  'measured-b': { label: 'measured B', width: 4 },
  band: { label: 'band', width: 0 },
  start: { label: 'start values', width: 1.3, dash: [2, 4] },
  before: { label: 'baseline', width: 1.6, dash: [7, 4] },
  after: { label: 'extended', width: 1.6 },
  change: { label: 'B over A', width: 1.6 },
  locked: { label: 'longitudinally locked', width: 1.4, dash: [10, 3, 2, 3] },
  found: { label: 'as found', width: 1.3, dash: [2, 4] },
  tried: { label: 'your values', width: 2 },
  vertical: { label: 'purely vertical', width: 1.4, dash: [2, 3] },
};

// Runs at several levels in one plot.
const PALETTE = ['after', 'before', 'locked', 'vertical', 'start'];

// A sample of such a line, bar or band for a legend.
function sample(role, filled = role === 'band') {
  const { width, dash } = ROLES[role];
  const [fill, stroke] = filled ? [`var(--${role})`, 'none'] : ['none', `var(--${role})`];
  return swatch(
    26,
    svg('path', {
      d: filled ? 'M0 1H26V9H0Z' : 'M0 5H26',
      style: `fill:${fill};stroke:${stroke}`,
      'stroke-width': width,
      'stroke-dasharray': dash && !filled ? dash.join(' ') : null,
    }),
  );
}

function swatch(width, shape) {
  return svg(
    'svg',
    { class: 'sample', viewBox: `0 0 ${width} 10`, width, height: 10, 'aria-hidden': 'true' },
    shape,
  );
}

function key(role, text, filled) {
  return keyed(role, text, sample(role, filled));
}

// A ring at a point of a plane.
function ringKey(role, text) {
  const ring = svg('circle', { cx: 5, cy: 5, r: 4, style: `fill:none;stroke:var(--${role})` });
  return keyed(role, text, swatch(10, ring));
}

// A mark at a position of a bar.
function markKey(role, text, width) {
  const mark = svg('line', { x1: 3, y1: 0, x2: 3, y2: 10, style: `stroke:var(--${role})`, 'stroke-width': width });
  return keyed(role, text, swatch(6, mark));
}

function keyed(role, text, drawing) {
  return h('span', { class: `key ${role}` }, drawing, text);
}
