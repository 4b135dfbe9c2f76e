// Stands before the report's own scripts, and tells the page around it what a test wants to know.
(function () {
  const found = { errors: [], violations: [] };
  addEventListener('error', (event) => found.errors.push(String(event.message)));
  addEventListener('unhandledrejection', (event) => found.errors.push(String(event.reason)));
  addEventListener('securitypolicyviolation', (event) => found.violations.push(event.blockedURI));
  for (const level of ['error', 'warn']) console[level] = (...what) => found.errors.push(what.join(' '));

  function look() {
    const figures = [...document.querySelectorAll('[data-figure]')];
    const root = document.documentElement;
    found.figures = figures.map((figure) => figure.dataset.figure);
    found.blank = figures
      .filter((figure) => !('drawn' in figure.dataset) || isBlank(figure))
      .map((figure) => figure.dataset.figure);
    found.width = innerWidth;
    found.overflow = root.scrollWidth - root.clientWidth;
    found.requests = performance.getEntriesByType('resource').map((entry) => entry.name);
    found.sections = [...document.querySelectorAll('section > h2')].map((heading) => heading.textContent);
    found.unlabelled = [...document.querySelectorAll('[role=img], [role=application], [role=region]')].filter(
      (part) => !part.getAttribute('aria-label'),
    ).length;
    found.bad_numbers = (document.body.innerText.match(/\b(NaN|undefined|Infinity|null)\b/g) || []).length;
    found.cut = [...document.querySelectorAll('.table')]
      .filter((table) => table.scrollWidth > table.clientWidth + 1)
      .map((table) => table.getAttribute('aria-label'));
    found.headings = [...document.querySelectorAll('h3')].map((heading) => heading.textContent);
    found.captions = [...document.querySelectorAll('figcaption')].map((caption) => caption.textContent);
    found.paragraphs = [...document.querySelectorAll('#verdict > p')].map((paragraph) => paragraph.textContent);
    found.keyboard = keyboard();
    found.themes = themes();
    parent.postMessage(JSON.stringify(found), '*');
  }

  // A canvas on which nothing was painted, or a drawing of no size.
  function isBlank(figure) {
    const canvas = figure.querySelector('canvas');
    if (canvas) {
      const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
      return !data.some((value) => value !== 0);
    }
    return figure.getBoundingClientRect().height < 20;
  }

  // What a plot and a map say after an arrow key.
  function keyboard() {
    const press = (element, key) => element.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true }));
    const plot = document.querySelector('.canvas');
    const map = document.querySelector('svg.heat');
    plot.focus();
    press(plot, 'ArrowRight');
    const said = [...plot.querySelectorAll('.u-value')].map((value) => value.textContent).filter((text) => text).length;
    if (!map) return { focused: document.activeElement === plot, plot: said };
    map.focus();
    press(map, 'ArrowRight');
    return { focused: document.activeElement === map, plot: said, map: document.querySelector('.readout').textContent };
  }

  function themes() {
    const paper = () => getComputedStyle(document.body).backgroundColor;
    const before = paper();
    document.querySelector('button.theme').click();
    return [before, paper()];
  }

  addEventListener('load', () => setTimeout(look, 1000));
})();
