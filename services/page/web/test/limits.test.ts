// Limits in force, as the form of the settings shows them.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Alerts } from "../src/messages/generated.js";
import { zonesOf } from "../src/drawing/own_boat.js";
import { limitOf } from "../src/views/limits.js";

const report = { guard_zone_range_m: 10.000001, guard_zone_from_rad: 300 * Math.PI / 180, guard_zone_to_rad: 420 * Math.PI / 180, cpa_limit_m: 5 } as Alerts;

test("a sector over the bow is told from 0 to 360 deg, and a whole circle stays one", () => {
  assert.equal(limitOf(report, "guard_zone_range_m"), 10);
  assert.equal(limitOf(report, "guard_zone_from_deg"), 300);
  assert.equal(limitOf(report, "guard_zone_to_deg"), 60);
  assert.equal(limitOf({ ...report, guard_zone_from_rad: 0, guard_zone_to_rad: 2 * Math.PI }, "guard_zone_to_deg"), 360);
  assert.equal(limitOf({ ...report, guard_zone_from_rad: 0, guard_zone_to_rad: Math.fround(2 * Math.PI) }, "guard_zone_to_deg"), 360);  // as it comes over the wire
});

test("the zone in force is drawn, not that of the config", () => {
  const boat = { guard_zones: [{ name: "", range_m: 15, from_deg: 0, to_deg: 90 }] } as never;
  assert.deepEqual(zonesOf({ alert_report: null, boat }).map(({ range_m }) => range_m), [15]);
  assert.ok(Math.abs(zonesOf({ alert_report: report, boat })[0]!.range_m - 10) < 0.01);
  assert.deepEqual(zonesOf({ alert_report: { ...report, guard_zone_range_m: 0 }, boat }), []);
});
