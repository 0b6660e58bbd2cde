// Controls of the page: buttons, lists, tables, keys, and files that are dropped.
import { gradientOf } from "./colours.mjs";
import { factsOf, short, tableOf } from "./facts.mjs";
import { FIELDS } from "./fields.mjs";
import { fillParts } from "./parts.mjs";

const THEMES = ["", "dark", "light"];
const find = (selector) => document.querySelector(selector);

/** Controls of a viewer, whose elements the page has. */
export class Controls {
  constructor(viewer) {
    this.viewer = viewer;
    this.facts = JSON.parse(find("#facts")?.textContent || "{}");
    this.#listen();
    this.update();
  }

  /** Write a message over the picture; return a function that takes it away. */
  say(text, isFault = false) {
    const message = document.createElement("p");
    message.textContent = text;
    message.classList.toggle("fault", isFault);
    message.addEventListener("click", () => message.remove());
    find("#message").append(message);
    return () => message.remove();
  }

  /** Write a message while something is done; return a function that takes it away. */
  wait(text) {
    this.hint?.();
    return this.say(text);
  }

  /** Write what a page without meshes waits for. */
  invite(text) {
    this.hint = this.say(text);
  }

  /** Set the tables of differences, which stand above the numbers of the files. */
  setCompared(tables) {
    this.facts = { compared: tables };
  }

  /** Write what is under the pointer. */
  point(text) {
    find("#pointer").textContent = text;
  }

  /** Fill lists and tables anew. */
  fill() {
    const { panels, original } = this.viewer;
    const options = new Map([["plain", "plain"]]);
    panels.flatMap((panel) => panel.colourings()).forEach(([key, title]) => options.set(key, title));
    if (original) {
      for (const [key, { title }] of Object.entries(FIELDS)) options.set(key, `error: ${title}`);
    }
    const select = find("#colouring");
    select.replaceChildren(...[...options].map(([key, title]) => new Option(title, key)));
    if (!options.has(this.viewer.look.colouring)) this.viewer.look.colouring = "plain";
    this.#fillPoses();
    this.#fillFacts();
    fillParts(this.viewer);
    this.update();
  }

  #fillPoses() {
    const names = new Set(this.viewer.panels.flatMap(({ poses }) => poses));
    const options = [new Option("at rest", ""), ...[...names].map((name) => new Option(name, name))];
    find("#pose").replaceChildren(...options);
    find("#pose").parentElement.hidden = !names.size;
    find("#play").parentElement.hidden = this.viewer.frames < 2;
  }

  #fillFacts() {
    const { panels } = this.viewer;
    const tables = panels.map((panel) => tableOf(factsOf(panel), titleOf(panel)));
    const { compared = [] } = this.facts;
    const comparison = compared.map((rows, i) => tableOf(rows, i ? "" : "difference"));
    find("#numbers").replaceChildren(...comparison, ...tables);
  }

  /** Show the scale of errors, or none. */
  showLegend(field, most) {
    find("#legend").hidden = !field;
    if (!field) return;
    const { title, unit, signed } = field;
    find("#legend .title").textContent = `${title}, ${unit}`;
    find("#legend .bar").style.background = gradientOf(signed);
    find("#legend .low").textContent = signed ? short(-most) : "0";
    find("#legend .high").textContent = `${short(most)} and more`;
  }

  /** Label the panels that are seen, one above the other or side by side. */
  label(seen, isTall) {
    const names = find("#names");
    names.classList.toggle("tall", isTall);
    const texts = seen.map(titleOf);
    if (names.dataset.shown === JSON.stringify(texts)) return;
    names.dataset.shown = JSON.stringify(texts);
    const labels = texts.map((text) => {
      const label = document.createElement("div");
      label.append(Object.assign(document.createElement("span"), { textContent: text }));
      return label;
    });
    names.replaceChildren(...labels);
  }

  /** Bring buttons into the state of the viewer. */
  update() {
    const { look, layout, panels } = this.viewer;
    for (const name of ["flat", "wire", "anchors"]) press(find(`#${name}`), look[name]);
    for (const name of ["side", "single", "flicker"]) press(find(`#${name}`), layout === name);
    find("#upwards").textContent = `${this.viewer.camera.upwards} up`;
    find("#colouring").value = look.colouring;
    find("#pose").value = this.viewer.pose;
    const { frame, frames, playing } = this.viewer;
    Object.assign(find("#frame"), { max: frames - 1, value: frame });
    find("[for=frame]").textContent = `${frame} of ${frames - 1}`;
    press(find("#play"), Boolean(playing));
    find("#layouts").hidden = panels.length < 2;
    find("#anchors").disabled = !panels.some(({ mesh }) => mesh.anchors.length);
  }

  #listen() {
    const { viewer } = this;
    const on = (selector, run) => find(selector).addEventListener("click", run);
    for (const name of ["flat", "wire", "anchors"]) on(`#${name}`, () => this.#toggle(name));
    for (const name of ["side", "single", "flicker"]) on(`#${name}`, () => viewer.setLayout(name));
    on("#reset", () => this.#reset());
    on("#upwards", () => this.#turnUpwards());
    on("#theme", () => this.#theme());
    on("#help", () => find("#keys").showModal());
    on("#panel", () => document.body.classList.toggle("narrow"));
    find("#colouring").addEventListener("change", ({ target }) => viewer.set({ colouring: target.value })); // prettier-ignore
    find("#pose").addEventListener("change", ({ target }) => viewer.show({ pose: target.value }));
    find("#frame").addEventListener("change", ({ target }) => {
      this.#step(target.value - viewer.frame);
    });
    on("#play", () => viewer.play());
    find("#scale").addEventListener("input", ({ target }) => {
      viewer.scale = 2 ** Number(target.value);
      viewer.paint();
    });
    find("#file").addEventListener("change", ({ target }) => this.#openAll(target.files));
    addEventListener("keydown", (event) => this.#key(event));
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      this.#openAll(event.dataTransfer.files);
    });
  }

  #toggle(name) {
    this.viewer.set({ [name]: !this.viewer.look[name] });
  }

  /** Stop playing, and show the frame so many after the one that is seen, round the ends. */
  #step(by) {
    const { viewer } = this;
    if (viewer.frames < 2) return;
    viewer.playing = null;
    viewer.show({ frame: (viewer.frame + by + viewer.frames) % viewer.frames });
  }

  #reset() {
    this.viewer.camera.reset();
    this.viewer.draw();
  }

  /** Let the next axis point upwards, z or y. */
  #turnUpwards() {
    const { camera } = this.viewer;
    camera.upwards = camera.upwards === "y" ? "z" : "y";
    this.#reset();
    this.update();
  }

  #theme() {
    const { dataset } = document.documentElement;
    dataset.theme = THEMES[(THEMES.indexOf(dataset.theme ?? "") + 1) % THEMES.length];
    this.viewer.draw();
  }

  async #openAll(files) {
    for (const file of files) {
      await this.viewer.open(file.name, new Uint8Array(await file.arrayBuffer()));
    }
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || find("#keys").open) return;
    if (document.body.matches(".reporting")) return;
    if (/^(SELECT|INPUT)$/.test(event.target.tagName) && event.key !== "Escape") return;
    const { viewer } = this;
    const { camera } = viewer;
    const height = viewer.canvas.clientHeight || 1;
    const turn = (dx, dy) => () => (event.shiftKey ? camera.pan(dx, dy, height) : camera.turn(dx, dy, height)); // prettier-ignore
    const keys = {
      f: () => this.#toggle("flat"),
      w: () => this.#toggle("wire"),
      a: () => this.#toggle("anchors"),
      c: () => viewer.set({ colouring: next(find("#colouring")) }),
      p: () => viewer.show({ pose: next(find("#pose")) }),
      ",": () => this.#step(-1),
      ".": () => this.#step(1),
      v: () => viewer.play(),
      s: () => viewer.setLayout("side"),
      1: () => viewer.setLayout("single"),
      x: () => viewer.setLayout(viewer.layout === "flicker" ? "single" : "flicker"),
      " ": () => this.#flip(),
      r: () => camera.reset(),
      z: () => this.#turnUpwards(),
      t: () => this.#theme(),
      "?": () => find("#keys").showModal(),
      ArrowLeft: turn(-20, 0),
      ArrowRight: turn(20, 0),
      ArrowUp: turn(0, -20),
      ArrowDown: turn(0, 20),
      "+": () => camera.zoom(1.15),
      "-": () => camera.zoom(1 / 1.15),
    };
    const run = keys[event.key] ?? keys[event.key.toLowerCase()];
    if (!run) return;
    event.preventDefault();
    run();
    viewer.draw();
  }

  /** Show one panel, and the other one the next time. */
  #flip() {
    if (this.viewer.layout !== "single") this.viewer.setLayout("single");
    this.viewer.next();
  }
}

/** Return the value of the next option of a list, after the last the first. */
function next(select) {
  const { options, selectedIndex } = select;
  return options[(selectedIndex + 1) % options.length].value;
}

const press = (button, isPressed) => button.setAttribute("aria-pressed", String(isPressed));

/** Return what a panel is called. */
function titleOf({ name, role, size }) {
  return `${role ? `${role}: ` : ""}${name} · ${short(size)} bytes`;
}
