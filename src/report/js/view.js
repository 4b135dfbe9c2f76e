// The reader's choices, which persist when the page is redrawn.

const view = {
  units: 'mm',
  // `light` or `dark`; the page may set an initial one.
  theme: document.documentElement.dataset.theme,
  // The summaries of the details that are open.
  opened: new Set(),
  // Printing shows all runs, and figures as SVG.
  printing: false,
  // The selection of each picker and the zoom of its plots.
  picked: new Map(),
  zoomed: new Map(),
  // The values of parameters that the reader tries, SI.
  tried: {},
};
