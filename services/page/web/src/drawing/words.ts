// What is said of one return.
import { kSecondLidar, type Picture } from "../picture.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { bearing, length } from "../units.js";
import { shortNameOf } from "../views/track_words.js";

/** To what a return belongs, or why to nothing. */
export function describeLabel(picture: Picture, label: number): string {
  if (label < 0) return texts.drawing.reasons[-label] ?? texts.drawing.no_label;
  if (label === 0) return texts.drawing.no_label;
  if (label > kSecondLidar) return texts.drawing.second_lidar(texts.drawing.segment(label - kSecondLidar));
  const track = picture.track_of_segment.get(label);
  const what = track !== undefined ? shortNameOf(track, picture) : picture.land_segments.has(label) ? texts.drawing.land : "";
  return what === "" ? texts.drawing.segment(label) : `${what}, ${texts.drawing.segment(label)}`;
}
export function describeReturn(state: State, picture: Picture, index: number): string {
  const returns = picture.returns!;
  const x = returns.level_m[3 * index]!, y = returns.level_m[3 * index + 1]!, z = returns.level_m[3 * index + 2]!;
  return texts.drawing.tip(length(state.settings, returns.range_m[index]!), bearing(Math.atan2(-y, x)), `${z.toFixed(1)} m`, returns.reflectivity[index]!, describeLabel(picture, returns.label[index]!));
}
