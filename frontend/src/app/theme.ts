/** Quiet chrome: greys with a little blue, one accent. Colours of identities live with the boxes (palette.ts). */

import { createTheme, type MantineColorsTuple } from "@mantine/core";
import { text } from "../strings";

const dark: MantineColorsTuple = [
  "#d9dce3",
  "#b0b5c1",
  "#8f95a4",
  "#646a7a",
  "#3d4250",
  "#2c303b",
  "#20242d",
  "#16191f",
  "#101217",
  "#0a0c0f",
];

const accent: MantineColorsTuple = [
  "#edf2ff",
  "#dbe4ff",
  "#bac8ff",
  "#91a7ff",
  "#748ffc",
  "#5c7cfa",
  "#4c6ef5",
  "#3b5bdb",
  "#364fc7",
  "#2f45b0",
];

export const theme = createTheme({
  fontFamily: '"Inter Variable", system-ui, sans-serif',
  fontFamilyMonospace: "ui-monospace, SFMono-Regular, Menlo, monospace",
  headings: { fontWeight: "620" },
  colors: { dark, accent },
  primaryColor: "accent",
  primaryShade: 7,
  defaultRadius: "md",
  cursorType: "pointer",
  focusRing: "auto",
  components: {
    // A menu holds its items only: the placeholder for the focus is no item.
    Menu: { defaultProps: { withInitialFocusPlaceholder: false } },
    Modal: { defaultProps: { closeButtonProps: { "aria-label": text.app.close } } },
  },
});
