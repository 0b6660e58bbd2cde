// Frames of a sequence, each decoded from the one that it is predicted from (SPEC.md 5.22).
import { farthestAnchors } from "./anchors.mjs";
import { cellsOf } from "./cells.mjs";
import { out, room } from "./core.mjs";
import { digestOf } from "./digest.mjs";
import { FormatError } from "./errors.mjs";
import { framesOf } from "./frame_table.mjs";
import { decodeFrame, hasScale, reconstructed } from "./geometry.mjs";
import { alone, given } from "./graph.mjs";
import { largest } from "./integers.mjs";
import { decodeVectors } from "./labels.mjs";
import { POSITION_LARGEST } from "./layout.mjs";
import { greatest } from "./poisson.mjs";

// Numbers of a map, and its identity, with the weight that is smoothed beside it.
const NINE = 9;
const STILL = [1, 0, 0, 0, 1, 0, 0, 0, 1, 1];

/** Player of the frames of a file, in any order; the next one after the last costs the least. */
export class Player {
  /** `points` are the positions of frame 0. */
  constructor(core, container, content, solver, points) {
    Object.assign(this, { core, container, content, solver });
    this.first = { finer: 0, integers: content.integers, points };
    this.cells = new Map(); // by their count: many frames have as many maps
    this.#rewind();
  }

  #rewind(at = 0) {
    Object.assign(this, { at, last: this.first });
  }

  /** Return the positions of the points of a frame. */
  points(index) {
    const { frames } = framesOf(this.container);
    const key = frames.slice(0, index).findLastIndex(({ isKey }) => isKey);
    if (index < this.at) this.#rewind();
    if (key >= this.at) this.#rewind(key);
    while (this.at < index) {
      const frame = frames[this.at];
      const { core, container, content, solver, cells } = this;
      const reference = frame.isKey ? this.first : this.last;
      this.last = decoded(core, container, content, solver, cells, frame, reference);
      this.at++;
    }
    return this.last.points;
  }
}

/** Return a frame, from what it is predicted from: both `finer`, `integers` and `points`. */
function decoded(core, { parameters: p }, content, solver, cells, frame, reference) {
  const { surface } = content.structure;
  const { step, coarse, finer, index, offset } = frame;
  const fail = (reason, where = offset) => {
    throw new FormatError(`frame ${index}: ${reason}`, where);
  };
  const parameters = { ...p, step, coarse, anchorStep: p.anchorStep * 2 ** -finer };
  const rows = decodeMaps(core, frame, surface, fail);
  const seen = decodeFrame(core, frame.sections, parameters, surface, content.integers);
  const { values, positions, isolated, refinements, corrections, units } = seen;
  const numbers = [values, positions, isolated, refinements, corrections, units, seen.cells];
  const digest = digestOf(core, [rows, ...numbers]);
  if (frame.digest.some((byte, i) => byte !== digest[i])) {
    fail("the checksum of the decoded integers is wrong");
  }
  const integers = absolute(p.method, seen, reference.integers, finer - reference.finer);
  if (!hasScale(parameters, integers)) fail("positions that are too large");
  const { maps } = frame;
  if (maps && !cells.has(maps)) cells.set(maps, cellsApart(core, surface, maps));
  const expected = p.method.anchored
    ? predicted(core, surface.graph, frame, rows, cells.get(maps), reference.points)
    : null;
  const points = reconstructed(core, parameters, integers, surface, solver, expected);
  if (!(greatest(points) <= 100 * POSITION_LARGEST)) fail("positions that are too large");
  return { finer, integers, points };
}

/** Return the rows of the maps of a frame, three for each. */
function decodeMaps(core, { maps, sections }, { labels, count }, fail) {
  if (!maps) return new Int32Array(0);
  const section = sections.get("MAPS");
  if (!(largest(labels) < maps && maps <= count)) {
    fail(`${maps} maps of ${count} vertices`, section.offset);
  }
  const rows = section.read((payload) => decodeVectors(core, payload, alone(3 * maps)));
  if (rows.every((x) => !x)) fail("MAPS: no map moves anything", section.start);
  return rows;
}

/** Return integers whose grid points were as seen from those of a reference, on another grid. */
function absolute({ anchored }, seen, reference, finer) {
  const moved = { ...seen };
  for (const name of anchored ? ["positions", "isolated"] : ["values"]) {
    moved[name] = BigInt64Array.from(seen[name], (x, i) => {
      const [base, by] = [BigInt(reference[name][i]), BigInt(finer)];
      return BigInt(x) + (by < 0n ? base >> -by : base << by);
    });
  }
  return moved;
}

/** Return the cell of each vertex, of so many that are far apart. */
function cellsApart(core, { graph, labels }, count) {
  return cellsOf(core, graph, labels, farthestAnchors(core, graph, labels, count)).of;
}

/** Return the deltas that a frame is expected to have, and positions near its own. */
function predicted(core, graph, { maps, rounds, unit }, rows, of, points) {
  const n = graph.count;
  const positions = points.subarray(0, 3 * n);
  const each = new Float64Array((NINE + 1) * n);
  for (let v = 0; v < n; v++) {
    for (let k = 0; k <= NINE; k++) {
      const moved = k < NINE && maps ? rows[NINE * of[v] + k] * 2 ** -unit : 0;
      each[(NINE + 1) * v + k] = STILL[k] + moved;
    }
  }
  if (maps) core.call("dm_smooth", ...given(graph), out(each), NINE + 1, rounds, room(each.length));
  const turns = new Float64Array(NINE * n);
  for (let v = 0, i = 0; v < n; v++) {
    const at = (NINE + 1) * v;
    for (let k = 0; k < NINE; k++) turns[i++] = each[at + k] / each[at + NINE];
  }
  const deltas = new Float64Array(3 * n);
  core.call("dm_turned_deltas", ...given(graph), positions, turns, out(deltas));
  return { deltas, positions };
}
