import { ActionIcon, Group, Tooltip, useComputedColorScheme, useMantineColorScheme } from "@mantine/core";
import { IconMoon, IconSun } from "@tabler/icons-react";
import type { ReactNode } from "react";
import { Link } from "wouter";
import icon from "../favicon.svg";
import { text } from "../strings";
import classes from "./Header.module.css";

/** The strip on top: where you are on the left, what you can do on the right. */
export function Header({ children, actions }: { children?: ReactNode; actions?: ReactNode }) {
  return (
    <header className={classes.header}>
      <Link href="/" className={classes.home} aria-label={`${text.app.name}, ${text.app.drives}`}>
        <img src={icon} width={24} height={24} alt="" />
        <span className={classes.name}>{text.app.name}</span>
      </Link>
      <div className={classes.place}>{children}</div>
      <Group gap="xs" wrap="nowrap">
        {actions}
        <ColourToggle />
      </Group>
    </header>
  );
}

function ColourToggle() {
  const { setColorScheme } = useMantineColorScheme();
  const dark = useComputedColorScheme("dark") === "dark";
  const label = dark ? text.app.toLight : text.app.toDark;
  return (
    <Tooltip label={label}>
      <ActionIcon
        variant="subtle"
        color="gray"
        aria-label={label}
        onClick={() => setColorScheme(dark ? "light" : "dark")}
      >
        {dark ? <IconSun size={18} /> : <IconMoon size={18} />}
      </ActionIcon>
    </Tooltip>
  );
}
