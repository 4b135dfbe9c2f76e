// Data and settings of the study.

function record({ record: own, fit, campaign, discover }) {
  const element = section(
    'record',
    'Data and settings',
    h('p', {}, own.description),
    own.notices.length
      ? h(
          'ul',
          {},
          own.notices.map((notice) => h('li', {}, notice)),
        )
      : null,
    table(
      'Runs',
      [
        ['file', 'text'],
        ['kind', 'text'],
        ['role', 'text'],
        ['drive', 'text'],
      ],
      own.runs.map((run) => [run.file, run.kind, roleName(run.role), driveText(run.drive)]),
    ),
    h(
      'div',
      { class: 'columns two' },
      own.vehicle.length
        ? table(
            'Vehicle',
            [
              ['fact', 'text'],
              ['value', 'number'],
            ],
            own.vehicle.map(([name, value]) => [name, given(value, vehicleUnit(name))]),
          )
        : null,
      table(
        'Sensors',
        [
          ['name', 'text'],
          ['location', 'text'],
          ['axis', 'text'],
          ['quantity', 'text'],
        ],
        own.sensors.map((sensor) => [sensor.name, sensor.location, sensor.axis, sensor.quantity]),
      ),
    ),
    h(
      'p',
      {},
      `Fit of ${fit.model}: ${own.settings.starts} starts, ${fit.evaluations} evaluations; sensor gains have a standard deviation of ${percent(own.settings.gain_error)}. Study of ${campaign} by qcar ${own.version} in ${number(own.seconds, 2)} s, of which discovery took ${number(discover.seconds, 2)} s.`,
    ),
  );
  return { element };
}

function driveText(parts) {
  return parts.map(({ what, value, unit }) => `${what} ${given(value, unit)}`).join(', ');
}

function vehicleUnit(name) {
  if (name.startsWith('m_')) return 'kg';
  if (name === 'static_tire_load') return 'N';
  if (name === 'gravity') return 'm/s^2';
  return /^(r_|static_tire_def|wheelbase)/.test(name) ? 'm' : '1';
}
