// The run as a whole: its trends, what was written, what the file holds, and how far that was checked.

import type { Run } from "../model/run";
import type { Checks, CrcCheck, Moment } from "../model/types";
import { Trend } from "../view/trend";
import { trendFigure } from "../view/trendfigure";
import { h, save } from "./dom";
import { csvButton, figureButtons, fileName } from "./export";
import { bytes, clock, share } from "./format";
import { decisionsTable, factsTable, topicsTable, writtenTable } from "./tables";

export interface RunHandlers {
  seek(index: number): void;
  attachment(name: string): Promise<Uint8Array<ArrayBuffer> | undefined>;
}

/** Of a longer text only the beginning is shown; all of it can be saved. */
const LONGEST_TEXT = 200_000;
const TEXT = /\.(toml|txt|md|json|csv|yaml|yml|asc|lbl)$/i;

export class RunPage {
  private readonly trendPlace = h("div", { class: "trend" });
  private readonly trend: Trend;
  private readonly file = h("pre", { class: "attachment", tabindex: 0, hidden: true, "aria-label": "Text of a file" });
  private of: Run | undefined;

  constructor(
    private readonly page: HTMLElement,
    private readonly handlers: RunHandlers,
  ) {
    this.trend = new Trend(this.trendPlace, handlers.seek);
  }

  /** A log may hold no decision at all. */
  show(run: Run, index: number, moment: Moment | undefined): void {
    if (this.of !== run) this.file.hidden = true;
    this.of = run;
    this.page.replaceChildren(...(moment ? this.decided(run, moment) : []), ...this.held(run));
    if (moment) this.trend.show(run, index);
  }

  /** Draws the trends for paper: they are measured on the screen. */
  figure(run: Run): SVGSVGElement {
    return trendFigure(run, `Value, reliability and energy over the run: ${run.facts.run.mission ?? run.facts.name}`);
  }

  private decided(run: Run, moment: Moment): HTMLElement[] {
    const lines = run.lines.filter((line) => line.decision === moment.number);
    const name = (what: string, ending: string): string => fileName(run, undefined, what, ending);
    return [
      heading("The chosen plans over the run", ...figureButtons("the trends", (ending) => name("trends", ending), () => this.figure(run)), csvButton("all decisions", () => name("decisions", "csv"), () => decisionsTable(run))),
      this.trendPlace,
      heading(`What was written at decision ${moment.number}`, csvButton("all that was written", () => name("written", "csv"), () => writtenTable(run))),
      h("ul", { class: "lines" }, lines.map((line) => h("li", { class: line.level >= 3 ? "warning" : "" }, line.text)), lines.length === 0 && h("li", { class: "note" }, "nothing")),
      h("h3", {}, "Known then"),
      h("p", {}, `Of ${(100 * moment.seen).toFixed(1)} % of the ground there was a reading of any kind, the view from orbit included; background interest ${share(moment.background)}; ${moment.sites} maxima, ${moment.shortlist} goals sequenced. Facts: ${moment.facts.join(", ") || "none"}.`),
      h("h3", {}, "From outside, and faults"),
      h("ul", { class: "lines" }, run.happenings.map((one) => h("li", {}, `${clock(one.timeS)} ${one.kind}: ${one.text}`)), run.happenings.length === 0 && h("li", { class: "note" }, "none")),
    ];
  }

  private held(run: Run): HTMLElement[] {
    const { facts } = run;
    const name = (what: string): string => fileName(run, undefined, what, "csv");
    return [
      h("h3", {}, "What was checked"),
      h("p", { class: "checks" }, run.checks ? checked(run.checks) : "The file is still being read."),
      heading("Topics in the file", csvButton("the topics", () => name("topics"), () => topicsTable(run))),
      h(
        "table",
        { class: "topics" },
        h("thead", {}, h("tr", {}, ["topic", "schema", "messages", "size", ""].map((label) => h("th", { scope: "col" }, label)))),
        h(
          "tbody",
          {},
          run.topics.map((topic) =>
            h(
              "tr",
              { class: topic.known && topic.unread === 0 ? "" : "unknown" },
              h("td", {}, topic.topic),
              h("td", {}, topic.schema),
              h("td", { class: "number" }, topic.count),
              h("td", { class: "number" }, bytes(topic.bytes)),
              h("td", {}, topic.unread > 0 ? `${topic.unread} not decoded: ${topic.why}` : topic.known ? "" : "not shown here"),
            ),
          ),
          run.topics.length === 0 && h("tr", {}, h("td", { colspan: 5, class: "note" }, run.wholeness.kind === "reading" ? "counted at the end" : "none")),
        ),
      ),
      heading("The run", csvButton("the run's facts", () => name("run"), () => factsTable(run))),
      h("dl", { class: "facts" }, Object.entries({ ...facts.run, ...run.end }).map(([key, value]) => h("div", {}, h("dt", {}, key), h("dd", {}, value || "none")))),
      h("h3", {}, "Files of the mission"),
      h("ul", { class: "files" }, facts.attachments.map((one) => this.fileRow(one.name, one.bytes)), facts.attachments.length === 0 && h("li", { class: "note" }, "none")),
      this.file,
    ];
  }

  private fileRow(name: string, size: number): HTMLElement {
    const own = name.replace(/^.*[/\\]/, "") || "file";
    return h(
      "li",
      {},
      h("span", {}, name),
      h("span", { class: "number" }, bytes(size)),
      TEXT.test(name) && h("button", { type: "button", onclick: () => void this.read(name) }, "show"),
      h("button", { type: "button", onclick: async () => save(own, new Blob([(await this.handlers.attachment(name)) ?? new Uint8Array()])) }, "save"),
    );
  }

  private async read(name: string): Promise<void> {
    const found = (await this.handlers.attachment(name)) ?? new Uint8Array();
    const text = new TextDecoder().decode(found.subarray(0, LONGEST_TEXT));
    this.file.textContent = found.length > LONGEST_TEXT ? `${text}\n… ${found.length - LONGEST_TEXT} bytes more: save the file to see them.` : text;
    this.file.hidden = false;
    this.file.scrollIntoView({ block: "nearest" });
  }
}

const heading = (words: string, ...buttons: HTMLElement[]): HTMLElement => h("h3", { class: "with-tools" }, h("span", {}, words), h("span", { class: "spring" }), ...buttons);

const SAID: Record<CrcCheck, string> = { right: "right", wrong: "WRONG", absent: "none in the file", unread: "not reached" };

/** What was held against its CRC, in sentences. */
export const checked = ({ way, chunks, chunkCrcs, attachments, attachmentsWrong, summary, data }: Checks): string =>
  [
    way === "index" ? "Read by its index." : "Read record by record from the front: it has no index that can be used.",
    `CRC of the data section: ${SAID[data]}; of the summary: ${SAID[summary]}.`,
    chunks === 0 ? "No chunk was read." : `${chunks} chunk${chunks === 1 ? "" : "s"} read, ${chunkCrcs === chunks ? "each against its own CRC" : `${chunkCrcs} of them with a CRC of its own`}.`,
    `${attachments} attachment${attachments === 1 ? "" : "s"} read${attachmentsWrong > 0 ? `, ${attachmentsWrong} left out because of a wrong CRC` : ""}.`,
    "The chain of decisions is not checked by this page: wisdom verify LOG does.",
  ].join(" ");
