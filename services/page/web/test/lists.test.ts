import assert from "node:assert/strict";
import test from "node:test";
import { type AisShip, Health, Pose, Track } from "../src/messages/generated.js";
import { channelsOf, faultOfPage, gravityOfProcess, Roll } from "../src/views/traffic.js";
import { nameOf, relative, restsOn, shortNameOf, situation } from "../src/views/track_words.js";
import { isOnlyCourse, lacking } from "../src/picture.js";
import { gravityOfPose } from "../src/views/sensors.js";
import { nameFrom } from "../src/views/name_form.js";
import { place } from "../src/views/track_detail.js";

const kDegree = Math.PI / 180;
const traffic = (channel: string, is_input: boolean, change: object) => ({
  channel, is_input, num_messages: 0, num_undecodable: 0, num_lost: 0, rate_hz: 10, queue_depth: -1, queue_limit: 0, latency_p50_us: -1, latency_p99_us: -1, ...change,
});
const health = (process: string, channels: object[], seq = 0) => ({ process, host: "boat", seq, utime_us: seq, channels }) as unknown as Health;

test("a channel is what its publisher and its readers tell together", () => {
  const rows = channelsOf([
    health("tracker", [traffic("SEGMENTS", true, { num_lost: 2, rate_hz: 8, queue_depth: 1, queue_limit: 30 })]),
    health("segmenter", [traffic("SEGMENTS", false, { latency_p99_us: 5000 })]),
    health("recorder", [traffic("SEGMENTS", true, { num_lost: 3, num_undecodable: 1, queue_depth: 9, queue_limit: 20 }), traffic("POSE", true, { rate_hz: 50 })]),
  ]);
  assert.deepEqual(rows.map(({ channel }) => channel), ["POSE", "SEGMENTS"]);
  const [pose, segments] = rows;
  assert.deepEqual(segments, {
    channel: "SEGMENTS", publishers: ["segmenter"], readers: ["tracker", "recorder"], rate_hz: 10, num_lost: 5, num_refused: 1, latency_p50_us: -1,
    latency_p99_us: 5000, queue_depth: 9, queue_limit: 20,
  });
  assert.equal(pose!.rate_hz, 50);
});

const kOfBoat = new Set(["lidar", "tracker", "recorder", "georeferencer"]);

test("a process that went silent stays on the roll, with its age", () => {
  const roll = new Roll();
  roll.take([health("lidar", [], 1), health("tracker", [], 1)], 0);
  roll.take([health("lidar", [], 1), health("tracker", [], 2)], 8000);
  assert.deepEqual(roll.list(9000, kOfBoat).map(({ health: { process }, age_s }) => [process, age_s]), [["lidar", 9], ["tracker", 1]]);
});

// A recorder that died in the morning was well again after ten minutes: it was not in the list any more.
test("a process of the boat is never forgotten, one of somebody else after ten minutes", () => {
  const roll = new Roll();
  roll.take([health("recorder", [], 1), health("somebody", [], 1)], 0);
  assert.deepEqual(roll.list(599_000, kOfBoat).map(({ health: { process } }) => process), ["recorder", "somebody"]);
  assert.deepEqual(roll.list(36_000_000, kOfBoat).map(({ health: { process }, age_s }) => [process, age_s]), [["recorder", 36_000]]);
});

test("invented computers do not fill the roll: of a name the one that was heard last is kept", () => {
  const roll = new Roll();
  for (let i = 0; i < 100; ++i) roll.take([{ ...health("recorder", [], i), host: `computer${i}` } as unknown as Health], i);
  assert.deepEqual(roll.list(700_000, kOfBoat).map(({ health: { host } }) => host), ["computer99"]);
});

test("what is silent is a warning, whatever it said last", () => {
  assert.equal(gravityOfProcess(Health.STATE_OK, 1), "ok");
  assert.equal(gravityOfProcess(Health.STATE_OK, 5), "warning");
  assert.equal(gravityOfProcess(Health.STATE_DEGRADED, 1), "caution");
});

test("bearings from the bow are said as a helmsman says them", () => {
  assert.equal(relative(35 * kDegree), "35° stbd");
  assert.equal(relative(325 * kDegree), "35° port");
  assert.equal(relative(-35 * kDegree), "35° port");
  assert.equal(relative(359.7 * kDegree), "ahead");
  assert.equal(relative(Math.PI), "astern");
  assert.equal(relative(NaN), "–");
});

test("what a track rests on, and its situation", () => {
  assert.equal(restsOn({ num_seen: 14, num_looks: 15, mean_returns: 2 }), "14 of 15 scans, 2 returns");
  assert.equal(restsOn({ num_seen: 3, num_looks: 4, mean_returns: 1.5 }), "3 of 4 scans, 1.5 returns");
  assert.equal(situation({ status: Track.STATUS_COASTING, encounter: Track.ENCOUNTER_CROSSING_GIVE_WAY }), "crossing: give way, not seen now");
  assert.equal(situation({ status: Track.STATUS_CONFIRMED, encounter: Track.ENCOUNTER_NONE }), "");
});

test("a track is called as people named it, else by kind and number", () => {
  const name_of_track = new Map([[7, "Anna's mooring buoy"]]), kind = Track.KIND_BUOY;
  assert.equal(nameOf({ id: 7, kind }, { name_of_track }), "Anna's mooring buoy");
  assert.equal(nameOf({ id: 8, kind }, { name_of_track }), "Buoy 8");
  assert.equal(shortNameOf({ id: 8, kind }, { name_of_track }), "buoy 8");
});

test("a track that AIS knows is called as its ship, unless people gave it a name", () => {
  const name_of_track = new Map([[7, "Anna's mooring buoy"]]), kind = Track.KIND_BOAT;
  const ship = (name: string): AisShip => ({ mmsi: 2110001, name }) as AisShip;
  const ship_of_track = new Map([[7, ship("EVEREST")], [8, ship("EVEREST")], [9, ship("")]]);
  assert.equal(nameOf({ id: 7, kind }, { name_of_track, ship_of_track }), "Anna's mooring buoy");
  assert.equal(nameOf({ id: 8, kind }, { name_of_track, ship_of_track }), "EVEREST");
  assert.equal(shortNameOf({ id: 9, kind }, { name_of_track, ship_of_track }), "MMSI 002110001");
  assert.equal(nameOf({ id: 10, kind }, { name_of_track, ship_of_track }), "Boat 10");
});

test("a name that is typed is as long as the look-out takes it", () => {
  assert.equal(nameFrom("  Kiosk pier "), "Kiosk pier");
  assert.equal(nameFrom(" "), "");
  assert.equal(nameFrom("ä".repeat(20)), "ä".repeat(20));
  assert.equal(nameFrom("ä".repeat(21)), null, "two bytes each");
});

test("a place is written as on a chart", () => {
  assert.equal(place(43.62982, -72.15), "43°37.789′N 072°09.000′W");
  assert.equal(place(-0.9999999, 179.99999), "01°00.000′S 179°59.999′E");
  assert.equal(place(NaN, 3), "–");
});

// "HDG 000" was the course over ground of a boat without a compass, and looked like a compass.
test("a heading that is only the course over ground is told as such, and is a caution", () => {
  const pose = (heading_source: number, status: number = Pose.STATUS_OK) => ({ heading_source, status });
  assert.deepEqual([Pose.HEADING_NONE, Pose.HEADING_HDT, Pose.HEADING_PASHR, Pose.HEADING_COURSE].map((source) => isOnlyCourse(pose(source))), [false, false, false, true]);
  assert.equal(isOnlyCourse(null), false);
  assert.equal(gravityOfPose(pose(Pose.HEADING_HDT)), "ok");
  assert.equal(gravityOfPose(pose(Pose.HEADING_COURSE)), "caution");
  assert.equal(gravityOfPose(pose(Pose.HEADING_NONE, Pose.STATUS_UNKNOWN)), "warning");
  assert.deepEqual([Pose.STATUS_OK, Pose.STATUS_COASTING, Pose.STATUS_NO_HEADING, Pose.STATUS_NO_POSITION, Pose.STATUS_UNKNOWN, Pose.STATUS_RELATIVE, Pose.STATUS_RELATIVE_TO_BOAT].map((status) => lacking(pose(0, status))), [null, null, "heading", "position", "position", null, null]);
  assert.equal(lacking(null), "position");
});

// The page stopped keeping the last minutes, and only its own HEALTH, deep in a list, said so.
test("why the page keeps no last minutes is told in the words of its HEALTH", () => {
  const health = (process: string, state: number, reason: string) => ({ process, state, reason });
  const reason = "no look back: /data/spool: 1.0 GB of the disk are free, and 2.0 GB are reserved for the recorder";
  assert.equal(faultOfPage([health("tracker", Health.STATE_DEGRADED, "no POSE"), health("page", Health.STATE_DEGRADED, reason)]), reason);
  assert.equal(faultOfPage([health("tracker", Health.STATE_FAILED, "no POSE"), health("page", Health.STATE_OK, "")]), "");
  assert.equal(faultOfPage([]), "");
});
