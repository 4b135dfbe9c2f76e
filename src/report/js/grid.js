// All cleat runs of one sensor side by side: a column for each speed, a row for each cleat, one scale for all.

function passageGrid(runs) {
  const sensors = [...new Set(runs.flatMap((run) => run.traces.map((trace) => `${trace.mass} ${trace.axis}`)))].sort();
  return picker('grid', {
    control: choice,
    label: 'Sensor',
    options: sensors.map((sensor) => [sensor, words(sensor)]),
    first: sensors.includes('body z') ? 'body z' : sensors[0],
    show: (sensor, place) => drawGrid(runs, sensor, place),
  });
}

function drawGrid(runs, sensor, place) {
  const traceOf = (run) => run.traces.find((trace) => `${trace.mass} ${trace.axis}` === sensor);
  const sorted = runs.filter(traceOf).sort((a, b) => a.cleat.localeCompare(b.cleat) || a.speed - b.speed);
  const speeds = [...new Set(sorted.map((run) => run.speed))].sort((a, b) => a - b);
  const cells = sorted.map((run) => ({ run, element: gridCell(run, sensor, speeds.indexOf(run.speed) + 1) }));
  const grid = h(
    'div',
    { class: 'grid', style: `--speeds: ${speeds.length}` },
    cells.map(({ element }) => element),
  );
  place.replaceChildren(grid);
  const curves = cells.map(({ run }) => traceCurves(traceOf(run)));
  const values = curves.flat().flatMap((curve) => curve.values.filter(Number.isFinite));
  const factor = unitOf(ACCELERATION.unit).factor;
  const ends = values.reduce(([low, high], v) => [Math.min(low, v * factor), Math.max(high, v * factor)], [0, 0]);
  const y = { ...ACCELERATION, range: () => padded(null, ...ends) };
  cells.forEach(({ run, element }, at) =>
    sketch(
      element.querySelector('.canvas'),
      inChosenUnits({ height: 250, gaps: true, x: TIME, y, at: run.time, from: GRID_VIEW, curves: curves[at] }),
    ),
  );
  return [];
}

// Shown duration, s; the rest of a record looks alike in all runs.
const GRID_VIEW = [-0.05, 0.6];

function gridCell(run, sensor, column) {
  const title = passageTitle(run);
  return h(
    'div',
    { style: `grid-column: ${column}` },
    h('h4', {}, title),
    figure('grid', `${title}: acceleration of ${words(sensor)}`, h('div', { class: 'canvas' })),
  );
}
