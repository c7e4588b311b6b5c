// Matrices, and buffers of the graphics hardware.

const STICK_SIDES = 12;
const MAX_MEASURED = 20000; // vertices from which the size on the screen is taken
const COARSE_TRIANGLES = 15000; // about, of the surface that slow machines turn
const LARGE = 100000; // triangles of a surface that has a coarse one
const NORMAL_STEPS = 1023; // on each side of zero of an octahedral coordinate

// ------------------------------------------------------------------------------------- matrices
// Matrices are lists of three columns.

function multiply(a, b) {
  return [0, 1, 2].flatMap((column) => [0, 1, 2].map((row) =>
    a[row] * b[3 * column] + a[3 + row] * b[3 * column + 1] + a[6 + row] * b[3 * column + 2]));
}

function turnAbout(axis, angle) {
  const matrix = [1, 0, 0, 0, 1, 0, 0, 0, 1], i = (axis + 1) % 3, j = (axis + 2) % 3;
  matrix[4 * i] = matrix[4 * j] = Math.cos(angle);
  matrix[3 * i + j] = Math.sin(angle);
  matrix[3 * j + i] = -Math.sin(angle);
  return matrix;
}

// Returns the product of a matrix and a vector.
function apply(matrix, vector) {
  return [0, 1, 2].map((row) => [0, 1, 2].reduce((sum, column) =>
    sum + matrix[3 * column + row] * vector[column], 0));
}

// Looks along the shortest principal axis of a molecule; the longest one is across or upright.
function startRotation({ axes: [longest, middle, shortest] }, isUpright) {
  const rows = isUpright ? [middle.map((value) => -value), longest, shortest] : [longest, middle, shortest];
  return [0, 1, 2].flatMap((column) => rows.map((row) => row[column]));
}

// Returns the middle of a turned molecule on the screen and half of its size, in angstrom from the
// centre of rotation.
function extentOf(molecule, rotation) {
  const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  const add = (places, index, reach) => {
    const place = apply(rotation, [0, 1, 2].map((axis) => places[3 * index + axis] - molecule.middle[axis]));
    for (let axis = 0; axis < 2; axis++) {
      low[axis] = Math.min(low[axis], place[axis] - reach);
      high[axis] = Math.max(high[axis], place[axis] + reach);
    }
  };
  const step = Math.ceil(molecule.vertices / MAX_MEASURED);
  for (let vertex = 0; vertex < molecule.vertices; vertex += step) add(molecule.points, vertex, 0);
  molecule.ligand?.forEach((value, atom) => value && add(molecule.centers, atom, 1));
  return { middle: [0, 1].map((axis) => (low[axis] + high[axis]) / 2),
    half: [0, 1].map((axis) => Math.max((high[axis] - low[axis]) / 2, 0.1)) };
}

// Returns the mean length of the edges of some triangles, in angstrom.
function meanEdge({ points, triangle }) {
  const step = 3 * Math.ceil(triangle.length / (3 * MAX_MEASURED));
  let sum = 0, count = 0;
  for (let i = 0; i < triangle.length; i += step, count++)
    sum += Math.hypot(...[0, 1, 2].map((axis) =>
      points[3 * triangle[i] + axis] - points[3 * triangle[i + 1] + axis]));
  return sum / count;
}

// Returns the surface that slow machines turn instead of a large one: a vertex at the mean of all
// vertices in a cell of a grid, and the triangles between them. `models` has a vertex of each, for
// the colours. With `isDivided`, vertices of a cell whose normals have different directions stay
// apart, which keeps walls apart but more triangles.
function coarseSurface(molecule, isDivided) {
  const { points, normal, place, triangle, vertices, triangles } = molecule;
  const side = 1.5 * meanEdge(molecule) * Math.sqrt(triangles / COARSE_TRIANGLES);
  const numbers = new Map(), models = [], sums = [], numberOf = new Uint32Array(vertices);
  for (let vertex = 0; vertex < vertices; vertex++) {
    const direction = decodeNormal(normal[2 * vertex], normal[2 * vertex + 1]);
    const [i, j, k] = [0, 1, 2].map((axis) => Math.floor(points[3 * vertex + axis] / side) + 4096);
    const key = 6 * (i + 8192 * (j + 8192 * k)) + (isDivided ? mainDirection(direction) : 0);
    if (!numbers.has(key)) {
      numbers.set(key, models.length);
      models.push(vertex);
      sums.push([0, 0, 0, 0, 0, 0, 0]);
    }
    const sum = sums[numberOf[vertex] = numbers.get(key)];
    for (let axis = 0; axis < 3; axis++) {
      sum[axis] += place[3 * vertex + axis];
      sum[3 + axis] += direction[axis];
    }
    sum[6]++;
  }
  const corners = [];
  for (let i = 0; i < triangle.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => numberOf[triangle[i + k]]);
    if (a !== b && b !== c && c !== a) corners.push(a, b, c);
  }
  if (isDivided && corners.length > 6 * COARSE_TRIANGLES) return coarseSurface(molecule, false);
  return { models, corners, place: sums.flatMap((sum) => [0, 1, 2].map((axis) => sum[axis] / sum[6])),
    normal: sums.flatMap((sum) => encodeNormal(sum.slice(3, 6))) };
}

// Returns which of the six directions of the axes is next to a direction.
function mainDirection(direction) {
  const sizes = direction.map(Math.abs), axis = sizes.indexOf(Math.max(...sizes));
  return 2 * axis + (direction[axis] > 0 ? 1 : 0);
}

// Octahedral normals, as page.py writes them; directions have no unit length.
function decodeNormal(u, v) {
  const x = u / NORMAL_STEPS - 1, y = v / NORMAL_STEPS - 1, z = 1 - Math.abs(x) - Math.abs(y);
  return z >= 0 ? [x, y, z]
    : [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1), z];
}

function encodeNormal([x, y, z]) {
  const sum = Math.abs(x) + Math.abs(y) + Math.abs(z) || 1, [u, v] = [x / sum, y / sum];
  const [a, b] = z >= 0 ? [u, v]
    : [(1 - Math.abs(v)) * (u < 0 ? -1 : 1), (1 - Math.abs(u)) * (v < 0 ? -1 : 1)];
  return [Math.round((a + 1) * NORMAL_STEPS), Math.round((b + 1) * NORMAL_STEPS)];
}

// ------------------------------------------------------------------------------------- graphics

function makeProgram(gl, { vertex, fragment }) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    const [first, second] = gl.getAttachedShaders(program);
    throw new Error([gl.getShaderInfoLog(first), gl.getShaderInfoLog(second),
      gl.getProgramInfoLog(program)].filter(Boolean).join("; "));
  }
  const uniforms = {};
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
    const { name } = gl.getActiveUniform(program, i);
    uniforms[name] = gl.getUniformLocation(program, name);
  }
  return { program, uniforms };
}

function makeTexture(gl, format, width, height) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
    gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
  return texture;
}

function makeFrame(gl, color, depth) {
  const frame = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  for (const [point, part] of [[gl.COLOR_ATTACHMENT0, color], [gl.DEPTH_ATTACHMENT, depth]]) {
    if (part?.texture) gl.framebufferTexture2D(gl.FRAMEBUFFER, point, gl.TEXTURE_2D, part.texture, 0);
    if (part?.renderbuffer)
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, point, gl.RENDERBUFFER, part.renderbuffer);
  }
  return frame;
}

// Describes an attribute of a vertex array: its buffer, numbers and place in each row of bytes.
function attribute(gl, index, buffer, size, type, { stride = 0, offset = 0, divisor = 0, isColor = false,
  isInteger = false } = {}) {
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.enableVertexAttribArray(index);
  if (isInteger) gl.vertexAttribIPointer(index, size, type, stride, offset);
  else gl.vertexAttribPointer(index, size, type, isColor, stride, offset);
  gl.vertexAttribDivisor(index, divisor);
}

function makeBuffer(gl, values, kind = gl.ARRAY_BUFFER) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(kind, buffer);
  gl.bufferData(kind, values, gl.STATIC_DRAW);
  return buffer;
}

// Fills the vertices of a surface and of its coarse surface.
function fillVertices(gl, { vertices, coarse }, molecule) {
  const count = molecule.vertices + (coarse?.models.length ?? 0);
  const rows = new Uint16Array(6 * count); // x, y, z, 0, normal: aligned to 4 bytes
  const put = ({ place, normal }, first, end) => {
    for (let i = 0; first + i < end; i++) {
      for (let axis = 0; axis < 3; axis++) rows[6 * (first + i) + axis] = place[3 * i + axis];
      for (let part = 0; part < 2; part++) rows[6 * (first + i) + 4 + part] = normal[2 * i + part];
    }
  };
  put(molecule, 0, molecule.vertices);
  if (coarse) put(coarse, molecule.vertices, count);
  gl.bindBuffer(gl.ARRAY_BUFFER, vertices);
  gl.bufferData(gl.ARRAY_BUFFER, rows, gl.STATIC_DRAW);
}

// Returns the vertex arrays of a molecule, with the buffers that change.
function makeDrawing(gl, molecule) {
  const surface = gl.createVertexArray();
  const [vertices, colors, indices] = [0, 1, 2].map(() => gl.createBuffer());
  fillVertices(gl, { vertices }, molecule);
  gl.bindVertexArray(surface);
  attribute(gl, 0, vertices, 3, gl.UNSIGNED_SHORT, { stride: 12 });
  attribute(gl, 1, vertices, 2, gl.UNSIGNED_SHORT, { stride: 12, offset: 8 });
  for (let kind = 0; kind < CLASSES; kind++)
    attribute(gl, 2 + kind, colors, 4, gl.UNSIGNED_BYTE,
      { stride: 4 * CLASSES, offset: 4 * kind, isColor: true });
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
  gl.bindVertexArray(null);
  return { surface, vertices, colors, indices, coarse: null, atoms: makeAtomDrawing(gl), ligands: makeAtomDrawing(gl) };
}

// Adds the coarse surface, if the surface is large and has none. Returns whether it has been added;
// then triangles and colours have to be filled again.
function addCoarse(gl, drawing, molecule) {
  if (drawing.coarse || molecule.triangles <= LARGE) return false;
  drawing.coarse = coarseSurface(molecule, true);
  fillVertices(gl, drawing, molecule);
  return true;
}

// Fills the list of triangles with those whose atoms are shown: the outer surface, the walls of
// cavities, and the coarse surface.
function fillSurface(gl, drawing, molecule) {
  const outer = [], walls = [], coarse = [], { triangle, component, vertices } = molecule;
  const areAllShown = !molecule.isHidden.includes(1); // then atoms of vertices are not needed
  for (let i = 0; i < triangle.length; i += 3) {
    const [a, b, c] = [triangle[i], triangle[i + 1], triangle[i + 2]];
    if (areAllShown || [a, b, c].every((vertex) => isVertexShown(molecule, vertex)))
      (component?.[a] > 0 ? walls : outer).push(a, b, c);
  }
  const { corners = [], models } = drawing.coarse ?? {};
  for (let i = 0; i < corners.length; i += 3)
    if (areAllShown || [0, 1, 2].every((k) => isVertexShown(molecule, models[corners[i + k]])))
      coarse.push(...corners.slice(i, i + 3).map((corner) => vertices + corner));
  gl.bindVertexArray(null);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, drawing.indices);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, Uint32Array.from(outer.concat(walls, coarse)), gl.STATIC_DRAW);
  Object.assign(drawing, { outer: { first: 0, count: outer.length },
    walls: { first: outer.length, count: walls.length },
    fast: { first: outer.length + walls.length, count: coarse.length } });
}

// Fills the colours of the vertices, and of those of the coarse surface.
function fillColors(gl, { colors, coarse }, bytes) {
  const width = 4 * CLASSES, models = coarse?.models ?? [];
  const all = new Uint8Array(bytes.length + width * models.length);
  all.set(bytes);
  models.forEach((vertex, i) =>
    all.set(bytes.subarray(width * vertex, width * (vertex + 1)), bytes.length + width * i));
  gl.bindBuffer(gl.ARRAY_BUFFER, colors);
  gl.bufferData(gl.ARRAY_BUFFER, all, gl.STATIC_DRAW);
}

function fillBuffers(gl, drawing, values) {
  for (const [name, array] of Object.entries(values)) {
    gl.bindBuffer(gl.ARRAY_BUFFER, drawing.buffers[name]);
    gl.bufferData(gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
  }
}

// Returns vertex arrays of spheres and sticks, and the buffers of their instances.
function makeAtomDrawing(gl) {
  const spheres = gl.createVertexArray(), sticks = gl.createVertexArray();
  const buffers = Object.fromEntries(["places", "colors", "numbers", "ends", "endColors", "endNumbers"]
    .map((name) => [name, gl.createBuffer()]));
  gl.bindVertexArray(spheres);
  attribute(gl, 0, makeBuffer(gl, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1])), 2, gl.FLOAT);
  attribute(gl, 1, buffers.places, 4, gl.FLOAT, { divisor: 1 });
  attribute(gl, 2, buffers.colors, 3, gl.UNSIGNED_BYTE, { stride: 4, divisor: 1, isColor: true });
  attribute(gl, 3, buffers.numbers, 1, gl.UNSIGNED_INT, { divisor: 1, isInteger: true });

  const corners = Float32Array.from({ length: 3 * (2 * STICK_SIDES + 2) }, (_, i) => {
    const corner = Math.floor(i / 3), angle = 2 * Math.PI * (corner >> 1) / STICK_SIDES;
    return [Math.cos(angle), Math.sin(angle), corner % 2][i % 3];
  });
  gl.bindVertexArray(sticks);
  attribute(gl, 0, makeBuffer(gl, corners), 3, gl.FLOAT);
  for (const end of [0, 1]) {
    attribute(gl, 1 + end, buffers.ends, 3, gl.FLOAT, { stride: 24, offset: 12 * end, divisor: 1 });
    attribute(gl, 3 + end, buffers.endColors, 3, gl.UNSIGNED_BYTE,
      { stride: 8, offset: 4 * end, divisor: 1, isColor: true });
  }
  attribute(gl, 5, buffers.endNumbers, 2, gl.UNSIGNED_INT, { divisor: 1, isInteger: true });
  gl.bindVertexArray(null);
  return { spheres, sticks, buffers, atoms: 0, bonds: 0 };
}

// Fills a drawing with the atoms that `isChosen` accepts and the bonds between them. Atoms without
// a bond, such as metals, are larger.
function fillAtoms(gl, drawing, molecule, isChosen) {
  const { centers, radius, elements, element: kinds } = molecule;
  const bonds = molecule.bonds.filter((_, i) =>
    isChosen(molecule.bonds[i & ~1]) && isChosen(molecule.bonds[i | 1]));
  const isBound = new Set(bonds);
  const chosen = Uint32Array.from(Array.from(radius.keys()).filter(isChosen));
  const colorOf = elements.map((name) => [...elementColor(name), 255]);
  const colorsOf = (atoms) => Uint8Array.from({ length: 4 * atoms.length }, (_, i) =>
    colorOf[kinds[atoms[i >> 2]]][i & 3]);
  const placesOf = (atoms) => Float32Array.from({ length: 3 * atoms.length }, (_, i) =>
    centers[3 * atoms[Math.floor(i / 3)] + i % 3]);
  const spheres = Float32Array.from({ length: 4 * chosen.length }, (_, i) => {
    const atom = chosen[i >> 2], size = radius[atom] / 1000;
    return (i & 3) < 3 ? centers[3 * atom + (i & 3)] : isBound.has(atom) ? size : -size;
  });
  fillBuffers(gl, drawing, { places: spheres, colors: colorsOf(chosen), numbers: chosen,
    ends: placesOf(bonds), endColors: colorsOf(bonds), endNumbers: bonds });
  Object.assign(drawing, { atoms: chosen.length, bonds: bonds.length / 2 });
}
