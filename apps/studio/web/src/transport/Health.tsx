// The health of the run: a light each for what can go wrong, and why.
import { useEffect, useMemo, useRef, useState } from "react";
import { Icon } from "../Icon";
import { lightsOf, worst, type Level } from "../model/health";
import { counted } from "../model/playback";
import { shorterSteps } from "../model/remedy";
import { askRun, edit, useStudio } from "../model/store";
import { useWarnings } from "../model/warnings";

const kWords: { [level in Level]: string } = { unknown: "not known yet", good: "good", watch: "look at it", bad: "bad" };

export function Health() {
  const numbers = useStudio((s) => s.numbers);
  const samples = useStudio((s) => s.samples);
  const warnings = useWarnings();
  const [open, setOpen] = useState(false);
  const box = useRef<HTMLDivElement>(null);
  const lights = useMemo(() => lightsOf(numbers, samples), [numbers, samples]);
  useEffect(() => {
    if (!open) return;
    const leave = (e: Event) => (e instanceof KeyboardEvent ? e.key === "Escape" : !box.current?.contains(e.target as globalThis.Node)) && setOpen(false);
    for (const type of ["pointerdown", "keydown"]) addEventListener(type, leave, true);
    return () => ["pointerdown", "keydown"].forEach((type) => removeEventListener(type, leave, true));
  }, [open]);
  const remedy = useStudio((s) => s.role === "writer" && s.types !== null) ? shorterSteps(useStudio.getState().scene, useStudio.getState().types!.world) : null;
  const help = async () => {
    if (!remedy) return;
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
        {lights.map((l) => <span key={l.name} className={`light ${l.level}`} title={`${l.name}: ${kWords[l.level]}`}><i />{l.name.toLowerCase()} <b>{l.value}</b></span>)}
        {warnings.length > 0 && <span className="light watch"><Icon name="warning" /> <b>{counted(warnings.length, "warning")}</b></span>}
      </button>
      {open && (
        <div className="why" role="dialog" aria-label="Health of the run">
          {lights.map((l) => (
            <p key={l.name} className={`light ${l.level}`}>
              <i /><span><b>{l.name}: {l.value}</b>, {kWords[l.level]}. {l.why} {l.node && l.level !== "good" && <button onClick={() => select(l.node!)}>Show {l.node}</button>}{" "}
                {remedy && (l.level === "watch" || l.level === "bad") && <button className="wanted" onClick={() => void help()}>{remedy.text}</button>}</span>
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
