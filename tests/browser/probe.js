// Stands before the report's own scripts, and tells the page around it what a test wants to know.
(function () {
  const found = { errors: [], violations: [] };
  addEventListener('error', (event) => found.errors.push(String(event.message)));
  addEventListener('unhandledrejection', (event) => found.errors.push(String(event.reason)));
  addEventListener('securitypolicyviolation', (event) => found.violations.push(event.blockedURI));
  for (const level of ['error', 'warn']) console[level] = (...what) => found.errors.push(what.join(' '));

  // What would go to a file or to the clipboard.
  found.saved = [];
  let reading = Promise.resolve();
  URL.createObjectURL = (blob) => {
    reading = Promise.all([reading, blob.text()]).then(([, text]) => found.saved.push(text));
    return 'data:,';
  };
  HTMLAnchorElement.prototype.click = () => {};
  Object.defineProperty(navigator, 'clipboard', {
    value: { writeText: (text) => Promise.resolve(found.saved.push(text)) },
  });

  // Until what has changed is drawn.
  const frame = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done))));

  async function look() {
    found.paragraphs = [...document.querySelectorAll('#verdict > p')].map((paragraph) => paragraph.textContent);
    found.ofRig = [...document.querySelectorAll('#rig > p')].map((paragraph) => paragraph.textContent);
    if (document.documentElement.dataset.probed === 'texts') return;
    await narrowed();
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
    const isNamed = (own) => own.getAttribute('role') === 'img' && own.getAttribute('aria-label');
    found.unnamed = [
      ...figures.filter((figure) => !figure.getAttribute('aria-label')),
      ...[...document.querySelectorAll('canvas')].filter((own) => !isNamed(own)),
    ].map((own) => own.outerHTML.slice(0, 80));
    found.resized = await resized();
    found.alarms = document.querySelectorAll('.failure').length;
    found.faint = faint();
    found.dashes = dashes();
    found.legends = legends();
    found.renamed = renamed();
    found.tables = [...document.querySelectorAll('.table')].map((own) => own.getAttribute('aria-label'));
    found.headings = [...document.querySelectorAll('h3')].map((heading) => heading.textContent);
    found.captions = [...document.querySelectorAll('figcaption')].map((caption) => caption.textContent);
    found.keyboard = keyboard();
    found.zoom = await zoomed();
    found.maps = maps();
    await exported();
    await tried();
    found.themes = themes();
    await printed();
    await otherUnits();
  }

  // The width of the first plot before and after the page becomes narrower; null without a plot. An alarm about the
  // layout would be among the errors.
  async function resized() {
    const plot = document.querySelector('.uplot');
    if (!plot) return null;
    const widths = [plot.clientWidth];
    for (const width of ['300px', '']) {
      document.body.style.width = width;
      for (let k = 0; k < 3; k++) await frame();
      widths.push(plot.clientWidth);
    }
    return widths;
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
    if (!plot) return null;
    const map = document.querySelector('svg.heat');
    plot.focus();
    press(plot, 'ArrowRight');
    const said = [...plot.querySelectorAll('.u-value')].map((value) => value.textContent).filter((text) => text);
    if (!map) return { focused: document.activeElement === plot, plot: said };
    map.focus();
    press(map, 'ArrowRight');
    return { focused: document.activeElement === map, plot: said, map: document.querySelector('.readout').textContent };
  }

  // A page that becomes narrower and wide again must not call that a failure.
  async function narrowed() {
    const main = document.querySelector('main');
    const width = () => document.querySelector('canvas, svg.plane').getBoundingClientRect().width;
    const before = width();
    main.style.width = '330px';
    await frame();
    await frame();
    found.narrower = width() < before || before < 300;
    main.style.width = '';
    await frame();
    await frame();
  }

  // Where the pointer stands in a plot of the rig at first, and after zooming in to the right of that and taking
  // another run: in what is shown then.
  async function zoomed() {
    const rig = document.querySelector('#rig, #ratios');
    const runs = rig ? [...rig.querySelectorAll('.choice input')] : [];
    if (runs.length < 2) return null;
    const key = (name, shiftKey = false) =>
      rig.querySelector('.canvas').dispatchEvent(new KeyboardEvent('keydown', { key: name, shiftKey, bubbles: true }));
    const place = () => parseFloat(rig.querySelector('.canvas .u-value').textContent);
    runs[1].click();
    await frame();
    key('ArrowRight');
    const before = place();
    for (let step = 0; step < 30; step += 1) key('ArrowRight', true);
    for (let step = 0; step < 4; step += 1) {
      key('+');
      await frame();
    }
    runs[0].click();
    await frame();
    key('ArrowRight');
    const values = rig.querySelector('.canvas').querySelectorAll('tr:not(.band) .u-value');
    found.pointer = [...values].map((own) => own.textContent);
    return [before, place()];
  }

  // The axis of each map of residuals, and the names of its rows.
  function maps() {
    const all = {};
    const section = document.querySelector('#discovery');
    const kinds = section ? [...section.querySelectorAll('.choice label')] : [];
    for (const kind of kinds) {
      kind.querySelector('input').click();
      const texts = [...section.querySelectorAll('svg.heat')[0].querySelectorAll('text')].map((own) => own.textContent);
      all[kind.textContent] = texts;
    }
    return all;
  }

  // The lines in legends and texts, by what they stand for.
  function dashes() {
    const all = {};
    for (const path of document.querySelectorAll('tr.u-series .sample path, .key .sample path')) {
      const role = path
        .closest('tr, .key')
        .className.replace(/u-series|u-off|key/g, '')
        .trim();
      all[role] = [...new Set([...(all[role] || []), path.getAttribute('stroke-dasharray') || ''])];
    }
    return all;
  }

  // What the legends of each kind of figure list.
  function legends() {
    const all = {};
    for (const label of document.querySelectorAll('[data-figure] tr.u-series .u-label')) {
      const kind = label.closest('[data-figure]').dataset.figure;
      all[kind] = [...new Set([...(all[kind] || []), label.textContent])];
    }
    return all;
  }

  // Captions that begin with a capital letter in place of that of a name, such as K_tire.
  function renamed() {
    const captions = [...document.querySelectorAll('figcaption')].filter((own) => /^[a-z]+[_.]/.test(own.textContent));
    const isChanged = (own) => getComputedStyle(own, '::first-letter').textTransform === 'uppercase';
    return captions.filter(isChanged).map((own) => own.textContent);
  }

  // The first figure and the first table as files, and the table for the clipboard.
  async function exported() {
    for (const [place, text] of [
      ['figure', 'CSV'],
      ['.table', 'CSV'],
      ['.table', 'Copy'],
    ]) {
      const buttons = [...document.querySelectorAll(`${place} .exports button`)];
      const button = buttons.find((own) => own.textContent === text);
      if (button) button.click();
      await reading;
    }
  }

  // The sliders, and the first ratio before and after one of them was moved, and when all are back.
  async function tried() {
    const part = [...document.querySelectorAll('details')].find((own) => own.querySelector('.sliders'));
    if (!part) return;
    part.querySelector('summary').click();
    await frame();
    await frame();
    const text = async () => {
      const button = part.querySelector('[data-figure=tried-magnitude] .exports button:last-child');
      if (!button) return null;
      button.click();
      await reading;
      return found.saved.pop();
    };
    const estimates = () => [...part.querySelectorAll('td .tried')].map((own) => own.textContent);
    const heading = part.querySelector('h3');
    const inputs = [...part.querySelectorAll('.sliders input')];
    const labels = [...part.querySelectorAll('.sliders label')];
    found.tried = {
      channel: heading && heading.textContent,
      estimates: [estimates()],
      labels: inputs.map((own) => own.getAttribute('aria-label')),
      shown: labels.map((own) => own.querySelector('output').textContent),
      before: await text(),
      blank: [...part.querySelectorAll('[data-figure]')].filter((own) => !('drawn' in own.dataset)).length,
    };
    const wanted = inputs.find((own) => own.getAttribute('aria-label').startsWith('k_wheel_z')) || inputs[0];
    wanted.value = 500;
    wanted.dispatchEvent(new Event('input'));
    await frame();
    found.tried.estimates.push(estimates());
    found.tried.moved = wanted.closest('label').querySelector('output').textContent;
    found.tried.after = await text();
    found.tried.overflow = document.documentElement.scrollWidth - document.documentElement.clientWidth;
    part.querySelector('.sliders button').click();
    await frame();
    found.tried.reset = await text();
    found.tried.estimates.push(estimates());
  }

  // What paper shows, and whether the page is itself again afterwards.
  async function printed() {
    const [controls, canvases] = ['button, select, input', 'canvas'];
    const count = (what) => document.querySelectorAll(what).length;
    const before = count(canvases);
    dispatchEvent(new Event('beforeprint'));
    const width = document.body.getBoundingClientRect().right;
    const wide = [...document.querySelectorAll('#report *')].filter(
      (own) => own.getBoundingClientRect().right > width + 1,
    );
    found.on_paper = [...document.querySelectorAll('[data-figure]')].map((figure) => figure.dataset.figure);
    found.printed = {
      width,
      wide: wide.map((own) => `${own.tagName} ${own.textContent.slice(0, 40)}`),
      controls: [...document.querySelectorAll(controls)].filter((own) => own.getClientRects().length).length,
      canvases: count(canvases),
    };
    dispatchEvent(new Event('afterprint'));
    await frame();
    found.printed.restored = count(canvases) === before;
  }

  // All that is said in both systems of units.
  async function otherUnits() {
    const mm = document.body.innerText;
    const list = document.querySelector('.units select');
    list.value = 'si';
    list.dispatchEvent(new Event('change', { bubbles: true }));
    await frame();
    found.units = { mm, si: document.body.innerText };
  }

  // Text of less contrast with what it stands on than 4.5, and lines of less than 3.
  function faint() {
    const canvas = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
    // A page has thousands of texts and a dozen colours.
    const once = (compute) => {
      const known = new Map();
      return (of) => {
        if (!known.has(of)) known.set(of, compute(of));
        return known.get(of);
      };
    };
    const shade = once((colour) => {
      canvas.clearRect(0, 0, 1, 1);
      canvas.fillStyle = colour;
      canvas.fillRect(0, 0, 1, 1);
      return [...canvas.getImageData(0, 0, 1, 1).data];
    });
    const light = once((colour) =>
      shade(colour)
        .slice(0, 3)
        .map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4))
        .reduce((sum, v, at) => sum + v * [0.2126, 0.7152, 0.0722][at], 0),
    );
    const contrast = (a, b) => (Math.max(light(a), light(b)) + 0.05) / (Math.min(light(a), light(b)) + 0.05);
    const ground = once((element) => {
      const own = getComputedStyle(element).backgroundColor;
      return shade(own)[3] === 255 || !element.parentElement ? own : ground(element.parentElement);
    });
    const isText = (element) => [...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim());
    const texts = [...document.querySelectorAll('#report *')].filter(
      (own) => isText(own) && own.getClientRects().length,
    );
    const weak = texts.filter((own) => {
      const style = getComputedStyle(own);
      return contrast(own instanceof SVGElement ? style.fill : style.color, ground(own)) < 4.5;
    });
    const paper = getComputedStyle(document.body).backgroundColor;
    const samples = [...document.querySelectorAll('.u-legend .sample path')].map((own) => getComputedStyle(own));
    const lines = samples.filter(({ stroke }) => stroke !== 'none' && contrast(stroke, paper) < 3);
    return [...weak.map((own) => own.textContent), ...lines.map(({ stroke }) => stroke)];
  }

  function themes() {
    const paper = () => getComputedStyle(document.body).backgroundColor;
    const before = paper();
    document.querySelector('button.theme').click();
    return [before, paper()];
  }

  addEventListener('load', async () => {
    await frame();
    await look().catch((error) => found.errors.push(`the probe: ${error.stack}`));
    parent.postMessage(JSON.stringify(found), '*');
  });
})();
