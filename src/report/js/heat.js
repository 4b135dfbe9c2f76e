// A map of residuals: rows are sensors in runs, columns are bands of a sixth of an octave, or of time or travel.

const HEAT_AREA = { left: 206, top: 6, width: 540, below: 36 };

function heatMap([role, caption], tiles, readout) {
  const scene = heatScene(tiles);
  const say = (tile) => {
    readout.textContent = tileText(role, tile);
  };
  const marker = svg('rect', { class: 'marker', visibility: 'hidden' });
  const [name] = ALONG[tiles[0].kind];
  const map = svg(
    'svg',
    {
      class: 'heat',
      viewBox: `0 0 ${HEAT_AREA.left + HEAT_AREA.width + 8} ${scene.height}`,
      tabindex: 0,
      role: 'application',
      'aria-label': `${caption}: residual over ${name} for each sensor and run. Arrow keys move from tile to tile.`,
    },
    heatRows(scene),
    heatTiles(role, tiles, scene, say),
    heatAxis(tiles, scene),
    marker,
  );
  walk(map, scene, marker, say);
  const element = captioned(`gap-${role}`, caption, h('div', { class: 'scroll' }, map));
  return fill(element, {}, [exports(caption, () => tileRows(scene.sorted))]);
}

// Positions of rows and tiles.
function heatScene(tiles) {
  const names = new Map(tiles.map((tile) => [tile, `${tile.channel} ${runText(tile)}`]));
  const sorted = [...tiles].sort(byRow);
  const rows = [...new Map(sorted.map((tile) => [names.get(tile), tile])).values()];
  const places = new Map(rows.map((tile, at) => [names.get(tile), at]));
  const cell = rows.length > 24 ? 15 : 19;
  const share = scale(tiles);
  const x = (value) => HEAT_AREA.left + share(value) * HEAT_AREA.width;
  const rowAt = (tile) => places.get(names.get(tile));
  const box = (tile) => ({
    x: x(tile.span[0]),
    y: HEAT_AREA.top + rowAt(tile) * cell,
    width: Math.max(1, x(tile.span[1]) - x(tile.span[0]) - 0.6),
    height: cell - 1.5,
  });
  return { sorted, rows, rowAt, cell, x, box, height: HEAT_AREA.top + rows.length * cell + HEAT_AREA.below };
}

// If tiles of runs of one level overlap, the largest residual is on top.
function heatTiles(role, tiles, { box }, say) {
  const sorted = [...tiles].sort((a, b) => a.strength - b.strength);
  return sorted.map((tile) =>
    svg(
      'rect',
      { class: `heat-${heat(tile.strength)}`, ...box(tile), onpointerenter: () => say(tile) },
      svg('title', {}, tileText(role, tile)),
    ),
  );
}

// The name of a sensor is next to the first of its runs.
function heatRows({ rows, cell }) {
  const text = (x, at, said, anchor) =>
    svg('text', { x, y: HEAT_AREA.top + at * cell + cell - 5, 'text-anchor': anchor }, said);
  return rows.map((tile, at) => [
    at === 0 || rows[at - 1].channel !== tile.channel ? text(0, at, words(tile.channel), 'start') : null,
    text(HEAT_AREA.left - 8, at, runText(tile), 'end'),
  ]);
}

function heatAxis(tiles, { x, height }) {
  const [name, unit] = ALONG[tiles[0].kind];
  const text = (at, y, said) => svg('text', { x: at, y, 'text-anchor': 'middle' }, said);
  return [
    mapTicks(tiles).map((value) => text(x(value), height - 20, plain(inUnit(value, unit).value, 3))),
    text(HEAT_AREA.left + HEAT_AREA.width / 2, height - 4, headed(name, unit)),
  ];
}

function tileRows(tiles) {
  const heads = ['sensor', 'run', 'from', 'to', 'standard deviations'];
  return [heads, ...tiles.map((tile) => [tile.channel, runText(tile), ...ends(tile), number(tile.strength)])];
}

// Position of a value along the bands.
function scale(tiles) {
  const low = Math.min(...tiles.map((tile) => tile.span[0]));
  const high = Math.max(...tiles.map((tile) => tile.span[1]));
  const log = tiles.length && overFrequency(tiles[0]);
  return (v) => (log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low));
}

// Round values for the axis along the bands.
function mapTicks(tiles) {
  if (!tiles.length) return [];
  const low = Math.min(...tiles.map((tile) => tile.span[0]));
  const high = Math.max(...tiles.map((tile) => tile.span[1]));
  const step =
    [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find((own) => (high - low) / own <= 8) || high - low;
  const values = overFrequency(tiles[0])
    ? [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200]
    : [...Array(10).keys()].map((n) => (Math.ceil(low / step) + n) * step);
  return values.filter((v) => v >= low && v <= high);
}

// Arrow keys move along a row of the map, and to the nearest tile of the next row.
function walk(map, { sorted, rows, rowAt, box }, marker, say) {
  const lines = rows.map((_, row) => sorted.filter((tile) => rowAt(tile) === row));
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
