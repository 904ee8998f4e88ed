// What the keys do.

import { h } from "./dom";

const KEYS: readonly [string, string][] = [
  ["←  →", "decision before, next decision"],
  ["n  N", "next decision at which a goal was added or dropped; the one before"],
  ["Home  End", "first, last decision"],
  ["Space", "play, stop; , and . slower and faster, r begins anew at the end"],
  ["g", "to the list of goals; ↑ ↓ to move, Enter to open one"],
  ["/", "filter the goals; Enter opens the first that fits"],
  ["1 2 3 4 5", "goals, changes, plans, run, the two runs"],
  ["l  L", "next layer, layer before"],
  ["a", "the layer as it is, its change since last, or A less B"],
  ["w", "ways of all plans in the family"],
  ["t", "timeline by mission time or by decision; its upper edge (Tab to it) is moved by ↑ ↓"],
  ["s", "relief on or off"],
  ["v  h", "the ground in two or three dimensions; heights stretched by more"],
  ["m", "to the map; there + − 0 zoom, Shift and arrows pan or turn, Alt and arrows ask a cell"],
  ["Esc", "let go of the goal"],
  ["d", "dark or light, the other of what is seen; then as the system has it"],
  ["o", "open a log"],
  ["c", "open a second log beside it"],
  ["b", "two runs by a wipe, side by side, or as a difference; [ and ] move the wipe"],
  ["x", "the decision of run A or of run B beside the map; that run leads the cursor"],
  ["f", "to the first decision that the two runs took otherwise, term by term"],
  ["y", "copy the link to what is looked at"],
  ["?", "this list"],
];

export const helpDialog = (): HTMLDialogElement => {
  const dialog = h(
    "dialog",
    { class: "help", "aria-label": "Keys" },
    h("h2", {}, "Keys"),
    h("dl", {}, KEYS.flatMap(([key, what]) => [h("dt", {}, key), h("dd", {}, what)])),
    h("p", { class: "note" }, "The address keeps what is looked at, and the way back leads over it; printing puts all pages on paper. Nothing on this page goes over the network."),
    h("form", { method: "dialog" }, h("button", {}, "Close")),
  );
  document.body.append(dialog);
  return dialog;
};
