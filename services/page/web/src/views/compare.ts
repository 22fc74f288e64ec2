// Two recordings of the same journey beside each other, at the same scan: what one says and the other does not is marked and listed.
import type { Scene } from "../drawing/scene.js";
import type { Theme } from "../drawing/colours.js";
import { beginOf, type Film, lineOf } from "../film.js";
import { type Answer, type Frame, RequestRefused } from "../link.js";
import { Segments, type Track } from "../messages/generated.js";
import { Assembler, type Picture } from "../picture.js";
import { State, type View } from "../state.js";
import { texts } from "../texts/index.js";
import { bearing, length, sinceBegin, speed } from "../units.js";
import { AroundView } from "./around.js";
import { Beginnings, compare, compareLabels, type Differences, type Limits, mattering, nameOfAlert, nameOfTrack } from "./differences.js";
import { button, make, setAttribute, setText } from "./dom.js";

const kToldEvery = 10;
const kSearched = ["SEGMENTS", "TRACKS", "ALERTS"];   // what is asked for of the scans that are searched

/** The picture around the boat with marks, which moves with the one beside it. */
class ComparedView extends AroundView {
  beside: ComparedView | null = null;
  /** Whose scale is also this one's; null: it has its own. */
  leader: ComparedView | null = null;
  /** Places in the level frame, m: x forward, y port; one pair after the other. */
  marks: Float32Array = new Float32Array();
  segmentMarks: { x_m: number; y_m: number; radius_m: number }[] = [];

  protected override place(picture: Picture, scene: Scene): boolean {
    const isPlaced = super.place(picture, scene);
    if (this.leader !== null && this.leader.scene !== null) this.plane.px_per_m = this.leader.plane.px_per_m;
    return isPlaced;
  }
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

// Labels of all returns of a scan, column by column; null where it has no SEGMENTS.
function labelsOf(frames: readonly Frame[]): Int16Array | null {
  const parts = frames.filter(({ channel }) => channel === "SEGMENTS").map(({ bytes }) => Segments.decode(bytes)).sort((a, b) => a.first_column - b.first_column);
  if (parts.length === 0) return null;
  const labels = new Int16Array(parts.reduce((sum, part) => sum + part.label.length, 0));
  let at = 0;
  for (const { label } of parts) { labels.set(label, at); at += label.length; }
  return labels;
}

export class CompareView implements View {
  readonly element = make("div", "view compare");
  private readonly sides: State[];
  private readonly views: ComparedView[];
  private readonly names = [make("h2", "compare_name"), make("h2", "compare_name")];
  private readonly summary = make("p", "compare_summary");
  private readonly table = make("table", "compare_table");
  private readonly search: HTMLButtonElement;
  private readonly body = make("div", "compare_body");
  private readonly hint = make("p", "compare_hint", texts.compare.hint);
  private readonly flips: HTMLButtonElement[];
  private isVisible = false;
  private isSearching = false;
  /** What was found to begin at the scan that is shown: its rows are marked. */
  private found: { utime_us: number; names: ReadonlySet<string> } = { utime_us: NaN, names: new Set() };
  private shown: { first: Picture | null; second: Picture | null } = { first: null, second: null };

  constructor(private readonly state: State, private readonly film: Film) {
    this.sides = [0, 1].map(() => new State(null, state.settings));
    this.views = this.sides.map((side) => new ComparedView(side));
    const [left, right] = this.views as [ComparedView, ComparedView];
    left.beside = right;
    right.beside = left;
    right.leader = left;
    this.search = button(texts.compare.next, () => { if (this.isSearching) this.isSearching = false; else void this.searchOn(); }, "compare_next");
    this.summary.setAttribute("role", "status");
    const limits = make("div", "compare_limits");
    limits.append(this.limit("differs_share", texts.compare.limits.share, texts.compare.percentOfReturns), this.limit("differs_moved_m", texts.compare.limits.moved, (metres) => length(state.settings, metres)));
    // On a phone one side is seen at a time.
    const flip = make("div", "compare_flip");
    this.flips = [0, 1].map((index) => button("", () => { show(index); }));
    const show = (index: number) => {
      this.body.dataset["side"] = String(index);
      for (const [each, one] of this.flips.entries()) setAttribute(one, "aria-pressed", String(each === index));
    };
    flip.append(...this.flips);
    show(0);
    this.table.setAttribute("aria-label", texts.compare.table);
    const panes = this.views.map((view, index) => {
      const pane = make("section", "compare_side");
      pane.append(this.names[index]!, view.element);
      return pane;
    });
    const drawn = make("div", "compare_sides"), told = make("div", "compare_told"), head = make("div", "compare_head");
    drawn.append(...panes);
    head.append(this.summary, this.search, limits);
    told.append(head, this.table);
    this.body.append(flip, drawn, told);
    this.element.append(this.hint, this.body);
    for (const [index, side] of this.sides.entries()) {
      // What is pointed at here is pointed at in the whole page; ids of the second recording are its own.
      if (index === 0) side.on(["marked"], () => { state.mark(side.marked); });
    }
    state.on(["marked"], () => { this.sides[0]!.mark(state.marked); });
    state.on(["settings"], () => {
      for (const side of this.sides) side.tell("settings");
      this.shown = { first: null, second: null };
      this.update();
    });
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

  // From where on a difference is worth a stop.
  private limit(name: "differs_share" | "differs_moved_m", label: string, textOf: (value: number) => string): HTMLElement {
    const { settings } = this.state, choice = make("select"), labelled = make("label", "muted", `${label} `);
    for (const value of settings.choices(name)) choice.add(new Option(value === 0 ? texts.compare.never : textOf(value), String(value)));
    const draw = () => { choice.value = String(settings.get(name)); };
    choice.onchange = () => { settings.set(name, Number(choice.value)); };
    this.state.on(["settings"], draw);
    draw();
    labelled.append(choice);
    return labelled;
  }
  private get limits(): Limits { return { share: this.state.settings.get("differs_share"), moved_m: this.state.settings.get("differs_moved_m") }; }

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
    for (const [index, id] of [lineOf(this.state.sources)[0]?.id, other].entries()) {
      setText(this.names[index]!, name(id));
      setText(this.flips[index]!, name(id));
    }
    this.film.setBeside(this.isVisible && other !== undefined ? other : null);
  }

  private update(): void {
    const first = this.state.picture, second = this.state.beside;
    if (!this.isVisible || this.body.hidden || (first === this.shown.first && second === this.shown.second)) return;
    this.shown = { first, second };
    const differences = first === null || second === null ? null : compare(first, second, this.limits.moved_m);
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
    const rows: { name: string; cells: [string, string, string] }[] = [];
    if (differences === null) setText(this.summary, words.nothing);
    else if (!differences.isSameScan) setText(this.summary, words.noScan);
    else {
      const { otherReturns, numReturns, segmentsOnlyInFirst, segmentsOnlyInSecond } = differences;
      const share = numReturns === 0 ? 0 : 100 * otherReturns.length / numReturns;
      setText(this.summary, isSame(differences) ? words.same(numReturns) : words.returns(otherReturns.length, numReturns, share.toFixed(share < 10 ? 1 : 0)));
      for (const alert of differences.alertsOnlyInFirst) rows.push({ name: nameOfAlert(alert, "first"), cells: [words.alert, alert.text, "–"] });
      for (const alert of differences.alertsOnlyInSecond) rows.push({ name: nameOfAlert(alert, "second"), cells: [words.alert, "–", alert.text] });
      for (const difference of differences.tracks) {
        const { first, second, what } = difference;
        rows.push({ name: nameOfTrack(difference), cells: [words.track[what], this.track(first), this.track(second)] });
      }
      if (segmentsOnlyInFirst.length + segmentsOnlyInSecond.length > 0) rows.push({ name: "", cells: [words.segments, String(segmentsOnlyInFirst.length), String(segmentsOnlyInSecond.length)] });
    }
    const isFound = this.found.utime_us === this.state.picture?.utime_us;
    this.summary.classList.toggle("begins", isFound && (this.found.names.has("returns") || this.found.names.has("scan")));
    const row = (cells: readonly string[], tag: "td" | "th", begins = false) => {
      const line = make("tr", begins ? "begins" : "");
      line.append(...cells.map((text) => make(tag, "", text)));
      if (begins) line.title = words.begins;
      return line;
    };
    this.table.replaceChildren(row(["", words.first, words.second], "th"), ...rows.map(({ name, cells }) => row(cells, "td", isFound && this.found.names.has(name))));
    this.table.hidden = rows.length === 0;
  }
  private track(track: Track | null): string {
    if (track === null) return "–";
    const { settings } = this.state;
    return [texts.drawing.name(track.kind, track.id), bearing(track.bearing_rad), length(settings, track.range_m), speed(settings, track.speed_mps),
      track.tcpa_s > 0 ? texts.compare.approach(length(settings, track.cpa_m)) : ""].filter((part) => part !== "").join(", ");
  }

  // The next scan at which a difference that matters begins: one that lasts is met once.
  private async searchOn(): Promise<void> {
    const { link, showing } = this.state, other = this.other, { limits } = this;
    if (link === null || showing.kind !== "recorded" || other === undefined) return;
    this.film.pause();
    this.isSearching = true;
    const begin_utime_us = beginOf(this.state), beginnings = new Beginnings();
    let at_us = showing.utime_us, numSearched = 0;
    const differencesOf = async (answer: Answer) => {
      const beside = await link.at(other, { scan_utime_us: answer.head.scan_utime_us }, kSearched);
      return compareLabels(pictureOf(answer.frames), pictureOf(beside.frames), labelsOf(answer.frames), labelsOf(beside.frames), limits.moved_m);
    };
    try {
      // What the scan that is shown says already is nothing new.
      beginnings.take(mattering(await differencesOf(await link.at(showing.source, { utime_us: at_us }, kSearched)), limits));
      while (this.isSearching) {
        const answer = await link.step(showing.source, at_us, 1, kSearched);
        if (answer.head.utime_us <= at_us) { this.end(texts.compare.noMore); break; }
        at_us = answer.head.utime_us;
        const names = beginnings.take(mattering(await differencesOf(answer), limits));
        if (names.length > 0) {
          this.found = { utime_us: answer.head.scan_utime_us, names: new Set(names) };
          this.film.seek(at_us);
          break;
        }
        if (++numSearched % kToldEvery === 0) setText(this.search, texts.compare.searching(sinceBegin(at_us, begin_utime_us)));
      }
    } catch (error) {
      if (!(error instanceof RequestRefused)) throw error;
    }
    this.isSearching = false;
    setText(this.search, texts.compare.next);
  }
  private end(text: string): void { setText(this.summary, text); }
}

function pictureOf(frames: readonly Frame[]): Picture {
  const assembler = new Assembler();
  for (const frame of frames) assembler.take(frame);
  return assembler.picture();
}
function isAlike({ segmentsOnlyInFirst, segmentsOnlyInSecond, tracks, alertsOnlyInFirst, alertsOnlyInSecond }: Differences): boolean {
  return segmentsOnlyInFirst.length + segmentsOnlyInSecond.length + tracks.length + alertsOnlyInFirst.length + alertsOnlyInSecond.length === 0;
}
function isSame(differences: Differences): boolean { return isAlike(differences) && differences.otherReturns.length === 0; }
