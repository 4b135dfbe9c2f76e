// What the K&C curves say, beside the start values of the campaign.

function curves({ kc, loops }) {
  if (!kc.length) return null;
  const rows = kc.map((own) => [
    `${words(own.test)}, ${own.quantity}`,
    measured(own.value, own.uncertainty, own.unit),
    own.parameter || '',
    own.start === null ? '' : quantity(own.start, own.unit),
    own.start === null ? '' : percent(own.value / own.start - 1),
  ]);
  const figures = loops.map((own) =>
    figure(`loop-${own.test}`, `${own.test}: force over displacement, and the gradient`, loopDrawing(own, kc)),
  );
  const element = section(
    'kc',
    'Kinematics and compliance',
    h(
      'p',
      {},
      'Gradients of the quasi-static and dynamic curves: stiffness from the slope, damping from the force over velocity, friction from half the width of the loop. The uncertainty is one standard deviation.',
    ),
    h('div', { class: 'columns two' }, figures),
    table(
      'Gradients and start values',
      [
        ['curve', 'text'],
        ['gradient', 'number'],
        ['parameter', 'text'],
        ['start value', 'number'],
        ['gradient against start', 'number'],
      ],
      rows,
    ),
  );
  return { element, draw: () => figures.forEach((own) => drawn(own)) };
}

// The measured cycle in grey, its gradient as a line through the middle.
function loopDrawing({ test, displacement, force }, kc) {
  const [left, top, w, tall] = [64, 8, 380, 190];
  const reach = (values) => Math.max(...values.map(Math.abs)) * 1.05;
  const [far, most] = [reach(displacement), reach(force)];
  const x = (d) => left + (w * (d + far)) / (2 * far);
  const y = (f) => top + (tall * (most - f)) / (2 * most);
  const path = displacement.map((d, at) => `${at ? 'L' : 'M'}${x(d).toFixed(1)} ${y(force[at]).toFixed(1)}`).join('');
  const slope = kc.find((own) => own.test === test && own.quantity === 'stiffness');
  const end = slope ? Math.min(far, most / Math.abs(slope.value)) : 0;
  const ticks = (size) => [-2, -1, 0, 1, 2].map((n) => n * roundStep(size / 2.5)).filter((v) => Math.abs(v) <= size);
  return svg(
    'svg',
    {
      class: 'loop',
      viewBox: '0 0 456 246',
      role: 'img',
      'aria-label': `${test} cycle: ${number(1e3 * far)} mm and ${number(most)} N to either side${slope ? `, gradient ${quantity(slope.value, 'N/m')}` : ''}`,
    },
    ticks(far).map((v) => [
      svg('path', { class: 'grid', d: `M${x(v)} ${top}V${top + tall}` }),
      svg('text', { x: x(v), y: top + tall + 16, 'text-anchor': 'middle' }, plain(1e3 * v, 4)),
    ]),
    ticks(most).map((v) => [
      svg('path', { class: 'grid', d: `M${left} ${y(v)}H${left + w}` }),
      svg('text', { x: left - 6, y: y(v) + 4, 'text-anchor': 'end' }, plain(v, 4)),
    ]),
    svg('path', { class: 'cycle', d: path }),
    slope &&
      svg('path', { class: 'slope', d: `M${x(-end)} ${y(-end * slope.value)}L${x(end)} ${y(end * slope.value)}` }),
    svg('text', { x: left + w / 2, y: 240, 'text-anchor': 'middle' }, 'displacement, mm'),
    svg('text', { x: -(top + tall / 2), y: 14, 'text-anchor': 'middle', transform: 'rotate(-90)' }, 'force, N'),
  );
}

// 1, 2 or 5 times a power of ten, from `least` on.
function roundStep(least) {
  const decade = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((n) => n * decade).find((step) => step >= least);
}
