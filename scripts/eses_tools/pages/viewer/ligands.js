// Finds which ligands are seen, and a first view that shows them.

const SEEN_SIDE = 320; // pixels of the longer side of a picture that tells which ligands are seen
// Turns of the first view about the axes of the screen, and how well they suit the picture: less if they
// turn the longest axis away from its longer side.
const FIRST_TURNS = [[0, 0, 1], [0, Math.PI, 0.98], [Math.PI / 2, 0, 0.85], [-Math.PI / 2, 0, 0.85],
  [0, Math.PI / 2, 0.7], [0, -Math.PI / 2, 0.7]];
const ENOUGH_SEEN = 0.75; // of what the best view shows of the ligands, for the first of the turns
const MIN_SEEN = 0.2; // part of the ligands that must be seen, or the surface becomes transparent

// Turns the molecules of a viewer such that most of their ligands are seen. If all are buried, the surface
// becomes transparent, unless its opacity was chosen.
function showLigands(viewer, isOpacityChosen) {
  const { look, molecules } = viewer;
  if (look.ligands === "none" || look.opacity < 100 || !molecules.some((one) => one.ligand)) return;
  viewer.isReduced = viewer.isSlow;
  if (viewer.isReduced) viewer.addCoarseSurfaces();
  const views = FIRST_TURNS.map(([x, y, suits]) => {
    const turn = multiply(turnAbout(1, y), turnAbout(0, x));
    viewer.reset(turn);
    const seen = shareOfLigands(viewer);
    return { turn, seen, value: suits * seen };
  });
  const best = views.reduce((one, other) => other.value > one.value ? other : one);
  const chosen = views[0].seen >= ENOUGH_SEEN * best.value ? views[0] : best;
  viewer.isReduced = false;
  viewer.reset(chosen.turn);
  if (chosen.seen < MIN_SEEN && !isOpacityChosen) viewer.set("opacity", OPACITIES.style);
}

// Returns the part of the ligands that the surface does not hide.
function shareOfLigands(viewer) {
  const count = () => seenLigands(viewer).reduce((sum, residues) =>
    [...residues.values()].reduce((a, b) => a + b, sum), 0);
  const { look } = viewer, { opacity } = look, seen = count();
  look.opacity = 0;
  const all = count();
  look.opacity = opacity;
  return seen / Math.max(all, 1);
}

// Returns for each molecule the residues of its ligands that are seen, and the pixels of each.
function seenLigands(viewer) {
  const { gl, buffers, molecules } = viewer, { clientWidth, clientHeight } = canvas;
  const scale = Math.min(SEEN_SIDE / Math.max(clientWidth, clientHeight, 1), canvas.width / Math.max(clientWidth, 1));
  const [width, height] = [clientWidth, clientHeight].map((side) => Math.max(1, Math.floor(scale * side)));
  gl.bindFramebuffer(gl.FRAMEBUFFER, buffers.pick);
  viewer.drawScene(width, height, true);
  viewer.arePicksDrawn = false;
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  const panels = viewer.panels(width, height);
  return molecules.map(({ ligand, residue, vertices }, i) => {
    const seen = new Map(), { x, y, width: across, height: down } = panels[i];
    for (let row = Math.ceil(y); row < Math.floor(y + down); row++)
      for (let column = Math.ceil(x); column < Math.floor(x + across); column++) {
        const at = 4 * ((height - 1 - row) * width + column);
        const atom = pixels[at] + 256 * pixels[at + 1] + 65536 * pixels[at + 2] - 1 - vertices;
        if (atom >= 0 && ligand?.[atom]) seen.set(residue[atom], (seen.get(residue[atom]) ?? 0) + 1);
      }
    return seen;
  });
}

// Returns a function that tells whether the surface leaves the ligand of a label visible. While the view
// changes, it is that of the view before.
function ligandFilter(viewer) {
  if (viewer.look.opacity < 100 || viewer.labels.every(({ residue }) => residue === undefined)) return () => true;
  if (!viewer.isChanging || !viewer.seen) viewer.seen = seenLigands(viewer);
  return ({ i, residue }) => residue === undefined || viewer.seen[i].has(residue);
}
