// Panels with a picture: work and precision, drift, orders, profiles, histories, and what is seen in space.
import {COSTS, ERRORS, both, csvOf, duration, front, groupBy, number, profiles, shown} from './records.js';
import {curvesCsv, drawCurves, drawSpace, lookAt, lookOf, variable} from './plots.js';

/** Exact zeros have no place on a logarithmic axis: they are drawn here. */
const FLOOR = 1e-17;
/** A browser draws no more points than this without a pause. */
const MOST_POINTS = 4000;

/** A regular expression for `polhode run --filter` that finds the runs of these sweeps' instance. */
export function filterOf(records, run) {
  const escape = (text) => text.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');
  return `^${escape(records.text('problem', run))}/${escape(records.text('variant', run))}/`;
}

/** Offers the instances of these sweeps; returns the sweeps of the one that is chosen. */
export function ofInstance(choice, records, sweeps) {
  const groups = groupBy(sweeps, (sweep) => String(sweep.instance));
  choice.offer([...groups.keys()].map((place) => [place, records.data.instances[place].label]));
  return groups.get(choice.value) || [];
}

/** Offers those of `words` that some run has. */
function offerFields(choice, records, words, preferred) {
  choice.offer(Object.entries(words).filter(([field]) => records.has(field)), preferred);
}

function costText(field, value) {
  if (field === 'cpu_time_s') return duration(value);
  return field === 'h' ? `${number(value, 4)} s` : number(value, 7);
}

/** One curve for each sweep: y of its successful runs against x. */
function sweepCurves({records, units}, sweeps, x, y) {
  const {factor} = shown(records.unit(y), units, true);
  const curves = [];
  let points = 0, left = 0;
  for (const sweep of sweeps) {
    const runs = sweep.runs.filter((run) => records.isOk(run) && records.value(x, run) > 0 && records.value(y, run) !== null);
    if (runs.length === 0) continue;
    if (points + runs.length > MOST_POINTS) { left += runs.length; continue; }
    points += runs.length;
    curves.push({name: records.method(sweep.like) + (x !== 'h' && records.value('h', sweep.like) === null ? ', adaptive' : ''),
      run: sweep.like, runs, sweep,
      xs: runs.map((run) => records.value(x, run)),
      ys: runs.map((run) => Math.max(Math.abs(records.value(y, run)) * factor, FLOOR)),
      grey: runs.map((run) => records.belowBar(run, y)),
      texts: runs.map((run) => `${records.control(run)}\n${COSTS[x]}: ${costText(x, records.value(x, run))}\n` +
        `${ERRORS[y]}: ${both(records.value(y, run), records.unit(y), true)}` +
        (records.belowBar(run, y) ? "\nbelow the reference's bar" : ''))});
  }
  return {curves, left};
}

function titled(words, unit) { return unit ? `${words} [${unit}]` : words; }

function drawSweeps(panel, context, sweeps, x, y, withFront) {
  const {records, units} = context;
  const {curves, left} = sweepCurves(context, sweeps, x, y);
  if (withFront && curves.length > 1) {
    const all = curves.flatMap((c) => c.runs.map((run, i) => ({x: c.xs[i], y: c.ys[i], run, text: c.texts[i], name: c.name})));
    const best = front(all);
    curves.push({name: 'the front: nothing is better in both', look: {colour: variable('--quiet'), dash: 'solid'},
      mode: 'lines', shape: 'hv', xs: best.map((p) => p.x), ys: best.map((p) => p.y), runs: best.map((p) => p.run), run: sweeps[0].like,
      texts: best.map((p) => `${p.name}, ${p.text}`)});
  }
  drawCurves(panel, records, curves, {
    x: {title: titled(COSTS[x], records.unit(x)), log: true},
    y: {title: titled(ERRORS[y], shown(records.unit(y), units, true).unit), log: true}});
  panel.csv = () => curvesCsv(panel, records, x, `${y} [${shown(records.unit(y), units, true).unit}]`);
  if (sweeps.length) panel.again(filterOf(records, sweeps[0].like));
  if (left) panel.note(`${left} points are not drawn: a browser would be slow. Choose less above.`);
}

const work = {
  id: 'x-work', title: 'Work and precision',
  about: 'Each curve is one method over its steps or tolerances. Open symbols are other libraries, dashed curves adaptive, ' +
    'dotted ones under a norm policy; what is below the bar of the reference is pale.',
  setup(panel) {
    Object.assign(panel, {problem: panel.choice('Problem'), y: panel.choice('Error'), x: panel.choice('Against'),
      front: panel.tick('Front', true)});
    offerFields(panel.y, panel.records, ERRORS, 'attitude_error_max');
    offerFields(panel.x, panel.records, COSTS, 'cpu_time_s');
  },
  draw(panel, context) {
    const sweeps = ofInstance(panel.problem, context.records, context.sweeps);
    drawSweeps(panel, context, sweeps, panel.x.value, panel.y.value, panel.front.checked);
  },
};

/** A slope with no more digits than its interval allows. */
function slopeText({slope, half_width: half}) {
  if (slope === undefined) return '–';
  return slope.toFixed(half ? Math.min(3, Math.max(1, 1 - Math.floor(Math.log10(half)))) : 2);
}

const orders = {
  id: 'x-orders', title: 'Orders, with their intervals',
  about: 'The error at the end against the step, and the slope where it is one: least squares over the longest stretch ' +
    'of steps whose local slopes agree, with its 95% interval.',
  setup(panel) { panel.problem = panel.choice('Problem'); },
  draw(panel, context) {
    const {records} = context;
    const fixed = context.sweeps.filter((sweep) => sweep.order);
    const sweeps = ofInstance(panel.problem, records, fixed);
    drawSweeps(panel, context, sweeps, 'h', 'attitude_error_end', false);
    panel.tabulate([['method'], ['order', true], ['± (95%)', true], ['points', true], ['steps [s]', true], ['why not']],
      sweeps.map(({like, order}) => [records.method(like), slopeText(order), order.half_width === null ? '(two points)' :
        number(order.half_width, 2), order.points ? String(order.points) : '–',
      order.points ? `${number(order.h_low)} to ${number(order.h_high)}` : '–', order.reason || '']));
  },
};

const drift = {
  id: 'x-drift', title: 'Drift against time',
  about: 'The largest magnitude in each short interval of log t. The exponent p of drift ~ t^p is the record\'s: 1 is ' +
    'secular, 0.5 a random walk, 0 none. Exact zeros are drawn at 1e-17.',
  setup(panel) {
    Object.assign(panel, {problem: panel.choice('Problem'), column: panel.choice('Quantity'), control: panel.choice('Step')});
  },
  draw(panel, context) {
    const {records, units} = context;
    const chosen = context.series.filter((series) => series.name !== 'history');
    const groups = groupBy(chosen, (series) => String(records.instanceOf[series.run]));
    panel.problem.offer([...groups.keys()].sort((a, b) => a - b).map((place) => [place, records.data.instances[place].label]));
    const here = groups.get(panel.problem.value) || [];
    const columns = new Map(here.flatMap((series) => series.columns.slice(1).map((c) => [c.name, c])));
    panel.column.offer([...columns.keys()].map((name) => [name, name.replaceAll('_', ' ')]), 'norm_drift');
    const withColumn = here.filter((series) => series.columns.some((c) => c.name === panel.column.value));
    const controls = groupBy(withColumn, (series) => records.control(series.run));
    const offUsual = ([, [{run}]]) => Math.abs(Math.log10((records.value('h', run) || 1e-9) / 0.1));
    const most = [...controls].sort((a, b) => b[1].length - a[1].length || offUsual(a) - offUsual(b))[0];
    panel.control.offer([...controls.keys(), 'all'].map((c) => [c, c]), most && most[0]);
    const unit = columns.get(panel.column.value)?.unit || '';
    const {unit: shownUnit, factor} = shown(unit, units, true);
    const curves = withColumn.filter((s) => panel.control.value === 'all' || records.control(s.run) === panel.control.value).map((series) => {
      const [t, y] = [series.columns[0], series.columns.find((c) => c.name === panel.column.value)];
      const kept = t.values.map((_, i) => i).filter((i) => t.values[i] > 0 && y.values[i] !== null);
      const p = panel.column.value.startsWith('norm_drift') ? records.value('norm_growth_exponent', series.run) : null;
      return {name: records.method(series.run) + (panel.control.value === 'all' ? `, ${records.control(series.run)}` : '') +
          (p === null ? '' : `, p = ${number(p, 2)}`),
        run: series.run, mode: 'lines+markers', xs: kept.map((i) => t.values[i]),
        ys: kept.map((i) => Math.max(Math.abs(y.values[i]) * factor, FLOOR)),
        texts: kept.map((i) => `t = ${number(t.values[i])} s\n${both(y.values[i], unit, true)}`)};
    }).filter((curve) => curve.xs.length > 0);
    drawCurves(panel, records, curves, {x: {title: 't [s]', log: true},
      y: {title: titled(panel.column.value.replaceAll('_', ' '), shownUnit), log: true}});
    panel.csv = () => curvesCsv(panel, records, 't [s]', `${panel.column.value} [${shownUnit}]`);
    if (here.length) panel.again(filterOf(records, here[0].run));
    const left = records.data.series_left_out;
    if (left && curves.length) panel.note(`${left} histories are not on this page, to keep it small; the folder holds them.`);
  },
};

const profile = {
  id: 'x-profiles', title: 'Performance profiles',
  about: 'The share of problems and accuracies (1e-6, 1e-9 and 1e-12 rad, where two methods or more get there) that a method ' +
    'reaches at no more than τ times the cost of the best (Dolan and Moré 2002). Other libraries are dashed. Where it was not run, or failed, it did not get there.',
  setup(panel) {
    panel.measure = panel.choice('Cost');
    panel.measure.offer([['time', 'CPU time'], ['evaluations', 'evaluations']], panel.records.has('cpu_time_s') ? 'time' : 'evaluations');
  },
  draw(panel, {records, sweeps}) {
    const contests = [];
    for (const [place, group] of groupBy(sweeps, (sweep) => sweep.instance)) {
      if (records.data.instances[place].aside) continue;
      records.data.targets.forEach((_, target) => {
        const ranked = records.ranking(group, panel.measure.value, target);
        if (ranked.length > 1) contests.push(new Map(ranked.map(({name, value}) => [name, value])));
      });
    }
    const runOf = new Map(sweeps.map((sweep) => [records.text('integrator', sweep.like), sweep.like]));
    const all = [...profiles(contests)].sort((a, b) => b[1].at(-1).share - a[1].at(-1).share || a[1][0].tau - b[1][0].tau);
    const end = Math.max(2, ...all.map(([, points]) => points.at(-1).tau));
    const curves = all.map(([name, points]) => {
      const xs = [...points.map((p) => p.tau), 1.05 * end], ys = [...points.map((p) => p.share), points.at(-1).share];
      if (xs[0] > 1) xs.unshift(1), ys.unshift(0);
      return {name: `${name}: ${points.length} of ${contests.length}`, run: runOf.get(name), runs: xs.map(() => undefined),
        look: {...lookOf(records, runOf.get(name)), symbol: '', dash: records.isRival(runOf.get(name)) ? 'dash' : 'solid'}, mode: 'lines', shape: 'hv', xs, ys, texts: xs.map((tau, i) => `${name}: ${number(100 * ys[i])}% within a factor ${number(tau)}`)};
    });
    drawCurves(panel, records, curves, {x: {title: 'τ: cost over that of the best', log: true},
      y: {title: 'share reached', log: false, range: [0, 1.03]}});
    panel.csv = () => curvesCsv(panel, records, 'tau', 'share');
    panel.again('');
  },
};

/** Histories of the chosen runs that have all of these columns. */
function histories({records, series}, columns) {
  return series.filter((s) => s.name === 'history' && columns.every((name) => s.columns.some((c) => c.name === name)))
    .map((s) => ({...s, label: `${records.instance(s.run).label}, ${records.method(s.run)}, ${records.control(s.run)}`}));
}
function columnsOf(series, names) { return names.map((name) => series.columns.find((c) => c.name === name).values); }

/** Names of runs by what not all of them share. */
function distinguished(records, runs) {
  const parts = [(run) => records.instance(run).label, (run) => records.method(run), (run) => records.control(run)];
  const telling = parts.filter((part, k) => k === 0 || new Set(runs.map(part)).size > 1);
  return runs.map((run) => telling.map((part) => part(run)).join(', '));
}

const history = {
  id: 'x-histories', title: 'Histories of controlled runs',
  about: 'What a controller does, against time: angles, rates, torques, and what the problem shows of itself.',
  setup(panel) { Object.assign(panel, {problem: panel.choice('Problem'), column: panel.choice('Quantity')}); },
  draw(panel, context) {
    const {records, units} = context;
    const groups = groupBy(histories(context, []), (s) => records.text('problem', s.run));
    panel.problem.offer([...groups.keys()].map((name) => [name, name]));
    const here = groups.get(panel.problem.value) || [];
    const columns = new Map(here.flatMap((s) => s.columns.slice(1).map((c) => [c.name, c])));
    panel.column.offer([...columns.keys()].map((name) => [name, name.replaceAll('_', ' ')]), 'alpha');
    const unit = columns.get(panel.column.value)?.unit || '';
    const {unit: shownUnit, factor} = shown(unit, units);
    const withColumn = here.filter((s) => s.columns.some((c) => c.name === panel.column.value));
    const names = distinguished(records, withColumn.map((s) => s.run));
    const curves = withColumn.map((s, k) => {
      const [t, y] = columnsOf(s, [s.columns[0].name, panel.column.value]);
      const kept = t.map((_, i) => i).filter((i) => y[i] !== null);
      return {name: names[k], run: s.run, look: {...lookAt(k), symbol: ''}, mode: 'lines', xs: kept.map((i) => t[i]), ys: kept.map((i) => y[i] * factor),
        texts: kept.map((i) => `t = ${number(t[i], 4)} s\n${both(y[i], unit)}`)};
    });
    drawCurves(panel, records, curves, {x: {title: 't [s]', log: false}, y: {title: titled(panel.column.value.replaceAll('_', ' '), shownUnit), log: false}});
    panel.csv = () => curvesCsv(panel, records, 't [s]', `${panel.column.value} [${shownUnit}]`);
    if (here.length) panel.again(`^${panel.problem.value}/`);
  },
};

const RATES = ['wx', 'wy', 'wz'];
/** Rates along the principal axes, where the body has others; axes: rows of unit vectors, or null. */
function inAxes(axes, rates) {
  return axes ? axes.map((axis) => rates[0].map((_, i) => axis.reduce((sum, a, k) => sum + a * rates[k][i], 0))) : rates;
}
const polhode = {
  id: 'x-polhodes', title: 'Polhodes on the inertia ellipsoid', space: true,
  about: 'Without torque the body rate stays on the ellipsoid of its energy and runs along a polhode: around the axis of the greatest or of the ' +
    'least moment of inertia, never the middle one. From the integrals of motion; a controlled run leaves the ellipsoid. ' +
    'Drag to turn, or use the arrow keys.',
  setup(panel) { Object.assign(panel, {body: panel.choice('Body'), run: panel.choice('With the rates of')}); },
  draw(panel, context) {
    const {records, units} = context;
    const {spins} = records.data;
    panel.body.offer(spins.map((spin, k) => [String(k), spin.label]));
    const runs = histories(context, RATES);
    panel.run.offer([['', 'no run'], ...runs.map((s, k) => [String(k), s.label])]);
    const spin = spins[panel.body.value];
    const {unit, factor} = shown('rad/s', units);
    const scaled = (points) => points.map((values) => values.map((v) => v * factor));
    const lines = [];
    if (spin) {
      for (const curve of spin.family) lines.push({name: 'polhode of the same energy', points: scaled(curve), colour: variable('--ink'), width: 1, faint: true});
      lines.push({name: 'polhode of the motion', points: scaled(spin.own), colour: '#D55E00', width: 3.5});
      lines.push({name: 'start', points: scaled(spin.omega0.map((w) => [w])), colour: '#D55E00', width: 1, mode: 'markers'});
    }
    if (spin && panel.run.value !== '') {
      const s = runs[panel.run.value];
      lines.push({name: s.label, points: scaled(inAxes(spin.axes, columnsOf(s, RATES))), colour: lookAt(4).colour, width: 2.5});
    }
    const names = spin?.axes ? ['1', '2', '3'] : ['x', 'y', 'z'];
    drawSpace(panel, lines, spin ? spin.semi_axes.map((a) => a * factor) : [1, 1, 1], names.map((axis) => `ω${axis} [${unit}]`));
    const tuple = (values) => `(${values.map((v) => number(v)).join(', ')})`;
    panel.output.textContent = spin ? `Principal moments ${spin.inertia.map((j) => number(j)).join(', ')} kg m²; ω0 = ` +
      `${tuple(spin.omega0.map((w) => w * factor))} ${unit}${spin.axes ? `, along the principal axes ${spin.axes.map(tuple).join(', ')} of the body` : ''}.` : '';
    panel.csv = () => csvOf([['curve', 'n', ...names.map((axis) => `omega_${axis} [${unit}]`)],
      ...lines.flatMap((line, n) => line.points[0].map((_, i) => [line.name, n, ...line.points.map((p) => p[i])]))]);
    panel.again('');
  },
};

const QUATERNION = ['q1', 'q2', 'q3', 'q4'];
/** The k-th column of R(q), q = (v, s), body to inertial: where that body axis points. */
function bodyAxis([a, b, c, s], k) {
  const n = Math.hypot(a, b, c, s) ** 2;
  return [[1 - 2 * (b * b + c * c) / n, 2 * (a * b + c * s) / n, 2 * (a * c - b * s) / n],
    [2 * (a * b - c * s) / n, 1 - 2 * (a * a + c * c) / n, 2 * (b * c + a * s) / n],
    [2 * (a * c + b * s) / n, 2 * (b * c - a * s) / n, 1 - 2 * (a * a + b * b) / n]][k];
}
const sphere = {
  id: 'x-sphere', title: 'Attitude on the sphere', space: true,
  about: 'The track of a body axis among the stars, from a run\'s history; the dot is where it begins. Drag to turn, or use the arrow keys.',
  setup(panel) {
    Object.assign(panel, {run: panel.choice('Run'), axis: panel.choice('Axis')});
    panel.axis.offer([['0', 'body x'], ['1', 'body y'], ['2', 'body z']]);
  },
  draw(panel, context) {
    const runs = histories(context, QUATERNION);
    panel.run.offer(runs.map((s, k) => [String(k), s.label]));
    const s = runs[panel.run.value];
    const lines = [];
    if (s) {
      const q = columnsOf(s, QUATERNION);
      const track = q[0].map((_, i) => bodyAxis(q.map((values) => values[i]), Number(panel.axis.value)));
      const points = [0, 1, 2].map((k) => track.map((p) => p[k]));
      lines.push({name: s.label, points, colour: '#D55E00', width: 2.5});
      lines.push({name: 'start', points: points.map((values) => [values[0]]), colour: '#D55E00', width: 1, mode: 'markers'});
    }
    drawSpace(panel, lines, [1, 1, 1], ['X', 'Y', 'Z']);
    panel.output.replaceChildren();
    if (s) panel.readout(s.run, '');
    panel.csv = () => csvOf([['t [s]', 'X', 'Y', 'Z'], ...(s ? s.columns[0].values.map((t, i) => [t, ...lines[0].points.map((p) => p[i])]) : [])]);
    if (s) panel.again(filterOf(context.records, s.run));
  },
};

export const pictures = {work, drift, orders, profile, history, polhode, sphere};
