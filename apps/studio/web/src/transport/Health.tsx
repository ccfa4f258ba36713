// The health of the run: a light each for what can go wrong, and why.
import { useEffect, useMemo, useRef, useState } from "react";
import { Icon } from "../Icon";
import { lightsOf, measuresOf, worst, type Level, type Light } from "../model/health";
import { counted } from "../model/playback";
import { followMotion, moreIterations, shorterSteps, type Remedy } from "../model/remedy";
import { askRun, edit, useStudio } from "../model/store";
import { useWarnings } from "../model/warnings";

const kWords: { [level in Level]: string } = { unknown: "not known", good: "good", watch: "look at it", bad: "bad" };

export function Health() {
  const numbers = useStudio((s) => s.numbers);
  const samples = useStudio((s) => s.samples);
  const warnings = useWarnings();
  const [open, setOpen] = useState(false);
  const box = useRef<HTMLDivElement>(null);
  const scene = useStudio((s) => s.scene);
  const types = useStudio((s) => s.types);
  const coarser = useStudio((s) => s.status.coarser ?? 1);
  const lights = useMemo(() => lightsOf(numbers, samples, types ? measuresOf(scene, types, coarser) : undefined), [numbers, samples, scene.nodes, scene.world, types, coarser]); // eslint-disable-line
  useEffect(() => {
    if (!open) return;
    const leave = (e: Event) => (e instanceof KeyboardEvent ? e.key === "Escape" : !box.current?.contains(e.target as globalThis.Node)) && setOpen(false);
    for (const type of ["pointerdown", "keydown"]) addEventListener(type, leave, true);
    return () => ["pointerdown", "keydown"].forEach((type) => removeEventListener(type, leave, true));
  }, [open]);
  const writer = useStudio((s) => s.role === "writer");
  const remedyOf = ({ name, level, node = "" }: Light): Remedy | null => {
    if (!writer || !types || (level !== "watch" && level !== "bad")) return null;
    const own = name === "CFL" ? followMotion(scene, types.world) : name === "Convergence" ? moreIterations(scene, types, node) : null;
    return own ?? shorterSteps(scene, types.world);
  };
  const help = async (remedy: Remedy) => {
    setOpen(false);
    edit(remedy.change);
    if (await askRun("reset")) await askRun("play");
  };
  const select = (node: string) => useStudio.setState({ selected: [node], selectedLinks: [] });
  const all = worst([...lights, { level: warnings.length > 0 ? "watch" : "unknown" }]);
  return (
    <div className="health" ref={box}>
      <button aria-expanded={open} title="Why?" onClick={() => setOpen(!open)}>
        <span className="unseen">Health: {kWords[all]}, </span>
        {lights.map((l) => <span key={l.name} className={`light ${l.level}`} title={`${l.name}: ${l.value}, ${kWords[l.level]}`}><i /><span className="name">{l.name === "CFL" ? l.name : l.name.toLowerCase()}</span> <b>{l.value}</b></span>)}
        {warnings.length > 0 && <span className="light watch warnings" title={counted(warnings.length, "warning")}><Icon name="warning" /><b>{warnings.length}</b><span className="name">{warnings.length === 1 ? "warning" : "warnings"}</span></span>}
      </button>
      {open && (
        <div className="why" role="dialog" aria-label="Health of the run">
          {lights.map((l) => ({ ...l, remedy: remedyOf(l) })).map(({ remedy, ...l }) => (
            <p key={l.name} className={`light ${l.level}`}>
              <i /><span><b>{l.name}: {l.value}</b>, {kWords[l.level]}. {l.why} {l.node && l.level !== "good" && <button onClick={() => select(l.node!)}>Show {l.node}</button>}{" "}
                {remedy && <button className="wanted" onClick={() => void help(remedy)}>{remedy.text}</button>}</span>
            </p>
          ))}
          {warnings.map((w) => (
            <p key={w.text} className="light watch"><Icon name="warning" /><span>{w.text}{w.count > 1 && ` (${w.count} times)`} {w.node && <button onClick={() => select(w.node!)}>Show {w.node}</button>}</span></p>
          ))}
        </div>
      )}
    </div>
  );
}
