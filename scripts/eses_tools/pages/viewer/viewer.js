// Draws the molecules side by side and handles mouse, touch and keyboard.

const STYLES = { // of atoms: factor and addition of the radius of spheres, radius of sticks
  none: null,
  sticks: { shrink: 0, add: 0.22, stick: 0.22 },
  balls: { shrink: 0.25, add: 0, stick: 0.14 },
  spheres: { shrink: 1, add: 0, stick: 0 },
};
const STICK_SIDES = 12;
const FILLED = 0.97; // part of the picture that the sphere around the largest molecule fills
const SAMPLES = 4; // of a pixel, which smooth edges
const SLOW_FRAME = 70; // milliseconds; slower machines draw less detail while the view changes
const WEAK_FRAME = 400; // milliseconds; such machines, without a GPU, never draw several samples
const REST = 250; // milliseconds until the full detail is drawn again
const TURN = Math.PI / 36; // of a key
const MIN_PICTURE = 2000; // pixels; width of saved pictures
const MAX_TAP = 6; // pixels that a finger may move

const $ = (id) => document.getElementById(id);
const canvas = $("canvas");

class Viewer {
  constructor(molecules, settings, limits) {
    this.molecules = molecules;
    this.view = { rotation: startRotation(), pan: [0, 0], zoom: 1 };
    this.look = { clip: 0, shading: true, theme: "auto", ...settings };
    this.limits = { ...limits, area: largestArea(molecules) };
    this.radius = Math.max(...molecules.map((one) => one.radius_of_all));
    this.range = 1.1 * this.radius + 5; // spheres of atoms included
    this.isChanging = false;
    this.isSlow = false;
    this.isWeak = false;
    this.lastFrame = 0;
    this.startGraphics();
    this.setTheme();
    this.paint();
    this.measure();
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

  // Measures whether the machine is weak.
  measure() {
    const pixel = new Uint8Array(4), { gl } = this;
    const time = (size) => {
      const begin = performance.now();
      this.render(size, size, { isShaded: false, samples: 0 });
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // waits until it is drawn
      return performance.now() - begin;
    };
    time(16); // compiles the shaders
    this.isWeak = time(512) > WEAK_FRAME;
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
    const count = this.molecules.length;
    const sizes = Array.from({ length: count }, (_, i) => [i + 1, Math.ceil(count / (i + 1))]);
    const side = ([columns, rows]) => Math.min(width / columns, height / rows);
    const [columns, rows] = sizes.reduce((best, one) => side(one) > side(best) ? one : best);
    return this.molecules.map((_, i) => ({
      x: i % columns * width / columns, y: Math.floor(i / columns) * height / rows,
      width: width / columns, height: height / rows,
    }));
  }

  // Returns the pixels per angstrom in a picture of this size.
  scaleIn(width, height) {
    const [panel] = this.panels(width, height);
    return this.view.zoom * FILLED * Math.min(panel.width, panel.height) / (2 * this.radius);
  }

  setView(program, molecule, panel, scale, isPick) {
    const gl = this.gl, { uniforms } = program;
    gl.useProgram(program.program);
    gl.uniformMatrix3fv(uniforms.u_rotation, false, this.view.rotation);
    gl.uniform3fv(uniforms.u_center, molecule.middle);
    gl.uniform2fv(uniforms.u_pan, this.view.pan);
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
      this.drawAtoms(i, panel, scale, isPick);
      this.drawSurface(i, panel, scale, isPick);
    });
    gl.disable(gl.SCISSOR_TEST);
  }

  drawSurface(i, panel, scale, isPick) {
    const { gl, programs: { surface } } = this, molecule = this.molecules[i];
    const opacity = this.look.opacity / 100;
    if (opacity === 0) return;
    this.setView(surface, molecule, panel, scale, isPick);
    gl.uniform3fv(surface.uniforms.u_origin, molecule.origin);
    gl.uniform1f(surface.uniforms.u_step, molecule.step);
    gl.uniform1f(surface.uniforms.u_clip, this.clipPlane());
    gl.uniform1f(surface.uniforms.u_opacity, opacity);
    gl.bindVertexArray(this.drawings[i].surface);
    const draw = () => gl.drawElements(gl.TRIANGLES, 3 * molecule.triangles, gl.UNSIGNED_INT, 0);
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

  drawAtoms(i, panel, scale, isPick) {
    const { gl, programs: { sphere, stick } } = this, molecule = this.molecules[i];
    const style = STYLES[this.look.style], drawing = this.drawings[i];
    if (!style || !molecule.centers) return;
    this.setView(sphere, molecule, panel, scale, isPick);
    gl.uniform1f(sphere.uniforms.u_shrink, style.shrink);
    gl.uniform1f(sphere.uniforms.u_add, style.add);
    gl.uniform1ui(sphere.uniforms.u_first, molecule.vertices + 1);
    gl.bindVertexArray(drawing.spheres);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, molecule.radius.length);
    if (style.stick === 0 || molecule.bonds.length === 0) return;
    this.setView(stick, molecule, panel, scale, isPick);
    gl.uniform1f(stick.uniforms.u_width, style.stick);
    gl.uniform1ui(stick.uniforms.u_first, molecule.vertices + 1);
    gl.bindVertexArray(drawing.sticks);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 2 * STICK_SIDES + 2, molecule.bonds.length / 2);
  }

  // Returns the height of the clip plane above the centre.
  clipPlane() {
    return this.look.clip === 0 ? this.range : this.radius * (1 - this.look.clip / 50);
  }

  // Draws a picture of this size into the canvas.
  render(width, height, { isShaded, samples }) {
    const gl = this.gl;
    canvas.width = width;
    canvas.height = height;
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
    const isReduced = this.isChanging && this.isSlow;
    const ratio = isReduced ? 0.5 : Math.min(window.devicePixelRatio || 1, 2);
    const isShaded = this.look.shading && !isReduced;
    const { clientWidth, clientHeight } = canvas;
    this.render(Math.max(1, Math.round(ratio * clientWidth)),
      Math.max(1, Math.round(ratio * clientHeight)),
      { isShaded, samples: isReduced || this.isWeak ? 0 : SAMPLES });
    this.showScale();
  }

  // Draws at the next opportunity. `isMoving` marks one of many changes.
  update(isMoving = false) {
    if (isMoving) {
      this.isChanging = true;
      clearTimeout(this.restTimer);
      this.restTimer = setTimeout(() => {
        this.isChanging = false;
        this.lastFrame = 0;
        this.update();
      }, REST);
    }
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame((now) => {
      this.isWaiting = false;
      if (this.isChanging && this.lastFrame) this.isSlow = now - this.lastFrame > SLOW_FRAME;
      this.lastFrame = this.isChanging ? now : 0;
      this.draw();
    });
  }

  // Colours the vertices and atoms.
  paint() {
    const gl = this.gl;
    this.molecules.forEach((molecule, i) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.drawings[i].colors);
      gl.bufferData(gl.ARRAY_BUFFER, paintVertices(molecule, this.look.color, this.limits),
        gl.STATIC_DRAW);
    });
    this.showLegend();
    this.update();
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
      this.view.pan = [this.view.pan[0] + change * (x - panel.x - panel.width / 2),
        this.view.pan[1] - change * (y - panel.y - panel.height / 2)];
    this.update(true);
  }

  reset() {
    this.view = { rotation: startRotation(), pan: [0, 0], zoom: 1 };
    this.update();
  }

  lookAlong(axis) {
    this.view.rotation = [0, 1, 2].flatMap((column) =>
      [0, 1, 2].map((row) => column === (axis + 1 + row) % 3 ? 1 : 0));
    this.update();
  }

  // Changes one of the settings of the panel.
  set(name, value) {
    this.look[name] = value;
    const control = $(name);
    if (control.type === "checkbox") control.checked = value;
    else control.value = value;
    if (name === "theme") this.setTheme();
    if (name === "color") this.paint();
    if (name === "style" && value !== "none" && this.look.opacity === 100) this.set("opacity", 45);
    if (name === "style" && value === "none" && this.look.opacity === 45) this.set("opacity", 100);
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

  // Returns length and pixels of a scale bar of about `pixels`.
  scaleBar(scale, pixels) {
    const power = 10 ** Math.floor(Math.log10(pixels / scale));
    const length = power * [5, 2, 1].find((one) => one * power * scale <= pixels);
    return { text: `${length.toLocaleString("en")} Å`, width: length * scale };
  }

  showScale() {
    const bar = this.scaleBar(this.scaleIn(canvas.clientWidth, canvas.clientHeight), 140);
    $("scale-text").textContent = bar.text;
    $("scale-bar").style.width = `${bar.width}px`;
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
    if (!gradient) return;
    const bar = element("div", "", "gradient"), ticks = element("div", "", "ticks");
    bar.style.background =
      `linear-gradient(to right, ${gradient.stops.map((color) => `rgb(${color})`)})`;
    ticks.append(...gradient.ticks.map((text) => element("span", text)));
    legend.append(element("div", gradient.title), bar, ticks);
  }

  showNames() {
    const { clientWidth, clientHeight } = canvas;
    $("names").replaceChildren(...this.panels(clientWidth, clientHeight).map((panel, i) => {
      const name = element("div", this.molecules[i].name);
      name.append(element("small", this.molecules[i].facts));
      Object.assign(name.style, { left: `${panel.x}px`, top: `${panel.y}px`, width: `${panel.width}px` });
      return name;
    }));
  }

  // Returns a canvas with the picture, the names, the scale bar and the legend.
  picture() {
    const { clientWidth, clientHeight } = canvas;
    const factor = Math.min(Math.max(MIN_PICTURE / clientWidth, window.devicePixelRatio || 1),
      this.maxPixels / Math.max(clientWidth, clientHeight));
    const width = Math.round(factor * clientWidth), height = Math.round(factor * clientHeight);
    this.render(width, height, { isShaded: this.look.shading, samples: SAMPLES });
    const page = document.createElement("canvas");
    page.width = width;
    page.height = height;
    const pen = page.getContext("2d");
    pen.drawImage(canvas, 0, 0);
    this.draw();
    pen.scale(factor, factor);
    pen.font = "15px sans-serif";
    pen.fillStyle = getComputedStyle(document.body).color;
    pen.textAlign = "center";
    if (this.molecules.length > 1)
      this.panels(clientWidth, clientHeight).forEach((panel, i) =>
        pen.fillText(this.molecules[i].name, panel.x + panel.width / 2, panel.y + 24));
    pen.textAlign = "left";
    const bar = this.scaleBar(this.scaleIn(clientWidth, clientHeight), 140);
    pen.fillText(bar.text, 16, clientHeight - 28);
    pen.fillRect(16, clientHeight - 20, bar.width, 3);
    this.drawLegend(pen, clientWidth, clientHeight);
    return page;
  }

  drawLegend(pen, width, height) {
    const { entries, gradient } = this.legend();
    const lines = entries.map(([name]) => pen.measureText(name).width);
    const left = width - 40 - Math.max(...lines, 0);
    entries.forEach(([name, color], i) => {
      const y = height - 20 - 21 * (entries.length - 1 - i);
      const text = pen.fillStyle;
      pen.fillStyle = `rgb(${color})`;
      pen.fillRect(left, y - 12, 13, 13);
      pen.fillStyle = text;
      pen.fillText(name, left + 20, y);
    });
    if (!gradient) return;
    const text = pen.fillStyle, from = width - 240, ramp = pen.createLinearGradient(from, 0, from + 220, 0);
    gradient.stops.forEach((color, i) =>
      ramp.addColorStop(i / (gradient.stops.length - 1), `rgb(${color})`));
    pen.fillStyle = ramp;
    pen.fillRect(from, height - 54, 220, 14);
    pen.fillStyle = text;
    pen.fillText(gradient.title, from, height - 62);
    gradient.ticks.forEach((tick, i) => {
      pen.textAlign = ["left", "center", "right"][i];
      pen.fillText(tick, from + 110 * i, height - 22);
    });
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

// The view of scripts/render: along y, with z upwards, turned a little.
function startRotation() {
  return multiply(turnAbout(0, Math.PI / 9), multiply(turnAbout(1, -Math.PI / 6),
    turnAbout(0, -Math.PI / 2)));
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

// Returns the vertex arrays of a molecule, and the buffer for colours of vertices.
function makeDrawing(gl, molecule) {
  const surface = gl.createVertexArray(), colors = gl.createBuffer();
  const rows = new Uint16Array(6 * molecule.vertices); // x, y, z, 0, normal: aligned to 4 bytes
  for (let i = 0; i < molecule.vertices; i++) {
    for (let axis = 0; axis < 3; axis++) rows[6 * i + axis] = molecule.place[3 * i + axis];
    for (let part = 0; part < 2; part++) rows[6 * i + 4 + part] = molecule.normal[2 * i + part];
  }
  gl.bindVertexArray(surface);
  const vertices = makeBuffer(gl, rows);
  attribute(gl, 0, vertices, 3, gl.UNSIGNED_SHORT, { stride: 12 });
  attribute(gl, 1, vertices, 2, gl.UNSIGNED_SHORT, { stride: 12, offset: 8 });
  attribute(gl, 2, colors, 3, gl.UNSIGNED_BYTE, { stride: 4, isColor: true });
  attribute(gl, 3, colors, 1, gl.UNSIGNED_BYTE, { stride: 4, offset: 3 });
  makeBuffer(gl, molecule.triangle, gl.ELEMENT_ARRAY_BUFFER);
  gl.bindVertexArray(null);
  return { surface, colors, ...(molecule.centers ? makeAtomDrawing(gl, molecule) : {}) };
}

function makeAtomDrawing(gl, { centers, radius, bonds, elements, element: kinds }) {
  const spheres = gl.createVertexArray(), sticks = gl.createVertexArray();
  const places = Float32Array.from({ length: 4 * radius.length }, (_, i) =>
    i % 4 < 3 ? centers[3 * (i >> 2) + i % 4] : radius[i >> 2] / 1000);
  const colorOf = elements.map(elementColor);
  const atomColors = Uint8Array.from({ length: 4 * radius.length }, (_, i) =>
    colorOf[kinds[i >> 2]][i % 4] ?? 255);
  gl.bindVertexArray(spheres);
  attribute(gl, 0, makeBuffer(gl, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1])), 2, gl.FLOAT);
  attribute(gl, 1, makeBuffer(gl, places), 4, gl.FLOAT, { divisor: 1 });
  attribute(gl, 2, makeBuffer(gl, atomColors), 3, gl.UNSIGNED_BYTE,
    { stride: 4, divisor: 1, isColor: true });

  const corners = Float32Array.from({ length: 3 * (2 * STICK_SIDES + 2) }, (_, i) => {
    const corner = Math.floor(i / 3), angle = 2 * Math.PI * (corner >> 1) / STICK_SIDES;
    return [Math.cos(angle), Math.sin(angle), corner % 2][i % 3];
  });
  const ends = Float32Array.from({ length: 3 * bonds.length }, (_, i) =>
    centers[3 * bonds[Math.floor(i / 3)] + i % 3]);
  const endColors = Uint8Array.from({ length: 4 * bonds.length }, (_, i) =>
    atomColors[4 * bonds[i >> 2] + i % 4]);
  gl.bindVertexArray(sticks);
  attribute(gl, 0, makeBuffer(gl, corners), 3, gl.FLOAT);
  const endBuffer = makeBuffer(gl, ends), colorBuffer = makeBuffer(gl, endColors);
  for (const end of [0, 1]) {
    attribute(gl, 1 + end, endBuffer, 3, gl.FLOAT, { stride: 24, offset: 12 * end, divisor: 1 });
    attribute(gl, 3 + end, colorBuffer, 3, gl.UNSIGNED_BYTE,
      { stride: 8, offset: 4 * end, divisor: 1, isColor: true });
  }
  attribute(gl, 5, makeBuffer(gl, bonds), 2, gl.UNSIGNED_INT, { divisor: 1, isInteger: true });
  gl.bindVertexArray(null);
  return { spheres, sticks };
}

// ---------------------------------------------------------------------------------------- input

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
  for (const name of ["color", "style", "theme"])
    $(name).addEventListener("change", (event) => viewer.set(name, event.target.value));
  for (const name of ["opacity", "clip"])
    $(name).addEventListener("input", (event) => viewer.set(name, Number(event.target.value)));
  $("shading").addEventListener("change", (event) => viewer.set("shading", event.target.checked));
  $("reset").addEventListener("click", () => viewer.reset());
  $("save").addEventListener("click", () => viewer.save());
  $("help").addEventListener("click", () => $("keys").showModal());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => viewer.setTheme());
  new ResizeObserver(() => { viewer.showNames(); viewer.update(); }).observe(canvas);
  canvas.addEventListener("webglcontextlost", () => {
    $("message").textContent = "The graphics hardware was reset. Reload the page.";
  });
}

// Returns the viewer when all molecules are read.
async function start() {
  const { settings, limits, molecules: infos } = JSON.parse($("molecules").textContent);
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
  if (window.innerWidth < 640) $("panel").open = false;
  const viewer = new Viewer(molecules, settings, limits);
  for (const name of ["color", "style", "opacity"]) $(name).value = settings[name];
  viewer.showNames();
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
