// Both sides over the same cleats: peaks, after-shakes and traces.

function cleatRuns({ cleat, traces }) {
  if (!traces.length) return null;
  const places = [...new Set(cleat.runs.map((own) => `${own.mass}_${own.axis}`))];
  const first = places.includes('body_z') ? 'body_z' : places[0];
  const shown = picker('cleat runs', {
    label: 'Run',
    options: traces.map((own) => [own.run, cleatRunName(own)]),
    first: traces[Math.floor(traces.length / 2)].run,
    show: (name, place, text) =>
      cleatRunPlots(
        traces.find((own) => own.run === name),
        place,
        text,
      ),
  });
  const tables = picker('cleat run tables', {
    control: choice,
    label: 'Mass',
    options: places.map((place) => [place, words(place)]),
    first,
    show: (name, place) => {
      place.replaceChildren(cleatRunTable(cleat.runs, name));
      return [];
    },
  });
  const count = Math.max(...traces.flatMap((own) => own.traces.map((trace) => trace.measured.length)));
  const element = section(
    'cleat',
    'Over the cleat',
    h(
      'p',
      {},
      `Accelerations in the ${cleat.conditions}: the simulations of `,
      bothKeys(),
      [
        null,
        [', and ', key('measured', 'what was measured')],
        [', and what was measured of ', key('measured-a', 'A'), ' and ', key('measured-b', 'B')],
      ][count],
      '. Time starts when the wheel reaches the cleat. The peak is the largest acceleration within the first 100 ms, the after-shake the RMS acceleration in the second after that.',
    ),
    shown.control,
    shown.place,
    h('h3', {}, 'Peaks and after-shakes'),
    tables.control,
    tables.place,
    spreadTable('B against A over all runs, simulated', cleat.summary),
    cleat.measured ? spreadTable('B against A over all runs, measured', cleat.measured) : null,
  );
  return {
    element,
    draw: () => {
      shown.draw();
      tables.draw();
    },
  };
}

function cleatRunName({ speed, height, role }) {
  return `${plain(3.6 * speed, 3)} km/h, ${given(height, 'm')}${role ? ` (${roleName(role)})` : ''}`;
}

function cleatRunPlots(run, place, title) {
  const traces = [...run.traces].sort((a, b) => a.mass.localeCompare(b.mass) || b.axis.localeCompare(a.axis));
  const columns = traces.map((trace) => traceColumn(trace, 'passage', title));
  place.replaceChildren(h('div', { class: 'columns two' }, columns));
  return traces.map((trace, at) => {
    const roles = trace.measured.length > 1 ? ['measured-a', 'measured-b'] : ['measured'];
    return plot(columns[at].querySelector('.canvas'), {
      x: TIME,
      y: ACCELERATION,
      at: run.time,
      sync: 'cleat runs',
      curves: [
        ...trace.measured.map((values, own) => ({ role: roles[own], values })),
        { role: 'before', label: 'A', values: trace.a },
        { role: 'after', label: 'B', values: trace.b },
      ],
    });
  });
}

function cleatRunTable(all, place) {
  const own = all.filter((run) => `${run.mass}_${run.axis}` === place);
  const count = Math.max(...own.map((run) => run.peak.measured.length));
  const headings = [[], ['measured'], ['measured A', 'measured B']][count];
  const cells = (metric) => [
    ...headings.map((heading, at) => acceleration(metric.measured[at])),
    h('span', { class: 'before' }, acceleration(metric.a)),
    h('span', { class: 'after' }, acceleration(metric.b)),
    signed(metric.change),
  ];
  const columns = (name) =>
    [...headings, 'A', 'B', 'change'].map((text, at) => [at ? text : `${name}, ${text}`, 'number']);
  return table(
    headed(`Peaks and after-shakes of ${words(place)}`, ACCELERATION.unit),
    [['run', 'text'], ...columns('peak'), ...columns('after-shake')],
    own.map((run) => [cleatRunName(run), ...cells(run.peak), ...cells(run.after_shake)]),
  );
}

function spreadTable(caption, summary) {
  const cells = (own) => (own ? [own.least, own.median, own.greatest].map(signed) : ['–', '–', '–']);
  return table(
    caption,
    [
      ['mass', 'text'],
      ['peak, least', 'number'],
      ['median', 'number'],
      ['greatest', 'number'],
      ['after-shake, least', 'number'],
      ['median', 'number'],
      ['greatest', 'number'],
    ],
    Object.entries(summary).map(([name, own]) => [words(name), ...cells(own.peak), ...cells(own.after_shake)]),
  );
}
