// A note, or a frame behind nodes.
import { NodeResizer, type NodeProps } from "@xyflow/react";
import { memo } from "react";
import type { Note, Scene } from "../model/scene";
import { edit } from "../model/store";

export const changeNote = (scene: Scene, id: string, change: Partial<Note>): Scene => ({
  ...scene,
  layout: {
    ...scene.layout,
    notes: (scene.layout?.notes ?? []).map((n) => (n.id === id ? { ...n, ...change } : n)),
  },
});

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
        onBlur={(e) => e.target.value !== note.text && edit((s) => changeNote(s, note.id, { text: e.target.value }))}
      />
    </div>
  );
});
