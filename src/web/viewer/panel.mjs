// Panel: a mesh, what is drawn of it, and how it is coloured.
import { colourBytes, partColour, SCALES } from "./colours.mjs";
import { FIELDS, fieldOf } from "./fields.mjs";
import { boxOf, cornerValues, modelOf, shownCorners } from "./model.mjs";
import { nameOf, titleOfKind } from "./parts.mjs";
import { MODES } from "./renderer.mjs";

const PLAIN = [196, 202, 208];

/**
 * A mesh with its file's name and size, and what the file says, null for other files; `held` are the
 * bytes of a file that has poses or frames.
 */
export class Panel {
  constructor({ name, role, mesh, about, size, held = null }) {
    Object.assign(this, { name, role, mesh, about, size, held, pose: "", frame: 0 });
    this.box = boxOf(mesh.positions);
    this.fields = new Map();
    this.buffers = null;
  }

  /** Hand the mesh to a renderer, in the frame of a box. */
  upload(renderer, box) {
    if (this.buffers) renderer.forget(this.buffers);
    this.around = box;
    this.model = modelOf(this.mesh, box);
    const anchors = new Float32Array(3 * this.mesh.anchors.length);
    this.mesh.anchors.forEach((v, i) => {
      for (let a = 0; a < 3; a++) {
        anchors[3 * i + a] = (this.mesh.positions[3 * v + a] - box.middle[a]) / box.size;
      }
    });
    this.buffers = renderer.upload(this.model, anchors);
  }

  /** The names of the poses of the file. */
  get poses() {
    return (this.about?.poses ?? []).map(({ name }) => name);
  }

  /** The number of frames of the file. */
  get frames() {
    return this.about?.frames ?? 1;
  }

  /** Take the mesh in another pose, "" for none, or in another frame. */
  change(mesh, pose, frame, renderer, hidden) {
    const { triangles, triangleCorners, trianglePolygons } = this.mesh;
    Object.assign(this, { mesh, pose, frame });
    Object.assign(mesh, { triangles, triangleCorners, trianglePolygons });
    this.fields.clear();
    if (!renderer) return;
    this.upload(renderer, this.around);
    this.hide(renderer, hidden);
  }

  /** Draw only polygons that are in no hidden part; `hidden` has names by kinds. */
  hide(renderer, hidden) {
    const filters = this.mesh.parts
      .filter(({ kind }) => hidden.get(kind)?.size)
      .map(({ kind, names, ofFace }) => (p) => !hidden.get(kind).has(nameOf(names, ofFace[p])));
    const isShown = (p) => filters.every((filter) => filter(p));
    renderer.show(this.buffers, shownCorners(this.mesh, isShown));
  }

  /** Return the ways to colour it: [key, title]. */
  colourings() {
    const { attributes, parts } = this.mesh;
    const of = (role) => attributes.filter((one) => one.role === role);
    return [
      ...of("colour").map(({ name }) => [`colour:${name}`, `colours: ${name}`]),
      ...of("uv").map(({ name }) => [`uv:${name}`, `checker: ${name}`]),
      ...parts.map(({ kind }) => [`part:${kind}`, titleOfKind(kind)]),
    ];
  }

  /** Return how it is coloured by itself: by the colours of the mesh, if it has any. */
  ownColouring() {
    return this.colourings().find(([key]) => key.startsWith("colour:"))?.[0] ?? "plain";
  }

  /** Colour it by a key; `original` is what errors are measured against, `most` their largest. */
  paint(renderer, key, original, most) {
    const [kind, name] = [key.split(":")[0], key.slice(key.indexOf(":") + 1)];
    const paint = (what) => renderer.paint(this.buffers, what);
    const find = (role) => this.mesh.attributes.find((a) => a.role === role && a.name === name);
    const count = this.mesh.triangles.length;
    const field = FIELDS[key] && this.field(key, original);
    if (field) {
      const { signed } = FIELDS[key];
      const numbers = new Float32Array(2 * count);
      field.forEach((x, c) => (numbers[2 * c] = signed ? 0.5 + x / most / 2 : x / most));
      const palette = signed ? SCALES.around : SCALES.rising;
      paint({ mode: MODES.field, field: numbers, palette });
    } else if (kind === "uv" && find("uv")) {
      const values = cornerValues(this.mesh, find("uv"));
      const width = values.length / count;
      const numbers = new Float32Array(2 * count);
      for (let c = 0; c < count; c++) {
        numbers[2 * c] = values[width * c];
        numbers[2 * c + 1] = width > 1 ? values[width * c + 1] : 0;
      }
      paint({ mode: MODES.checker, field: numbers });
    } else if (kind === "colour" && find("colour")) {
      const values = cornerValues(this.mesh, find("colour"));
      const colours = colourBytes(values, values.length / count, find("colour"));
      paint({ mode: MODES.colour, colours });
    } else {
      const parts = kind === "part" && this.mesh.parts.find((one) => one.kind === name);
      const colours = new Uint8Array(4 * count);
      const polygons = this.mesh.trianglePolygons;
      for (let c = 0; c < count; c++) {
        const rgb = parts ? partColour(parts.ofFace[polygons[Math.floor(c / 3)]]) : PLAIN;
        colours.set([...rgb, 255], 4 * c);
      }
      paint({ mode: MODES.colour, colours });
    }
  }

  /** Return an error at the corners; null where there is none, as of the original itself. */
  field(key, original) {
    if (!original || original === this) return null;
    if (!this.fields.has(key) || this.against !== original) {
      if (this.against !== original) this.fields.clear();
      this.against = original;
      const { diagonal } = original.box;
      this.fields.set(key, fieldOf(key, this.mesh, original.mesh, diagonal || 1));
    }
    return this.fields.get(key);
  }
}
