// Today's axle and the design over each cleat, with the measurements of the tested car.

function rides(data) {
  if (!data.rides.length) return null;
  const shown = picker('rides', {
    label: 'Run',
    options: data.rides.map((own) => [own.run, runName(own.run)]),
    first: data.rides[Math.floor(data.rides.length / 2)].run,
    show: (name, place, text) =>
      ridePlots(
        data.rides.find((own) => own.run === name),
        place,
        text,
      ),
  });
  const isMeasured = data.rides.some((ride) => ride.traces.some((trace) => trace.measured));
  const element = section(
    'cleat',
    'Over the cleat',
    h(
      'p',
      {},
      'Accelerations of ',
      key('before', 'today'),
      ' and ',
      key('after', 'the design'),
      isMeasured
        ? [', beside what was ', key('measured', 'measured'), ' on the car, aligned with today at the peak of the wheel']
        : [],
      '.',
      zoomHint(),
    ),
    shown.control,
    shown.place,
  );
  return { element, draw: shown.draw };
}

function ridePlots(ride, place, title) {
  const columns = ride.traces.map((trace) => traceColumn(trace, 'ride', title));
  place.replaceChildren(h('div', { class: 'columns two' }, columns));
  return ride.traces.map((trace, at) =>
    plot(columns[at].querySelector('.canvas'), {
      x: TIME,
      y: ACCELERATION,
      at: ride.time,
      sync: 'rides',
      from: RIDE_VIEW,
      curves: [
        ...(trace.measured ? [{ role: 'measured', values: trace.measured }] : []),
        { role: 'before', label: 'today', values: trace.today },
        { role: 'after', label: 'design', values: trace.design },
      ],
    }),
  );
}

// Shown time, s: the impact and the beginning of the after-shake.
const RIDE_VIEW = [-0.05, 0.6];
