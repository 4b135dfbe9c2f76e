// The report of a comparison from top to bottom.

function comparison(data) {
  const kinds = { parameters: 'Two parameter sets', models: 'Two models', campaigns: 'Two campaigns' };
  const title = (own) => own.campaign || own.name.split('/').pop();
  const models = data.a.model === data.b.model ? `Model ${data.a.model}` : `Models ${data.a.model} and ${data.b.model}`;
  const names = title(data.a) === title(data.b) ? [data.a.name, data.b.name] : [title(data.a), title(data.b)];
  const head = () =>
    heading(
      kinds[data.kind],
      `${names[0]} beside ${names[1]}`,
      key('before', `A, ${data.a.name}`),
      h('br'),
      key('after', `B, ${data.b.name}`),
      h('br'),
      models,
    );
  const sections = () => [
    summary(data),
    moves(data),
    sides(data),
    vibrations(data),
    gradients(data),
    ratios(data),
    cleatRuns(data),
  ];
  assemble(() => [head(), sections()]);
}

comparison(reported());
