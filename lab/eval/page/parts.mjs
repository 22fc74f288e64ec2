// What the page is made of: elements, numbers, tables, charts, and a scan from above.
import * as Plot from "@observablehq/plot";
import { polygonHull } from "d3-polygon";

// Series beyond this many repeat a colour with another symbol: 35 look different from each other.
export const NUM_COLOURS = 7;
const SYMBOLS = ["circle", "square", "triangle", "diamond2", "times"];
const colourOf = (i) => `var(--s${i % NUM_COLOURS})`;
const LOOSE = "var(--loose)";
const HALO = { stroke: "var(--ground)", strokeWidth: 3 };

/** An element; strings among the children become text. */
export function e(name, properties, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

/** As printf writes it, which rounds an exact half to even; "-" for what is not a number. */
export function number(value, decimals) {
  if (!Number.isFinite(value)) return "-";
  const text = value.toFixed(decimals);
  const isHalf = Math.abs(value) < 1e15 && /^50*$/.test(value.toFixed(60).split(".")[1].slice(decimals));
  return isHalf && Number(text.at(-1)) % 2 ? (value * (1 - 2 ** -50)).toFixed(decimals) : text;
}

/** The first cell of a row is its heading. Columns of numbers and dashes alone stand to the right, others to the left. */
export function table(caption, headings, rows) {
  const asCell = (cell) => (typeof cell === "string" ? { text: cell } : cell);
  const cells = rows.map((row) => row.map(asCell));
  const words = headings.map((_, i) => (cells.some((row) => /[^-+0-9.% /\n]/.test(row[i].text)) ? "words" : ""));
  const make = (name, css, scope, ...children) => {
    const element = e(name, scope ? { scope } : {}, ...children);
    if (css) element.className = css;
    return element;
  };
  return e("div", { className: "wide" }, e("table", {}, e("caption", {}, caption),
    e("thead", {}, e("tr", {}, ...headings.map(asCell).map(({ text, isUpright }, i) =>
      make("th", isUpright ? "upright" : words[i], "col", e("span", {}, text))))),
    e("tbody", {}, ...cells.map((row) => e("tr", {}, ...row.map(({ text, css }, i) =>
      i === 0 ? make("th", css, "row", text) : make("td", [words[i], css].filter(Boolean).join(" "), "", text)))))));
}

// Beyond this no axis can be labelled.
const isDrawable = (value) => typeof value === "number" && Math.abs(value) < 1e12;

function svg(css, title, options) {
  const element = Plot.plot({ ariaLabel: title, style: { fontFamily: "inherit", fontSize: "12px", background: "none" }, ...options });
  element.setAttribute("role", "img");
  element.classList.add(css);
  return element;
}

const legend = (names, marksOf) => e("ul", { className: "legend" }, ...names.map((name, i) => e("li", {}, svg("key", "", {
  width: 30, height: 12, margin: 0, x: { axis: null, domain: [0, 30] }, y: { axis: null, domain: [12, 0] }, marks: marksOf(i),
}), name)));

function figure(title, parts) {
  return e("figure", {}, e("figcaption", {}, title), ...parts);
}

const axis = { labelAnchor: "center", labelArrow: "none" };
const grid = { stroke: "var(--grid)", strokeOpacity: 1 };

// From zero, but where that would press the lines together at the top; never of no extent.
function domainOf(values, hasZero) {
  let [min, max] = [Math.min(...values), Math.max(...values)];
  if (hasZero && min > 0 && min < max / 2) min = 0;
  const margin = max - min <= 1e-9 * Math.max(Math.abs(min), Math.abs(max)) ? Math.max(0.5, Math.abs(max) / 20) : 0;
  return [min - margin, max + margin];
}

const lineMarks = (points, i, isBold, symbols = points) => [
  Plot.line(points, { stroke: colourOf(i), strokeWidth: isBold ? 3 : 1.4, strokeLinejoin: "round" }),
  Plot.dot(symbols, { symbol: SYMBOLS[i % SYMBOLS.length], r: 3, stroke: colourOf(i), fill: colourOf(i) }),
];

/** Lines [{name, isBold, points: [[x, y]]}], a legend, and the numbers folded away. A point that is not a number breaks its line. */
export function lineChart({ title, xLabel, yLabel, isPercent, lines, numbers, note }) {
  const drawn = lines.map(({ points }) => points.map((point) => (point.every(isDrawable) ? point : [NaN, NaN])));
  const known = drawn.flat().filter(([x]) => isDrawable(x));
  const chart = !known.length ? e("p", {}, "no numbers") : svg("chart", title, {
    width: 760, height: 330, marginLeft: 60, marginBottom: 46, marginRight: 16,
    x: { domain: domainOf(known.map(([x]) => x)), nice: 6 }, y: { domain: isPercent ? [0, 100] : domainOf(known.map(([, y]) => y), true), nice: 6 },
    marks: [Plot.gridY({ ...grid, ticks: 6 }), Plot.axisX({ ...axis, label: xLabel, ticks: 6 }),
      Plot.axisY({ ...axis, label: yLabel, ticks: 6, tickSize: 0 }), Plot.frame({ anchor: "bottom", stroke: "var(--faint)" }),
      ...drawn.flatMap((points, i) => lineMarks(points, i, lines[i].isBold))],
  });
  const places = [...new Set(numbers.flatMap(({ points }) => points.map(([x]) => x).filter(Number.isFinite)))].sort((a, b) => a - b);
  return figure(title, [chart,
    legend(lines.map(({ name }) => name), (i) => lineMarks([[1, 6], [29, 6]], i, lines[i].isBold, [[15, 6]])),
    ...(note ? [e("p", {}, note)] : []),
    e("details", {}, e("summary", {}, "Numbers"),
      table(yLabel, [xLabel, ...numbers.map(({ name }) => ({ text: name, isUpright: numbers.length > 4 }))],
        places.map((place) => [number(place, 2), ...numbers.map(({ points }) => number(points.find(([x]) => x === place)?.[1], 2))])))]);
}

/** Groups [{name, values}] of bars that lie, a bar for each series, its number at the end. */
export function barChart(title, xLabel, series, groups, decimals) {
  const endOf = (value) => (isDrawable(value) ? Math.max(0, value) : 0);
  const bars = groups.flatMap(({ values }, group) => values.map((value, i) => ({ group, i, value, end: endOf(value) })));
  if (!bars.some(({ value }) => isDrawable(value))) return figure(title, [e("p", {}, "no numbers")]);
  const names = groups.map(({ name }) => (name.length > 44 ? `${name.slice(0, 44)}...` : name));
  const place = { fy: "group", y: "i" };
  return figure(title, [svg("chart", title, {
    width: 760, height: 50 + groups.length * (12 * series.length + 8), marginLeft: 14 + 7.4 * Math.max(...names.map((name) => name.length)),
    marginTop: 8, marginBottom: 42, marginRight: 52, x: { domain: [0, Math.max(...bars.map(({ end }) => end)) || 1], nice: 6 },
    y: { axis: null, domain: series.map((_, i) => i), paddingInner: 0.15, paddingOuter: 0.33 }, fy: { domain: groups.map((_, i) => i), padding: 0 },
    marks: [Plot.gridX({ ...grid, ticks: 6 }), Plot.axisX({ ...axis, label: xLabel, ticks: 6, tickSize: 0 }),
      Plot.axisFy({ anchor: "left", label: null, tickFormat: (i) => names[i] }),
      Plot.barX(bars.filter(({ value }) => isDrawable(value)), { ...place, x: "end", fill: ({ i }) => colourOf(i) }),
      Plot.ruleX([0], { stroke: "var(--faint)" }),
      Plot.text(bars, { ...place, x: "end", text: ({ value }) => number(value, decimals), dx: 5, textAnchor: "start", fontSize: 10, fill: "var(--faint)" })],
  }), ...(series.length > 1 ? [legend(series, (i) => [Plot.rect([0], { x1: 2, x2: 28, y1: 1, y2: 11, fill: colourOf(i) })])] : [])]);
}

const share = (value) => number(value, 3);

/** Bins [{from, to, num_segments, stated, observed}]: what was stated of a bin and how often it came true, beside the line on which both are the same;
 *  below it how many a bin holds; the numbers folded away. An empty bin has no dot and no bar, and breaks the line. */
export function reliabilityDiagram(title, bins) {
  const known = bins.filter(({ num_segments }) => num_segments > 0);
  const most = Math.max(1, ...known.map(({ num_segments }) => num_segments));
  const frame = { width: 420, marginLeft: 52, marginRight: 12 };
  const x = { domain: [0, 1] };
  const ends = { ticks: [0, 0.2, 0.4, 0.6, 0.8, 1], tickSize: 0 };
  const spots = bins.map(({ stated, observed }) => [stated ?? NaN, observed ?? NaN]);
  const chart = svg("chart", title, {
    ...frame, height: 380, marginTop: 10, marginBottom: 22, x, y: { domain: [0, 1] },
    marks: [Plot.gridY({ ...grid, ...ends }), Plot.gridX({ ...grid, ...ends }), Plot.axisX({ ...axis, ...ends, label: null }),
      Plot.axisY({ ...axis, ...ends, label: "share of them that are of an object" }),
      Plot.line([[0, 0], [1, 1]], { stroke: "var(--faint)", strokeDasharray: "5 4" }),
      Plot.line(spots, { stroke: colourOf(0), strokeWidth: 2, strokeLinejoin: "round" }),
      Plot.dot(spots, { r: 4.5, fill: colourOf(0), stroke: "var(--ground)" })],
  });
  const counts = svg("chart", `${title}: segments a bin`, {
    ...frame, height: 136, marginTop: 16, marginBottom: 46, x, y: { type: "symlog", domain: [0, most] },
    marks: [Plot.axisX({ ...axis, ...ends, label: "probability stated by a segment", labelOffset: 36 }),
      Plot.axisY({ ...axis, label: "segments", ticks: [] }),
      Plot.rectY(known, { x1: "from", x2: "to", y: "num_segments", inset: 2, fill: colourOf(1) }),
      Plot.ruleY([0], { stroke: "var(--faint)" }),
      Plot.text(known, { x: ({ from, to }) => (from + to) / 2, y: "num_segments", text: ({ num_segments }) => String(num_segments), dy: -7, fontSize: 10,
        fill: "var(--text)" })],
  });
  const result = figure(title, [chart, counts, e("details", {}, e("summary", {}, "Numbers"),
    table("", ["probability", "segments", "stated, mean", "observed"], bins.map(({ from, to, num_segments, stated, observed }) =>
      [`${number(from, 1)} to ${number(to, 1)}`, String(num_segments), share(stated), share(observed)])))]);
  result.className = "reliability";
  return result;
}

// Groups of returns as one: [[[right, forward], [right, end]]] in metres, and how many.
const merge = (groups) => ({ runs: groups.flatMap(({ runs }) => runs), count: groups.reduce((sum, group) => sum + group.count, 0) });

// Which segment belongs to which object. Objects come by bearing, so that neighbours differ in colour.
function match({ objects: scored, returns, unit_m: unit }) {
  const groups = returns.map(({ object, segment, num_returns, runs }) => ({ object, segment, count: num_returns,
    runs: Array.from({ length: runs.length / 3 }, (_, i) => {
      const [right, forward, length] = runs.slice(3 * i, 3 * i + 3);
      return [[right * unit, forward * unit], [right * unit, (forward + length - 1) * unit]];
    }) }));
  const segments = new Map([...new Set(groups.map(({ segment }) => segment))].filter((id) => id > 0)
    .map((id) => [id, { ...merge(groups.filter(({ segment }) => segment === id)), numbers: [], numShared: 0 }]));
  const objects = scored.map((object, i) =>
    ({ ...object, ...merge(groups.filter((group) => group.object === object.id)), number: i + 1, colour: colourOf(i) }));
  for (const object of objects) {
    const pieces = groups.filter((group) => group.object === object.id && group.segment > 0);
    object.numPieces = pieces.length;
    // Of equals the first: groups come by object and then by segment.
    const iou = ({ segment, count }) => count / (object.count + segments.get(segment).count - count);
    if (pieces.length) segments.get(pieces.reduce((a, b) => (iou(a) >= iou(b) ? a : b)).segment).numbers.push(object.number);
  }
  for (const { object, segment, count } of groups) {
    const one = segments.get(segment);
    if (one && object > 0 && count > one.numShared) Object.assign(one, { numShared: count, object: objects.find(({ id }) => id === object) });
  }
  return { objects, segments: [...segments.values()], looseInTruth: merge(groups.filter(({ object }) => object <= 0)),
    looseInPrediction: merge(groups.filter(({ segment }) => segment <= 0)) };
}

// What both plans show: the boat, all objects and all segments, with some water around; neither a strip nor a tower.
function extentOf({ objects, segments }) {
  const spots = [[0, 0], ...[...objects, ...segments].flatMap(({ runs }) => runs.flat())];
  const [xs, ys] = [spots.map(([x]) => x), spots.map(([, y]) => y)];
  const [minX, maxX, minY, maxY] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const margin = Math.max(3, 0.06 * Math.max(maxX - minX, maxY - minY));
  const moreX = Math.max(0, maxY - minY - (maxX - minX)) / 2 + margin;
  const moreY = Math.max(0, 0.6 * (maxX - minX) - (maxY - minY)) / 2 + margin;
  return { x: [minX - moreX, maxX + moreX], y: [minY - moreY, maxY + moreY] };
}

// A square round a single return, a line between two.
function outlineOf(runs, marginM) {
  const corners = [...new Map(runs.flat().map((spot) => [spot.join(), spot])).values()];
  if (corners.length === 1) {
    const [x, y] = corners[0];
    return [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]].map(([right, up]) => [x + right * marginM, y + up * marginM]);
  }
  const hull = polygonHull(corners) ?? corners;
  return [...hull, hull[0]];
}

// One plan. Layers [{runs, colour, label, outline: "solid" | "dashed" | undefined}]; the first lies below.
function drawPlan(title, { x, y }, layers) {
  const width = 460;
  const scale = width / (x[1] - x[0]);
  const reach = Math.hypot(Math.max(-x[0], x[1]), Math.max(-y[0], y[1]));
  const step = reach > 80 ? 20 : reach > 30 ? 10 : 5;
  const hasRoom = ([right, up]) => Math.min(right - x[0], x[1] - right, up - y[0], y[1] - up) * scale >= 16;
  const rings = Array.from({ length: Math.ceil(reach / step) - 1 }, (_, i) => (i + 1) * step);
  const byColour = [...new Set(layers.map(({ colour }) => colour))];
  const words = (texts, options) =>
    Plot.text(texts, { x: ([, [right]]) => right, y: ([, [, up]]) => up, text: ([text]) => text, fontSize: 11, ...HALO, ...options });
  const paths = (lines, options) => (!lines.length ? [] : [Plot.geo({ type: "MultiLineString", coordinates: lines }, { strokeLinecap: "round", ...options })]);
  const outlines = (stroke, kind, options) =>
    paths(layers.filter(({ colour, outline }) => colour === stroke && outline === kind).map(({ runs }) => outlineOf(runs, 4 / scale)),
      { stroke, ...options });
  return svg("plan", title, {
    width, height: (y[1] - y[0]) * scale, margin: 0, x: { axis: null, domain: x }, y: { axis: null, domain: y },
    marks: [
      ...rings.map((ring) => Plot.dot([[0, 0]], { r: ring * scale, stroke: "var(--grid)", strokeWidth: 1 })),
      words(rings.flatMap((ring) => {
        const spot = [[0, ring], [0, -ring], [ring, 0], [-ring, 0]].find(hasRoom);
        return spot ? [[`${ring} m`, spot]] : [];
      }), { fill: "var(--faint)" }),
      ...byColour.flatMap((stroke) => paths(layers.filter(({ colour }) => colour === stroke).flatMap(({ runs }) => runs),
        { stroke, strokeWidth: stroke === LOOSE ? 2.2 : 3 })),
      ...byColour.flatMap((stroke) => [...outlines(stroke, "solid", {}), ...outlines(stroke, "dashed", { strokeDasharray: "3.5 2.5" })]),
      Plot.dot([[0, 0]], { symbol: "triangle", r: 5, fill: "var(--text)", stroke: "var(--ground)" }),
      words(layers.filter(({ label }) => label).map(({ label, runs }) =>
        [label, runs.flat().reduce((a, b) => (b[1] > a[1] ? b : a))]), { dy: -10, fontWeight: 700, fill: "var(--text)" }),
    ],
  });
}

/** A scan from above, twice: the truth, and what a method made of it; and the objects that came off worst. */
export function plan(method, scan) {
  const caption = `${method}: ${scan.scene}, seed ${scan.seed}, scan ${scan.scan}, mIoU ${number(scan.iou_percent, 1)} %`;
  if (!scan.returns) return figure(caption, [e("p", {}, "Not drawn: the scan, its truth and its labels differ in size.")]);
  const matched = match(scan);
  const { objects, segments } = matched;
  const numFalse = segments.filter(({ object }) => !object).length;
  const extent = extentOf(matched);
  // Where an object is cut into hundreds of pieces, outlines of the large ones say enough.
  const pieces = segments.filter(({ object, numbers }) => object && !numbers.length).map(({ count }) => count).sort((a, b) => b - a);
  const least = pieces.length > 100 ? pieces[100] + 1 : 1;
  const outline = ({ object, numbers, count }) => (!object ? "solid" : !numbers.length && count >= least ? "dashed" : undefined);
  const truth = drawPlan("Truth from above", extent, [{ ...matched.looseInTruth, colour: LOOSE },
    ...objects.map((object) => ({ runs: object.runs, colour: object.colour, label: String(object.number) }))]);
  const prediction = drawPlan("Prediction from above", extent, [{ ...matched.looseInPrediction, colour: LOOSE },
    ...[...segments].sort((a, b) => !a.object - !b.object).map((segment) => ({
      runs: segment.runs, colour: segment.object?.colour ?? "var(--text)", label: segment.numbers.join("+"), outline: outline(segment) }))]);
  const shown = [...objects].sort((a, b) => a.iou_percent - b.iou_percent).slice(0, 6);
  const result = figure(`${caption}; ${objects.length} objects, ${segments.length} segments, of these ${numFalse} false`, [
    e("div", { className: "side" }, e("p", {}, "Truth"), truth), e("div", { className: "side" }, e("p", {}, "Prediction"), prediction),
    ...(!shown.length ? [] : [table(
      shown.length < objects.length ? `The ${shown.length} of ${objects.length} objects that came off worst` : "All objects, worst first",
      ["No.", "object", "kind", "returns", "segments that hold some", "IoU %"],
      shown.map(({ number: no, name, kind, num_returns, numPieces, iou_percent }) =>
        [String(no), name, kind, String(num_returns), String(numPieces), number(iou_percent, 1)]))]),
  ]);
  result.className = "pair";
  return result;
}
