// The alerts above every view: what holds now, the gravest first, with a button to acknowledge. A screen reader hears each once.
import * as wire from "../messages/generated.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { acknowledge } from "./acknowledge.js";
import { button, make, placeChildren, setAttribute, setText } from "./dom.js";
import { Announcer, byGravity, gravityOf, patternOf } from "./gravity.js";
import { Shape } from "./shapes.js";
import type { Sounder } from "./sound.js";

const words = texts.panels.alerts;
// How many are shown before somebody asks for more: they must leave room for the picture.
const kShownWide = 3, kShownTablet = 2, kShownPhone = 1;
const kStill_ms = 400;        // a button that has just come to its place takes no touch: it was meant for the one before
const kTextEvery_ms = 1000;   // numbers in a text change with each scan: nobody reads ten a second
const kPatience_ms = 4000;    // until the look-out says that it took an acknowledgement

export function levelWord(alert: Pick<wire.Alert, "level" | "state">): string {
  switch (gravityOf(alert)) {
    case "warning": return alert.state === wire.Alert.STATE_RECTIFIED ? words.warningOver : words.warning;
    case "caution": return alert.state === wire.Alert.STATE_RECTIFIED ? words.cautionOver : words.caution;
    default: return words.acknowledged;
  }
}

class Row {
  readonly element = make("li", "alert");
  readonly acknowledge: HTMLButtonElement;
  private readonly shape = new Shape();
  private readonly level = make("span", "level");
  private readonly text = make("span", "text");
  private readonly sent = make("span", "sent");
  private text_ms = -Infinity;
  private sent_ms: number | null = null;
  private isSending = false;
  private place = -1;
  private placed_ms = -Infinity;

  constructor(private readonly state: State, private alert: wire.Alert) {
    const show = button("", () => { if (this.alert.track_id !== 0) state.choose(this.alert.track_id); }, "words");
    show.append(this.level, this.text);
    show.onpointerenter = () => { if (this.alert.track_id !== 0) state.mark({ track: this.alert.track_id }); };
    show.onpointerleave = () => { state.mark({}); };
    this.acknowledge = button(words.acknowledge, () => { void this.send(); }, "acknowledge");
    this.element.append(this.shape.element, show, this.acknowledge, this.sent);
  }

  update(alert: wire.Alert, isLive: boolean, now_ms: number): void {
    const hasChanged = alert.state !== this.alert.state || alert.level !== this.alert.level;
    this.alert = alert;
    const gravity = gravityOf(alert);
    this.shape.set(gravity);
    setAttribute(this.element, "data-gravity", gravity);
    setText(this.level, levelWord(alert));
    if (hasChanged || now_ms - this.text_ms >= kTextEvery_ms) {
      this.text_ms = now_ms;
      setText(this.text, alert.text);
      setAttribute(this.acknowledge, "aria-label", words.acknowledgeOf(alert.text));
    }
    this.acknowledge.hidden = !isLive || gravity === "quiet";
    if (gravity === "quiet") {
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

  private async send(): Promise<void> {
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
  private readonly list = make("ul");
  private readonly rows = new Map<number, Row>();
  private readonly more: HTMLButtonElement;
  private readonly now = make("div", "for-readers");    // assertive
  private readonly later = make("div", "for-readers");  // polite
  private readonly announcer = new Announcer();
  private readonly wide = matchMedia("(min-width: 900px)");
  private readonly phone = matchMedia("(max-width: 599px), (max-height: 599px)");
  private showsAll = false;
  private seen: readonly wire.Alert[] | null = null;

  /** @param behind where alerts of now stand while a recording is shown */
  constructor(private readonly state: State, private readonly sounder: Sounder, private readonly behind: { readonly liveAlerts: readonly wire.Alert[] }) {
    this.element.setAttribute("aria-label", words.name);
    this.now.setAttribute("role", "alert");
    this.later.setAttribute("role", "status");
    this.more = button("", () => {
      this.showsAll = !this.showsAll;
      this.update();
    }, "more");
    this.element.append(this.list, this.more, this.now, this.later);
    state.on(["picture", "showing", "connection", "age"], () => { this.update(); });
    this.update();
  }

  /** Puts the keyboard on the first alert that is not acknowledged: to acknowledge takes a second key. */
  focus(): void {
    [...this.rows.values()].map((row) => row.acknowledge).find((acknowledge) => acknowledge.isConnected && !acknowledge.hidden)?.focus();
  }

  private update(): void {
    const { state } = this;
    const isLive = state.showing.kind === "live" && state.hello?.mode !== "log";
    const alerts = byGravity(state.picture?.alerts ?? []);
    const now_ms = performance.now();
    for (const id of this.rows.keys()) if (!alerts.some((alert) => alert.id === id)) this.rows.delete(id);
    const places: HTMLElement[] = [];
    const numShown = this.phone.matches ? kShownPhone : this.wide.matches ? kShownWide : kShownTablet;
    alerts.forEach((alert, index) => {
      let row = this.rows.get(alert.id);
      if (row === undefined) {
        row = new Row(state, alert);
        this.rows.set(alert.id, row);
      }
      row.update(alert, isLive, now_ms);
      row.setPlace(index, now_ms);
      if (this.showsAll || index < numShown) places.push(row.element);
    });
    // Where a button has the keyboard nothing is moved, or the keyboard would be lost.
    if (!this.list.contains(document.activeElement) || places.length !== this.list.children.length) placeChildren(this.list, places);
    const numHidden = alerts.length - numShown;
    this.more.hidden = numHidden <= 0;
    setText(this.more, this.showsAll ? words.fewer : words.more(numHidden));
    const gravest = alerts.slice(numShown).map(gravityOf);
    setAttribute(this.more, "data-gravity", gravest.includes("warning") ? "warning" : gravest.includes("caution") ? "caution" : null);
    setAttribute(this.more, "aria-expanded", String(this.showsAll));
    // Alerts of now sound, and are told to a screen reader, also while somebody looks back. Those of a log never.
    const ofNow = state.hello?.mode === "log" ? [] : isLive ? state.picture?.alerts ?? [] : this.behind.liveAlerts;
    this.sounder.want(state.connection.state === "open" ? patternOf(ofNow) : null);
    if (state.hello?.mode !== "log" && ofNow !== this.seen) {
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
