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
        heatMap(
          [role, `${caption}: ${text}`],
          tiles.filter((tile) => kindOf(tile) === kind),
          readout,
        );
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

// The quantity along the bands of each kind of run, and its unit.
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

function byRow(a, b) {
  return (
    a.channel.localeCompare(b.channel) ||
    a.level - b.level ||
    (a.speed || 0) - (b.speed || 0) ||
    a.run.localeCompare(b.run) ||
    a.span[0] - b.span[0]
  );
}

// The label of a run: its level, for a cleat run also its speed, for a time history its name.
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
