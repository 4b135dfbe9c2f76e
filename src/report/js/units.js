// Data are in SI; the page shows the units that the reader has chosen.

const GRAVITY = 9.80665;

const SYSTEMS = {
  mm: {
    name: 'N/mm, mm, g',
    scales: {
      'N/m': [1e-3, 'N/mm'],
      'N s/m': [1e-3, 'N s/mm'],
      m: [1e3, 'mm'],
      'm/s': [1e3, 'mm/s'],
      'm/s^2': [1 / GRAVITY, 'g'],
    },
  },
  si: { name: 'N/m, m, m/s²', scales: {} },
};

// The unit that is shown for an SI unit, and the factor that converts a value to it.
function unitOf(unit) {
  const [factor, name] = SYSTEMS[view.units].scales[unit] || [1, unit || '1'];
  return { factor, unit: name === '1' ? '' : pretty(name) };
}

function inUnit(value, unit) {
  const own = unitOf(unit);
  return { ...own, value: value === null ? null : value * own.factor };
}

// `m/s^2` as m/s², `N s/m` with a dot.
function pretty(unit) {
  return unit.replace(/\^(\d+(\.\d+)?)/g, (_, power) => superscript(power)).replace(/([A-Za-z]) ([A-Za-z])/g, '$1·$2');
}

function withUnit(text, unit) {
  return unit ? `${text}\u202f${unit}` : text;
}

// A name with its unit, as at an axis or over a column.
function headed(label, unit) {
  const { unit: shown } = unitOf(unit);
  return shown ? `${label}, ${shown}` : label;
}

function given(value, unit, digits) {
  const own = inUnit(value, unit);
  return withUnit(plain(own.value, digits), own.unit);
}

function quantity(value, unit, digits = 3) {
  const own = inUnit(value, unit);
  return withUnit(number(own.value, digits), own.unit);
}
