// What views show: messages of one moment, joined and brought into frames that can be drawn. Nothing here knows the DOM.
import * as wire from "./messages/generated.js";
import type { BoatFacts, Frame, Mounting } from "./link.js";
import { Refused } from "./messages/reader.js";

/** Channels that a picture is made of. */
export const kPictureChannels = ["LIDAR_SCAN", "LIDAR_SCAN_2", "SEGMENTS", "SEGMENTS_2", "OBSTACLES", "TRACKS", "ALERTS", "AIS", "POSE", "LIDAR_CLOCK", "GNSS_FIX", "HEALTH", "RUN_INFO"];

/** Added to the labels of a second lidar that are segments: its SEGMENTS_2 have numbers of their own. */
export const kSecondLidar = 0x10000;

/** Returns of a scan that measured something, as arrays with one number (or three) per return; behind those of the first lidar the second's. */
export interface Returns {
  count: number;
  /** Of the first lidar. */
  first_count: number;
  /** x, y, z in the frame `level`: x forward along the heading at the end of the scan, y port, z up from the water; each placed by the attitude at its time. */
  level_m: Float32Array;
  range_m: Float32Array;
  reflectivity: Uint8Array;
  /** As in SEGMENTS: above 0 the segment, below 0 minus the reason, 0 where SEGMENTS did not come. A segment of the second lidar has kSecondLidar more. */
  label: Int32Array;
  /** Place in the range image of its lidar. */
  column: Uint16Array;
  ring: Uint8Array;
  return_index: Uint8Array;
}

/** One scan with all that was said of it. A part that did not come is empty. */
export interface Picture {
  /** First firing of the scan; of a picture without scan the time of its newest message. Microseconds since 1970 UTC. */
  utime_us: number;
  end_utime_us: number;
  boat: BoatFacts | null;
  scan: wire.LidarScan[];
  returns: Returns | null;
  segments: wire.Segment[];
  obstacles: wire.Obstacle[];
  /** Status LOST left in: it is told once. */
  tracks: wire.Track[];
  track_by_id: ReadonlyMap<number, wire.Track>;
  /** Track of a segment of this scan. */
  track_of_segment: ReadonlyMap<number, wire.Track>;
  /** Segments that are land, by what is remembered or by the scan. */
  land_segments: ReadonlySet<number>;
  /** Remembered edge of land, map frame: east, north, east, north ... */
  waterline_map_m: Float32Array;
  alerts: wire.Alert[];
  /** ALERTS whole: what sounds, silence, limits in force; null: none came. */
  alert_report: wire.Alerts | null;
  /** Alert of a track that holds, the gravest. */
  alert_of_track: ReadonlyMap<number, wire.Alert>;
  /** What people called a track. */
  name_of_track: ReadonlyMap<number, string>;
  /** Ships of AIS, while it is no older than the tracks. */
  ships: wire.AisShip[];
  /** The ship of AIS that a track is, where that is sure. */
  ship_of_track: ReadonlyMap<number, wire.AisShip>;
  /** Of the end of the scan, or the newest. */
  pose: wire.Pose | null;
  /** Own position in the map frame at the end of the scan; NaN = not known. */
  own_east_m: number;
  own_north_m: number;
  /** From true north clockwise, at the end of the scan; NaN = not known. */
  heading_rad: number;
  clock: wire.LidarClock | null;
  fix: wire.GnssFix | null;
  health: wire.Health[];
  run_info: wire.RunInfo | null;
  /** When each channel last came, by the clock of whoever received it (server or log), by name. */
  times_us: ReadonlyMap<string, number>;
}

interface Parted { utime_us: number; part_index: number; num_parts: number }

// The parts of the newest message of a channel, and those of the one before until they are whole.
class Parts<T extends Parted> {
  whole: T[] = [];
  private coming: T[] = [];
  take(message: T): boolean {
    if (this.coming[0] !== undefined && this.coming[0].utime_us !== message.utime_us) this.coming = [];
    if (!this.coming.some((part) => part.part_index === message.part_index)) this.coming.push(message);
    if (this.coming.length < message.num_parts) return false;
    this.whole = this.coming.sort((a, b) => a.part_index - b.part_index);
    this.coming = [];
    return true;
  }
}

const kPosesKept = 64;
/** AIS of another scan is shown beside tracks so long: a moment of a recording has that of the scan before. */
const kAisKept_us = 1_500_000;
const kNoParts: wire.Segments[] = [];
const kSecondScansKept = 8;
/** The scan of the second lidar that is shown ended so long before that of the first, or later. */
const kSecondBefore_us = 500_000;

/** What one lidar saw in one scan. */
export interface Looked { scan: wire.LidarScan[]; labels: wire.Segments[] }
function isSame(a: Looked | null, b: Looked | null): boolean { return a?.scan === b?.scan && a?.labels === b?.labels; }

/** Takes messages in any order, and makes a picture of what is newest. */
export class Assembler {
  private readonly scan = new Parts<wire.LidarScan>();
  private readonly scans: wire.LidarScan[][] = [];  // whole, the newest last: TRACKS come later than the scan
  private readonly segments = new Parts<wire.Segments>();
  private readonly second = { scan: new Parts<wire.LidarScan>(), segments: new Parts<wire.Segments>(), scans: [] as Looked[], labels: [] as wire.Segments[][] };
  private readonly obstacles = new Parts<wire.Obstacles>();
  private readonly tracks = new Parts<wire.Tracks>();
  private waterline = new Float32Array();
  private alerts: wire.Alerts | null = null;
  private ais: wire.Ais | null = null;
  private readonly poses: wire.Pose[] = [];
  private clock: wire.LidarClock | null = null;
  private fix: wire.GnssFix | null = null;
  private readonly health = new Map<string, { health: wire.Health; utime_us: number }>();
  private run_info: wire.RunInfo | null = null;
  private readonly times = new Map<string, number>();
  /** Messages that could not be read, by channel. */
  readonly refused = new Map<string, number>();
  boat: BoatFacts | null = null;
  private kept: { first: Looked; second: Looked | null; pose: wire.Pose | null; boat: BoatFacts | null; returns: Returns } | null = null;

  /** @returns whether there is something new to draw: a scan, tracks, alerts or obstacles that are whole */
  take(frame: Frame): boolean {
    try {
      const isNew = this.takeMessage(frame);
      this.times.set(frame.channel, frame.utime_us);
      return isNew;
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
      this.refused.set(frame.channel, (this.refused.get(frame.channel) ?? 0) + 1);
      return false;
    }
  }

  private takeMessage({ channel, utime_us, bytes }: Frame): boolean {
    switch (channel) {
      case "LIDAR_SCAN":
        if (!this.scan.take(wire.LidarScan.decode(bytes))) return false;
        this.scans.push(this.scan.whole);
        if (this.scans.length > 3) this.scans.shift();
        return true;
      case "LIDAR_SCAN_2": {
        const { second } = this;
        if (second.scan.take(wire.LidarScan.decode(bytes))) second.scans = [...second.scans, { scan: second.scan.whole, labels: kNoParts }].slice(-kSecondScansKept);
        return false;
      }
      case "SEGMENTS": return this.segments.take(wire.Segments.decode(bytes));
      case "SEGMENTS_2": {
        const { second } = this;
        if (second.segments.take(wire.Segments.decode(bytes))) second.labels = [...second.labels, second.segments.whole].slice(-kSecondScansKept);
        return false;
      }
      case "OBSTACLES": return this.obstacles.take(wire.Obstacles.decode(bytes));
      case "TRACKS": {
        if (!this.tracks.take(wire.Tracks.decode(bytes))) return false;
        const first = this.tracks.whole[0]!;
        if (first.num_waterline > 0) this.waterline = interleaved(first.waterline_east_m, first.waterline_north_m);
        return true;
      }
      case "ALERTS": this.alerts = wire.Alerts.decode(bytes); return true;
      case "AIS": this.ais = wire.Ais.decode(bytes); return false;
      case "POSE":
        this.poses.push(wire.Pose.decode(bytes));
        this.poses.sort((a, b) => a.utime_us - b.utime_us);
        if (this.poses.length > kPosesKept) this.poses.shift();
        return false;
      case "LIDAR_CLOCK": this.clock = wire.LidarClock.decode(bytes); return false;
      case "GNSS_FIX": this.fix = wire.GnssFix.decode(bytes); return false;
      case "HEALTH": {
        const health = wire.Health.decode(bytes);
        this.health.set(`${health.process}@${health.host}`, { health, utime_us });
        return false;
      }
      case "RUN_INFO": this.run_info = wire.RunInfo.decode(bytes); return false;
      default: return false;
    }
  }

  // Tracks, obstacles and alerts of a scan come one after the other: its returns stay the same array.
  private returnsOf(first: Looked, second: Looked | null, pose: wire.Pose | null, turn_radps: number): Returns {
    const { kept } = this;
    if (kept !== null && isSame(kept.first, first) && isSame(kept.second, second) && kept.pose === pose && kept.boat === this.boat) return kept.returns;
    const returns = toReturns(first, second, this.boat, pose, turn_radps);
    this.kept = { first, second, pose, boat: this.boat, returns };
    return returns;
  }

  // What the second lidar saw last until the end of the first's scan.
  private seenBySecond(end_utime_us: number): Looked | null {
    const seen = this.second.scans.findLast(({ scan }) => scan[0]!.end_utime_us <= end_utime_us);
    if (seen === undefined || end_utime_us - seen.scan[0]!.end_utime_us > kSecondBefore_us) return null;
    return { scan: seen.scan, labels: this.second.labels.findLast((parts) => parts[0]!.utime_us === seen.scan[0]!.utime_us) ?? kNoParts };
  }

  picture(): Picture {
    const tracksParts = this.tracks.whole, segmentParts = this.segments.whole;
    // The scan whose segments and tracks are there; where nobody segments, the newest.
    const scan = this.scans.findLast((parts) => parts[0]!.utime_us === segmentParts[0]?.utime_us) ?? this.scans.at(-1) ?? [];
    const first = scan[0];
    const tracks = tracksParts.flatMap((part) => part.tracks);
    const isOfScan = segmentParts[0]?.utime_us === first?.utime_us;
    const segments = isOfScan ? segmentParts.flatMap((part) => part.segments) : [];
    const track_of_segment = new Map<number, wire.Track>();
    const land_segments = new Set<number>();
    if (tracksParts[0] !== undefined && tracksParts[0].utime_us === segmentParts[0]?.utime_us) {
      for (const track of tracks) for (const id of track.segment_ids) track_of_segment.set(id, track);
      for (const id of tracksParts[0].land_segment_ids) land_segments.add(id);
    }
    for (const segment of segments) if (segment.kind === wire.Segment.KIND_LAND && !track_of_segment.has(segment.id)) land_segments.add(segment.id);
    const alert_of_track = new Map<number, wire.Alert>();
    const alerts = this.alerts?.alerts ?? [];
    for (const alert of alerts) if (holds(alert) && alert.track_id !== 0 && !alert_of_track.has(alert.track_id)) alert_of_track.set(alert.track_id, alert);
    const name_of_track = new Map<number, string>();
    this.alerts?.named_track_id.forEach((id, index) => { name_of_track.set(id, this.alerts?.given_name[index] ?? ""); });
    const end_utime_us = first?.end_utime_us ?? tracksParts[0]?.end_utime_us ?? this.alerts?.end_utime_us ?? this.poses.at(-1)?.utime_us ?? 0;
    const pose = this.poses.findLast((candidate) => candidate.utime_us <= end_utime_us) ?? this.poses.at(-1) ?? null;
    const motion = motionOf(this.poses, pose);
    const after_s = pose === null ? 0 : Math.min(0.5, Math.max(-0.5, (end_utime_us - pose.utime_us) / 1e6));
    const newest = Math.max(0, ...this.times.values());
    const { ais } = this, ofTracks = tracksParts[0];
    const hasAis = ais !== null && Math.abs(ais.end_utime_us - end_utime_us) < kAisKept_us && (ofTracks === undefined || ais.tracks_begin_utime_us === ofTracks.begin_utime_us);
    const ships = hasAis ? ais.ships : [];
    const ship_of_track = new Map(ships.filter((ship) => ship.state === wire.AisShip.STATE_TRACKED).map((ship) => [ship.track_id, ship]));
    return {
      utime_us: first?.utime_us ?? tracksParts[0]?.utime_us ?? newest, end_utime_us, boat: this.boat, scan,
      returns: scan.length === 0 ? null : this.returnsOf({ scan, labels: isOfScan ? segmentParts : kNoParts }, this.seenBySecond(end_utime_us), pose, motion.turn_radps),
      segments, obstacles: this.obstacles.whole.flatMap((part) => part.obstacles), tracks,
      track_by_id: new Map(tracks.map((track) => [track.id, track])), track_of_segment, land_segments, waterline_map_m: this.waterline,
      alerts, alert_report: this.alerts, alert_of_track, name_of_track, ships, ship_of_track, pose,
      own_east_m: pose === null ? NaN : pose.position_map_m[0]! + after_s * (pose.velocity_map_mps[0]! || 0),
      own_north_m: pose === null ? NaN : pose.position_map_m[1]! + after_s * (pose.velocity_map_mps[1]! || 0),
      heading_rad: pose === null ? NaN : pose.heading_rad + after_s * motion.turn_radps,
      clock: this.clock, fix: this.fix,
      health: [...this.health.values()].filter((entry) => newest - entry.utime_us < 10e6).map((entry) => entry.health)
        .sort((a, b) => (a.process < b.process ? -1 : 1)),
      run_info: this.run_info, times_us: new Map(this.times),
    };
  }
}

function interleaved(east: Float32Array, north: Float32Array): Float32Array<ArrayBuffer> {
  const both = new Float32Array(2 * east.length);
  for (let i = 0; i < east.length; ++i) { both[2 * i] = east[i]!; both[2 * i + 1] = north[i]!; }
  return both;
}

/** Whether it is so now, acknowledged or not; else it is over. */
export function holds(alert: Pick<wire.Alert, "state">): boolean { return alert.state === wire.Alert.STATE_ACTIVE || alert.state === wire.Alert.STATE_ACKNOWLEDGED; }

/** Whether the heading is only the course over ground: neither a compass nor an attitude sensor tells one. */
export function isOnlyCourse(pose: Pick<wire.Pose, "heading_source"> | null | undefined): boolean { return pose?.heading_source === wire.Pose.HEADING_COURSE; }
/** Whether the map is one of its own, which began where the boat was: nothing of it has a place on the earth. */
export function isRelative(pose: Pick<wire.Pose, "status"> | null | undefined): boolean {
  return pose?.status === wire.Pose.STATUS_RELATIVE || pose?.status === wire.Pose.STATUS_RELATIVE_COASTING || pose?.status === wire.Pose.STATUS_RELATIVE_TO_BOAT;
}
/** What is not known of where the boat is and where its bow points: without both there are no tracks. */
export function lacking(pose: Pick<wire.Pose, "status"> | null): "position" | "heading" | null {
  if (pose?.status === wire.Pose.STATUS_OK || pose?.status === wire.Pose.STATUS_COASTING || isRelative(pose)) return null;
  return pose?.status === wire.Pose.STATUS_NO_HEADING ? "heading" : "position";
}

/** Difference of two angles, -pi to pi. */
export function angleBetween(to_rad: number, from_rad: number): number {
  const turn = (to_rad - from_rad) % (2 * Math.PI);
  return turn > Math.PI ? turn - 2 * Math.PI : turn < -Math.PI ? turn + 2 * Math.PI : turn;
}

function motionOf(poses: wire.Pose[], pose: wire.Pose | null): { turn_radps: number } {
  const before = pose === null ? undefined : poses.findLast((candidate) => candidate.utime_us < pose.utime_us - 15_000);
  if (pose === null || before === undefined || pose.utime_us - before.utime_us > 500_000) return { turn_radps: 0 };
  const turn = angleBetween(pose.heading_rad, before.heading_rad) / ((pose.utime_us - before.utime_us) / 1e6);
  return { turn_radps: Number.isFinite(turn) ? turn : 0 };
}

const kNoMounting: Mounting = { x_m: 0, y_m: 0, z_m: 0, roll_deg: 0, pitch_deg: 0, yaw_deg: 0 };
function numReturns(scan: wire.LidarScan[]): number {
  let count = 0;
  for (const part of scan) for (const range of part.range) if (range !== 0) ++count;
  return count;
}

/** Where each return of both lidars lies, at the end of the first's scan. */
export function toReturns(first: Looked, second: Looked | null, boat: BoatFacts | null, pose: wire.Pose | null, turn_radps: number): Returns {
  const room = numReturns(first.scan) + numReturns(second?.scan ?? []);
  const returns: Returns = {
    count: 0, first_count: 0, level_m: new Float32Array(3 * room), range_m: new Float32Array(room), reflectivity: new Uint8Array(room),
    label: new Int32Array(room), column: new Uint16Array(room), ring: new Uint8Array(room), return_index: new Uint8Array(room),
  };
  const end_us = first.scan[0]!.end_utime_us, up = boat?.reference_point_above_water_m ?? 0;
  addReturns(returns, first, boat?.lidar ?? kNoMounting, 0, { end_us, up, pose, turn_radps });
  returns.first_count = returns.count;
  if (second !== null && boat?.lidar_2) addReturns(returns, second, boat.lidar_2, kSecondLidar, { end_us, up, pose, turn_radps });
  return returns;
}

// By the mounting of the lidar and the attitude: roll positive starboard down, pitch positive bow up.
function addReturns(returns: Returns, { scan, labels }: Looked, mounting: Mounting, label_offset: number, moved: { end_us: number; up: number; pose: wire.Pose | null; turn_radps: number }): void {
  const { end_us, pose, turn_radps } = moved;
  const degree = Math.PI / 180;
  const R_vessel_lidar = rotation(mounting.yaw_deg * degree, mounting.pitch_deg * degree, mounting.roll_deg * degree);
  // Attitude: pitch bow up is a negative turn about y (port); roll starboard down a positive one about x.
  const R_level_vessel = rotation(0, pose?.has_attitude ? -pose.pitch_rad : 0, pose?.has_attitude ? pose.roll_rad : 0);
  const R = product(R_level_vessel, R_vessel_lidar);
  const lever = apply(R_level_vessel, [mounting.x_m, mounting.y_m, mounting.z_m]);
  const up = moved.up + (pose !== null && Number.isFinite(pose.heave_m) ? pose.heave_m : 0);
  let speed_x = 0, speed_y = 0;
  if (pose !== null && Number.isFinite(pose.velocity_map_mps[0]!) && Number.isFinite(pose.heading_rad)) {
    const sin = Math.sin(pose.heading_rad), cos = Math.cos(pose.heading_rad);
    speed_x = pose.velocity_map_mps[0]! * sin + pose.velocity_map_mps[1]! * cos;
    speed_y = -pose.velocity_map_mps[0]! * cos + pose.velocity_map_mps[1]! * sin;
  }
  for (const part of scan) {
    const label = labels.find((candidate) => candidate.first_column === part.first_column && candidate.num_columns === part.num_columns)?.label;
    const cosElevation = part.elevation_rad.map(Math.cos), sinElevation = part.elevation_rad.map(Math.sin);
    const perColumn = part.num_rings * part.num_returns;
    // -1 where the return of a pair is the same echo told twice: kept, they lie on each other.
    for (let column = 0; column < part.num_columns; ++column) {
      const before_s = (end_us - part.utime_us) / 1e6 - part.time_ns[column]! / 1e9;
      const turned = -before_s * turn_radps;  // heading at the time of the shot less that at the end, clockwise
      const cosTurn = Math.cos(turned), sinTurn = Math.sin(turned);
      for (let cell = 0; cell < perColumn; ++cell) {
        const index = column * perColumn + cell;
        const counts = part.range[index]! & 0xffff;
        if (counts === 0) continue;
        const ring = Math.floor(cell / part.num_returns);
        const range = counts * part.range_unit_m;
        const azimuth = part.azimuth_rad[column]! + part.azimuth_offset_rad[ring]!;
        const flat = range * cosElevation[ring]!;
        const x = flat * Math.cos(azimuth), y = -flat * Math.sin(azimuth), z = range * sinElevation[ring]! + part.origin_height_m[ring]!;
        const lx = R[0]! * x + R[1]! * y + R[2]! * z + lever[0]!, ly = R[3]! * x + R[4]! * y + R[5]! * z + lever[1]!;
        const lz = R[6]! * x + R[7]! * y + R[8]! * z + lever[2]!;
        const i = returns.count++;
        // A heading that was more to the right then turns the vector clockwise: y is to port.
        returns.level_m[3 * i] = cosTurn * lx + sinTurn * ly - before_s * speed_x;
        returns.level_m[3 * i + 1] = -sinTurn * lx + cosTurn * ly - before_s * speed_y;
        returns.level_m[3 * i + 2] = lz + up;
        returns.range_m[i] = range;
        returns.reflectivity[i] = part.reflectivity[index]!;
        const own = label?.[index] ?? 0;
        returns.label[i] = own > 0 ? own + label_offset : own;
        returns.column[i] = part.first_column + column;
        returns.ring[i] = ring;
        returns.return_index[i] = cell % part.num_returns;
      }
    }
  }
}

/** Rotation matrix Rz(yaw) Ry(pitch) Rx(roll), row by row; radians, right-handed. */
export function rotation(yaw: number, pitch: number, roll: number): Float64Array {
  const cy = Math.cos(yaw), sy = Math.sin(yaw), cp = Math.cos(pitch), sp = Math.sin(pitch), cr = Math.cos(roll), sr = Math.sin(roll);
  return Float64Array.of(cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, -sp, cp * sr, cp * cr);
}
function product(a: Float64Array, b: Float64Array): Float64Array {
  const c = new Float64Array(9);
  for (let row = 0; row < 3; ++row) {
    for (let column = 0; column < 3; ++column) for (let k = 0; k < 3; ++k) c[3 * row + column]! += a[3 * row + k]! * b[3 * k + column]!;
  }
  return c;
}
function apply(a: Float64Array, v: [number, number, number]): [number, number, number] {
  return [0, 3, 6].map((row) => a[row]! * v[0] + a[row + 1]! * v[1] + a[row + 2]! * v[2]) as [number, number, number];
}
