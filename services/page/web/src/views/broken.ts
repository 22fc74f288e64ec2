// Lines of angles.

/** A line that passes through north is broken there, and does not run down the whole chart. */
export function broken(times: number[], degrees: (number | null)[]): [number[], (number | null)[]] {
  const brokenTimes: number[] = [], values: (number | null)[] = [];
  degrees.forEach((value, index) => {
    const before = degrees[index - 1] ?? null;
    if (value !== null && before !== null && Math.abs(value - before) > 180) {
      brokenTimes.push((times[index - 1]! + times[index]!) / 2);
      values.push(null);
    }
    brokenTimes.push(times[index]!);
    values.push(value);
  });
  return [brokenTimes, values];
}
