// How grave things are, and their order: the most dangerous first. Nothing here knows the DOM.
import * as wire from "../messages/generated.js";
import type { Gravity } from "./shapes.js";

/** What holds and is not acknowledged is a warning or a caution; what is acknowledged or over is quiet. */
export function gravityOf(alert: Pick<wire.Alert, "level" | "state">): Gravity {
  if (alert.state === wire.Alert.STATE_ACKNOWLEDGED || alert.state === wire.Alert.STATE_CLEARED) return "quiet";
  return alert.level >= wire.Alert.LEVEL_WARNING ? "warning" : "caution";
}

const kSoon_s = 30;

// Active before over before acknowledged; warnings before cautions; what comes within half a minute; what was raised last. Nothing of it changes with
// each scan: a button that moved would be touched for another.
function urgency(alert: wire.Alert): [number, number, number, number] {
  const states = [wire.Alert.STATE_ACTIVE, wire.Alert.STATE_RECTIFIED, wire.Alert.STATE_ACKNOWLEDGED] as readonly number[];
  const state = states.indexOf(alert.state);
  return [state < 0 ? states.length : state, -alert.level, alert.tcpa_s <= kSoon_s ? 0 : 1, -alert.raised_utime_us];
}

export function byGravity(alerts: readonly wire.Alert[]): wire.Alert[] {
  return sorted(alerts.filter((alert) => alert.state !== wire.Alert.STATE_CLEARED), urgency);
}

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
