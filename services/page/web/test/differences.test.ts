// What two logs of one journey say differently, and which of it is worth a stop.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Alert, Track } from "../src/messages/generated.js";
import type { Picture } from "../src/picture.js";
import { Beginnings, compare, mattering } from "../src/views/differences.js";

function track(id: number, change: Partial<Track> = {}): Track {
  return {
    id, kind: Track.KIND_BUOY, status: Track.STATUS_CONFIRMED, speed_mps: 0, cpa_m: 20, tcpa_s: -1, position_map_m: Float64Array.of(10 * id, 0, 0), latitude_deg: 54 + id / 1e4, longitude_deg: 10,
    segment_ids: new Int32Array(), ...change,
  } as unknown as Track;
}
function alert(track_id: number, change: Partial<Alert> = {}): Alert { return { id: 1, cause: Alert.CAUSE_GUARD_ZONE, state: Alert.STATE_ACTIVE, track_id, text: `track ${track_id}`, ...change } as unknown as Alert; }
function picture(labels: number[], tracks: Track[] = [], alerts: Alert[] = []): Picture {
  return { utime_us: 7, returns: { count: labels.length, label: Int16Array.from(labels) }, segments: [], tracks, track_of_segment: new Map(), alerts } as unknown as Picture;
}
const kLimits = { share: 0.1, moved_m: 2 };
const differing = (first: Picture, second: Picture, limits = kLimits) => mattering(compare(first, second, limits.moved_m), limits);
const ten = [1, 1, 1, 1, 1, 2, 2, 2, -5, -5];

test("the same by other numbers is the same", () => {
  assert.deepEqual(differing(picture(ten, [track(1)], [alert(1)]), picture(ten.map((label) => (label > 0 ? label + 4 : label)), [track(1, { id: 9 })], [alert(9)])), []);
});
test("a track without a place on the earth is compared on the map", () => {
  const relative = (north_m: number) => track(1, { latitude_deg: NaN, longitude_deg: NaN, position_map_m: Float64Array.of(10, north_m) });
  assert.deepEqual(differing(picture(ten, [relative(0)]), picture(ten, [relative(1)])), []);
  assert.deepEqual(differing(picture(ten, [relative(0)]), picture(ten, [relative(1)]), { ...kLimits, moved_m: 0.5 }), ["place 1 1"]);
});
// "To the next that differs" stopped at each scan: some return is always told differently.
test("other labels matter from the share on that is chosen", () => {
  const one = [...ten.slice(0, 9), 2];
  assert.deepEqual(differing(picture(ten), picture(one)), ["returns"]);
  assert.deepEqual(differing(picture(ten), picture(one), { ...kLimits, share: 0.2 }), []);
  assert.deepEqual(differing(picture(ten), picture(one), { ...kLimits, share: 0 }), [], "never");
});
test("a track matters where one lacks it, has it as another kind, or elsewhere by more than is chosen", () => {
  assert.deepEqual(differing(picture(ten, [track(1), track(3)]), picture(ten, [track(1)])), ["only 3 –"]);
  assert.deepEqual(differing(picture(ten, [track(1)]), picture(ten, [track(1), track(3)])), ["only – 3"]);
  assert.deepEqual(differing(picture(ten, [track(1)]), picture(ten, [track(1, { kind: Track.KIND_BOAT })])), ["kind 1 1"]);
  const moved = track(1, { latitude_deg: 54 + 1 / 1e4 + 1.5 / 111_300 });
  assert.deepEqual(differing(picture(ten, [track(1)]), picture(ten, [moved])), []);
  assert.deepEqual(differing(picture(ten, [track(1)]), picture(ten, [moved]), { ...kLimits, moved_m: 1 }), ["place 1 1"]);
});
test("what is tentative, a little faster, or nearer at its closest is listed or left out, but no stop", () => {
  assert.deepEqual(differing(picture(ten, [track(1)]), picture(ten, [track(1), track(3, { status: Track.STATUS_TENTATIVE })])), []);
  const faster = compare(picture(ten, [track(1)]), picture(ten, [track(1, { speed_mps: 0.6 })]), 2);
  assert.equal(faster.tracks[0]?.what, "speed");
  assert.deepEqual(mattering(faster, kLimits), []);
});
test("an alert that the other lacks matters, one that is over does not", () => {
  assert.deepEqual(differing(picture(ten, [track(1)], [alert(1)]), picture(ten, [track(1)])), ["alert first 1"]);
  assert.deepEqual(differing(picture(ten, [track(1)], [alert(1, { state: Alert.STATE_CLEARED })]), picture(ten, [track(1)])), []);
  assert.equal(differing(picture(ten, [track(1)], [alert(1)]), picture(ten, [track(1)], [alert(1, { state: Alert.STATE_CLEARED })])).length, 1);
});
test("an alert of a tentative track is the same alert as that of a confirmed one", () => {
  const tentative = track(1, { id: 9, status: Track.STATUS_TENTATIVE });
  assert.deepEqual(differing(picture(ten, [track(1)], [alert(1)]), picture(ten, [tentative], [alert(9)])), []);
  assert.deepEqual(differing(picture(ten, [track(1)]), picture(ten, [tentative])), ["only 1 –"]);
});
test("a scan that one lacks is a difference", () => { assert.deepEqual(differing(picture(ten), picture([1])), ["scan"]); });

test("a difference that lasts is met once, one that comes back after two seconds again", () => {
  const beginnings = new Beginnings();
  assert.deepEqual(beginnings.take(["only 3 –"]), ["only 3 –"]);
  for (let scan = 0; scan < 100; ++scan) assert.deepEqual(beginnings.take(["only 3 –"]), []);
  for (let scan = 0; scan < 10; ++scan) beginnings.take([]);
  assert.deepEqual(beginnings.take(["only 3 –", "returns"]), ["returns"], "it flickers");
  for (let scan = 0; scan < 21; ++scan) beginnings.take([]);
  assert.deepEqual(beginnings.take(["only 3 –"]), ["only 3 –"]);
});
