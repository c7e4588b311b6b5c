// Shows the rows of a table: failures, outliers, pictures, plots, and the table, which can be sorted,
// filtered and downloaded. The first column names the structures.

const STEP = 200; // rows that are shown at once
const MAX_OPEN = 5; // failures that are shown at once
const MAX_OUTLIERS = 20; // that are named
// Columns whose distributions say nothing about the structures.
const SETTINGS = ["probe_radius", "model", "threads", "nx", "ny", "nz", "bx", "by", "bz"];

const { columns, texts, plots, rows: lists, pictures } =
  JSON.parse(document.getElementById("rows").textContent);
const key = columns[0], isText = (name) => texts.includes(name);
const rows = lists.map((list) => Object.fromEntries(columns.map((name, i) => [name, list[i]])));
const state = { column: key, isDescending: false, filter: "", status: "", shown: STEP };
const $ = (selector) => document.querySelector(selector);
const titles = new Map(plots);
// Areas and volumes of all kinds of surfaces have their units, as those of the plots against atoms.
const titleOf = (name) => titles.get(name) ?? name.replaceAll("_", " ").replace(/^(ses|sas) /, (kind) => kind.toUpperCase())
  .replace(/^euler/, "Euler").replace(/(?<=\barea)$/, ", Å²").replace(/(?<=\bvolume)$/, ", Å³");

function element(tag, text, className = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  made.className = className;
  return made;
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

const chosenRows = () => rows.filter(isMatch).sort(compare);

// Numbers in the table have six digits; those of the download have all.
function cellOf(row, name) {
  const value = row[name], isLong = !isText(name) && value !== "" && !Number.isInteger(value);
  const cell = element("td", isLong ? String(+value.toPrecision(6)) : value, isText(name) ? "text" : "");
  if (isLong) cell.title = value;
  return cell;
}

function showTable() {
  const matches = chosenRows();
  $("#shown").textContent = `${matches.length} of ${rows.length} structures`;
  $("tbody").replaceChildren(...matches.slice(0, state.shown).map((row) => {
    const line = document.createElement("tr");
    line.append(...columns.map((name) => cellOf(row, name)));
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
    const cell = element("th", "", isText(name) ? "text" : ""), button = element("button", "");
    // Long names may be divided behind underscores.
    button.append(...name.split(/(?<=_)/).flatMap((part) => [part, document.createElement("wbr")]));
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

// Saves the rows that the filter leaves, in their order, as CSV.
function download() {
  const field = (value) => /[",\r\n]/.test(value) ? `"${String(value).replaceAll('"', '""')}"` : value;
  const lines = [columns, ...chosenRows().map((row) => columns.map((name) => row[name]))];
  const text = lines.map((line) => `${line.map(field).join(",")}\n`).join("");
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  link.download = "structures.csv";
  link.click();
  URL.revokeObjectURL(link.href);
}

// -------------------------------------------------------------------------------------- plots

function makePlot(folder, name) {
  const figure = document.createElement("figure");
  const plot = svg("svg", { id: `${folder}-${name}`, viewBox: `0 0 ${SIZE.width} ${SIZE.height}`, role: "img" });
  figure.append(plot);
  $(`#${folder}`).append(figure);
}

// Names the structures with outliers in any plot, the farthest first.
function showOutliers(found) {
  found.sort((a, b) => Math.abs(Math.log(b.factor)) - Math.abs(Math.log(a.factor)));
  const values = new Map();
  for (const { name, title, factor } of found)
    values.set(name, [...values.get(name) ?? [],
      `${title.replace(/,.*/, "")} ${numberText(+factor.toPrecision(3))} times the expected`]);
  $("#outliers").hidden = found.length === 0;
  $("#outliers ul").replaceChildren(...Array.from(values).slice(0, MAX_OUTLIERS).map(([name, parts]) => {
    const item = element("li", ""), button = element("button", name);
    button.type = "button";
    button.addEventListener("click", () => setFilter(name));
    item.append(button, `: ${parts.join(", ")}`);
    return item;
  }));
  if (values.size > MAX_OUTLIERS)
    $("#outliers ul").append(element("li", `and ${values.size - MAX_OUTLIERS} more`));
}

function drawPlots(matches) {
  const found = [];
  for (const [name, title] of plots) {
    const points = matches.filter((row) => row.atoms > 0 && row[name] > 0)
      .map((row) => ({ x: row.atoms, y: row[name], name: row[key] }));
    const outliers = outliersOf(points), plot = $(`#plots-${name}`);
    drawScatter(plot, title, points, outliers);
    found.push(...outliers.map((point) => ({ ...point, title })));
    plot.setAttribute("aria-label", `${title}, of ${points.length} structures, against atoms; the table has the numbers`);
  }
  showOutliers(found);
  for (const name of distributions) {
    const values = matches.map((row) => row[name]).filter((value) => value !== ""), plot = $(`#histograms-${name}`);
    plot.parentElement.hidden = values.length === 0;
    if (values.length === 0) continue;
    drawHistogram(plot, titleOf(name), values);
    plot.setAttribute("aria-label", `distribution of ${titleOf(name)}; median ${numberText(median(values))}`);
  }
}

// Returns the columns of numbers that differ between structures.
const distributions = columns.filter((name) => !isText(name) && !SETTINGS.includes(name)
  && new Set(rows.map((row) => row[name]).filter((value) => value !== "")).size > 2);

// --------------------------------------------------------------------------------------- start

function setFilter(text) {
  state.filter = text;
  $("#filter").value = text;
  showTable();
}

function showCounts() {
  const counts = new Map();
  for (const { status } of rows) counts.set(status, (counts.get(status) ?? 0) + 1);
  $("#counts").textContent = `${rows.length} structures: `
    + Array.from(counts, ([status, count]) => `${count} ${status}`).join(", ");
  for (const status of counts.keys()) $("#status").append(new Option(status, status));
  const failures = rows.filter(({ status }) => status === "failed");
  $("#failures").hidden = failures.length === 0;
  $("#failures details").open = failures.length <= MAX_OPEN;
  $("#failures summary").textContent = `${failures.length} of ${rows.length} structures`;
  // Most messages begin with the name of the file.
  $("#failures ul").append(...failures.map((row) =>
    element("li", !row[key] || row.message.startsWith(row[key]) ? row.message : `${row[key]}: ${row.message}`)));
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
for (const [name] of plots) makePlot("plots", name);
for (const name of distributions) makePlot("histograms", name);
$("#against").hidden = plots.length === 0;
$("#distributions").hidden = distributions.length === 0;
showCounts();
showPictures();
showTable();
$("form").addEventListener("submit", (event) => event.preventDefault());
$("#filter").addEventListener("input", (event) => setFilter(event.target.value));
$("#status").addEventListener("change", (event) => { state.status = event.target.value; showTable(); });
$("#download").addEventListener("click", download);
$("#more").addEventListener("click", () => { state.shown += STEP; showTable(); });
