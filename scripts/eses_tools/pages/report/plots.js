// Plots as SVG, which print and scale: values against the number of atoms, and histograms.

const SIZE = { width: 380, height: 250 }; // of a plot, in its own units
const MARGIN = { right: 14, top: 28, bottom: 38 };
const MIN_FITTED = 8; // structures that a line is fitted to, at least
const MAX_DEVIATION = 5; // of values that are no outliers, in standard deviations
const MIN_FACTOR = 1.05; // between an outlier and the fitted line, at least

function svg(tag, attributes, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  return made;
}

function numberText(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e7 || size < 1e-3 ? value.toExponential(1).replace(/\.0(?=e)/, "").replace("e+", "e")
    : value.toLocaleString("en", { maximumSignificantDigits: 7 });
}

const median = (values) => {
  const sorted = [...values].sort((a, b) => a - b), half = sorted.length >> 1;
  return sorted.length % 2 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
};

// --------------------------------------------------------------------------------------- axes

// Returns round numbers in [low, high], about `count` of them.
function roundNumbers(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999);
  const first = Math.ceil(low / step), last = Math.floor(high / step);
  return Array.from({ length: Math.max(last - first + 1, 0) }, (_, i) => +((first + i) * step).toPrecision(12));
}

// Returns 1, 2 and 5 times powers of ten in [low, high], or only powers, at most `count` of them.
function logarithmicNumbers(low, high, count) {
  const from = Math.floor(Math.log10(low)), to = Math.ceil(Math.log10(high));
  const powers = Array.from({ length: to - from + 1 }, (_, i) => from + i);
  const inside = (values) => values.filter((value) => value >= low && value <= high);
  const fine = inside(powers.flatMap((power) => [1, 2, 5].map((factor) => +`${factor}e${power}`)));
  if (fine.length <= count) return fine;
  const coarse = inside(powers.map((power) => +`1e${power}`));
  const stride = Math.ceil(coarse.length / count);
  return coarse.length > 1 ? coarse.filter((_, i) => i % stride === 0) : fine.filter((_, i) => i % 2 === 0);
}

// Returns an axis that fits the values: their range with some space, ticks, and places from 0 to 1.
function makeAxis(values, isLogarithmic, count) {
  let low = values.reduce((a, b) => Math.min(a, b)), high = values.reduce((a, b) => Math.max(a, b));
  if (isLogarithmic) {
    const space = Math.max((high / low) ** 0.05, low === high ? 1.5 : 1.0001);
    [low, high] = [low / space, high * space];
    const ticks = high / low < 8 ? roundNumbers(low, high, count) : logarithmicNumbers(low, high, count + 1);
    return { low, high, ticks, place: (value) => Math.log(value / low) / Math.log(high / low) };
  }
  if (low === high) [low, high] = [low - Math.max(Math.abs(low) / 2, 0.5), high + Math.max(Math.abs(high) / 2, 0.5)];
  return { low, high, ticks: roundNumbers(low, high, count), place: (value) => (value - low) / (high - low) };
}

// Draws title, grid and labels. Returns functions that place values on both axes.
function drawFrame(plot, title, bottomTitle, x, y) {
  const left = 14 + 7.2 * Math.max(1, ...y.ticks.map((value) => numberText(value).length));
  const right = SIZE.width - MARGIN.right, bottom = SIZE.height - MARGIN.bottom;
  const across = (value) => left + (right - left) * x.place(value);
  const up = (value) => bottom + (MARGIN.top - bottom) * y.place(value);
  const lines = [...y.ticks.map((value) => `M${left} ${up(value)}H${right}`),
    ...x.ticks.map((value) => `M${across(value)} ${MARGIN.top}V${bottom}`)];
  plot.append(svg("text", { x: 4, y: 15, class: "title" }, title), svg("path", { d: lines.join(""), class: "grid" }));
  for (const value of y.ticks)
    plot.append(svg("text", { x: left - 6, y: up(value) + 4, "text-anchor": "end" }, numberText(value)));
  for (const value of x.ticks) {
    const half = 3.6 * numberText(value).length; // labels at the ends stay inside
    const place = Math.min(Math.max(across(value), half), SIZE.width - half);
    plot.append(svg("text", { x: place, y: bottom + 16, "text-anchor": "middle" }, numberText(value)));
  }
  plot.append(svg("text", { x: (left + right) / 2, y: SIZE.height - 4, "text-anchor": "middle" }, bottomTitle));
  return { across, up, left, right, bottom };
}

// -------------------------------------------------------------------------------------- plots

// Returns the points that are far from the line through all points, in logarithms, with their
// factors: how many times the value of the line they have. The line and the deviation are medians of
// other structures, so that outliers do not move them.
function outliersOf(points) {
  if (points.length < MIN_FITTED) return [];
  const logs = points.map(({ x, y }) => [Math.log(x), Math.log(y)]);
  const sorted = [...logs].sort((a, b) => a[0] - b[0]), half = sorted.length >> 1;
  // The slope is the median of those between a point of the lower and one of the upper half.
  const slopes = sorted.slice(0, half).map(([x, y], i) => {
    const [otherX, otherY] = sorted[sorted.length - half + i];
    return otherX > x ? (otherY - y) / (otherX - x) : NaN;
  }).filter(Number.isFinite);
  const slope = slopes.length ? median(slopes) : 0;
  const rests = logs.map(([x, y]) => y - slope * x), level = median(rests);
  const deviation = 1.4826 * median(rests.map((rest) => Math.abs(rest - level)));
  const limit = Math.max(MAX_DEVIATION * deviation, Math.log(MIN_FACTOR));
  return points.map((point, i) => ({ ...point, factor: Math.exp(rests[i] - level) }))
    .filter(({ factor }) => Math.abs(Math.log(factor)) > limit);
}

// Draws points {x, y, name}, both on logarithmic scales, and outliers with their names.
function drawScatter(plot, title, points, outliers) {
  plot.replaceChildren();
  if (points.length === 0) {
    plot.append(svg("text", { x: 4, y: 15, class: "title" }, title), svg("text", { x: 4, y: 40 }, "no values"));
    return;
  }
  const { across, up } = drawFrame(plot, title, "atoms", makeAxis(points.map(({ x }) => x), true, 4),
    makeAxis(points.map(({ y }) => y), true, 5));
  const place = ({ x, y }) => `M${across(x).toFixed(1)} ${up(y).toFixed(1)}h0`;
  plot.append(svg("path", { d: points.map(place).join(""), class: "points" }));
  for (const point of outliers) {
    const dot = svg("circle", { cx: across(point.x), cy: up(point.y), r: 4, class: "outlier" });
    dot.append(svg("title", {}, `${point.name}: ${numberText(point.y)}`));
    plot.append(dot);
  }
}

// Draws how often values occur, with a line at their median. Bins have equal widths, or equal ratios
// if the values cover more than a factor of 30.
function drawHistogram(plot, title, values) {
  plot.replaceChildren();
  const least = values.reduce((a, b) => Math.min(a, b)), most = values.reduce((a, b) => Math.max(a, b));
  const isLogarithmic = least > 0 && most / least > 30;
  const x = makeAxis(values, isLogarithmic, 4);
  const count = Math.min(Math.max(Math.ceil(2 * Math.cbrt(values.length)), 5), 40), bins = new Array(count).fill(0);
  for (const value of values) bins[Math.min(Math.floor(count * x.place(value)), count - 1)] += 1;
  const highest = bins.reduce((a, b) => Math.max(a, b));
  const y = { ticks: roundNumbers(0, highest, 4).filter(Number.isInteger), place: (value) => value / highest };
  const middle = median(values);
  const { across, up, left, right, bottom } = drawFrame(plot, `${title}: median ${numberText(+middle.toPrecision(4))}`,
    isLogarithmic ? "logarithmic scale" : "", x, y);
  const width = (right - left) / count;
  plot.append(svg("path", { class: "bars", d: bins.map((times, i) => times === 0 ? ""
    : `M${(left + i * width + 0.5).toFixed(1)} ${bottom}V${up(times).toFixed(1)}h${(width - 1).toFixed(1)}V${bottom}z`).join("") }),
  svg("path", { class: "median", d: `M${across(middle).toFixed(1)} ${MARGIN.top}V${bottom}` }));
}
