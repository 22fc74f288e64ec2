// Tells the look-out what somebody has decided: that an alert is taken note of, that it is to be silent, which limits hold.
import type * as wire from "../messages/generated.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";

const kPatience_ms = 5000;

/** As POST /order takes it (PROTOCOL.md); what is left out is as the config says. */
export type Order =
  | { kind: "silence" }
  | { kind: "name"; track_id: number; name: string }
  | { kind: "settings"; mode: "open_water" | "harbour"; guard_zone_range_m?: number; guard_zone_from_deg?: number; guard_zone_to_deg?: number; cpa_limit_m?: number };

/** @returns null when it was sent on to the look-out; else why not, in words */
export function acknowledge(state: State, alert: wire.Alert): Promise<string | null> {
  return send(state, "/acknowledge", { alert_id: alert.id, raised_utime_us: alert.raised_utime_us });
}
/** @returns as above */
export function order(state: State, order: Order): Promise<string | null> { return send(state, "/order", order); }

async function send(state: State, path: string, body: object): Promise<string | null> {
  const words = texts.panels.acknowledge;
  if (state.hello?.may_acknowledge === false) return words.mayNot;
  if (state.token === "") return words.noToken;
  try {
    const response = await fetch(path, {
      method: "POST",
      headers: { "Authorization": `Bearer ${state.token}`, "Content-Type": "application/json" },
      body: JSON.stringify(body),
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
