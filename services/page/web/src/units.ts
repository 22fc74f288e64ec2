// Numbers in words, in the units that the user has chosen. What is not known is a dash, never 0.
import type { Settings } from "./settings.js";

const kUnknown = "–";
const kMetresPerMile = 1852;

export function length(settings: Settings, metres: number): string {
  if (!Number.isFinite(metres)) return kUnknown;
  if (settings.get("length_unit") === "NM" && Math.abs(metres) >= 185.2) return `${(metres / kMetresPerMile).toFixed(2)} NM`;
  return `${metres.toFixed(Math.abs(metres) < 10 ? 1 : 0)} m`;
}
export function speed(settings: Settings, mps: number): string {
  if (!Number.isFinite(mps)) return kUnknown;
  switch (settings.get("speed_unit")) {
    case "mps": return `${mps.toFixed(1)} m/s`;
    case "kmh": return `${(mps * 3.6).toFixed(1)} km/h`;
    default: return `${(mps * 3600 / kMetresPerMile).toFixed(1)} kn`;
  }
}
/** From true north or the bow, three digits as mariners write it. */
export function bearing(radians: number): string {
  if (!Number.isFinite(radians)) return kUnknown;
  const degrees = Math.round(((radians * 180 / Math.PI) % 360 + 360) % 360) % 360;
  return `${String(degrees).padStart(3, "0")}°`;
}
export function duration(seconds: number): string {
  if (!Number.isFinite(seconds)) return kUnknown;
  if (seconds < 10) return `${seconds.toFixed(1)} s`;
  if (seconds < 99.5) return `${seconds.toFixed(0)} s`;
  // Not "1:40": that would look like a time of day.
  const whole = Math.round(seconds), minutes = Math.floor(whole / 60);
  return minutes < 60 ? `${minutes} min ${whole % 60} s` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}
/** Time of day, UTC, as it stands on an axis. */
export function timeOfDay(utime_us: number, decimals = 0): string {
  if (!Number.isFinite(utime_us)) return kUnknown;
  return new Date(utime_us / 1000).toISOString().slice(11, decimals > 0 ? 20 + decimals : 19);
}
/** Seconds from the begin of a log, as the field for a time takes them: "+90.5 s". */
export function sinceBegin(utime_us: number, begin_utime_us: number, decimals = 1): string {
  const seconds = Number(((utime_us - begin_utime_us) / 1e6).toFixed(decimals));
  return Number.isFinite(seconds) ? `${seconds < 0 ? "−" : "+"}${Math.abs(seconds).toFixed(decimals)} s` : "";
}
/** A time as it stands everywhere: "14:03:20.5 UTC +90.5 s"; @param begin_utime_us of the log, NaN where there is none (live) */
export function timeText(utime_us: number, begin_utime_us: number, decimals = 1): string {
  if (!Number.isFinite(utime_us)) return kUnknown;
  const step_us = 10 ** (6 - decimals), rounded = Math.round(utime_us / step_us) * step_us;
  const since = sinceBegin(utime_us, begin_utime_us, decimals);
  return `${timeOfDay(rounded, decimals)} UTC${since === "" ? "" : ` ${since}`}`;
}
export function date(utime_us: number): string { return new Date(utime_us / 1000).toISOString().slice(0, 10); }
export function bytes(count: number): string {
  return count < 1e6 ? `${(count / 1e3).toFixed(0)} kB` : count < 1e9 ? `${(count / 1e6).toFixed(1)} MB` : `${(count / 1e9).toFixed(2)} GB`;
}
