// The sensors in words: the lidar's clock, the GNSS receiver, and what is known of the own position and heading.
import * as wire from "../messages/generated.js";
import { isOnlyCourse, lacking, type Picture } from "../picture.js";
import type { State, View } from "../state.js";
import { texts } from "../texts/index.js";
import { duration } from "../units.js";
import { Facts, make, Pace, setAttribute, setText } from "./dom.js";
import { type Gravity, Shape } from "./shapes.js";
import { place } from "./track_detail.js";

const words = texts.panels.sensors;
const kEvery_ms = 500;
const kDegree = Math.PI / 180;
const kOld_s = 3;

function deviationText(metres: number): string {
  if (!Number.isFinite(metres)) return "–";
  return metres < 1 ? `${(100 * metres).toFixed(0)} cm` : `${metres.toFixed(1)} m`;
}
function signed(value: number, decimals: number): string { return Number.isFinite(value) ? `${value > 0 ? "+" : ""}${value.toFixed(decimals)}` : "–"; }

export function gravityOfClock(state: number): Gravity {
  switch (state) {
    case wire.LidarClock.STATE_LOCKED: return "ok";
    case wire.LidarClock.STATE_ERROR: case wire.LidarClock.STATE_FREE_RUNNING: return "caution";
    default: return "unknown";  // a boat without PPS at its lidar is no fault
  }
}
export function gravityOfFix(quality: number): Gravity {
  return quality === wire.GnssFix.QUALITY_NONE ? "warning" : quality === wire.GnssFix.QUALITY_DEAD_RECKONING ? "caution" : "ok";
}
export function gravityOfPose(pose: Pick<wire.Pose, "status" | "heading_source">): Gravity {
  if (pose.status === wire.Pose.STATUS_OK) return isOnlyCourse(pose) ? "caution" : "ok";
  return pose.status === wire.Pose.STATUS_UNKNOWN ? "warning" : "caution";
}

class Card {
  readonly element = make("article", "card");
  readonly facts = new Facts();
  private readonly shape = new Shape("unknown");
  private readonly state = make("span", "state", words.none);

  constructor(name: string) {
    const head = make("header");
    head.append(this.shape.element, make("strong", "", name), this.state);
    this.element.append(head, this.facts.element);
  }
  tell(gravity: Gravity, text: string): void {
    setAttribute(this.element, "data-gravity", gravity);
    this.shape.set(gravity);
    setText(this.state, text);
  }
}

export class Sensors implements View {
  readonly element = make("div", "sensors page");
  private readonly pose = new Card(words.pose);
  private readonly fix = new Card(words.gnss);
  private readonly clock = new Card(words.lidar);
  private isVisible = false;
  private readonly pace = new Pace(() => { this.draw(); }, () => kEvery_ms);

  constructor(private readonly state: State) {
    this.element.append(this.pose.element, this.fix.element, this.clock.element);
    state.on(["picture"], () => { if (this.isVisible) this.pace.ask(); });
  }

  setVisible(isVisible: boolean): void {
    this.isVisible = isVisible;
    this.draw();
  }

  private draw(): void {
    const { picture } = this.state;
    if (!this.isVisible || picture === null) return;
    const newest_us = Math.max(...picture.times_us.values());
    const age = (channel: string) => (newest_us - (picture.times_us.get(channel) ?? NaN)) / 1e6;
    this.drawPose(picture, age("POSE"));
    this.drawFix(picture, age("GNSS_FIX"));
    this.drawClock(picture, age("LIDAR_CLOCK"));
  }

  private drawPose({ pose }: Picture, age_s: number): void {
    if (pose === null) return;
    const { facts } = this.pose, names = words.facts;
    const deviation = (index: number) => Math.sqrt(pose.covariance[index]?.[index] ?? NaN);
    this.pose.tell(age_s > kOld_s ? "warning" : gravityOfPose(pose), lacking(pose) === null && isOnlyCourse(pose) ? words.onlyCourse : words.poseStates[pose.status] ?? "");
    facts.set(names.age, texts.panels.health.ago(duration(age_s)));
    facts.set(names.place, place(pose.latitude_deg, pose.longitude_deg));
    facts.set(names.deviation, deviationText(Math.max(deviation(0), deviation(1))));
    facts.set(names.heading, words.headings[pose.heading_source] ?? "");
    facts.set(names.headingDeviation, Number.isFinite(deviation(8)) ? `${(deviation(8) / kDegree).toFixed(1)}°` : "–");
    facts.set(names.attitude, pose.has_attitude
      ? words.measured(signed(pose.roll_rad / kDegree, 1), signed(pose.pitch_rad / kDegree, 1)) : words.unmeasured);
  }

  private drawFix({ fix }: Picture, age_s: number): void {
    if (fix === null) return;
    const { facts } = this.fix, names = words.facts;
    this.fix.tell(age_s > kOld_s ? "warning" : gravityOfFix(fix.quality), words.qualities[fix.quality] ?? String(fix.quality));
    facts.set(names.age, texts.panels.health.ago(duration(age_s)));
    facts.set(names.satellites, fix.num_satellites < 0 ? "–" : String(fix.num_satellites));
    facts.set(names.hdop, Number.isFinite(fix.hdop) ? fix.hdop.toFixed(1) : "–");
    facts.set(names.deviation, deviationText(fix.horizontal_sd_m));
    facts.set(names.receiver, `${fix.source} (${fix.sentence_type})`);
  }

  private drawClock({ clock }: Picture, age_s: number): void {
    if (clock === null) return;
    const { facts } = this.clock, names = words.facts;
    this.clock.tell(age_s > kOld_s ? "warning" : gravityOfClock(clock.state), words.clockStates[clock.state] ?? "");
    facts.set(names.age, texts.panels.health.ago(duration(age_s)));
    facts.set(names.stamps, words.timeSources[clock.time_source] ?? "");
    facts.set(names.offset, Number.isFinite(clock.offset_s) ? texts.panels.health.milliseconds(signed(1000 * clock.offset_s, 1)) : "–");
    facts.set(names.drift, Number.isFinite(clock.drift_ppm) ? `${signed(clock.drift_ppm, 1)} ppm` : "–");
    facts.set(names.rotation, Number.isFinite(clock.rotation_rpm) ? `${clock.rotation_rpm.toFixed(0)} / min` : "–");
    facts.set(names.packets, `${clock.num_lost_packets} / ${clock.num_packets}`);
    facts.set(names.rmc, clock.rmc_age_us < 0 ? "–" : texts.panels.health.ago(duration(clock.rmc_age_us / 1e6)));
  }
}
