// One chart of numbers of like name and unit, by uPlot. Its cursor moves with those of the other charts.
import uPlot from "uplot";
import { texts } from "../texts/index.js";
import { sinceBegin, timeOfDay } from "../units.js";
import { onCircle, unwrapped } from "./circle.js";
import { button, make, setText } from "./dom.js";
import { svg } from "./shapes.js";
import { isOnCircle, type Path, type Ring, unitOf } from "./series.js";

const words = texts.panels.plots;
const kHeight_px = 150;
const kDegreeSteps = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 45, 90, 180, 360, 720];
const kSync = "plots";
// Lines are told apart by dashes as well: in the night there is one colour.
const kStrokes: { colour: string; dash: number[] }[] = [
  { colour: "--accent", dash: [] }, { colour: "--text", dash: [6, 4] }, { colour: "--caution", dash: [2, 3] }, { colour: "--ok", dash: [10, 4, 2, 4] },
];
const strokeOf = (index: number) => kStrokes[index % kStrokes.length]!;

/** A path as people read it: "tracker: cpu fraction". */
export function labelOf(path: Path): string {
  const parts = path.split("/");
  const field = parts.at(-1)!.replace(/_(rad|radps|us|bytes|mps|m|s|hz|deg|rpm|ppm)$/, "").replaceAll("_", " ");
  if (path === "PAGE/num_tracks") return words.numTracks;
  if (path === "PAGE/num_returns") return words.numReturns;
  if (parts[0] === "TRACK") return `${parts[1] === "chosen" ? words.chosen : words.ofTrack(Number(parts[1]))}: ${field}`;
  return `${parts.length > 2 ? parts[1]! : parts[0]!}: ${field}`;
}

export function valueText(value: number | null | undefined, unit: string): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const magnitude = Math.abs(value);
  const text = Number.isInteger(value) ? String(value) : value.toFixed(magnitude >= 100 ? 0 : magnitude >= 10 ? 1 : magnitude >= 1 ? 2 : 3);
  return unit === "" ? text : unit.startsWith("°") ? `${text}${unit}` : `${text} ${unit}`;
}

export interface ChartActions { remove(path: Path): void; seek(time_s: number): void }

export class Chart {
  readonly element = make("div", "chart");
  private readonly plot: uPlot;
  private readonly values: HTMLElement[] = [];
  private readonly strokes: SVGLineElement[] = [];
  private readonly unit: string;
  private readonly factors: number[];
  private readonly isCircle: boolean;
  private shown_s = NaN;
  private begin_s = NaN;
  private colours = new Map<string, string>();

  constructor(readonly paths: readonly Path[], width_px: number, actions: ChartActions) {
    this.unit = unitOf(paths[0]!).unit;
    this.factors = paths.map((path) => unitOf(path).factor);
    this.isCircle = paths.every(isOnCircle);
    this.readColours();
    const legend = make("div", "legend");
    paths.forEach((path, index) => {
      const one = make("span", "series"), stroke = svg("svg", { viewBox: "0 0 26 8", class: "stroke", "aria-hidden": "true" });
      const line = svg("line", { x1: "1", y1: "4", x2: "25", y2: "4", "stroke-width": "2.5", "stroke-dasharray": strokeOf(index).dash.join(" ") });
      stroke.append(line);
      this.strokes.push(line);
      const value = make("b");
      this.values.push(value);
      const remove = button("×", () => { actions.remove(path); });
      remove.setAttribute("aria-label", words.remove(labelOf(path)));
      one.append(stroke, make("span", "", labelOf(path)), value, remove);
      legend.append(one);
    });
    this.element.append(legend);
    this.element.setAttribute("role", "group");
    this.element.setAttribute("aria-label", words.chart(paths.map(labelOf).join(", ")));
    this.element.title = words.seekHint;
    const axis = () => ({
      stroke: () => this.colour("--muted"), grid: { stroke: () => this.colour("--line"), width: 1 }, ticks: { stroke: () => this.colour("--line"), width: 1 },
      font: "12px system-ui, sans-serif",
    });
    this.plot = new uPlot({
      width: Math.max(200, width_px - 16), height: kHeight_px, legend: { show: false },
      cursor: { sync: { key: kSync }, drag: { x: false, y: false }, points: { size: 7 } },
      scales: { x: { time: true } },
      tzDate: (seconds) => uPlot.tzDate(new Date(seconds * 1000), "Etc/UTC"),
      axes: [
        { ...axis(), space: 80, size: () => (Number.isFinite(this.begin_s) ? 42 : 28), values: (_, splits) => splits.map((split) => `${timeOfDay(split * 1e6)}\n${sinceBegin(split * 1e6, this.begin_s * 1e6, 0)}`.trim()) },
        {
          ...axis(), size: 64, space: 28, ...(this.isCircle ? { incrs: kDegreeSteps } : {}),
          values: (_, splits) => splits.map((split) => this.word(Number(split.toPrecision(6)))),
        },
      ],
      series: [{}, ...paths.map((_, index) => ({
        stroke: () => this.colour(strokeOf(index).colour), width: 2, dash: strokeOf(index).dash, points: { show: false },
      }))],
      hooks: {
        setCursor: [(plot) => { this.tell(plot.cursor.idx ?? null); }],
        drawAxes: [(plot) => { this.drawNow(plot); }],
      },
    }, [[], ...paths.map(() => [])] as unknown as uPlot.AlignedData, this.element);
    this.plot.over.addEventListener("click", () => {
      const { left } = this.plot.cursor;
      if (left !== undefined && left !== null && left >= 0) actions.seek(this.plot.posToVal(left, "x"));
    });
    this.recolour();
  }

  /** @param now_s the moment that is shown, marked by a line; NaN: none. @param begin_s where seconds are counted from; NaN: nowhere */
  draw(rings: ReadonlyMap<Path, Ring>, from_s: number, to_s: number, now_s: number, begin_s: number): void {
    this.begin_s = begin_s;
    this.shown_s = now_s;
    const buckets = Math.max(100, Math.min(600, Math.floor(this.plot.width / 2)));
    const tables = this.paths.map((path, index) => {
      const { times, values } = rings.get(path)?.thinned(from_s, to_s, buckets) ?? { times: [], values: [] };
      const factor = this.factors[index]!;
      const shown = values.map((value) => (value === null ? null : value * factor));
      return [times, this.isCircle ? unwrapped(shown) : shown] as uPlot.AlignedData;
    });
    this.plot.batch(() => {
      this.plot.setData(tables.length === 1 ? tables[0]! : uPlot.join(tables), false);
      this.plot.setScale("x", { min: from_s, max: to_s });
    });
    this.tell(this.plot.cursor.idx ?? null);
  }

  resize(width_px: number): void {
    const width = Math.max(200, width_px - 16);
    if (width !== this.plot.width && width_px > 0) this.plot.setSize({ width, height: kHeight_px });
  }
  recolour(): void {
    this.readColours();
    this.strokes.forEach((line, index) => { line.setAttribute("stroke", this.colour(strokeOf(index).colour)); });
    this.plot.redraw(false, true);
  }
  destroy(): void { this.plot.destroy(); }

  // Values below the cursor; without a cursor those of the moment that is shown, else the last.
  private tell(pointed: number | null): void {
    const index = pointed ?? (Number.isFinite(this.shown_s) && this.plot.data[0].length > 0 ? this.plot.valToIdx(this.shown_s) : null);
    this.paths.forEach((_, series) => {
      const values = this.plot.data[series + 1]!;
      let at = index ?? values.length - 1;
      // Times of other numbers stand between: the one before holds. Where it has none itself, there is none.
      while (at > 0 && values[at] === undefined) --at;
      setText(this.values[series]!, this.word(values[at]));
    });
  }

  private word(value: number | null | undefined): string {
    return valueText(this.isCircle && value !== null && value !== undefined ? onCircle(value) : value, this.unit);
  }

  private drawNow(plot: uPlot): void {
    if (!Number.isFinite(this.shown_s)) return;
    const x = Math.round(plot.valToPos(this.shown_s, "x", true));
    if (x < plot.bbox.left || x > plot.bbox.left + plot.bbox.width) return;
    plot.ctx.fillStyle = this.colour("--text");
    plot.ctx.fillRect(x - 1, plot.bbox.top, 2, plot.bbox.height);
  }

  private colour(name: string): string { return this.colours.get(name) ?? "gray"; }
  private readColours(): void {
    const style = getComputedStyle(document.documentElement);
    const names = ["--accent", "--text", "--caution", "--ok", "--muted", "--line"];
    this.colours = new Map(names.map((name) => [name, style.getPropertyValue(name).trim() || "gray"]));
  }
}
