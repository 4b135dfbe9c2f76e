// The verdict and the key numbers, at the top of the report.

function verdict(data) {
  const { summary, discover } = data;
  const falling = fallingFit(data);
  const element = section(
    'verdict',
    'Verdict',
    h('p', { class: 'lead' }, lead(data)),
    h('p', {}, consequence(discover, summary, data.kappa[0])),
    falling && h('p', { class: 'caution' }, falling),
    h('div', { class: 'answers' }, [
      fitAnswer(data),
      cleatAnswer(data),
      gapAnswer(discover),
      leftAnswer(discover),
      ...discover.effects.map((effect) => effectAnswer(effect, discover.effects)),
    ]),
  );
  return { element };
}

// A value before and after in the colours of both.
function step(what, before, after) {
  return h(
    'p',
    {},
    h('span', { class: 'what' }, what),
    ' ',
    h('span', { class: after === null ? '' : 'before' }, before),
    after === null
      ? null
      : [h('span', { class: 'arrow', 'aria-label': 'to' }, ' → '), h('span', { class: 'after' }, after)],
  );
}

function mean(values) {
  return values.length ? values.reduce((sum, value) => sum + value, 0) / values.length : null;
}

function fitAnswer({ rig: ratios }) {
  const roles = ['fit', 'held_out'].map((role) => [role, ratios.filter((ratio) => ratio.role === role)]);
  const lines = roles
    .filter(([, own]) => own.length)
    .map(([role, own]) => {
      const after = own.every((ratio) => ratio.quality_after)
        ? mean(own.map((ratio) => ratio.quality_after.fit_magnitude))
        : null;
      return step(
        role === 'fit' ? 'fitted' : 'held out',
        `${number(mean(own.map((r) => r.quality_before.fit_magnitude)))} %`,
        after === null ? null : `${number(after)} %`,
      );
    });
  return answer('Rig fit, magnitude', lines);
}

function cleatAnswer({ simulate }) {
  if (!simulate) return null;
  const of = (metric) => {
    const median = (set) =>
      set && set.summary.body_z && set.summary.body_z[metric] ? set.summary.body_z[metric].median : null;
    return [median(simulate.before), median(simulate.after)];
  };
  const line = (what, [before, after]) => step(what, percent(before), after === null ? null : percent(after));
  return answer('Cleat error, body z, median', line('peak', of('peak')), line('after-shake', of('after_shake')));
}

function gapAnswer({ gap, effects }) {
  const line = (what, { before, after }) =>
    before === null ? null : step(what, number(before), effects.length ? number(after) : null);
  return answer('Residual, standard deviations', line('fitted', gap.fit), line('held out', gap.held_out));
}

// The sensors with the largest residuals.
function leftAnswer({ left, effects }) {
  const most = [...left].sort((a, b) => b.before_percent - a.before_percent).slice(0, 2);
  const size = (value) => `${number(value, 2)} %`;
  return answer(
    'Residual of the worst sensors, % of signal',
    most.map((own) =>
      step(
        `${words(own.channel)}, ${LEFT_IN[own.kind]}`,
        size(own.before_percent),
        effects.length ? size(own.after_percent) : null,
      ),
    ),
  );
}

function effectAnswer(effect, effects) {
  const lines = Object.entries(effect.parameters)
    .filter(([name]) => effect.stderr[name] !== null)
    .map(([name, value]) =>
      h('p', {}, h('span', { class: 'what' }, name), ' ', measured(value, effect.stderr[name], effect.units[name])),
    );
  return answer(effectTitle(effect, effects), lines);
}
