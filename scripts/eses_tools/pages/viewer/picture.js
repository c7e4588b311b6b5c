// Draws the picture that is saved.

const MAX_OVER = 8; // entries of a legend that may cover a part of the molecule
const MIN_PICTURE = 2000; // pixels; width of saved pictures without their legends
const LINE = 21, EDGE = 20, GRADIENT = 220; // pixels; of a legend in saved pictures

// Returns length and pixels of a scale bar of about `pixels`.
function scaleBar(scale, pixels) {
  const power = 10 ** Math.floor(Math.log10(pixels / scale));
  const length = power * [5, 2, 1].find((one) => one * power * scale <= pixels);
  return { text: `${length.toLocaleString("en")} Å`, width: length * scale };
}

// Returns a canvas with the picture of a viewer, the names and the scale bar, and the legend beside it.
function pictureOf(viewer) {
  const { clientWidth, clientHeight } = canvas;
  const factor = Math.min(Math.max(MIN_PICTURE / clientWidth, window.devicePixelRatio || 1),
    viewer.maxPixels / Math.max(clientWidth, clientHeight));
  const width = Math.round(factor * clientWidth), height = Math.round(factor * clientHeight);
  viewer.render(width, height, { isShaded: viewer.look.shading, samples: SAMPLES });
  const page = document.createElement("canvas");
  const pen = page.getContext("2d");
  const font = "15px sans-serif", { color, backgroundColor } = getComputedStyle(document.body);
  pen.font = font;
  const legend = viewer.legend(), columns = legendColumns(pen, legend, clientHeight);
  page.width = width + Math.ceil(factor * columns.width);
  page.height = height;
  pen.fillStyle = backgroundColor;
  pen.fillRect(width, 0, page.width - width, height);
  pen.drawImage(canvas, 0, 0);
  viewer.draw();
  pen.scale(factor, factor);
  Object.assign(pen, { font, fillStyle: color });
  pen.textAlign = "center";
  if (viewer.molecules.length > 1)
    viewer.panels(clientWidth, clientHeight).forEach((panel, i) =>
      pen.fillText(viewer.molecules[i].name, panel.x + panel.width / 2, panel.y + 24));
  drawLabels(pen, viewer.visibleLabels());
  pen.textAlign = "left";
  const bar = scaleBar(viewer.scaleIn(clientWidth, clientHeight), 140);
  pen.fillText(bar.text, 16, clientHeight - 28);
  pen.fillRect(16, clientHeight - 20, bar.width, 3);
  drawLegend(pen, legend, columns, clientWidth, clientHeight);
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

// Returns the columns of a legend: how many entries each has, their widths, and the width of all.
function legendColumns(pen, { entries, gradient }, height) {
  const lines = Math.max(1, Math.floor((height - 2 * EDGE - (gradient ? 80 : 0)) / LINE)), widths = [];
  for (let first = 0; first < entries.length; first += lines)
    widths.push(40 + Math.max(...entries.slice(first, first + lines).map(([name]) => pen.measureText(name).width)));
  const sum = widths.reduce((all, width) => all + width, 0);
  return { lines, widths, width: Math.max(sum, gradient ? GRADIENT + 2 * EDGE : 0) };
}

// Draws a legend on the right of a picture of this size.
function drawLegend(pen, { entries, gradient }, { lines, widths }, width, height) {
  const text = pen.fillStyle;
  let left = width;
  widths.forEach((columnWidth, column) => {
    entries.slice(column * lines, (column + 1) * lines).forEach(([name, color], i) => {
      const y = EDGE + LINE * (i + 1);
      pen.fillStyle = `rgb(${color})`;
      pen.fillRect(left, y - 12, 13, 13);
      pen.fillStyle = text;
      pen.fillText(name, left + 20, y);
    });
    left += columnWidth;
  });
  if (!gradient) return;
  const from = width + EDGE, ramp = pen.createLinearGradient(from, 0, from + GRADIENT, 0);
  gradient.stops.forEach((color, i) =>
    ramp.addColorStop(i / (gradient.stops.length - 1), `rgb(${color})`));
  pen.fillStyle = ramp;
  pen.fillRect(from, height - 54, GRADIENT, 14);
  pen.fillStyle = text;
  pen.fillText(gradient.title, from, height - 62);
  gradient.ticks.forEach((tick, i) => {
    pen.textAlign = ["left", "center", "right"][i];
    pen.fillText(tick, from + GRADIENT / 2 * i, height - 22);
  });
}
