// Transmissibilities of the rig, run by run and channel by channel.

// The choice of all runs.
const ALL = '';

function rig(data) {
  const { rig: ratios } = data;
  if (!ratios.length) return null;
  const runs = [...new Map(ratios.map((ratio) => [ratio.run, ratio.role])).entries()];
  const channels = [...new Set(ratios.map((ratio) => ratio.channel))];
  const changed = ratios.some((ratio) => ratio.after);
  const shown = picker('rig', {
    control: choice,
    label: 'Run',
    options: [
      ...runs.map(([run, role]) => [run, `${runName(run)} (${roleName(role)})`]),
      ...(runs.length > 1 ? [[ALL, 'all levels, measured']] : []),
    ],
    show: (run, place) =>
      run === ALL
        ? drawLevels(ratios, channels, place)
        : drawRatios(
            ratios.filter((ratio) => ratio.run === run),
            channels,
            place,
          ),
  });
  const trial = tried(data);
  const element = section(
    'rig',
    'Rig fit',
    h(
      'p',
      {},
      'Transmissibilities ',
      key('measured', 'measured'),
      ' with a ',
      key('band', 'band'),
      ' of two standard deviations of the noise plus half the difference between left and right; the ',
      key('start', 'start values'),
      ', the ',
      key('before', 'fitted baseline model'),
      changed ? [' and the ', key('after', 'extended model')] : null,
      '. Coherence near 1 means that the excitation explains the response.',
      zoomHint(),
    ),
    shown.control,
    shown.place,
    qualityTable(ratios, runs, channels),
    trial.element,
  );
  const draw = () => {
    shown.draw();
    if (trial.draw) trial.draw();
  };
  return { element, draw };
}

function drawRatios(ratios, channels, place) {
  const own = channels.map((channel) => ratios.find((ratio) => ratio.channel === channel)).filter((ratio) => ratio);
  const columns = own.map(ratioFigure);
  place.replaceChildren(h('div', { class: 'columns' }, columns));
  return own.flatMap((ratio, at) => ratioPlots(ratio, columns[at]));
}

// The measured ratios of all runs in one plot: they differ if the axle is nonlinear.
function drawLevels(ratios, channels, place) {
  const parts = channels.map((channel) => ({
    own: ratios.filter((ratio) => ratio.channel === channel),
    column: h(
      'div',
      { class: 'column' },
      h('h3', {}, channelName(channel)),
      ['magnitude', 'phase'].map((part) =>
        figure(`levels-${part}`, `All runs: ${part} of ${channelName(channel)}`, h('div', { class: 'canvas' })),
      ),
    ),
  }));
  place.replaceChildren(
    h(
      'div',
      { class: 'columns' },
      parts.map(({ column }) => column),
    ),
  );
  return parts.flatMap(({ own, column }) => levelPlots(own, column));
}

function levelPlots(own, column) {
  const at = [...new Set(own.flatMap((ratio) => ratio.frequency))].sort((a, b) => a - b);
  const curves = (part) =>
    own.map((ratio, place) => ({
      role: PALETTE[place % PALETTE.length],
      label: runName(ratio.run),
      values: along(ratio.measured[part], ratio.frequency, at),
    }));
  return polarPlots(column, { unit: own[0].unit, at, sync: 'rig', gaps: false, curves });
}

function ratioFigure(ratio) {
  const quality = (own) => `magnitude ${number(own.fit_magnitude)} %, phase ${number(own.fit_phase)} %`;
  const after = ratio.quality_after ? [' → ', h('span', { class: 'after' }, quality(ratio.quality_after))] : null;
  return h(
    'div',
    { class: 'column' },
    h('h3', {}, channelName(ratio.channel)),
    h(
      'p',
      { class: 'note' },
      'fit ',
      h('span', { class: 'before' }, quality(ratio.quality_before)),
      after,
      ratio.fitted || ratio.role !== 'fit' ? null : '; compared, not in the cost',
    ),
    ['magnitude', 'phase', 'coherence'].map((part) =>
      figure(
        `rig-${part}`,
        `${runName(ratio.run)}: ${part} of ${channelName(ratio.channel)}`,
        h('div', { class: 'canvas' }),
      ),
    ),
  );
}

function ratioPlots(ratio, column) {
  const below = [coherencePlot([{ role: 'measured', values: ratio.coherence }])];
  const curves = (part) => polarCurves(ratio, part);
  return polarPlots(column, { unit: ratio.unit, at: ratio.frequency, sync: 'rig', curves, below });
}

function polarCurves(ratio, part) {
  const curves = [
    { role: 'measured', values: ratio.measured[part], error: ratio.band[part] },
    { role: 'start', values: ratio.start[part] },
    { role: 'before', values: ratio.before[part] },
  ];
  if (ratio.after) curves.push({ role: 'after', values: ratio.after[part] });
  return curves;
}

function qualityTable(ratios, runs, channels) {
  const rows = channels.map((channel) => [
    channelName(channel),
    ...runs.map(([run]) => {
      const own = ratios.find((ratio) => ratio.run === run && ratio.channel === channel);
      return own ? qualityCell(own) : '';
    }),
  ]);
  return table(
    'Fit of magnitude and phase, percent',
    [['channel', 'text'], ...runs.map(([run, role]) => [`${runName(run)}, ${roleName(role)}`, 'number'])],
    rows,
  );
}

function qualityCell({ quality_before: before, quality_after: after }) {
  const text = (own) => `${number(own.fit_magnitude)} / ${number(own.fit_phase)}`;
  return after
    ? [h('span', { class: 'before' }, text(before)), ' → ', h('span', { class: 'after' }, text(after))]
    : text(before);
}
