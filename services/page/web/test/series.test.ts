import assert from "node:assert/strict";
import test from "node:test";
import type { Health, Pose, Track } from "../src/messages/generated.js";
import type { Picture } from "../src/picture.js";
import { onCircle, unwrapped } from "../src/views/circle.js";
import { chartOf, pathsOf, Ring, unitOf, valueIn } from "../src/views/series.js";

const channel = (name: string, is_input: boolean, rate_hz: number) => ({
  channel: name, is_input, num_messages: 0, num_undecodable: 0, num_lost: 0, rate_hz, queue_depth: -1, queue_limit: 0, handling_p50_us: -1,
  handling_p99_us: -1, latency_p50_us: -1, latency_p99_us: -1,
});
const health = {
  process: "tracker", cpu_fraction: 0.25, seq: 7, channels: [channel("SEGMENTS", true, 9), channel("TRACKS", false, 10)],
  counters: [{ name: "scans.late", count: 3 }],
} as unknown as Health;
const pose = { heading_rad: 1, has_attitude: true, position_map_m: Float64Array.of(3, 4, 5) } as unknown as Pose;
const track = { id: 17, range_m: 31 } as unknown as Track;
const picture = { pose, health: [health], clock: null, fix: null, tracks: [track], track_by_id: new Map([[17, track]]), returns: null } as unknown as Picture;

test("every number that is offered can be read", () => {
  const paths = pathsOf(picture, 17);
  for (const path of ["HEALTH/tracker/channels.TRACKS.out.rate_hz", "HEALTH/tracker/counters.scans.late", "POSE/position_map_m[1]", "TRACK/17/range_m"]) {
    assert.ok(paths.includes(path), `${path} in ${paths.join(" ")}`);
  }
  for (const path of paths.filter((one) => one !== "PAGE/num_returns")) assert.ok(Number.isFinite(valueIn(picture, path, 17)), path);
});

test("numbers are read by their paths", () => {
  assert.equal(valueIn(picture, "HEALTH/tracker/channels.SEGMENTS.in.rate_hz", null), 9);
  assert.equal(valueIn(picture, "HEALTH/tracker/counters.scans.late", null), 3);
  assert.equal(valueIn(picture, "POSE/position_map_m[1]", null), 4);
  assert.equal(valueIn(picture, "POSE/has_attitude", null), 1);
  assert.equal(valueIn(picture, "TRACK/chosen/range_m", 17), 31);
  for (const path of ["TRACK/chosen/range_m", "TRACK/18/range_m", "POSE/none", "HEALTH/none/cpu_fraction", "HEALTH/tracker/channels.ALERTS.out.rate_hz", "NONE/x"]) {
    assert.ok(Number.isNaN(valueIn(picture, path, null)), path);
  }
});

test("units follow from names, and like numbers share a chart", () => {
  assert.equal(unitOf("POSE/heading_rad").unit, "°");
  assert.equal(unitOf("HEALTH/tracker/channels.TRACKS.out.latency_p99_us").unit, "ms");
  assert.equal(unitOf("HEALTH/tracker/cpu_fraction").factor, 100);
  assert.equal(chartOf("HEALTH/tracker/cpu_fraction"), chartOf("HEALTH/segmenter/cpu_fraction"));
  assert.notEqual(chartOf("HEALTH/tracker/cpu_fraction"), chartOf("POSE/heading_rad"));
});

test("a ring keeps the last numbers, in the order of their times", () => {
  const ring = new Ring(3);
  for (const [time_s, value] of [[1, 10], [2, 20], [2, 99], [1.5, 99], [NaN, 99], [3, 30], [4, 40]] as const) ring.push(time_s, value);
  assert.deepEqual(ring.thinned(0, 10, 100), { times: [2, 3, 4], values: [20, 30, 40] });
});

test("thinning keeps the spike of one message, and gaps", () => {
  const ring = new Ring(1000);
  for (let i = 0; i < 1000; ++i) ring.push(i, i === 777 ? 50 : i >= 500 && i < 600 ? NaN : 1);
  const { times, values } = ring.thinned(0, 999, 20);
  assert.ok(times.length <= 41);
  assert.ok(values.includes(50));
  assert.ok(values.includes(null));
  assert.deepEqual(times, [...times].sort((a, b) => a - b));
});

test("a line ends where nothing came for long, also where it is thinned", () => {
  for (const buckets of [20, 1000]) {
    const ring = new Ring(1000);
    for (let i = 0; i < 600; ++i) ring.push(i < 300 ? 0.1 * i : 0.1 * i + 17, i % 7);
    const { times, values } = ring.thinned(0, 100, buckets);
    const inside = times.map((time, index) => ({ time, value: values[index] })).filter(({ time }) => time > 29.9005 && time < 47);
    assert.deepEqual(inside.map(({ value }) => value), [null, null], `${buckets} buckets`);
    assert.deepEqual(times, [...times].sort((a, b) => a - b));
  }
});

test("a heading that passes north goes on, and ends where it is", () => {
  assert.deepEqual(unwrapped([359, 1, null, 2]), [-1, 1, null, 2]);
  assert.deepEqual(unwrapped([2, 359, 358]), [362, 359, 358]);
  assert.deepEqual(unwrapped([10, 100, 190, 280, 10]), [-350, -260, -170, -80, 10]);
  assert.deepEqual([-1, 362, 360].map(onCircle), [359, 2, 0]);
});
