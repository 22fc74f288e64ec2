// Land as it is remembered, and obstacles of a boat that does not know where it is.
import type { Picture } from "../picture.js";
import { boatX, boatY, tracePath, type Scene } from "./scene.js";

const kCell_m = 0.5;  // of the land memory

/** Edge of the remembered land as its cells, and land of this scan as lines along its nearest returns. */
export function paintLand(scene: Scene): void {
  const { context, plane, own, theme, picture } = scene;
  context.fillStyle = theme.css.land;
  context.strokeStyle = theme.css.land;
  if (own.isOnMap) {
    const edge = picture.waterline_map_m, size = Math.max(2.5, kCell_m * plane.px_per_m);
    context.globalAlpha = 0.75;
    context.beginPath();
    for (let i = 0; i + 1 < edge.length; i += 2) {
      const x = plane.x(edge[i]!, edge[i + 1]!), y = plane.y(edge[i]!, edge[i + 1]!);
      if (x > -size && y > -size && x < plane.width_px + size && y < plane.height_px + size) context.rect(x - size / 2, y - size / 2, size, size);
    }
    context.fill();
  }
  context.globalAlpha = 1;
  context.lineWidth = 2.5;
  context.lineJoin = "round";
  context.lineCap = "round";
  context.beginPath();
  for (const obstacle of picture.obstacles) {
    if (obstacle.kind !== 1 && !picture.land_segments.has(obstacle.id)) continue;
    const isPlaced = own.isOnMap && obstacle.num_waterline_map > 1;
    const n = isPlaced ? obstacle.num_waterline_map : own.isOnMap ? 0 : obstacle.num_waterline;
    for (let i = 0; i < n; ++i) {
      const x = isPlaced ? plane.x(obstacle.waterline_east_m[i]!, obstacle.waterline_north_m[i]!) : boatX(scene, obstacle.waterline_vessel_x_m[i]!, obstacle.waterline_vessel_y_m[i]!);
      const y = isPlaced ? plane.y(obstacle.waterline_east_m[i]!, obstacle.waterline_north_m[i]!) : boatY(scene, obstacle.waterline_vessel_x_m[i]!, obstacle.waterline_vessel_y_m[i]!);
      // A line jumps where nearer land ends: there it is not land.
      if (i === 0 || jumps(obstacle, i)) context.moveTo(x, y); else context.lineTo(x, y);
    }
  }
  context.stroke();
  context.lineCap = "butt";
}
const kJump_m = 4;
function jumps(obstacle: Picture["obstacles"][number], i: number): boolean {
  return Math.hypot(obstacle.waterline_vessel_x_m[i]! - obstacle.waterline_vessel_x_m[i - 1]!, obstacle.waterline_vessel_y_m[i]! - obstacle.waterline_vessel_y_m[i - 1]!) > kJump_m;
}

/** Obstacles of this scan that no track explains: with a place on the map or only around the boat. */
export function paintObstacles(scene: Scene): void {
  const { context, own, theme, picture, state } = scene;
  context.strokeStyle = theme.css.track;
  context.lineWidth = 1.5;
  const marked = state.marked.segment;
  for (const obstacle of picture.obstacles) {
    if (obstacle.kind === 1 || picture.land_segments.has(obstacle.id) || (own.isOnMap && obstacle.status !== 0)) continue;
    if (own.isOnMap && obstacle.id !== marked) continue;
    if (obstacle.confidence === 1 && !state.settings.get("shows_tentative") && obstacle.id !== marked) continue;
    context.beginPath();
    if (own.isOnMap) tracePath(scene, obstacle.footprint_east_m, obstacle.footprint_north_m, true);
    else {
      for (let i = 0; i < obstacle.num_footprint; ++i) {
        const x = boatX(scene, obstacle.footprint_vessel_x_m[i]!, obstacle.footprint_vessel_y_m[i]!), y = boatY(scene, obstacle.footprint_vessel_x_m[i]!, obstacle.footprint_vessel_y_m[i]!);
        if (i === 0) context.moveTo(x, y); else context.lineTo(x, y);
      }
      context.closePath();
      const x = boatX(scene, obstacle.center_vessel_m[0]!, obstacle.center_vessel_m[1]!), y = boatY(scene, obstacle.center_vessel_m[0]!, obstacle.center_vessel_m[1]!);
      context.moveTo(x + 7, y);
      context.arc(x, y, 7, 0, 2 * Math.PI);
    }
    context.strokeStyle = obstacle.id === marked ? theme.css.text : theme.css.track;
    context.stroke();
  }
}
