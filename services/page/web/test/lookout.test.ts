import assert from "node:assert/strict";
import test from "node:test";
import { assess, type Known } from "../src/views/lookout.js";

const well: Known = { isRecorded: false, connection: "open", connection_s: 100, wasLost: false, hasPicture: true, age_s: 0.1, alerts_s: 0.1 };

test("nothing is said where all is well", () => { assert.deepEqual(assess(well), { level: "ok", text: "", mode: "live" }); });

test("an old picture is told with its age", () => {
  const verdict = assess({ ...well, age_s: 3.4 });
  assert.deepEqual(verdict, { level: "warning", text: "The picture is 3 s old", mode: "old" });
});

test("a tracker that is silent means no look-out, though the picture is young", () => {
  assert.match(assess({ ...well, alerts_s: 2.2 }).text, /^No look-out.*2 s/);
  assert.match(assess({ ...well, alerts_s: NaN }).text, /^No look-out/);
  assert.equal(assess({ ...well, alerts_s: NaN, connection_s: 1 }).text, "");
});

test("a lost connection is graver than all else", () => {
  assert.deepEqual(assess({ ...well, connection: "lost", connection_s: 7.9, age_s: 9 }).mode, "lost");
  assert.match(assess({ ...well, connection: "lost", connection_s: 7.9 }).text, / 7 s/);
});

test("it says when the connection is back, and when nothing ever came", () => {
  assert.equal(assess({ ...well, wasLost: true, connection_s: 3.5 }).text, "The connection is back.");
  assert.equal(assess({ ...well, wasLost: true, connection_s: 6 }).text, "");
  assert.equal(assess({ ...well, hasPicture: false }).level, "warning");
  assert.equal(assess({ ...well, age_s: Infinity }).level, "warning");
});

test("a recorded moment is never old", () => { assert.deepEqual(assess({ ...well, isRecorded: true, age_s: 500, alerts_s: NaN }).text, ""); });
