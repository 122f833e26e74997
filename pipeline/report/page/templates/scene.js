/* SPDX-License-Identifier: GPL-3.0-or-later */
"use strict";
// A small viewer: WebGL 2, parallel projection, no library and no request. The model is JSON in the page itself.
const model = JSON.parse(document.getElementById("model").textContent);
const canvas = document.getElementById("view");
const gl = canvas.getContext("webgl2", { alpha: false, antialias: true, preserveDrawingBuffer: true });
const told = document.getElementById("told");

const VERTEX = `#version 300 es
in uvec4 place;
in uint number;
uniform mat3 turn;
uniform vec3 middle;
uniform vec2 shift;
uniform float reach, zoom, aspect;
out vec3 at, eye, corner;
flat out vec3 drawn;
flat out uint owner;
void main() {
  at = vec3(place.xyz);
  eye = turn * (at - middle) / reach;
  gl_Position = vec4((eye.xy * zoom + shift) * vec2(1.0 / aspect, 1.0), -0.5 * eye.z, 1.0);
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
  // a side is where the corner opposite to it has no weight
  drawn = vec3((place.w >> 1) & 1u, (place.w >> 2) & 1u, place.w & 1u);
  owner = number;
}`;
const FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
in vec3 at, eye, corner;
flat in vec3 drawn;
flat in uint owner;
uniform vec3 colors[12];
uniform vec4 color;
uniform vec3 ink;
uniform bool byNumber, lines, picking;
uniform int axis, layer;
uniform float cut;
out vec4 pixel;
void main() {
  if (at[axis] > cut) discard;
  if (picking) {
    uint n = owner + 1u;
    pixel = vec4(float(n & 255u), float((n >> 8) & 255u), float((n >> 16) & 255u), float(layer)) / 255.0;
    return;
  }
  vec3 normal = normalize(cross(dFdx(eye), dFdy(eye)));
  vec3 base = byNumber ? colors[owner % 12u] : color.rgb;
  vec3 lit = base * (0.45 + 0.6 * abs(normal.z));
  if (lines) {
    vec3 far = smoothstep(vec3(0.0), 1.3 * fwidth(corner), corner);
    far = mix(vec3(1.0), far, drawn);
    lit = mix(ink, lit, 0.35 + 0.65 * min(far.x, min(far.y, far.z)));
  }
  pixel = vec4(lit, color.a);
}`;
const LINE_VERTEX = `#version 300 es
in vec3 place;
uniform mat3 turn;
uniform vec3 middle;
uniform vec2 shift;
uniform float reach, zoom, aspect;
void main() {
  vec3 eye = turn * (place - middle) / reach;
  gl_Position = vec4((eye.xy * zoom + shift) * vec2(1.0 / aspect, 1.0), -0.5 * eye.z, 1.0);
}`;
const LINE_FRAGMENT = `#version 300 es
precision highp float;
uniform vec3 ink;
out vec4 pixel;
void main() { pixel = vec4(ink, 1.0); }`;

function numbers(text, kind) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
  return new kind(bytes.buffer);
}

function rgb(text) {
  return [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16) / 255);
}

function program(vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  return made;
}

function buffer(content, shader, name, size, kind, whole) {
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, content, gl.STATIC_DRAW);
  const where = gl.getAttribLocation(shader, name);
  gl.enableVertexAttribArray(where);
  if (whole) gl.vertexAttribIPointer(where, size, kind, 0, 0);
  else gl.vertexAttribPointer(where, size, kind, false, 0, 0);
}

// the corners of each triangle stand by themselves: a corner's place says which it is
function surface(layer, shader) {
  const points = numbers(layer.points, Uint16Array), corners = numbers(layer.triangles, Uint32Array);
  const edges = numbers(layer.edges, Uint8Array), owner = numbers(layer.numbers, Uint32Array);
  const places = new Uint16Array(4 * corners.length), owners = new Uint32Array(corners.length);
  for (let k = 0; k < corners.length; k++) {
    places.set(points.subarray(3 * corners[k], 3 * corners[k] + 3), 4 * k);
    places[4 * k + 3] = edges[Math.floor(k / 3)];
    owners[k] = owner[Math.floor(k / 3)];
  }
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  buffer(places, shader, "place", 4, gl.UNSIGNED_SHORT, true);
  buffer(owners, shader, "number", 1, gl.UNSIGNED_INT, true);
  return { ...layer, array, count: corners.length, rgb: layer.color ? rgb(layer.color) : [0, 0, 0] };
}

function outline(box, shader) {
  const [a, b] = [box.low, box.high], ends = [];
  for (const axis of [0, 1, 2]) for (const u of [a, b]) for (const v of [a, b]) {
    const [i, j] = [0, 1, 2].filter((other) => other !== axis);
    for (const end of [a, b]) {
      const point = [0, 0, 0];
      point[axis] = end[axis]; point[i] = u[i]; point[j] = v[j];
      ends.push(...point);
    }
  }
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  buffer(new Float32Array(ends), shader, "place", 3, gl.FLOAT, false);
  return { ...box, array, count: ends.length / 3, shown: true };
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((v) => v / Math.hypot(...a));

// rows: to the right, upward, toward the reader
function looking(towards, up) {
  const right = unit(cross(towards, up)), above = unit(cross(right, towards));
  return [right, above, unit(towards).map((v) => -v)];
}

function turned(rows, about, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)], [u, v] = about === "x" ? [1, 2] : [2, 0];
  const result = rows.map((row) => row.slice());
  for (const k of [0, 1, 2]) {
    result[u][k] = c * rows[u][k] - s * rows[v][k];
    result[v][k] = s * rows[u][k] + c * rows[v][k];
  }
  return result;
}

function start() {
  const solid = program(VERTEX, FRAGMENT), thin = program(LINE_VERTEX, LINE_FRAGMENT);
  const layers = model.layers.map((layer) => surface(layer, solid));
  const outlines = model.outlines.map((box) => outline(box, thin));
  const lines = { name: "lines of the mesh", shown: model.lines };
  const home = () => ({ turn: looking(model.towards, model.up), zoom: 1.0, shift: [0, 0] });
  let eye = home(), waiting = false;
  const uniform = (shader, name) => gl.getUniformLocation(shader, name);
  const theme = (name) => rgb(getComputedStyle(document.documentElement).getPropertyValue(name).trim().padEnd(7, "0"));

  function camera(shader) {
    gl.useProgram(shader);
    const [a, b, c] = eye.turn;
    gl.uniformMatrix3fv(uniform(shader, "turn"), false, [a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]]);
    gl.uniform3fv(uniform(shader, "middle"), model.middle);
    gl.uniform2fv(uniform(shader, "shift"), eye.shift);
    gl.uniform1f(uniform(shader, "reach"), model.reach);
    gl.uniform1f(uniform(shader, "zoom"), eye.zoom);
    gl.uniform1f(uniform(shader, "aspect"), canvas.width / canvas.height);
  }

  function cutting() {
    const axis = Number(document.getElementById("axis").value), share = Number(document.getElementById("cut").value) / 1000;
    // whole at the end of the slider, rounding or not
    const place = share === 1 ? 70000 : model.low[axis] + share * (model.high[axis] - model.low[axis]);
    const meters = (model.origin[axis] + Math.min(place, model.high[axis]) * model.step) * model.perMeter;
    document.getElementById("where").textContent = `${"xyz"[axis]} = ${meters.toPrecision(4)} ${model.unit}`;
    gl.uniform1i(uniform(solid, "axis"), axis);
    gl.uniform1f(uniform(solid, "cut"), place);
  }

  function surfaces(picking) {
    camera(solid);
    cutting();
    gl.uniform3fv(uniform(solid, "colors"), model.palette.flatMap(rgb));
    gl.uniform3fv(uniform(solid, "ink"), rgb(model.ink));
    gl.uniform1i(uniform(solid, "lines"), lines.shown ? 1 : 0);
    gl.uniform1i(uniform(solid, "picking"), picking ? 1 : 0);
    // what can be seen through comes last, and hides nothing
    for (const clear of [false, true]) {
      for (const [index, layer] of layers.entries()) {
        if (!layer.shown || clear !== layer.opacity < 1 || (picking && clear)) continue;
        gl.depthMask(!clear);
        (clear ? gl.enable : gl.disable).call(gl, gl.BLEND);
        gl.uniform4fv(uniform(solid, "color"), [...layer.rgb, layer.opacity]);
        gl.uniform1i(uniform(solid, "byNumber"), layer.color ? 0 : 1);
        gl.uniform1i(uniform(solid, "layer"), index + 1);
        gl.bindVertexArray(layer.array);
        gl.drawArrays(gl.TRIANGLES, 0, layer.count);
      }
    }
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  function draw() {
    waiting = false;
    const scale = window.devicePixelRatio || 1;
    const [width, height] = [Math.round(canvas.clientWidth * scale), Math.round(canvas.clientHeight * scale)];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.clearColor(...theme("--paper"), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    camera(thin);
    gl.uniform3fv(uniform(thin, "ink"), theme("--soft"));
    for (const box of outlines) {
      if (!box.shown) continue;
      gl.bindVertexArray(box.array);
      gl.drawArrays(gl.LINES, 0, box.count);
    }
    surfaces(false);
    drawAxes();
    document.body.dataset.state = "drawn";
  }

  function drawAxes() {
    const axes = document.getElementById("axes");
    axes.replaceChildren();
    // the one that points away first
    for (const k of [0, 1, 2].sort((a, b) => eye.turn[2][a] - eye.turn[2][b])) {
      const [x, y] = [32 * eye.turn[0][k], -32 * eye.turn[1][k]];
      const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
      for (const [name, value] of Object.entries({ x1: 0, y1: 0, x2: x, y2: y, stroke: "currentColor" })) line.setAttribute(name, value);
      const text = document.createElementNS("http://www.w3.org/2000/svg", "text");
      for (const [name, value] of Object.entries({ x: 1.3 * x, y: 1.3 * y + 4, "text-anchor": "middle", fill: "currentColor" })) text.setAttribute(name, value);
      text.textContent = "xyz"[k];
      axes.append(line, text);
    }
  }

  function redraw() {
    if (!waiting) requestAnimationFrame(draw);
    waiting = true;
  }

  // draws numbers instead of colors, once, and reads the one under the pointer
  function pick(x, y) {
    const scale = canvas.width / canvas.clientWidth, pixel = new Uint8Array(4);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const frame = gl.createFramebuffer(), image = gl.createRenderbuffer(), depth = gl.createRenderbuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    for (const [target, kind, place] of [[image, gl.RGBA8, gl.COLOR_ATTACHMENT0], [depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, target);
      gl.renderbufferStorage(gl.RENDERBUFFER, kind, canvas.width, canvas.height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, target);
    }
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    surfaces(true);
    gl.readPixels(Math.floor(x * scale), canvas.height - 1 - Math.floor(y * scale), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.deleteFramebuffer(frame);
    gl.deleteRenderbuffer(image);
    gl.deleteRenderbuffer(depth);
    const layer = layers[pixel[3] - 1];
    const number = pixel[0] + 256 * pixel[1] + 65536 * pixel[2] - 1;
    told.textContent = !layer ? "" : layer.label ? `${layer.label} ${number}` : layer.name;
    redraw();
  }

  function box(thing, color) {
    const label = document.createElement("label"), input = document.createElement("input");
    input.type = "checkbox";
    input.checked = thing.shown;
    input.addEventListener("change", () => { thing.shown = input.checked; redraw(); });
    label.append(input, " ");
    if (color) {
      const swatch = document.createElement("span");
      swatch.className = "swatch";
      swatch.style.background = color;
      label.append(swatch);
    }
    label.append(thing.name);
    document.getElementById("layers").append(label);
  }
  for (const layer of layers) box(layer, layer.color);
  for (const each of outlines) box(each);
  box(lines);

  const pointers = new Map();
  let moved = 0;
  const spread = () => { const [a, b] = [...pointers.values()]; return Math.hypot(a.x - b.x, a.y - b.y); };
  const turn = (dx, dy) => { eye.turn = turned(turned(eye.turn, "y", 0.008 * dx), "x", 0.008 * dy); };
  const shift = (dx, dy) => { eye.shift = [eye.shift[0] + (2 * dx) / canvas.clientHeight, eye.shift[1] - (2 * dy) / canvas.clientHeight]; };
  const zoom = (factor) => {
    const limited = Math.min(Math.max(eye.zoom * factor, 0.2), 200) / eye.zoom;
    eye.zoom *= limited;
    eye.shift = eye.shift.map((v) => v * limited);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    moved = 0;
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before.x, event.clientY - before.y];
    const apart = pointers.size === 2 ? spread() : 0;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    moved += Math.abs(dx) + Math.abs(dy);
    if (pointers.size === 2) {
      if (apart > 0) zoom(spread() / apart);
      shift(dx / 2, dy / 2);
    } else if (event.shiftKey || event.buttons & 6) shift(dx, dy);
    else turn(dx, dy);
    redraw();
  });
  for (const name of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(name, (event) => {
      pointers.delete(event.pointerId);
      if (name === "pointerup" && moved < 4 && !pointers.size) pick(event.offsetX, event.offsetY);
    });
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-0.0015 * event.deltaY));
    redraw();
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, -20], ArrowDown: [0, 20] }[event.key];
    if (step) (event.shiftKey ? shift : turn)(...step);
    else if (event.key === "+") zoom(1.2);
    else if (event.key === "-") zoom(1 / 1.2);
    else return;
    event.preventDefault();
    redraw();
  });
  const views = { x: [[1, 0, 0], [0, 1, 0]], y: [[0, 1, 0], [0, 0, 1]], z: [[0, 0, -1], [0, 1, 0]] };
  for (const [name, view] of Object.entries(views)) {
    document.getElementById(name).addEventListener("click", () => { eye.turn = looking(...view); redraw(); });
  }
  document.getElementById("reset").addEventListener("click", () => { eye = home(); redraw(); });
  for (const name of ["axis", "cut"]) document.getElementById(name).addEventListener("input", redraw);
  window.addEventListener("resize", redraw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  draw();
}

if (gl) start();
else {
  document.body.dataset.state = "no-webgl";
  told.className = "bad";
  told.textContent = "This browser offers no WebGL 2, with which the scene is drawn; fibertwin view opens it in a window.";
}
