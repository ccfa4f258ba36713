// A note, or a frame behind nodes.
import { NodeResizer, type NodeProps } from "@xyflow/react";
import { memo } from "react";
import { changeNote } from "../model/notes";
import type { Note } from "../model/scene";
import { edit } from "../model/store";

export const NoteNode = memo(function NoteNode({ data, selected }: NodeProps & { data: { note: Note } }) {
  const { note } = data;
  return (
    <div className={note.frame ? "note frame" : "note"}>
      <NodeResizer
        isVisible={selected} minWidth={120} minHeight={60}
        onResizeEnd={(_, at) =>
          edit((s) => changeNote(s, note.id, { x: at.x, y: at.y, width: at.width, height: at.height }))
        }
      />
      <textarea
        className="nodrag" aria-label="Note" defaultValue={note.text} key={note.text}
        placeholder={note.frame ? "Group" : "Note"}
        onKeyDown={(e) => e.key === "Escape" && e.currentTarget.closest<HTMLElement>(".graph")?.focus()}
        onBlur={(e) => e.target.value !== note.text && edit((s) => changeNote(s, note.id, { text: e.target.value }))}
      />
    </div>
  );
});
