// From metres on the water to pixels of the screen and back: a shift, a turn and one scale. Nothing here knows the DOM.

/** Something of the plane of the map frame, shown on the screen: x to the right, y down, in pixels of the style sheet. */
export class Plane {
  width_px = 1;
  height_px = 1;
  /** What lies at the anchor, map frame. */
  east_m = 0;
  north_m = 0;
  /** Where on the screen that is, as a share of its width and height. */
  anchor_x = 0.5;
  anchor_y = 0.5;
  px_per_m = 4;
  /** Which direction is up, from north clockwise. */
  private up_rad = 0;
  private sin = 0;
  private cos = 1;

  get up(): number { return this.up_rad; }
  set up(radians: number) {
    this.up_rad = Number.isFinite(radians) ? radians : 0;
    this.sin = Math.sin(this.up_rad);
    this.cos = Math.cos(this.up_rad);
  }

  x(east_m: number, north_m: number): number {
    return this.anchor_x * this.width_px + this.px_per_m * ((east_m - this.east_m) * this.cos - (north_m - this.north_m) * this.sin);
  }
  y(east_m: number, north_m: number): number {
    return this.anchor_y * this.height_px - this.px_per_m * ((east_m - this.east_m) * this.sin + (north_m - this.north_m) * this.cos);
  }
  /** The place under a pixel, east and north, m. */
  place(x_px: number, y_px: number): [number, number] {
    const right = (x_px - this.anchor_x * this.width_px) / this.px_per_m, ahead = (this.anchor_y * this.height_px - y_px) / this.px_per_m;
    return [this.east_m + right * this.cos + ahead * this.sin, this.north_m - right * this.sin + ahead * this.cos];
  }
  /** Moves the plane so that a place lies under a pixel. */
  put(place: readonly [number, number], x_px: number, y_px: number): void {
    const [east, north] = this.place(x_px, y_px);
    this.east_m += place[0] - east;
    this.north_m += place[1] - north;
  }
  /** Whether a circle around a place reaches the screen. */
  sees(east_m: number, north_m: number, radius_m: number): boolean {
    const x = this.x(east_m, north_m), y = this.y(east_m, north_m), r = radius_m * this.px_per_m + 40;
    return x > -r && y > -r && x < this.width_px + r && y < this.height_px + r;
  }
  /** Places of the level frame (x along the heading, y port) at the own boat as a matrix for WebGL, column by column, height dropped. */
  fromLevel(own_east_m: number, own_north_m: number, heading_rad: number): Float32Array {
    const x0 = this.x(own_east_m, own_north_m), y0 = this.y(own_east_m, own_north_m);
    const turn = heading_rad - this.up_rad;  // of the bow, from up clockwise
    const s = this.px_per_m * Math.sin(turn), c = this.px_per_m * Math.cos(turn);
    const kx = 2 / this.width_px, ky = -2 / this.height_px;
    return Float32Array.of(kx * s, -ky * c, 0, 0, -kx * c, -ky * s, 0, 0, 0, 0, 0, 0, kx * x0 - 1, ky * y0 + 1, 0, 1);
  }
}

/** The least of 1, 2, 5 times a power of ten that is not below. */
export function niceStep(least: number): number {
  const power = 10 ** Math.floor(Math.log10(least));
  const rest = least / power;
  return power * (rest <= 1 ? 1 : rest <= 2 ? 2 : rest <= 5 ? 5 : 10);
}

/** Distance of a point from the line between two others. */
export function distanceToLine(x: number, y: number, x1: number, y1: number, x2: number, y2: number): number {
  const dx = x2 - x1, dy = y2 - y1, square = dx * dx + dy * dy;
  const share = square === 0 ? 0 : Math.min(1, Math.max(0, ((x - x1) * dx + (y - y1) * dy) / square));
  return Math.hypot(x - x1 - share * dx, y - y1 - share * dy);
}
