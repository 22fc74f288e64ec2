// The page: sections of tables and plots from the JSON in it. Its fields are described in README.md. Every text becomes a text node, never markup.
import { barChart, e, lineChart, NUM_COLOURS, number, plan, reliabilityDiagram, table } from "./parts.mjs";

const results = JSON.parse(document.getElementById("results").textContent);
const [own] = results.worlds;

// Names of methods: ours begin with "ours"; one that lacks a step is named "X without Y".
const WITHOUT = " without ";
const baseOf = ({ name }) => (name.includes(WITHOUT) ? name.slice(0, name.indexOf(WITHOUT)) : "");
const isOurs = (method) => method.name.startsWith("ours") && !baseOf(method);
const nameCell = (method) => ({ text: method.name, css: isOurs(method) ? "ours" : "" });

const isNumber = (value) => Number.isFinite(value);
const shadeOf = (percent) => (isNumber(percent) ? `h${Math.max(0, Math.min(9, Math.trunc(percent / 10)))}` : "");
const shaded = (percent, decimals) => ({ text: number(percent, decimals), css: shadeOf(percent) });
const note = (text) => e("p", { className: "note" }, text);
const entries = (pairs) => e("dl", {}, ...pairs.flatMap(([name, ...value]) => [e("dt", {}, name), e("dd", {}, ...value)]));
const inWorld = (world, title) => (world.name ? `${world.name}: ${title}` : title);
// A part for each world, ours first.
const inEachWorld = (part) =>
  results.worlds.flatMap((world) => {
    const nodes = world.is_here ? part(world) : [e("p", {}, "Not here.")];
    return world.name && world !== own && nodes.length ? [e("h3", {}, world.name), ...nodes] : nodes;
  });

// Greatest first; methods whose figure is printed the same stand on one rank.
function rank(methods, figure, decimals) {
  const ranks = [];
  const known = methods.map((method) => [figure(method), method.name]).filter(([value]) => isNumber(value));
  for (const [value, name] of known.sort((a, b) => b[0] - a[0])) {
    const last = ranks.at(-1);
    if (last && number(last.value, decimals) === number(value, decimals)) last.names.push(name);
    else ranks.push({ value, names: [name] });
  }
  return ranks;
}
const namesOf = ({ names }) => names.join(", ");
// Methods that look at a part of each scan have an easier task: they take no part in comparisons.
const wholeView = (world) => world.methods.filter((method) => !method.is_partial);
const bestMethods = (world, count) =>
  wholeView(world).filter(({ mean }) => isNumber(mean.iou_percent)).sort((a, b) => b.mean.iou_percent - a.mean.iou_percent).slice(0, count);

function whatWasRun() {
  const { command, version, computer, first_seed, last_seed, num_seeds, seconds } = results;
  const seeds = num_seeds > 0 ? `${num_seeds} a scene (${first_seed} to ${last_seed}), ${number(seconds, 1)} s each` : "-";
  return [entries([
    ["command", command ? e("code", {}, command) : "-"], ["version", version || "-"], ["computer", computer || "-"],
    ["scenes", own.scenes.join(", ") || "-"], ["seeds", seeds], ["methods", String(own.methods.length)],
    ["scans a method", String(Math.max(0, ...own.methods.map(({ total }) => total.num_scans)))],
    ...results.worlds.slice(1).map((world) => [world.name, [...(world.is_here ? [] : ["not here"]), ...world.notes].join("; ")]),
  ])];
}

function summary(world) {
  const overall = rank(wholeView(world), ({ mean }) => mean.iou_percent, 1);
  if (!overall.length) return [e("p", {}, "No method was evaluated on a scene with objects.")];
  let text = `Highest mean mIoU over the scenes: ${namesOf(overall[0])} with ${number(overall[0].value, 1)} %`;
  if (overall[1]) text += `, before ${namesOf(overall[1])} with ${number(overall[1].value, 1)} %`;
  text += ".";
  // A method that finds nothing has no false segments and is fast.
  const useful = wholeView(world).filter(({ mean }) => isNumber(mean.iou_percent) && mean.iou_percent >= overall[0].value / 2);
  const fewest = rank(useful, ({ mean }) => mean.false_segments, 2).at(-1);
  const fastest = rank(useful, ({ total }) => total.time_ms?.median, 2).at(-1);
  const best = [
    ...(fewest ? [`fewest false segments ${namesOf(fewest)}, ${number(fewest.value, 2)} a scan`] : []),
    ...(fastest ? [`fastest ${namesOf(fastest)}, ${number(fastest.value, 2)} ms a scan (median)`] : []),
  ];
  if (best.length) text += ` Of the methods with half of that or more: ${best.join("; ")}.`;

  const wins = new Map();
  const rows = world.scenes.map((scene, i) => {
    const [first, second] = rank(wholeView(world), ({ scenes }) => scenes[i]?.iou_percent, 1);
    for (const name of first?.names ?? []) wins.set(name, (wins.get(name) ?? 0) + 1);
    return [scene, ...(first ? [namesOf(first), number(first.value, 1)] : ["-", "-"]),
      ...(second ? [namesOf(second), number(second.value, 1), number(first.value - second.value, 1)] : ["-", "-", "-"])];
  });
  const won = [...wins].sort((a, b) => b[1] - a[1]).map(([name, count]) => `${name} ${count}`);
  return [e("p", {}, text), e("p", {}, `${won.length ? "Scenes won: " : ""}${won.join(", ")}.`),
    table("The best method of each scene by mIoU, %, of those that look all round", ["scene", "best", "mIoU", "next", "mIoU", "ahead by"], rows),
    ...againstPeers(world), ...bars(world)];
}

function againstPeers({ against_peers }) {
  if (!against_peers.length) return [];
  const peerCells = (peer) =>
    peer ? [peer.name, number(peer.iou_percent, 1), number(peer.false_segments, 2), number(peer.error_percent, 1)] : ["-", "-", "-", "-"];
  const peerHeadings = ["its mIoU %", "its false a scan", "our error of its error, %"];
  return [table("Ours against the best peer of each scene: our error (100 - mIoU) as a share of its error, %; below 100 ours is better",
    ["scene", "ours, mIoU %", "false a scan", "best tuned peer", ...peerHeadings, "best of all peers", ...peerHeadings],
    against_peers.map((row) =>
      [row.scene, number(row.iou_percent, 1), number(row.false_segments, 2), ...peerCells(row.tuned), ...peerCells(row.all)]
        .map((text) => ({ text, css: row.scene === "mean" ? "total" : "" }))))];
}

function bars(world) {
  if (!world.methods.length) return [];
  const best = bestMethods(world, 4);  // more bars a scene would not be read
  return [
    barChart("mIoU, mean over the scenes", "mIoU, %", ["all objects", "objects in the water"],
      world.methods.map(({ name, mean }) => ({ name, values: [mean.iou_percent, mean.water_iou_percent] })), 1),
    ...(best.length && world.scenes.length ? [barChart("mIoU by scene, the methods of the highest mean", "mIoU, %", best.map(({ name }) => name),
      world.scenes.map((name, i) => ({ name, values: best.map(({ scenes }) => scenes[i]?.iou_percent) })), 1)] : []),
  ];
}

// Methods in rows; the mean over scenes and each scene in columns, one world beside the other. Of per cents the best of each column is in bold.
function sceneTable(caption, figure, decimals, isPercent) {
  const headings = results.worlds.flatMap((world) =>
    [world.is_here ? inWorld(world, "mean") : inWorld(world, "not here"), ...world.scenes.map((scene) => inWorld(world, scene))]);
  const valuesOf = (method) => [method.mean[figure], ...method.scenes.map((score) => score?.[figure])];
  const cellsOf = (world, i) => {
    if (!world.is_here) return ["-"];
    const best = valuesOf(world.methods[i]).map((_, column) => Math.max(...wholeView(world).map((other) => valuesOf(other)[column]).filter(isNumber)));
    return valuesOf(world.methods[i]).map((value, column) => {
      const text = number(value, decimals);
      if (!isPercent) return text;
      const isBest = isNumber(value) && !world.methods[i].is_partial && text === number(best[column], decimals);
      return { text, css: shadeOf(value) + (isBest ? " best" : "") };
    });
  };
  return table(caption, ["method", ...headings.map((text) => ({ text, isUpright: true }))],
    own.methods.map((method, i) => [nameCell(method), ...results.worlds.flatMap((world) => cellsOf(world, i))]));
}

function tableOne() {
  if (!own.methods.length) return [];
  // In two lines, so that all scenes fit beside each other.
  const times = (score) =>
    score?.time_ms ? { text: `${number(score.time_ms.median, 2)}\n${number(score.time_ms.p99, 2)}`, css: "two" } : { text: "-" };
  return [
    sceneTable("Table I: mIoU, %. The best of each column in bold, of those that look all round", "iou_percent", 1, true),
    table("Table I: time of a scan, ms: the median, and below it the 99th percentile",
      ["method", ...["all scenes", ...own.scenes].map((text) => ({ text, isUpright: true }))],
      own.methods.map((method) => [nameCell(method), ...[method.total, ...method.scenes].map(times)])),
    note("In print (Jeong and Quattrini Li, IROS 2021, Table I: own lake, own laptop): Euclidean clustering 26.3 % in 140 ms, F3D 23.1 % in 21 ms, " +
      "depth clustering 18.9 % in 16 ms, the paper's method 33.6 % in 30 ms at W = 512, 55.2 % in 57 ms at 1024, 84.5 % in 86 ms at 1800."),
  ];
}

const ofKinds = (world) => !world.kinds.length ? [] : [table(inWorld(world, "Mean IoU by kind of object, over all scenes, %"),
  ["method", ...world.kinds.map((text) => ({ text, isUpright: true }))],
  world.methods.map((method) => [nameCell(method), ...method.kinds_iou_percent.map((percent) => shaded(percent, 1))]))];

const waterAndKinds = () => !own.methods.length ? [] : [
  sceneTable("mIoU over objects in the water alone, %", "water_iou_percent", 1, true),
  sceneTable("Things of 5 returns or more that have a segment, %", "with_segment_percent", 1, true),
  ...results.worlds.flatMap(ofKinds),
];

const segmentCounts = () => !own.methods.length ? [] : [
  sceneTable("False segments a scan", "false_segments", 2, false),
  ...results.worlds.filter(({ methods }) => methods.length).map((world) =>
    table(inWorld(world, "Cut and merged objects, over all scenes"),
      ["method", "segments a scan", "over-segmented objects, %", "under-segmenting segments, %", "true positives, %"],
      world.methods.map((method) => [nameCell(method), ...["segments", "over_segmented_percent", "under_segmented_percent", "true_positive_percent"]
        .map((figure) => number(method.total[figure], 1))]))),
];

// By name in the JSON, as in the tables.
const LOSSES = [["into_land", "into land"], ["into_thing", "into another thing"], ["cut", "cut"], ["with_clutter", "with clutter"], ["missed", "missed"]];
const OUTCOMES = ["found", ...LOSSES.map(([name]) => name)];
const numThings = (outcomes) => OUTCOMES.reduce((sum, name) => sum + outcomes[name], 0);
const lossCells = (outcomes) => {
  const count = numThings(outcomes);
  const percent = (lost) => number((100 * lost) / count, 2);
  return [String(count), percent(count - outcomes.found), ...LOSSES.map(([name]) => percent(outcomes[name]))];
};
const LOSS_HEADINGS = ["things", "lost, %", ...LOSSES.map(([, words]) => `${words}, %`)];

// Of all methods together, and by kind for those that state a probability: ours.
function thingsLost({ methods }) {
  const known = methods.filter(({ outcomes }) => outcomes.length);
  if (!known.length) return [];
  const sum = (rows) => Object.fromEntries(OUTCOMES.map((name) => [name, rows.reduce((total, row) => total + row[name], 0)]));
  return [
    table("Things of 5 returns or more with an IoU below 0.5, by what became of them, over all scenes", ["method", ...LOSS_HEADINGS],
      known.map((method) => [nameCell(method), ...lossCells(sum(method.outcomes))])),
    ...known.filter(({ total }) => total.reliability.length).map(({ name, outcomes }) =>
      table(`${name}: by kind`, ["kind", ...LOSS_HEADINGS], outcomes.map((row) => [row.kind, ...lossCells(row)]))),
  ];
}

// Scenes differ in how much clutter they have: one of rain outweighs all others in the total.
function reliability() {
  const ofScenes = ({ scenes }, names) => {
    const known = scenes.map((score, i) => [names[i], score?.reliability ?? []]).filter(([, bins]) => bins.length);
    return known.length < 2 ? [] : [e("details", {}, e("summary", {}, "By scene"), ...known.map(([name, bins]) => reliabilityDiagram(name, bins)))];
  };
  const diagrams = inEachWorld(({ methods, scenes }) => methods.filter(({ total }) => total.reliability.length)
    .flatMap((method) => [reliabilityDiagram(`${method.name}, all scenes`, method.total.reliability), ...ofScenes(method, scenes)]));
  return !diagrams.length ? [] : [
    note("A dot is the mean of the probabilities that the segments of a bin state, against the share of them most of whose returns are of an object. On the " +
      "broken line both are the same; below it the method is surer than it should be. Bars, on a logarithmic axis: how many segments a bin holds. What is " +
      "left out of a fit is judged by evidence that does not know its scene."),
    ...diagrams];
}

// A chart that can be read, and below it the numbers of all.
function figureByRange(world, bins, title, yLabel) {
  const best = bestMethods(world, NUM_COLOURS - 1);
  const known = world.methods.filter((method) => method[bins].length);
  if (!known.length) return [];
  const lineOf = (method, entries) => ({ name: method.name, isBold: isOurs(method), points: entries.map((bin) => [bin.middle_m, bin.percent]) });
  // One object that happens to be far off would draw a peak.
  const often = (method) => {
    const all = method[bins].reduce((sum, bin) => sum + bin.num_object_scans, 0);
    return method[bins].filter((bin) => 100 * bin.num_object_scans >= all);
  };
  const drawn = known.filter((method) => isOurs(method) || best.includes(method));
  const isLess = drawn.length < known.length ? "Drawn are ours and the methods of the highest mean mIoU; the numbers below are of all. " : "";
  return [lineChart({
    title, xLabel: "range of the object's nearest return, m (middle of the bin)", yLabel, isPercent: true,
    lines: drawn.map((method) => lineOf(method, often(method))), numbers: known.map((method) => lineOf(method, method[bins])),
    note: `${isLess}Bins with less than a hundredth of the object-scans are not drawn.`,
  })];
}

const byRange = (world) => [
  ...figureByRange(world, "iou_by_range", "IoU by range, all scenes", "mean IoU, %"),
  ...figureByRange(world, "recall_by_range", "Recall at IoU 0.5 by range, all scenes", "recall, %"),
  ...(!world.near_recall.length ? [] : [table(`Recall at IoU 0.5 of objects nearer than ${number(world.near_m, 0)} m, %`,
    ["scene: kind", ...world.methods.map(({ name }) => ({ text: name, isUpright: true }))],
    world.near_recall.map(({ scene, kind, percent }) => [`${scene}: ${kind}`, ...percent.map((value) => shaded(value, 0))]))]),
];

const tableTwo = ({ projections }) => !projections.length ? [] : [
  table("Table II: what the range image keeps",
    ["columns", "true positives, %", "points kept a scan", "returns a scan", "distance to the nearest return, mean, m", "sd, m"],
    projections.map((row) => [String(row.columns), number(row.true_positive_percent, 1), number(row.points_kept, 0), number(row.returns, 0),
      number(row.nearest_mean_m, 3), number(row.nearest_sd_m, 3)])),
  note("In print, at 512 / 1024 / 1800 columns: true positives 90.2 / 89.8 / 91.7 %; 1563 / 2726 / 4204 points of 5580; distance -0.079 / -0.023 / " +
    "-0.025 m, sd 0.757 / 0.693 / 0.595 m. How a distance can be negative is not said there; here it is without sign."),
];

// Stages of the segmenter in the order of its work, then others by name.
const STAGES = ["project", "search", "cluster", "measure"];
const stageOrder = ({ name }) => (STAGES.includes(name) ? STAGES.indexOf(name) : STAGES.length);

function tableThree(world) {
  const timeCells = (times) => ["median", "p99", "mean", "sd"].map((figure) => number(times?.[figure], 3));
  const rows = world.methods.filter(({ stages }) => stages.length).flatMap(({ name, stages, total }) => [
    ...[...stages].sort((a, b) => stageOrder(a) - stageOrder(b)).map((stage) => [name, stage.name, ...timeCells(stage.time_ms)]),
    [name, "whole scan", ...timeCells(total.time_ms)].map((text) => ({ text, css: "total" })),
  ]);
  if (!rows.length) return [];
  return [table("Table III: time of a scan by stage, over all scenes, ms", ["method", "stage", "median", "99th percentile", "mean", "sd"], rows),
    note("In print: 35 ms (sd 8 to 15) a scan on a laptop, 37 ms on the boat, 21 ms with a field of view of 90 degrees.")];
}

function ablation({ methods }) {
  const bases = new Set(methods.map(baseOf).filter(Boolean));
  const shown = methods.filter((method) => bases.has(method.name) || baseOf(method));
  if (!bases.size) return [];
  return [
    table("With and without a step, over all scenes",
      ["method", "mIoU, %", "components a scan", "segments a scan", "false segments a scan", "median, ms", "99th percentile, ms"],
      shown.map(({ name, mean, total }) => [name, number(mean.iou_percent, 1), number(mean.components, 1), number(mean.segments, 1),
        number(mean.false_segments, 2), number(total.time_ms?.median, 2), number(total.time_ms?.p99, 2)])),
    barChart("Time of a scan with and without a step", "median, ms", ["median"],
      shown.map(({ name, total }) => ({ name, values: [total.time_ms?.median] })), 2),
    barChart("Components of a scan before they are clustered", "components a scan", ["components"],
      shown.map(({ name, mean }) => ({ name, values: [mean.components] })), 0),
    note("In print: with breadth-first search 72 ms and 460 components, without 297 ms and 1604."),
  ];
}

const curves = () => results.curves.map((curve) => lineChart({
  title: curve.title, xLabel: curve.x_label, yLabel: curve.y_label, lines: curve.lines, numbers: curve.lines,
  note: curve.scans_from ? `On ${curve.scans_from}. ${curve.note}` : curve.note,
}));

function worstScans({ methods }) {
  const figures = methods.flatMap(({ name, worst }) => worst.map((scan) => plan(name, scan)));
  return figures.length ? [e("p", {}, "Seen from above, bow up; the triangle is the boat, rings give the range. A number is an object of the truth, and " +
    "in the prediction stands at the segment that fits it best; 3+4 is one segment that fits two. A segment has the colour of the object that it shares " +
    "most returns with. A dashed line is drawn round a segment whose object has a better one: it is a piece (of more than a hundred, round the larger " +
    "ones). Segments that hold no object at all are outlined and dotted in the colour of this text. Grey: returns of no object on the left, in no " +
    "segment on the right, and on both sides what the method does not look at."), ...figures] : [];
}

// The words of lab/eval/README.md, in short.
const DEFINITIONS = [
  ["IoU", "Of a true object and a segment: the returns that both have, through the returns that at least one of them has. The IoU of an object is that " +
    "with the segment for which it is largest; 0 when no segment holds any of it."],
  ["mIoU", "The paper's equation: the mean of the IoU over the true objects with a return in a scan, then over the scans of a scene. The mean over scenes " +
    "counts each scene with objects the same."],
  ["object in the water", "Boats, kayaks, swimmers, buoys, markers. Land, docks, piers and walls are not."],
  ["return of no object", "Strays, rain, spray, glints, crests, wakes and the own boat. They are no objects; in a segment they lower its IoU."],
  ["false segment", "A segment without a return of any object; one of the own boat is false too. In captures of the second world the own boat's returns " +
    "are taken out by their truth before a method sees them."],
  ["all segments, sure only", "Two operating points of one method, each in a row of its own: every segment counts, or those alone that the method does " +
    "not call tentative. The others have one: every segment counts."],
  ["second world", "Captures with truth, made by others than our simulator's authors."],
  ["thing with a segment", "An object with 5 returns or more in a scan, whose returns are more than half of some segment."],
  ["over-segmented", "An object of which two or more segments hold a tenth each."],
  ["under-segmenting", "A segment that holds a tenth each of two or more objects."],
  ["true positives", "The share of the objects' returns that are in a segment of which their object has most returns."],
  ["thing lost", "An object that is not land, of 5 returns or more in a scan, with an IoU below 0.5. Into land, into another thing, with clutter: the segment " +
    "that holds most of it is mostly of that. Cut: mostly its own, and more of it is elsewhere. Missed: more of it is in no segment than in any one."],
  ["recall at IoU 0.5", "The share of object-scans whose IoU is 0.5 or more, by the range of the object's nearest return, in bins of 10 m."],
  ["component", "Of methods that search first and cluster then: what the search gave."],
  ["time", "Of labelling one scan, on one core, without rendering, decoding and scoring. The 99th percentile is of the nearest rank."],
  ["points kept", "Of the first whole scan of each seed: returns that keep their pixel of the range image; the distance is from the point of a pixel to " +
    "the nearest return, without sign."],
];

const sections = [
  ["run", "What was run", whatWasRun()],
  ["summary", "Summary", inEachWorld(summary)],
  ["table-1", "Table I: methods and scenes", tableOne()],
  ["water", "Objects in the water, and kinds", waterAndKinds()],
  ["segments", "False, cut and merged segments", segmentCounts()],
  ["lost", "Things lost", inEachWorld(thingsLost)],
  ["reliability", "Are stated probabilities true?", reliability()],
  ["range", "By range", inEachWorld(byRange)],
  ["table-2", "Table II: projections", inEachWorld(tableTwo)],
  ["table-3", "Table III: time by stage", inEachWorld(tableThree)],
  ["ablation", "Ablation", inEachWorld(ablation)],
  ["curves", "Tests of the paper, and sweeps", curves()],
  ["worst", "Worst scans", inEachWorld(worstScans)],
  ["definitions", "Definitions", [entries(DEFINITIONS)]],
].filter(([, , nodes]) => nodes.length);
document.body.replaceChildren(
  e("header", {}, e("h1", {}, "Lookout: segmentation evaluated"),
    e("nav", { ariaLabel: "Contents" }, e("ul", {}, ...sections.map(([id, title]) => e("li", {}, e("a", { href: `#${id}` }, title)))))),
  e("main", {}, ...sections.map(([id, title, nodes]) => e("section", { id }, e("h2", {}, title), ...nodes))));
