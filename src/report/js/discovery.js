// What is missing: where the gap is, what explains it, how the model changes, and what else was considered.

function discovery(data) {
  const { discover, kappa, changes } = data;
  const maps = heatMaps(data.gap_map, discover.effects.length > 0);
  const stiffness = kappa.length ? kappaPart(kappa) : null;
  const element = section('discovery', 'Discovery',
    h('p', {}, 'The gap is what measured and modelled responses differ by over its uncertainty: noise, and errors that calibrated sensors may have. 1 is noise. It is taken after the parameters have made up for as much of it as they can.'),
    gapTable(discover), maps.map((map) => map.element), strongest(discover.where),
    stiffness && stiffness.element,
    discover.effects.map(effectPart), changes && changesPart(changes));
  return { element, draw: () => { maps.forEach((map) => map.draw()); if (stiffness) stiffness.draw(); } };
}

function gapTable({ gap, by_channel: channels }) {
  const rows = [['fitted runs', gap.fit], ['held-out runs', gap.held_out], ...Object.entries(channels).map(([name, own]) => [`sensor ${words(name)}`, own])]
    .filter(([, own]) => own.before !== null).map(([name, own]) => [name, number(own.before), number(own.after)]);
  return table('Gap over its uncertainty', [['', 'text'], ['before', 'number'], ['after', 'number']], rows);
}

function heatMaps({ before, after }, changed) {
  const kinds = [...new Map(before.map((tile) => [kindOf(tile), kindName(tile)])).entries()].sort((a, b) => KINDS.indexOf(a[0]) - KINDS.indexOf(b[0]));
  const sets = [['before', before], ...(changed ? [['after', after]] : [])];
  const place = h('div', {});
  const readout = h('p', { class: 'readout', 'aria-live': 'polite' }, 'Point at a tile, or reach the map with Tab and move with the arrow keys.');
  const show = (kind) => {
    const maps = sets.map(([role, tiles]) => heatMap(role, tiles.filter((tile) => kindOf(tile) === kind), readout));
    place.replaceChildren(...maps);
    maps.forEach((map) => drawn(map));
  };
  const element = h('div', {}, h('h3', {}, 'Where the gap is'),
    kinds.length > 1 ? choice('Response', kinds, kinds[0][0], show) : null, heatKey(), place, readout);
  return [{ element, draw: () => show(kinds[0][0]) }];
}

const KINDS = ['harmonic1', 'harmonic2', 'harmonic3', 'time', 'passage', 'travel'];

// What runs along the bands of each kind.
const ALONG = { harmonic: ['frequency', 'Hz', 1], time: ['time', 's', 1], passage: ['time', 's', 1], travel: ['travel', 'mm', 1e3] };

function kindOf(tile) {
  return `${tile.kind}${tile.harmonic || ''}`;
}

function kindName({ kind, harmonic }) {
  const names = { time: 'time histories', passage: 'cleat runs', travel: 'K&C curves' };
  return names[kind] || `${['first', 'second', 'third'][harmonic - 1] || harmonic} harmonic`;
}

const HEAT = [1.5, 3, 10, 30, 100, 300];

function heat(strength) {
  return HEAT.filter((limit) => strength >= limit).length;
}

function heatKey() {
  const names = ['noise', ...HEAT.map((limit) => `≥ ${limit}`)];
  return h('p', { class: 'heat-key' }, names.map((name, at) => h('span', {}, h('span', { class: `swatch heat-${at}` }), name)));
}

// Rows are sensors at levels, columns are bands: of a sixth of an octave, or of time or travel.
function heatMap(role, tiles, readout) {
  const rowOf = (tile) => `${tile.channel} @ ${tile.level}`;
  const sorted = [...tiles].sort((a, b) => a.channel.localeCompare(b.channel) || a.level - b.level);
  const rows = [...new Set(sorted.map(rowOf))];
  const [left, top, cell, w] = [132, 6, 19, 600];
  const along = scale(tiles);
  const height = top + rows.length * cell + 36;
  const box = (tile) => ({ x: left + along(tile.span[0]) * w, y: top + rows.indexOf(rowOf(tile)) * cell, width: Math.max(1, (along(tile.span[1]) - along(tile.span[0])) * w - 0.6), height: cell - 1.5 });
  // Where runs of one level lie over each other, the strongest part is on top.
  const rects = [...tiles].sort((a, b) => a.strength - b.strength).map((tile) => svg('rect', {
    class: `heat-${heat(tile.strength)}`, ...box(tile), onpointerenter: () => { readout.textContent = tileText(role, tile); },
  }, svg('title', {}, tileText(role, tile))));
  const labels = rows.map((row, at) => {
    const [channel, level] = row.split(' @ ');
    return svg('text', { x: left - 8, y: top + at * cell + 13, 'text-anchor': 'end' }, `${channel}, ${levelText(Number(level), tiles[0])}`);
  });
  const [name, unit, factor] = tiles.length ? ALONG[tiles[0].kind] : ['', '', 1];
  const ticks = mapTicks(tiles).map((value) => svg('text', { x: left + along(value) * w, y: height - 20, 'text-anchor': 'middle' }, plain(factor * value, 3)));
  const marker = svg('rect', { class: 'marker', visibility: 'hidden' });
  const map = svg('svg', { class: 'heat', viewBox: `0 0 ${left + w + 8} ${height}`, tabindex: 0, role: 'application', 'aria-label': `Gap ${role} over ${name} for each sensor and level. Arrow keys move from tile to tile.` },
    labels, rects, ticks, marker, svg('text', { x: left + w / 2, y: height - 4, 'text-anchor': 'middle' }, `${name}, ${unit}`));
  walk(map, sorted, { rows, rowOf, box, marker, say: (tile) => { readout.textContent = tileText(role, tile); } });
  return figure(`gap-${role}`, role === 'before' ? 'The model of the campaign' : 'The model with what was missing', h('div', { class: 'scroll' }, map));
}

// How far along the bands a value is.
function scale(tiles) {
  const low = Math.min(...tiles.map((tile) => tile.span[0]));
  const high = Math.max(...tiles.map((tile) => tile.span[1]));
  const log = tiles.length && tiles[0].kind === 'harmonic';
  return (v) => (log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low));
}

// Round values along the bands.
function mapTicks(tiles) {
  if (!tiles.length) return [];
  const low = Math.min(...tiles.map((tile) => tile.span[0]));
  const high = Math.max(...tiles.map((tile) => tile.span[1]));
  const step = [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find((own) => (high - low) / own <= 8) || high - low;
  const values = tiles[0].kind === 'harmonic' ? [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200]
    : [...Array(10).keys()].map((n) => (Math.ceil(low / step) + n) * step);
  return values.filter((v) => v >= low && v <= high);
}

function levelText(level, tile) {
  const units = { harmonic: 'mm/s', passage: 'mm', travel: 'mm' };
  return units[tile.kind] ? `${plain(1e3 * level, 3)} ${units[tile.kind]}` : plain(level, 2);
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
    const nearest = line.reduce((best, tile, place) => (Math.abs(tile.span[0] - from) < Math.abs(line[best].span[0] - from) ? place : best), 0);
    at[1] = bounded(step[0] ? nearest : at[1] + step[1], line.length);
    fill(marker, { ...box(line[at[1]]), visibility: 'visible' }, []);
    say(line[at[1]]);
  });
}

function spanText({ band_hz: band, window_s: window, travel_m: travel }) {
  const [ends, unit, factor] = [[band, 'Hz', 1], [window, 's', 1], [travel, 'mm', 1e3]].find(([own]) => own) || [[], '', 1];
  return `${ends.map((v) => number(factor * v)).join(' to ')} ${unit}`;
}

function strongest(places) {
  if (!places.length) return null;
  const rows = places.map((own) => [words(own.channel), own.harmonic === null ? '–' : String(own.harmonic), spanText(own), number(own.level), number(own.strength)]);
  return details('The strongest parts of the gap as a table', table('Gap before', [['sensor', 'text'], ['harmonic', 'number'], ['band or window', 'text'], ['level', 'number'], ['times the uncertainty', 'number']], rows));
}

// κ of a place: the dynamic stiffness that would have to be there.
function kappaPart(all) {
  const place = h('div', { class: 'columns two' }, ['real', 'imaginary'].map((part) => h('div', { class: 'column' }, figure(`kappa-${part}`, null, h('div', { class: 'canvas' })))));
  let charts = [];
  const show = (name) => {
    charts.forEach(forget);
    const own = all.find((candidate) => candidate.place === name);
    charts = ['real', 'imaginary'].map((part, at) => kappaPlot(own, part, place.children[at].querySelector('.canvas')));
  };
  const rows = all.map((own) => [own.place, own.sensor ? 'sensor' : 'in the axle', percent(own.ceiling, 3), percent(own.common, 3)]);
  const element = h('div', {}, h('h3', {}, 'Which place would explain it'),
    h('p', {}, 'For each place, the dynamic stiffness κ that would have to be added there to explain all channels at once. The ceiling is the share of the squared gap that any effect at this place could explain; with one κ for all levels, a linear one.'),
    table('Places', [['place', 'text'], ['kind', 'text'], ['ceiling', 'number'], ['linear', 'number']], rows),
    select('κ at', all.map((own) => [own.place, own.place]), all[0].place, show), place);
  return { element, draw: () => show(all[0].place) };
}

function kappaPlot(own, part, place) {
  const scale = own.sensor ? 1 : 1e-3;
  const longest = own.runs.reduce((a, b) => (b.frequency.length > a.frequency.length ? b : a));
  const palette = ['after', 'before', 'locked', 'vertical', 'measured'];
  const curves = own.runs.map((run, at) => ({
    role: palette[at % palette.length], label: levelText(run.level, { kind: 'harmonic' }),
    values: longest.frequency.map((f) => { const line = run.frequency.indexOf(f); return line < 0 || run[part][line] === null ? null : scale * run[part][line]; }),
  }));
  return plot(place, { x: FREQUENCY, y: { label: `${part} part of κ${own.sensor ? '' : ', N/mm'}` }, at: longest.frequency, curves, sync: 'kappa' });
}

function effectPart(effect) {
  const rows = Object.entries(effect.parameters).map(([name, value]) => {
    const error = effect.stderr[name];
    return [name, error === null ? quantity(value, unitOf(name)) : measured(value, error, unitOf(name)), error === null ? 'not seen by these data' : percent(error / Math.abs(value))];
  });
  const rivals = effect.rivals.map((rival) => [`${words(rival.effect)} at ${words(rival.at)}`, number(rival.behind)]);
  return h('div', {}, h('h3', {}, `${words(effect.name)} at ${words(effect.at)}`),
    h('p', {}, `It closes ${percent(effect.evidence.gap_closed, 3)} of the excess gap of the runs that judge it.`),
    h('div', { class: 'columns two' },
      table('What it is', [['parameter', 'text'], ['value', 'number'], ['standard error', 'text']], rows),
      rivals.length ? table('Rivals', [['effect', 'text'], ['behind by', 'number']], rivals) : null));
}

function changeLine(kind, sign, heading, text) {
  return h('p', { class: kind }, h('span', { class: 'sign' }, sign), heading === 'equations' ? h('span', { class: 'equation' }, formula(text)) : h('code', {}, text));
}

// Masses and links of both directions may share a name.
function direction(name) {
  const [axis, rest] = name.split('.');
  return rest ? h('span', { class: 'direction' }, `${axis} direction`) : null;
}

function changesPart(changes) {
  const parts = Object.entries(changes).map(([heading, own]) => h('div', { class: 'changes' }, h('h4', {}, words(heading)),
    own.map((change) => h('div', { class: 'change' }, direction(change.name),
      change.before === null ? null : changeLine('gone', '−', heading, change.before),
      change.after === null ? null : changeLine('come', '+', heading, change.after)))));
  return h('div', {}, h('h3', {}, 'How the model changes'), parts);
}
