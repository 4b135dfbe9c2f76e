// Transmissibilities of the rig, run by run and channel by channel.

function rig({ rig: ratios }) {
  if (!ratios.length) return null;
  const runs = [...new Map(ratios.map((ratio) => [ratio.run, ratio.role])).entries()];
  const channels = [...new Set(ratios.map((ratio) => ratio.channel))];
  const changed = ratios.some((ratio) => ratio.after);
  const place = h('div', { class: 'columns' });
  let charts = [];
  const show = (run) => {
    charts.forEach(forget);
    charts = [];
    const own = channels
      .map((channel) => ratios.find((ratio) => ratio.run === run && ratio.channel === channel))
      .filter((ratio) => ratio);
    place.replaceChildren(...own.map((ratio) => ratioFigure(ratio, charts)));
    charts.draw = () => own.forEach((ratio, at) => charts.push(...ratioPlots(ratio, place.children[at])));
    if (place.isConnected) charts.draw();
  };
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
      ' of two standard deviations of the noise and of what left and right differ by, and the model ',
      key('start', 'at its start values'),
      ', ',
      key('before', 'fitted'),
      changed ? [', and ', key('after', 'with what it lacked')] : null,
      '. Drag over a plot to zoom, double-click to see everything; a click in the legend hides a curve. Coherence near 1 means that what drives the axle explains its response.',
    ),
    choice(
      'Run',
      runs.map(([run, role]) => [run, `${runName(run)} (${roleName(role)})`]),
      runs[0][0],
      show,
    ),
    place,
    qualityTable(ratios, runs, channels),
  );
  show(runs[0][0]);
  return { element, draw: () => charts.draw() };
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
    ['magnitude', 'phase', 'coherence'].map((part) => figure(`rig-${part}`, null, h('div', { class: 'canvas' }))),
  );
}

function ratioPlots(ratio, column) {
  const coherence = {
    y: { label: 'coherence', range: coherenceRange },
    height: 130,
    digits: 5,
    curves: [{ role: 'measured', values: ratio.coherence }],
  };
  const curves = (part) => polarCurves(ratio, part);
  return polarPlots(column, { at: ratio.frequency, sync: 'rig', curves, below: coherence });
}

function coherenceRange(u, low) {
  return [low === null ? 0 : Math.min(0.9, low - 0.01), 1.002];
}

function polarCurves(ratio, part) {
  const edge = (sign) =>
    ratio.measured[part].map((value, at) => (value === null ? null : value + sign * ratio.band[part][at]));
  const curves = [
    { role: 'band', values: edge(-1) },
    { role: 'band', values: edge(1) },
    { role: 'measured', values: ratio.measured[part] },
    { role: 'start', values: ratio.start[part] },
    { role: 'before', label: 'fitted', values: ratio.before[part] },
  ];
  if (ratio.after) curves.push({ role: 'after', label: 'with it', values: ratio.after[part] });
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
