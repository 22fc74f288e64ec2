// A time as somebody types it.

const kDay_us = 86_400e6;

/** @param text  UTC: "12:34", "12:34:56.7" (of a day between from and to), "2026-07-14 12:34:56"; after `from`: "+90" or "90" s, "+1:30"; microseconds since
 *               1970 UTC (16 digits); or as the page writes it, "12:34:56.7 UTC +90.5 s"
 *  @returns microseconds since 1970 UTC, or null when it is no time or lies outside of from to to */
export function parseTime(text: string, from_utime_us: number, to_utime_us: number): number | null {
  const within = (utime_us: number) => (utime_us >= from_utime_us - 1e6 && utime_us <= to_utime_us + 1e6 ? Math.min(Math.max(utime_us, from_utime_us), to_utime_us) : null);
  const trimmed = text.trim().replace(/(\d UTC) [+−][\d.]+ s$/, "$1").replace(/\s*(UTC|Z)$/i, "");
  if (/^\d{16}$/.test(trimmed)) return within(Number(trimmed));
  // Without a sign "23.59" may be meant for 23:59.
  const after = /^(?:\+(\d+(?:\.\d+)?)|(\d+))\s*s?$/.exec(trimmed);
  if (after !== null) return within(from_utime_us + Number(after[1] ?? after[2]) * 1e6);
  const elapsed = /^\+(?:(\d+):)?(\d{1,2}):([0-5]\d(?:\.\d+)?)$/.exec(trimmed);
  if (elapsed !== null) return within(from_utime_us + (Number(elapsed[1] ?? 0) * 3600 + Number(elapsed[2]) * 60 + Number(elapsed[3])) * 1e6);
  const match = /^(?:(\d{4})-(\d{2})-(\d{2})[T\s]+)?(\d{1,2}):(\d{2})(?::(\d{2}(?:\.\d+)?))?$/.exec(trimmed);
  if (match === null) return null;
  const [, year, month, day, hours, minutes, seconds] = match;
  if (Number(hours) > 23 || Number(minutes) > 59 || Number(seconds ?? 0) >= 60) return null;
  const ofDay_us = (Number(hours) * 3600 + Number(minutes) * 60 + Number(seconds ?? 0)) * 1e6;
  if (year !== undefined) {
    const midnight = Date.UTC(Number(year), Number(month) - 1, Number(day));
    return new Date(midnight).toISOString().startsWith(`${year}-${month}-${day}`) ? within(midnight * 1000 + ofDay_us) : null;
  }
  for (let midnight = Math.floor(from_utime_us / kDay_us) * kDay_us; midnight <= to_utime_us; midnight += kDay_us) {
    const found = within(midnight + ofDay_us);
    if (found !== null) return found;
  }
  return null;
}
