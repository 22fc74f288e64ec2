// The own boat, and what is measured from it: rings, guard zones, heading and way.
import { holds, isOnlyCourse, type Picture } from "../picture.js";
import { texts } from "../texts/index.js";
import { length } from "../units.js";
import { alertColour } from "./alerts.js";
import { blindSectors } from "./blind.js";
import { kFont, type Box } from "./labels.js";
import { niceStep } from "./plane.js";
import { boatX, boatY, type Scene } from "./scene.js";

const kMetresPerMile = 1852;
const kRing_px = 84;
const kVector_s = 30;
const kHatch_px = 9;

/** Distance of two rings, m: a round number of the unit that is chosen. */
export function ringStep(px_per_m: number, inMiles: boolean): number {
  const least_m = kRing_px / px_per_m;
  return inMiles && least_m >= 0.1 * kMetresPerMile ? niceStep(least_m / kMetresPerMile) * kMetresPerMile : niceStep(least_m);
}

/** Rings around the own boat, with their distances, and a tick each 30 degrees on the first. @returns boxes of its words */
export function paintRings(scene: Scene): Box[] {
  const { context, plane, own, theme, state } = scene;
  const x = plane.x(own.east_m, own.north_m), y = plane.y(own.east_m, own.north_m);
  const step_m = ringStep(plane.px_per_m, state.settings.get("length_unit") === "NM");
  const farthest_px = Math.hypot(Math.max(x, plane.width_px - x), Math.max(y, plane.height_px - y));
  const boxes: Box[] = [];
  if (farthest_px > 60 * kRing_px) return boxes;
  const numRings = Math.min(40, Math.ceil(farthest_px / (step_m * plane.px_per_m)));
  context.strokeStyle = theme.css.line;
  context.lineWidth = 1;
  context.beginPath();
  for (let k = 1; k <= numRings; ++k) {
    const radius = k * step_m * plane.px_per_m;
    context.moveTo(x + radius, y);
    context.arc(x, y, radius, 0, 2 * Math.PI);
  }
  const inner = step_m * plane.px_per_m * 0.92;
  for (let degrees = 0; degrees < 360; degrees += 30) {
    const angle = degrees * Math.PI / 180 - plane.up, sin = Math.sin(angle), cos = -Math.cos(angle), outer = inner / 0.92;
    context.moveTo(x + inner * sin, y + inner * cos);
    context.lineTo(x + outer * sin, y + outer * cos);
  }
  context.stroke();
  context.font = kFont;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineJoin = "round";
  context.strokeStyle = theme.css.water;
  context.lineWidth = 4;
  context.fillStyle = theme.css.muted;
  for (let k = 1; k <= numRings; ++k) {
    const at = y + k * step_m * plane.px_per_m;
    if (at > plane.height_px - 12 || at < 12) continue;
    const text = length(state.settings, k * step_m).replace(".0 ", " ");
    context.strokeText(text, x, at);
    context.fillText(text, x, at);
    boxes.push({ x: x - 24, y: at - 8, width: 48, height: 16 });
  }
  if (!own.isOnMap) return boxes;
  const edge = inner / 0.92 + 12, nx = x - edge * Math.sin(plane.up), ny = y - edge * Math.cos(plane.up);
  context.strokeText(texts.drawing.north, nx, ny);
  context.fillStyle = theme.css.text;
  context.fillText(texts.drawing.north, nx, ny);
  boxes.push({ x: nx - 8, y: ny - 8, width: 16, height: 16 });
  return boxes;
}

/** The guard zone in force, as ALERTS tell it; without ALERTS those of the config. */
export function zonesOf(picture: Pick<Picture, "alert_report" | "boat">): { range_m: number; from_deg: number; to_deg: number }[] {
  const report = picture.alert_report;
  if (report === null) return picture.boat?.guard_zones ?? [];
  const degrees = (radians: number) => radians * 180 / Math.PI;
  return report.guard_zone_range_m > 0 ? [{ range_m: report.guard_zone_range_m, from_deg: degrees(report.guard_zone_from_rad), to_deg: degrees(report.guard_zone_to_rad) }] : [];
}

/** Sectors in which anything raises an alert; filled where one is raised now. */
export function paintGuardZones(scene: Scene): void {
  const { context, plane, own, theme, picture } = scene;
  const x = plane.x(own.east_m, own.north_m), y = plane.y(own.east_m, own.north_m);
  const inside = picture.alerts.filter((alert) => holds(alert) && alert.is_in_zone);
  const raised = inside.length === 0 ? null : inside.some((alert) => alertColour(alert) === "warning") ? theme.css.warning : theme.css.caution;
  for (const zone of zonesOf(picture)) {
    const turn = own.heading_rad - plane.up - Math.PI / 2;
    const from = zone.from_deg * Math.PI / 180 + turn;
    const sweep = ((zone.to_deg - zone.from_deg) % 360 + 360) % 360 || 360;
    const to = from + sweep * Math.PI / 180;
    context.beginPath();
    if (sweep < 360) context.moveTo(x, y);
    context.arc(x, y, zone.range_m * plane.px_per_m, from, to);
    if (sweep < 360) context.closePath();
    context.fillStyle = raised ?? theme.css.accent;
    context.globalAlpha = raised === null ? 0.05 : 0.14;
    context.fill();
    context.globalAlpha = raised === null ? 0.55 : 1;
    context.strokeStyle = raised ?? theme.css.accent;
    context.lineWidth = raised === null ? 1.2 : 2;
    context.setLineDash([6, 4]);
    context.stroke();
    context.setLineDash([]);
    context.globalAlpha = 1;
  }
  paintBlindSectors(scene);
}

// Where nobody looks: hatched, so that it is seen in every palette.
function paintBlindSectors(scene: Scene): void {
  const { context, plane, own, theme, picture } = scene;
  const sectors = blindSectors(picture.alerts), zone = zonesOf(picture)[0];
  if (sectors.length === 0 || zone === undefined) return;
  const x = plane.x(own.east_m, own.north_m), y = plane.y(own.east_m, own.north_m), turn = own.heading_rad - plane.up - Math.PI / 2;
  context.save();
  context.beginPath();
  for (const { from_deg, to_deg, near_m, far_m } of sectors) {
    const from = from_deg * Math.PI / 180 + turn, to = from + (((to_deg - from_deg) % 360 + 360) % 360 || 360) * Math.PI / 180;
    const far = Math.min(far_m, zone.range_m) * plane.px_per_m, near = Math.min(near_m * plane.px_per_m, far);
    context.moveTo(x + near * Math.cos(from), y + near * Math.sin(from));
    context.arc(x, y, far, from, to);
    context.arc(x, y, near, to, from, true);
    context.closePath();
  }
  context.strokeStyle = theme.css.caution;
  context.lineWidth = 2;
  context.stroke();
  context.clip();
  const reach = zone.range_m * plane.px_per_m, most = Math.min(reach, Math.hypot(plane.width_px, plane.height_px));
  context.lineWidth = 1.5;
  context.beginPath();
  for (let d = -2 * most; d <= 2 * most; d += kHatch_px) {
    context.moveTo(x + d - most, y - most);
    context.lineTo(x + d + most, y + most);
  }
  context.stroke();
  context.restore();
}

/** The hull in its true size, or a mark where that is too small to be seen; line of heading, vector of the next 30 s. */
export function paintOwnBoat(scene: Scene): void {
  const { context, plane, own, theme, picture } = scene;
  const box = picture.boat?.own_vessel ?? { min_x_m: -1.5, max_x_m: 1.5, min_y_m: -0.7, max_y_m: 0.7 };
  const hull_m = picture.boat?.hull_length_m ?? box.max_x_m - box.min_x_m, beam_m = picture.boat?.hull_beam_m ?? box.max_y_m - box.min_y_m;
  const middle = (box.max_x_m + box.min_x_m) / 2, side = (box.max_y_m + box.min_y_m) / 2;
  // Never smaller than can be seen.
  const grow = Math.max(1, 18 / (hull_m * plane.px_per_m));
  const l = hull_m / 2 * grow, b = beam_m / 2 * Math.min(grow, Math.max(1, 9 / (beam_m * plane.px_per_m)));
  const x = (fx: number, fy: number) => boatX(scene, middle + fx, side + fy), y = (fx: number, fy: number) => boatY(scene, middle + fx, side + fy);

  context.strokeStyle = theme.css.own;
  context.globalAlpha = 0.5;
  context.lineWidth = 1.2;
  context.beginPath();
  context.moveTo(x(l, 0), y(l, 0));
  const far = 2 * Math.hypot(plane.width_px, plane.height_px) / plane.px_per_m;
  context.lineTo(x(far, 0), y(far, 0));
  // Dashed where it is only the course over ground: the bow may point elsewhere.
  if (isOnlyCourse(picture.pose)) context.setLineDash([10, 8]);
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;

  const velocity = picture.pose?.velocity_map_mps;
  if (own.isOnMap && velocity !== undefined && Math.hypot(velocity[0]!, velocity[1]!) > 0.3) {
    context.lineWidth = 2.5;
    context.beginPath();
    context.moveTo(plane.x(own.east_m, own.north_m), plane.y(own.east_m, own.north_m));
    const east = own.east_m + kVector_s * velocity[0]!, north = own.north_m + kVector_s * velocity[1]!;
    context.lineTo(plane.x(east, north), plane.y(east, north));
    context.stroke();
  }
  context.beginPath();
  context.moveTo(x(l, 0), y(l, 0));
  context.bezierCurveTo(x(0.75 * l, b * 0.55), y(0.75 * l, b * 0.55), x(0.5 * l, b), y(0.5 * l, b), x(0, b), y(0, b));
  context.lineTo(x(-l, 0.85 * b), y(-l, 0.85 * b));
  context.lineTo(x(-l, -0.85 * b), y(-l, -0.85 * b));
  context.lineTo(x(0, -b), y(0, -b));
  context.bezierCurveTo(x(0.5 * l, -b), y(0.5 * l, -b), x(0.75 * l, -b * 0.55), y(0.75 * l, -b * 0.55), x(l, 0), y(l, 0));
  context.closePath();
  context.fillStyle = theme.css.panel;
  context.fill();
  context.lineWidth = 2;
  context.strokeStyle = theme.css.own;
  context.lineJoin = "round";
  context.stroke();
}

/** A length on the screen as a bar, in a corner. */
export function paintScale({ context, plane, theme, state }: Scene, x_px: number, y_px: number): void {
  const step_m = ringStep(plane.px_per_m, state.settings.get("length_unit") === "NM"), width = step_m * plane.px_per_m;
  context.lineJoin = "round";
  for (const [colour, line] of [[theme.css.water, 5], [theme.css.text, 2]] as const) {
    context.strokeStyle = colour;
    context.lineWidth = line;
    context.beginPath();
    context.moveTo(x_px, y_px - 6);
    context.lineTo(x_px, y_px);
    context.lineTo(x_px + width, y_px);
    context.lineTo(x_px + width, y_px - 6);
    context.stroke();
  }
  context.font = kFont;
  context.textAlign = "center";
  context.textBaseline = "bottom";
  context.strokeStyle = theme.css.water;
  context.lineWidth = 4;
  context.fillStyle = theme.css.text;
  const text = length(state.settings, step_m).replace(".0 ", " ");
  context.strokeText(text, x_px + width / 2, y_px - 4);
  context.fillText(text, x_px + width / 2, y_px - 4);
}
