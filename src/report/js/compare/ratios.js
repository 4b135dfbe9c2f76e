// Transmissibilities of both sides, with the measured ones.

function ratios(data) {
  const { ratios: all } = data;
  if (!all.length) return null;
  const runs = [...new Map(all.map((own) => [own.run || '', own.role])).entries()];
  const shown = picker('ratios', {
    control: choice,
    label: 'Run',
    options: runs.map(([run, role]) => [run, `${runName(run)}${role ? ` (${roleName(role)})` : ''}`]),
    show: (run, place) =>
      drawCompared(
        all.filter((ratio) => (ratio.run || '') === run),
        place,
      ),
  });
  const count = Math.max(...all.map((own) => own.measured.length));
  const element = section(
    'ratios',
    'Transmissibility',
    h(
      'p',
      {},
      'The models of ',
      bothKeys(),
      [
        null,
        [', and ', key('measured', 'what was measured')],
        [', and what was measured of ', key('measured-a', 'A'), ' and ', key('measured-b', 'B')],
      ][count],
      count ? [' with a ', key('band', 'band'), ' of two standard deviations'] : null,
      count ? '. The lower plots show B over A, and the coherence of the measurement.' : '. The lower plots show B over A.',
      zoomHint(),
    ),
    shown.control,
    shown.place,
    ratioTable(data),
  );
  return { element, draw: shown.draw };
}

function drawCompared(own, place) {
  const columns = own.map(ratioColumn);
  place.replaceChildren(h('div', { class: 'columns' }, columns));
  return own.flatMap((ratio, at) => comparedPlots(ratio, columns[at]));
}

function ratioColumn(ratio) {
  const of = (letter, own) => `${letter} ${number(own.fit_magnitude)} % and ${number(own.fit_phase)} %`;
  const [a, b] = ratio.quality;
  return h(
    'div',
    { class: 'column' },
    h('h3', {}, channelName(ratio.channel)),
    a && b
      ? h(
          'p',
          { class: 'note' },
          'fit of magnitude and phase: ',
          h('span', { class: 'before' }, of('A', a)),
          ', ',
          h('span', { class: 'after' }, of('B', b)),
        )
      : null,
    ['magnitude', 'phase', 'change', ...(ratio.measured.length ? ['coherence'] : [])].map((part) =>
      figure(
        `ratio-${part}`,
        `${ratio.run ? `${runName(ratio.run)}: ` : ''}${part} of ${channelName(ratio.channel)}`,
        h('div', { class: 'canvas' }),
      ),
    ),
  );
}

function comparedPlots(ratio, column) {
  const observed = ratio.measured_change;
  const change = {
    y: { label: 'B over A', unit: 'dB', range: aroundZero },
    height: 150,
    curves: [
      ...(observed ? [{ role: 'measured', values: observed.magnitude }] : []),
      { role: 'change', values: ratio.change.magnitude },
    ],
  };
  const curves = (part) => sideCurves(ratio, part);
  const coherences = ratio.measured.map(({ coherence }, at) => ({ role: measuredRoles(ratio)[at], values: coherence }));
  const below = [change, ...(coherences.length ? [coherencePlot(coherences)] : [])];
  return polarPlots(column, { unit: ratio.unit, at: ratio.frequency, sync: 'ratios', curves, below });
}

// The axis always includes zero.
function aroundZero(u, low, high) {
  return padded(u, Math.min(0, low === null ? 0 : low), Math.max(0.1, high === null ? 0 : high));
}

function measuredRoles({ measured: all }) {
  return all.length > 1 ? ['measured-a', 'measured-b'] : ['measured'];
}

function sideCurves(ratio, part) {
  const roles = measuredRoles(ratio);
  const observed = ratio.measured.map(({ value, band }, at) => ({
    role: roles[at],
    values: value[part],
    error: band[part],
  }));
  return [...observed, ...SIDES.map(([own, letter, role]) => ({ role, label: letter, values: ratio[own][part] }))];
}

function ratioTable({ transmissibility: all }) {
  const [runs, observed, fits] = [(own) => own.run, (own) => own.measured, (own) => own.fit].map((of) => all.some(of));
  const campaigns = Math.max(...all.map((own) => own.coherence.length));
  const coherences = [[], ['coherence'], ['coherence of A', 'of B']][campaigns];
  const change = (own) =>
    own ? [decibels(own.magnitude), `${number(own.frequency)} Hz`, `${number(own.rms, 2)} dB`] : ['–', '–', '–'];
  const three = (name) => [
    [`${name}largest change`, 'number'],
    ['at', 'number'],
    ['root mean square', 'number'],
  ];
  return table(
    'Where B differs most from A',
    [
      ['channel', 'text'],
      ...(runs ? [['run', 'text']] : []),
      ...three(observed ? 'models: ' : ''),
      ...(observed ? three('measured: ') : []),
      ...(fits
        ? [
            ['fit of A', 'number'],
            ['of B', 'number'],
          ]
        : []),
      ...coherences.map((name) => [name, 'number']),
    ],
    all.map((own) => [
      channelName(own.channel),
      ...(runs ? [own.run === null ? '' : runName(own.run)] : []),
      ...change(own.change),
      ...(observed ? change(own.measured) : []),
      ...(fits ? (own.fit || [null, null]).map((fit) => `${number(fit)} %`) : []),
      ...coherences.map((_, at) => (at < own.coherence.length ? number(own.coherence[at], 4) : '–')),
    ]),
  );
}
