// The report page in Chromium. Usage: node page.mjs FOLDER VIBC, where the folder holds NAME.html of each model and NAME.json of
// `analyze`. Needs playwright-core and axe-core below PLAYWRIGHT, and Chromium (CHROMIUM or /usr/bin/chromium).
// Each check says `ok: ...`; a failure ends the run with status 1.
import { createRequire } from 'node:module';
import fs from 'node:fs';
import path from 'node:path';

const require = createRequire(process.env.PLAYWRIGHT ? path.join(process.env.PLAYWRIGHT, 'x.js') : import.meta.url);
const { chromium } = require('playwright-core');
const axe = fs.readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
const folder = process.argv[2];
const faults = [];
const names = fs.readdirSync(folder).filter(name => name.endsWith('.html')).map(name => name.slice(0, -5)).sort();
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox', '--disable-gpu'] });

/** A page that notes every message, error and request. */
async function open(name, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1200, height: 900 }, reducedMotion: 'reduce', ...options });
  const page = await context.newPage();
  page.on('console', message => faults.push(`${name}: console: ${message.text()}`));
  page.on('pageerror', error => faults.push(`${name}: page: ${error}`));
  page.on('dialog', dialog => { faults.push(`${name}: dialog ${dialog.message()}`); dialog.dismiss(); });
  page.on('request', request => { if (!request.url().startsWith('file:') || !request.url().includes(folder)) faults.push(`${name}: request ${request.url()}`); });
  await page.goto(`file://${path.join(folder, name)}.html`);
  return page;
}

const expect = (holds, what) => { if (!holds) faults.push(what); };
const done = what => console.log(`ok: ${what}`);

// ---- every page: no fault, no request, fits 360 and 1600 px in both schemes

for (const [width, colorScheme] of [[360, 'dark'], [1600, 'light']]) {
  for (const name of names) {
    const page = await open(name, { viewport: { width, height: 900 }, colorScheme });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    expect(wide <= width, `${name} is ${wide} px wide in a window of ${width}`);
    expect(await page.locator('h1').count() === 1, `${name} has a title`);
    if (process.env.SHOTS) await page.screenshot({ path: path.join(process.env.SHOTS, `${name}-${width}-${colorScheme}.png`), fullPage: true });
    await page.context().close();
  }
}
done(`${names.length} pages open at 360 and 1600 px without a message or a request`);

// ---- axe: nothing serious

for (const name of ['cart', 'half_car', 'hostile'].filter(name => names.includes(name))) {
  for (const colorScheme of ['light', 'dark']) {
    const page = await open(name, { colorScheme });
    // The tool's own script is no part of the page, whose policy lets no other run: it comes by the debugger.
    const session = await page.context().newCDPSession(page);
    await session.send('Page.setBypassCSP', { enabled: true });
    await page.reload();
    await session.send('Runtime.evaluate', { expression: axe });
    const found = await page.evaluate(() => axe.run(document, { resultTypes: ['violations'] }));
    const serious = found.violations.filter(({ impact }) => impact === 'serious' || impact === 'critical');
    for (const { id, nodes } of serious) faults.push(`axe, ${name}, ${colorScheme}: ${id}: ${nodes.slice(0, 3).map(node => node.html.slice(0, 120)).join(' | ')}`);
    await page.context().close();
  }
}
done('axe-core finds nothing serious');

// ---- a hostile model shows its names and runs nothing

if (names.includes('hostile')) {
  const page = await open('hostile');
  expect(await page.evaluate(() => window.ran === undefined), 'a script of the model ran');
  expect((await page.locator('.text').innerText()).includes('</script><script>window.ran = 1</script>'), 'the text is shown as it is');
  expect(await page.locator('main script, main img, main iframe, main object, main [onclick], main [onerror], main [onload]').count() === 0, 'nothing of the text became an element');
  // The policy alone holds as well: an inline handler that gets into the page does not run. What the policy says about it on the
  // console, now or later, is no fault of the page.
  page.removeAllListeners('console');
  const held = await page.evaluate(() => new Promise(resolve => {
    document.addEventListener('securitypolicyviolation', () => resolve(window.ran === undefined));
    document.querySelector('main').insertAdjacentHTML('beforeend', '<img src=x onerror="window.ran = 2">');
    setTimeout(() => resolve(window.ran === undefined), 500);
  }));
  expect(held, 'the policy lets no inline handler run');
  await page.context().close();
  done('a hostile model runs nothing');
}

// ---- modes move as their shapes say, within half a pixel at eight phases

const PHASES = [0, 45, 90, 135, 180, 225, 270, 315];

/** Where points of glyphs (`[item, x, y]`, as they are at rest) are on the figure's page at each phase of a motion, which is set
 * by the controls; with the box of each element that is named. */
const series = (page, motion, points, boxes = []) => page.evaluate(([motion, points, boxes, phases]) => {
  const $ = id => document.getElementById(id);
  $('motion').value = String(motion);
  $('motion').dispatchEvent(new Event('change'));
  return phases.map(phase => {
    $('phase').value = String(phase);
    $('phase').dispatchEvent(new Event('input'));
    const at = points.map(([item, x, y]) => {
      const m = document.querySelector(`[data-item="${item}"] [data-with]`).transform.baseVal.consolidate().matrix;
      return [m.a * x + m.c * y + m.e, m.b * x + m.d * y + m.f];
    });
    at.boxes = boxes.map(item => { const { left, right } = document.querySelector(`[data-item="${item}"]`).getBoundingClientRect(); return [left, right]; });
    return { phase, at, boxes: at.boxes };
  });
}, [motion, points, boxes, PHASES]);

/** The middle of a glyph at rest. */
const middle = (page, item) => page.evaluate(item => {
  const { x, y, width, height } = document.querySelector(`[data-item="${item}"]`).getBBox();
  return [x + width / 2, y + height / 2];
}, item);

let compared = 0, worst = 0;
function compare(name, [x, y], [ex, ey]) {
  const off = Math.hypot(x - ex, y - ey);
  [compared, worst] = [compared + 1, Math.max(worst, off)];
  if (!(off < 0.5)) faults.push(`${name}: ${off.toFixed(2)} px off: ${[x, y]} instead of ${[ex, ey]}`);
}

/** Pixels for a metre, by the scale bar: its length and its text. */
const scale = page => page.evaluate(() => {
  const bar = document.querySelector('.scale-bar').getBBox();
  const label = [...document.querySelectorAll('.label')].map(text => text.textContent).find(text => /^[\d.]+\s*(mm|m)$/.test(text));
  const [, number, unit] = /^([\d.]+)\s*(mm|m)$/.exec(label);
  return bar.width / (Number(number) * (unit === 'mm' ? 0.001 : 1));
});
const amount = (page, motion) => page.evaluate(motion => JSON.parse(document.getElementById('payload').textContent).motions[motion].amount, motion);

// The cart: the block slides, and the rod hangs 2 m below it, turning about the block. The oracle knows no more than that.
{
  const page = await open('cart');
  const { modes } = JSON.parse(fs.readFileSync(path.join(folder, 'cart.json'), 'utf8'));
  const perMetre = await scale(page);
  await page.locator('#rest').click();
  const [block, rod] = [await middle(page, 'b0'), await middle(page, 'b1')];
  const length = 2 * perMetre;
  for (const [number, mode] of modes.entries()) {
    const times = await amount(page, number);
    const end = [block[0], rod[1] + length / 2];
    for (const { phase, at } of await series(page, number, [['b0', ...block], ['b1', ...end]])) {
      const swing = times * Math.cos(phase * Math.PI / 180);
      const x = perMetre * swing * mode.shape['block.x'], angle = swing * mode.shape['rod.angle'];
      compare(`cart, mode ${number + 1}, ${phase} deg, block`, at[0], [block[0] + x, block[1]]);
      // The page's y runs downwards: a rod that hangs and turns counter-clockwise moves its lower end to the right.
      const hung = [block[0] + x + length * Math.sin(angle), rod[1] - length / 2 + length * Math.cos(angle)];
      compare(`cart, mode ${number + 1}, ${phase} deg, end of the rod`, at[1], hung);
    }
  }
  // Twice the amplitude is twice the way.
  const [{ at: [once] }] = await series(page, 0, [['b0', ...block]]);
  await page.locator('#scale').evaluate(input => { input.value = '2'; input.dispatchEvent(new Event('input')); });
  const [{ at: [twice] }] = await series(page, 0, [['b0', ...block]]);
  compare('cart, amplitude', [twice[0] - block[0], 0], [2 * (once[0] - block[0]), 0]);
  await page.context().close();
}

// The half car: a body that bounces and pitches about its centre.
{
  const page = await open('half_car');
  const { modes } = JSON.parse(fs.readFileSync(path.join(folder, 'half_car.json'), 'utf8'));
  const perMetre = await scale(page);
  const axle = await page.evaluate(() => { const { x, width } = document.querySelector('[data-item="b0"]').getBBox(); return [x, x + width]; });
  await page.locator('#rest').click();
  const height = await page.evaluate(() => { const { y, height } = document.querySelector('[data-item="b0"] [data-with]').getBBox(); return y + height / 2; });
  const payload = await page.evaluate(() => JSON.parse(document.getElementById('payload').textContent));
  const [, cx, cy] = payload.figure.parts[1];
  for (const [number, mode] of modes.entries()) {
    for (const { phase, at } of await series(page, number, [['b0', axle[1], height]])) {
      const swing = payload.motions[number].amount * Math.cos(phase * Math.PI / 180);
      const [rise, angle] = [perMetre * swing * mode.shape['chassis.y'], swing * mode.shape['chassis.angle']];
      const [dx, dy] = [axle[1] - cx, height - cy];
      const to = [cx + dx * Math.cos(angle) + dy * Math.sin(angle), cy - dx * Math.sin(angle) + dy * Math.cos(angle) - rise];
      compare(`half car, mode ${number + 1}, ${phase} deg`, at[0], to);
    }
  }
  await page.context().close();
}

// Three equal masses between walls, from spec to shape in closed form: sqrt 2, 1; the middle stands still in mode 2.
if (names.includes('three')) {
  const page = await open('three');
  await page.locator('#rest').click();
  const rest = [];
  for (const body of [0, 1, 2]) rest.push(await middle(page, `b${body}`));
  const shapes = [[Math.SQRT1_2, 1, Math.SQRT1_2], [1, 0, -1], [1, -Math.SQRT2, 1]];
  for (const [number, shape] of shapes.entries()) {
    const points = [0, 1, 2].map(body => [`b${body}`, ...rest[body]]);
    for (const { phase, at, boxes: [a, b, spring] } of await series(page, number, points, ['b0', 'b1', 'e1'])) {
      const ways = at.map(([x], body) => x - rest[body][0]);
      const largest = shape.reduce((a, b) => (Math.abs(b) > Math.abs(a) ? b : a));
      const swing = ways[shape.indexOf(largest)] / largest;
      shape.forEach((part, body) => compare(`three masses, mode ${number + 1}, ${phase} deg, body ${body}`, [ways[body], 0], [swing * part, 0]));
      const full = 22 * Math.cos(phase * Math.PI / 180);
      expect(Math.abs(Math.abs(swing * largest) - Math.abs(full)) < 0.5, `three masses, mode ${number + 1}: ${swing * largest} px at ${phase} deg`);
      // A spring's ends stay at what it ties: its glyph reaches from block to block.
      compare(`three masses, mode ${number + 1}, ${phase} deg, spring`, spring, [Math.min(a[1], b[1]), Math.max(a[0], b[0])]);
    }
  }
  await page.context().close();
}

// Damped poles: q(t) = Re(v exp(s t)) where (s^2 M + s C + K) v = 0; v by elimination here, from the report's own matrices.
{
  const page = await open('cart');
  const { matrices: { m, c, k }, poles, modes } = JSON.parse(fs.readFileSync(path.join(folder, 'cart.json'), 'utf8'));
  const perMetre = await scale(page);
  await page.locator('#rest').click();
  const block = await middle(page, 'b0');
  const upper = poles.filter(({ im }) => im > 0);
  const payload = await page.evaluate(() => JSON.parse(document.getElementById('payload').textContent));
  for (const [number, { re, im }] of upper.entries()) {
    const motion = modes.length + number;
    const q = (i, j) => [(re * re - im * im) * m[i][j] + re * c[i][j] + k[i][j], 2 * re * im * m[i][j] + im * c[i][j]];
    // The second row: q10 x + q11 angle = 0, with the ratio angle / x.
    const [a, b] = [q(1, 0), q(1, 1)], size = b[0] ** 2 + b[1] ** 2;
    const ratio = [-(a[0] * b[0] + a[1] * b[1]) / size, -(a[1] * b[0] - a[0] * b[1]) / size];
    const own = payload.motions[motion];
    const entry = i => [own.q[i], own.qi?.[i] ?? 0];
    const [x, y] = [entry(0), entry(1)], square = x[0] ** 2 + x[1] ** 2;
    const shown = [(y[0] * x[0] + y[1] * x[1]) / square, (y[1] * x[0] - y[0] * x[1]) / square];
    expect(Math.hypot(shown[0] - ratio[0], shown[1] - ratio[1]) < 1e-5 * Math.hypot(...ratio), `pole ${number + 1}: ${shown} instead of ${ratio}`);
    for (const { phase, at } of await series(page, motion, [['b0', ...block]])) {
      const angle = phase * Math.PI / 180, decay = Math.exp(re / im * angle);
      const swing = own.amount * decay * (x[0] * Math.cos(angle) - x[1] * Math.sin(angle));
      compare(`cart, pole ${number + 1}, ${phase} deg`, at[0], [block[0] + perMetre * swing, block[1]]);
    }
  }
  await page.context().close();
}
done(`${compared} positions at eight phases, at most ${worst.toFixed(3)} px off`);

// ---- curves are the transfer function, whatever the zoom

{
  const page = await open('cart');
  const { matrices: { m, c, k } } = JSON.parse(fs.readFileSync(path.join(folder, 'cart.json'), 'utf8'));
  await page.locator('#gain').focus();
  for (let step = 0; step < 7; step++) {
    await page.locator('#gain').evaluate(svg => { for (let k = 0; k < 13; k++) svg.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight' })); });
    const said = /^([\d.e-]+) Hz: gain ([\d.e-]+) \(/.exec(await page.locator('#reading').innerText());
    expect(said, 'the cursor says nothing');
    if (!said) break;
    const w = 2 * Math.PI * Number(said[1]);
    const q = (i, j) => [k[i][j] - w * w * m[i][j], w * c[i][j]];
    const times = ([a, b], [x, y]) => [a * x - b * y, a * y + b * x];
    const [p, r] = [times(q(0, 0), q(1, 1)), times(q(0, 1), q(1, 0))];
    const gain = Math.hypot(...q(1, 1)) / Math.hypot(p[0] - r[0], p[1] - r[1]);
    expect(Math.abs(Number(said[2]) - gain) < 2e-3 * gain, `gain ${said[2]} at ${said[1]} Hz instead of ${gain}`);
  }
  // Closer and closer about the cursor, the curve is still made of many points.
  for (let k = 0; k < 12; k++) await page.keyboard.press('+');
  const points = await page.locator('#gain .curve').getAttribute('d');
  expect(points.split('L').length > 500, 'a zoomed curve is no polygon');
  await page.locator('#whole').click();
  await page.locator('#to').selectOption({ index: 1 });
  expect(await page.locator('#features [data-pair]:visible').count() === 1, 'one pair is listed');
  await page.locator('#view').selectOption('nyquist');
  expect(await page.locator('#gain .curve').count() === 1 && await page.locator('#phase-plot .curve').count() === 0, 'a Nyquist plot');
  await page.context().close();
  done('curves are the transfer function');
}

// ---- from numbers to lines and back, by mouse and by keyboard

{
  const page = await open('cart');
  await page.locator('[data-item="e0"] path').first().click({ force: true });
  const line = await page.locator('[data-item="e0"]').getAttribute('data-line');
  expect(await page.locator(`#L${line}.here`).count() === 1, 'a click on a spring leads to its line');
  await page.locator(`#L${line}`).click();
  expect(await page.locator('[data-item="e0"].here').count() === 1, 'and back');
  const link = page.locator('a[data-line]').first();
  await link.focus();
  await page.keyboard.press('Enter');
  const of = await link.getAttribute('data-line');
  expect(await page.locator(`#L${of}.here`).count() === 1, 'a name is a link for the keyboard');
  expect(await page.locator('mtd[data-line]').count() > 0, 'entries of matrices lead to lines');
  await page.locator('mtd[data-line]').first().click();
  expect(await page.locator('.text .here').count() === 1, 'a click on an entry leads to a line');
  await page.locator('#play').focus();
  await page.keyboard.press('Enter');
  expect(await page.locator('#play').innerText() === 'Pause', 'the keyboard plays');
  const before = await page.locator('[data-item="b0"] [data-with]').getAttribute('transform');
  await page.waitForTimeout(300);
  expect(before !== await page.locator('[data-item="b0"] [data-with]').getAttribute('transform'), 'it moves');
  await page.keyboard.press('Enter');
  await page.context().close();
  done('numbers lead to lines and back');
}

// ---- nothing starts by itself where that is not wanted; printing shows the rest

{
  const page = await open('cart');
  expect(await page.locator('#play').innerText() === 'Play', 'prefers-reduced-motion starts nothing');
  const pdf = await page.pdf();
  expect(pdf.length > 20_000, 'a print');
  expect(await page.evaluate(() => { window.dispatchEvent(new Event('beforeprint')); return document.querySelector('[data-item="b0"] [data-with]').getAttribute('transform'); }) === 'matrix(1 0 0 1 0 0)', 'a print shows the rest');
  await page.context().close();
  const lively = await open('cart', { reducedMotion: 'no-preference' });
  expect(await lively.locator('#play').innerText() === 'Pause', 'modes move by themselves elsewhere');
  await lively.context().close();
  done('reduced motion and print');
}

await browser.close();
if (faults.length) {
  console.log(faults.slice(0, 60).join('\n'));
  process.exit(1);
}
