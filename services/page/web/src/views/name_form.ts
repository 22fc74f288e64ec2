// Gives the chosen track a name, which lives as long as the track. Empty: as the look-out calls it.
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { order } from "./acknowledge.js";
import { button, make, setText } from "./dom.js";

const words = texts.panels.tracks.naming;
const kMost_bytes = 40;

/** As the look-out takes it; null: it is too long. */
export function nameFrom(typed: string): string | null {
  const name = typed.trim();
  return new TextEncoder().encode(name).length > kMost_bytes ? null : name;
}

export class NameForm {
  readonly element = make("form", "naming");
  private readonly input = make("input");
  private readonly said = make("p", "note");
  private track_id = 0;
  private shown = "";

  constructor(private readonly state: State) {
    const label = make("label");
    this.input.type = "text";
    this.input.maxLength = kMost_bytes;
    this.input.placeholder = words.unset;
    this.input.autocomplete = "off";
    label.append(make("span", "", words.label), this.input);
    this.said.setAttribute("role", "status");
    const set = button(words.set, () => {});
    set.type = "submit";
    this.element.append(label, set, this.said);
    this.element.onsubmit = (event) => { event.preventDefault(); void this.send(); };
  }

  /** What was typed stays until another track is chosen; else the name that another window gave comes up. */
  draw(track_id: number): void {
    const { state } = this;
    this.element.hidden = state.showing.kind !== "live" || state.hello?.mode !== "live";
    const name = state.picture?.name_of_track.get(track_id) ?? "", isOther = this.track_id !== track_id;
    const isTyped = this.input.value !== this.shown || document.activeElement === this.input;
    if (!isOther && (isTyped || name === this.shown)) return;
    this.track_id = track_id;
    this.shown = name;
    this.input.value = name;
    if (isOther) setText(this.said, "");
  }

  private async send(): Promise<void> {
    const name = nameFrom(this.input.value), { track_id } = this;
    if (name !== null) this.shown = this.input.value;
    const refused = name === null ? words.tooLong : await order(this.state, { kind: "name", track_id, name });
    if (track_id === this.track_id) setText(this.said, refused ?? words.sent);
  }
}
