// Numbers with readable digits and units.

// A number with the given significant digits, without an exponent if it is short enough.
function number(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e7)) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    return `${minus(mantissa)}·10${superscript(Number(exponent))}`;
  }
  const rounded = Number(value.toPrecision(digits));
  const decimals = size === 0 ? 0 : Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return grouped(rounded, Math.min(decimals, 6), 6);
}

// Formats by their least and most decimals. A page writes thousands of numbers, and to make a format takes as long as to
// write hundreds of them.
const FORMATS = new Map();

// With thin spaces between thousands.
function grouped(value, minimumFractionDigits, maximumFractionDigits) {
  const key = `${minimumFractionDigits} ${maximumFractionDigits}`;
  if (!FORMATS.has(key)) {
    FORMATS.set(key, new Intl.NumberFormat('en-GB', { minimumFractionDigits, maximumFractionDigits }));
  }
  return minus(FORMATS.get(key).format(value).replace(/,/g, '\u202f'));
}

// The same without trailing zeros, for given values as opposed to measured ones.
function plain(value, digits = 5) {
  return number(
    Number(value.toPrecision(digits)),
    String(Math.abs(Number(value.toPrecision(digits)))).replace(/^0\.0*|\./g, '').length || 1,
  );
}

function minus(text) {
  return text.replace('-', '−');
}

function superscript(exponent) {
  return String(exponent).replace(/[-0-9]/g, (c) => (c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]));
}

// A share as percent.
function percent(share, digits = 2) {
  return share === null || !Number.isFinite(share) ? '–' : `${number(100 * share, digits)} %`;
}

// A relative change with its sign, in percent: to a tenth where it is small, to three digits where it is large.
function signed(share) {
  if (share === null || share === undefined || !Number.isFinite(share)) return '–';
  const small = (100 * share).toFixed(1);
  if (Number(small) === 0) return '0\u202f%';
  return `${share > 0 ? '+' : ''}${Math.abs(share) < 1 ? minus(small) : number(100 * share)}\u202f%`;
}

// Largest number of decimal places.
const MOST_PLACES = 6;

// `value ± error` with as many digits as the error justifies; with a common power of ten if the numbers would be long.
function measured(value, error, unit) {
  const scaled = inUnit(value, unit);
  if (error === null || !Number.isFinite(error) || error <= 0) return quantity(value, unit, 4);
  const size = Math.abs(scaled.value);
  const places = (off) => Math.max(0, 1 - Math.floor(Math.log10(off)));
  const isLong = size < 1e-4 || size >= 1e7 || places(error * scaled.factor) > MOST_PLACES;
  const power = size !== 0 && isLong ? Math.floor(Math.log10(size)) : 0;
  const [own, off] = [scaled.value, error * scaled.factor].map((x) => x / 10 ** power);
  const shown = Math.min(MOST_PLACES, places(off));
  const fixed = (x) => grouped(Number(x.toFixed(shown)), shown, shown);
  const both = `${fixed(own)} ± ${fixed(off)}`;
  const text = power ? `(${both})·10${superscript(power)}` : both;
  return withUnit(text, scaled.unit);
}

// `coulomb_friction` with spaces for underscores.
function words(name) {
  return name.replace(/_/g, ' ');
}

// `pad_to_body` as an arrow.
function channelName(name) {
  return words(name.replace(/_to_/, ' → '));
}

// `rig/sweep_025.csv.gz` without folder and ending.
function runName(file) {
  return file
    .split('/')
    .pop()
    .replace(/\.gz$/, '')
    .replace(/\.csv$/, '');
}

function roleName(role) {
  return role === 'held_out' ? 'held out' : role;
}
