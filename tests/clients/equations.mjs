// Equations in MathML as Chromium lays them out, at two widths, in light and dark: every formula is a formula to the browser and has a size,
// numerators stand above their denominators, dots above their letters, indices below, cells of matrices in rows; nothing is asked for from
// outside, and no page is wider than the window. Usage: node equations.mjs FOLDER-OF-HTML
// Needs playwright-core (where NODE_PATH or PLAYWRIGHT says) and Chromium (CHROMIUM or /usr/bin/chromium).
import { createRequire } from 'node:module';
import fs from 'node:fs';
import path from 'node:path';

const require = createRequire(process.env.PLAYWRIGHT ? path.join(process.env.PLAYWRIGHT, 'x.js') : import.meta.url);
const { chromium } = require('playwright-core');
const folder = process.argv[2];
const files = fs.readdirSync(folder).filter(name => name.endsWith('.html')).sort();
const faults = [];
const seen = { math: 0, mfrac: 0, mover: 0, msub: 0, msup: 0, mtr: 0 };

const laidOut = () => {
  const found = [], seen = {};
  const box = element => element.getBoundingClientRect();
  const all = (name, look) => {
    const elements = [...document.querySelectorAll(name)];
    seen[name] = elements.length;
    for (const element of elements) {
      const fault = look(element, [...element.children]);
      if (fault) found.push(`${name}: ${fault} in ${element.textContent.slice(0, 60)}`);
    }
  };
  const middle = element => (box(element).top + box(element).bottom) / 2;
  all('math', math => {
    if (!getComputedStyle(math).display.includes('math')) return `display is ${getComputedStyle(math).display}`;
    if (box(math).width < 1 || box(math).height < 1) return 'no size';
    if (!math.textContent.trim()) return 'nothing';
  });
  all('mfrac', (_, [over, under]) => (box(over).bottom <= box(under).top + 1 ? null : 'the numerator is not above'));
  all('mover', (_, [letter, dots]) => (middle(dots) < middle(letter) ? null : 'the dots are not above'));
  all('msub', (_, [letter, index]) => (middle(index) > middle(letter) && box(index).left >= box(letter).right - 2 ? null : 'the index is not below'));
  all('msup', (_, [base, exponent]) => (middle(exponent) < middle(base) ? null : 'the exponent is not above'));
  all('mtr', (row, cells) => {
    const [first, ...others] = cells;
    return others.every(cell => box(cell).left >= box(first).left && Math.abs(middle(cell) - middle(first)) < box(row).height) ? null : 'the cells are not in a row';
  });
  if (document.querySelector('merror, script')) found.push('an error or a script');
  return { found, seen };
};

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--disable-gpu'],
});
for (const width of [360, 1600]) {
  for (const colorScheme of ['light', 'dark']) {
    const context = await browser.newContext({ viewport: { width, height: 900 }, colorScheme });
    const page = await context.newPage();
    page.on('console', message => faults.push(`console: ${message.text()}`));
    page.on('pageerror', error => faults.push(`page: ${error}`));
    page.on('request', request => { if (!/^(about|data|file):/.test(request.url())) faults.push(`request: ${request.url()}`); });
    for (const file of files) {
      await page.goto(`file://${path.resolve(folder, file)}`);
      const { found, seen: counts } = await page.evaluate(laidOut);
      for (const name of Object.keys(seen)) seen[name] += counts[name];
      for (const fault of found) faults.push(`${file} at ${width}, ${colorScheme}: ${fault}`);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      if (wide > width) faults.push(`${file} is ${wide} px wide in a window of ${width}`);
      if (process.env.SHOTS) await page.screenshot({ path: path.join(process.env.SHOTS, `${file}-${width}-${colorScheme}.png`), fullPage: true });
    }
    await context.close();
  }
}
await browser.close();
console.log(`${files.length} pages: ${JSON.stringify(seen)}`);
for (const [name, count] of Object.entries(seen)) if (count < 100) faults.push(`${name} was looked at ${count} times: the test does not see them`);
if (faults.length) {
  console.log(faults.slice(0, 40).join('\n'));
  process.exit(1);
}
