// Gives the vertices colours.

const MAX_LEGEND = 26; // entries; more would not be legible
const CLASSES = 4; // of colours, see divideIntoClasses
const REACH = 8; // square angstrom; powers that differ by more are far from a border
const PLAIN = [158, 181, 204];
const MISSING = [190, 190, 190];
const WHITENED = 0.3; // part of white in the colours of chains, residues and atoms
// Viridis (S. van der Walt, N. Smith).
const SEQUENTIAL = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

// The colours of eses-blocks --color, which are distinct for successive numbers.
function distinctColor(number) {
  const hue = 6 * (Math.imul(number, 0x9E3779B9) >>> 0) / 2 ** 32;
  const up = Math.floor(60 + 175 * (hue % 1)), down = 295 - up;
  return [[235, up, 60], [down, 235, 60], [60, 235, up], [60, down, 235], [up, 60, 235],
    [235, 60, down]][Math.floor(hue)];
}

function softColor(number) {
  return distinctColor(number).map((value) => Math.round(value + WHITENED * (255 - value)));
}

// Component 0 is the outside.
function componentColor(number) {
  return number === 0 ? [200, 200, 200] : distinctColor(number - 1);
}

function componentName(number) {
  return number === 0 ? "outside" : `cavity ${number}`;
}

function elementColor(name) {
  const code = parseInt(ELEMENT_COLORS[name] ?? "ff1493", 16);
  return [code >> 16, code >> 8 & 255, code & 255];
}

function gradientColor(stops, share) {
  const at = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const low = Math.min(Math.floor(at), stops.length - 2);
  return stops[low].map((value, i) => value + (at - low) * (stops[low + 1][i] - value));
}

function potentialAt(molecule, vertex) {
  return (molecule.potential[vertex] - 32768) / 32767 * molecule.potential_max;
}

// Returns the end of the scale of areas: a multiple of 5 that at most 2 per cent of the atoms exceed.
function largestArea(molecules) {
  const areas = molecules.flatMap((one) => one.area ? Array.from(one.area) : [])
    .filter((area) => area > 0).sort((a, b) => a - b);
  return 5 * Math.ceil((areas[Math.floor(0.98 * areas.length)] ?? 500) / 500);
}

// The schemes: which molecules have them, a function that returns the colour of a vertex, whether
// colours between vertices are interpolated, and the legend.
const SCHEMES = {
  patch: {
    label: "patch", has: (one) => one.patch,
    paint: (one, { patches }) => Object.assign((vertex) => patches[one.patch[vertex] - 1],
      { isByPatch: one.border !== undefined }),
    entries: (_, { patches }) => patches.map((color, i) => [PATCHES[i + 1], color]),
  },
  potential: {
    label: "potential", has: (one) => one.potential, isSmooth: true,
    paint: (one, { potential, diverging }) => (vertex) =>
      gradientColor(diverging, 0.5 + potentialAt(one, vertex) / (2 * potential)),
    gradient: ({ potential, diverging }) => ({
      stops: diverging, title: "potential, kT/e",
      ticks: [`≤ −${potential}`, "0", `≥ +${potential}`],
    }),
  },
  atom: {
    label: "atom", has: (one) => one.touched,
    paint: (one) => byAtom(one, (atom) => softColor(one.serial[atom] - 1)),
  },
  element: {
    label: "element", has: (one) => one.touched && one.element && one.elements.some((name) => name),
    paint: (one) => byAtom(one, (atom) => elementColor(elementOf(one, atom))),
    entries: (one) => one.elements.map((name) => [name || "unknown", elementColor(name)]),
  },
  residue: {
    label: "residue", has: (one) => one.touched && one.residue,
    paint: (one) => byAtom(one, (atom) => softColor(one.residue[atom])),
    entries: (one) => one.residues.map(([name, number, chain], i) =>
      [`${name} ${number} ${chain}`.trim(), softColor(i)]),
  },
  chain: {
    label: "chain", has: (one) => one.touched && one.chain,
    paint: (one) => byAtom(one, (atom) => softColor(one.chain[atom])),
    entries: (one) => Array.from(new Set(Array.from(one.atom, (atom) => one.chain[atom])))
      .sort((a, b) => a - b).map((i) =>
        [one.chains[i] ? `chain ${one.chains[i]}` : "no chain", softColor(i)]),
  },
  component: {
    label: "component", has: (one) => one.component,
    paint: (one) => (vertex) => componentColor(one.component[vertex]),
    entries: (one) => Array.from(new Set(one.component)).sort((a, b) => a - b)
      .map((number) => [componentName(number), componentColor(number)]),
  },
  area: {
    label: "area of the atom", has: (one) => one.touched && one.area,
    paint: (one, { area }) => byAtom(one, (atom) =>
      gradientColor(SEQUENTIAL, one.area[atom] / 100 / area)),
    gradient: ({ area }) => ({
      stops: SEQUENTIAL, title: "area of the atom, Å²",
      ticks: ["0", `${area / 2}`, `≥ ${area}`],
    }),
  },
  file: {
    label: "as in the file", has: (one) => one.color_of_file, isSmooth: true,
    paint: (one) => (vertex) => one.color_of_file.subarray(3 * vertex, 3 * vertex + 3),
  },
  plain: { label: "one colour", has: () => true, paint: () => () => PLAIN },
};

// Returns a function from vertex to colour for colours of atoms.
function byAtom(molecule, colorOf) {
  const colors = Array.from(molecule.serial, (_, atom) => colorOf(atom));
  const paint = (vertex) => colors[molecule.atom[vertex]];
  return Object.assign(paint, { isByAtom: molecule.centers !== undefined });
}

// Returns four colours of each vertex, one for each class, with a height in the fourth byte. The
// shader gives each point of a triangle the colour of the highest class, so that borders between
// colours are sharp. The own colour of a vertex has height 255; a colour without height is absent.
function paintVertices(molecule, scheme, limits, areCavitiesShown) {
  const chosen = SCHEMES[scheme].has(molecule) ? SCHEMES[scheme] : SCHEMES.plain;
  const paint = chosen.paint(molecule, limits);
  const isCavity = (vertex) => areCavitiesShown && molecule.component[vertex] > 0;
  const own = new Uint8Array(4 * molecule.vertices);
  for (let vertex = 0; vertex < molecule.vertices; vertex++)
    own.set(isCavity(vertex) ? componentColor(molecule.component[vertex]) : paint(vertex), 4 * vertex);
  const colors = new Uint32Array(own.buffer), parts = new Uint32Array(CLASSES * molecule.vertices);
  const bytes = new Uint8Array(parts.buffer);
  const put = (vertex, kind, color, height) => {
    const at = CLASSES * vertex + kind;
    if (bytes[4 * at + 3] >= height) return;
    parts[at] = color;
    bytes[4 * at + 3] = height;
  };
  if (chosen.isSmooth) {
    colors.forEach((color, vertex) => put(vertex, 0, color, 255));
    return bytes;
  }
  const classes = divideIntoClasses(molecule.triangle, colors);
  colors.forEach((color, vertex) => put(vertex, classes.get(color) ?? 0, color, 255));
  if (paint.isByAtom) raiseNeighbors(molecule, colors, (vertex, color, height) =>
    put(vertex, classes.get(color), color, height));
  if (paint.isByPatch) raiseOtherPatches(molecule, isCavity, limits, (vertex, color, height) => {
    const [packed] = new Uint32Array(Uint8Array.from([...color, 0]).buffer);
    if (classes.has(packed)) put(vertex, classes.get(packed), packed, height);
  });
  return bytes;
}

// Colours of atoms meet where the powers of the atoms are equal: gives each vertex the colours of
// other corners of its triangles, the lower the larger the power of their atoms.
function raiseNeighbors(molecule, colors, raise) {
  const { triangle, atom } = molecule;
  for (let i = 0; i < triangle.length; i += 3)
    for (let k = 0; k < 6; k++) {
      const vertex = triangle[i + k % 3], other = triangle[i + (k + 1 + (k > 2)) % 3];
      if (colors[vertex] === colors[other]) continue;
      const lower = power(molecule, vertex, atom[other]) - power(molecule, vertex, atom[vertex]);
      raise(vertex, colors[other], Math.round(Math.min(Math.max(255 * (1 - lower / REACH), 1), 255)));
    }
}

// Patches meet at their borders, which page.py has found on the edges of triangles: gives each vertex
// the colours of other kinds of patches that a neighbour has.
function raiseOtherPatches({ patch, border, vertices }, isCavity, { patches }, raise) {
  for (let vertex = 0; vertex < vertices; vertex++)
    for (const step of [0, 1]) {
      const height = border[2 * vertex + step];
      if (height > 0 && !isCavity(vertex)) raise(vertex, patches[(patch[vertex] + step) % 3], height);
    }
}

// Returns a class of each colour that has a border, such that different colours in a triangle have
// different classes. Colours are ordered by their numbers of neighbours; each gets the class with
// which it has the fewest borders, mostly none.
function divideIntoClasses(triangles, colors) {
  const borders = new Map();
  const count = (one, other) => {
    if (!borders.has(one)) borders.set(one, new Map());
    borders.get(one).set(other, (borders.get(one).get(other) ?? 0) + 1);
  };
  for (let i = 0; i < triangles.length; i += 3)
    for (let k = 0; k < 3; k++) {
      const one = colors[triangles[i + k]], other = colors[triangles[i + (k + 1) % 3]];
      if (one === other) continue;
      count(one, other);
      count(other, one);
    }
  const classes = new Map();
  for (const [color, others] of [...borders].sort((a, b) => b[1].size - a[1].size)) {
    const shared = new Array(CLASSES).fill(0);
    for (const [other, length] of others)
      if (classes.has(other)) shared[classes.get(other)] += length;
    classes.set(color, shared.indexOf(Math.min(...shared)));
  }
  return classes;
}

// Returns the names and colours of a scheme without repetition; none if they would be too many.
function legendEntries(molecules, scheme, limits) {
  const { has, entries } = SCHEMES[scheme];
  if (!entries) return [];
  const shown = new Map(molecules.filter(has).flatMap((one) => entries(one, limits)));
  return shown.size > MAX_LEGEND ? [] : Array.from(shown);
}
