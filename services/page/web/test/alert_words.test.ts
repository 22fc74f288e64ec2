// What an alert says in one line: how near, where, when, where to.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Alert, type Track } from "../src/messages/generated.js";
import { lineOf, passingSide, shortName, sightOf } from "../src/views/alert_words.js";

const kHere = { own_east_m: 0, own_north_m: 0, heading_rad: 0, boat: { hull_length_m: 6 }, pose: { velocity_map_mps: [0, 1] } };
const settings = { get: () => "m" } as never;
function picture(tracks: Track[] = []) { return { ...kHere, track_by_id: new Map(tracks.map((track) => [track.id, track])) } as never; }
function track(east: number, north: number, v_east: number, v_north: number, tcpa_s: number, cpa_m: number) {
  return { id: 7, position_map_m: [east, north], velocity_map_mps: [v_east, v_north], tcpa_s, cpa_m, length_m: 4 } as unknown as Track;
}
function alert(change: Partial<Alert> = {}): Alert {
  return {
    id: 1, track_id: 7, name: "boat 7", cause: Alert.CAUSE_CLOSEST_APPROACH, level: Alert.LEVEL_WARNING, state: Alert.STATE_ACTIVE, sight: Alert.SIGHT_SEEN, end: Alert.END_NONE,
    is_in_zone: false, comes_near: true, distance_m: 12.4, bearing_rad: 0.5, cpa_m: 1.2, tcpa_s: 8, time_left_s: 6, text: "boat 7: all of it", ...change,
  } as Alert;
}

test("a thing says on which side it passes, at which distance and when", () => {
  // Ahead of the bow from port to starboard, gone through before the boat is there.
  const ahead = track(-10, 20, 2, 0, 8, 8);
  assert.equal(passingSide(ahead, kHere as never), "ahead");
  assert.equal(lineOf(alert(), picture([ahead]), settings), "12\u00a0m, 29°\u00a0stbd · passes ahead, 1.2\u00a0m in 8.0\u00a0s");
  assert.equal(passingSide(track(-20, 4, 2, 0, 8, 2), kHere as never), "to port");
  assert.equal(passingSide(track(-2, -20, 0, 2, 8, 8), kHere as never), "astern");
  assert.equal(passingSide(track(0, 16, 0, -1, 8, 0), kHere as never), "", "it meets the boat");
  assert.equal(passingSide(track(3, 8, 0, 0, -1, 5), kHere as never), "", "it opens");
  assert.equal(passingSide(track(-20, 4, 2, 0, 8, 9), kHere as never), "", "the boat turns: straight on is not where it goes");
  assert.equal(passingSide(undefined, kHere as never), "");
});

test("what opens, what is lost and the watch have words of their own", () => {
  assert.equal(lineOf(alert({ time_left_s: NaN, tcpa_s: 0, is_in_zone: true }), picture(), settings), "12\u00a0m, 29°\u00a0stbd · opens · in the zone");
  assert.equal(lineOf(alert({ is_in_zone: true }), picture(), settings), lineOf(alert(), picture(), settings), "where it passes says more than the zone");
  const lost = alert({ sight: Alert.SIGHT_LOST, track_id: 0, cpa_m: NaN, tcpa_s: NaN, time_left_s: NaN });
  assert.equal(lineOf(lost, picture(), settings), "last 12\u00a0m, 29°\u00a0stbd");
  assert.equal(sightOf(lost), "not seen any more");
  assert.equal(sightOf(alert({ sight: Alert.SIGHT_JUST_SEEN })), "just seen");
  assert.equal(sightOf(alert({ state: Alert.STATE_RECTIFIED, end: Alert.END_PASSED })), "passed");
  const watch = alert({ cause: Alert.CAUSE_WATCH, name: "", text: "nobody looks", distance_m: NaN });
  assert.equal(lineOf(watch, picture(), settings), "nobody looks");
  assert.equal(shortName(watch), "look-out");
});
