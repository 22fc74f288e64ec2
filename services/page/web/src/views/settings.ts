// The sheet of settings, and the list of keys.
import type { SettingValues } from "../settings.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { button, make, setText } from "./dom.js";
import { Limits } from "./limits.js";
import { type Sounder, WakeLock } from "./sound.js";

const words = texts.panels.settings;
type Choice = "palette" | "length_unit" | "speed_unit" | "orientation" | "colour_by";
type Switch = "shows_returns" | "shows_trails" | "shows_ellipses" | "shows_tentative" | "sound";

export class SettingsSheet {
  readonly element = make("dialog", "sheet");
  private readonly inputs: { input: HTMLInputElement; isOn: () => boolean }[] = [];
  private readonly about = make("p", "note");
  private readonly token = make("p", "note");
  private readonly keys = make("section");
  private readonly limits: Limits;

  constructor(private readonly state: State, private readonly sounder: Sounder) {
    this.limits = new Limits(state);
    const title = make("h2", "", words.title);
    title.id = "settings-title";
    this.element.setAttribute("aria-labelledby", title.id);
    const head = make("header");
    head.append(title, button(words.close, () => { this.element.close(); }));
    const shown = this.switches(words.shown, ["shows_returns", "shows_trails", "shows_ellipses", "shows_tentative"]);
    const sound = this.switches(words.alarm, ["sound"]);
    sound.append(make("p", "note", words.soundNote), button(words.testSound, () => { this.sounder.test(); }));
    if (!WakeLock.isThere) sound.append(make("p", "note", words.noWakeLock));
    this.keys.append(make("h2", "", words.keys), this.listKeys());
    this.keys.tabIndex = -1;
    this.element.append(head, this.choice("palette"), this.choice("orientation"), this.choice("colour_by"), this.choice("length_unit"),
      this.choice("speed_unit"), shown, sound, this.limits.element, this.token, this.keys, this.about);
    // A touch beside the sheet closes it.
    this.element.onclick = (event) => { if (event.target === this.element) this.element.close(); };
    state.on(["settings"], () => { this.update(); });
    this.update();
  }

  open(atKeys = false): void {
    const { hello, token } = this.state;
    setText(this.about, hello === null ? "" : words.about(hello.version, hello.host));
    setText(this.token, hello?.mode === "log" ? "" : token === "" ? words.noToken : words.hasToken);
    if (!this.element.open) this.element.showModal();
    this.limits.open();
    if (atKeys) {
      this.keys.scrollIntoView();
      this.keys.focus();
    }
  }

  private update(): void {
    for (const { input, isOn } of this.inputs) input.checked = isOn();
  }

  private choice<Name extends Choice>(name: Name): HTMLFieldSetElement {
    const { settings } = this.state;
    const field = make("fieldset"), options = make("div", "segments");
    const names = words.choices[name] as Record<string, string>;
    for (const value of settings.choices(name)) {
      const label = make("label"), input = make("input");
      input.type = "radio";
      input.name = name;
      input.onchange = () => { settings.set(name, value as SettingValues[Name]); };
      this.inputs.push({ input, isOn: () => settings.get(name) === value });
      label.append(input, names[String(value)] ?? String(value));
      options.append(label);
    }
    field.append(make("legend", "", words.names[name]), options);
    return field;
  }

  private switches(legend: string, names: Switch[]): HTMLFieldSetElement {
    const field = make("fieldset", "switches");
    field.append(make("legend", "", legend));
    for (const name of names) {
      const label = make("label"), input = make("input");
      input.type = "checkbox";
      input.setAttribute("role", "switch");
      input.onchange = () => { this.state.settings.set(name, input.checked); };
      this.inputs.push({ input, isOn: () => this.state.settings.get(name) });
      label.append(make("span", "", words.names[name]), input);
      field.append(label);
    }
    return field;
  }

  private listKeys(): HTMLDListElement {
    const list = make("dl", "keys");
    for (const [keys, effect] of words.keyList) {
      const names = make("dt");
      keys.split(" ").forEach((key, index) => { names.append(index > 0 ? " " : "", make("kbd", "", key)); });
      list.append(names, make("dd", "", effect));
    }
    return list;
  }
}

/** Keys that hold everywhere. Those of a view are the view's own. */
export interface KeyActions { showView(index: number): void; focusAlert(): void }

export function listenToKeys(state: State, sheet: SettingsSheet, actions: KeyActions): void {
  addEventListener("keydown", (event) => {
    const isElsewhere = event.target instanceof Element && event.target.closest("input, select, textarea, dialog") !== null;
    if (event.ctrlKey || event.altKey || event.metaKey || event.defaultPrevented || isElsewhere) return;
    const { settings } = state;
    switch (event.key) {
      case "?": sheet.open(true); break;
      case "a": actions.focusAlert(); break;
      case "h": settings.set("orientation", settings.get("orientation") === "head" ? "north" : "head"); break;
      case "s": settings.set("sound", !settings.get("sound")); break;
      case "p": {
        const palettes = settings.choices("palette");
        settings.set("palette", palettes[(palettes.indexOf(settings.get("palette")) + 1) % palettes.length]!);
        break;
      }
      case "Escape": state.choose(null); break;
      default:
        if (/^[1-9]$/.test(event.key)) actions.showView(Number(event.key) - 1);
        else return;
    }
    event.preventDefault();
  });
}
