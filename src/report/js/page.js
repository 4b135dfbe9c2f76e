// The frame of every report: its head, its list of sections, and what holds for all of it.

// A section is `{element, draw?}`; the first one stands above the list.
function assemble(head, sections) {
  const parts = sections.filter((part) => part !== null);
  const links = parts
    .filter((part) => part.element.id)
    .map(({ element }) => h('li', {}, h('a', { href: `#${element.id}` }, element.querySelector('h2').textContent)));
  const page = document.getElementById('report');
  page.replaceChildren(
    head,
    parts[0].element,
    h('nav', { 'aria-label': 'Contents' }, h('ol', {}, links.slice(1))),
    ...parts.slice(1).map((part) => part.element),
  );
  parts.forEach((part) => part.draw && part.draw());
}

function reported() {
  return JSON.parse(document.getElementById('data').textContent);
}

function heading(kind, title, ...subject) {
  return h(
    'header',
    {},
    h('p', { class: 'kind' }, kind),
    h('h1', {}, title),
    h('p', { class: 'subject' }, subject),
    themeButton(),
  );
}

function lowered(sentence) {
  return sentence.charAt(0).toLowerCase() + sentence.slice(1);
}

// The system's theme until the reader chooses.
function themeButton() {
  const root = document.documentElement;
  const system = matchMedia('(prefers-color-scheme: dark)');
  const button = h('button', { type: 'button', class: 'theme' });
  let isChosen = 'theme' in root.dataset;
  const show = (theme) => {
    root.dataset.theme = theme;
    button.textContent = theme === 'dark' ? 'Light page' : 'Dark page';
    recolour();
  };
  const ofSystem = () => (system.matches ? 'dark' : 'light');
  button.addEventListener('click', () => {
    isChosen = true;
    show(root.dataset.theme === 'dark' ? 'light' : 'dark');
  });
  system.addEventListener('change', () => isChosen || show(ofSystem()));
  show(isChosen ? root.dataset.theme : ofSystem());
  return button;
}

window.addEventListener('error', (event) => {
  document
    .getElementById('report')
    .prepend(h('p', { role: 'alert', class: 'failure' }, `A part of this report could not be drawn: ${event.message}`));
});
addEventListener('beforeprint', () =>
  document.querySelectorAll('details').forEach((part) => {
    part.open = true;
  }),
);
