// Draws the picture that is saved.

const MAX_OVER = 8; // entries of a legend that may cover a part of the molecule
const MIN_PICTURE = 2000; // pixels; width of saved pictures

// Returns length and pixels of a scale bar of about `pixels`.
function scaleBar(scale, pixels) {
  const power = 10 ** Math.floor(Math.log10(pixels / scale));
  const length = power * [5, 2, 1].find((one) => one * power * scale <= pixels);
  return { text: `${length.toLocaleString("en")} Å`, width: length * scale };
}

// Returns a canvas with the picture of a viewer, the names, the scale bar and the legend.
function pictureOf(viewer) {
  const { clientWidth, clientHeight } = canvas;
  const factor = Math.min(Math.max(MIN_PICTURE / clientWidth, window.devicePixelRatio || 1),
    viewer.maxPixels / Math.max(clientWidth, clientHeight));
  const width = Math.round(factor * clientWidth), height = Math.round(factor * clientHeight);
  viewer.render(width, height, { isShaded: viewer.look.shading, samples: SAMPLES });
  const page = document.createElement("canvas");
  page.width = width;
  page.height = height;
  const pen = page.getContext("2d");
  pen.drawImage(canvas, 0, 0);
  viewer.draw();
  pen.scale(factor, factor);
  pen.font = "15px sans-serif";
  pen.fillStyle = getComputedStyle(document.body).color;
  pen.textAlign = "center";
  if (viewer.molecules.length > 1)
    viewer.panels(clientWidth, clientHeight).forEach((panel, i) =>
      pen.fillText(viewer.molecules[i].name, panel.x + panel.width / 2, panel.y + 24));
  drawLabels(pen, viewer.visibleLabels());
  pen.textAlign = "left";
  const bar = scaleBar(viewer.scaleIn(clientWidth, clientHeight), 140);
  pen.fillText(bar.text, 16, clientHeight - 28);
  pen.fillRect(16, clientHeight - 20, bar.width, 3);
  drawLegend(pen, viewer.legend(), clientWidth, clientHeight);
  return page;
}

function drawLabels(pen, labels) {
  pen.save();
  for (const { box, left, top, width, height } of labels) {
    const { backgroundColor, color, font } = getComputedStyle(box);
    Object.assign(pen, { font, fillStyle: backgroundColor });
    pen.fillRect(left, top, width, height);
    pen.fillStyle = color;
    pen.fillText(box.textContent, left + width / 2, top + height - 5);
  }
  pen.restore();
}

function drawLegend(pen, { entries, gradient }, width, height) {
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
