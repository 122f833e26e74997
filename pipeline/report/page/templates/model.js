/* SPDX-License-Identifier: GPL-3.0-or-later */
// A small viewer: WebGL 2, parallel projection, no library and no request. The model is JSON in the page itself.
const model = JSON.parse(document.getElementById("model").textContent);
const canvas = document.getElementById("view");
const gl = canvas.getContext("webgl2", { alpha: false, antialias: true, preserveDrawingBuffer: true });
const byId = (id) => document.getElementById(id);
const told = byId("told");

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
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

// A plane: its axis, how it is tilted about the two others [degree], and where it stands along its normal.
const plane = { axis: model.axis, tilts: [0, 0], place: 0, side: 1 };
const radians = (degrees) => (degrees * Math.PI) / 180;

function normalOf({ axis, tilts }) {
  const [a, b] = tilts.map(radians), normal = [0, 0, 0];
  normal[axis] = Math.cos(a) * Math.cos(b);
  normal[(axis + 1) % 3] = Math.sin(a) * Math.cos(b);
  normal[(axis + 2) % 3] = Math.sin(b);
  // no rounding where nothing is tilted
  return tilts.some((angle) => angle !== 0) ? normal : [0, 1, 2].map((k) => (k === axis ? 1 : 0));
}

function rangeOf(normal) {
  const ends = [0, 0];
  for (const k of [0, 1, 2]) {
    ends[0] += Math.min(normal[k] * model.low[k], normal[k] * model.high[k]);
    ends[1] += Math.max(normal[k] * model.low[k], normal[k] * model.high[k]);
  }
  return ends;
}

// a plane that only touches the end of everything would meet no cell
function within(place, normal) {
  const [low, high] = rangeOf(normal), margin = 1e-5 * (high - low);
  return Math.min(Math.max(place, low + margin), high - margin);
}

function start() {
  const solid = program(VERTEX, FRAGMENT), thin = program(LINE_VERTEX, LINE_FRAGMENT);
  const stream = program(STREAM_VERTEX, STREAM_FRAGMENT), ball = program(BALL_VERTEX, BALL_FRAGMENT);
  const layers = model.layers.map((layer) => surface(layer, solid));
  const outlines = model.outlines.map((box) => outline(box, thin));
  const streamlines = model.streamlines ? streams(model.streamlines, stream) : null;
  const particles = model.particles.map((given) => balls(given, ball));
  const cells = model.cells ? readCells(model.cells) : null;
  const section = { name: "section of the cells", shown: true, count: 0, array: vertexArray(), buffers: {}, stale: true, owners: [] };
  const lines = { name: "lines of the mesh", shown: model.lines };
  const home = () => ({ turn: looking(model.towards, model.up), zoom: 1.0, shift: [0, 0] });
  let eye = home(), waiting = false;
  const known = new Map();
  const uniform = (shader, name) => {
    if (!known.has(shader)) known.set(shader, new Map());
    const names = known.get(shader);
    if (!names.has(name)) names.set(name, gl.getUniformLocation(shader, name));
    return names.get(name);
  };
  const theme = (name) => rgb(getComputedStyle(document.documentElement).getPropertyValue(name).trim().padEnd(7, "0"));
  const cellField = () => (cells ? cells.fields[Number(byId("cells-by").value)] : undefined);
  const numberField = () => model.numberFields[Number(byId("fibers-by").value)];

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

  function cutting(shader, on) {
    const normal = normalOf(plane).map((v) => v * plane.side);
    gl.uniform4fv(uniform(shader, "plane"), [...normal, plane.side * plane.place]);
    gl.uniform1i(uniform(shader, "cutting"), on && byId("away").checked ? 1 : 0);
  }

  function ramp(shader, colors) {
    gl.uniform3fv(uniform(shader, "ramp"), (colors ?? Array(16).fill("#000000")).flatMap(rgb));
  }

  function updateSection() {
    if (!cells || !section.shown || !section.stale) return;
    section.stale = false;
    const found = sectionOf(cells, normalOf(plane), plane.place, cellField());
    gl.bindVertexArray(section.array);
    const names = { place: found.places, sides: found.sides, number: found.owners, value: found.values };
    for (const [name, content] of Object.entries(names)) {
      const buffer = section.buffers[name];
      section.buffers[name] = attribute(solid, name, name === "place" ? 3 : 1, content, buffer ? { buffer } : {});
    }
    section.count = found.owners.length;
  }

  function surfaces(picking) {
    camera(solid);
    gl.uniform3fv(uniform(solid, "colors"), model.palette.flatMap(rgb));
    gl.uniform3fv(uniform(solid, "ink"), rgb(model.ink));
    gl.uniform1i(uniform(solid, "lines"), lines.shown ? 1 : 0);
    gl.uniform1i(uniform(solid, "picking"), picking ? 1 : 0);
    const field = numberField();
    // what can be seen through comes last, and hides nothing
    for (const clear of [false, true]) {
      if (clear) drawSection(picking);
      cutting(solid, true);
      for (const [index, layer] of layers.entries()) {
        if (!layer.shown || clear !== layer.opacity < 1 || (picking && clear)) continue;
        gl.depthMask(!clear);
        (clear ? gl.enable : gl.disable).call(gl, gl.BLEND);
        ramp(solid, layer.label && field ? field.colors : null);
        gl.uniform1i(uniform(solid, "byField"), layer.label && field ? 1 : 0);
        gl.uniform4fv(uniform(solid, "color"), [...layer.rgb, layer.opacity]);
        gl.uniform1i(uniform(solid, "byNumber"), layer.color ? 0 : 1);
        gl.uniform1i(uniform(solid, "lit"), 1);
        gl.uniform1i(uniform(solid, "solid"), layer.solid);
        gl.uniform1i(uniform(solid, "layer"), index + 1);
        gl.bindVertexArray(layer.array);
        gl.drawArrays(gl.TRIANGLES, 0, layer.count);
      }
    }
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  function drawSection(picking) {
    if (!section.shown || !section.count) return;
    const field = cellField();
    cutting(solid, false);
    ramp(solid, field?.colors);
    gl.uniform1i(uniform(solid, "byField"), field ? 1 : 0);
    gl.uniform1i(uniform(solid, "byNumber"), 0);
    gl.uniform1i(uniform(solid, "lit"), 0);
    gl.uniform1i(uniform(solid, "solid"), 0);
    gl.uniform1i(uniform(solid, "lines"), byId("section-lines").checked ? 1 : 0);
    gl.uniform1i(uniform(solid, "layer"), 255);
    gl.uniform4fv(uniform(solid, "color"), [...rgb(model.cellColor), 1]);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    // walls that lie in the plane come second
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(-1, -1);
    gl.bindVertexArray(section.array);
    gl.drawArrays(gl.TRIANGLES, 0, section.count);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.uniform1i(uniform(solid, "lines"), lines.shown ? 1 : 0);
  }

  function drawStreams() {
    if (!streamlines?.shown) return;
    camera(stream);
    cutting(stream, byId("away-flow").checked);
    ramp(stream, streamlines.colors);
    gl.uniform1f(uniform(stream, "width"), 0.0022);
    gl.bindVertexArray(streamlines.array);
    gl.drawArraysInstanced(gl.TRIANGLES, 0, 6, streamlines.count);
  }

  function drawParticles() {
    camera(ball);
    cutting(ball, byId("away-flow").checked);
    gl.uniform1f(uniform(ball, "least"), 3.2 / Math.max(canvas.height, 1));
    for (const each of particles) {
      if (!each.shown) continue;
      gl.uniform1f(uniform(ball, "radius"), each.radius);
      gl.uniform4fv(uniform(ball, "color"), [...rgb(each.color), 1]);
      gl.bindVertexArray(each.array);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, 6, each.count);
    }
  }

  function draw() {
    waiting = false;
    const scale = window.devicePixelRatio || 1;
    const [width, height] = [Math.round(canvas.clientWidth * scale), Math.round(canvas.clientHeight * scale)];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    updateSection();
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
    drawStreams();
    drawParticles();
    surfaces(false);
    drawAxes();
    document.body.dataset.state = "drawn";
  }

  function drawAxes() {
    const axes = byId("axes");
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

  // what stands in the boxes of the plane follows the plane
  function showPlane(typed = false) {
    const normal = normalOf(plane), [low, high] = rangeOf(normal);
    plane.place = within(plane.place, normal);
    byId("axis").value = plane.axis;
    byId("cut").value = (1000 * (plane.place - low)) / (high - low);
    const tilted = plane.tilts.some((angle) => angle !== 0);
    const meters = dot(normal, model.origin) + plane.place * model.step;
    if (!typed) byId("place").value = (meters * model.perMeter).toFixed(3);
    byId("place-of").textContent = tilted ? "along the normal" : `${"xyz"[plane.axis]} =`;
    for (const k of [0, 1]) {
      byId(`tilt-${k}`).value = plane.tilts[k];
      byId(`tilt-${k}-of`).textContent = `tilted toward ${"xyz"[(plane.axis + 1 + k) % 3]} by ${plane.tilts[k].toFixed(0)}°`;
    }
    section.stale = true;
    redraw();
  }

  // the plane turns about the point of it that is nearest to the middle of all
  function tilt(tilts) {
    const before = normalOf(plane), off = plane.place - dot(before, model.middle);
    const held = model.middle.map((v, k) => v + off * before[k]);
    plane.tilts = tilts.map((angle) => Math.min(Math.max(angle, -90), 90));
    plane.place = dot(normalOf(plane), held);
    showPlane();
  }

  // which side goes: the one toward the reader, so that the section is seen
  function faceReader() { plane.side = dot(eye.turn[2], normalOf(plane)) >= 0 ? 1 : -1; }

  const dragPlane = {
    plane(dx, dy) {
      const normal = normalOf(plane), scale = (2 * model.reach) / (eye.zoom * canvas.clientHeight);
      const [right, up] = [dot(eye.turn[0], normal), dot(eye.turn[1], normal)], seen = Math.hypot(right, up);
      // a plane that faces the reader moves with the pointer's height
      const along = seen > 0.15 ? (dx * right - dy * up) / seen ** 2 : -dy * Math.sign(dot(eye.turn[2], normal) || 1);
      plane.place += scale * along;
      showPlane();
    },
    tilt(dx, dy) {
      const n = normalOf(plane).map((v, k) => v + 0.006 * (dx * eye.turn[0][k] - dy * eye.turn[1][k]) * plane.side);
      const [u, v, w] = [n[plane.axis], n[(plane.axis + 1) % 3], n[(plane.axis + 2) % 3]].map((c) => c / Math.hypot(...n));
      tilt([Math.atan2(v, u), Math.asin(Math.min(Math.max(w, -1), 1))].map((angle) => (angle * 180) / Math.PI));
    },
  };

  const text = (value) => (value === 0 ? "0" : Math.abs(value) >= 1e4 || Math.abs(value) < 1e-2 ? value.toExponential(2) : value.toPrecision(3));
  function legend(id, field) {
    const place = byId(id);
    place.hidden = !field;
    if (!field) return;
    place.querySelector(".ramp").style.background = `linear-gradient(to right, ${field.colors.join(", ")})`;
    place.querySelector(".low").textContent = text(field.low);
    place.querySelector(".high").textContent = `${text(field.high)} ${field.unit}`.trim();
  }

  // where the reader's line of sight at a pixel meets the plane, and what the field is there
  function fieldThere(x, y, tet) {
    const field = cellField(), normal = normalOf(plane);
    if (!field) return "";
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    const flat = [(((2 * x) / w - 1) * (w / h) - eye.shift[0]) / eye.zoom, (1 - (2 * y) / h - eye.shift[1]) / eye.zoom];
    const on = [0, 1, 2].map((k) => model.middle[k] + model.reach * (flat[0] * eye.turn[0][k] + flat[1] * eye.turn[1][k]));
    const slope = dot(normal, eye.turn[2]), step = Math.abs(slope) > 1e-6 ? (plane.place - dot(normal, on)) / slope : 0;
    const share = fieldAt(cells, field, tet, barycentric(cells, tet, on.map((v, k) => v + step * eye.turn[2][k])));
    return `, ${field.name} ${text(field.low + share * (field.high - field.low))} ${field.unit}`.trimEnd();
  }

  // draws numbers instead of colors, once, and reads the one under the pointer
  function pick(x, y) {
    const scale = canvas.width / canvas.clientWidth, pixel = new Uint8Array(4);
    const frame = gl.createFramebuffer(), image = gl.createRenderbuffer(), depth = gl.createRenderbuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    for (const [target, kind, place] of [[image, gl.RGBA8, gl.COLOR_ATTACHMENT0], [depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, target);
      gl.renderbufferStorage(gl.RENDERBUFFER, kind, canvas.width, canvas.height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, target);
    }
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    surfaces(true);
    gl.readPixels(Math.floor(x * scale), canvas.height - 1 - Math.floor(y * scale), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.deleteFramebuffer(frame);
    gl.deleteRenderbuffer(image);
    gl.deleteRenderbuffer(depth);
    const layer = layers[pixel[3] - 1];
    const number = pixel[0] + 256 * pixel[1] + 65536 * pixel[2] - 1, field = numberField();
    if (pixel[3] === 255) told.textContent = `cell ${cells.cell ? cells.cell[number] : number}${fieldThere(x, y, number)}`;
    else if (!layer) told.textContent = "";
    else if (!layer.label) told.textContent = layer.name;
    else told.textContent = `${layer.label} ${number}${field ? `, ${field.name} ${text(field.values[number])} ${field.unit}` : ""}`;
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
    byId("layers").append(label);
  }
  for (const layer of layers) box(layer, layer.color);
  if (cells) box(section, model.cellColor);
  if (streamlines) box(streamlines);
  for (const each of particles) box(each, each.color);
  for (const each of outlines) box(each);
  box(lines);

  function choices(id, fields, first) {
    const select = byId(id);
    for (const [value, name] of [["-1", first], ...fields.map((field, k) => [String(k), field.name])]) {
      select.append(new Option(name, value));
    }
    select.closest("label").hidden = !fields.length;
  }
  choices("cells-by", model.cells?.fields ?? [], "nothing");
  choices("fibers-by", model.numberFields, model.numbered);
  byId("cells-by").value = String((model.cells?.fields.length ?? 0) && model.cells.first);
  function recolor() {
    const field = numberField();
    for (const layer of layers) {
      if (!field || !layer.label) continue;
      const span = field.high - field.low || 1;
      gl.bindVertexArray(layer.array);
      attribute(solid, "value", 1, Float32Array.from(layer.owners, (k) => (field.values[k] - field.low) / span), { buffer: layer.values });
    }
    legend("cells-legend", cellField());
    legend("fibers-legend", field);
    legend("streams-legend", streamlines);
    section.stale = true;
    redraw();
  }
  for (const id of ["cells-by", "fibers-by"]) byId(id).addEventListener("change", recolor);

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
  const drags = { turn, shift, plane: dragPlane.plane, tilt: dragPlane.tilt };
  function dragged(event) {
    const plain = byId("drag").value;
    if (event.altKey || event.ctrlKey) return event.shiftKey ? "tilt" : "plane";
    return event.shiftKey || event.buttons & 6 ? "shift" : plain;
  }
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
    } else drags[dragged(event)](dx, dy);
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
    if (step) (event.shiftKey ? shift : drags[byId("drag").value])(...step);
    else if (event.key === "+") zoom(1.2);
    else if (event.key === "-") zoom(1 / 1.2);
    else return;
    event.preventDefault();
    redraw();
  });
  const views = { x: [[1, 0, 0], [0, 1, 0]], y: [[0, 1, 0], [0, 0, 1]], z: [[0, 0, -1], [0, 1, 0]] };
  for (const [name, view] of Object.entries(views)) {
    byId(name).addEventListener("click", () => { eye.turn = looking(...view); redraw(); });
  }
  function firstPlane(axis) {
    plane.axis = axis;
    plane.tilts = [0, 0];
    plane.place = model.middle[axis];
    faceReader();
    showPlane();
  }
  byId("reset").addEventListener("click", () => { eye = home(); firstPlane(model.axis); });
  byId("axis").addEventListener("input", () => firstPlane(Number(byId("axis").value)));
  byId("cut").addEventListener("input", () => {
    const [low, high] = rangeOf(normalOf(plane));
    plane.place = low + (Number(byId("cut").value) / 1000) * (high - low);
    showPlane();
  });
  byId("place").addEventListener("input", () => {
    const meters = Number(byId("place").value) / model.perMeter;
    plane.place = (meters - dot(normalOf(plane), model.origin)) / model.step;
    showPlane(true);
  });
  for (const k of [0, 1]) {
    byId(`tilt-${k}`).addEventListener("input", () => tilt(plane.tilts.map((angle, n) => (n === k ? Number(byId(`tilt-${k}`).value) : angle))));
  }
  for (const id of ["away", "away-flow", "section-lines"]) byId(id).addEventListener("change", redraw);
  byId("other").addEventListener("click", () => { plane.side *= -1; redraw(); });
  window.addEventListener("resize", redraw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  byId("away-flow").closest("label").hidden = !streamlines && !particles.length;
  firstPlane(model.axis);
  recolor();
  draw();
}

if (gl) start();
else {
  document.body.dataset.state = "no-webgl";
  told.className = "bad";
  told.textContent = "This browser offers no WebGL 2, with which this is drawn; fibertwin view opens it in a window.";
}
