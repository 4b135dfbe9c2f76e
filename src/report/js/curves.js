// The gradients of the K&C curves, with the start values of the campaign.

function curves({ kc, loops }) {
  if (!kc.length) return null;
  const rows = kc.map((own) => [
    `${words(own.test)}, ${own.quantity}`,
    measured(own.value, own.uncertainty, own.unit),
    own.parameter || '',
    own.parameter ? parameterValue(own) : '',
    own.start === null ? '' : quantity(own.start, own.unit),
    own.start === null || own.parameter_value === null ? '' : signed(own.start / own.parameter_value - 1),
  ]);
  const figures = loops.map((own) =>
    captioned(
      `loop-${own.test}`,
      `${own.test}: force over displacement, and the gradient`,
      h('div', { class: 'canvas' }),
    ),
  );
  const element = section(
    'kc',
    'Kinematics and compliance',
    h(
      'p',
      {},
      'Gradients of the quasi-static and dynamic curves: stiffness from the slope, damping from the force over velocity, friction from the step of the force where the velocity of a sine changes sign. The half width of the loop of a slow cycle is dry friction and the damping at the speed of the rig together. The uncertainty is one standard deviation. The parameter is the value with which the model has this gradient while its body is held. It exceeds the gradient if there is a compliance in series.',
    ),
    h('div', { class: 'columns two' }, figures),
    table(
      'Gradients and start values',
      [
        ['curve', 'text'],
        ['gradient', 'number'],
        ['parameter', 'text'],
        ['its value by the curve', 'number'],
        ['start value', 'number'],
        ['start against curve', 'number'],
      ],
      rows,
    ),
  );
  return { element, draw: () => loops.forEach((own, at) => loopPlot(own, kc, figures[at].querySelector('.canvas'))) };
}

function parameterValue({ parameter_value: value, unit, why_no_parameter_value: why }) {
  return value === null ? why : quantity(value, unit, 4);
}

// The measured cycle, each direction of travel a curve, and its gradient as a line through the middle.
function loopPlot({ test, displacement, force }, kc, place) {
  const points = displacement.map((d, at) => ({
    x: d,
    force: force[at],
    out: displacement[at + 1] === undefined ? d > displacement[at - 1] : displacement[at + 1] > d,
  }));
  points.sort((first, second) => first.x - second.x);
  const branch = (out) => points.map((own) => (own.out === out ? own.force : null));
  const slope = kc.find((own) => own.test === test && own.quantity === 'stiffness');
  const most = 1.05 * Math.max(...force.map(Math.abs));
  const gradient = slope ? slope.value : 0;
  const line = points.map(({ x }) => (Math.abs(gradient * x) > most ? null : gradient * x));
  return plot(place, {
    x: { label: 'displacement', unit: 'm' },
    y: { label: 'force', unit: 'N' },
    at: points.map((own) => own.x),
    gaps: false,
    digits: 4,
    curves: [
      { role: 'measured', label: 'outwards', values: branch(true) },
      { role: 'inwards', values: branch(false) },
      ...(slope ? [{ role: 'before', label: 'gradient', values: line }] : []),
    ],
  });
}
