import assert from "node:assert/strict";
import test from "node:test";
import { Health } from "../src/messages/generated.js";
import { State } from "../src/state.js";
import { ProcessWatch, unwellOf } from "../src/views/process_watch.js";

const kOfBoat = ["georeferencer", "lidar", "lidar_2", "plotter", "recorder", "tracker"];
const health = (process: string, state: number = Health.STATE_OK, reason = "", utime_us = 0) =>
  ({ process, host: "boat", seq: utime_us, utime_us, state, reason, channels: [] }) as unknown as Health;
const told = (process: string, state: number = Health.STATE_OK, reason = "", age_s = 0.5) => ({ health: health(process, state, reason), age_s });
const ofBoat = new Set(kOfBoat);

test("where all are well, start, or are of somebody else, nothing is said", () => {
  assert.equal(unwellOf([], ofBoat), null);
  assert.equal(unwellOf([told("lidar"), told("recorder", Health.STATE_STARTING, "waits for the disk"), told("stranger", Health.STATE_FAILED, "fire")], ofBoat), null);
});

test("degraded processes are a caution, with the first reason", () => {
  assert.deepEqual(unwellOf([told("georeferencer", Health.STATE_DEGRADED), told("lidar"), told("recorder", Health.STATE_DEGRADED, "12 messages lost")], ofBoat), {
    level: "caution", who: "2 processes are not well: georeferencer, recorder",
    text: "2 processes are not well: georeferencer, recorder. recorder: 12 messages lost",
  });
});

test("a failed or silent process is a warning and comes first; what a silent one told last is no reason", () => {
  const unwell = unwellOf([
    told("georeferencer", Health.STATE_DEGRADED, "no POSE"), told("plotter", Health.STATE_DEGRADED, "an old reason", 4), told("recorder", Health.STATE_FAILED, "the disk is full"),
  ], ofBoat);
  assert.equal(unwell?.level, "warning");
  assert.equal(unwell.text, "3 processes are not well: plotter (silent), recorder (failed), georeferencer. recorder: the disk is full");
  assert.deepEqual(unwellOf([told("lidar_2", Health.STATE_OK, "", 60)], ofBoat), {
    level: "warning", text: "1 process is not well: lidar_2 (silent)", who: "1 process is not well: lidar_2 (silent)",
  });
});

// A live page of a boat, with a clock of its own.
function livePage() {
  const clock = { now_ms: 0 }, state = new State();
  state.hello = { mode: "live", version: "", host: "boat", server_utime_us: 0, channels: [], processes: kOfBoat, sources: [], may_acknowledge: false };
  const watch = new ProcessWatch(state, () => clock.now_ms);
  const show = (heard: Health[]) => {
    state.picture = { health: heard, end_utime_us: 0 } as unknown as State["picture"];
    state.tell("picture");
  };
  state.connection = { state: "open", since_ms: 0 };
  state.tell("connection");
  return { clock, state, watch, show };
}

test("a process that dies is told for as long as the page lives, and no more when it is back", () => {
  const { clock, watch, show } = livePage();
  show([health("recorder"), health("tracker")]);
  assert.equal(watch.unwell(), null);
  for (clock.now_ms = 1000; clock.now_ms <= 3_600_000; clock.now_ms += 1000) show([health("tracker", Health.STATE_OK, "", clock.now_ms)]);
  assert.equal(watch.unwell()?.text, "1 process is not well: recorder (silent)");
  show([health("tracker", Health.STATE_OK, "", clock.now_ms), health("recorder", Health.STATE_OK, "", clock.now_ms)]);
  assert.equal(watch.unwell(), null);
});

test("while the connection is lost nothing is said, and nobody is silent only because the page heard nothing", () => {
  const { clock, state, watch, show } = livePage();
  show([health("recorder"), health("tracker", Health.STATE_FAILED, "no scan")]);
  state.connection = { state: "lost", since_ms: 0 };
  state.tell("connection");
  clock.now_ms = 60_000;
  state.tell("age");
  assert.equal(watch.unwell(), null);
  state.connection = { state: "open", since_ms: clock.now_ms };
  state.tell("connection");
  assert.equal(watch.unwell()?.who, "1 process is not well: tracker (failed)");
  clock.now_ms = 64_000;  // now it would have come
  state.tell("age");
  assert.equal(watch.unwell()?.who, "2 processes are not well: recorder (silent), tracker (silent)");
});

test("of a recorded moment the state of that moment is told, by the time of the log", () => {
  const { clock, state, watch, show } = livePage();
  show([health("recorder")]);
  state.showing = { kind: "recorded", source: 0, utime_us: 100e6, scan_index: 0, num_scans: 1 };
  // The sensor's clock, by which the picture ends, is another than that of HEALTH.
  state.picture = { health: [health("recorder", Health.STATE_DEGRADED, "slow", 99.5e6), health("lidar", Health.STATE_OK, "", 99e6)], end_utime_us: 137e6 } as unknown as State["picture"];
  state.tell("picture");
  assert.equal(watch.unwell()?.text, "1 process is not well: recorder. recorder: slow");
  state.picture = { health: [], end_utime_us: 137e6 } as unknown as State["picture"];
  assert.equal(watch.unwell(), null, "a log without HEALTH");
  // Back to now: what was heard before, and nothing of that moment.
  clock.now_ms = 300_000;
  state.showing = { kind: "live" };
  state.picture = null;
  state.tell("showing");
  assert.equal(watch.unwell(), null);
});
