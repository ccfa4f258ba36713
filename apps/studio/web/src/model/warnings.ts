// The warnings of the scene and its run, as components see them.
import { useMemo } from "react";
import { warningsOf, type Warning } from "./health";
import { useStudio } from "./store";

export function useWarnings(): Warning[] {
  const scene = useStudio((s) => s.sceneState.warnings);
  const events = useStudio((s) => s.numbers?.["rare_events"]);
  const log = useStudio((s) => s.log);
  // Where nothing is built, what the log says is of a run that is gone.
  const since = useStudio((s) => (s.status.state === "empty" ? Infinity : s.built));
  const names = useStudio((s) => Object.keys(s.scene.nodes).join());
  return useMemo(() => warningsOf(scene, events === undefined ? null : { rare_events: events }, log, since, names.split(",")), [scene, events, log, since, names]);
}
