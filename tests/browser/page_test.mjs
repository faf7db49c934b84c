// The report's page in Debian's Chromium, from file://, as its reader meets it.
//   node page_test.mjs POLHODE       POLHODE_SCREENSHOTS=DIR keeps pictures to look at
// Exits with 77, and says why, where there is no browser or no playwright-core, or polhode was built without plotly.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import {pathToFileURL} from 'node:url';

const here = import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname);
const [, , polhode] = process.argv;

function skip(reason) {
  console.log(`skipped: ${reason}`);
  process.exit(77);
}
const browserPath = (process.env.PATH || '').split(':').map((folder) => path.join(folder, 'chromium')).find((file) => fs.existsSync(file));
if (!browserPath) skip('chromium is not on the PATH (bench/install browser)');
const {chromium} = await import('playwright-core').catch(() => skip('playwright-core is not installed (bench/install browser)'));

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'polhode-page-'));
process.on('exit', () => fs.rmSync(folder, {recursive: true, force: true}));

const run = (...words) => execFileSync(polhode, words, {stdio: ['ignore', 'pipe', 'inherit'], encoding: 'utf8'});
/** A report of these lines of records; returns the page. */
function report(name, lines) {
  const results = path.join(folder, name);
  fs.mkdirSync(results);
  fs.writeFileSync(path.join(results, 'run.jsonl'), lines.map((line) => JSON.stringify(line) + '\n').join(''));
  run('report', results, '--out', path.join(results, 'page'));
  return pathToFileURL(path.join(results, 'page', 'report.html')).href;
}

// --- Pages: a real one with hostile texts, one of a single record, one of refusals alone ------------------------------
const made = path.join(folder, 'made');
run('run', path.join(here, 'suite.toml'), '--out', made);
const lines = fs.readdirSync(made).filter((file) => file.endsWith('.jsonl'))
  .flatMap((file) => fs.readFileSync(path.join(made, file), 'utf8').trim().split('\n')).map((line) => JSON.parse(line));
const hostile = '</script><script>window.hacked = 1</script><img src=x onerror="window.hacked = 2">';
const runs = lines.filter((line) => line.kind === 'run');
runs.find((r) => r.status === 'refused').reason = hostile;
runs.find((r) => r.status === 'ok' && r.integrator === 'rk4').reference = hostile;
lines.filter((line) => line.name === 'history').forEach((s) => { s.columns[s.columns.length - 1] = hostile; s.units[s.units.length - 1] = hostile; });
const url = report('real', lines);
const head = lines.filter((line) => line.kind === 'meta');
const single = report('single', [...head, runs.find((r) => r.status === 'ok')]);
const refusals = report('refusals', [...head, ...runs.filter((r) => r.status === 'refused')]);
const blind = report('blind', [...head, ...runs.map((r) => ({...r, reference: '', reference_bar: null, cpu_time_s: null,
  attitude_error_max: null, attitude_error_end: null, attitude_error_l2: null, rate_error_max: null, rate_error_end: null}))]);
if (!fs.readFileSync(new URL(url), 'utf8').includes('polhode-data')) skip('polhode was built without plotly (bench/install report)');

// --- The browser ------------------------------------------------------------------------------------------------------
const flags = ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];
const launch = (...more) => chromium.launch({executablePath: browserPath, args: [...flags, ...more], timeout: patience});
/** A busy machine is no failure [ms]. */
const patience = 120_000;
/** Opens a page that must neither ask for anything nor complain. */
async function open(browser, address, options = {}) {
  const page = await browser.newPage({viewport: {width: 1280, height: 900}, ...options});
  page.setDefaultTimeout(patience);
  page.complaints = [];
  page.on('request', (r) => { if (!/^(file|data|blob):/.test(r.url()) || (r.url() !== address && r.url().startsWith('file:'))) page.complaints.push(`asks for ${r.url()}`); });
  page.on('console', (m) => { if (m.type() === 'error') page.complaints.push(`console: ${m.text()}`); });
  page.on('pageerror', (e) => page.complaints.push(`error: ${e.stack}`));
  await page.goto(address);
  return page;
}
async function close(page) {
  assert.deepEqual(page.complaints, []);
  assert.equal(await page.evaluate(() => window.hacked), undefined);
  await page.context().close();
}
/** Brings a panel into sight and waits until it has drawn. */
async function show(page, id) {
  const panel = page.locator(`#${id}`);
  await panel.scrollIntoViewIfNeeded();
  await panel.locator('.plot .main-svg, .plot canvas, table, .remark:not([hidden])').first().waitFor({state: 'attached'});
  return panel;
}
/** Draws all panels at once, as before printing. */
async function showAll(page) {
  await page.evaluate(() => window.dispatchEvent(new Event('beforeprint')));
  return page.locator('.panel').evaluateAll((panels) => panels.map((p) => p.id));
}
const traces = (panel) => panel.locator('.plot').evaluate((plot) => plot.data.map(({name, x, y, visible}) => ({name, x: [...x], y: [...y], visible})));
const option = (where, label, value) => where.getByRole('combobox', {name: label, exact: true}).selectOption(value);

const tests = {
  async 'numbers of a picture are the records\''(browser) {
    const page = await open(browser, url);
    assert.equal(await page.locator('.chosen').textContent(), `${runs.length} of ${runs.length} runs`);
    const panel = await show(page, 'x-work');
    const looks = await panel.locator('.plot').evaluate((plot) => plot.data.map(({line, marker}) => `${line.color} ${line.dash} ${marker.symbol}`));
    assert.equal(new Set(looks).size, looks.length, 'curves are told apart');
    const rk4 = (await traces(panel)).find((t) => t.name === 'rk4 (quaternion)');
    const wanted = runs.filter((r) => r.problem === 'free_body' && r.integrator === 'rk4' && r.status === 'ok').sort((a, b) => b.h - a.h);
    assert.deepEqual(rk4.y, wanted.map((r) => r.attitude_error_max));
    assert.deepEqual(rk4.x, wanted.map((r) => r.cpu_time_s.median));
    await option(panel, 'Against', 'evaluations');
    await option(panel, 'Error', 'energy_drift_max');
    const changed = (await traces(panel)).find((t) => t.name === 'rk4 (quaternion)');
    assert.deepEqual(changed.x, wanted.map((r) => r.evaluations));
    assert.deepEqual(changed.y, wanted.map((r) => r.energy_drift_max));
    await option(panel, 'Error', 'attitude_error_max');
    await option(page.locator('.filters'), 'Units', 'customary');
    const arcseconds = (await traces(panel)).find((t) => t.name === 'rk4 (quaternion)').y[0];
    assert.ok(Math.abs(arcseconds / wanted[0].attitude_error_max / 206264.806 - 1) < 1e-6);
    await close(page);
  },

  async 'the answer comes first, and opens'(browser) {
    const page = await open(browser, url);
    assert.equal(await page.locator('main table').first().locator('thead th').first().textContent(), 'need');
    const [row] = await page.locator('#table-needs tbody tr', {hasText: 'long free motion'}).allTextContents();
    assert.ok(row.includes('free_body, 50 s: '), row);
    assert.equal(await page.locator('#table-needs tbody tr', {hasText: 'These records cannot say'}).count() > 0, true);
    await close(page);
  },

  async 'filters choose'(browser) {
    const page = await open(browser, url);
    const panel = await show(page, 'x-work');
    const filters = page.locator('.filters');
    await option(filters, 'Side', 'rival');
    const names = (await traces(panel)).map((t) => t.name).filter((name) => !name.startsWith('the front'));
    assert.ok(names.length > 0 && names.every((name) => name.startsWith('odeint_')), names.join());
    assert.equal(await page.locator('.chosen').textContent(), `${runs.filter((r) => r.integrator.startsWith('odeint')).length} of ${runs.length} runs`);
    await filters.getByRole('button', {name: 'Reset'}).click();
    await option(filters, 'Problem', 'tether_capture');
    await option(filters, 'Norm policy', 'project');
    assert.deepEqual((await traces(panel)).map((t) => t.name), ['gauss2 (quaternion, project)']);
    await filters.getByLabel('Integrator').fill('nobody');
    assert.equal(await panel.locator('.remark').textContent(), 'Nothing of what is chosen can be shown here.');
    await close(page);
  },

  async 'keys read points out, the legend switches, the data come as CSV'(browser) {
    const page = await open(browser, url);
    const panel = await show(page, 'x-work');
    await panel.locator('.plot').focus();
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('ArrowRight');
    const [first] = await traces(panel);
    const run = runs.find((r) => r.attitude_error_max === first.y[1] && r.cpu_time_s.median === first.x[1]);
    const readout = await panel.locator('.readout').textContent();
    assert.ok(readout.includes(run.cell), readout);
    assert.ok(readout.includes(`--integrator ${run.integrator} --h ${run.h}`), readout);
    await panel.locator('.legend button').first().press('Enter');
    assert.equal((await traces(panel))[0].visible, false);
    const [download] = await Promise.all([page.waitForEvent('download'), panel.getByRole('button', {name: 'CSV'}).click()]);
    const csv = fs.readFileSync(await download.path(), 'utf8').trim().split('\r\n');
    assert.equal(csv[0], 'curve,cell,cpu_time_s,attitude_error_max [rad]');
    assert.ok(csv.some((line) => line.includes(`,${run.cell},${run.cpu_time_s.median},${run.attitude_error_max}`)), csv[1]);
    assert.match(await panel.locator('.take code').textContent(), /^polhode run DIR\/suite.toml --filter '\^free_body\/\/' --out NEW/);
    await close(page);
  },

  async 'tables name winners, reasons and orders'(browser) {
    const page = await open(browser, url);
    const winners = await show(page, 'x-winners');
    const cell = winners.locator('button.cell').first();
    const winner = await cell.locator('b').textContent();
    await cell.focus();
    assert.ok((await winners.locator('.readout').textContent()).includes(`1. ${winner} (`));
    const failures = await show(page, 'x-failures');
    await failures.locator('tr', {hasText: 'cf4'}).locator('button').first().focus();
    assert.ok((await failures.locator('.readout').textContent()).includes('refused: '));
    const orders = await show(page, 'x-orders');
    assert.match(await orders.locator('tr', {hasText: 'rk4 (quaternion)'}).first().textContent(), /[34]\.\d+/);
    for (const id of ['x-formulations', 'x-speed']) assert.ok(await (await show(page, id)).locator('tbody tr').count() > 2, id);
    for (const id of ['x-profiles', 'x-drift']) assert.ok((await traces(await show(page, id))).length > 3, id);
    const histories = await show(page, 'x-histories');
    assert.ok((await traces(histories))[0].y.length > 100);
    await option(histories, 'Quantity', hostile);  // shown as text, whatever it holds
    assert.ok((await traces(histories))[0].y.length > 100);
    await close(page);
  },

  async 'space is drawn, and projected where it cannot be'(browser) {
    const other = await launch('--enable-unsafe-swiftshader');
    for (const [where, flat] of [[browser, true], [other, false]]) {
      const page = await open(where, url);
      for (const id of flat ? ['x-polhodes', 'x-sphere'] : ['x-polhodes']) {
        const panel = await show(page, id);
        const fallen = (await panel.locator('.remark').textContent()).includes('no WebGL');
        if (flat) assert.ok(fallen);
        if (flat && id === 'x-polhodes') {
          const titles = () => panel.locator('.plot').evaluate((plot) => plot.layout.annotations.map(({text}) => text));
          assert.deepEqual(await titles(), ['ωx [rad/s]', 'ωy [rad/s]', 'ωz [rad/s]']);
          await option(panel, 'Body', {label: 'free_body, inertia = (100 120 110 7 -11 4), 50 s'});
          assert.deepEqual(await titles(), ['ω1 [rad/s]', 'ω2 [rad/s]', 'ω3 [rad/s]']);
          assert.match(await panel.locator('.readout').textContent(), /along the principal axes \(/);
        }
        const kinds = await panel.locator('.plot').evaluate((plot) => plot.data.map(({type}) => type));
        assert.ok(kinds.includes(fallen ? 'scatter' : 'scatter3d') && kinds.length >= 2, `${id}: ${kinds}`);
        if (!flat) console.log(fallen ? '        (no WebGL here)' : '        (WebGL in software)');
        if (fallen) continue;
        const eye = () => panel.locator('.plot').evaluate((plot) => plot._fullLayout.scene.camera.eye.x);
        const before = await eye();
        await panel.locator('.plot').focus();
        await page.keyboard.press('ArrowLeft');
        await page.waitForTimeout(100);
        assert.notEqual(await eye(), before);
      }
      await close(page);
    }
    await other.close();
  },

  async 'little to show is no error'(browser) {
    for (const [name, address] of Object.entries({single, refusals, blind})) {
      const page = await open(browser, address);
      assert.ok((await showAll(page)).length > 8);
      const said = await page.locator('.panel .remark').allTextContents();
      assert.ok(said.some((text) => text.startsWith('Nothing of what is chosen')), `${name}: ${said}`);
      assert.equal(await page.locator('#x-work .plot').isVisible(), name !== 'refusals', name);
      await close(page);
    }
  },

  async 'without scripts the still pictures remain'(browser) {
    const page = await open(browser, url, {javaScriptEnabled: false});
    assert.ok(await page.locator('#explore .still svg').isVisible());
    assert.ok(await page.locator('#explore noscript p').isVisible());
    await page.context().close();
  },

  async 'fits phones and wide screens, in light and dark'(browser) {
    const page = await open(browser, url, {viewport: {width: 1600, height: 900}, colorScheme: 'light'});
    for (const [colorScheme, width] of [['light', 1600], ['dark', 360]]) {
      await page.setViewportSize({width, height: 900});
      await page.emulateMedia({colorScheme});
      const ids = await showAll(page);
      if (process.env.POLHODE_SCREENSHOTS) {
        for (const id of ids) {
          const panel = await show(page, id);
          await page.waitForTimeout(500);
          await panel.screenshot({path: path.join(process.env.POLHODE_SCREENSHOTS, `${colorScheme}-${width}-${id}.png`)});
        }
      }
      const [content, seen] = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
      assert.ok(content <= seen, `${content} px wide at ${seen}`);
      const panel = await show(page, 'x-work');
      const wanted = colorScheme === 'dark' ? '#e4e7ea' : '#1d2125';
      await page.waitForFunction((ink) => document.querySelector('#x-work .plot')._fullLayout.font.color === ink, wanted);
      const box = await panel.locator('.plot .main-svg').first().boundingBox();
      assert.ok(box.width > 0.8 * Math.min(width, 1408) - 40 && box.width <= width, `a picture of ${box.width} px at ${width}`);
    }
    await close(page);
  },
};

const browser = await launch('--disable-3d-apis');  // in software, space is slow
let failed = 0;
const waiting = Object.entries(tests);
/** Two at a time: most of a test is waiting. */
async function work() {
  for (let next = waiting.shift(); next; next = waiting.shift()) {
    const [name, test] = next, start = Date.now();
    try {
      await test(browser);
      console.log(`ok      ${name} (${Date.now() - start} ms)`);
    } catch (error) {
      ++failed;
      console.log(`FAILED  ${name}\n${error.stack}`);
    }
  }
}
await Promise.all([work(), work()]);
await browser.close();
process.exit(failed ? 1 : 0);
