// The axle as masses and links: z upwards, x along the page.

const LANE = { z: 182, x: 88 };
const STEP = { z: 112, x: 330 };
// Distance between neighbouring elements of a link.
const BESIDE = 22;
const BAR = { z: 36, x: 112 };

function axles(data) {
  const { before, after } = data.axles;
  const shown = after || before;
  const fresh = after ? newNames(before, after) : new Set();
  const drawings = ['z', 'x'].map((axis) => axleDrawing(shown, axis, fresh)).filter((part) => part);
  const element = section(
    'axle',
    'Vehicle and axle',
    h(
      'p',
      {},
      after
        ? ['The extended model; ', key('after', 'what is new'), ' is highlighted. Values are those found with it.']
        : 'The model with its fitted values.',
    ),
    h('div', { class: 'drawings' }, drawings),
    details('Masses and links as a table', axleTable(shown, fresh)),
    details(`Equations of motion of ${before.name}`, equationSheet(before.equations)),
    after && details(`Equations of motion of ${after.name}`, equationSheet(after.equations)),
  );
  return { element, draw: () => drawings.forEach((drawing) => drawn(drawing)) };
}

function newNames(before, after) {
  const names = (axle) => [...axle.points, ...axle.links].map((own) => `${own.axis}.${own.name}`);
  const known = new Set(names(before));
  const law = (link) => JSON.stringify([link.ends.map((end) => end.point), link.elements.map((e) => [e.kind, e.law])]);
  const laws = new Map(before.links.map((link) => [`${link.axis}.${link.name}`, law(link)]));
  const changed = after.links.filter(
    (link) => laws.has(`${link.axis}.${link.name}`) && laws.get(`${link.axis}.${link.name}`) !== law(link),
  );
  return new Set([
    ...names(after).filter((name) => !known.has(name)),
    ...changed.map((link) => `${link.axis}.${link.name}`),
  ]);
}

function axleTable(axle, fresh) {
  const mark = (own) => (fresh.has(`${own.axis}.${own.name}`) ? 'new' : '');
  const masses = axle.points.map((own) => [
    `${own.axis} ${words(own.name)}`,
    own.kind,
    own.inertia === null ? '' : quantity(own.inertia, own.angle ? 'kg m^2' : 'kg'),
    mark(own),
  ]);
  const links = axle.links.map((link) => [
    `${link.axis} ${words(link.name)}`,
    link.ends.map((end) => words(end.point)).join(' – '),
    elementsText(link).join(', '),
    mark(link),
  ]);
  return table(
    'Masses and links',
    [
      ['name', 'text'],
      ['what', 'text'],
      ['value', 'text law'],
      ['', 'text'],
    ],
    [...masses, ...links],
  );
}

function elementsText(link) {
  return link.elements.map((element) => {
    const unit = { spring: 'N/m', damper: 'N s/m', inerter: 'kg' }[element.kind];
    return element.value === null ? element.law : quantity(element.value, unit);
  });
}

function axleDrawing(axle, axis, fresh) {
  const { place, links } = axleLayout(axle, axis);
  if (!links.length) return null;
  const all = [...place.values()].filter((own) => own.lanes.length);
  const top = Math.max(...all.map((own) => own.level));
  const bottom = Math.min(...all.map((own) => own.level));
  const lanes = Math.max(...links.map((own) => own.lane)) + 1;
  const across = LANE[axis];
  const upright = axis === 'z';
  const widest = BESIDE * (Math.max(1, ...links.map(({ link }) => link.elements.length)) - 1);
  const width = upright ? lanes * across + widest / 2 + 16 : (top - bottom) * STEP.x + BAR.x + 16;
  const height = upright ? (top - bottom) * STEP.z + BAR.z + 34 : lanes * across + 20;
  const along = (level) =>
    upright ? 12 + BAR.z / 2 + (top - level) * STEP.z : 8 + BAR.x / 2 + (level - bottom) * STEP.x;
  const lane = (index) => (upright ? 62 + index * across : 14 + across / 2 + index * across);
  const scene = { axis, along, lane, isNew: (own) => fresh.has(`${axis}.${own.name}`) };
  const name = axis === 'z' ? 'Vertical chain, z' : `Longitudinal chain, ${axis}`;
  const drawing = svg(
    'svg',
    {
      viewBox: `0 0 ${width} ${height}`,
      width,
      height,
      role: 'img',
      'aria-label': `${name}: ${links.map(({ link }) => `${words(link.name)} between ${link.ends.map((end) => words(end.point)).join(' and ')}`).join(', ')}`,
    },
    links.map((own) => drawArms(own, place, scene)),
    links.map((own) => drawLink(own, place, scene)),
    all.map((own) => drawPoint(own, scene)),
  );
  return captioned(`axle-${axis}`, name, drawing);
}

function drawPoint({ own, level, lanes, turns }, { axis, along, lane, isNew }) {
  const reach = axis === 'z' ? 46 : 30;
  const [low, high] = [lane(Math.min(...lanes)) - reach, lane(Math.max(...lanes)) + reach];
  const centre = along(level);
  const thick = BAR[axis];
  const kind = `point ${own.kind}${isNew(own) ? ' new' : ''}`;
  const label =
    own.inertia === null ? [words(own.name)] : [words(own.name), quantity(own.inertia, own.angle ? 'kg m^2' : 'kg')];
  if (isLine(own)) {
    return svg(
      'g',
      { class: kind },
      svg('path', { d: `M${low} ${centre}H${high}` }),
      svg('path', { class: 'hatch', d: hatch(low, high, centre) }),
      svg('text', { x: high + 8, y: centre + 4 }, label[0]),
    );
  }
  const box =
    axis === 'z'
      ? { x: low, y: centre - thick / 2, width: high - low, height: thick }
      : { x: centre - thick / 2, y: low, width: thick, height: high - low };
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const turning = turns.map((angle) => `${words(angle.name)} ${quantity(angle.inertia, 'kg m^2')}`);
  const lines = axis === 'z' && box.width > 110 ? [label.join(' · '), ...turning] : [...label, ...turning];
  const text = lines.map((line, at) =>
    svg(
      'text',
      { x, y: y + 4.5 + (at - (lines.length - 1) / 2) * 15, 'text-anchor': 'middle', class: at ? 'value' : 'name' },
      line,
    ),
  );
  return svg('g', { class: kind }, svg('rect', { ...box, rx: 3 }), text);
}

// A prescribed motion is drawn as a hatched line.
function isLine({ kind }) {
  return kind === 'road' || kind === 'motion';
}

function hatch(low, high, y) {
  let path = '';
  for (let x = low + 6; x <= high; x += 9) path += `M${x} ${y}l-6 8`;
  return path;
}

function drawLink({ link, ends, lane: at }, place, { axis, along, lane, isNew }) {
  const levels = ends.map((end) => place.get(end.point).level);
  const edge = BAR[axis] / 2;
  const high = Math.max(...levels);
  const low = Math.min(...levels);
  const sign = axis === 'z' ? 1 : -1;
  const reach = (level) => (isLine(place.get(ends[levels.indexOf(level)].point).own) ? 0 : edge);
  const from = along(high) + sign * reach(high);
  const to = along(low) - sign * reach(low);
  const centre = lane(at);
  const symbols = link.elements.length ? link.elements : [{ kind: 'law', law: '' }];
  const half = (BESIDE * (symbols.length - 1)) / 2;
  const shapes = symbols.map((element, index) =>
    symbol(element.kind, Math.min(from, to), Math.max(from, to), centre + BESIDE * index - half, axis),
  );
  const lines = [words(link.name), ...elementsText(link).map(shortened)];
  const middle = (from + to) / 2;
  const text =
    axis === 'z'
      ? lines.map((line, index) =>
          svg(
            'text',
            {
              x: centre + 20 + half,
              y: middle + 4 + (index - (lines.length - 1) / 2) * 15,
              class: index ? 'value' : 'name',
            },
            line,
          ),
        )
      : [
          svg('text', { x: middle, y: centre - 25, 'text-anchor': 'middle', class: 'name' }, lines[0]),
          svg(
            'text',
            { x: middle, y: centre + 35, 'text-anchor': 'middle', class: 'value' },
            lines.slice(1).join(' · '),
          ),
        ];
  return svg(
    'g',
    { class: `link${isNew(link) ? ' new' : ''}` },
    svg('title', {}, `${words(link.name)}: ${elementsText(link).join(', ')}`),
    shapes,
    text,
  );
}

// Lines from the middle of a link to the levers between its ends. They lie under all labels.
function drawArms({ link, ends, lane: at }, place, { axis, along, lane, isNew }) {
  const levels = ends.map((end) => place.get(end.point).level);
  const [low, high] = [Math.min(...levels), Math.max(...levels)];
  const pivots = ends
    .map((end) => place.get(end.point))
    .filter((own) => own.level !== high && own.level !== low && own.lanes.length);
  const arms = pivots.map((own) =>
    svg('path', {
      class: 'arm',
      d: line(
        axis,
        lane(at),
        (along(low) + along(high)) / 2,
        lane(own.lanes.reduce((a, b) => (Math.abs(b - at) < Math.abs(a - at) ? b : a))),
        along(own.level),
      ),
    }),
  );
  return svg('g', { class: `link${isNew(link) ? ' new' : ''}` }, arms);
}

function shortened(text) {
  return text.length > 18 ? `${text.slice(0, 17)}…` : text;
}

function line(axis, across0, along0, across1, along1) {
  return axis === 'z' ? `M${across0} ${along0}L${across1} ${along1}` : `M${along0} ${across0}L${along1} ${across1}`;
}

// An element between two bars, in its own coordinates: `a` runs along the lane, `c` across.
function symbol(kind, from, to, centre, axis) {
  const half = kind === 'spring' ? 19 : 13;
  const middle = (from + to) / 2;
  const at = (a, c) =>
    axis === 'z' ? `${(centre + c).toFixed(1)} ${a.toFixed(1)}` : `${a.toFixed(1)} ${(centre + c).toFixed(1)}`;
  const stems = `M${at(from, 0)}L${at(middle - half, 0)}M${at(middle + half, 0)}L${at(to, 0)}`;
  return svg('path', { class: kind, d: stems + BODIES[kind](middle, half, at) });
}

const BODIES = {
  spring: (m, half, at) => {
    const turns = [...Array(8).keys()].map((n) => at(m - half + ((n + 0.5) * half) / 4, n % 2 ? -7 : 7));
    return `M${at(m - half, 0)}L${turns.join('L')}L${at(m + half, 0)}`;
  },
  damper: (m, half, at) =>
    `M${at(m - half, -8)}L${at(m + half, -8)}M${at(m - half, 8)}L${at(m + half, 8)}M${at(m + half, -8)}L${at(m + half, 8)}M${at(m - half, 0)}L${at(m, 0)}M${at(m, -5.5)}L${at(m, 5.5)}`,
  inerter: (m, half, at) =>
    `M${at(m - half, -8)}L${at(m + half, -8)}L${at(m + half, 8)}L${at(m - half, 8)}ZM${at(m, -8)}L${at(m, 8)}`,
  law: (m, half, at) =>
    `M${at(m - half, -8)}L${at(m + half, -8)}L${at(m + half, 8)}L${at(m - half, 8)}ZM${at(m + half * 0.6, -5)}L${at(m - half * 0.6, 5)}`,
};
