// Where the gap is: a map over sensors and levels, and over frequency, time or travel.

// The second map is that of the model with what was `added`.
function heatMaps({ before, after }, added) {
  const kinds = [...new Map(before.map((tile) => [kindOf(tile), kindName(tile)])).entries()].sort(
    (a, b) => KINDS.indexOf(a[0]) - KINDS.indexOf(b[0]),
  );
  const sets = [
    ['before', 'The model of the campaign', before],
    ...(added ? [['after', `The model with ${added}`, after]] : []),
  ];
  const place = h('div', {});
  const readout = h(
    'p',
    { class: 'readout', 'aria-live': 'polite' },
    'Point at a tile, or reach the map with Tab and move with the arrow keys.',
  );
  const show = (kind) => {
    const maps = sets.map(([role, caption, tiles]) =>
      heatMap(
        [role, caption],
        tiles.filter((tile) => kindOf(tile) === kind),
        readout,
      ),
    );
    place.replaceChildren(...maps);
    maps.forEach((map) => drawn(map));
  };
  const element = h(
    'div',
    {},
    h('h3', {}, 'Where the gap is'),
    kinds.length > 1 ? choice('Response', kinds, kinds[0][0], show) : null,
    heatKey(),
    place,
    readout,
  );
  return [{ element, draw: () => show(kinds[0][0]) }];
}

const KINDS = [
  ...['harmonic1', 'harmonic2', 'harmonic3', 'time', 'passage', 'travel', 'width'],
  ...['cycle1', 'cycle2', 'cycle3'],
];

// What runs along the bands of each kind.
const ALONG = {
  harmonic: ['frequency', 'Hz', 1],
  time: ['time', 's', 1],
  passage: ['time', 's', 1],
  travel: ['travel', 'mm', 1e3],
  width: ['travel', 'mm', 1e3],
  cycle: ['frequency', 'Hz', 1],
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
    names.map((name, at) => h('span', {}, h('span', { class: `swatch heat-${at}` }), name)),
  );
}

// Rows are sensors at levels, columns are bands: of a sixth of an octave, or of time or travel.
function heatMap([role, caption], tiles, readout) {
  const rowOf = (tile) => `${tile.channel} @ ${tile.level}`;
  const sorted = [...tiles].sort((a, b) => a.channel.localeCompare(b.channel) || a.level - b.level);
  const rows = [...new Set(sorted.map(rowOf))];
  const [left, top, cell, w] = [132, 6, 19, 600];
  const along = scale(tiles);
  const height = top + rows.length * cell + 36;
  const box = (tile) => ({
    x: left + along(tile.span[0]) * w,
    y: top + rows.indexOf(rowOf(tile)) * cell,
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
  const labels = rows.map((row, at) => {
    const [channel, level] = row.split(' @ ');
    return svg(
      'text',
      { x: left - 8, y: top + at * cell + 13, 'text-anchor': 'end' },
      `${channel}, ${levelText(Number(level), tiles[0])}`,
    );
  });
  const [name, unit, factor] = tiles.length ? ALONG[tiles[0].kind] : ['', '', 1];
  const ticks = mapTicks(tiles).map((value) =>
    svg('text', { x: left + along(value) * w, y: height - 20, 'text-anchor': 'middle' }, plain(factor * value, 3)),
  );
  const marker = svg('rect', { class: 'marker', visibility: 'hidden' });
  const map = svg(
    'svg',
    {
      class: 'heat',
      viewBox: `0 0 ${left + w + 8} ${height}`,
      tabindex: 0,
      role: 'application',
      'aria-label': `Gap ${role} over ${name} for each sensor and level. Arrow keys move from tile to tile.`,
    },
    labels,
    rects,
    ticks,
    marker,
    svg('text', { x: left + w / 2, y: height - 4, 'text-anchor': 'middle' }, `${name}, ${unit}`),
  );
  walk(map, sorted, {
    rows,
    rowOf,
    box,
    marker,
    say: (tile) => {
      readout.textContent = tileText(role, tile);
    },
  });
  return figure(`gap-${role}`, caption, h('div', { class: 'scroll' }, map));
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

function levelText(level, tile) {
  const units = { harmonic: 'mm/s', passage: 'mm', travel: 'mm', width: 'mm', cycle: 'mm' };
  return units[tile.kind] ? `${plain(1e3 * level, 3)} ${units[tile.kind]}` : plain(level, 4);
}

function tileText(role, tile) {
  const [, unit, factor] = ALONG[tile.kind];
  const span = `${number(factor * tile.span[0])} to ${number(factor * tile.span[1])} ${unit}`;
  return `${role}: ${tile.channel}, ${levelText(tile.level, tile)}, ${span}: ${number(tile.strength)} times the uncertainty`;
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
