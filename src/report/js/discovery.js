// The missing effect: where the residual is, which effects explain it, how the model changes, and the rivals.

function discovery(data) {
  const { discover, kappa, changes } = data;
  const maps = heatMaps(data.gap_map, added(discover.effects));
  const stiffness = kappa.length ? kappaPart(kappa) : null;
  const element = section(
    'discovery',
    'Discovery',
    h(
      'p',
      {},
      'The residual is the RMS difference between measurement and model, in standard deviations of its uncertainty (noise and calibration errors of the sensors). Noise alone gives 1. The residual is what remains after the parameters are fitted. The baseline model is that of the campaign; the extended model includes the effects found.',
    ),
    h('div', { class: 'columns two' }, residualTable(discover), leftTable(discover)),
    candidateTable(discover),
    maps.element,
    strongest(data.gap_map.before),
    stiffness && stiffness.element,
    discover.effects.map((effect) => effectPart(effect, discover.effects)),
    discover.learned && learnedPart(discover.learned),
    visiblePart(discover.visible),
    changes && changesPart(changes),
  );
  return {
    element,
    draw: () => {
      maps.draw();
      if (stiffness) stiffness.draw();
    },
  };
}

// The columns of the baseline and, if there is one, of the extended model.
function bothModels(effects) {
  return [['baseline', 'number'], ...(effects.length ? [['extended', 'number']] : [])];
}

function residualTable({ gap, by_channel: channels, effects }) {
  const rows = [
    ['fitted runs', gap.fit],
    ['held-out runs', gap.held_out],
    ...Object.entries(channels).map(([name, own]) => [`sensor ${words(name)}`, own]),
  ]
    .filter(([, own]) => own.before !== null)
    .map(([name, own]) => [name, number(own.before), ...(effects.length ? [number(own.after)] : [])]);
  return table('Residual, standard deviations', [['of', 'text'], ...bothModels(effects)], rows);
}

function leftTable({ left, effects }) {
  const rows = left.map((own) => [
    words(own.channel),
    LEFT_IN[own.kind],
    number(own.before_percent, 2),
    ...(effects.length ? [number(own.after_percent, 2)] : []),
  ]);
  return table(
    'Residual of each sensor in percent of its signal',
    [['sensor', 'text'], ['in', 'text'], ...bothModels(effects)],
    rows,
  );
}

function candidateTable({ candidates, probability }) {
  if (!candidates.length) return null;
  return table(
    `Most probable effects${probability === null ? '' : ` (the answer: ${chance(probability)})`}`,
    [
      ['effect', 'text'],
      ['form', 'text'],
      ['probability', 'number'],
      ['explained share, alone', 'number'],
      ['gain in log evidence, alone', 'number'],
    ],
    candidates.map((own) => [
      `${words(own.effect)} at ${words(own.at)}`,
      own.form === null ? '–' : words(own.form),
      chance(own.probability),
      percent(own.explained, 3),
      number(own.log_evidence),
    ]),
  );
}

// Largest number of rows in a table of residuals.
const LISTED = 24;

function strongest(tiles) {
  if (!tiles.length) return null;
  const rows = tiles
    .slice(0, LISTED)
    .map((tile) => [
      words(tile.channel),
      kindName(tile),
      runText(tile),
      ends(tile).join(' to '),
      number(tile.strength),
    ]);
  return details(
    'The largest residuals as a table',
    table(
      'Residual of the baseline model',
      [
        ['sensor', 'text'],
        ['response', 'text'],
        ['run', 'text'],
        ['band or window', 'text'],
        ['standard deviations', 'number'],
      ],
      rows,
    ),
  );
}

// κ of a place: the dynamic stiffness that would have to be added there.
function kappaPart(all) {
  const shown = picker('kappa', {
    label: 'κ at',
    options: all.map((own) => [own.place, words(own.place)]),
    show: (name, place) =>
      drawKappa(
        all.find((own) => own.place === name),
        place,
      ),
  });
  const rows = all.map((own) => [
    words(own.place),
    own.sensor ? 'sensor' : 'in the axle',
    percent(own.ceiling, 3),
    percent(own.common, 3),
  ]);
  const element = h(
    'div',
    {},
    h('h3', {}, 'Which place would explain it'),
    h(
      'p',
      {},
      'For each link, mass and sensor: the dynamic stiffness κ that would have to be added there to explain all channels at once. The first share is the part of the mean square residual that any effect at this place could explain; the second is the part that a linear effect, with the same κ at all levels, could explain.',
    ),
    table(
      'Places',
      [
        ['place', 'text'],
        ['kind', 'text'],
        ['explained share, alone', 'number'],
        ['by a linear effect', 'number'],
      ],
      rows,
    ),
    shown.control,
    shown.place,
  );
  return { element, draw: shown.draw };
}

function drawKappa(own, place) {
  const parts = ['real', 'imaginary'];
  const figures = parts.map((part) =>
    figure(`kappa-${part}`, `κ at ${words(own.place)}, ${part} part`, h('div', { class: 'canvas' })),
  );
  place.replaceChildren(h('div', { class: 'columns two' }, figures));
  return parts.map((part, at) => kappaPlot(own, part, figures[at].querySelector('.canvas')));
}

function kappaPlot(own, part, place) {
  const longest = own.runs.reduce((a, b) => (b.frequency.length > a.frequency.length ? b : a));
  const curves = own.runs.map((run, at) => ({
    role: PALETTE[at % PALETTE.length],
    label: given(run.level, 'm/s'),
    values: along(run[part], run.frequency, longest.frequency),
    error: along(run.sigma, run.frequency, longest.frequency),
  }));
  return plot(place, {
    x: FREQUENCY,
    y: { label: part === 'real' ? 'Re κ' : 'Im κ', unit: own.sensor ? '1' : 'N/m' },
    at: longest.frequency,
    curves,
    sync: 'kappa',
  });
}
