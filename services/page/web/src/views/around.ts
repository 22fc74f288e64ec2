// The picture around the boat: north up or bow up, the own boat always where it was put.
import { type Scene } from "../drawing/scene.js";
import { icon } from "../drawing/stage.js";
import { lacking, type Picture } from "../picture.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { length } from "../units.js";
import { shortNameOf } from "./track_words.js";
import { PlanView } from "./plan_view.js";

const kFirstReach_m = 50;
const kLeast_px_per_m = 0.15, kMost_px_per_m = 120;

export class AroundView extends PlanView {
  // Where the own boat is moved to from its place, pixels of the screen.
  private right_px = 0;
  private down_px = 0;
  private isFitted = false;
  private readonly orientation: HTMLButtonElement;

  constructor(state: State) {
    super(state, "around");
    this.orientation = this.stage.button("", "north", () => { this.turn(); });
    state.on(["settings"], () => { this.nameOrientation(); });
    this.nameOrientation();
  }

  protected place(_picture: Picture, { own }: Scene): boolean {
    const isHeadUp = !own.isOnMap || this.state.settings.get("orientation") === "head", plane = this.plane;
    if (!this.isFitted) {
      this.isFitted = true;
      plane.px_per_m = Math.min(plane.width_px, plane.height_px) / 2 / kFirstReach_m;
    }
    plane.east_m = own.east_m;
    plane.north_m = own.north_m;
    plane.up = isHeadUp ? own.heading_rad : 0;
    // With the bow up more is seen of what is ahead.
    plane.anchor_x = 0.5 + this.right_px / plane.width_px;
    plane.anchor_y = (isHeadUp ? 0.62 : 0.5) + this.down_px / plane.height_px;
    return true;
  }
  protected pan(dx_px: number, dy_px: number): void {
    this.right_px += dx_px;
    this.down_px += dy_px;
  }
  protected zoom(factor: number, x_px: number, y_px: number): void {
    const plane = this.plane, before = plane.px_per_m;
    plane.px_per_m = Math.min(kMost_px_per_m, Math.max(kLeast_px_per_m, before * factor));
    const grown = plane.px_per_m / before - 1;
    // What is under the pointer stays there.
    this.pan(grown * (plane.anchor_x * plane.width_px - x_px), grown * (plane.anchor_y * plane.height_px - y_px));
  }
  protected centre(): void { this.right_px = this.down_px = 0; }

  protected override moreKeys(): Record<string, () => void> { return { n: () => { this.turn(); } }; }
  private turn(): void { this.state.settings.set("orientation", this.state.settings.get("orientation") === "head" ? "north" : "head"); }
  private nameOrientation(): void {
    const isHeadUp = this.state.settings.get("orientation") === "head", button = this.orientation;
    const label = isHeadUp ? texts.drawing.orientation_head : texts.drawing.orientation_north;
    button.replaceChildren(icon(isHeadUp ? "head" : "north"));
    button.title = label;
    button.setAttribute("aria-label", label);
  }

  protected describe({ picture }: Scene): string {
    const tracks = picture.tracks.filter((track) => track.status === 2 || track.status === 3).sort((a, b) => a.range_m - b.range_m), nearest = tracks[0];
    return texts.drawing.around(tracks.length, nearest === undefined ? "" : `${shortNameOf(nearest, picture)}, ${length(this.state.settings, nearest.range_m)}`);
  }
  protected noteFor(scene: Scene | null): string { return scene?.own.isOnMap === false ? texts.lacks[lacking(scene.picture.pose) ?? "position"] : ""; }
}
