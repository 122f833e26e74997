/* SPDX-License-Identifier: GPL-3.0-or-later */
// Cutting the cells: where a plane meets each tetrahedron, and what a field is there. Drawn by model.js.
const EDGES = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];

function numbers(text, kind) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
  return new kind(bytes.buffer);
}

// edges are numbered as they first come, tetrahedron by tetrahedron, in the order of EDGES
function edgesOf(tets, points) {
  const seen = new Map(), found = new Uint32Array((6 * tets.length) / 4);
  for (let t = 0; t < tets.length / 4; t++) for (let e = 0; e < 6; e++) {
    const a = tets[4 * t + EDGES[e][0]], b = tets[4 * t + EDGES[e][1]];
    const key = Math.min(a, b) * points + Math.max(a, b);
    let number = seen.get(key);
    if (number === undefined) seen.set(key, (number = seen.size));
    found[6 * t + e] = number;
  }
  return found;
}

function readCells(given) {
  const points = numbers(given.points, Uint16Array), tets = numbers(given.tets, Uint32Array);
  return {
    points, tets, count: tets.length / 4, vertices: points.length / 3,
    sides: given.sides ? numbers(given.sides, Uint8Array) : null,
    cell: given.cell ? numbers(given.cell, Uint32Array) : null,
    fields: given.fields.map((field) => ({ ...field, values: numbers(field.values, Uint16Array) })),
    edges: null,
  };
}

// share of a field's range at a place of a tetrahedron, by its barycentric coordinates
function fieldAt(cells, field, tet, place) {
  const value = (k) => field.values[k] / 65535;
  if (field.at === "cells") return value(tet);
  let sum = 0;
  if (field.at === "vertices") {
    for (let k = 0; k < 4; k++) sum += place[k] * value(cells.tets[4 * tet + k]);
    return sum;
  }
  cells.edges ??= edgesOf(cells.tets, cells.vertices);
  for (let k = 0; k < 4; k++) sum += place[k] * (2 * place[k] - 1) * value(cells.tets[4 * tet + k]);
  for (let e = 0; e < 6; e++) {
    const weight = 4 * place[EDGES[e][0]] * place[EDGES[e][1]];
    if (weight) sum += weight * value(cells.vertices + cells.edges[6 * tet + e]);
  }
  return Math.min(Math.max(sum, 0), 1);
}

const average = (places) => [0, 1, 2, 3].map((k) => places.reduce((sum, place) => sum + place[k], 0) / places.length);

// The corners of the polygon in which a plane meets a tetrahedron, in order around it, as barycentric coordinates, and
// the face on which the side from each corner to the next lies. `above` are signed distances of the four vertices; a
// vertex on the plane counts as below, so that a plane through vertices meets each cell on one of its sides once.
function polygonOf(above) {
  const up = [0, 1, 2, 3].filter((k) => above[k] > 0), down = [0, 1, 2, 3].filter((k) => above[k] <= 0);
  const on = (a, b) => {
    const place = [0, 0, 0, 0], share = above[a] / (above[a] - above[b]);
    place[a] = 1 - share;
    place[b] = share;
    return place;
  };
  const others = (...used) => [0, 1, 2, 3].find((k) => !used.includes(k));
  if (up.length === 2) {
    const [a, b] = up, [c, d] = down;
    // a side lies on the face whose one missing vertex is named here
    return { places: [on(a, c), on(a, d), on(b, d), on(b, c)], faces: [b, c, a, d] };
  }
  const alone = up.length === 1 ? up[0] : down[0], [a, b, c] = [0, 1, 2, 3].filter((k) => k !== alone);
  const from = (k) => (up.length === 1 ? on(alone, k) : on(k, alone));
  return { places: [from(a), from(b), from(c)], faces: [others(alone, a, b), others(alone, b, c), others(alone, c, a)] };
}

// The section of all cells with the plane normal * p = offset: triangles, three corners after each other.
function sectionOf(cells, normal, offset, field) {
  const { points, tets } = cells, distance = new Float64Array(cells.vertices);
  for (let k = 0; k < cells.vertices; k++) {
    distance[k] = normal[0] * points[3 * k] + normal[1] * points[3 * k + 1] + normal[2] * points[3 * k + 2] - offset;
  }
  const places = [], values = [], owners = [], sides = [];
  for (let t = 0; t < cells.count; t++) {
    const four = [tets[4 * t], tets[4 * t + 1], tets[4 * t + 2], tets[4 * t + 3]];
    const up = (distance[four[0]] > 0) + (distance[four[1]] > 0) + (distance[four[2]] > 0) + (distance[four[3]] > 0);
    if (up === 0 || up === 4) continue;
    const polygon = polygonOf(four.map((k) => distance[k]));
    const at = (bary) => [0, 1, 2].map((axis) => four.reduce((sum, k, n) => sum + bary[n] * points[3 * k + axis], 0));
    const middle = average(polygon.places), count = polygon.places.length;
    // a quadratic field is looked at in the middles of the sides too
    const fine = field && field.at === "nodes";
    const share = (bary) => (field ? fieldAt(cells, field, t, bary) : 0);
    const center = [at(middle), share(middle)];
    for (let k = 0; k < count; k++) {
      const a = polygon.places[k], b = polygon.places[(k + 1) % count];
      const drawn = !cells.sides || (cells.sides[t] >> polygon.faces[k]) & 1 ? 1 : 0;
      for (const [from, to] of fine ? [[a, average([a, b])], [average([a, b]), b]] : [[a, b]]) {
        places.push(...at(from), ...at(to), ...center[0]);
        values.push(share(from), share(to), center[1]);
        owners.push(t, t, t);
        sides.push(drawn, drawn, drawn);
      }
    }
  }
  return { places: new Float32Array(places), values: new Float32Array(values), owners: new Uint32Array(owners), sides: new Uint8Array(sides) };
}

// the coordinates of a point within a tetrahedron, as shares of its vertices
function barycentric(cells, tet, point) {
  const at = [0, 1, 2, 3].map((k) => [0, 1, 2].map((axis) => cells.points[3 * cells.tets[4 * tet + k] + axis]));
  const less = (a, b) => a.map((v, k) => v - b[k]), volume = (a, b, c) => dot(a, cross(b, c));
  const [u, v, w, p] = [less(at[1], at[0]), less(at[2], at[0]), less(at[3], at[0]), less(point, at[0])];
  const whole = volume(u, v, w) || 1;
  const shares = [volume(p, v, w), volume(u, p, w), volume(u, v, p)].map((part) => part / whole);
  return [1 - shares[0] - shares[1] - shares[2], ...shares];
}
