// The player of recordings: which moment is shown, and when the next one is. Time is the log's; while it plays, the browser's clock leads.
import type { Live } from "./live.js";
import { type Answer, type AnswerHead, type Frame, RequestRefused, type Source } from "./link.js";
import { Alert, Alerts } from "./messages/generated.js";
import { Refused } from "./messages/reader.js";
import { Assembler, kPictureChannels, type Picture } from "./picture.js";
import type { State } from "./state.js";
import { texts } from "./texts/index.js";

export const kRates = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50];
const kLongestWait_ms = 1000;      // for the next scan while it plays: longer gaps of a log are skipped
const kBehind_scans = 2;           // so far behind its clock the player leaves scans out
const kPrimed_us = 1_100_000;      // before a moment: the remembered land comes with every tenth scan
const kCaughtUp_us = 1_000_000;    // so near to the end of what is still recorded, playing on is looking at now

/** Recordings of one line of time: those that do not overlap, the first of them taken. In the order of time. */
export function lineOf(sources: readonly Source[]): Source[] {
  const line: Source[] = [];
  for (const source of sources) {
    if (line.every((other) => source.begin_utime_us >= other.end_utime_us || source.end_utime_us <= other.begin_utime_us)) line.push(source);
  }
  return line.sort((a, b) => a.begin_utime_us - b.begin_utime_us);
}
/** The recording of a line that holds a time, or else the last before it, or else the first. */
export function sourceAt(line: readonly Source[], utime_us: number): Source | undefined {
  return line.findLast((source) => source.begin_utime_us <= utime_us) ?? line[0];
}

/** Where the seconds of a log are counted from; NaN live, where there is no begin. */
export function beginOf({ hello, sources }: Pick<State, "hello" | "sources">): number {
  return hello?.mode === "log" ? lineOf(sources)[0]?.begin_utime_us ?? NaN : NaN;
}

/** Why there is no picture, in words: live nothing came; of a log it is being read, or it holds no scan. Empty: nobody knows yet. */
export function whyNothing({ hello, sources }: Pick<State, "hello" | "sources">): string {
  if (hello === null) return "";
  if (hello.mode === "live") return texts.nothingYet;
  return sources.length > 0 && sources.every((source) => source.is_indexed && source.num_scans === 0) ? texts.noScans : texts.reading;
}

/** How long before a time of the log the scan of a picture was received, s: in a gap of the log it is the last one before. 0 where it has none. */
export function ageInLog(picture: Pick<Picture, "times_us">, utime_us: number): number {
  const received_us = picture.times_us.get("LIDAR_SCAN") ?? picture.times_us.get("TRACKS");
  return received_us === undefined ? 0 : Math.max(0, (utime_us - received_us) / 1e6);
}

type Wanted = { kind: "at"; utime_us: number } | { kind: "step"; scans: number };
interface Moment { head: AnswerHead; frames: Frame[]; beside: Answer | null }

export class Film {
  rate = 1;
  isPlaying = false;
  /** A second recording that is shown at the same scan; null: none. */
  besideSource: number | null = null;
  /** Why the last request was refused; empty: it was not. */
  refusal = "";
  /** Alerts of now, while a recorded moment is shown. */
  liveAlerts: Alert[] = [];
  /** ALERTS of now, whole. */
  liveReport: Alerts | null = null;
  private liveSounding = 0;

  private assembler = new Assembler();
  private shownFrames: Frame[] = [];
  private head: AnswerHead | null = null;
  private wanted: Wanted | null = null;
  private isAsking = false;
  private next: Moment | null = null;   // asked for while it plays; shown when it is due
  private base = { utime_us: 0, ms: 0 };  // this time of the log is shown at this time of performance.now()
  private generation = 0;

  constructor(private readonly state: State, private readonly live: Live, private readonly now_ms: () => number = () => performance.now()) {
    state.seek = (utime_us) => { this.seek(utime_us); };
    // What was refused while an index was built is asked again when it may be there.
    state.on(["sources"], () => {
      if (state.hello?.mode === "log" && !this.isAsking && (state.showing.kind === "live" || this.refusal !== "")) this.begin();
    });
    const draw = () => {
      this.turn();
      requestAnimationFrame(draw);
    };
    requestAnimationFrame(draw);
  }

  /** To be called on each `hello`: a log opens where there is something to see; a moment that was shown before is fetched again. */
  begin(): void {
    this.isAsking = false;
    ++this.generation;
    this.next = null;
    const { showing, hello } = this.state;
    if (showing.kind === "recorded") this.seek(showing.utime_us, this.isPlaying);
    else if (hello?.mode === "log") {
      // Before its index is built a recording has no times; they come with `sources`.
      const first = lineOf(this.state.sources)[0];
      if (first !== undefined && first.num_scans > 0 && this.wanted === null) this.seek(first.opens_utime_us ?? first.begin_utime_us);
    }
  }

  /** A message of now: while a recorded moment is shown, only alerts are asked for. */
  take(frame: Frame): void {
    if (this.state.showing.kind === "live" || frame.channel !== "ALERTS") return;
    try {
      this.liveReport = Alerts.decode(frame.bytes);
      const alerts = this.liveReport.alerts.filter((alert) => alert.state !== Alert.STATE_CLEARED);
      const text = (list: Alert[]) => list.map((alert) => `${alert.id} ${alert.level} ${alert.state}`).join();
      const { sounding_alert_id } = this.liveReport;
      const isOther = text(alerts) !== text(this.liveAlerts) || sounding_alert_id !== this.liveSounding;
      this.liveSounding = sounding_alert_id;
      this.liveAlerts = alerts;
      if (isOther) this.state.tell("showing");
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
    }
  }

  /** Shows the moment at a time of the log; leaves what is live. */
  seek(utime_us: number, keepsPlaying = false): void {
    if (this.state.sources.length === 0) return;
    if (!keepsPlaying) this.isPlaying = false;
    const whole_us = Math.round(utime_us);
    this.setBase(whole_us);
    this.want({ kind: "at", utime_us: whole_us });
  }
  /** So many scans on; negative: back. It pauses. */
  step(scans: number): void {
    if (this.state.showing.kind === "live") {
      const end = lineOf(this.state.sources).at(-1)?.end_utime_us;
      if (end !== undefined) this.seek(end);
      return;
    }
    this.isPlaying = false;
    const before = this.wanted?.kind === "step" ? this.wanted.scans : 0;
    this.want({ kind: "step", scans: before + scans });
  }
  play(): void {
    const { showing } = this.state;
    if (showing.kind === "live") return;
    const line = lineOf(this.state.sources);
    const end = line.at(-1)?.end_utime_us ?? 0;
    this.isPlaying = true;
    if (this.state.hello?.mode === "log" && this.head !== null && this.isLast(this.head) && showing.utime_us >= end - kCaughtUp_us) this.seek(line[0]!.begin_utime_us, true);
    else this.setBase(showing.utime_us);
    this.state.tell("showing");
  }
  pause(): void {
    this.isPlaying = false;
    this.next = null;
    this.state.tell("showing");
  }
  setRate(rate: number): void {
    this.rate = rate;
    if (this.state.showing.kind === "recorded") this.setBase(this.state.showing.utime_us);
    this.state.tell("showing");
  }
  /** Back to what comes now; a log has no now. */
  goLive(): void {
    if (this.state.hello?.mode !== "live" || this.state.showing.kind === "live") return;
    this.isPlaying = false;
    this.wanted = this.next = this.head = null;
    ++this.generation;
    this.isAsking = false;
    this.liveAlerts = [];
    this.liveReport = null;
    this.shownFrames = [];
    this.state.showing = { kind: "live" };
    this.state.beside = null;
    this.state.picture = null;  // of a moment that is over: not to be taken for now
    this.live.begin(this.state.hello);
    this.state.tell("showing");
    this.state.tell("picture");
  }
  /** Whether a second recording is wanted beside the first; the moment that is shown is fetched again with it. */
  setBeside(source: number | null): void {
    if (this.besideSource === source) return;
    this.besideSource = source;
    if (source === null) { this.state.beside = null; return; }
    if (this.state.showing.kind === "recorded") this.want({ kind: "at", utime_us: this.state.showing.utime_us });
  }

  private setBase(utime_us: number): void { this.base = { utime_us, ms: this.now_ms() }; }
  private want(wanted: Wanted): void {
    this.wanted = wanted;
    this.next = null;
    this.ask();
  }
  private isLast(head: AnswerHead): boolean { return head.scan_index + 1 >= head.num_scans; }

  // One request at a time; the newest wish is the next.
  private ask(): void {
    const { link, showing } = this.state;
    if (this.isAsking || this.wanted === null || link === null) return;
    const wanted = this.wanted;
    this.wanted = null;
    const line = lineOf(this.state.sources);
    const utime_us = wanted.kind === "at" ? wanted.utime_us : showing.kind === "recorded" ? showing.utime_us : 0;
    const source = wanted.kind === "at" ? sourceAt(line, utime_us) : this.sourceOfStep(line, wanted.scans);
    if (source === undefined) return;
    const isOther = wanted.kind === "step" && showing.kind === "recorded" && source.id !== showing.source;
    const answer = wanted.kind === "at" || isOther
      ? link.at(source.id, { utime_us: isOther ? (wanted.scans > 0 ? source.begin_utime_us : source.end_utime_us) : Math.max(utime_us, source.begin_utime_us) }, kPictureChannels)
      : link.step(source.id, utime_us, wanted.scans, kPictureChannels);
    this.receive(answer, (moment) => { this.show(moment); });
  }

  // A step beyond the end of a recording of the line leads into the next.
  private sourceOfStep(line: Source[], scans: number): Source | undefined {
    const at = line.findIndex((source) => source.id === this.head?.source);
    if (at < 0 || this.head === null) return line[0];
    const isBeyond = scans > 0 ? this.isLast(this.head) : this.head.scan_index <= 0;
    return (isBeyond ? line[at + Math.sign(scans)] : undefined) ?? line[at];
  }

  private receive(answer: Promise<Answer>, use: (moment: Moment) => void): void {
    this.isAsking = true;
    const generation = this.generation;
    const withBeside = answer.then(async ({ head, frames }): Promise<Moment> => {
      const beside = this.besideSource === null || head.scan_index < 0 ? null
        : await this.state.link!.at(this.besideSource, { scan_utime_us: head.scan_utime_us }, kPictureChannels).catch(() => null);
      return { head, frames, beside };
    });
    withBeside.then((moment) => {
      if (generation !== this.generation) return;
      this.isAsking = false;
      this.refusal = "";
      use(moment);
      this.ask();
    }, (error: unknown) => {
      if (!(error instanceof RequestRefused)) throw error;
      if (generation !== this.generation) return;
      this.isAsking = false;
      // Replaced by a newer one of another part of the page, or the connection was lost: begin() asks again.
      if (error.message !== "replaced") {
        this.refusal = error.message;
        this.isPlaying = false;
        this.state.tell("showing");
      }
      this.ask();
    });
  }

  private show({ head, frames, beside }: Moment): void {
    const { state } = this;
    const isNext = this.head?.source === head.source && head.utime_us > this.head.utime_us && head.utime_us - this.head.utime_us < kPrimed_us;
    if (!isNext) this.assembler = new Assembler();
    if (state.showing.kind === "live") state.link?.watch(["ALERTS"]);
    this.head = head;
    this.shownFrames = frames;
    state.showing = { kind: "recorded", source: head.source, utime_us: head.utime_us, scan_index: head.scan_index, num_scans: head.num_scans };
    state.beside = beside === null ? null : this.toPicture(new Assembler(), beside.head.source, beside.frames);
    state.picture = this.toPicture(this.assembler, head.source, frames);
    state.age_s = ageInLog(state.picture, head.utime_us);
    state.tell("showing");
    state.tell("picture");
    if (this.isPlaying || this.wanted !== null) return;
    if (head.scan_index < 0 && head.num_scans > 0) this.want({ kind: "step", scans: 1 });  // before the first scan there is nothing to see
    else if (!isNext) void this.prime(head);
  }

  // What a moment alone does not hold: the remembered land, and how the boat turned just before.
  private async prime(head: AnswerHead): Promise<void> {
    const { link } = this.state;
    if (link === null || head.scan_index < 0) return;
    const from = head.utime_us - kPrimed_us;
    try {
      const before = (await Promise.all([link.range(head.source, "TRACKS", from, head.utime_us - 1, 200), link.range(head.source, "POSE", head.utime_us - 400_000, head.utime_us, 100)]))
        .flatMap((answer) => answer.frames);
      if (this.head !== head) return;
      this.assembler = new Assembler();
      this.state.picture = this.toPicture(this.assembler, head.source, [...before, ...this.shownFrames]);
      this.state.tell("picture");
    } catch (error) {
      if (!(error instanceof RequestRefused)) throw error;
    }
  }

  private toPicture(assembler: Assembler, source: number, frames: Frame[]): Picture {
    assembler.boat = this.state.sources.find((candidate) => candidate.id === source)?.boat ?? null;
    for (const frame of frames) assembler.take(frame);
    return assembler.picture();
  }

  // Once a frame of the screen, while it plays: what is due is shown, what comes next is asked for.
  private turn(): void {
    const { showing, link } = this.state;
    if (!this.isPlaying || showing.kind !== "recorded" || this.head === null || link === null || this.state.connection.state !== "open") return;
    const due_us = this.base.utime_us + (this.now_ms() - this.base.ms) * 1000 * this.rate;
    if (this.next !== null) {
      const wait_ms = (this.next.head.utime_us - due_us) / 1000 / this.rate;
      if (wait_ms > 0 && wait_ms <= kLongestWait_ms) return;
      const { next } = this;
      if (wait_ms > kLongestWait_ms && next.head.utime_us - showing.utime_us > 3e6) this.setBase(next.head.utime_us);  // a gap
      else if (wait_ms > 0) return;
      this.next = null;
      this.show(next);
    }
    if (this.isAsking || this.wanted !== null) return;
    this.askNext(due_us);
  }

  private askNext(due_us: number): void {
    const { state } = this, head = this.head!;
    const line = lineOf(state.sources), link = state.link!;
    const at = line.findIndex((source) => source.id === head.source), source = line[at];
    if (source === undefined) { this.pause(); return; }
    const period_us = (source.end_utime_us - source.begin_utime_us) / Math.max(1, source.num_scans);
    const following = line[at + 1];
    if (this.isLast(head) || due_us > source.end_utime_us) {
      if (following !== undefined) {
        this.setBase(following.begin_utime_us);
        this.receive(link.at(following.id, { utime_us: following.begin_utime_us }, kPictureChannels), (moment) => { this.show(moment); });
        return;
      }
      if (state.hello?.mode === "live") {
        if (source.is_growing) { this.goLive(); return; }
      }
      if (this.isLast(head)) { this.pause(); return; }
    }
    // Near enough: the next scan. Too far behind: the one that is due by the time it comes.
    const isBehind = due_us - head.utime_us > kBehind_scans * period_us;
    const answer = isBehind ? link.at(head.source, { utime_us: Math.round(Math.min(due_us, source.end_utime_us)) }, kPictureChannels)
      : link.step(head.source, head.utime_us, 1, kPictureChannels);
    this.receive(answer, (moment) => {
      if (!this.isPlaying || this.wanted !== null) return;
      if (moment.head.source === head.source && moment.head.scan_index === head.scan_index) {
        if (isBehind) this.setBase(moment.head.utime_us + period_us);  // nothing in between: a gap of the log
        if (!isBehind) this.pause();
        return;
      }
      this.next = moment;
    });
  }
}
