// Gives the vertices colours.

const MAX_LEGEND = 26; // entries; more would not be legible
const MAX_DISTINCT = 256; // colours of a file, which are then not interpolated
const CLASSES = 4; // of colours, see classesOf
const TURNS = 8; // in which regions choose their classes again
const REACH = 8; // square angstrom; powers that differ by more are far from a border
const RINGS = 3; // of vertices around a border that know the colours beyond it
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
// colours between vertices are interpolated (not at all by default), and the legend.
const SCHEMES = {
  patch: {
    label: "patch", has: (one) => one.patch,
    paint: (one, { patches }) => Object.assign((vertex) => patches[one.patch[vertex] - 1],
      { isByPatch: one.border !== undefined }),
    entries: (_, { patches }) => patches.map((color, i) => [PATCHES[i + 1], color]),
  },
  potential: {
    label: "potential", has: (one) => one.potential, isSmooth: () => true,
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
    label: "as in the file", has: (one) => one.color_of_file,
    isSmooth: ({ color_of_file }) => new Set(Array.from(color_of_file, (value, i) => i % 3 ? 0
      : value + 256 * color_of_file[i + 1] + 65536 * color_of_file[i + 2])).size > MAX_DISTINCT,
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
  const classes = chosen.isSmooth?.(molecule) ? new Uint8Array(molecule.vertices)
    : paint.isByPatch ? molecule.patch.map((kind, vertex) => isCavity(vertex) ? 0 : kind)
      : classesOf(molecule.triangle, colors);
  // Returns the index of the colour in `parts` if the vertex had none as high in its class.
  const put = (vertex, kind, color, height) => {
    const at = CLASSES * vertex + kind;
    if (bytes[4 * at + 3] >= height) return undefined;
    parts[at] = color;
    bytes[4 * at + 3] = height;
    return at;
  };
  colors.forEach((color, vertex) => put(vertex, classes[vertex], color, 255));
  if (paint.isByAtom) raiseNeighbors(molecule, colors, classes, put);
  if (paint.isByPatch) raiseOtherPatches(molecule, isCavity, limits, put);
  return bytes;
}

// Colours of atoms meet where the powers of the atoms are equal: gives each vertex the colours of
// the other corners of its triangles, the lower the larger the power of their atoms. Then it gives
// them what these corners have been given: a height that ends in a thin triangle would show as a line.
function raiseNeighbors(molecule, colors, classes, put) {
  const { triangle, atom, vertices } = molecule, sources = new Int32Array(CLASSES * vertices).fill(-1);
  const raise = (vertex, source) => { // the vertex from which a colour comes
    if (source < 0 || colors[vertex] === colors[source]) return;
    const lower = power(molecule, vertex, atom[source]) - power(molecule, vertex, atom[vertex]);
    const height = Math.round(Math.min(Math.max(255 * (1 - lower / REACH), 1), 255));
    const at = put(vertex, classes[source], colors[source], height);
    if (at !== undefined) sources[at] = source;
  };
  forEdges(triangle, raise);
  for (let ring = 1; ring < RINGS; ring++) {
    const given = sources.slice();
    forEdges(triangle, (vertex, other) => {
      for (let kind = 0; kind < CLASSES; kind++) raise(vertex, given[CLASSES * other + kind]);
    });
  }
}

// Patches meet at their borders, which page.py has found on the edges of triangles: gives each vertex
// the colours of other kinds of patches that are near.
function raiseOtherPatches({ patch, border, vertices }, isCavity, { patches }, put) {
  const colors = patches.map((color) => new Uint32Array(Uint8Array.from([...color, 0]).buffer)[0]);
  for (let vertex = 0; vertex < vertices; vertex++)
    for (const step of [0, 1]) {
      const height = border[2 * vertex + step], kind = (patch[vertex] + step) % 3;
      if (height > 0 && !isCavity(vertex)) put(vertex, kind + 1, colors[kind], height);
    }
}

// Calls a function with the ends of each edge of each triangle, in both directions.
function forEdges(triangle, act) {
  for (let i = 0; i < triangle.length; i += 3)
    for (let k = 0; k < 6; k++) act(triangle[i + k % 3], triangle[i + (k + 1 + (k > 2)) % 3]);
}

// Returns the class of each vertex, such that connected vertices of one colour have the same class,
// and different colours in a triangle different ones, with few exceptions.
function classesOf(triangle, colors) {
  const parents = Uint32Array.from(colors.keys()), borders = new Map();
  const rootOf = (vertex) => {
    while (parents[vertex] !== vertex) vertex = parents[vertex] = parents[parents[vertex]];
    return vertex;
  };
  forEdges(triangle, (one, other) => {
    if (colors[one] === colors[other]) parents[rootOf(one)] = rootOf(other);
  });
  const regions = parents.map((_, vertex) => rootOf(vertex));
  forEdges(triangle, (vertex, next) => {
    const [one, other] = [regions[vertex], regions[next]];
    if (one === other) return;
    if (!borders.has(one)) borders.set(one, new Map());
    borders.get(one).set(other, (borders.get(one).get(other) ?? 0) + 1);
  });
  const classes = new Map(), order = [...borders].sort((a, b) => b[1].size - a[1].size);
  for (let turn = 0; turn < TURNS; turn++)
    for (const [region, others] of order) {
      const shared = new Array(CLASSES).fill(0); // lengths of the borders with each class
      for (const [other, length] of others) if (classes.has(other)) shared[classes.get(other)] += length;
      classes.set(region, shared.indexOf(Math.min(...shared)));
    }
  return Uint8Array.from(regions, (region) => classes.get(region) ?? 0);
}

// Returns the names and colours of a scheme without repetition; none if they would be too many.
function legendEntries(molecules, scheme, limits) {
  const { has, entries } = SCHEMES[scheme];
  if (!entries) return [];
  const shown = new Map(molecules.filter(has).flatMap((one) => entries(one, limits)));
  return shown.size > MAX_LEGEND ? [] : Array.from(shown);
}
