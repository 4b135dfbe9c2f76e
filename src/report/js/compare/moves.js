// The parameters of both sides, those that differ most first.

function moves({ parameters: all }) {
  const differing = all.filter((own) => own.moved || own.a === null || own.b === null);
  const equal = all.filter((own) => !differing.includes(own) && own.tied_to === null);
  const size = (own) => (own.relative === null ? -1 : Math.abs(own.relative));
  differing.sort((first, second) => size(second) - size(first));
  const known = differing.some((own) => own.standard_errors !== null);
  const most = Math.max(...differing.map((own) => (own.relative === null ? 0 : Math.abs(own.relative))));
  const element = section(
    'moves',
    'Parameters',
    h(
      'p',
      {},
      'Of ',
      bothKeys(),
      ', the largest change first; parameters that only one side has come last.',
      known
        ? ' The last column is the difference divided by the combined standard error of both fits: above 2 it is hardly due to chance.'
        : null,
    ),
    differing.length ? moveTable('What differs', differing, known, most) : null,
    equal.length
      ? details(
          `${equal.length} that ${equal.length === 1 ? 'is' : 'are'} equal`,
          table(
            'Equal parameters',
            [
              ['parameter', 'text'],
              ['value', 'number'],
            ],
            equal.map((own) => [described(own), given(own.a, own.unit)]),
          ),
        )
      : null,
  );
  return { element };
}

function moveTable(title, rows, known, most) {
  const side = (value, error, unit) => {
    if (value === null) return '–';
    return error === null ? given(value, unit) : measured(value, error, unit);
  };
  return table(
    title,
    [
      ['parameter', 'text'],
      ['A', 'number'],
      ['B', 'number'],
      ['difference', 'number'],
      ['change', 'number'],
      ['', 'text'],
      ...(known ? [['standard errors', 'number']] : []),
    ],
    rows.map((own) => [
      described(own),
      h('span', { class: 'before' }, side(own.a, own.stderr_a, own.unit)),
      h('span', { class: 'after' }, side(own.b, own.stderr_b, own.unit)),
      own.difference === null ? '–' : quantity(own.difference, own.unit),
      signed(own.relative),
      changeBar(own.relative, most),
      ...(known ? [own.standard_errors === null ? '–' : number(own.standard_errors, 2)] : []),
    ]),
  );
}

// A parameter's name above its sentence.
function described({ name, doc }) {
  return [name, h('span', { class: 'doc' }, doc)];
}
