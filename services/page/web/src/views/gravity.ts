// How grave things are, and their order: the most dangerous first. Nothing here knows the DOM.
import * as wire from "../messages/generated.js";
import { holds } from "../picture.js";
import type { Gravity } from "./shapes.js";

/** What holds and is not acknowledged is a warning or a caution; what is acknowledged or over is quiet. */
export function gravityOf(alert: Pick<wire.Alert, "level" | "state">): Gravity {
  if (alert.state !== wire.Alert.STATE_ACTIVE) return "quiet";
  return alert.level >= wire.Alert.LEVEL_WARNING ? "warning" : "caution";
}

const kClearlyNearer = 0.8;
const kClearly_s = 1;  // by so much less time is left: less makes no other order, or a button would be touched for another

/** What holds: what is not acknowledged before what is, warnings before cautions, then what leaves less time. Where none of two comes too near: what is
 *  seen before what is not seen any more, then the nearer.
 *  @param before ids in the order of before: what is as urgent stays where it was; what is new comes first */
export function byGravity(alerts: readonly wire.Alert[], before: readonly number[] = []): wire.Alert[] {
  const place = (alert: wire.Alert) => before.indexOf(alert.id);
  const placed = sorted(alerts.filter(holds), (alert) => [alert.state === wire.Alert.STATE_ACKNOWLEDGED ? 1 : 0, -alert.level, place(alert), -alert.raised_utime_us]);
  const isAlike = (a: wire.Alert, b: wire.Alert) => a.level === b.level && a.state === b.state;
  for (let i = 1; i < placed.length; ++i) {
    for (let k = i; k > 0 && isAlike(placed[k]!, placed[k - 1]!) && isClearlySooner(placed[k]!, placed[k - 1]!); --k) {
      [placed[k], placed[k - 1]] = [placed[k - 1]!, placed[k]!];
    }
  }
  return placed;
}
function isClearlySooner(one: wire.Alert, other: wire.Alert): boolean {
  const left = last(one.time_left_s), of_other = last(other.time_left_s);
  if (left < Infinity || of_other < Infinity) return left < Infinity && left < of_other - kClearly_s;
  const isLost = (alert: wire.Alert) => alert.sight === wire.Alert.SIGHT_LOST;
  if (isLost(one) !== isLost(other)) return isLost(other);
  return last(one.distance_m) < kClearlyNearer * last(other.distance_m);
}

/** What is over and was not acknowledged, the newest first. */
export function overOf(alerts: readonly wire.Alert[]): wire.Alert[] {
  return sorted(alerts.filter((alert) => alert.state === wire.Alert.STATE_RECTIFIED), (alert) => [-alert.changed_utime_us]);
}

/** Whether it goes away again: that is never shown as a danger. */
export function opensOut(alert: Pick<wire.Alert, "time_left_s" | "tcpa_s">): boolean { return Number.isNaN(alert.time_left_s) && alert.tcpa_s <= 0; }

/** Tracks by alert, then probability of a close approach in steps of a tenth, time to it, and range. Status LOST is left out. */
export function byDanger(tracks: readonly wire.Track[], alert_of_track: ReadonlyMap<number, wire.Alert>, withTentative: boolean): wire.Track[] {
  const shown = tracks.filter((track) => track.status !== wire.Track.STATUS_LOST
    && (withTentative || track.status !== wire.Track.STATUS_TENTATIVE || alert_of_track.has(track.id)));
  return sorted(shown, (track) => {
    const alert = alert_of_track.get(track.id);
    const probability = Math.round(10 * (track.cpa_probability || 0)) / 10;
    // While it opens the time says nothing.
    const time = probability > 0 && track.tcpa_s > 0 ? track.tcpa_s : Infinity;
    return [alert === undefined || alert.state === wire.Alert.STATE_CLEARED ? 0 : -alert.level, -probability, time, last(track.range_m)];
  });
}

/** The order that was, as long as somebody points at it: what is gone leaves, what is new comes last. */
export function keepOrder<T extends { id: number }>(before: readonly number[], wanted: readonly T[]): T[] {
  const byId = new Map(wanted.map((item) => [item.id, item]));
  const kept = before.flatMap((id) => byId.get(id) ?? []);
  const known = new Set(before);
  return [...kept, ...wanted.filter((item) => !known.has(item.id))];
}

function last(value: number): number { return Number.isFinite(value) ? value : Infinity; }

function sorted<T extends { id: number }>(items: readonly T[], keys: (item: T) => number[]): T[] {
  return items.map((item) => ({ item, keys: [...keys(item), item.id] })).sort((a, b) => {
    for (let i = 0; i < a.keys.length; ++i) if (a.keys[i] !== b.keys[i]) return a.keys[i]! < b.keys[i]! ? -1 : 1;
    return 0;
  }).map(({ item }) => item);
}

/** What a screen reader hears: each alert once when it is raised, when it grows graver or holds again; once when it is over. */
export class Announcer {
  private readonly told = new Map<number, { level: number; state: number }>();

  /** @returns alerts to be told at once, and those that may wait for a pause in speech */
  take(alerts: readonly wire.Alert[]): { now: wire.Alert[]; later: wire.Alert[] } {
    const now: wire.Alert[] = [], later: wire.Alert[] = [];
    for (const alert of alerts) {
      const before = this.told.get(alert.id);
      const isActive = alert.state === wire.Alert.STATE_ACTIVE;
      if (isActive && (before === undefined || alert.level > before.level || before.state !== wire.Alert.STATE_ACTIVE)) now.push(alert);
      else if (before !== undefined && alert.state !== before.state) later.push(alert);
      this.told.set(alert.id, { level: alert.level, state: alert.state });
    }
    const present = new Set(alerts.map((alert) => alert.id));
    for (const id of this.told.keys()) if (!present.has(id)) this.told.delete(id);
    return { now, later };
  }
}

export type Pattern = "caution" | "warning";
/** The sound of the one that sounds, as the look-out tells it. */
export function patternOf(report: Pick<wire.Alerts, "alerts" | "sounding_alert_id"> | null): Pattern | null {
  if (report === null || report.sounding_alert_id === 0) return null;
  const alert = report.alerts.find(({ id }) => id === report.sounding_alert_id);
  return alert === undefined ? null : alert.level >= wire.Alert.LEVEL_WARNING ? "warning" : "caution";
}
