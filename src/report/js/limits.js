// What the model cannot say, from what it is and from what was measured.

function limits(data) {
  const own = Object.values(data.fit.parameters);
  const reason = (parameter) => parameter.why_no_stderr && parameter.why_no_stderr.reason;
  const names = (wanted) =>
    own.filter((parameter) => reason(parameter) === wanted && !parameter.curve).map((parameter) => parameter.name);
  const curves = own.filter((parameter) => parameter.curve).map((parameter) => parameter.name);
  const loose = own.filter((parameter) => parameter.relative_stderr > 0.05).map((parameter) => parameter.name);
  const sentences = [
    listed(names('not_seen'), 'The rig fit does not see {}: its tables and rides hold start values there.'),
    listed(curves, 'The rig fit does not see {}: its tables and rides hold what the K&C curves say.'),
    listed(names('only_together'), 'The data determine {} only in combination.'),
    listed(names('at_bound'), '{} rest on a bound of their range, and have no error bar.'),
    listed(loose, 'The relative standard error of {} is above 5 %.'),
    data.record.runs.some((run) => run.role === 'held_out')
      ? null
      : 'No run is held out, so nothing here has been judged on data that the fit has not seen.',
    data.kc.length ? null : 'There are no K&C curves: friction and static stiffness have not been compared.',
    data.track ? null : 'There are no cleat runs: what the tyre does while it rolls has not been compared.',
    ...data.discover.effects.map(unseen),
    'Bodies move along z and x, without pitch and roll; the two directions meet in the rolling tyre alone.',
    'Before an effect is added the model is linear on the rig: its parameters are those that fit best at the levels driven, and the other levels show how far that carries.',
    'The residual counts what the sensors saw between the lowest and the highest frequency of the runs. An effect that acts elsewhere is not excluded.',
  ].filter((sentence) => sentence);
  return {
    element: section(
      'limits',
      'What the model cannot say',
      h(
        'ul',
        { class: 'limits' },
        sentences.map((sentence) => h('li', {}, sentence)),
      ),
    ),
  };
}

function listed(names, sentence) {
  return names.length ? sentence.replace('{}', names.join(', ')) : null;
}

function unseen(effect) {
  const names = Object.keys(effect.parameters).filter((name) => effect.stderr[name] === null);
  return listed(names, `Of ${words(effect.name)}, the data do not see {}; those keep their start values.`);
}
