// Decoder of `.dmesh` files: bytes become a mesh of typed arrays, or are refused.
import { entriesOf } from "./attribute_table.mjs";
import { decodeAttributes, domainsOf, restored } from "./attributes.mjs";
import { decodeConnectivity } from "./connectivity.mjs";
import { readContainer } from "./container.mjs";
import { decodeCopies } from "./copies.mjs";
import { digested, digestOf } from "./digest.mjs";
import { DeltameshError, FormatError } from "./errors.mjs";
import { framesOf } from "./frame_table.mjs";
import { Player } from "./frames.mjs";
import { decodeGeometry, geometrySolver, hasScale, reconstructed } from "./geometry.mjs";
import { inverse, largest } from "./integers.mjs";
import { announced, checkLimits, checkPose, MAX_VERTICES, MEMORY } from "./limits.mjs";
import { decodeOrder, permutedCorners } from "./order.mjs";
import { decodeParts } from "./parts.mjs";
import { decodePolygons } from "./polygons.mjs";
import { decodePoses, posed, posesOf, turnNormals } from "./poses.mjs";
import { decodeStitches } from "./stitches.mjs";
import { complexOf, manifoldOf, plainStructure, trivialStitches } from "./structure.mjs";
import { readTexts } from "./texts.mjs";
import { trianglesOf } from "./triangles.mjs";

// Sections whose decoders walk from half-edge to half-edge.
const NEED_MANIFOLD = ["STCH", "COPY", "POLY", "ATTR"];

/** Return what a file says of itself; nothing of its mesh is decoded. */
export function inspect(bytes) {
  const container = readContainer(bytes);
  const { version, vertices, triangles, parameters, meta, sections } = container;
  const texts = sections.get("PART")?.read((payload) => readTexts(payload)[0]);
  return {
    version,
    vertices,
    triangles,
    size: bytes.length,
    parameters: { ...parameters, method: parameters.method.name },
    meta,
    sections: [...sections.values()].map(({ id, offset, end }) => ({ id, bytes: end - offset })),
    frames: framesOf(container).frames.length + 1,
    fps: framesOf(container).rate || null,
    attributes: entriesOf(container),
    parts: (texts?.divisions ?? []).map(({ kind, names }) => ({ kind, names })),
    metadata: texts?.metadata ?? new Map(),
    lost: texts?.lost ?? [],
    poses: posesOf(container).map(({ name, step, size }) => ({ name, step, bytes: size })),
  };
}

/**
 * Decode a file, a Uint8Array, with a core of `loadCore`; return its mesh, of a sequence a frame.
 *
 * `maxVertices` and `memory`, in bytes, are the limits, `pose` is the name of one of its poses,
 * `frame` the number of a frame. Of the mesh, `positions` has three numbers a vertex; `corners` and
 * `offsets` the vertices of each polygon; `triangles` those of each triangle, `triangleCorners` their
 * places among `corners`, `trianglePolygons` their polygons; `anchors` the vertices whose positions
 * are stored; `attributes` and `parts` what else there is.
 */
export function decode(core, bytes, options = {}) {
  const file = new Opened(core, bytes, options);
  try {
    return file.mesh(options);
  } finally {
    file.close();
  }
}

/** File whose meshes are decoded as they are asked for: what is alike in all is decoded once. */
export class Opened {
  constructor(core, bytes, { maxVertices = MAX_VERTICES, memory = MEMORY } = {}) {
    for (const [name, limit] of Object.entries({ maxVertices, memory })) {
      if (limit >= 0) continue;
      throw new DeltameshError(`${name} must be a number from 0 on, not ${limit}`);
    }
    Object.assign(this, { core, maxVertices, memory, container: readContainer(bytes) });
    this.frames = framesOf(this.container).frames.length + 1;
  }

  /** Return the mesh in a pose, or in a frame; see `decode`. */
  mesh({ pose = null, frame = 0 } = {}) {
    const { core, container, frames, memory } = this;
    if (!(Number.isInteger(frame) && frame >= 0 && frame < frames)) {
      throw new DeltameshError(`there is no frame ${frame}: the file has ${frames}, from 0 on`);
    }
    if (pose !== null) {
      if (frame) throw new DeltameshError("a pose is one of frame 0");
      if (!posesOf(container).some(({ name }) => name === pose)) {
        throw new DeltameshError(`there is no pose '${pose}'`);
      }
      checkPose(container, memory);
    }
    if (!this.player) this.#read();
    const { content, points } = this;
    if (pose !== null) {
      const wanted = content.poses.find(({ name }) => name === pose);
      const { integers, structure: { surface } } = content;
      const moved = posed(core, surface, integers.anchors, wanted, points);
      return meshOf(container, content, points, moved);
    }
    this.first ??= meshOf(container, content, points);
    return frame ? this.#moved(this.player.points(frame)) : { ...this.first };
  }

  #read() {
    this.close(); // of a reading that has failed
    const { core, container } = this;
    const content = readContent(core, container, this.maxVertices, this.memory);
    checkDigest(core, container, content);
    const { parameters, sections } = container;
    const { integers, structure: { surface } } = content;
    if (!hasScale(parameters, integers)) {
      throw new FormatError("positions that are too large", sections.get("PARM").offset);
    }
    this.solver = geometrySolver(core, parameters, integers, surface);
    const points = reconstructed(core, parameters, integers, surface, this.solver);
    const player = new Player(core, container, content, this.solver, points);
    Object.assign(this, { content, points, player });
  }

  #moved(points) {
    const { structure, order } = this.content;
    const { corners, offsets } = this.first;
    let positions = gathered(points, structure.points, 3);
    if (order) positions = gathered(positions, order.vertices, 3);
    return { ...this.first, positions, ...trianglesOf(positions, corners, offsets) };
  }

  /** Free the memory of the core. */
  close() {
    this.solver?.free();
    this.solver = null;
  }
}

function readContent(core, container, maxVertices, memory) {
  const counts = announced(container);
  checkLimits(container, counts, maxVertices, memory);
  const structure = readStructure(core, container, counts);
  const { sections } = container;
  const integers = decodeGeometry(core, container, structure.surface);
  const domains = domainsOf(structure);
  const read = (id, run) => sections.get(id)?.read(run);
  const attributes = read("ATTR", (payload) => decodeAttributes(core, payload, domains)) ?? [];
  const parts = read("PART", (payload) => decodeParts(core, payload, domains)) ?? null;
  const order = read("ORDR", (payload) => decodeOrder(core, payload, structure)) ?? null;
  const poses =
    read("POSE", (payload) =>
      decodePoses(core, payload, structure.surface, integers.anchors),
    ) ?? [];
  return { structure, domains, integers, attributes, parts, order, poses };
}

function readStructure(core, { sections, vertices, triangles }, counts) {
  let structure = sections.get("CONN").read((payload) => {
    const faces = decodeConnectivity(core, payload, counts);
    const manifold = manifoldOf(core, faces, counts.vertices);
    if (NEED_MANIFOLD.some((id) => sections.has(id)) && !manifold.isSound) {
      throw new FormatError("the faces form no manifold", 0);
    }
    const stitches = trivialStitches(counts.vertices, counts.faces);
    const used = counts.points - counts.isolated;
    return plainStructure(core, complexOf(core, manifold, stitches, used, counts.isolated));
  });
  const further = {
    STCH: (payload) => decodeStitches(core, payload, triangles, structure),
    COPY: (payload) => decodeCopies(core, payload, vertices, structure),
    POLY: (payload) => decodePolygons(core, payload, structure),
  };
  for (const [id, run] of Object.entries(further)) {
    structure = sections.get(id)?.read(run) ?? structure;
  }
  return structure;
}

function checkDigest(core, { digest, sections }, content) {
  const found = digestOf(core, digested(content));
  if (!digest.every((byte, i) => byte === found[i])) {
    const reason = "the checksum of the decoded integers is wrong";
    throw new FormatError(reason, sections.get("CHEK").offset);
  }
}

/**
 * Return the mesh of a content and of the positions of its points in frame 0.
 *
 * In a pose, its points have `moved` to other `positions`, and their `turns` are matrices.
 */
function meshOf(container, content, points, moved = null) {
  const { structure, domains, integers, attributes, parts, order } = content;
  const { points: pointOf, polygons } = structure;
  const positions = gathered(points, pointOf, 3);
  const made = attributes.map((one) => restored(one, domains, positions));
  const mesh = {
    positions,
    corners: domains.vertexOfCorners,
    offsets: polygons.offsets,
    attributes: made,
    parts: (parts?.divisions ?? []).map((one) => ({ ...one })),
    metadata: parts?.metadata ?? new Map(),
    lost: parts?.lost ?? [],
    anchors: anchorsOf(integers.anchors, pointOf),
    precision: container.parameters.single ? "float32" : "float64",
  };
  if (moved) {
    mesh.positions = gathered(moved.positions, pointOf, 3);
    turnNormals(mesh, gathered(moved.turns, pointOf, 9));
  }
  if (order) reorder(mesh, order);
  return Object.assign(mesh, trianglesOf(mesh.positions, mesh.corners, mesh.offsets));
}

/** Return the first vertex at each point that is an anchor. */
function anchorsOf(anchors, pointOf) {
  const first = new Int32Array(largest(pointOf) + 1);
  for (let v = pointOf.length - 1; v >= 0; v--) first[pointOf[v]] = v;
  return anchors.map((point) => first[point]);
}

/** Bring a mesh into the order of its source. */
function reorder(mesh, order) {
  const [places, offsets] = permutedCorners(mesh.offsets, order);
  const rank = inverse(order.vertices);
  const taken = { vertex: order.vertices, corner: places, face: order.polygons };
  const sizes = { vertex: rank.length, corner: places.length, face: order.polygons.length };
  mesh.positions = gathered(mesh.positions, order.vertices, 3);
  mesh.corners = places.map((c) => rank[mesh.corners[c]]);
  mesh.offsets = offsets;
  mesh.anchors = mesh.anchors.map((v) => rank[v]);
  for (const attribute of mesh.attributes) {
    const elements = taken[attribute.domain];
    const width = attribute.values.length / (sizes[attribute.domain] || 1);
    attribute.values = gathered(attribute.values, elements, width);
    if (attribute.has) attribute.has = gathered(attribute.has, elements, 1);
  }
  for (const one of mesh.parts) one.ofFace = gathered(one.ofFace, order.polygons, 1);
}

/** Return rows of an array, each of so many numbers. */
function gathered(array, rows, width) {
  const found = new array.constructor(rows.length * width);
  rows.forEach((row, i) => {
    for (let k = 0; k < width; k++) found[i * width + k] = array[row * width + k];
  });
  return found;
}
