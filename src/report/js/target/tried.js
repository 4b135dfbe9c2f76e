// Sliders for the parameters of the design: they change the metrics of the targets to first order and, for a linear model, the ratios that it
// declares.

// Hz.
const TRIED_BAND = [0.5, 30];
const TRIED_LINES = 200;

function tried(data) {
  const { parameters } = data;
  const beside = estimates(data);
  if (!PROGRAM && !beside) return noSliders();
  const rides =
    'Rides are not computed in this page: metrics are estimated by their elasticities at the design, so trust small changes only. qcar sensitivity with --set NAME=VALUE computes them.';
  const knobs = parameters.map((own) => ({ ...own, value: own.design, gives: () => ({}) }));
  if (!PROGRAM) return sliders({ says: rides, knobs, ratios: [], beside });
  return sliders({ ...responses(data), beside, says: [beside ? `${rides} ` : null, responses(data).says] });
}

// Each target with its value at the design, and the estimate from its elasticities for other values.
function estimates({ targets, parameters, elasticities }) {
  if (!elasticities.length) return null;
  const columns = [
    ['target', 'text'],
    ['run', 'text'],
    ['limit', 'number'],
    ['design', 'number'],
    ['your values', 'number'],
    ['', 'text'],
  ];
  const places = targets.map(() => [h('span', { class: 'tried' }), h('span', {})]);
  const rows = targets.map((own, at) => [
    own.metric,
    own.run ? runName(own.run) : '',
    limitOf(own),
    quantity(own.design, own.unit),
    ...places[at],
  ]);
  const moved = (values) =>
    targets.forEach((own, at) => {
      const [value, word] = places[at];
      const estimate = own.design * estimated(elasticities[at], values, parameters);
      value.textContent = quantity(estimate, own.unit);
      word.textContent = beyond(own, estimate) <= SLACK ? 'met' : 'missed';
    });
  return { element: table('Estimates of the targets', columns, rows), moved };
}

// A target that exceeds its limit by at most this share counts as met.
const SLACK = 5e-5;

function beyond({ sense, limit }, value) {
  return ((sense === 'at_most' ? 1 : -1) * (value - limit)) / (Math.abs(limit) || 1);
}

// The factor by which a metric changes: a power of each parameter that keeps its sign, otherwise linear.
function estimated(elasticities, values, parameters) {
  return values.reduce((factor, value, k) => {
    const part = parameters[k].design === 0 ? 1 : value / parameters[k].design;
    return factor * (part > 0 ? part ** elasticities[k] : 1 + elasticities[k] * (part - 1));
  }, 1);
}

function responses({ parameters, moves }) {
  const given = (place, value) =>
    Object.fromEntries(
      moves.filter((own) => own.variable === place).map((own) => [own.parameter, own.factor * value + own.constant]),
    );
  const today = Object.assign({}, ...parameters.map((own, place) => given(place, own.today)));
  const [from, to] = TRIED_BAND;
  const frequency = [...Array(TRIED_LINES).keys()].map((line) => from * (to / from) ** (line / (TRIED_LINES - 1)));
  const channels = PROGRAM.about.channels.filter(({ denominator }) => denominator.row === null);
  return {
    says: [
      'The linear response, computed in this page: ',
      key('tried', 'with your values'),
      ', of ',
      key('before', 'today'),
      ' and of ',
      key('after', 'the design'),
      '.',
    ],
    knobs: parameters.map((own, place) => ({ ...own, value: own.design, gives: (value) => given(place, value) })),
    ratios: channels.map(({ name, unit }) => {
      const ratio = { channel: name, unit, frequency };
      const [before, after] = [polar(ratio, today), polar(ratio, {})];
      const curves = (part) => [
        { role: 'before', label: 'today', values: before[part] },
        { role: 'after', label: 'design', values: after[part] },
      ];
      return { ...ratio, curves };
    }),
  };
}
