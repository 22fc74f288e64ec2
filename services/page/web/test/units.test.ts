// Numbers and times as they stand in the page.
import assert from "node:assert/strict";
import { test } from "node:test";
import { beginOf, whyNothing } from "../src/film.js";
import { texts } from "../src/texts/index.js";
import { duration, sinceBegin, timeText } from "../src/units.js";

const begin = Date.UTC(2026, 6, 14, 14, 3, 20) * 1000;

// The head, the time line, lists and plots each had a notation of their own.
test("a time is UTC and seconds from the start of the log; live there is no start", () => {
  assert.equal(timeText(begin + 90.5e6, begin), "14:04:50.5 UTC +90.5 s");
  assert.equal(timeText(begin - 1e6, begin), "14:03:19.0 UTC −1.0 s");
  assert.equal(timeText(begin, NaN, 0), "14:03:20 UTC");
  assert.equal(timeText(NaN, begin), "–");
});
test("both halves of a time are rounded alike", () => {
  assert.equal(timeText(begin + 90.96e6, begin), "14:04:51.0 UTC +91.0 s");
  assert.equal(timeText(begin + 59.97e6, begin, 0), "14:04:20 UTC +60 s");
  assert.equal(sinceBegin(begin - 20_000, begin), "+0.0 s", "no minus before nothing");
});
test("a log counts from its first recording, what is live from nowhere", () => {
  const sources = [{ begin_utime_us: 5, end_utime_us: 9 }] as never;
  assert.equal(beginOf({ hello: { mode: "log" } as never, sources }), 5);
  assert.ok(Number.isNaN(beginOf({ hello: { mode: "live" } as never, sources })));
  assert.ok(Number.isNaN(beginOf({ hello: null, sources: [] })));
});
// A log that was still being read asked whether the lidar's process runs.
test("of a log without a picture nobody asks whether processes run", () => {
  const log = { mode: "log" } as never, source = (is_indexed: boolean, num_scans: number) => ({ is_indexed, num_scans }) as never;
  assert.equal(whyNothing({ hello: log, sources: [source(false, 0)] }), texts.reading);
  assert.equal(whyNothing({ hello: log, sources: [source(true, 0)] }), texts.noScans);
  assert.equal(whyNothing({ hello: log, sources: [source(true, 7)] }), texts.reading);
  assert.equal(whyNothing({ hello: { mode: "live" } as never, sources: [] }), texts.nothingYet);
  assert.equal(whyNothing({ hello: null, sources: [] }), "");
});
// "1:40" was taken for a time of day.
test("a duration is not like a time of day", () => {
  assert.deepEqual([9.94, 42, 99.4, 99.6, 100, 3599, 3600, 100_000, NaN].map(duration), ["9.9 s", "42 s", "99 s", "1 min 40 s", "1 min 40 s", "59 min 59 s", "1 h 0 min", "27 h 46 min", "–"]);
});
