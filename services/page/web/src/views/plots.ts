// Numbers over time, chosen from all that messages hold: live the last minutes, of a recording what stood around the moment that is shown.
import { beginOf } from "../film.js";
import { channelOf, chartOf, type Path, Ring, timeIn, valueIn, valueInBytes } from "./series.js";
import { type Frame, kNoConnection, RequestRefused } from "../link.js";
import { Refused } from "../messages/reader.js";
import type { State, View } from "../state.js";
import { texts } from "../texts/index.js";
import { Chart } from "./chart.js";
import { Chooser } from "./chooser.js";
import { button, make, Pace, placeChildren } from "./dom.js";

const words = texts.panels.plots;
const kEvery_ms = 250;
const kRoom = 6200;             // ten minutes of ten a second
const kMaxSeries = 12;
const kMinutes = [1, 2, 5, 10];
// Of a range: more than a chart is wide; of HEALTH each process's, ten minutes of them; fewer of TRACKS, which are large.
const kMaxMessages = new Map([["HEALTH", 5000], ["TRACKS", 400]]);
const kMaxOfOthers = 1500;
const kKey = "lookout.plots";
const kFirst: Path[] = ["POSE/heading_rad", "PAGE/num_tracks", "HEALTH/tracker/cpu_fraction", "HEALTH/segmenter/cpu_fraction"];

interface Kept { paths: Path[]; minutes: number }

export class Plots implements View {
  readonly element = make("div", "view plots");
  private readonly rings = new Map<Path, Ring>();
  private readonly charts = new Map<string, Chart>();
  private readonly area = make("div", "charts");
  private readonly empty = make("p", "empty", words.empty);
  private readonly span = make("select");
  private readonly chooser: Chooser;
  private paths: Path[];
  private minutes: number;
  private isVisible = false;
  private readonly pace = new Pace(() => { this.draw(); }, () => kEvery_ms);
  private asked = "";
  private chosen: number | null = null;

  constructor(private readonly state: State) {
    ({ paths: this.paths, minutes: this.minutes } = load());
    this.chooser = new Chooser(state, (path) => { this.add(path); });
    const bar = make("div", "toolbar"), label = make("label", "muted", `${words.window} `);
    for (const minutes of [...kMinutes, 0]) {
      const option = make("option", "", minutes === 0 ? words.whole : words.minutes(minutes));
      option.value = String(minutes);
      this.span.append(option);
    }
    this.span.value = String(this.minutes);
    this.span.onchange = () => {
      this.minutes = Number(this.span.value);
      this.keep();
      void this.fetch();
      this.draw();
    };
    label.append(this.span);
    bar.append(button(words.add, () => { this.chooser.open(this.paths); }, "primary"), label);
    this.element.append(bar, this.empty, this.area, this.chooser.element);
    for (const path of this.paths) this.rings.set(path, new Ring(kRoom));
    state.on(["picture"], () => { this.take(); });
    state.on(["showing", "connection", "sources"], () => { void this.fetch(); });
    state.on(["settings"], () => {
      if (this.isVisible) for (const chart of this.charts.values()) chart.recolour();
    });
    state.on(["marked"], () => {
      if (state.chosen === this.chosen) return;
      this.chosen = state.chosen;
      for (const [path, ring] of this.rings) if (path.startsWith("TRACK/chosen/")) ring.clear();
      this.asked = "";
      void this.fetch();
    });
    new ResizeObserver(() => { for (const chart of this.charts.values()) chart.resize(this.area.clientWidth); }).observe(this.area);
    this.arrange();
  }

  setVisible(isVisible: boolean): void {
    this.isVisible = isVisible;
    if (isVisible) {
      for (const chart of this.charts.values()) chart.recolour();
      void this.fetch();
      this.draw();
    }
  }

  private get isRecorded(): boolean { return this.state.hello?.mode === "log" || this.state.showing.kind === "recorded"; }

  // Live, each picture gives one number of each path, also while another view is shown: that is what plots are for.
  private take(): void {
    const { picture } = this.state;
    if (picture === null) return;
    if (!this.isRecorded) {
      for (const [path, ring] of this.rings) ring.push(timeIn(picture, path) / 1e6, valueIn(picture, path, this.state.chosen));
    }
    if (this.isVisible) this.pace.ask();
  }

  private bounds(): { from_s: number; to_s: number; now_s: number } {
    const { state } = this;
    const now_us = state.showing.kind === "recorded" ? state.showing.utime_us : Math.max(0, ...state.picture?.times_us.values() ?? []);
    const now_s = now_us / 1e6;
    const length_s = 60 * this.minutes;
    if (!this.isRecorded) return { from_s: now_s - (length_s === 0 ? 600 : length_s), to_s: now_s, now_s: NaN };
    const source = this.source();
    const begin_s = (source?.begin_utime_us ?? 0) / 1e6, end_s = (source?.end_utime_us ?? 0) / 1e6;
    if (length_s === 0 || end_s - begin_s <= length_s) return { from_s: begin_s, to_s: end_s, now_s };
    // Steps of a third, so that not each scan asks for another range.
    const step_s = length_s / 3;
    const from_s = Math.max(begin_s, Math.floor((now_s - begin_s) / step_s - 1) * step_s + begin_s);
    return { from_s, to_s: Math.min(end_s, from_s + length_s), now_s };
  }
  private source() {
    const number = this.state.showing.kind === "recorded" ? this.state.showing.source : 0;
    return this.state.sources.find((candidate) => candidate.id === number);
  }

  private draw(): void {
    if (!this.isVisible) return;
    if (this.isRecorded) void this.fetch();
    const { from_s, to_s, now_s } = this.bounds();
    if (to_s > from_s) for (const chart of this.charts.values()) chart.draw(this.rings, from_s, to_s, now_s, beginOf(this.state) / 1e6);
  }

  // Of a recording, or of what the server still has of the minutes before: one range for each channel.
  private async fetch(): Promise<void> {
    const { state } = this;
    const source = this.source();
    if (!this.isVisible || state.link === null || source === undefined || state.indexing.has(source.id) || this.paths.length === 0) return;
    const { from_s, to_s } = this.bounds();
    if (!(to_s > from_s)) return;
    const asked = `${source.id} ${this.isRecorded ? `${from_s} ${to_s}` : `live ${this.minutes}`} ${state.chosen} ${this.paths.join(" ")}`;
    if (asked === this.asked) return;
    this.asked = asked;
    for (const channel of new Set(this.paths.map(channelOf))) {
      try {
        const paths = this.paths.filter((path) => channelOf(path) === channel);
        const { frames } = await state.link.range(source.id, channel, Math.round(1e6 * from_s), Math.round(1e6 * to_s),
          kMaxMessages.get(channel) ?? kMaxOfOthers);
        if (this.asked !== asked) return;
        for (const path of paths) this.fill(path, frames);
        this.draw();
      } catch (error) {
        if (!(error instanceof RequestRefused)) throw error;
        // Without a connection live goes on with what comes, and a recording is asked again when something changes. What is refused is not there.
        if (error.message !== kNoConnection) continue;
        if (this.isRecorded && this.asked === asked) this.asked = "";
        return;
      }
    }
  }

  private fill(path: Path, frames: readonly Frame[]): void {
    const ring = this.rings.get(path);
    if (ring === undefined) return;
    const before = Array.from({ length: ring.count }, (_, index) => [ring.time(index), ring.value(index)] as const);
    const found = new Map<number, { came_us: number; value: number }>();
    for (const { bytes, utime_us: came_us } of frames) {
      try {
        const { utime_us, value } = valueInBytes(path, bytes, this.state.chosen);
        // Of a message in parts, one part holds the track; of HEALTH, one process the number.
        if (path.startsWith("HEALTH/") ? !Number.isNaN(value) : !(Number.isNaN(value) && found.has(utime_us))) found.set(utime_us, { came_us, value });
      } catch (error) {
        if (!(error instanceof Refused)) throw error;
      }
    }
    ring.clear();
    for (const { came_us, value } of [...found.values()].sort((a, b) => a.came_us - b.came_us)) ring.push(came_us / 1e6, value);
    if (!this.isRecorded) for (const [time_s, value] of before) ring.push(time_s, value);
  }

  private add(path: Path): void {
    if (this.paths.includes(path)) return;
    this.paths = [...this.paths, path].slice(-kMaxSeries);
    this.change();
  }
  private remove(path: Path): void {
    this.paths = this.paths.filter((other) => other !== path);
    this.change();
  }
  private change(): void {
    for (const path of this.rings.keys()) if (!this.paths.includes(path)) this.rings.delete(path);
    for (const path of this.paths) if (!this.rings.has(path)) this.rings.set(path, new Ring(kRoom));
    this.keep();
    this.arrange();
    void this.fetch();
    this.draw();
  }

  private arrange(): void {
    const groups = new Map<string, Path[]>();
    for (const path of this.paths) groups.set(chartOf(path), [...groups.get(chartOf(path)) ?? [], path]);
    for (const [name, chart] of this.charts) {
      if (groups.get(name)?.join() === chart.paths.join()) continue;
      chart.destroy();
      this.charts.delete(name);
    }
    for (const [name, paths] of groups) {
      if (this.charts.has(name)) continue;
      this.charts.set(name, new Chart(paths, this.area.clientWidth || 360, {
        remove: (path) => { this.remove(path); },
        seek: (time_s) => { if (this.state.sources.length > 0) this.state.seek(Math.round(1e6 * time_s)); },
      }));
    }
    placeChildren(this.area, [...groups.keys()].map((name) => this.charts.get(name)!.element));
    this.empty.hidden = this.paths.length > 0;
  }

  private keep(): void {
    const kept: Kept = { paths: this.paths, minutes: this.minutes };
    try { localStorage.setItem(kKey, JSON.stringify(kept)); } catch { /* a browser that keeps nothing */ }
  }
}

// What is not of this shape is left out.
function load(): Kept {
  try {
    const kept = JSON.parse(localStorage.getItem(kKey) ?? "{}") as Partial<Kept>;
    const paths = Array.isArray(kept.paths) ? kept.paths.filter((path) => typeof path === "string" && /^[A-Z_]+\/./.test(path)).slice(0, kMaxSeries) : kFirst;
    return { paths, minutes: [...kMinutes, 0].includes(kept.minutes ?? -1) ? kept.minutes! : 2 };
  } catch {
    return { paths: kFirst, minutes: 2 };
  }
}
