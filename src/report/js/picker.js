// Shows one of several figures: a control, and a place that is redrawn. The selection and the zoom of the plots
// persist, and printing shows all figures.

// One of several, by radio buttons in a row.
let groups = 0;
function choice(label, options, chosen, change) {
  const name = `choice-${(groups += 1)}`;
  const buttons = options.map(([value, text]) =>
    h(
      'label',
      {},
      h('input', { type: 'radio', name, value, checked: value === chosen, onchange: () => change(value) }),
      h('span', {}, text),
    ),
  );
  return h('fieldset', { class: 'choice' }, h('legend', {}, label), buttons);
}

// One of many, by a list.
function select(label, options, chosen, change) {
  const entries = options.map(([value, text]) => h('option', { value, selected: value === chosen }, text));
  return h(
    'label',
    { class: 'select' },
    h('span', {}, label),
    h('select', { onchange: (event) => change(event.target.value) }, entries),
  );
}

// `options` are `[value, text]`; `show(value, place, text)` fills a place that is part of the page, and returns its plots.
function picker(name, { control = select, label, options, first = options[0][0], show }) {
  if (view.printing) return printed(options, show);
  const place = h('div', { class: 'picked' });
  let charts = [];
  const draw = (value) => {
    charts.forEach(forget);
    view.picked.set(name, value);
    charts = show(value, place, options.find(([own]) => own === value)[1]);
  };
  const chosen = view.picked.has(name) ? view.picked.get(name) : first;
  return {
    control: options.length > 1 ? control(label, options, chosen, draw) : null,
    place,
    draw: () => draw(chosen),
  };
}

function printed(options, show) {
  const places = options.map(([, text]) => [h('div', {}), text]);
  return {
    control: null,
    place: places.map(([place, text]) =>
      h('div', { class: 'sheet' }, options.length > 1 ? h('h4', {}, text) : null, place),
    ),
    draw: () => options.forEach(([value, text], at) => show(value, places[at][0], text)),
  };
}
