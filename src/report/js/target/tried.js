// The parameters of the design, to be moved: the ratios to the road that the model declares.

// Hz.
const TRIED_BAND = [0.5, 30];
const TRIED_LINES = 200;

function tried({ parameters, moves }) {
  if (!PROGRAM) return noSliders();
  const given = (place, value) =>
    Object.fromEntries(
      moves.filter((own) => own.knob === place).map((own) => [own.parameter, own.factor * value + own.constant]),
    );
  const today = Object.assign({}, ...parameters.map((own, place) => given(place, own.today)));
  const [from, to] = TRIED_BAND;
  const frequency = [...Array(TRIED_LINES).keys()].map((line) => from * (to / from) ** (line / (TRIED_LINES - 1)));
  const channels = PROGRAM.about.channels.filter(({ denominator }) => denominator.row === null);
  return sliders({
    says: [
      'The linear response, computed in this page: ',
      key('tried', 'with your values'),
      ', of ',
      key('before', 'today'),
      ' and of ',
      key('after', 'the design'),
      '.',
    ],
    knobs: parameters.map((own, place) => ({ ...own, value: own.design, gives: (value) => given(place, value) })),
    ratios: channels.map(({ name }) => {
      const ratio = { channel: name, frequency };
      const [before, after] = [polar(ratio, today), polar(ratio, {})];
      const curves = (part) => [
        { role: 'before', label: 'today', values: before[part] },
        { role: 'after', label: 'design', values: after[part] },
      ];
      return { ...ratio, curves };
    }),
  });
}
