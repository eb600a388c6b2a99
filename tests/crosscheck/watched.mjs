// Drives the page of `kiln watch` in a real browser while files change on disk, and prints what was seen as JSON.
// node watched.mjs PROGRAM FOLDER THREE SPECS: THREE is the folder of three.js, or - for none.
import { spawn } from 'node:child_process';
import crypto from 'node:crypto';
import fs from 'node:fs';
import path from 'node:path';
import readline from 'node:readline';

import { launch, open as openPage } from '../../scripts/engines/chromium.mjs';

const [program, folder, three, specs] = process.argv.slice(2);
const SECONDS = 30;
const found = { complaints: [] };
const watches = [];

const write = (name, text) => fs.writeFileSync(path.join(folder, name), text);
const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

// Starts a watch; gives its address.
async function watch(...words) {
  const viewer = three === '-' ? [] : ['--three', three];
  const line = ['--format', 'json', 'watch', ...words, '--port', '0', ...viewer];
  const child = spawn(program, line, { cwd: folder, stdio: ['ignore', 'pipe', 'inherit'] });
  watches.push(child);
  return new Promise((resolve, reject) => {
    child.on('exit', () => reject(new Error('kiln watch ended')));
    readline.createInterface({ input: child.stdout }).on('line', (text) => {
      const { address } = JSON.parse(text);
      if (address) resolve(address);
    });
  });
}

// Waits until the page has told of a bake and, of a good one, drawn it.
async function settled(page, good) {
  const done = (good) => {
    const { data, drawn } = { data: document.body.dataset, drawn: performance.getEntriesByName('kiln-drawn') };
    const busy = document.querySelector('#stage [aria-busy=true]');
    if (data.good !== String(good) || busy) return false;
    const chosen = document.getElementById('asset').value;
    return !good || (data.shownFile === chosen && drawn.at(-1)?.detail === data.shown);
  };
  await page.waitForFunction(done, good, { timeout: SECONDS * 1000, polling: 20 });
  // The browser shows a picture a frame after it was drawn.
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
}

// Does something to the files, waits for the news of it, and gives the number of the bake.
async function after(page, good, change) {
  const before = await page.evaluate(() => Number(document.body.dataset.revision ?? 0));
  change();
  await page.waitForFunction(
    ([before, good]) => Number(document.body.dataset.revision) > before && document.body.dataset.good === String(good),
    [before, good],
    { timeout: SECONDS * 1000, polling: 20 },
  );
  await settled(page, good);
}

// The upper half of the picture, which nothing else ever covers, as a hash.
async function picture(page) {
  const { x, y, width, height } = await page.locator('#stage').boundingBox();
  const bytes = await page.screenshot({ clip: { x, y, width, height: height / 2 } });
  return crypto.createHash('sha256').update(bytes).digest('hex');
}

const said = (page) => page.locator('#wrong').innerText();

const open = (browser, address) => openPage(browser, address, found.complaints);

async function drag(page) {
  const { x, y, width, height } = await page.locator('#stage').boundingBox();
  await page.mouse.move(x + width / 2, y + height / 4);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 + 90, y + height / 4 + 25, { steps: 4 });
  await page.mouse.up();
  await pause(100);
  await settled(page, true);
}

const CUP = (radius) => `include = ["looks.toml"]
[shape.body]
material = "glaze"
[shape.body.union]
of = ["bowl", "foot"]
[shape.bowl.sphere]
radius = ${radius}
[shape.foot.box]
size = [0.5, 2, 0.5]
`;
const LOOKS = (color) => `[material.glaze]\ncolor = "${color}"\ncolor-texture = "spots.png"\n`;

// Edits of a document, of what it includes and of its pictures, all saved in the ways that editors do.
async function edits(browser) {
  const image = fs.readFileSync(path.join(specs, 'inputs/label.png'));
  write('cup.toml', '[shape.bowl.sphere]\nradius = \n');
  const page = await open(browser, await watch('cup.toml'));
  await settled(page, false);
  found.first = { said: await said(page), title: await page.title() };

  write('spots.png', image);
  write('looks.toml', LOOKS('#3366aa'));
  await after(page, true, () => write('cup.toml', CUP(1.0)));
  found.recovered = { hidden: await page.locator('#wrong').isHidden(), picture: await picture(page) };
  await drag(page);
  found.dragged = await picture(page);

  await after(page, true, () => write('cup.toml', CUP(1.2)));
  found.edited = await picture(page);
  await after(page, true, () => {
    write('.cup.toml.swp', CUP(1.0));
    fs.renameSync(path.join(folder, '.cup.toml.swp'), path.join(folder, 'cup.toml'));
  });
  found.renamed = await picture(page);

  await after(page, false, () => write('cup.toml', CUP(1.0).replace('radius', 'radus')));
  found.broken = {
    said: await said(page),
    place: await page.locator('#texts li.error').evaluate((item) => item.previousElementSibling.dataset.line),
    picture: await picture(page),
    status: await page.locator('#status').innerText(),
  };
  await after(page, true, () => write('cup.toml', CUP(1.0)));
  found.mended = await picture(page);

  await after(page, true, () => write('looks.toml', LOOKS('#aa3333')));
  found.included = await picture(page);
  await after(page, false, () => fs.rmSync(path.join(folder, 'spots.png')));
  found.imageGone = { said: await said(page), picture: await picture(page) };
  await after(page, true, () => write('spots.png', image));
  await after(page, false, () => write('looks.toml', `include = ["cup.toml"]\n${LOOKS('#aa3333')}`));
  found.cycle = { said: await said(page), picture: await picture(page) };
  await after(page, true, () => write('looks.toml', LOOKS('#aa3333')));
  await after(page, false, () => fs.rmSync(path.join(folder, 'cup.toml')));
  found.deleted = { said: await said(page), picture: await picture(page) };
  // A save in two steps.
  await after(page, true, () => {
    const text = CUP(1.0);
    write('cup.toml', text.slice(0, 40));
    fs.appendFileSync(path.join(folder, 'cup.toml'), text.slice(40));
  });
  found.back = await picture(page);

  await pick(page);
  await page.close();
}

// Clicks on the ball and on the box that pierces it: each is a part of the union.
async function pick(page) {
  if (three === '-') return;
  const { x, y, width, height } = await page.locator('#stage').boundingBox();
  const click = async (down) => {
    await page.locator('#note').evaluate((note) => { note.textContent = ''; });
    await page.mouse.click(x + width / 2, y + height * down);
    await page.waitForFunction(() => document.getElementById('note').textContent !== '', null, { timeout: SECONDS * 1000 });
    return {
      note: await page.locator('#note').innerText(),
      line: await page.locator('#texts li.mark').innerText(),
    };
  };
  await page.locator('#fit').click();
  await settled(page, true);
  found.pickedMiddle = await click(0.5);
  await page.mouse.move(x + width / 2, y + height / 2);
  // Seen from above, the top of the box is in the middle.
  await page.mouse.down();
  await page.mouse.move(x + width / 2, y + height / 2 + 2 * height, { steps: 6 });
  await page.mouse.up();
  await settled(page, true);
  found.pickedTop = await click(0.5);
}

// A clip, scrubbed; switches.
async function motion(browser) {
  fs.copyFileSync(path.join(specs, 'motion/fish.toml'), path.join(folder, 'fish.toml'));
  const page = await open(browser, await watch('fish.toml'));
  await settled(page, true);
  const scrub = async (share) => {
    await page.locator('#time').evaluate((range, share) => {
      range.value = range.max * share;
      range.dispatchEvent(new Event('input'));
    }, share);
    await pause(100);
    await settled(page, true);
    return picture(page);
  };
  found.clips = await page.locator('#clip option').allInnerTexts();
  found.rest = await picture(page);
  await page.locator('#clip').selectOption({ index: 1 });
  found.duration = Number(await page.locator('#time').getAttribute('max'));
  found.scrubbed = [await scrub(0.3), await scrub(0.6), await scrub(0.3)];
  await page.locator('#angles').check();
  await page.waitForFunction(() => document.querySelectorAll('#limits tr').length > 0, null, { timeout: SECONDS * 1000 });
  found.limits = await page.locator('#limits tr').evaluateAll((all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
  await page.locator('#angles').uncheck();
  found.heats = { list: await page.locator('#heat option').allInnerTexts() };
  for (const name of ['curvature', 'deviation', 'texel-density', '(materials)']) {
    await page.locator('#heat').selectOption(name);
    const worn = name === '(materials)' ? '' : name;
    await page.waitForFunction((worn) => document.body.dataset.heat === worn, worn, { timeout: SECONDS * 1000 });
    await settled(page, true);
    found.heats[name] = { picture: await picture(page), note: await page.locator('#note').innerText() };
  }
  found.switches = {};
  for (const box of await page.locator('#options input').all()) {
    const name = await box.getAttribute('id');
    await box.check();
    await pause(100);
    await settled(page, true);
    found.switches[name] = await picture(page);
    await box.uncheck();
  }
  // Chosen clip and time outlast an edit.
  const spec = fs.readFileSync(path.join(folder, 'fish.toml'), 'utf8');
  await after(page, true, () => write('fish.toml', `${spec}\n# the same\n`));
  found.kept = await picture(page);
  await page.locator('#play').click();
  const start = Number(await page.locator('#time').inputValue());
  await page.waitForFunction((start) => Number(document.getElementById('time').value) !== start, start);
  found.played = true;
  await page.close();
}

// Levels of detail: shown, and as colors.
async function levels(browser) {
  fs.copyFileSync(path.join(specs, 'levels/amphora.toml'), path.join(folder, 'amphora.toml'));
  const page = await open(browser, await watch('amphora.toml'));
  await settled(page, true);
  found.levels = { list: await page.locator('#level option').allInnerTexts(), pictures: [] };
  const chosen = async (select, value, data) => {
    await page.locator(select).selectOption(value);
    await page.waitForFunction(
      ([data, value]) => document.body.dataset[data] === value, [data, value], { timeout: SECONDS * 1000 },
    );
    await settled(page, true);
    return picture(page);
  };
  for (const level of ['0', '1', '3', '0']) found.levels.pictures.push(await chosen('#level', level, 'level'));
  found.levels.heats = [await chosen('#heat', 'lod', 'heat')];
  found.levels.heats.push(await chosen('#level', '3', 'level'));
  found.levels.note = await page.locator('#note').innerText();
  await page.close();
}

// Milliseconds from a save to its bytes in the page, and to its picture, for texts that differ.
async function took(browser, name, text) {
  write(name, text(0));
  const page = await open(browser, await watch(name));
  await settled(page, true);
  const all = [];
  for (let step = 1; step <= 5; step += 1) {
    await pause(100);
    await page.evaluate(() => performance.clearMarks());
    const start = performance.timeOrigin + performance.now();
    write(name, text(step));
    await page.waitForFunction(() => performance.getEntriesByName('kiln-drawn').length > 0, null, { polling: 'raf' });
    await settled(page, true);
    const marks = await page.evaluate(() => ['kiln-bytes', 'kiln-drawn'].map((name) => {
      const mark = performance.getEntriesByName(name)[0];
      return mark ? performance.timeOrigin + mark.startTime : null;
    }));
    all.push(marks.map((mark) => mark && mark - start));
  }
  await page.close();
  return all;
}

const TEA = ['teapot', 'teacup', 'teaspoon'];

async function latency(browser) {
  const vase = fs.readFileSync(path.join(specs, 'turned/vase.toml'), 'utf8');
  // Their sections one after the other; within another tolerance all of it is cut anew.
  const sections = TEA.map((name) => {
    const text = fs.readFileSync(path.join(specs, `patches/${name}.toml`), 'utf8');
    return text.slice(text.indexOf('\n[') + 1);
  }).join('\n');
  const tea = (step) => `tolerance = ${(0.0002 - step * 0.00001).toFixed(5)}\n${sections}`;
  found.latency = {
    vase: await took(browser, 'vase.toml', (step) => vase.replace('height = 0.26', `height = 0.26${step}`)),
    'tea set': await took(browser, 'tea-set.toml', tea),
  };
}

const browser = await launch();
try {
  await edits(browser);
  await motion(browser);
  await levels(browser);
  if (three !== '-') await latency(browser);
} finally {
  await browser.close();
  for (const child of watches) child.kill();
}
console.log(JSON.stringify(found));
