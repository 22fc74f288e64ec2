// The alerts above every view: one panel a thing that is dangerous now, the gravest first; what is over is folded below. A screen reader hears each once.
import * as wire from "../messages/generated.js";
import type { Picture } from "../picture.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { acknowledge, order } from "./acknowledge.js";
import { lineOf, shortName, sightOf } from "./alert_words.js";
import { button, make, placeChildren, setAttribute, setText } from "./dom.js";
import { Announcer, byGravity, gravityOf, opensOut, overOf, patternOf } from "./gravity.js";
import { Shape } from "./shapes.js";
import type { Sounder } from "./sound.js";

const words = texts.panels.alerts;
// How many are shown before somebody asks for more: they must leave room for the picture.
const kShownWide = 3, kShownTablet = 2, kShownPhone = 1;
const kStill_ms = 400;        // a button that has just come to its place takes no touch: it was meant for the one before
const kTextEvery_ms = 500;    // numbers in a text change with each scan: nobody reads ten a second
const kPatience_ms = 4000;    // until the look-out says that it took an acknowledgement

export function levelWord(alert: Pick<wire.Alert, "level" | "state">): string {
  switch (gravityOf(alert)) {
    case "warning": return words.warning;
    case "caution": return words.caution;
    default: return alert.state === wire.Alert.STATE_ACKNOWLEDGED ? words.acknowledged : words.over;
  }
}

class Row {
  readonly element = make("li", "alert");
  readonly acknowledge: HTMLButtonElement;
  private readonly shape = new Shape();
  private readonly level = make("span", "level");
  private readonly sight = make("span", "sight");
  private readonly name = make("span", "name");
  private readonly text = make("span", "text");
  private readonly sent = make("span", "sent");
  private text_ms = -Infinity;
  private sent_ms: number | null = null;
  private isSending = false;
  private place = -1;
  private placed_ms = -Infinity;

  constructor(private readonly state: State, private alert: wire.Alert) {
    const show = button("", () => { if (this.alert.track_id !== 0) state.choose(this.alert.track_id); }, "words");
    const head = make("span", "what"), kind = make("span", "kind");
    kind.append(this.level, this.sight);
    head.append(this.name, kind);
    show.append(head, this.text);
    show.onpointerenter = () => { if (this.alert.track_id !== 0) state.mark({ track: this.alert.track_id }); };
    show.onpointerleave = () => { state.mark({}); };
    this.acknowledge = button(words.acknowledge, () => { void this.send(); }, "acknowledge");
    this.element.append(this.shape.element, show, this.acknowledge, this.sent);
  }

  get isWanting(): boolean { return gravityOf(this.alert) !== "quiet" || this.alert.state === wire.Alert.STATE_RECTIFIED; }

  update(alert: wire.Alert, picture: Picture, isLive: boolean, now_ms: number): void {
    const hasChanged = alert.state !== this.alert.state || alert.level !== this.alert.level || alert.sight !== this.alert.sight;
    this.alert = alert;
    const gravity = gravityOf(alert);
    this.shape.set(gravity);
    setAttribute(this.element, "data-gravity", gravity === "warning" && opensOut(alert) ? "caution" : gravity);
    setAttribute(this.element, "data-sight", alert.sight === wire.Alert.SIGHT_LOST ? "lost" : null);
    setText(this.level, levelWord(alert));
    setText(this.name, shortName(alert));
    setText(this.sight, sightOf(alert));
    if (hasChanged || now_ms - this.text_ms >= kTextEvery_ms) {
      this.text_ms = now_ms;
      setText(this.text, lineOf(alert, picture, this.state.settings));
      setAttribute(this.acknowledge, "aria-label", words.acknowledgeOf(alert.text));
    }
    this.acknowledge.hidden = !isLive || !this.isWanting;
    if (!this.isWanting) {
      this.sent_ms = null;
      setText(this.sent, "");
    } else if (this.sent_ms !== null && now_ms - this.sent_ms > kPatience_ms) {
      this.sent_ms = null;
      setText(this.sent, words.unanswered);
    }
  }

  /** @param place in the list, from 0 */
  setPlace(place: number, now_ms: number): void {
    if (this.place >= 0 && place !== this.place) this.placed_ms = now_ms;
    this.place = place;
  }

  async send(): Promise<void> {
    if (this.isSending || performance.now() - this.placed_ms < kStill_ms) return;
    this.isSending = true;
    this.acknowledge.disabled = true;
    const refused = await acknowledge(this.state, this.alert);
    this.isSending = false;
    this.acknowledge.disabled = false;
    this.sent_ms = refused === null ? performance.now() : null;
    setText(this.sent, refused ?? words.sent);
  }
}

export class AlertBar {
  readonly element = make("section", "alerts");
  private readonly summary = make("p", "summary");
  private readonly list = make("ul");
  private readonly overList = make("ul", "over");
  private readonly rows = new Map<number, Row>();
  private readonly more: HTMLButtonElement;
  private readonly overButton: HTMLButtonElement;
  private readonly all: HTMLButtonElement;
  private readonly silence: HTMLButtonElement;
  private readonly said = make("span", "sent");
  private readonly now = make("div", "for-readers");    // assertive
  private readonly later = make("div", "for-readers");  // polite
  private readonly announcer = new Announcer();
  private readonly wide = matchMedia("(min-width: 900px)");
  private readonly phone = matchMedia("(max-width: 599px), (max-height: 599px)");
  private showsAll = false;
  private showsOver = false;
  private order: number[] = [];
  private seen: readonly wire.Alert[] | null = null;

  /** @param behind where alerts of now stand while a recording is shown */
  constructor(private readonly state: State, private readonly sounder: Sounder,
              private readonly behind: { readonly liveAlerts: readonly wire.Alert[]; readonly liveReport: wire.Alerts | null }) {
    this.element.setAttribute("aria-label", words.name);
    this.now.setAttribute("role", "alert");
    this.later.setAttribute("role", "status");
    this.said.setAttribute("role", "status");
    this.more = button("", () => { this.showsAll = !this.showsAll; this.update(); }, "more");
    this.overButton = button("", () => { this.showsOver = !this.showsOver; this.update(); }, "more folded");
    this.all = button(words.acknowledgeAll, () => { this.acknowledgeListed(); }, "all");
    this.silence = button(words.silence, () => { void this.beSilent(); }, "silence");
    const main = make("div", "now-and-over"), tools = make("div", "alert-tools");
    main.append(this.summary, this.list, this.overList);
    tools.append(this.more, this.overButton, this.all, this.silence, this.said);
    this.element.append(main, tools, this.now, this.later);
    state.on(["picture", "showing", "connection", "age", "settings"], () => { this.update(); });
    this.update();
  }

  /** Puts the keyboard on the first alert that is not acknowledged: to acknowledge takes a second key. */
  focus(): void {
    [...this.rows.values()].map((row) => row.acknowledge).find((acknowledge) => acknowledge.isConnected && !acknowledge.hidden)?.focus();
  }

  // Those that are seen: of one that is hidden nobody has taken note.
  private get listed(): Row[] { return [...this.rows.values()].filter((row) => row.element.isConnected && row.isWanting); }

  private acknowledgeListed(): void {
    for (const row of this.listed) void row.send();
  }

  private async beSilent(): Promise<void> {
    this.silence.disabled = true;
    const refused = await order(this.state, { kind: "silence" });
    this.silence.disabled = false;
    setText(this.said, refused ?? "");
    if (refused !== null) setTimeout(() => { setText(this.said, ""); }, kPatience_ms);
  }

  private rowOf(alert: wire.Alert, isLive: boolean, now_ms: number): Row {
    let row = this.rows.get(alert.id);
    if (row === undefined) {
      row = new Row(this.state, alert);
      this.rows.set(alert.id, row);
    }
    row.update(alert, this.state.picture!, isLive, now_ms);
    return row;
  }

  private update(): void {
    const { state } = this;
    const isLive = state.showing.kind === "live" && state.hello?.mode !== "log";
    const told = state.picture?.alerts ?? [], report = state.picture?.alert_report ?? null;
    const alerts = byGravity(told, this.order), over = overOf(told);
    this.order = alerts.map(({ id }) => id);
    const now_ms = performance.now();
    for (const id of this.rows.keys()) if (!alerts.some((alert) => alert.id === id) && !over.some((alert) => alert.id === id)) this.rows.delete(id);
    const numShown = this.phone.matches ? kShownPhone : this.wide.matches ? kShownWide : kShownTablet;
    const places: HTMLElement[] = [];
    alerts.forEach((alert, index) => {
      const row = this.rowOf(alert, isLive, now_ms);
      row.setPlace(index, now_ms);
      if (this.showsAll || index < numShown) places.push(row.element);
    });
    const overRows = over.map((alert) => this.rowOf(alert, isLive, now_ms).element);
    // Where a button has the keyboard nothing is moved, or the keyboard would be lost.
    if (!this.list.contains(document.activeElement) || places.length !== this.list.children.length) placeChildren(this.list, places);
    placeChildren(this.overList, this.showsOver ? overRows : []);
    setText(this.summary, report?.summary ?? "");
    this.summary.hidden = alerts.length <= 3 || this.summary.textContent === "";
    this.tellMore(alerts.slice(numShown));
    this.overButton.hidden = over.length === 0;
    setText(this.overButton, words.numOver(over.length));
    setAttribute(this.overButton, "aria-expanded", String(this.showsOver));
    const { listed } = this;
    this.all.hidden = !isLive || listed.length < 2;
    setAttribute(this.all, "aria-label", words.acknowledgeListed(listed.length));
    const silent_s = report === null ? 0 : Math.ceil((report.silenced_until_utime_us - report.utime_us) / 1e6);
    this.silence.hidden = !isLive || report === null || (report.sounding_alert_id === 0 && silent_s <= 0);
    setText(this.silence, silent_s > 0 ? words.silent(silent_s) : words.silence);
    setAttribute(this.silence, "aria-pressed", String(silent_s > 0));
    this.tellNow(isLive);
  }

  private tellMore(hidden: readonly wire.Alert[]): void {
    this.more.hidden = hidden.length === 0;
    setText(this.more, this.showsAll ? words.fewer : words.more(hidden.length));
    const gravest = hidden.map(gravityOf);
    setAttribute(this.more, "data-gravity", gravest.includes("warning") ? "warning" : gravest.includes("caution") ? "caution" : null);
    setAttribute(this.more, "aria-expanded", String(this.showsAll));
  }

  // Alerts of now sound, and are told to a screen reader, also while somebody looks back. Those of a log never.
  private tellNow(isLive: boolean): void {
    const { state } = this, isLog = state.hello?.mode === "log";
    const report = isLog ? null : isLive ? state.picture?.alert_report ?? null : this.behind.liveReport;
    this.sounder.want(state.connection.state === "open" ? patternOf(report) : null, report?.sounding_alert_id ?? 0);
    const ofNow = isLog ? [] : isLive ? state.picture?.alerts ?? [] : this.behind.liveAlerts;
    if (!isLog && ofNow !== this.seen) {
      this.seen = ofNow;
      this.announce(ofNow);
    }
  }

  private announce(alerts: readonly wire.Alert[]): void {
    const { now, later } = this.announcer.take(alerts);
    if (now.length > 0) setText(this.now, byGravity(now).map((alert) => `${levelWord(alert)}: ${alert.text}.`).join(" "));
    else if (alerts.length === 0) setText(this.now, "");
    if (later.length > 0) setText(this.later, later.map((alert) => words.changed(words.states[alert.state] ?? "", alert.text)).join(" "));
  }
}
