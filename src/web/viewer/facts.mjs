// Numbers of a file, as rows of tables.
import { titleOfKind } from "./parts.mjs";

/** Return a number in a few digits. */
export function short(number) {
  if (Number.isInteger(number)) return number.toLocaleString("en");
  const size = Math.abs(number);
  if (size >= 1e5 || size < 1e-3) return number.toExponential(2).replace("e-", "e−");
  return String(Number(number.toPrecision(4)));
}

/** Return [name, value] of a file that was decoded, or of a mesh from another file. */
export function factsOf({ mesh, about, size }) {
  const vertices = mesh.positions.length / 3;
  const rows = [
    ["vertices", short(vertices)],
    ["faces", short(mesh.offsets.length - 1)],
    ["triangles", short(mesh.triangles.length / 3)],
    ["file", `${short(size)} bytes`],
  ];
  // A mesh of another file is in the page as one of ours, of which there is nothing to say.
  if (about?.size === size) {
    rows.push(["bits per vertex", short((8 * size) / vertices)], ...codingFacts(about));
  }
  if (about?.frames > 1) rows.push(["frames", short(about.frames)]);
  if (about?.poses?.length) rows.push(["poses", about.poses.map(({ name }) => name).join(", ")]);
  const names = mesh.attributes.map(({ name, domain, type, width }) => `${name} (${domain}, ${width} × ${type})`);
  if (names.length) rows.push(["attributes", names.join(", ")]);
  for (const { kind, names: parts } of mesh.parts) rows.push([titleOfKind(kind), short(parts.length)]);
  for (const [key, lines] of mesh.metadata) rows.push([key, lines.join("\n")]);
  if (mesh.lost.length) rows.push(["not kept", mesh.lost.join(", ")]);
  return rows;
}

function codingFacts({ parameters, meta, sections }) {
  const rows = [["method", parameters.method]];
  if (parameters.step) rows.push(["step", short(parameters.step)]);
  if (parameters.anchorCount) rows.push(["anchors", short(parameters.anchorCount)]);
  if (meta) {
    rows.push(
      ["RMS error", `${short(meta.rms / (meta.diagonal || 1))} of the diagonal`],
      ["largest error", `${short(meta.max / (meta.diagonal || 1))} of the diagonal`],
      ["normals", `${short(meta.normal)}°`],
      ["dihedral angles", `${short(meta.dihedral)}°`],
    );
    if (meta.parts > 1) rows.push(["worst part", `${meta.part || "–"}: ${short(meta.part_normal)}°`]);
    rows.push(["encoder", meta.encoder]);
  }
  const sizes = sections.map(({ id, bytes }) => `${id} ${short(bytes)}`);
  rows.push(["sections", sizes.join(", ")]);
  return rows;
}

/** Return a table of rows. */
export function tableOf(rows, caption) {
  const table = document.createElement("table");
  if (caption) table.createCaption().textContent = caption;
  for (const [name, ...values] of rows) {
    const row = table.insertRow();
    const head = document.createElement("th");
    head.scope = "row";
    head.textContent = name;
    row.append(head);
    for (const value of values) row.insertCell().textContent = value;
  }
  return table;
}
