// What the user has chosen, kept by the browser.

export interface SettingValues {
  palette: "day" | "dusk" | "night" | "sun";
  length_unit: "m" | "NM";
  speed_unit: "kn" | "mps" | "kmh";
  orientation: "north" | "head";
  colour_by: "segment" | "track" | "height" | "reflectivity";
  sound: boolean;
  shows_tentative: boolean;
  shows_returns: boolean;
  shows_trails: boolean;
  shows_ellipses: boolean;
}
export const kDefaults: SettingValues = {
  palette: "day", length_unit: "m", speed_unit: "kn", orientation: "head", colour_by: "track", sound: false,
  shows_tentative: false, shows_returns: true, shows_trails: true, shows_ellipses: false,
};
const kChoices: { [Name in keyof SettingValues]: readonly SettingValues[Name][] } = {
  palette: ["day", "dusk", "night", "sun"], length_unit: ["m", "NM"], speed_unit: ["kn", "mps", "kmh"], orientation: ["north", "head"],
  colour_by: ["segment", "track", "height", "reflectivity"], sound: [false, true], shows_tentative: [false, true], shows_returns: [false, true],
  shows_trails: [false, true], shows_ellipses: [false, true],
};
const kKey = "lookout.settings";

export class Settings {
  private values: SettingValues;
  constructor(private readonly onChange: () => void) { this.values = load(); }

  get<Name extends keyof SettingValues>(name: Name): SettingValues[Name] { return this.values[name]; }
  choices<Name extends keyof SettingValues>(name: Name): readonly SettingValues[Name][] { return kChoices[name]; }
  set<Name extends keyof SettingValues>(name: Name, value: SettingValues[Name]): void {
    if (this.values[name] === value) return;
    this.values = { ...this.values, [name]: value };
    try { localStorage.setItem(kKey, JSON.stringify(this.values)); } catch { /* a browser that keeps nothing */ }
    this.onChange();
  }
}

// What is not among the choices of today is left out.
function load(): SettingValues {
  const values: Record<string, unknown> = { ...kDefaults };
  try {
    const kept = JSON.parse(localStorage.getItem(kKey) ?? "{}") as Record<string, unknown>;
    for (const [name, choices] of Object.entries(kChoices)) if ((choices as readonly unknown[]).includes(kept[name])) values[name] = kept[name];
  } catch { /* as above */ }
  return values as unknown as SettingValues;
}
