// The targets, met or missed, and by how much.

function wanted(data) {
  const required = data.targets.filter((own) => own.wish === null);
  const missed = required.filter((own) => !own.met);
  const all = required.length < data.targets.length ? 'targets that must hold' : 'targets';
  const lead = data.met
    ? `All ${all} are met, at a cost of ${number(data.cost)}.`
    : `No design was found that meets all ${all}: the best misses ${missed.length} of ${required.length}.`;
  const columns = [
    ['target', 'text'],
    ['run', 'text'],
    ['limit', 'number'],
    ['today', 'number'],
    ['design', 'number'],
    ...(data.uncertainty ? [['95 %', 'text'], ['holds', 'number']] : []),
    ['', 'text'],
    ['beyond the limit', 'number'],
    ['multiplier', 'number'],
    ...(data.space ? [['met in space', 'number']] : []),
  ];
  const row = (own) => {
    const cells = [
      own.metric,
      own.run ? runName(own.run) : '',
      limitOf(own),
      h('span', { class: 'before' }, quantity(own.today, own.unit)),
      h('span', { class: 'after' }, quantity(own.design, own.unit)),
      ...(data.uncertainty ? [interval(own), own.holds === null ? '–' : percent(own.holds, 3)] : []),
      judgedWord(own),
      signed(own.excess),
      number(own.multiplier, 2),
      ...(data.space ? [percent(own.in_space, 3)] : []),
    ];
    return cells;
  };
  const element = section(
    'targets',
    'Targets',
    h('p', { class: 'lead' }, lead),
    h(
      'p',
      {},
      'Of ',
      key('before', 'today'),
      ' and ',
      key('after', 'the design'),
      data.met
        ? '. A multiplier is the rate at which the cost falls as the limit is loosened, per 100 % of the limit.'
        : '. A multiplier is the share of a target in the conflict.',
    ),
    table('Targets', columns, data.targets.map(row)),
    data.uncertainty ? h('p', {}, uncertaintyNote(data.uncertainty)) : null,
  );
  return { element };
}

function limitOf({ sense, limit, unit, wish }) {
  return `${sense === 'at_most' ? '≤' : '≥'} ${quantity(limit, unit)}${wish === null ? '' : ' (wish)'}`;
}

function judgedWord(own) {
  if (own.met) return 'met';
  return own.wish === null ? h('strong', {}, 'missed') : 'wish missed';
}

function interval(own) {
  return own.uncertainty ? own.uncertainty.interval.map((value) => quantity(value, own.unit)).join(' … ') : '–';
}

// The uncertainty of the parameters, and how often the design meets the targets.
function uncertaintyNote({ all, draws, wanted, parameters }) {
  const by = Object.entries(parameters)
    .filter(([, names]) => names.length)
    .map(([source, names]) => `${source} (${names.join(', ')})`);
  const asked = wanted === null ? '' : ` Each target shall hold with a probability of ${percent(wanted, 3)}; the excess over the limit includes the margin for that.`;
  return `With uncertain parameters, the design meets all targets that must hold in ${percent(all, 3)} of ${draws} draws.${asked} Sources of uncertainty: ${by.join(', ')}.`;
}
