// The fitted parameters: values, standard errors, correlations and why an error is unknown.

function parameters({ fit, refitted, correlations: pairs, other_minima: otherMinima }) {
  const own = Object.values(fit.parameters);
  const changed = refitted.length > 0;
  const rows = own.map((parameter) => {
    const row = [
      parameter.name,
      given(parameter.start, parameter.unit),
      parameter.stderr === null
        ? quantity(parameter.value, parameter.unit, 4)
        : measured(parameter.value, parameter.stderr, parameter.unit),
      parameter.relative_stderr === null ? '' : percent(parameter.relative_stderr),
      rangeBar(parameter, found(refitted, parameter.name)),
      remark(parameter),
      ...(changed ? [refittedCell(found(refitted, parameter.name), parameter.unit)] : []),
    ];
    row.class = parameter.fitted ? null : 'still';
    return row;
  });
  const ended = `${fit.converged ? 'Converged' : 'Did not converge'}: ${fit.stopped}.${searched(fit, otherMinima)}`;
  const element = section(
    'parameters',
    'Parameters',
    h('p', {}, `Of the baseline model, ${fit.model}, fitted to the rig runs. ${ended}`),
    changed
      ? h(
          'p',
          { class: 'caution' },
          'As long as an effect is missing, the fitted values are biased by it. The last column has those of the extended model, fitted to all runs with the role fit.',
        )
      : null,
    table(
      'Fitted parameters',
      [
        ['parameter', 'text'],
        ['start', 'number'],
        ['baseline ± standard error', 'number'],
        ['relative', 'number'],
        ['in its range', 'text'],
        ['remark', 'text sentence'],
        ...(changed ? [['extended', 'number']] : []),
      ],
      rows,
    ),
    correlations(fit.correlations),
    pairs.length ? details('All correlations', correlationMap(pairs)) : null,
  );
  return { element };
}

// Where the searches ended. `others` is the number of other minima of a fit to all runs as they are, null for a fit to transmissibilities, which
// has a cost.
function searched({ minima, starts, cost, start_cost: before }, others) {
  const count = `${starts} ${starts === 1 ? 'start' : 'starts'}`;
  if (others !== null) return ` ${count} found ${others || 'no'} other ${others > 1 ? 'minima' : 'minimum'}.`;
  if (!minima.length) return '';
  return ` ${minima[0].starts} of ${count} found this minimum, cost ${number(cost)} (${number(before)} at the start values).`;
}

function remark({ at_bound: bound, tied_to: tied, why_no_stderr: why, relative_stderr: relative, curve }) {
  if (bound) return `at the ${bound} end of its range`;
  if (tied) return `as ${tied}`;
  if (curve) return `from the K&C ${curve} curve${why ? `, ${WHY[why.reason](why)}` : ''}`;
  if (why) return WHY[why.reason] ? WHY[why.reason](why) : words(why.reason);
  return relative > 0.05 ? 'poorly determined' : '';
}

const WHY = {
  known: () => 'known, not fitted',
  tied: () => 'takes the value of another',
  not_seen: () => 'no fitted channel depends on it',
  at_bound: () => 'at its bound',
  only_together: (why) => `determined only together with ${why.with.join(', ')}`,
  not_converged: () => 'the search did not end at a minimum',
};

function found(refitted, name) {
  return refitted.find((own) => own.name === name) || null;
}

function refittedCell(own, unit) {
  if (!own || own.stderr === null) return '';
  return h('span', { class: 'after' }, measured(own.value, own.stderr, unit));
}

// Position of a value between its bounds, with its start value.
function rangeBar({ range, value, start, fitted, unit }, after) {
  if (!range || !fitted) return '';
  const at = (v) => `${(100 * Math.min(1, Math.max(0, (v - range[0]) / (range[1] - range[0])))).toFixed(1)}%`;
  return h(
    'span',
    { class: 'range', role: 'img', 'aria-label': `between ${given(range[0], unit)} and ${given(range[1], unit)}` },
    h('span', { class: 'tick start', style: `left:${at(start)}` }),
    h('span', { class: 'tick before', style: `left:${at(value)}` }),
    after && h('span', { class: 'tick after', style: `left:${at(after.value)}` }),
  );
}

function correlations(pairs) {
  if (!pairs.length) return h('p', {}, 'No two estimates have a correlation above 0.9.');
  return table(
    'Estimates with a correlation above 0.9',
    [
      ['parameters', 'text'],
      ['correlation', 'number'],
    ],
    pairs.map(({ between, value }) => [between.join(' and '), number(value)]),
  );
}

// All pairs: the colour shows the sign of the correlation, its strength the magnitude.
function correlationMap(pairs) {
  const names = [...new Set(pairs.flatMap(({ between }) => between))];
  const value = (a, b) => {
    const pair = pairs.find(({ between }) => between.includes(a) && between.includes(b));
    return pair ? pair.value : 0;
  };
  const cell = (r) =>
    h(
      'span',
      { class: r < 0 ? 'negative' : 'positive', style: `--share: ${(45 * Math.abs(r)).toFixed(0)}%` },
      minus(r.toFixed(2)),
    );
  return table(
    'Correlations of the estimates',
    [['', 'text'], ...names.map((name) => [name, 'number'])],
    names.map((a) => [a, ...names.map((b) => (a === b ? h('span', {}, '1') : cell(value(a, b))))]),
    { class: 'table matrix' },
  );
}
