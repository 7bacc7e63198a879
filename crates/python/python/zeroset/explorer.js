// The browser's half of the widget. It keeps the view and asks the kernel for pictures, each once
// an earlier one has come. So there are as many as the connection allows. While something moves,
// pictures become coarser if they take long; at rest, one is drawn in full.

/** Time of a picture, in milliseconds, above which the next one is coarser, or finer below. */
const SLOW = 66, FAST = 22;
/** Most pictures that are on their way at once: while one is sent, another is drawn. */
const ON_THE_WAY = 3;
/** Most pixels of the screen along the side of a pixel of a picture that moves. */
const COARSEST = 4;
/** Time without a change after which the picture is drawn in full, and the text is read. */
const REST = 160, TYPING = 120;
/** Change of distance for a step of the wheel or a key, and of the angle for a key. */
const ZOOM = 1.15, TURN = Math.PI / 24;

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** The sum of vectors with factors: sum([u, 2], [v, -1]) is 2u − v. */
const sum = (...terms) => [0, 1, 2].map(k => terms.reduce((all, [v, s]) => all + s * v[k], 0));
const unit = v => sum([v, 1 / Math.hypot(...v)]);

/** A camera that turns around its target, about an axis. Angles are in radians. */
class Orbit {
  constructor(camera) {
    const { eye, target, up, ...projection } = camera;
    this.pole = unit(up);
    // Any two directions that are perpendicular to the pole and to each other.
    const other = Math.abs(this.pole[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0];
    this.a = unit(sum([other, 1], [this.pole, -dot(other, this.pole)]));
    this.b = cross(this.pole, this.a);
    const back = sum([eye, 1], [target, -1]);
    this.distance = Math.hypot(...back);
    this.elevation = Math.asin(Math.max(-1, Math.min(1, dot(back, this.pole) / this.distance)));
    this.azimuth = Math.atan2(dot(back, this.b), dot(back, this.a));
    this.target = target;
    this.projection = projection;
  }

  directions() {
    const level = sum([this.a, Math.cos(this.azimuth)], [this.b, Math.sin(this.azimuth)]);
    const right = cross(this.pole, level);
    const [rise, run] = [Math.sin(this.elevation), Math.cos(this.elevation)];
    const back = sum([level, run], [this.pole, rise]);
    return { back, right, up: sum([this.pole, run], [level, -rise]) };
  }

  camera() {
    const { back, up } = this.directions();
    const eye = sum([this.target, 1], [back, this.distance]);
    return { eye, target: this.target, up, ...this.projection };
  }

  turn(right, down) {
    this.azimuth -= right;
    const most = Math.PI / 2;
    this.elevation = Math.max(-most, Math.min(most, this.elevation + down));
  }

  /** The height of the picture in the plane through the target. */
  height() {
    const { fov, orthographic } = this.projection;
    return orthographic ?? 2 * this.distance * Math.tan(fov * Math.PI / 360);
  }

  /** Moves the target by shares of the picture's height. */
  pan(right, down) {
    const at = this.directions(), height = this.height();
    this.target = sum([this.target, 1], [at.right, -right * height], [at.up, down * height]);
  }

  zoom(factor) {
    this.distance *= factor;
    if ("orthographic" in this.projection) this.projection.orthographic *= factor;
  }
}

function element(tag, parent, properties = {}) {
  const made = Object.assign(document.createElement(tag), properties);
  parent.append(made);
  return made;
}

class View {
  constructor(model, el) {
    this.model = model;
    this.id = Array.from(crypto.getRandomValues(new Uint32Array(2))).join("-");
    this.number = 0;
    /** Requests without an answer, by number: whether for a picture at rest, and when sent. */
    this.asked = new Map();
    /** Number of the last request for a picture of an earlier document. */
    this.outdated = 0;
    /** Number of the picture that is shown, and when it came. */
    this.shown = 0;
    this.came = 0;
    /** Whether something changed since the last request. */
    this.changed = false;
    this.scale = 1;
    this.values = { ...model.get("values") };
    this.listeners = [];
    this.timers = {};
    this.build(el);
    this.listen("change:text", () => this.showText());
    this.listen("change:error", () => this.showError(model.get("error")));
    this.listen("change:revision", () => this.showDocument());
    this.listen("change:values", () => this.takeValues());
    this.listen("change:axes", () => this.change(false));
    this.listen("msg:custom", (answer, buffers) => this.receive(answer, buffers));
    this.showText();
    this.showError(model.get("error"));
    this.showDocument();
  }

  listen(event, action) {
    this.model.on(event, action);
    this.listeners.push([event, action]);
  }

  remove() {
    for (const [event, action] of this.listeners) this.model.off(event, action);
    Object.values(this.timers).forEach(clearTimeout);
    cancelAnimationFrame(this.tick);
  }

  /** Calls `action` after a pause, unless `later` is called again with the same name before. */
  later(name, pause, action) {
    clearTimeout(this.timers[name]);
    this.timers[name] = setTimeout(action, pause);
  }

  build(el) {
    const root = this.root = element("div", el, { className: "zeroset" });
    // Keys belong to the widget, not to the notebook.
    root.dataset.lmSuppressShortcuts = "true";
    root.addEventListener("keydown", event => event.stopPropagation());
    const [width, height] = [this.model.get("width"), this.model.get("height")];
    root.style.width = `${width}px`;
    this.input = element("textarea", root, { spellcheck: false, rows: 1 });
    this.input.setAttribute("aria-label", "formula");
    this.error = element("pre", root, { className: "error" });
    this.error.setAttribute("role", "status");
    this.canvas = element("canvas", root, { tabIndex: 0 });
    this.canvas.style.aspectRatio = `${width} / ${height}`;
    this.canvas.style.width = `${width}px`;
    this.canvas.setAttribute("role", "img");
    this.canvas.title =
      "Drag to turn, Shift and drag to move. After a click, the wheel zooms. Double-click: home.";
    this.bars = element("div", root, { className: "sliders" });
    const bar = element("div", root, { className: "bar" });
    element("button", bar, { textContent: "Home", title: "The first view" })
      .addEventListener("click", () => this.home());
    this.axes = element("button", bar, { textContent: "Axes" });
    this.axes.addEventListener("click", () => {
      this.model.set("axes", !this.model.get("axes"));
      this.model.save_changes();
      this.change(false);
    });
    element("button", bar, { textContent: "Save", title: "Save the picture as a PNG file" })
      .addEventListener("click", () => this.save());
    this.status = element("span", bar, { className: "status" });
    this.input.addEventListener("input", () => {
      this.fitInput();
      this.later("typing", TYPING, () => this.submit());
    });
    this.handlePointer();
  }

  fitInput() {
    this.input.rows = Math.min(12, this.input.value.split("\n").length);
  }

  submit() {
    this.model.set("text", this.input.value);
    this.model.save_changes();
  }

  showText() {
    // Someone who types has a newer text.
    if (document.activeElement !== this.input) this.input.value = this.model.get("text");
    this.fitInput();
  }

  showError(message) {
    this.error.textContent = message;
    this.input.setAttribute("aria-invalid", String(message !== ""));
  }

  /** Shows a new document: other sliders, another domain. A view chosen by hand stays. */
  showDocument() {
    this.domain = null;
    if (!this.moved) this.orbit = null;
    this.outdated = this.number;
    this.values = { ...this.model.get("values") };
    this.rows = {};
    this.bars.replaceChildren();
    for (const slider of this.model.get("sliders")) this.addSlider(slider);
    this.change(false);
  }

  addSlider({ name, low, high, time }) {
    const step = (high - low) / 200;
    const digits = Math.max(0, Math.min(12, -Math.floor(Math.log10(step))));
    const value = this.values[name];
    const attributes = { min: low, max: high, step: "any", value };
    element("label", this.bars, { textContent: name, htmlFor: `${this.id}-${name}` });
    const range =
      element("input", this.bars, { type: "range", id: `${this.id}-${name}`, ...attributes });
    const number = element("input", this.bars, { type: "number", step: "any" });
    number.setAttribute("aria-label", `value of ${name}`);
    const show = value => {
      range.value = value;
      if (document.activeElement !== number) number.value = Number(value.toFixed(digits));
    };
    const set = value => {
      this.values[name] = value;
      show(value);
      this.change(true);
    };
    range.addEventListener("input", () => set(Number(Number(range.value).toFixed(digits))));
    number.addEventListener("change", () => {
      if (number.value !== "" && Number.isFinite(Number(number.value))) set(Number(number.value));
    });
    this.rows[name] = { show, low, high };
    show(value);
    const last = element("span", this.bars);
    if (time) {
      const play = element("button", last, { textContent: "▶", title: "Let the time run" });
      play.setAttribute("aria-label", "play");
      play.addEventListener("click", () => this.play(play, name, set));
    }
  }

  takeValues() {
    const values = this.model.get("values");
    const isNew = ([name, value]) => name in this.rows && this.values[name] !== value;
    const changes = Object.entries(values).filter(isNew);
    for (const [name, value] of changes) {
      this.values[name] = value;
      this.rows[name].show(value);
    }
    if (changes.length > 0) this.change(false);
  }

  play(button, name, set) {
    this.playing = !this.playing;
    button.textContent = this.playing ? "⏸" : "▶";
    let last = performance.now();
    const { low, high } = this.rows[name];
    const advance = now => {
      if (!this.playing || !button.isConnected) {
        this.playing = false;
        return;
      }
      // While pictures are on their way, the clock waits.
      if (this.asked.size < ON_THE_WAY) {
        const next = this.values[name] + (now - last) / 1000;
        last = now;
        set(low + (next - low) % (high - low));
      }
      this.tick = requestAnimationFrame(advance);
    };
    this.tick = requestAnimationFrame(advance);
  }

  handlePointer() {
    const canvas = this.canvas;
    let from = null;
    canvas.addEventListener("pointerdown", event => {
      if (event.button !== 0 && event.button !== 2) return;
      canvas.setPointerCapture(event.pointerId);
      canvas.focus({ preventScroll: true });
      from = [event.clientX, event.clientY];
    });
    canvas.addEventListener("pointermove", event => {
      if (!from || !this.orbit) return;
      const size = canvas.clientHeight;
      const [right, down] = [event.clientX - from[0], event.clientY - from[1]].map(d => d / size);
      from = [event.clientX, event.clientY];
      const isPan = event.shiftKey || (event.buttons & 2) !== 0;
      if (isPan) this.orbit.pan(right, down);
      else this.orbit.turn(right * Math.PI, down * Math.PI);
      this.move();
    });
    const end = () => { from = null; };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("contextmenu", event => event.preventDefault());
    canvas.addEventListener("dblclick", () => this.home());
    // Without a click before, the wheel scrolls the page.
    canvas.addEventListener("wheel", event => {
      if (document.activeElement !== canvas || !this.orbit) return;
      event.preventDefault();
      this.orbit.zoom(ZOOM ** Math.sign(event.deltaY));
      this.move();
    }, { passive: false });
    const keys = {
      ArrowLeft: orbit => orbit.turn(-TURN, 0),
      ArrowRight: orbit => orbit.turn(TURN, 0),
      ArrowUp: orbit => orbit.turn(0, -TURN),
      ArrowDown: orbit => orbit.turn(0, TURN),
      "+": orbit => orbit.zoom(1 / ZOOM),
      "-": orbit => orbit.zoom(ZOOM),
    };
    canvas.addEventListener("keydown", event => {
      if (event.key === "Home") this.home();
      else if (event.key in keys && this.orbit) {
        keys[event.key](this.orbit);
        this.move();
      } else return;
      event.preventDefault();
    });
  }

  move() {
    this.moved = true;
    this.change(true);
  }

  home() {
    this.moved = false;
    this.orbit = this.domain = null;
    this.change(false);
  }

  save() {
    this.canvas.toBlob(blob => {
      const url = URL.createObjectURL(blob);
      const link = element("a", this.root, { href: url, download: "zeroset.png" });
      link.click();
      link.remove();
      URL.revokeObjectURL(url);
    });
  }

  /** Something to be drawn has changed, and more of the same will follow if it moves. */
  change(isMoving) {
    this.axes.setAttribute("aria-pressed", String(this.model.get("axes")));
    this.changed = true;
    this.isMoving = isMoving;
    // A picture at rest may take long, and is given up. Others are waited for.
    const atRest = [...this.asked].filter(([, { final }]) => final);
    for (const [number] of atRest) this.asked.delete(number);
    if (this.asked.size < ON_THE_WAY) this.ask(!isMoving);
  }

  ask(final) {
    clearTimeout(this.timers.rest);
    this.changed = false;
    this.number += 1;
    const pixel = final ? window.devicePixelRatio || 1 : 1 / this.scale;
    const side = name => Math.max(1, Math.round(this.model.get(name) * pixel));
    const [width, height] = [side("width"), side("height")];
    this.asked.set(this.number, { final, sent: performance.now() });
    // At rest, the surface may have outgrown the domain, and a view that nobody chose.
    const domain = final ? null : this.domain;
    const camera = (this.moved || !final) && this.orbit ? this.orbit.camera() : null;
    const { id: view, number, values } = this;
    this.model.send({ view, number, width, height, final, camera, domain, values });
    if (final) {
      this.model.set("values", { ...values });
      this.model.save_changes();
    }
    this.root.dataset.state = "drawing";
  }

  async receive(answer, buffers) {
    const asked = answer.view === this.id && this.asked.get(answer.number);
    if (!asked) return;
    if (answer.error !== undefined) this.showError(answer.error);
    else await this.show(answer, buffers[0]);
    if (!this.asked.delete(answer.number)) return;
    const now = performance.now();
    // A hand that moves slowly makes pictures rare, and a slow connection makes them late. Only
    // if they are both, drawing takes long.
    if (!asked.final) this.pace(Math.min(now - asked.sent, now - this.came));
    this.came = now;
    if (this.changed) this.ask(!this.isMoving);
    else if (this.asked.size === 0) {
      if (!asked.final) this.later("rest", REST, () => this.ask(true));
      else this.root.dataset.state = "rest";
    }
  }

  /** Chooses the size of the next picture that moves. */
  pace(time) {
    if (time > SLOW) this.scale = Math.min(COARSEST, this.scale * 2);
    else if (time < FAST) this.scale = Math.max(1, this.scale / 2);
  }

  async show({ number, camera, domain, counts, size }, png) {
    const image = await createImageBitmap(new Blob([png], { type: "image/png" }));
    // Given up meanwhile, or overtaken.
    if (!this.asked.has(number) || number < this.shown) return;
    this.shown = number;
    const [width, height] = ["width", "height"].map(name => this.model.get(name));
    const ratio = Math.max(size[0] / width, window.devicePixelRatio || 1);
    // Changing the size clears the canvas, also to the same size.
    const wide = Math.round(width * ratio), high = Math.round(height * ratio);
    if (this.canvas.width !== wide || this.canvas.height !== high) {
      Object.assign(this.canvas, { width: wide, height: high });
    }
    this.canvas.getContext("2d").drawImage(image, 0, 0, wide, high);
    if (number > this.outdated) {
      if (!this.moved || !this.orbit) this.orbit = new Orbit(camera);
      this.domain = domain;
    }
    this.showError(this.model.get("error"));
    const share = 100 * counts.undecided / (size[0] * size[1]);
    const open = share === 0 ? "every pixel proven" : `${share.toPrecision(2)} % undecided`;
    this.status.textContent = `${size[0]} × ${size[1]}, ${open}`;
    this.canvas.setAttribute("aria-label", `picture of ${this.model.get("text")}`);
    this.root.dataset.frames = Number(this.root.dataset.frames ?? 0) + 1;
  }
}

function render({ model, el }) {
  const view = new View(model, el);
  return () => view.remove();
}

export default { render };
