// The page: what is asked for, and what is shown.
import { models } from './models.js';
import { open } from './open.js';

const $ = (id) => document.getElementById(id);
const picture = $('picture'), context = picture.getContext('2d'), overlay = $('boxes');
const worker = new Worker(new URL('./tracer.js', import.meta.url), { type: 'module' });

const state = { builder: 'sbvh', alpha: 1e-5, mode: 'shaded', level: -1, azimuth: -0.9, height: 0.3, distance: 1.3 };
let bounds = { lower: [0, 0, 0], upper: [1, 1, 1] }, boxes = new Float32Array(0), number = 0;
/** For tests: how many pictures are complete, and of what. */
window.shown = { number: -1, mode: '' };

function say(text) {
  $('status').textContent = text;
}

function camera() {
  const { lower, upper } = bounds, center = lower.map((l, k) => (l + upper[k]) / 2);
  const size = Math.hypot(...upper.map((u, k) => u - lower[k])) || 1;
  const { azimuth: a, height: h } = state, forward = [-Math.cos(a) * Math.cos(h), -Math.sin(a) * Math.cos(h), -Math.sin(h)];
  const right = [-Math.sin(a), Math.cos(a), 0];
  const up = [right[1] * forward[2] - right[2] * forward[1], right[2] * forward[0] - right[0] * forward[2], right[0] * forward[1] - right[1] * forward[0]];
  return { eye: center.map((c, k) => c - state.distance * 0.62 * size * forward[k]), right, up, forward, tangent: 0.5, size };
}

function draw() {
  const width = Math.max(64, Math.min(900, Math.round(picture.clientWidth / 8) * 8)), height = Math.round((width * 0.62) / 8) * 8;
  if (picture.width !== width || picture.height !== height) {
    const before = Object.assign(document.createElement('canvas'), { width: picture.width, height: picture.height });
    before.getContext('2d').drawImage(picture, 0, 0);
    picture.width = width;
    picture.height = height;
    context.drawImage(before, 0, 0, width, height);
  }
  worker.postMessage({ picture: { camera: camera(), width, height, mode: state.mode, number: ++number } });
  drawBoxes();
}

function drawBoxes() {
  overlay.width = picture.clientWidth * devicePixelRatio;
  overlay.height = picture.clientHeight * devicePixelRatio;
  if (boxes.length === 0) return;
  const lines = overlay.getContext('2d'), { eye, right, up, forward, tangent } = camera();
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const project = (p) => {
    const v = p.map((x, k) => x - eye[k]), z = dot(v, forward), aspect = overlay.width / overlay.height;
    if (z <= 1e-3) return null;
    return [(1 + dot(v, right) / (z * tangent * aspect)) * 0.5 * overlay.width, (1 - dot(v, up) / (z * tangent)) * 0.5 * overlay.height];
  };
  lines.strokeStyle = '#ff9d4c';
  lines.globalAlpha = Math.max(0.12, Math.min(0.9, 400 / boxes.length));
  lines.lineWidth = devicePixelRatio;
  lines.beginPath();
  for (let i = 0; i < boxes.length; i += 6) {
    const corner = (c) => project([0, 1, 2].map((k) => boxes[i + k + ((c >> k) & 1 ? 3 : 0)]));
    const corners = Array.from({ length: 8 }, (_, c) => corner(c));
    for (let c = 0; c < 8; ++c) {
      for (const bit of [1, 2, 4]) {
        const [a, b] = [corners[c], corners[c | bit]];
        if (c & bit || !a || !b) continue;
        lines.moveTo(...a);
        lines.lineTo(...b);
      }
    }
  }
  lines.stroke();
}

function facts(list) {
  $('facts').replaceChildren(...Object.entries(list).map(([name, value]) => {
    const item = document.createElement('div');
    item.append(Object.assign(document.createElement('dt'), { textContent: name }), Object.assign(document.createElement('dd'), { textContent: value }));
    return item;
  }));
}

function showRows(...rows) {
  $('table').tBodies[0].replaceChildren(...rows);
  $('table').hidden = rows.length === 0;
}

function rebuild(mesh) {
  say('Building…');
  showRows();
  worker.postMessage({ mesh, build: { builder: state.builder, alpha: state.alpha }, level: state.level });
}

function load(mesh) {
  mesh.index ??= new Uint32Array(mesh.positions.length / 3).map((_, i) => i);
  if (mesh.index.length === 0) throw new Error('there are no triangles');
  rebuild(mesh);
}

async function openFile(file) {
  say(`Reading ${file.name}…`);
  try {
    load(await open(file));
  } catch (error) {
    say(error.message);
  }
}

let known = {};
worker.onmessage = ({ data }) => {
  if (data.error) say(data.error);
  if (data.progress !== undefined) say(`Building: ${Math.round(100 * data.progress)} %`);
  if (data.statistics) {
    const s = data.statistics;
    bounds = s.bounds;
    known = {
      triangles: s.triangles.toLocaleString('en'), references: s.references.toLocaleString('en'), nodes: s.nodes.toLocaleString('en'),
      memory: `${(s.bytes / 1e6).toFixed(1)} MB`, build: `${data.build.toFixed(0)} ms`,
    };
    const skipped = s.degenerateTriangles + s.nonFiniteTriangles;
    if (skipped > 0) known['left out'] = skipped.toLocaleString('en');
    facts(known);
    draw();
  }
  if (data.boxes) {
    boxes = data.boxes;
    drawBoxes();
  }
  if (data.image) {
    if (data.number !== number) return;
    const image = new ImageData(data.image, data.width, data.height);
    if (data.final) {
      context.putImageData(image, 0, 0);
      const time = data.seconds < 1 ? `${(1000 * data.seconds).toFixed(0)} ms` : `${data.seconds.toFixed(1)} s`;
      say(`${data.count.toLocaleString('en')} rays in ${time}: ${(data.count / data.seconds / 1e6).toFixed(2)} million a second`);
      window.shown = { number: data.number, mode: data.mode };
    } else {
      createImageBitmap(image).then((bitmap) => {
        if (window.shown.number < data.number && data.number === number) context.drawImage(bitmap, 0, 0, picture.width, picture.height);
      });
    }
  }
  if (data.rows) {
    const cell = (value, digits = 0) => (value === undefined ? '–' : value.toLocaleString('en', { maximumFractionDigits: digits, minimumFractionDigits: digits }));
    const rate = (value) => value.toLocaleString('en', { maximumSignificantDigits: 2, minimumSignificantDigits: 2 });
    showRows(...data.rows.map((row) => {
      const line = document.createElement('tr');
      for (const text of [row.builder, cell(row.cost, 1), cell(row.references), cell(row.build), cell(row.steps, 1), cell(row.tests, 1), rate(row.rate)])
        line.append(Object.assign(document.createElement('td'), { textContent: text }));
      return line;
    }));
    $('compare').disabled = !data.done;
  }
};
worker.onerror = (event) => say(event.message || 'The worker cannot be loaded.');

function setAlpha() {
  const exponent = Number($('alpha').value);
  state.alpha = exponent <= -7 ? 0 : 10 ** exponent;
  $('alpha-value').textContent = exponent <= -7 ? '0: everywhere' : exponent >= 0 ? '1: nowhere' : state.alpha.toExponential(0);
}
function setLevel() {
  state.level = Number($('level').value);
  $('level-value').textContent = state.level < 0 ? 'none' : state.level;
  worker.postMessage({ level: state.level });
}
function setMode(mode) {
  state.mode = mode;
  document.querySelector(`input[name=mode][value=${mode}]`).checked = true;
  draw();
}
function compare() {
  $('compare').disabled = true;
  worker.postMessage({ compare: { camera: camera(), alpha: state.alpha } });
}

$('controls').onsubmit = (event) => event.preventDefault();
$('model').onchange = () => load(models[$('model').value]());
$('file').onchange = () => $('file').files[0] && openFile($('file').files[0]);
$('builder').onchange = () => {
  state.builder = $('builder').value;
  rebuild();
};
$('alpha').oninput = setAlpha;
$('alpha').onchange = () => rebuild();
$('level').oninput = setLevel;
for (const radio of document.querySelectorAll('input[name=mode]')) radio.onchange = () => setMode(radio.value);
$('compare').onclick = compare;

const turn = (azimuth, height) => {
  state.azimuth += azimuth;
  state.height = Math.max(-1.5, Math.min(1.5, state.height + height));
  draw();
};
const zoom = (factor) => {
  state.distance = Math.max(0.05, Math.min(8, state.distance * factor));
  draw();
};
// The mouse or one finger turns, two fingers zoom.
const held = new Map();
const apart = () => {
  const [a, b] = held.values();
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
};
picture.onpointerdown = (event) => {
  held.set(event.pointerId, [event.clientX, event.clientY]);
  picture.setPointerCapture(event.pointerId);
};
picture.onpointermove = (event) => {
  const from = held.get(event.pointerId), to = [event.clientX, event.clientY];
  if (!from) return;
  const before = held.size === 2 ? apart() : 0;
  held.set(event.pointerId, to);
  if (held.size === 1) turn(-(to[0] - from[0]) * 0.008, (to[1] - from[1]) * 0.008);
  else if (before > 0 && apart() > 0) zoom(before / apart());
};
picture.onpointerup = picture.onpointercancel = (event) => held.delete(event.pointerId);
picture.addEventListener('wheel', (event) => {
  event.preventDefault();
  zoom(Math.exp(event.deltaY * 0.001));
}, { passive: false });

const step = (id, by) => {
  const input = $(id);
  input.value = Number(input.value) + by;
  input.dispatchEvent(new Event('input'));
};
const keys = {
  ArrowLeft: () => turn(-0.12, 0), ArrowRight: () => turn(0.12, 0), ArrowUp: () => turn(0, 0.1), ArrowDown: () => turn(0, -0.1),
  '+': () => zoom(0.85), '=': () => zoom(0.85), '-': () => zoom(1.18),
  1: () => setMode('shaded'), 2: () => setMode('ao'), 3: () => setMode('steps'),
  '[': () => step('level', -1), ']': () => step('level', 1), c: compare,
  b() {
    $('builder').selectedIndex = ($('builder').selectedIndex + 1) % $('builder').options.length;
    $('builder').onchange();
  },
};
addEventListener('keydown', (event) => {
  const of = document.activeElement, busy = of?.matches('select, input');
  if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key] || (busy && event.key.startsWith('Arrow'))) return;
  if (of?.matches('select') && /^[a-z]$/.test(event.key)) return; // letters choose there
  event.preventDefault();
  keys[event.key]();
});

addEventListener('dragover', (event) => {
  event.preventDefault();
  $('drop').hidden = false;
});
addEventListener('dragleave', (event) => { if (!event.relatedTarget) $('drop').hidden = true; });
addEventListener('drop', (event) => {
  event.preventDefault();
  $('drop').hidden = true;
  if (event.dataTransfer.files[0]) openFile(event.dataTransfer.files[0]);
});
let drawnWidth = picture.clientWidth;
addEventListener('resize', () => {
  if (picture.clientWidth === drawnWidth) return;
  drawnWidth = picture.clientWidth;
  draw();
});

setAlpha();
load(models.hall());
