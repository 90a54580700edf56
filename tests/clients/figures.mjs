// Figures and plots in Chromium and in librsvg: no name over a line or a name, at two widths, in light and dark, with two fonts;
// both renderers draw alike. Usage: node figures.mjs FOLDER-OF-SVG
// Needs playwright-core (where NODE_PATH or PLAYWRIGHT says), Chromium (CHROMIUM or /usr/bin/chromium) and rsvg-convert.
import { execFileSync } from 'node:child_process';
import { createRequire } from 'node:module';
import fs from 'node:fs';
import path from 'node:path';

const require = createRequire(process.env.PLAYWRIGHT ? path.join(process.env.PLAYWRIGHT, 'x.js') : import.meta.url);
const { chromium } = require('playwright-core');
const folder = process.argv[2];
const files = fs.readdirSync(folder).filter(name => name.endsWith('.svg')).sort();
const faults = [];

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--disable-gpu'],
});

// What lies over what: points along every line against the box of every name.
const crowded = () => {
  const svg = document.querySelector('svg');
  const found = [];
  const labels = [...svg.querySelectorAll('text.label')].map(element => ({ element, box: element.getBBox() }));
  const page = svg.viewBox.baseVal;
  const over = (a, b) => a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
  labels.forEach(({ element, box }, k) => {
    // Capitals and descenders, not the whole line.
    const room = { x: box.x, y: box.y + box.height * 0.15, width: box.width, height: box.height * 0.75 };
    if (room.x < 0 || room.y < 0 || room.x + room.width > page.width || room.y + room.height > page.height)
      found.push(`${element.textContent} leaves the page`);
    for (const other of labels.slice(k + 1))
      if (over(room, { ...other.box, y: other.box.y + other.box.height * 0.15, height: other.box.height * 0.75 }))
        found.push(`${element.textContent} over ${other.element.textContent}`);
    for (const shape of svg.querySelectorAll('.glyph path, .glyph circle, .mark path, .mark circle, .curve')) {
      const bounds = shape.getBBox();
      if (!over(room, bounds)) continue;
      const group = shape.closest('.glyph');
      if (group?.classList.contains('leader') && group.querySelector('title').textContent === element.textContent) continue;
      const length = shape.getTotalLength();
      for (let way = 0; way <= length; way += 1.5) {
        const { x, y } = shape.getPointAtLength(way);
        if (x > room.x && x < room.x + room.width && y > room.y && y < room.y + room.height) {
          found.push(`${element.textContent} over ${group?.getAttribute('class') ?? shape.getAttribute('class')}`);
          break;
        }
      }
    }
  });
  return found;
};

for (const width of [360, 1600]) {
  for (const colorScheme of ['light', 'dark']) {
    for (const font of ['', '.vibc-figure,.vibc-plot{font-family:"DejaVu Sans",monospace!important}']) {
      const context = await browser.newContext({ viewport: { width, height: 900 }, colorScheme });
      const page = await context.newPage();
      page.on('console', message => faults.push(`console: ${message.text()}`));
      page.on('pageerror', error => faults.push(`page: ${error}`));
      page.on('request', request => { if (!/^(about|data|file):/.test(request.url())) faults.push(`request: ${request.url()}`); });
      for (const file of files) {
        await page.setContent(`<body style="margin:0">${fs.readFileSync(path.join(folder, file), 'utf8')}<style>${font}</style>`);
        for (const fault of await page.evaluate(crowded)) faults.push(`${file} at ${width}, ${colorScheme}, ${font ? 'wide font' : 'own font'}: ${fault}`);
        const wide = await page.evaluate(() => document.documentElement.scrollWidth);
        if (wide > width) faults.push(`${file} is ${wide} px wide in a window of ${width}`);
        if (process.env.SHOTS && !font) await page.screenshot({ path: path.join(process.env.SHOTS, `${file}-${width}-${colorScheme}.png`), fullPage: true });
      }
      await context.close();
    }
  }
}

// The same pixels in both renderers, within what antialiasing and fonts differ.
const context = await browser.newContext({ colorScheme: 'light' });
const page = await context.newPage();
let worst = 0;
for (const file of files) {
  const from = path.join(folder, file);
  const other = execFileSync('rsvg-convert', ['--width', '800', '--keep-aspect-ratio', '--background-color', 'white', from], { maxBuffer: 1 << 28 });
  const difference = await page.evaluate(async ([svg, png]) => {
    const load = source => new Promise((resolve, reject) => {
      const image = new Image();
      image.onload = () => resolve(image);
      image.onerror = () => reject(new Error('no image'));
      image.src = source;
    });
    const [own, other] = [await load(`data:image/svg+xml;base64,${svg}`), await load(`data:image/png;base64,${png}`)];
    const pixels = image => {
      const canvas = Object.assign(document.createElement('canvas'), { width: other.width, height: other.height });
      const at = canvas.getContext('2d');
      at.fillStyle = 'white';
      at.fillRect(0, 0, canvas.width, canvas.height);
      at.drawImage(image, 0, 0, canvas.width, canvas.height);
      return at.getImageData(0, 0, canvas.width, canvas.height).data;
    };
    const [a, b] = [pixels(own), pixels(other)];
    let sum = 0;
    for (let k = 0; k < a.length; k++) sum += Math.abs(a[k] - b[k]);
    return sum / a.length / 255;
  }, [fs.readFileSync(from).toString('base64'), other.toString('base64')]);
  worst = Math.max(worst, difference);
  if (difference > 0.02) faults.push(`${file}: the renderers differ by ${(100 * difference).toFixed(2)} %`);
}
await browser.close();
console.log(`${files.length} figures, renderers differ by at most ${(100 * worst).toFixed(2)} %`);
if (faults.length) {
  console.log(faults.slice(0, 60).join('\n'));
  process.exit(1);
}
