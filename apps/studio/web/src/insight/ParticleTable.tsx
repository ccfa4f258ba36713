// The particles of a fluid with all of their attributes: sorted by any of them, page by page, also while the scene runs.
import { useState } from "react";
import { useAnswer } from "../model/answer";
import { shortText } from "../model/numbers";
import { useStudio } from "../model/store";
import type { Json } from "../model/types";

/** See "particles" in PROTOCOL.md. */
interface Table {
  node: string;
  frame: number;
  time: number;
  total: number;
  from: number;
  columns: { name: string; unit: string }[];
  rows: Json[][];
}

const kRows = 50;

export function ParticleTable() {
  const fluids = useStudio((s) => s.fluids);
  const picked = useStudio((s) => s.picked);
  // Of the frame that is looked at, or of the nearest one that the server has kept whole.
  const looking = useStudio((s) => s.looking);
  const [refused, setRefused] = useState<string | null>(null);
  const [wish, setWish] = useState<string | null>(null);
  const [sort, setSort] = useState({ by: "id", descending: false });
  const [from, setFrom] = useState(0);
  const [{ table, sorted }, setShown] = useState<{ table: Table | null; sorted: typeof sort }>({ table: null, sorted: sort });
  const node = wish !== null && fluids.includes(wish) ? wish : fluids[0];
  useAnswer<Table | null>(node === undefined ? null : { do: "particles", node, sort: sort.by, descending: sort.descending, from, count: kRows, ...(looking !== null && { frame: looking }) }, (answer) => (setRefused(null), setShown({ table: answer, sorted: sort })), (e) => setRefused(e.message));
  if (refused !== null && looking !== null) return <p className="hint" role="status">No table of frame {looking}: {refused}</p>;
  if (node === undefined || table?.node !== node) return <p className="hint">No particles yet.</p>;
  const { total, columns } = table;
  const pages = Math.max(1, Math.ceil(total / kRows));
  const page = Math.min(Math.floor(from / kRows), pages - 1);
  const turn = (to: number) => setFrom(kRows * Math.min(Math.max(to, 0), pages - 1));
  const order = (by: string) => {
    setSort((s) => ({ by, descending: s.by === by ? !s.descending : by !== "id" }));
    setFrom(0);
  };
  const pick = (id: number) => useStudio.setState({ picked: { node, id } });
  return (
    <div className="particle-table">
      <div className="pager" role="toolbar" aria-label="Pages">
        {fluids.length > 1 && (
          <select aria-label="Fluid" value={node} onChange={(e) => (setWish(e.target.value), setFrom(0))}>{fluids.map((f) => <option key={f}>{f}</option>)}</select>
        )}
        <button aria-label="First page" disabled={page === 0} onClick={() => turn(0)}>«</button>
        <button aria-label="Page before" disabled={page === 0} onClick={() => turn(page - 1)}>‹</button>
        <span>{total === 0 ? "none" : `${(table.from + 1).toLocaleString("en")}–${(table.from + table.rows.length).toLocaleString("en")} of ${total.toLocaleString("en")}`}</span>
        <button aria-label="Next page" disabled={page >= pages - 1} onClick={() => turn(page + 1)}>›</button>
        <button aria-label="Last page" disabled={page >= pages - 1} onClick={() => turn(pages - 1)}>»</button>
        <small title={looking === null ? "The table shows the run" : "The table shows the recorded frame that is looked at"} data-frame={table.frame}>
          at {table.time.toFixed(3)} s{looking !== null && table.frame !== looking && `, frame ${table.frame}: the nearest that is kept whole`}
        </small>
      </div>
      <div className="scroll">
        <table>
          <thead>
            <tr>
              {columns.map((c) => (
                <th key={c.name} aria-sort={c.name !== sorted.by ? "none" : sorted.descending ? "descending" : "ascending"}>
                  <button onClick={() => order(c.name)} title={`Sort by ${c.name}`}>
                    {c.name}{c.unit && <small> {c.unit.replaceAll("^2", "²").replaceAll("^3", "³")}</small>}{c.name === sorted.by && (sorted.descending ? " ▼" : " ▲")}
                  </button>
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {table.rows.map((row) => {
              const id = Number(row[0]);
              const chosen = picked?.node === node && picked.id === id;
              return (
                <tr key={id} tabIndex={0} aria-selected={chosen} onClick={() => pick(id)} onKeyDown={(e) => e.key === "Enter" && pick(id)} title="Show it in the view">
                  {row.map((v, i) => <td key={columns[i]!.name}>{shortText(v)}</td>)}
                </tr>
              );
            })}
          </tbody>
        </table>
      </div>
    </div>
  );
}
