// Counts that a file announces, and limits that are checked before anything is allocated.
import { entriesOf } from "./attribute_table.mjs";
import { readVarint } from "./bytes.mjs";
import { FormatError, LimitError } from "./errors.mjs";
import { INTERPOLATED, LEAST_SQUARES, MAX_ELEMENTS_PER_BYTE } from "./layout.mjs";
import { posesOf } from "./poses.mjs";
import { movedParts, textSize } from "./texts.mjs";

// Bytes of memory that decoding takes at most, as the Python library estimates them.
export const PER_FACE = 120;
export const PER_TEXT_BYTE = 24;
export const PER_TRANSFORM = 400;
export const PER_GLUED_FACE = 240;
export const PER_ELEMENT = 160;
export const PER_NUMBER = 40;
export const PER_TREE_VERTEX = 320;
export const PER_MOTION = 160;
export const MAX_VERTICES = 2 ** 32;
export const MEMORY = 16 * 2 ** 30;

/** Return the numbers of points, of isolated ones, and of vertices and faces of the manifold. */
export function announced({ sections, parameters, vertices: n, triangles: m }) {
  const { isolated } = parameters;
  const counts = { points: n, isolated, vertices: 0, faces: m };
  sections.get("COPY")?.read((payload) => {
    const [count, at] = readVarint(payload, 0);
    const [further] = readVarint(payload, at);
    if (!(isolated <= count && count < n) || further > n - count) {
      throw new FormatError("the counts of points contradict those of the header", 0);
    }
    counts.points = count;
  });
  counts.vertices = counts.points - isolated;
  sections.get("STCH")?.read((payload) => {
    const [vertices, at] = readVarint(payload, 0);
    const [faces] = readVarint(payload, at);
    if (faces > m || vertices > 3 * faces || vertices < counts.vertices) {
      throw new FormatError("the counts of the manifold contradict those of the header", 0);
    }
    Object.assign(counts, { vertices, faces });
  });
  return counts;
}

/** Refuse a file whose counts are above the limits, or cannot be true. */
export function checkLimits(container, counts, maxVertices, memory) {
  const { vertices: n, triangles: m, sections } = container;
  if (n > maxVertices) {
    throw new LimitError(`${n} vertices are more than the limit of ${maxVertices}`);
  }
  const used = counts.points - counts.isolated;
  const { offset } = sections.get("CONN");
  if (m === 0) throw new FormatError("a mesh of 0 triangles", offset);
  if (!(used <= counts.vertices && counts.vertices <= 3 * counts.faces)) {
    const manifold = `${counts.vertices} vertices and ${counts.faces} faces of the manifold`;
    throw new FormatError(`${manifold} for ${used} points`, offset);
  }
  checkFilling(container, counts);
  const needed = memoryOfCounts(container);
  checkMemory(needed, memory);
  // The text is unpacked only now.
  checkMemory(needed + PER_TRANSFORM * movedParts(container), memory);
}

/** Refuse a pose that takes more memory: it is solved for by least squares. */
export function checkPose(container, memory) {
  const needed = memoryOfCounts(container) + PER_TRANSFORM * movedParts(container);
  const { memory: fixed, memoryPerVertex } = LEAST_SQUARES;
  checkMemory(needed + fixed + memoryPerVertex * container.vertices, memory);
}

function checkMemory(needed, memory) {
  if (needed > memory) {
    const reason = `decoding takes about ${needed} bytes`;
    throw new LimitError(`${reason}, more than the limit of ${memory}`);
  }
}

function memoryOfCounts(container) {
  const { parameters, sections, vertices: n, triangles: m } = container;
  const perFace = PER_FACE + (sections.has("POLY") ? PER_GLUED_FACE : 0);
  const bySolution = parameters.interpolated ? INTERPOLATED : LEAST_SQUARES;
  const { memory, memoryPerVertex } = parameters.method.anchored ? bySolution : parameters.method;
  let needed = memory + memoryPerVertex * n + perFace * m;
  const counts = { vertex: n, corner: 3 * m, face: m };
  for (const entry of entriesOf(container)) {
    const columns = 3 * Math.ceil(entry.columns / 3);
    const domain = entry.coding === "octahedral" ? "corner" : entry.domain;
    needed += counts[domain] * (PER_ELEMENT + PER_NUMBER * columns);
  }
  needed += PER_TEXT_BYTE * textSize(container);
  if (sections.has("POSE")) {
    const motions = posesOf(container).length * parameters.anchorCount;
    needed += PER_TREE_VERTEX * n + PER_MOTION * motions;
  }
  return needed;
}

/** Refuse a file that has not exactly the bytes that its elements need (SPEC.md 5.18). */
function checkFilling({ sections, parameters, vertices, triangles }, counts) {
  const size = (id) => sections.get(id)?.payload.length ?? 0;
  const first = parameters.method.geometry[0];
  const held = [
    ["CONN", counts.faces, "faces of the manifold"],
    [first, (parameters.method.exact ? 3 : 1) * counts.isolated, "isolated vertices"],
    ["STCH", triangles - counts.faces, "faces beyond the manifold"],
    ["COPY", vertices - counts.points, "vertices beyond the points"],
  ].map(([id, count, what]) => {
    const lacking = Math.max(0, Math.ceil(count / MAX_ELEMENTS_PER_BYTE) - size(id) - 4);
    return { id, count, what, lacking };
  });
  const lacking = held.reduce((sum, one) => sum + one.lacking, 0);
  const section = sections.get("FILL");
  const filled = size("FILL");
  if (lacking > filled) {
    const { id, count, what } = held.find((one) => one.lacking);
    const room = `${size(id)} bytes${section ? ` and ${filled} of FILL` : ""}`;
    throw new FormatError(`${id}: ${count} ${what} do not fit into ${room}`, sections.get(id).offset);
  }
  if (!section) return;
  if (lacking < filled || !filled) {
    throw new FormatError(`FILL: ${filled} bytes where ${lacking} are lacking`, section.offset);
  }
  if (section.payload.some((byte) => byte)) {
    throw new FormatError("FILL: a byte that is not zero", section.offset);
  }
}
