// Reads the molecules of the page and gives them colours.

const ELEMENT_COLORS = { // those of Jmol, slightly darker carbon and hydrogen
  "": "a0a8b0", H: "e8e8e8", C: "8c9196", N: "3050f8", O: "e8150d", F: "70c030", Na: "ab5cf2",
  Mg: "5fbf00", P: "ff8000", S: "e0c020", Cl: "1fc01f", K: "8f40d4", Ca: "3dbf00", Mn: "9c7ac7",
  Fe: "e06633", Co: "f090a0", Ni: "50d050", Cu: "c88033", Zn: "7d80b0", Se: "ffa100",
  Br: "a62929", I: "940094",
};
// Covalent radii in angstrom (B. Cordero et al., Dalton Trans. 2008, 2832, doi:10.1039/b801115j).
const COVALENT = {
  H: 0.31, C: 0.76, N: 0.71, O: 0.66, F: 0.57, Na: 1.66, Mg: 1.41, P: 1.07, S: 1.05, Cl: 1.02,
  K: 2.03, Ca: 1.76, Mn: 1.39, Fe: 1.32, Co: 1.26, Ni: 1.24, Cu: 1.32, Zn: 1.22, Se: 1.2,
  Br: 1.2, I: 1.39,
};
const UNKNOWN_COVALENT = 0.76; // carbon
const BOND_TOLERANCE = 0.45; // angstrom
const MAX_LEGEND = 26; // entries; more would not be legible
const PATCHES = ["", "convex", "saddle", "concave"];
const CLASSES = 4; // of colours, see divideIntoClasses
const PLAIN = [158, 181, 204];
// Viridis (S. van der Walt, N. Smith).
const SEQUENTIAL = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

// -------------------------------------------------------------------------------------- arrays

function fromBase64(text) {
  const piece = 1 << 20; // characters, a multiple of 4
  const clean = text.trim();
  const padding = clean.endsWith("==") ? 2 : clean.endsWith("=") ? 1 : 0;
  const bytes = new Uint8Array(clean.length / 4 * 3 - padding);
  for (let from = 0, to = 0; from < clean.length; from += piece) {
    const part = atob(clean.slice(from, from + piece));
    for (let i = 0; i < part.length; i++) bytes[to++] = part.charCodeAt(i);
  }
  return bytes;
}

async function unpack(text) {
  const stream = new Blob([fromBase64(text)]).stream()
    .pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Returns the arrays of a molecule by name. page.py stores differences to the row before, the
// lowest bytes of all values first.
function readArrays(bytes, layout) {
  const arrays = {};
  let at = 0;
  for (const { name, width, columns, rows } of layout) {
    const count = rows * columns;
    const values = new { 1: Uint8Array, 2: Uint16Array, 4: Uint32Array }[width](count);
    for (let plane = 0; plane < width; plane++, at += count)
      for (let i = 0; i < count; i++) values[i] |= bytes[at + i] << (8 * plane);
    for (let i = columns; i < count; i++) values[i] += values[i - columns]; // modulo 2^(8 width)
    arrays[name] = values;
  }
  return arrays;
}

// Returns the molecule described by `info` with its arrays and bonds.
async function readMolecule(info, text) {
  const molecule = { ...info, ...readArrays(await unpack(text), info.arrays) };
  if (molecule.center) {
    molecule.centers = Float32Array.from(molecule.center, (value, i) =>
      value / 1000 + info.atom_origin[i % 3]);
    molecule.bonds = findBonds(molecule);
  }
  return molecule;
}

// ------------------------------------------------------------------------------------- molecule

function elementOf(molecule, atom) {
  return molecule.element ? molecule.elements[molecule.element[atom]] : "";
}

// Returns pairs of atoms that are closer than the sum of their covalent radii plus a tolerance.
function findBonds({ centers, element, elements, radius }) {
  const covalent = elements.map((name) => COVALENT[name] ?? (name ? 1.5 : UNKNOWN_COVALENT));
  const side = 2 * Math.max(...covalent) + BOND_TOLERANCE;
  const key = (x, y, z) => (x + 4096) + 8192 * ((y + 4096) + 8192 * (z + 4096));
  const cells = new Map(), bonds = [];
  for (let atom = 0; atom < radius.length; atom++) {
    const [x, y, z] = centers.subarray(3 * atom, 3 * atom + 3);
    const [i, j, k] = [x, y, z].map((value) => Math.floor(value / side));
    for (let a = i - 1; a <= i + 1; a++)
      for (let b = j - 1; b <= j + 1; b++)
        for (let c = k - 1; c <= k + 1; c++)
          for (const other of cells.get(key(a, b, c)) ?? []) {
            const distance = Math.hypot(x - centers[3 * other], y - centers[3 * other + 1],
              z - centers[3 * other + 2]);
            const reach = covalent[element[atom]] + covalent[element[other]] + BOND_TOLERANCE;
            if (distance > 0.4 && distance < reach) bonds.push(other, atom);
          }
    const cell = key(i, j, k);
    if (cells.has(cell)) cells.get(cell).push(atom);
    else cells.set(cell, [atom]);
  }
  return Uint32Array.from(bonds);
}

// Returns the text that names an atom of the molecule, for example "CA, ALA 52A, chain A".
function describeAtom(molecule, atom) {
  const parts = [];
  const name = molecule.name_of_atom ? molecule.names[molecule.name_of_atom[atom]] : "";
  parts.push(name || `${elementOf(molecule, atom)} atom ${molecule.serial[atom]}`.trim());
  if (molecule.residue) {
    const [residue, number, chain] = molecule.residues[molecule.residue[atom]];
    if (residue || number) parts.push(`${residue} ${number}`.trim());
    if (chain) parts.push(`chain ${chain}`);
  }
  if (molecule.area) parts.push(`${(molecule.area[atom] / 100).toFixed(1)} Å²`);
  return parts.join(", ");
}

function describeVertex(molecule, vertex) {
  const parts = molecule.atom ? [describeAtom(molecule, molecule.atom[vertex])] : ["surface"];
  if (molecule.patch) parts.push(PATCHES[molecule.patch[vertex]]);
  if (molecule.component?.[vertex] > 0) parts.push(componentName(molecule.component[vertex]));
  if (molecule.potential) {
    const value = potentialAt(molecule, vertex);
    parts.push(`${value < 0 ? "−" : "+"}${Math.abs(value).toPrecision(2)} kT/e`);
  }
  return parts.join(", ");
}

// --------------------------------------------------------------------------------------- colours

// The colours of eses-blocks --color, which are distinct for successive numbers.
function distinctColor(number) {
  const hue = 6 * (Math.imul(number, 0x9E3779B9) >>> 0) / 2 ** 32;
  const up = Math.floor(60 + 175 * (hue % 1)), down = 295 - up;
  return [[235, up, 60], [down, 235, 60], [60, 235, up], [60, down, 235], [up, 60, 235],
    [235, 60, down]][Math.floor(hue)];
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
    paint: (one, { patches }) => (vertex) => patches[one.patch[vertex] - 1],
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
    label: "atom", has: (one) => one.atom,
    paint: (one) => byAtom(one, (atom) => distinctColor(one.serial[atom] - 1)),
  },
  element: {
    label: "element", has: (one) => one.atom && one.element && one.elements.some((name) => name),
    paint: (one) => byAtom(one, (atom) => elementColor(elementOf(one, atom))),
    entries: (one) => one.elements.map((name) => [name || "unknown", elementColor(name)]),
  },
  residue: {
    label: "residue", has: (one) => one.atom && one.residue,
    paint: (one) => byAtom(one, (atom) => distinctColor(one.residue[atom])),
    entries: (one) => one.residues.map(([name, number, chain], i) =>
      [`${name} ${number} ${chain}`.trim(), distinctColor(i)]),
  },
  chain: {
    label: "chain", has: (one) => one.atom && one.chain,
    paint: (one) => byAtom(one, (atom) => distinctColor(one.chain[atom])),
    entries: (one) => one.chains.map((name, i) =>
      [name ? `chain ${name}` : "no chain", distinctColor(i)]),
  },
  component: {
    label: "component", has: (one) => one.component,
    paint: (one) => (vertex) => componentColor(one.component[vertex]),
    entries: (one) => Array.from(new Set(one.component)).sort((a, b) => a - b)
      .map((number) => [componentName(number), componentColor(number)]),
  },
  area: {
    label: "area of the atom", has: (one) => one.atom && one.area,
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
  plain: { label: "none", has: () => true, paint: () => () => PLAIN },
};

// Returns a function from vertex to colour for colours of atoms.
function byAtom(molecule, colorOf) {
  const colors = Array.from(molecule.serial, (_, atom) => colorOf(atom));
  return (vertex) => colors[molecule.atom[vertex]];
}

// Returns the colours of all vertices in a scheme and their classes, four bytes each.
function paintVertices(molecule, scheme, limits) {
  const chosen = SCHEMES[scheme].has(molecule) ? SCHEMES[scheme] : SCHEMES.plain;
  const paint = chosen.paint(molecule, limits);
  const colors = new Uint8Array(4 * molecule.vertices);
  for (let vertex = 0; vertex < molecule.vertices; vertex++) colors.set(paint(vertex), 4 * vertex);
  if (!chosen.isSmooth) divideIntoClasses(molecule.triangle, colors);
  return colors;
}

// Sets the fourth byte of each vertex to a class, such that different colours in a triangle have
// different classes. The shader draws sharp borders between classes. Colours are ordered by their
// numbers of neighbours; each gets the class with which it has the fewest borders, mostly none.
function divideIntoClasses(triangles, bytes) {
  const colors = new Uint32Array(bytes.buffer), borders = new Map();
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
  for (let vertex = 0; vertex < colors.length; vertex++)
    bytes[4 * vertex + 3] = classes.get(colors[vertex]) ?? 0;
}

// Returns the names and colours of a scheme without repetition; none if they would be too many.
function legendEntries(molecules, scheme, limits) {
  const { has, entries } = SCHEMES[scheme];
  if (!entries) return [];
  const shown = new Map(molecules.filter(has).flatMap((one) => entries(one, limits)));
  return shown.size > MAX_LEGEND ? [] : Array.from(shown);
}
