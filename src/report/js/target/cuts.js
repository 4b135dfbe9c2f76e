// Planes of two parameters: good and bad designs, and the solution space.

function cuts(data) {
  if (!data.space || !data.space.cuts.length) return null;
  const unit = (name) => data.parameters.find((own) => own.name === name);
  const figures = data.space.cuts.map(({ parameters: names, dots }) => {
    const own = names.map(unit);
    const marks = dots.map(([a, b, broken]) => ({
      at: [a, b],
      role: broken === null ? 'after' : 'before',
      size: 2.6,
      hollow: broken !== null,
      said: broken === null ? 'good' : `beyond ${broken}`,
    }));
    const box = (x, y) => {
      const [[left, right], [low, high]] = own.map((one) => one.interval.map((v) => inUnit(v, one.unit).value));
      return svg('rect', {
        x: x(left),
        y: y(high),
        width: x(right) - x(left),
        height: y(low) - y(high),
        style: 'fill:var(--band);stroke:var(--after)',
      });
    };
    return plane('cut', `${names[0]} and ${names[1]}`, own.map((one) => [one.name, one.unit]), marks, box);
  });
  return drawAll(
    section(
      'cuts',
      'Cuts through the solution space',
      h('p', {}, 'Each dot is a design, good if filled; its other parameters are anywhere in their intervals. The box is the solution space.'),
      h('div', { class: 'columns two' }, figures),
    ),
  );
}
