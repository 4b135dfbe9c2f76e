// Time histories: measured, and simulated with the baseline and the extended model.

function records({ records: all }) {
  if (!all.length) return null;
  const runs = [...new Map(all.map((own) => [own.run, own.role])).entries()];
  const shown = picker('records', {
    control: choice,
    label: 'Run',
    options: runs.map(([run, role]) => [run, `${runName(run)} (${roleName(role)})`]),
    show: (run, place) =>
      drawRecords(
        all.filter((own) => own.run === run),
        place,
      ),
  });
  const extended = all.some((own) => own.after);
  const element = section(
    'records',
    'Records over time',
    h(
      'p',
      {},
      'Signals ',
      key('measured', 'measured'),
      ' and replayed by the ',
      key('before', 'baseline model'),
      extended ? [' and the ', key('after', 'extended model')] : null,
      ', with the parameters that discovery fits to all runs. NRMS is the RMS residual divided by the RMS of the signal without its mean.',
      zoomHint(),
    ),
    shown.control,
    shown.place,
    nrmsTable(all, extended),
  );
  return { element, draw: shown.draw };
}

function drawRecords(own, place) {
  const parts = own.map((record) => ({ record, figures: recordFigures(record) }));
  place.replaceChildren(
    ...parts.map(({ record, figures: { time, over } }) =>
      h(
        'div',
        {},
        h('h4', {}, `${words(record.channel)}, ${record.quantity}`),
        time,
        h('div', { class: 'columns two' }, over),
      ),
    ),
  );
  return parts.map(({ record, figures: { time, over } }) => {
    over.forEach((element, at) => drawOrbit(record, TRAVELS[at], element.querySelector('.canvas')));
    return plot(time.querySelector('.canvas'), {
      x: TIME,
      y: { label: record.quantity, unit: record.unit },
      at: record.time,
      sync: 'records',
      curves: recordCurves(record),
    });
  });
}

// The quantity over which a force is drawn.
const TRAVELS = [
  { of: 'velocity', label: 'velocity' },
  { of: 'displacement', label: 'travel' },
];

function recordFigures(record) {
  const canvas = () => h('div', { class: 'canvas' });
  const name = `${runName(record.run)}: ${record.quantity} of ${words(record.channel)}`;
  return {
    time: figure('record', `${name} over time`, canvas()),
    over: record.travel
      ? TRAVELS.map(({ of, label }) => figure(`record-${of}`, `${name} over ${label}`, canvas()))
      : [],
  };
}

function recordCurves(record) {
  return [
    { role: 'measured', values: record.measured },
    { role: 'before', values: record.before },
    ...(record.after ? [{ role: 'after', values: record.after }] : []),
  ];
}

function drawOrbit(record, { of, label }, place) {
  orbit(place, {
    x: { label, unit: record.travel.units[of] },
    y: { label: record.quantity, unit: record.unit },
    at: record.travel[of],
    curves: recordCurves(record),
  });
}

function nrmsTable(all, extended) {
  return table(
    'NRMS of each run',
    [
      ['run', 'text'],
      ['role', 'text'],
      ['sensor', 'text'],
      ['quantity', 'text'],
      ['baseline', 'number'],
      ...(extended ? [['extended', 'number']] : []),
    ],
    all.map((own) => [
      runName(own.run),
      roleName(own.role),
      words(own.channel),
      own.quantity,
      percent(own.nrms_before, 3),
      ...(extended ? [percent(own.nrms_after, 3)] : []),
    ]),
  );
}
