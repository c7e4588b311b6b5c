// Handles mouse, touch, keyboard and controls, and starts the viewer.

function element(tag, text = "", className = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  made.className = className;
  return made;
}

function listenToPointers(viewer) {
  const fingers = new Map();
  let moved = 0, hovered = null;

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (fingers.size === 1) moved = 0;
    viewer.hideTip();
  });
  canvas.addEventListener("pointermove", (event) => {
    const here = [event.offsetX, event.offsetY], before = fingers.get(event.pointerId);
    if (!before) {
      if (hovered === null) requestAnimationFrame(() => {
        if (hovered && !viewer.isChanging) viewer.showTip(...hovered);
        hovered = null;
      });
      hovered = here;
      return;
    }
    const [x, y] = [here[0] - before[0], here[1] - before[1]];
    moved += Math.hypot(x, y);
    if (fingers.size === 2) {
      const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
      pinch(viewer, other, before, here);
    } else if (fingers.size === 1 && (event.shiftKey || event.buttons & 6)) {
      viewer.move(x, y);
    } else if (fingers.size === 1) {
      const speed = 2.5 / Math.min(canvas.clientWidth, canvas.clientHeight);
      viewer.turn(speed * y, speed * x);
    }
    fingers.set(event.pointerId, here);
  });
  const end = (event) => {
    fingers.delete(event.pointerId);
    if (event.type === "pointerup" && event.pointerType !== "mouse" && moved < MAX_TAP)
      viewer.showTip(event.offsetX, event.offsetY);
  };
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
  canvas.addEventListener("pointerleave", () => { hovered = null; viewer.hideTip(); });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1);
    viewer.hideTip();
    viewer.zoom(Math.exp(-pixels / 600), event.offsetX, event.offsetY);
  }, { passive: false });
}

// One of two fingers moves from `before` to `here`: zooms, turns and moves.
function pinch(viewer, other, before, here) {
  const arm = (point) => [point[0] - other[0], point[1] - other[1]];
  const [a, b] = [arm(before), arm(here)];
  const middle = [(other[0] + here[0]) / 2, (other[1] + here[1]) / 2];
  viewer.zoom(Math.hypot(...b) / Math.max(Math.hypot(...a), 1), ...middle);
  viewer.move((here[0] - before[0]) / 2, (here[1] - before[1]) / 2);
  viewer.turn(0, 0, Math.atan2(a[1], a[0]) - Math.atan2(b[1], b[0]));
}

function step(viewer, name, direction) {
  const values = Array.from($(name).options, (option) => option.value);
  viewer.set(name, values[(values.indexOf(viewer.look[name]) + direction + values.length) % values.length]);
  $("spoken").textContent = $(name).selectedOptions[0].textContent;
}

function slide(viewer, name, change) {
  viewer.set(name, Math.min(Math.max(viewer.look[name] + change, 0), 100));
}

function listenToKeys(viewer) {
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const actions = {
    "+": () => viewer.zoom(1.15), "=": () => viewer.zoom(1.15), "-": () => viewer.zoom(1 / 1.15),
    ",": () => viewer.turn(0, 0, TURN), ".": () => viewer.turn(0, 0, -TURN),
    "[": () => slide(viewer, "clip", -2), "]": () => slide(viewer, "clip", 2),
    x: () => viewer.lookAlong(0), y: () => viewer.lookAlong(1), z: () => viewer.lookAlong(2),
    v: () => { if (!$("cavities").hidden) viewer.set("cavities", !viewer.look.cavities); },
    c: () => step(viewer, "color", 1), a: () => step(viewer, "style", 1),
    r: () => viewer.reset(), Home: () => viewer.reset(), s: () => viewer.save(),
    "?": () => $("keys").showModal(),
    Enter: () => {
      const [x, y] = [canvas.clientWidth / 2, canvas.clientHeight / 2];
      viewer.showTip(x, y);
      $("spoken").textContent = $("tip").hidden ? "nothing in the centre" : $("tip").textContent;
    },
  };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const arrow = arrows[event.key];
    if (arrow && event.shiftKey) viewer.move(30 * arrow[0], 30 * arrow[1]);
    else if (arrow) viewer.turn(TURN * arrow[1], TURN * arrow[0]);
    else if (actions[event.key]) actions[event.key]();
    else return;
    if (event.key !== "Enter") viewer.hideTip();
    event.preventDefault();
  });
}

function listenToControls(viewer) {
  for (const name of ["color", "style", "theme", "ligands"])
    $(name).addEventListener("change", (event) => viewer.set(name, event.target.value));
  for (const name of ["opacity", "clip"])
    $(name).addEventListener("input", (event) => viewer.set(name, Number(event.target.value)));
  for (const name of ["shading", "cavities", "names"])
    $(name).addEventListener("change", (event) => viewer.set(name, event.target.checked));
  $("open").addEventListener("click", () => $("table").click());
  $("table").addEventListener("change", (event) => openTable(viewer, event.target.files[0]));
  $("reset").addEventListener("click", () => viewer.reset());
  $("save").addEventListener("click", () => viewer.save());
  $("help").addEventListener("click", () => $("keys").showModal());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => viewer.setTheme());
  new ResizeObserver(() => { viewer.showNames(); viewer.update(); }).observe(canvas);
  canvas.addEventListener("webglcontextlost", () => {
    $("message").textContent = "The graphics hardware was reset. Reload the page.";
  });
}

// Whether a control can take a value that an address names.
function isPossible(name, value) {
  const control = $(name);
  if (control?.type === "checkbox") return typeof value === "boolean";
  if (control?.type === "range") return value >= 0 && value <= 100;
  return Array.from(control?.options ?? [], (option) => option.value).includes(value);
}

function hideControls(name, isHidden) {
  $(name).hidden = isHidden;
  document.querySelector(`label[for="${name}"]`).hidden = isHidden;
}

// Returns the viewer when all molecules are read.
async function start() {
  const { settings, limits, table, molecules: infos } = JSON.parse($("molecules").textContent);
  if (typeof DecompressionStream === "undefined")
    throw new Error("this browser is too old: it has no DecompressionStream");
  const molecules = [];
  for (const [i, info] of infos.entries()) {
    const source = $(`arrays-${i}`);
    molecules.push(await readMolecule(info, source.textContent));
    source.remove();
  }
  for (const [name, scheme] of Object.entries(SCHEMES))
    if (molecules.some(scheme.has)) $("color").append(new Option(scheme.label, name));
  const names = Array.from($("color").options, (option) => option.value);
  if (!names.includes(settings.color)) settings.color = names[0];
  if (!molecules.some((one) => one.centers)) {
    $("style").disabled = true;
    settings.style = "none";
  }
  hideControls("ligands", !molecules.some((one) => one.ligand));
  hideControls("names", !molecules.some((one) => one.ligand));
  hideControls("cavities", !molecules.some((one) => one.component?.some((number) => number > 0)));
  hideControls("open", !molecules.some((one) => one.residue));
  if (window.innerWidth < 640) $("panel").open = false;
  const viewer = new Viewer(molecules, settings, limits);
  for (const name of ["color", "style", "opacity", "ligands"]) $(name).value = viewer.look[name];
  if (table) addTable(viewer, table.name, table.text);
  viewer.showNames();
  viewer.restore(location.hash.slice(1));
  listParts(viewer);
  listenToPointers(viewer);
  listenToKeys(viewer);
  listenToControls(viewer);
  $("message").textContent = "";
  return viewer;
}

// For scripts and tests: a promise of the viewer.
window.eses = start();
window.eses.catch((error) => {
  $("message").textContent = `The surface cannot be drawn: ${error.message}.`;
});
