// Programs of the graphics card, in GLSL ES 3.00.

const CORNER = `#version 300 es
precision highp float;
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;
layout(location = 2) in vec4 colour;
layout(location = 3) in vec2 field;
layout(location = 4) in uint edges;
uniform mat4 seen, whole;
`;

export const SURFACE = {
  vertex: `${CORNER}
out vec3 at, turned, sides;
out vec4 tint;
out vec2 number;
flat out uint real;
void main() {
  gl_Position = whole * vec4(position, 1.0);
  at = (seen * vec4(position, 1.0)).xyz;
  turned = mat3(seen) * normal.xyz;
  tint = colour;
  number = field;
  real = edges;
  int k = gl_VertexID % 3;
  sides = vec3(k == 0, k == 1, k == 2);
}`,
  fragment: `#version 300 es
precision highp float;
in vec3 at, turned, sides;
in vec4 tint;
in vec2 number;
flat in uint real;
uniform int mode;
uniform bool flatly;
uniform float wire;
uniform vec3 line;
uniform sampler2D palette;
out vec4 shown;
vec3 base() {
  if (mode == 1) {
    vec2 cell = floor(number * 16.0);
    float odd = mod(cell.x + cell.y, 2.0);
    return mix(vec3(0.92), vec3(0.25, 0.45, 0.7), odd);
  }
  if (mode == 2) return texture(palette, vec2(clamp(number.x, 0.0, 1.0) * 0.996 + 0.002, 0.5)).rgb;
  return tint.rgb;
}
void main() {
  vec3 facet = normalize(cross(dFdx(at), dFdy(at)));
  vec3 n = flatly || dot(turned, turned) < 1e-6 ? facet : normalize(turned);
  vec3 eye = normalize(-at);
  if (dot(n, eye) < 0.0) n = -n;
  vec3 lamp = normalize(vec3(-0.35, 0.5, 1.0));
  float diffuse = max(dot(n, lamp), 0.0);
  float shine = pow(max(dot(reflect(-lamp, n), eye), 0.0), 24.0);
  vec3 colour = base() * (0.32 + 0.72 * diffuse) + 0.06 * shine;
  if (!gl_FrontFacing) colour *= vec3(0.86, 0.8, 0.76);
  if (wire > 0.0) {
    vec3 change = max(fwidth(sides), vec3(1e-9));
    vec3 far = sides / change;
    // Where triangles are few pixels high, lines would cover them.
    float height = 1.0 / max(change.x, max(change.y, change.z));
    float strength = 0.85 * clamp(height / (9.0 * wire), 0.12, 1.0);
    float nearest = 1e9;
    if ((real & 1u) != 0u) nearest = min(nearest, far.x);
    if ((real & 2u) != 0u) nearest = min(nearest, far.y);
    if ((real & 4u) != 0u) nearest = min(nearest, far.z);
    float cover = 1.0 - smoothstep(wire * 0.5 - 0.5, wire * 0.5 + 0.5, nearest);
    colour = mix(colour, line, strength * cover);
  }
  shown = vec4(colour, 1.0);
}`,
};

export const PICK = {
  vertex: `${CORNER}
flat out uint triangle;
void main() {
  gl_Position = whole * vec4(position, 1.0);
  triangle = uint(gl_VertexID / 3) + 1u;
}`,
  fragment: `#version 300 es
precision highp float;
flat in uint triangle;
out vec4 shown;
void main() {
  uvec4 bytes = uvec4(triangle, triangle >> 8, triangle >> 16, triangle >> 24) & 255u;
  shown = vec4(bytes) / 255.0;
}`,
};

export const POINTS = {
  vertex: `#version 300 es
precision highp float;
layout(location = 0) in vec3 position;
uniform mat4 whole;
uniform float size;
void main() {
  gl_Position = whole * vec4(position, 1.0);
  gl_Position.z -= 4e-4 * gl_Position.w;
  gl_PointSize = size;
}`,
  fragment: `#version 300 es
precision highp float;
uniform vec3 line;
out vec4 shown;
void main() {
  float far = length(gl_PointCoord - 0.5);
  if (far > 0.5) discard;
  shown = vec4(far > 0.36 ? vec3(1.0) : line, 1.0);
}`,
};
