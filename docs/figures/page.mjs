// A picture of the report page, for the README. Usage: node page.mjs PAGE.html PICTURE.png; with --compare, the picture that is
// there is compared with the page: status 1 if they differ by more than the fonts of two machines do.
// Needs playwright-core (below PLAYWRIGHT) and Chromium (CHROMIUM or /usr/bin/chromium).
import { createRequire } from 'node:module';
import fs from 'node:fs';
import path from 'node:path';

const require = createRequire(process.env.PLAYWRIGHT ? path.join(process.env.PLAYWRIGHT, 'x.js') : import.meta.url);
const { chromium } = require('playwright-core');
const [report, picture, option] = process.argv.slice(2);
const MOST = 0.03;

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox', '--disable-gpu'] });
const context = await browser.newContext({ viewport: { width: 1000, height: 1000 }, colorScheme: 'light', reducedMotion: 'reduce' });
const page = await context.newPage();
await page.goto(`file://${path.resolve(report)}`);
// The second mode at full swing.
await page.locator('#motion').selectOption('1');
const box = await page.locator('#poles').boundingBox();
const shot = await page.screenshot({ fullPage: true, clip: { x: 0, y: 0, width: 1000, height: Math.ceil(box.y + box.height + 12) } });

if (option === '--compare') {
  const blank = await context.newPage();
  const difference = await blank.evaluate(async pictures => {
    const [a, b] = await Promise.all(pictures.map(async data => {
      const image = new Image();
      image.src = `data:image/png;base64,${data}`;
      await image.decode();
      const canvas = Object.assign(document.createElement('canvas'), { width: 250, height: 250 });
      canvas.getContext('2d').drawImage(image, 0, 0, 250, 250);
      return canvas.getContext('2d').getImageData(0, 0, 250, 250).data;
    }));
    return a.reduce((sum, value, i) => sum + Math.abs(value - b[i]), 0) / (255 * a.length);
  }, [shot, fs.readFileSync(picture)].map(bytes => bytes.toString('base64')));
  console.log(`mean difference ${difference.toFixed(4)}`);
  await browser.close();
  process.exit(difference < MOST ? 0 : 1);
}
fs.writeFileSync(picture, shot);
await browser.close();
