// Viewer: meshes in panels, and how they are seen.
import { Camera, followGestures } from "./camera.mjs";
import { Controls } from "./controls.mjs";
import { cutLike, FIELDS, quantile } from "./fields.mjs";
import { bytesOf } from "./held.mjs";
import { readMeshFile } from "./meshfiles.mjs";
import { Panel } from "./panel.mjs";
import { described } from "./pointer.mjs";
import { Renderer } from "./renderer.mjs";
import { placeOf, viewAt } from "./views.mjs";

const FLICKER = 600; // milliseconds that each mesh is shown
const USUAL_FPS = 25; // where a file does not say
const MOST_SHOWN = 0.98; // of the errors, below the end of the scale

/** Meshes in panels, and how they are seen; `decode` returns a promise of what is in a file. */
export class Viewer {
  constructor(decode) {
    this.panels = [];
    this.camera = new Camera();
    this.look = { flat: false, wire: false, anchors: false, colouring: "plain" };
    this.layout = "side";
    this.current = 0;
    this.scale = 1;
    this.hidden = new Map();
    this.pose = "";
    this.frame = 0;
    this.playing = null;
    this.decode = decode;
    this.canvas = document.querySelector("canvas");
    this.controls = new Controls(this);
    try {
      this.renderer = new Renderer(this.canvas);
    } catch (error) {
      this.controls.say(`${error.message}: there is no picture, only numbers`, true);
    }
    this.#listen();
  }

  /** Open files that the page holds. */
  async openAll(elements) {
    for (const element of elements) {
      const { name, role, size } = element.dataset;
      await this.open(name, bytesOf(element), role, Number(size));
    }
  }

  /** Open a file; whatever is wrong with it becomes a message. */
  async open(name, bytes, role = "", size = bytes.length) {
    const done = this.controls.wait(`${name}: decoding …`);
    try {
      const other = readMeshFile(name, bytes);
      const { mesh, about } = other ? { mesh: other, about: null } : await this.decode(bytes);
      const held = about?.poses?.length || about?.frames > 1 ? bytes : null;
      this.#add(new Panel({ name, role: role || (other ? "original" : ""), mesh, about, size, held }));
    } catch (error) {
      this.controls.say(`${name}: ${error.message}`, true);
    } finally {
      done();
    }
  }

  #add(panel) {
    if (this.panels.length) cutLike(panel.mesh, (this.original ?? this.panels[0]).mesh);
    this.panels.push(panel);
    this.current = this.panels.length - 1;
    if (this.renderer) {
      const box = this.panels[0].box;
      panel.upload(this.renderer, box);
      panel.hide(this.renderer, this.hidden);
    }
    this.controls.fill();
    this.paint();
  }

  /** The frames of the longest sequence. */
  get frames() {
    return Math.max(1, ...this.panels.map(({ frames }) => frames));
  }

  /**
   * Show a pose of all files that have one by that name, and the others at rest, as by ""; or a frame
   * of all sequences, of shorter ones the last.
   */
  async show({ pose = "", frame = 0 }) {
    Object.assign(this, { pose, frame });
    this.controls.update();
    for (const panel of this.panels) {
      const own = panel.poses.includes(pose) ? pose : "";
      const at = Math.min(frame, panel.frames - 1);
      if (panel.pose === own && panel.frame === at) continue;
      const done = this.playing ? () => {} : this.controls.wait(`${panel.name}: decoding …`);
      try {
        const { mesh } = await this.decode(panel.held, { pose: own || null, frame: at });
        if (this.pose !== pose || this.frame !== frame) return;
        panel.change(mesh, own, at, this.renderer, this.hidden);
      } catch (error) {
        this.playing = null;
        this.controls.say(`${panel.name}: ${error.message}`, true);
      } finally {
        done();
      }
    }
    this.paint();
  }

  /** Show one frame after the other, as fast as they come, or stop that. */
  async play() {
    const own = this.playing || this.frames < 2 ? null : {};
    this.playing = own;
    this.controls.update();
    const fps = Math.max(...this.panels.map(({ about }) => about?.fps ?? 0)) || USUAL_FPS;
    while (own && this.playing === own) {
      const time = new Promise((resolve) => setTimeout(resolve, 1000 / fps));
      await this.show({ frame: (this.frame + 1) % this.frames });
      await time;
    }
  }

  /** Take a panel away. */
  close(index) {
    const [panel] = this.panels.splice(index, 1);
    if (panel.buffers) this.renderer.forget(panel.buffers);
    this.current = Math.max(0, Math.min(this.current, this.panels.length - 1));
    this.controls.fill();
    this.paint();
  }

  /** Take all panels away. */
  closeAll() {
    while (this.panels.length) this.close(this.panels.length - 1);
    Object.assign(this, { pose: "", frame: 0, playing: null });
    this.hidden.clear();
  }

  /** The panel that errors are measured against, if there is one. */
  get original() {
    if (this.panels.length < 2) return null;
    return this.panels.find(({ role }) => role === "original") ?? this.panels[0];
  }

  /** Return the error at the end of the scale. */
  mostOf(key) {
    const fields = this.panels.map((panel) => panel.field(key, this.original)).filter(Boolean);
    return Math.max(...fields.map((field) => quantile(field, MOST_SHOWN)), 0) * this.scale || 1;
  }

  /** Colour all panels as they are to be. */
  paint() {
    const { colouring } = this.look;
    const most = FIELDS[colouring] && this.original ? this.mostOf(colouring) : 1;
    for (const panel of this.renderer ? this.panels : []) {
      panel.paint(this.renderer, colouring, this.original, most);
    }
    this.controls.showLegend(FIELDS[colouring] && this.original ? FIELDS[colouring] : null, most);
    this.draw();
  }

  /** Set parts of the look, and draw. */
  set(look) {
    Object.assign(this.look, look);
    if ("colouring" in look) this.paint();
    this.draw();
    this.controls.update();
  }

  /** Set how panels are laid out: "side", "single" or "flicker". */
  setLayout(layout) {
    this.layout = layout;
    clearInterval(this.timer);
    if (layout === "flicker") this.timer = setInterval(() => this.next(), FLICKER);
    this.draw();
    this.controls.update();
  }

  /** Show the next panel, where one is shown at a time. */
  next(step = 1) {
    const count = this.panels.length || 1;
    this.current = (this.current + step + count) % count;
    this.draw();
    this.controls.update();
  }

  /** Show or hide parts of a kind by names. */
  hideParts(kind, names) {
    this.hidden.set(kind, names);
    for (const panel of this.renderer ? this.panels : []) panel.hide(this.renderer, this.hidden);
    this.draw();
  }

  /** The panels that are drawn now. */
  get seen() {
    return this.layout === "side" ? this.panels : this.panels.slice(this.current, this.current + 1);
  }

  /** Draw with the next frame. */
  draw() {
    this.waiting ??= requestAnimationFrame(() => {
      this.waiting = undefined;
      this.#drawNow();
    });
  }

  #drawNow() {
    const { canvas, renderer, camera } = this;
    this.controls.label(this.seen, canvas.clientHeight > canvas.clientWidth);
    if (!renderer) return;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((x) => Math.round(x * ratio));
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    const style = getComputedStyle(document.body);
    const colour = (name) => style.getPropertyValue(name).trim().split(/\s+/).map((x) => x / 255);
    renderer.clear(colour("--ground"));
    const look = { ...this.look, ratio, line: colour("--line") };
    this.seen.forEach((panel, i) => {
      const place = placeOf(canvas, this.seen.length, i);
      renderer.draw(panel.buffers, place, camera.matrices(place[2] / place[3]), look);
    });
  }

  /** Return the panel at a place of the page, its rectangle, and the pixel; null for none. */
  #at(event) {
    const found = viewAt(this.canvas, this.seen.length, event);
    return found && { ...found, panel: this.seen[found.view] };
  }

  #listen() {
    const { canvas, camera } = this;
    const heightAt = (event) => {
      const found = this.#at(event);
      const ratio = canvas.height / canvas.clientHeight;
      return found ? found.place[3] / ratio : canvas.clientHeight;
    };
    const gestures = followGestures(canvas, camera, heightAt, () => this.draw());
    canvas.addEventListener("pointermove", (event) => {
      if (!gestures.isDragging()) this.point(event);
    });
    canvas.addEventListener("pointerup", (event) => {
      if (!gestures.wasDragged()) this.point(event);
    });
    canvas.addEventListener("dblclick", () => {
      camera.reset();
      this.draw();
    });
    canvas.addEventListener("webglcontextlost", () => {
      this.controls.say("The graphics card has lost the picture: load the page again.", true);
    });
    new ResizeObserver(() => this.draw()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }

  /** Describe what is under the pointer, with the next frame. */
  point(event) {
    if (!this.renderer || this.pointing) return;
    this.pointing = requestAnimationFrame(() => {
      this.pointing = undefined;
      const found = this.#at(event);
      this.controls.point(found ? this.#described(found) : "");
    });
  }

  #described({ panel, place, x, y }) {
    const [left, low, width, height] = place;
    const aspect = width / height;
    const triangle = this.renderer.pickAt(panel.buffers, place, this.camera.matrices(aspect), x, y);
    if (triangle < 0) return "";
    const [u, v] = [(2 * (x + 0.5 - left)) / width - 1, (2 * (y + 0.5 - low)) / height - 1];
    const direction = this.camera.direction(u, v, aspect);
    const { colouring } = this.look;
    return described(panel, triangle, this.camera.eye, direction, colouring, this.original);
  }
}
