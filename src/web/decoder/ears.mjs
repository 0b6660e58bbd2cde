// Ears of a simple polygon, which are clipped off until none is left.
//
// An ear is a triangle of three corners in sequence that lies in the polygon (G. Meisters, Polygons
// have ears, 1975). Corners at one position do not hide each other: a hole is reached over a bridge.
import { FLAT, TINY } from "./planes.mjs";

// What counts as an ear, from one level to the next when no corner is known as one: a triangle that
// is no sliver and that no corner touches; one that no corner touches; one with no corner inside.
const [CLEAR, EXACT, OPEN, NONE] = [0, 1, 2, 3];

/** Return a polygon, in its plane, as triangles of its corners; null where it crosses itself. */
export function clipEars(x, y) {
  const outline = new Outline(x, y);
  const found = outline.clip();
  const isWhole = outline.level < NONE;
  for (let t = 0; t < found.length && isWhole; t += 3) {
    if (outline.turn(found[t], found[t + 1], found[t + 2]) < -TINY) return null;
  }
  return isWhole ? found : null;
}

const widthOf = (values) => values.reduce((a, b) => Math.max(a, b)) - values.reduce((a, b) => Math.min(a, b));

/** What is left of a polygon, as a ring of corners. */
class Outline {
  constructor(x, y) {
    // Corners are sorted along x: the longer of the two.
    const isHigh = widthOf(y) > widthOf(x);
    [this.x, this.y] = isHigh ? [y, x.map((value) => -value)] : [x, y];
    this.size = x.length;
    this.level = CLEAR;
    this.corners = x.map((_, c) => ({ c, before: (c || x.length) - 1, after: (c + 1) % x.length }));
    this.corners.forEach((_, c) => this.#measure(c));
    this.#sort();
  }

  /** Clip all ears; return them as triangles of corners. */
  clip() {
    const { corners } = this;
    const found = [];
    let ears = [];
    let changed = corners.map(({ c }) => c);
    while (this.size > 3 && this.level < NONE) {
      ears.push(...changed.filter((c) => this.#isClear(c)));
      const best = ears.filter((c) => this.#isBest(c));
      const beside = best.map((c) => [corners[c].before, corners[c].after]);
      best.forEach((c, i) => found.push(beside[i][0], c, beside[i][1]));
      best.forEach((c, i) => this.#unlink(c, ...beside[i]));
      if (this.size === 3) {
        const second = corners[beside[0][0]].after;
        found.push(beside[0][0], second, corners[second].after);
      }
      if (!best.length) this.level++;
      const all = () => corners.filter(({ after }) => after >= 0).map(({ c }) => c);
      changed = best.length ? [...new Set(beside.flat())].sort((a, b) => a - b) : all();
      changed.filter(() => best.length).forEach((c) => this.#measure(c));
      ears = ears.filter((c) => corners[c].isEar);
    }
    return found;
  }

  /** Return whether a corner is an ear, which is found out here. */
  #isClear(c) {
    const own = this.corners[c];
    const isSharp = [!own.isFlat, own.area > 0, own.area >= -TINY][this.level];
    own.isEar = own.repeats || (isSharp && !this.#isHidden(c));
    if (own.isEar) own.score = own.repeats ? Infinity : own.quality;
    return own.isEar;
  }

  /** Return whether an ear is better than those beside it, the first of equal ones. */
  #isBest(c) {
    const { before, after } = this.corners[c];
    const beside = [before, after];
    // Of four corners, two that are opposite must not both go.
    if (this.size === 4) beside.push(this.corners[after].after);
    const { score } = this.corners[c];
    return beside.every((d) => score > this.corners[d].score || (score === this.corners[d].score && c < d));
  }

  #unlink(c, before, after) {
    this.corners[before].after = after;
    this.corners[after].before = before;
    Object.assign(this.corners[c], { after: -1, isFlat: false, isEar: false });
    this.size--;
    if (--this.untilSorting < 0) this.#sort();
  }

  #measure(c) {
    const { x, y } = this;
    const { before, after } = this.corners[c];
    const [ax, ay, bx, by] = [x[c] - x[before], y[c] - y[before], x[after] - x[c], y[after] - y[c]];
    const [area, a, b] = [ax * by - ay * bx, ax * ax + ay * ay, bx * bx + by * by];
    const around = a + b + (ax + bx) ** 2 + (ay + by) ** 2;
    Object.assign(this.corners[c], {
      area,
      quality: area / (around > 0 ? around : 1),
      score: -Infinity,
      repeats: ax === 0 && ay === 0,
      isFlat: area <= FLAT * Math.sqrt(a * b),
      isEar: false,
    });
  }

  /** Sort the corners that may hide an ear: one that is hidden, is by a reflex corner. */
  #sort() {
    const flat = this.corners.filter(({ isFlat }) => isFlat).map(({ c }) => c);
    this.sorted = flat.sort((c, d) => this.x[c] - this.x[d]);
    this.untilSorting = this.size >> 1;
  }

  #isHidden(c) {
    const { x, sorted, corners } = this;
    const { before, after, area } = corners[c];
    const places = [x[before], x[c], x[after]];
    const [low, high] = [Math.min(...places), Math.max(...places)];
    const reach = 2 * FLAT * (high - low);
    const margin = [-FLAT * area, 0, TINY][this.level];
    let [k, end] = [0, sorted.length];
    while (k < end) {
      const middle = (k + end) >> 1;
      if (x[sorted[middle]] < low - reach) k = middle + 1;
      else end = middle;
    }
    for (; k < sorted.length && x[sorted[k]] <= high + reach; k++) {
      const at = sorted[k];
      if (!corners[at].isFlat || [before, c, after].some((d) => this.#isAt(d, at))) continue;
      const sides = [
        [after, before],
        [before, c],
        [c, after],
      ];
      if (sides.every(([from, to]) => this.turn(from, to, at) >= margin)) return true;
    }
    return false;
  }

  #isAt(c, d) {
    return this.x[c] === this.x[d] && this.y[c] === this.y[d];
  }

  /** Return twice the area of a triangle of corners, negative where it turns to the right. */
  turn(a, b, c) {
    const { x, y } = this;
    return (x[b] - x[a]) * (y[c] - y[a]) - (y[b] - y[a]) * (x[c] - x[a]);
  }
}
