// Ratios of the model, computed in the page while a slider moves.

// Number of steps of a slider.
const STEPS = 1000;

// A range whose ends differ by more than this factor has a logarithmic slider.
const WIDE = 20;

// The text in place of the sliders of a nonlinear model, whose page has no program.
function noSliders() {
  if (view.printing) return { element: null };
  const words =
    'There are no sliders here: this model is nonlinear, so its response depends on the excitation level and needs a simulation. ' +
    'qcar simulate with --set NAME=VALUE tries other values.';
  return { element: h('p', {}, words) };
}

// Details that are closed until the reader opens them; only then are their figures made. `knobs` are `{name, unit, doc?, value,
// range, gives}`, where `gives` returns the values of parameters; `ratios` are `{channel, unit?, frequency, turns?, curves}`, where
// `curves(part)` are fixed curves; `beside`, `{element, moved}`, is shown next to them and gets the value of every knob.
function sliders({ says, knobs, ratios, beside }) {
  if (view.printing) return { element: null };
  const moving = beside ? knobs : knobs.filter((knob) => ratios.some((ratio) => moves(knob, ratio)));
  if (!moving.length) return { element: null };
  const place = h('div', { class: 'columns' });
  let charts = [];
  const given = () => Object.assign({}, ...moving.map((knob) => givenBy(knob)));
  const moved = () => {
    charts.forEach((pair, at) => redrawn(pair, polar(ratios[at], given())));
    if (beside) beside.moved(moving.map(triedValue));
  };
  const shown = [sliderList(moving, moved), beside ? beside.element : null, place];
  const part = details('Try other values', h('p', {}, says), shown);
  if (beside) beside.moved(moving.map(triedValue));
  const draw = () => {
    if (charts.length || !part.open) return;
    const columns = ratios.map(triedFigure);
    place.replaceChildren(...columns);
    charts = ratios.map((ratio, at) => triedPlots(ratio, given(), columns[at]));
  };
  part.addEventListener('toggle', draw);
  return { element: part, draw };
}

function moves({ value, range, gives }, ratio) {
  const other = range.find((end) => end !== value);
  const [found, moved] = [value, other].map((own) => polar(ratio, gives(own)).magnitude);
  return found.some((own, at) => own !== moved[at]);
}

function triedValue({ name, value }) {
  return view.tried[name] === undefined ? value : view.tried[name];
}

function givenBy({ name, gives }) {
  return view.tried[name] === undefined ? {} : gives(view.tried[name]);
}

function sliderList(knobs, moved) {
  const rows = knobs.map((knob) => slider(knob, moved));
  const reset = () => {
    view.tried = {};
    rows.forEach((row) => row.show());
    moved();
  };
  return h(
    'div',
    { class: 'sliders' },
    rows.map((row) => row.element),
    h('button', { type: 'button', onclick: reset }, 'Back to the values of the report'),
  );
}

function slider(knob, moved) {
  const { name, unit, doc } = knob;
  const place = places(knob);
  const current = () => triedValue(knob);
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

function triedPlots(ratio, given, column) {
  const tried = polar(ratio, given);
  const curves = (part) => [...ratio.curves(part), { role: 'tried', values: tried[part] }];
  return polarPlots(column, { unit: ratio.unit, at: ratio.frequency, sync: 'tried', curves });
}

// The last curve of each plot is the one that moves; the shown range of frequencies stays.
function redrawn(charts, { magnitude, phase }) {
  [magnitude, phase].forEach((values, at) => {
    charts[at].setData([...charts[at].data.slice(0, -1), values], false);
    charts[at].redraw(true, true);
  });
}

// Magnitude in dB and phase in degrees, unwrapped to `turns` or to the previous line.
function polar({ channel, frequency, turns }, given) {
  const { re, im } = PROGRAM.response(channel, given, frequency);
  let last = 0;
  const phase = re.map((own, at) => {
    const bare = (Math.atan2(im[at], own) * 180) / Math.PI;
    const other = turns && turns[at] !== null ? turns[at] : last;
    last = bare + 360 * Math.round((other - bare) / 360);
    return last;
  });
  return { magnitude: re.map((own, at) => 20 * Math.log10(Math.hypot(own, im[at]))), phase };
}
