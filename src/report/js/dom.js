// Elements, tables, figures and controls.

const SVG = 'http://www.w3.org/2000/svg';

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes || {})) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? '' : value);
  }
  for (const child of children.flat(Infinity)) {
    if (child !== null && child !== undefined && child !== false) element.append(child);
  }
  return element;
}

function h(tag, attributes, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

function svg(tag, attributes, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

function section(id, title, ...children) {
  return h('section', { id, 'aria-labelledby': `${id}-title` }, h('h2', { id: `${id}-title` }, title), children);
}

// Columns are `[heading, kind]`, kind being `text` or `number`; rows are arrays of cells.
function table(caption, columns, rows, attributes = {}) {
  const head = columns.map(([heading, kind]) => h('th', { scope: 'col', class: kind }, heading));
  const body = rows.map((row) =>
    h(
      'tr',
      { class: row.class },
      row.map((cell, at) =>
        at === 0 ? h('th', { scope: 'row', class: columns[at][1] }, cell) : h('td', { class: columns[at][1] }, cell),
      ),
    ),
  );
  return h(
    'div',
    { class: 'table', tabindex: 0, role: 'region', 'aria-label': caption, ...attributes },
    h('table', {}, h('caption', {}, caption), h('thead', {}, h('tr', {}, head)), h('tbody', {}, body)),
  );
}

// A figure announces itself; a page is whole when every figure has said that it is drawn.
function figure(name, caption, ...children) {
  return h('figure', { 'data-figure': name }, children, caption && h('figcaption', {}, caption));
}

function drawn(element) {
  const owner = element.closest('[data-figure]');
  if (owner) owner.setAttribute('data-drawn', '');
}

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

function details(summary, ...children) {
  return h('details', {}, h('summary', {}, summary), children);
}

// `z_wheel` as a letter or word with its index, in whatever surrounds it.
function formula(text) {
  return text.split(/([A-Za-z]+\p{M}*_\w+)/u).map((part, at) => {
    if (at % 2 === 0) return part;
    const [letter, ...index] = part.split('_');
    return [h('i', {}, letter), h('sub', {}, index.join(' '))];
  });
}

// The text of a stage of equations: headings stand at the margin.
function equationSheet(text) {
  const lines = text.split('\n').filter((line) => line.trim());
  const parts = lines.map((line) => {
    if (!line.startsWith(' ')) return h('h4', {}, line);
    const deep = line.startsWith('        ');
    return h('p', { class: deep ? 'continued' : null }, formula(line.trim()));
  });
  return h('div', { class: 'equations', tabindex: 0, role: 'region', 'aria-label': 'Equations' }, parts);
}

function key(role, text) {
  return h('span', { class: `key ${role}` }, text);
}

// One of the few numbers at the head of a report.
function answer(title, ...lines) {
  return h('div', { class: 'answer' }, h('h3', {}, title), lines);
}
