// The records of the page: how they are unpacked, chosen, named and ranked. Nothing here touches the document.

/** Numbers as people read them: "5.03e-10", "0.25"; – for what is absent. */
export function number(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e-4 && size < 1e6) return String(Number(value.toPrecision(digits)));
  return value.toExponential(digits - 1).replace(/\.?0+e/, 'e').replace('e+', 'e');
}

/** A CPU time in the unit that suits it. */
export function duration(seconds, digits = 3) {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return '–';
  for (const [unit, size] of [['s', 1], ['ms', 1e-3], ['µs', 1e-6]]) {
    if (seconds >= size) return `${number(seconds / size, digits)} ${unit}`;
  }
  return `${number(seconds / 1e-9, digits)} ns`;
}

const DEGREE = Math.PI / 180;
/** Units that people expect beside SI: of errors, which are small, and of angles and rates. */
const CUSTOMARY = {
  error: {unit: 'arcsec', factor: 3600 / DEGREE},
  rad: {unit: 'deg', factor: 1 / DEGREE},
  'rad/s': {unit: 'deg/s', factor: 1 / DEGREE},
};

/** How a quantity is shown under a choice of units, "si" or "customary": {unit, factor}. */
export function shown(unit, choice, isError = false) {
  const other = CUSTOMARY[isError && unit === 'rad' ? 'error' : unit];
  return choice === 'customary' && other ? other : {unit, factor: 1};
}

/** A value in SI, and beside it in the customary unit: "5.03e-10 rad (0.000104 arcsec)". */
export function both(value, unit, isError = false) {
  const si = `${number(value)}${unit ? ` ${unit}` : ''}`;
  const other = shown(unit, 'customary', isError);
  return other.factor === 1 || value === null ? si : `${si} (${number(value * other.factor)} ${other.unit})`;
}

/** Words of the fields that a picture can show; what a run's error or drift is, and what it costs. */
export const ERRORS = {
  attitude_error_max: 'attitude error, largest',
  attitude_error_end: 'attitude error at the end',
  attitude_error_l2: 'attitude error, mean square over time',
  rate_error_max: 'rate error, largest, relative',
  rate_error_end: 'rate error at the end, relative',
  norm_drift_max: 'norm drift, delivered',
  norm_drift_raw_max: 'norm drift, before projection',
  energy_drift_max: 'energy drift, relative',
  momentum_drift_max: '|L| drift, relative',
  momentum_direction_max: 'turn of L in space',
  position_defect_max: 'defect of the constraint, positions',
  velocity_defect_max: 'defect of the constraint, velocities',
  multiplier_error_max: 'error of the multiplier, relative',
};
export const COSTS = {
  cpu_time_s: 'CPU time',
  evaluations: 'evaluations',
  steps: 'steps',
  iterations: 'nonlinear iterations',
  h: 'step h',
  rtol: 'relative tolerance',
};

/** A text for a shell. */
function quoted(text) {
  return /^[\w.,:=+-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
}

/** Rows as RFC 4180, full precision. */
export function csvOf(rows) {
  const entry = (value) => {
    let text = value === null || value === undefined ? '' : String(value);
    if (typeof value === 'string' && /^[=+\-@]/.test(text)) text = ` ${text}`;  // no formula for a spreadsheet
    return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  return rows.map((row) => row.map(entry).join(',')).join('\r\n') + '\r\n';
}

/** All records of the page. A run is its place; a sweep is the runs of one method under one kind of control. */
export class Records {
  constructor(data) {
    this.data = data;
    this.count = data.records.count;
    this.numbers = data.records.numbers;
    this.instanceOf = new Int32Array(this.count);
    this.sweeps = [];
    data.instances.forEach((instance, place) => {
      for (const sweep of instance.sweeps) {
        Object.assign(sweep, {instance: place, like: sweep.runs[0]});
        this.sweeps.push(sweep);
        for (const run of sweep.runs) this.instanceOf[run] = place;
      }
    });
  }

  has(field) { return field in this.numbers; }
  /** A number of a run, null if it has none. */
  value(field, run) { return this.numbers[field] ? this.numbers[field].values[run] : null; }
  unit(field) { return this.numbers[field] ? this.numbers[field].unit : ''; }
  text(field, run) {
    const column = this.data.records.texts[field];
    return column.words[column.at[run]];
  }
  words(field) { return this.data.records.texts[field].words; }
  instance(run) { return this.data.instances[this.instanceOf[run]]; }
  integrator(run) { return this.data.integrators[this.text('integrator', run)]; }
  family(run) { return this.integrator(run).family || (this.integrator(run).rival ? 'library' : 'own'); }
  isOk(run) { return this.text('status', run) === 'ok'; }
  isRival(run) { return this.integrator(run).rival; }

  /** "gauss2 (quaternion, project)" */
  method(run) {
    const policy = this.text('policy', run);
    const rest = policy === 'none' ? '' : `, ${policy}`;
    return `${this.text('integrator', run)} (${this.text('formulation', run)}${rest})`;
  }
  /** "h = 0.1 s" or "rtol = 1e-6" */
  control(run) {
    const h = this.value('h', run), rtol = this.value('rtol', run);
    if (h !== null) return `h = ${number(h, 4)} s`;
    return rtol === null ? 'no step or tolerance' : `rtol = ${number(rtol, 4)}`;
  }
  /** True if the error says no more than the reference's bar. */
  belowBar(run, field) {
    const bar = this.value('reference_bar', run), error = this.value(field, run);
    return field.startsWith('attitude_error') && bar !== null && error !== null && error <= bar;
  }

  /** True if the run is chosen. */
  matches(run, filters) {
    const is = (wanted, value) => !wanted || wanted === value;
    return is(filters.problem, this.text('problem', run)) && is(filters.formulation, this.text('formulation', run)) &&
        is(filters.policy, this.text('policy', run)) && is(filters.family, this.family(run)) &&
        is(filters.side, this.isRival(run) ? 'rival' : 'own') &&
        (!filters.name || this.text('integrator', run).includes(filters.name));
  }
  /** The chosen sweeps; all runs of a sweep share what is chosen by. */
  chosenSweeps(filters) { return this.sweeps.filter((sweep) => this.matches(sweep.like, filters)); }

  /** What polhode is called with to make this run again. */
  command(run) {
    const part = (flag, value) => (value === null || value === '' ? '' : ` --${flag} ${quoted(String(value))}`);
    const instance = this.instance(run);
    const set = Object.entries(instance.set).map(([name, values]) => part('set', `${name}=${values.join(',')}`));
    return `polhode simulate ${quoted(this.text('problem', run))}${part('variant', this.text('variant', run))}` +
        `${part('formulation', this.text('formulation', run))}${part('integrator', this.text('integrator', run))}` +
        `${this.text('policy', run) === 'none' ? '' : part('policy', this.text('policy', run))}` +
        `${part('h', this.value('h', run))}${part('rtol', this.value('rtol', run))}` +
        `${part('atol', this.value('atol', run))}${part('t-end', instance.t_end)}${set.join('')}`;
  }

  /** All that is recorded of a run, as [name, text] for a reader. */
  facts(run) {
    const facts = [['cell', this.text('cell', run)], ['problem', this.instance(run).label],
      ['method', this.method(run)], ['control', this.control(run)], ['status', this.text('status', run)]];
    if (this.text('reason', run)) facts.push(['reason', this.text('reason', run)]);
    for (const [field, words] of Object.entries(ERRORS)) {
      const value = this.value(field, run);
      if (value !== null) facts.push([words, both(value, this.unit(field), true)]);
    }
    if (this.value('reference_bar', run) !== null) {
      facts.push(['bar of the reference', both(this.value('reference_bar', run), 'rad', true)]);
    }
    for (const field of ['norm_growth_exponent', 'steps', 'evaluations']) {
      const value = this.value(field, run);
      if (value !== null) facts.push([field.replaceAll('_', ' '), number(value, field === 'norm_growth_exponent' ? 3 : 12)]);
    }
    if (this.value('cpu_time_s', run) !== null) {
      const [low, high] = ['low', 'high'].map((end) => duration(this.value(`cpu_time_s_${end}`, run)));
      facts.push(['CPU time', `${duration(this.value('cpu_time_s', run))} (${low} to ${high})`]);
    }
    return facts;
  }

  /**
   * The cheapest way of each integrator to a target, cheapest first: of the chosen sweeps of one instance.
   * measure: "time" or "evaluations"; target: place in data.targets.
   */
  ranking(sweeps, measure, target) {
    const best = new Map();
    for (const sweep of sweeps) {
      const row = sweep[measure][target];
      if (!row) continue;
      const [value, low, high, run, interpolated] = row;
      const name = this.text('integrator', run);
      if (!best.has(name) || value < best.get(name).value) best.set(name, {name, value, low, high, run, interpolated});
    }
    return [...best.values()].sort((a, b) => a.value - b.value);
  }
}

/** Sweeps by what `key` says of them. */
export function groupBy(list, key) {
  const groups = new Map();
  for (const item of list) {
    const k = key(item);
    if (!groups.has(k)) groups.set(k, []);
    groups.get(k).push(item);
  }
  return groups;
}

/**
 * Performance profiles (Dolan and Moré 2002): of `contests`, each a Map solver -> cost, the share that a solver wins
 * within a factor tau of the best. A solver that is missing did not get there: its cost is infinite.
 */
export function profiles(contests) {
  const ratios = new Map();
  for (const contest of contests) {
    const best = Math.min(...contest.values());
    for (const [solver, cost] of contest) {
      if (!ratios.has(solver)) ratios.set(solver, []);
      ratios.get(solver).push(cost / best);
    }
  }
  return new Map([...ratios].map(([solver, list]) => [solver, list.sort((a, b) => a - b).map((tau, i) => ({
    tau, share: (i + 1) / contests.length}))]));
}

/** The points that no other beats in both: cheapest first. Points have x and y. */
export function front(points) {
  const sorted = [...points].sort((a, b) => a.x - b.x || a.y - b.y);
  let least = Infinity;
  return sorted.filter((p) => (p.y < least ? ((least = p.y), true) : false));
}
