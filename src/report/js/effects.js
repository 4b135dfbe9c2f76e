// Each effect that was found, with its rivals; if none was found, the learned laws or the detection limits.

function effectPart(effect, effects) {
  return h(
    'div',
    {},
    h('h3', {}, effectTitle(effect, effects)),
    h('p', {}, explainedPart(effect.evidence.gap_closed)),
    h('div', { class: 'columns two' }, strengthTable('What it is', effect), rivalTable(effect.rivals)),
  );
}

function explainedPart(share) {
  return share === null
    ? 'The judging runs leave no residual of the baseline model above noise, so there is nothing to explain.'
    : `It explains ${percent(share, 3)} of the residual of the baseline model above noise, on the judging runs.`;
}

function strengthTable(title, { parameters, stderr, units }) {
  const rows = Object.entries(parameters).map(([name, value]) => {
    const [error, unit] = [stderr[name], units[name]];
    return [
      name,
      error === null ? quantity(value, unit) : measured(value, error, unit),
      error === null ? 'not determined by these data' : percent(error / Math.abs(value)),
    ];
  });
  return table(
    title,
    [
      ['parameter', 'text'],
      ['value', 'number'],
      ['standard error', 'text'],
    ],
    rows,
  );
}

function rivalTable(rivals) {
  if (!rivals.length) return null;
  return table(
    'Rivals and their probability relative to the answer, before their fits had converged',
    [
      ['effect', 'text sentence'],
      ['probability', 'text sentence'],
    ],
    rivals.map((rival) => [`${words(rival.effect)} at ${words(rival.at)}`, odds(rival.behind)]),
  );
}

// A law describes the axle's behaviour without a physical cause.
function learnedPart({ laws, explained, gap }) {
  const judged = gap.held_out.before === null ? gap.fit : gap.held_out;
  return h(
    'div',
    {},
    h('h3', {}, 'Learned from the data'),
    h(
      'p',
      {},
      `This law has no physical cause${explained === null ? '' : `, but explains ${percent(explained, 3)} of the residual above noise`}: the residual falls from ${number(judged.before)} to ${number(judged.after)} standard deviations with`,
    ),
    laws.map((law) => [
      h('h4', {}, placed(law)),
      h('p', {}, `${law.words}.`),
      details(`Coefficients of the ${placed(law)}`, strengthTable(placed(law), law)),
    ]),
  );
}

// If no effect is missing: an effect whose usual size is below the detection limit may be present without being seen.
function visiblePart(visible) {
  if (!visible.length) return null;
  const sizes = ({ usual }) => Object.entries(usual).map(([name, value]) => `${name} ${number(value)}`);
  return details(
    'How clearly an effect of usual size would have been seen',
    h('p', {}, 'The usual size of each effect divided by the smallest size that would certainly be found. Below 1 an effect may be present without being seen. SI units.'),
    table(
      'Usual size over the smallest certain size',
      [
        ['effect', 'text'],
        ['usual size', 'text sentence'],
        ['over the limit', 'number'],
      ],
      visible.map((own) => [placed(own), sizes(own).join(', '), number(own.times_the_limit)]),
    ),
  );
}
