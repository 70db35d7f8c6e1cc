// The canvas cannot use style sheets; so its two sets of colours stand here.
const LIGHT = {
  outside: '#e9edf1', grid: '#dfe4e9', halo: '#ffffff', faint: '#b6bec8', text: '#1d2733',
  fixture: 'rgba(255, 214, 74, 0.13)', fixtureSeen: 'rgba(255, 201, 20, 0.85)', fixtureUnlit: 'rgba(120, 130, 140, 0.6)',
  fixtureEdge: 'rgba(184, 138, 0, 0.65)',
  place: '#6b7785', keepOut: '#c0392b', slowZone: '#b45309', detection: '#2563eb', particle: '#0e7490', hypothesis: '#c026d3', sonar: 'rgba(14, 165, 233, 0.10)',
  echo: '#0284c7', path: '#2563eb', pathHalo: 'rgba(37, 99, 235, 0.18)', goal: '#db2777', draft: '#ea580c',
  attractive: '#16a34a', repulsive: '#dc2626', trail: 'rgba(37, 99, 235, 0.45)', truth: '#15803d',
  truthTrail: 'rgba(21, 128, 61, 0.55)', odometryTrail: 'rgba(180, 83, 9, 0.7)', person: '#b45309', tracking: '#1d6fe0', ambiguous: '#d97706', lost: '#dc2626',
  tiles: {free: [255, 255, 255, 255], wall: [52, 65, 80, 255], disputed: [217, 70, 239, 255], hit: [234, 120, 12],
    open: [56, 160, 220]},
};
const DARK = {
  outside: '#0d1217', grid: '#161d25', halo: '#10161c', faint: '#4a5663', text: '#e4eaf0',
  fixture: 'rgba(255, 214, 74, 0.10)', fixtureSeen: 'rgba(255, 209, 50, 0.85)', fixtureUnlit: 'rgba(130, 140, 150, 0.6)',
  fixtureEdge: 'rgba(255, 214, 74, 0.45)',
  place: '#9aa7b5', keepOut: '#ff7b6b', slowZone: '#f0a840', detection: '#6ea8ff', particle: '#38d6e8', hypothesis: '#e879f9', sonar: 'rgba(56, 189, 248, 0.12)',
  echo: '#38bdf8', path: '#60a5fa', pathHalo: 'rgba(96, 165, 250, 0.22)', goal: '#f472b6', draft: '#fb923c',
  attractive: '#4ade80', repulsive: '#f87171', trail: 'rgba(96, 165, 250, 0.5)', truth: '#4ade80',
  truthTrail: 'rgba(74, 222, 128, 0.5)', odometryTrail: 'rgba(251, 146, 60, 0.7)', person: '#f59e0b', tracking: '#3b8bff', ambiguous: '#f59e0b', lost: '#f87171',
  tiles: {free: [28, 37, 47, 255], wall: [190, 202, 215, 255], disputed: [217, 70, 239, 255], hit: [251, 146, 60],
    open: [56, 160, 220]},
};

export class Theme extends EventTarget {
  constructor(button) {
    super();
    this.system = matchMedia('(prefers-color-scheme: dark)');
    this.chosen = localStorage.getItem('theme');
    this.system.addEventListener('change', () => this.apply());
    button.addEventListener('click', () => {
      this.chosen = this.isDark() ? 'light' : 'dark';
      localStorage.setItem('theme', this.chosen);
      this.apply();
    });
    this.apply();
  }

  isDark() { return this.chosen ? this.chosen === 'dark' : this.system.matches; }

  apply() {
    document.documentElement.dataset.theme = this.isDark() ? 'dark' : 'light';
    this.colours = this.isDark() ? DARK : LIGHT;
    this.dispatchEvent(new Event('change'));
  }
}
