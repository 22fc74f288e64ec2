// Numbers over time: which there are in messages, how they are read, kept and thinned. Nothing here knows the DOM.
import * as wire from "../messages/generated.js";
import type { Picture } from "../picture.js";

/** A number: "HEALTH/tracker/cpu_fraction", "POSE/heading_rad", "TRACK/17/range_m", "TRACK/chosen/range_m", "PAGE/num_tracks". */
export type Path = string;

type Fields = ReadonlyMap<string, number>;

// Numbers of a message by name: members, elements of short arrays, and of health_t its counters and channels by their names.
export function fieldsOf(message: object): Fields {
  const fields = new Map<string, number>();
  walk(message, "", fields);
  return fields;
}

const kLongest = 16;  // of an array whose elements are shown one by one
const kNoNumbers = new Set(["seq", "raw_seq", "begin_seq", "pid"]);

function walk(value: unknown, name: string, fields: Map<string, number>): void {
  if (typeof value === "number") fields.set(name, value);
  else if (typeof value === "boolean") fields.set(name, value ? 1 : 0);
  else if (Array.isArray(value) || ArrayBuffer.isView(value)) {
    const elements = value as ArrayLike<unknown>;
    if (elements.length > kLongest) {
      // Of counters and channels, which carry names, there may be more.
      if (!(Array.isArray(value) && isNamed(value[0]))) return;
    }
    for (let i = 0; i < elements.length; ++i) {
      const element = elements[i];
      walk(element, isNamed(element) ? `${name}.${nameOf(element)}` : `${name}[${i}]`, fields);
    }
  } else if (typeof value === "object" && value !== null) {
    if (isCounter(value)) { fields.set(name, value.count); return; }
    for (const [member, inner] of Object.entries(value)) {
      if (kNoNumbers.has(member) || member.endsWith("utime_us") || member.startsWith("num_outline") || member.startsWith("outline_")) continue;
      if (typeof inner !== "string") walk(inner, name === "" ? member : `${name}.${member}`, fields);
    }
  }
}
interface Named { name?: string; channel?: string; is_input?: boolean }
function isNamed(value: unknown): value is Named {
  return typeof value === "object" && value !== null && (typeof (value as Named).name === "string" || typeof (value as Named).channel === "string");
}
function isCounter(value: object): value is { name: string; count: number } { return "count" in value && "name" in value; }
function nameOf(value: Named): string {
  return value.name ?? `${value.channel ?? ""}${value.is_input === true ? ".in" : ".out"}`;
}

/** Those that a picture has, by path. */
export function pathsOf(picture: Picture, chosen: number | null): Path[] {
  const paths: Path[] = ["PAGE/num_tracks", "PAGE/num_returns"];
  const add = (prefix: string, message: object | null | undefined) => {
    if (message !== null && message !== undefined) for (const field of fieldsOf(message).keys()) paths.push(`${prefix}/${field}`);
  };
  add("POSE", picture.pose);
  if (chosen !== null) {
    add("TRACK/chosen", picture.track_by_id.get(chosen));
    add(`TRACK/${chosen}`, picture.track_by_id.get(chosen));
  }
  add("LIDAR_CLOCK", picture.clock);
  add("GNSS_FIX", picture.fix);
  for (const health of picture.health) add(`HEALTH/${health.process}`, health);
  return paths;
}

/** Channel on which the messages of a path come. */
export function channelOf(path: Path): string {
  const head = path.split("/")[0]!;
  return head === "TRACK" || head === "PAGE" ? "TRACKS" : head;
}

/** @returns the number; NaN where this picture has none */
export function valueIn(picture: Picture, path: Path, chosen: number | null): number {
  const [head, ...rest] = path.split("/");
  switch (head) {
    case "PAGE": return rest[0] === "num_tracks" ? picture.tracks.length : picture.returns?.count ?? NaN;
    case "POSE": return picture.pose === null ? NaN : read(picture.pose, rest[0]!);
    case "LIDAR_CLOCK": return picture.clock === null ? NaN : read(picture.clock, rest[0]!);
    case "GNSS_FIX": return picture.fix === null ? NaN : read(picture.fix, rest[0]!);
    case "HEALTH": {
      const health = picture.health.find((candidate) => candidate.process === rest[0]);
      return health === undefined ? NaN : read(health, rest.slice(1).join("/"));
    }
    case "TRACK": {
      const track = picture.track_by_id.get(rest[0] === "chosen" ? chosen ?? -1 : Number(rest[0]));
      return track === undefined ? NaN : read(track, rest[1]!);
    }
    default: return NaN;
  }
}

/** Out of the bytes of a message as it came. NaN: it holds no such number. @throws Refused when the bytes are not a message */
export function valueInBytes(path: Path, bytes: Uint8Array, chosen: number | null): { utime_us: number; value: number } {
  const [head, ...rest] = path.split("/");
  switch (head) {
    case "POSE": return of(wire.Pose.decode(bytes), rest[0]!);
    case "LIDAR_CLOCK": return of(wire.LidarClock.decode(bytes), rest[0]!);
    case "GNSS_FIX": return of(wire.GnssFix.decode(bytes), rest[0]!);
    case "HEALTH": {
      const health = wire.Health.decode(bytes);
      return health.process === rest[0] ? of(health, rest.slice(1).join("/")) : { utime_us: health.utime_us, value: NaN };
    }
    default: {
      const tracks = wire.Tracks.decode(bytes);
      if (head === "PAGE") return { utime_us: tracks.end_utime_us, value: rest[0] === "num_tracks" ? tracks.num_scan_tracks : NaN };
      const id = rest[0] === "chosen" ? chosen ?? -1 : Number(rest[0]);
      const track = tracks.tracks.find((candidate) => candidate.id === id);
      return { utime_us: tracks.end_utime_us, value: track === undefined ? NaN : read(track, rest[1]!) };
    }
  }
}
function of(message: { utime_us: number }, field: string): { utime_us: number; value: number } {
  return { utime_us: message.utime_us, value: read(message, field) };
}

/** When the message of a path came, by the clock of whoever received it: that of the time line, and one clock for all channels. */
export function timeIn(picture: Picture, path: Path): number { return picture.times_us.get(channelOf(path)) ?? NaN; }

// One member without walking through all of them: this is done with each picture.
function read(message: object, field: string): number {
  let value: unknown = message;
  let rest = field;
  while (rest !== "" && value !== undefined && value !== null) {
    const [, member, after] = /^\.?([^.[]+)(.*)$/.exec(rest) ?? [];
    const index = /^\[(\d+)\](.*)$/.exec(rest);
    if (index !== null) {
      value = (value as ArrayLike<unknown>)[Number(index[1])];
      rest = index[2]!;
    } else if (Array.isArray(value)) {
      // Names may hold dots themselves: the longest that fits.
      const elements = value as unknown[];
      const wanted = rest.slice(1);
      const element = elements.find((candidate) => isNamed(candidate) && (wanted === nameOf(candidate) || wanted.startsWith(`${nameOf(candidate)}.`)));
      if (!isNamed(element)) return NaN;
      rest = wanted.slice(nameOf(element).length);
      value = isCounter(element) ? element.count : element;
    } else {
      if (member === undefined) return NaN;
      value = (value as Record<string, unknown>)[member];
      rest = after!;
    }
  }
  return typeof value === "number" ? value : typeof value === "boolean" ? Number(value) : NaN;
}

/** How a number is shown: factor from the wire's unit, and unit. */
export function unitOf(path: Path): { factor: number; unit: string } {
  const name = path.replace(/\[\d+\]/g, "");
  if (/_rad$/.test(name)) return { factor: 180 / Math.PI, unit: "°" };
  if (/_radps$/.test(name)) return { factor: 180 / Math.PI, unit: "°/s" };
  if (/_us$/.test(name)) return { factor: 1e-3, unit: "ms" };
  if (/_bytes$/.test(name)) return { factor: 1e-6, unit: "MB" };
  if (/_mps$/.test(name)) return { factor: 1, unit: "m/s" };
  if (/(_fraction|_share|_probability)$/.test(name)) return { factor: 100, unit: "%" };
  const known = /_(m2|m|s|hz|deg|rpm|ppm|ns)$/.exec(name)?.[1];
  return { factor: 1, unit: known === undefined ? "" : { m2: "m²", hz: "Hz", deg: "°", rpm: "/min" }[known] ?? known };
}

/** Whether a number is a direction, 0 after 360 degrees. */
export function isOnCircle(path: Path): boolean { return /(heading|course|bearing|azimuth)(_\w+)?_rad$/.test(path); }

/** Numbers of like name and unit stand in one chart. */
export function chartOf(path: Path): string {
  const name = path.split("/").at(-1)!;
  return `${name.split(".").at(-1)!} ${unitOf(path).unit}`;
}

const kGap_s = 3, kGap_steps = 8, kBeside_s = 1e-3;

/** The last numbers of one path, in the order of their times; bounded. */
export class Ring {
  private readonly times: Float64Array;
  private readonly values: Float64Array;
  private begin = 0;
  count = 0;

  constructor(private readonly room: number) {
    this.times = new Float64Array(room);
    this.values = new Float64Array(room);
  }

  /** What is not later than the last is left out: a picture is drawn again without anything new. */
  push(time_s: number, value: number): void {
    if (!Number.isFinite(time_s) || (this.count > 0 && time_s <= this.time(this.count - 1))) return;
    const at = (this.begin + this.count) % this.room;
    this.times[at] = time_s;
    this.values[at] = value;
    if (this.count < this.room) ++this.count;
    else this.begin = (this.begin + 1) % this.room;
  }
  clear(): void { this.begin = this.count = 0; }
  time(index: number): number { return this.times[(this.begin + index) % this.room]!; }
  value(index: number): number { return this.values[(this.begin + index) % this.room]!; }

  /** Least and greatest of each bucket between two times: a spike of one message stays to be seen. */
  thinned(from_s: number, to_s: number, buckets: number): { times: number[]; values: (number | null)[] } {
    const times: number[] = [], values: (number | null)[] = [];
    let first = 0;
    while (first < this.count && this.time(first) < from_s) ++first;
    let last = first;
    while (last < this.count && this.time(last) <= to_s) ++last;
    // Where nothing came for long the line ends: it does not lead over what is not known.
    const gap_s = Math.max(kGap_s, kGap_steps * (this.count > 1 ? (this.time(this.count - 1) - this.time(0)) / (this.count - 1) : 0));
    let pushed = -1;
    const push = (index: number) => {
      for (let i = pushed + 1; pushed >= 0 && i <= index; ++i) {
        if (this.time(i) - this.time(i - 1) <= gap_s) continue;
        times.push(this.time(i - 1) + kBeside_s, this.time(i) - kBeside_s);
        values.push(null, null);
      }
      pushed = index;
      times.push(this.time(index));
      values.push(Number.isFinite(this.value(index)) ? this.value(index) : null);
    };
    if (last - first <= 2 * buckets) {
      for (let i = first; i < last; ++i) push(i);
      return { times, values };
    }
    const width_s = (to_s - from_s) / buckets;
    for (let i = first; i < last;) {
      const bucket = Math.floor((this.time(i) - from_s) / width_s);
      let least = -1, greatest = -1, gap = -1;
      for (; i < last && Math.floor((this.time(i) - from_s) / width_s) === bucket; ++i) {
        const value = this.value(i);
        if (!Number.isFinite(value)) gap = i;
        else {
          if (least < 0 || value < this.value(least)) least = i;
          if (greatest < 0 || value > this.value(greatest)) greatest = i;
        }
      }
      if (least < 0) push(gap);
      else for (const index of least === greatest ? [least] : least < greatest ? [least, greatest] : [greatest, least]) push(index);
    }
    return { times, values };
  }
}
