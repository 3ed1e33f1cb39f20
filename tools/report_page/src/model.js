// A model of the page: its arrays as the program packed them (see tools/page_model.h), and the geometry made of them.

/** Reads consecutive little-endian arrays. */
class Reader {
  constructor(base64) {
    const text = atob(base64);
    this.bytes = Uint8Array.from(text, character => character.charCodeAt(0));
    this.place = 0;
  }
  take8(length) {
    this.place += length;
    return this.bytes.slice(this.place - length, this.place);
  }
  take16(length) { return new Uint16Array(this.take8(2 * length).buffer); }
}

const top = 65535;  // of 16 bits

/** Positions are in the cube [0, 1] of the model here, lengths too. */
function readMesh(reader, {vertices, faces}) {
  return {positions: Float32Array.from(reader.take16(3 * vertices), value => value / top),
          triangles: reader.take16(3 * faces)};
}

export function readModel(contents, place) {
  const reader = new Reader(document.getElementById(`model-${place}`).textContent);
  const model = {input: readMesh(reader, contents.input), cage: null};
  if (contents.cage) {
    model.cage = readMesh(reader, contents.cage);
    const distances = Float32Array.from(reader.take16(contents.cage.points), value => value / top);
    model.surface = measuredSurface(model.cage, reader.take8(contents.cage.faces), distances);
  }
  return model;
}

/**
 * The faces of the cage cut into those between the points at which its distance was measured, in parts of the largest.
 * A face cut into n parts has points in n + 1 rows, the first of them along its first edge.
 */
function measuredSurface({positions, triangles}, subdivision, distances) {
  const points = new Float32Array(3 * distances.length);
  const pieces = [];
  let first = 0;
  subdivision.forEach((parts, face) => {
    writePoints(points, first, corners(positions, triangles, face), parts);
    first = cut(pieces, first, parts);
  });
  return {positions: points, triangles: Uint32Array.from(pieces), distances};
}

function corners(positions, triangles, face) {
  return [0, 1, 2].map(k => positions.subarray(3 * triangles[3 * face + k], 3 * triangles[3 * face + k] + 3));
}

function writePoints(points, first, [a, b, c], parts) {
  let place = 3 * first;
  for (let row = 0; row <= parts; ++row) {
    for (let i = 0; i + row <= parts; ++i) {
      for (let k = 0; k < 3; ++k) points[place++] = a[k] + (b[k] - a[k]) * i / parts + (c[k] - a[k]) * row / parts;
    }
  }
}

/** Adds the triangles between the points of a face; returns the first point of the next face. */
function cut(pieces, first, parts) {
  for (let row = 0; row < parts; ++row) {
    const length = parts + 1 - row;
    for (let i = 0; i + 1 < length; ++i) {
      const [a, above] = [first + i, first + length + i];
      pieces.push(a, a + 1, above);
      if (i + 2 < length) pieces.push(a + 1, above + 1, above);
    }
    first += length;
  }
  return first + 1;
}

/** Where the plane x[axis] = offset cuts a mesh: ends of segments, one after the other. */
export function contour({positions, triangles}, axis, offset) {
  const ends = [];
  const side = v => positions[3 * v + axis] - offset;
  for (let f = 0; f < triangles.length; f += 3) {
    for (let k = 0; k < 3; ++k) {
      const [v, w] = [triangles[f + k], triangles[f + (k + 1) % 3]];
      const [s, t] = [side(v), side(w)];
      if ((s < 0) === (t < 0)) continue;
      const part = s / (s - t);
      for (let c = 0; c < 3; ++c) {
        ends.push(positions[3 * v + c] + part * (positions[3 * w + c] - positions[3 * v + c]));
      }
    }
  }
  return Float32Array.from(ends);
}
