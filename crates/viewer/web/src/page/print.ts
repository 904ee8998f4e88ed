// The page on paper: title, map, legend, the decision with all its pages, timeline; put together when it is printed.
//
// What is on the screen is laid out for a screen: printing copies its parts, one after another, in light colours.

import { h } from "../ui/dom";

/** What is put on paper, asked for at the moment of printing. */
export interface Printed {
  title: string;
  facts: HTMLElement;
  map: HTMLElement | SVGElement | undefined;
  /** Where the map has none inside. */
  legend: HTMLElement | undefined;
  head: HTMLElement;
  pages: readonly { title: string; page: HTMLElement }[];
  /** In pieces that a sheet can hold. */
  timeline: readonly SVGSVGElement[];
  trends: SVGSVGElement | undefined;
}

/** A picture of a canvas as it is: a copy of a canvas is empty. */
export const pictureOf = (canvas: HTMLCanvasElement): HTMLCanvasElement => {
  const copy = h("canvas", { width: canvas.width, height: canvas.height });
  copy.getContext("2d")?.drawImage(canvas, 0, 0);
  return copy;
};

/** A copy for paper: nothing in it can be pressed, and no name stands twice on the page. */
const copied = (of: HTMLElement): HTMLElement => {
  const copy = of.cloneNode(true) as HTMLElement;
  copy.hidden = false;
  for (const one of [copy, ...copy.querySelectorAll<HTMLElement>("[id], [hidden]")]) {
    one.removeAttribute("id");
    one.removeAttribute("aria-labelledby");
  }
  for (const one of copy.querySelectorAll(".save, .files button, input, .u-wrap, .attachment")) one.remove();
  return copy;
};

/** The longest table, of the file and not of the mission: it stands behind all that is read. */
const topicsOf = (pages: readonly HTMLElement[]): HTMLElement[] => {
  const topics = pages.map((page) => page.querySelector<HTMLElement>(".topics")).find((table) => table !== null);
  if (!topics) return [];
  if (topics.previousElementSibling?.matches("h3")) topics.previousElementSibling.remove();
  return [h("section", { class: "paper-page" }, h("h2", {}, "Topics in the file"), topics)];
};

const build = ({ title, facts, map, legend, head, pages, timeline, trends }: Printed): HTMLElement => {
  const copies = pages.map(({ title: name, page }) => ({ name, page: withTrends(copied(page), trends) }));
  const topics = topicsOf(copies.map(({ page }) => page));
  return h(
    "section",
    { class: "paper" },
    h("h1", {}, title),
    copied(facts),
    h("div", { class: "paper-map" }, map ?? "", legend ? copied(legend) : ""),
    copied(head),
    ...copies.map(({ name, page }) => h("section", { class: "paper-page" }, h("h2", {}, name), page)),
    h("section", { class: "paper-page paper-time" }, h("h2", {}, "Timeline"), ...timeline),
    ...topics,
  );
};

/** A plot on the screen is as wide as the screen; on paper stands one that fits. */
const withTrends = (page: HTMLElement, trends: SVGSVGElement | undefined): HTMLElement => {
  page.querySelector(".trend")?.replaceWith(trends ?? "");
  return page;
};

/** `printed` is asked for what is to be on paper; nothing if nothing is open. `light` puts the page in light colours and back. */
export const listenPrint = (printed: () => Printed | undefined, light: (on: boolean) => void): void => {
  let paper: HTMLElement | undefined;
  const put = (): void => {
    if (paper) return;
    light(true);
    const what = printed();
    if (what) {
      paper = build(what);
      document.body.append(paper);
    }
  };
  const away = (): void => {
    paper?.remove();
    paper = undefined;
    light(false);
  };
  window.addEventListener("beforeprint", put);
  window.addEventListener("afterprint", away);
  // A preview may change the medium without saying that it prints.
  matchMedia("print").addEventListener("change", ({ matches }) => (matches ? put() : away()));
};
