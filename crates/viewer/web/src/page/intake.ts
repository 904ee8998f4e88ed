// Files taken in: dropped on the page, or chosen.

import { h } from "../ui/dom";

export class Intake {
  readonly file = h("input", { type: "file", accept: ".mcap,.part", multiple: true, hidden: true, "aria-hidden": "true" });
  /** What is shown while no log is open. */
  readonly welcome: HTMLElement;
  /** Whether the file being chosen is to be the second. */
  private beside = false;

  constructor(take: (files: readonly File[], beside: boolean) => void) {
    this.welcome = h(
      "div",
      { class: "welcome" },
      h("h2", {}, "No log is open"),
      h("p", {}, "Drop an .mcap file anywhere on this page, or ", h("button", { type: "button", onclick: () => this.choose(false) }, "choose one"), "."),
      h("p", { class: "note" }, "It is read here, in this page. Nothing is sent anywhere. Files that were cut short or damaged are read up to the fault."),
    );
    this.file.addEventListener("change", () => {
      take([...(this.file.files ?? [])], this.beside);
      this.beside = false;
      this.file.value = "";
    });
    const { classList } = document.documentElement;
    document.addEventListener("dragover", (event) => {
      event.preventDefault();
      classList.add("dropping");
    });
    document.addEventListener("dragleave", (event) => {
      if (event.relatedTarget === null) classList.remove("dropping");
    });
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      classList.remove("dropping");
      take([...(event.dataTransfer?.files ?? [])], event.shiftKey);
    });
  }

  choose(beside: boolean): void {
    this.beside = beside;
    this.file.click();
  }
}
