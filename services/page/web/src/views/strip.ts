// What happened when: the strips of the recordings of one line of time, asked for as the time line shows them. Nothing here knows the DOM.
import { lineOf } from "../film.js";
import { RequestRefused, type Source, type Strip, type StripEvent } from "../link.js";
import type { State } from "../state.js";

export interface Span { from_utime_us: number; to_utime_us: number }
export type JumpKind = "alert" | "loss" | "health" | "start";
export const kJumpKinds: readonly JumpKind[] = ["alert", "loss", "health", "start"];

const kBuckets_px = 3;             // width of a bucket on the screen
const kMostBuckets = 1000;
const kAgain_ms = 2000;            // a recording that grows is asked for again
const kSame_us = 1000;
const kGap_us = 2_000_000;

/** From the begin of the first to the end of the last recording; null: there are none. */
export function wholeSpan(line: readonly Source[]): Span | null {
  const first = line[0], last = line.at(-1);
  if (first === undefined || last === undefined || last.end_utime_us <= 0) return null;  // 0: nothing is known yet
  return { from_utime_us: first.begin_utime_us, to_utime_us: Math.max(last.end_utime_us, first.begin_utime_us + 1_000_000) };
}

/** A span made longer or shorter about a time that keeps its place, within the whole and not below 1 s. */
export function zoomed(span: Span, whole: Span, about_utime_us: number, factor: number): Span {
  const length = span.to_utime_us - span.from_utime_us, most = whole.to_utime_us - whole.from_utime_us;
  const next = Math.min(most, Math.max(Math.min(1_000_000, most), length * factor));
  const share = (about_utime_us - span.from_utime_us) / length;
  return moved({ from_utime_us: about_utime_us - share * next, to_utime_us: about_utime_us + (1 - share) * next }, whole, 0);
}
/** A span moved in time, within the whole. */
export function moved(span: Span, whole: Span, by_us: number): Span {
  const length = Math.min(span.to_utime_us - span.from_utime_us, whole.to_utime_us - whole.from_utime_us);
  const from = Math.min(Math.max(span.from_utime_us + by_us, whole.from_utime_us), whole.to_utime_us - length);
  return { from_utime_us: from, to_utime_us: from + length };
}

/** Where a strip holds nothing of tracks and processes for 2 s and longer, in the order of time: files of one recording that do not follow each other. */
export function gapsOf({ begin_utime_us, bucket_us, num_tracks, health, num_lost, alert_level }: Strip): Span[] {
  const gaps: Span[] = [];
  const isEmpty = (i: number) => num_tracks[i]! < 0 && health[i]! < 0 && num_lost[i] === 0 && alert_level[i] === 0;
  for (let i = 0; i < num_tracks.length;) {
    let end = i;
    while (end < num_tracks.length && isEmpty(end)) ++end;
    // A log without TRACKS and HEALTH says nothing of where it has gaps.
    if ((end - i) * bucket_us >= kGap_us && end - i < num_tracks.length) gaps.push({ from_utime_us: begin_utime_us + i * bucket_us, to_utime_us: begin_utime_us + end * bucket_us });
    i = end + 1;
  }
  return gaps;
}

/** The event of a kind that is next after (or before) a time by more than 50 ms; those of gaps and ends go with the starts. */
export function nextEvent(events: readonly StripEvent[], kind: JumpKind, utime_us: number, direction: 1 | -1): StripEvent | undefined {
  const isOfKind = (event: StripEvent) => event.kind === kind || (kind === "start" && (event.kind === "end" || event.kind === "gap"));
  const kApart_us = 50_000;
  return direction > 0 ? events.find((event) => isOfKind(event) && event.utime_us > utime_us + kApart_us)
    : events.findLast((event) => isOfKind(event) && event.utime_us < utime_us - kApart_us);
}

/** Strips by recording: of the whole line for jumps, and of the span that is seen. */
export class Strips {
  /** Of the whole line, in the order of time. */
  events: StripEvent[] = [];
  private readonly whole = new Map<number, Strip>();
  private seen: Strip[] = [];
  private seenSpan: Span | null = null;
  private askedAt_ms = -Infinity;
  private isAsking = false;

  constructor(private readonly state: State, private readonly onChange: () => void) {}

  /** The strips that show a span best; nothing came yet: none. */
  of(span: Span): readonly Strip[] {
    const isSame = this.seenSpan !== null && Math.abs(this.seenSpan.from_utime_us - span.from_utime_us) < kSame_us
      && Math.abs(this.seenSpan.to_utime_us - span.to_utime_us) < kSame_us;
    return isSame && this.seen.length > 0 ? this.seen : [...this.whole.values(), ...this.seen];
  }
  /** Forgets all: other recordings came. */
  clear(): void {
    this.whole.clear();
    this.seen = [];
    this.seenSpan = null;
    this.events = [];
    this.askedAt_ms = -Infinity;
  }

  /** Asks for what the span lacks, one span at a time. To be called when it changed, and now and then. */
  update(span: Span, width_px: number, now_ms: number): void {
    const line = lineOf(this.state.sources).filter((source) => !this.state.indexing.has(source.id) && source.num_scans > 0);
    const whole = wholeSpan(line);
    if (whole === null || this.isAsking || this.state.link === null || this.state.connection.state !== "open") return;
    const isGrowing = line.some((source) => source.is_growing);
    const isOld = now_ms - this.askedAt_ms > kAgain_ms;
    const lacksWhole = line.some((source) => !this.whole.has(source.id));
    const isOther = this.seenSpan === null || this.seenSpan.from_utime_us !== span.from_utime_us || this.seenSpan.to_utime_us !== span.to_utime_us;
    // A span that moves on with a recording that grows is not asked for with each scan.
    if (!(lacksWhole || (isGrowing ? isOld : isOther) || (isOther && now_ms - this.askedAt_ms > 300))) return;
    this.askedAt_ms = now_ms;
    this.isAsking = true;
    this.ask(line, span, Math.min(kMostBuckets, Math.max(50, Math.round(width_px / kBuckets_px))), lacksWhole || (isGrowing && isOld))
      .catch((error: unknown) => { if (!(error instanceof RequestRefused)) throw error; })
      .finally(() => { this.isAsking = false; });
  }

  private async ask(line: Source[], span: Span, buckets: number, asksWhole: boolean): Promise<void> {
    const link = this.state.link!;
    if (asksWhole) {
      for (const source of line) {
        this.whole.set(source.id, await link.strip(source.id, source.begin_utime_us, Math.max(source.end_utime_us, source.begin_utime_us + 1000), buckets));
      }
      this.events = [...this.whole.values()].flatMap((strip) => strip.events).sort((a, b) => a.utime_us - b.utime_us);
    }
    const seen: Strip[] = [];
    for (const source of line) {
      const from = Math.max(span.from_utime_us, source.begin_utime_us), to = Math.min(span.to_utime_us, source.end_utime_us);
      if (to - from < 1000) continue;
      const share = (to - from) / (span.to_utime_us - span.from_utime_us);
      seen.push(await link.strip(source.id, Math.round(from), Math.round(to), Math.max(20, Math.round(buckets * share))));
    }
    this.seen = seen;
    this.seenSpan = span;
    this.onChange();
  }
}
