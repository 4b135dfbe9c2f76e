// A plot for paper: a small SVG without a legend.

const SKETCH = { left: 44, right: 12, top: 6, bottom: 32 };

function sketch(place, own) {
  const [width, height] = [Math.max(130, place.clientWidth), Math.round(0.52 * own.height)];
  const y = upY(own, height);
  const x = alongX(own, leftOf(y, 5), width);
  const lines = own.curves.filter((curve) => curve.role !== 'band' && !curve.hidden);
  const name = place.closest('figure').getAttribute('aria-label');
  place.append(
    svg(
      'svg',
      { class: 'sketch', viewBox: `0 0 ${width} ${height}`, width, height, role: 'img', 'aria-label': name },
      frame(own, x, y, width, height),
      bandPairs(own.curves).map(([low]) => bandShape(own, low, x, y)),
      lines.map((curve) => (curve.beside === undefined ? curveShape(own, curve, x, y) : barShapes(own, curve, x, y))),
    ),
  );
  drawn(place);
}

// Where the plot begins, beside the longest number at its vertical axis; a digit is `digit` wide.
function leftOf({ ticks }, digit) {
  return Math.max(SKETCH.left, 20 + digit * Math.max(0, ...ticks.map((v) => plain(v, 4).length)));
}

// Axes are `{low, high, at, ticks}`, where `at` gives the position of a value on the paper; that along x begins at `begin`.
function alongX({ x, at, from }, begin, width) {
  const [low, high] = from || (x.range ? x.range() : [at[0], at[at.length - 1]]);
  const length = width - begin - SKETCH.right;
  const share = x.log ? (v) => Math.log(v / low) / Math.log(high / low) : (v) => (v - low) / (high - low);
  const ticks = x.log ? decadeTicks(low, high) : evenTicks(low, high, length / 42);
  return { low, high, begin, at: (v) => begin + length * share(v), ticks };
}

function upY({ y, at, curves, from }, height) {
  const isShown = (v, line) =>
    v !== null && Number.isFinite(v) && (!from || (at[line] >= from[0] && at[line] <= from[1]));
  const values = curves.flatMap((curve) => curve.values.filter(isShown));
  const ends = values.reduce(([low, high], v) => [Math.min(low, v), Math.max(high, v)], [Infinity, -Infinity]);
  const [low, high] = (y.range || padded)(null, ...(values.length ? ends : [null, null]));
  const length = height - SKETCH.top - SKETCH.bottom;
  return {
    low,
    high,
    at: (v) => SKETCH.top + (length * (high - v)) / (high - low),
    ticks: evenTicks(low, high, length / 22),
  };
}

function decadeTicks(low, high) {
  const powers = [...Array(10).keys()].map((n) => 10 ** (n - 4));
  const digits = [...Array(9).keys()].map((n) => n + 1);
  const ticks = powers.flatMap((power) => digits.map((digit) => digit * power)).filter((v) => v >= low && v <= high);
  return ticks.filter(labelled(ticks));
}

// At most `most` round values, but no fewer than two.
function evenTicks(low, high, most) {
  const rough = (high - low) / Math.max(2, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((digit) => digit * power >= rough);
  const first = Math.ceil(low / step);
  const ticks = [...Array(Math.max(0, Math.floor(high / step) - first + 1)).keys()].map((n) => step * (first + n));
  return ticks.length > 1 || !(high > low) ? ticks : evenTicks(low, high, 1.5 * Math.max(2, most));
}

function frame(own, x, y, width, height) {
  const floor = height - SKETCH.bottom;
  const label = (text, place) => svg('text', { 'text-anchor': 'middle', ...place }, text);
  return [
    x.ticks.map((v) => svg('path', { class: 'grid', d: `M${px(x.at(v))} ${SKETCH.top}V${floor}` })),
    y.ticks.map((v) => svg('path', { class: 'grid', d: `M${px(x.begin)} ${px(y.at(v))}H${width - SKETCH.right}` })),
    x.ticks.map((v) => label(plain(v, 4), { x: px(x.at(v)), y: floor + 11 })),
    y.ticks.map((v) => svg('text', { x: px(x.begin - 3), y: px(y.at(v)) + 3, 'text-anchor': 'end' }, plain(v, 4))),
    label(own.x.text, { x: px((x.begin + width) / 2), y: height - 5 }),
    label(own.y.text, { transform: `translate(8 ${floor / 2 + 3}) rotate(-90)` }),
  ];
}

function px(value) {
  return value.toFixed(1);
}

// A line that ends where a value is missing or lies beyond the axes.
function curveShape({ at, gaps }, { role, values }, x, y) {
  let [path, pen] = ['', 'M'];
  values.forEach((v, line) => {
    const known = v !== null && v !== undefined && Number.isFinite(v);
    if (known && at[line] >= x.low && at[line] <= x.high) {
      path += `${pen}${px(x.at(at[line]))} ${px(y.at(v))}`;
      pen = 'L';
    } else if (gaps || known) pen = 'M';
  });
  const { width, dash } = ROLES[role];
  return svg('path', {
    d: path,
    style: `stroke:var(--${role});fill:none`,
    'stroke-width': 0.6 * width,
    'stroke-dasharray': dash ? dash.map((part) => 0.6 * part).join(' ') : null,
  });
}

function bandShape({ at, curves }, low, x, y) {
  const edge = (values) =>
    values.flatMap((v, line) => (v === null || !Number.isFinite(v) ? [] : [`${px(x.at(at[line]))} ${px(y.at(v))}`]));
  const outline = [...edge(curves[low].values), ...edge(curves[low + 1].values).reverse()];
  return svg('path', { d: `M${outline.join('L')}Z`, style: 'fill:var(--band);stroke:none' });
}

function barShapes({ at }, { role, values, beside }, x, y) {
  const wide = at.length > 1 ? x.at(at[1]) - x.at(at[0]) : 40;
  const width = wide * (beside ? 0.42 : 0.85);
  const shift = beside ? (beside < 0 ? -width : 0) : -width / 2;
  return values.map((v, line) =>
    svg('rect', {
      x: px(x.at(at[line]) + shift),
      y: px(y.at(v)),
      width: px(width),
      height: px(y.at(0) - y.at(v)),
      style: `fill:var(--${role})`,
    }),
  );
}
