// The report of targets from top to bottom.

function target(data) {
  const head = () => heading('Targets', data.subject.split('/').pop(), `Model ${data.model}`);
  assemble(() => [head(), [wanted(data), intervals(data), tornado(data), cuts(data), front(data), rides(data)]]);
}

target(reported());
