// The ratios of the rig, computed anew in the page while a parameter is moved.

// The steps of a slider.
const STEPS = 1000;

// Values beyond such a ratio of the ends of a range are spread by their logarithm.
const WIDE = 20;

// What a slider moves: what the fit has estimated, has a range and moves one of the ratios.
function movable({ fit, refitted }, ratios) {
  const estimated = refitted.length
    ? refitted.filter(({ stderr }) => stderr !== null)
    : Object.values(fit.parameters).filter(({ fitted }) => fitted);
  const names = estimated.map(({ name }) => name);
  const moves = ({ name, value, range }) =>
    ratios.some((ratio) => {
      const other = range.find((end) => end !== value);
      const [found, moved] = [{}, { [name]: other }].map((given) => polar(ratio, given).magnitude);
      return found.some((own, at) => own !== moved[at]);
    });
  return PROGRAM.about.parameters.filter((own) => names.includes(own.name) && own.range && !own.follows && moves(own));
}

// Details that are closed until a reader wants them; only then are their figures made.
function sliders(data) {
  if (!PROGRAM || view.printing) return { element: null };
  const run = data.rig[0].run;
  const ratios = data.rig.filter((ratio) => ratio.run === run);
  const parameters = movable(data, ratios);
  if (!parameters.length) return { element: null };
  const place = h('div', { class: 'columns' });
  let charts = [];
  const moved = () => charts.forEach((pair, at) => redrawn(pair, polar(ratios[at], view.tried)));
  const part = details(
    'Try other values',
    h(
      'p',
      {},
      `The linear response of the ${data.refitted.length ? 'extended' : 'baseline'} model, computed in this page: `,
      key('tried', 'with your values'),
      ', with the ',
      key('found', 'values that were found'),
      ', and as ',
      key('measured', 'measured'),
      ` in ${runName(run)}.`,
    ),
    sliderList(parameters, moved),
    place,
  );
  const draw = () => {
    if (charts.length || !part.open) return;
    const columns = ratios.map(triedFigure);
    place.replaceChildren(...columns);
    charts = ratios.map((ratio, at) => triedPlots(ratio, columns[at]));
  };
  part.addEventListener('toggle', draw);
  return { element: part, draw };
}

function sliderList(parameters, moved) {
  const rows = parameters.map((parameter) => slider(parameter, moved));
  const reset = () => {
    view.tried = {};
    rows.forEach((row) => row.show());
    moved();
  };
  return h(
    'div',
    { class: 'sliders' },
    rows.map((row) => row.element),
    h('button', { type: 'button', onclick: reset }, 'Back to the values that were found'),
  );
}

function slider(parameter, moved) {
  const { name, unit, value, doc } = parameter;
  const place = places(parameter);
  const current = () => (view.tried[name] === undefined ? value : view.tried[name]);
  const shown = h('output', {});
  const input = h('input', { type: 'range', min: 0, max: STEPS, step: 1, 'aria-label': doc ? `${name}: ${doc}` : name });
  const told = () => {
    shown.textContent = quantity(current(), unit, 4);
    input.setAttribute('aria-valuetext', shown.textContent);
  };
  const show = () => {
    input.value = place.of(current());
    told();
  };
  input.addEventListener('input', () => {
    view.tried[name] = place.at(Number(input.value));
    told();
    moved();
  });
  show();
  return { element: h('label', { title: doc || null }, h('span', {}, formula(name)), input, shown), show };
}

// The values at the steps of a slider, and the step of a value.
function places({ range: [low, high] }) {
  const isWide = low > 0 && high / low > WIDE;
  const [there, back] = isWide ? [Math.log, Math.exp] : [(v) => v, (v) => v];
  const [from, to] = [there(low), there(high)];
  return {
    at: (step) => back(from + ((to - from) * step) / STEPS),
    of: (value) => Math.round((STEPS * (there(value) - from)) / (to - from)),
  };
}

function triedFigure(ratio) {
  return h(
    'div',
    { class: 'column' },
    h('h3', {}, channelName(ratio.channel)),
    ['magnitude', 'phase'].map((part) =>
      figure(`tried-${part}`, `Other values: ${part} of ${channelName(ratio.channel)}`, h('div', { class: 'canvas' })),
    ),
  );
}

function triedPlots(ratio, column) {
  const [found, tried] = [polar(ratio, {}), polar(ratio, view.tried)];
  const curves = (part) => [
    { role: 'measured', values: ratio.measured[part] },
    { role: 'found', values: found[part] },
    { role: 'tried', values: tried[part] },
  ];
  return polarPlots(column, { at: ratio.frequency, sync: 'tried', curves });
}

// The last curve of each plot is the one that moves; what is shown of the frequencies stays.
function redrawn(charts, { magnitude, phase }) {
  [magnitude, phase].forEach((values, at) => {
    charts[at].setData([...charts[at].data.slice(0, -1), values], false);
    charts[at].redraw(true, true);
  });
}

// Magnitude in dB and phase in degrees, on the turn of the measured one.
function polar({ channel, frequency, measured: beside }, given) {
  const { re, im } = PROGRAM.response(channel, given, frequency);
  const turn = (phase, other) => (other === null ? phase : phase + 360 * Math.round((other - phase) / 360));
  return {
    magnitude: re.map((own, at) => 20 * Math.log10(Math.hypot(own, im[at]))),
    phase: re.map((own, at) => turn((Math.atan2(im[at], own) * 180) / Math.PI, beside.phase[at])),
  };
}
