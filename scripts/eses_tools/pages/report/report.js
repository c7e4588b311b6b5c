// Shows the rows of a table: failures, pictures, plots, and the table, which can be sorted and
// filtered. The first column names the structures.

const STEP = 200; // rows that are shown at once
const MARGIN = { left: 62, right: 12, top: 24, bottom: 36 }; // of a plot, in pixels

const { columns, texts, plots, rows: lists, pictures } =
  JSON.parse(document.getElementById("rows").textContent);
const key = columns[0], isText = (name) => texts.includes(name);
const rows = lists.map((list) => Object.fromEntries(columns.map((name, i) => [name, list[i]])));
const state = { column: key, isDescending: false, filter: "", status: "", shown: STEP };
const $ = (selector) => document.querySelector(selector);

function element(tag, text, className = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  made.className = className;
  return made;
}

function shortNumber(value) {
  return value >= 1e5 || value < 1e-3 ? value.toExponential(0).replace("e+", "e") : String(value);
}

// -------------------------------------------------------------------------------------- table

function isMatch(row) {
  const text = texts.map((name) => row[name]).join("\n").toLowerCase();
  return text.includes(state.filter.toLowerCase()) && (!state.status || row.status === state.status);
}

// Orders rows by the chosen column; missing values are last.
function compare(a, b) {
  const [x, y] = [a[state.column], b[state.column]];
  if (x === "" || y === "") return (x === "") - (y === "");
  const order = isText(state.column) ? x.localeCompare(y, "en", { numeric: true }) : x - y;
  return state.isDescending ? -order : order;
}

function showTable() {
  const matches = rows.filter(isMatch).sort(compare);
  $("#shown").textContent = `${matches.length} of ${rows.length} structures`;
  $("tbody").replaceChildren(...matches.slice(0, state.shown).map((row) => {
    const line = document.createElement("tr");
    line.append(...columns.map((name) => element("td", row[name], isText(name) ? "text" : "")));
    return line;
  }));
  $("#more").hidden = matches.length <= state.shown;
  document.querySelectorAll("th").forEach((cell, i) => {
    if (columns[i] !== state.column) cell.removeAttribute("aria-sort");
    else cell.setAttribute("aria-sort", state.isDescending ? "descending" : "ascending");
  });
  drawPlots(matches);
}

function makeHeader() {
  $("thead tr").append(...columns.map((name) => {
    const cell = element("th", "", isText(name) ? "text" : ""), button = element("button", name);
    cell.scope = "col";
    button.type = "button";
    button.addEventListener("click", () => {
      state.isDescending = state.column === name && !state.isDescending;
      state.column = name;
      showTable();
    });
    cell.append(button);
    return cell;
  }));
}

// -------------------------------------------------------------------------------------- plots

// Returns the powers of ten around positive values.
function decades(values) {
  const low = Math.floor(Math.log10(values.reduce((a, b) => Math.min(a, b))));
  const high = Math.ceil(Math.log10(values.reduce((a, b) => Math.max(a, b))));
  return Array.from({ length: Math.max(high - low, 1) + 1 }, (_, i) => low + i);
}

// Draws y against the number of atoms, both on logarithmic scales.
function drawPlot(canvas, points, title) {
  const ratio = window.devicePixelRatio || 1, style = getComputedStyle(document.body);
  const width = canvas.clientWidth, height = canvas.clientHeight, pen = canvas.getContext("2d");
  canvas.width = ratio * width;
  canvas.height = ratio * height;
  pen.scale(ratio, ratio);
  pen.font = "13px sans-serif";
  pen.fillStyle = style.color;
  pen.fillText(title, 4, 14);
  if (points.length === 0) return;
  const x = decades(points.map((point) => point[0])), y = decades(points.map((point) => point[1]));
  const place = (value, scale, from, to) =>
    from + (to - from) * (Math.log10(value) - scale[0]) / (scale[scale.length - 1] - scale[0]);
  const across = (value) => place(value, x, MARGIN.left, width - MARGIN.right);
  const up = (value) => place(value, y, height - MARGIN.bottom, MARGIN.top);
  pen.strokeStyle = style.getPropertyValue("--line");
  pen.lineWidth = 0.5;
  pen.beginPath();
  pen.textAlign = "right";
  for (const power of y) {
    pen.moveTo(MARGIN.left, up(10 ** power));
    pen.lineTo(width - MARGIN.right, up(10 ** power));
    pen.fillText(shortNumber(+`1e${power}`), MARGIN.left - 6, up(10 ** power) + 4);
  }
  pen.textAlign = "center";
  for (const power of x) {
    pen.moveTo(across(10 ** power), MARGIN.top);
    pen.lineTo(across(10 ** power), height - MARGIN.bottom);
    pen.fillText(shortNumber(+`1e${power}`), across(10 ** power), height - MARGIN.bottom + 16);
  }
  pen.fillText("atoms", (MARGIN.left + width) / 2, height - 4);
  pen.stroke();
  pen.fillStyle = style.getPropertyValue("--point");
  for (const [a, b] of points) {
    pen.beginPath();
    pen.arc(across(a), up(b), 2.5, 0, 7);
    pen.fill();
  }
}

function drawPlots(matches) {
  for (const [name, title] of plots) {
    const canvas = $(`#plot-${name}`);
    const points = matches.filter((row) => row.atoms > 0 && row[name] > 0)
      .map((row) => [row.atoms, row[name]]);
    drawPlot(canvas, points, title);
    canvas.setAttribute("aria-label", `${title}, of ${points.length} structures, against atoms; `
      + "the table has the numbers");
  }
}

function makePlots() {
  $("#plots").append(...plots.map(([name]) => {
    const figure = document.createElement("figure"), canvas = document.createElement("canvas");
    canvas.id = `plot-${name}`;
    canvas.setAttribute("role", "img");
    figure.append(canvas);
    return figure;
  }));
}

// --------------------------------------------------------------------------------------- start

function showCounts() {
  const counts = new Map();
  for (const { status } of rows) counts.set(status, (counts.get(status) ?? 0) + 1);
  $("#counts").textContent = `${rows.length} structures: `
    + Array.from(counts, ([status, count]) => `${count} ${status}`).join(", ");
  for (const status of counts.keys()) $("#status").append(new Option(status, status));
  const failures = rows.filter(({ status }) => status === "failed");
  $("#failures").hidden = failures.length === 0;
  $("#failures ul").append(...failures.map((row) =>
    element("li", row[key] ? `${row[key]}: ${row.message}` : row.message)));
}

function showPictures() {
  const names = Object.keys(pictures);
  $("#pictures").hidden = names.length === 0;
  $(".pictures").append(...names.map((name) => {
    const figure = document.createElement("figure"), picture = new Image();
    picture.src = pictures[name];
    picture.alt = `surface of ${name}`;
    picture.loading = "lazy";
    figure.append(picture, element("figcaption", name));
    return figure;
  }));
}

makeHeader();
makePlots();
showCounts();
showPictures();
showTable();
$("#filter").addEventListener("input", (event) => { state.filter = event.target.value; showTable(); });
$("#status").addEventListener("change", (event) => { state.status = event.target.value; showTable(); });
$("#more").addEventListener("click", () => { state.shown += STEP; showTable(); });
window.addEventListener("resize", () => showTable());
