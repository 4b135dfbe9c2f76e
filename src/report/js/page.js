// The frame of every report: its head, its list of sections, and the controls for the whole page.

// `build` gives the head of the page and its sections, `{element, draw?}` or null; the first section is above the list.
function assemble(build) {
  const again = () => {
    const seen = scrollY;
    plots.forEach(forget);
    render(build());
    scrollTo({ top: seen, behavior: 'instant' });
  };
  addEventListener('units', again);
  onPaper(again);
  systemTheme.addEventListener('change', applyTheme);
  render(build());
}

function render([head, sections]) {
  const parts = sections.filter((part) => part !== null);
  const links = parts
    .filter((part) => part.element.id)
    .map(({ element }) => h('li', {}, h('a', { href: `#${element.id}` }, element.querySelector('h2').textContent)));
  applyTheme();
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
    h('div', { class: 'switches' }, unitSwitch(), themeButton()),
  );
}

// All values of the page in other units.
function unitSwitch() {
  const options = Object.entries(SYSTEMS).map(([name, { name: text }]) => [name, text]);
  const label = select('Units', options, view.units, (units) => {
    view.units = units;
    dispatchEvent(new Event('units'));
    document.querySelector('.units select').focus();
  });
  label.classList.add('units');
  return label;
}

function lowered(sentence) {
  return sentence.charAt(0).toLowerCase() + sentence.slice(1);
}

// Paper has every run and every detail, in light colours.
function onPaper(again) {
  const print = (printing) => () => {
    view.printing = printing;
    document.documentElement.classList.toggle('printing', printing);
    again();
  };
  addEventListener('beforeprint', print(true));
  addEventListener('afterprint', print(false));
}

window.addEventListener('error', (event) => {
  document
    .getElementById('report')
    .prepend(h('p', { role: 'alert', class: 'failure' }, `A part of this report could not be drawn: ${event.message}`));
});
