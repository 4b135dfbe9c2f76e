// The answer first.

function verdict(data) {
  const { summary, discover } = data;
  const element = section(
    'verdict',
    'Verdict',
    h('p', { class: 'lead' }, lead(data)),
    h('p', {}, consequence(discover, summary, data.kappa[0])),
    h('div', { class: 'answers' }, [
      fitAnswer(data),
      cleatAnswer(data),
      gapAnswer(discover),
      ...discover.effects.map((effect) => effectAnswer(effect, discover.effects)),
    ]),
  );
  return { element };
}

function lead({ summary, discover }) {
  if (summary.verdict === 'found') return `Missing: ${discover.effects.map(placed).join(', and ')}.`;
  return `${words(summary.missing.charAt(0).toUpperCase() + summary.missing.slice(1))}.`;
}

function consequence(discover, { verdict: kind }, likely) {
  const judged =
    discover.gap.held_out.before !== null ? ['held-out', discover.gap.held_out] : ['fitted', discover.gap.fit];
  const [which, gap] = judged;
  const before = `${number(gap.before)} times its uncertainty`;
  const [best, ...alike] = discover.effects.filter((effect) => effect.one_of);
  const [chosen] = best ? [best] : discover.effects;
  const rival = chosen && chosen.rivals[0];
  const next = rival
    ? ` The next best explanation, ${words(rival.effect)} at ${words(rival.at)}, is lower by ${number(rival.behind, 2)} in the logarithm of the evidence.`
    : '';
  const place = likely
    ? ` Something at ${words(likely.place)} could explain up to ${percent(likely.ceiling)} of what it leaves of the sweeps.`
    : '';
  switch (kind) {
    case 'none':
      return `On ${which} runs the model leaves a gap of ${before}; 1 is noise. No effect of the catalogue is called for.`;
    case 'found':
      return `On ${which} runs the model left a gap of ${before}; with what was missing, ${number(gap.after)} is left, and 1 is noise.${next}`;
    case 'class':
      return `On ${which} runs the model left a gap of ${before}; with ${added(discover.effects)} ${number(gap.after)} is left, and 1 is noise. With ${alike.map(placed).join(' or ')} instead the fitted runs are explained as well, so that no model file is written.${next}`;
    default:
      return `On ${which} runs the model leaves a gap of ${before}, and nothing in the catalogue closes it. The map below shows where it is.${place}`;
  }
}

function placed(effect) {
  return `${words(effect.name)} at ${words(effect.at)}`;
}

// Of several that the data cannot tell apart it is one.
function effectTitle(effect, effects) {
  if (!effect.one_of) return placed(effect);
  return `${effect === oneOf(effects) ? 'Either' : 'Or'} ${placed(effect)}`;
}

// The best of those.
function oneOf(effects) {
  return effects.find((effect) => effect.one_of);
}

// What the model after has beside the one before; `null` where that is nothing.
function added(effects) {
  const own = effects.filter((effect) => !effect.one_of || effect === oneOf(effects));
  if (!own.length) return null;
  return oneOf(effects) ? own.map(placed).join(' and ') : 'what was missing';
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
  return answer('Gap over its uncertainty', line('fitted', gap.fit), line('held out', gap.held_out));
}

function effectAnswer(effect, effects) {
  const lines = Object.entries(effect.parameters)
    .filter(([name]) => effect.stderr[name] !== null)
    .map(([name, value]) =>
      h('p', {}, h('span', { class: 'what' }, name), ' ', measured(value, effect.stderr[name], effect.units[name])),
    );
  return answer(effectTitle(effect, effects), lines);
}
