// Light, dark, or as the system has it.

import type { Theme } from "../state";

const THEMES: readonly Theme[] = ["auto", "light", "dark"];
const KEY = "wisdom-theme";

export const nextTheme = (theme: Theme): Theme => THEMES[(THEMES.indexOf(theme) + 1) % THEMES.length] ?? "auto";

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
