// Mode and limits of the look-out: those in force, and a form that sends others. They hold until the next ones, or until the tracker starts anew.
import * as wire from "../messages/generated.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { order } from "./acknowledge.js";
import { button, make, setText } from "./dom.js";

const words = texts.panels.limits;
const kDegree = Math.PI / 180;
type Name = "guard_zone_range_m" | "guard_zone_from_deg" | "guard_zone_to_deg" | "cpa_limit_m";
const kNames: readonly Name[] = ["guard_zone_range_m", "guard_zone_from_deg", "guard_zone_to_deg", "cpa_limit_m"];
const kMost: Record<Name, number> = { guard_zone_range_m: 1000, guard_zone_from_deg: 360, guard_zone_to_deg: 360, cpa_limit_m: 500 };

/** As a form shows it: degrees, and no more digits than are meant. */
export function limitOf(report: wire.Alerts, name: Name): number {
  if (name === "guard_zone_range_m" || name === "cpa_limit_m") return Number(report[name].toFixed(1));
  const degrees = (name === "guard_zone_from_deg" ? report.guard_zone_from_rad : report.guard_zone_to_rad) / kDegree;
  return Number((degrees > 360.05 ? degrees - 360 : degrees < 0 ? degrees + 360 : degrees).toFixed(1));
}

export class Limits {
  readonly element = make("fieldset", "limits");
  private readonly inForce = make("p", "note");
  private readonly said = make("p", "note");
  private readonly fields = new Map<Name, HTMLInputElement>();
  private readonly modes = new Map<"open_water" | "harbour", HTMLInputElement>();

  constructor(private readonly state: State) {
    const modes = make("div", "segments");
    for (const mode of ["open_water", "harbour"] as const) {
      const label = make("label"), input = make("input");
      input.type = "radio";
      input.name = "mode";
      label.append(input, words.modes[mode]);
      this.modes.set(mode, input);
      modes.append(label);
    }
    this.element.append(make("legend", "", words.title), this.inForce, modes);
    for (const name of kNames) {
      const label = make("label", "number"), input = make("input");
      input.type = "number";
      input.inputMode = "decimal";
      input.min = "0";
      input.max = String(kMost[name]);
      input.step = "any";
      input.placeholder = words.unset;
      label.append(make("span", "", words.names[name]), input);
      this.fields.set(name, input);
      this.element.append(label);
    }
    const set = make("div", "segments");
    set.append(button(words.set, () => { void this.send(false); }), button(words.asConfig, () => { void this.send(true); }));
    this.said.setAttribute("role", "status");
    this.element.append(set, this.said, make("p", "note", words.note));
    state.on(["picture"], () => { this.tell(); });
  }

  /** What was typed stays; in harbour what is in force has shrunk by the speed, and is not what is to be set. */
  open(): void {
    setText(this.said, "");
    const report = this.report;
    this.element.hidden = report === null;
    if (report === null) return;
    const isHarbour = report.mode === wire.Order.MODE_HARBOUR;
    this.modes.get("harbour")!.checked = isHarbour;
    this.modes.get("open_water")!.checked = !isHarbour;
    this.tell();
  }

  private get report(): wire.Alerts | null { return this.state.showing.kind === "live" && this.state.hello?.mode === "live" ? this.state.picture?.alert_report ?? null : null; }

  private tell(): void {
    const { report } = this;
    if (report === null || this.element.closest("dialog")?.open !== true) return;
    setText(this.inForce, words.inForce(report.mode === wire.Order.MODE_HARBOUR ? words.modes.harbour : words.modes.open_water, limitOf(report, "guard_zone_range_m"),
      limitOf(report, "guard_zone_from_deg"), limitOf(report, "guard_zone_to_deg"), limitOf(report, "cpa_limit_m")));
  }

  private async send(isOfConfig: boolean): Promise<void> {
    const wrong = kNames.find((name) => !this.fields.get(name)!.checkValidity());
    if (!isOfConfig && wrong !== undefined) { setText(this.said, words.wrong(words.names[wrong], kMost[wrong])); return; }
    const limits = Object.fromEntries(isOfConfig ? [] : kNames.filter((name) => this.fields.get(name)!.value !== "").map((name) => [name, this.fields.get(name)!.valueAsNumber]));
    const mode = this.modes.get("harbour")!.checked ? "harbour" : "open_water";
    setText(this.said, await order(this.state, { kind: "settings", mode, ...limits }) ?? words.sent);
  }
}
