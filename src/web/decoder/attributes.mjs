// Section ATTR: attributes of vertices, corners and faces (SPEC.md 5.14).
import { numberSize, readAttributeTable } from "./attribute_table.mjs";
import { fromCodes, checkCodes } from "./codings.mjs";
import { FormatError, located } from "./errors.mjs";
import { decodeNumbers, readFormats } from "./exact.mjs";
import { alone, among, elementsOf, graphOf, graphOfFaces, lowAndHigh, endsOf, withoutParallelograms } from "./graph.mjs"; // prettier-ignore
import { halfBits } from "./halves.mjs";
import { counted, largest, sorted } from "./integers.mjs";
import { decodeLabels, decodeThree, joined } from "./labels.mjs";
import { OWN_WEDGES, POLYGON_OWNERS, POSITION_LARGEST, WEDGES_OF } from "./layout.mjs";
import { decodeNormals, normalVectors } from "./octahedral.mjs";
import { polygonOfCorners } from "./outlines.mjs";
import { codeWedges } from "./wedges.mjs";

/** Return the vertices, corners and polygons of a structure, as attributes see them. */
export function domainsOf(structure) {
  const { faces, polygons } = structure;
  const memory = {};
  return {
    structure,
    polygons,
    polygonOfCorners: polygonOfCorners(polygons.offsets),
    vertexOfCorners: polygons.corners.map((c) => faces[c]),
    get faces() {
      memory.faces ??= polygonElements(structure);
      return memory.faces;
    },
  };
}

/** Return polygons as elements; two with an edge in common are neighbours. */
function polygonElements({ faces, points, polygons: { offsets, ofCorners } }) {
  const of = polygonOfCorners(offsets);
  const start = faces.map((v) => points[v]);
  const [low, high] = lowAndHigh(start, endsOf(start));
  const n = largest(start) + 1;
  // However many faces there are on an edge, each is linked to the next.
  const order = sorted(start.length, [low, n], [high, n]);
  const a = [];
  const b = [];
  for (let i = 0; i + 1 < order.length; i++) {
    const [g, h] = [order[i], order[i + 1]];
    if (low[g] !== low[h] || high[g] !== high[h] || low[g] === high[g]) continue;
    a.push(of[ofCorners[g]]);
    b.push(of[ofCorners[h]]);
  }
  return withoutParallelograms(graphOf(a, b, offsets.length - 1));
}

/** Return the attributes of a payload: owners, labels of rows, and codes, as they are digested. */
export function decodeAttributes(core, payload, domains) {
  let [entries, at] = readAttributeTable(payload);
  const found = [];
  for (const entry of entries) {
    let position = at;
    const streams = entry.sizes.map((size) => {
      const stream = [position, payload.subarray(position, position + size)];
      position += size;
      return stream;
    });
    const earlier = found.map((one) => (one.entry.wedges === OWN_WEDGES ? one.owners.wedges : null));
    const owners = decodeOwners(core, entry, streams, domains, earlier);
    if (entry.coding === "octahedral") {
      const [begin, stream] = streams[0];
      const normals = decodeNormals(core, stream, begin, entry.bits, owners.elements);
      const labels = counted(owners.has.length).filter((i) => owners.has[i]);
      found.push({ entry, owners, labels, codes: normals.codes, weights: normals.weights });
    } else {
      found.push({ entry, owners, ...decodeRows(core, streams, entry, owners, at) });
    }
    at += entry.size;
  }
  return found;
}

/** Return the owners of values; their streams, the first ones, are taken off the list. */
function decodeOwners(core, entry, streams, domains, earlier) {
  const start = streams[0]?.[0] ?? 0;
  const owners = ownersOf(core, entry, streams, domains, earlier);
  const has = new Int32Array(owners.elements.count).fill(1);
  if (entry.partly) {
    const [begin, stream] = streams.shift();
    const labels = located(begin, "", () => decodeLabels(core, stream, owners.elements));
    if (largest(labels) > 1) throw new FormatError("presence label above 1", start);
    labels.forEach((label, i) => (has[i] = Number((label === 1) === entry.firstNone)));
  }
  return { ...owners, has };
}

function ownersOf(core, entry, streams, domains, earlier) {
  const { structure, polygons } = domains;
  if (entry.domain === "corner" && entry.wedges !== POLYGON_OWNERS) {
    const isOwn = entry.wedges === OWN_WEDGES;
    const wedges = isOwn
      ? ownWedges(core, streams.shift(), domains)
      : earlier[entry.wedges - WEDGES_OF];
    const elements = elementsOf(graphOfFaces(wedges, largest(wedges) + 1), wedges);
    return { wedges, elements, ofElements: polygons.corners.map((c) => wedges[c]) };
  }
  const elements = entry.domain === "vertex" ? structure.vertices : domains.faces;
  const isCorner = entry.domain === "corner";
  const ofElements = isCorner ? domains.polygonOfCorners : counted(elements.count);
  return { wedges: null, elements, ofElements };
}

function ownWedges(core, [begin, stream], { structure, polygons: { corners, ofCorners } }) {
  const run = (coder) => codeWedges(core, coder, structure.complex.corners);
  const wedges = core.decode(core.model("wedges"), stream, run, begin);
  if (wedges.some((wedge, c) => wedges[corners[ofCorners[c]]] !== wedge)) {
    throw new FormatError("corner of a polygon in two wedges", begin);
  }
  return wedges;
}

/** Return the row of each owner that has a value, and the codes of the rows. */
function decodeRows(core, streams, entry, owners, at) {
  const near = among(owners.elements, owners.has);
  let labels = counted(near.count);
  let elements = near;
  if (entry.palette !== null) {
    const [begin, stream] = streams.shift();
    labels = located(begin, "", () => decodeLabels(core, stream, near));
    const found = largest(labels) + 1;
    if (found !== entry.palette) {
      throw new FormatError(`palette of ${entry.palette} rows, of which ${found} are used`, at);
    }
    elements = alone(entry.palette);
  }
  const isExact = entry.coding === "exact";
  const size = numberSize(entry.type);
  const threes = streams.map(([begin, stream]) =>
    isExact
      ? located(begin, "", () => exactBits(core, stream, elements, size))
      : decodeThree(core, stream, elements, begin),
  );
  const last = streams.length ? streams.at(-1)[0] : 0;
  const codes = joined(threes, last, elements.count, entry.columns);
  if (entry.mixed) unmix(codes, entry.columns);
  located(at, "", () => checkCodes(entry, codes));
  return { labels, codes };
}

function unmix(codes, width) {
  for (let i = 0; i < codes.length; i += width) {
    codes[i] += codes[i + 1];
    codes[i + 2] += codes[i + 1];
  }
}

/** Return the bit patterns of three columns of floats of so many bytes. */
function exactBits(core, payload, elements, size) {
  const [width, columns, at] = readFormats(payload);
  if (size < 8 && width === 64) {
    throw new FormatError(`${width}-bit numbers in an attribute of ${8 * size} bits`, 0);
  }
  const { values, indices, isRaw } = decodeNumbers(core, payload, at, elements, width, columns);
  const refuseValue = () => {
    throw new FormatError(`value not representable in ${8 * size} bits`, at);
  };
  const bits = new BigInt64Array(values.length);
  const view = new DataView(new ArrayBuffer(8));
  values.forEach((value, i) => {
    if (isRaw[i]) return;
    if (!(Math.abs(value) <= POSITION_LARGEST)) refuseValue();
    if (size === 8) {
      view.setFloat64(0, value);
      bits[i] = view.getBigInt64(0);
    } else if (size === 4) {
      if (Math.fround(value) !== value) refuseValue();
      view.setFloat32(0, value);
      bits[i] = BigInt(view.getUint32(0));
    } else {
      const half = halfBits(value);
      if (half === null) refuseValue();
      bits[i] = BigInt(half);
    }
  });
  isRaw.forEach((raw, i) => {
    if (!raw) return;
    if (size === 8 && width === 32) bits[i] = widenedBits(Number(indices[i] & 0xffffffffn));
    else if (size < 8 && BigInt.asUintN(8 * size, indices[i]) !== indices[i]) {
      throw new FormatError(`raw value exceeds ${8 * size} bits`, at);
    } else bits[i] = indices[i];
  });
  return bits;
}

/** Return the bits of the binary64 number that a binary32 one is, NaNs with their payloads. */
function widenedBits(bits) {
  const view = new DataView(new ArrayBuffer(8));
  const fraction = bits & 0x7fffff;
  if ((bits & 0x7f800000) === 0x7f800000 && fraction) {
    // A signalling NaN becomes a quiet one, as conversions make it.
    const high = (BigInt(bits >>> 31) << 63n) | (0x7ffn << 52n);
    return BigInt.asIntN(64, high | (BigInt(fraction | 0x400000) << 29n));
  }
  view.setUint32(0, bits);
  view.setFloat64(0, view.getFloat32(0));
  return view.getBigInt64(0);
}

/**
 * Return an attribute as users know it.
 *
 * `values` has a row of `width` numbers (two each of complex ones) for each element of the domain;
 * `has` is 0 where there is none, null if all have one.
 */
export function restored({ entry, owners, labels, codes, weights }, domains, positions) {
  const rows = new Int32Array(owners.has.length).fill(-1);
  for (let i = 0, next = 0; i < rows.length; i++) if (owners.has[i]) rows[i] = labels[next++];
  const isNormal = entry.coding === "octahedral";
  const table = isNormal
    ? normalVectors(codes, entry, weights, owners, domains, positions)
    : fromCodes(entry, codes);
  const width = entry.columns / entry.limbs;
  const values = new table.constructor(owners.ofElements.length * width);
  const has = new Uint8Array(owners.ofElements.length);
  owners.ofElements.forEach((owner, i) => {
    const row = rows[owner];
    if (row < 0) return;
    has[i] = 1;
    for (let k = 0; k < width; k++) values[i * width + k] = table[row * width + k];
  });
  const { name, domain, role, type, normalized, error } = entry;
  const some = has.includes(0) ? has : null;
  return { name, domain, role, type, normalized, error, width: entry.width, values, has: some };
}
