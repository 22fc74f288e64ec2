// Tracks on a plane: outline or mark, vector, trail, ellipse, closest approach, label.
import { Track } from "../messages/generated.js";
import type { Alert } from "../messages/generated.js";
import { texts } from "../texts/index.js";
import { duration, length, speed } from "../units.js";
import { shortNameOf } from "../views/track_words.js";
import { alertColour, alertLines } from "./alerts.js";
import { trackColour } from "./colours.js";
import { tracePath, type Scene } from "./scene.js";

const kVector_s = 30;
const kLeast_px = 11;  // of an outline; below, a mark of this size stands in its place

/** What raises an alert first, then what comes near soon, then by distance. */
export function danger(track: Track, alert: Alert | undefined): number {
  const raised = alert === undefined ? 0 : alert.level;
  return -1e9 * raised - 1e6 * (track.cpa_probability > 0.1 ? track.cpa_probability : 0) + (Number.isFinite(track.distance_m) ? track.distance_m : track.range_m);
}

export function isShown({ state, picture }: Scene, track: Track): boolean {
  if (track.status === Track.STATUS_LOST) return false;
  return track.status !== Track.STATUS_TENTATIVE || state.settings.get("shows_tentative") || picture.alert_of_track.has(track.id) || state.marked.track === track.id || state.chosen === track.id;
}

export function paintTrails({ context, plane, trails, picture, theme, state }: Scene): void {
  if (!state.settings.get("shows_trails")) return;
  context.lineWidth = 1.5;
  context.lineJoin = "round";
  context.globalAlpha = 0.55;
  for (const track of picture.tracks) {
    if (track.status === Track.STATUS_TENTATIVE || !(track.speed_mps > 0.3)) continue;
    const places = trails.places.get(track.id)?.places_m;
    if (places === undefined || places.length < 2) continue;
    context.strokeStyle = theme.css[trackColour(track, picture.alert_of_track.get(track.id))];
    context.beginPath();
    for (let i = 0; i + 1 < places.length; i += 2) {
      const x = plane.x(places[i]!, places[i + 1]!), y = plane.y(places[i]!, places[i + 1]!);
      if (i === 0) context.moveTo(x, y); else context.lineTo(x, y);
    }
    context.lineTo(plane.x(track.position_map_m[0]!, track.position_map_m[1]!), plane.y(track.position_map_m[0]!, track.position_map_m[1]!));
    context.stroke();
  }
  context.globalAlpha = 1;
}

/** All tracks, the gravest last so that it lies on top; adds their labels, the gravest first. */
export function paintTracks(scene: Scene): void {
  const { context, picture, plane, state, trails, theme } = scene;
  const shown = picture.tracks.filter((track) => isShown(scene, track) && plane.sees(track.position_map_m[0]!, track.position_map_m[1]!, track.length_m + 30 * (track.speed_mps || 0)))
    .map((track) => ({ track, alert: picture.alert_of_track.get(track.id) })).map((entry) => ({ ...entry, rank: danger(entry.track, entry.alert) }))
    .sort((a, b) => b.rank - a.rank);
  for (const { track, utime_us } of trails.lost.values()) {
    if (track.existence_probability < 0.5 && track.status === Track.STATUS_TENTATIVE) continue;
    context.globalAlpha = 0.7 * trails.strength(utime_us);
    paintBody(scene, track, undefined, theme.css.muted);
  }
  context.globalAlpha = 1;
  // Of a thing in alert its label has that in words.
  const gravest = shown.at(-1)?.alert === undefined ? shown.at(-1)?.track : undefined;
  for (const { track, alert } of shown) paintTrack(scene, track, alert, track === gravest || (track.id === state.chosen && alert === undefined));
  for (const { track, alert } of shown.reverse()) {
    const half = kLeast_px / 2, x = plane.x(track.position_map_m[0]!, track.position_map_m[1]!), y = plane.y(track.position_map_m[0]!, track.position_map_m[1]!);
    scene.taken.push({ x: x - half, y: y - half, width: kLeast_px, height: kLeast_px });
    const isOn = state.marked.track === track.id || state.chosen === track.id;
    if (track.status === Track.STATUS_TENTATIVE && alert === undefined && !isOn) continue;
    const radius_px = Math.max(kLeast_px, Math.min(30, track.width_m * plane.px_per_m / 2));
    const isRaised = alert !== undefined, moves = track.speed_mps > 0.3, range = length(state.settings, track.range_m);
    // Many stand about: of them the number and the range in one line is enough.
    const isPlain = !isRaised && !isOn && !moves && !picture.name_of_track.has(track.id) && !picture.ship_of_track.has(track.id);
    const name = shortNameOf(track, picture), ship = picture.ship_of_track.get(track.id), facts = moves ? `${range}  ${speed(state.settings, track.speed_mps)}` : range;
    const label = {
      x_px: x, y_px: y, radius_px,
      lines: isPlain ? [texts.drawing.plain(track.kind, track.id, range)] : ship === undefined || ship.name === "" ? [name, facts] : [name, texts.drawing.mmsi(ship.mmsi), facts],
      colour: theme.css[isRaised || isOn ? trackColour(track, alert) : isPlain ? "muted" : "text"], isBoxed: isRaised || isOn,
      ...(isRaised ? alertLines(scene, alert) : {}),
    };
    if (isOn) scene.labels.unshift(label); else scene.labels.push(label);
  }
}

function paintTrack(scene: Scene, track: Track, alert: Alert | undefined, isNamed: boolean): void {
  const { context, plane, picture, state, theme } = scene;
  const colour = theme.css[trackColour(track, alert)];
  const x = plane.x(track.position_map_m[0]!, track.position_map_m[1]!), y = plane.y(track.position_map_m[0]!, track.position_map_m[1]!);
  const isRaised = alert !== undefined;
  if (state.settings.get("shows_ellipses") || state.chosen === track.id) paintEllipse(scene, track, colour);
  if (track.speed_mps > 0.3) {
    const east = track.position_map_m[0]! + kVector_s * track.velocity_map_mps[0]!, north = track.position_map_m[1]! + kVector_s * track.velocity_map_mps[1]!;
    context.strokeStyle = colour;
    context.lineWidth = isRaised ? 3 : 2;
    context.beginPath();
    context.moveTo(x, y);
    const ex = plane.x(east, north), ey = plane.y(east, north), far = Math.hypot(ex - x, ey - y);
    context.lineTo(ex, ey);
    if (far > 14) {
      const ux = (ex - x) / far, uy = (ey - y) / far;
      context.moveTo(ex - 8 * ux + 4 * uy, ey - 8 * uy - 4 * ux);
      context.lineTo(ex, ey);
      context.lineTo(ex - 8 * ux - 4 * uy, ey - 8 * uy + 4 * ux);
    }
    context.stroke();
  }
  if (track.status === Track.STATUS_TENTATIVE && !isRaised) { context.globalAlpha = 0.6; context.setLineDash([2, 3]); }
  else if (track.status === Track.STATUS_COASTING) context.setLineDash([5, 4]);
  paintBody(scene, track, alert, colour);
  context.setLineDash([]);
  context.globalAlpha = 1;
  const isOn = state.marked.track === track.id || state.chosen === track.id;
  if (isRaised || isOn) {
    const radius = Math.max(17, Math.max(track.length_m, track.width_m) * plane.px_per_m / 2 + 8);
    context.strokeStyle = isOn ? theme.css.text : colour;
    context.lineWidth = 2.5;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    if (isRaised && alertColour(alert) === "warning") { context.moveTo(x + radius + 5, y); context.arc(x, y, radius + 5, 0, 2 * Math.PI); }
    context.stroke();
  }
  if ((isRaised || state.chosen === track.id) && track.tcpa_s > 0 && track.tcpa_s < 900 && picture.pose !== null) paintApproach(scene, track, colour, isNamed);
}

// Its outline, softly filled; what would be too small to be seen is a mark that says its kind.
function paintBody(scene: Scene, track: Track, alert: Alert | undefined, colour: string): void {
  const { context, plane } = scene;
  const x = plane.x(track.position_map_m[0]!, track.position_map_m[1]!), y = plane.y(track.position_map_m[0]!, track.position_map_m[1]!);
  context.strokeStyle = colour;
  context.fillStyle = colour;
  context.lineWidth = alert === undefined ? 1.8 : 2.5;
  context.lineJoin = "round";
  context.beginPath();
  if (track.num_outline > 2 && track.length_m * plane.px_per_m >= kLeast_px) {
    tracePath(scene, track.outline_east_m, track.outline_north_m, true);
  } else {
    const r = kLeast_px / 2 + 1;
    if (track.kind === Track.KIND_BOAT) {
      const way = (Number.isFinite(track.course_rad) ? track.course_rad : track.length_bearing_rad) - plane.up, s = Math.sin(way), c = -Math.cos(way);
      context.moveTo(x + 1.5 * r * s, y + 1.5 * r * c);
      context.lineTo(x - r * s - 0.8 * r * c, y - r * c + 0.8 * r * s);
      context.lineTo(x - r * s + 0.8 * r * c, y - r * c - 0.8 * r * s);
      context.closePath();
    } else if (track.kind === Track.KIND_STRUCTURE) context.rect(x - r, y - r, 2 * r, 2 * r);
    else {
      context.arc(x, y, r, 0, 2 * Math.PI);
      if (track.kind === Track.KIND_BUOY) { context.moveTo(x + 1.5, y); context.arc(x, y, 1.5, 0, 2 * Math.PI); }
    }
  }
  const before = context.globalAlpha;
  context.globalAlpha = before * (alert === undefined ? 0.22 : 0.4);
  context.fill();
  context.globalAlpha = before;
  context.stroke();
}

/** Half axes of the ellipse that holds 95 of 100, m, and the direction of the longer, from north clockwise, rad. */
export function ellipseOf(east_east: number, east_north: number, north_north: number): { a_m: number; b_m: number; bearing_rad: number } {
  const mean = (east_east + north_north) / 2, spread = Math.hypot((north_north - east_east) / 2, east_north);
  const k95 = 2.4477;
  return { a_m: k95 * Math.sqrt(mean + spread), b_m: k95 * Math.sqrt(Math.max(0, mean - spread)), bearing_rad: 0.5 * Math.atan2(2 * east_north, north_north - east_east) };
}
function paintEllipse({ context, plane }: Scene, track: Track, colour: string): void {
  const { a_m, b_m, bearing_rad } = ellipseOf(track.covariance_relative_m2[0]!, track.covariance_relative_m2[1]!, track.covariance_relative_m2[2]!);
  if (!Number.isFinite(a_m) || !Number.isFinite(b_m)) return;
  context.strokeStyle = colour;
  context.lineWidth = 1;
  context.globalAlpha = 0.6;
  context.beginPath();
  context.ellipse(plane.x(track.position_map_m[0]!, track.position_map_m[1]!), plane.y(track.position_map_m[0]!, track.position_map_m[1]!),
    a_m * plane.px_per_m, b_m * plane.px_per_m, bearing_rad - plane.up - Math.PI / 2, 0, 2 * Math.PI);
  context.stroke();
  context.globalAlpha = 1;
}

// Where both will be at the closest approach, and the line between; in words for the gravest alone.
function paintApproach(scene: Scene, track: Track, colour: string, isNamed: boolean): void {
  const { context, plane, own, picture, state, theme } = scene;
  const t = track.tcpa_s, velocity = picture.pose!.velocity_map_mps;
  const own_east = own.east_m + t * (velocity[0]! || 0), own_north = own.north_m + t * (velocity[1]! || 0);
  const east = track.position_map_m[0]! + t * track.velocity_map_mps[0]!, north = track.position_map_m[1]! + t * track.velocity_map_mps[1]!;
  const x1 = plane.x(own_east, own_north), y1 = plane.y(own_east, own_north), x2 = plane.x(east, north), y2 = plane.y(east, north);
  context.strokeStyle = colour;
  context.lineWidth = 1.2;
  context.setLineDash([3, 4]);
  context.beginPath();
  context.moveTo(plane.x(own.east_m, own.north_m), plane.y(own.east_m, own.north_m));
  context.lineTo(x1, y1);
  context.moveTo(plane.x(track.position_map_m[0]!, track.position_map_m[1]!), plane.y(track.position_map_m[0]!, track.position_map_m[1]!));
  context.lineTo(x2, y2);
  context.stroke();
  context.setLineDash([]);
  context.lineWidth = 3;
  context.beginPath();
  context.moveTo(x1, y1);
  context.lineTo(x2, y2);
  context.stroke();
  for (const [x, y, fill] of [[x1, y1, theme.css.own], [x2, y2, colour]] as const) {
    context.fillStyle = fill;
    context.beginPath();
    context.arc(x, y, 4.5, 0, 2 * Math.PI);
    context.fill();
  }
  if (isNamed) scene.labels.unshift({ x_px: (x1 + x2) / 2, y_px: (y1 + y2) / 2, radius_px: 8, lines: [texts.drawing.approach(length(state.settings, track.cpa_m), duration(t))], colour, isBoxed: false });
}
