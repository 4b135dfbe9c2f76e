// The two sides, and the differences between their models.

const SIDES = [
  ['a', 'A', 'before'],
  ['b', 'B', 'after'],
];

// The names of both sides in their colours.
function bothKeys(text = (own, letter) => letter) {
  return SIDES.map(([own, letter, role], at) => [at ? ' and ' : '', key(role, text(own, letter))]);
}

function sides(data) {
  const { a, b, axles, changes } = data;
  const differ = Object.keys(changes).length > 0;
  const drawings = (axle, fresh) =>
    ['z', 'x'].map((axis) => axleDrawing(axle, axis, fresh)).filter((drawing) => drawing);
  const [first, second] = [drawings(axles.a, newNames(axles.b, axles.a)), drawings(axles.b, newNames(axles.a, axles.b))];
  const element = section(
    'sides',
    'Model',
    h(
      'p',
      {},
      differ
        ? ['Differences between the models are highlighted in the colour of ', bothKeys(), '.']
        : `Both sides are of the model ${a.model}: ${lowered(a.doc)}. The drawing shows the values of B.`,
    ),
    differ ? [h('h3', {}, `A, ${a.model}`), h('div', { class: 'drawings of-a' }, first)] : null,
    differ ? h('h3', {}, `B, ${b.model}`) : null,
    h('div', { class: 'drawings' }, second),
    differ ? changesPart(changes) : null,
    details(`Equations of motion of ${a.model}${differ ? ' (A)' : ''}`, equationSheet(axles.a.equations)),
    differ ? details(`Equations of motion of ${b.model} (B)`, equationSheet(axles.b.equations)) : null,
  );
  return { element, draw: () => [...(differ ? first : []), ...second].forEach((drawing) => drawn(drawing)) };
}
