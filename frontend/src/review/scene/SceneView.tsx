import { ActionIcon, Loader, Tooltip, useComputedColorScheme } from "@mantine/core";
import { IconCube3dSphere, IconCubeOff, IconX } from "@tabler/icons-react";
import { Notice } from "../../app/Notice";
import { text } from "../../strings";
import { withKey } from "../keys/Key";
import classes from "./SceneView.module.css";
import { useScene } from "./useScene";

/** The LiDAR sweep and the 3D boxes of the frame, following the playhead. */
export function SceneView({ height, onClose }: { height: number; onClose: () => void }) {
  const { scene, restart } = useScene(useComputedColorScheme("dark"));
  return (
    <section className={classes.scene} style={{ height }} aria-label={text.scene.frameTitle}>
      <header className={classes.head}>
        <IconCube3dSphere size={15} />
        <h2 className={classes.title}>{text.scene.title}</h2>
        <Tooltip label={withKey(text.scene.hide, "toggleScene")}>
          <ActionIcon size="sm" variant="subtle" color="gray" aria-label={text.scene.hide} onClick={onClose}>
            <IconX size={14} />
          </ActionIcon>
        </Tooltip>
      </header>
      <div className={classes.body}>
        {scene.state === "starting" && <Notice icon={<Loader size="sm" />} title={text.scene.starting} />}
        {scene.state === "running" && (
          <iframe className={classes.frame} src={scene.url} title={text.scene.frameTitle} />
        )}
        {scene.state === "noLidar" && (
          <Notice icon={<IconCubeOff size={26} stroke={1.4} />} title={text.scene.noLidar}>
            {text.scene.noLidarHint}
          </Notice>
        )}
        {(scene.state === "failed" || scene.state === "lost") && (
          <Notice
            icon={<IconCubeOff size={26} stroke={1.4} />}
            title={scene.state === "failed" ? text.scene.failed : text.scene.lost}
            onRetry={restart}
            role="alert"
          >
            {scene.message}
          </Notice>
        )}
      </div>
    </section>
  );
}
