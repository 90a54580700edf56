// The extension in VS Code, which is code-server in Chromium. Usage: node vscode.mjs PORT FOLDER, where the folder holds cart.vib;
// `.ci/editor` starts all of it. Each check says `ok: ...`; a failure ends the run with status 1. SHOTS names a folder for pictures.
import { createRequire } from 'node:module';
import path from 'node:path';

const require = createRequire(process.env.PLAYWRIGHT ? path.join(process.env.PLAYWRIGHT, 'x.js') : import.meta.url);
const { chromium } = require('playwright-core');
const [port, folder] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox', '--disable-gpu'] });
const page = await browser.newPage({ viewport: { width: 1500, height: 850 } });
page.setDefaultTimeout(90_000);

let failed = 0;
const check = (holds, what) => {
  console.log(`${holds ? 'ok' : 'FAILED'}: ${what}`);
  if (!holds) failed = 1;
};
const shot = name => (process.env.SHOTS ? page.screenshot({ path: path.join(process.env.SHOTS, `${name}.png`) }) : undefined);

/** Waits until something holds in one of the frames, and returns that frame. */
async function within(test, what, most = 90_000) {
  const end = Date.now() + most;
  while (Date.now() < end) {
    for (const frame of page.frames()) {
      if (await frame.evaluate(test).catch(() => false)) {
        check(true, what);
        return frame;
      }
    }
    await page.waitForTimeout(200);
  }
  check(false, what);
}

/** Waits until a locator is there. */
async function there(locator, what) {
  const found = await locator.first().waitFor({ state: 'visible' }).then(() => true, () => false);
  check(found, what);
  return found;
}

async function command(name) {
  await page.keyboard.press('F1');
  await page.locator('.quick-input-widget input').first().waitFor();
  await page.keyboard.type(name);
  await page.locator('.quick-input-list .monaco-list-row').first().waitFor();
  await page.waitForTimeout(500);
}

async function line(number) {
  await page.locator('.view-lines').first().click({ position: { x: 60, y: 20 } });
  await page.keyboard.press('Control+g');
  await page.locator('.quick-input-widget input').first().waitFor();
  await page.keyboard.type(String(number));
  await page.waitForTimeout(300);
  await page.keyboard.press('Enter');
  await page.locator('.quick-input-widget').waitFor({ state: 'hidden' });
  await page.waitForTimeout(500);
}

await page.goto(`http://127.0.0.1:${port}/?folder=${folder}`);
await page.waitForSelector('.monaco-workbench');
await page.getByRole('treeitem', { name: /cart\.vib/ }).first().dblclick();
await page.waitForSelector('.view-lines');

// ---- code lenses, the preview, and lines

const lens = page.locator('.codelens-decoration a', { hasText: 'Preview' });
await there(lens, 'a code lens offers the preview');
await lens.first().click();
const frame = await within(() => !!document.querySelector('.vibc-figure') && document.querySelector('#motion').options.length > 0, 'the preview shows the figure');
await shot('preview');
if (frame) {
  const mode = await frame.evaluate(() => document.querySelector('#motion').options[0].textContent);
  check(mode.includes('0.3435'), `it has the modes: ${mode}`);
  const of = await frame.evaluate(() => {
    document.querySelector('[data-item="e0"] path').dispatchEvent(new MouseEvent('click', { bubbles: true }));
    return document.querySelector('[data-item="e0"]').dataset.line;
  });
  const position = page.locator('.statusbar-item', { hasText: new RegExp(`Ln ${of}\\b`) });
  await there(position, `a click on the spring selects line ${of}`);
  await line(20);
  await within(() => !!document.querySelector('#figure [data-item="b0"].here'), "the cursor's line marks the block");
}

// ---- the status item

// Language status items stand behind the braces in the status bar.
const braces = page.locator('[id="status.languageStatus"]');
if (await there(braces, 'there is a language status')) {
  await braces.first().hover();
  await there(page.locator('.hover-language-status', { hasText: 'vib' }), 'the status item says how the text is');
  await shot('status');
  await page.mouse.move(700, 400);
}

// ---- errors as one types, over the last figure

await line(13);
await page.keyboard.press('End');
await page.keyboard.press('Enter');
await page.keyboard.type('let twice = ');
await within(() => !!document.querySelector('[role=alert] li') && !!document.querySelector('.vibc-figure'), 'errors stand over the last figure');
await shot('errors');
await page.keyboard.type('2 * k ', { delay: 30 });
await within(() => !!document.querySelector('.vibc-figure') && !document.querySelector('[role=alert]'), 'and go when the text is right');

// ---- snippets, commands, tasks, the walkthrough

await line(30);
await page.keyboard.press('Control+End');
await page.keyboard.press('Enter');
await page.keyboard.type('damper');
await page.keyboard.press('Control+Space');
const suggestions = page.locator('.suggest-widget .monaco-list-row');
if (await there(suggestions, 'completion opens')) {
  const rows = await suggestions.evaluateAll(list => list.map(row => row.getAttribute('aria-label') ?? ''));
  check(rows.some(row => /damper/i.test(row) && /snippet/i.test(row)), `a snippet is among them: ${rows.slice(0, 4).join(' | ')}`);
  await shot('snippets');
}
await page.keyboard.press('Escape');
for (let k = 0; k < 8; k++) await page.keyboard.press('Control+z');

await command('vib: ');
const commands = await page.locator('.quick-input-list .monaco-list-row').allInnerTexts();
const wanted = ['Analyze', 'Simulate', 'Emit code', 'Open the preview', 'Equations of motion'];
check(wanted.every(name => commands.some(row => row.includes(name))), `${commands.length} commands`);
await shot('commands');
await page.keyboard.press('Escape');

await command('Tasks: Run Task');
// The palette does not always rank it first.
await page.locator('.quick-input-list .monaco-list-row', { hasText: /^Tasks: Run Task$/ }).first().click();
const task = page.locator('.quick-input-list .monaco-list-row', { hasText: 'vibc' });
if (await there(task, 'tasks of vibc are offered')) {
  await task.first().click();
  await there(page.locator('.quick-input-list .monaco-list-row', { hasText: 'vibc: check cart.vib' }), 'one of them checks the model');
}
await shot('tasks');
await page.keyboard.press('Escape');

await command('Welcome: Open Walkthrough');
await page.keyboard.press('Enter');
await page.waitForTimeout(800);
await page.keyboard.type('vib');
const row = page.locator('.quick-input-list .monaco-list-row', { hasText: 'Mechanical vibrations' });
if (await there(row, 'the walkthrough is listed')) {
  await row.first().click();
  await there(page.getByText('Write a model'), 'and opens');
  await page.waitForTimeout(1500);
  await shot('walkthrough');
}

await browser.close();
process.exit(failed);
