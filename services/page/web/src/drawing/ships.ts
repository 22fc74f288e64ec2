// Ships of AIS that are no track: a triangle at the place that AIS says, its point to the bow. One that the lidar should see and does not is filled.
import { AisShip } from "../messages/generated.js";
import { texts } from "../texts/index.js";
import { length } from "../units.js";
import { shipName } from "../views/track_words.js";
import type { Scene } from "./scene.js";

const kHalfLength_px = 9, kHalfWidth_px = 5;
// False ships are easily made: they may not take the room of all tracks.
const kMostNamedFirst = 4;

/** Where the bow of a ship points, from true north clockwise: by her heading, else by the course of one that moves; else to the north. */
export function bowOf(ship: Pick<AisShip, "heading_rad" | "report_course_rad" | "report_speed_mps">): number {
  if (Number.isFinite(ship.heading_rad)) return ship.heading_rad;
  return ship.report_speed_mps > 0.5 && Number.isFinite(ship.report_course_rad) ? ship.report_course_rad : 0;
}

/** Ships that are no track. Their labels come behind those of tracks; of a few that the lidar should see behind those of alerts. */
export function paintShips({ context, plane, picture, state, theme, labels }: Scene): void {
  let numFirst = 0;
  for (const ship of picture.ships) {
    const [east_m, north_m] = [ship.position_map_m[0]!, ship.position_map_m[1]!];
    if (ship.state === AisShip.STATE_TRACKED || !Number.isFinite(east_m) || !plane.sees(east_m, north_m, 0)) continue;
    const isOnly = ship.state === AisShip.STATE_AIS_ONLY, x = plane.x(east_m, north_m), y = plane.y(east_m, north_m);
    const turn = bowOf(ship) - plane.up, sin = Math.sin(turn), cos = Math.cos(turn);
    const at = (right: number, ahead: number) => [x + right * cos + ahead * sin, y + right * sin - ahead * cos] as const;
    const colour = theme.css[isOnly ? "text" : "muted"];
    context.beginPath();
    context.moveTo(...at(0, kHalfLength_px));
    context.lineTo(...at(kHalfWidth_px, -kHalfLength_px));
    context.lineTo(...at(-kHalfWidth_px, -kHalfLength_px));
    context.closePath();
    context.strokeStyle = context.fillStyle = colour;
    context.lineWidth = 1.5;
    context.stroke();
    if (isOnly) context.fill();
    const lines = [shipName(ship), isOnly ? texts.drawing.ais_only : `${texts.drawing.ais} · ${length(state.settings, ship.range_m)}`];
    const label = { x_px: x, y_px: y, radius_px: kHalfLength_px, lines, colour, isBoxed: false };
    if (isOnly && numFirst++ < kMostNamedFirst) labels.splice(labels.findLastIndex((one) => one.isBoxed) + 1, 0, label);
    else labels.push(label);
  }
}
