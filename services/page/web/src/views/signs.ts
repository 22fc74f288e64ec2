// The signs on the player's buttons, drawn: not every computer's letters have them.
const kSpace = "http://www.w3.org/2000/svg";
const kPaths = {
  play: "M7 4v16l13-8z",
  pause: "M6 4h4v16H6zM14 4h4v16h-4z",
  back: "M16 5v14l-9-7zM5 5h2v14H5z",
  on: "M8 5v14l9-7zM17 5h2v14h-2z",
  before: "M12 5v14l-8-7zM21 5v14l-8-7zM2 5h2v14H2z",
  after: "M12 5v14l8-7zM3 5v14l8-7zM20 5h2v14h-2z",
  nearer: "M11 5h2v6h6v2h-6v6h-2v-6H5v-2h6z",
  farther: "M5 11h14v2H5z",
  whole: "M2 12l6-5v4h8V7l6 5-6 5v-4H8v4z",
} as const;
export type Sign = keyof typeof kPaths;

/** A sign in the colour of the text around it; hidden from screen readers, which read the label of its button. */
export function sign(name: Sign): SVGSVGElement {
  const svg = document.createElementNS(kSpace, "svg"), path = document.createElementNS(kSpace, "path");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  svg.classList.add("film_sign");
  path.setAttribute("d", kPaths[name]);
  path.setAttribute("fill", "currentColor");
  svg.append(path);
  return svg;
}
