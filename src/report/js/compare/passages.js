// Both sides over the same cleats: peaks, after-shakes and traces.

function passages({ cleat, traces }) {
  if (!traces.length) return null;
  const places = [...new Set(cleat.runs.map((own) => `${own.mass}_${own.axis}`))];
  const first = places.includes('body_z') ? 'body_z' : places[0];
  const charts = [];
  const [columns, rows] = [h('div', { class: 'columns two' }), h('div', {})];
  const showRun = (name) => {
    charts.splice(0).forEach(forget);
    charts.push(...passagePlots(traces.find((own) => own.run === name), columns));
  };
  const showPlace = (place) => rows.replaceChildren(passageTable(cleat.runs, place));
  const count = Math.max(...traces.flatMap((own) => own.traces.map((trace) => trace.measured.length)));
  const middle = traces[Math.floor(traces.length / 2)].run;
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
      '. Time counts from where the wheel feels the cleat. The peak is the largest acceleration within the first 100 ms, the after-shake the root mean square of the second after it.',
    ),
    select(
      'Run',
      traces.map((own) => [own.run, passageName(own)]),
      middle,
      showRun,
    ),
    columns,
    h('h3', {}, 'Peaks and after-shakes'),
    choice(
      'Mass',
      places.map((place) => [place, words(place)]),
      first,
      showPlace,
    ),
    rows,
    spreadTable('B against A over all runs, simulated', cleat.summary),
    cleat.measured ? spreadTable('B against A over all runs, measured', cleat.measured) : null,
  );
  return {
    element,
    draw: () => {
      showRun(middle);
      showPlace(first);
    },
  };
}

function passageName({ speed, height, role }) {
  return `${plain(3.6 * speed, 3)} km/h, ${plain(1e3 * height, 3)} mm${role ? ` (${roleName(role)})` : ''}`;
}

function passagePlots(run, place) {
  const traces = [...run.traces].sort((a, b) => a.mass.localeCompare(b.mass) || b.axis.localeCompare(a.axis));
  place.replaceChildren(...traces.map((trace) => traceColumn(trace, 'passage')));
  return traces.map((trace, at) => {
    const roles = trace.measured.length > 1 ? ['measured-a', 'measured-b'] : ['measured'];
    return plot(place.children[at].querySelector('.canvas'), {
      x: SECONDS,
      y: ACCELERATION,
      at: run.time,
      sync: 'passages',
      curves: [
        ...trace.measured.map((values, own) => ({ role: roles[own], values })),
        { role: 'before', label: 'A', values: trace.a },
        { role: 'after', label: 'B', values: trace.b },
      ],
    });
  });
}

function passageTable(all, place) {
  const own = all.filter((run) => `${run.mass}_${run.axis}` === place);
  const count = Math.max(...own.map((run) => run.peak.measured.length));
  const headings = [[], ['measured'], ['measured A', 'measured B']][count];
  const cells = (metric) => [
    ...headings.map((heading, at) => number(metric.measured[at])),
    h('span', { class: 'before' }, number(metric.a)),
    h('span', { class: 'after' }, number(metric.b)),
    signed(metric.change),
  ];
  const columns = (name) =>
    [...headings, 'A', 'B', 'change'].map((text, at) => [at ? text : `${name}, ${text}`, 'number']);
  return table(
    `Peaks and after-shakes of ${words(place)}, m/s²`,
    [['run', 'text'], ...columns('peak'), ...columns('after-shake')],
    own.map((run) => [passageName(run), ...cells(run.peak), ...cells(run.after_shake)]),
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
