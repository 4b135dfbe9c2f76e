// Copies the data of a table or figure to the clipboard, or saves them as a file, for a spreadsheet.

// Buttons for rows of text, the first of which are headings.
function exports(name, rows) {
  if (view.printing) return null;
  const button = (text, label, act) =>
    h(
      'button',
      { type: 'button', 'aria-label': `${label}: ${name}`, onclick: (event) => act(event.currentTarget) },
      text,
    );
  return h(
    'span',
    { class: 'exports' },
    button('Copy', 'Copy', (own) => copy(own, separated(rows(), '\t'))),
    button('CSV', 'Save as CSV', () => save(name, separated(rows(), ','))),
  );
}

// A number in machine-readable form: no thin spaces, an ASCII minus sign, powers of ten with an e.
function machine(cell) {
  return cell
    .replace(/\u2212/g, '-')
    .replace(/(\d)\u202f(?=\d)/g, '$1')
    .replace(
      /·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)/g,
      (_, power) => `e${power.replace(/./g, (c) => (c === '⁻' ? '-' : '⁰¹²³⁴⁵⁶⁷⁸⁹'.indexOf(c)))}`,
    )
    .replace(/[\u202f\s]+/g, ' ')
    .trim();
}

function separated(rows, separator) {
  const quoted = (cell) => (/[",\n\t]/.test(cell) ? `"${cell.replace(/"/g, '""')}"` : cell);
  return `${rows.map((row) => row.map((cell) => quoted(machine(cell))).join(separator)).join('\n')}\n`;
}

function copy(button, text) {
  const say = (word) => () => {
    button.textContent = word;
    setTimeout(() => {
      button.textContent = 'Copy';
    }, 1500);
  };
  const written = navigator.clipboard ? navigator.clipboard.writeText(text) : Promise.reject();
  written.then(say('Copied'), say('Not allowed'));
}

function save(name, text) {
  const address = URL.createObjectURL(new Blob([text], { type: 'text/csv' }));
  const file = `${name.replace(/[^\p{L}\p{N}]+/gu, '_').replace(/^_|_$/g, '')}.csv`;
  h('a', { href: address, download: file }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
