// The head of the page: live or not, time, own course and speed, sound, settings; below it one line when the picture may not be believed.
import { beginOf } from "../film.js";
import { isOnlyCourse, isRelative, type Picture } from "../picture.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import * as wire from "../messages/generated.js";
import { bearing, date, speed, timeText } from "../units.js";
import { button, make, placeChildren, setAttribute, setText } from "./dom.js";
import { assess } from "./lookout.js";
import type { SettingsSheet } from "./settings.js";
import { icon, Shape } from "./shapes.js";
import type { Sounder } from "./sound.js";

const words = texts.panels.head;
const kDeaf_s = 3;  // how long it may hear nothing before that is worth a sound

export class Banner {
  readonly element = make("header");
  private readonly mode = make("span", "mode");
  private readonly clock = make("span", "clock");
  private readonly headingName = make("dt", "", words.heading);
  private readonly heading = make("dd");
  private readonly headingNote = make("dd", "note");
  private readonly ground = make("dd");
  private readonly sound: HTMLButtonElement;
  private readonly line = make("div", "banner");
  private readonly shape = new Shape();
  private readonly text = make("span");
  private readonly spoken = make("div", "for-readers");
  private wasLost = false;
  private alerts_at: number | undefined;   // times_us of ALERTS that came last
  private alerts_ms = NaN;                 // performance.now() when they came
  private deaf_ms: number | null = null;   // since when nothing is heard; Infinity: told
  private said = "";

  constructor(private readonly state: State, private readonly sounder: Sounder, settings: SettingsSheet) {
    const head = make("div", "head");
    const own = make("dl", "own"), heading = make("div"), ground = make("div"), state_and_time = make("div", "now");
    heading.append(this.headingName, this.heading, this.headingNote);
    ground.append(make("dt", "", words.speed), this.ground);
    own.append(heading, ground);
    state_and_time.append(this.mode, this.clock);
    const buttons = make("div", "buttons");
    this.sound = button("", () => { state.settings.set("sound", !state.settings.get("sound")); }, "plain");
    const open = button("", () => { settings.open(); }, "plain");
    open.append(icon("settings"));
    open.setAttribute("aria-label", texts.panels.settings.title);
    open.title = texts.panels.settings.title;
    buttons.append(this.sound, open);
    head.append(make("h1", "for-readers", texts.title), state_and_time, own, buttons);
    this.line.append(this.shape.element, this.text);
    this.spoken.setAttribute("role", "alert");
    this.element.append(head, this.line, this.spoken);
    state.on(["picture", "age", "connection", "showing"], () => { this.update(); });
    state.on(["settings"], () => { this.update(); });
    this.update();
  }

  private updateSound(): void {
    const isOn = this.state.settings.get("sound");
    const name = !isOn ? words.soundOff : this.sounder.isAllowed ? words.soundOn : words.soundWaits;
    if (this.sound.title === name) return;
    placeChildren(this.sound, [icon(name === words.soundOn ? "sound" : "silent")]);
    this.sound.title = name;
    this.sound.setAttribute("aria-label", name);
  }

  private update(): void {
    const { state } = this;
    const now_ms = performance.now();
    const { picture } = state;
    const isRecorded = state.showing.kind === "recorded" || state.hello?.mode === "log";
    const alerts_at = picture?.times_us.get("ALERTS");
    if (!isRecorded && alerts_at !== undefined && alerts_at !== this.alerts_at) {
      this.alerts_at = alerts_at;
      this.alerts_ms = now_ms;
    }
    if (state.connection.state === "lost") this.wasLost = true;
    const verdict = assess({
      isRecorded, connection: state.connection.state, connection_s: (now_ms - state.connection.since_ms) / 1000, wasLost: this.wasLost,
      hasPicture: picture !== null, age_s: state.age_s, alerts_s: (now_ms - this.alerts_ms) / 1000,
    });
    setAttribute(this.mode, "data-mode", verdict.mode);
    setText(this.mode, words.modes[verdict.mode]);
    const utime_us = state.showing.kind === "recorded" ? state.showing.utime_us : picture?.end_utime_us ?? NaN;
    setText(this.clock, utime_us > 0 ? isRecorded ? `${date(utime_us)} ${timeText(utime_us, beginOf(state))}` : timeText(utime_us, NaN, 0) : "");
    this.tellHeading(picture);
    const velocity = picture?.pose?.velocity_map_mps;
    setText(this.ground, speed(state.settings, velocity === undefined ? NaN : Math.hypot(velocity[0]!, velocity[1]!)));
    this.line.hidden = verdict.text === "";
    if (verdict.text !== "") {
      setAttribute(this.line, "data-level", verdict.level === "quiet" ? "note" : verdict.level);
      this.shape.set(verdict.level === "quiet" ? "unknown" : verdict.level);
      setText(this.text, verdict.text);
    }
    // Heard once, not with each second that it counts.
    const saying = verdict.level === "warning" ? verdict.text.replace(/\d+/g, "") : "";
    if (saying !== this.said) {
      this.said = saying;
      setText(this.spoken, saying === "" ? "" : verdict.text);
    }
    this.updateSound();
    this.beDeaf(verdict.level === "warning" && !isRecorded, now_ms);
  }

  // Course over ground in place of a compass is no heading: wind and current turn the bow away from it.
  private tellHeading(picture: Picture | null): void {
    const isCourse = isOnlyCourse(picture?.pose);
    // Without a compass a relative map is turned as the bow was at its begin.
    const isFromStart = isRelative(picture?.pose) && picture?.pose?.heading_source === wire.Pose.HEADING_NONE;
    setText(this.headingName, isFromStart ? words.relative : isCourse ? words.course : words.heading);
    setText(this.heading, bearing(picture?.heading_rad ?? NaN));
    setText(this.headingNote, isFromStart ? words.relativeNote : isCourse ? words.noCompass : "");
    setAttribute(this.headingName, "title", isFromStart ? words.relativeHint : isCourse ? words.courseHint : null);
  }

  // A look-out that hears nothing raises no alert: the page itself makes the sound, once.
  private beDeaf(isDeaf: boolean, now_ms: number): void {
    if (!isDeaf) this.deaf_ms = null;
    else if (this.deaf_ms === null) this.deaf_ms = now_ms;
    else if (now_ms - this.deaf_ms > 1000 * kDeaf_s) {
      this.deaf_ms = Infinity;
      this.sounder.once("warning");
    }
  }
}
