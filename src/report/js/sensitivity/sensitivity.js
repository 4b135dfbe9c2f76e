// The report of sensitivities from top to bottom.

function sensitivity(data) {
  const head = () => heading('Sensitivities', data.subject.split('/').pop(), `Model ${data.model}`);
  assemble(() => [head(), [summary(data), tornado(data), matrix(data), uncertaintySection(data), sobol(data)]]);
}

sensitivity(reported());
