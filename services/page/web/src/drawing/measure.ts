// The tool that measures from one place to another. A place on a track goes with it, and one on the own boat with that.
import { texts } from "../texts/index.js";
import { bearing, length } from "../units.js";
import { boatX, boatY, type Scene } from "./scene.js";

export type End = { kind: "own" } | { kind: "track"; id: number } | { kind: "place"; east_m: number; north_m: number };

/** East and north of one place of the map frame from another, m. */
export type Between = (from: readonly [number, number], to: readonly [number, number]) => [number, number];

export class Measure {
  isOn = false;
  private from: End | null = null;
  private to: End | null = null;

  toggle(): void {
    this.isOn = !this.isOn;
    this.from = this.to = null;
  }
  /** The next end; a third begins anew. */
  add(end: End): void {
    if (this.from === null || this.to !== null) { this.from = end; this.to = null; } else this.to = end;
  }
  /** What to do next; empty: nothing. */
  get hint(): string { return !this.isOn || this.to !== null ? "" : this.from === null ? texts.drawing.measure_first : texts.drawing.measure_second; }

  paint(scene: Scene, between: Between): void {
    if (!this.isOn || this.from === null) return;
    const { context, plane, theme, own, state } = scene;
    const a = placeOf(this.from, scene), b = this.to === null ? null : placeOf(this.to, scene);
    if (a === null) { this.from = this.to = null; return; }
    const ends = b === null ? [a] : [a, b];
    context.lineWidth = 2;
    context.strokeStyle = theme.css.accent;
    context.beginPath();
    for (const [east, north] of ends) {
      const x = plane.x(east, north), y = plane.y(east, north);
      context.moveTo(x - 9, y);
      context.lineTo(x + 9, y);
      context.moveTo(x, y - 9);
      context.lineTo(x, y + 9);
    }
    if (b !== null) {
      context.moveTo(plane.x(...a), plane.y(...a));
      context.lineTo(plane.x(...b), plane.y(...b));
    }
    context.stroke();
    if (b === null) return;
    const [east, north] = between(a, b), direction = Math.atan2(east, north);
    const lines = [length(state.settings, Math.hypot(east, north))];
    if (own.isOnMap) lines.push(texts.drawing.true_bearing(bearing(direction)));
    if (this.from.kind === "own" || !own.isOnMap) lines.push(texts.drawing.relative_bearing(bearing(direction - own.heading_rad)));
    scene.labels.unshift({ x_px: (plane.x(...a) + plane.x(...b)) / 2, y_px: (plane.y(...a) + plane.y(...b)) / 2, radius_px: 4, lines, colour: theme.css.accent, isBoxed: true });
  }
}

function placeOf(end: End, { picture, own }: Scene): [number, number] | null {
  if (end.kind === "place") return [end.east_m, end.north_m];
  if (end.kind === "own") return [own.east_m, own.north_m];
  const track = picture.track_by_id.get(end.id);
  return track === undefined ? null : [track.position_map_m[0]!, track.position_map_m[1]!];
}
/** Whether a pixel is on the own boat. */
export function isOnOwn(scene: Scene, x_px: number, y_px: number, reach_px: number): boolean {
  return Math.hypot(boatX(scene, 0, 0) - x_px, boatY(scene, 0, 0) - y_px) < reach_px;
}
