// The time line: what happened when, where the shown moment lies, and the player's buttons.
import { beginOf, type Film, kRates, lineOf, sourceAt } from "../film.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { date, timeText } from "../units.js";
import { type JumpKind, kJumpKinds, moved, nextEvent, type Span, Strips, wholeSpan, zoomed } from "./strip.js";
import { type Sign, sign } from "./signs.js";
import { describe, drawStrip } from "./timeline_canvas.js";
import { parseTime } from "./time_text.js";
import { faultOfPage } from "./traffic.js";

const kFollows_share = 0.9;  // a playing moment beyond this share of the span moves the span
const kTap_px = 4;

function button(name: string, label: string, shown: Sign | null, onClick: () => void): HTMLButtonElement {
  const element = document.createElement("button");
  element.type = "button";
  element.className = `film_button ${name}`;
  element.setAttribute("aria-label", label);
  element.title = label;
  if (shown !== null) element.append(sign(shown));
  element.onclick = onClick;
  return element;
}
function box(name: string, ...children: HTMLElement[]): HTMLDivElement {
  const element = document.createElement("div");
  element.className = name;
  element.append(...children);
  return element;
}
function choice<Value extends string>(name: string, label: string, values: readonly Value[], textOf: (value: Value) => string): HTMLSelectElement {
  const element = document.createElement("select");
  element.className = name;
  element.setAttribute("aria-label", label);
  element.title = label;
  for (const value of values) element.add(new Option(textOf(value), value));
  return element;
}

export class Timeline {
  readonly element = document.createElement("footer");
  private readonly canvas = document.createElement("canvas");
  private readonly slider = box("film_strip", this.canvas);
  private readonly tip = box("film_tip");
  private readonly clock = document.createElement("output");
  private readonly note = box("film_note");
  private readonly liveAlerts = button("film_alerts", texts.film.backToLive, null, () => { this.film.goLive(); });
  private readonly playButton: HTMLButtonElement;
  private readonly liveButton: HTMLButtonElement;
  private readonly recordedControls: HTMLElement[];
  private readonly rate = choice("film_rate", texts.film.rate, kRates.map(String), (value) => texts.film.times(value));
  private readonly kind = choice<JumpKind>("film_kind", texts.film.kind, kJumpKinds, (value) => texts.film.kinds[value]);
  private readonly time = document.createElement("input");
  private readonly strips: Strips;
  private span: Span | null = null;   // null: the whole
  private isDirty = true;
  private pointed_px: number | null = null;
  private readonly pointers = new Map<number, { x: number; began: number }>();
  private hasPinched = false;
  private sourcesKey = "";
  private fault = "";   // of the last minutes, as the page's own HEALTH has it

  constructor(private readonly state: State, private readonly film: Film) {
    this.strips = new Strips(state, () => { this.isDirty = true; });
    this.element.className = "film timeline";
    this.element.setAttribute("aria-label", texts.film.name);
    this.playButton = button("play", texts.film.play, "play", () => { this.togglePlay(); });
    this.liveButton = button("live", texts.film.backToLive, null, () => { this.film.goLive(); });
    this.liveButton.textContent = texts.live;
    this.rate.value = String(film.rate);
    this.rate.onchange = () => { film.setRate(Number(this.rate.value)); };
    this.time.type = "text";
    this.time.className = "film_time";
    this.time.placeholder = texts.film.timeHint;
    this.time.setAttribute("aria-label", texts.film.time);
    this.time.onchange = () => { this.takeTime(); };
    this.clock.className = "film_clock";
    const stepBack = button("back", texts.film.stepBack, "back", () => { film.step(-1); });
    const stepOn = button("on", texts.film.stepOn, "on", () => { film.step(1); });
    const before = button("before", texts.film.before, "before", () => { this.jump(-1); });
    const after = button("after", texts.film.after, "after", () => { this.jump(1); });
    const zoomIn = button("nearer", texts.film.zoomIn, "nearer", () => { this.zoom(0.5); });
    const zoomOut = button("farther", texts.film.zoomOut, "farther", () => { this.zoom(2); });
    const whole = button("whole", texts.film.whole, "whole", () => { this.span = null; this.isDirty = true; });
    this.recordedControls = [this.playButton, stepBack, stepOn, this.rate];
    this.note.setAttribute("role", "status");
    this.element.append(
      box("film_line", this.note, this.liveAlerts),
      box("film_controls", this.liveButton, before, stepBack, this.playButton, stepOn, after, this.rate, this.kind, this.clock, this.time, box("film_zoom", zoomOut, whole, zoomIn)),
      this.slider, this.tip);
    this.tip.hidden = true;
    this.slider.tabIndex = 0;
    this.slider.setAttribute("role", "slider");
    this.slider.setAttribute("aria-label", texts.film.slider);
    this.listen();
    state.on(["showing", "sources", "connection", "settings"], () => { this.update(); });
    state.on(["picture"], () => { this.takeFault(); });
    new ResizeObserver(() => { this.isDirty = true; }).observe(this.slider);
    const draw = () => {
      this.draw();
      requestAnimationFrame(draw);
    };
    requestAnimationFrame(draw);
    setInterval(() => { this.refresh(); }, 500);
    this.update();
  }

  private get whole(): Span | null { return wholeSpan(lineOf(this.state.sources)); }
  private get shownSpan(): Span | null { return this.span ?? this.whole; }
  /** Time of the moment that is shown; live: the end of what is recorded. */
  private get shown_utime_us(): number {
    const { showing } = this.state;
    return showing.kind === "recorded" ? showing.utime_us : this.whole?.to_utime_us ?? NaN;
  }

  private text(utime_us: number): string { return timeText(utime_us, beginOf(this.state)); }

  private togglePlay(): void {
    if (this.film.isPlaying) this.film.pause(); else this.film.play();
  }
  private jump(direction: 1 | -1): void {
    const event = nextEvent(this.strips.events, this.kind.value as JumpKind, this.shown_utime_us, direction);
    if (event === undefined) { this.say(texts.film.noSuchEvent(texts.film.kinds[this.kind.value as JumpKind])); return; }
    this.film.seek(event.utime_us);
    this.say(`${this.text(event.utime_us)}: ${event.text}`);
    if (this.span !== null && this.whole !== null) {
      const half = (this.span.to_utime_us - this.span.from_utime_us) / 2;
      if (event.utime_us < this.span.from_utime_us || event.utime_us > this.span.to_utime_us) this.span = moved(this.span, this.whole, event.utime_us - this.span.from_utime_us - half);
    }
  }
  private takeTime(): void {
    const whole = this.whole;
    if (whole === null || this.time.value.trim() === "") return;
    const utime_us = parseTime(this.time.value, whole.from_utime_us, whole.to_utime_us);
    if (utime_us === null) { this.say(texts.film.badTime(this.text(whole.from_utime_us), this.text(whole.to_utime_us))); return; }
    this.time.value = "";
    this.say("");
    this.film.seek(utime_us);
  }
  // Why the last minutes are not kept (no room on the disk), or what else the page's own process lacks.
  private takeFault(): void {
    const reason = this.state.hello?.mode === "live" ? faultOfPage(this.state.picture?.health ?? []) : "", fault = reason === "" ? "" : texts.film.fault(reason);
    if (fault === this.fault) return;
    this.fault = fault;
    this.update();
  }
  private zoom(factor: number): void {
    const { whole, shownSpan } = this;
    if (whole === null || shownSpan === null) return;
    const about = Math.min(Math.max(this.shown_utime_us, shownSpan.from_utime_us), shownSpan.to_utime_us);
    this.setSpan(zoomed(shownSpan, whole, about, factor));
  }
  private setSpan(span: Span): void {
    const whole = this.whole;
    // The whole goes on with a recording that grows; a part stays where it is.
    this.span = whole !== null && span.to_utime_us - span.from_utime_us >= whole.to_utime_us - whole.from_utime_us ? null : span;
    this.isDirty = true;
    this.refresh();
  }
  private said = "";
  private say(text: string): void {
    this.said = text;
    this.update();
  }

  private timeAt(x: number): number {
    const span = this.shownSpan;
    if (span === null) return NaN;
    const share = Math.min(1, Math.max(0, x / Math.max(1, this.slider.clientWidth)));
    return span.from_utime_us + share * (span.to_utime_us - span.from_utime_us);
  }
  private place(event: PointerEvent | WheelEvent): number { return event.clientX - this.slider.getBoundingClientRect().left; }

  private listen(): void {
    const { slider } = this;
    slider.onpointerdown = (event) => {
      slider.setPointerCapture(event.pointerId);
      const x = this.place(event);
      this.pointers.set(event.pointerId, { x, began: x });
      if (this.pointers.size > 1) this.hasPinched = true;
      else { this.hasPinched = false; if (event.pointerType === "mouse") this.scrub(x); }
    };
    slider.onpointermove = (event) => {
      const x = this.place(event), held = this.pointers.get(event.pointerId);
      this.pointed_px = x;
      this.isDirty = true;
      if (held === undefined) return;
      if (this.pointers.size === 2) this.pinch(event.pointerId, x);
      else if (!this.hasPinched && Math.abs(x - held.began) >= (event.pointerType === "mouse" ? 1 : kTap_px)) this.scrub(x);
      held.x = x;
    };
    const release = (event: PointerEvent) => {
      const held = this.pointers.get(event.pointerId);
      this.pointers.delete(event.pointerId);
      if (event.type === "pointerup" && held !== undefined && !this.hasPinched && event.pointerType !== "mouse") this.scrub(this.place(event));
      if (event.pointerType !== "mouse") { this.pointed_px = null; this.isDirty = true; }
    };
    slider.onpointerup = release;
    slider.onpointercancel = release;
    slider.onpointerleave = () => { this.pointed_px = null; this.isDirty = true; };
    slider.addEventListener("wheel", (event) => {
      const { whole, shownSpan } = this;
      if (whole === null || shownSpan === null) return;
      event.preventDefault();
      const length = shownSpan.to_utime_us - shownSpan.from_utime_us;
      if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
        this.setSpan(moved(shownSpan, whole, (event.deltaX || event.deltaY) / slider.clientWidth * length));
      } else this.setSpan(zoomed(shownSpan, whole, this.timeAt(this.place(event)), 1.0015 ** event.deltaY));
    }, { passive: false });
    slider.onkeydown = (event) => { if (this.takeSliderKey(event.key)) { event.preventDefault(); event.stopPropagation(); } };
    document.addEventListener("keydown", (event) => {
      const { target } = event;
      if (event.ctrlKey || event.metaKey || event.altKey || (target instanceof HTMLElement && target.matches("input, select, textarea"))) return;
      if (event.key === " " && target instanceof HTMLElement && target.matches("button, a, summary")) return;
      if (this.takePageKey(event.key)) event.preventDefault();
    });
  }
  private scrub(x: number): void {
    const utime_us = this.timeAt(x);
    this.said = "";
    if (Number.isFinite(utime_us)) this.film.seek(utime_us);
  }
  private pinch(id: number, x: number): void {
    const { whole, shownSpan } = this;
    const held = this.pointers.get(id), other = [...this.pointers].find(([candidate]) => candidate !== id)?.[1];
    if (whole === null || shownSpan === null || held === undefined || other === undefined) return;
    const before = Math.max(8, Math.abs(held.x - other.x)), after = Math.max(8, Math.abs(x - other.x));
    const next = zoomed(shownSpan, whole, this.timeAt((held.x + other.x) / 2), before / after);
    this.setSpan(moved(next, whole, -(x - held.x) / 2 / this.slider.clientWidth * (next.to_utime_us - next.from_utime_us)));
  }
  private takeSliderKey(key: string): boolean {
    const whole = this.whole;
    if (whole === null) return false;
    switch (key) {
      case "ArrowLeft": case "ArrowDown": this.film.step(-1); return true;
      case "ArrowRight": case "ArrowUp": this.film.step(1); return true;
      case "PageDown": this.film.seek(Math.max(whole.from_utime_us, this.shown_utime_us - 10e6)); return true;
      case "PageUp": this.film.seek(Math.min(whole.to_utime_us, this.shown_utime_us + 10e6)); return true;
      case "Home": this.film.seek(whole.from_utime_us); return true;
      case "End": this.film.seek(whole.to_utime_us); return true;
      case "+": this.zoom(0.5); return true;
      case "-": this.zoom(2); return true;
      case "0": this.span = null; this.isDirty = true; return true;
      default: return false;
    }
  }
  private takePageKey(key: string): boolean {
    if (this.state.sources.length === 0) return false;
    switch (key) {
      case " ": this.togglePlay(); return true;
      case ",": this.film.step(-1); return true;
      case ".": this.film.step(1); return true;
      case "[": this.jump(-1); return true;
      case "]": this.jump(1); return true;
      case "l": case "L": this.film.goLive(); return true;
      default: return false;
    }
  }

  private update(): void {
    const { state, film } = this;
    const key = state.sources.map((source) => `${source.id} ${source.name}`).join("|");
    if (key !== this.sourcesKey) {
      this.sourcesKey = key;
      this.span = null;
      this.strips.clear();
    }
    const isRecorded = state.showing.kind === "recorded", isLive = state.hello?.mode === "live";
    this.element.hidden = state.sources.length === 0 && this.fault === "";
    this.element.dataset["showing"] = state.showing.kind;
    this.liveButton.hidden = !isLive;
    this.liveButton.setAttribute("aria-pressed", String(!isRecorded));
    for (const control of this.recordedControls) (control as HTMLButtonElement).disabled = !isRecorded && control !== this.recordedControls[1];
    this.playButton.replaceChildren(sign(film.isPlaying ? "pause" : "play"));
    this.playButton.setAttribute("aria-label", film.isPlaying ? texts.film.pause : texts.film.play);
    this.rate.value = String(film.rate);
    const worst = Math.max(0, ...film.liveAlerts.map((alert) => alert.level));
    this.liveAlerts.hidden = !isRecorded || !isLive || film.liveAlerts.length === 0;
    this.liveAlerts.dataset["level"] = String(worst);
    this.liveAlerts.textContent = texts.film.liveAlerts(film.liveAlerts.length, film.liveAlerts[0]?.text ?? "");
    const shares = [...state.indexing.values()];
    const note = shares.length > 0 ? texts.indexing(Math.floor(100 * Math.min(...shares))) : film.refusal !== "" ? texts.film.refused(film.refusal) : this.said !== "" ? this.said : this.fault;
    this.note.textContent = isRecorded && isLive ? `${texts.film.notNow(this.text(this.shown_utime_us))} ${note}` : note;
    this.note.classList.toggle("fault", note !== "" && note === this.fault);
    this.note.parentElement!.hidden = this.note.textContent === "" && this.liveAlerts.hidden;
    const { showing } = state;
    if (showing.kind === "recorded") {
      this.clock.textContent = `${date(showing.utime_us)} ${this.text(showing.utime_us)}`;
      this.clock.title = texts.film.scan(showing.scan_index + 1, showing.num_scans);
      this.follow(showing.utime_us);
    } else this.clock.textContent = "";
    this.isDirty = true;
  }
  // A moment that leaves the span on the way of playing takes the span along.
  private follow(utime_us: number): void {
    const { span, whole } = this;
    if (span === null || whole === null || this.pointers.size > 0 || !this.film.isPlaying) return;
    const length = span.to_utime_us - span.from_utime_us, share = (utime_us - span.from_utime_us) / length;
    if (share > kFollows_share || share < 0) this.span = moved(span, whole, utime_us - span.from_utime_us - 0.1 * length);
  }

  private refresh(): void {
    const span = this.shownSpan;
    if (span !== null && !this.element.hidden && !document.hidden) this.strips.update(span, this.slider.clientWidth, performance.now());
  }
  private draw(): void {
    const span = this.shownSpan, whole = this.whole;
    if (!this.isDirty || this.element.hidden || span === null || whole === null) return;
    this.isDirty = false;
    const shown_utime_us = this.shown_utime_us, strips = this.strips.of(span);
    const sources = lineOf(this.state.sources);
    drawStrip(this.canvas, { span, strips, sources, shown_utime_us, begin_utime_us: beginOf(this.state), isLive: this.state.showing.kind === "live", pointed_px: this.pointed_px });
    const { slider } = this;
    slider.setAttribute("aria-valuemin", "0");
    slider.setAttribute("aria-valuemax", String(Math.round((whole.to_utime_us - whole.from_utime_us) / 1e6)));
    slider.setAttribute("aria-valuenow", String(Math.round((shown_utime_us - whole.from_utime_us) / 1e6)));
    slider.setAttribute("aria-valuetext", `${this.text(shown_utime_us)}, ${describe(strips, shown_utime_us).join(", ")}`);
    this.tip.hidden = this.pointed_px === null;
    if (this.pointed_px === null) return;
    const utime_us = this.timeAt(this.pointed_px);
    const near_us = 6 / Math.max(1, slider.clientWidth) * (span.to_utime_us - span.from_utime_us);
    const event = this.strips.events.filter((candidate) => Math.abs(candidate.utime_us - utime_us) < near_us).sort((a, b) => b.level - a.level)[0];
    const source = sources.length > 1 ? sourceAt(sources, utime_us)?.name : undefined;
    this.tip.textContent = [this.text(utime_us), event?.text, ...describe(strips, utime_us), source].filter((text) => text !== undefined && text !== "").join(" · ");
    const left = Math.min(Math.max(0, this.pointed_px - this.tip.offsetWidth / 2), Math.max(0, slider.clientWidth - this.tip.offsetWidth));
    this.tip.style.transform = `translateX(${left}px)`;
  }
}
