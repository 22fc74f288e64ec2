// A track in words and numbers as they stand in lists. Nothing here knows the DOM.
import * as wire from "../messages/generated.js";
import type { Picture } from "../picture.js";
import type { Settings } from "../settings.js";
import { texts } from "../texts/index.js";
import { bearing, duration, length, speed } from "../units.js";

const words = texts.panels.tracks;
const kDegree = Math.PI / 180;

/** What tells of names: of people, and of ships. */
export type Names = Pick<Picture, "name_of_track"> & Partial<Pick<Picture, "ship_of_track">>;

/** By her name, else by her MMSI. */
export function shipName(ship: Pick<wire.AisShip, "name" | "mmsi">): string { return ship.name === "" ? texts.drawing.mmsi(ship.mmsi) : ship.name; }
function nameByShip(track: Pick<wire.Track, "id">, { ship_of_track }: Names): string | undefined {
  const ship = ship_of_track?.get(track.id);
  return ship === undefined ? undefined : shipName(ship);
}

/** As people call it, else as AIS does, else by kind and number. */
export function nameOf(track: Pick<wire.Track, "kind" | "id">, names: Names): string {
  return names.name_of_track.get(track.id) ?? nameByShip(track, names) ?? words.name(words.kinds[track.kind] ?? words.kinds[4]!, track.id);
}
/** The same within a sentence or a picture: "boat 7". */
export function shortNameOf(track: Pick<wire.Track, "kind" | "id">, names: Names): string {
  return names.name_of_track.get(track.id) ?? nameByShip(track, names) ?? texts.drawing.name(track.kind, track.id);
}

/** From the bow, as a helmsman says it. */
export function relative(bearing_rad: number): string {
  if (!Number.isFinite(bearing_rad)) return "–";
  const degrees = Math.round((((bearing_rad / kDegree) % 360) + 360) % 360) % 360;
  if (degrees === 0) return words.ahead;
  if (degrees === 180) return words.astern;
  return degrees < 180 ? words.starboard(degrees) : words.port(360 - degrees);
}

/** From true north; NaN where the heading is not known. */
export function trueBearing_rad(track: Pick<wire.Track, "bearing_rad">, picture: Pick<Picture, "heading_rad">): number {
  return track.bearing_rad + picture.heading_rad;
}

/** Status and encounter; empty where there is nothing to say. */
export function situation(track: Pick<wire.Track, "status" | "encounter">): string {
  return [words.encounters[track.encounter] ?? "", words.statuses[track.status] ?? ""].filter((part) => part !== "").join(", ");
}

export function restsOn(track: Pick<wire.Track, "num_seen" | "num_looks" | "mean_returns">): string {
  const returns = track.mean_returns;
  return words.rests(track.num_seen, track.num_looks, returns < 9.95 ? returns.toFixed(1).replace(".0", "") : returns.toFixed(0));
}

export interface TrackTexts { bearing: string; relative: string; range: string; course: string; speed: string; cpa: string; tcpa: string; rests: string }
export function textsOf(track: wire.Track, picture: Picture, settings: Settings): TrackTexts {
  const stands = !Number.isFinite(track.course_rad);
  return {
    bearing: bearing(trueBearing_rad(track, picture)), relative: relative(track.bearing_rad), range: length(settings, track.range_m),
    course: bearing(track.course_rad), speed: stands ? words.stands : speed(settings, track.speed_mps),
    cpa: length(settings, track.cpa_m), tcpa: track.tcpa_s > 0 ? duration(track.tcpa_s) : Number.isFinite(track.tcpa_s) ? words.opens : "–",
    rests: restsOn(track),
  };
}
