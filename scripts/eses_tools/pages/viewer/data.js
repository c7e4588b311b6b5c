// Reads the molecules of the page and names their parts.

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
const PATCHES = ["", "convex", "saddle", "concave"];
const NO_RESIDUE = ["", "", ""];

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
  molecule.points = Float32Array.from(molecule.place, (value, i) =>
    info.step * value + info.origin[i % 3]);
  molecule.isHidden = new Uint8Array(molecule.residues?.length ?? 0);
  if (molecule.center) {
    molecule.centers = Float32Array.from(molecule.center, (value, i) =>
      value / 1000 + info.atom_origin[i % 3]);
    molecule.bonds = findBonds(molecule);
  }
  return withAtoms(molecule);
}

// Gives a molecule `touched`, the atoms of the vertices that its mesh names, and `atom`, the atoms of
// least power, which are found when they are first needed.
function withAtoms(molecule) {
  const touched = molecule.touched = molecule.atom;
  let shared = molecule.centers && touched ? null : touched;
  return Object.defineProperty(molecule, "atom",
    { enumerable: true, get: () => shared ??= shareByPower(molecule, touched.slice()) });
}

// Returns the power of a vertex with respect to the sphere of an atom, in square angstrom.
function power({ points, centers, radius }, vertex, atom) {
  let sum = -((radius[atom] / 1000) ** 2);
  for (let axis = 0; axis < 3; axis++) sum += (points[3 * vertex + axis] - centers[3 * atom + axis]) ** 2;
  return sum;
}

// A mesh names one of the atoms that touch a probe. Gives each vertex the one of least power
// instead, as areas of atoms are shared: atoms spread along the edges of triangles. Changes and
// returns the atoms of the vertices.
function shareByPower(molecule, atom) {
  const { triangle } = molecule;
  const powers = Float32Array.from(atom, (one, vertex) => power(molecule, vertex, one));
  for (let isChanged = true; isChanged;) {
    isChanged = false;
    for (let i = 0; i < triangle.length; i++) {
      const vertex = triangle[i], other = triangle[i % 3 === 2 ? i - 2 : i + 1];
      if (atom[vertex] === atom[other]) continue;
      for (const [to, from] of [[vertex, other], [other, vertex]]) {
        const offered = power(molecule, to, atom[from]);
        if (offered >= powers[to] - 1e-4) continue;
        [powers[to], atom[to], isChanged] = [offered, atom[from], true];
      }
    }
  }
  return atom;
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

function residueOf(molecule, atom) {
  return molecule.residue ? molecule.residues[molecule.residue[atom]] : NO_RESIDUE;
}

function isShown(molecule, atom) {
  return !molecule.residue || molecule.isHidden[molecule.residue[atom]] === 0;
}

function isVertexShown(molecule, vertex) {
  return !molecule.atom || isShown(molecule, molecule.atom[vertex]);
}

// Returns the mean position of atoms or vertices.
function meanPlace(places, chosen) {
  const sum = [0, 0, 0];
  for (const one of chosen) for (let axis = 0; axis < 3; axis++) sum[axis] += places[3 * one + axis];
  return sum.map((value) => value / chosen.length);
}

// Returns the names of ligands and cavities, and where they are.
function labelsOf(molecule, { areLigands, areCavities }) {
  const groups = new Map(), labels = [];
  const add = (key, one) => groups.has(key) ? groups.get(key).push(one) : groups.set(key, [one]);
  if (areLigands && molecule.ligand)
    molecule.ligand.forEach((value, atom) => value && isShown(molecule, atom)
      && add(molecule.residue[atom], atom));
  for (const [residue, atoms] of groups)
    labels.push({ text: molecule.residues[residue].join(" ").trim(), residue,
      place: meanPlace(molecule.centers, atoms) });
  if (!areCavities || !molecule.component) return labels;
  groups.clear();
  molecule.component.forEach((number, vertex) => number > 0 && add(number, vertex));
  for (const [number, vertices] of [...groups].sort(([a], [b]) => a - b)) { // the largest first
    const volume = molecule.voids?.[number - 1];
    labels.push({ text: volume === undefined ? `${number}` : `${number}: ${volume.toFixed(1)} Å³`,
      place: meanPlace(molecule.points, vertices) });
  }
  return labels;
}

// Returns the labels whose places are in the panels of their molecules, with their upper left corners:
// above or below the place, without those that would cover an earlier one.
function placeLabels(labels) {
  const placed = [];
  const isFree = (left, top, { width, height }) => placed.every((one) => left >= one.left + one.width
    || one.left >= left + width || top >= one.top + one.height || one.top >= top + height);
  for (const label of labels) {
    const { x, y, panel, width, height } = label, right = panel.x + panel.width, bottom = panel.y + panel.height;
    if (x < panel.x || x > right || y < panel.y || y > bottom) continue;
    const left = Math.max(Math.min(x - width / 2, right - width), panel.x);
    const top = [y - 1.5 * height, y + 0.5 * height].find((one) => isFree(left, one, label));
    if (top !== undefined) placed.push({ ...label, left, top });
  }
  return placed;
}

// Returns the text that names an atom of the molecule, for example "CA, ALA 52A, chain A".
function describeAtom(molecule, atom) {
  const parts = [];
  const name = molecule.name_of_atom ? molecule.names[molecule.name_of_atom[atom]] : "";
  parts.push(name || `${elementOf(molecule, atom)} atom ${molecule.serial[atom]}`.trim());
  if (molecule.residue) {
    const [residue, number, chain] = residueOf(molecule, atom);
    if (residue || number) parts.push(`${residue} ${number}`.trim());
    if (chain) parts.push(`chain ${chain}`);
  }
  if (molecule.area && !molecule.ligand?.[atom]) parts.push(`${(molecule.area[atom] / 100).toFixed(1)} Å²`);
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
