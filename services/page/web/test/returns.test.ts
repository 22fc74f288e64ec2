// Where returns of one or two lidars lie around the boat.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { BoatFacts } from "../src/link.js";
import { kSecondLidar, toReturns, type Looked } from "../src/picture.js";

// One ring, one column: a return 10 m ahead of the lidar, of this label.
function looked(label: number, end_utime_us = 1_000_000): Looked {
  const scan = {
    utime_us: end_utime_us - 100_000, end_utime_us, first_column: 3, num_columns: 1, num_rings: 1, num_returns: 1, range: Int32Array.of(5000), range_unit_m: 0.002, elevation_rad: Float32Array.of(0),
    azimuth_rad: Float32Array.of(0), azimuth_offset_rad: Float32Array.of(0), origin_height_m: Float32Array.of(0), time_ns: Int32Array.of(0), reflectivity: Uint8Array.of(9),
  };
  return { scan: [scan], labels: [{ first_column: 3, num_columns: 1, label: Int16Array.of(label) }] } as unknown as Looked;
}
const kAhead = { x_m: 0, y_m: 0, z_m: 1, roll_deg: 0, pitch_deg: 0, yaw_deg: 0 };
const boat = (lidar_2: typeof kAhead | null) => ({ reference_point_above_water_m: 0.5, lidar: kAhead, lidar_2 }) as unknown as BoatFacts;
const place = (level_m: Float32Array, index: number) => [...level_m.subarray(3 * index, 3 * index + 3)].map((value) => Math.round(1000 * value) / 1000 + 0);

test("the second lidar's returns stand behind the first's, by its own mounting", () => {
  const returns = toReturns(looked(4), looked(4), boat({ ...kAhead, x_m: -2, yaw_deg: 90 }), null, 0);
  assert.equal(returns.count, 2);
  assert.equal(returns.first_count, 1);
  assert.deepEqual(place(returns.level_m, 0), [10, 0, 1.5]);
  assert.deepEqual(place(returns.level_m, 1), [-2, 10, 1.5]);
  assert.deepEqual([...returns.label], [4, kSecondLidar + 4], "its segments have numbers of their own");
});
test("why a return of the second lidar belongs to nothing is said as of the first", () => {
  assert.deepEqual([...toReturns(looked(-2), looked(-5), boat(kAhead), null, 0).label], [-2, -5]);
});
test("without its mounting the second lidar is not drawn", () => {
  assert.equal(toReturns(looked(1), looked(1), boat(null), null, 0).count, 1);
  assert.equal(toReturns(looked(1), null, boat(kAhead), null, 0).count, 1);
});
