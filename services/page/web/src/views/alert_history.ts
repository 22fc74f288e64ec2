// The alerts that there were, the newest first: since the page was opened, or of a whole log.
import { beginOf } from "../film.js";
import * as wire from "../messages/generated.js";
import type { State, View } from "../state.js";
import { texts } from "../texts/index.js";
import { timeText } from "../units.js";
import { button, make, placeChildren, setAttribute, setText } from "./dom.js";
import { gravityOf } from "./gravity.js";
import { Shape } from "./shapes.js";
import { levelWord } from "./alerts.js";

const words = texts.panels.alerts;
const kKept = 200;

/** What was told of an alert last, with the gravest that it was. */
export interface Entry { utime_us: number; level: number; state: number; text: string }

/** Keeps the last alerts, each once, however often it is told. */
export class History {
  private readonly entries = new Map<string, Entry>();

  /** @returns whether anything has changed that can be seen */
  take(alerts: readonly wire.Alert[]): boolean {
    let hasChanged = false;
    for (const alert of alerts) {
      const key = `${alert.id} ${alert.raised_utime_us}`;
      const before = this.entries.get(key);
      if (before?.state === alert.state && before.level >= alert.level) continue;
      hasChanged = true;
      this.entries.set(key, { utime_us: alert.raised_utime_us, level: Math.max(alert.level, before?.level ?? 0), state: alert.state, text: alert.text });
      if (this.entries.size > kKept) this.entries.delete(this.entries.keys().next().value!);
    }
    return hasChanged;
  }
  list(): Entry[] { return [...this.entries.values()].sort((a, b) => b.utime_us - a.utime_us); }
}

export class AlertHistory implements View {
  readonly element = make("div", "page");
  private readonly listElement = make("ul", "history");
  private readonly empty = make("p", "empty");
  private readonly history = new History();
  private ofLog: Entry[] | null = null;
  private asked = "";
  private isVisible = false;

  constructor(private readonly state: State) {
    this.element.append(this.empty, this.listElement);
    this.listElement.setAttribute("aria-label", words.history);
    state.on(["picture"], () => { if (!this.isLog && this.history.take(state.picture?.alerts ?? [])) this.draw(); });
    state.on(["sources", "showing", "connection"], () => { this.draw(); });
  }

  setVisible(isVisible: boolean): void {
    this.isVisible = isVisible;
    this.draw();
  }

  private get isLog(): boolean { return this.state.hello?.mode === "log" || this.state.showing.kind === "recorded"; }

  private draw(): void {
    if (!this.isVisible) return;
    const { state, isLog } = this;
    if (isLog) void this.ask();
    const begin_utime_us = beginOf(state);
    const entries = isLog ? this.ofLog ?? [] : this.history.list();
    this.empty.hidden = entries.length > 0;
    setText(this.empty, isLog ? words.noneRecorded : words.none);
    placeChildren(this.listElement, entries.map((entry) => {
      const item = make("li");
      const alert = { level: entry.level, state: entry.state };
      const gravity = gravityOf(alert);
      setAttribute(item, "data-gravity", gravity);
      const text = make("span", "text", isLog ? entry.text : `${levelWord(alert)}: ${entry.text}`);
      const time = make("time", "", timeText(entry.utime_us, begin_utime_us));
      item.append(new Shape(gravity).element, time, text);
      if (isLog) {
        const jump = button("", () => { state.seek(entry.utime_us); }, "plain");
        jump.append(time);
        item.replaceChildren(new Shape(gravity).element, jump, text);
      }
      return item;
    }));
  }

  // The events of the log's strip: asked once for a recording, and again as it grows.
  private async ask(): Promise<void> {
    const { state } = this;
    const number = state.showing.kind === "recorded" ? state.showing.source : 0;
    const source = state.sources.find((candidate) => candidate.id === number);
    if (source === undefined || state.link === null || state.indexing.has(number)) return;
    const asked = `${number} ${source.begin_utime_us} ${Math.floor(source.end_utime_us / 10e6)}`;
    if (asked === this.asked) return;
    this.asked = asked;
    try {
      const { events } = await state.link.strip(number, source.begin_utime_us, source.end_utime_us + 1, 1);
      this.ofLog = events.filter((event) => event.kind === "alert")
        .map(({ utime_us, level, text }) => ({ utime_us, level, state: wire.Alert.STATE_ACTIVE, text })).sort((a, b) => b.utime_us - a.utime_us);
      this.draw();
    } catch {
      this.asked = "";  // refused, or the connection is gone: with the next change of sources it asks again
    }
  }
}
