// An alert in a few words: what it is, how near, when, and where it goes. Nothing here knows the DOM.
import * as wire from "../messages/generated.js";
import { holds, type Picture } from "../picture.js";
import type { Settings } from "../settings.js";
import { texts } from "../texts/index.js";
import { duration, length } from "../units.js";
import { opensOut } from "./gravity.js";
import { relative } from "./track_words.js";

const words = texts.panels.alerts;
const kSoon_s = 600;
const kMeets_m = 1;    // nearer than this, middle to middle, it passes on no side
const kAgrees_m = 2;   // straight on to what the look-out says; a boat that turns goes on an arc
const tight = (text: string) => text.replaceAll(" ", "\u00a0");

/** "boat 7"; of the watch, which has no name, a word for that. */
export function shortName(alert: Pick<wire.Alert, "name">): string { return alert.name === "" ? words.watch : alert.name; }

/** Why one sees it, or no more; empty: there is nothing to say. */
export function sightOf(alert: Pick<wire.Alert, "sight" | "state" | "end">): string {
  if (!holds(alert)) return words.ends[alert.end] ?? "";
  return alert.sight === wire.Alert.SIGHT_JUST_SEEN ? words.justSeen : alert.sight === wire.Alert.SIGHT_LOST ? words.lost : "";
}

/** On which side of the boat it passes, by how both go now; empty where that is not known. */
export function passingSide(track: wire.Track | undefined, picture: Pick<Picture, "pose" | "boat" | "own_east_m" | "own_north_m" | "heading_rad">): string {
  const { pose, own_east_m, own_north_m, heading_rad } = picture;
  if (track === undefined || pose === null || !(track.tcpa_s > 0)) return "";
  const t = track.tcpa_s;
  const east = track.position_map_m[0]! - own_east_m + t * (track.velocity_map_mps[0]! - (pose.velocity_map_mps[0]! || 0));
  const north = track.position_map_m[1]! - own_north_m + t * (track.velocity_map_mps[1]! - (pose.velocity_map_mps[1]! || 0));
  const apart_m = Math.hypot(east, north), hulls_m = ((picture.boat?.hull_length_m ?? 0) + (track.length_m || 0)) / 2;
  if (!(apart_m > kMeets_m) || apart_m + kAgrees_m < track.cpa_m || apart_m - hulls_m - kAgrees_m > track.cpa_m) return "";
  const bearing = Math.atan2(east, north) - heading_rad, forward = Math.cos(bearing), starboard = Math.sin(bearing);
  if (!Number.isFinite(forward)) return "";
  if (Math.abs(forward) >= Math.abs(starboard)) return forward > 0 ? words.sides.ahead : words.sides.astern;
  return starboard > 0 ? words.sides.starboard : words.sides.port;
}

/** When and how it passes: "passes astern, 1.2 m in 8.0 s"; in brief without the side. */
export function whatComes(alert: wire.Alert, picture: Picture, settings: Settings, isBrief = false): string {
  if (alert.sight === wire.Alert.SIGHT_LOST) return "";
  if (opensOut(alert)) return words.opens;
  if (!(alert.tcpa_s > 0 && alert.tcpa_s < kSoon_s) || !Number.isFinite(alert.cpa_m)) return "";
  const closest = words.closest(tight(length(settings, alert.cpa_m)), tight(duration(alert.tcpa_s)));
  const side = isBrief ? "" : passingSide(picture.track_by_id.get(alert.track_id), picture);
  return isBrief ? closest : side === "" ? words.comes(closest) : words.passes(side, closest);
}

/** How near, where, when, and where to: one line. Of the watch what the look-out says. */
export function lineOf(alert: wire.Alert, picture: Picture, settings: Settings): string {
  if (alert.cause === wire.Alert.CAUSE_WATCH || !Number.isFinite(alert.distance_m)) return alert.text;
  const where = `${tight(length(settings, alert.distance_m))}, ${tight(relative(alert.bearing_rad))}`;
  if (alert.sight === wire.Alert.SIGHT_LOST) return words.lastPlace(where);
  if (!holds(alert)) return where;
  // Where it passes says more than that it is in the zone, which the chart shows: the line is read at a glance.
  const comes = whatComes(alert, picture, settings);
  const isToldByZone = alert.is_in_zone && (comes === "" || opensOut(alert));
  return [where, comes, isToldByZone ? words.inZone : ""].filter((part) => part !== "").join(" · ");
}
