// What can be taken away: tables as CSV, figures as SVG and PNG, under names that say what they are.

import type { Run } from "../model/run";
import type { Moment } from "../model/types";
import { h, save } from "./dom";
import { csvField } from "./format";

export type Table = readonly (readonly (string | number | undefined)[])[];

/** Lines end as RFC 4180 has it. */
export const csv = (table: Table): string => table.map((row) => `${row.map(csvField).join(",")}\r\n`).join("");

/** `paper-d3-goals.csv`: mission, decision, what. */
export const fileName = (run: Run, moment: Moment | undefined, what: string, ending: string): string => {
  const plainly = (words: string): string => words.replace(/[^A-Za-z0-9._-]+/g, "-").replace(/^[-.]+/, "").slice(0, 60);
  const mission = plainly(run.facts.run.mission || run.facts.name) || "log";
  return `${mission}${moment ? `-d${moment.number}` : ""}-${plainly(what)}.${ending}`;
};

export const saveTable = (name: string, table: Table): void => save(name, new Blob([csv(table)], { type: "text/csv;charset=utf-8" }));

const written = (svg: SVGSVGElement): Blob => new Blob([new XMLSerializer().serializeToString(svg)], { type: "image/svg+xml" });

export const saveSvg = (name: string, svg: SVGSVGElement): void => save(name, written(svg));

/** A figure as pixels, twice as fine as it is wide. */
export const savePng = async (name: string, svg: SVGSVGElement): Promise<void> => {
  const { width, height } = svg.viewBox.baseVal;
  const url = URL.createObjectURL(written(svg));
  try {
    const picture = new Image(width * 2, height * 2);
    picture.src = url;
    await picture.decode();
    const canvas = h("canvas", { width: width * 2, height: height * 2 });
    canvas.getContext("2d")?.drawImage(picture, 0, 0, canvas.width, canvas.height);
    canvas.toBlob((blob) => blob && save(name, blob), "image/png");
  } finally {
    URL.revokeObjectURL(url);
  }
};

/** A small button that saves a table; it is made when it is asked for. */
export const csvButton = (what: string, name: () => string, table: () => Table): HTMLButtonElement =>
  h("button", { type: "button", class: "save", title: `Save ${what} as CSV`, "aria-label": `Save ${what} as CSV`, onclick: () => saveTable(name(), table()) }, "CSV");

/** Buttons that save a figure; `name` is asked with the ending. */
export const figureButtons = (what: string, name: (ending: string) => string, figure: () => SVGSVGElement | undefined): HTMLButtonElement[] =>
  (["svg", "png"] as const).map((ending) =>
    h(
      "button",
      {
        type: "button",
        class: "save",
        title: `Save ${what} as ${ending.toUpperCase()}`,
        "aria-label": `Save ${what} as ${ending.toUpperCase()}`,
        onclick: () => {
          const svg = figure();
          if (!svg) return;
          if (ending === "svg") saveSvg(name(ending), svg);
          else void savePng(name(ending), svg);
        },
      },
      ending.toUpperCase(),
    ),
  );
