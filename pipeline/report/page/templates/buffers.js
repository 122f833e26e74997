/* SPDX-License-Identifier: GPL-3.0-or-later */
// What the graphics card draws from: the model's numbers in its buffers.
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

// fills a buffer of the vertex array that is bound; each attribute is one run of numbers, once per vertex or per copy
function attribute(shader, name, size, content, { buffer = gl.createBuffer(), stride = 0, offset = 0, perCopy = false } = {}) {
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, content, gl.DYNAMIC_DRAW);
  const where = gl.getAttribLocation(shader, name);
  if (where < 0) return buffer;
  const kind = { Uint8Array: gl.UNSIGNED_BYTE, Uint16Array: gl.UNSIGNED_SHORT, Uint32Array: gl.UNSIGNED_INT, Float32Array: gl.FLOAT }[content.constructor.name];
  gl.enableVertexAttribArray(where);
  if (["sides", "number"].includes(name)) gl.vertexAttribIPointer(where, size, kind, stride, offset);
  else gl.vertexAttribPointer(where, size, kind, false, stride, offset);
  if (perCopy) gl.vertexAttribDivisor(where, 1);
  return buffer;
}

function vertexArray() {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  return array;
}

// the corners of each triangle stand by themselves: a corner's place says which it is
function surface(layer, shader) {
  const points = numbers(layer.points, Uint16Array), corners = numbers(layer.triangles, Uint32Array);
  const edges = numbers(layer.edges, Uint8Array), owner = numbers(layer.numbers, Uint32Array);
  const places = new Uint16Array(3 * corners.length), owners = new Uint32Array(corners.length), sides = new Uint8Array(corners.length);
  for (let k = 0; k < corners.length; k++) {
    places.set(points.subarray(3 * corners[k], 3 * corners[k] + 3), 3 * k);
    sides[k] = edges[Math.floor(k / 3)];
    owners[k] = owner[Math.floor(k / 3)];
  }
  const array = vertexArray();
  attribute(shader, "place", 3, places);
  attribute(shader, "sides", 1, sides);
  attribute(shader, "number", 1, owners);
  const values = attribute(shader, "value", 1, new Float32Array(corners.length));
  return { ...layer, array, values, owners, count: corners.length, rgb: layer.color ? rgb(layer.color) : [0, 0, 0] };
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
  const array = vertexArray();
  attribute(shader, "place", 3, new Float32Array(ends));
  return { ...box, array, count: ends.length / 3, shown: true };
}

function streams(given, shader) {
  const points = numbers(given.points, Uint16Array), values = numbers(given.values, Uint16Array);
  const starts = numbers(given.starts, Uint32Array), pieces = [];
  for (let line = 0; line + 1 < starts.length; line++) {
    for (let k = starts[line]; k + 1 < starts[line + 1]; k++) {
      for (const n of [k, k + 1]) pieces.push(points[3 * n], points[3 * n + 1], points[3 * n + 2], values[n] / 65535);
    }
  }
  const array = vertexArray(), content = new Float32Array(pieces), buffer = gl.createBuffer();
  for (const [name, size, offset] of [["start", 3, 0], ["startValue", 1, 12], ["end", 3, 16], ["endValue", 1, 28]]) {
    attribute(shader, name, size, content, { buffer, stride: 32, offset, perCopy: true });
  }
  return { ...given, array, count: pieces.length / 8 };
}

function balls(given, shader) {
  const array = vertexArray(), points = numbers(given.points, Uint16Array);
  attribute(shader, "place", 3, points, { perCopy: true });
  return { ...given, array, count: points.length / 3 };
}
