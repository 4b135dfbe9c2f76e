// Light or dark: the system's theme until the reader chooses; paper is light.

const systemTheme = matchMedia('(prefers-color-scheme: dark)');

function theme() {
  if (view.printing) return 'light';
  return view.theme || (systemTheme.matches ? 'dark' : 'light');
}

function applyTheme() {
  document.documentElement.dataset.theme = theme();
  recolour();
}

function themeButton() {
  const button = h('button', { type: 'button', class: 'theme' });
  const label = () => {
    button.textContent = theme() === 'dark' ? 'Light page' : 'Dark page';
  };
  button.addEventListener('click', () => {
    view.theme = theme() === 'dark' ? 'light' : 'dark';
    applyTheme();
    label();
  });
  label();
  return button;
}
