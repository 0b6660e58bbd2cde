// Renderer of models by WebGL2: views side by side on one canvas.
import { PICK, POINTS, SURFACE } from "./shaders.mjs";

const ANCHOR_COLOUR = [0.85, 0.1, 0.35];
const ANCHOR_SIZE = 9;

/** How numbers at corners become colours. */
export const MODES = { colour: 0, checker: 1, field: 2 };

/** Renderer on a canvas; throws an Error where there is no WebGL2. */
export class Renderer {
  constructor(canvas) {
    const wanted = { antialias: true, preserveDrawingBuffer: true };
    const gl = canvas.getContext("webgl2", wanted);
    if (!gl) throw new Error("this browser has no WebGL2");
    Object.assign(this, { canvas, gl });
    this.surface = programOf(gl, SURFACE);
    this.pick = programOf(gl, PICK);
    this.points = programOf(gl, POINTS);
    this.target = targetOf(gl);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.SCISSOR_TEST);
  }

  /** Return the buffers of a model. */
  upload({ corners, normals, edges }, anchors) {
    const { gl } = this;
    const count = corners.length / 3;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    attach(gl, 0, corners, 3, gl.FLOAT);
    attach(gl, 1, normals, 4, gl.BYTE, true);
    const colour = attach(gl, 2, new Uint8Array(4 * count).fill(200), 4, gl.UNSIGNED_BYTE, true);
    const field = attach(gl, 3, new Float32Array(2 * count), 2, gl.FLOAT);
    attach(gl, 4, edges, 1, gl.UNSIGNED_BYTE);
    const index = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, index);
    const dots = gl.createVertexArray();
    gl.bindVertexArray(dots);
    attach(gl, 0, anchors, 3, gl.FLOAT);
    gl.bindVertexArray(null);
    const palette = gl.createTexture();
    const made = { array, colour, field, index, dots, palette, anchors: anchors.length / 3 };
    return { ...made, shown: 0, mode: MODES.colour };
  }

  /** Give the memory of a model back. */
  forget({ array, colour, field, index, dots, palette }) {
    const { gl } = this;
    [array, dots].forEach((one) => gl.deleteVertexArray(one));
    [colour, field, index].forEach((one) => gl.deleteBuffer(one));
    gl.deleteTexture(palette);
  }

  /** Set the corners that are drawn. */
  show(buffers, indices) {
    const { gl } = this;
    gl.bindVertexArray(buffers.array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers.index);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    buffers.shown = indices.length;
  }

  /** Set how corners are coloured: `colours`, four bytes each, or `field`, two numbers each. */
  paint(buffers, { mode, colours, field, palette }) {
    const { gl } = this;
    buffers.mode = mode;
    const replace = (buffer, data) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    };
    if (colours) replace(buffers.colour, colours);
    if (field) replace(buffers.field, field);
    if (palette) {
      gl.bindTexture(gl.TEXTURE_2D, buffers.palette);
      const size = [palette.length / 4, 1, 0];
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, ...size, gl.RGBA, gl.UNSIGNED_BYTE, palette);
      for (const name of ["MIN_FILTER", "MAG_FILTER"]) {
        gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.LINEAR);
      }
      for (const name of ["WRAP_S", "WRAP_T"]) {
        gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.CLAMP_TO_EDGE);
      }
    }
  }

  /** Fill the canvas with a colour. */
  clear([r, g, b]) {
    const { gl, canvas } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.scissor(0, 0, canvas.width, canvas.height);
    gl.clearColor(r, g, b, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  /** Draw a model into a rectangle of the canvas, in pixels from the lower left. */
  draw(buffers, [x, y, width, height], { seen, whole }, look) {
    const { gl } = this;
    gl.viewport(x, y, width, height);
    gl.scissor(x, y, width, height);
    const { program, at } = this.surface;
    gl.useProgram(program);
    gl.uniformMatrix4fv(at("seen"), false, seen);
    gl.uniformMatrix4fv(at("whole"), false, whole);
    gl.uniform1i(at("mode"), buffers.mode);
    gl.uniform1i(at("flatly"), Number(look.flat));
    gl.uniform1f(at("wire"), look.wire ? 1.2 * look.ratio : 0);
    gl.uniform3fv(at("line"), look.line);
    gl.bindTexture(gl.TEXTURE_2D, buffers.palette);
    gl.bindVertexArray(buffers.array);
    gl.drawElements(gl.TRIANGLES, buffers.shown, gl.UNSIGNED_INT, 0);
    if (look.anchors && buffers.anchors) {
      gl.useProgram(this.points.program);
      gl.uniformMatrix4fv(this.points.at("whole"), false, whole);
      gl.uniform1f(this.points.at("size"), ANCHOR_SIZE * look.ratio);
      gl.uniform3fv(this.points.at("line"), ANCHOR_COLOUR);
      gl.bindVertexArray(buffers.dots);
      gl.drawArrays(gl.POINTS, 0, buffers.anchors);
    }
    gl.bindVertexArray(null);
  }

  /** Return the triangle of a model that is seen at a pixel, -1 for none. */
  pickAt(buffers, [x, y, width, height], { whole }, px, py) {
    const { gl, target } = this;
    target.resize(width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target.frame);
    gl.viewport(0, 0, width, height);
    gl.scissor(px - x, py - y, 1, 1);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.pick.program);
    gl.uniformMatrix4fv(this.pick.at("whole"), false, whole);
    gl.bindVertexArray(buffers.array);
    gl.drawElements(gl.TRIANGLES, buffers.shown, gl.UNSIGNED_INT, 0);
    gl.bindVertexArray(null);
    const pixel = new Uint8Array(4);
    gl.readPixels(px - x, py - y, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return new DataView(pixel.buffer).getInt32(0, true) - 1;
  }
}

function programOf(gl, { vertex, fragment }) {
  const program = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) {
      throw new Error(gl.getShaderInfoLog(shader));
    }
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    throw new Error(gl.getProgramInfoLog(program));
  }
  const places = new Map();
  const at = (name) => {
    if (!places.has(name)) places.set(name, gl.getUniformLocation(program, name));
    return places.get(name);
  };
  return { program, at };
}

function attach(gl, location, data, size, type, normalized = false) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
  gl.enableVertexAttribArray(location);
  const isInteger = type === gl.UNSIGNED_BYTE && !normalized;
  if (isInteger) gl.vertexAttribIPointer(location, size, type, 0, 0);
  else gl.vertexAttribPointer(location, size, type, normalized, 0, 0);
  return buffer;
}

/** Return a target to draw into, unseen. */
function targetOf(gl) {
  const frame = gl.createFramebuffer();
  const [colour, depth] = [gl.createRenderbuffer(), gl.createRenderbuffer()];
  let size = "";
  const resize = (width, height) => {
    if (size === `${width} ${height}`) return;
    size = `${width} ${height}`;
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    for (const [buffer, format, place] of [
      [colour, gl.RGBA8, gl.COLOR_ATTACHMENT0],
      [depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT],
    ]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  };
  return { frame, resize };
}
