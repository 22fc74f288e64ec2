// What the processes of the boat tell of themselves, live or at the moment of a log that is shown, and which of them are not well. Nothing here knows the DOM.
import * as wire from "../messages/generated.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { gravityOfProcess, kSilent_s, Roll, type Told } from "./traffic.js";

const words = texts.panels.health;

/** Of the processes that are not well. */
export interface Unwell {
  level: "warning" | "caution";
  text: string;
  /** Which they are and how, without reasons: these may hold numbers that change each second. */
  who: string;
}

function nameOf({ health: { process, state }, age_s }: Told): string {
  if (age_s > kSilent_s) return words.unwell.silent(process);
  return state === wire.Health.STATE_FAILED ? words.unwell.failed(process) : words.unwell.degraded(process);
}

/** Failed and silent ones are a warning and come first; where all are degraded it is a caution. The first reason that one of them tells stands behind.
 *  @param told in the order of names
 *  @param of_boat names of the processes of a boat: others are left out
 *  @returns null: all are well, or nobody told anything */
export function unwellOf(told: readonly Told[], of_boat: ReadonlySet<string>): Unwell | null {
  const levels = told.filter(({ health }) => of_boat.has(health.process)).map((one) => ({ one, level: gravityOfProcess(one.health.state, one.age_s) }));
  const warnings = levels.filter(({ level }) => level === "warning"), cautions = levels.filter(({ level }) => level === "caution");
  const unwell = [...warnings, ...cautions].map(({ one }) => one);
  if (unwell.length === 0) return null;
  const who = words.notWell(unwell.length, unwell.map(nameOf).join(", "));
  // What a silent process told last is not why it is silent.
  const teller = unwell.find(({ health, age_s }) => age_s <= kSilent_s && health.reason !== "");
  const text = teller === undefined ? who : words.because(who, teller.health.process, teller.health.reason);
  return { level: warnings.length > 0 ? "warning" : "caution", text, who };
}

export class ProcessWatch {
  private readonly roll = new Roll();
  private deaf_ms: number | null;  // since when no HEALTH of now can come; null: it can
  private host = "";

  /** @param now_ms clock of the page */
  constructor(private readonly state: State, private readonly now_ms: () => number = () => performance.now()) {
    this.deaf_ms = now_ms();
    state.on(["connection"], () => { this.forgetOtherHost(); });
    state.on(["picture", "age", "connection", "showing"], () => { this.take(); });
  }

  /** Live all that were heard; of a log those that were heard within the seconds before the moment that is shown. */
  list(): Told[] {
    const { picture, showing } = this.state;
    if (this.isOfNow()) return this.roll.list(this.now_ms(), this.ofBoat());
    const shown_us = showing.kind === "recorded" ? showing.utime_us : picture?.end_utime_us ?? NaN;
    return (picture?.health ?? []).map((health) => ({ health, age_s: Math.max(0, (shown_us - health.utime_us) / 1e6) }))
      .sort((a, b) => (a.health.process < b.health.process ? -1 : 1));
  }

  /** @returns null also while the connection is lost: then nothing is known of them */
  unwell(): Unwell | null {
    return this.isOfNow() && this.state.connection.state !== "open" ? null : unwellOf(this.list(), this.ofBoat());
  }

  private isOfNow(): boolean { return this.state.showing.kind === "live" && this.state.hello?.mode !== "log"; }
  private ofBoat(): ReadonlySet<string> { return new Set(this.state.hello?.processes ?? []); }

  // The page of another computer has other processes.
  private forgetOtherHost(): void {
    const { hello } = this.state;
    if (hello !== null && hello.host !== this.host) this.roll.clear();
    this.host = hello?.host ?? "";
  }

  private take(): void {
    const now_ms = this.now_ms();
    if (!this.isOfNow() || this.state.connection.state !== "open") {
      this.deaf_ms ??= now_ms;
      return;
    }
    if (this.deaf_ms !== null) {
      this.roll.leaveOut(now_ms - this.deaf_ms);
      this.deaf_ms = null;
    }
    this.roll.take(this.state.picture?.health ?? [], now_ms);
  }
}
