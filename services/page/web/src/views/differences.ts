// What two pictures of the same scan say differently. Nothing here knows the DOM.
import { Alert, Track } from "../messages/generated.js";
import { offset } from "../drawing/mercator.js";
import type { Picture } from "../picture.js";

export interface TrackDifference { first: Track | null; second: Track | null; what: "only" | "kind" | "place" | "speed" | "approach" }
export interface Differences {
  /** Whether both hold the same scan, return for return; otherwise all else is empty. */
  isSameScan: boolean;
  numReturns: number;
  /** Returns of which one says that they are of a segment and the other does not, or that lie in segments that do not go together. */
  otherReturns: Uint32Array;
  segmentsOnlyInFirst: number[];
  segmentsOnlyInSecond: number[];
  tracks: TrackDifference[];
  /** Alerts that the other lacks. */
  alertsOnlyInFirst: Alert[];
  alertsOnlyInSecond: Alert[];
}
/** From where on a difference matters: share of the returns, and how far apart a track is; 0: never. */
export interface Limits { share: number; moved_m: number }

const kSameSegment_share = 0.5;  // of the returns of both together
const kSameTrack_m = 2;
const kOtherSpeed_mps = 0.5;
const kOtherApproach_m = 2;

type Labels = Int16Array | Int32Array;

/** Segments that go together: those with more than half of their returns in common. */
function pairSegments(first: Labels, second: Labels): Map<number, number> {
  const sizes = [new Map<number, number>(), new Map<number, number>()], common = new Map<number, number>();
  const add = (counts: Map<number, number>, key: number) => { counts.set(key, (counts.get(key) ?? 0) + 1); };
  for (let i = 0; i < first.length; ++i) {
    const a = first[i]!, b = second[i]!;
    if (a > 0) add(sizes[0]!, a);
    if (b > 0) add(sizes[1]!, b);
    if (a > 0 && b > 0) add(common, a * 65536 + b);
  }
  const pairs = new Map<number, number>();
  for (const [key, count] of common) {
    const a = Math.floor(key / 65536), b = key % 65536;
    if (count > kSameSegment_share * (sizes[0]!.get(a)! + sizes[1]!.get(b)! - count)) pairs.set(a, b);
  }
  return pairs;
}

/** Tracks that a helmsman is told of: confirmed, or with an alert. */
function toldOf({ tracks, alerts }: Picture): Track[] {
  const raised = new Set(alerts.filter(isAlertTold).map((alert) => alert.track_id));
  return tracks.filter((track) => track.status === Track.STATUS_CONFIRMED || track.status === Track.STATUS_COASTING || raised.has(track.id));
}
function isAlertTold(alert: Alert): boolean { return alert.state !== Alert.STATE_CLEARED; }

function pairTracks(first: Picture, second: Picture, segments: ReadonlyMap<number, number>): Map<Track, Track> {
  const pairs = new Map<Track, Track>(), taken = new Set<number>();
  const told = toldOf(first), others = new Set(toldOf(second));
  const take = (a: Track, b: Track | undefined) => {
    if (b === undefined || taken.has(b.id) || !others.has(b)) return;
    pairs.set(a, b);
    taken.add(b.id);
  };
  for (const track of told) {
    for (const id of track.segment_ids) {
      const other = segments.get(id);
      if (!pairs.has(track) && other !== undefined) take(track, second.track_of_segment.get(other));
    }
  }
  // The nearest pairs first, so that the order of ids plays no part.
  const near: { a: Track; b: Track; distance_m: number }[] = [];
  for (const a of told) {
    if (pairs.has(a)) continue;
    for (const b of others) {
      const distance_m = Math.hypot(a.position_map_m[0]! - b.position_map_m[0]!, a.position_map_m[1]! - b.position_map_m[1]!);
      if (distance_m < kSameTrack_m) near.push({ a, b, distance_m });
    }
  }
  for (const { a, b } of near.sort((one, other) => one.distance_m - other.distance_m)) if (!pairs.has(a)) take(a, b);
  return pairs;
}

// How far apart two say that a track is: on the earth, since their map frames may have other datums; on the map where a frame is not on the earth.
function apart_m(one: Track, other: Track): number {
  if (Number.isNaN(one.latitude_deg) || Number.isNaN(other.latitude_deg)) {
    return Math.hypot(one.position_map_m[0]! - other.position_map_m[0]!, one.position_map_m[1]! - other.position_map_m[1]!);
  }
  const [east, north] = offset(one.latitude_deg, one.longitude_deg, other.latitude_deg, other.longitude_deg);
  return Math.hypot(east, north);
}

/** What two pictures of the same scan say of its returns (of the first lidar), tracks and alerts. */
export function compare(first: Picture, second: Picture, moved_m: number): Differences {
  const a = first.returns, b = second.returns;
  return compareLabels(first, second, a?.label.subarray(0, a.first_count) ?? null, b?.label.subarray(0, b.first_count) ?? null, moved_m);
}
/** The same with the labels of the returns beside the pictures; a label of 0 is no return. */
export function compareLabels(first: Picture, second: Picture, a: Labels | null, b: Labels | null, moved_m: number): Differences {
  const none = { numReturns: 0, otherReturns: new Uint32Array(), segmentsOnlyInFirst: [], segmentsOnlyInSecond: [], tracks: [], alertsOnlyInFirst: [], alertsOnlyInSecond: [] };
  if (first.utime_us !== second.utime_us || a === null || b === null || a.length !== b.length) return { isSameScan: false, ...none };
  const segments = pairSegments(a, b);
  const other = new Uint32Array(a.length);
  let numOther = 0, numReturns = 0;
  for (let i = 0; i < a.length; ++i) {
    const one = a[i]!, two = b[i]!;
    if (one !== 0 || two !== 0) ++numReturns;
    if (one > 0 ? segments.get(one) !== two : two > 0) other[numOther++] = i;
  }
  const paired = new Set(segments.values());
  const tracks: TrackDifference[] = [];
  const pairs = pairTracks(first, second, segments), seconds = new Set([...pairs.values()].map((track) => track.id));
  for (const track of toldOf(first)) {
    const same = pairs.get(track);
    if (same === undefined) tracks.push({ first: track, second: null, what: "only" });
    else if (same.kind !== track.kind) tracks.push({ first: track, second: same, what: "kind" });
    else if (moved_m > 0 && apart_m(track, same) >= moved_m) tracks.push({ first: track, second: same, what: "place" });
    else if (Math.abs(same.speed_mps - track.speed_mps) >= kOtherSpeed_mps) tracks.push({ first: track, second: same, what: "speed" });
    else if (Math.abs(same.cpa_m - track.cpa_m) >= kOtherApproach_m && Math.max(same.tcpa_s, track.tcpa_s) > 0) tracks.push({ first: track, second: same, what: "approach" });
  }
  for (const track of toldOf(second)) if (!seconds.has(track.id)) tracks.push({ first: null, second: track, what: "only" });
  // An alert is of a thing: the same when its track goes together with the other's; without a track when it is called the same.
  const partner = new Map([...pairs].map(([one, two]) => [one.id, two.id]));
  const has = (picture: Picture, { track_id, name }: Alert, of: ReadonlyMap<number, number>) => picture.alerts.some((alert) =>
    isAlertTold(alert) && (track_id === 0 ? alert.track_id === 0 && alert.name === name : alert.track_id === of.get(track_id)));
  const back = new Map([...partner].map(([one, two]) => [two, one]));
  return {
    isSameScan: true, numReturns, otherReturns: other.slice(0, numOther),
    segmentsOnlyInFirst: first.segments.map((segment) => segment.id).filter((id) => !segments.has(id)),
    segmentsOnlyInSecond: second.segments.map((segment) => segment.id).filter((id) => !paired.has(id)),
    tracks,
    alertsOnlyInFirst: first.alerts.filter((alert) => isAlertTold(alert) && !has(second, alert, partner)),
    alertsOnlyInSecond: second.alerts.filter((alert) => isAlertTold(alert) && !has(first, alert, back)),
  };
}

/** What of the differences of a scan matters: tracks that only one has, or has as another kind or elsewhere, alerts, many returns. Each by a name that stays while it lasts. */
export function mattering({ isSameScan, otherReturns, numReturns, tracks, alertsOnlyInFirst, alertsOnlyInSecond }: Differences, { share }: Limits): string[] {
  if (!isSameScan) return ["scan"];
  return [
    ...(share > 0 && otherReturns.length >= share * numReturns && otherReturns.length > 0 ? ["returns"] : []),
    ...tracks.filter(({ what }) => what === "only" || what === "kind" || what === "place").map(nameOfTrack),
    ...alertsOnlyInFirst.map((alert) => nameOfAlert(alert, "first")), ...alertsOnlyInSecond.map((alert) => nameOfAlert(alert, "second")),
  ];
}
export function nameOfTrack({ what, first, second }: TrackDifference): string { return `${what} ${first?.id ?? "–"} ${second?.id ?? "–"}`; }
export function nameOfAlert(alert: Alert, side: "first" | "second"): string { return `alert ${side} ${alert.track_id === 0 ? alert.name : alert.track_id}`; }

const kForgotten_scans = 20;

/** Finds where a difference begins: one that lasts, or comes and goes within two seconds, is met once. */
export class Beginnings {
  private readonly seen = new Map<string, number>();
  private count = 0;

  /** To be called with what matters of each scan, in their order. @returns what was not there in the scans just before */
  take(names: readonly string[]): string[] {
    ++this.count;
    const fresh = names.filter((name) => !(this.count - (this.seen.get(name) ?? -Infinity) <= kForgotten_scans));
    for (const name of names) this.seen.set(name, this.count);
    return fresh;
  }
}
