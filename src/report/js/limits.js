// Limits of these results, from the model and from the measurements.

function limits(data) {
  const own = Object.values(data.fit.parameters);
  const reason = (parameter) => parameter.why_no_stderr && parameter.why_no_stderr.reason;
  const names = (wanted) =>
    own.filter((parameter) => reason(parameter) === wanted && !parameter.curve).map((parameter) => parameter.name);
  const curves = own.filter((parameter) => parameter.curve).map((parameter) => parameter.name);
  const loose = own.filter((parameter) => parameter.relative_stderr > 0.05).map((parameter) => parameter.name);
  const sentences = [
    listed(names('not_seen'), 'The rig runs do not determine {}: tables and rides of the rig fit use start values.'),
    listed(curves, 'The rig runs do not determine {}: tables and rides of the rig fit use the values from K&C curves.'),
    listed(names('only_together'), 'The data determine {} only in combination.'),
    listed(names('at_bound'), '{} are at a bound of their range and have no standard error.'),
    listed(loose, 'The relative standard error of {} is above 5 %.'),
    data.record.runs.some((run) => run.role === 'held_out')
      ? null
      : 'No run is held out, so nothing here was checked on data that were not fitted.',
    data.kc.length ? null : 'There are no K&C curves, so friction and static stiffness were not compared.',
    data.track ? null : 'There are no cleat runs, so the rolling tyre was not compared.',
    ...data.discover.effects.map(unseen),
    motions(data),
    data.axles.before.linear
      ? 'Before an effect is added the model is linear on the rig: its parameters fit best at the fitted levels, and the other levels show how far that holds.'
      : null,
    'The residual covers the sensors between the lowest and the highest frequency of the runs. Effects outside that band are not excluded.',
  ].filter((sentence) => sentence);
  return {
    element: section(
      'limits',
      'Limits of these results',
      h(
        'ul',
        { class: 'limits' },
        sentences.map((sentence) => h('li', {}, sentence)),
      ),
    ),
  };
}

// What the parts of the model do. Laws couple directions only in a nonlinear model.
function motions({ axles, track: rolled }) {
  const { points, linear } = axles.after || axles.before;
  const moving = points.filter(({ kind }) => kind === 'mass' || kind === 'node');
  const axes = [...new Set(moving.filter(({ angle }) => !angle).map(({ axis }) => axis))];
  const turning = [...new Set(moving.filter(({ angle }) => angle).map(({ name }) => words(name)))];
  if (!axes.length) return null;
  const turns = turning.length ? ` and turn by ${turning.join(', ')} only` : ', without pitch and roll';
  const coupled = axes.length > 1 && rolled && linear ? '; only the rolling tyre couples the directions' : '';
  return `Bodies move along ${axes.join(' and ')}${turns}${coupled}.`;
}

function listed(names, sentence) {
  return names.length ? sentence.replace('{}', names.join(', ')) : null;
}

function unseen(effect) {
  const names = Object.keys(effect.parameters).filter((name) => effect.stderr[name] === null);
  return listed(names, `Of ${words(effect.name)}, the data do not determine {}; those keep their start values.`);
}
