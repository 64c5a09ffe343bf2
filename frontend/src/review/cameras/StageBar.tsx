import { ActionIcon, Button, Popover, SegmentedControl, Slider, Stack, Text, Tooltip } from "@mantine/core";
import { IconAdjustmentsHorizontal } from "@tabler/icons-react";
import { memo } from "react";
import { text } from "../../strings";
import { type Adjustments, filterOf, GAMMA_FILTER_ID, LIMITS, UNCHANGED, useAppearance } from "./appearance";
import { COLOURINGS, type Colouring } from "./colouring";
import { Legend } from "./Legend";
import classes from "./StageBar.module.css";

/** Above the cameras: what the colours mean, and how the pictures are shown. */
export const StageBar = memo(function StageBar() {
  const { colouring, setColouring } = useAppearance();
  return (
    <div className={classes.bar}>
      <span className={classes.words} id="colour-by">
        {text.cameras.colourBy}
      </span>
      <SegmentedControl
        size="xs"
        aria-labelledby="colour-by"
        value={colouring}
        onChange={(value) => setColouring(value as Colouring)}
        data={COLOURINGS.map((value) => ({ value, label: text.cameras.colourings[value] }))}
      />
      <Legend />
      <PictureAdjustments />
    </div>
  );
});

function PictureAdjustments() {
  const { adjustments, adjust } = useAppearance();
  const changed = filterOf(adjustments) !== undefined;
  return (
    <Popover position="bottom-end" width={260} shadow="md" trapFocus>
      <Popover.Target>
        <Tooltip label={text.cameras.adjust} openDelay={500}>
          <ActionIcon
            variant={changed ? "light" : "subtle"}
            color={changed ? undefined : "gray"}
            aria-label={text.cameras.adjust}
            className={classes.adjust}
          >
            <IconAdjustmentsHorizontal size={18} />
          </ActionIcon>
        </Tooltip>
      </Popover.Target>
      <Popover.Dropdown>
        <Stack gap="sm">
          {(Object.keys(LIMITS) as (keyof Adjustments)[]).map((name) => (
            <div key={name}>
              <Text size="xs" fw={560}>
                {text.cameras.adjustments[name]} {adjustments[name].toFixed(2)}
              </Text>
              <Slider
                size="sm"
                thumbLabel={text.cameras.adjustments[name]}
                label={null}
                min={LIMITS[name].min}
                max={LIMITS[name].max}
                step={0.05}
                value={adjustments[name]}
                onChange={(value) => adjust({ [name]: value })}
              />
            </div>
          ))}
          <Button size="compact-xs" variant="default" disabled={!changed} onClick={() => adjust(UNCHANGED)}>
            {text.cameras.adjustReset}
          </Button>
        </Stack>
      </Popover.Dropdown>
    </Popover>
  );
}

/** The gamma curve, which CSS has no filter for; the pictures refer to it by name. */
export function GammaFilter() {
  const gamma = useAppearance((state) => state.adjustments.gamma);
  if (gamma === 1) return null;
  const curve = { type: "gamma", exponent: 1 / gamma };
  return (
    <svg width={0} height={0} aria-hidden style={{ position: "absolute" }}>
      <filter id={GAMMA_FILTER_ID} colorInterpolationFilters="sRGB">
        <feComponentTransfer>
          <feFuncR {...curve} />
          <feFuncG {...curve} />
          <feFuncB {...curve} />
        </feComponentTransfer>
      </filter>
    </svg>
  );
}
