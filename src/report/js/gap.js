// Where the residual is: a map over sensors and runs, and over frequency, time or travel.

// The second map is that of the extended model.
function heatMaps({ before, after }, added) {
  const kinds = [...new Map(before.map((tile) => [kindOf(tile), kindName(tile)])).entries()].sort(
    (a, b) => KINDS.indexOf(a[0]) - KINDS.indexOf(b[0]),
  );
  const sets = [
    ['before', 'Baseline model', before],
    ...(added ? [['after', `Extended model, with ${added}`, after]] : []),
  ];
  const readout = h(
    'p',
    { class: 'readout', 'aria-live': 'polite' },
    'Point at a tile, or reach the map with Tab and move with the arrow keys.',
  );
  const shown = picker('gap', {
    control: choice,
    label: 'Response',
    options: kinds,
    show: (kind, place, text) => {
      const ofKind = ([role, caption, tiles]) =>
        heatMap([role, `${caption}: ${text}`], tiles.filter((tile) => kindOf(tile) === kind), readout);
      const maps = sets.map(ofKind);
      place.replaceChildren(...maps);
      maps.forEach((map) => drawn(map));
      return [];
    },
  });
  const element = h(
    'div',
    {},
    h('h3', {}, 'Where the residual is'),
    shown.control,
    heatKey(),
    shown.place,
    view.printing ? null : readout,
  );
  return { element, draw: shown.draw };
}

const KINDS = [
  ...['harmonic1', 'harmonic2', 'harmonic3', 'time', 'passage', 'travel', 'width'],
  ...['cycle1', 'cycle2', 'cycle3'],
];

// What runs along the bands of each kind, and its unit.
const ALONG = {
  harmonic: ['frequency', 'Hz'],
  time: ['time', 's'],
  passage: ['time', 's'],
  travel: ['travel', 'm'],
  width: ['travel', 'm'],
  cycle: ['frequency', 'Hz'],
};

// Harmonics have bands of a sixth of an octave.
function overFrequency({ kind }) {
  return ALONG[kind][1] === 'Hz';
}

function kindOf(tile) {
  return `${tile.kind}${tile.harmonic || ''}`;
}

function kindName({ kind, harmonic }) {
  const order = `${['first', 'second', 'third'][harmonic - 1] || harmonic} harmonic`;
  const names = {
    harmonic: order,
    time: 'time histories',
    passage: 'cleat runs',
    travel: 'K&C curves',
    width: 'width of K&C loops',
    cycle: `${order} of K&C sines`,
  };
  return names[kind];
}

const HEAT = [1.5, 3, 10, 30, 100, 300];

function heat(strength) {
  return HEAT.filter((limit) => strength >= limit).length;
}

function heatKey() {
  const names = ['noise', ...HEAT.map((limit) => `≥ ${limit}`)];
  return h(
    'p',
    { class: 'heat-key' },
    'Residual in standard deviations:',
    names.map((name, at) => h('span', {}, h('span', { class: `swatch heat-${at}` }), name)),
  );
}

// Rows are sensors in runs, columns are bands: of a sixth of an octave, or of time or travel.
function heatMap([role, caption], tiles, readout) {
  const rowOf = (tile) => `${tile.channel} ${runText(tile)}`;
  const sorted = [...tiles].sort(byRow);
  const rows = [...new Map(sorted.map((tile) => [rowOf(tile), tile])).entries()];
  const places = new Map(rows.map(([row], at) => [row, at]));
  const [left, top, cell, w] = [206, 6, rows.length > 24 ? 15 : 19, 540];
  const along = scale(tiles);
  const height = top + rows.length * cell + 36;
  const box = (tile) => ({
    x: left + along(tile.span[0]) * w,
    y: top + places.get(rowOf(tile)) * cell,
    width: Math.max(1, (along(tile.span[1]) - along(tile.span[0])) * w - 0.6),
    height: cell - 1.5,
  });
  // Where runs of one level lie over each other, the strongest part is on top.
  const rects = [...tiles]
    .sort((a, b) => a.strength - b.strength)
    .map((tile) =>
      svg(
        'rect',
        {
          class: `heat-${heat(tile.strength)}`,
          ...box(tile),
          onpointerenter: () => {
            readout.textContent = tileText(role, tile);
          },
        },
        svg('title', {}, tileText(role, tile)),
      ),
    );
  const label = (x, at, text, anchor) =>
    svg('text', { x, y: top + at * cell + cell - 5, 'text-anchor': anchor }, text);
  const isFirst = (at) => at === 0 || rows[at - 1][1].channel !== rows[at][1].channel;
  const labels = rows.map(([, tile], at) => [
    isFirst(at) ? label(0, at, words(tile.channel), 'start') : null,
    label(left - 8, at, runText(tile), 'end'),
  ]);
  const [name, si] = tiles.length ? ALONG[tiles[0].kind] : ['', '1'];
  const ticks = mapTicks(tiles).map((value) =>
    svg(
      'text',
      { x: left + along(value) * w, y: height - 20, 'text-anchor': 'middle' },
      plain(inUnit(value, si).value, 3),
    ),
  );
  const marker = svg('rect', { class: 'marker', visibility: 'hidden' });
  const map = svg(
    'svg',
    {
      class: 'heat',
      viewBox: `0 0 ${left + w + 8} ${height}`,
      tabindex: 0,
      role: 'application',
      'aria-label': `${caption}: residual over ${name} for each sensor and run. Arrow keys move from tile to tile.`,
    },
    labels,
    rects,
    ticks,
    marker,
    svg('text', { x: left + w / 2, y: height - 4, 'text-anchor': 'middle' }, headed(name, si)),
  );
  walk(map, sorted, {
    rows: rows.map(([row]) => row),
    rowOf,
    box,
    marker,
    say: (tile) => {
      readout.textContent = tileText(role, tile);
    },
  });
  const heads = ['sensor', 'run', 'from', 'to', 'standard deviations'];
  const texts = () => [heads, ...sorted.map((tile) => [tile.channel, runText(tile), ...ends(tile), number(tile.strength)])];
  return fill(captioned(`gap-${role}`, caption, h('div', { class: 'scroll' }, map)), {}, [exports(caption, texts)]);
}

function byRow(a, b) {
  return (
    a.channel.localeCompare(b.channel) ||
    a.level - b.level ||
    (a.speed || 0) - (b.speed || 0) ||
    a.run.localeCompare(b.run) ||
    a.span[0] - b.span[0]
  );
}

// How far along the bands a value is.
function scale(tiles) {
  const low = Math.min(...tiles.map((tile) => tile.span[0]));
  const high = Math.max(...tiles.map((tile) => tile.span[1]));
  const log = tiles.length && overFrequency(tiles[0]);
  return (v) => (log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low));
}

// Round values along the bands.
function mapTicks(tiles) {
  if (!tiles.length) return [];
  const low = Math.min(...tiles.map((tile) => tile.span[0]));
  const high = Math.max(...tiles.map((tile) => tile.span[1]));
  const step =
    [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find((own) => (high - low) / own <= 8) || high - low;
  const values =
    overFrequency(tiles[0])
      ? [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200]
      : [...Array(10).keys()].map((n) => (Math.ceil(low / step) + n) * step);
  return values.filter((v) => v >= low && v <= high);
}

// How a run of this kind is told from others: by its level, over a cleat by its speed too, a record by its name.
function runText({ kind, level, speed, run }) {
  if (kind === 'time') return runName(run);
  const driven = given(level, kind === 'harmonic' ? 'm/s' : 'm', 3);
  return speed === null ? driven : `${driven}, ${plain(3.6 * speed, 3)} km/h`;
}

function ends(tile) {
  const [, unit] = ALONG[tile.kind];
  return tile.span.map((end) => quantity(end, unit));
}

function tileText(role, tile) {
  const strength = `${number(tile.strength)} standard deviations`;
  return `${ROLES[role].label}: ${tile.channel}, ${runText(tile)}, ${ends(tile).join(' to ')}: ${strength}`;
}

// The arrow keys on a map: along a row, and to the nearest tile of the next one.
function walk(map, tiles, { rows, rowOf, box, marker, say }) {
  const lines = rows.map((row) => tiles.filter((tile) => rowOf(tile) === row).sort((a, b) => a.span[0] - b.span[0]));
  const [at, bounded] = [[0, 0], (value, count) => Math.min(count - 1, Math.max(0, value))];
  map.addEventListener('keydown', (event) => {
    const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[event.key];
    if (!step) return;
    event.preventDefault();
    const from = lines[at[0]][at[1]].span[0];
    at[0] = bounded(at[0] + step[0], lines.length);
    const line = lines[at[0]];
    const nearest = line.reduce(
      (best, tile, place) => (Math.abs(tile.span[0] - from) < Math.abs(line[best].span[0] - from) ? place : best),
      0,
    );
    at[1] = bounded(step[0] ? nearest : at[1] + step[1], line.length);
    fill(marker, { ...box(line[at[1]]), visibility: 'visible' }, []);
    say(line[at[1]]);
  });
}
