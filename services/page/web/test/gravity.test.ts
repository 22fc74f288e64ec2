import assert from "node:assert/strict";
import test from "node:test";
import { Alert, Track } from "../src/messages/generated.js";
import { Announcer, byDanger, byGravity, gravityOf, keepOrder, opensOut, overOf, patternOf } from "../src/views/gravity.js";

function alert(id: number, change: Partial<Alert> = {}): Alert {
  return {
    id, cause: Alert.CAUSE_CLOSEST_APPROACH, level: Alert.LEVEL_CAUTION, state: Alert.STATE_ACTIVE, track_id: id, raised_utime_us: id, changed_utime_us: id,
    distance_m: 10, bearing_rad: 0, cpa_m: 3, tcpa_s: 20, cpa_probability: 0.5, time_left_s: 15, text: `boat ${id}`, ...change,
  } as Alert;
}
function track(id: number, change: Partial<Track> = {}): Track {
  return { id, status: Track.STATUS_CONFIRMED, cpa_probability: 0, tcpa_s: 0, range_m: 10 * id, ...change } as Track;
}
const ids = (items: { id: number }[]) => items.map(({ id }) => id);

test("warnings that hold come first, acknowledged ones last; what is over stands apart, cleared ones not at all", () => {
  const list = [
    alert(1, { state: Alert.STATE_ACKNOWLEDGED, level: Alert.LEVEL_WARNING }), alert(2), alert(3, { level: Alert.LEVEL_WARNING }),
    alert(4, { state: Alert.STATE_RECTIFIED, level: Alert.LEVEL_WARNING }), alert(5, { state: Alert.STATE_CLEARED }),
  ];
  assert.deepEqual(ids(byGravity(list)), [3, 2, 1]);
  assert.deepEqual(ids(overOf(list)), [4]);
  assert.deepEqual(list.map(gravityOf), ["quiet", "caution", "warning", "quiet", "quiet"]);
});

test("alerts of one level stand by the time that is left, and change places only where that differs clearly", () => {
  const at = (a_s: number, b_s: number, before: number[] = []) => ids(byGravity([alert(1, { time_left_s: a_s }), alert(2, { time_left_s: b_s })], before));
  assert.deepEqual(at(50, 20), [2, 1]);
  assert.deepEqual(at(20, 50), [1, 2]);
  assert.deepEqual(at(9, 8.5, [1, 2]), [1, 2]);
  assert.deepEqual(at(8.5, 9, [2, 1]), [2, 1]);
  assert.deepEqual(at(9, 7, [1, 2]), [2, 1]);
  // What comes no nearer stands behind what does.
  assert.deepEqual(at(NaN, 60, [1, 2]), [2, 1]);
  assert.deepEqual(at(NaN, NaN, [1, 2]), [1, 2]);
});

test("of what does not come too near the nearer stands first, and what is not seen any more last", () => {
  const far = (id: number, distance_m: number, change: Partial<Alert> = {}) => alert(id, { time_left_s: NaN, distance_m, ...change });
  assert.deepEqual(ids(byGravity([far(1, 13), far(2, 78)], [1])), [1, 2], "although the other is new");
  assert.deepEqual(ids(byGravity([far(1, 13), far(2, 12)], [1, 2])), [1, 2], "hardly nearer");
  assert.deepEqual(ids(byGravity([far(1, 13), far(2, 10)], [1, 2])), [2, 1]);
  assert.deepEqual(ids(byGravity([far(1, 5, { sight: Alert.SIGHT_LOST }), far(2, 78)], [1, 2])), [2, 1]);
});

test("what is new stands before what leaves as much time, and level before time", () => {
  assert.deepEqual(ids(byGravity([alert(1), alert(2), alert(3)], [1, 2])), [3, 1, 2]);
  assert.deepEqual(ids(byGravity([alert(1, { time_left_s: 0 }), alert(2, { level: Alert.LEVEL_WARNING, time_left_s: 5 })], [1, 2])), [2, 1]);
});

test("what opens is known by its time; where nothing is known of that it may come", () => {
  assert.ok(opensOut(alert(1, { time_left_s: NaN, tcpa_s: 0 })));
  assert.ok(!opensOut(alert(1, { time_left_s: NaN, tcpa_s: NaN })));
  assert.ok(!opensOut(alert(1, { time_left_s: 0, tcpa_s: 3 })));
});

test("tracks stand by alert, probability, time, range", () => {
  const tracks = [
    track(1), track(2, { cpa_probability: 0.9, tcpa_s: 40 }), track(3, { cpa_probability: 0.9, tcpa_s: 10 }), track(4, { range_m: NaN }),
    track(5, { status: Track.STATUS_TENTATIVE }), track(6, { status: Track.STATUS_LOST }), track(7, { status: Track.STATUS_TENTATIVE }),
  ];
  const alerts = new Map([[7, alert(7)]]);
  assert.deepEqual(ids(byDanger(tracks, alerts, false)), [7, 3, 2, 1, 4]);
  assert.deepEqual(ids(byDanger(tracks, alerts, true)), [7, 3, 2, 1, 5, 4]);
});

test("rows keep their places while somebody points at them", () => {
  assert.deepEqual(ids(keepOrder([3, 1, 2], [{ id: 4 }, { id: 2 }, { id: 3 }])), [3, 2, 4]);
});

test("a screen reader hears an alert once, and again when it grows graver", () => {
  const announcer = new Announcer();
  assert.deepEqual(ids(announcer.take([alert(1)]).now), [1]);
  for (let scan = 0; scan < 10; ++scan) assert.deepEqual(announcer.take([alert(1, { text: `in ${scan} s` })]), { now: [], later: [] });
  assert.deepEqual(ids(announcer.take([alert(1, { level: Alert.LEVEL_WARNING })]).now), [1]);
  assert.deepEqual(ids(announcer.take([alert(1, { level: Alert.LEVEL_WARNING, state: Alert.STATE_ACKNOWLEDGED })]).later), [1]);
  assert.deepEqual(ids(announcer.take([alert(1, { level: Alert.LEVEL_WARNING })]).now), [1]);
});

test("the one sounds that the look-out names", () => {
  const alerts = [alert(1), alert(2, { level: Alert.LEVEL_WARNING })];
  assert.equal(patternOf(null), null);
  assert.equal(patternOf({ alerts, sounding_alert_id: 0 }), null);
  assert.equal(patternOf({ alerts, sounding_alert_id: 1 }), "caution");
  assert.equal(patternOf({ alerts, sounding_alert_id: 2 }), "warning");
  assert.equal(patternOf({ alerts, sounding_alert_id: 3 }), null);
});
