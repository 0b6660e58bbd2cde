// The page: it decodes the files that it holds, draws them, and lets people look.
import { answered } from "../decoder/worker.mjs";
import { decoderIn } from "../decoder/worker_client.mjs";
import { Camera, followGestures } from "./camera.mjs";
import { Controls } from "./controls.mjs";
import { FIELDS, quantile } from "./fields.mjs";
import { readMeshFile } from "./meshfiles.mjs";
import { Panel } from "./panel.mjs";
import { described } from "./pointer.mjs";
import { Renderer } from "./renderer.mjs";

const FLICKER = 600; // milliseconds that each mesh is shown
const MOST_SHOWN = 0.98; // of the errors, below the end of the scale

/**
 * Start the page.
 *
 * `core` is the compiled core, its bytes; `program` the text of a script that is this program, for
 * a worker, empty where there is to be none.
 */
export async function start({ core, program }) {
  const viewer = new Viewer(await WebAssembly.compile(core), program);
  globalThis.deltameshViewer = viewer;
  await viewer.openOwn();
  document.body.dataset.state = "ready";
}

/** Meshes in panels, and how they are seen. */
class Viewer {
  constructor(module, program) {
    this.module = module;
    this.panels = [];
    this.camera = new Camera();
    this.look = { flat: false, wire: false, anchors: false, colouring: "plain" };
    this.layout = "side";
    this.current = 0;
    this.scale = 1;
    this.hidden = new Map();
    this.decode = decoderOf(module, program);
    this.canvas = document.querySelector("canvas");
    this.controls = new Controls(this);
    try {
      this.renderer = new Renderer(this.canvas);
    } catch (error) {
      this.controls.say(`${error.message}: there is no picture, only numbers`, true);
    }
    this.#listen();
  }

  /** Open the files that the page holds. */
  async openOwn() {
    for (const element of document.querySelectorAll("script.mesh")) {
      const { name, role, size } = element.dataset;
      const bytes = globalThis.deltameshBytes(element.textContent);
      await this.open(name, bytes, role, Number(size));
    }
    if (!this.panels.length && !document.querySelector("script.mesh")) {
      this.controls.invite("Drop a .dmesh, OBJ or PLY file here.");
    }
  }

  /** Open a file; whatever is wrong with it becomes a message. */
  async open(name, bytes, role = "", size = bytes.length) {
    const done = this.controls.wait(`${name}: decoding …`);
    try {
      const other = readMeshFile(name, bytes);
      const { mesh, about } = other ? { mesh: other, about: null } : await this.decode(bytes);
      this.#add(new Panel({ name, role: role || (other ? "original" : ""), mesh, about, size }));
    } catch (error) {
      this.controls.say(`${name}: ${error.message}`, true);
    } finally {
      done();
    }
  }

  #add(panel) {
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

  /** Take a panel away. */
  close(index) {
    const [panel] = this.panels.splice(index, 1);
    if (panel.buffers) this.renderer.forget(panel.buffers);
    this.current = Math.max(0, Math.min(this.current, this.panels.length - 1));
    this.controls.fill();
    this.paint();
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
      const place = this.#placeOf(i);
      renderer.draw(panel.buffers, place, camera.matrices(place[2] / place[3]), look);
    });
  }

  /** Return the rectangle of a panel that is seen, in pixels from the lower left. */
  #placeOf(i) {
    const { width, height } = this.canvas;
    const count = this.seen.length;
    const isTall = height > width;
    const share = Math.floor((isTall ? height : width) / count);
    return isTall
      ? [0, height - (i + 1) * share, width, share]
      : [i * share, 0, share, height];
  }

  /** Return the panel at a place of the page, its rectangle, and the pixel. */
  #at(event) {
    const box = this.canvas.getBoundingClientRect();
    const ratio = this.canvas.width / box.width;
    const x = Math.floor((event.clientX - box.left) * ratio);
    const y = Math.floor((box.bottom - event.clientY) * ratio);
    for (let i = 0; i < this.seen.length; i++) {
      const place = this.#placeOf(i);
      const [left, low, width, height] = place;
      if (x >= left && x < left + width && y >= low && y < low + height) {
        return { panel: this.seen[i], place, x, y };
      }
    }
    return null;
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

/** Return a function that decodes bytes, in a worker where there can be one. */
function decoderOf(module, program) {
  if (program) {
    try {
      const script = URL.createObjectURL(new Blob([program], { type: "text/javascript" }));
      return decoderIn(new Worker(script), module).decode;
    } catch {
      // No workers here: the page waits while it decodes.
    }
  }
  return async (bytes) => {
    const [{ mesh, about, error }] = await answered({ id: 0, module, bytes });
    if (error) throw Object.assign(new Error(error.message), error);
    return { mesh, about };
  };
}
