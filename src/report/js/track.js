// Cleat runs: traces of any run, the errors of all, and the variants of the model.

const VARIANT_VIEW = [-0.02, 0.2];

function track({ track: own, simulate }) {
  if (!own) return null;
  const options = own.runs.map((run) => [run.file, passageTitle(run)]);
  const first = own.runs[Math.floor(own.runs.length / 2)].file;
  const runOf = (file) => own.runs.find((run) => run.file === file);
  const pick = (name, draw) =>
    picker(name, {
      label: 'Run',
      options,
      first,
      show: (file, place, text) => draw(runOf(file), place, text),
    });
  const [traces, variants] = [pick('traces', drawTraces), pick('variants', drawVariants)];
  const changed = own.runs.some((run) => run.traces.some((trace) => trace.after));
  // On paper every run is shown separately anyway.
  const grid = own.runs.length > 1 && !view.printing ? passageGrid(own.runs) : null;
  const histograms = errorFigures(own.histograms);
  const element = section(
    'track',
    'Over the cleat',
    h(
      'p',
      {},
      'Accelerations ',
      key('measured', 'measured'),
      ' and simulated: ',
      key('before', 'baseline model'),
      ', with the parameters of the rig fit',
      changed ? [', and ', key('after', 'extended model'), ', with the parameters found with it'] : null,
      '. Records are aligned at the peak of the wheel; time starts when the wheel reaches the cleat.',
    ),
    startCaution(own.at_start, changed),
    traces.control,
    traces.place,
    grid ? [h('h3', {}, 'All runs side by side'), grid.control, grid.place] : null,
    errorsPart(simulate, histograms),
    h('h3', {}, 'Variants of the model'),
    h(
      'p',
      {},
      'The complete model, the same with its ',
      key('locked', 'longitudinal motion locked'),
      ', and ',
      key('vertical', 'purely vertical on a point contact'),
      '.',
    ),
    variants.control,
    variants.place,
  );
  return {
    element,
    draw: () => {
      traces.draw();
      variants.draw();
      if (grid) grid.draw();
      histograms.forEach(({ element: place, own }) => histogramPlot(own, place.querySelector('.canvas')));
    },
  };
}

function errorsPart(simulate, histograms) {
  return [
    h('h3', {}, 'Errors over all runs'),
    h(
      'p',
      {},
      'Relative errors of the largest acceleration within the first 100 ms, and of the RMS acceleration after that; positive if the simulation is larger. Bins of 5 %.',
    ),
    h(
      'div',
      { class: 'columns four' },
      histograms.map((part) => part.element),
    ),
    summaryTable(simulate),
    details('Every run', errorTable(simulate)),
  ];
}

// Parameters that no rig run determines are only start values in the rides of the rig fit.
function startCaution(names, changed) {
  if (!names.length) return null;
  const [plural, own] = [names.length > 1, names.join(', ')];
  return h(
    'p',
    { class: 'caution' },
    `No rig run or K&C curve determines ${own}: in the baseline model ${plural ? 'they have their start values' : 'it has its start value'}, which may cause part of the error.`,
    changed ? ' The extended model is also fitted to the cleat runs.' : null,
  );
}

function passageTitle({ speed, cleat, role }) {
  return `${plain(3.6 * speed, 3)} km/h, ${words(cleat)} (${roleName(role)})`;
}

function drawTraces(run, place, title) {
  const traces = [...run.traces].sort((a, b) => a.mass.localeCompare(b.mass) || b.axis.localeCompare(a.axis));
  return drawAccelerations('trace', title, run, traces, place, { sync: 'track', curves: traceCurves });
}

function traceCurves(trace) {
  return [
    { role: 'measured', values: trace.measured },
    { role: 'before', values: trace.before },
    ...(trace.after ? [{ role: 'after', values: trace.after }] : []),
  ];
}

function drawVariants(run, place, title) {
  const vertical = run.traces.filter((trace) => trace.axis === 'z');
  const curves = (trace) => [
    { role: 'measured', values: trace.measured },
    { role: trace.after ? 'after' : 'before', label: 'complete', values: trace.after || trace.before },
    { role: 'locked', values: trace.locked },
    { role: 'vertical', values: trace.vertical },
  ];
  return drawAccelerations('variant', title, run, vertical, place, { sync: 'variants', from: VARIANT_VIEW, curves });
}

function drawAccelerations(kind, title, run, traces, place, { curves, ...how }) {
  const columns = traces.map((trace) => traceColumn(trace, kind, title));
  place.replaceChildren(h('div', { class: 'columns two' }, columns));
  return traces.map((trace, at) =>
    plot(columns[at].querySelector('.canvas'), {
      x: TIME,
      y: ACCELERATION,
      at: run.time,
      ...how,
      curves: curves(trace),
    }),
  );
}

function errorFigures(histograms) {
  const names = ['body_z', 'body_x'].filter((name) => histograms[name]);
  const wanted = names.length ? names : Object.keys(histograms);
  return [
    ['peak', 'peak'],
    ['after_shake', 'after-shake'],
  ].flatMap(([metric, text]) =>
    wanted.map((name) => ({
      element: captioned(`histogram-${metric}-${name}`, `${words(name)}, ${text}`, h('div', { class: 'canvas' })),
      own: histograms[name][metric],
    })),
  );
}

// Bars of both models side by side in each bin.
function histogramPlot({ before, after }, place) {
  const sets = [
    ['before', before],
    ['after', after],
  ].filter(([, own]) => own && own.counts.length);
  if (!sets.length) {
    place.replaceChildren(h('p', { class: 'note' }, 'no run has this error'));
    drawn(place);
    return;
  }
  const width = 100 * sets[0][1].width;
  const bin = (own, at) => Math.round((100 * own.start) / width) + at;
  const low = Math.min(-1, ...sets.map(([, own]) => bin(own, 0)));
  const high = Math.max(1, ...sets.map(([, own]) => bin(own, own.counts.length)));
  const bins = [...Array(high - low).keys()].map((at) => low + at);
  const most = Math.max(...sets.flatMap(([, own]) => own.counts));
  plot(place, {
    x: {
      label: 'error',
      unit: '%',
      range: () => [low * width, high * width],
      say: (v) => `${plain(v - width / 2, 3)} to ${plain(v + width / 2, 3)} %`,
    },
    y: { label: 'runs', whole: true, range: () => [0, most * 1.05] },
    at: bins.map((own) => (own + 0.5) * width),
    height: 170,
    curves: sets.map(([role, own], at) => ({
      role,
      beside: sets.length > 1 ? 2 * at - 1 : 0,
      values: bins.map((place) => own.counts[place - bin(own, 0)] || 0),
    })),
  });
}

const MODELS = [
  ['before', 'baseline', ['z', 'x']],
  ['after', 'extended', ['z', 'x']],
  ['longitudinally_locked', 'longitudinally locked', ['z']],
  ['pure_vertical', 'purely vertical', ['z']],
];

// A locked model does not move along x, so its errors there are meaningless.
function summaryTable(simulate) {
  const rows = Object.keys(simulate.before.summary).flatMap((place) =>
    MODELS.filter(([name, , axes]) => simulate[name] && axes.some((axis) => place.endsWith(axis))).map(
      ([name, text], at) => {
        const own = simulate[name].summary[place] || {};
        const sizes = ['peak', 'after_shake'].flatMap((metric) =>
          own[metric] ? [percent(own[metric].median), percent(own[metric].worst)] : ['–', '–'],
        );
        return [at === 0 ? words(place) : '', text, ...sizes];
      },
    ),
  );
  return table(
    'Size of the errors',
    [
      ['mass', 'text'],
      ['model', 'text'],
      ['peak, median', 'number'],
      ['worst', 'number'],
      ['after-shake, median', 'number'],
      ['worst', 'number'],
    ],
    rows,
  );
}

function errorTable(simulate) {
  const last = simulate.after || simulate.before;
  const rows = last.runs.map((own) => [
    runName(own.run),
    roleName(own.role),
    `${words(own.mass)} ${own.axis}`,
    acceleration(own.measured_peak),
    acceleration(own.simulated_peak),
    percent(own.peak_error),
    acceleration(own.measured_after_shake),
    acceleration(own.simulated_after_shake),
    percent(own.after_shake_error),
  ]);
  return table(
    headed('Peaks and after-shakes', ACCELERATION.unit),
    [
      ['run', 'text'],
      ['role', 'text'],
      ['mass', 'text'],
      ['peak measured', 'number'],
      ['simulated', 'number'],
      ['error', 'number'],
      ['after-shake measured', 'number'],
      ['simulated', 'number'],
      ['error', 'number'],
    ],
    rows,
  );
}
