// Shows pictures of a file that Kiln draws itself, turned by dragging. One is asked for at a time.

// Whether an answer is words instead of a picture.
const says = (answer) => answer.headers.get('content-type')?.startsWith('text/plain');

// Degrees for a pixel.
const SPEED = 0.4;

export class Frames {
  // Switches, with what stands beside them.
  options = { normals: 'normals' };

  constructor(place) {
    this.place = place;
    this.view = { azimuth: 35, elevation: 22 };
    this.on = {};
    this.moment = { clip: -1, time: 0 };
    this.lod = 0;
    this.image = place.appendChild(new Image());
    this.image.alt = 'the model';
    this.image.draggable = false;
    this.listen();
    new ResizeObserver(() => this.draw()).observe(place);
  }

  async load(asset) {
    this.key = asset.key;
    this.moment = { clip: -1, time: 0 };
    await this.draw();
    return this.key === asset.key;
  }

  set(name, value) {
    this.on[name] = value;
    this.draw();
  }

  // Shows what is measured as colors; what is wrong with that, if anything is.
  async heat(what) {
    this.measured = what;
    this.complaint = '';
    await this.draw();
    return this.complaint;
  }

  // Shows a level of detail.
  async level(number) {
    if (number === this.lod) return;
    this.lod = number;
    await this.draw();
  }

  pose(clip, time) {
    this.moment = { clip, time };
    this.draw();
  }

  fit() {
    this.view = { azimuth: 35, elevation: 22 };
    this.draw();
  }

  // Draws what is to be seen now, after what is being drawn.
  draw() {
    this.waiting = true;
    this.image.ariaBusy = 'true';
    this.drawing ??= this.drawAll().finally(() => {
      this.drawing = null;
      this.image.ariaBusy = 'false';
    });
    return this.drawing;
  }

  async drawAll() {
    while (this.waiting && this.key) {
      this.waiting = false;
      const { key } = this;
      const answer = await fetch(this.address());
      if (this.measured && says(answer)) {
        this.complaint = (await answer.text()).trim();
        this.measured = null;
        this.waiting = true;
        continue;
      }
      // Its bytes are gone: later ones are on their way.
      if (answer.status !== 200) continue;
      const picture = URL.createObjectURL(await answer.blob());
      const before = this.image.src;
      this.image.src = picture;
      await this.image.decode();
      if (before) URL.revokeObjectURL(before);
      performance.mark('kiln-drawn', { detail: key });
    }
  }

  address() {
    const scale = Math.min(devicePixelRatio, 2048 / this.place.clientWidth, 2048 / this.place.clientHeight);
    const pixels = (length) => Math.max(1, Math.floor(length * scale));
    const { clip, time } = this.moment;
    const parts = [
      `key=${this.key}`,
      `azimuth=${this.view.azimuth}&elevation=${this.view.elevation}`,
      `width=${pixels(this.place.clientWidth)}&height=${pixels(this.place.clientHeight)}`,
    ];
    if (clip >= 0) parts.push(`clip=${clip}&time=${time}`);
    if (this.lod > 0) parts.push(`lod=${this.lod}`);
    if (this.on.normals) parts.push('normals');
    if (this.measured) parts.push(`heat=${encodeURIComponent(this.measured)}`);
    return `/frame?${parts.join('&')}`;
  }

  listen() {
    let from = null;
    this.place.addEventListener('pointerdown', (event) => {
      from = { x: event.clientX, y: event.clientY, ...this.view };
      this.place.setPointerCapture(event.pointerId);
    });
    this.place.addEventListener('pointerup', () => { from = null; });
    this.place.addEventListener('pointermove', (event) => {
      if (!from) return;
      const elevation = from.elevation + (event.clientY - from.y) * SPEED;
      this.view = {
        azimuth: (from.azimuth - (event.clientX - from.x) * SPEED) % 360,
        elevation: Math.min(90, Math.max(-90, elevation)),
      };
      this.draw();
    });
  }
}
