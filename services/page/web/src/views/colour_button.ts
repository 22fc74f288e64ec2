// The button that goes through what returns are coloured by.
import type { Stage } from "../drawing/stage.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";

export function colourButton(stage: Stage, state: State, setting: "colour_by" | "image_colour_by"): void {
  const colour = stage.button("", "colours", () => {
    const choices = state.settings.choices(setting);
    state.settings.set(setting, choices[(choices.indexOf(state.settings.get(setting)) + 1) % choices.length]!);
  });
  const name = () => {
    const label = texts.drawing.colour(texts.drawing.colours[state.settings.get(setting)]);
    colour.title = label;
    colour.setAttribute("aria-label", label);
  };
  name();
  state.on(["settings"], name);
}
