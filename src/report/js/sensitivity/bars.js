// Bars from zero, one below the other: names on the left, values at their ends.

const BARS = { left: 136, bars: 260, right: 44, row: 20, top: 6, bottom: 34 };

// Letters of the longest name that stands beside a figure, and the width of a letter.
const LONGEST_NAME = 34;
const LETTER = 6.8;

// A name for a figure: the middle of a longer one is left out, because names differ at either end.
function brief(name) {
  const half = (LONGEST_NAME - 1) / 2;
  return name.length > LONGEST_NAME ? `${name.slice(0, Math.floor(half))}…${name.slice(-Math.ceil(half))}` : name;
}

// The width of a column of names.
function roomFor(names, least) {
  return Math.max(least, 14 + LETTER * Math.max(0, ...names.map((name) => brief(name).length)));
}

// `rows` are `{name, value, said, role, inner?, interval?}`: an `inner` bar is a part of the whole one, an `interval` a line across its
// end. `across` stands below the axis.
function bars(kind, name, rows, across) {
  const ends = rows.flatMap(({ value, inner, interval }) => [
    value,
    Math.max(0, inner || 0),
    ...(interval || []),
  ]);
  const [low, high] = [Math.min(0, ...ends), Math.max(0, ...ends)];
  const isSigned = low < 0;
  // Room for values beyond the ends of the bars.
  const beside = roomFor(rows.map((row) => row.name), BARS.left);
  const [left, right] = [beside + (isSigned ? BARS.right : 0), beside + BARS.bars];
  const floor = BARS.top + BARS.row * rows.length;
  const x = (value) => left + ((right - left) * (value - low)) / (high - low || 1);
  const label = (at, up, anchor, text) => svg('text', { x: at, y: up, 'text-anchor': anchor }, text);
  const ticks = evenTicks(low, high || 1, 5).map((v) => [
    svg('path', { d: `M${x(v)} ${BARS.top}V${floor}`, style: 'stroke:var(--grid)' }),
    label(x(v), floor + 14, 'middle', plain(v, 3)),
  ]);
  const bar = (value, height, middle, style) =>
    svg('rect', {
      x: Math.min(x(0), x(value)),
      y: middle - height / 2,
      width: Math.abs(x(value) - x(0)),
      height,
      style,
    });
  const body = rows.map((row, at) => {
    const middle = BARS.top + BARS.row * (at + 0.5);
    const beyond = row.value < 0 ? row.value : Math.max(row.value, row.inner || 0, ...(row.interval || []));
    const colour = `fill:var(--${row.role})`;
    return svg(
      'g',
      {},
      svg('title', {}, `${row.name}: ${row.said}`),
      label(beside - 8, middle + 4, 'end', brief(row.name)),
      bar(row.value, 12, middle, row.inner === undefined ? colour : `${colour};fill-opacity:0.35`),
      row.inner === undefined ? null : bar(Math.max(0, row.inner), 12, middle, colour),
      row.interval
        ? svg('path', {
            d: `M${x(row.interval[0])} ${middle}H${x(row.interval[1])}M${x(row.interval[0])} ${middle - 4}v8M${x(row.interval[1])} ${middle - 4}v8`,
            style: 'stroke:var(--ink);fill:none',
          })
        : null,
      label(x(beyond) + (row.value < 0 ? -5 : 5), middle + 4, row.value < 0 ? 'end' : 'start', row.said),
    );
  });
  const spoken = rows.map((row) => `${row.name} ${row.said}`).join(', ');
  const height = floor + BARS.bottom;
  return captioned(
    kind,
    name,
    svg(
      'svg',
      { class: 'plane', viewBox: `0 0 ${right + BARS.right} ${height}`, role: 'img', 'aria-label': `${name}: ${spoken}` },
      ticks,
      svg('path', { d: `M${x(0)} ${BARS.top}V${floor}`, style: 'stroke:var(--muted)' }),
      body,
      label((left + right) / 2, height - 4, 'middle', across),
    ),
  );
}

// A bar that is shorter than this share of the longest one would be invisible.
const SEEN = 0.01;

// The entries `[name, value]` with the largest magnitudes.
function largest(pairs, most) {
  const known = pairs.filter(([, value]) => Number.isFinite(value) && value !== 0);
  const sorted = known.sort((a, b) => Math.abs(b[1]) - Math.abs(a[1])).slice(0, most);
  return sorted.filter(([, value]) => Math.abs(value) >= SEEN * Math.abs(sorted[0][1]));
}

// A share as percent; a rounding error counts as zero.
function share(of) {
  return Math.abs(of) < 5e-4 ? '0 %' : percent(of);
}

// Metrics in groups of at most `most`, each with a name.
function parted(caption, metrics, most) {
  const count = Math.ceil(metrics.length / most);
  const each = Math.ceil(metrics.length / count);
  const parts = [...Array(count).keys()].map((n) => metrics.slice(each * n, each * (n + 1)));
  const ends = (part) => (count > 1 ? `: ${part[0].name} to ${part[part.length - 1].name}` : '');
  return parts.map((part) => [caption + ends(part), part]);
}

// Largest number of metrics in the columns of one table.
const ACROSS = 5;

function metricTables(caption, metrics, columns, rows) {
  return parted(caption, metrics, ACROSS).map(([name, part]) =>
    table(name, [['', 'text'], ...part.map((own) => [columns(own), 'number'])], rows(part)),
  );
}
