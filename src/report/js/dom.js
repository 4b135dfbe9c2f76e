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
  const texts = () => [
    columns.map(([heading]) => heading),
    ...body.map((row) => [...row.cells].map((cell) => cell.textContent)),
  ];
  return h(
    'div',
    { class: 'table', tabindex: 0, role: 'region', 'aria-label': caption, ...attributes },
    h(
      'table',
      {},
      h('caption', {}, h('span', {}, caption), exports(caption, texts)),
      h('thead', {}, h('tr', {}, head)),
      h('tbody', {}, body),
    ),
  );
}

// A figure has a name for screen readers and registers itself: a page is complete when every figure is drawn.
function figure(kind, name, ...children) {
  return h('figure', { 'data-figure': kind, 'aria-label': name }, children);
}

// A figure with its name as caption below it.
function captioned(kind, name, ...children) {
  return figure(kind, name, children, h('figcaption', {}, name));
}

function drawn(element) {
  const owner = element.closest('[data-figure]');
  if (owner) owner.setAttribute('data-drawn', '');
}

// A section whose figures need no drawing: they are complete at once.
function drawAll(element) {
  return { element, draw: () => element.querySelectorAll('figure').forEach((own) => drawn(own)) };
}

function details(summary, ...children) {
  const part = h('details', { open: view.printing || view.opened.has(summary) });
  const clicked = () => view.opened[part.open ? 'delete' : 'add'](summary);
  return fill(part, {}, [h('summary', { onclick: clicked }, summary), children]);
}

// `z_wheel` as a letter or word with an index, also within other text.
function formula(text) {
  return text.split(/([A-Za-z]+\p{M}*_\w+)/u).map((part, at) => {
    if (at % 2 === 0) return part;
    const [letter, ...index] = part.split('_');
    return [h('i', {}, letter), h('sub', {}, index.join(' '))];
  });
}

// The printed equations: lines without indentation are headings.
function equationSheet(text) {
  const lines = text.split('\n').filter((line) => line.trim());
  const parts = lines.map((line) => {
    if (!line.startsWith(' ')) return h('h4', {}, line);
    const deep = line.startsWith('        ');
    return h('p', { class: deep ? 'continued' : null }, formula(line.trim()));
  });
  return h('div', { class: 'equations', tabindex: 0, role: 'region', 'aria-label': 'Equations' }, parts);
}

// One of the key numbers at the top of a report.
function answer(title, ...lines) {
  return h('div', { class: 'answer' }, h('h3', {}, title), lines);
}

// A change as a bar to the right of zero, or to its left.
function changeBar(share, most) {
  if (share === null || !(most > 0)) return '';
  const length = (50 * Math.abs(share)) / most;
  return h(
    'span',
    { class: 'delta', 'aria-hidden': 'true' },
    h('span', { style: `left:${share < 0 ? 50 - length : 50}%;width:${length}%` }),
  );
}
