// Two recordings of the same journey beside each other, at the same scan: what one says and the other does not is marked and listed.
import type { Scene } from "../drawing/scene.js";
import type { Theme } from "../drawing/colours.js";
import { type Film, lineOf } from "../film.js";
import { type Frame, RequestRefused } from "../link.js";
import type { Track } from "../messages/generated.js";
import { Assembler, kPictureChannels, type Picture } from "../picture.js";
import { State, type View } from "../state.js";
import { texts } from "../texts/index.js";
import { bearing, length, speed } from "../units.js";
import { AroundView } from "./around.js";
import { compare, type Differences } from "./differences.js";

const kMostSearched = 600;   // scans, for the next one that differs

/** The picture around the boat with marks, which moves with the one beside it. */
class ComparedView extends AroundView {
  beside: ComparedView | null = null;
  /** Places in the level frame, m: x forward, y port; one pair after the other. */
  marks: Float32Array = new Float32Array();
  segmentMarks: { x_m: number; y_m: number; radius_m: number }[] = [];

  protected override pan(dx_px: number, dy_px: number): void {
    super.pan(dx_px, dy_px);
    this.beside?.follow(() => { this.beside?.panAlone(dx_px, dy_px); }, this.plane.px_per_m);
  }
  protected override zoom(factor: number, x_px: number, y_px: number): void {
    super.zoom(factor, x_px, y_px);  // which pans
  }
  protected override centre(): void {
    super.centre();
    this.beside?.follow(() => { this.beside?.centreAlone(); }, this.plane.px_per_m);
  }
  private panAlone(dx_px: number, dy_px: number): void { super.pan(dx_px, dy_px); }
  private centreAlone(): void { super.centre(); }
  private follow(move: () => void, px_per_m: number): void {
    this.plane.px_per_m = px_per_m;
    move();
    this.stage.ask();
  }
  redraw(): void { this.stage.ask(); }

  protected override paintGround = (context: CanvasRenderingContext2D, theme: Theme, scene: Scene | null): void => {
    void theme;
    if (scene === null) return;
    const { own } = scene, sin = Math.sin(own.heading_rad), cos = Math.cos(own.heading_rad);
    const east = (x: number, y: number) => own.east_m + x * sin - y * cos, north = (x: number, y: number) => own.north_m + x * cos + y * sin;
    const colour = getComputedStyle(this.element).getPropertyValue("--warning");
    context.fillStyle = colour;
    context.globalAlpha = 0.5;
    for (let i = 0; i + 1 < this.marks.length; i += 2) {
      const x = this.marks[i]!, y = this.marks[i + 1]!, e = east(x, y), n = north(x, y);
      context.fillRect(this.plane.x(e, n) - 2.5, this.plane.y(e, n) - 2.5, 5, 5);
    }
    context.globalAlpha = 1;
    context.strokeStyle = colour;
    context.lineWidth = 2.5;
    for (const { x_m, y_m, radius_m } of this.segmentMarks) {
      const e = east(x_m, y_m), n = north(x_m, y_m);
      context.beginPath();
      context.arc(this.plane.x(e, n), this.plane.y(e, n), Math.max(10, radius_m * this.plane.px_per_m + 6), 0, 2 * Math.PI);
      context.stroke();
    }
  };
}

function element<Tag extends keyof HTMLElementTagNameMap>(tag: Tag, name: string, text = ""): HTMLElementTagNameMap[Tag] {
  const made = document.createElement(tag);
  made.className = name;
  if (text !== "") made.textContent = text;
  return made;
}

export class CompareView implements View {
  readonly element = element("div", "view compare");
  private readonly sides: State[];
  private readonly views: ComparedView[];
  private readonly names = [element("h2", "compare_name"), element("h2", "compare_name")];
  private readonly summary = element("p", "compare_summary");
  private readonly table = element("table", "compare_table");
  private readonly search: HTMLButtonElement;
  private readonly body = element("div", "compare_body");
  private readonly hint = element("p", "compare_hint", texts.compare.hint);
  private isVisible = false;
  private isSearching = false;
  private shown: { first: Picture | null; second: Picture | null } = { first: null, second: null };

  constructor(private readonly state: State, private readonly film: Film) {
    this.sides = [0, 1].map(() => new State(null, state.settings));
    this.views = this.sides.map((side) => new ComparedView(side));
    const [left, right] = this.views as [ComparedView, ComparedView];
    left.beside = right;
    right.beside = left;
    this.search = element("button", "compare_next", texts.compare.next);
    this.search.type = "button";
    this.search.onclick = () => { if (this.isSearching) this.isSearching = false; else void this.searchOn(); };
    this.summary.setAttribute("role", "status");
    this.table.setAttribute("aria-label", texts.compare.table);
    const panes = this.views.map((view, index) => {
      const pane = element("section", "compare_side");
      pane.append(this.names[index]!, view.element);
      return pane;
    });
    const drawn = element("div", "compare_sides"), told = element("div", "compare_told"), head = element("div", "compare_head");
    drawn.append(...panes);
    head.append(this.summary, this.search);
    told.append(head, this.table);
    this.body.append(drawn, told);
    this.element.append(this.hint, this.body);
    for (const [index, side] of this.sides.entries()) {
      // What is pointed at here is pointed at in the whole page; ids of the second recording are its own.
      if (index === 0) side.on(["marked"], () => { state.mark(side.marked); });
    }
    state.on(["marked"], () => { this.sides[0]!.mark(state.marked); });
    state.on(["settings"], () => { for (const side of this.sides) side.tell("settings"); });
    state.on(["sources"], () => { this.choose(); });
    state.on(["picture", "showing"], () => { this.update(); });
    this.choose();
  }

  setVisible(isVisible: boolean): void {
    this.isVisible = isVisible;
    for (const view of this.views) view.setVisible(isVisible && !this.body.hidden);
    this.choose();
    if (!isVisible) this.isSearching = false;
    this.update();
  }

  /** The recording that runs beside the first of the line; undefined: there is none. */
  private get other(): number | undefined {
    const line = lineOf(this.state.sources).map((source) => source.id);
    return this.state.sources.find((source) => !line.includes(source.id))?.id;
  }
  private choose(): void {
    const other = this.other, name = (id: number | undefined) => this.state.sources.find((source) => source.id === id)?.name ?? "";
    this.hint.hidden = other !== undefined;
    if (this.body.hidden !== (other === undefined)) {
      this.body.hidden = other === undefined;
      for (const view of this.views) view.setVisible(this.isVisible && other !== undefined);
    }
    this.names[0]!.textContent = name(lineOf(this.state.sources)[0]?.id);
    this.names[1]!.textContent = name(other);
    this.film.setBeside(this.isVisible && other !== undefined ? other : null);
  }

  private update(): void {
    const first = this.state.picture, second = this.state.beside;
    if (!this.isVisible || this.body.hidden || (first === this.shown.first && second === this.shown.second)) return;
    this.shown = { first, second };
    const differences = first === null || second === null ? null : compare(first, second);
    for (const [index, side] of this.sides.entries()) {
      side.picture = index === 0 ? first : second;
      side.showing = this.state.showing;
      side.age_s = this.state.age_s;
      this.mark(this.views[index]!, side.picture, differences, index);
      side.tell("picture");
      this.views[index]!.redraw();
    }
    this.tell(differences);
  }

  private mark(view: ComparedView, picture: Picture | null, differences: Differences | null, index: number): void {
    const returns = picture?.returns ?? null;
    view.segmentMarks = [];
    view.marks = new Float32Array();
    if (returns === null || differences === null || !differences.isSameScan) return;
    const marks = new Float32Array(2 * differences.otherReturns.length);
    for (const [i, at] of differences.otherReturns.entries()) {
      marks[2 * i] = returns.level_m[3 * at]!;
      marks[2 * i + 1] = returns.level_m[3 * at + 1]!;
    }
    view.marks = marks;
    const only = new Set(index === 0 ? differences.segmentsOnlyInFirst : differences.segmentsOnlyInSecond);
    const boxes = new Map<number, { x0: number; x1: number; y0: number; y1: number }>();
    for (let i = 0; i < returns.count; ++i) {
      const label = returns.label[i]!;
      if (!only.has(label)) continue;
      const x = returns.level_m[3 * i]!, y = returns.level_m[3 * i + 1]!, box = boxes.get(label);
      if (box === undefined) boxes.set(label, { x0: x, x1: x, y0: y, y1: y });
      else { box.x0 = Math.min(box.x0, x); box.x1 = Math.max(box.x1, x); box.y0 = Math.min(box.y0, y); box.y1 = Math.max(box.y1, y); }
    }
    view.segmentMarks = [...boxes.values()].map(({ x0, x1, y0, y1 }) => ({ x_m: (x0 + x1) / 2, y_m: (y0 + y1) / 2, radius_m: Math.hypot(x1 - x0, y1 - y0) / 2 }));
  }

  private tell(differences: Differences | null): void {
    const { compare: words } = texts;
    const rows: [string, string, string][] = [];
    if (differences === null) this.summary.textContent = words.nothing;
    else if (!differences.isSameScan) this.summary.textContent = words.noScan;
    else {
      const { otherReturns, numReturns, segmentsOnlyInFirst, segmentsOnlyInSecond } = differences;
      const share = numReturns === 0 ? 0 : 100 * otherReturns.length / numReturns;
      this.summary.textContent = isSame(differences) ? words.same(numReturns) : words.returns(otherReturns.length, numReturns, share.toFixed(share < 10 ? 1 : 0));
      if (segmentsOnlyInFirst.length + segmentsOnlyInSecond.length > 0) rows.push([words.segments, String(segmentsOnlyInFirst.length), String(segmentsOnlyInSecond.length)]);
      for (const { first, second, what } of differences.tracks) rows.push([words.track[what], this.track(first), this.track(second)]);
      for (const text of differences.alertsOnlyInFirst) rows.push([words.alert, text, "–"]);
      for (const text of differences.alertsOnlyInSecond) rows.push([words.alert, "–", text]);
    }
    const row = (cells: readonly string[], tag: "td" | "th") => {
      const line = document.createElement("tr");
      line.append(...cells.map((text) => element(tag, "", text)));
      return line;
    };
    this.table.replaceChildren(row(["", words.first, words.second], "th"), ...rows.map((cells) => row(cells, "td")));
    this.table.hidden = rows.length === 0;
  }
  private track(track: Track | null): string {
    if (track === null) return "–";
    const { settings } = this.state;
    return [texts.drawing.name(track.kind, track.id), bearing(track.bearing_rad), length(settings, track.range_m), speed(settings, track.speed_mps),
      track.tcpa_s > 0 ? texts.compare.approach(length(settings, track.cpa_m)) : ""].filter((part) => part !== "").join(", ");
  }

  // The next scan of which segments, tracks or alerts differ.
  private async searchOn(): Promise<void> {
    const { link, showing } = this.state, other = this.other;
    if (link === null || showing.kind !== "recorded" || other === undefined) return;
    this.film.pause();
    this.isSearching = true;
    let at_us = showing.utime_us, numSearched = 0;
    const picture = (frames: Frame[], source: number) => {
      const assembler = new Assembler();
      assembler.boat = this.state.sources.find((candidate) => candidate.id === source)?.boat ?? null;
      for (const frame of frames) assembler.take(frame);
      return assembler.picture();
    };
    try {
      while (this.isSearching && numSearched < kMostSearched) {
        const { head, frames } = await link.step(showing.source, at_us, 1, kPictureChannels);
        if (head.utime_us <= at_us) { this.summary.textContent = texts.compare.noMore; break; }
        const beside = await link.at(other, { scan_utime_us: head.scan_utime_us }, kPictureChannels);
        at_us = head.utime_us;
        const differences = compare(picture(frames, head.source), picture(beside.frames, other));
        if (!differences.isSameScan || !isAlike(differences)) { this.film.seek(at_us); break; }
        this.search.textContent = texts.compare.searching(++numSearched);
      }
      if (numSearched === kMostSearched) this.film.seek(at_us);
    } catch (error) {
      if (!(error instanceof RequestRefused)) throw error;
    }
    this.isSearching = false;
    this.search.textContent = texts.compare.next;
  }
}

function isAlike({ segmentsOnlyInFirst, segmentsOnlyInSecond, tracks, alertsOnlyInFirst, alertsOnlyInSecond }: Differences): boolean {
  return segmentsOnlyInFirst.length + segmentsOnlyInSecond.length + tracks.length + alertsOnlyInFirst.length + alertsOnlyInSecond.length === 0;
}
function isSame(differences: Differences): boolean { return isAlike(differences) && differences.otherReturns.length === 0; }
