// What is drawn where: planes, picking, colours, labels, matrices, the earth. Pure functions of src/drawing.
// Node's own types are not among the packages of the page: esbuild bundles this file, and tsc does not check it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { fillColours, kRamps, luminance, parseColour, rampColour, distinctColour, rampOf, standingOut, type Theme } from "../src/drawing/colours.js";
import { blindSectors } from "../src/drawing/blind.js";
import { drawLabels, placeFor, within } from "../src/drawing/labels.js";
import { lookAt, perspective, product, project } from "../src/drawing/matrix.js";
import { gridStep, latitudeOf, longitudeOf, mercatorX, mercatorY, offset, position, widthAt, zoomFor } from "../src/drawing/mercator.js";
import { ringStep } from "../src/drawing/own_boat.js";
import { isInside, pickReturn, pickTrack } from "../src/drawing/pick.js";
import { plot } from "../src/drawing/plain_points.js";
import { distanceToLine, niceStep, Plane } from "../src/drawing/plane.js";
import { ellipseOf } from "../src/drawing/tracks.js";
import { columnTurns } from "../src/views/range_image.js";

const near = (actual: number, expected: number, tolerance = 1e-6) => { assert.ok(Math.abs(actual - expected) <= tolerance, `${actual} in place of ${expected}`); };

function plane(up = 0): Plane {
  const made = new Plane();
  Object.assign(made, { width_px: 800, height_px: 600, px_per_m: 5, east_m: 100, north_m: -50 });
  made.up = up;
  return made;
}
function track(id: number, east: number, north: number, half = 1) {
  return { id, num_outline: 4, position_map_m: [east, north], outline_east_m: [east - half, east + half, east + half, east - half], outline_north_m: [north - half, north - half, north + half, north + half] };
}
const theme = { isNight: false, isDark: false, css: {}, rgb: { text: [1, 1, 1], muted: [2, 2, 2], track: [3, 3, 3], moving: [4, 4, 4], warning: [5, 5, 5], caution: [6, 6, 6], land: [7, 7, 7], returns: [8, 8, 8], tentative: [9, 9, 9] } } as unknown as Theme;
function picture(labels: number[], more: object = {}) {
  const count = labels.length, level_m = new Float32Array(3 * count);
  labels.forEach((_, i) => { level_m[3 * i] = 10 * (i + 1); });
  return {
    returns: { count, level_m, label: Int16Array.from(labels), reflectivity: new Uint8Array(count) }, track_of_segment: new Map(), alert_of_track: new Map(), land_segments: new Set(), ...more,
  } as never;
}

test("north is up, and east is to the right", () => {
  const p = plane();
  near(p.x(100, -50), 400);
  near(p.y(100, -50), 300);
  near(p.y(100, -40), 250);
  near(p.x(110, -50), 450);
});
test("with the bow up, what is ahead is above the own boat", () => {
  const p = plane(Math.PI / 2);  // heading east
  near(p.x(110, -50), 400);
  near(p.y(110, -50), 250);
  near(p.x(100, -60), 450);  // south is to starboard
});
test("a pixel and its place belong to each other at any heading", () => {
  for (const up of [0, 0.7, 3, -2]) {
    const p = plane(up), [east, north] = p.place(123, 456);
    near(p.x(east, north), 123, 1e-9);
    near(p.y(east, north), 456, 1e-9);
    p.put([1, 2], 50, 60);
    near(p.x(1, 2), 50, 1e-9);
    near(p.y(1, 2), 60, 1e-9);
  }
});
test("an unknown heading is no heading", () => {
  const p = plane(NaN);
  near(p.y(100, -40), 250);
});
test("returns lie where the plane has their places", () => {
  const p = plane(0.4), heading = 1.1, own: [number, number] = [103, -47];
  const m = p.fromLevel(...own, heading);
  for (const [x, y] of [[0, 0], [20, 3], [-7, 12]] as const) {
    const east = own[0] + x * Math.sin(heading) - y * Math.cos(heading), north = own[1] + x * Math.cos(heading) + y * Math.sin(heading);
    near((m[0]! * x + m[4]! * y + m[12]! + 1) / 2 * 800, p.x(east, north), 0.01);
    near((1 - (m[1]! * x + m[5]! * y + m[13]!)) / 2 * 600, p.y(east, north), 0.01);
  }
});
test("steps are 1, 2, 5", () => {
  assert.deepEqual([0.03, 1, 1.1, 2.1, 7, 180].map(niceStep).map((value) => Number(value.toPrecision(6))), [0.05, 1, 2, 5, 10, 200]);
  assert.equal(Number(ringStep(1, false).toPrecision(6)), 100);
  near(ringStep(0.1, true), 0.5 * 1852, 1e-6);
});
test("the nearest track under the pointer is picked, and none that is too far", () => {
  const p = plane(), tracks = [track(1, 100, -50), track(2, 104, -50)] as never;
  assert.equal(pickTrack(p, tracks, 401, 300, 14)?.id, 1);
  assert.equal(pickTrack(p, tracks, 419, 300, 14)?.id, 2);
  assert.equal(pickTrack(p, tracks, 400, 400, 14), null);
});
test("a large outline is picked anywhere inside of it", () => {
  assert.equal(pickTrack(plane(), [track(7, 100, -50, 30)] as never, 500, 350, 14)?.id, 7);
});
test("a return is picked by its place, the own boat's own never", () => {
  const p = plane();
  assert.equal(pickReturn(p, picture([3, -1]), 100, -50, 0, 400, 200, 8), 1);
  assert.equal(pickReturn(p, picture([3, -2]), 100, -50, 0, 400, 200, 8), -1);
  assert.equal(pickReturn(p, picture([3]), 100, -50, Math.PI / 2, 450, 300, 8), 0);
});
test("inside of an outline", () => {
  assert.ok(isInside(1, 1, [0, 4, 4, 0], [0, 0, 4, 4]));
  assert.ok(!isInside(5, 1, [0, 4, 4, 0], [0, 0, 4, 4]));
  near(distanceToLine(5, 3, 0, 0, 4, 0), Math.hypot(1, 3));
  near(distanceToLine(5, 3, 2, 3, 2, 3), 3);
});
test("colours are read in the spellings of style sheets", () => {
  assert.deepEqual(parseColour(" #0af "), [0, 170, 255]);
  assert.deepEqual(parseColour("rgb(1 2 3 / 50%)"), [1, 2, 3]);
  assert.deepEqual(parseColour("rgba(1, 2, 3, 0.5)"), [1, 2, 3]);
  assert.equal(parseColour("var(--x)"), null);
  near(luminance([255, 255, 255]), 1, 1e-3);
});
test("at night nothing is blue, and hardly anything green", () => {
  for (let id = 1; id < 300; ++id) {
    const [r, g, b] = distinctColour(id, true, true);
    assert.ok(r > 100 && g < 0.62 * r && b < 0.62 * r, `${id}: ${r} ${g} ${b}`);
  }
  for (let share = 0; share <= 1; share += 0.01) assert.ok(rampColour(share, true, true)[2] <= 10);
});
test("returns have the colour of their track, what it is raised for first", () => {
  const moving = { id: 4, status: 2, speed_mps: 3, course_rad: 1 }, standing = { id: 5, status: 2, speed_mps: 0, course_rad: NaN };
  const track_of_segment = new Map([[1, moving], [2, standing], [3, standing]]);
  const alert_of_track = new Map([[4, { level: 2, state: 1 }]]);
  const out = new Uint8Array(24);
  const given = { theme, colour_by: "track", track: null, segment: null, chosen: null } as const;
  fillColours(picture([1, 2, 6, 9, -5, -2], { track_of_segment, alert_of_track, land_segments: new Set([6]) }), given, out);
  assert.deepEqual([0, 4, 8, 12].map((at) => out[at]), [5, 3, 7, 8]);
  assert.ok(out[19]! > 0 && out[19]! < 255);
  assert.equal(out[23], 0);
});
// The range image had the colours of tracks: how far a thing is could not be seen in it.
test("by range what is near has the colour that warns, and each doubling is as far apart", () => {
  const out = new Uint8Array(16), given = picture([1, 1, 1, 1], {}) as { returns: { range_m: Float32Array } };
  given.returns.range_m = Float32Array.of(0.5, 1, 100, 400);
  fillColours(given as never, { theme, colour_by: "range", track: null, segment: null, chosen: null }, out);
  assert.deepEqual([...out.slice(0, 3)], [...rampColour(1, false, false)]);
  assert.deepEqual([...out.slice(4, 7)], [...rampColour(1, false, false)]);
  assert.deepEqual([...out.slice(8, 11)], [...rampColour(0, false, false)]);
  assert.deepEqual([...out.slice(12, 15)], [...rampColour(0, false, false)]);
  const { range } = kRamps;
  near(range.share(2) - range.share(4), range.share(20) - range.share(40), 1e-9);
  assert.equal(rampOf("track"), undefined);
  for (const by of ["range", "height", "reflectivity"] as const) for (const tick of rampOf(by)!.ticks) assert.ok(rampOf(by)!.share(tick) >= -1e-9 && rampOf(by)!.share(tick) <= 1 + 1e-9, `${by} ${tick}`);
});
const unseen = (text: string, change: object = {}) => ({ cause: 3, id: 5, state: 1, text: `no look-out in part of the guard zone: ${text}`, ...change });
test("where nobody looks is read out of the alert that says so", () => {
  assert.deepEqual(blindSectors([unseen("300 to 60 deg, from 5.0 m on (beyond max_range_m of the segmenter)")]), [{ from_deg: 300, to_deg: 60, near_m: 5, far_m: Infinity }]);
  assert.deepEqual(blindSectors([unseen("300 to 60 deg, up to 10.0 m (nearer than min_range_m of the segmenter)")]), [{ from_deg: 300, to_deg: 60, near_m: 0, far_m: 10 }]);
  assert.deepEqual(blindSectors([unseen("320 to 352 deg (the own boat hides it); 10 to 20 deg, 4.0 to 6.5 m (the own boat hides it); and 2 more")]),
    [{ from_deg: 320, to_deg: 352, near_m: 0, far_m: Infinity }, { from_deg: 10, to_deg: 20, near_m: 4, far_m: 6.5 }]);
  assert.deepEqual(blindSectors([unseen("all round (the lidar does not fire there)")]), [{ from_deg: 0, to_deg: 360, near_m: 0, far_m: Infinity }]);
});
test("the watch, what is over, and other alerts say nothing of where nobody looks", () => {
  const text = "270 to 90 deg (the lidar does not fire there)";
  assert.equal(blindSectors([unseen(text, { state: 2 })]).length, 1, "also while it is acknowledged");
  assert.deepEqual(blindSectors([unseen(text, { id: -1 }), unseen(text, { state: 4 }), unseen(text, { cause: 1 })]), []);
});
test("what is marked is marked whatever the colours are by", () => {
  const out = new Uint8Array(8);
  for (const colour_by of ["segment", "track", "height", "reflectivity"] as const) {
    fillColours(picture([1, 2]), { theme, colour_by, track: null, segment: 2, chosen: null }, out);
    assert.equal(out[4], 1);
    assert.notEqual(out[0], 1);
  }
});
test("a label goes to the next side that is free, or nowhere", () => {
  const label = { x_px: 100, y_px: 100, radius_px: 4 }, size = { width_px: 200, height_px: 200 };
  assert.equal(placeFor(label, 60, 20, size, [])?.x, 110);
  assert.equal(placeFor(label, 60, 20, size, [{ x: 120, y: 95, width: 10, height: 10 }])?.x, 30);
  assert.equal(placeFor(label, 60, 20, size, [{ x: 0, y: 0, width: 200, height: 200 }]), null);
  assert.equal(placeFor({ ...label, x_px: 190 }, 60, 20, size, [])?.x, 120);
});
test("labels that must be drawn are drawn whatever stands before them", () => {
  const written: string[] = [], none = () => undefined;
  const context = { measureText: () => ({ width: 6 }), strokeText: none, beginPath: none, roundRect: none, fill: none, fillText: (text: string) => { written.push(text); } };
  const plain = (i: number) => ({ x_px: 100, y_px: 40 * i, radius_px: 4, lines: [`ship ${i}`], colour: "", isBoxed: false });
  const alert = { ...plain(20), lines: ["boat 17"], isBoxed: true, shorter: [["17"]] };
  const sheet = { width_px: 400, height_px: 2000, covered: [] }, theme = { css: { panel: "", water: "" } };
  drawLabels(context as never, [...Array(10).keys()].map(plain).concat(alert as never), theme as never, sheet, 8, []);
  assert.equal(written.length, 9);
  assert.equal(written.at(-1), "boat 17");
});
test("a label that must be drawn lies over marks and other labels, but not under a button", () => {
  const label = { x_px: 170, y_px: 100, radius_px: 4 }, sheet = { width_px: 200, height_px: 400, covered: [{ x: 90, y: 60, width: 110, height: 80 }] };
  const box = within(label, 60, 20, sheet, []);
  assert.ok(box.x + box.width < 90 || box.y + box.height < 60 || box.y > 140, JSON.stringify(box));
  const all = [{ x: 0, y: 0, width: 200, height: 400 }];
  assert.deepEqual(within(label, 60, 20, sheet, all), box);
  assert.equal(within(label, 60, 20, { ...sheet, covered: all }, []).x, 100);
});
test("the eye sees its target in the middle, and nothing behind it", () => {
  const m = product(perspective(0.9, 1.5, 1, 100), lookAt([0, 0, 10], [20, 0, 0], [0, 0, 1]));
  const middle = project(m, 20, 0, 0)!;
  near(middle[0], 0, 1e-6);
  near(middle[1], 0, 1e-6);
  assert.ok(project(m, 20, 3, 0)![0] < 0, "port is to the left");
  assert.ok(project(m, 20, 0, 3)![1] > 0, "up is up");
  assert.equal(project(m, -20, 0, 20), null);
});
test("mercator there and back", () => {
  for (const [latitude, longitude] of [[54.3, 10.1], [-33.8, 151.2], [0, -180], [84, 0]] as const) {
    near(latitudeOf(mercatorY(latitude)), latitude, 1e-9);
    near(longitudeOf(mercatorX(longitude)), longitude, 1e-9);
  }
  near(mercatorY(85.0511287798), 0, 1e-4);
  near(widthAt(60) / widthAt(0), 0.5, 1e-9);
  assert.equal(zoomFor(256 * 2 ** 14, 0, 18), 14);
  assert.equal(zoomFor(256 * 2 ** 20, 0, 18), 18);
});
test("distances on the earth, also over 180 degrees", () => {
  const [east, north] = offset(54, 10, 54.001, 10.001);
  near(north, 111.3, 0.1);
  near(east, 65.6, 0.1);
  near(offset(10, 179.999, 10, -179.999)[0], 219.3, 0.3);
});
test("positions as charts have them", () => {
  assert.equal(position(54.3187, true), "54° 19.122' N");
  assert.equal(position(-10.99999999, false), "011° 00.000' W");
  assert.equal(position(9.5, false, 0), "009° 30' E");
  assert.equal(position(NaN, true), "–");
  assert.equal(gridStep(0.3), 0.5);
  assert.equal(gridStep(12), 20);
});
test("an ellipse lies along the direction in which least is known", () => {
  const { a_m, b_m, bearing_rad } = ellipseOf(4, 0, 1);
  near(a_m / b_m, 2, 1e-9);
  near(Math.abs(bearing_rad), Math.PI / 2, 1e-9);
  near(ellipseOf(2, 1.5, 2).bearing_rad, Math.PI / 4, 1e-9);
});
test("the bow is in the middle of the range image, whatever way the lidar is mounted", () => {
  const turns = new Float32Array(4), degree = Math.PI / 180;
  columnTurns({ boat: { lidar: { yaw_deg: 5 } }, scan: [{ num_columns: 3, first_column: 0, azimuth_rad: [5 * degree, 95 * degree, 275 * degree] }] } as never, turns);
  near(turns[0]!, 0, 1e-6);
  near(turns[1]!, 0.25, 1e-6);
  near(turns[2]!, -0.25, 1e-6);
  assert.ok(Number.isNaN(turns[3]!));
});
test("plotted points lie where the matrix puts them, and the nearer one is in front", () => {
  const words = new Uint32Array(100), none = new Float32Array(), one = Float32Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
  const points = { places: Float32Array.of(0.05, 0.05, 0, -2, 0, 0, 0.05, 0.05, 0), colours: Uint8Array.of(1, 2, 3, 255, 9, 9, 9, 255, 4, 4, 4, 0), count: 3 };
  plot(one, points, 1, words, none, 10, 10);
  assert.deepEqual([...words.entries()].filter(([, word]) => word !== 0), [[45, 0xff030201]]);
  const m = perspective(0.9, 1, 1, 100), depth = new Float32Array(100).fill(Infinity);
  words.fill(0);
  plot(m, { places: Float32Array.of(0, 0, -5, 0, 0, -9, 0, 0, 5), colours: Uint8Array.of(1, 0, 0, 255, 2, 0, 0, 255, 3, 0, 0, 255), count: 3 }, 1, words, depth, 10, 10);
  assert.deepEqual([...words].filter((word) => word !== 0), [0xff000001]);
});
test("land stands out from the water in every palette", () => {
  assert.deepEqual(standingOut([90, 60, 0], [255, 255, 255], [0, 0, 0]), [90, 60, 0]);
  const mixed = standingOut([230, 220, 160], [255, 255, 255], [0, 0, 0]);
  assert.ok(1.05 / (luminance(mixed) + 0.05) >= 3);
});
