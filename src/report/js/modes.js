// Modes: natural frequencies, damping ratios and shapes.

function modes({ modes: { before, after }, axles }) {
  if (!before.length) return null;
  const sets = [['before', 'baseline model', before], ...(after ? [['after', 'extended model', after]] : [])];
  const element = section(
    'modes',
    'Modes',
    h(
      'p',
      {},
      'Undamped natural frequency, damping ratio, and the motion of each mass over that of the largest: bars to the right are in phase with it, bars to the left in antiphase; pale bars are in between.',
    ),
    [axles.before, axles.after].some((axle) => axle && !axle.linear)
      ? h(
          'p',
          { class: 'caution' },
          'For a nonlinear model these are small motions about rest, where dry friction sticks and acts as a spring. Larger motions have other frequencies and damping ratios.',
        )
      : null,
    h(
      'div',
      { class: 'columns wide' },
      sets.map(([role, name, set]) => modeTable(role, name, set)),
    ),
  );
  return { element, draw: () => element.querySelectorAll('figure').forEach((own) => drawn(own)) };
}

function modeTable(role, name, set) {
  const rows = set.map((mode) => [number(mode.frequency), percent(mode.damping), shapeDrawing(mode.parts)]);
  return figure(
    `modes-${role}`,
    `Modes of the ${name}`,
    table(
      name,
      [
        ['frequency, Hz', 'number'],
        ['damping', 'number'],
        ['shape', 'text'],
      ],
      rows,
      { class: `table modes of-${role}` },
    ),
  );
}
