// The keys of the page. A canvas or a table that has the focus takes its own first.

/** What each key does; none does nothing. */
export type Keys = Record<string, (() => void) | undefined>;

/** Keys that are typed into a field, or go with Ctrl, Alt or a dialog, are not the page's. */
export const listenKeys = (keys: () => Keys): void => {
  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    const typing = target.matches("input, select, textarea");
    if (typing && event.key === "Escape") target.blur();
    if (typing || event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    // On a button the space bar presses the button.
    if (event.key === " " && target.matches("button, summary")) return;
    const act = keys()[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
};
