// Unpack the arrays that isopeel.html_report.packing has packed as short texts.

function bytesOf(text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
  return bytes;
}

/** Numbers of one of JavaScript's typed arrays; like all machines that have browsers they are little-endian. */
function numbersOf(text, Type) {
  return Type === Uint8Array ? bytesOf(text) : new Type(bytesOf(text).buffer);
}

/** Points x, y, x, y and so on, column by column, from the first column and the differences to each next one. */
function pointsOf(packed) {
  const first = numbersOf(packed.first, Int32Array);
  const differences = numbersOf(packed.differences, Int16Array);
  const points = new Float64Array(first.length + differences.length);
  points.set(first);
  for (let k = 0; k < differences.length; k++) points[first.length + k] = points[k] + differences[k];
  return points.map((value) => value * packed.unit);
}

/** A state with all that is drawn of it: of its bodies, and of the faces that adhere. */
function unpackedState(packed) {
  return {
    step: packed.step,
    bodies: packed.bodies.map(({ nodes, stress }) => ({
      nodes: pointsOf(nodes),
      stress: numbersOf(stress, Uint8Array),
    })),
    faces: packed.faces.map(({ adhering, front, adhesion, body }) => ({
      adhering: pointsOf(adhering),
      front,
      adhesion: numbersOf(adhesion, Float32Array),
      body: numbersOf(body, Float32Array),
    })),
    residuals: packed.residuals,
  };
}
