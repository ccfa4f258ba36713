// All attributes of the particle that was clicked, also while the scene runs; how far it is from another one; and a probe there.
import { useState } from "react";
import { useAnswer } from "../model/answer";
import { shortText } from "../model/numbers";
import { distanceBetween, probeType, withProbe } from "../model/probe";
import { edit, useStudio } from "../model/store";
import type { Json } from "../model/types";

interface Found {
  node: string;
  id: number;
  attributes: { [name: string]: Json };
}

type Which = Pick<Found, "node" | "id"> | null;

/** What the server tells of a particle: undefined while it has told nothing, null where the particle is not there. */
function useParticle(which: Which): Found | null | undefined {
  const [found, setFound] = useState<Found | null | undefined>();
  const looking = useStudio((s) => s.looking);
  useAnswer<Found | null>(which && { do: "particle", node: which.node, particle: which.id, ...(looking !== null && { frame: looking }) }, setFound);
  return found && which && found.node === which.node && found.id === which.id ? found : found === null ? null : undefined;
}

const placeOf = (found: Found | null | undefined): number[] | null => {
  const at = found?.attributes["position"];
  return Array.isArray(at) && at.length === 3 ? at.map(Number) : null;
};

/** A node that measures there. */
function measure(node: string, at: number[]): void {
  edit((s) => {
    const [next, name] = withProbe(s, useStudio.getState().types!, node, at) ?? [s, null];
    if (name !== null) useStudio.setState({ selected: [name], selectedLinks: [] });
    return next;
  });
}

export function PickedParticle() {
  const picked = useStudio((s) => s.picked);
  const before = useStudio((s) => s.pickedBefore);
  const canMeasure = useStudio((s) => s.role === "writer" && s.types !== null && probeType(s.types) !== null);
  const found = useParticle(picked), other = useParticle(before);
  if (!picked) return null;
  const at = placeOf(found), from = placeOf(other);
  return (
    <div className="picked" role="region" aria-label={`Particle ${picked.id} of ${picked.node}`}>
      <button aria-label="Close" onClick={() => useStudio.setState({ picked: null, pickedBefore: null })}>×</button>
      <h3>Particle {picked.id} of {picked.node}</h3>
      <table>
        <tbody>
          {Object.entries(found?.attributes ?? {}).map(([name, v]) => <tr key={name}><th>{name}</th><td>{shortText(v)}</td></tr>)}
          {before && at && from && <tr className="distance"><th>to particle {before.id}</th><td>{shortText(distanceBetween(at, from))} m</td></tr>}
        </tbody>
      </table>
      {found === null && <p className="hint">It is not there.</p>}
      {at && canMeasure && <button className="measure" onClick={() => measure(picked.node, at)} title="Adds a node that measures at this place; after a reset, its plots are in Insight">Measure here</button>}
      {at && !before && <p className="hint">Shift and a click on another: how far it is.</p>}
    </div>
  );
}
