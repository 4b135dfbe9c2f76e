// The difference between two models: removed and added lines.

function changeLine(kind, sign, heading, text) {
  return h(
    'p',
    { class: kind },
    h('span', { class: 'sign' }, sign),
    heading === 'equations' ? h('span', { class: 'equation' }, formula(text)) : h('code', {}, text),
  );
}

// Masses and links of both directions may share a name.
function direction(name) {
  const [axis, rest] = name.split('.');
  return rest ? h('span', { class: 'direction' }, `${axis} direction`) : null;
}

function changesPart(changes) {
  const parts = Object.entries(changes).map(([heading, own]) =>
    h(
      'div',
      { class: 'changes' },
      h('h4', {}, words(heading)),
      own.map((change) =>
        h(
          'div',
          { class: 'change' },
          direction(change.name),
          change.before === null ? null : changeLine('gone', '−', heading, change.before),
          change.after === null ? null : changeLine('come', '+', heading, change.after),
        ),
      ),
    ),
  );
  return h('div', {}, h('h3', {}, 'How the model changes'), parts);
}
