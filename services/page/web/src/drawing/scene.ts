// One moment painted on a plane: what `around` and `map` have in common. The frame is that of the map, or that of the boat where the map is not known.
import type { Picture } from "../picture.js";
import type { State } from "../state.js";
import type { Theme } from "./colours.js";
import type { Box, Label } from "./labels.js";
import type { Plane } from "./plane.js";
import type { Trails } from "./trails.js";

/** Where the own boat is drawn: map frame, or at (0, 0) with its bow to the north where position or heading is not known. */
export interface OwnPlace { east_m: number; north_m: number; heading_rad: number; isOnMap: boolean }

export function ownPlace(picture: Picture): OwnPlace {
  const { own_east_m: east_m, own_north_m: north_m, heading_rad } = picture;
  if (Number.isFinite(east_m) && Number.isFinite(north_m) && Number.isFinite(heading_rad)) return { east_m, north_m, heading_rad, isOnMap: true };
  return { east_m: 0, north_m: 0, heading_rad: 0, isOnMap: false };
}

export interface Scene {
  context: CanvasRenderingContext2D;
  plane: Plane;
  picture: Picture;
  own: OwnPlace;
  theme: Theme;
  state: State;
  trails: Trails;
  labels: Label[];
  /** What labels may not cover. */
  taken: Box[];
}

/** Metres of the boat (x forward, y port) as pixels. */
export function boatX({ plane, own }: Scene, x_m: number, y_m: number): number {
  const sin = Math.sin(own.heading_rad), cos = Math.cos(own.heading_rad);
  return plane.x(own.east_m + x_m * sin - y_m * cos, own.north_m + x_m * cos + y_m * sin);
}
export function boatY({ plane, own }: Scene, x_m: number, y_m: number): number {
  const sin = Math.sin(own.heading_rad), cos = Math.cos(own.heading_rad);
  return plane.y(own.east_m + x_m * sin - y_m * cos, own.north_m + x_m * cos + y_m * sin);
}
/** Adds an outline of the map frame to the path. */
export function tracePath({ context, plane }: Scene, east_m: ArrayLike<number>, north_m: ArrayLike<number>, isClosed: boolean): void {
  for (let i = 0; i < east_m.length; ++i) {
    const x = plane.x(east_m[i]!, north_m[i]!), y = plane.y(east_m[i]!, north_m[i]!);
    if (i === 0) context.moveTo(x, y); else context.lineTo(x, y);
  }
  if (isClosed) context.closePath();
}
