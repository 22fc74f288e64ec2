// Angles on a circle, drawn as one line.

/** A line that passes through north goes on above 360 or below 0, and does not run down the whole chart; the last value lies in 0 to 360. */
export function unwrapped(degrees: readonly (number | null)[]): (number | null)[] {
  let before: number | null = null, turns = 0;
  const line = degrees.map((value) => {
    if (value === null) return null;
    if (before !== null) turns += value - before > 180 ? -360 : value - before < -180 ? 360 : 0;
    before = value;
    return value + turns;
  });
  const down = before === null ? 0 : turns + 360 * Math.floor(before / 360);
  return line.map((value) => (value === null ? null : value - down));
}

/** In 0 to 360, for people. */
export function onCircle(degrees: number): number { return ((degrees % 360) + 360) % 360; }
