// Whether what is seen may be believed: in order of gravity, one line. Nothing here knows the DOM.
import { texts } from "../texts/index.js";
import { duration } from "../units.js";
import type { Gravity } from "./shapes.js";

const words = texts.panels.lookout;
const kOld_s = 1;             // of the picture, and of ALERTS
const kPatience_s = 3;        // after the page was opened, before it says that nothing came
const kTold_s = 5;            // how long it says that the connection is back

/** What is known; times in s, NaN: not known. */
export interface Known {
  isRecorded: boolean;
  connection: "opening" | "open" | "lost";
  /** Since the connection became what it is. */
  connection_s: number;
  wasLost: boolean;
  hasPicture: boolean;
  age_s: number;
  /** Since ALERTS came last; NaN: never. */
  alerts_s: number;
}
export interface Verdict { level: Gravity; text: string; mode: "live" | "old" | "lost" | "recorded" | "none" }

/** @returns what is to be said; an empty text where all is well */
export function judge(known: Known): Verdict {
  if (known.connection === "lost") return { level: "warning", text: texts.lost(Math.floor(known.connection_s)), mode: "lost" };
  if (known.isRecorded) return { level: "quiet", text: "", mode: "recorded" };
  if (known.connection === "opening") return { level: "quiet", text: texts.connecting, mode: "none" };
  if (!known.hasPicture || !Number.isFinite(known.age_s)) {
    if (known.connection_s < kPatience_s) return { level: "quiet", text: texts.connecting, mode: "none" };
    return { level: "warning", text: texts.nothingYet, mode: "none" };
  }
  if (known.age_s > kOld_s) return { level: "warning", text: texts.stale(duration(Math.floor(known.age_s)).replace(".0", "")), mode: "old" };
  if (!(known.alerts_s <= kOld_s) && known.connection_s > kPatience_s) {
    return { level: "warning", text: Number.isFinite(known.alerts_s) ? words.silent(Math.floor(known.alerts_s)) : words.noAlerts, mode: "live" };
  }
  if (known.wasLost && known.connection_s < kTold_s) return { level: "quiet", text: texts.back, mode: "live" };
  return { level: "ok", text: "", mode: "live" };
}
