// What the K&C curves say, beside the start values of the campaign.

function curves({ kc }) {
  if (!kc.length) return null;
  const rows = kc.map((own) => [
    `${words(own.test)}, ${own.quantity}`, measured(own.value, own.uncertainty, own.unit), own.parameter || '',
    own.start === null ? '' : quantity(own.start, own.unit), own.start === null ? '' : percent(own.value / own.start - 1),
  ]);
  const element = section('kc', 'Kinematics and compliance',
    h('p', {}, 'Gradients of the quasi-static and dynamic curves: stiffness from the slope, damping from the force over velocity, friction from half the width of the loop. The uncertainty is one standard deviation.'),
    table('Gradients and start values', [['curve', 'text'], ['gradient', 'number'], ['parameter', 'text'], ['start value', 'number'], ['gradient against start', 'number']], rows));
  return { element };
}
