// Draws the molecules side by side, with their legend, names and scale.

const STYLES = { // of atoms: factor and addition of the radius of spheres, radius of sticks
  none: null,
  sticks: { shrink: 0, add: 0.22, stick: 0.22 },
  balls: { shrink: 0.25, add: 0, stick: 0.14 },
  spheres: { shrink: 1, add: 0, stick: 0 },
};
const FILLED = 0.92; // part of the picture that the largest molecule fills
const MAX_LABELS = 40; // of a molecule; more would not be legible
const OPACITIES = { style: 45, cavities: 35 }; // per cent, of the surface around atoms and cavities
const STEPS = 1000; // of an angstrom and other numbers in the address of the page
const SAMPLES = 4; // of a pixel, which smooth edges
const SLOW_FRAME = 70; // milliseconds; slower machines draw less detail while the view changes
const WEAK_FRAME = 400; // milliseconds; such machines, without a GPU, never draw several samples
const AIM_FRAME = 35; // milliseconds of a frame with less detail
const RATIOS = [0.25, 0.5]; // range of the pixels that such a frame has for each of the page, on a side
const REST = 250; // milliseconds until the full detail is drawn again
const TURN = Math.PI / 36; // of a key
const MAX_TAP = 6; // pixels that a finger may move

const $ = (id) => document.getElementById(id);
const canvas = $("canvas");

class Viewer {
  constructor(molecules, settings, limits) {
    this.molecules = molecules;
    const { opacity_is_chosen: isOpacityChosen, ...look } = settings;
    this.look = { clip: 0, shading: true, theme: "auto", ligands: "balls", cavities: false, names: true,
      ...look };
    this.limits = { ...limits, area: largestArea(molecules) };
    this.radius = Math.max(...molecules.map((one) => one.radius_of_all));
    this.range = 1.1 * this.radius + 5; // spheres of atoms included
    this.isChanging = false;
    this.isSlow = false;
    this.isWeak = false;
    this.ratio = RATIOS[1];
    this.frames = []; // times of frames with full detail while the view changes
    this.startGraphics();
    this.reset();
    this.setTheme();
    this.fillDrawings();
    this.paint();
    this.measure();
    showLigands(this, isOpacityChosen);
  }

  // -------------------------------------------------------------------------------- graphics

  startGraphics() {
    const gl = canvas.getContext("webgl2", { antialias: false, alpha: false });
    if (!gl) throw new Error("this browser or machine has no WebGL 2");
    this.gl = gl;
    this.programs = {
      surface: makeProgram(gl, SURFACE), sphere: makeProgram(gl, SPHERE),
      stick: makeProgram(gl, STICK), occlusion: makeProgram(gl, OCCLUSION),
      composite: makeProgram(gl, COMPOSITE),
    };
    this.maxPixels = Math.min(gl.getParameter(gl.MAX_RENDERBUFFER_SIZE), 8192);
    this.empty = gl.createVertexArray();
    this.drawings = this.molecules.map((one) => makeDrawing(gl, one));
  }

  // Measures whether the machine is slow or weak.
  measure() {
    this.timeOf(16, 16); // compiles the shaders
    const time = this.timeOf(512, 512);
    this.isSlow = time > SLOW_FRAME;
    this.isWeak = time > WEAK_FRAME;
  }

  // Returns the milliseconds that a picture of this size takes.
  timeOf(width, height, options = { isShaded: false, samples: 0 }) {
    const { gl } = this, begin = performance.now();
    this.render(width, height, options);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // waits until it is drawn
    return performance.now() - begin;
  }

  // Allocates the buffers of the picture, if its size has changed.
  resize(width, height, wanted) {
    const gl = this.gl, samples = Math.min(wanted, gl.getParameter(gl.MAX_SAMPLES));
    if (this.buffers?.width === width && this.buffers.height === height
        && this.buffers.samples === samples) return;
    for (const { texture, renderbuffer, frame } of this.buffers?.parts ?? []) {
      if (texture) gl.deleteTexture(texture);
      if (renderbuffer) gl.deleteRenderbuffer(renderbuffer);
      if (frame) gl.deleteFramebuffer(frame);
    }
    const parts = [];
    const keep = (part) => { parts.push(part); return part; };
    const textured = (format) => keep({ texture: makeTexture(gl, format, width, height) });
    const rendered = (format, samples) => {
      const renderbuffer = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, renderbuffer);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, format, width, height);
      return keep({ renderbuffer });
    };
    const framed = (color, depth) => keep({ frame: makeFrame(gl, color, depth) }).frame;
    const picture = textured(gl.RGBA8), depth = textured(gl.DEPTH_COMPONENT24);
    const occlusion = textured(gl.RGBA8), numbers = textured(gl.RGBA8);
    this.buffers = {
      width, height, samples, parts, picture, depth, occlusion,
      sampled: framed(rendered(gl.RGBA8, samples), rendered(gl.DEPTH_COMPONENT24, samples)),
      resolved: framed(picture, depth),
      shade: framed(occlusion, null),
      pick: framed(numbers, rendered(gl.DEPTH_COMPONENT24, 0)),
    };
  }

  // Returns the rectangles of the molecules in a picture of this size, from the upper left.
  panels(width, height) {
    return panelsOf(this.molecules.length, width, height);
  }

  // Returns the pixels per angstrom in a picture of this size.
  scaleIn(width, height) {
    const [panel] = this.panels(width, height);
    const [x, y] = this.half;
    return this.view.zoom * FILLED * Math.min(panel.width / x, panel.room / y) / 2;
  }

  // Makes the molecules fill the picture in their present rotation.
  fit() {
    const extents = this.molecules.map((one) => extentOf(one, this.view.rotation));
    this.middles = extents.map((one) => one.middle);
    this.half = [0, 1].map((axis) => Math.max(...extents.map((one) => one.half[axis])));
    Object.assign(this.view, { pan: [0, 0], zoom: 1 });
    this.update();
  }

  // Returns where a place of a molecule is in its panel, in angstrom from the middle of the panel's room.
  onScreen(i, place) {
    const { molecules, view, middles } = this;
    const turned = apply(view.rotation, place.map((value, axis) => value - molecules[i].middle[axis]));
    return [0, 1].map((axis) => turned[axis] + view.pan[axis] - middles[i][axis]);
  }

  setView(program, i, panel, scale, isPick) {
    const gl = this.gl, { uniforms } = program, molecule = this.molecules[i];
    gl.useProgram(program.program);
    gl.uniformMatrix3fv(uniforms.u_rotation, false, this.view.rotation);
    gl.uniform3fv(uniforms.u_center, molecule.middle);
    const rise = (panel.y + panel.height / 2 - panel.middle[1]) / scale;
    gl.uniform2fv(uniforms.u_pan, this.view.pan.map((value, axis) => value - this.middles[i][axis] + axis * rise));
    gl.uniform2f(uniforms.u_scale, 2 * scale / panel.width, 2 * scale / panel.height);
    gl.uniform1f(uniforms.u_range, this.range);
    gl.uniform3fv(uniforms.u_back, this.back);
    gl.uniform1f(uniforms.u_radius, this.radius);
    gl.uniform1i(uniforms.u_pick, isPick);
  }

  // Draws all molecules into the bound frame buffer.
  drawScene(width, height, isPick) {
    const gl = this.gl, scale = this.scaleIn(width, height);
    gl.viewport(0, 0, width, height);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(...(isPick ? [0, 0, 0] : this.back), isPick ? 0 : 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.SCISSOR_TEST);
    gl.depthFunc(gl.LEQUAL);
    this.panels(width, height).forEach((panel, i) => {
      const left = Math.round(panel.x), low = Math.round(height - panel.y - panel.height);
      const size = [Math.round(panel.width), Math.round(panel.height)];
      gl.viewport(left, low, ...size);
      gl.scissor(left, low, ...size);
      const { atoms, ligands } = this.drawings[i];
      this.drawAtoms(i, atoms, this.look.style, panel, scale, isPick);
      this.drawAtoms(i, ligands, this.look.ligands, panel, scale, isPick);
      this.drawSurface(i, panel, scale, isPick);
    });
    gl.disable(gl.SCISSOR_TEST);
  }

  drawSurface(i, panel, scale, isPick) {
    const { gl, programs: { surface } } = this, molecule = this.molecules[i];
    const { outer, walls, fast } = this.drawings[i], opacity = this.look.opacity / 100;
    this.setView(surface, i, panel, scale, isPick);
    gl.uniform3fv(surface.uniforms.u_origin, molecule.origin);
    gl.uniform1f(surface.uniforms.u_step, molecule.step);
    gl.uniform1f(surface.uniforms.u_clip, this.clipPlane());
    gl.bindVertexArray(this.drawings[i].surface);
    if (this.look.cavities) this.drawParts([walls], 1, isPick);
    // The inner side of the whole surface of a structure is not seen.
    if (molecule.center && this.look.clip === 0 && !molecule.isHidden.includes(1)) gl.enable(gl.CULL_FACE);
    if (this.isReduced && fast.count > 0) this.drawParts([fast], opacity, isPick);
    else this.drawParts(this.look.cavities ? [outer] : [outer, walls], opacity, isPick);
    gl.disable(gl.CULL_FACE);
  }

  // Draws these parts of the surface that is bound.
  drawParts(parts, opacity, isPick) {
    if (opacity === 0) return;
    const { gl, programs: { surface } } = this;
    gl.uniform1f(surface.uniforms.u_opacity, opacity);
    gl.uniform1f(surface.uniforms.u_inner, this.look.cavities ? 1 : 0.55); // walls are seen from outside
    const draw = () => parts.forEach(({ first, count }) =>
      gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 4 * first));
    if (opacity < 1 && !isPick) { // only the nearest layer is blended
      gl.colorMask(false, false, false, false);
      draw();
      gl.colorMask(true, true, true, true);
      gl.enable(gl.BLEND);
      gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    }
    draw();
    gl.disable(gl.BLEND);
  }

  drawAtoms(i, drawing, name, panel, scale, isPick) {
    const { gl, programs: { sphere, stick } } = this, molecule = this.molecules[i], style = STYLES[name];
    if (!style || drawing.atoms === 0) return;
    this.setView(sphere, i, panel, scale, isPick);
    gl.uniform1f(sphere.uniforms.u_shrink, style.shrink);
    gl.uniform1f(sphere.uniforms.u_add, style.add);
    gl.uniform1ui(sphere.uniforms.u_first, molecule.vertices + 1);
    gl.bindVertexArray(drawing.spheres);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, drawing.atoms);
    if (style.stick === 0 || drawing.bonds === 0) return;
    this.setView(stick, i, panel, scale, isPick);
    gl.uniform1f(stick.uniforms.u_width, style.stick);
    gl.uniform1ui(stick.uniforms.u_first, molecule.vertices + 1);
    gl.bindVertexArray(drawing.sticks);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 2 * STICK_SIDES + 2, drawing.bonds);
  }

  // Returns the height of the clip plane above the centre.
  clipPlane() {
    return this.look.clip === 0 ? this.range : this.radius * (1 - this.look.clip / 50);
  }

  // Draws a picture of this size into the canvas.
  render(width, height, { isShaded, samples }) {
    const gl = this.gl;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    this.resize(width, height, samples);
    const { buffers, programs: { occlusion, composite } } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffers.sampled);
    this.drawScene(width, height, false);
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, buffers.sampled);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, buffers.resolved);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height,
      gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT, gl.NEAREST);
    gl.disable(gl.DEPTH_TEST);
    gl.bindVertexArray(this.empty);
    gl.viewport(0, 0, width, height);
    [buffers.depth, buffers.picture, buffers.occlusion].forEach(({ texture }, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, unit === 2 && isShaded ? null : texture);
    });
    if (isShaded) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, buffers.shade);
      gl.useProgram(occlusion.program);
      gl.uniform1i(occlusion.uniforms.u_depth, 0);
      gl.uniform1f(occlusion.uniforms.u_range, this.range);
      gl.uniform1f(occlusion.uniforms.u_pixels, this.scaleIn(width, height));
      gl.drawArrays(gl.TRIANGLES, 0, 3);
      gl.bindTexture(gl.TEXTURE_2D, buffers.occlusion.texture);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.useProgram(composite.program);
    gl.uniform1i(composite.uniforms.u_depth, 0);
    gl.uniform1i(composite.uniforms.u_picture, 1);
    gl.uniform1i(composite.uniforms.u_occlusion, 2);
    gl.uniform1f(composite.uniforms.u_range, this.range);
    gl.uniform1i(composite.uniforms.u_is_shaded, isShaded);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    this.arePicksDrawn = false;
  }

  // Draws with less detail while the view changes on a slow machine.
  draw() {
    const isReduced = this.isReduced = this.isChanging && this.isSlow;
    if (isReduced) this.addCoarseSurfaces();
    const ratio = isReduced ? this.ratio : Math.min(window.devicePixelRatio || 1, 2);
    const size = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.max(1, Math.round(ratio * side)));
    const options = { isShaded: this.look.shading, samples: this.isWeak ? 0 : SAMPLES };
    if (isReduced) { // the next frame has as many pixels as the machine can draw in time
      const change = Math.sqrt(AIM_FRAME / this.timeOf(...size));
      this.ratio = Math.min(Math.max(ratio * Math.min(change, 1.1), RATIOS[0]), RATIOS[1]);
    } else if (this.isSlow && !this.isWeak) { // it may have been busy before
      this.isSlow = this.timeOf(...size, options) > SLOW_FRAME;
    } else this.render(...size, options);
    this.showScale();
    this.showLabels();
  }

  addCoarseSurfaces() {
    const added = this.drawings.filter((drawing, i) => addCoarse(this.gl, drawing, this.molecules[i]));
    if (added.length === 0) return;
    this.fillDrawings();
    this.paint();
  }

  // Draws at the next opportunity. `isMoving` marks one of many changes.
  update(isMoving = false) {
    if (isMoving) {
      this.isChanging = true;
      clearTimeout(this.restTimer);
    }
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame((now) => {
      this.isWaiting = false;
      // Frames can begin before those before them are drawn, so that single times tell nothing.
      if (this.isChanging && !this.isSlow) this.frames.push(now);
      const { frames } = this, count = frames.length - 1;
      this.isSlow ||= count >= 4 && (frames[count] - frames[0]) / count > SLOW_FRAME;
      this.draw();
      if (this.isChanging) this.waitForRest();
    });
  }

  // Draws the full detail if the view does not change for a while after a picture, which may take longer.
  waitForRest() {
    clearTimeout(this.restTimer);
    this.restTimer = setTimeout(() => {
      this.isChanging = false;
      this.frames = [];
      this.update();
      this.keepInAddress();
    }, REST);
  }

  // Colours the vertices and atoms.
  paint() {
    this.molecules.forEach((molecule, i) => {
      fillColors(this.gl, this.drawings[i], paintVertices(molecule, this.look.color, this.limits,
        this.look.cavities && Boolean(molecule.component)));
    });
    this.showLegend();
    this.update();
  }

  // Fills the drawings with what is shown.
  fillDrawings() {
    this.molecules.forEach((molecule, i) => {
      const { atoms, ligands } = this.drawings[i];
      fillSurface(this.gl, this.drawings[i], molecule);
      if (!molecule.centers) return;
      const isLigand = (atom) => Boolean(molecule.ligand?.[atom]);
      fillAtoms(this.gl, atoms, molecule, (atom) => !isLigand(atom) && isShown(molecule, atom));
      fillAtoms(this.gl, ligands, molecule, (atom) => isLigand(atom) && isShown(molecule, atom));
    });
    this.arePicksDrawn = false;
    this.makeLabels();
    this.update();
  }

  // Shows or hides residues of a molecule.
  show(molecule, residues, isVisible) {
    for (const residue of residues) molecule.isHidden[residue] = isVisible ? 0 : 1;
    this.fillDrawings();
    this.keepInAddress();
  }

  // ---------------------------------------------------------------------------------- picking

  // Returns what is drawn at a point of the page: a text, or an empty one.
  textAt(x, y) {
    const { gl } = this, { clientWidth, clientHeight } = canvas;
    const width = canvas.width, height = canvas.height;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.buffers.pick);
    if (!this.arePicksDrawn) this.drawScene(width, height, true);
    this.arePicksDrawn = true;
    const pixel = new Uint8Array(4);
    gl.readPixels(Math.floor(x * width / clientWidth), height - 1 - Math.floor(y * height / clientHeight),
      1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    const number = pixel[0] + 256 * pixel[1] + 65536 * pixel[2];
    if (number === 0) return "";
    const molecule = this.molecules[this.panelAt(x, y).index];
    return number <= molecule.vertices ? describeVertex(molecule, number - 1)
      : describeAtom(molecule, number - 1 - molecule.vertices);
  }

  panelAt(x, y) {
    const panels = this.panels(canvas.clientWidth, canvas.clientHeight);
    const index = panels.findIndex((one) => x >= one.x && x < one.x + one.width
      && y >= one.y && y < one.y + one.height);
    return { index: Math.max(index, 0), ...panels[Math.max(index, 0)] };
  }

  // Shows the name of what is at a point, beside it.
  showTip(x, y) {
    const text = this.textAt(x, y), tip = $("tip");
    tip.hidden = text === "";
    tip.textContent = text;
    if (text === "") return;
    tip.style.left = `${Math.min(x + 14, canvas.clientWidth - tip.offsetWidth - 4)}px`;
    tip.style.top = `${Math.max(y - tip.offsetHeight - 10, 4)}px`;
  }

  hideTip() {
    $("tip").hidden = true;
  }

  // ---------------------------------------------------------------------------------- changes

  // Turns by these angles about the axes of the screen.
  turn(x, y, z = 0) {
    const { view } = this;
    view.rotation = multiply(turnAbout(2, z), multiply(turnAbout(1, y),
      multiply(turnAbout(0, x), view.rotation)));
    this.update(true);
  }

  move(x, y) { // in pixels
    const scale = this.scaleIn(canvas.clientWidth, canvas.clientHeight);
    this.view.pan = [this.view.pan[0] + x / scale, this.view.pan[1] - y / scale];
    this.update(true);
  }

  // Zooms by a factor and keeps what is at a point of the page at its place.
  zoom(factor, x, y) {
    const { clientWidth, clientHeight } = canvas;
    const panel = this.panelAt(x ?? 0, y ?? 0);
    const before = this.scaleIn(clientWidth, clientHeight);
    this.view.zoom = Math.min(Math.max(this.view.zoom * factor, 0.1), 100);
    const change = 1 / this.scaleIn(clientWidth, clientHeight) - 1 / before;
    if (x !== undefined)
      this.view.pan = [this.view.pan[0] + change * (x - panel.middle[0]),
        this.view.pan[1] - change * (y - panel.middle[1])];
    this.update(true);
  }

  // Shows the first view; `turn` replaces how it differs from a look along the shortest axis.
  reset(turn = this.firstTurn) {
    const [panel] = this.panels(canvas.clientWidth, canvas.clientHeight);
    const start = startRotation(this.molecules[0], panel.height > panel.width);
    this.firstTurn = turn;
    this.view = { rotation: turn ? multiply(turn, start) : start };
    this.fit();
    this.keepInAddress();
  }

  lookAlong(axis) {
    this.view.rotation = [0, 1, 2].flatMap((column) =>
      [0, 1, 2].map((row) => column === (axis + 1 + row) % 3 ? 1 : 0));
    this.fit();
    this.keepInAddress();
  }

  // Changes one of the settings of the panel.
  set(name, value) {
    this.look[name] = value;
    const control = $(name);
    if (control.type === "checkbox") control.checked = value;
    else control.value = value;
    if (name === "theme") this.setTheme();
    if (name === "color" || name === "cavities") this.paint();
    if (name === "cavities" || name === "names" || name === "ligands") this.makeLabels();
    if (name in OPACITIES) this.lookThrough(OPACITIES[name], value && value !== "none");
    this.update();
    this.keepInAddress();
  }

  // Makes a surface without opacity of its own transparent for what is inside, or opaque again.
  lookThrough(opacity, isInside) {
    const [from, to] = isInside ? [100, opacity] : [opacity, 100];
    if (this.look.opacity === from) this.set("opacity", to);
  }

  // ------------------------------------------------------------------------- view in the address

  // Returns the view and the settings as the end of an address.
  address() {
    const { rotation, pan, zoom } = this.view, round = (value) => Math.round(STEPS * value) / STEPS;
    const hidden = this.molecules.map(({ isHidden }) => Array.from(isHidden.keys()).filter((i) => isHidden[i]));
    return encodeURIComponent(JSON.stringify({ look: this.look, rotation: rotation.map(round),
      pan: pan.map(round), zoom: round(zoom), half: this.half.map(round), middles: this.middles, hidden }));
  }

  keepInAddress() {
    clearTimeout(this.addressTimer); // browsers limit how often an address may change
    this.addressTimer = setTimeout(() => {
      try { history.replaceState(null, "", `#${this.address()}`); } catch { /* a frame without an address */ }
    }, REST);
  }

  // Restores what address() has returned; an address of another page is left alone.
  restore(text) {
    let kept;
    try { kept = JSON.parse(decodeURIComponent(text)); } catch { return; }
    if (kept?.hidden?.length !== this.molecules.length || kept.rotation?.length !== 9) return;
    kept.hidden.forEach((residues, i) => residues.forEach((residue) => {
      this.molecules[i].isHidden[residue] = 1;
    }));
    this.fillDrawings();
    const { look, rotation, pan, zoom, half, middles } = kept;
    for (const [name, value] of Object.entries(look)) if (isPossible(name, value)) this.set(name, value);
    Object.assign(this, { half, middles, view: { rotation, pan, zoom } });
    this.update();
  }

  setTheme() {
    const isDark = this.look.theme === "dark" || (this.look.theme === "auto"
      && matchMedia("(prefers-color-scheme: dark)").matches);
    document.documentElement.dataset.theme = isDark ? "dark" : "light";
    const code = parseInt(getComputedStyle(document.documentElement).getPropertyValue("--back")
      .trim().slice(1), 16);
    this.back = [code >> 16, code >> 8 & 255, code & 255].map((value) => value / 255);
    this.update();
  }

  // ----------------------------------------------------------------------------- text and PNG

  showScale() {
    const bar = scaleBar(this.scaleIn(canvas.clientWidth, canvas.clientHeight), 140);
    $("scale-text").textContent = this.isReduced ? `${bar.text}, less detail while it moves` : bar.text;
    $("scale-bar").style.width = `${bar.width}px`;
  }

  // Collects the names of ligands and cavities that are shown.
  makeLabels() {
    const { names, ligands, cavities } = this.look;
    const elements = this.molecules.flatMap((molecule, i) =>
      labelsOf(molecule, { areLigands: names && ligands !== "none", areCavities: cavities })
        .slice(0, MAX_LABELS).map(({ text, place, residue }) => ({ i, place, residue, box: element("div", text) })));
    $("labels").replaceChildren(...elements.map(({ box }) => box));
    this.labels = elements.map((one) => ({ ...one, width: one.box.offsetWidth, height: one.box.offsetHeight }));
  }

  // Returns the labels that are shown, with their upper left corners.
  visibleLabels() {
    const { clientWidth, clientHeight } = canvas, panels = this.panels(clientWidth, clientHeight);
    const scale = this.scaleIn(clientWidth, clientHeight);
    const isSeen = ligandFilter(this);
    return placeLabels(this.labels.filter(isSeen).map((label) => {
      const [x, y] = this.onScreen(label.i, label.place), panel = panels[label.i];
      return { ...label, panel, x: panel.middle[0] + scale * x, y: panel.middle[1] - scale * y };
    }));
  }

  showLabels() {
    for (const { box } of this.labels) box.hidden = true;
    for (const { box, left, top } of this.visibleLabels()) {
      box.hidden = false;
      box.style.transform = `translate(${left}px, ${top}px)`;
    }
  }

  legend() {
    const scheme = SCHEMES[this.look.color];
    return {
      entries: legendEntries(this.molecules, this.look.color, this.limits),
      gradient: scheme.gradient?.(this.limits),
    };
  }

  showLegend() {
    const { entries, gradient } = this.legend(), legend = $("legend");
    legend.replaceChildren(...entries.map(([name, color]) => {
      const square = element("i");
      square.style.background = `rgb(${color})`;
      const line = element("div", name);
      line.prepend(square);
      return line;
    }));
    canvas.classList.toggle("beside-legend", entries.length > MAX_OVER); // changes its width
    if (!gradient) return;
    const bar = element("div", "", "gradient"), ticks = element("div", "", "ticks");
    bar.style.background =
      `linear-gradient(to right, ${gradient.stops.map((color) => `rgb(${color})`)})`;
    ticks.append(...gradient.ticks.map((text) => element("span", text)));
    legend.append(element("div", gradient.title), bar, ticks);
  }

  showNames() {
    const { clientWidth, clientHeight } = canvas;
    $("titles").replaceChildren(...this.panels(clientWidth, clientHeight).map((panel, i) => {
      const name = element("div", this.molecules[i].name);
      name.append(element("small", this.molecules[i].facts));
      Object.assign(name.style, { left: `${panel.x}px`, top: `${panel.y}px`, width: `${panel.width}px` });
      return name;
    }));
  }

  // Returns a canvas with the picture, the names, the scale bar and the legend.
  picture() {
    return pictureOf(this);
  }

  save() {
    this.picture().toBlob((blob) => {
      const link = document.createElement("a");
      link.href = URL.createObjectURL(blob);
      link.download = `${document.title.replace(/[^\w.-]+/g, "_") || "surface"}.png`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    }, "image/png");
  }
}
