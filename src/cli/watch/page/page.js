// The page of `kiln watch`: hears of each bake, shows the last good one, and what is wrong with the newest.
import { Texts } from '/page/texts.js';

const at = (id) => document.getElementById(id);
const texts = new Texts(at('texts'));

// The last news, the viewer, the asset that is shown, and which moment of it.
let news = { assets: [] };
let viewer = null;
let shown = null;
let playing = null;

async function makeViewer() {
  if (document.body.dataset.viewer === 'three') {
    try {
      const { Viewer } = await import('/page/viewer.js');
      return new Viewer(at('stage'), picked);
    } catch (error) {
      at('note').textContent = `no WebGL (${error.message}): pictures are drawn by Kiln`;
    }
  } else {
    at('note').textContent = 'three.js was not found: pictures are drawn by Kiln';
  }
  const { Frames } = await import('/page/frames.js');
  return new Frames(at('stage'));
}

// Says which line made the triangle that was clicked.
async function picked(key, mesh, corners) {
  const [a, b, c] = corners;
  const answer = await fetch(`/place?key=${key}&mesh=${mesh}&a=${a}&b=${b}&c=${c}`);
  if (answer.status !== 200) {
    texts.unmark();
    return;
  }
  const { file, line, current } = await answer.json();
  at('note').textContent = `${file}:${line}${current ? '' : ', as it was last baked'}`;
  if (current) texts.mark(file, line);
}

function clip() {
  return shown?.clips[at('clip').selectedIndex - 1] ?? null;
}

function pose() {
  const time = Number(at('time').value);
  at('seconds').textContent = clip() ? `${time.toFixed(2)} s` : '';
  viewer?.pose(at('clip').selectedIndex - 1, time);
  tellAngles();
}

// The question for the angles of joints that is on its way, and whether another waits.
let asking = null;

// How far joints are turned, beside how far they may: asked one after the other.
async function tellAngles() {
  at('limited').hidden = !(shown?.joints.length > 0);
  const wanted = at('angles').checked && !at('limited').hidden;
  at('limits').hidden = !wanted;
  if (!wanted) return;
  if (asking) {
    asking.again = true;
    return;
  }
  asking = { again: false };
  const moment = `clip=${at('clip').selectedIndex - 1}&time=${Number(at('time').value)}`;
  const answer = await fetch(`/joints?key=${shown.key}&${moment}`).catch(() => null);
  if (answer?.status === 200) at('limits').replaceChildren(...(await answer.json()).flatMap(rows));
  const { again } = asking;
  asking = null;
  if (again) await tellAngles();
}

// A joint as rows: its name and axis, its range, and its angle.
function rows({ name, axes }) {
  return axes.map(({ axis, least, most, angle, within }) => {
    const row = document.createElement('tr');
    row.classList.toggle('beyond', !within);
    // No angle is minus zero.
    const degrees = (Math.round(angle * 10) / 10 + 0).toFixed(1);
    for (const text of [`${name} ${axis}`, `${least}° to ${most}°`, `${degrees}°`]) row.insertCell().textContent = text;
    return row;
  });
}

function stop() {
  cancelAnimationFrame(playing?.frame);
  playing = null;
  at('play').textContent = 'play';
}

function play() {
  const start = performance.now() - Number(at('time').value) * 1000;
  const step = () => {
    const duration = clip()?.duration ?? 0;
    if (!playing || duration === 0) return stop();
    at('time').value = ((performance.now() - start) / 1000) % duration;
    pose();
    playing.frame = requestAnimationFrame(step);
  };
  playing = { frame: 0 };
  at('play').textContent = 'stop';
  step();
}

// Options of a list, with the chosen one kept where it is still there.
function fill(select, names) {
  const before = select.value;
  select.replaceChildren(...names.map((name) => new Option(name, name)));
  select.value = names.includes(before) ? before : names[0] ?? '';
}

function fillClips(asset) {
  fill(at('clip'), ['(rest)', ...asset.clips.map((one) => one.name)]);
  at('clip').parentElement.hidden = asset.clips.length === 0;
  chooseClip();
}

function chooseClip() {
  const chosen = clip();
  for (const id of ['play', 'time', 'seconds']) at(id).hidden = !chosen;
  at('time').max = chosen?.duration ?? 0;
  if (!chosen) stop();
}

// What is measured on the surface: of skins also the weight of each joint.
function fillHeats() {
  const joints = viewer.joints?.() ?? [];
  const levels = shown?.levels > 1 ? ['lod'] : [];
  const measures = ['deviation', 'curvature', 'uv-stretch', 'texel-density', ...levels, ...joints.map((name) => `weights:${name}`)];
  fill(at('heat'), ['(materials)', ...measures]);
}

// The levels of detail that there are; that which was chosen is shown again.
async function fillLevels(asset) {
  fill(at('level'), Array.from({ length: asset.levels }, (_, number) => String(number)));
  at('level').parentElement.hidden = asset.levels < 2;
  await viewer.level(at('level').selectedIndex);
}

// Shows what was measured as colors, or the materials.
async function wear() {
  const chosen = at('heat').selectedIndex > 0 ? at('heat').value : null;
  at('note').textContent = await viewer.heat(chosen) ?? '';
  document.body.dataset.heat = chosen ?? '';
}

async function show() {
  const asset = news.assets.find((one) => one.file === at('asset').value);
  if (!asset || asset.key === shown?.key) return;
  if (await viewer.load({ ...asset, address: `/asset?key=${asset.key}` })) {
    shown = asset;
    fillClips(asset);
    fillHeats();
    await fillLevels(asset);
    if (at('heat').selectedIndex > 0 || document.body.dataset.heat) await wear();
    pose();
    Object.assign(document.body.dataset, { shown: asset.key, shownFile: asset.file });
  }
}

function tell() {
  const { diagnostics, good, failure, revision } = news;
  const count = (severity) => diagnostics.filter((one) => one.severity === severity).length;
  const numbers = ['error', 'warning'].filter(count).map((one) => `${count(one)} ${one}${count(one) > 1 ? 's' : ''}`);
  const wrong = [failure, news.rendered].filter(Boolean).join('\n');
  at('wrong').hidden = wrong === '';
  at('wrong').textContent = wrong;
  at('wrong').classList.toggle('doubt', good);
  const line = news.assets.find((one) => one.file === at('asset').value)?.line ?? '';
  const last = news.assets.length > 0 ? ', the last good model is shown' : '';
  const bad = `${numbers.join(', ') || 'failed'}${last}`;
  const told = revision === 0 ? 'waiting for the first bake' : `${line}  baked in ${news.milliseconds?.toFixed(1)} ms`;
  at('status').textContent = good ? [told, ...numbers].join('  ') : bad;
  at('status').parentElement.classList.toggle('bad', !good);
  document.title = `${good ? '' : '(!) '}${news.document ?? 'Kiln'}`;
  document.body.dataset.good = good;
}

async function hear(text) {
  news = JSON.parse(text);
  fill(at('asset'), news.assets.map((one) => one.file));
  at('asset').parentElement.hidden = news.assets.length < 2;
  tell();
  await Promise.all([show(), texts.read(news)]);
  document.body.dataset.revision = news.revision;
}

viewer = await makeViewer();
for (const [name, title] of Object.entries(viewer.options)) {
  const box = Object.assign(document.createElement('input'), { type: 'checkbox', id: name });
  box.addEventListener('change', () => viewer.set(name, box.checked));
  const label = document.createElement('label');
  label.append(box, ` ${title}`);
  at('options').append(label);
}
at('asset').addEventListener('change', () => { tell(); show(); });
at('clip').addEventListener('change', () => { chooseClip(); pose(); });
at('time').addEventListener('input', () => { stop(); pose(); });
at('play').addEventListener('click', () => (playing ? stop() : play()));
at('heat').addEventListener('change', () => wear());
at('level').addEventListener('change', async () => {
  await viewer.level(at('level').selectedIndex);
  await wear();
  document.body.dataset.level = at('level').value;
});
at('angles').addEventListener('change', () => tellAngles());
at('fit').addEventListener('click', () => viewer.fit());
fillClips({ clips: [] });
fillHeats();

const events = new EventSource('/news');
events.addEventListener('message', (event) => hear(event.data));
events.addEventListener('error', () => {
  at('status').textContent = 'kiln watch has ended, or cannot be reached';
  at('status').parentElement.classList.add('bad');
});
