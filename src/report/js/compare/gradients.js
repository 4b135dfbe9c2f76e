// The gradients of the K&C curves of two campaigns.

function gradients({ kc }) {
  if (!kc.length) return null;
  const side = (own, unit) => (own === null ? '–' : measured(own.value, own.uncertainty, unit));
  const element = section(
    'kc',
    'Kinematics and compliance',
    h('p', {}, 'Gradients of the curves, each with one standard deviation. The last column is the difference divided by the combined standard deviation.'),
    table(
      'Gradients',
      [
        ['curve', 'text'],
        ['A', 'number'],
        ['B', 'number'],
        ['change', 'number'],
        ['standard errors', 'number'],
      ],
      kc.map((own) => [
        `${words(own.test)}, ${own.quantity}`,
        h('span', { class: 'before' }, side(own.a, own.unit)),
        h('span', { class: 'after' }, side(own.b, own.unit)),
        signed(own.relative),
        own.standard_errors === null ? '–' : number(own.standard_errors, 2),
      ]),
    ),
  );
  return { element };
}
