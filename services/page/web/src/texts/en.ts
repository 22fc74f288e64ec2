// Every text of the page, in English. A translation is a second file of this shape.
export const en = {
  title: "Lookout",
  views: { around: "Around", map: "Map", range_image: "Range image", cloud: "3-D", lists: "Lists", plots: "Plots", compare: "Compare" },
  connecting: "Connecting …",
  lost: (seconds: number) => `No connection to the boat for ${seconds} s. Trying again.`,
  back: "The connection is back.",
  stale: (seconds: string) => `The picture is ${seconds} old`,
  nothingYet: "Nothing came yet. Are lookout-vlp16 and the other processes running?",
  live: "LIVE",
  recorded: "RECORDED",
  indexing: (percent: number) => `Reading the log: ${percent} %`,
  noPosition: "Position not known: only what is around the boat",
};
export type Texts = typeof en;
