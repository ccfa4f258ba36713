// All attributes of the particle that was clicked, also while the scene runs.
import { useState } from "react";
import { useAnswer } from "../model/answer";
import { shortText } from "../model/numbers";
import { useStudio } from "../model/store";
import type { Json } from "../model/types";

interface Found {
  node: string;
  id: number;
  attributes: { [name: string]: Json };
}

export function PickedParticle() {
  const picked = useStudio((s) => s.picked);
  const [found, setFound] = useState<Found | null | undefined>();
  useAnswer<Found | null>(picked && { do: "particle", node: picked.node, particle: picked.id }, setFound);
  if (!picked) return null;
  const attributes = found?.node === picked.node && found.id === picked.id ? found.attributes : {};
  return (
    <div className="picked">
      <button aria-label="Close" onClick={() => useStudio.setState({ picked: null })}>×</button>
      <h3>Particle {picked.id} of {picked.node}</h3>
      <table>
        <tbody>
          {Object.entries(attributes).map(([name, v]) => <tr key={name}><th>{name}</th><td>{shortText(v)}</td></tr>)}
        </tbody>
      </table>
      {found === null && <p className="hint">It is not there.</p>}
    </div>
  );
}
