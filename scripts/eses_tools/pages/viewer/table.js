// Colours by the columns of a table: of atoms, by their numbers, or of residues.

const KEYS = { // names of columns that say which atom or residue a row is about
  serial: ["serial", "atom_serial"],
  chain: ["chain", "auth_asym_id", "chain_id", "chainid"],
  number: ["residue_number", "resi", "resid", "auth_seq_id", "number"],
};
const OTHER_KEYS = ["x", "y", "z", "residue", "resname", "name", "element", "atoms"]; // no results
const LAST = ["radius", "is_polar"]; // columns that are shown at first only if there are no others

// Returns the rows of a CSV file as lists of texts.
function parseCsv(text) {
  const rows = [[]];
  for (const [, quoted, plain, end] of text.matchAll(/(?:"((?:[^"]|"")*)"|([^",\r\n]*))(,|\r?\n|$)/g)) {
    rows.at(-1).push(quoted === undefined ? plain.trim() : quoted.replaceAll('""', '"'));
    if (end === "") break;
    if (end !== ",") rows.push([]);
  }
  return rows.filter((row) => row.length > 1 || row[0]);
}

async function openTable(viewer, file) {
  if (!file) return;
  const problem = addTable(viewer, file.name, await file.text());
  $("message").textContent = problem ?? "";
  if (problem) setTimeout(() => { $("message").textContent = ""; }, 6000);
}

// Adds a scheme of colours for each column of numbers, and shows the first result among them. Returns what
// is wrong with the table, or nothing.
function addTable(viewer, name, text) {
  const [header = [], ...rows] = parseCsv(text);
  const find = (key) => header.findIndex((title) => KEYS[key].includes(title.toLowerCase()));
  const serial = find("serial"), chain = find("chain"), number = find("number");
  if (serial < 0 && number < 0) return `${name} has no column serial or residue_number`;
  const keyOf = serial >= 0 ? (row) => row[serial] : (row) => `${row[chain] ?? ""} ${row[number]}`;
  const keyOfAtom = serial >= 0 ? (one, atom) => String(one.serial[atom])
    : (one, atom) => `${chain < 0 ? "" : residueOf(one, atom)[2]} ${residueOf(one, atom)[1]}`;
  const added = header.flatMap((title, column) => {
    const key = title.toLowerCase();
    if ([...Object.values(KEYS).flat(), ...OTHER_KEYS].includes(key)) return [];
    const values = new Map(rows.filter((row) => row[column] !== "" && Number.isFinite(Number(row[column])))
      .map((row) => [keyOf(row), Number(row[column])]));
    return values.size === 0 ? [] : [addColumn(viewer, title, values, keyOfAtom)];
  });
  if (added.length === 0) return `${name} has no column of numbers`;
  if (!SCHEMES[added[0]].isFound) return `${name} names no atom or residue of this page`;
  viewer.set("color", added.find((one) => !LAST.includes(SCHEMES[one].label.toLowerCase())) ?? added[0]);
  return undefined;
}

// Adds the scheme of a column; `values` has a number for each key of an atom.
function addColumn(viewer, title, values, keyOfAtom) {
  const name = `table:${title}`, sorted = Array.from(values.values()).sort((a, b) => a - b);
  const at = (share) => sorted[Math.round(share * (sorted.length - 1))];
  const isSigned = at(0.02) < 0 && at(0.98) > 0, end = Math.max(-at(0.02), at(0.98));
  const [low, high] = isSigned ? [-end, end] : [at(0.02), at(0.98)];
  const stops = isSigned ? viewer.limits.diverging : SEQUENTIAL;
  const valueOf = (one, atom) => values.get(keyOfAtom(one, atom));
  const colorOf = (value) => value === undefined ? MISSING
    : gradientColor(stops, (value - low) / (high - low || 1));
  SCHEMES[name] = {
    label: title, has: (one) => one.touched && (one.residue || one.serial),
    isFound: viewer.molecules.some((one) => one.serial?.some((_, atom) => valueOf(one, atom) !== undefined)),
    paint: (one) => byAtom(one, (atom) => colorOf(valueOf(one, atom))),
    gradient: () => ({ stops, title,
      ticks: [`≤ ${low.toPrecision(3)}`, ((low + high) / 2).toPrecision(3), `≥ ${high.toPrecision(3)}`] }),
  };
  if (!Array.from($("color").options).some((option) => option.value === name))
    $("color").append(new Option(title, name));
  return name;
}
