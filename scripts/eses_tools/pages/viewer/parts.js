// Lists chains and residues, which boxes show and hide.

const MAX_FOUND = 200; // residues in the list of those that were searched for

// Returns the chains of a molecule with their residues, in the order of the file.
function chainsOf(molecule) {
  const chains = new Map();
  molecule.residues.forEach(([, , chain], residue) => {
    if (!chains.has(chain)) chains.set(chain, []);
    chains.get(chain).push(residue);
  });
  return chains;
}

function listParts(viewer) {
  const named = viewer.molecules.filter((one) => one.residues);
  if (named.length === 0) return;
  $("parts").hidden = false;
  const list = $("parts").querySelector("ul");
  const fill = () => {
    const wanted = $("wanted").value.trim().toUpperCase();
    list.replaceChildren(...named.flatMap((molecule) =>
      wanted ? foundResidues(viewer, molecule, wanted) : chainItems(viewer, molecule)));
  };
  $("wanted").addEventListener("input", fill);
  fill();
}

function chainItems(viewer, molecule) {
  return Array.from(chainsOf(molecule), ([chain, residues]) => {
    const item = makeItem(viewer, molecule, residues, chain ? `chain ${chain}` : "no chain");
    const inner = element("ul"), more = element("button", "residues");
    more.type = "button";
    more.setAttribute("aria-expanded", "false");
    more.addEventListener("click", () => {
      const isOpen = more.getAttribute("aria-expanded") === "true";
      more.setAttribute("aria-expanded", String(!isOpen));
      inner.replaceChildren(...(isOpen ? [] : residues.map((residue) =>
        residueItem(viewer, molecule, residue))));
    });
    item.append(" ", more, inner);
    return item;
  });
}

function residueItem(viewer, molecule, residue) {
  return makeItem(viewer, molecule, [residue], molecule.residues[residue].join(" ").trim());
}

// Returns the residues whose number, name, or chain and number are wanted.
function foundResidues(viewer, molecule, wanted) {
  const words = wanted.split(/[\s:/]+/);
  const found = Array.from(molecule.residues.keys()).filter((residue) => {
    const parts = molecule.residues[residue].map((part) => part.toUpperCase());
    return words.every((word) => parts.includes(word));
  });
  return found.slice(0, MAX_FOUND).map((residue) => residueItem(viewer, molecule, residue));
}

// Returns a line with a box that shows and hides residues.
function makeItem(viewer, molecule, residues, text) {
  const item = element("li"), label = element("label"), box = element("input");
  box.type = "checkbox";
  box.checked = residues.some((residue) => !molecule.isHidden[residue]);
  box.addEventListener("change", () => {
    viewer.show(molecule, residues, box.checked);
    for (const other of item.querySelectorAll("ul input")) other.checked = box.checked;
  });
  label.append(box, text);
  item.append(label);
  return item;
}
