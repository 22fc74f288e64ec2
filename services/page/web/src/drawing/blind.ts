// The parts of the guard zone into which nobody looks, as an alert of the tracker names them. Nothing here knows the DOM.
import * as wire from "../messages/generated.js";

/** From the bow clockwise, deg; from and up to which range, m. */
export interface BlindSector { from_deg: number; to_deg: number; near_m: number; far_m: number }

const kPart = /(?:(\d+) to (\d+) deg|all round)(?:, from ([\d.]+) m on|, up to ([\d.]+) m|, ([\d.]+) to ([\d.]+) m)?/g;

/** Whether an alert says that nobody looks into a part of the guard zone. (Alerts of the watch, below 0, say that nobody looks at all.) */
export function isBlindness(alert: Pick<wire.Alert, "cause" | "id" | "state">): boolean {
  return alert.cause === wire.Alert.CAUSE_WATCH && alert.id > 0 && (alert.state === wire.Alert.STATE_ACTIVE || alert.state === wire.Alert.STATE_ACKNOWLEDGED);
}

/** Those that the alerts name; an alert holds them in its text alone ("..., 300 to 60 deg, from 5.0 m on (...)"). */
export function blindSectors(alerts: readonly Pick<wire.Alert, "cause" | "id" | "state" | "text">[]): BlindSector[] {
  return alerts.filter(isBlindness).flatMap(({ text }) => [...text.matchAll(kPart)].map(([, from, to, nearest, farthest, near, far]) => ({
    from_deg: Number(from ?? 0), to_deg: Number(to ?? 360), near_m: Number(nearest ?? near ?? 0), far_m: Number(farthest ?? far ?? Infinity),
  })));
}
