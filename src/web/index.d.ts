/** Base of everything that the decoder throws on purpose. */
export class DeltameshError extends Error {}

/** The bytes are not a valid `.dmesh` file. */
export class FormatError extends DeltameshError {
  /** What is wrong. */
  readonly reason: string;
  /** Where, in bytes from the start of the file, as far as it is known. */
  readonly offset: number | null;
}

/** Decoding would need more than the limits allow. */
export class LimitError extends DeltameshError {}

/** The least-squares system could not be factored or solved. */
export class SolveError extends DeltameshError {}

export type Numbers =
  | Uint8Array
  | Uint16Array
  | Uint32Array
  | BigUint64Array
  | Int8Array
  | Int16Array
  | Int32Array
  | BigInt64Array
  | Float32Array
  | Float64Array;

export interface Attribute {
  name: string;
  /** What its rows belong to: vertices, corners of polygons, or polygons. */
  domain: "vertex" | "corner" | "face";
  role: "normal" | "uv" | "colour" | "other";
  /** Type in the file; `float16` comes as Float32Array, complex numbers as pairs. */
  type: string;
  normalized: boolean;
  /** The largest error of a number of it; of unit normals, the largest angle in degrees. */
  error: number;
  /** Numbers a row. */
  width: number;
  values: Numbers;
  /** 1 for each element that has a value, null if all have one. */
  has: Uint8Array | null;
}

export interface Parts {
  kind: "object" | "mesh" | "group" | "material" | "smoothing";
  names: string[];
  /** The part of each polygon, -1 for none. */
  ofFace: Int32Array;
  /** Matrices of 16 numbers, row by row, or null. */
  transforms: Float64Array | null;
}

export interface Mesh {
  /** Three numbers a vertex. */
  positions: Float64Array;
  /** The vertices of the polygons, one polygon after the other. */
  corners: Int32Array;
  /** Where each polygon begins in `corners`, and the end of the last. */
  offsets: Int32Array;
  /** The vertices of the triangles of the polygons, three each. */
  triangles: Int32Array;
  /** Their places in `corners`. */
  triangleCorners: Int32Array;
  /** The polygon of each triangle. */
  trianglePolygons: Int32Array;
  /** The vertices whose positions are stored. */
  anchors: Int32Array;
  attributes: Attribute[];
  parts: Parts[];
  metadata: Map<string, string[]>;
  /** What of the source is not in the file. */
  lost: string[];
  /** Type of the positions in the source. */
  precision: "float32" | "float64";
}

export interface Limits {
  maxVertices?: number;
  /** Bytes that decoding may take. */
  memory?: number;
}

export interface Options extends Limits {
  /** Name of a pose of the mesh; at rest without one. */
  pose?: string | null;
  /** Number of a frame of a sequence, from 0. It is decoded from the key frame before it on. */
  frame?: number;
}

export interface About {
  version: number;
  vertices: number;
  triangles: number;
  /** Bytes of the file. */
  size: number;
  parameters: { method: string; step: number; anchorCount: number; [name: string]: unknown };
  /** Errors that the encoder measured, its name, and its source; null if the file has none. */
  meta: { [name: string]: number | string } | null;
  sections: { id: string; bytes: number }[];
  /** Number of the frames of a sequence; 1 for one mesh. */
  frames: number;
  /** Frames a second, as far as that is known. */
  fps: number | null;
  attributes: { name: string; domain: string; type: string; width: number }[];
  parts: { kind: string; names: string[] }[];
  metadata: Map<string, string[]>;
  lost: string[];
  poses: { name: string; step: number; bytes: number }[];
}

/** The bytes of a file. */
export type Bytes = Uint8Array | ArrayBuffer;

export type Wasm = BufferSource | Response | WebAssembly.Module;

export interface Decoder {
  decode(bytes: Bytes, options?: Options): Mesh;
  /** The meshes of a sequence, one after the other; they share all arrays that are alike. */
  frames(bytes: Bytes, limits?: Limits): Generator<Mesh, void>;
  inspect(bytes: Bytes): About;
}

export interface WorkerDecoder {
  /** The next frame of a sequence costs no more than that, as long as few others are decoded. */
  decode(bytes: Bytes, options?: Options): Promise<{ mesh: Mesh; about: About }>;
  close(): void;
}

export function inspect(bytes: Bytes): About;
export function createDecoder(options?: { wasm?: Wasm | Promise<Wasm> }): Promise<Decoder>;
export function createWorkerDecoder(options?: {
  wasm?: Wasm | Promise<Wasm>;
  worker?: Worker;
}): Promise<WorkerDecoder>;
