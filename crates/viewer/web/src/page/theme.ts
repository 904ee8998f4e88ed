// Light, dark, or as the system has it.

import type { Theme } from "../state";

const THEMES: readonly Theme[] = ["auto", "light", "dark"];
const dark = (): boolean => matchMedia("(prefers-color-scheme: dark)").matches;
const KEY = "wisdom-theme";

/** First the opposite of what is seen, so that the first press shows; then what the system has, and back to it. */
export const nextTheme = (theme: Theme, systemDark = dark()): Theme => {
  const opposite = systemDark ? "light" : "dark";
  if (theme === "auto") return opposite;
  return theme === opposite ? (systemDark ? "dark" : "light") : "auto";
};

export const keptTheme = (): Theme => {
  try {
    const kept = localStorage.getItem(KEY);
    return THEMES.find((theme) => theme === kept) ?? "auto";
  } catch {
    return "auto";
  }
};

export const applyTheme = (theme: Theme): void => {
  if (theme === "auto") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
  try {
    localStorage.setItem(KEY, theme);
  } catch {
    // A page opened from disk may have no storage; the theme then lasts as long as the page.
  }
};
