// The time line's spans, jumps and gaps, and times as they are typed.
import assert from "node:assert/strict";
import { test } from "node:test";
import { ageInLog, lineOf, sourceAt } from "../src/film.js";
import type { Source, Strip, StripEvent } from "../src/link.js";
import { gapsOf, moved, nextEvent, wholeSpan, zoomed } from "../src/views/strip.js";
import { parseTime } from "../src/views/time_text.js";
import { sinceBegin, timeText } from "../src/units.js";
import { describe } from "../src/views/timeline_canvas.js";

const source = (id: number, begin_s: number, end_s: number) => ({ id, begin_utime_us: begin_s * 1e6, end_utime_us: end_s * 1e6 }) as unknown as Source;
const whole = { from_utime_us: 0, to_utime_us: 100e6 };
const strip = (more: Partial<Strip>): Strip => ({
  source: 0, begin_utime_us: 0, bucket_us: 1e6, num_tracks: [3, 3, -1, -1, -1, 2], alert_level: [0, 0, 0, 0, 0, 0], num_lost: [0, 0, 0, 0, 0, 0], health: [-1, -1, -1, -1, -1, -1], events: [],
  ...more,
});

test("recordings that overlap are not of one line, whatever their order", () => {
  const line = lineOf([source(0, 50, 60), source(1, 0, 40), source(2, 30, 55), source(3, 60, 70)]);
  assert.deepEqual(line.map(({ id }) => id), [1, 0, 3]);
  assert.deepEqual(wholeSpan(line), { from_utime_us: 0, to_utime_us: 70e6 });
  assert.equal(wholeSpan([]), null);
});
test("a time between two recordings is of the one before, one before all of the first", () => {
  const line = [source(1, 10, 20), source(2, 30, 40)];
  assert.deepEqual([5, 10, 25, 30, 99].map((at_s) => sourceAt(line, at_s * 1e6)?.id), [1, 1, 1, 2, 2]);
});
test("zooming keeps the time under the pointer, stays within the whole, and shows 1 s at least", () => {
  const half = zoomed(whole, whole, 25e6, 0.5);
  assert.deepEqual(half, { from_utime_us: 12.5e6, to_utime_us: 62.5e6 });
  assert.deepEqual(zoomed(half, whole, 0, 10), whole);
  const least = zoomed(whole, whole, 99.9e6, 1e-6);
  assert.equal(Math.round(least.to_utime_us - least.from_utime_us), 1e6);
  assert.ok(least.to_utime_us <= 100e6);
});
test("a span that is moved stops at the ends of the whole", () => {
  const span = { from_utime_us: 40e6, to_utime_us: 50e6 };
  assert.deepEqual(moved(span, whole, 5e6), { from_utime_us: 45e6, to_utime_us: 55e6 });
  assert.deepEqual(moved(span, whole, 80e6), { from_utime_us: 90e6, to_utime_us: 100e6 });
  assert.deepEqual(moved(span, whole, -80e6), { from_utime_us: 0, to_utime_us: 10e6 });
});
test("a jump leaves the event that is shown, and ends and gaps go with the starts", () => {
  const events = [[1, "start"], [2, "alert"], [3, "loss"], [4, "alert"], [5, "gap"], [6, "end"]].map(([at_s, kind]) => ({ utime_us: Number(at_s) * 1e6, kind, level: 0, text: "" }) as StripEvent);
  const at_s = (kind: "alert" | "loss" | "health" | "start", from_s: number, direction: 1 | -1) => {
    const found = nextEvent(events, kind, from_s * 1e6, direction);
    return found === undefined ? null : found.utime_us / 1e6;
  };
  assert.equal(at_s("alert", 2, 1), 4);
  assert.equal(at_s("alert", 2.01, -1), null);
  assert.equal(at_s("alert", 4, -1), 2);
  assert.equal(at_s("alert", 4, 1), null);
  assert.equal(at_s("start", 1, 1), 5);
  assert.equal(at_s("start", 5, 1), 6);
  assert.equal(at_s("health", 0, 1), null);
});
test("a gap is where a strip holds nothing for 2 s", () => {
  assert.deepEqual(gapsOf(strip({})), [{ from_utime_us: 2e6, to_utime_us: 5e6 }]);
  assert.deepEqual(gapsOf(strip({ bucket_us: 0.5e6 })), []);
  assert.deepEqual(gapsOf(strip({ health: [-1, -1, -1, 0, -1, -1] })), []);
  assert.deepEqual(gapsOf(strip({ num_lost: [0, 0, 0, 2, 0, 0] })), []);
  assert.deepEqual(gapsOf(strip({ num_tracks: [-1, -1, -1, -1, -1, -1] })), [], "of a log without TRACKS nothing is known");
  assert.deepEqual(gapsOf(strip({ num_tracks: [1, 1, 1, -1, -1, -1] })), [{ from_utime_us: 3e6, to_utime_us: 6e6 }]);
});
test("a strip says what was at a time, and that nothing was recorded in a gap", () => {
  assert.deepEqual(describe([strip({ alert_level: [2, 0, 0, 0, 0, 0], num_lost: [1, 0, 0, 0, 0, 0] })], 0.5e6), ["3 tracks", "warning", "1 message lost"]);
  assert.deepEqual(describe([strip({})], 3.5e6), ["nothing recorded"]);
  assert.deepEqual(describe([strip({})], 20e6), ["nothing recorded"]);
});
test("in a gap of a log the picture is as old as its scan", () => {
  assert.equal(ageInLog({ times_us: new Map([["LIDAR_SCAN", 10e6], ["ALERTS", 17e6]]) }, 18e6), 8);
  assert.equal(ageInLog({ times_us: new Map([["TRACKS", 10e6]]) }, 10.5e6), 0.5);
  assert.equal(ageInLog({ times_us: new Map() }, 10e6), 0);
  assert.equal(ageInLog({ times_us: new Map([["LIDAR_SCAN", 10e6]]) }, 9e6), 0);
});

const begin = Date.UTC(2026, 6, 14, 23, 59, 0) * 1000, end = begin + 120e6;  // over midnight
test("times are read as they are typed", () => {
  assert.equal(parseTime("23:59:30", begin, end), begin + 30e6);
  assert.equal(parseTime(" 23:59:30.25 utc ", begin, end), begin + 30.25e6);
  assert.equal(parseTime("23:59", begin, end), begin);
  assert.equal(parseTime("0:00:10", begin, end), begin + 70e6, "of the next day");
  assert.equal(parseTime("2026-07-15 00:00:10", begin, end), begin + 70e6);
  assert.equal(parseTime("2026-07-14T23:59:30Z", begin, end), begin + 30e6);
  assert.equal(parseTime("+90", begin, end), begin + 90e6);
  assert.equal(parseTime("+1.5 s", begin, end), begin + 1.5e6);
  assert.equal(parseTime("90", begin, end), begin + 90e6);
  assert.equal(parseTime("+1:30", begin, end), begin + 90e6);
  assert.equal(parseTime("+0:01:30.5", begin, end), begin + 90.5e6);
  assert.equal(parseTime(String(begin + 7), begin, end), begin + 7);
});
test("a time is read as the page itself writes it", () => {
  for (const at_us of [begin, begin + 12.3e6, begin + 90e6]) {
    assert.equal(parseTime(timeText(at_us, begin), begin, end), at_us);
    assert.equal(parseTime(`2026-07-1${at_us < begin + 60e6 ? 4 : 5} ${timeText(at_us, begin)}`, begin, end), at_us);
    assert.equal(parseTime(sinceBegin(at_us, begin), begin, end), at_us);
  }
});
test("within a second of an end it is the end; else what lies outside is no time", () => {
  assert.equal(parseTime("23:58:59.5", begin, end), begin);
  assert.equal(parseTime("+120.5", begin, end), end);
  for (const text of ["23:58:00", "00:02:00", "+122", "2026-07-16 00:00:10"]) assert.equal(parseTime(text, begin, end), null, text);
});
test("what is no time is refused", () => {
  for (const text of ["", "now", "24:00", "23:60", "23:59:60", "1:2:3", "23.59", "-5", "2026-02-30 23:59:30", "14:03:20 CET"]) assert.equal(parseTime(text, begin, end), null, text);
});
