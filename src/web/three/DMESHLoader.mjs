// Loader of .dmesh files for three.js.
import { BufferAttribute, BufferGeometry, FileLoader, Loader } from "three";
import { createDecoder } from "../index.mjs";

const NAMES = { normal: "normal", uv: "uv", colour: "color" };

/** Loader of .dmesh files as BufferGeometry; parts become groups, one for each of the first kind. */
export class DMESHLoader extends Loader {
  /** `options` are those of `createDecoder`. */
  constructor(manager, options) {
    super(manager);
    this.decoder = createDecoder(options);
  }

  load(url, onLoad, onProgress, onError = console.error) {
    const loader = new FileLoader(this.manager);
    loader.setPath(this.path);
    loader.setResponseType("arraybuffer");
    loader.setRequestHeader(this.requestHeader);
    loader.setWithCredentials(this.withCredentials);
    const parsed = (buffer) => this.parse(buffer).then(onLoad).catch(onError);
    loader.load(url, parsed, onProgress, onError);
  }

  /** Return a promise of the geometry in the bytes of a file. */
  async parse(buffer) {
    const { decode } = await this.decoder;
    return geometryOf(decode(new Uint8Array(buffer)));
  }
}

/** Return the geometry of a mesh; vertices are told apart where corners or faces have attributes. */
export function geometryOf(mesh) {
  const whole = mesh.attributes.filter(({ has }) => !has);
  const first = Object.keys(NAMES).map((role) => whole.find((one) => one.role === role));
  const shown = first.filter((one) => one);
  const isSplit = shown.some(({ domain }) => domain !== "vertex");
  const order = trianglesByPart(mesh);
  const corners = order.flatMap((t) => [3 * t, 3 * t + 1, 3 * t + 2]);
  const geometry = new BufferGeometry();
  const vertices = isSplit ? corners.map((c) => mesh.triangles[c]) : null;
  geometry.setAttribute("position", attributeOf(mesh.positions, 3, vertices, false));
  for (const { role, domain, values, width } of shown) {
    const rowOf = {
      vertex: (c) => mesh.triangles[c],
      corner: (c) => mesh.triangleCorners[c],
      face: (c) => mesh.trianglePolygons[Math.floor(c / 3)],
    }[domain];
    const rows = isSplit ? corners.map(rowOf) : null;
    const isBytes = role === "colour" && /^Uint/.test(values.constructor.name);
    geometry.setAttribute(NAMES[role], attributeOf(values, width, rows, isBytes));
  }
  if (!isSplit) {
    const index = Uint32Array.from(corners, (c) => mesh.triangles[c]);
    geometry.setIndex(new BufferAttribute(index, 1));
  }
  addGroups(geometry, mesh, order);
  if (!geometry.getAttribute("normal")) geometry.computeVertexNormals();
  return geometry;
}

/** Return the numbers of some rows, all by default; doubles as floats, bytes as they are. */
function attributeOf(values, width, rows, isBytes) {
  const Numbers = isBytes ? values.constructor : Float32Array;
  if (!rows) return new BufferAttribute(Numbers.from(values, Number), width, isBytes);
  const taken = new Numbers(rows.length * width);
  rows.forEach((row, i) => {
    for (let k = 0; k < width; k++) taken[i * width + k] = Number(values[row * width + k]);
  });
  return new BufferAttribute(taken, width, isBytes);
}

/** Return the triangles, those of a part of the first kind one after the other. */
function trianglesByPart({ parts, trianglePolygons }) {
  const order = Array.from(trianglePolygons, (_, t) => t);
  if (!parts.length) return order;
  const { ofFace } = parts[0];
  return order.sort((a, b) => ofFace[trianglePolygons[a]] - ofFace[trianglePolygons[b]] || a - b);
}

function addGroups(geometry, { parts, trianglePolygons }, order) {
  if (!parts.length) return;
  const { ofFace } = parts[0];
  for (let begin = 0, end = 0; begin < order.length; begin = end) {
    const part = ofFace[trianglePolygons[order[begin]]];
    while (end < order.length && ofFace[trianglePolygons[order[end]]] === part) end++;
    geometry.addGroup(3 * begin, 3 * (end - begin), Math.max(part, 0));
  }
}
