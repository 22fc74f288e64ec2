// What HEALTH tells of processes and channels, put together. Nothing here knows the DOM.
import * as wire from "../messages/generated.js";
import type { Gravity } from "./shapes.js";

/** One channel, of what its publisher and its readers tell. -1: nobody says. */
export interface ChannelRow {
  channel: string;
  publishers: string[];
  readers: string[];
  rate_hz: number;
  num_lost: number;
  num_refused: number;
  latency_p50_us: number;
  latency_p99_us: number;
  /** Of the reader whose queue is fullest. */
  queue_depth: number;
  queue_limit: number;
}

export function channelsOf(health: readonly wire.Health[]): ChannelRow[] {
  const rows = new Map<string, ChannelRow>();
  for (const process of health) {
    for (const traffic of process.channels) {
      let row = rows.get(traffic.channel);
      if (row === undefined) {
        row = {
          channel: traffic.channel, publishers: [], readers: [], rate_hz: 0, num_lost: 0, num_refused: 0, latency_p50_us: -1, latency_p99_us: -1,
          queue_depth: -1, queue_limit: 0,
        };
        rows.set(traffic.channel, row);
      }
      row.num_refused += traffic.num_undecodable;
      if (traffic.is_input) {
        row.readers.push(process.process);
        row.num_lost += traffic.num_lost;
        if (traffic.queue_depth > row.queue_depth) {
          row.queue_depth = traffic.queue_depth;
          row.queue_limit = traffic.queue_limit;
        }
        // A channel whose publisher is silent is known by its readers alone.
        if (row.publishers.length === 0) row.rate_hz = Math.max(row.rate_hz, traffic.rate_hz);
      } else {
        row.rate_hz = row.publishers.length === 0 ? traffic.rate_hz : row.rate_hz + traffic.rate_hz;
        row.publishers.push(process.process);
        row.latency_p50_us = Math.max(row.latency_p50_us, traffic.latency_p50_us);
        row.latency_p99_us = Math.max(row.latency_p99_us, traffic.latency_p99_us);
      }
    }
  }
  return [...rows.values()].sort((a, b) => (a.channel < b.channel ? -1 : 1));
}

/** Why the page's own process is not well, as its HEALTH has it: the last minutes cannot be kept, say. Empty: it is well. */
export function faultOfPage(health: readonly Pick<wire.Health, "process" | "state" | "reason">[]): string {
  const own = health.find(({ process }) => process === "page");
  return own === undefined || own.state === wire.Health.STATE_OK ? "" : own.reason;
}

export const kSilent_s = 3.5;  // HEALTH comes once a second

export function gravityOfProcess(state: number, age_s: number): Gravity {
  if (age_s > kSilent_s) return "warning";
  switch (state) {
    case wire.Health.STATE_OK: return "ok";
    case wire.Health.STATE_FAILED: return "warning";
    case wire.Health.STATE_STARTING: return "unknown";
    default: return "caution";
  }
}

const kForgotten_ms = 600_000;

/** What one process told last, and how long ago. */
export interface Told { health: wire.Health; age_s: number }

/** Processes that were heard, also those that are silent by now: a process that died is what one wants to see. */
export class Roll {
  private readonly known = new Map<string, { health: wire.Health; heard_ms: number }>();

  /** @param now_ms clock of the page */
  take(health: readonly wire.Health[], now_ms: number): void {
    for (const one of health) {
      const key = `${one.process}@${one.host}`;
      const before = this.known.get(key)?.health;
      if (before === undefined || before.seq !== one.seq || before.utime_us !== one.utime_us) this.known.set(key, { health: one, heard_ms: now_ms });
    }
  }
  clear(): void { this.known.clear(); }
  /** The page itself heard nothing for so long: nobody is silent for longer by that. */
  leaveOut(deaf_ms: number): void { for (const one of this.known.values()) one.heard_ms += deaf_ms; }
  /** In the order of their names. What is silent for ten minutes is forgotten, but never the one of its name that was heard last, where it is of the boat.
   *  @param of_boat names of the processes of a boat */
  list(now_ms: number, of_boat: ReadonlySet<string>): Told[] {
    const last_ms = new Map<string, number>();
    for (const { health: { process }, heard_ms } of this.known.values()) last_ms.set(process, Math.max(heard_ms, last_ms.get(process) ?? -Infinity));
    for (const [key, { health: { process }, heard_ms }] of this.known) {
      const isKept = of_boat.has(process) && heard_ms === last_ms.get(process);
      if (now_ms - heard_ms > kForgotten_ms && !isKept) this.known.delete(key);
    }
    return [...this.known.values()].map(({ health, heard_ms }) => ({ health, age_s: (now_ms - heard_ms) / 1000 }))
      .sort((a, b) => (a.health.process < b.health.process ? -1 : 1));
  }
}
