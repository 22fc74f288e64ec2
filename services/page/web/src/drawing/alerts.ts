// Things in alert on a plane: what to call them there, in which colour; and those that have no track, or are not seen any more.
import { Alert } from "../messages/generated.js";
import { holds } from "../picture.js";
import { shortName, sightOf, whatComes } from "../views/alert_words.js";
import { opensOut } from "../views/gravity.js";
import { length } from "../units.js";
import type { Label } from "./labels.js";
import { offset } from "./mercator.js";
import { boatX, boatY, type Scene } from "./scene.js";

const kMark_px = 9;

/** Red is what is dangerous and comes nearer; what opens, or is a caution, is not. */
export function alertColour(alert: Pick<Alert, "level" | "time_left_s" | "tcpa_s">): "warning" | "caution" { return alert.level >= Alert.LEVEL_WARNING && !opensOut(alert) ? "warning" : "caution"; }

/** What it is and how near; where it is, or when it passes and where to. Where that has no room: less of it. */
export function alertLines({ picture, state }: Pick<Scene, "picture" | "state">, alert: Alert): { lines: string[]; shorter: string[][] } {
  const sight = sightOf(alert), name = shortName(alert), range = length(state.settings, alert.distance_m);
  const first = Number.isFinite(alert.distance_m) ? `${name} · ${range}` : name;
  const comes = whatComes(alert, picture, state.settings), brief = whatComes(alert, picture, state.settings, true);
  const full = [first, sight, comes].filter((line) => line !== ""), less = [first, sight === "" ? brief : sight].filter((line) => line !== "");
  return { lines: full, shorter: [less, [first]] };
}

/** Those that no track shows: land, what has no number yet, what is not seen any more. Hollow where it was; adds their labels. */
export function paintAlertPlaces(scene: Scene): void {
  const { context, picture, plane, theme } = scene, labels: Label[] = [];
  for (const alert of picture.alerts) {
    if (!holds(alert) || picture.track_by_id.has(alert.track_id)) continue;
    const place = placeOf(scene, alert);
    if (place === null) continue;
    const [x, y] = place, colour = theme.css[alertColour(alert)], isLost = alert.sight === Alert.SIGHT_LOST;
    context.strokeStyle = colour;
    context.lineWidth = 2.5;
    context.setLineDash(isLost ? [4, 4] : []);
    context.beginPath();
    context.arc(x, y, kMark_px, 0, 2 * Math.PI);
    if (!isLost && alertColour(alert) === "warning") { context.moveTo(x + kMark_px + 5, y); context.arc(x, y, kMark_px + 5, 0, 2 * Math.PI); }
    context.stroke();
    context.setLineDash([]);
    if (x < 0 || y < 0 || x > plane.width_px || y > plane.height_px) continue;
    labels.push({ x_px: x, y_px: y, radius_px: kMark_px, ...alertLines(scene, alert), colour, isBoxed: !isLost });
  }
  scene.labels.unshift(...labels);
}

// On the earth where both places are known there, else by distance and bearing from the boat.
function placeOf(scene: Scene, alert: Alert): [number, number] | null {
  const { plane, own, picture: { pose } } = scene;
  if (own.isOnMap && pose !== null && Number.isFinite(alert.latitude_deg) && Number.isFinite(alert.longitude_deg) && Number.isFinite(pose.latitude_deg)) {
    const [east, north] = offset(pose.latitude_deg, pose.longitude_deg, alert.latitude_deg, alert.longitude_deg);
    return [plane.x(pose.position_map_m[0]! + east, pose.position_map_m[1]! + north), plane.y(pose.position_map_m[0]! + east, pose.position_map_m[1]! + north)];
  }
  if (!Number.isFinite(alert.distance_m) || !Number.isFinite(alert.bearing_rad)) return null;
  const forward = alert.distance_m * Math.cos(alert.bearing_rad), port = -alert.distance_m * Math.sin(alert.bearing_rad);
  return [boatX(scene, forward, port), boatY(scene, forward, port)];
}
