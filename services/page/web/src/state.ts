// What the whole page knows: the picture, what is pointed at, settings, whether what is seen is still true. Views watch it.
import type { Hello, Link, Source } from "./link.js";
import { type Picture } from "./picture.js";
import { Settings } from "./settings.js";

/** A thing that is pointed at or chosen, marked in every view. */
export interface Marked { track: number | null; segment: number | null }

/** live: what comes now. recorded: a moment of a recording. */
export type Showing =
  | { kind: "live" }
  | { kind: "recorded"; source: number; utime_us: number; scan_index: number; num_scans: number };

export interface Connection {
  /** nothing came yet; connected; lost, since when (performance.now()). */
  state: "opening" | "open" | "lost";
  since_ms: number;
}

type Topic = "picture" | "marked" | "settings" | "connection" | "sources" | "age" | "showing";

export class State {
  hello: Hello | null = null;
  sources: Source[] = [];
  /** Share of the index that is built, by source; absent: whole. */
  readonly indexing = new Map<number, number>();
  connection: Connection = { state: "opening", since_ms: performance.now() };
  showing: Showing = { kind: "live" };
  picture: Picture | null = null;
  /** Of a second recording beside the first, at the same scan. */
  beside: Picture | null = null;
  /** Of the picture: how long ago it was measured and came, s; of a recorded one how long before the time that is shown it came. */
  age_s = 0;
  marked: Marked = { track: null, segment: null };
  /** Chosen by a click or in a list; stays until another is. */
  chosen: number | null = null;
  readonly settings: Settings;
  /** Of this page; empty: it may not acknowledge. */
  token = "";

  private readonly watchers = new Map<Topic, Set<() => void>>();

  /** @param settings those of another state, to be shared with it; none: own ones */
  constructor(public link: Link | null = null, settings: Settings | null = null) {
    this.settings = settings ?? new Settings(() => { this.tell("settings"); });
  }

  /** Shows the moment of the recordings at a time of the log; the player sets it. */
  seek: (utime_us: number) => void = () => undefined;

  on(topics: Topic[], watcher: () => void): void {
    for (const topic of topics) {
      const watchers = this.watchers.get(topic) ?? new Set();
      watchers.add(watcher);
      this.watchers.set(topic, watchers);
    }
  }
  tell(topic: Topic): void {
    for (const watcher of this.watchers.get(topic) ?? []) watcher();
  }

  mark(marked: Partial<Marked>): void {
    const next = { track: marked.track ?? null, segment: marked.segment ?? null };
    if (next.track === this.marked.track && next.segment === this.marked.segment) return;
    this.marked = next;
    this.tell("marked");
  }
  choose(track: number | null): void {
    this.chosen = track;
    this.tell("marked");
  }
}

/** A part of the page. Its element is made by itself and placed by the layout. */
export interface View {
  readonly element: HTMLElement;
  /** Whether it is on the screen: what is not draws nothing and costs nothing. */
  setVisible(isVisible: boolean): void;
}
