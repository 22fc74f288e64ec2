// What lies under the pointer. Nothing here knows the DOM.
import type { Track } from "../messages/generated.js";
import type { Picture } from "../picture.js";
import { distanceToLine, type Plane } from "./plane.js";

/** @param x_px, y_px vertices in turn; @returns whether a point lies inside of the outline */
export function isInside(x: number, y: number, xs: ArrayLike<number>, ys: ArrayLike<number>): boolean {
  let inside = false;
  for (let i = 0, j = xs.length - 1; i < xs.length; j = i++) {
    if (ys[i]! > y !== ys[j]! > y && x < (xs[j]! - xs[i]!) * (y - ys[i]!) / (ys[j]! - ys[i]!) + xs[i]!) inside = !inside;
  }
  return inside;
}

/** The track under a pixel, or the nearest whose outline is not further off than `reach_px`; null: none. */
export function pickTrack(plane: Plane, tracks: readonly Track[], x_px: number, y_px: number, reach_px: number): Track | null {
  let best: Track | null = null, least = reach_px;
  const [east, north] = plane.place(x_px, y_px);
  for (const track of tracks) {
    const x = plane.x(track.position_map_m[0]!, track.position_map_m[1]!), y = plane.y(track.position_map_m[0]!, track.position_map_m[1]!);
    let distance = Math.hypot(x - x_px, y - y_px);
    const n = track.num_outline;
    if (n > 2 && isInside(east, north, track.outline_east_m, track.outline_north_m)) distance = Math.min(distance, 0.5);
    for (let i = 0, j = n - 1; i < n && distance >= 1; j = i++) {
      const metres = distanceToLine(east, north, track.outline_east_m[j]!, track.outline_north_m[j]!, track.outline_east_m[i]!, track.outline_north_m[i]!);
      distance = Math.min(distance, metres * plane.px_per_m);
    }
    if (distance < least) { least = distance; best = track; }
  }
  return best;
}

/** Index of the return nearest to a pixel, not further than `reach_px`; -1: none. */
export function pickReturn(plane: Plane, picture: Picture, own_east_m: number, own_north_m: number, heading_rad: number, x_px: number, y_px: number, reach_px: number): number {
  const { returns } = picture;
  if (returns === null) return -1;
  const [east, north] = plane.place(x_px, y_px);
  const sin = Math.sin(heading_rad), cos = Math.cos(heading_rad), de = east - own_east_m, dn = north - own_north_m;
  const forward = de * sin + dn * cos, port = -de * cos + dn * sin;
  let best = -1, least = (reach_px / plane.px_per_m) ** 2;
  for (let i = 0; i < returns.count; ++i) {
    const dx = returns.level_m[3 * i]! - forward, dy = returns.level_m[3 * i + 1]! - port, square = dx * dx + dy * dy;
    if (square < least && returns.label[i] !== -2) { least = square; best = i; }
  }
  return best;
}
