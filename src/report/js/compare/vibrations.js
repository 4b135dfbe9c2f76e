// Modes of both sides, each paired with the most similar one.

function vibrations({ modes: pairs }) {
  if (!pairs.length) return null;
  const rows = pairs.map(({ a, b }) => [
    a ? number(a.frequency) : '–',
    b ? number(b.frequency) : '–',
    signed(frequencyShift({ a, b })),
    a ? percent(a.damping, 3) : '–',
    b ? percent(b.damping, 3) : '–',
    a ? h('span', { class: 'modes of-before' }, shapeDrawing(a.parts)) : '',
    b ? h('span', { class: 'modes of-after' }, shapeDrawing(b.parts)) : '',
  ]);
  const element = section(
    'modes',
    'Modes',
    h(
      'p',
      {},
      'Undamped natural frequency, damping ratio and shape of ',
      bothKeys(),
      '. Bars to the right are in phase with the mass that moves most, bars to the left in antiphase; pale bars are in between. Modes of similar shape are paired.',
    ),
    figure(
      'modes',
      'Modes of A and B',
      table(
        'Modes',
        [
          ['A, Hz', 'number'],
          ['B, Hz', 'number'],
          ['change', 'number'],
          ['damping of A', 'number'],
          ['of B', 'number'],
          ['shape of A', 'text'],
          ['shape of B', 'text'],
        ],
        rows,
        { class: 'table modes' },
      ),
    ),
  );
  return { element, draw: () => element.querySelectorAll('figure').forEach((own) => drawn(own)) };
}
