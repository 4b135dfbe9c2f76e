// Sliders for the fitted parameters of a study: they change the ratios of a rig run.

function tried({ fit, refitted, rig: ratios }) {
  if (!PROGRAM) return noSliders();
  const { run } = ratios[0];
  const estimated = refitted.length
    ? refitted.filter(({ stderr }) => stderr !== null)
    : Object.values(fit.parameters).filter(({ fitted }) => fitted);
  const names = estimated.map(({ name }) => name);
  const isMovable = ({ name, range, follows }) => names.includes(name) && range && !follows;
  return sliders({
    says: [
      `The linear response of the ${refitted.length ? 'extended' : 'baseline'} model, computed in this page: `,
      key('tried', 'with your values'),
      ', with the ',
      key('found', 'values found'),
      ', and as ',
      key('measured', 'measured'),
      ` in ${runName(run)}.`,
    ],
    knobs: PROGRAM.about.parameters
      .filter(isMovable)
      .map((own) => ({ ...own, gives: (value) => ({ [own.name]: value }) })),
    ratios: ratios.filter((ratio) => ratio.run === run).map(triedRatio),
  });
}

function triedRatio({ channel, unit, frequency, measured: beside }) {
  const ratio = { channel, unit, frequency, turns: beside.phase };
  const found = polar(ratio, {});
  const curves = (part) => [
    { role: 'measured', values: beside[part] },
    { role: 'found', values: found[part] },
  ];
  return { ...ratio, curves };
}
