// The largest changes and their consequences, in a few numbers.

function summary(data) {
  const element = section(
    'summary',
    'What moved',
    h('p', { class: 'lead' }, movedSentence(data)),
    h('div', { class: 'answers' }, [
      largestMoves(data.parameters),
      largestShifts(data.modes),
      largestRatios(data.transmissibility),
      cleatChanges(data.cleat),
    ]),
    data.notices.length ? data.notices.map((notice) => h('p', { class: 'caution' }, notice)) : null,
  );
  return { element };
}

function movedSentence({ parameters: all, changes }) {
  const moved = all.filter((own) => own.moved);
  const lonely = all.filter((own) => own.a === null || own.b === null);
  const parts = Object.values(changes).reduce((sum, own) => sum + own.length, 0);
  const first = moved.length
    ? `${moved.length} of ${all.length} parameters ${moved.length === 1 ? 'differs' : 'differ'}`
    : 'No parameter differs';
  const second = lonely.length
    ? `, ${lonely.length} ${lonely.length === 1 ? 'belongs' : 'belong'} to one of the models alone`
    : '';
  return `${first}${second}${parts && !lonely.length ? ', and the models differ' : ''}.`;
}

function bySize(value) {
  return (first, second) => Math.abs(value(second)) - Math.abs(value(first));
}

// The three largest of a kind.
function largest(title, all, value, line) {
  const known = all.filter((own) => value(own) !== null && value(own) !== undefined && value(own) !== 0);
  const lines = known.sort(bySize(value)).slice(0, 3).map(line);
  const row = ([what, text]) => h('p', {}, h('span', { class: 'what' }, what), ' ', text);
  return lines.length ? answer(title, lines.map(row)) : null;
}

function largestMoves(parameters) {
  const moved = parameters.filter((own) => own.moved);
  return largest('Parameters, B against A', moved, (own) => own.relative, (own) => [own.name, signed(own.relative)]);
}

function frequencyShift({ a, b }) {
  return a && b ? b.frequency / a.frequency - 1 : null;
}

// The frequency of a strongly damped mode says little.
function largestShifts(pairs) {
  const lively = pairs.filter(({ a, b }) => a && b && Math.max(a.damping, b.damping) < 0.5);
  return largest('Natural frequencies', lively, frequencyShift, (own) => [
    `${number(own.a.frequency)} Hz`,
    signed(frequencyShift(own)),
  ]);
}

// Changes of the measured values, if both sides were measured.
function largestRatios(channels) {
  const byChannel = new Map();
  const known = channels.map(({ channel, change, measured: own }) => ({ channel, ...(own || change) }));
  known
    .filter((own) => own.magnitude !== undefined)
    .sort(bySize((own) => own.magnitude))
    .forEach((own) => byChannel.has(own.channel) || byChannel.set(own.channel, own));
  const title = channels.some((own) => own.measured) ? 'Transmissibility, measured' : 'Transmissibility';
  return largest(title, [...byChannel.values()], (own) => own.magnitude, (own) => [
    `${channelName(own.channel)} at ${number(own.frequency)} Hz`,
    decibels(own.magnitude),
  ]);
}

function decibels(value) {
  return `${value > 0 ? '+' : ''}${number(value, 2)} dB`;
}

function cleatChanges({ summary: simulated, measured: observed }) {
  const summary = observed || simulated;
  const name = summary.body_z ? 'body_z' : Object.keys(summary)[0];
  if (!name) return null;
  const line = (what, spread) =>
    spread && h('p', {}, h('span', { class: 'what' }, what), ' ', signed(spread.median));
  return answer(
    `Cleat, ${words(name)}, median change${observed ? ', measured' : ''}`,
    line('peak', summary[name].peak),
    line('after-shake', summary[name].after_shake),
  );
}
