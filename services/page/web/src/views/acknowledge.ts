// Tells the look-out that somebody has taken note of an alert.
import type * as wire from "../messages/generated.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";

const kPatience_ms = 5000;

/** @returns null when it was sent on to the look-out; else why not, in words */
export async function acknowledge(state: State, alert: wire.Alert): Promise<string | null> {
  const words = texts.panels.acknowledge;
  if (state.hello?.may_acknowledge === false) return words.mayNot;
  if (state.token === "") return words.noToken;
  try {
    const response = await fetch("/acknowledge", {
      method: "POST",
      headers: { "Authorization": `Bearer ${state.token}`, "Content-Type": "application/json" },
      body: JSON.stringify({ alert_id: alert.id, raised_utime_us: alert.raised_utime_us }),
      signal: AbortSignal.timeout(kPatience_ms),
    });
    switch (response.status) {
      case 202: return null;
      case 401: return words.wrongToken;
      case 403: case 421: return words.notOurs;
      case 409: return words.recorded;
      case 503: return words.busy;
      default: return words.refused(response.status);
    }
  } catch {
    return words.unreachable;
  }
}
