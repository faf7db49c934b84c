// Panels that are tables: who wins, what failed, formulations side by side, speed.
import {csvOf, duration, groupBy, number, both} from './records.js';
import {keyOf, lookOf} from './plots.js';
import {filterOf, ofInstance} from './pictures.js';
import {make} from './panel.js';

function priceText(value, measure) { return measure === 'time' ? duration(value) : `${number(value, 4)} ev.`; }
function targetText(target) { return both(target, 'rad', true); }
function offerMeasure(choice, records) {
  choice.offer([['time', 'CPU time'], ['evaluations', 'evaluations']], records.has('cpu_time_s') ? 'time' : 'evaluations');
}

const winners = {
  id: 'x-winners', title: 'Time to accuracy: who wins where', tabular: true,
  about: 'The cheapest way to an attitude error, largest over the run, on each problem, and how many times that the best of the other ' +
    'side costs. Costs marked ≈ lie between two runs, in logarithms. Open symbols are other libraries.',
  hint: 'Point at an entry, or go to it with the tab key: the whole ranking is read out here.',
  setup(panel) {
    panel.measure = panel.choice('Cost');
    offerMeasure(panel.measure, panel.records);
  },
  draw(panel, {records, sweeps}) {
    const measure = panel.measure.value;
    const csv = [['problem', 'attitude error [rad]', 'rank', 'integrator', 'cell', measure === 'time' ? 'CPU time [s]' : 'evaluations', 'low', 'high', 'interpolated']];
    const rows = [];
    for (const [place, group] of groupBy(sweeps, (sweep) => sweep.instance)) {
      const instance = records.data.instances[place];
      const rankings = records.data.targets.map((_, target) => records.ranking(group, measure, target));
      if (instance.aside || rankings.every((ranked) => ranked.length === 0)) continue;
      rows.push([instance.label, ...rankings.map((ranked, target) => {
        if (ranked.length === 0) return 'nobody';
        ranked.forEach((c, i) => csv.push([instance.label, records.data.targets[target], i + 1, c.name, records.text('cell', c.run), c.value, c.low, c.high, c.interpolated]));
        const [best] = ranked;
        const other = ranked.find((c) => records.isRival(c.run) !== records.isRival(best.run));
        const list = ranked.slice(0, 12).map((c, i) => `${i + 1}. ${records.method(c.run)} ${c.interpolated ? '≈ ' : ''}${priceText(c.value, measure)}`).join('\n');
        return {text: [keyOf(lookOf(records, best.run)), make('b', {}, best.name), ` ${best.interpolated ? '≈ ' : ''}${priceText(best.value, measure)}`,
          make('small', {}, other ? `${records.isRival(best.run) ? 'ours' : 'rival'} × ${number(other.value / best.value)}${other.low <= best.high ? ' (tie)' : ''}` :
            ranked.length === 1 ? 'nobody else gets there' : records.isRival(best.run) ? 'none of ours' : 'no rival')],
        class: records.isRival(best.run) ? 'theirs' : 'ours', read: [best.run, list]};
      })]);
    }
    panel.tabulate([['problem'], ...records.data.targets.map((target) => [targetText(target)])], rows);
    panel.csv = () => csvOf(csv);
    panel.again('');
  },
};

const failures = {
  id: 'x-failures', title: 'Failures and refusals', tabular: true,
  about: 'Runs of each method on each problem: how many ended well, failed, or were refused because the method does not suit.',
  hint: 'Point at an entry, or go to it with the tab key: the reasons are read out here.',
  setup(panel) { panel.only = panel.tick('Only methods with a failure or refusal', true); },
  draw(panel, {records, sweeps}) {
    const problems = [...new Set(sweeps.map((sweep) => records.text('problem', sweep.like)))].sort();
    const csv = [['integrator', 'problem', 'status', 'reason', 'runs']];
    const rows = [];
    for (const [name, group] of [...groupBy(sweeps, (sweep) => records.text('integrator', sweep.like))].sort((a, b) => (a[0] < b[0] ? -1 : 1))) {
      const byProblem = groupBy(group, (sweep) => records.text('problem', sweep.like));
      let spotless = true;
      const row = problems.map((problem) => {
        const runs = (byProblem.get(problem) || []).flatMap((sweep) => sweep.runs);
        if (runs.length === 0) return '';
        const reasons = groupBy(runs, (run) => `${records.text('status', run)}\n${records.text('reason', run)}`);
        const count = (is) => runs.filter((run) => is(records.text('status', run))).length;
        const ok = count((s) => s === 'ok'), refused = count((s) => s === 'refused'), failed = runs.length - ok - refused;
        for (const [key, list] of reasons) csv.push([name, problem, ...key.split('\n'), list.length]);
        if (failed || refused) spotless = false;
        const words = [ok ? `✓ ${ok}` : '', failed ? `✗ ${failed}` : '', refused ? `○ ${refused}` : ''].filter(Boolean).join('  ');
        const text = [...reasons].map(([key, list]) => `${list.length} ${key.replace('\n', ': ').replace(/: $/, '')}`).join('\n');
        return {text: words, class: failed ? 'failed' : refused ? 'refused' : 'fine', read: [undefined, `${name} on ${problem}\n${text}`]};
      });
      if (!(spotless && panel.only.checked)) rows.push([name, ...row]);
    }
    panel.tabulate([['✓ ok  ✗ failed  ○ refused'], ...problems.map((problem) => [problem])], rows);
    if (rows.length === 0) panel.note('No run of what is chosen failed, and none was refused.');
    panel.csv = () => csvOf(csv);
    panel.again('');
  },
};

const formulations = {
  id: 'x-formulations', title: 'Formulations compared', tabular: true,
  about: 'The same integrator in each description of the attitude: what an accuracy costs, or how far the norm drifts.',
  hint: 'Point at an entry, or go to it with the tab key: the record is read out here.',
  setup(panel) {
    Object.assign(panel, {problem: panel.choice('Problem'), what: panel.choice('What')});
    const {targets} = panel.records.data;
    panel.what.offer([...targets.map((t, k) => [`time ${k}`, `CPU time to ${number(t)} rad`]), ...targets.map((t, k) => [`evaluations ${k}`, `evaluations to ${number(t)} rad`]),
      ['norm_drift_max', 'largest norm drift'], ['attitude_error_max', 'least attitude error [rad]']],
    panel.records.has('cpu_time_s') ? 'time 0' : 'evaluations 0');
  },
  draw(panel, {records, sweeps}) {
    const several = [...groupBy(sweeps, (sweep) => sweep.instance).values()]
      .filter((group) => new Set(group.map((sweep) => records.text('formulation', sweep.like))).size > 1).flat();
    const here = ofInstance(panel.problem, records, several);
    const columns = [...new Set(here.map((sweep) => records.text('formulation', sweep.like)))];
    const [measure, target] = panel.what.value.split(' ');
    const csv = [['integrator', 'formulation', 'cell', panel.what.value]];
    const found = (group) => {
      if (target !== undefined) {
        const [best] = records.ranking(group, measure, Number(target));
        return best && {run: best.run, value: best.value, text: (best.interpolated ? '≈ ' : '') + priceText(best.value, measure)};
      }
      const runs = group.flatMap((sweep) => sweep.runs).filter((run) => records.isOk(run) && records.value(measure, run) !== null);
      const sign = measure === 'norm_drift_max' ? -1 : 1;
      const [run] = runs.sort((a, b) => sign * (records.value(measure, a) - records.value(measure, b)));
      return run !== undefined && {run, value: records.value(measure, run), text: number(records.value(measure, run))};
    };
    const why = (group) => {
      const runs = group.flatMap((sweep) => sweep.runs);
      if (runs.length === 0) return '';
      return runs.every((run) => records.text('status', run) === 'refused') ? 'refused' : 'not reached';
    };
    const rows = [...groupBy(here, (sweep) => records.text('integrator', sweep.like))].map(([name, group]) => [name, ...columns.map((column) => {
      const entry = found(group.filter((sweep) => records.text('formulation', sweep.like) === column));
      if (!entry) return why(group.filter((sweep) => records.text('formulation', sweep.like) === column));
      csv.push([name, column, records.text('cell', entry.run), entry.value]);
      return {text: entry.text, read: [entry.run, '']};
    })]);
    panel.tabulate([['integrator'], ...columns.map((column) => [column, true])], rows);
    panel.csv = () => csvOf(csv);
    if (here.length) panel.again(filterOf(records, here[0].like));
  },
};

function median(values) {
  const sorted = [...values].sort((a, b) => a - b), middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}
const speed = {
  id: 'x-speed', title: 'Speed', tabular: true,
  about: 'CPU time of a step and of an evaluation: medians over the timed runs of a method. A race to an accuracy is the table of winners, not this one.',
  setup(panel) { Object.assign(panel, {problem: panel.choice('Problem'), per: panel.choice('Bars')}); panel.per.offer([['steps', 'per step'], ['evaluations', 'per evaluation']]); },
  draw(panel, {records, sweeps}) {
    const timed = sweeps.filter((sweep) => sweep.runs.some((run) => records.isOk(run) && records.value('cpu_time_s', run) > 0));
    const here = ofInstance(panel.problem, records, timed);
    const rows = [...groupBy(here, (sweep) => records.method(sweep.like))].map(([name, group]) => {
      const runs = group.flatMap((sweep) => sweep.runs).filter((run) => records.isOk(run) && records.value('cpu_time_s', run) > 0);
      const per = (field) => median(runs.filter((run) => records.value(field, run) > 0).map((run) => records.value('cpu_time_s', run) / records.value(field, run)));
      return {name, like: group[0].like, runs: runs.length, steps: per('steps'), evaluations: per('evaluations')};
    }).sort((a, b) => a[panel.per.value] - b[panel.per.value]);
    const most = Math.max(...rows.map((row) => row[panel.per.value]).filter(Number.isFinite));
    panel.tabulate([['method'], ['per step', true], ['per evaluation', true], ['runs', true], ['']], rows.map((row) => {
      const bar = make('span', {class: records.isRival(row.like) ? 'bar rival' : 'bar', 'aria-hidden': 'true'});
      bar.style.width = `${Math.max(0.5, 100 * row[panel.per.value] / most) || 0}%`;
      return [row.name, duration(row.steps), duration(row.evaluations), String(row.runs), make('span', {class: 'track'}, bar)];
    }));
    panel.csv = () => csvOf([['method', 's per step', 's per evaluation', 'runs'], ...rows.map((row) => [row.name, row.steps, row.evaluations, row.runs])]);
    if (here.length) panel.again(filterOf(records, here[0].like));
  },
};

export const tables = {winners, failures, formulations, speed};
