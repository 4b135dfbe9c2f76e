// The report of a study from top to bottom.

function study(data) {
  const head = () => heading('Campaign study', data.campaign, `Model ${data.model}: ${lowered(data.record.model_doc)}`);
  const sections = () => [
    verdict(data),
    axles(data),
    curves(data),
    rig(data),
    parameters(data),
    modes(data),
    track(data),
    records(data),
    discovery(data),
    record(data),
    limits(data),
  ];
  assemble(() => [head(), sections()]);
}

study(reported());
