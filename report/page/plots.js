// Pictures: colours, axes with their decades, what a panel has around its picture. Plotly draws.
import {csvOf} from './records.js';

const SYMBOLS = ['circle', 'square', 'triangle-up', 'triangle-down', 'diamond', 'pentagon', 'x', 'cross', 'star'];
const DASHES = ['solid', 'dash', 'dot', 'dashdot'];
/** Paths of the symbols in a legend, in a box from -5 to 5. */
const SHAPES = {
  circle: 'M-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0', square: 'M-3.6-3.6h7.2v7.2h-7.2z', 'triangle-up': 'M0-4.4L4.2 3.4H-4.2z',
  'triangle-down': 'M0 4.4L4.2-3.4H-4.2z', diamond: 'M0-4.8L4.2 0L0 4.8L-4.2 0z',
  pentagon: 'M0-4.4L4.2-1.4L2.6 3.6H-2.6L-4.2-1.4z',
  x: 'M-4.2-2.4L-2.4-4.2L0-1.8L2.4-4.2L4.2-2.4L1.8 0L4.2 2.4L2.4 4.2L0 1.8L-2.4 4.2L-4.2 2.4L-1.8 0z',
  cross: 'M-1.4-4.4H1.4V-1.4H4.4V1.4H1.4V4.4H-1.4V1.4H-4.4V-1.4H-1.4z',
  star: 'M0-4.8L1.2-1.5L4.6-1.5L1.9.6L2.9 4L0 2L-2.9 4L-1.9.6L-4.6-1.5L-1.2-1.5z',
};

export function onTheme(change) { window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', change); }

export function variable(name) { return getComputedStyle(document.documentElement).getPropertyValue(name).trim(); }

/** The colour of a method's place, as in the still figures. Symbols tell what colours cannot. */
function colourAt(place) { return variable(`--curve-${place % Number(variable('--curves'))}`); }

/** Text for Plotly, which reads a little HTML. */
export function plain(text) {
  return String(text).replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;');
}

/** How a run's method looks: colour by integrator, symbol by integrator and formulation (in quaternions as in the still
 * figures), open for rivals, dashed if adaptive, dotted by policy. */
export function lookOf(records, run) {
  const {look, rival} = records.integrator(run);
  const others = records.words('formulation').filter((word) => word !== 'quaternion').sort();
  const shift = 1 + others.indexOf(records.text('formulation', run));  // 0 for quaternions
  const adaptive = records.value('h', run) === null, policy = records.text('policy', run) !== 'none';
  return {colour: colourAt(look), symbol: SYMBOLS[(look + shift) % SYMBOLS.length], open: rival,
    dash: DASHES[(adaptive ? 1 : 0) + (policy ? 2 : 0)]};
}

/** A look for the k-th of curves that are not told apart by their methods. */
export function lookAt(k) {
  const first = [3, 12, 2, 6, 0, 1, 15, 10];
  return {colour: colourAt(first[k % 8]), symbol: SYMBOLS[k % SYMBOLS.length], open: false,
    dash: DASHES[Math.floor(k / 8) % 4]};
}

/** Ticks of a logarithmic axis over [low, high] in log10: whole decades, at most nine labelled; within less, 1, 2, 5. */
export function ticks(low, high) {
  const values = [], texts = [];
  if (high - low < 1.2) {
    for (let k = Math.floor(low); k <= Math.ceil(high); ++k) {
      for (const m of [1, 2, 5]) {
        const value = Number(`${m}e${k}`);  // 0.2, not 0.2 and a rounding
        values.push(value);
        texts.push(Math.abs(k) <= 3 ? String(value) : `${m}·10<sup>${k}</sup>`);
      }
    }
    return {tickvals: values, ticktext: texts};
  }
  const stride = Math.max(1, Math.ceil((high - low) / 9));
  for (let k = Math.ceil(low - 1e-9); k <= Math.floor(high + 1e-9); ++k) {
    values.push(10 ** k);
    texts.push(k % stride === 0 ? `10<sup>${k}</sup>` : '');
  }
  return {tickvals: values, ticktext: texts};
}

/** A Plotly axis through all values; those of a logarithmic one are positive. */
function axisOf(title, values, log) {
  const axis = {title: {text: plain(title), standoff: 8}, gridcolor: variable('--grid'), zeroline: false,
    linecolor: variable('--quiet'), automargin: true, exponentformat: 'power'};
  if (!log) return axis;
  let low = Infinity, high = -Infinity;
  for (const v of values) if (v > 0) low = Math.min(low, v), high = Math.max(high, v);
  if (!(high >= low)) return {...axis, type: 'log'};
  low = Math.log10(low), high = Math.log10(high);
  const spare = Math.max(0.15, 0.03 * (high - low));
  const range = [low - spare, high + spare];
  return {...axis, type: 'log', range, ...ticks(...range), tickmode: 'array'};
}

function themed(layout) {
  return {paper_bgcolor: 'rgba(0,0,0,0)', plot_bgcolor: 'rgba(0,0,0,0)', showlegend: false, hovermode: 'closest',
    font: {family: 'system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif', size: 13,
      color: variable('--ink')},
    hoverlabel: {align: 'left', bgcolor: variable('--row'), bordercolor: variable('--quiet'),
      font: {color: variable('--ink')}},
    margin: {l: 12, r: 16, t: 12, b: 12}, ...layout};
}
const CONFIG = {responsive: true, displaylogo: false, plotlyServerURL: '', showSendToCloud: false,
  modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d'], toImageButtonOptions: {format: 'svg'}};

/**
 * Draws curves into a panel: {name, run, xs, ys, texts, runs, grey?, mode?, look?}; a legend whose entries switch, the
 * arrow keys move from point to point, and a point's record is read out. axes: {x: {title, log}, y: ...}.
 */
export function drawCurves(panel, records, curves, axes) {
  const {plot} = panel;
  const traces = curves.map((curve) => {
    const look = curve.look || lookOf(records, curve.run);
    const texts = curve.texts.map((text) => plain(text).replaceAll('\n', '<br>'));
    return {type: 'scatter', name: plain(curve.name), x: curve.xs, y: curve.ys, mode: curve.mode || 'lines+markers',
      text: texts, hovertemplate: `<b>${plain(curve.name)}</b><br>%{text}<extra></extra>`,
      line: {color: look.colour, dash: look.dash, width: 1.6, shape: curve.shape || 'linear'},
      marker: {color: curve.grey ? curve.grey.map((is) => (is ? variable('--grid') : look.colour)) : look.colour,
        symbol: (look.symbol || 'circle') + (look.open ? '-open' : ''), size: curve.xs.length > 20 ? 5 : 7, line: {color: look.colour, width: look.open ? 1.6 : 0.6}}};
  });
  const layout = themed({
    xaxis: axisOf(axes.x.title, curves.flatMap((c) => c.xs), axes.x.log),
    yaxis: {...axisOf(axes.y.title, curves.flatMap((c) => c.ys), axes.y.log), ...(axes.y.range ? {range: axes.y.range} : {})},
  });
  panel.curves = curves;
  panel.empty(curves.length === 0);
  drawn(plot, traces, layout);
  followZoom(plot);
  readPoints(panel, records);
  legendOf(panel, records, traces);
}

function drawn(plot, traces, layout) {
  window.Plotly.react(plot, traces, layout, CONFIG);
}

/** Ticks for the decades that are seen after a zoom. */
function followZoom(plot) {
  if (plot.dataset.follows) return;
  plot.dataset.follows = 'yes';
  plot.on('plotly_relayout', (change) => {
    const update = {};
    for (const name of ['xaxis', 'yaxis']) {
      const axis = plot._fullLayout[name];
      const moved = Object.keys(change).some((key) => key.startsWith(`${name}.range`) || key === `${name}.autorange`);
      if (!moved || axis.type !== 'log') continue;
      const {tickvals, ticktext} = ticks(...axis.range);
      Object.assign(update, {[`${name}.tickvals`]: tickvals, [`${name}.ticktext`]: ticktext});
    }
    if (Object.keys(update).length) window.Plotly.relayout(plot, update);
  });
}

/** Reads a point out when it is pointed at; the arrow keys do the same without a mouse. */
function readPoints(panel, records) {
  const {plot} = panel;
  panel.at = null;
  const show = (k, i) => {
    const curve = panel.curves[k];
    if (!curve || curve.xs[i] === undefined) return;
    panel.at = [k, i];
    panel.readout(curve.runs ? curve.runs[i] : curve.run, curve.texts[i]);
  };
  plot.removeAllListeners('plotly_hover');
  plot.on('plotly_hover', ({points}) => show(points[0].curveNumber, points[0].pointIndex));
  plot.onkeydown = (event) => {
    const step = {ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowDown: [1, 0], ArrowUp: [-1, 0]}[event.key];
    if (!step || panel.curves.length === 0) return;
    event.preventDefault();
    let [k, i] = panel.at || [0, -1];
    if (step[0]) k = (k + step[0] + panel.curves.length) % panel.curves.length;
    i = Math.min(Math.max(i + step[1], 0), panel.curves[k].xs.length - 1);
    window.Plotly.Fx.hover(plot, [{curveNumber: k, pointNumber: i}]);
    show(k, i);
  };
}

/** A legend of buttons: each switches its curve off and on; pointing at it dims the others. */
function legendOf(panel, records, traces) {
  const {plot, legend} = panel;
  legend.replaceChildren(...traces.map((trace, k) => {
    const look = panel.curves[k].look || lookOf(records, panel.curves[k].run);
    const button = document.createElement('button');
    button.type = 'button';
    button.setAttribute('aria-pressed', 'true');
    button.append(keyOf(look), panel.curves[k].name);
    button.onclick = () => {
      const on = button.getAttribute('aria-pressed') !== 'true';
      button.setAttribute('aria-pressed', String(on));
      window.Plotly.restyle(plot, {visible: on}, [k]);
    };
    const emphasise = (only) => window.Plotly.restyle(plot,
      {opacity: traces.map((_, other) => (only && other !== k ? 0.15 : 1))}, traces.map((_, other) => other));
    if (traces.length > 1 && traces.length <= 80) {
      button.onfocus = button.onpointerenter = () => emphasise(true);
      button.onblur = button.onpointerleave = () => emphasise(false);
    }
    return button;
  }));
}

/** A line with its symbol, as in the picture. */
export function keyOf(look) {
  const dash = {solid: '', dash: '5 3', dot: '2 3', dashdot: '5 2 2 2'}[look.dash] || '';
  const span = document.createElement('span');
  span.className = 'key';
  span.innerHTML = `<svg viewBox="-13 -6 26 12" width="26" height="12" aria-hidden="true"><path d="M-13 0H13" ` +
      `stroke="${look.colour}" stroke-width="1.6" stroke-dasharray="${dash}"/><path d="${SHAPES[look.symbol] || ''}" ` +
      `stroke="${look.colour}" stroke-width="1.3" fill="${look.open ? 'var(--page)' : look.colour}"/></svg>`;
  return span;
}

/** The rows of the curves as CSV: curve, cell, x, y. */
export function curvesCsv(panel, records, x, y) {
  const rows = [['curve', 'cell', x, y]];
  for (const curve of panel.curves) {
    curve.xs.forEach((value, i) => {
      const run = curve.runs ? curve.runs[i] : curve.run;
      rows.push([curve.name, run === undefined ? '' : records.text('cell', run), value, curve.ys[i]]);
    });
  }
  return csvOf(rows);
}

/** True if the browser draws in three dimensions. */
function hasWebGl() {
  try {
    const canvas = document.createElement('canvas');
    return Boolean(window.WebGLRenderingContext && (canvas.getContext('webgl2') || canvas.getContext('webgl')));
  } catch { return false; }
}

/** Where one looks from, and the plane that things are then projected on: for pictures without WebGL. */
const EYE = [0.62, 0.62, 0.48];
function projected([x, y, z]) { return [0.7071 * (y - x), 0.877 * z - 0.34 * (x + y)]; }
function dot(a, b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/**
 * Lines in space on a translucent ellipsoid (semi-axes): {name, points: [xs, ys, zs], colour, width, faint}. Without
 * WebGL the same from one side. titles: of the three axes.
 */
export function drawSpace(panel, lines, semiAxes, titles) {
  const {plot} = panel;
  const most = Math.max(...semiAxes);
  panel.empty(lines.length === 0);
  if (!hasWebGl()) {
    // What faces the eye, and faintly what the ellipsoid hides.
    const traces = lines.flatMap((line) => [false, true].map((far) => {
      const points = line.points[0].map((_, i) => [0, 1, 2].map((k) => line.points[k][i]))
        .map((p) => ((dot(EYE, p.map((v, k) => v / semiAxes[k] ** 2)) < 0) === far ? projected(p) : [null, null]));
      return {type: 'scatter', mode: line.mode || 'lines', x: points.map((p) => p[0]), y: points.map((p) => p[1]),
        name: plain(line.name), opacity: far ? 0.2 : 1, hoverinfo: 'name', marker: {color: line.colour, size: 8},
        line: {color: line.colour, width: line.width}};
    }));
    const reach = 1.3 * most, ink = variable('--ink');
    const tips = [[reach, 0, 0], [0, reach, 0], [0, 0, reach]].map(projected);
    traces.push(...tips.map(([x, y]) => ({type: 'scatter', mode: 'lines', x: [0, x], y: [0, y], hoverinfo: 'skip', opacity: 0.5, line: {color: ink, width: 1}})));
    const names = tips.map(([x, y], k) => ({x: 1.1 * x, y: 1.1 * y, text: plain(titles[k]), showarrow: false, font: {color: ink}}));
    const hidden = {visible: false, zeroline: false};
    drawn(plot, traces, themed({annotations: names, xaxis: hidden, yaxis: {...hidden, scaleanchor: 'x'}}));
    panel.note('This browser draws nothing in three dimensions (no WebGL): the picture is a projection.');
    return;
  }
  const axis = (text) => ({title: {text: plain(text)}, gridcolor: variable('--grid'), color: variable('--ink'),
    showbackground: false, zerolinecolor: variable('--quiet'), range: [-1.06 * most, 1.06 * most], showspikes: false});
  const [us, vs] = [25, 49].map((n, k) => Array.from({length: n}, (_, i) => (k + 1) * Math.PI * i / (n - 1)));
  const surface = (of) => us.map((u) => vs.map((v) => of(u, v)));
  const shape = {type: 'surface', opacity: 0.38, showscale: false, hoverinfo: 'skip',
    colorscale: [[0, variable('--solid')], [1, variable('--solid')]],
    lighting: {ambient: 0.75, diffuse: 0.5, specular: 0.1}, contours: {x: {highlight: false}, y: {highlight: false}, z: {highlight: false}},
    x: surface((u, v) => 0.995 * semiAxes[0] * Math.sin(u) * Math.cos(v)),
    y: surface((u, v) => 0.995 * semiAxes[1] * Math.sin(u) * Math.sin(v)), z: surface((u) => 0.995 * semiAxes[2] * Math.cos(u))};
  const traces = lines.map((line) => ({type: 'scatter3d', mode: line.mode || 'lines', name: plain(line.name),
    x: line.points[0], y: line.points[1], z: line.points[2], opacity: line.faint ? 0.75 : 1,
    hovertemplate: `${plain(line.name)}<br>%{x:.4g}, %{y:.4g}, %{z:.4g}<extra></extra>`,
    line: {color: line.colour, width: line.width * 2}, marker: {color: line.colour, size: 5}}));
  const size = plot.clientWidth < 420 ? 1.45 : 1.28;
  drawn(plot, [shape, ...traces], themed({margin: {l: 0, r: 0, t: 0, b: 0}, scene: {
    aspectmode: 'cube', camera: {eye: {x: size, y: size, z: 0.8 * size}, center: {x: 0, y: 0, z: -0.08}},
    xaxis: axis(titles[0]), yaxis: axis(titles[1]), zaxis: axis(titles[2])}}));
  turnByKeys(plot);
}

/** The arrow keys turn the picture. */
function turnByKeys(plot) {
  plot.onkeydown = (event) => {
    const turn = {ArrowLeft: [0.15, 0], ArrowRight: [-0.15, 0], ArrowUp: [0, 0.12], ArrowDown: [0, -0.12]}[event.key];
    if (!turn) return;
    event.preventDefault();
    const {x, y, z} = plot._fullLayout.scene.camera.eye;
    const r = Math.hypot(x, y, z), azimuth = Math.atan2(y, x) + turn[0];
    const height = Math.min(1.45, Math.max(-1.45, Math.asin(z / r) + turn[1]));
    window.Plotly.relayout(plot, {'scene.camera.eye': {x: r * Math.cos(height) * Math.cos(azimuth),
      y: r * Math.cos(height) * Math.sin(azimuth), z: r * Math.sin(height)}});
  };
}
