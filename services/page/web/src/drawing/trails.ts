// Where tracks were in the last minute, and where the own boat was. Kept while pictures follow each other; asked for where a recording is jumped in.
import { Tracks } from "../messages/generated.js";
import type { Track } from "../messages/generated.js";
import type { Picture } from "../picture.js";
import type { State } from "../state.js";

const kTrail_us = 60e6;
const kStep_us = 1e6;
const kJump_us = 5e6;
const kFade_us = 3e6;
const kOwnPlaces = 1200;

interface Trail { times_us: number[]; places_m: number[] }

export class Trails {
  /** Of each track, map frame: east, north, east, north ..., the oldest first. */
  readonly places = new Map<number, Trail>();
  /** Tracks that ended in the last seconds, and when. */
  readonly lost = new Map<number, { track: Track; utime_us: number }>();
  /** The own way: latitude and longitude, deg, in turn, the oldest first. */
  readonly own_deg: number[] = [];
  /** To draw again: a trail out of a recording came. */
  onCame: () => void = () => undefined;
  private last_us = -Infinity;
  private lastOwn_us = -Infinity;
  private source: number | null = null;
  private isAsking = false;

  constructor(private readonly state: State) {}

  take(picture: Picture): void {
    const now_us = picture.end_utime_us;
    const source = this.state.showing.kind === "recorded" ? this.state.showing.source : null;
    if (now_us < this.last_us || now_us > this.last_us + kJump_us || source !== this.source) {
      this.places.clear();
      this.lost.clear();
      this.own_deg.length = 0;
      this.lastOwn_us = -Infinity;
      this.source = source;
      this.last_us = now_us;
      if (source !== null) void this.ask(source);
    }
    this.last_us = now_us;
    this.add(picture.tracks, now_us);
    for (const id of this.places.keys()) if (!picture.track_by_id.has(id)) this.places.delete(id);
    for (const track of picture.tracks) if (track.status === 4) this.lost.set(track.id, { track, utime_us: now_us });
    for (const [id, { utime_us }] of this.lost) if (now_us - utime_us > kFade_us) this.lost.delete(id);
    const { pose } = picture;
    if (pose !== null && Number.isFinite(pose.latitude_deg) && now_us - this.lastOwn_us >= kStep_us) {
      this.lastOwn_us = now_us;
      this.own_deg.push(pose.latitude_deg, pose.longitude_deg);
      if (this.own_deg.length > 2 * kOwnPlaces) this.own_deg.splice(0, 2);
    }
  }
  /** Of a track that was lost: 1 now, 0 when it has faded. */
  strength(utime_us: number): number { return Math.max(0, 1 - (this.last_us - utime_us) / kFade_us); }

  private add(tracks: readonly Track[], now_us: number): void {
    for (const track of tracks) {
      let trail = this.places.get(track.id);
      if (trail === undefined) this.places.set(track.id, trail = { times_us: [], places_m: [] });
      const last = trail.times_us.at(-1);
      if (last !== undefined && now_us < last + kStep_us) continue;
      trail.times_us.push(now_us);
      trail.places_m.push(track.position_map_m[0]!, track.position_map_m[1]!);
      while (trail.times_us[0]! < now_us - kTrail_us) {
        trail.times_us.shift();
        trail.places_m.splice(0, 2);
      }
    }
  }

  // The minute before the moment that is shown. Where the server has none, or another moment is shown by then, nothing is added.
  private async ask(source: number): Promise<void> {
    if (this.isAsking || this.state.link === null || this.last_us <= 0) return;
    this.isAsking = true;
    const until_us = this.last_us;
    try {
      const { frames } = await this.state.link.range(source, "TRACKS", until_us - kTrail_us, until_us, 31);
      if (this.source !== source || Math.abs(this.last_us - until_us) > kJump_us) return;
      const now = new Map(this.places);
      this.places.clear();
      for (const frame of frames) {
        const message = Tracks.decode(frame.bytes);
        if (message.end_utime_us < until_us) this.add(message.tracks.filter((track) => now.has(track.id)), message.end_utime_us);
      }
      for (const [id, trail] of now) {
        const before = this.places.get(id);
        if (before === undefined) this.places.set(id, trail);
        else { before.times_us.push(...trail.times_us); before.places_m.push(...trail.places_m); }
      }
      this.onCame();
    } catch {
      // Refused, or not to be read: without trails the picture is still true.
    } finally {
      this.isAsking = false;
      if (this.source !== null && Math.abs(this.last_us - until_us) > kJump_us) void this.ask(this.source);
    }
  }
}
