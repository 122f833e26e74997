/* SPDX-License-Identifier: GPL-3.0-or-later */
// Programs of the graphics card: surfaces, streamlines as strips, particles as balls, and thin lines.
const CAMERA = `
uniform mat3 turn;
uniform vec3 middle;
uniform vec2 shift;
uniform float reach, zoom, aspect;
vec4 seen(vec3 eye) { return vec4((eye.xy * zoom + shift) * vec2(1.0 / aspect, 1.0), -0.5 * eye.z, 1.0); }
`;
const CUT = `
uniform vec4 plane;
uniform bool cutting;
bool away(vec3 at) { return cutting && dot(plane.xyz, at) > plane.w; }
`;
const RAMP = `
uniform vec3 ramp[16];
vec3 colored(float share) {
  float place = clamp(share, 0.0, 1.0) * 15.0;
  int k = min(int(place), 14);
  return mix(ramp[k], ramp[k + 1], place - float(k));
}
`;
const VERTEX = `#version 300 es
in vec3 place;
in uint sides, number;
in float value;
${CAMERA}
out vec3 at, eye, corner;
out float share;
flat out vec3 drawn;
flat out uint owner;
void main() {
  at = place;
  eye = turn * (at - middle) / reach;
  gl_Position = seen(eye);
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
  // a side is where the corner opposite to it has no weight
  drawn = vec3((sides >> 1) & 1u, (sides >> 2) & 1u, sides & 1u);
  owner = number;
  share = value;
}`;
const FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
in vec3 at, eye, corner;
in float share;
flat in vec3 drawn;
flat in uint owner;
uniform vec3 colors[12];
uniform vec4 color;
uniform vec3 ink;
uniform bool byNumber, byField, lines, picking, lit;
uniform int layer, solid;
${CUT}
${RAMP}
out vec4 pixel;
void main() {
  if (away(at)) discard;
  if (picking) {
    uint n = owner + 1u;
    pixel = vec4(float(n & 255u), float((n >> 8) & 255u), float((n >> 16) & 255u), float(layer)) / 255.0;
    return;
  }
  vec3 normal = normalize(cross(dFdx(eye), dFdy(eye)));
  vec3 base = byField ? colored(share) : byNumber ? colors[owner % 12u] : color.rgb;
  // the inside of something solid, seen where it is cut: one even color
  bool inside = solid != 0 && gl_FrontFacing != (solid > 0);
  vec3 shown = !lit ? base : inside ? 0.72 * base : base * (0.45 + 0.6 * abs(normal.z));
  if (lines && !inside) {
    vec3 pixels = fwidth(corner), far = smoothstep(vec3(0.0), 1.3 * pixels, corner);
    far = mix(vec3(1.0), far, drawn);
    // where a triangle is a few pixels high its lines would hide it
    float plain = smoothstep(0.15, 0.7, max(pixels.x, max(pixels.y, pixels.z)));
    shown = mix(ink, shown, mix(0.35 + 0.65 * min(far.x, min(far.y, far.z)), 1.0, plain));
  }
  pixel = vec4(shown, color.a);
}`;
// a piece of a streamline as a strip that faces the reader, rounded by its shading
const STREAM_VERTEX = `#version 300 es
in vec3 start, end;
in float startValue, endValue;
uniform float width;
${CAMERA}
out vec3 at;
out float share, across;
void main() {
  vec3 a = turn * (start - middle) / reach, b = turn * (end - middle) / reach;
  vec2 along = b.xy - a.xy;
  vec2 right = length(along) > 0.0 ? normalize(vec2(-along.y, along.x)) : vec2(1.0, 0.0);
  bool last = gl_VertexID == 2 || gl_VertexID == 4 || gl_VertexID == 5;
  across = (gl_VertexID == 0 || gl_VertexID == 2 || gl_VertexID == 4) ? 1.0 : -1.0;
  vec3 eye = last ? b : a;
  eye.xy += across * width * right;
  at = last ? end : start;
  share = last ? endValue : startValue;
  gl_Position = seen(eye);
}`;
const STREAM_FRAGMENT = `#version 300 es
precision highp float;
in vec3 at;
in float share, across;
${CUT}
${RAMP}
out vec4 pixel;
void main() {
  if (away(at)) discard;
  pixel = vec4(colored(share) * (0.55 + 0.5 * sqrt(1.0 - across * across)), 1.0);
}`;
const BALL_VERTEX = `#version 300 es
in vec3 place;
uniform float radius, least;
${CAMERA}
out vec3 at;
out vec2 from;
void main() {
  int k = gl_VertexID;
  from = vec2(k == 1 || k == 2 || k == 4 ? 1.0 : -1.0, k == 2 || k == 4 || k == 5 ? 1.0 : -1.0);
  at = place;
  vec3 eye = turn * (place - middle) / reach;
  float size = max(radius / reach, least / zoom);
  eye += vec3(from * size, 0.8 * size);
  gl_Position = seen(eye);
}`;
const BALL_FRAGMENT = `#version 300 es
precision highp float;
in vec3 at;
in vec2 from;
uniform vec4 color;
${CUT}
out vec4 pixel;
void main() {
  float r = dot(from, from);
  if (r > 1.0 || away(at)) discard;
  pixel = vec4(color.rgb * (0.5 + 0.5 * sqrt(1.0 - r)), 1.0);
}`;
const LINE_VERTEX = `#version 300 es
in vec3 place;
${CAMERA}
void main() { gl_Position = seen(turn * (place - middle) / reach); }`;
const LINE_FRAGMENT = `#version 300 es
precision highp float;
uniform vec3 ink;
out vec4 pixel;
void main() { pixel = vec4(ink, 1.0); }`;
