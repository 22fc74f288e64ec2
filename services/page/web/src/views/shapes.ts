// Shapes that tell how grave a thing is without any colour.

export type Gravity = "warning" | "caution" | "quiet" | "ok" | "unknown";

const kNamespace = "http://www.w3.org/2000/svg";
// In a box of 24 x 24; warning: a triangle with its mark cut out; caution: a square; quiet: a tick in a ring; ok: a disc; unknown: a ring.
const kPaths: Record<Gravity, string> = {
  warning: "M12 1.5 23.5 22H.5ZM10.9 8.5l.3 7h1.6l.3-7ZM10.9 17v2.2h2.2V17Z",
  caution: "M2 2h20v20H2ZM10.9 5.5l.3 9h1.6l.3-9ZM10.9 16.3v2.4h2.2v-2.4Z",
  quiet: "M12 2a10 10 0 1 0 0 20 10 10 0 0 0 0-20Zm0 2a8 8 0 1 1 0 16 8 8 0 0 1 0-16Zm4.3 4-5.6 5.8-2.7-2.7-1.4 1.4 4.1 4.1 7-7.2Z",
  ok: "M12 4a8 8 0 1 0 0 16 8 8 0 0 0 0-16Z",
  unknown: "M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18Zm0 2a7 7 0 1 1 0 14 7 7 0 0 1 0-14Z",
};

export function svg<T extends keyof SVGElementTagNameMap>(tag: T, attributes: Record<string, string>): SVGElementTagNameMap[T] {
  const element = document.createElementNS(kNamespace, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}

/** Beside it stands a word that says the same, so readers of the screen pass over it. */
export class Shape {
  readonly element = svg("svg", { viewBox: "0 0 24 24", class: "shape", "aria-hidden": "true" });
  private readonly path = svg("path", { fill: "currentColor", "fill-rule": "evenodd" });
  private gravity: Gravity | null = null;

  constructor(gravity?: Gravity) {
    this.element.append(this.path);
    if (gravity !== undefined) this.set(gravity);
  }
  set(gravity: Gravity): void {
    if (gravity === this.gravity) return;
    this.gravity = gravity;
    this.path.setAttribute("d", kPaths[gravity]);
  }
}

const kIcons = {
  settings: "M4 7h9m5 0h2M4 17h2m5 0h9M13 7a2.5 2.5 0 1 0 5 0 2.5 2.5 0 0 0-5 0ZM6 17a2.5 2.5 0 1 0 5 0 2.5 2.5 0 0 0-5 0Z",
  sound: "M4 9.5v5h3.5L12 19V5L7.5 9.5ZM15.5 9a4 4 0 0 1 0 6M18 6.5a8 8 0 0 1 0 11",
  silent: "M4 9.5v5h3.5L12 19V5L7.5 9.5ZM16 9.5l5 5m0-5-5 5",
};
export function icon(name: keyof typeof kIcons): SVGSVGElement {
  const element = svg("svg", { viewBox: "0 0 24 24", width: "24", height: "24", "aria-hidden": "true" });
  element.append(svg("path", {
    d: kIcons[name], fill: "none", stroke: "currentColor", "stroke-width": "2", "stroke-linecap": "round", "stroke-linejoin": "round",
  }));
  return element;
}
