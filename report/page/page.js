// Builds the interactive part of the page: filters above, a panel for each view, drawn when it comes into sight.
import {Records} from './records.js';
import {onTheme} from './plots.js';
import {Choice, Panel, make} from './panel.js';
import {pictures} from './pictures.js';
import {tables} from './tables.js';

function start() {
  const records = new Records(JSON.parse(document.getElementById('polhode-data').textContent));
  const views = [tables.winners, pictures.work, pictures.profile, pictures.drift, pictures.orders, tables.formulations, tables.failures,
    pictures.polhode, pictures.sphere, pictures.history, tables.speed];
  const panels = views.map((view) => new Panel(view, records));

  const filters = {};
  const chosen = make('output', {class: 'chosen'});
  const choices = [];
  const changed = () => {
    for (const [name, choice] of choices) filters[name] = choice.value;
    const sweeps = records.chosenSweeps(filters);
    const runs = sweeps.reduce((sum, sweep) => sum + sweep.runs.length, 0);
    chosen.textContent = `${runs} of ${records.count} runs`;
    const series = records.data.series.filter((s) => records.matches(s.run, filters));
    for (const panel of panels) {
      panel.context = {records, sweeps, series, units: units.value};
      panel.stale = true;
      if (panel.seen) refresh(panel);
    }
  };
  const refresh = (panel) => {
    if (!panel.stale) return;
    panel.stale = false;
    panel.redraw();
  };

  const bar = make('div', {class: 'filters', role: 'group', 'aria-label': 'Filters'});
  const offer = (name, label, values, texts = (v) => v) => {
    const choice = new Choice(label, changed);
    choice.offer([['', 'all'], ...values.map((value) => [value, texts(value)])]);
    choices.push([name, choice]);
    bar.append(choice.element);
  };
  const families = new Set(records.sweeps.map((sweep) => records.family(sweep.like)));
  offer('problem', 'Problem', [...records.words('problem')].sort());
  offer('family', 'Family', [...families].sort(), (family) => family.replaceAll('_', ' '));
  offer('side', 'Side', ['own', 'rival'], (side) => ({own: 'ours', rival: 'other libraries'})[side]);
  offer('formulation', 'Formulation', [...records.words('formulation')].sort());
  offer('policy', 'Norm policy', [...records.words('policy')].sort());
  const name = make('input', {type: 'search', oninput: changed, placeholder: 'part of a name'});
  choices.push(['name', name]);
  const units = new Choice('Units', changed);
  units.offer([['si', 'SI'], ['customary', 'arcsec, deg']]);
  const reset = make('button', {type: 'button', onclick: () => {
    for (const [, choice] of choices) choice.value = '';
    units.value = 'si';
    changed();
  }}, 'Reset');
  bar.append(make('label', {}, 'Integrator', name), units.element, reset, chosen);

  const links = make('ul', {class: 'panels'}, ...views.map((view) => make('li', {}, make('a', {href: `#${view.id}`}, view.title))));
  const root = document.getElementById('panels');
  root.append(make('nav', {'aria-label': 'Pictures'}, links), bar, ...panels.map((panel) => panel.element));
  for (const panel of panels) panel.view.setup?.(panel);
  document.documentElement.classList.add('interactive');

  const sight = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      const panel = panels.find((p) => p.element === entry.target);
      panel.seen = entry.isIntersecting;
      if (panel.seen) refresh(panel);
    }
  }, {rootMargin: '400px'});
  changed();
  for (const panel of panels) sight.observe(panel.element);
  onTheme(changed);
  window.addEventListener('beforeprint', () => panels.forEach(refresh));
}

start();
