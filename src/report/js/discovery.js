// What is missing: where the gap is, what explains it, how the model changes, and what else was considered.

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
      'The gap is what measured and modelled responses differ by over its uncertainty: noise, and errors that calibrated sensors may have. 1 is noise. It is taken after the parameters have made up for as much of it as they can.',
    ),
    gapTable(discover),
    maps.map((map) => map.element),
    strongest(discover.where),
    stiffness && stiffness.element,
    discover.effects.map((effect) => effectPart(effect, discover.effects)),
    changes && changesPart(changes),
  );
  return {
    element,
    draw: () => {
      maps.forEach((map) => map.draw());
      if (stiffness) stiffness.draw();
    },
  };
}

function gapTable({ gap, by_channel: channels, effects }) {
  const rows = [
    ['fitted runs', gap.fit],
    ['held-out runs', gap.held_out],
    ...Object.entries(channels).map(([name, own]) => [`sensor ${words(name)}`, own]),
  ]
    .filter(([, own]) => own.before !== null)
    .map(([name, own]) => [name, number(own.before), ...(effects.length ? [number(own.after)] : [])]);
  return table(
    'Gap over its uncertainty',
    [
      ['', 'text'],
      ['before', 'number'],
      ...(effects.length ? [['after', 'number']] : []),
    ],
    rows,
  );
}

function spanText({ band_hz: band, window_s: window, travel_m: travel }) {
  const [ends, unit, factor] = [
    [band, 'Hz', 1],
    [window, 's', 1],
    [travel, 'mm', 1e3],
  ].find(([own]) => own) || [[], '', 1];
  return `${ends.map((v) => number(factor * v)).join(' to ')} ${unit}`;
}

function strongest(places) {
  if (!places.length) return null;
  const rows = places.map((own) => [
    words(own.channel),
    own.harmonic === null ? '–' : String(own.harmonic),
    spanText(own),
    number(own.level),
    number(own.strength),
  ]);
  return details(
    'The strongest parts of the gap as a table',
    table(
      'Gap before',
      [
        ['sensor', 'text'],
        ['harmonic', 'number'],
        ['band or window', 'text'],
        ['level', 'number'],
        ['times the uncertainty', 'number'],
      ],
      rows,
    ),
  );
}

// κ of a place: the dynamic stiffness that would have to be there.
function kappaPart(all) {
  const place = h(
    'div',
    { class: 'columns two' },
    ['real', 'imaginary'].map((part) =>
      h('div', { class: 'column' }, figure(`kappa-${part}`, null, h('div', { class: 'canvas' }))),
    ),
  );
  let charts = [];
  const show = (name) => {
    charts.forEach(forget);
    const own = all.find((candidate) => candidate.place === name);
    charts = ['real', 'imaginary'].map((part, at) => kappaPlot(own, part, place.children[at].querySelector('.canvas')));
  };
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
      'For each link, mass and sensor, the dynamic stiffness κ that would have to be added there to explain all channels at once. The ceiling is the share of the squared gap that any effect at this place could explain; with one κ for all levels, a linear one.',
    ),
    table(
      'Places',
      [
        ['place', 'text'],
        ['kind', 'text'],
        ['ceiling', 'number'],
        ['linear', 'number'],
      ],
      rows,
    ),
    select(
      'κ at',
      all.map((own) => [own.place, words(own.place)]),
      all[0].place,
      show,
    ),
    place,
  );
  return { element, draw: () => show(all[0].place) };
}

function kappaPlot(own, part, place) {
  const scale = own.sensor ? 1 : 1e-3;
  const longest = own.runs.reduce((a, b) => (b.frequency.length > a.frequency.length ? b : a));
  const palette = ['after', 'before', 'locked', 'vertical', 'measured'];
  const curves = own.runs.map((run, at) => ({
    role: palette[at % palette.length],
    label: levelText(run.level, { kind: 'harmonic' }),
    values: longest.frequency.map((f) => {
      const line = run.frequency.indexOf(f);
      return line < 0 || run[part][line] === null ? null : scale * run[part][line];
    }),
  }));
  return plot(place, {
    x: FREQUENCY,
    y: { label: `${part} part of κ${own.sensor ? '' : ', N/mm'}` },
    at: longest.frequency,
    curves,
    sync: 'kappa',
  });
}

function effectPart(effect, effects) {
  const rows = Object.entries(effect.parameters).map(([name, value]) => {
    const [error, unit] = [effect.stderr[name], effect.units[name]];
    return [
      name,
      error === null ? quantity(value, unit) : measured(value, error, unit),
      error === null ? 'not seen by these data' : percent(error / Math.abs(value)),
    ];
  });
  const rivals = effect.rivals.map((rival) => [
    `${words(rival.effect)} at ${words(rival.at)}`,
    number(rival.behind),
    rival.early ? 'before its fit had settled' : 'fitted to the end',
  ]);
  return h(
    'div',
    {},
    h('h3', {}, effectTitle(effect, effects)),
    h('p', {}, `It closes ${percent(effect.evidence.gap_closed, 3)} of the excess gap of the runs that judge it.`),
    h(
      'div',
      { class: 'columns two' },
      table(
        'What it is',
        [
          ['parameter', 'text'],
          ['value', 'number'],
          ['standard error', 'text'],
        ],
        rows,
      ),
      rivals.length
        ? table(
            'Rivals, by how much worse they explain the fitted runs',
            [
              ['effect', 'text'],
              ['lower in log evidence by', 'number'],
              ['judged', 'text sentence'],
            ],
            rivals,
          )
        : null,
    ),
  );
}
