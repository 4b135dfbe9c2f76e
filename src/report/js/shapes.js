// The shape of a mode.

function shapeDrawing(parts) {
  const moving = parts.filter((part) => part.amplitude >= 0.02);
  const height = 17 * moving.length + 2;
  const zero = 150;
  const bars = moving.map((part, at) => {
    const along = Math.cos((part.phase * Math.PI) / 180);
    const length = 58 * part.amplitude * (along < 0 ? -1 : 1);
    const y = 17 * at + 3;
    return svg(
      'g',
      {},
      svg('title', {}, `${words(part.point)} ${part.axis}: ${number(part.amplitude)} at ${number(part.phase)}°`),
      svg('text', { x: 84, y: y + 9, 'text-anchor': 'end' }, `${words(part.point)} ${part.axis}`),
      svg('rect', {
        x: Math.min(zero, zero + length),
        y,
        width: Math.max(1, Math.abs(length)),
        height: 11,
        style: `fill-opacity:${(0.25 + 0.75 * Math.abs(along)).toFixed(2)}`,
      }),
    );
  });
  const label = moving
    .map((part) => `${words(part.point)} ${part.axis} ${number(part.amplitude)} at ${number(part.phase, 2)} degrees`)
    .join(', ');
  return svg(
    'svg',
    { class: 'shape', viewBox: `0 0 214 ${height}`, width: 214, height, role: 'img', 'aria-label': label },
    svg('path', { class: 'zero', d: `M${zero} 0V${height}` }),
    bars,
  );
}
