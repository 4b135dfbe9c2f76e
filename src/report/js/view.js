// What the reader has chosen. A page that is drawn anew keeps to it.

const view = {
  units: 'mm',
  // `light` or `dark`; the page may name one to begin with.
  theme: document.documentElement.dataset.theme,
  // The summaries of the details that are open.
  opened: new Set(),
  // Printing shows every run at once, and every figure as lines that a printer draws sharply.
  printing: false,
  // What each picker shows, and where its plots were zoomed to.
  picked: new Map(),
  zoomed: new Map(),
  // The values of parameters that the reader tries, SI.
  tried: {},
};
