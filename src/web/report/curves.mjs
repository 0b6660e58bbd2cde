// Curves of errors over sizes: one for each codec, on scales of logarithms.
import { cellText } from "./cells.mjs";
import { short } from "../viewer/facts.mjs";

const [WIDTH, HEIGHT] = [720, 380];
const PLACE = { left: 84, right: 150, top: 14, bottom: 42 };
const COLOURS = ["#1f77c4", "#d1495b", "#2a9d5c", "#b07aa1", "#e08a1e", "#6b7280", "#17a2a2"];
const MARKERS = ["M-5 0A5 5 0 1 0 5 0A5 5 0 1 0-5 0", "M-5-5H5V5H-5Z", "M0-6L6 5H-6Z", "M0-6L6 0L0 6L-6 0Z"];
const find = (selector) => document.querySelector(selector);

/** Curves of the rows: `mesh` is the column of the mesh, `x` and `y` those to choose among. */
export class Curves {
  constructor({ columns, rows, open, mesh, x, y }) {
    Object.assign(this, { columns, rows, open, mesh, hidden: new Set() });
    const titles = (list) => list.map((k) => new Option(columns[k].title, k));
    this.selects = ["mesh", "error", "size"].map((name) => find(`#curve-${name}`));
    const meshes = [...new Set(rows.map(({ cells }) => cells[mesh]))];
    const options = [meshes.map((name) => new Option(name, name)), titles(y), titles(x)];
    this.selects.forEach((select, i) => {
      select.replaceChildren(...options[i]);
      select.addEventListener("change", () => this.draw());
    });
    find("#curves").hidden = !rows.length;
    this.draw();
  }

  /** Draw the curves that are chosen. */
  draw() {
    const [mesh, y, x] = this.selects.map(({ value }) => value);
    const own = this.rows.filter(({ cells }) => cells[this.mesh] === mesh);
    const able = own.filter(({ cells }) => cells[x] > 0 && cells[y] > 0);
    const drawn = able.filter((row) => !this.hidden.has(row.series));
    const svg = find("#curves svg");
    svg.replaceChildren();
    const without = own.length - able.length;
    find("#curves figcaption").textContent = without ? `Without ${without} of no error.` : "";
    this.#names(svg, able);
    if (!drawn.length) return;
    const [right, top] = [WIDTH - PLACE.right, HEIGHT - PLACE.bottom];
    const across = scaleOf(drawn.map(({ cells }) => cells[x]), PLACE.left, right);
    const up = scaleOf(drawn.map(({ cells }) => cells[y]), top, PLACE.top);
    this.#axes(svg, across, up, this.columns[x].title, this.columns[y].title);
    this.#series(drawn).forEach(([name, k]) => {
      const rows = drawn.filter((row) => row.series === name).sort((a, b) => a.cells[x] - b.cells[x]);
      const places = rows.map(({ cells }) => [across.at(cells[x]), up.at(cells[y])]);
      const stroke = COLOURS[k % COLOURS.length];
      add(svg, "polyline", { points: places.join(" "), fill: "none", stroke, "stroke-width": 2 });
      rows.forEach((row, r) => this.#point(svg, row, places[r], k, stroke));
    });
  }

  /** Return the names of the curves of some rows, with their numbers among those of all rows. */
  #series(rows) {
    const names = [...new Set(this.rows.map(({ series }) => series))];
    const own = new Set(rows.map(({ series }) => series));
    return names.map((name, k) => [name, k]).filter(([name]) => own.has(name));
  }

  /** Write the names of the curves, which hide and show them. */
  #names(svg, rows) {
    this.#series(rows).forEach(([name, k], i) => {
      const place = `translate(${WIDTH - PLACE.right + 16} ${PLACE.top + 8 + 20 * i})`;
      const isHidden = this.hidden.has(name);
      const given = { transform: place, tabindex: 0, role: "button", "aria-pressed": !isHidden };
      const group = add(svg, "g", { ...given, class: isHidden ? "name without" : "name" });
      add(group, "path", { d: MARKERS[k % 4], fill: COLOURS[k % COLOURS.length] });
      add(group, "text", { x: 12, y: 4 }, name);
      const toggle = () => {
        if (!this.hidden.delete(name)) this.hidden.add(name);
        this.draw();
      };
      group.addEventListener("click", toggle);
      group.addEventListener("keydown", ({ key }) => key === "Enter" && toggle());
    });
  }

  #point(svg, row, place, k, fill) {
    const given = { d: MARKERS[k % 4], fill, class: "point", transform: `translate(${place})` };
    const point = add(svg, "path", { ...given, tabindex: 0, role: "button" });
    const words = this.columns.map(({ title, kind }, i) => `${title}: ${cellText(row.cells[i], kind)}`);
    add(point, "title", {}, words.join("\n"));
    point.addEventListener("click", () => this.open(row));
    point.addEventListener("keydown", ({ key }) => key === "Enter" && this.open(row));
  }

  #axes(svg, across, up, xTitle, yTitle) {
    const [right, low] = [WIDTH - PLACE.right, HEIGHT - PLACE.bottom];
    for (const value of across.ticks) {
      const x = across.at(value);
      add(svg, "line", { x1: x, x2: x, y1: PLACE.top, y2: low, class: "grid" });
      add(svg, "text", { x, y: low + 16, "text-anchor": "middle" }, tickText(value));
    }
    for (const value of up.ticks) {
      const y = up.at(value);
      add(svg, "line", { x1: PLACE.left, x2: right, y1: y, y2: y, class: "grid" });
      add(svg, "text", { x: PLACE.left - 6, y: y + 4, "text-anchor": "end" }, tickText(value));
    }
    add(svg, "text", { x: (PLACE.left + right) / 2, y: HEIGHT - 6, "text-anchor": "middle" }, xTitle);
    const middle = (PLACE.top + low) / 2;
    add(svg, "text", { x: 0, y: 0, "text-anchor": "middle", transform: `translate(12 ${middle}) rotate(-90)` }, yTitle);
  }
}

/** Return a scale of logarithms from values to places, with round numbers on it. */
function scaleOf(values, from, to) {
  const [low, high] = [Math.min(...values), Math.max(...values)].map(Math.log);
  const margin = Math.max(0.06 * (high - low), 0.05);
  const at = (value) => from + ((Math.log(value) - low + margin) / (high - low + 2 * margin)) * (to - from);
  const [least, most] = [Math.exp(low - margin), Math.exp(high + margin)];
  const round = [];
  for (let power = Math.floor(Math.log10(least)); power <= Math.log10(most); power++) {
    for (const digit of [1, 2, 5]) {
      const value = Number(`${digit}e${power}`);
      if (value >= least && value <= most) round.push(value);
    }
  }
  const powers = round.filter((value) => /^1e|^10*$|^0\.0*1$/.test(String(value)));
  return { at, ticks: round.length > 9 && powers.length > 1 ? powers : round };
}

const tickText = (value) => short(value).replace(".00e", "e");

function add(parent, kind, attributes, text = "") {
  const element = document.createElementNS("http://www.w3.org/2000/svg", kind);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.textContent = text;
  parent.append(element);
  return element;
}
