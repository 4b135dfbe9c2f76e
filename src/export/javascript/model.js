// The value of every parameter, in the order of `about.parameters`: what `given` says, else that of the parameter which it
// follows, else its own.
function values(given = {}) {
  const names = about.parameters.map(({ name }) => name);
  const unknown = Object.keys(given).find((name) => !names.includes(name));
  if (unknown !== undefined) throw new Error(`${about.name} has no parameter ${unknown}`);
  const value = ({ name, value: own, follows }) => {
    if (given[name] !== undefined) return given[name];
    return follows === null ? own : value(about.parameters[names.indexOf(follows)]);
  };
  return about.parameters.map(value);
}

// The ratio of a channel, by its name, at frequencies in Hz: real and imaginary parts.
function response(name, given, hertz) {
  const channel = about.channels.find((own) => own.name === name);
  if (!channel) throw new Error(`${about.name} has no response of a channel ${name}`);
  const constants = prepare(values(given));
  const lines = hertz.map((frequency) => {
    const omega = 2 * Math.PI * frequency;
    const rows = channel.response(constants, omega);
    const [a, b] = signal(rows, channel.numerator, omega);
    const [c, d] = signal(rows, channel.denominator, omega);
    const size = c * c + d * d;
    return [(a * c + b * d) / size, (b * c - a * d) / size];
  });
  return { re: lines.map(([re]) => re), im: lines.map(([, im]) => im) };
}

// A row of a response, or what excites it, times a power of jω.
function signal(rows, { row, power }, omega) {
  const [re, im] = row === null ? [1, 0] : [rows[row], rows[rows.length / 2 + row]];
  const size = omega ** power;
  const turned = [
    [re, im],
    [-im, re],
    [-re, -im],
    [im, -re],
  ][((power % 4) + 4) % 4];
  return [size * turned[0], size * turned[1]];
}
